//! Layer 2: many deformable bodies with the rigid bodies and walls around them.

mod bend;
mod body;
mod context;
mod evaluate;
mod pair;
mod pairs;
mod prepare;
mod remove;
mod sleep;
mod state;
mod touching;

use super::kernel::DeformableKernel;
use super::pair::FrictionStart;
use super::record::{DeformableContact, DeformablePartner, DeformableTotals, NodalState};
use super::shape::{DeformableShape, Modulus};
use crate::batch::ContactBatch;
use crate::body_shape::BodyShape;
use crate::contact::{BodyId, Load};
use crate::error::{ContactError, check};
use crate::general::FieldMesh;
use crate::generalized::Resistance;
use crate::law::{ContactLaw, ContactParameters};
use crate::motion::Motion;
use crate::slots::Slots;
use crate::walls::WallShape;
use bend::Bend;
use body::SoftBody;
use context::Context;
use femdem_mesh::Vector3;
use pairs::PairList;
pub use remove::Touched;
use serde::{Deserialize, Serialize};
use state::Sleep;
use std::collections::BTreeMap;
use std::sync::Arc;
use touching::{Part, Touching};

/// Kinds of numbers.
const SOFT: usize = 0;
const RIGID: usize = 1;
const WALL: usize = 2;

impl DeformablePartner {
    /// Its kind and its number.
    fn kind(self) -> (usize, u32) {
        match self {
            Self::Deformable(i) => (SOFT, i),
            Self::Rigid(i) => (RIGID, i),
            Self::Wall(w) => (WALL, w),
        }
    }
}

/// Contact of deformable bodies with each other, with rigid bodies and with walls, with friction
/// history. Contacts among rigid bodies and walls belong to a
/// [`ContactBatch`](crate::ContactBatch).
///
/// Bodies are added, updated with one [`NodalState`] or [`Motion`] each, and removed at any time between updates. Free
/// numbers are given out again, the lowest first.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DeformableBatch {
    law: ContactLaw,
    kernel: DeformableKernel,
    #[serde(skip)]
    shapes: Vec<Arc<DeformableShape>>,
    #[serde(skip)]
    rigid_shapes: Vec<RigidShape>,
    /// Numbers of the deformable bodies, the rigid ones and the walls.
    slots: [Slots; 3],
    bodies: Vec<SoftBody>,
    rigid: Vec<Option<u32>>,
    rigid_sleep: Vec<Sleep>,
    walls: Vec<Option<WallShape>>,
    pairs: PairList,
    /// Initial friction of pairs, applied in the next update.
    starts: BTreeMap<(DeformablePartner, u32), FrictionStart>,
    rigid_loads: Vec<Load>,
    rigid_resistances: Vec<Resistance>,
    wall_loads: Vec<Load>,
    totals: DeformableTotals,
}

/// A rigid shape and its tetrahedra.
#[derive(Debug, Clone)]
pub(crate) struct RigidShape {
    pub shape: BodyShape,
    pub mesh: Arc<FieldMesh>,
}

impl RigidShape {
    fn new(shape: BodyShape) -> Result<Self, ContactError> {
        Ok(Self {
            mesh: shape.tetrahedra()?,
            shape,
        })
    }
}

impl DeformableBatch {
    /// An empty batch with one contact law, whose penalty is that of the rigid bodies.
    pub fn new(law: ContactLaw) -> Self {
        Self {
            law,
            kernel: DeformableKernel::default().with_walls(law.parameters().wall_response),
            shapes: Vec::new(),
            rigid_shapes: Vec::new(),
            slots: Default::default(),
            bodies: Vec::new(),
            rigid: Vec::new(),
            rigid_sleep: Vec::new(),
            walls: Vec::new(),
            pairs: PairList::default(),
            starts: BTreeMap::new(),
            rigid_loads: Vec::new(),
            rigid_resistances: Vec::new(),
            wall_loads: Vec::new(),
            totals: DeformableTotals::default(),
        }
    }

