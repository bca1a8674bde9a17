//! The modified Drucker-Prager law with a cap, for powders.

use super::log_strain::{self, HISTORY, LogStrain, Returned, isotropic, split};
use super::{Deformation, Material, Moduli, Response, Tangent};
use crate::error::{FemError, check};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Hencky elasticity that yields in shear and in compaction, with p = -tr(T)/3, positive in compression, and
/// q = sqrt(3/2) |dev T|:
///
/// - below p_a on the line q = d + p tan(beta), with `cohesion` d and `friction_angle` beta (in the plane of p
///   and q: for a Mohr-Coulomb angle phi and cohesion c, tan(beta) = 6 sin(phi)/(3 - sin(phi)) and
///   d = 6 c cos(phi)/(3 - sin(phi)) in compression);
/// - above p_a on the cap, the ellipse sqrt((p - p_a)^2 + (R q)^2) = R (d + p_a tan(beta)) with the
///   `eccentricity` R. It ends on the axis at p_b = p_a + R (d + p_a tan(beta)), the hydrostatic yield pressure.
///
/// `hardening` is p_b over the compaction kappa, the volumetric plastic strain on the cap (logarithmic: the relative
/// density is its first value times exp(kappa)). It is a table, as measured: published curves of powders have no
/// form in common (DiMaggio and Sandler, J. Eng. Mech. Div. ASCE 97, 935 (1971), for the cap; Cunningham, Sinka and
/// Zavaliangos, J. Pharm. Sci. 93, 2022 (2004); Sinka, Cunningham and Zavaliangos, Powder Technol. 133, 33 (2003); Han et
/// al., Int. J. Pharm. 358, 144 (2008), for tablets).
///
/// Flow is associated on the cap. On the line it keeps the volume: no dilatancy. So the direction of flow is
/// continuous where the two surfaces meet, and needs no surface of transition (alpha = 0). The usual elliptic
/// potential of the line would create energy where p < p_a/2 in a powder without cohesion. The mean tension has the
/// limit d / tan(beta), with plastic dilation, as in [`super::DruckerPrager`]. Neither flow softens the cap: kappa and
/// p_b never fall.
///
/// A powder loses half of its volume, so that here stress refers to the compacted powder: T = exp(kappa) tau,
/// which is the true stress but for the elastic change of volume and for gaps. Moduli and strengths are those of
/// the compacted powder, too. The energy is exp(-kappa) times Hencky's, and what it loses as kappa grows is
/// dissipated.
///
/// The tangent is not symmetric, and the work dissipated in a step, the stress at its end times the plastic
/// strain, is accurate to first order in the step.
///
/// History: C_p^-1 - I (xx, yy, zz, yz, xz, xy) and kappa, seven numbers.
///
/// ```
/// use femdem_fem::material::DruckerPragerCap;
///
/// // A powder that yields at 1 MPa when loose, and at 100 MPa at a compaction of 0.7, half of its volume.
/// let powder = DruckerPragerCap::new(2e9, 0.2, 0.5e6, 65_f64.to_radians(), 0.6, vec![[0.0, 1e6], [0.5, 2e7], [0.7, 1e8]])?;
/// assert!((powder.yield_pressure(0.6) / 6e7 - 1.0).abs() < 1e-12);
/// // A cap that softens has no solution that is independent of the mesh.
/// assert!(DruckerPragerCap::new(2e9, 0.2, 0.5e6, 1.1, 0.6, vec![[0.0, 1e6], [0.5, 1e5]]).is_err());
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Record", into = "Record")]
pub struct DruckerPragerCap {
    moduli: Moduli,
    cohesion: f64,
    slope: f64,
    friction_angle: f64,
    eccentricity: f64,
    hardening: Vec<[f64; 2]>,
}

