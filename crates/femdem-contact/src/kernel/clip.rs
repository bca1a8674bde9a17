//! Plane polygons in coordinates of their own plane: cuts by lines, exact integrals.
//!
//! A facet and all lines that cut it lie in one plane, so the kernel works there in two coordinates: half the
//! arithmetic of three, and no out-of-plane round-off.

/// A point in the plane of a facet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Point {
    pub x: f64,
    pub y: f64,
}

/// A function linear in the plane, c - a x - b y. As a half-plane, the points where it is at least 0.
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

/// Result of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    /// Nothing was cut away.
    Whole,
    /// The result is in the output buffer.
    Part,
    /// Nothing is left.
    Empty,
}

/// Two polygon buffers, reused from call to call.
#[derive(Debug, Default)]
pub(crate) struct Clipper {
    polygon: Vec<Point>,
    spare: Vec<Point>,
}

impl Clipper {
    pub fn load(&mut self, polygon: &[Point]) {
        self.polygon.clear();
        self.polygon.extend_from_slice(polygon);
    }

    pub fn polygon(&self) -> &[Point] {
        &self.polygon
    }

    /// Cuts the polygon in the buffer.
    #[inline]
    pub fn cut(&mut self, by: &Line) -> Cut {
        let cut = cut_into(&self.polygon, by, &mut self.spare);
        if cut == Cut::Part {
            std::mem::swap(&mut self.polygon, &mut self.spare);
        }
        cut
    }
}

/// Clips a convex polygon. Edge by edge (Sutherland and Hodgman 1974), so that a line
/// through several vertices, whose depths differ in sign by round-off, loses nothing.
#[inline]
pub(crate) fn cut_into(polygon: &[Point], by: &Line, out: &mut Vec<Point>) -> Cut {
    let (mut inside, mut outside) = (false, false);
    for p in polygon {
        let d = by.at(p);
        inside |= d >= 0.0;
        outside |= d < 0.0;
    }
    if !outside {
        return Cut::Whole;
    }
    if !inside {
        return Cut::Empty;
    }
    out.clear();
    let mut p = &polygon[polygon.len() - 1];
    let mut dp = by.at(p);
    for q in polygon {
        let dq = by.at(q);
        if (dq >= 0.0) != (dp >= 0.0) {
            out.push(crossing_of(p, q, dp, dq));
        }
        if dq >= 0.0 {
            out.push(*q);
        }
        (p, dp) = (q, dq);
    }
    Cut::Part
}

/// Splits a convex polygon into the part where `by` is at least 0 and the part where it is
/// at most 0.
pub(crate) fn split_into(
    polygon: &[Point],
    by: &Line,
    above: &mut Vec<Point>,
    below: &mut Vec<Point>,
) {
    above.clear();
    below.clear();
    let Some(mut p) = polygon.last() else {
        return;
    };
    let mut dp = by.at(p);
    for q in polygon {
        let dq = by.at(q);
        if (dq >= 0.0) != (dp >= 0.0) {
            let x = crossing_of(p, q, dp, dq);
            above.push(x);
            below.push(x);
        }
        if dq >= 0.0 {
            above.push(*q);
        } else {
            below.push(*q);
        }
        (p, dp) = (q, dq);
    }
}

/// The point of the edge from `inside` to `out` where the depth vanishes; the depths differ
/// in sign. Taken from the inner end, so that both pieces of a split get the same bits.
#[inline]
pub(crate) fn crossing(inside: &Point, out: &Point, d_in: f64, d_out: f64) -> Point {
    let t = d_in / (d_in - d_out);
    Point {
        x: inside.x + (out.x - inside.x) * t,
        y: inside.y + (out.y - inside.y) * t,
    }
}

/// As [`crossing`], with the inner end at either.
#[inline]
pub(crate) fn crossing_of(p: &Point, q: &Point, dp: f64, dq: f64) -> Point {
    if dp >= 0.0 {
        crossing(p, q, dp, dq)
    } else {
        crossing(q, p, dq, dp)
    }
}

/// Second moments in a plane: of x^2, of x y and of y^2.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Second {
    pub xx: f64,
    pub xy: f64,
    pub yy: f64,
}

