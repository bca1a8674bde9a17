//! Laws in logarithmic strain: Hencky elasticity with, or without, multiplicative plasticity.
//!
//! F = F_e F_p; the trial elastic strain is ln(F C_p^-1 F^T)/2 with the C_p^-1 of the last step. Return
//! maps take principal strains and work as at small strain (Simo, Comput. Methods Appl. Mech. Engrg.
//! 99, 61 (1992); de Souza Neto, Peric and Owen, Computational Methods for Plasticity, chapter 14).

use super::principal::{Frame, Principal, half_log_slope};
use super::{Deformation, Moduli, Response, Tangent};
use femdem_mesh::Matrix3;

/// Result of a return map for principal trial strains.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Returned {
    /// Principal Kirchhoff stresses, Pa.
    pub stress: [f64; 3],
    /// d stress / d trial strain, Pa.
    pub moduli: [[f64; 3]; 3],
    /// Deviatoric stress over deviatoric trial strain, Pa: 2 mu when elastic.
    pub shear_secant: f64,
    /// Principal elastic strains at the end of the step.
    pub elastic: [f64; 3],
    /// Accumulated plastic strain at the end of the step.
    pub hardening: f64,
    /// Work dissipated in the step, J/m^3.
    pub plastic_work: f64,
    /// Whether the step is plastic.
    pub flows: bool,
}

impl Returned {
    /// The result of an elastic step: tau = lambda tr(eps) I + 2 mu eps.
    pub fn elastic(moduli: &Moduli, strain: &[f64; 3], hardening: f64) -> Self {
        let dilation = strain[0] + strain[1] + strain[2];
        let two_mu = 2.0 * moduli.shear;
        Self {
            stress: strain.map(|e| moduli.lambda * dilation + two_mu * e),
            moduli: isotropic(moduli.bulk, two_mu),
            shear_secant: two_mu,
            elastic: *strain,
            hardening,
            plastic_work: 0.0,
            flows: false,
        }
    }

    /// The same for the tangent, with the eigenvalues `b` of the trial b.
    pub fn principal(&self, b: &[f64; 3]) -> Principal {
        let secant = |j: usize, k: usize| self.shear_secant * half_log_slope(b[j], b[k]);
        Principal {
            stress: self.stress,
            moduli: self.moduli,
            secants: [secant(1, 2), secant(2, 0), secant(0, 1)],
        }
    }
}

/// bulk 1 (x) 1 + two_mu (I - 1 (x) 1 / 3), in principal components.
pub(crate) fn isotropic(bulk: f64, two_mu: f64) -> [[f64; 3]; 3] {
    let outside = bulk - two_mu / 3.0;
    let row = |i: usize| [0, 1, 2].map(|j| outside + if i == j { two_mu } else { 0.0 });
    [row(0), row(1), row(2)]
}

/// Stored energy of the strain: K/2 tr(eps)^2 + mu dev(eps) : dev(eps), J/m^3.
pub(crate) fn stored(moduli: &Moduli, strain: &[f64; 3]) -> f64 {
    let (dilation, deviator) = split(strain);
    0.5 * moduli.bulk * dilation * dilation
        + moduli.shear * deviator.iter().map(|e| e * e).sum::<f64>()
}

/// Trace and deviator.
pub(crate) fn split(values: &[f64; 3]) -> (f64, [f64; 3]) {
    let trace = values[0] + values[1] + values[2];
    (trace, values.map(|v| v - trace / 3.0))
}

/// A law in logarithmic strain, by its moduli and its return map.
pub(crate) trait LogStrain {
    /// The moduli per reference volume at this value of the hardening variable, Pa.
    fn moduli(&self, hardening: f64) -> Moduli;

    /// The result of a step with principal trial strains `trial` that began at `hardening`.
    fn return_map(&self, trial: &[f64; 3], hardening: f64) -> Returned;
}

/// History of a plastic point: C_p^-1 - I (xx, yy, zz, yz, xz, xy) and the hardening variable.
pub(crate) const HISTORY: usize = 7;

/// C_p^-1 and the hardening variable.
#[derive(Debug, Clone, Copy)]
struct History {
    metric: Matrix3,
    hardening: f64,
}

impl History {
    fn read(old: &[f64]) -> Option<Self> {
        let &[xx, yy, zz, yz, xz, xy, hardening] = old else {
            return None;
        };
        let metric = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) + Matrix3::identity();
        Some(Self { metric, hardening })
    }

    /// C_p^-1 = F^-1 b_e F^-T at the end of a step, and the hardening variable.
    fn after(frame: &Frame, end: &Returned) -> [f64; HISTORY] {
        let mut metric = -Matrix3::identity();
        for a in 0..3 {
            let pulled = frame.inverse * frame.direction(a);
            metric += pulled * pulled.transpose() * (2.0 * end.elastic[a]).exp();
        }
        let m = &metric;
        [m.m11, m.m22, m.m33, m.m23, m.m13, m.m12, end.hardening]
    }
}

/// Trial state and its return.
fn step<L: LogStrain>(law: &L, d: &Deformation, history: &History) -> Option<(Frame, Returned)> {
    let frame = Frame::new(&d.gradient, &history.metric)?;
    let trial = frame.b.values.map(|value| 0.5 * value.ln());
    let end = law.return_map(&trial, history.hardening);
    Some((frame, end))
}

/// [`super::Material::respond`] of an elastic-plastic law.
pub(crate) fn respond<L: LogStrain>(
    law: &L,
    d: &Deformation,
    old: &[f64],
    new: &mut [f64],
) -> Option<Response> {
    let (frame, end) = step(law, d, &History::read(old)?)?;
    let new: &mut [f64; HISTORY] = new.try_into().ok()?;
    if end.flows {
        *new = History::after(&frame, &end);
    } else {
        // A copy, so that any number of elastic steps adds no round-off to the history.
        new.copy_from_slice(old);
    }
    Response {
        energy: stored(&law.moduli(end.hardening), &end.elastic),
        piola: frame.piola(&end.stress),
        viscous_power: 0.0,
        plastic_work: end.plastic_work,
    }
    .finite()
}

/// [`super::Material::tangent`] of an elastic-plastic law.
pub(crate) fn tangent<L: LogStrain>(law: &L, d: &Deformation, old: &[f64]) -> Option<Tangent> {
    let (frame, end) = step(law, d, &History::read(old)?)?;
    frame.tangent(&end.principal(&frame.b.values))
}

/// [`super::Material::stiffness_bound`] of an elastic-plastic law: of the algorithmic tangent and of
/// the elastic one that governs unloading from the end of the step.
pub(crate) fn stiffness_bound<L: LogStrain>(law: &L, d: &Deformation, old: &[f64]) -> f64 {
    let Some((frame, end)) = History::read(old).and_then(|history| step(law, d, &history)) else {
        return f64::NAN;
    };
    let lengths = [1.0 / d.smallest_stretch(); 3];
    let algorithmic = frame.stiffness_bound(&end.principal(&frame.b.values), &lengths);
    let mut unloading = frame;
    unloading.b.values = end.elastic.map(|e| (2.0 * e).exp());
    let elastic = Returned::elastic(&law.moduli(end.hardening), &end.elastic, end.hardening);
    let elastic = unloading.stiffness_bound(&elastic.principal(&unloading.b.values), &lengths);
    algorithmic.max(elastic)
}
