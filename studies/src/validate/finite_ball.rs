//! An effect that Hertz's theory neglects: a ball is not a half-space.
//!
//! A linearly elastic ball is pressed on a rigid plane, or on its mirror image, by its own inertia: a uniform
//! body force. Its displacement is a sum over the degrees n of Legendre polynomials (A. I. Lur'e,
//! Three-dimensional problems of the theory of elasticity, 1964),
//!
//! u_r = [A (n+1)(n-2+4 nu) r^(n+1) + B n r^(n-1)] P_n(cos t),
//! u_t = [A (n+5-4 nu) r^(n+1) + B r^(n-1)] dP_n/dt,
//!
//! and for n = 1 additionally a field C r^2 e_z, which balances the body force. The pressure has Hertz's form
//! sqrt(1 - (s/a)^2) on the cap s < a and is directed along the normal of the plane. With S(a) the work of a
//! unit force on its own displacement and G(a) the mean gap between the cap and the plane, the radius a
//! minimises the complementary energy F^2 S/2 + F G; the ball's energy is then F^2 S/2. For a to 0 this is
//! Hertz's theory. Finite strain and waves are neglected.
//!
//! Lengths are in radii, stresses in Young's moduli.

use std::f64::consts::PI;

/// Points of Gauss's rule over the cap.
const POINTS: usize = 60;

/// Terms of the series, over 1/a: the rest is about 1e-5 of the displacement.
const TERMS: f64 = 60.0;

/// One degree of the displacement.
struct Degree {
    n: f64,
    poisson: f64,
    a: f64,
    b: f64,
    c: f64,
}

impl Degree {
    /// Under the tractions `radial` P_n and `tangential` dP_n/dt, relative to the centre of mass.
    fn new(n: usize, poisson: f64, radial: f64, tangential: f64) -> Self {
        let (m, nu) = (n as f64, poisson);
        let shear = 0.5 / (1.0 + nu);
        let lame = nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let [a, b, c] = match n {
            0 => [-radial / (4.0 * shear * (1.0 + nu)), 0.0, 0.0],
            1 => {
                let c = (radial + 2.0 * tangential) / (2.0 * lame + 8.0 * shear);
                let a = (tangential / (2.0 * shear) - c) / (2.0 + 2.0 * nu);
                // The mean displacement of the ball, which the rigid motion B takes away.
                [a, -(0.6 * c + 2.0 * a), c]
            }
            _ => {
                let rows = [
                    [(m + 1.0) * (m * m - m - 2.0 - 2.0 * nu), m * (m - 1.0)],
                    [m * m + 2.0 * m - 1.0 + 2.0 * nu, m - 1.0],
                ];
                let wanted = [radial / (2.0 * shear), tangential / (2.0 * shear)];
                let determinant = rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0];
                let a = (wanted[0] * rows[1][1] - rows[0][1] * wanted[1]) / determinant;
                let b = (rows[0][0] * wanted[1] - wanted[0] * rows[1][0]) / determinant;
                [a, b, 0.0]
            }
        };
        Self {
            n: m,
            poisson,
            a,
            b,
            c,
        }
    }

    /// Factors of P_n in u_r and of dP_n/dt in u_t at the radius r.
    fn displacement(&self, r: f64) -> [f64; 2] {
        let Self {
            n,
            poisson: nu,
            a,
            b,
            c,
        } = *self;
        let (high, low) = (a * r.powf(n + 1.0), b * r.powf(n - 1.0));
        let radial = (n + 1.0) * (n - 2.0 + 4.0 * nu) * high + n * low;
        [
            radial + c * r * r,
            (n + 5.0 - 4.0 * nu) * high + low + c * r * r,
        ]
    }
}

/// A ball pressed on a cap of radius `a`: the work S of a unit force, and the mean gap G.
fn cap(a: f64, poisson: f64) -> [f64; 2] {
    // By point: cosine of the angle from the pole, force, P_n and P_(n+1).
    let mut points = Vec::with_capacity(POINTS);
    let (mut force, mut gap) = (0.0, 0.0);
    for (x, weight) in gauss(POINTS) {
        let u = 0.25 * PI * (x + 1.0);
        let sine = a * u.sin();
        let cosine = (1.0 - sine * sine).sqrt();
        let area = 2.0 * PI * sine * (a * u.cos() / cosine) * (0.25 * PI * weight);
        let push = u.cos() * area;
        force += push;
        gap += push * (1.0 - cosine);
        points.push((cosine, push, 1.0, cosine));
    }
    let mut work = 0.0;
    for n in 0..(TERMS / a).ceil() as usize {
        let m = n as f64;
        let [mut radial, mut tangential] = [0.0; 2];
        for (cosine, push, p, next) in &mut points {
            radial -= *push * *cosine * *p;
            tangential -= *push * (m + 1.0) * (*cosine * *p - *next);
            let after = ((2.0 * m + 3.0) * *cosine * *next - (m + 1.0) * *p) / (m + 2.0);
            (*p, *next) = (*next, after);
        }
        let k = (2.0 * m + 1.0) / (4.0 * PI);
        radial *= k;
        tangential *= if n == 0 { 0.0 } else { k / (m * (m + 1.0)) };
        let [u, v] = Degree::new(n, poisson, radial, tangential).displacement(1.0);
        work += (radial * u + m * (m + 1.0) * tangential * v) / k;
    }
    [work / (force * force), gap / force]
}

/// Force on a ball with a contact of radius `a`, and its energy.
fn pressed(a: f64, poisson: f64) -> [f64; 2] {
    let step = 1e-3 * a;
    let (above, below) = (cap(a + step, poisson), cap(a - step, poisson));
    let force = -2.0 * (above[1] - below[1]) / (above[0] - below[0]);
    [force, 0.5 * force * force * cap(a, poisson)[0]]
}