impl Second {
    /// Adds `weight` times another.
    #[inline(always)]
    pub fn add(&mut self, other: &Self, weight: f64) {
        self.xx += weight * other.xx;
        self.xy += weight * other.xy;
        self.yy += weight * other.yy;
    }
}

/// Integrals over one polygon, about an origin in its plane, of a field linear over it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct PolygonIntegrals {
    /// Area, m^2.
    pub area: f64,
    /// Integral of x dS and y dS.
    pub moment: Point,
    /// Integrals of x^2 dS, x y dS and y^2 dS.
    pub second: Second,
    /// Integral of phi dS.
    pub pressure: f64,
    /// Integral of x phi dS and y phi dS.
    pub pressure_moment: Point,
    /// Integral of (x^2 + y^2) phi dS.
    pub pressure_second: f64,
}

/// x, y, x^2, y^2, x y, x r^2 and y r^2 of a point, r^2 = x^2 + y^2.
#[derive(Clone, Copy)]
struct Powers {
    first: [f64; 2],
    squares: [f64; 2],
    product: f64,
    cubes: [f64; 2],
}

impl Powers {
    #[inline(always)]
    fn new(x: f64, y: f64) -> Self {
        let squares = [x * x, y * y];
        let square = squares[0] + squares[1];
        Self {
            first: [x, y],
            squares,
            product: x * y,
            cubes: [x * square, y * square],
        }
    }
}

/// Exact integrals over a counter-clockwise polygon: fan triangles about the first vertex,
/// then a shift of the moments to the origin.
///
/// A power of degree m over the triangle from 0 to b and c is 2 T / (m + 2) times its mean
/// over the edge from b to c, and that mean is Simpson's up to degree 3: exact with the
/// values at b, c and (b + c) / 2.
#[inline(always)]
pub(crate) fn integrate(polygon: &[Point], origin: &Point, field: &Line) -> PolygonIntegrals {
    let Some((a, rest)) = polygon.split_first() else {
        return PolygonIntegrals::default();
    };
    let mut corners = rest.iter().map(|p| Powers::new(p.x - a.x, p.y - a.y));
    let Some(mut b) = corners.next() else {
        return PolygonIntegrals::default();
    };
    let (mut area, mut product) = (0.0, 0.0);
    let (mut first, mut squares, mut cubes) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    for c in corners {
        let t = b.first[0] * c.first[1] - b.first[1] * c.first[0];
        let s = Powers::new(b.first[0] + c.first[0], b.first[1] + c.first[1]);
        area += t;
        product += t * (b.product + c.product + s.product);
        for i in 0..2 {
            first[i] += t * s.first[i];
            squares[i] += t * (b.squares[i] + c.squares[i] + s.squares[i]);
            cubes[i] += t * (b.cubes[i] + c.cubes[i] + 0.5 * s.cubes[i]);
        }
        b = c;
    }
    let area = 0.5 * area;
    let first = first.map(|m| m * (1.0 / 6.0));
    let squares = squares.map(|m| m * (1.0 / 24.0));
    let cubes = cubes.map(|m| m * (1.0 / 30.0));
    let product = product * (1.0 / 24.0);
    let second = squares[0] + squares[1];
    let phi = field.at(a);
    PolygonIntegrals {
        area,
        moment: Point {
            x: first[0],
            y: first[1],
        },
        second: Second {
            xx: squares[0],
            xy: product,
            yy: squares[1],
        },
        pressure: phi * area - field.a * first[0] - field.b * first[1],
        pressure_moment: Point {
            x: phi * first[0] - field.a * squares[0] - field.b * product,
            y: phi * first[1] - field.a * product - field.b * squares[1],
        },
        pressure_second: phi * second - field.a * cubes[0] - field.b * cubes[1],
    }
    .shifted(a.x - origin.x, a.y - origin.y)
}

