use crate::shapes::extruded::band;
use crate::shapes::family::family;
use crate::shapes::weld::surface;
use crate::{MeshError, Point3, Polyhedron, Vector3};
use std::f64::consts::{FRAC_PI_3, SQRT_2, TAU};

family! {
    /// A tetrapod: four conical legs towards the corners of a regular tetrahedron, one of them up
    /// (along z).
    ///
    /// Proportions after the drawing in the U.S. Army Coastal Engineering Research Center's Shore
    /// Protection Manual (1984, chapter 7), in units of the height: feet of 0.302, legs of 0.470
    /// where they meet, a volume of 0.280; the taper follows, 10 degrees to the axis. Feet are flat,
    /// without bevels. Legs are frusta of regular polygons with their vertices on the cones, and meet
    /// in the planes between them.
    Tetrapod = "tetrapod", "tetrapod, four conical legs", size: "the height of the unit on three feet" {
        /// Diameter of a foot over the height.
        foot: f64 = 0.302, in 0.2, 0.36;
        /// Diameter of a leg, where two legs meet, over the height.
        root: f64 = 0.470, in 0.37, 0.6;
        /// Sides of a leg, taken up to the next multiple of 6.
        sides: u32 = 12, in 6, 96;
    }
}

impl Tetrapod {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let legs = directions();
        let mut polygons = Vec::new();
        for (i, &leg) in legs.iter().enumerate() {
            let neighbour = legs[(i + 1) % 4];
            polygons.extend(self.leg(leg, neighbour));
        }
        surface(&polygons)
    }

    /// The surface of the leg along `axis`, from a side where it meets `neighbour`.
    fn leg(&self, axis: Vector3, neighbour: Vector3) -> Vec<Vec<Point3>> {
        let e1 = (neighbour - axis * axis.dot(&neighbour)).normalize();
        let e2 = axis.cross(&e1);

        // On three feet the lowest points are the corners of the lower feet's polygons.
        let foot = 0.5 * self.foot;
        let length = 0.75 * (1.0 - foot * 8.0_f64.sqrt() / 3.0);
        // Two legs meet where the radius is sqrt(2) times the distance along the axis.
        let root = 0.5 * self.root;
        let taper = (root - foot) / (length - root / SQRT_2);
        let radius_at_centre = root + taper * root / SQRT_2;

        let n = 6 * self.sides.div_ceil(6);
        let mut meeting = Vec::new();
        let mut end = Vec::new();
        for i in 0..n {
            let angle = TAU * f64::from(i) / f64::from(n);
            let outward = e1 * angle.cos() + e2 * angle.sin();
            // The nearest neighbour lies within 60 degrees.
            let from_neighbour = angle - 2.0 * FRAC_PI_3 * (angle / (2.0 * FRAC_PI_3)).round();
            let cos = from_neighbour.cos();
            let along = radius_at_centre * cos / (SQRT_2 + taper * cos);
            let radius = radius_at_centre - taper * along;
            meeting.push(Point3::from(axis * along + outward * radius));
            end.push(Point3::from(axis * length + outward * foot));
        }
        let mut polygons = band(&meeting, &end);
        polygons.push(end);
        polygons
    }
}

/// From the centre of a regular tetrahedron to its corners, the first one along z.
fn directions() -> [Vector3; 4] {
    let (sin, cos) = (8.0_f64.sqrt() / 3.0, 1.0 / 3.0);
    let height = 0.75_f64.sqrt();
    [
        Vector3::z(),
        Vector3::new(sin, 0.0, -cos),
        Vector3::new(-0.5 * sin, height * sin, -cos),
        Vector3::new(-0.5 * sin, -height * sin, -cos),
    ]
}