    /// As [`new`](Self::new), with the rigid shapes, the rigid bodies and the walls of another batch under their indices.
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if a convex shape is too flat for tetrahedra.
    pub fn beside(rigid: &ContactBatch, law: ContactLaw) -> Result<Self, ContactError> {
        let mut batch = Self::new(law);
        for shape in rigid.shapes() {
            batch.add_rigid_shape(shape.clone())?;
        }
        let [bodies, walls] = rigid.numbers();
        let kinds = (0..bodies.total() as u32).map(|body| rigid.shape_index(body));
        batch.rigid = kinds.collect();
        batch.rigid_sleep = vec![Sleep::Awake; bodies.total()];
        batch.rigid_loads = vec![Load::default(); bodies.total()];
        batch.rigid_resistances = vec![Resistance::default(); bodies.total()];
        batch.walls = (0..walls.total() as u32)
            .map(|wall| rigid.wall(wall).cloned())
            .collect();
        batch.wall_loads = vec![Load::default(); walls.total()];
        batch.slots = [Slots::default(), bodies.clone(), walls.clone()];
        Ok(batch)
    }

    /// The law's parameters.
    pub fn parameters(&self) -> &ContactParameters {
        self.law.parameters()
    }

    /// Replaces the law; contacts keep their history.
    pub fn set_law(&mut self, law: ContactLaw) {
        self.evaluate_all();
        self.kernel = self.kernel.with_walls(law.parameters().wall_response);
        self.law = law;
    }

    /// Adds the shape of deformable bodies and returns its index.
    pub fn add_shape(&mut self, shape: impl Into<Arc<DeformableShape>>) -> u32 {
        self.shapes.push(shape.into());
        self.shapes.len() as u32 - 1
    }

    /// Adds a deformable body and returns its index.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if the shape was never added, [`ContactError::Parameter`] if the
    /// modulus is out of its range.
    pub fn add_body(&mut self, shape: u32, modulus: Modulus) -> Result<u32, ContactError> {
        modulus.check()?;
        let Some(kind) = self.shapes.get(shape as usize) else {
            return Err(no_shape(shape, self.shapes.len()));
        };
        let new = SoftBody::new(shape, kind, modulus);
        let (body, is_new) = self.slots[SOFT].take();
        if is_new {
            self.bodies.push(new);
        } else {
            self.bodies[body as usize] = new;
        }
        self.pairs.forget_search();
        Ok(body)
    }

    /// Replaces the modulus of a deformable body; its contacts keep their history.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] for an unknown body, [`ContactError::Parameter`] if the modulus is
    /// out of its range.
    pub fn set_modulus(&mut self, body: u32, modulus: Modulus) -> Result<(), ContactError> {
        modulus.check()?;
        self.known(SOFT, body)?;
        let soft = &mut self.bodies[body as usize];
        soft.modulus = modulus;
        soft.sleep.stir();
        Ok(())
    }

    /// Sets the frequency of the slowest elastic oscillation of a deformable body, rad/s; π c/L for a bar of length L, with
    /// c = √(E/ρ). If it is high compared with the oscillation on the contacts, the dashpots damp the body as if it
    /// were rigid, with all of its mass. With 0, the initial value, they know the mass of the touching nodes only.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] for an unknown body, [`ContactError::Parameter`] if it is negative or not finite.
    pub fn set_frequency(&mut self, body: u32, frequency: f64) -> Result<(), ContactError> {
        check(
            "frequency",
            frequency,
            frequency >= 0.0,
            "at least 0 and finite, in rad/s",
        )?;
        self.known(SOFT, body)?;
        let soft = &mut self.bodies[body as usize];
        soft.frequency = frequency;
        soft.sleep.stir();
        Ok(())
    }

    /// Sets whether a deformable body may touch itself, as one that folds does. Initially it does not: its parts pass
    /// through each other.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] for an unknown body.
    pub fn set_self_contact(&mut self, body: u32, on: bool) -> Result<(), ContactError> {
        self.known(SOFT, body)?;
        let soft = &mut self.bodies[body as usize];
        if soft.bend.is_some() != on {
            soft.bend = on.then(Bend::default);
        }
        soft.sleep.stir();
        self.pairs.forget_search();
        Ok(())
    }

