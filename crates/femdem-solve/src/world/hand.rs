//! What a host does by hand, at any time between steps: it removes bodies and walls, puts bodies elsewhere, sets their
//! velocities, and loads them.
//!
//! Contacts of what is removed or put elsewhere end with their friction history. What touched it is judged anew, and wakes.
//! The energy that comes and goes is in [`Ledger::by_hand`](crate::Ledger::by_hand).

use super::World;
use crate::applied::AppliedLoad;
use crate::body::{Body, check_velocities};
use crate::error::{SolveError, check};
use crate::guide::Guide;
use crate::halo::Halo;
use femdem_contact::{BodyId, Contact, Frame, Motion, Partner, Wrench};
use femdem_mesh::{Pose, Vector3, checked_pose};

/// Energies of contacts, J.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Stored {
    pub elastic: f64,
    springs: f64,
}

impl Stored {
    pub(super) fn of<'a>(contacts: impl Iterator<Item = &'a Contact>) -> Self {
        contacts.fold(Self::default(), |sum, contact| Self {
            elastic: sum.elastic + contact.potential(),
            springs: sum.springs + contact.spring_energy,
        })
    }
}

impl World {
    /// Removes a body, rigid or deformable, with its contacts and bonds. What it touched wakes. The index is given to the next
    /// body that is added, unless a lower one is free; until then it names no body.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, and after [implicit](crate::ImplicitStep) steps, whose contacts are
    /// evaluated first, the errors of [`World::step`].
    pub fn remove_body(&mut self, id: BodyId) -> Result<(), SolveError> {
        self.not_shared("removing bodies by one rank")?;
        self.take_away(id)
    }

    /// Removes a body here; of a guest its owner books what it has.
    pub(super) fn take_away(&mut self, id: BodyId) -> Result<(), SolveError> {
        self.known(id)?;
        self.evaluate_pending()?;
        let i = id as usize;
        let stored = self.stored_by(Partner::Body(id));
        self.flows.by_hand -= self.batch.stored_in_bonds(id);
        let energy = self.forget_nodes(id);
        let energy = energy.unwrap_or_else(|| self.bodies[i].energy(&self.parameters.gravity));
        if !self.is_guest(id) {
            self.flows.by_hand -= energy;
        }
        let touched = self.batch.remove_body(id)?;
        self.bodies[i] = Body::vacant();
        self.motions[i] = Motion::fixed(Frame::identity());
        self.awake.retain(|&other| other != id);
        self.newcomers.forget(Partner::Body(id));
        self.forget_adaptive(id);
        self.step_control.lose();
        self.book_ended(stored, &touched);
        Ok(())
    }

    /// A body of other ranks was removed.
    pub(super) fn note_removal(&mut self) -> Result<(), SolveError> {
        self.evaluate_pending()?;
        self.step_control.lose();
        self.loaded = false;
        Ok(())
    }

    /// Removes a wall and its contacts. What touched it wakes. The index is given to the next wall that is added, unless a
    /// lower one is free; until then it names no wall.
    ///
    /// # Errors
    /// As [`World::remove_body`].
    pub fn remove_wall(&mut self, wall: u32) -> Result<(), SolveError> {
        self.not_shared("removing walls by one rank")?;
        self.take_wall_away(wall)
    }

    pub(super) fn take_wall_away(&mut self, wall: u32) -> Result<(), SolveError> {
        let w = self.known_wall(wall)?;
        self.evaluate_pending()?;
        let stored = self.stored_by(Partner::Wall(wall));
        let touched = self.batch.remove_wall(wall)?;
        self.wall_drives[w] = (Guide::FIXED, Pose::identity());
        self.wall_motions[w] = Motion::fixed(Frame::identity());
        self.newcomers.forget(Partner::Wall(wall));
        self.book_ended(stored, &touched);
        Ok(())
    }

