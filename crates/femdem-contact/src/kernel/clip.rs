//! Clipping of convex polygons by half-spaces, and exact integrals over them.

use femdem_mesh::Vector3;

/// A half-space {x : offset - normal.x >= 0}; `normal` need not be unit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfSpace {
    pub normal: Vector3,
    pub offset: f64,
}

impl HalfSpace {
    /// Depth below the bounding plane; negative outside.
    #[inline]
    pub fn depth(&self, x: &Vector3) -> f64 {
        self.offset - self.normal.dot(x)
    }
}

/// Two polygon buffers and the vertex depths, reused from call to call.
#[derive(Debug, Default)]
pub(crate) struct Clipper {
    polygon: Vec<Vector3>,
    spare: Vec<Vector3>,
    depths: Vec<f64>,
}

/// What a cut left of the polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Nothing was cut away.
    Whole,
    /// The result is in the output buffer.
    Part,
    /// Nothing is left.
    Empty,
}

impl Clipper {
    pub fn load(&mut self, polygon: &[Vector3]) {
        self.polygon.clear();
        self.polygon.extend_from_slice(polygon);
    }

    pub fn polygon(&self) -> &[Vector3] {
        &self.polygon
    }

    /// Cuts a polygon that lies elsewhere into the buffer; loads it if it is whole.
    pub fn load_cut(&mut self, polygon: &[Vector3], by: &HalfSpace) -> Cut {
        let cut = cut_into(polygon, by, &mut self.depths, &mut self.polygon);
        if cut == Cut::Whole {
            self.load(polygon);
        }
        cut
    }

    /// Cuts the polygon in the buffer.
    pub fn cut(&mut self, by: &HalfSpace) -> Cut {
        let cut = cut_into(&self.polygon, by, &mut self.depths, &mut self.spare);
        if cut == Cut::Part {
            std::mem::swap(&mut self.polygon, &mut self.spare);
        }
        cut
    }

    /// Cuts the polygon in the buffer by all half-spaces; false if nothing is left.
    pub fn cut_all<'a>(&mut self, by: impl IntoIterator<Item = &'a HalfSpace>) -> bool {
        by.into_iter().all(|h| self.cut(h) != Cut::Empty)
    }
}

/// Clips a convex polygon. The vertices that stay form one cyclic run, because the
/// polygon is convex; two new vertices close it.
#[inline]
pub(crate) fn cut_into(
    polygon: &[Vector3],
    by: &HalfSpace,
    depths: &mut Vec<f64>,
    out: &mut Vec<Vector3>,
) -> Cut {
    let n = polygon.len();
    depths.clear();
    depths.extend(polygon.iter().map(|x| by.depth(x)));
    let inside = depths.iter().filter(|d| **d >= 0.0).count();
    if inside == n {
        return Cut::Whole;
    }
    if inside == 0 {
        return Cut::Empty;
    }
    // First vertex of the run that stays: inside, with its predecessor outside.
    let previous = |i: usize| if i == 0 { n - 1 } else { i - 1 };
    let mut first = 0;
    while !(depths[first] >= 0.0 && depths[previous(first)] < 0.0) {
        first += 1;
    }
    let before = previous(first);
    let mut last = first + inside - 1;
    if last >= n {
        last -= n;
    }
    let after = if last + 1 == n { 0 } else { last + 1 };
    out.clear();
    let one_run = depths[last] >= 0.0
        && depths[after] < 0.0
        && run(first, last, n).all(|i| depths[i] >= 0.0);
    if !one_run {
        edge_by_edge(polygon, depths, out);
        return Cut::Part;
    }
    out.push(crossing(
        &polygon[before],
        &polygon[first],
        depths[before],
        depths[first],
    ));
    if first <= last {
        out.extend_from_slice(&polygon[first..=last]);
    } else {
        out.extend_from_slice(&polygon[first..]);
        out.extend_from_slice(&polygon[..=last]);
    }
    out.push(crossing(
        &polygon[after],
        &polygon[last],
        depths[after],
        depths[last],
    ));
    Cut::Part
}

/// The cyclic indices from `first` to `last`.
#[inline]
fn run(first: usize, last: usize, n: usize) -> impl Iterator<Item = usize> {
    let length = if last >= first {
        last - first + 1
    } else {
        n - first + last + 1
    };
    (0..length).map(move |k| if first + k < n { first + k } else { first + k - n })
}

/// The clip when a plane through several vertices splits them into more than one run by
/// round-off (Sutherland and Hodgman 1974).
#[cold]
fn edge_by_edge(polygon: &[Vector3], depths: &[f64], out: &mut Vec<Vector3>) {
    for (i, x) in polygon.iter().enumerate() {
        let j = if i + 1 == polygon.len() { 0 } else { i + 1 };
        let (d, e, y) = (depths[i], depths[j], &polygon[j]);
        if d >= 0.0 {
            out.push(*x);
            if e < 0.0 {
                out.push(crossing(y, x, e, d));
            }
        } else if e >= 0.0 {
            out.push(crossing(x, y, d, e));
        }
    }
}

/// The point of the edge where the depth vanishes; `d_out < 0 <= d_in`.
#[inline]
fn crossing(out: &Vector3, inside: &Vector3, d_out: f64, d_in: f64) -> Vector3 {
    let t = d_in / (d_in - d_out);
    inside + (out - inside) * t
}

