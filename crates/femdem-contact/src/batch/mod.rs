//! Layer 2: many bodies. The batch owns candidate pairs, their caches and friction
//! history; the host owns the bodies, their integration and the time step.

mod ahead;
mod attraction;
mod bonds;
mod deformable;
mod evaluate;
mod exact;
mod gather;
mod history;
mod implicit;
mod kind;
mod layout;
mod materials;
mod pairs;
mod periodic;
mod query;
mod remove;
mod search;
mod share;
mod stable;
mod stored;

use crate::body_shape::{BodyShape, Kind};
use crate::broadphase::Broadphase;
use crate::contact::{BodyId, Load, Partner, RigidContact};
use crate::deform::{DeformablePart, DeformableShape, Side};
use crate::error::{ContactError, check};
use crate::friction::Pace;
use crate::general::FieldMesh;
use crate::law::ContactParameters;
use crate::laws::{ContactLaws, MaterialId};
use crate::materials::Materials;
use crate::motion::Motion;
use crate::periodic::Space;
use crate::slots::Slots;
use crate::walls::WallShape;
use bonds::Bonds;
pub use bonds::{BondId, EndedBonds};
use evaluate::{Context, Views};
use gather::{Sums, load_not_finite};
pub use implicit::Snapshot;
use pairs::{Pair, PairTable};
use serde::{Deserialize, Serialize};
pub use share::{BodyRecord, BodyRecords, PairRecord};
use std::sync::Arc;

/// Fewer pairs than this are evaluated on the calling thread: handing them out would
/// cost more than it saves. The results are the same bits either way.
#[cfg(feature = "parallel")]
pub(crate) const SERIAL_BELOW: usize = 96;

/// Sums over the pairs that the last update evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct BatchTotals {
    /// Contact energy of the evaluated pairs, J.
    pub energy: f64,
    /// By how much it is larger than before that update, J.
    pub energy_change: f64,
    /// Energy of the liquid bridges that have broken within the step of that update, J: it is lost.
    pub broken: f64,
    /// Energy in their friction springs, J.
    pub spring_energy: f64,
    /// Candidate pairs evaluated.
    pub candidates: usize,
    /// Touching pairs among them.
    pub touching: usize,
}

/// Contact of many bodies and walls of any shape, with friction history.
///
/// Bodies are added, updated with one [`Motion`] each, and removed at any time between updates. Pairs of two bodies
/// that are both asleep are not evaluated; their last contact stays on record. Deformable bodies have numbers among those of
/// the rigid ones, and are updated with the state of their nodes ([`update_deformables`](Self::update_deformables)).
///
/// A number that has become free is given to the next body, the lowest first: an id that was kept after the removal of
/// its body is refused until then, and names the new body afterwards. The same holds for walls.
///
/// Serialised it is for binary formats: its maps have keys of several numbers, and some numbers are
/// infinite, which JSON has not. It is stored without its shapes: once read, it needs
/// [`restore_shapes`](Self::restore_shapes).
///
/// ```
/// use femdem_contact::{ContactBatch, ContactLaw, ContactParameters, ConvexShape, Frame, Motion, Wall};
/// use femdem_mesh::{Matrix3, Vector3, catalogue::CatalogueShape};
///
/// // A cube of side 1 m and 1,000 kg lies 1 mm deep in a floor. The host owns its motion.
/// let cube = ConvexShape::new(&"P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?)?;
/// let mut batch = ContactBatch::new(ContactLaw::new(ContactParameters::default())?);
/// let shape = batch.add_shape(cube);
/// let body = batch.add_body(shape)?;
/// batch.add_wall(Wall::half_space("floor", Vector3::z(), 0.0)?);
/// let frame = Frame { position: Vector3::new(0.0, 0.0, 0.499), ..Frame::identity() };
/// let resting = Motion {
///     inverse_mass: 1e-3,
///     inverse_inertia: Matrix3::identity() * 6e-3,
///     inverse_inertia_max: 6e-3,
///     ..Motion::fixed(frame)
/// };
/// batch.update(&[resting], &[Motion::fixed(Frame::identity())], 1e-4)?;
/// assert_eq!(batch.contacts().len(), 1);
/// let load = batch.load_of(body);
/// assert!(load.total.force.z > 0.0 && load.total.torque.norm() < 1e-9 * load.total.force.z);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ContactBatch {
    materials: Materials,
    #[serde(skip)]
    shapes: Vec<BodyShape>,
    /// Whether the shapes are those of the bodies: not in a batch that was read and has not got them back.
    #[serde(skip)]
    restored: bool,
    /// The shapes as tetrahedra; empty as long as there is no mesh.
    #[serde(skip)]
    fans: Vec<Arc<FieldMesh>>,
    /// Numbers of bodies and of walls. What other lists hold for numbers not in use means nothing.
    body_slots: Slots,
    wall_slots: Slots,
    body_shapes: Vec<u32>,
    walls: Vec<Option<WallShape>>,
    /// Travel of each wall at which all bodies must look for it again, m.
    wall_expires: Vec<f64>,
    awake: Vec<bool>,
    /// Awake bodies, ascending; rebuilt when `awake` has changed.
    awake_list: Vec<BodyId>,
    awake_changed: bool,
    broadphase: Broadphase,
    pairs: PairTable,
    /// Between rigid bodies, which then have no contact.
    bonds: Bonds,
    /// The last step that was not 0, s.
    last_step: f64,
    /// Where space repeats itself.
    space: Option<Space>,
    sums: Sums,
    /// The deformable bodies, if there ever were any.
    deformable: Option<Box<DeformablePart>>,
    /// Then the loads of the bodies and the walls from all contacts.
    #[serde(skip)]
    all_loads: [Vec<Load>; 2],
}

