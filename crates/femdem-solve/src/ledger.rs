//! The energy ledger: all energy put in, stored and dissipated.

use crate::world::CrackFlows;
use serde::{Deserialize, Serialize};
use std::ops::AddAssign;

/// What bonds have exchanged, J.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct BondFlows {
    /// Dissipated by their glue.
    pub glue: f64,
    /// Dissipated by the friction of their broken points.
    pub friction: f64,
    /// Lost where bonds ended: what they held, less what the contacts that took over do.
    pub released: f64,
    /// Where these hold more than the bonds did.
    pub lent: f64,
}

/// Flows of energy that accumulate while a world steps, J.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Flows {
    /// Work of driven walls and bodies.
    pub work_in: f64,
    /// See [`Ledger::by_hand`].
    pub by_hand: f64,
    /// Work of external loads.
    pub load_work: f64,
    /// Work of the normal dashpots (negative: taken out).
    pub damping_work: f64,
    /// Work of friction, springs included (negative: taken out).
    pub friction_work: f64,
    /// Work of drag and local damping (negative: taken out).
    pub medium_work: f64,
    /// Work of viscous stresses inside bodies (negative: taken out).
    pub viscous_work: f64,
    /// Work of plastic flow inside bodies (negative: taken out).
    pub plastic_work: f64,
    /// Held by liquid bridges when they broke.
    pub broken: f64,
    /// What the cracks of bodies exchanged.
    pub cracks: CrackFlows,
    /// What bonds exchanged.
    pub bonds: BondFlows,
    /// See [`Ledger::fidelity`].
    pub fidelity: f64,
    /// Numerical dissipation of implicit steps.
    pub step_loss: f64,
    /// Of the last implicit step; `None` after an explicit one.
    pub pending: Option<Pending>,
    /// Kinetic energy removed when bodies were frozen.
    pub frozen: f64,
    /// See [`Ledger::exchanged`].
    pub exchanged: f64,
    /// Kinetic energy, `work_in` and `load_work` after the last step.
    pub last: [f64; 3],
}

/// What an implicit step took from the motion, J: the contacts are evaluated at its end in the next one.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Pending {
    /// By normal forces and moments.
    pub taken: f64,
    /// By the dashpots among them.
    pub damping: f64,
}

impl AddAssign for Flows {
    /// The flows of another part of a world.
    fn add_assign(&mut self, other: Self) {
        for (sum, part) in [
            (&mut self.work_in, other.work_in),
            (&mut self.by_hand, other.by_hand),
            (&mut self.load_work, other.load_work),
            (&mut self.damping_work, other.damping_work),
            (&mut self.friction_work, other.friction_work),
            (&mut self.medium_work, other.medium_work),
            (&mut self.viscous_work, other.viscous_work),
            (&mut self.plastic_work, other.plastic_work),
            (&mut self.step_loss, other.step_loss),
            (&mut self.fidelity, other.fidelity),
            (&mut self.bonds.glue, other.bonds.glue),
            (&mut self.bonds.friction, other.bonds.friction),
            (&mut self.bonds.released, other.bonds.released),
            (&mut self.bonds.lent, other.bonds.lent),
            (&mut self.broken, other.broken),
            (&mut self.frozen, other.frozen),
            (&mut self.exchanged, other.exchanged),
        ] {
            *sum += part;
        }
        // One part takes the implicit steps.
        self.pending = self.pending.or(other.pending);
        self.cracks += other.cracks;
        for (sum, part) in self.last.iter_mut().zip(other.last) {
            *sum += part;
        }
    }
}

impl Flows {
    /// Adds what the last step exchanged; `kinetic` is the energy in motion after it, J.
    pub fn exchange(&mut self, kinetic: f64) {
        let now = [kinetic, self.work_in, self.load_work];
        for (now, last) in now.iter().zip(self.last) {
            self.exchanged += (now - last).abs();
        }
        self.last = now;
    }