/// Integrals over one planar convex polygon, relative to an origin, of a field
/// that is linear over it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PolygonIntegrals {
    /// Area, m^2.
    pub area: f64,
    /// Integral of x dS.
    pub moment: Vector3,
    /// Integral of |x|^2 dS.
    pub second: f64,
    /// Integral of phi dS.
    pub pressure: f64,
    /// Integral of x phi dS.
    pub pressure_moment: Vector3,
    /// Integral of |x|^2 phi dS.
    pub pressure_second: f64,
}

/// Exact integrals over a polygon with unit normal `normal`; phi = depth * scale.
#[inline]
pub(crate) fn integrate(
    polygon: &[Vector3],
    normal: &Vector3,
    origin: &Vector3,
    field: &HalfSpace,
    scale: f64,
) -> PolygonIntegrals {
    let mut sum = PolygonIntegrals::default();
    if polygon.len() < 3 {
        return sum;
    }
    let at = |x: &Vector3| (x - origin, field.depth(x) * scale);
    let (a, phi_a) = at(&polygon[0]);
    let (mut b, mut phi_b) = at(&polygon[1]);
    let aa = a.norm_squared();
    let mut bb = b.norm_squared();
    for x in &polygon[2..] {
        let (c, phi_c) = at(x);
        let cc = c.norm_squared();
        let t = 0.5 * normal.dot(&(b - a).cross(&(c - a)));
        let s = a + b + c;
        let squares = s.norm_squared() + aa + bb + cc;
        let phi = phi_a + phi_b + phi_c;
        let weighted = a * phi_a + b * phi_b + c * phi_c;
        let weighted_squares = aa * phi_a + bb * phi_b + cc * phi_c;
        sum.area += t;
        sum.moment += s * (t / 3.0);
        sum.second += t / 12.0 * squares;
        sum.pressure += t / 3.0 * phi;
        sum.pressure_moment += (s * phi + weighted) * (t / 12.0);
        sum.pressure_second +=
            t / 60.0 * (phi * squares + 2.0 * weighted.dot(&s) + 2.0 * weighted_squares);
        (b, phi_b, bb) = (c, phi_c, cc);
    }
    sum
}

/// Integral of x dS over a polygon, relative to an origin, and the area.
pub(crate) fn area_moment(
    polygon: &[Vector3],
    normal: &Vector3,
    origin: &Vector3,
) -> (Vector3, f64) {
    let mut sum = (Vector3::zeros(), 0.0);
    let Some((first, rest)) = polygon.split_first() else {
        return sum;
    };
    let a = first - origin;
    for pair in rest.windows(2) {
        let (b, c) = (pair[0] - origin, pair[1] - origin);
        let t = 0.5 * normal.dot(&(b - a).cross(&(c - a)));
        sum.0 += (a + b + c) * (t / 3.0);
        sum.1 += t;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vector3> {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]
            .iter()
            .map(|p| Vector3::new(p[0], p[1], 0.0))
            .collect()
    }

    #[test]
    fn a_corner_cut_keeps_five_vertices_and_the_right_area() {
        let mut clipper = Clipper::default();
        clipper.load(&square());
        let by = HalfSpace {
            normal: Vector3::new(1.0, 1.0, 0.0),
            offset: 3.0,
        };
        assert_eq!(clipper.cut(&by), Cut::Part);
        assert_eq!(clipper.polygon().len(), 5);
        let area = integrate(
            clipper.polygon(),
            &Vector3::z(),
            &Vector3::zeros(),
            &by,
            1.0,
        )
        .area;
        assert!((area - 3.5).abs() < 1e-15);
    }

    #[test]
    fn planes_that_miss_and_planes_that_take_all() {
        let mut clipper = Clipper::default();
        clipper.load(&square());
        let far = |offset| HalfSpace {
            normal: Vector3::x(),
            offset,
        };
        assert_eq!(clipper.cut(&far(2.0)), Cut::Whole);
        assert_eq!(clipper.cut(&far(-1e-9)), Cut::Empty);
    }

    /// Closed forms over the square [0,2]^2 with phi = x (depth of the half-space -x <= 0):
    /// area 4, int phi = 4, int x phi = 16/3, int y phi = 4, int r^2 = 32/3, int r^2 phi = 40/3.
    #[test]
    fn integrals_of_a_linear_field_over_a_square() {
        let field = HalfSpace {
            normal: -Vector3::x(),
            offset: 0.0,
        };
        let s = integrate(&square(), &Vector3::z(), &Vector3::zeros(), &field, 1.0);
        assert!((s.area - 4.0).abs() < 1e-14);
        assert!((s.pressure - 4.0).abs() < 1e-14);
        assert!((s.pressure_moment - Vector3::new(16.0 / 3.0, 4.0, 0.0)).norm() < 1e-13);
        assert!((s.second - 32.0 / 3.0).abs() < 1e-13);
        assert!((s.pressure_second - 40.0 / 3.0).abs() < 1e-13);
        assert!((s.moment - Vector3::new(4.0, 4.0, 0.0)).norm() < 1e-13);
    }
}
