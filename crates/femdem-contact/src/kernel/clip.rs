//! Plane polygons in coordinates of their own plane: cuts by lines, exact integrals.
//!
//! A facet and everything it is cut by lie in one plane, so the kernel works there in two
//! coordinates: half the arithmetic of three, and no out-of-plane round-off.

/// A point in the plane of a facet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Point {
    pub x: f64,
    pub y: f64,
}

/// A function linear in the plane, c - a x - b y. As a half-plane, what is at least 0.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Line {
    pub a: f64,
    pub b: f64,
    pub c: f64,
}

impl Line {
    #[inline]
    pub fn at(&self, p: &Point) -> f64 {
        self.c - self.a * p.x - self.b * p.y
    }

    /// This function minus another.
    #[inline]
    pub fn minus(&self, other: &Self) -> Self {
        Self {
            a: self.a - other.a,
            b: self.b - other.b,
            c: self.c - other.c,
        }
    }

    /// The opposite half-plane.
    #[inline]
    pub fn flipped(&self) -> Self {
        Self {
            a: -self.a,
            b: -self.b,
            c: -self.c,
        }
    }
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

/// Two polygon buffers and the vertex depths, reused from call to call.
#[derive(Debug, Default)]
pub(crate) struct Clipper {
    polygon: Vec<Point>,
    spare: Vec<Point>,
    depths: Vec<f64>,
}

impl Clipper {
    pub fn load(&mut self, polygon: &[Point]) {
        self.polygon.clear();
        self.polygon.extend_from_slice(polygon);
    }

    pub fn polygon(&self) -> &[Point] {
        &self.polygon
    }

    /// Cuts a polygon that lies elsewhere into the buffer; loads it if it is whole.
    pub fn load_cut(&mut self, polygon: &[Point], by: &Line) -> Cut {
        let cut = cut_into(polygon, by, &mut self.depths, &mut self.polygon);
        if cut == Cut::Whole {
            self.load(polygon);
        }
        cut
    }

    /// Cuts the polygon in the buffer.
    pub fn cut(&mut self, by: &Line) -> Cut {
        let cut = cut_into(&self.polygon, by, &mut self.depths, &mut self.spare);
        if cut == Cut::Part {
            std::mem::swap(&mut self.polygon, &mut self.spare);
        }
        cut
    }

    /// Cuts the polygon in the buffer by all lines; false if nothing is left.
    pub fn cut_all<'a>(&mut self, by: impl IntoIterator<Item = &'a Line>) -> bool {
        by.into_iter().all(|h| self.cut(h) != Cut::Empty)
    }
}

/// Clips a convex polygon. The vertices that stay form one cyclic run, because the
/// polygon is convex; two new vertices close it.
#[inline]
pub(crate) fn cut_into(
    polygon: &[Point],
    by: &Line,
    depths: &mut Vec<f64>,
    out: &mut Vec<Point>,
) -> Cut {
    let n = polygon.len();
    depths.clear();
    depths.extend(polygon.iter().map(|p| by.at(p)));
    let inside = depths.iter().filter(|d| **d >= 0.0).count();
    if inside == n {
        return Cut::Whole;
    }
    if inside == 0 {
        return Cut::Empty;
    }
    close_run(polygon, depths, inside, out);
    Cut::Part
}