    /// Books the last implicit step, if there is one, once it is known by how much the contacts store more (J). What they
    /// do not store was dissipated, by dashpots and else by the step. A step gives no energy: if it does, that is not
    /// booked.
    pub fn settle(&mut self, stored: f64) {
        if let Some(pending) = self.pending.take() {
            let lost = (pending.taken - stored).max(0.0);
            let damping = pending.damping.max(0.0).min(lost);
            self.damping_work -= damping;
            self.step_loss += lost - damping;
        }
    }
}

/// Energies of a world, J. The sum of `final_energy` and everything dissipated equals [`given`](Self::given),
/// `initial + by_hand + work_in + load_work + lent + fidelity`, up to the integration error. Bodies that overlap when they are added or
/// put somewhere by hand, and walls placed where bodies are, bring elastic energy. `initial` or `by_hand` contains it
/// from the next step on.
///
/// ```
/// use femdem_contact::Wall;
/// use femdem_mesh::{Pose, Vector3, catalogue::CatalogueShape};
/// use femdem_solve::{BodySpec, Drive, World, WorldParameters};
///
/// // A cube falls on a floor: what it loses is in the dashpots and in friction.
/// let mut world = World::new(WorldParameters::default())?;
/// world.add_wall(Wall::half_space("floor", Vector3::z(), 0.0)?, Drive::Fixed)?;
/// let shape = world.add_shape("cube", &"P5".parse::<CatalogueShape>()?.polyhedron(0.1)?)?;
/// let place = Pose::new(Vector3::new(0.0, 0.0, 0.2), Vector3::new(0.3, 0.2, 0.1));
/// world.add_body(BodySpec::at_rest(shape, 2000.0, place))?;
/// while world.time() < 1.0 {
///     world.step()?;
/// }
/// let ledger = world.ledger();
/// let lost = ledger.dissipated_damping + ledger.dissipated_friction + ledger.frozen;
/// assert!((lost / (ledger.initial - ledger.final_energy()) - 1.0).abs() < 0.02);
/// assert!(ledger.error_relative().abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Kinetic and potential energy of all bodies when they were added, and elastic energy of their overlaps; or all
    /// energy when the ledger was [begun anew](crate::World::restart_ledger).
    pub initial: f64,
    /// Work done on the bodies by driven walls and bodies, and by what is prescribed at deformable bodies.
    pub work_in: f64,
    /// What the host has put in by hand, less what it took: the change of the kinetic, potential and strain energy of
    /// bodies whose pose, nodes or velocities were set; the elastic energy of their overlaps and the energy of their friction
    /// springs, before (taken) and after (put in); and, negative, all that removed bodies and walls had of these, what the bonds
    /// of bodies held that were removed or put elsewhere, and what contacts held in whose place a bond was added.
    pub by_hand: f64,
    /// Work of external loads ([`World::set_load`](crate::World::set_load)).
    pub load_work: f64,
    /// Lent to cracks at their births: the energy of their stretched springs. It comes back in what they dissipate. And what
    /// contacts held more than the ended bonds that they took over from.
    pub lent: f64,
    /// Given to bodies when they became deformable, less what was taken when they became rigid ([`World::set_adaptive`](crate::World::set_adaptive)): mostly the
    /// energy of their strains, and of their motion within themselves.
    pub fidelity: f64,
    /// Kinetic energy now.
    pub kinetic: f64,
    /// Potential energy in gravity now, relative to the origin.
    pub potential: f64,
    /// Elastic contact energy now, and that of the attraction of contacts, which is negative but for stretched liquid bridges.
    pub elastic: f64,
    /// Elastic energy inside deformable bodies now.
    pub strain: f64,
    /// Energy in the friction springs now.
    pub friction_springs: f64,
    /// Energy in the cracks of bodies now: in their glue, and in the contact and friction of their sides.
    pub cracks: f64,
    /// Energy in the bonds of rigid bodies now.
    pub bonds: f64,
    /// Dissipated by sliding, and by the dashpots beside the friction springs.
    pub dissipated_friction: f64,
    /// Dissipated by the normal dashpots.
    pub dissipated_damping: f64,
    /// Dissipated by the medium: drag and local damping.
    pub dissipated_medium: f64,
    /// Dissipated by the viscosity of materials.
    pub dissipated_viscous: f64,
    /// Dissipated by plastic flow.
    pub dissipated_plastic: f64,
    /// Dissipated where liquid bridges broke: what they held.
    pub dissipated_bridges: f64,
    /// Dissipated by breaking: less what was lent, this is the energy of fracture.
    pub dissipated_fracture: f64,
    /// Dissipated by breaking bonds: their energy of fracture.
    pub dissipated_bonds: f64,
    /// Dissipated by the pressure that new cracks have as it fades, by contacts whose field cracks change, and where bonds ended.
    pub dissipated_release: f64,
    /// Numerical dissipation of [implicit](crate::ImplicitStep) steps: what the contacts took from the motion and neither store
    /// nor lost in dashpots. Steps in which they give more than was stored are not booked, and so appear as an error.
    pub dissipated_step: f64,
    /// Kinetic energy removed when bodies were frozen.
    pub frozen: f64,
    /// Energy exchanged so far: the sum over the steps of |change of the kinetic energy|, |work of what is driven| and |work
    /// of external loads|; over ranks, of each rank, which is more.
    pub exchanged: f64,
}