impl DruckerPragerCap {
    /// The powder with `cohesion` in Pa, `friction_angle` in rad and `hardening` as pairs of compaction and yield
    /// pressure in Pa, with straight lines between; the last line goes on.
    ///
    /// # Errors
    /// [`FemError::Parameter`] unless young > 0, -1 < poisson < 0.5, cohesion >= 0, 0 < friction_angle < pi/2,
    /// eccentricity > 0, and `hardening` has at least two pairs that begin at a compaction of 0 with a pressure
    /// > 0, and of which both numbers rise.
    pub fn new(
        young: f64,
        poisson: f64,
        cohesion: f64,
        friction_angle: f64,
        eccentricity: f64,
        hardening: Vec<[f64; 2]>,
    ) -> Result<Self, FemError> {
        let moduli = Moduli::new(young, poisson)?;
        check("cohesion", cohesion, cohesion >= 0.0, "finite and >= 0 Pa")?;
        let acute = friction_angle > 0.0 && friction_angle < FRAC_PI_2;
        let allowed = "above 0 and below pi/2, in rad";
        check("friction_angle", friction_angle, acute, allowed)?;
        let round = eccentricity > 0.0;
        check("eccentricity", eccentricity, round, "finite and > 0")?;
        check_hardening(&hardening)?;
        Ok(Self {
            moduli,
            cohesion,
            slope: friction_angle.tan(),
            friction_angle,
            eccentricity,
            hardening,
        })
    }

    /// The elastic moduli of the powder, per present volume.
    #[must_use]
    pub fn moduli(&self) -> &Moduli {
        &self.moduli
    }

    /// p_b, Pa, at the compaction `kappa`.
    #[must_use]
    pub fn yield_pressure(&self, kappa: f64) -> f64 {
        let (line, _) = self.line(self.segment(kappa));
        line[0] + line[1] * kappa
    }

    /// The line of the table that holds `kappa`.
    fn segment(&self, kappa: f64) -> usize {
        let inner = &self.hardening[1..self.hardening.len() - 1];
        inner.partition_point(|knot| knot[0] <= kappa)
    }

    /// p_b at a compaction of 0 and its slope on the line `segment`, and the compaction at its end.
    fn line(&self, segment: usize) -> ([f64; 2], f64) {
        let ([x, y], [end, top]) = (self.hardening[segment], self.hardening[segment + 1]);
        let slope = (top - y) / (end - x);
        ([y - slope * x, slope], end)
    }

    /// p_a of a yield pressure.
    fn centre(&self, yield_pressure: f64) -> f64 {
        let r = self.eccentricity;
        (yield_pressure - r * self.cohesion) / (1.0 + r * self.slope)
    }

    /// The return to the cap of a trial stress (p, q) beyond it, from the compaction `kappa`.
    ///
    /// With lambda the flow over the gradient (p - p_a, R^2 q), u = p - p_a, and p_a on a straight line of slope h in
    /// kappa, u = u_0/(1 + (K + h) lambda), q = q_0/(1 + 3 mu R^2 lambda) and d kappa = lambda u. The yield function is
    /// convex and falls with lambda, so that Newton's iterates from 0 increase towards its root and never pass it; they
    /// double at least, then converge quadratically. Where the root is beyond the end of a line of the table, the
    /// next line goes on from there.
    fn to_cap(&self, p: f64, q: f64, kappa: f64) -> Yielding {
        let mut cap = Cap::new(self, p, q, kappa, self.segment(kappa));
        let last = self.hardening.len() - 2;
        let mut lambda = 0.0;
        for segment in self.segment(kappa)..last {
            let growth = self.line(segment).1 - kappa;
            let Some(end) = cap.at_growth(growth) else {
                break;
            };
            if cap.value(end).0 <= 0.0 {
                break;
            }
            lambda = end;
            cap = Cap::new(self, p, q, kappa, segment + 1);
        }
        // Twenty for a trial stress a million times beyond the cap.
        const STEPS: usize = 200;
        for _ in 0..STEPS {
            let (value, slope) = cap.value(lambda);
            let step = -value / slope;
            if step.is_nan() || step <= f64::EPSILON * lambda {
                break;
            }
            lambda += step;
        }
        cap.end(lambda)
    }

