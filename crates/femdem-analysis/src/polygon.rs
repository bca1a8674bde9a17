//! Convex polygons in a plane, cut by lines and by a circle, and volumes over them.

/// Largest number of corners: a triangle cut by three lines, by a fourth, and by the two of a quadrant.
const CORNERS: usize = 9;

type Place = [f64; 2];

/// A convex polygon, counter-clockwise.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Polygon {
    points: [Place; CORNERS],
    count: usize,
}

impl Polygon {
    pub(crate) fn triangle(corners: &[Place; 3]) -> Self {
        let mut triangle = Self::default();
        corners.iter().for_each(|c| triangle.push(*c));
        triangle
    }

    fn push(&mut self, point: Place) {
        // By round-off a cut can meet a polygon's border more than twice; a corner dropped here changes the
        // result by round-off only.
        if let Some(place) = self.points.get_mut(self.count) {
            *place = point;
            self.count += 1;
        }
    }

    fn points(&self) -> &[Place] {
        &self.points[..self.count]
    }

    /// The sides, as pairs of points.
    fn sides(&self) -> impl Iterator<Item = (&Place, &Place)> {
        let points = self.points();
        points.iter().zip(points.iter().cycle().skip(1))
    }

    /// The part where `inside`, an affine function, is not negative.
    pub(crate) fn cut(&self, inside: impl Fn(&Place) -> f64) -> Self {
        let mut part = Self::default();
        for (p, q) in self.sides() {
            let (here, there) = (inside(p), inside(q));
            if here >= 0.0 {
                part.push(*p);
            }
            if (here < 0.0) != (there < 0.0) {
                part.push(between(p, q, here / (here - there)));
            }
        }
        part
    }

    /// Volume under the affine function `height`.
    pub(crate) fn volume(&self, height: impl Fn(Place) -> f64) -> f64 {
        fan(self.points().iter().copied(), &height)
    }

    /// The same over the part in a disc about the origin of coordinates.
    pub(crate) fn volume_in_disc(&self, radius: f64, height: impl Fn(Place) -> f64) -> f64 {
        let farthest = self
            .points()
            .iter()
            .map(|p| p[0].hypot(p[1]))
            .fold(0.0, f64::max);
        if farthest <= radius {
            return self.volume(height);
        }
        let gap = |k: usize| {
            let along = || self.points().iter().map(|p| p[k]);
            let (low, high) = (
                along().fold(f64::INFINITY, f64::min),
                along().fold(f64::NEG_INFINITY, f64::max),
            );
            low.max(-high).max(0.0)
        };
        if gap(0).hypot(gap(1)) >= radius {
            return 0.0;
        }
        // In a quadrant no arc is longer than a quarter turn, so that the angle between its ends determines it:
        // round-off cannot turn an arc of no length into a whole circle.
        let mut volume = 0.0;
        for (x, y) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)] {
            let quarter = self.cut(|p| x * p[0]).cut(|p| y * p[1]);
            volume += quarter.volume_in_quarter(radius, &height);
        }
        volume
    }

    /// For a polygon that lies in one quadrant.
    fn volume_in_quarter(&self, radius: f64, height: &impl Fn(Place) -> f64) -> f64 {
        // Where the sides enter and leave the disc, or begin and end in it.
        let mut rest = [[[0.0; 2]; 2]; CORNERS];
        let mut count = 0;
        for (p, q) in self.sides() {
            if let Some(inside) = part_in_circle(p, q, radius) {
                rest[count] = inside;
                count += 1;
            }
        }
        let rest = &rest[..count];
        let mut volume = fan(rest.as_flattened().iter().copied(), height);
        for ([_, leave], [enter, _]) in rest.iter().zip(rest.iter().cycle().skip(1)) {
            // An arc of no length where a corner lies inside.
            volume += segment_volume(leave, enter, radius, height);
        }
        volume
    }
}