/// Integrals over a polygon in a gauge field that sum to the energy and the volume of an overlap.
///
/// The field is phi = 1 - g about its centre c, with g homogeneous of degree 1 in x - c and 1 on the body's
/// skin. The vector fields
///
/// (x - c) (1/3 - g/4 - 1/(12 g^3)) and (x - c) (1/3 - 1/(3 g^3))
///
/// have the divergences phi and 1 away from c, where they are sources of strength -V/4 and -V, V the body's
/// volume; and they vanish on its skin. The integrals of phi and of 1 over the part of the body on the inner
/// side of some polygons are therefore the sums over the polygons of s = n.(x - c) times the integrals of the
/// brackets, plus V/4 and V if c is in that part. What vanishes with phi is never a difference of large
/// numbers, so that faces that coincide add nothing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Brackets {
    /// Integral of 1/3 - g/4 - 1/(12 g^3), m^2.
    pub energy: f64,
    /// Integral of 1/3 - 1/(3 g^3), m^2.
    pub volume: f64,
}

impl Brackets {
    /// Over a counter-clockwise polygon with a field linear over it. Over a triangle of area T with the
    /// values g_1, g_2, g_3 at its corners, int g^-3 dS = T/(g_1 g_2 g_3).
    #[inline(always)]
    pub fn new(polygon: &[Point], field: &Line) -> Self {
        let mut sums = Self::default();
        let Some((a, rest)) = polygon.split_first() else {
            return sums;
        };
        let at_a = field.at(a);
        let mut corners = rest.iter().map(|p| (p.x - a.x, p.y - a.y, field.at(p)));
        let Some(mut b) = corners.next() else {
            return sums;
        };
        for c in corners {
            let t = b.0 * c.1 - b.1 * c.0;
            // Elementary symmetric functions of phi: g_1 g_2 g_3 = 1 - e1 + e2 - e3.
            let (sum, product) = (b.2 + c.2, b.2 * c.2);
            let e1 = at_a + sum;
            let e2 = at_a * sum + product;
            let e3 = at_a * product;
            let lost = e1 - e2 + e3;
            // Not 1 - lost, which has no digits near the centre of the field.
            let weight = t / ((1.0 - at_a) * (1.0 - b.2) * (1.0 - c.2));
            sums.energy += weight * (e2 - e3 - e1 * lost);
            sums.volume -= weight * lost;
            b = c;
        }
        sums.energy *= 1.0 / 24.0;
        sums.volume *= 1.0 / 6.0;
        sums
    }

    /// Adds `other` times `factor`.
    #[inline(always)]
    pub fn add(&mut self, other: &Self, factor: f64) {
        self.energy += other.energy * factor;
        self.volume += other.volume * factor;
    }
}

impl PolygonIntegrals {
    /// The same integrals about an origin from which the old one lies at (x, y).
    #[inline]
    pub(crate) fn shifted(mut self, x: f64, y: f64) -> Self {
        let square = x * x + y * y;
        self.second.xx += x * (2.0 * self.moment.x + x * self.area);
        self.second.xy += x * self.moment.y + y * (self.moment.x + x * self.area);
        self.second.yy += y * (2.0 * self.moment.y + y * self.area);
        self.pressure_second += 2.0 * (x * self.pressure_moment.x + y * self.pressure_moment.y)
            + square * self.pressure;
        self.moment.x += x * self.area;
        self.moment.y += y * self.area;
        self.pressure_moment.x += x * self.pressure;
        self.pressure_moment.y += y * self.pressure;
        self
    }
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

    /// A line along a diagonal through two vertices, off by round-off in any direction,
    /// leaves half of the square on either side.
    #[test]
    fn a_cut_through_vertices_is_not_confused_by_round_off() {
        for tilt in [-1e-17, 0.0, 1e-17, 3e-16] {
            let by = Line {
                a: 1.0 + tilt,
                b: -1.0,
                c: tilt,
            };
            let (mut above, mut below, mut cut) = (Vec::new(), Vec::new(), Vec::new());
            split_into(&square(), &by, &mut above, &mut below);
            let area = |p: &[Point]| integrate(p, &Point::default(), &X).area;
            assert!((area(&above) - 2.0).abs() < 1e-12);
            assert!((area(&below) - 2.0).abs() < 1e-12);
            assert_eq!(cut_into(&square(), &by, &mut cut), Cut::Part);
            assert!((area(&cut) - 2.0).abs() < 1e-12);
        }
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
        close(s.second.xx, 16.0 / 3.0);
        close(s.second.xy, 4.0);
        close(s.second.yy, 16.0 / 3.0);
        close(s.pressure_second, 40.0 / 3.0);
        close(s.moment.x, 4.0);
        close(s.moment.y, 4.0);
    }
}
