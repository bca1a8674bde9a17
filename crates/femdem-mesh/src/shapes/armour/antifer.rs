use crate::shapes::extruded::band;
use crate::shapes::family::family;
use crate::shapes::planar::{Point2, triangulate};
use crate::shapes::weld::{centred, surface};
use crate::{MeshError, Point3, Polyhedron};
use std::f64::consts::PI;

family! {
    /// An Antifer cube: a block that tapers upwards (along z), with a round groove along each of its
    /// four sides.
    ///
    /// The widths of 1.086 and 1.005 heights and the volume of 1.0247 cubic heights are those given
    /// for Antifer blocks by A. B. Frens, "The impact of placement method on Antifer-block
    /// stability", thesis, Delft University of Technology, 2007. The grooves are taken as half
    /// circles about the faces of the block, of constant radius; the default radius is the one that
    /// gives this volume with 8 segments. Vertices of the grooves lie on the circle.
    Antifer = "antifer", "Antifer cube, tapered with grooved sides", size: "the height" {
        /// Width at the bottom over the height.
        bottom: f64 = 1.086, in 0.8, 1.4;
        /// Width at the top over the height.
        top: f64 = 1.005, in 0.8, 1.4;
        /// Radius of the grooves over the height.
        groove: f64 = 0.1061, in 0.02, 0.25;
        /// Facets across each groove.
        segments: u32 = 8, in 2, 48;
    }
}

impl Antifer {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let lower = self.outline(0.5 * self.bottom);
        let upper = self.outline(0.5 * self.top);
        let raised = |points: &[Point2], z: f64| -> Vec<Point3> {
            points.iter().map(|p| Point3::new(p.x, p.y, z)).collect()
        };
        let mut polygons = band(&raised(&lower, -0.5), &raised(&upper, 0.5));
        for triangle in triangulate(&lower, &[])? {
            polygons.push(
                raised(&triangle.map(|i| lower[i]), -0.5)
                    .into_iter()
                    .rev()
                    .collect(),
            );
        }
        for triangle in triangulate(&upper, &[])? {
            polygons.push(raised(&triangle.map(|i| upper[i]), 0.5));
        }
        centred(&surface(&polygons)?)
    }

    /// The section with half the width `half`, counter-clockwise.
    fn outline(&self, half: f64) -> Vec<Point2> {
        let mut side = vec![[half, -half]];
        for i in 0..=self.segments {
            let (sin, cos) = (PI * f64::from(i) / f64::from(self.segments)).sin_cos();
            side.push([half - self.groove * sin, -self.groove * cos]);
        }
        let quarter_turns: [fn([f64; 2]) -> [f64; 2]; 4] = [
            |[x, y]| [x, y],
            |[x, y]| [-y, x],
            |[x, y]| [-x, -y],
            |[x, y]| [y, -x],
        ];
        quarter_turns
            .into_iter()
            .flat_map(|turn| side.iter().map(move |&point| turn(point)))
            .map(|[x, y]| Point2 { x, y })
            .collect()
    }
}
