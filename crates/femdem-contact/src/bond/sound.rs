//! Whether a bond that was read is one.

use super::part::Part;
use super::state::{Bond, BondState, Side};
use crate::contact::Wrench;
use crate::generalized::Generalized;
use crate::glue::GlueLaw;

fn are_finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> bool {
    numbers.into_iter().all(|x| x.is_finite())
}

/// Finite and not negative.
fn is_amount(x: f64) -> bool {
    (0.0..f64::INFINITY).contains(&x)
}

impl Bond {
    /// Whether a bond that was read has finite numbers, amounts that are not negative and a law that is allowed.
    pub(crate) fn is_sound(&self) -> bool {
        let law = self.law.glue();
        let areas: f64 = self.parts.iter().map(|part| part.facet.area()).sum();
        self.law.check().is_ok()
            && (areas / self.area - 1.0).abs() < 1e-9
            && self.parts.iter().all(|part| part.is_sound(&law))
            && self.state.is_sound()
            && self.sides.iter().all(Side::is_sound)
            // Losses are differences of energies: rounding may take them below 0.
            && are_finite([&self.lost.glue, &self.lost.friction, &self.lost.pressure])
            && [self.delay, self.yielded, self.slid].into_iter().all(is_amount)
            && self.broken_at.is_none_or(f64::is_finite)
    }
}

impl Part {
    fn is_sound(&self, law: &GlueLaw) -> bool {
        let last = &self.last;
        are_finite(self.at.iter().flatten().flatten())
            && are_finite(last.openings.iter().chain(&last.slopes).flatten())
            && is_amount(last.energy)
            && self.facet.is_sound(law)
    }
}

impl BondState {
    fn is_sound(&self) -> bool {
        let vectors = [&self.centre, &self.normal, &self.force, &self.moment];
        are_finite(vectors.into_iter().flatten())
            && [self.tension, self.energy].into_iter().all(is_amount)
    }
}

impl Side {
    fn is_sound(&self) -> bool {
        let of_wrench = |w: &Wrench| are_finite(w.force.iter().chain(&w.torque));
        let Generalized {
            translation,
            coupling,
            turning,
        } = &self.stiffness;
        [&self.elastic, &self.damping].into_iter().all(of_wrench)
            && are_finite([translation, coupling, turning].into_iter().flatten())
            && is_amount(self.share)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bond, BondLaw, BondSection};
    use crate::{Frame, Motion};
    use femdem_mesh::Vector3;

    /// A bond that has softened, is pressed and slides.
    fn used() -> Bond {
        let section = BondSection::disc(Vector3::zeros(), Vector3::x(), 0.05).unwrap();
        let law = BondLaw {
            damping: 0.1,
            ..BondLaw::default()
        };
        let at = |x: f64, y: f64| Motion {
            inverse_mass: 1.0,
            ..Motion::fixed(Frame {
                position: Vector3::new(x, y, 0.0),
                ..Frame::identity()
            })
        };
        let mut bond = Bond::new([0, 1], &section, law, [&at(-0.1, 0.0), &at(0.1, 0.0)]).unwrap();
        bond.update([&at(-0.1, 0.0), &at(0.1 - 1e-5, 5e-5)]);
        assert!(bond.has_yielded() && !bond.is_broken() && bond.is_sound());
        bond
    }

    /// Every stored number that is not finite is found, wherever it is, and so are negative amounts.
    #[test]
    fn numbers_that_cannot_be_are_found() {
        let config = bincode::config::legacy();
        let good = bincode::serde::encode_to_vec(used(), config).unwrap();
        let mut found = 0;
        for at in 0..good.len() - 7 {
            let mut bytes = good.clone();
            bytes[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
            let read = bincode::serde::decode_from_slice::<Bond, _>(&bytes, config);
            let Ok((bond, _)) = read else {
                continue;
            };
            if format!("{bond:?}").contains("NaN") {
                found += 1;
                assert!(!bond.is_sound(), "byte {at}: {bond:?}");
            }
        }
        assert!(found > 500, "{found}");
        let faults: [fn(&mut Bond); 6] = [
            |bond| bond.delay = -1.0,
            |bond| bond.yielded = f64::INFINITY,
            |bond| bond.slid = -1e-9,
            |bond| bond.sides[1].share = -1.0,
            |bond| bond.state.energy = -1.0,
            |bond| bond.parts[2].last.energy = -1.0,
        ];
        for (k, fault) in faults.into_iter().enumerate() {
            let mut bond = used();
            fault(&mut bond);
            assert!(!bond.is_sound(), "fault {k}");
        }
    }
}