    /// Puts a rigid body somewhere else, with its velocity and angular velocity: `pose` maps the coordinates of its shape's
    /// polyhedron to the world. Its contacts and bonds end, even if it hardly moves; it and what it touched wake.
    /// A driven body follows its drive on from there.
    ///
    /// # Errors
    /// As [`World::remove_body`], and [`SolveError::Mesh`] for a pose that is none.
    pub fn set_pose(&mut self, id: BodyId, pose: Pose) -> Result<(), SolveError> {
        self.not_shared("moving bodies by hand")?;
        let i = self.known_body(id)?;
        let pose = checked_pose(&pose)?;
        self.evaluate_pending()?;
        let stored = self.stored_by(Partner::Body(id));
        self.flows.by_hand -= self.batch.stored_in_bonds(id);
        let mut touched = self.batch.moved_by_hand(id)?;
        let (gravity, time) = (self.parameters.gravity, self.time);
        let body = &mut self.bodies[i];
        let (before, turn) = (body.energy(&gravity), body.angular_velocity());
        let place = self.shapes[body.shape as usize].place(&pose);
        if let Some((guide, base)) = body.driven.as_deref_mut() {
            let driven = guide.now(time);
            *base = driven.base_of(&place);
            body.follow(&driven, &place);
        } else {
            body.position = place.translation.vector;
            body.orientation = place.rotation;
            body.turn_at(&turn);
        }
        self.flows.by_hand += body.energy(&gravity) - before;
        self.motions[i] = body.motion();
        self.newcomers.moved.bodies.insert(id);
        touched.push(id);
        self.book_ended(stored, &touched);
        Ok(())
    }

    /// Sets the velocity of a rigid body's centroid (m/s) and its angular velocity (rad/s), in world axes. It wakes. Its
    /// contacts keep their friction.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::Driven`] for a driven one, [`SolveError::Parameter`] for
    /// a velocity that is not finite.
    pub fn set_velocity(
        &mut self,
        id: BodyId,
        velocity: Vector3,
        angular_velocity: Vector3,
    ) -> Result<(), SolveError> {
        self.not_shared("moving bodies by hand")?;
        let i = self.known_body(id)?;
        self.restored()?;
        check_velocities(&velocity, &angular_velocity)?;
        let body = &mut self.bodies[i];
        if body.driven.is_some() {
            return Err(SolveError::Driven { body: i });
        }
        let before = body.kinetic_energy();
        body.velocity = velocity;
        body.turn_at(&angular_velocity);
        self.flows.by_hand += body.kinetic_energy() - before;
        self.step_control.launch(body);
        self.motions[i] = body.motion();
        // The recorded dashpot forces belong to the earlier velocity.
        self.loaded = false;
        self.stir(&[id]);
        Ok(())
    }

    /// Loads a body with a force (N) and, if it is rigid, a torque about its centroid (N m), in world axes, until they are
    /// changed; an [`AppliedLoad`] may also follow a rigid body as it turns. Gravity acts besides. On a deformable body the force
    /// is distributed by mass, as gravity is; forces on a part of it are conditions of its [boundary](World::set_boundary). The
    /// body wakes if the load changes. The work is [`Ledger::load_work`](crate::Ledger::load_work). While a body follows a drive,
    /// the drive bears its load, which then does no work on anything in the world.
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, [`SolveError::Parameter`] for a load that is not finite, and for a torque
    /// on a deformable body or a load that follows one.
    pub fn set_load(&mut self, id: BodyId, load: impl Into<AppliedLoad>) -> Result<(), SolveError> {
        self.not_shared("loading bodies by one rank")?;
        self.load_own(id, load.into())
    }

    /// As [`set_load`](Self::set_load), of bodies by their numbers in the whole, in a world that is
    /// [shared out](Self::share_out), by all ranks: each loads those that belong to it, and leaves out numbers that it does not know.
    ///
    /// # Errors
    /// As [`set_load`](Self::set_load), and what `halo` reports.
    pub fn set_loads_on(
        &mut self,
        loads: &[(BodyId, AppliedLoad)],
        halo: &mut dyn Halo,
    ) -> Result<(), SolveError> {
        self.fits(halo)?;
        for &(number, load) in loads {
            if let Some(id) = self.number_here(number).filter(|id| !self.is_guest(*id)) {
                self.load_own(id, load)?;
            }
        }
        // Some have woken.
        self.tell_rest(halo)
    }