    /// The end of a step from the compaction `kappa` whose stress is `end`.
    fn at(&self, trial: &[f64; 3], kappa: f64, end: &Yielding) -> Returned {
        let Moduli { bulk, shear, .. } = self.moduli;
        let (dilation, deviator) = split(trial);
        let size = deviator.iter().map(|e| e * e).sum::<f64>().sqrt();
        let trial_q = 6.0_f64.sqrt() * shear * size;
        let shrink = if trial_q > 0.0 {
            end.q / trial_q
        } else {
            end.shrink
        };
        let normal = deviator.map(|e| if size > 0.0 { e / size } else { 0.0 });
        let scale = (-kappa - end.growth).exp();
        let stress = deviator.map(|e| 2.0 * shear * shrink * e - end.p);
        let [[pp, pq], [qp, qq]] = end.slopes;
        let mut moduli = isotropic(bulk * pp, 2.0 * shear * shrink);
        let along = 2.0 * shear * (qq - shrink);
        let (root, rise) = ((2.0_f64 / 3.0).sqrt(), 6.0_f64.sqrt() * shear);
        // d kappa = (d trial p - d p)/K, where the cap flows.
        let grows = if end.growth > 0.0 { 1.0 } else { 0.0 };
        let swell = [grows * (1.0 - pp), grows * pq * rise / bulk];
        for (i, row) in moduli.iter_mut().enumerate() {
            for (entry, m) in row.iter_mut().zip(normal) {
                *entry += along * normal[i] * m - root * bulk * qp * normal[i] - rise * pq * m;
                *entry = scale * (*entry + stress[i] * (swell[0] + swell[1] * m));
            }
        }
        let elastic = deviator.map(|e| shrink * e - end.p / (3.0 * bulk));
        // By the stress; and by the energy of what is compacted.
        let dilated = dilation + end.p / bulk;
        let sheared = (2.0_f64 / 3.0).sqrt() * size * (1.0 - shrink);
        let stored = log_strain::stored(&self.moduli, &elastic);
        Returned {
            stress: stress.map(|t| scale * t),
            moduli,
            shear_secant: scale * 2.0 * shear * shrink,
            elastic,
            hardening: kappa + end.growth,
            plastic_work: scale
                * (end.q * sheared - end.p * dilated + end.growth.exp_m1() * stored),
            flows: true,
        }
    }
}

/// A stress on the yield surface.
struct Yielding {
    p: f64,
    q: f64,
    /// q over its trial value, which may be 0.
    shrink: f64,
    /// d (p, q) / d (trial p, q).
    slopes: [[f64; 2]; 2],
    /// The compaction since the trial state.
    growth: f64,
}

/// The cap that moves along a straight line of the table, as a function of lambda.
struct Cap<'a> {
    law: &'a DruckerPragerCap,
    /// Trial values of p - p_a, with p_a extended to no growth along the line, and of q.
    trial: [f64; 2],
    /// p_a without growth and its slope h.
    centre: [f64; 2],
    /// K + h and 3 mu R^2.
    rates: [f64; 2],
}

impl<'a> Cap<'a> {
    fn new(law: &'a DruckerPragerCap, p: f64, q: f64, kappa: f64, segment: usize) -> Self {
        let ([start, slope], _) = law.line(segment);
        let centre = law.centre(start + slope * kappa);
        let h = slope / (1.0 + law.eccentricity * law.slope);
        let r2 = law.eccentricity * law.eccentricity;
        Self {
            law,
            trial: [p - centre, q],
            centre: [centre, h],
            rates: [law.moduli.bulk + h, 3.0 * law.moduli.shear * r2],
        }
    }

    /// lambda where the compaction has grown by `growth`, unless p would be below p_a by then.
    fn at_growth(&self, growth: f64) -> Option<f64> {
        let left = self.trial[0] - self.rates[0] * growth;
        (left > 0.0).then_some(growth / left)
    }

    /// p - p_a, q and p_a.
    fn state(&self, lambda: f64) -> [f64; 3] {
        let u = self.trial[0] / (1.0 + self.rates[0] * lambda);
        let q = self.trial[1] / (1.0 + self.rates[1] * lambda);
        [u, q, self.centre[0] + self.centre[1] * lambda * u]
    }

    /// Slopes of the yield function by u and by q, with the motion of p_a at fixed lambda in the first.
    fn normal(&self, lambda: f64) -> ([f64; 2], f64) {
        let [u, q, _] = self.state(lambda);
        let r = self.law.eccentricity;
        let size = norm(u, r * q);
        let moves = r * self.law.slope * self.centre[1];
        ([u / size - moves * lambda, r * r * q / size], moves * u)
    }

    /// The yield function and its slope.
    fn value(&self, lambda: f64) -> (f64, f64) {
        let [u, q, centre] = self.state(lambda);
        let r = self.law.eccentricity;
        let value = norm(u, r * q) - r * (self.law.cohesion + centre * self.law.slope);
        let (normal, moves) = self.normal(lambda);
        let [a, b] = self.rates.map(|rate| rate / (1.0 + rate * lambda));
        (value, -(normal[0] * u * a + normal[1] * q * b + moves))
    }

