//! Stress, tangent and stiffness bound of isotropic laws in the principal frame of b.

use super::Tangent;
use super::spectral::Spectral;
use femdem_mesh::{Matrix3, Vector3};

/// Stress and moduli of an isotropic law in the principal frame n_A of b, with b_A the eigenvalues of b and
/// eps_A = ln(b_A)/2. For plasticity b and eps are those of the trial state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Principal {
    /// Kirchhoff stress tau_A, Pa.
    pub stress: [f64; 3],
    /// d tau_A / d eps_B, Pa.
    pub moduli: [[f64; 3]; 3],
    /// (tau_B - tau_C) / (b_B - b_C), indexed by the third direction A, Pa; its limit where the two are
    /// equal, so that no difference is ever divided by.
    pub secants: [f64; 3],
}

/// F with its inverse, and b with its principal frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub inverse: Matrix3,
    pub b: Spectral,
}

impl Frame {
    /// The frame of b = F `metric` F^T; `None` unless J and all eigenvalues are positive and finite.
    pub fn new(gradient: &Matrix3, metric: &Matrix3) -> Option<Self> {
        let inverse = gradient.try_inverse()?;
        let b = Spectral::of(&(gradient * metric * gradient.transpose()));
        let usable = gradient.determinant() > 0.0
            && b.values.iter().all(|&v| v > 0.0 && v.is_finite())
            && inverse.iter().all(|v| v.is_finite());
        usable.then_some(Self { inverse, b })
    }

    /// n_A.
    pub fn direction(&self, a: usize) -> Vector3 {
        self.b.vectors.column(a).into()
    }

    /// P = tau F^-T = sum_A tau_A n_A (x) F^-1 n_A.
    pub fn piola(&self, stress: &[f64; 3]) -> Matrix3 {
        let scaled = self.b.vectors * Matrix3::from_diagonal(&Vector3::from(*stress));
        scaled * (self.inverse * self.b.vectors).transpose()
    }

    /// dP/dF. With dF = L F the stress changes by dP = (d tau - tau L^T) F^-T, and in the principal
    /// frame d tau_AA = sum_B a_AB L_BB, d tau_AB = g_AB (L_AB b_B + L_BA b_A) (Ogden, Non-linear
    /// Elastic Deformations, section 6.1.4; Simo and Hughes, Computational Inelasticity, section 8.1).
    pub fn tangent(&self, law: &Principal) -> Option<Tangent> {
        let (b, tau) = (&self.b.values, &law.stress);
        let pulled = self.inverse * self.b.vectors;
        let dyad = |a: usize, c: usize| Dyad::new(&self.direction(a), &pulled.column(c).into());
        let mut sum = Tangent::zeros();
        for a in 0..3 {
            for c in 0..3 {
                let geometric = if a == c { tau[a] } else { 0.0 };
                let normal = law.moduli[a][c] - geometric;
                sum.ger(normal, &dyad(a, a).0, &dyad(c, c).0, 1.0);
                if a != c {
                    let secant = law.secants[3 - a - c];
                    sum.ger(secant * b[c], &dyad(a, c).0, &dyad(a, c).0, 1.0);
                    sum.ger(secant * b[a] - tau[a], &dyad(a, c).0, &dyad(c, a).0, 1.0);
                }
            }
        }
        sum.iter().all(|t| t.is_finite()).then_some(sum)
    }

    /// The bound of [`super::Material::stiffness_bound`]. `lengths` are 1/lambda_B if the principal
    /// stretches lambda_B of F belong to the frame (elastic laws), else the largest of F^-1 thrice.
    ///
    /// The quadratic form of the tangent is split in p (tr H)^2 and a rest, H_AB = n_A . G F^-1 n_B.
    /// The first is at most p |F^-1|^2 (sum |u|^2)(sum |B|^2), the rest at most its largest eigenvalue
    /// times |G|^2, which is not larger than the same product.
    pub fn stiffness_bound(&self, law: &Principal, lengths: &[f64; 3]) -> f64 {
        let (b, tau, a) = (&self.b.values, &law.stress, &law.moduli);
        let shared = (a[0][1] + a[0][2] + a[1][0] + a[1][2] + a[2][0] + a[2][1]) / 6.0;
        let shared = shared.max(0.0);
        let mut normal = Matrix3::zeros();
        let mut largest = 0.0_f64;
        for i in 0..3 {
            for j in 0..3 {
                let geometric = if i == j { tau[i] } else { 0.0 };
                let rest = 0.5 * (a[i][j] + a[j][i]) - geometric - shared;
                normal[(i, j)] = rest * lengths[i] * lengths[j];
            }
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let g = law.secants[i];
            let coupling = 0.5 * (g * (b[j] + b[k]) - tau[j] - tau[k]) * lengths[j] * lengths[k];
            let (first, second) = (g * b[j] * lengths[j].powi(2), g * b[k] * lengths[k].powi(2));
            let half = (0.25 * (first - second).powi(2) + coupling * coupling).sqrt();
            largest = largest.max(0.5 * (first + second) + half);
        }
        let [x, y, z] = Spectral::of(&normal).values;
        let longest = lengths[0].max(lengths[1]).max(lengths[2]);
        shared * longest * longest + largest.max(x).max(y).max(z)
    }

    /// 1/lambda_B of the principal stretches, for b = F F^T.
    pub fn inverse_stretches(&self) -> [f64; 3] {
        self.b.values.map(|value| 1.0 / value.sqrt())
    }
}

/// n (x) m as the nine rows of a [`Tangent`].
struct Dyad(femdem_mesh::nalgebra::SVector<f64, 9>);

impl Dyad {
    fn new(n: &Vector3, m: &Vector3) -> Self {
        Self(femdem_mesh::nalgebra::SVector::from_fn(|row, _| {
            n[row / 3] * m[row % 3]
        }))
    }
}

/// (ln x - ln y) / (2 (x - y)) for positive x and y, exact to round-off where they are nearly equal.
pub(crate) fn half_log_slope(x: f64, y: f64) -> f64 {
    let gap = (x - y) / y;
    if gap == 0.0 {
        0.5 / y
    } else {
        0.5 * gap.ln_1p() / (gap * y)
    }
}