impl ContactBatch {
    /// An empty batch with one contact law, or with laws for pairs of materials.
    pub fn new(laws: impl Into<ContactLaws>) -> Self {
        let laws = laws.into();
        let mut broadphase = Broadphase::default();
        broadphase.set_range(laws.attraction_range());
        Self {
            materials: Materials::new(laws),
            shapes: Vec::new(),
            restored: true,
            fans: Vec::new(),
            body_slots: Slots::default(),
            wall_slots: Slots::default(),
            body_shapes: Vec::new(),
            walls: Vec::new(),
            wall_expires: Vec::new(),
            awake: Vec::new(),
            awake_list: Vec::new(),
            awake_changed: false,
            broadphase,
            pairs: PairTable::default(),
            bonds: Bonds::default(),
            last_step: 0.0,
            space: None,
            sums: Sums::default(),
            deformable: None,
            all_loads: Default::default(),
        }
    }

    /// Adds a shape, convex, a sphere or a mesh, and returns its index.
    pub fn add_shape(&mut self, shape: impl Into<BodyShape>) -> u32 {
        self.shapes.push(shape.into());
        self.shapes.len() as u32 - 1
    }

    /// Adds a body, awake and of material 0, and returns its index.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if the shape was never added.
    pub fn add_body(&mut self, shape: u32) -> Result<BodyId, ContactError> {
        let kind = self.known_shape(shape)?.kind();
        let body = self.take_number(shape, kind);
        self.begin_rigid(body);
        Ok(body)
    }

    /// Begins with a rigid body, awake, under a number that it has got.
    fn begin_rigid(&mut self, body: BodyId) {
        self.awake[body as usize] = true;
        self.awake_changed = true;
        if let Some(part) = &mut self.deformable {
            part.add_rigid(body);
        }
    }

    /// A number for a body: the lowest that is free. It is not awake as a rigid body.
    fn take_number(&mut self, shape: u32, kind: Kind) -> BodyId {
        let slot = self.body_slots.take();
        self.begin_number(slot, shape, kind)
    }

    /// Makes place for a body under a number that has been given out, and says which.
    fn begin_number(&mut self, (body, is_new): (u32, bool), shape: u32, kind: Kind) -> BodyId {
        let i = body as usize;
        if is_new {
            self.body_shapes.push(shape);
            self.materials.of_bodies.push(MaterialId::default());
            self.awake.push(false);
            self.sums.loads.push(Load::default());
            if self.deformable.is_some() {
                self.all_loads[0].push(Load::default());
            }
        } else {
            self.body_shapes[i] = shape;
            self.materials.of_bodies[i] = MaterialId::default();
        }
        self.pairs.set_body(i, kind);
        body
    }

    fn known_shape(&self, shape: u32) -> Result<&BodyShape, ContactError> {
        self.shapes.get(shape as usize).ok_or(ContactError::NoSuch {
            what: "shape",
            index: shape as usize,
            count: self.shapes.len(),
        })
    }

