//! The deformable bodies of a batch, with their contacts: with each other, with rigid bodies and with walls.

mod bend;
mod body;
mod context;
mod each;
mod evaluate;
mod fragments;
mod look;
mod pair;
mod pairs;
mod periodic;
mod prepare;
mod remove;
mod reshape;
mod search;
mod share;
mod sleep;
mod state;
mod touching;

use super::record::{DeformableTotals, NodalLoads, NodalState};
use super::scratch::Scratches;
use super::shape::{DeformableShape, Modulus};
use super::side::Side;
use crate::contact::{BodyId, Load, Partner};
use crate::error::ContactError;
use crate::general::FieldMesh;
use crate::generalized::Resistance;
use crate::materials::Materials;
use crate::motion::Motion;
use crate::periodic::{EdgeLoad, Space};
use crate::record::Contact;
use crate::spring_load::{Part, SpringLoad};
use crate::walls::WallShape;
use bend::Bend;
pub(crate) use body::SoftBody;
use context::Context;
use femdem_mesh::Vector3;
pub use fragments::FragmentShape;
use look::Look;
pub(crate) use pair::SoftPair;
use pairs::PairList;
use serde::{Deserialize, Serialize};
pub(crate) use state::Sleep;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What the contacts of deformable bodies need of the batch around them. Lists are by number of the bodies, or of the walls.
pub(crate) struct Around<'a> {
    pub materials: &'a Materials,
    /// Shapes of rigid bodies as tetrahedra.
    pub rigid_meshes: &'a [Arc<FieldMesh>],
    /// The shapes of the rigid bodies.
    pub rigid_kinds: &'a [Option<u32>],
    pub wall_shapes: &'a [Option<WallShape>],
    pub rigid: &'a [Motion],
    pub walls: &'a [Motion],
    /// Where space repeats itself.
    pub space: Option<&'a Space>,
    /// Time since the last update, s.
    pub dt: f64,
}

/// The deformable bodies of a batch. Lists are by number of the bodies, rigid ones included: what stands for numbers of the
/// other kind is vacant.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct DeformablePart {
    #[serde(skip)]
    shapes: Vec<Arc<DeformableShape>>,
    bodies: Vec<SoftBody>,
    /// How many of them are there.
    count: usize,
    rigid_sleep: Vec<Sleep>,
    pairs: PairList,
    /// Bodies that were entered anew since pairs were listed last; of rigid ones the deformable neighbours.
    entered: BTreeMap<BodyId, Vec<BodyId>>,
    /// Whether a wall has moved away since then.
    walls_moved: bool,
    /// Initial friction of pairs, applied in the next update.
    starts: BTreeMap<(Side, BodyId), SpringLoad>,
    rigid_loads: Vec<Load>,
    rigid_resistances: Vec<Resistance>,
    wall_loads: Vec<Load>,
    totals: DeformableTotals,
    #[serde(skip)]
    edges: [EdgeLoad; 3],
    #[serde(skip)]
    scratches: Scratches,
}

impl DeformablePart {
    /// Without deformable bodies, beside rigid ones that are awake or not, and walls.
    pub fn beside(awake: &[bool], walls: usize) -> Self {
        let mut part = Self::default();
        for (body, awake) in (0..).zip(awake) {
            part.add_rigid(body);
            part.set_rigid_awake(body, *awake);
        }
        part.wall_loads = vec![Load::default(); walls];
        part
    }

    /// Adds the shape of deformable bodies and returns its index.
    pub fn add_shape(&mut self, shape: Arc<DeformableShape>) -> u32 {
        self.shapes.push(shape);
        self.shapes.len() as u32 - 1
    }

    /// Replaces a shape of no body.
    pub fn replace_shape(&mut self, index: u32, shape: Arc<DeformableShape>) {
        self.shapes[index as usize] = shape;
    }

    /// Adds a deformable body under a number that is free in the batch.
    pub fn add_body(&mut self, id: BodyId, shape: u32, modulus: Modulus) {
        self.reach(id);
        let kind = &self.shapes[shape as usize];
        self.bodies[id as usize] = SoftBody::new(shape, kind, modulus);
        self.count += 1;
    }

    /// Sets whether a deformable body may touch itself. Initially it does not.
    pub fn set_self_contact(&mut self, body: BodyId, on: bool) {
        let body = &mut self.bodies[body as usize];
        if body.bend.is_some() != on {
            body.bend = on.then(Bend::default);
        }
        body.sleep.stir();
    }