    /// The stress at the root, with derivatives at which the yield function stays 0.
    fn end(&self, lambda: f64) -> Yielding {
        let [u, q, centre] = self.state(lambda);
        let ([by_u, by_q], _) = self.normal(lambda);
        let [a, b] = self.rates.map(|rate| 1.0 + rate * lambda);
        let hard = -self.value(lambda).1;
        let by_trial = [by_u / a / hard, by_q / b / hard];
        let along = [self.law.moduli.bulk * u / a, self.rates[1] * q / b];
        let mut slopes = along.map(|way| by_trial.map(|by| -way * by));
        slopes[0][0] += (1.0 + self.centre[1] * lambda) / a;
        slopes[1][1] += 1.0 / b;
        Yielding {
            p: centre + u,
            q,
            shrink: 1.0 / b,
            slopes,
            growth: lambda * u,
        }
    }
}

fn norm(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

fn check_hardening(table: &[[f64; 2]]) -> Result<(), FemError> {
    let pairs = table.len() as f64;
    let allowed = "at least 2, in pairs with the compaction";
    check("yield pressures", pairs, table.len() >= 2, allowed)?;
    let (mut strain, mut pressure) = (f64::NEG_INFINITY, 0.0);
    for (row, &[x, y]) in table.iter().enumerate() {
        let rises = if row == 0 { x == 0.0 } else { x > strain };
        let allowed = "0 in the first pair and above the one before in all others";
        check("compaction", x, rises, allowed)?;
        let allowed = "above 0 Pa and above the one before: a cap that softens has no solution that is independent \
                       of the mesh";
        check("yield pressure", y, y > pressure, allowed)?;
        (strain, pressure) = (x, y);
    }
    Ok(())
}

impl LogStrain for DruckerPragerCap {
    fn moduli(&self, hardening: f64) -> Moduli {
        self.moduli.scaled((-hardening).exp())
    }

    fn return_map(&self, trial: &[f64; 3], kappa: f64) -> Returned {
        let Moduli { bulk, shear, .. } = self.moduli;
        let (dilation, deviator) = split(trial);
        let size = deviator.iter().map(|e| e * e).sum::<f64>().sqrt();
        let (p, q) = (-bulk * dilation, 6.0_f64.sqrt() * shear * size);
        let centre = self.centre(self.yield_pressure(kappa));
        let limit = self.cohesion + p * self.slope;
        let tension = -self.cohesion / self.slope;
        let reach = self.eccentricity * (self.cohesion + centre * self.slope);
        if p > centre && norm(p - centre, self.eccentricity * q) > reach {
            return self.at(trial, kappa, &self.to_cap(p, q, kappa));
        }
        if p < tension {
            let apex = Yielding {
                p: tension,
                q: 0.0,
                shrink: 0.0,
                slopes: [[0.0; 2]; 2],
                growth: 0.0,
            };
            return self.at(trial, kappa, &apex);
        }
        if p <= centre && q > limit {
            let sheared = Yielding {
                p,
                q: limit,
                shrink: limit / q,
                slopes: [[1.0, 0.0], [self.slope, 0.0]],
                growth: 0.0,
            };
            return self.at(trial, kappa, &sheared);
        }
        Returned::elastic(&LogStrain::moduli(self, kappa), trial, kappa)
    }
}

impl Material for DruckerPragerCap {
    fn name(&self) -> &str {
        "Drucker-Prager with a cap"
    }

    fn history_len(&self) -> usize {
        HISTORY
    }

    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        log_strain::respond(self, d, old, new)
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        log_strain::tangent(self, d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.moduli.wave()
    }

    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        log_strain::stiffness_bound(self, d, old)
    }
}

/// How the law is written in files.
#[derive(Serialize, Deserialize)]
#[serde(rename = "DruckerPragerCap", deny_unknown_fields)]
struct Record {
    young: f64,
    poisson: f64,
    cohesion: f64,
    friction_angle: f64,
    eccentricity: f64,
    hardening: Vec<[f64; 2]>,
}

impl From<DruckerPragerCap> for Record {
    fn from(law: DruckerPragerCap) -> Self {
        Self {
            young: law.moduli.young,
            poisson: law.moduli.poisson,
            cohesion: law.cohesion,
            friction_angle: law.friction_angle,
            eccentricity: law.eccentricity,
            hardening: law.hardening,
        }
    }
}

impl TryFrom<Record> for DruckerPragerCap {
    type Error = FemError;

    fn try_from(record: Record) -> Result<Self, FemError> {
        Self::new(
            record.young,
            record.poisson,
            record.cohesion,
            record.friction_angle,
            record.eccentricity,
            record.hardening,
        )
    }
}
