//! Volume of the part of a closed surface's inside that lies in a ball, in closed form.
//!
//! Seen from the centre of a ball of radius `R`, a face on a plane at the signed distance `h` is the base of a
//! cone. Where the face lies in the ball the cone ends on it, elsewhere on the sphere, so that the contribution
//! of the face to the volume is the integral over it, in polar coordinates about the foot of the centre on its
//! plane, of
//!
//! `h/3` for `r <= a`,  `R³ h / (3 (r² + h²)^1.5)` for `r > a`,  with `a² = max(R² - h², 0)`.
//!
//! Its radial integral `G(r)`, turned into an integral over the border, `∮ G(r) dθ`, has an elementary form for
//! every piece of a straight edge. The only decision is where an edge crosses the circle `r = a`, where `G` is
//! continuous.

use femdem_mesh::{Point3, Vector3};

/// Contribution of a triangle (outward counter-clockwise) to the volume that its surface has in the ball.
pub(crate) fn volume_in_ball(triangle: &[Point3; 3], centre: &Point3, radius: f64) -> f64 {
    let [a, b, c] = triangle.map(|p| p - centre);
    let area = (b - a).cross(&(c - a));
    let Some(normal) = area.try_normalize(0.0) else {
        return 0.0;
    };
    let height = normal.dot(&a);
    let (sign, height) = (height.signum(), height.abs());
    let sides = [(a, b), (b, c), (c, a)];
    let cone = Cone::new(height, radius);
    sign * sides
        .map(|(p, q)| cone.side(&normal, &p, &q))
        .iter()
        .sum::<f64>()
}

struct Cone {
    height: f64,
    /// Radius of the circle in which the sphere cuts the plane; 0 if it does not.
    circle: f64,
    /// `R³ / 3`.
    outside: f64,
    /// The parts of `G` that do not depend on `r` outside the circle.
    constant: f64,
}

impl Cone {
    fn new(height: f64, radius: f64) -> Self {
        let square = ((radius - height) * (radius + height)).max(0.0);
        let outside = radius.powi(3) / 3.0;
        Self {
            height,
            circle: square.sqrt(),
            outside,
            // Where the circle begins, r² + h² is R², or h² when there is no circle.
            constant: height * square / 6.0 + outside * (height / height.max(radius)),
        }
    }

    /// `∫ G dθ` along the side from `p` to `q`; both are given from the centre.
    fn side(&self, normal: &Vector3, p: &Vector3, q: &Vector3) -> f64 {
        let Some(along) = (q - p).try_normalize(0.0) else {
            return 0.0;
        };
        // Signed distance of the side's line from the foot, positive when it runs counter-clockwise.
        let apart = p.cross(&along).dot(normal);
        let [from, to] = [p.dot(&along), q.dot(&along)];
        let half_chord = ((self.circle - apart.abs()) * (self.circle + apart.abs()))
            .max(0.0)
            .sqrt();
        let [enter, leave] = [-half_chord, half_chord].map(|t| t.clamp(from, to));
        self.beyond(apart, from, enter)
            + self.within(apart, enter, leave)
            + self.beyond(apart, leave, to)
    }

    /// Inside the circle `G = h r² / 6`, and `∫ r² dθ` is twice the triangle's area.
    fn within(&self, apart: f64, from: f64, to: f64) -> f64 {
        self.height * apart * (to - from) / 6.0
    }

