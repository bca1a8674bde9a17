use crate::shapes::family::family;
use crate::shapes::weld::surface;
use crate::{MeshError, Point3, Polyhedron};

/// Width of a fluke at its tips over the height.
const TIP: f64 = 0.20;
/// Side of the chamfers of shank and flukes over the height.
const CHAMFER: f64 = 0.057;

family! {
    /// A dolos: two flukes across each other at the ends of a shank along z, all with chamfered
    /// square sections. The upper fluke lies along y, the lower one along x.
    ///
    /// Proportions after the drawing in the U.S. Army Coastal Engineering Research Center's Shore
    /// Protection Manual (1984, chapter 7): fluke tips of 0.20, chamfers of 0.057, a waist of 0.32
    /// and a volume of 0.16 in units of the height. Flukes taper straight from the waist's width in
    /// their middle to the tips. H. F. Burcharth and Z. Liu (23rd Int. Conf. Coastal Engineering,
    /// 1992) vary the waist from 0.32 to 0.42 and give a volume of 0.675 `waist`^1.285, which this
    /// body meets within 4 %. Where the shank meets a tapered fluke its sides bend, by 2 % of the
    /// height at a waist of 0.32 and 5 % at 0.42, so that they end on the edges of the fluke.
    Dolos = "dolos", "dolos, two crossed flukes on a shank",
    size: "the height, which is also the length of a fluke" {
        /// Waist ratio: width of the shank, and of a fluke in its middle, over the height.
        waist: f64 = 0.32, in 0.25, 0.42;
    }
}

type Polygon = Vec<Point3>;

/// The symmetry that maps the upper fluke to the lower one: a quarter turn and a reflection in z = 0. It turns
/// polygons inside out, which is undone.
fn swap_ends(polygon: &Polygon) -> Polygon {
    polygon
        .iter()
        .rev()
        .map(|p| Point3::new(-p.y, p.x, -p.z))
        .collect()
}

fn mirror_y(polygon: &Polygon) -> Polygon {
    polygon
        .iter()
        .rev()
        .map(|p| Point3::new(p.x, -p.y, p.z))
        .collect()
}

impl Dolos {
    fn build(&self) -> Result<Polyhedron, MeshError> {
        let ring = Ring::new(self);
        let half_fluke = self.half_fluke(&ring);
        let mut ends: Vec<Polygon> = half_fluke.iter().map(mirror_y).collect();
        ends.extend(half_fluke);
        let mut polygons: Vec<Polygon> = ends.iter().map(swap_ends).collect();
        polygons.extend(ends);
        let mut quarter = ring.quarter_of_shank();
        for _ in 0..4 {
            quarter = quarter.iter().map(swap_ends).collect();
            polygons.extend(quarter.iter().cloned());
        }
        surface(&polygons)
    }

    /// Half the width of a fluke at the distance y from its middle.
    fn half_width(&self, y: f64) -> f64 {
        0.5 * self.waist - (self.waist - TIP) * y
    }

    /// Corners of the upper fluke's section at y, from +x towards +z.
    fn section(&self, y: f64) -> [Point3; 8] {
        let wide = self.half_width(y);
        let narrow = wide - CHAMFER;
        let middle = 0.5 - 0.5 * self.waist;
        [
            [wide, -narrow],
            [wide, narrow],
            [narrow, wide],
            [-narrow, wide],
            [-wide, narrow],
            [-wide, -narrow],
            [-narrow, -wide],
            [narrow, -wide],
        ]
        .map(|[x, z]| Point3::new(x, y, middle + z))
    }

    /// The part of the upper fluke at y > 0, without what the shank covers.
    fn half_fluke(&self, ring: &Ring) -> Vec<Polygon> {
        let [m0, m1, m2, m3, m4, m5, ..] = self.section(0.0);
        let tip = self.section(0.5);
        let [t0, t1, t2, t3, t4, t5, t6, t7] = tip;
        let Ring { side, inner, .. } = *ring;
        let (other_side, other_inner) = (mirrored_x(side), mirrored_x(inner));
        vec![
            vec![m1, t1, t2, m2],
            vec![m2, t2, t3, m3],
            vec![m3, t3, t4, m4],
            vec![m0, side, m1],
            vec![side, t0, t1, m1],
            vec![m4, other_side, m5],
            vec![m4, t4, t5, other_side],
            vec![other_side, t5, t6, other_inner],
            vec![other_inner, t6, t7, inner],
            vec![inner, t7, t0, side],
            tip.into_iter().rev().collect(),
        ]
    }
}

fn mirrored_x(p: Point3) -> Point3 {
    Point3::new(-p.x, p.y, p.z)
}

/// Where the shank ends on the upper fluke: three points for x >= 0, y >= 0, on edges of the fluke.
struct Ring {
    /// On the edge of the fluke's side, in the middle of the fluke.
    middle: Point3,
    /// On the same edge, where the shank's chamfer begins.
    side: Point3,
    /// On the edge of the fluke's inner face, where the shank's chamfer ends.
    inner: Point3,
}

impl Ring {
    fn new(dolos: &Dolos) -> Self {
        let half = 0.5 * dolos.waist;
        let [middle, ..] = dolos.section(0.0);
        let [side, ..] = dolos.section(half - CHAMFER);
        let [.., inner] = dolos.section(half);
        Self {
            middle,
            side,
            inner,
        }
    }

    /// The shank's face towards +y, and its chamfer towards +x and +y.
    fn quarter_of_shank(&self) -> Vec<Polygon> {
        // A half turn about x = y, z = 0 maps the upper ring to the lower one.
        let below = |p: Point3| Point3::new(p.y, p.x, -p.z);
        let (middle_below, side_below, inner_below) =
            (below(self.middle), below(self.side), below(self.inner));
        vec![
            vec![mirrored_x(self.inner), self.inner, middle_below],
            vec![self.inner, side_below, middle_below],
            vec![mirrored_x(self.inner), middle_below, mirrored_x(side_below)],
            vec![side_below, self.inner, self.side],
            vec![inner_below, side_below, self.side],
        ]
    }
}