    /// Adds a wall, of planes or a mesh, of material 0, and returns its index.
    pub fn add_wall(&mut self, wall: impl Into<WallShape>) -> u32 {
        let wall = wall.into();
        let (slot, is_new) = self.wall_slots.take();
        let w = slot as usize;
        self.pairs.set_wall(w, wall.is_mesh());
        if is_new {
            self.walls.push(Some(wall));
            self.materials.of_walls.push(MaterialId::default());
            self.wall_expires.push(f64::NEG_INFINITY);
            self.sums.walls.push(Load::default());
            if self.deformable.is_some() {
                self.all_loads[1].push(Load::default());
            }
        } else {
            self.walls[w] = Some(wall);
            self.materials.of_walls[w] = MaterialId::default();
            self.wall_expires[w] = f64::NEG_INFINITY;
        }
        if let Some(part) = &mut self.deformable {
            part.add_wall(slot);
        }
        slot
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.body_slots.len()
    }

    /// Whether there are no bodies.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The bodies, ascending.
    pub fn body_ids(&self) -> impl Iterator<Item = BodyId> {
        self.body_slots.iter()
    }

    /// Whether there is such a body.
    pub fn contains(&self, body: BodyId) -> bool {
        self.body_slots.holds(body)
    }

    /// Whether there is such a body and it is rigid.
    pub fn is_rigid(&self, body: BodyId) -> bool {
        self.contains(body) && !self.is_deformable(body)
    }

    /// Number of rigid bodies.
    pub fn rigid_count(&self) -> usize {
        self.len() - self.deformable_count()
    }

    /// The rigid bodies, ascending.
    pub fn rigid_ids(&self) -> impl Iterator<Item = BodyId> {
        self.body_ids().filter(|body| self.is_rigid(*body))
    }

    /// Index of the shape of a rigid body.
    pub fn shape_index(&self, body: BodyId) -> Option<u32> {
        self.is_rigid(body).then(|| self.body_shapes[body as usize])
    }

    /// Numbers of bodies and of walls that have been in use: how many motions of each [`update`](Self::update) takes.
    pub fn slots(&self) -> [usize; 2] {
        [self.body_slots.total(), self.wall_slots.total()]
    }

    fn known_body(&self, body: BodyId) -> Result<(), ContactError> {
        if self.contains(body) {
            return Ok(());
        }
        Err(ContactError::NoSuch {
            what: "body",
            index: body as usize,
            count: self.len(),
        })
    }

    fn known_wall(&self, wall: u32) -> Result<(), ContactError> {
        if self.wall_slots.holds(wall) {
            return Ok(());
        }
        Err(ContactError::NoSuch {
            what: "wall",
            index: wall as usize,
            count: self.wall_slots.len(),
        })
    }

    /// The walls with their indices, ascending.
    pub fn walls(&self) -> impl Iterator<Item = (u32, &WallShape)> {
        let walls = (0..).zip(&self.walls);
        walls.filter_map(|(w, wall)| Some((w, wall.as_ref()?)))
    }

    /// A wall.
    pub fn wall(&self, wall: u32) -> Option<&WallShape> {
        self.walls.get(wall as usize)?.as_ref()
    }

    /// The shapes, by index.
    pub fn shapes(&self) -> &[BodyShape] {
        &self.shapes
    }

    /// Gives a batch that was read from a file its shapes back, those of rigid and those of deformable bodies, in the order of
    /// addition.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if a body refers to a shape that is not there, [`ContactError::Stored`] if the shape is
    /// of another kind, convex, sphere or mesh, than it was, or if what was read is not consistent.
    pub fn restore_shapes(
        &mut self,
        shapes: Vec<BodyShape>,
        deformable: Vec<Arc<DeformableShape>>,
    ) -> Result<(), ContactError> {
        stored::check(self, &shapes)?;
        if let Some(mut part) = self.deformable.take() {
            let restored = part.restore_shapes(deformable, self.slots(), |side| match side {
                Side::Rigid(body) | Side::Deformable(body) => self.contains(body),
                Side::Wall(wall) => self.wall_slots.holds(wall),
            });
            self.deformable = Some(part);
            restored?;
        }
        self.sum_loads();
        self.shapes = shapes;
        self.restored = true;
        self.fans.clear();
        Ok(())
    }

    /// Whether a body is awake; `false` for a body that does not exist.
    pub fn is_awake(&self, body: BodyId) -> bool {
        let rigid = self.awake.get(body as usize).copied().unwrap_or(false);
        rigid
            || self
                .deformable
                .as_ref()
                .is_some_and(|part| part.is_awake(body))
    }

