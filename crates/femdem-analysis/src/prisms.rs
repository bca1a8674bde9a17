//! Volume shared by two closed surfaces of any form: signed prisms.
//!
//! Look along an axis `w`. A point lies in a closed surface if the triangles below it, each counted `+1` where
//! the line upwards enters and `-1` where it leaves, sum to 1; the same holds for the triangles above it with
//! the signs changed. Use the first criterion for a body `L` and the second for a body `U`: the product of the
//! two sums, integrated over space, is
//!
//! `V(L ∩ U) = - sum_ij s_i s_j ∫ max(w_j - w_i, 0) du dv`  over where the triangles `i` of `L` and
//! `j` of `U` lie over one another, with `s` the sign of the outward normal's component along `w`.
//!
//! Every term is continuous in the corners (a triangle seen edge-on has no area), so that there are no
//! decisions, and coinciding or touching faces are no special case. The sum is correct for every closed
//! surface, convex or not, in one part or more. Only triangles of `L` below the top of `U` and of `U` above the
//! bottom of `L` contribute.

use femdem_mesh::{Point3, Vector3};

use crate::polygon::Polygon;

/// A volume below this part of the summed sizes of all prisms is round-off.
const ROUND_OFF: f64 = 1e-14;

/// A triangle projected along an axis.
#[derive(Clone, Copy, Debug)]
struct Shadow {
    /// Counter-clockwise seen against the axis.
    corners: [[f64; 2]; 3],
    /// Whether the outward normal points along the axis (+1) or against it (-1).
    sign: f64,
    /// Height over the first corner, and its slopes.
    height: f64,
    slope: [f64; 2],
    /// Least and greatest height.
    reach: [f64; 2],
    /// Box around the corners.
    low: [f64; 2],
    high: [f64; 2],
}

impl Shadow {
    /// `None` when the triangle is seen edge-on. Coordinates are taken from `origin`.
    fn new(triangle: &[Point3; 3], axis: usize, origin: &Point3) -> Option<Self> {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let [a, mut b, mut c] = triangle.map(|p| p - origin);
        let twice_area = |b: &Vector3, c: &Vector3| {
            (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u])
        };
        let sign = twice_area(&b, &c).signum();
        if sign < 0.0 {
            std::mem::swap(&mut b, &mut c);
        }
        let area = twice_area(&b, &c);
        if area <= 0.0 || area.is_nan() {
            return None;
        }
        let (p, q) = (b - a, c - a);
        Some(Self {
            corners: [a, b, c].map(|x| [x[u], x[v]]),
            sign,
            height: a[axis],
            slope: [
                (p[axis] * q[v] - q[axis] * p[v]) / area,
                (q[axis] * p[u] - p[axis] * q[u]) / area,
            ],
            reach: [
                a[axis].min(b[axis]).min(c[axis]),
                a[axis].max(b[axis]).max(c[axis]),
            ],
            low: [u, v].map(|k| a[k].min(b[k]).min(c[k])),
            high: [u, v].map(|k| a[k].max(b[k]).max(c[k])),
        })
    }

    /// Height over `p`, which lies in the triangle to round-off: for steep triangles the height is limited to
    /// that of the triangle, so that round-off is not amplified.
    fn height(&self, p: [f64; 2]) -> f64 {
        let [u, v] = [p[0] - self.corners[0][0], p[1] - self.corners[0][1]];
        (self.height + self.slope[0] * u + self.slope[1] * v).clamp(self.reach[0], self.reach[1])
    }
}

/// The triangles of one body, seen along an axis, ordered for a sweep; memory to be reused.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shadows {
    list: Vec<Shadow>,
    /// Largest extent along the sweep.
    widest: f64,
}

impl Shadows {
    /// Restarts.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.widest = 0.0;
    }

    /// Adds a triangle, outward counter-clockwise.
    pub(crate) fn push(&mut self, triangle: &[Point3; 3], axis: usize, origin: &Point3) {
        if let Some(shadow) = Shadow::new(triangle, axis, origin) {
            self.widest = self.widest.max(shadow.high[0] - shadow.low[0]);
            self.list.push(shadow);
        }
    }

    fn sort(&mut self) {
        // Stable: equals stay in the order given.
        self.list.sort_by(|a, b| a.low[0].total_cmp(&b.low[0]));
    }
}

/// Volume shared by two bodies: `lower` contains the triangles of one body below the top of the other, `upper`
/// those of the other above the bottom of the first. Same axis and origin. With a `radius`, the part in the
/// cylinder about the axis through the origin. Zero where a volume cannot be distinguished from round-off.
pub(crate) fn shared_volume(lower: &mut Shadows, upper: &mut Shadows, radius: Option<f64>) -> f64 {
    upper.sort();
    lower.sort();
    let (mut volume, mut size) = (0.0, 0.0);
    for i in &lower.list {
        let from = i.low[0] - upper.widest;
        let first = upper.list.partition_point(|j| j.low[0] < from);
        let within = upper.list[first..].iter();
        for j in within.take_while(|j| j.low[0] < i.high[0]) {
            let apart = j.high[0] <= i.low[0]
                || j.high[1] <= i.low[1]
                || i.high[1] <= j.low[1]
                || j.reach[1] <= i.reach[0];
            if !apart {
                let prism = between(i, j, radius);
                volume -= i.sign * j.sign * prism;
                size += prism.abs();
            }
        }
    }
    if volume > ROUND_OFF * size {
        volume
    } else {
        0.0
    }
}

