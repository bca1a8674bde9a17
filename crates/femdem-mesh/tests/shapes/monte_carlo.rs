//! Volume, centroid and inertia of non-convex shapes by sampling, with independent tests of what is inside.

use super::body;
use femdem_mesh::{Point3, Polyhedron, Vector3, convex_hull};
use std::f64::consts::{PI, TAU};

const SAMPLES: usize = 300_000;

/// Uniform numbers from 0 to 1: a Weyl sequence in three dimensions, shifted by a linear
/// congruential generator.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Compares the integrals of 1, x and the products of coordinates with sampled ones, within four
/// standard deviations and `slack` of the integral's scale.
fn compare(text: &str, inside: impl Fn(&Point3) -> bool, slack: f64) {
    let body = body(text, 1.0);
    let (mut low, mut high) = (Point3::origin(), Point3::origin());
    for v in body.vertices() {
        (low, high) = (low.inf(v), high.sup(v));
    }
    let extent = high - low;
    let mut numbers = Numbers(2026);
    let mut sums = [0.0; 10];
    let mut squares = [0.0; 10];
    for _ in 0..SAMPLES {
        let unit = Vector3::from_fn(|_, _| numbers.next());
        let p = low + unit.component_mul(&extent);
        if inside(&p) {
            for (k, value) in moments(&p).into_iter().enumerate() {
                sums[k] += value;
                squares[k] += value * value;
            }
        }
    }
    let n = SAMPLES as f64;
    for (k, exact) in integrals(&body).into_iter().enumerate() {
        let mean = sums[k] / n;
        let deviation = ((squares[k] / n - mean * mean) / n).sqrt() * extent.product();
        let sampled = mean * extent.product();
        let scale = body.mass_properties().volume
            * body
                .bounding_radius()
                .powi([0, 1, 1, 1, 2, 2, 2, 2, 2, 2][k]);
        assert!(
            (sampled - exact).abs() <= 4.0 * deviation + slack * scale,
            "{text}, integral {k}: sampled {sampled} +- {deviation}, body {exact}"
        );
    }
}

fn moments(p: &Point3) -> [f64; 10] {
    let (x, y, z) = (p.x, p.y, p.z);
    [
        1.0,
        x,
        y,
        z,
        y * y + z * z,
        z * z + x * x,
        x * x + y * y,
        -x * y,
        -y * z,
        -z * x,
    ]
}

fn integrals(body: &Polyhedron) -> [f64; 10] {
    let m = body.mass_properties();
    let i = m.inertia;
    let c = m.centroid.coords * m.volume;
    [
        m.volume,
        c.x,
        c.y,
        c.z,
        i[(0, 0)],
        i[(1, 1)],
        i[(2, 2)],
        i[(0, 1)],
        i[(1, 2)],
        i[(2, 0)],
    ]
}

/// Whether a point of the plane lies in a regular polygon on a circle about the origin.
fn in_polygon(x: f64, y: f64, radius: f64, sides: f64, start: f64) -> bool {
    let sector = TAU / sides;
    let from_corner = (y.atan2(x) - start).rem_euclid(sector);
    x.hypot(y) * (from_corner - 0.5 * sector).cos() <= radius * (0.5 * sector).cos()
}

#[test]
fn dolos() {
    for waist in [0.32_f64, 0.42] {
        let chamfer = 0.057;
        let half = |y: f64| 0.5 * waist - (waist - 0.2) * y.abs();
        let middle = 0.5 - 0.5 * waist;
        let in_fluke = |along: f64, across: f64, z: f64| {
            let wide = half(along);
            let (a, b) = (across.abs(), (z - middle).abs());
            along.abs() <= 0.5 && a <= wide && b <= wide && a + b <= 2.0 * wide - chamfer
        };
        // The shank is the hull of the rings where it leaves the flukes.
        let mut ends = Vec::new();
        for (x, y, z) in [
            (half(0.0), 0.0, middle - half(0.0) + chamfer),
            {
                let y = 0.5 * waist - chamfer;
                (half(y), y, middle - half(y) + chamfer)
            },
            {
                let y = 0.5 * waist;
                (half(y) - chamfer, y, middle - half(y))
            },
        ] {
            for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                ends.push(Point3::new(sx * x, sy * y, z));
                ends.push(Point3::new(sy * y, sx * x, -z));
            }
        }
        ends.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        ends.dedup();
        let shank = convex_hull(&ends).unwrap();
        let planes: Vec<_> = (0..shank.face_count())
            .map(|i| (shank.face_normal(i), shank.face_offset(i)))
            .collect();
        let inside = |p: &Point3| {
            in_fluke(p.y, p.x, p.z)
                || in_fluke(p.x, p.y, -p.z)
                || planes.iter().all(|(n, offset)| n.dot(&p.coords) <= *offset)
        };
        compare(&format!("dolos:waist={waist}"), inside, 0.0);
    }
}

