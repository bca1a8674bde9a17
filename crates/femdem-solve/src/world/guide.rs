//! Walls and bodies that the host moves, step by step.

use super::World;
use crate::error::SolveError;
use crate::guide::{Guide, check_driven};
use femdem_contact::{BodyId, Partner};
use femdem_fem::Driven;

impl World {
    /// Lets the host move a wall from now on: it says in every step where the wall is at its end
    /// ([`step_with`](Self::step_with)). `now` is where it says that the wall is now, counted from wherever it likes, and
    /// how it moves: for a motion that begins at rest where the wall is, the default. [`drive_wall`](Self::drive_wall)
    /// ends it.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown wall, [`SolveError::Parameter`] for a motion that is not finite.
    pub fn drive_wall_by_host(&mut self, wall: u32, now: Driven) -> Result<(), SolveError> {
        check_driven(&now)?;
        self.guide_wall(wall, Guide::host(now))
    }

    /// The same for a rigid body. Contacts do not move it then; its energy is on the books as [`drive_body`] has it, which
    /// ends it.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::Parameter`] for a motion that is not finite.
    ///
    /// [`drive_body`]: Self::drive_body
    pub fn drive_body_by_host(&mut self, id: BodyId, now: Driven) -> Result<(), SolveError> {
        check_driven(&now)?;
        self.guide_body(id, Some(Guide::host(now)))
    }

    /// Gives a wall a new prescribed motion, counted from where it is now.
    pub(super) fn guide_wall(&mut self, wall: u32, guide: Guide) -> Result<(), SolveError> {
        self.restored()?;
        let (w, time) = (self.known_wall(wall)?, self.time);
        let (old, base) = &mut self.wall_drives[w];
        let here = old.now(time).place(base);
        *base = guide.now(time).base_of(&here);
        *old = guide;
        Ok(())
    }

    /// Asks the host where what it moves will be at `end`, s.
    pub(super) fn ask(
        &mut self,
        end: f64,
        host: &mut dyn FnMut(Partner, f64) -> Option<Driven>,
    ) -> Result<(), SolveError> {
        let hosted = |guide: &Guide| matches!(guide, Guide::Host { .. });
        for (w, (guide, _)) in (0..).zip(&mut self.wall_drives) {
            if hosted(guide) {
                guide.follow(host(Partner::Wall(w), end))?;
            }
        }
        for &i in &self.awake {
            let driven = self.bodies[i as usize].driven.as_deref_mut();
            if let Some((guide, _)) = driven.filter(|(guide, _)| hosted(guide)) {
                guide.follow(host(Partner::Body(i), end))?;
            }
        }
        Ok(())
    }

    /// What the host moves has come to where it said.
    pub(super) fn arrive(&mut self) {
        self.wall_drives
            .iter_mut()
            .for_each(|(guide, _)| guide.arrive());
        for &i in &self.awake {
            if let Some((guide, _)) = self.bodies[i as usize].driven.as_deref_mut() {
                guide.arrive();
            }
        }
    }
}