/// The largest force in an impact over that of Hertz's theory. The energy of a ball before is `energy`, over
/// Young's modulus and the cube of the radius.
pub(crate) fn peak_over_hertz(poisson: f64, energy: f64) -> f64 {
    let modulus = 1.0 / (1.0 - poisson * poisson);
    let approach = (energy * 15.0 / (8.0 * modulus)).powf(0.4);
    let hertz = 4.0 / 3.0 * modulus * approach.powf(1.5);
    // Hertz's radius is an upper bound, and not far off.
    let [mut low, mut high] = [0.5, 1.1].map(|factor| factor * approach.sqrt());
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if pressed(middle, poisson)[1] < energy {
            low = middle;
        } else {
            high = middle;
        }
    }
    pressed(low, poisson)[0] / hertz
}

/// Points and weights of Gauss's rule on (-1, 1).
fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let rule = (0..count).map(|i| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut before, mut p) = (1.0, x);
            for k in 2..=count {
                let k = k as f64;
                (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    });
    rule.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Vector = [f64; 3];

    /// P_n and its derivative by the cosine, for n up to 3.
    fn legendre(n: usize, c: f64) -> [f64; 2] {
        match n {
            0 => [1.0, 0.0],
            1 => [c, 1.0],
            2 => [1.5 * c * c - 0.5, 3.0 * c],
            _ => [2.5 * c * c * c - 1.5 * c, 7.5 * c * c - 1.5],
        }
    }

    /// The displacement of one degree at a point.
    fn displacement(degree: &Degree, n: usize, x: Vector) -> Vector {
        let r = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (c, s) = (x[2] / r, x[0].hypot(x[1]) / r);
        let [p, slope] = legendre(n, c);
        let [u, v] = degree.displacement(r);
        let (radial, tangential) = (u * p, -v * slope * s);
        let outward = radial * s + tangential * c;
        let along = [x[0], x[1]].map(|x| x / (r * s));
        [
            outward * along[0],
            outward * along[1],
            radial * c - tangential * s,
        ]
    }

    /// Stress by central differences.
    fn stress(degree: &Degree, n: usize, nu: f64, x: Vector) -> [Vector; 3] {
        let h = 1e-4;
        let mut slope = [[0.0; 3]; 3];
        for j in 0..3 {
            let at = |h: f64| {
                let mut x = x;
                x[j] += h;
                displacement(degree, n, x)
            };
            let (above, below) = (at(h), at(-h));
            for i in 0..3 {
                slope[i][j] = (above[i] - below[i]) / (2.0 * h);
            }
        }
        let (shear, lame) = (0.5 / (1.0 + nu), nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
        let swelling = slope[0][0] + slope[1][1] + slope[2][2];
        let mut stress = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let volume = if i == j { lame * swelling } else { 0.0 };
                stress[i][j] = shear * (slope[i][j] + slope[j][i]) + volume;
            }
        }
        stress
    }

    /// The fields are in balance inside, with a constant body force for n = 1, and have the prescribed
    /// tractions on the surface.
    #[test]
    fn every_degree_solves_its_problem() {
        let nu = 0.2;
        for n in 0..4 {
            let tractions = [0.7, if n == 0 { 0.0 } else { 0.3 }];
            let degree = Degree::new(n, nu, tractions[0], tractions[1]);
            let x = [0.3, 0.2, 0.4];
            let h = 1e-3;
            let mut balance = [0.0; 3];
            for j in 0..3 {
                let at = |h: f64| {
                    let mut x = x;
                    x[j] += h;
                    stress(&degree, n, nu, x)
                };
                let (above, below) = (at(h), at(-h));
                for i in 0..3 {
                    balance[i] += (above[i][j] - below[i][j]) / (2.0 * h);
                }
            }
            let body = if n == 1 { -(0.7 + 2.0 * 0.3) } else { 0.0 };
            for (i, total) in balance.into_iter().enumerate() {
                let wanted = if i == 2 { -body } else { 0.0 };
                assert!((total - wanted).abs() < 1e-4, "n = {n}: {balance:?}");
            }
            let (s, c) = (0.6, 0.8);
            let normal = [s, 0.0, c];
            let stress = stress(&degree, n, nu, normal);
            let traction = stress.map(|row| (0..3).map(|j| row[j] * normal[j]).sum::<f64>());
            let [p, slope] = legendre(n, c);
            let radial = traction[0] * s + traction[2] * c;
            let tangential = traction[0] * c - traction[2] * s;
            assert!((radial - tractions[0] * p).abs() < 1e-5, "n = {n}");
            assert!(
                (tangential + tractions[1] * slope * s).abs() < 1e-5,
                "n = {n}"
            );
        }
    }

    /// A small cap is Hertz's on a half-space: S = 3/5 (1 - nu^2)/a and G = a^2/5; the excess of the force
    /// in an impact falls with the radius.
    #[test]
    fn small_contacts_are_those_of_hertz() {
        let a = 0.01;
        for nu in [0.0, 0.2, 0.4] {
            let [work, gap] = cap(a, nu);
            let excess = work * a / (0.6 * (1.0 - nu * nu)) - 1.0;
            assert!(excess.abs() < 1.5 * a, "nu = {nu}: {excess}");
            assert!((gap / (0.2 * a * a) - 1.0).abs() < a, "{gap}");
        }
        let excess = [1e-10, 1e-8].map(|energy| peak_over_hertz(0.2, energy) - 1.0);
        assert!((0.0..0.006).contains(&excess[0]), "{excess:?}");
        let growth = excess[1] / excess[0];
        // The radius grows by 100^(1/5) = 2.5; the surface of a ball adds a logarithm of it.
        assert!((2.5..3.5).contains(&growth), "{growth}");
    }
}
