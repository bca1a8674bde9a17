//! The penalty that a run chooses.

use std::collections::BTreeSet;

use femdem_pack::{penalty_under_adhesion, penalty_under_cohesion, penalty_under_stress};

use super::loads::{Loads, Placed, Tower};
use super::meets::{Meets, Met};
use super::{Behaviour, BodyEntry, Penalty, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;

/// Wanted mean depth of the contacts at rest, in circumscribed diameters.
const PENETRATION: f64 = 0.005;

/// Largest depth of an impact over the mean depth at rest.
const AT_IMPACT: f64 = 10.0;

/// Largest depth of an impact over the thickness of the body and of a wall of tetrahedra: the field rises over half of it.
const OF_THICKNESS: f64 = 0.25;

/// Local over mean stress of a pack.
const UNEVEN: f64 = 1.5;

/// Most that anything moves in a step, over the thickness of the thinnest body or wall.
const OF_STEP: f64 = 0.25;

/// How far a tower is from buckling on its contacts.
const MARGIN: f64 = 3.0;

/// The least penalty, unless a depth is asked for \[Pa\].
const LEAST: f64 = 1e6;

impl Loads {
    /// Bounds the step such that nothing moves in it by more than a part of the thinnest body or wall: it would pass through
    /// without a contact.
    ///
    /// # Errors
    ///
    /// As [`World::set_time_step`](femdem_solve::World::set_time_step).
    pub(super) fn bound_step(&self, simulation: &mut Simulation) -> Result<(), Error> {
        let each = || self.placed.iter();
        let thinnest = each().map(|body| 2.0 * body.field_depth);
        let thinnest = thinnest.fold(self.thinnest_wall, f64::min);
        let fastest = each().map(|body| self.speed_of(body)).fold(0.0, f64::max);
        let bound = OF_STEP * thinnest / fastest;
        let mut step = simulation.world.parameters().time_step;
        // Without speed or thin things the quotient is no number.
        if bound.is_finite() && step.largest.is_none_or(|given| given > bound) {
            step.largest = Some(bound);
            simulation.world.set_time_step(step)?;
        }
        Ok(())
    }
}

impl Scenario {
    /// Takes the penalty that the scene gives, or chooses one, before the first step.
    ///
    /// It is the largest of those that keep, for every rigid body that has it in a contact with anything that is there,
    /// - the depth on a face under what weighs on it,
    /// - the mean depth of a pack under its weight,
    /// - the depth of an impact at its fastest,
    /// - the depth on a face or of a ball under attraction,
    /// - a tower of one or several bodies from buckling,
    ///
    /// within `contact.penetration`, and at least 1 MPa where that is not given; and that gives adaptive bodies their contact ratios.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] if both a penalty and a penetration are given, or one is out of range.
    pub(super) fn set_penalty(
        &self,
        simulation: &mut Simulation,
        loads: &Loads,
    ) -> Result<(), Error> {
        let asked = self.contact.penetration;
        let has_ratio = |body: &BodyEntry| {
            body.behaviour == Behaviour::Adaptive && body.contact_ratio.is_some()
        };
        if self.contact.penalty.is_some() && self.body.iter().any(has_ratio) {
            let allowed =
                "the penalty of the scene is that of adaptive bodies: give one of the two";
            return Err(wrong(
                "contact-ratio",
                "given with contact.penalty",
                allowed,
            ));
        }
        if let Some(value) = self.contact.penalty {
            if asked.is_some() {
                return Err(Error::Option {
                    name: "contact.penetration",
                    value: "given with contact.penalty".to_owned(),
                    allowed: "give one of the two: a penalty decides the depth",
                });
            }
            simulation.penalty = Penalty {
                value,
                reason: "given".to_owned(),
            };
            return Ok(());
        }
        if let Some(depth) = asked.filter(|depth| !(1e-6..=0.05).contains(depth)) {
            return Err(Error::Option {
                name: "contact.penetration",
                value: depth.to_string(),
                allowed: "from 1e-6 to 0.05, in circumscribed diameters; 0.005 is usual",
            });
        }
        let depth = asked.unwrap_or(PENETRATION);
        let name = |member: usize| simulation.name_of_placed(member).to_owned();
        let mut best = match asked {
            Some(_) => (0.0, String::new()),
            None => (LEAST, "the least that is taken".to_owned()),
        };
        let mut try_it = |value: f64, reason: String| {
            if value.is_finite() && value > best.0 {
                best = (value, reason);
            }
        };
        let size = |depth: f64| format!("{:.2} % of its size", 100.0 * depth);
        let meets = Meets::of(self, simulation);
        // A pair with a penalty of its own does not ask for another one.
        let asks = |law: &Met| law.penalty.is_none();
        let asking = |body: &&Placed| meets.laws(body.material).iter().any(asks);
        let asking: Vec<&Placed> = loads.placed.iter().filter(asking).collect();
        for body in &asking {
            let name = name(body.member);
            let force = loads.force_on(body);
            try_it(
                of_weight(loads, body) / depth,
                format!("{name} under {force:.2e} N rests {} deep", size(depth)),
            );
            let speed = loads.speed_of(body);
            let deepest = loads.deepest(body, AT_IMPACT * depth);
            try_it(
                of_impact(loads, body) / deepest.powi(2),
                format!(
                    "{name} at {speed:.2} m/s goes at most {} deep",
                    size(deepest)
                ),
            );
            let stress = loads.stress;
            try_it(
                of_pack(loads, body) / depth.powi(3),
                format!(
                    "a pack under {stress:.2e} Pa is {} deep in the mean",
                    size(depth)
                ),
            );
        }
        for (penalty, name) in simulation.adaptive_penalties(self) {
            try_it(penalty, format!("{name} has its contact ratio"));
        }
        for body in &asking {
            for law in meets.laws(body.material).into_iter().filter(asks) {
                let (name, deep) = (name(body.member), size(depth));
                let Met {
                    cohesion,
                    adhesion_energy,
                    ..
                } = law;
                let [by_cohesion, by_adhesion] = of_attraction(body, &law, depth);
                try_it(
                    by_cohesion,
                    format!("{name} under a cohesion of {cohesion:.2e} Pa rests {deep} deep"),
                );
                try_it(
                    by_adhesion,
                    format!(
                        "{name} under an adhesion of {adhesion_energy:.2e} J/m² rests {deep} deep"
                    ),
                );
            }
        }
        let asking: BTreeSet<usize> = asking.iter().map(|body| body.member).collect();
        let towers = loads.towers();
        for tower in towers.iter().filter(|t| asking.contains(&t.member)) {
            let name = name(tower.member);
            let what = match tower.bodies {
                1 => name,
                several => format!("the stack of {several} bodies with {name}"),
            };
            try_it(
                MARGIN * of_tower(loads, tower),
                format!("{what} stands upright, with a margin of {MARGIN}"),
            );
        }
        if best.0 == 0.0 {
            best = (LEAST, "nothing weighs or moves".to_owned());
        }
        let mut contact = simulation.world.parameters().contact;
        contact.penalty = up(best.0);
        simulation.world.set_contact(contact)?;
        simulation.penalty = Penalty {
            value: contact.penalty,
            reason: best.1,
        };
        Ok(())
    }

    /// The depths that the rigid bodies of a scene are expected to reach under its penalty.
    #[must_use]
    pub fn forecast(&self, simulation: &Simulation) -> Forecast {
        let loads = Loads::of(self, simulation);
        let usual = simulation.penalty.value;
        let meets = Meets::of(self, simulation);
        let mut forecast = Forecast::default();
        for body in &loads.placed {
            let name = simulation.name_of_placed(body.member);
            let laws = meets.laws(body.material);
            let of = |law: &Met| law.penalty.unwrap_or(usual);
            let penalty = laws.iter().map(of).fold(f64::INFINITY, f64::min);
            for law in &laws {
                let [cohesion, adhesion] = of_attraction(body, law, 1.0);
                forecast.at_rest.see(cohesion / of(law), name);
                forecast.at_rest.see((adhesion / of(law)).sqrt(), name);
            }
            let face = of_weight(&loads, body) / penalty;
            forecast.at_rest.see(face, name);
            forecast
                .at_rest
                .see((of_pack(&loads, body) / penalty).cbrt(), name);
            // Those of a pack lie on one another.
            if body.member >= simulation.origin.bodies {
                let impact = (of_impact(&loads, body) / penalty).sqrt();
                forecast.at_impact.see(impact, name);
            }
        }
        forecast
    }
}

/// A depth that is expected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExpectedDepth {
    /// Depth in circumscribed diameters.
    pub depth: f64,
    /// Name of the body.
    pub body: String,
}