/// Volume over `lower` and under `upper`.
fn between(lower: &Shadow, upper: &Shadow, radius: Option<f64>) -> f64 {
    let mut common = Polygon::triangle(&lower.corners);
    for k in 0..3 {
        let (a, b) = (upper.corners[k], upper.corners[(k + 1) % 3]);
        common = common.cut(|p| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]));
    }
    let height = |p: [f64; 2]| upper.height(p) - lower.height(p);
    if lower.reach[1] > upper.reach[0] {
        common = common.cut(|p| height(*p));
    }
    match radius {
        None => common.volume(height),
        Some(radius) => common.volume_in_disc(radius, height),
    }
}

/// Contribution of a triangle to the volume that its surface has in a cylinder of `radius` about the axis
/// through `origin`: the signed prism between it and the plane of `origin`.
pub(crate) fn volume_in_cylinder(
    triangle: &[Point3; 3],
    axis: usize,
    origin: &Point3,
    radius: f64,
) -> f64 {
    Shadow::new(triangle, axis, origin).map_or(0.0, |shadow| {
        let part = Polygon::triangle(&shadow.corners);
        shadow.sign * part.volume_in_disc(radius, |p| shadow.height(p))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::Clipper;
    use femdem_mesh::catalogue::CatalogueShape;
    use femdem_mesh::{Polyhedron, Pose, Rotation};
    use proptest::prelude::*;

    fn solid(id: &str) -> Polyhedron {
        id.parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(2.0)
            .unwrap()
    }

    /// Shared volume projected along every axis, with either body below.
    fn by_prisms(bodies: [(&Polyhedron, &Pose); 2]) -> Vec<f64> {
        let mut found = Vec::new();
        for axis in 0..3 {
            let mut shadows = bodies.map(|(shape, pose)| {
                let mut shadows = Shadows::default();
                for t in shape.triangles() {
                    let triangle = t.map(|v| pose * shape.vertices()[v as usize]);
                    shadows.push(&triangle, axis, &Point3::new(0.3, -0.2, 0.1));
                }
                shadows
            });
            let [a, b] = &mut shadows;
            found.extend([shared_volume(a, b, None), shared_volume(b, a, None)]);
        }
        found
    }

    fn by_planes([(body, at), (knife, there)]: [(&Polyhedron, &Pose); 2]) -> f64 {
        let mut clipper = Clipper::default();
        clipper.load(body, &(there.inverse() * at));
        for i in 0..knife.face_count() {
            clipper.clip(&knife.face_normal(i), knife.face_offset(i));
        }
        clipper.volume()
    }

    fn pose() -> impl Strategy<Value = Pose> {
        let vector = |size: f64| prop::array::uniform3(-size..size).prop_map(Vector3::from);
        (vector(0.8), vector(3.0)).prop_map(|(place, turn)| Pose::new(place, turn))
    }

    proptest! {
        #[test]
        fn prisms_agree_with_planes(a in pose(), b in pose()) {
            for [first, second] in [["P1", "P5"], ["A10", "P4"], ["P2", "A12"]] {
                let (first, second) = (solid(first), solid(second));
                let bodies = [(&first, &a), (&second, &b)];
                let expected = by_planes(bodies);
                for found in by_prisms(bodies) {
                    prop_assert!((found - expected).abs() < 1e-13, "{found} {expected}");
                }
            }
        }
    }

    /// Faces along the axes, at the same heights, edges over edges: everything that can coincide does.
    #[test]
    fn bodies_in_step_with_the_axes() {
        let shapes = [solid("P5"), solid("P4"), solid("A2")];
        let steps = [0.0, 0.5, 1.0, 1.0 / 3_f64.sqrt()];
        let quarter = Rotation::from_scaled_axis(Vector3::y() * std::f64::consts::FRAC_PI_2);
        for (i, first) in shapes.iter().enumerate() {
            for second in &shapes[i..] {
                for (x, z) in steps.iter().flat_map(|x| steps.map(|z| (*x, z))) {
                    let there = Pose::translation(x, 0.0, z)
                        * Pose::from_parts(Default::default(), quarter);
                    let bodies = [(first, &Pose::identity()), (second, &there)];
                    let expected = by_planes(bodies);
                    for found in by_prisms(bodies) {
                        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
                    }
                }
            }
        }
    }

    /// The part of a clipped surface can be used like any body.
    #[test]
    fn a_clipped_surface_can_be_one_of_the_two() {
        let (body, cube) = (solid("A10"), solid("P5"));
        let mut clipper = Clipper::default();
        clipper.load(&body, &Pose::identity());
        clipper.clip(&Vector3::new(0.6, 0.0, 0.8), 0.2);
        let mut rest = Shadows::default();
        clipper.each_triangle(|t| rest.push(&t, 1, &Point3::origin()));
        let there = Pose::translation(0.4, 0.3, 0.2);
        let mut other = Shadows::default();
        for t in cube.triangles() {
            let triangle = t.map(|v| there * cube.vertices()[v as usize]);
            other.push(&triangle, 1, &Point3::origin());
        }
        let found = shared_volume(&mut other, &mut rest, None);
        clipper.transform(&there.inverse());
        for i in 0..6 {
            clipper.clip(&cube.face_normal(i), cube.face_offset(i));
        }
        assert!(
            (found - clipper.volume()).abs() < 1e-14 && found > 0.1,
            "{found}"
        );
    }
}