fn between(p: &Place, q: &Place, t: f64) -> Place {
    [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
}

/// Volume under `height` over a convex polygon.
fn fan(points: impl Iterator<Item = Place>, height: &impl Fn(Place) -> f64) -> f64 {
    let mut points = points.map(|p| (p, height(p)));
    let (Some((a, over_a)), Some(mut last)) = (points.next(), points.next()) else {
        return 0.0;
    };
    let mut six_volumes = 0.0;
    for (c, over_c) in points {
        let (b, over_b) = last;
        let twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        six_volumes += twice_area * (over_a + over_b + over_c);
        last = (c, over_c);
    }
    six_volumes / 6.0
}

/// The part of the segment from `p` to `q` that lies in the circle; ends inside are unchanged.
fn part_in_circle(p: &Place, q: &Place, radius: f64) -> Option<[Place; 2]> {
    let d = [q[0] - p[0], q[1] - p[1]];
    let a = d[0] * d[0] + d[1] * d[1];
    if a == 0.0 {
        return None;
    }
    let b = p[0] * d[0] + p[1] * d[1];
    let c = p[0] * p[0] + p[1] * p[1] - radius * radius;
    let root = (b * b - a * c).max(0.0).sqrt();
    let [enter, leave] = [(-b - root) / a, (root - b) / a];
    let start = if enter > 0.0 {
        between(p, q, enter)
    } else {
        *p
    };
    let end = if leave < 1.0 {
        between(p, q, leave)
    } else {
        *q
    };
    (enter.max(0.0) < leave.min(1.0)).then_some([start, end])
}

/// Volume over the segment of the disc between the arc from `p` to `q` and its chord.
fn segment_volume(p: &Place, q: &Place, radius: f64, height: &impl Fn(Place) -> f64) -> f64 {
    let angle = (p[0] * q[1] - p[1] * q[0]).atan2(p[0] * q[0] + p[1] * q[1]);
    let square = angle * angle;
    // angle - sin(angle), by its series where the difference would lose digits.
    let excess = if square < 0.01 {
        let series = 1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0));
        angle * square / 6.0 * series
    } else {
        angle - angle.sin()
    };
    let middle = [p[0] + q[0], p[1] + q[1]];
    let length = middle[0].hypot(middle[1]);
    if excess == 0.0 || length == 0.0 {
        return 0.0;
    }
    let out = 4.0 * radius * (0.5 * angle).sin().powi(3) / (3.0 * excess * length);
    0.5 * radius * radius * excess * height([middle[0] * out, middle[1] * out])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The triangle counter-clockwise.
    fn turned([a, b, c]: [Place; 3]) -> [Place; 3] {
        if (b[0] - a[0]) * (c[1] - a[1]) < (b[1] - a[1]) * (c[0] - a[0]) {
            [a, c, b]
        } else {
            [a, b, c]
        }
    }

    /// Integral of `height` over triangle and disc by rows and columns of a fine grid.
    fn counted(corners: &[Place; 3], radius: f64, height: impl Fn(Place) -> f64) -> f64 {
        let (cells, mut sum) = (400, 0.0);
        let step = 2.0 * radius / f64::from(cells);
        for i in 0..cells * cells {
            let p = [i % cells, i / cells].map(|k| (f64::from(k) + 0.5) * step - radius);
            let turn = |k: usize| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
            };
            if p[0].hypot(p[1]) < radius && (0..3).all(|k| turn(k) > 0.0) {
                sum += height(p) * step * step;
            }
        }
        sum
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn disc_and_triangle_against_counting(corners in prop::array::uniform3(prop::array::uniform2(-2.0..2.0_f64))) {
            let corners = turned(corners);
            let height = |p: Place| 1.0 + 0.4 * p[0] - 0.3 * p[1];
            let found = Polygon::triangle(&corners).volume_in_disc(0.9, height);
            let expected = counted(&corners, 0.9, height);
            prop_assert!((found - expected).abs() < 2e-2, "{found} {expected}");
        }

        /// A triangle cut in two at any line: the parts in the disc make the whole.
        #[test]
        fn parts_make_the_whole(
            corners in prop::array::uniform3(prop::array::uniform2(-2..3_i32)),
            line in prop::array::uniform3(-2..3_i32),
        ) {
            let corners = turned(corners.map(|c| c.map(|x| 0.5 * f64::from(x))));
            let triangle = Polygon::triangle(&corners);
            let [a, b, c] = line.map(|x| 0.5 * f64::from(x));
            let height = |p: Place| 1.0 + 0.4 * p[0] - 0.3 * p[1];
            for radius in [0.5, 1.0, 0.5_f64.sqrt(), 5.0] {
                let side = |p: &Place| a * p[0] + b * p[1] - c;
                let [one, other] = [triangle.cut(side), triangle.cut(|p| -side(p))]
                    .map(|part| part.volume_in_disc(radius, height));
                let whole = triangle.volume_in_disc(radius, height);
                prop_assume!(a != 0.0 || b != 0.0);
                prop_assert!((one + other - whole).abs() < 1e-14, "{one} {other} {whole}");
            }
        }
    }

    /// Segments of all sizes against the closed formula, the disc in the triangle, corners on the circle.
    #[test]
    fn circles_against_closed_formulas() {
        let flat = |_: Place| 1.0;
        let around = Polygon::triangle(&[[-9.0, -5.0], [9.0, -5.0], [0.0, 9.0]]);
        let disc = around.volume_in_disc(1.5, flat);
        assert!((disc - std::f64::consts::PI * 2.25).abs() < 1e-14);
        for distance in [1.0 - 1e-12, 0.999_999, 0.9, 0.1, 0.0, -0.5, -1.0 + 1e-9] {
            let beyond = around.cut(|p| p[0] - distance).volume_in_disc(1.0, flat);
            let half: f64 = f64::acos(distance);
            let segment = half - 0.5 * (2.0 * half).sin();
            assert!(
                (beyond - segment).abs() < 1e-14,
                "{distance}: {beyond} {segment}"
            );
        }
        let inscribed = Polygon::triangle(&[[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]);
        assert!((inscribed.volume_in_disc(1.0, flat) - 1.0).abs() < 1e-15);
    }
}
