//! A run whose steps are taken elsewhere: by ranks that share its bodies.

use std::path::Path;

use femdem_solve::{Alone, Ledger, World};

use crate::Error;
use crate::run::depths::Depths;
use crate::run::measured::rounding_of_places;
use crate::run::{Ending, Run};

impl Run {
    /// Refuses implicit steps, which one rank would take alone.
    /// [`World::share_out`] says what worlds cannot be shared.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the entry of the scene.
    pub fn steps_elsewhere(&self) -> Result<(), Error> {
        let steps = self.simulation.world.parameters().time_step;
        if steps.implicit.is_none() {
            return Ok(());
        }
        Err(Error::Option {
            name: "implicit steps",
            value: "an entry of the scene".to_owned(),
            allowed: "not there in a run over several ranks: use `femdem run`",
        })
    }

    /// Time of the next row of the tables, the next frame or the end, s.
    #[must_use]
    pub fn next_due(&self) -> f64 {
        let row = self.next_row as f64 * self.scenario.history_interval();
        let frame = self.next_frame as f64 * self.scenario.frame_interval();
        row.min(frame).min(self.scenario.duration)
    }

    /// Goes on with a later state of the world: writes what is due, and ends the run if its time has come or its bodies rest.
    /// Unlike [`advance`](Self::advance) it does not notice bodies that have passed through thin ones.
    pub(super) fn go_on_with(
        &mut self,
        world: World,
        may_rest: bool,
        folder: &Path,
    ) -> Result<(), Error> {
        self.simulation.world = world;
        if self.simulation.world.time() >= self.scenario.duration {
            self.end_motion(Ending::Time);
        } else if may_rest && self.simulation.rest().at_rest {
            self.end_motion(Ending::Rest);
        }
        let simulation = &self.simulation;
        let depths = simulation.depths(self.deepest().depth, self.has_warned(), &mut Alone)?;
        let ledger = simulation.world.ledger();
        self.check(&depths, &ledger, rounding_of_places(&simulation.world))?;
        self.write_due(folder)
    }

    /// Whether it has warned of a deep contact.
    pub(super) fn has_warned(&self) -> bool {
        !self.warnings().is_empty()
    }

    /// Records the depths of the contacts of all bodies, and checks the step and the ledger.
    pub(super) fn check(
        &mut self,
        depths: &Depths,
        ledger: &Ledger,
        rounding: f64,
    ) -> Result<(), Error> {
        if self.simulation.world.steps() > 0 {
            self.scenario.check_step(self.time_step())?;
        }
        self.watch.see(depths, &self.simulation);
        self.close_books(ledger, rounding)
    }
}