    /// Wakes a body or puts it to sleep. Between two sleeping bodies, and between a sleeping deformable body and a wall,
    /// nothing is evaluated: contacts stay as they are. The next update reads the state of a deformable body once more,
    /// which should be at rest; after that it must not move until it is woken, and a host that moves a wall must wake what
    /// touches it.
    pub fn set_awake(&mut self, body: BodyId, awake: bool) {
        let is_rigid = self.is_rigid(body);
        if let Some(part) = &mut self.deformable {
            if is_rigid {
                part.set_rigid_awake(body, awake);
            } else {
                part.set_awake(body, awake);
            }
        }
        if is_rigid && self.awake[body as usize] != awake {
            self.awake[body as usize] = awake;
            self.awake_changed = true;
            self.pairs.mark_changed();
        }
    }

    /// Wakes a rigid body with the load of its contacts on record.
    pub fn wake_with_load(&mut self, body: BodyId) {
        if self.is_rigid(body) {
            self.sums.loads[body as usize] = self.rigid_load_of(body);
            let load = self.load_of(body);
            if let Some(sum) = self.all_loads[0].get_mut(body as usize) {
                *sum = load;
            }
            self.set_awake(body, true);
        }
    }

    /// Sleeping bodies that are candidates of an awake body, sorted.
    pub fn sleeping_neighbours(&self) -> Vec<BodyId> {
        let asleep = |i: &u32| !self.awake[*i as usize];
        let mut list: Vec<u32> = self
            .pairs
            .evaluated()
            .flat_map(|pair| match pair.a {
                Partner::Body(a) => [a, pair.b],
                Partner::Wall(_) => [pair.b, pair.b],
            })
            .filter(asleep)
            .collect();
        list.sort_unstable();
        list.dedup();
        list
    }

    /// Sleeping bodies, sorted, in contact with an awake body under a normal force for which
    /// `is_struck(body, force)` holds.
    pub fn struck_sleepers(&self, is_struck: impl Fn(BodyId, f64) -> bool) -> Vec<BodyId> {
        let mut list: Vec<BodyId> = Vec::new();
        for contact in self.pairs.evaluated().flat_map(|p| p.contacts()) {
            let Partner::Body(a) = contact.a else {
                continue;
            };
            for body in [a, contact.b] {
                if !self.awake[body as usize] && is_struck(body, contact.normal_force) {
                    list.push(body);
                }
            }
        }
        list.sort_unstable();
        list.dedup();
        list
    }

    /// Sleeping bodies, sorted, that something has left in the last update: it is no candidate of theirs any more, and
    /// what they bore of it is gone.
    pub fn left_sleepers(&self) -> Vec<BodyId> {
        let asleep = |i: &u32| !self.awake[*i as usize];
        let mut list: Vec<BodyId> = self.pairs.left.iter().copied().filter(asleep).collect();
        list.sort_unstable();
        list.dedup();
        list
    }

    /// Finds and evaluates all contacts of awake bodies.
    ///
    /// `bodies` and `walls` hold one motion per body and wall, by index (see [`slots`](Self::slots); those of removed ones
    /// are not read); `dt` is the time
    /// since the last update, s (friction history and torsion advance by it). Velocities are those of the leapfrog
    /// method, of the half step before: the dashpot allows for their lag of dt/2. At `dt` 0 there is none.
    ///
    /// # Errors
    /// [`ContactError::StateCount`] if a slice has the wrong length,
    /// [`ContactError::NotFinite`] and [`ContactError::Wall`] if the state of an awake body or of a
    /// wall is not finite or has a negative inverse mass, [`ContactError::LoadNotFinite`] if what the contacts do to an
    /// awake body overflows, as at speeds of 1e300 m/s ([`ContactError::Wall`] if only the load on a wall does; the
    /// contacts are then of no further use), [`ContactError::Parameter`] for a
    /// `dt` that is negative or not finite, [`ContactError::NoSuch`] if the batch was read from a
    /// file and has not got its [shapes](Self::restore_shapes) back,
    /// [`ContactError::Mesh`] if a convex body among meshes is too flat for tetrahedra.
    pub fn update(
        &mut self,
        bodies: &[Motion],
        walls: &[Motion],
        dt: f64,
    ) -> Result<(), ContactError> {
        self.advance(Snapshot { bodies, walls, dt }, None)
    }