    fn load_own(&mut self, id: BodyId, load: AppliedLoad) -> Result<(), SolveError> {
        let [force, torque] = load.largest();
        check("force", force, true, "finite, in N")?;
        check("torque", torque, true, "finite, in N m")?;
        self.restored()?;
        if self.batch.is_deformable(id) {
            check(
                "load that turns with the body",
                torque + load.turning.force.norm(),
                !load.follows(),
                "of rigid bodies only: a force on a deformable body keeps its direction",
            )?;
            return self.pull_deformable(id, &load.fixed);
        }
        let i = self.known_body(id)?;
        if torque > 0.0 || load.follows() {
            self.refuse_adaptive(
                Some(id),
                "loads without a torque",
                "a torque, or a load that turns with it",
            )?;
        }
        let body = &mut self.bodies[i];
        if body.set_load(&load, &self.shapes[body.shape as usize]) {
            self.stir(&[id]);
        }
        Ok(())
    }

    /// The external load of a body about its centroid in world axes as it is now, set by [`set_load`](Self::set_load).
    pub fn applied_load(&self, id: BodyId) -> Option<Wrench> {
        if let Some(body) = self.deformable(id) {
            return Some(Wrench {
                force: body.applied_load(),
                torque: Vector3::zeros(),
            });
        }
        self.body(id).map(Body::applied)
    }

    pub(super) fn known(&self, id: BodyId) -> Result<(), SolveError> {
        if self.batch.contains(id) {
            return Ok(());
        }
        Err(self.no_such("body", id, self.body_count()))
    }

    /// The place of a rigid body in the lists.
    pub(super) fn known_body(&self, id: BodyId) -> Result<usize, SolveError> {
        if self.batch.is_rigid(id) {
            return Ok(id as usize);
        }
        self.known(id)?;
        Err(self.no_such("rigid body", id, self.rigid_count()))
    }

    fn no_such(&self, what: &'static str, index: u32, count: usize) -> SolveError {
        SolveError::NoSuch {
            what,
            index: index as usize,
            count,
        }
    }

    pub(super) fn known_wall(&self, wall: u32) -> Result<usize, SolveError> {
        if self.batch.wall(wall).is_some() {
            return Ok(wall as usize);
        }
        Err(SolveError::NoSuch {
            what: "wall",
            index: wall as usize,
            count: self.walls().count(),
        })
    }

    /// The contacts of the present positions, if those on record are of an implicit step, which books what they store in
    /// the next one.
    pub(super) fn evaluate_pending(&mut self) -> Result<(), SolveError> {
        self.restored()?;
        if self.flows.pending.is_some() {
            self.evaluate_if_due()?;
        }
        Ok(())
    }

    /// What the contacts of a body or a wall store that are on the books here.
    pub(super) fn stored_by(&self, thing: Partner) -> Stored {
        let contacts = match thing {
            Partner::Body(id) => self.contacts_of(id),
            Partner::Wall(_) => self.contacts(),
        };
        let booked = |contact: &&Contact| contact.has_side(thing) && !self.is_guest(contact.b);
        Stored::of(contacts.iter().filter(booked))
    }

    /// What a deformable body stores where it touches itself.
    pub(super) fn stored_within(&self, id: BodyId) -> Stored {
        let itself = Partner::Body(id);
        let contacts = self.deformable_contacts();
        Stored::of(contacts.filter(|contact| contact.a == itself && contact.b == id))
    }

    /// Books what contacts held that have ended by hand, and judges the bodies anew that they held.
    pub(super) fn book_ended(&mut self, stored: Stored, touched: &[BodyId]) {
        self.flows.by_hand -= stored.elastic + stored.springs;
        // What friction has dissipated is its work less what its springs hold.
        self.flows.friction_work += stored.springs;
        self.loaded = false;
        self.judge_anew(touched);
    }

    /// Judges rigid and deformable bodies of this rank anew, and wakes those of them that are asleep: what holds them has changed.
    pub(super) fn judge_anew(&mut self, touched: &[BodyId]) {
        let own = touched.iter().filter(|body| !self.is_guest(**body));
        let (soft, rigid): (Vec<BodyId>, Vec<BodyId>) =
            own.partition(|body| self.batch.is_deformable(**body));
        if let Some(deformables) = &mut self.deformables {
            for body in soft {
                deformables.wake(body as usize, &mut self.batch);
            }
        }
        self.stir(&rigid);
    }
}