#[test]
fn tetrapod() {
    let (sin, cos) = (8.0_f64.sqrt() / 3.0, 1.0 / 3.0);
    let legs = [
        Vector3::z(),
        Vector3::new(sin, 0.0, -cos),
        Vector3::new(-0.5 * sin, 0.75_f64.sqrt() * sin, -cos),
        Vector3::new(-0.5 * sin, -0.75_f64.sqrt() * sin, -cos),
    ];
    let (foot, root) = (0.151, 0.235);
    let length = 0.75 * (1.0 - foot * sin);
    let meeting = root * 0.5_f64.sqrt();
    for sides in [12.0, 30.0] {
        let inside = |p: &Point3| {
            let along = legs.map(|leg| leg.dot(&p.coords));
            let nearest = (0..4).fold(0, |best, i| if along[i] > along[best] { i } else { best });
            let s = along[nearest];
            let radius = foot + (root - foot) * (length - s) / (length - meeting);
            let leg = legs[nearest];
            let e1 = (legs[(nearest + 1) % 4] + leg * cos).normalize();
            let (x, y) = (e1.dot(&p.coords), leg.cross(&e1).dot(&p.coords));
            s <= length && in_polygon(x, y, radius, sides, 0.0)
        };
        compare(&format!("tetrapod:sides={sides}"), inside, 0.0);
    }
}

#[test]
fn lobes() {
    for lobes in [3_u32, 4] {
        let half = PI / f64::from(lobes);
        let radius = 0.5 / (1.0 + 0.85 / half.sin());
        let centre = 0.5 - radius;
        let inside = |p: &Point3| {
            let in_core = in_polygon(p.x, p.y, centre, f64::from(lobes), 0.0);
            let in_lobe = (0..lobes).any(|i| {
                let (sin, cos) = (2.0 * half * f64::from(i)).sin_cos();
                (p.x - centre * cos).hypot(p.y - centre * sin) <= radius
            });
            in_core || in_lobe
        };
        // The arcs are polygons.
        compare(&format!("lobed:lobes={lobes},segments=64"), inside, 3e-4);
    }
}

#[test]
fn pellet() {
    let inside = |p: &Point3| {
        in_polygon(p.x, p.y, 0.5, 36.0, 0.0)
            && !in_polygon(p.x, p.y, 0.09, 12.0, 0.0)
            && (0..6).all(|i| {
                let angle = TAU * f64::from(i) / 6.0;
                let (x, y) = (p.x - 0.3 * angle.cos(), p.y - 0.3 * angle.sin());
                !in_polygon(x, y, 0.09, 12.0, angle)
            })
    };
    compare("pellet:aspect=0.8", inside, 0.0);
}

#[test]
fn antifer() {
    let groove = 0.12;
    let text = format!("antifer:groove={groove},segments=48");
    // The body lies about its centroid: its lower face shows by how much it was moved.
    let moved = body(&text, 1.0)
        .vertices()
        .iter()
        .map(|v| v.z)
        .fold(f64::MAX, f64::min)
        + 0.5;
    let inside = |p: &Point3| {
        let z = p.z - moved;
        let half = 0.5 * (0.5 * (1.086 + 1.005) + (1.005 - 1.086) * z);
        let off_groove = |a: f64, b: f64| a.hypot(b) > groove;
        p.x.abs() <= half
            && p.y.abs() <= half
            && off_groove(half - p.x.abs(), p.y)
            && off_groove(half - p.y.abs(), p.x)
    };
    compare(&text, inside, 2e-4);
}

#[test]
fn clump() {
    let spheres = [
        [-0.25, 0.0, 0.0, 0.25],
        [0.1, 0.0, 0.0, 0.3],
        [0.1, 0.3, 0.1, 0.2],
    ];
    // The centroid of the union, sampled first, is where the body has its origin.
    let in_union = |p: Point3| {
        spheres
            .iter()
            .any(|&[x, y, z, r]| (p - Point3::new(x, y, z)).norm() <= r)
    };
    let mut numbers = Numbers(1);
    let (mut count, mut sum) = (0.0, Vector3::zeros());
    for _ in 0..SAMPLES {
        let p = Point3::from(Vector3::from_fn(|_, _| 1.4 * numbers.next() - 0.7));
        if in_union(p) {
            count += 1.0;
            sum += p.coords;
        }
    }
    let centroid = sum / count;
    compare("clump:cells=5", |p| in_union(p + centroid), 0.006);
}
