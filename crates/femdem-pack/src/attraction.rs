//! What attraction asks of the penalty of a pack.

use crate::pair_law::PairLaw;
use crate::penalty::{penalty_under_adhesion, penalty_under_cohesion};
use crate::spec::PackSpec;
use femdem_contact::ContactParameters;

impl PackSpec {
    /// The penalty (Pa) at which attraction alone lets the contacts have the mean penetration `depth`, m. Pairs with a penalty of
    /// their own are left out: they do not have the one that is looked for.
    pub(crate) fn penalty_of_attraction(&self, depth: f64) -> f64 {
        let usual = self.contact(1.0);
        let walls = std::iter::once(self.wall_material);
        let met = |law: &ContactParameters, rise: f64| {
            let cohesion = penalty_under_cohesion(law.cohesion, rise, depth);
            cohesion + penalty_under_adhesion(law.work_of_adhesion(), rise, 2.0 * depth)
        };
        let needs = self.shapes.iter().flat_map(|shape| {
            let rise = shape.rise();
            let others = self.shapes.iter().map(|other| other.material);
            others.chain(walls.clone()).filter_map(move |other| {
                let of = |pair: &&PairLaw| pair.is_of([shape.material, other]);
                match self.pairs.iter().find(of) {
                    Some(pair) if pair.penalty.is_some() => None,
                    Some(pair) => Some(met(&pair.over(&usual), rise)),
                    None => Some(met(&usual, rise)),
                }
            })
        });
        needs.fold(0.0, f64::max)
    }
}
