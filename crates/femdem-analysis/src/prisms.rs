//! Volume shared by two closed surfaces of any form: signed prisms.
//!
//! Look along an axis `w`. A point lies in a closed surface when the triangles below it, each counted
//! `+1` where the line upwards enters and `-1` where it leaves, sum to 1; the same holds for the
//! triangles above it with the signs changed. Take the first way for a body `L` and the second for a
//! body `U`: the product of the two sums, integrated over space, is
//!
//! `V(L ∩ U) = - sum_ij s_i s_j ∫ max(w_j - w_i, 0) du dv`  over where the triangles `i` of `L` and
//! `j` of `U` lie over one another, with `s` the sign of the outward normal's component along `w`.
//!
//! Every term is continuous in the corners (a triangle seen edge-on has no area), so nothing has to be
//! decided and coinciding or touching faces are no special case. The sum is right for every closed
//! surface, convex or not, in one part or more. Only triangles of `L` below the top of `U` and of `U`
//! above the bottom of `L` have a part in it.

use femdem_mesh::{Point3, Vector3};

/// Most corners of a triangle cut by three lines, and by one more.
const CORNERS: usize = 7;

/// A triangle seen along an axis.
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

    /// Height over `p`, which lies in the triangle but for round-off: steep triangles must not make
    /// more of that than their own height.
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
    /// Starts anew.
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

/// Volume shared by the body of which `lower` holds the triangles below the top of the other, and
/// the body of which `upper` holds those above the bottom of the first. Same axis and origin.
pub(crate) fn shared_volume(lower: &mut Shadows, upper: &mut Shadows) -> f64 {
    upper.sort();
    lower.sort();
    let mut volume = 0.0;
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
                volume -= i.sign * j.sign * between(i, j);
            }
        }
    }
    volume
}

/// Volume over `lower` and under `upper`.
fn between(lower: &Shadow, upper: &Shadow) -> f64 {
    let mut common = Polygon::default();
    for corner in lower.corners {
        common.push([corner[0], corner[1], 0.0]);
    }
    for k in 0..3 {
        let (a, b) = (upper.corners[k], upper.corners[(k + 1) % 3]);
        let inside = |p: &[f64; 3]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        common = common.cut(inside);
    }
    for point in common.points_mut() {
        let at = [point[0], point[1]];
        point[2] = upper.height(at) - lower.height(at);
    }
    if lower.reach[1] > upper.reach[0] {
        common = common.cut(|p| p[2]);
    }
    common.volume()
}

/// A convex polygon in a plane with a value at each corner.
#[derive(Clone, Copy, Debug, Default)]
struct Polygon {
    points: [[f64; 3]; CORNERS],
    count: usize,
}

impl Polygon {
    fn push(&mut self, point: [f64; 3]) {
        // Round-off can make a cut meet a polygon's border more than twice; no corner is worth more
        // than round-off then.
        if let Some(place) = self.points.get_mut(self.count) {
            *place = point;
            self.count += 1;
        }
    }

    fn points(&self) -> &[[f64; 3]] {
        &self.points[..self.count]
    }

    fn points_mut(&mut self) -> &mut [[f64; 3]] {
        &mut self.points[..self.count]
    }

    /// The part where `inside` is not negative.
    fn cut(&self, inside: impl Fn(&[f64; 3]) -> f64) -> Self {
        let mut part = Self::default();
        let Some(mut last) = self.points().last() else {
            return part;
        };
        let mut before = inside(last);
        for point in self.points() {
            let now = inside(point);
            if (before < 0.0) != (now < 0.0) {
                let t = before / (before - now);
                part.push([0, 1, 2].map(|k| last[k] + t * (point[k] - last[k])));
            }
            if now >= 0.0 {
                part.push(*point);
            }
            (last, before) = (point, now);
        }
        part
    }

    /// Volume under the values.
    fn volume(&self) -> f64 {
        let Some((a, rest)) = self.points().split_first() else {
            return 0.0;
        };
        let six_volumes = |pair: &[[f64; 3]]| {
            let [b, c] = [pair[0], pair[1]];
            let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            twice_area * (a[2] + b[2] + c[2])
        };
        rest.windows(2).map(six_volumes).sum::<f64>() / 6.0
    }
}
