//! What is integrated over a section of a ball, in the notation of [`disc`](super::disc): s and t = R - s, u = R^2 - s^2,
//! and x from the foot. Differences from the rim and from the foot are multiplied out, so that nothing cancels where
//! both s and h are close to R.

use super::disc::{Disc, Node, Sum};
use super::rule::THREE;
use crate::kernel::{Point, Second};

/// Integrals of the ball's field phi = t/R, times R.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct FieldSums {
    /// int t dA, int x t dA, int rho^2 t dA.
    pub pressure: f64,
    pub first: Point,
    pub second: f64,
    /// int dA/s, int x dA/s, int x x^T dA/s.
    pub slope: f64,
    pub slope_first: Point,
    pub slope_second: Second,
    /// int h (g(R) - g(s))/s^3 dA, g(s) = s^3/3 - s^4/(4 R): the integral of phi over what lies behind the section,
    /// seen from the ball's centre.
    pub energy: f64,
}

/// Integrals of the section, and of the part of the ball behind it, seen from the ball's centre.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct SolidSums {
    /// int dA, int x dA, int x x^T dA.
    pub area: f64,
    pub first: Point,
    pub second: Second,
    /// int h (R^3 - s^3)/(3 s^3) dA.
    pub volume: f64,
    /// The first moment of this volume along the normal and in the plane: int h^2 q dA, int h x q dA with
    /// q = (R^4 - s^4)/(4 s^4).
    pub moment_normal: f64,
    pub moment: Point,
}

/// Symmetric functions of t and T = R - h.
struct Depths {
    /// t + T, t T and t^2 + t T + T^2.
    sum: f64,
    product: f64,
    squares: f64,
}

impl Depths {
    fn new(disc: &Disc, t: f64) -> Self {
        let (sum, product) = (t + disc.depth, t * disc.depth);
        Self {
            sum,
            product,
            squares: sum * sum - product,
        }
    }
}

/// Adds `weight` times the symmetric part of `a` `b`^T.
fn add_product(to: &mut Second, a: &Point, b: &Point, weight: f64) {
    to.xx += weight * a.x * b.x;
    to.xy += weight * 0.5 * (a.x * b.y + a.y * b.x);
    to.yy += weight * a.y * b.y;
}

fn add_scaled(to: &mut Point, a: &Point, weight: f64) {
    to.x += weight * a.x;
    to.y += weight * a.y;
}

impl Sum for FieldSums {
    fn add(&mut self, disc: &Disc, node: &Node) {
        let r = disc.radius;
        let Node { s, t, .. } = *node;
        let Depths {
            sum,
            product,
            squares,
        } = Depths::new(disc, t);
        // rho^2 = (s - h) (s + h)
        let wedge = node.wedge / (s + disc.height);
        // int_h^s (R - s) s ds = (s - h) (3 R (t + T) - 2 (t^2 + t T + T^2))/6
        let pressure = wedge * (3.0 * r * sum - 2.0 * squares) / 6.0;
        self.pressure += pressure;
        // x t = -grad G, G = int_s^R (R - s) s ds
        let g = |t: f64| t * t * (0.5 * r - t / 3.0);
        add_scaled(&mut self.first, &node.outward, -g(t));
        // rho^2 t = -x . grad G = 2 G - div (x G)
        let mean = THREE.map(|(place, weight)| {
            let t = disc.depth + (t - disc.depth) * place;
            weight * g(t) * (r - t)
        });
        self.second += 2.0 * wedge * mean.iter().sum::<f64>() - node.wedge * g(t);
        // x/s = -grad t, and x x^T/s = t I - grad (x t)
        self.slope += wedge;
        add_scaled(&mut self.slope_first, &node.outward, -t);
        self.slope_second.xx += pressure;
        self.slope_second.yy += pressure;
        add_product(&mut self.slope_second, &node.at, &node.outward, -t);
        // h int_h^s (g(R) - g(s))/s^2 ds
        let least = 2.0 * r * r * squares - r * sum.powi(3) + product * squares;
        self.energy += wedge * least / (12.0 * r * s);
    }
}

impl Sum for SolidSums {
    fn add(&mut self, disc: &Disc, node: &Node) {
        let (r, h) = (disc.radius, disc.height);
        let Node { s, t, u, .. } = *node;
        let Depths { sum, product, .. } = Depths::new(disc, t);
        self.area += 0.5 * node.wedge;
        // x = -grad (u/2), and x x^T = u/2 I - grad (x u/2)
        add_scaled(&mut self.first, &node.outward, -0.5 * u);
        let even = node.wedge * (disc.square + u) / 8.0;
        self.second.xx += even;
        self.second.yy += even;
        add_product(&mut self.second, &node.at, &node.outward, -0.5 * u);
        // h int_h^s (R^3 - s^3)/(3 s^2) ds
        let cubes = sum * (3.0 * r * r - r * sum + product) - 2.0 * r * product;
        self.volume += node.wedge / (s + h) * cubes / (6.0 * s);
        // h^2 int_h^s (R^4 - s^4)/(4 s^3) ds, R^2 - s h = R (t + T) - t T
        let squares = s * s;
        self.moment_normal += node.wedge * (r * sum - product) * (r * r + s * h) / (8.0 * squares);
        // x q = -grad (u^2/(8 s^2))
        add_scaled(
            &mut self.moment,
            &node.outward,
            -h * u * u / (8.0 * squares),
        );
    }
}