    /// Contacts at the present places, or at present and ahead without dashpots.
    fn advance<'a>(
        &mut self,
        now: Snapshot<'a>,
        ahead: Option<Snapshot<'a>>,
    ) -> Result<(), ContactError> {
        for view in [Some(now), ahead].into_iter().flatten() {
            self.check(&view)?;
        }
        let view = ahead.unwrap_or(now);
        let bodies = view.bodies;
        self.pairs.left.clear();
        self.pairs.broken = 0.0;
        if view.dt > 0.0 {
            self.last_step = view.dt;
        }
        self.make_fans()?;
        self.search(view)?;
        self.pairs.refresh_order(&self.awake, &self.awake_list);
        let attracts = self.materials.laws.all().any(ContactParameters::attracts);
        let context = |view: Snapshot<'a>| Context {
            materials: &self.materials,
            shapes: &self.shapes,
            fans: &self.fans,
            body_shapes: &self.body_shapes,
            wall_shapes: &self.walls,
            bodies: view.bodies,
            walls: view.walls,
            space: self.space.as_ref(),
            bonds: &self.bonds,
            attracts,
            last_step: self.last_step,
            pace: Pace {
                dt: view.dt,
                dashpots: ahead.is_none(),
                share: 1.0,
                birth: None,
            },
        };
        let (now, ahead) = (context(now), ahead.map(context));
        let views = Views {
            now: &now,
            ahead: ahead.as_ref(),
        };
        self.sums.begin(&self.awake_list);
        let guests = std::mem::take(&mut self.pairs.guests);
        let seen = |pair: &Pair| self.sums.add(&self.awake, &guests, pair);
        evaluate::run(views, &mut self.pairs, seen);
        self.pairs.guests = guests;
        // Outside of a step the host has changed what holds them, and keeps the books of that.
        if now.pace.dt > 0.0 {
            self.sums.totals.broken += self.pairs.broken;
        }
        let is_guest = |body| self.pairs.is_guest(body);
        self.bonds.update(bodies, &self.awake, is_guest);
        self.bonds.add_loads(&self.awake, &mut self.sums.loads);
        self.sum_loads_of_awake();
        self.check_results(bodies)
    }

    /// Refuses results that are not finite.
    fn check_results(&self, bodies: &[Motion]) -> Result<(), ContactError> {
        self.sums.check(&self.awake_list, bodies, &self.walls)?;
        let totals = self.totals();
        let energies = [totals.energy, totals.energy_change, totals.spring_energy];
        if energies.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        let stored = |c: &&RigidContact| (c.potential() + c.spring_energy).abs();
        let contacts = self.evaluated();
        match contacts.max_by(|a, b| stored(a).total_cmp(&stored(b))) {
            Some(contact) => Err(load_not_finite(contact.b as usize, bodies)),
            // All that is not finite is the energy of contacts that have ended.
            None => Ok(()),
        }
    }

    /// Whether the states fit what was added.
    fn check(&self, view: &Snapshot) -> Result<(), ContactError> {
        for (what, given, expected) in [
            ("body", view.bodies.len(), self.body_shapes.len()),
            ("wall", view.walls.len(), self.walls.len()),
        ] {
            if given != expected {
                return Err(ContactError::StateCount {
                    what,
                    given,
                    expected,
                });
            }
        }
        if let Some((_, wall)) = self
            .walls()
            .find(|(w, _)| !view.walls[*w as usize].is_sound())
        {
            return Err(ContactError::Wall {
                name: wall.name().to_owned(),
                why: "its motion is not finite".to_owned(),
            });
        }
        self.check_space(view)?;
        self.check_attraction()?;
        if !self.restored && !self.is_empty() {
            return Err(ContactError::NoSuch {
                what: "shape",
                index: self.body_shapes[0] as usize,
                count: 0,
            });
        }
        check("dt", view.dt, view.dt >= 0.0, "0 or more and finite, in s")
    }

    /// Makes tetrahedra of the shapes, once a mesh can meet them.
    fn make_fans(&mut self) -> Result<(), ContactError> {
        let are_met = self.pairs.has_meshes() || self.deformable.is_some();
        if self.fans.len() < self.shapes.len() && are_met {
            for shape in &self.shapes[self.fans.len()..] {
                self.fans.push(shape.tetrahedra()?);
            }
        }
        Ok(())
    }

    /// Sums the loads of awake bodies and walls in the order of the pairs.
    fn gather(&mut self) {
        self.sums.begin(&self.awake_list);
        for pair in self.pairs.evaluated() {
            self.sums.add(&self.awake, &self.pairs.guests, pair);
        }
        self.sum_loads_of_awake();
    }
}