// Of which none may be left out of its terms.
const _: () = assert!(size_of::<Ledger>() == 25 * size_of::<f64>());

impl Ledger {
    /// All its entries, in joules.
    pub(crate) fn terms(&mut self) -> [&mut f64; 25] {
        [
            &mut self.initial,
            &mut self.work_in,
            &mut self.by_hand,
            &mut self.load_work,
            &mut self.lent,
            &mut self.fidelity,
            &mut self.kinetic,
            &mut self.potential,
            &mut self.elastic,
            &mut self.strain,
            &mut self.friction_springs,
            &mut self.cracks,
            &mut self.bonds,
            &mut self.dissipated_friction,
            &mut self.dissipated_damping,
            &mut self.dissipated_medium,
            &mut self.dissipated_viscous,
            &mut self.dissipated_plastic,
            &mut self.dissipated_bridges,
            &mut self.dissipated_fracture,
            &mut self.dissipated_bonds,
            &mut self.dissipated_release,
            &mut self.dissipated_step,
            &mut self.frozen,
            &mut self.exchanged,
        ]
    }

    /// All energy put in: at the beginning and by additions, by hand, by drives and by loads, J.
    pub fn given(&self) -> f64 {
        self.initial + self.by_hand + self.work_in + self.load_work + self.lent + self.fidelity
    }

    /// Kinetic, potential, elastic and spring energy now, J.
    pub fn final_energy(&self) -> f64 {
        self.kinetic
            + self.potential
            + self.elastic
            + self.strain
            + self.friction_springs
            + self.cracks
            + self.bonds
    }

    /// All that was dissipated, J.
    pub fn dissipated(&self) -> f64 {
        self.dissipated_friction
            + self.dissipated_damping
            + self.dissipated_medium
            + self.dissipated_viscous
            + self.dissipated_plastic
            + self.dissipated_bridges
            + self.dissipated_fracture
            + self.dissipated_bonds
            + self.dissipated_release
            + self.dissipated_step
            + self.frozen
    }

    /// The energy missing in the ledger, J: energy now plus dissipated minus energy put in.
    pub fn error(&self) -> f64 {
        self.final_energy() + self.dissipated() - self.given()
    }

    /// The error over the turnover: the largest of the energy exchanged so far, of the dissipated energy, and of the
    /// kinetic and stored energy now.
    pub fn error_relative(&self) -> f64 {
        let stored = self.kinetic
            + self.elastic
            + self.strain
            + self.friction_springs
            + self.cracks
            + self.bonds;
        let turnover = self
            .dissipated()
            .abs()
            .max(stored.abs())
            .max(self.exchanged);
        if turnover > 0.0 {
            self.error() / turnover
        } else {
            0.0
        }
    }
}