    /// Outside it `G = constant - (R³/3) h / √(r² + h²)`.
    fn beyond(&self, apart: f64, from: f64, to: f64) -> f64 {
        if from >= to || apart == 0.0 {
            return 0.0;
        }
        let angle = to.atan2(apart.abs()) - from.atan2(apart.abs());
        // With t = p tan θ: ∫ h dθ / √(r² + h²) = atan(h t / (p √(p² + h² + t²))).
        let solid = |t: f64| {
            (self.height * t)
                .atan2(apart.abs() * (apart * apart + self.height * self.height + t * t).sqrt())
        };
        apart.signum() * (self.constant * angle - self.outside * (solid(to) - solid(from)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::catalogue::CatalogueShape;
    use femdem_mesh::shapes::{Dolos, Shape};
    use femdem_mesh::{Polyhedron, Pose};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn in_ball(shape: &Polyhedron, centre: &Point3, radius: f64) -> f64 {
        let place = |v: u32| shape.vertices()[v as usize];
        shape
            .triangles()
            .iter()
            .map(|t| volume_in_ball(&t.map(place), centre, radius))
            .sum()
    }

    fn solid(id: &str) -> Polyhedron {
        id.parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(2.0)
            .unwrap()
    }

    /// Balls of which a cube of side 2 about the origin contains nothing, a cap, a half, a quarter, an eighth,
    /// and all but six caps.
    #[test]
    fn parts_of_a_ball_in_a_cube() {
        let cube = solid("P5").scaled(3_f64.sqrt()).unwrap();
        let ball = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
        let cap = |r: f64, h: f64| PI * h * h * (3.0 * r - h) / 3.0;
        let cases = [
            ([0.0, 0.0, 0.0], 0.9, ball(0.9)),
            ([0.1, -0.2, 0.3], 9.0, 8.0),
            ([4.0, 0.0, 0.0], 2.5, 0.0),
            ([1.0, 0.0, 0.0], 0.5, 0.5 * ball(0.5)),
            ([1.0, 1.0, 0.2], 0.5, 0.25 * ball(0.5)),
            ([1.0, -1.0, 1.0], 0.5, 0.125 * ball(0.5)),
            ([1.2, 0.0, 0.1], 0.5, cap(0.5, 0.3)),
            ([0.0, 0.0, 0.0], 1.2, ball(1.2) - 6.0 * cap(1.2, 0.2)),
        ];
        for (centre, radius, expected) in cases {
            let found = in_ball(&cube, &Point3::from(centre), radius);
            assert!(
                (found - expected).abs() < 1e-12,
                "{centre:?} {radius}: {found}, not {expected}"
            );
        }
    }

    /// The derivative by the radius is the area of the sphere inside the body, by sampling its points.
    #[test]
    fn growth_is_the_area_inside() {
        let dolos = Shape::from(Dolos::default()).polyhedron(2.0).unwrap();
        let cube = solid("P5");
        for (shape, centre) in [
            (&cube, Point3::new(0.2, 0.1, -0.3)),
            (&dolos, Point3::new(0.05, 0.1, 0.0)),
        ] {
            for radius in [0.3, 0.6, 0.8] {
                let step = 1e-4;
                let growth = (in_ball(shape, &centre, radius + step)
                    - in_ball(shape, &centre, radius - step))
                    / (2.0 * step);
                let tiny = 0.02;
                let mut inside = 0.0;
                let n = 4000;
                for i in 0..n {
                    // Fibonacci's points on the sphere.
                    let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
                    let turn = f64::from(i) * PI * (3.0 - 5_f64.sqrt());
                    let s = (1.0 - z * z).sqrt();
                    let point = centre + radius * Vector3::new(s * turn.cos(), s * turn.sin(), z);
                    // A small ball about a point is either wholly inside or not, as its part shows.
                    inside += in_ball(shape, &point, tiny) / (4.0 / 3.0 * PI * tiny.powi(3));
                }
                let area = inside / f64::from(n) * 4.0 * PI * radius * radius;
                assert!(
                    (growth - area).abs() < 0.01 * (1.0 + area),
                    "{radius}: {growth}, sampled {area}"
                );
            }
        }
    }

    proptest! {
        /// Cutting the body by a plane splits the volume: sums over the halves, which have other faces, agree.
        #[test]
        fn halves_make_the_whole(place in prop::array::uniform3(-1.5..1.5_f64), radius in 0.1..2.0_f64, offset in -0.6..0.6_f64, turn in prop::array::uniform3(-3.0..3.0_f64)) {
            let shape = solid("A10");
            let pose = Pose::new(Vector3::zeros(), Vector3::from(turn));
            let centre = Point3::from(place);
            let part = |normal: Vector3, offset: f64| {
                let mut clipper = crate::clip::Clipper::default();
                clipper.load(&shape, &pose);
                clipper.clip(&normal, offset);
                let mut volume = 0.0;
                clipper.each_triangle(|t| volume += volume_in_ball(&t, &centre, radius));
                volume
            };
            let whole = part(Vector3::x(), 9.0);
            let halves = part(Vector3::x(), offset) + part(-Vector3::x(), -offset);
            prop_assert!((whole - halves).abs() < 1e-12, "{whole} {halves}");
            prop_assert!(whole > -1e-13 && whole < 4.19 * radius.powi(3));
        }
    }
}