/// Writes the run of `inside` vertices with depth >= 0 and the two points that close it.
pub(crate) fn close_run(polygon: &[Point], depths: &[f64], inside: usize, out: &mut Vec<Point>) {
    let n = polygon.len();
    // First vertex of the run: inside, with its predecessor outside.
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
    let stay = |range: &[f64]| range.iter().all(|d| *d >= 0.0);
    let one_run = if first <= last {
        stay(&depths[first..=last])
    } else {
        stay(&depths[first..]) && stay(&depths[..=last])
    };
    if !one_run {
        edge_by_edge(polygon, depths, out);
        return;
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
}

/// The clip when a line through several vertices splits them into more than one run by
/// round-off (Sutherland and Hodgman 1974).
#[cold]
fn edge_by_edge(polygon: &[Point], depths: &[f64], out: &mut Vec<Point>) {
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
fn crossing(out: &Point, inside: &Point, d_out: f64, d_in: f64) -> Point {
    let t = d_in / (d_in - d_out);
    Point {
        x: inside.x + (out.x - inside.x) * t,
        y: inside.y + (out.y - inside.y) * t,
    }
}

/// Integrals over one polygon, about an origin in its plane, of a field linear over it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PolygonIntegrals {
    /// Area, m^2.
    pub area: f64,
    /// Integral of x dS and y dS.
    pub moment: Point,
    /// Integral of (x^2 + y^2) dS.
    pub second: f64,
    /// Integral of phi dS.
    pub pressure: f64,
    /// Integral of x phi dS and y phi dS.
    pub pressure_moment: Point,
    /// Integral of (x^2 + y^2) phi dS.
    pub pressure_second: f64,
}

/// Exact integrals over a counter-clockwise polygon.
#[inline]
pub(crate) fn integrate(polygon: &[Point], origin: &Point, field: &Line) -> PolygonIntegrals {
    let mut sum = PolygonIntegrals::default();
    if polygon.len() < 3 {
        return sum;
    }
    // x, y, phi and x^2 + y^2 of a vertex.
    let at = |p: &Point| {
        let (x, y) = (p.x - origin.x, p.y - origin.y);
        [x, y, field.at(p), x * x + y * y]
    };
    let a = at(&polygon[0]);
    let mut b = at(&polygon[1]);
    for p in &polygon[2..] {
        let c = at(p);
        let t = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        let s: [f64; 4] = std::array::from_fn(|k| a[k] + b[k] + c[k]);
        // Sums of phi x, phi y, phi r^2 over the vertices.
        let w: [f64; 4] = std::array::from_fn(|k| a[2] * a[k] + b[2] * b[k] + c[2] * c[k]);
        let squares = s[0] * s[0] + s[1] * s[1] + s[3];
        let (t3, t12) = (t * (1.0 / 3.0), t * (1.0 / 12.0));
        sum.area += t;
        sum.moment.x += s[0] * t3;
        sum.moment.y += s[1] * t3;
        sum.second += t12 * squares;
        sum.pressure += t3 * s[2];
        sum.pressure_moment.x += t12 * (s[0] * s[2] + w[0]);
        sum.pressure_moment.y += t12 * (s[1] * s[2] + w[1]);
        let cross = 2.0 * (w[0] * s[0] + w[1] * s[1] + w[3]);
        sum.pressure_second += t * (1.0 / 60.0) * (s[2] * squares + cross);
        b = c;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Point> {
        [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]
            .iter()
            .map(|p| Point { x: p[0], y: p[1] })
            .collect()
    }

    const X: Line = Line {
        a: -1.0,
        b: 0.0,
        c: 0.0,
    };

    #[test]
    fn a_corner_cut_keeps_five_vertices_and_the_right_area() {
        let mut clipper = Clipper::default();
        clipper.load(&square());
        let by = Line {
            a: 1.0,
            b: 1.0,
            c: 3.0,
        };
        assert_eq!(clipper.cut(&by), Cut::Part);
        assert_eq!(clipper.polygon().len(), 5);
        let area = integrate(clipper.polygon(), &Point::default(), &by).area;
        assert!((area - 3.5).abs() < 1e-15);
    }

    #[test]
    fn lines_that_miss_and_lines_that_take_all() {
        let mut clipper = Clipper::default();
        clipper.load(&square());
        let far = |c| Line { a: 1.0, b: 0.0, c };
        assert_eq!(clipper.cut(&far(2.0)), Cut::Whole);
        assert_eq!(clipper.cut(&far(-1e-9)), Cut::Empty);
    }

    /// Depths that alternate in sign by round-off must not lose the rest of the polygon.
    #[test]
    fn two_runs_of_round_off_keep_the_polygon() {
        let polygon = square();
        let depths = [1.0, -1e-18, 1e-18, 1.0];
        let mut out = Vec::new();
        close_run(&polygon, &depths, 3, &mut out);
        let area = integrate(&out, &Point::default(), &X).area;
        assert!((area - 4.0).abs() < 1e-12, "{area}");
        let depths = [1.0, -1e-18, 1.0, -1e-18];
        close_run(&polygon, &depths, 2, &mut out);
        let area = integrate(&out, &Point::default(), &X).area;
        assert!((area - 4.0).abs() < 1e-12, "{area}");
    }

    /// Closed forms over the square [0,2]^2 with phi = x:
    /// area 4, int phi = 4, int x phi = 16/3, int y phi = 4, int r^2 = 32/3, int r^2 phi = 40/3.
    #[test]
    fn integrals_of_a_linear_field_over_a_square() {
        let s = integrate(&square(), &Point::default(), &X);
        let close = |got: f64, want: f64| assert!((got - want).abs() < 1e-13, "{got} {want}");
        close(s.area, 4.0);
        close(s.pressure, 4.0);
        close(s.pressure_moment.x, 16.0 / 3.0);
        close(s.pressure_moment.y, 4.0);
        close(s.second, 32.0 / 3.0);
        close(s.pressure_second, 40.0 / 3.0);
        close(s.moment.x, 4.0);
        close(s.moment.y, 4.0);
    }
}