impl ExpectedDepth {
    fn see(&mut self, depth: f64, name: &str) {
        if depth > self.depth {
            *self = Self {
                depth,
                body: name.to_owned(),
            };
        }
    }
}

/// The largest depths that are expected of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forecast {
    /// Under the weights.
    pub at_rest: ExpectedDepth,
    /// At the fastest impact that start, fall and prescribed motions allow, of bodies that are not of a pack.
    pub at_impact: ExpectedDepth,
}

impl Loads {
    /// Force that weighs on a body at most \[N\]: its weight and, over its footprint, that of all others; at most all together.
    fn force_on(&self, body: &Placed) -> f64 {
        (body.mass * self.gravity + self.stress * body.footprint()).min(self.weight)
    }

    /// Fastest impact of a body \[m/s\].
    fn speed_of(&self, body: &Placed) -> f64 {
        body.speed + (2.0 * self.gravity * body.drop).sqrt() + self.driven
    }

    /// The wanted depth, and at most a part of the thickness of the body and of the thinnest wall of tetrahedra, in diameters of the
    /// body.
    fn deepest(&self, body: &Placed, wanted: f64) -> f64 {
        let thickness = self.thinnest_wall.min(2.0 * body.field_depth);
        wanted.min(OF_THICKNESS * thickness / body.diameter)
    }
}