    /// Whether a deformable body may touch itself; `false` for one that does not exist.
    pub fn self_contact(&self, body: u32) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.bend.is_some())
    }

    /// Adds a rigid shape and returns its index.
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if a convex body is too flat for tetrahedra.
    pub fn add_rigid_shape(&mut self, shape: impl Into<BodyShape>) -> Result<u32, ContactError> {
        self.rigid_shapes.push(RigidShape::new(shape.into())?);
        Ok(self.rigid_shapes.len() as u32 - 1)
    }

    /// Adds a rigid body and returns its index.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if the shape was never added.
    pub fn add_rigid(&mut self, shape: u32) -> Result<BodyId, ContactError> {
        if shape as usize >= self.rigid_shapes.len() {
            return Err(no_shape(shape, self.rigid_shapes.len()));
        }
        let (body, is_new) = self.slots[RIGID].take();
        let i = body as usize;
        if is_new {
            self.rigid.push(Some(shape));
            self.rigid_sleep.push(Sleep::Awake);
            self.rigid_loads.push(Load::default());
            self.rigid_resistances.push(Resistance::default());
        } else {
            self.rigid[i] = Some(shape);
            self.rigid_sleep[i] = Sleep::Awake;
        }
        self.pairs.forget_search();
        Ok(body)
    }

    /// Adds a wall, of planes or a mesh, and returns its index. Its contacts with sleeping bodies are found
    /// in the next update.
    pub fn add_wall(&mut self, wall: impl Into<WallShape>) -> u32 {
        self.evaluate_all();
        let (slot, is_new) = self.slots[WALL].take();
        if is_new {
            self.walls.push(Some(wall.into()));
            self.wall_loads.push(Load::default());
        } else {
            self.walls[slot as usize] = Some(wall.into());
        }
        self.pairs.forget_search();
        slot
    }

    /// Restores the shapes of a batch that was read from a file, in the order of addition.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if a body refers to a missing shape, [`ContactError::Stored`] if a pair refers to a
    /// missing body or wall, and the errors of [`add_rigid_shape`](Self::add_rigid_shape).
    pub fn restore_shapes(
        &mut self,
        shapes: Vec<Arc<DeformableShape>>,
        rigid: Vec<BodyShape>,
    ) -> Result<(), ContactError> {
        for (largest, count) in [
            (self.bodies.iter().map(|b| b.shape).max(), shapes.len()),
            (self.rigid.iter().flatten().copied().max(), rigid.len()),
        ] {
            if let Some(index) = largest.filter(|i| *i as usize >= count) {
                return Err(no_shape(index, count));
            }
        }
        let counts = [self.bodies.len(), self.rigid.len(), self.walls.len()];
        let slots = &self.slots;
        let numbered = |(slots, count): (&Slots, usize)| slots.is_sound() && slots.total() == count;
        if !slots.iter().zip(counts).all(numbered)
            || !self.pairs.fits(|kind, slot| slots[kind].holds(slot))
            || self.rigid_sleep.len() != counts[RIGID]
        {
            return Err(ContactError::Stored {
                what: "the table of pairs".to_owned(),
            });
        }
        for i in self.slots[SOFT].iter() {
            let body = &mut self.bodies[i as usize];
            body.restore(&shapes[body.shape as usize]);
        }
        self.shapes = shapes;
        self.rigid_shapes = rigid
            .into_iter()
            .map(RigidShape::new)
            .collect::<Result<_, _>>()?;
        self.gather(true);
        Ok(())
    }

    /// The shapes of deformable bodies, by index.
    pub fn shapes(&self) -> &[Arc<DeformableShape>] {
        &self.shapes
    }

    /// Number of deformable bodies.
    pub fn len(&self) -> usize {
        self.slots[SOFT].len()
    }

    /// Whether there are no deformable bodies.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The deformable bodies, ascending.
    pub fn body_ids(&self) -> impl Iterator<Item = u32> {
        self.slots[SOFT].iter()
    }

    /// Whether there is such a deformable body.
    pub fn contains(&self, body: u32) -> bool {
        self.slots[SOFT].holds(body)
    }

    /// Numbers of deformable bodies, rigid ones and walls that have been in use: how many states of each
    /// [`update`](Self::update) takes.
    pub fn slots(&self) -> [usize; 3] {
        self.slots.each_ref().map(Slots::total)
    }

    fn known(&self, kind: usize, slot: u32) -> Result<(), ContactError> {
        if self.slots[kind].holds(slot) {
            return Ok(());
        }
        Err(ContactError::NoSuch {
            what: ["deformable body", "rigid body", "wall"][kind],
            index: slot as usize,
            count: self.slots[kind].len(),
        })
    }

    /// Finds and evaluates all contacts of the deformable bodies.
    ///
    /// The slices hold one state per deformable body, rigid body and wall, by index (see [`slots`](Self::slots)). Those of
    /// removed rigid bodies and walls are not read; those of removed deformable bodies are empty. `dt` is the time since
    /// the last update, s.
    ///
    /// # Errors
    /// [`ContactError::StateCount`] or [`ContactError::NodeCount`] if a slice has the wrong length,
    /// [`ContactError::NodeState`] or [`ContactError::NotFinite`] if a state is not finite or an inverse mass
    /// is negative, [`ContactError::Parameter`] for a `dt` that is negative or not finite, [`ContactError::InvertedTet`] if a tetrahedron in a contact is inverted. The nodal values
    /// of a sleeping deformable body are read only in the first update after it fell asleep, or after a
    /// change of the batch that affects its contacts. After an error the histories are a mixture of two
    /// steps.
    pub fn update(
        &mut self,
        bodies: &[NodalState],
        rigid: &[Motion],
        walls: &[Motion],
        dt: f64,
    ) -> Result<(), ContactError> {
        for (what, given, expected) in [
            ("deformable body", bodies.len(), self.bodies.len()),
            ("rigid body", rigid.len(), self.rigid.len()),
            ("wall", walls.len(), self.walls.len()),
        ] {
            if given != expected {
                return Err(ContactError::StateCount {
                    what,
                    given,
                    expected,
                });
            }
        }
        let lost = |(kind, motion): (&Option<u32>, &Motion)| kind.is_some() && !motion.is_sound();
        if let Some(body) = self.rigid.iter().zip(rigid).position(lost) {
            return Err(ContactError::NotFinite {
                body,
                position: rigid[body].frame.position.into(),
            });
        }
        let present = self.walls.iter().zip(walls);
        let mut present = present.filter_map(|(wall, motion)| Some((wall.as_ref()?, motion)));
        if let Some((wall, _)) = present.find(|(_, motion)| !motion.is_sound()) {
            return Err(ContactError::Wall {
                name: wall.name().to_owned(),
                why: "its motion is not finite".to_owned(),
            });
        }
        check("dt", dt, dt >= 0.0, "0 or more and finite, in s")?;
        body::advance(&mut self.bodies, bodies)?;
        let context = Context {
            parameters: self.law.parameters(),
            at_walls: self.law.parameters().at_walls(),
            kernel: &self.kernel,
            shapes: &self.shapes,
            rigid_shapes: &self.rigid_shapes,
            rigid_kinds: &self.rigid,
            rigid_sleep: &self.rigid_sleep,
            wall_shapes: &self.walls,
            states: bodies,
            rigid,
            walls,
            dt,
        };
        let found = self.pairs.search(&context, &mut self.bodies);
        let begins = !self.starts.is_empty();
        if begins {
            for pair in self.pairs.list_mut() {
                pair.begins = self.starts.remove(&pair.key());
            }
            self.starts.clear();
        }
        self.pairs.measure_bends(&context, &mut self.bodies);
        let wanted = self.pairs.wanted(&context, &self.bodies);
        prepare::prepare(&mut self.bodies, &wanted, &context);
        let result = evaluate::run(&context, &self.bodies, &mut self.pairs);
        if begins {
            for pair in self.pairs.list_mut() {
                pair.begins = None;
            }
        }
        result?;
        self.gather(found);
        self.settle();
        Ok(())
    }

    /// Starts a pair with the friction of a contact that was computed elsewhere, such as that of rigid
    /// bodies: a force on B (N) and a moment on B about the normal (N m), spread over the triangles in
    /// contact in proportion to their normal loads. It takes effect in the next update, if the pair touches
    /// then and has no friction yet.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if A or B was never added, [`ContactError::Parameter`] if the force or the moment is not
    /// finite.
    pub fn begin_friction(
        &mut self,
        a: DeformablePartner,
        b: u32,
        force: Vector3,
        torsion: f64,
    ) -> Result<(), ContactError> {
        check(
            "force",
            force.norm(),
            true,
            "finite in every component, in N",
        )?;
        check("torsion", torsion, true, "finite, in N m")?;
        let (kind, slot) = a.kind();
        self.known(kind, slot)?;
        self.known(SOFT, b)?;
        self.bodies[b as usize].sleep.stir();
        let start = FrictionStart { force, torsion };
        self.starts.insert((a, b), start);
        Ok(())
    }

    /// Sums the forces in the order of the pairs; on bodies among sleepers only if `all`.
    fn gather(&mut self, all: bool) {
        let pairs = self.pairs.list();
        sleep::stir(&mut self.bodies, &self.rigid_sleep, pairs, all);
        self.rigid_loads.fill(Load::default());
        self.rigid_resistances.fill(Resistance::default());
        self.wall_loads.fill(Load::default());
        self.totals = DeformableTotals::default();
        let mut parts = Vec::with_capacity(2 * pairs.len());
        for (place, pair) in (0..).zip(pairs) {
            self.totals += &pair.totals();
            if pair.outcome.contacts.is_empty() {
                continue;
            }
            parts.push((pair.b, Part { place, side: 1 }));
            let found = pair.outcome.load.as_deref();
            match pair.a {
                DeformablePartner::Deformable(i) => parts.push((i, Part { place, side: 0 })),
                DeformablePartner::Rigid(i) => {
                    let at = i as usize;
                    if let (Some(total), Some((load, _))) = (self.rigid_loads.get_mut(at), found) {
                        *total += load;
                    }
                    let total = self.rigid_resistances.get_mut(at);
                    if let (Some(total), Some((_, resistance))) = (total, found) {
                        *total += resistance;
                    }
                }
                DeformablePartner::Wall(w) => {
                    let total = self.wall_loads.get_mut(w as usize);
                    if let (Some(total), Some((load, _))) = (total, found) {
                        *total += load;
                    }
                }
            }
        }
        let touching = Touching::new(&parts, self.bodies.len());
        body::gather(&mut self.bodies, pairs, &touching);
    }

    /// Whether anything touches a body. If not, all of the following are zero.
    pub fn touches(&self, body: u32) -> bool {
        self.bodies.get(body as usize).is_some_and(|b| b.loaded)
    }

    /// Contact forces on the nodes of a body, N: elastic, damping and friction. Empty if there is
    /// no such body.
    pub fn forces(&self, body: u32) -> &[Vector3] {
        self.bodies.get(body as usize).map_or(&[], |b| &b.forces)
    }

    /// By deformable body, whether anything is near it. The others touch nothing until they, or what they may meet, have
    /// moved by a twentieth of their radius since the last update.
    pub fn have_neighbours(&self) -> Vec<bool> {
        let mut near = vec![false; self.bodies.len()];
        let pairs = self.pairs.list().iter().filter(|pair| pair.is_near());
        for body in pairs.flat_map(|pair| pair.deformables()) {
            if let Some(near) = near.get_mut(body as usize) {
                *near = true;
            }
        }
        near
    }

    /// The part of [`forces`](Self::forces) due to damping, N.
    pub fn damping_forces(&self, body: u32) -> &[Vector3] {
        self.bodies.get(body as usize).map_or(&[], |b| &b.damping)
    }

    /// The part of [`forces`](Self::forces) due to friction, N.
    pub fn friction_forces(&self, body: u32) -> &[Vector3] {
        self.bodies.get(body as usize).map_or(&[], |b| &b.friction)
    }

    /// Contact stiffness k of the nodes of a body, N/m: a node of mass m adds 2 k/m to the squared
    /// frequency that bounds the step.
    pub fn stiffness(&self, body: u32) -> &[f64] {
        self.bodies.get(body as usize).map_or(&[], |b| &b.stiffness)
    }

    /// Damping rate of the nodes of a body due to contact, 1/s: the rate in
    /// [`stable_step`](crate::stable_step).
    pub fn rates(&self, body: u32) -> &[f64] {
        self.bodies.get(body as usize).map_or(&[], |b| &b.rates)
    }

    /// Loads on the rigid bodies from the deformable ones.
    pub fn rigid_loads(&self) -> &[Load] {
        &self.rigid_loads
    }

    /// Stiffness and viscosity against the motion of a rigid body that deformable ones touch; `None` for
    /// others.
    pub fn rigid_resistance(&self, body: BodyId) -> Option<&Resistance> {
        let touched = self.rigid_loads.get(body as usize)?.contacts > 0;
        let resistance = self.rigid_resistances.get(body as usize)?;
        touched.then_some(resistance)
    }

    /// Loads on the walls from the deformable bodies, about the walls' origins.
    pub fn wall_loads(&self) -> &[Load] {
        &self.wall_loads
    }

    /// The contacts, sorted by pair and patch.
    pub fn contacts(&self) -> impl Iterator<Item = &DeformableContact> {
        self.pairs.list().iter().flat_map(|p| &p.outcome.contacts)
    }

    /// Sums of the last update.
    pub fn totals(&self) -> &DeformableTotals {
        &self.totals
    }
}

fn no_shape(index: u32, count: usize) -> ContactError {
    ContactError::NoSuch {
        what: "shape",
        index: index as usize,
        count,
    }
}
