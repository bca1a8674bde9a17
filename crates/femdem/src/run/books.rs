//! Watch over the energy ledger of a run.

use super::Run;
use super::measured::rounding_of_places;
use crate::Error;
use femdem_solve::Ledger;

/// Steps between looks at the ledger: each takes a pass over bodies and contacts.
const EVERY: u64 = 256;

/// The error of the ledger over the energy turned over, above which a run says so at its end.
pub(super) const NOTED: f64 = 0.01;

/// The error above which a run stops, unless the scene has another limit.
pub(super) const LIMIT: f64 = 0.2;

/// What is lost to rounding, over the potential and initial energy.
const ROUNDING: f64 = 1e-9;

impl Run {
    /// Refuses to go on with a ledger that misses more than the scene's `energy-error-limit`.
    ///
    /// # Errors
    ///
    /// [`Error::Books`] with the error and what may help.
    pub(super) fn check_books(&self) -> Result<(), Error> {
        let world = &self.simulation().world;
        if !world.steps().is_multiple_of(EVERY) {
            return Ok(());
        }
        self.close_books(&world.ledger(), rounding_of_places(world))
    }

    /// The same of a ledger now, whatever the step; `rounding` is what rounding alone gives to deformable bodies \[J\].
    pub(super) fn close_books(&self, ledger: &Ledger, rounding: f64) -> Result<(), Error> {
        let (missing, limit) = (ledger.error_relative(), self.scenario().energy_error_limit);
        let rounding = ROUNDING * (ledger.potential.abs() + ledger.initial.abs()) + rounding;
        // Within an impact a large step has the energy of the contact and that of the motion at different times. What
        // the contacts store now is therefore no evidence.
        let sure = 1.0 - ((ledger.elastic + rounding) / ledger.error().abs()).min(1.0);
        if missing.abs() * sure <= limit {
            return Ok(());
        }
        Err(Error::Books {
            missing,
            time: self.simulation().world.time(),
            limit,
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::Usage;
    use crate::run::{Run, Scenario};

    const DROP: &str = "duration = 0.6
        sleeping = false
        contact.friction = 0
        contact.damping = 0
        time-step.safety = 0.3
        [material.m]
        density = 1000
        [[wall]]
        name = \"floor\"
        plane = { normal = [0, 0, 1] }
        [[body]]
        material = \"m\"
        shape = \"cube\"
        size = 0.1
        position = [0, 0, 0.15]
        ";

    /// A conservative bounce: the energy now is that of the start, and the error is measured by what has been
    /// exchanged between motion, height and contact.
    #[test]
    fn a_bounce_without_losses_closes_the_books() {
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(DROP).unwrap()).unwrap();
        run.advance(folder.path(), u64::MAX).unwrap();
        let ledger = run.simulation().world.ledger();
        assert!(ledger.exchanged > 1.0 * ledger.kinetic, "{ledger:?}");
        let summary = run.finish(folder.path(), &Usage::default()).unwrap();
        let missing = summary.energy.ledger_error_relative;
        assert!(missing.abs() < 3e-3, "{missing}");
        assert!(!summary.to_string().contains("above"), "{summary}");
    }

    /// A body that nothing touches yet has the energy of rounding alone, which is no error of the ledger.
    #[test]
    fn bodies_that_nothing_touches_yet_are_no_error() {
        let text = "duration = 2e-5
            gravity = [0, 0, 0]
            [material.m]
            density = 1600
            law = \"neo-hookean\"
            young = 5e9
            poisson = 0.2
            [[body]]
            shape = \"A13\"
            diameter = 0.004
            material = \"m\"
            behaviour = \"deformable\"
            position = [0.02, 0.01, 0.01]
            rotation = { axis = [3, 2, 1], angle = 20 }
            ";
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
        run.advance(folder.path(), u64::MAX).unwrap();
        let world = &run.simulation().world;
        assert!(world.steps() > super::EVERY);
        let ledger = world.ledger();
        assert!(ledger.kinetic < 1e-20);
        // Without the allowance the run would have been refused.
        assert!(ledger.error_relative().abs() > super::LIMIT, "{ledger:?}");
    }

    #[test]
    fn a_run_stops_where_its_books_do_not_close() {
        let text = format!("energy-error-limit = 1e-9\n{DROP}");
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        let message = run
            .advance(folder.path(), u64::MAX)
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("energy-error-limit = 0.000000001"),
            "{message}"
        );
        let text = format!("energy-error-limit = -1\n{DROP}");
        let refused = Run::new(Scenario::from_toml(&text).unwrap()).err().unwrap();
        assert!(refused.to_string().contains("energy-error-limit = -1"));
    }
}
