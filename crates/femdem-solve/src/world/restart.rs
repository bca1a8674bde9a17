//! One state as the beginning of another motion: the clock anew, other gravity, other motions.

use super::World;
use crate::error::SolveError;
use crate::guide::Guide;
use crate::ledger::Flows;
use crate::parameters::WorldParameters;
use femdem_contact::BodyId;
use femdem_fem::Drive;
use femdem_mesh::Vector3;

impl World {
    /// Starts the clock anew: time and steps are 0, and the [ledger](Self::restart_ledger) is empty. Bodies, contacts with
    /// their friction and frozen bodies stay as they are. What moves as prescribed is where it is, and its motion
    /// begins anew from there.
    pub fn restart_clock(&mut self) {
        let time = self.time;
        for (guide, base) in &mut self.wall_drives {
            *base = guide.now(0.0).base_of(&guide.now(time).place(base));
        }
        for body in &mut self.bodies {
            let place = body.place();
            if let Some((guide, base)) = body.driven.as_deref_mut() {
                let driven = guide.now(0.0);
                *base = driven.base_of(&place);
                body.follow(&driven, &place);
            }
        }
        for (body, motion) in self.bodies.iter().zip(&mut self.motions) {
            if body.driven.is_some() {
                *motion = body.motion();
            }
        }
        let deformables = self.deformables.iter_mut().flat_map(|d| &mut d.bodies);
        for body in deformables {
            body.boundary = body.boundary.restarted(time);
        }
        self.time = 0.0;
        self.steps = 0;
        // Pressures depend on time, and dashpots on the velocities of driven bodies.
        let moved = self.bodies.iter().any(|body| body.driven.is_some());
        self.loaded &= !moved && self.deformables.is_none();
        self.restart_ledger();
    }

    /// Begins the ledger anew: all energy now is its initial energy, and nothing has been exchanged or dissipated.
    pub fn restart_ledger(&mut self) {
        let now = self.ledger();
        self.flows = Flows {
            // What friction has dissipated is its work less what its springs hold.
            friction_work: -now.friction_springs,
            pending: self.flows.pending,
            last: [now.kinetic, 0.0, 0.0],
            ..Flows::default()
        };
        self.initial_energy = now.final_energy();
    }

    /// Replaces the acceleration of gravity (m/s^2). Frozen bodies wake, and the change of the potential energy is on the
    /// books as work.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn set_gravity(&mut self, gravity: Vector3) -> Result<(), SolveError> {
        let before = self.ledger().potential;
        self.replace(WorldParameters {
            gravity,
            ..self.parameters
        })?;
        self.wake_all();
        self.flows.work_in += self.ledger().potential - before;
        Ok(())
    }

    /// The prescribed motion of a wall; `None` for an unknown one, and for one that the host moves.
    #[must_use]
    pub fn wall_drive(&self, wall: u32) -> Option<Drive> {
        self.batch.wall(wall)?;
        self.wall_drives.get(wall as usize)?.0.drive()
    }

    /// The prescribed motion of a rigid body; `None` for a body that moves freely or is moved by the host, or an unknown one.
    #[must_use]
    pub fn body_drive(&self, id: BodyId) -> Option<Drive> {
        self.body(id)?.driven.as_deref()?.0.drive()
    }

    /// Gives a rigid body a new prescribed motion, counted from where it is now, or sets it free with the velocity that it
    /// has. The books are those of the free bodies: what a body has when it begins or ends to be free is work.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::Parameter`] for a drive out of range.
    pub fn drive_body(&mut self, id: BodyId, drive: Option<Drive>) -> Result<(), SolveError> {
        if let Some(drive) = &drive {
            drive.validate()?;
        }
        self.guide_body(id, drive.map(Guide::Drive))
    }

    pub(super) fn guide_body(
        &mut self,
        id: BodyId,
        guide: Option<Guide>,
    ) -> Result<(), SolveError> {
        self.not_shared("driving bodies")?;
        if guide.is_some() {
            self.refuse_adaptive(Some(id), "to move freely", "a prescribed motion")?;
        }
        let (i, time) = (self.known_body(id)?, self.time);
        self.restored()?;
        let gravity = self.parameters.gravity;
        let body = &mut self.bodies[i];
        let before = body.energy(&gravity);
        body.driven = None;
        if let Some(guide) = guide {
            let (driven, place) = (guide.now(time), body.place());
            body.driven = Some(Box::new((guide, driven.base_of(&place))));
            body.follow(&driven, &place);
        }
        body.rest.quiet_steps = 0;
        self.flows.work_in += body.energy(&gravity) - before;
        self.motions[i] = body.motion();
        let contact = &self.batch.shapes()[body.shape as usize];
        if guide.is_none() {
            let material = self.batch.material(id).unwrap_or_default();
            let laws = self.batch.laws().of(material);
            self.step_control.see(contact, body, laws);
            self.step_control.launch(body);
        }
        // What is bonded to it wakes with it.
        let mut piece = self.with_bonded_sleepers(&[id]);
        piece.retain(|&id| !self.batch.is_awake(id));
        self.wake(&piece);
        self.loaded = false;
        Ok(())
    }
}
