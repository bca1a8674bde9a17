//! Stepping a run to its end.

use std::path::Path;

use femdem_solve::Alone;

use crate::Error;
use crate::run::relaxation::Relaxing;
use crate::run::stillness::STEPS_BETWEEN_LOOKS;
use crate::run::{Ending, RelaxSummary, Run};

impl Run {
    /// Advances by at most `steps` steps, or to the end of the run, and writes frames and rows into `folder`
    /// when they are due. The end has a frame and a row, too. A relaxation continues in parts of up to 4,000
    /// steps, and has neither frames nor rows before its end.
    ///
    /// # Errors
    ///
    /// As [`Simulation::step`](crate::run::Simulation::step), and [`Error::View`].
    pub fn advance(&mut self, folder: &Path, steps: u64) -> Result<(), Error> {
        if self.ending.is_none() {
            self.write_due(folder)?;
        }
        let mut left = steps;
        while left > 0 && self.ending.is_none() {
            let taken = if self.relaxing.is_some() {
                self.relax_on()?
            } else {
                self.simulation.step()?;
                if self.simulation.world.steps() == 1 {
                    self.scenario.check_step(self.time_step())?;
                }
                self.look()?;
                self.allow_sleep();
                self.watch.look(&self.simulation)?;
                self.check_books()?;
                1
            };
            left = left.saturating_sub(taken);
            self.write_due(folder)?;
        }
        Ok(())
    }

    /// Performs a part of the relaxation; returns its steps.
    fn relax_on(&mut self) -> Result<u64, Error> {
        let entry = self.scenario.relax.unwrap_or_default();
        let Some(Relaxing { ending, so_far, .. }) = &mut self.relaxing else {
            return Ok(1);
        };
        let before = so_far.steps;
        *so_far = self.simulation.relax_on(&entry, so_far)?;
        if so_far.is_done(&entry) {
            self.ending = Some(*ending);
        }
        Ok((so_far.steps - before).max(1))
    }

    /// Checks whether the motion is over, and with it the run if there is no relaxation.
    fn look(&mut self) -> Result<(), Error> {
        if let Some(ending) = self.end_of_motion()? {
            self.end_motion(ending);
        }
        Ok(())
    }

    /// Ends the run or, where there is one, begins the relaxation.
    pub(super) fn end_motion(&mut self, ending: Ending) {
        if self.scenario.relax.is_some() {
            self.relaxing = Some(Relaxing {
                ending,
                time_step: self.simulation.world.time_step(),
                so_far: RelaxSummary::default(),
            });
        } else {
            self.ending = Some(ending);
        }
    }

    fn end_of_motion(&mut self) -> Result<Option<Ending>, Error> {
        let world = &self.simulation.world;
        if world.time() >= self.scenario.duration {
            return Ok(Some(Ending::Time));
        }
        let Some(rest) = self.scenario.rest else {
            return Ok(None);
        };
        if !world.steps().is_multiple_of(STEPS_BETWEEN_LOOKS) {
            return Ok(None);
        }
        let (now, energy) = (world.time(), world.kinetic_energy_on(&mut Alone)?);
        let more_to_come = self.is_more_to_come();
        let is_still = self.stillness.look(&rest, now, energy, more_to_come);
        Ok((is_still && self.simulation.rest().at_rest).then_some(Ending::Rest))
    }
}