    /// Whether a deformable body may touch itself.
    pub fn self_contact(&self, body: BodyId) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.bend.is_some())
    }

    /// Adds a rigid body under a number that is free in the batch.
    pub fn add_rigid(&mut self, id: BodyId) {
        self.reach(id);
        self.rigid_sleep[id as usize] = Sleep::Awake;
    }

    /// Makes the lists long enough for a number.
    fn reach(&mut self, id: BodyId) {
        let count = self.bodies.len().max(id as usize + 1);
        self.bodies.resize_with(count, SoftBody::vacant);
        self.rigid_sleep.resize(count, Sleep::Awake);
        self.rigid_loads.resize(count, Load::default());
        self.rigid_resistances.resize(count, Resistance::default());
    }

    /// A wall has come. Its contacts with sleeping bodies are found in the next update.
    pub fn add_wall(&mut self, wall: u32) {
        self.evaluate_all();
        let count = self.wall_loads.len().max(wall as usize + 1);
        self.wall_loads.resize(count, Load::default());
    }

    /// Makes the next update evaluate the contacts of sleepers too.
    pub fn evaluate_all(&mut self) {
        self.sleeps().for_each(Sleep::stir);
    }

    /// The modulus of a deformable body.
    pub fn modulus(&self, body: BodyId) -> Option<Modulus> {
        let body = self.bodies.get(body as usize)?;
        body.is_there.then_some(body.modulus)
    }

    /// Replaces the modulus of a deformable body.
    pub fn set_modulus(&mut self, body: BodyId, modulus: Modulus) {
        let body = &mut self.bodies[body as usize];
        body.modulus = modulus;
        body.sleep.stir();
    }

    /// Sets the frequency of the slowest elastic oscillation of a deformable body, rad/s.
    pub fn set_frequency(&mut self, body: BodyId, frequency: f64) {
        let body = &mut self.bodies[body as usize];
        body.frequency = frequency;
        body.sleep.stir();
    }

    /// Restores the shapes after the rest was read from a file, in the order of addition. `is_there` tells whether a body or a
    /// wall is.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if a body refers to a missing shape, [`ContactError::Stored`] if lists do not have the
    /// lengths `bodies` and `walls`, or if a pair refers to something missing.
    pub fn restore_shapes(
        &mut self,
        shapes: Vec<Arc<DeformableShape>>,
        [bodies, walls]: [usize; 2],
        is_there: impl Fn(Side) -> bool,
    ) -> Result<(), ContactError> {
        let lengths = [
            self.bodies.len(),
            self.rigid_sleep.len(),
            self.rigid_loads.len(),
            self.rigid_resistances.len(),
        ];
        let fits = lengths.iter().all(|length| *length == bodies)
            && self.wall_loads.len() == walls
            && self.bodies.iter().filter(|body| body.is_there).count() == self.count
            && (0..)
                .zip(&self.bodies)
                .all(|(i, body)| !body.is_there || is_there(Side::Deformable(i)))
            && self.entered.keys().all(|&body| is_there(Side::Rigid(body)))
            && self.pairs.fits(|side| {
                let kind = match side {
                    Side::Deformable(body) => self.contains(body),
                    Side::Rigid(body) => !self.contains(body),
                    Side::Wall(_) => true,
                };
                kind && is_there(side)
            });
        if !fits {
            return Err(ContactError::Stored {
                what: "the table of pairs".to_owned(),
            });
        }
        for body in &mut self.bodies {
            if !body.is_there {
                continue;
            }
            let Some(shape) = shapes.get(body.shape as usize) else {
                return Err(no_shape(body.shape, shapes.len()));
            };
            body.restore(shape);
        }
        self.shapes = shapes;
        self.pairs.note_own();
        self.gather_again(true);
        Ok(())
    }

    /// The shapes of deformable bodies, by index.
    pub fn shapes(&self) -> &[Arc<DeformableShape>] {
        &self.shapes
    }

    /// Number of deformable bodies.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is such a deformable body.
    pub fn contains(&self, body: BodyId) -> bool {
        let body = self.bodies.get(body as usize);
        body.is_some_and(|body| body.is_there)
    }

    /// Takes over the present positions of all nodes.
    pub fn advance(&mut self, states: &[NodalState]) -> Result<(), ContactError> {
        body::advance(&mut self.bodies, states)
    }

    /// Evaluates all contacts of the deformable bodies where they [are](Self::advance), after the search, which has found another
    /// pair or not: see [`ContactBatch::update_deformables`](crate::ContactBatch::update_deformables).
    pub fn update(
        &mut self,
        states: &[NodalState],
        around: &Around,
        found: bool,
    ) -> Result<(), ContactError> {
        let context = Context {
            around,
            shapes: &self.shapes,
            rigid_sleep: &self.rigid_sleep,
            states,
        };
        let begins = !self.starts.is_empty();
        if begins {
            for pair in self.pairs.list_mut() {
                pair.begins = self.starts.remove(&pair.key());
            }
            self.starts.clear();
        }
        self.pairs.measure_bends(&mut self.bodies);
        let mut looks = look::all(&context, &self.bodies, self.pairs.list_mut());
        let wanted = look::wanted(&looks, self.bodies.len());
        prepare::prepare(&mut self.bodies, &wanted, &context);
        let result = evaluate::run(
            &context,
            &self.bodies,
            self.pairs.list_mut(),
            &mut looks,
            &self.scratches,
        );
        if begins {
            for pair in self.pairs.list_mut() {
                pair.begins = None;
            }
        }
        result?;
        self.gather(&looks, found);
        self.settle();
        Ok(())
    }

    /// Starts a pair with the friction of a contact that was computed elsewhere: see
    /// [`ContactBatch::begin_springs`](crate::ContactBatch::begin_springs).
    pub fn begin_friction(&mut self, a: Side, b: BodyId, start: SpringLoad) {
        if let Some(body) = self.bodies.get_mut(b as usize) {
            body.sleep.stir();
            self.starts.insert((a, b), start);
        }
    }

    /// Sums the forces of the pairs as they are.
    fn gather_again(&mut self, all: bool) {
        let back = |pair: &SoftPair| Look::back(pair, &self.bodies, &self.rigid_sleep);
        let looks: Vec<Look> = self.pairs.list().iter().map(back).collect();
        self.gather(&looks, all);
    }

    /// Sums the forces in the order of the pairs; on bodies among sleepers only if `all`.
    fn gather(&mut self, looks: &[Look], all: bool) {
        let (pairs, count) = (self.pairs.list(), self.bodies.len());
        for (load, resistance) in self.rigid_loads.iter_mut().zip(&mut self.rigid_resistances) {
            // Most numbers are those of deformable bodies, or of bodies that touch none.
            if load.contacts > 0 {
                *load = Load::default();
                *resistance = Resistance::default();
            }
        }
        self.wall_loads.fill(Load::default());
        self.totals = DeformableTotals::default();
        // A pair whose B belongs to another batch is on the books there.
        let booked = |look: &&Look| !self.bodies[look.b as usize].is_guest;
        for look in looks.iter().filter(booked) {
            self.totals += &look.totals;
        }
        let (touching, beside) = look::touching(looks, count);
        for pair in beside.into_iter().map(|place| &pairs[place as usize]) {
            let Some((load, resistance)) = pair.outcome.load.as_deref() else {
                continue;
            };
            match pair.a {
                Side::Rigid(i) => {
                    self.rigid_loads[i as usize] += load;
                    self.rigid_resistances[i as usize] += resistance;
                }
                Side::Wall(w) => self.wall_loads[w as usize] += load,
                Side::Deformable(_) => {}
            }
        }
        let stirred = match all {
            true => vec![true; count],
            false => look::stirred(looks, count),
        };
        body::gather(&mut self.bodies, pairs, &touching, &stirred);
        self.sum_edges();
    }

    /// Whether anything touches a deformable body.
    pub fn touches(&self, body: u32) -> bool {
        self.bodies.get(body as usize).is_some_and(|b| b.loaded)
    }

    /// What the contacts do to the nodes of a body; empty lists if there is no such body.
    pub fn nodal_loads(&self, body: BodyId) -> NodalLoads<'_> {
        let body = self.bodies.get(body as usize);
        body.map_or(NodalLoads::default(), SoftBody::loads)
    }

    /// By number, whether anything is near a deformable body: see
    /// [`ContactBatch::have_neighbours`](crate::ContactBatch::have_neighbours).
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

    /// The pairs whose B belongs to this batch: they are on its books.
    fn booked(&self) -> impl Iterator<Item = &SoftPair> {
        let pairs = self.pairs.list().iter();
        pairs.filter(|pair| !self.bodies[pair.b as usize].is_guest)
    }

    /// Their energies, J.
    pub fn energies(&self) -> impl Iterator<Item = f64> {
        self.booked().map(|pair| pair.totals().energy)
    }

    /// Those with walls: the wall, the force on it without dashpots, N, and the contacts.
    pub fn wall_pairs(&self) -> impl Iterator<Item = (u32, Vector3, &[Contact])> {
        self.booked().filter_map(|pair| {
            let Side::Wall(wall) = pair.a else {
                return None;
            };
            let (load, _) = pair.outcome.load.as_deref()?;
            Some((wall, load.static_part().force, &pair.outcome.contacts[..]))
        })
    }

    /// The contacts, sorted by pair and patch.
    pub fn contacts(&self) -> impl Iterator<Item = &Contact> {
        self.pairs.list().iter().flat_map(|p| &p.outcome.contacts)
    }

    /// The springs of the patches of a body's contacts with others.
    pub fn springs_of(&self, body: BodyId) -> impl Iterator<Item = ((Partner, BodyId), Part)> {
        let thing = Partner::Body(body);
        let pairs = self.pairs.list().iter();
        let patches =
            pairs.flat_map(|pair| pair.outcome.contacts.iter().zip(&pair.outcome.springs));
        let own = patches.filter(move |(contact, _)| (contact.a == thing) != (contact.b == body));
        own.map(|(contact, load)| {
            let part = Part {
                load: *load,
                point: contact.point,
                normal: contact.normal,
                normal_force: contact.normal_force,
            };
            ((contact.a, contact.b), part)
        })
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