/// The next larger number of two digits.
fn up(value: f64) -> f64 {
    let digit = 10_f64.powf(value.log10().floor() - 1.0);
    (value / digit).ceil() * digit
}

/// Penalty times depth/d. Two prisms on faces of the area A with the field depth R have the force p A depth/R, a prism on a floor twice
/// as much, and the volume is 2 A R: p = 2 F R²/(V depth) holds both.
fn of_weight(loads: &Loads, body: &Placed) -> f64 {
    2.0 * loads.force_on(body) * body.field_depth.powi(2) / (body.volume * body.diameter)
}

/// Penalty times (depth/d)³ of a pack, with a margin for a stress that is uneven.
fn of_pack(loads: &Loads, body: &Placed) -> f64 {
    if loads.placed.len() < 2 {
        return 0.0;
    }
    let field_depth = body.field_depth / body.diameter;
    penalty_under_stress(UNEVEN * loads.stress, 1.0, field_depth)
}

/// Penalty times (depth/d)². The energy of an overlap of the area A with a floor is p A depth²/R. The least area that a body touches
/// with is that of an edge, R d, and its mass is then of order m/V times R d²: p is at least (m/V) v² R d/(2 depth²). A corner and a
/// body that is struck go deeper by up to the root of 2: p = (m/V) v² R d/depth².
fn of_impact(loads: &Loads, body: &Placed) -> f64 {
    let density = body.mass / body.volume;
    density * loads.speed_of(body).powi(2) * body.field_depth / body.diameter
}

/// Penalties at which a body rests at a depth over d by its cohesion and by its adhesion.
fn of_attraction(body: &Placed, law: &Met, depth: f64) -> [f64; 2] {
    let (deep, rise) = (depth * body.diameter, body.field_depth);
    [
        penalty_under_cohesion(law.cohesion, rise, deep),
        penalty_under_adhesion(law.adhesion_energy, rise, deep),
    ]
}

/// A prism of height L and width w on a floor has the stiffness 2 p A/(L/2) w²/12 against turning over and the moment rho g A L²/2: it
/// stands if p > 1.5 rho g L³/w². A stack of bodies bends as a column: p > 3 rho g L³/(7.84 w²).
fn of_tower(loads: &Loads, tower: &Tower) -> f64 {
    let load = tower.density * loads.gravity * tower.height.powi(3) / tower.width.powi(2);
    match tower.bodies {
        1 => 1.5 * load,
        _ => 3.0 / 7.84 * load,
    }
}

#[cfg(test)]
mod tests {
    use super::up;

    #[test]
    fn penalties_are_rounded_up_to_two_digits() {
        for (value, wanted) in [
            (1.01e6, 1.1e6),
            (9.91e6, 1e7),
            (2.0e7, 2.0e7),
            (1.234e-3, 1.3e-3),
        ] {
            assert!(
                (up(value) / wanted - 1.0).abs() < 1e-12,
                "{value}: {}",
                up(value)
            );
        }
    }
}
