//! Deformable bodies of the batch: they have a number as all bodies do, and meet everything else.

use super::gather::Sums;
use super::{ContactBatch, Snapshot};
use crate::body_shape::Kind;
use crate::contact::{BodyId, Load, Partner};
use crate::deform::{
    Around, DeformablePart, DeformableShape, DeformableTotals, FragmentShape, Modulus, NodalLoads,
    NodalState, Side,
};
use crate::error::{ContactError, check};
use crate::motion::Motion;
use crate::record::Contact;
use crate::spring_load::SpringLoad;
use femdem_mesh::Vector3;
use std::sync::Arc;

impl ContactBatch {
    /// Adds the shape of deformable bodies and returns its index; they are counted apart from those of rigid bodies.
    pub fn add_deformable_shape(&mut self, shape: impl Into<Arc<DeformableShape>>) -> u32 {
        self.deformable_mut().add_shape(shape.into())
    }

    /// Adds a deformable body, awake, and returns its index.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if the shape was never added, [`ContactError::Parameter`] if the modulus is out of its
    /// range.
    pub fn add_deformable(&mut self, shape: u32, modulus: Modulus) -> Result<BodyId, ContactError> {
        modulus.check()?;
        let count = self.deformable_shapes().len();
        if shape as usize >= count {
            return Err(ContactError::NoSuch {
                what: "shape of deformable bodies",
                index: shape as usize,
                count,
            });
        }
        let body = self.take_number(0, Kind::Convex);
        self.deformable_mut().add_body(body, shape, modulus);
        Ok(body)
    }

    /// The shapes of deformable bodies, by index.
    pub fn deformable_shapes(&self) -> &[Arc<DeformableShape>] {
        self.deformable.as_ref().map_or(&[], |part| part.shapes())
    }

    /// Whether there is such a body and it is deformable.
    pub fn is_deformable(&self, body: BodyId) -> bool {
        let part = self.deformable.as_ref();
        part.is_some_and(|part| part.contains(body))
    }

    /// Number of deformable bodies.
    pub fn deformable_count(&self) -> usize {
        self.deformable.as_ref().map_or(0, |part| part.len())
    }

    /// The deformable bodies, ascending.
    pub fn deformable_ids(&self) -> impl Iterator<Item = BodyId> {
        self.body_ids().filter(|body| self.is_deformable(*body))
    }

    /// The modulus of a deformable body.
    pub fn modulus(&self, body: BodyId) -> Option<Modulus> {
        self.deformable.as_ref()?.modulus(body)
    }

    /// Replaces the modulus of a deformable body; its contacts keep their history.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such deformable body, [`ContactError::Parameter`] if the modulus is out of
    /// its range.
    pub fn set_modulus(&mut self, body: BodyId, modulus: Modulus) -> Result<(), ContactError> {
        modulus.check()?;
        self.known_deformable(body)?.set_modulus(body, modulus);
        Ok(())
    }

    /// Gives a deformable body a shape of its own, of index `shape`, which is replaced by `cracked` if that is given: the body
    /// has cracked, and the shape is [`DeformableShape::cracked`] of the present one. The field keeps its stiffness over
    /// depth. Friction goes on where the skin stays; new skin has none.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such deformable body or shape, or another body has that shape.
    pub fn crack_deformable(
        &mut self,
        body: BodyId,
        shape: u32,
        cracked: Option<Arc<DeformableShape>>,
    ) -> Result<(), ContactError> {
        let part = self.known_deformable(body)?;
        let count = part.shapes().len();
        if shape as usize >= count || part.has_another(body, shape) {
            return Err(ContactError::NoSuch {
                what: "shape of this deformable body alone",
                index: shape as usize,
                count,
            });
        }
        part.crack(body, shape, cracked);
        self.broadphase.forget(body as usize);
        Ok(())
    }

    /// Makes bodies of the parts into which a deformable body has fallen, and returns their numbers in the order of `parts`. The first
    /// keeps the number of the body, and the number of its shape, which no other body may have; the others get the next free
    /// ones, and new shapes. All are awake, touch themselves if the body did, and have its material and
    /// its stiffness over depth, but no [frequency](Self::set_frequency). Friction goes on where skin and partner stay, also between parts
    /// that touched each other as parts of one body: where springs are on the skin of both, on that with more of them.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such deformable body, if another body has its shape, and unless each tetrahedron of its mesh is
    /// in one part.
    pub fn fragment_deformable(
        &mut self,
        body: BodyId,
        parts: Vec<FragmentShape>,
    ) -> Result<Vec<BodyId>, ContactError> {
        let material = self.material(body).unwrap_or_default();
        self.known_deformable(body)?.check_parts(body, &parts)?;
        let mut ids = vec![body];
        for _ in 1..parts.len() {
            ids.push(self.take_number(0, Kind::Convex));
        }
        for id in &ids {
            self.materials.of_bodies[*id as usize] = material;
        }
        self.deformable_mut().part(&ids, parts);
        self.broadphase.forget(body as usize);
        Ok(ids)
    }

    /// Sets the frequency of the slowest elastic oscillation of a deformable body, rad/s; π c/L for a bar of length L, with
    /// c = √(E/ρ). If it is high compared with the oscillation on the contacts, the dashpots damp the body as if it
    /// were rigid, with all of its mass. With 0, the initial value, they know the mass of the touching nodes only.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such deformable body, [`ContactError::Parameter`] if the frequency is
    /// negative or not finite.
    pub fn set_frequency(&mut self, body: BodyId, frequency: f64) -> Result<(), ContactError> {
        check(
            "frequency",
            frequency,
            frequency >= 0.0,
            "at least 0 and finite, in rad/s",
        )?;
        self.known_deformable(body)?.set_frequency(body, frequency);
        Ok(())
    }

    /// Sets whether a deformable body may touch itself, as one that folds does. Initially it does not: its parts pass
    /// through each other.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such deformable body.
    pub fn set_self_contact(&mut self, body: BodyId, on: bool) -> Result<(), ContactError> {
        self.known_deformable(body)?.set_self_contact(body, on);
        self.broadphase.forget(body as usize);
        Ok(())
    }

    /// Whether a deformable body may touch itself; `false` for one that does not exist.
    pub fn self_contact(&self, body: BodyId) -> bool {
        let part = self.deformable.as_ref();
        part.is_some_and(|part| part.self_contact(body))
    }

    /// Finds and evaluates all contacts of the deformable bodies, with each other, with rigid bodies and with walls. Those
    /// among rigid bodies and walls are [`update`](Self::update)'s, which is called before.
    ///
    /// `nodes` holds a state for each body by number (see [`slots`](Self::slots)), empty for those that are not
    /// deformable; `bodies` and `walls` are those of `update`. `dt` is the time since the last call, s. The nodal values of
    /// a sleeping deformable body are read only in the first update after it fell asleep, or after a change of the batch
    /// that affects its contacts.
    ///
    /// # Errors
    /// [`ContactError::StateCount`] or [`ContactError::NodeCount`] if a list has the wrong length,
    /// [`ContactError::NodeState`], [`ContactError::NotFinite`] or [`ContactError::Wall`] if a state is not finite or an
    /// inverse mass is negative, [`ContactError::Parameter`] for a `dt` that is negative or not finite,
    /// [`ContactError::InvertedTet`] if a tetrahedron in a contact is inverted, [`ContactError::Parameter`] for a periodic cell
    /// that is too small for a body, and [`ContactError::Mesh`] if a rigid
    /// convex body is too flat for tetrahedra. After an error the histories are a mixture of two steps.
    pub fn update_deformables(
        &mut self,
        nodes: &[NodalState],
        bodies: &[Motion],
        walls: &[Motion],
        dt: f64,
    ) -> Result<(), ContactError> {
        let view = Snapshot { bodies, walls, dt };
        self.check(&view)?;
        self.check_nodes(nodes)?;
        let kinds: Vec<Option<u32>> = (0..self.body_slots.total() as u32)
            .map(|body| self.shape_index(body))
            .collect();
        let lost = |(kind, motion): (&Option<u32>, &Motion)| kind.is_some() && !motion.is_sound();
        if let Some(body) = kinds.iter().zip(bodies).position(lost) {
            return Err(ContactError::NotFinite {
                body,
                position: bodies[body].frame.position.into(),
            });
        }
        self.make_fans()?;
        if let Some(part) = &mut self.deformable {
            part.advance(nodes)?;
        }
        self.search(view)?;
        let found = self.search_deformables(walls)?;
        if let Some(part) = &mut self.deformable {
            let around = Around {
                materials: &self.materials,
                rigid_meshes: &self.fans,
                rigid_kinds: &kinds,
                wall_shapes: &self.walls,
                rigid: bodies,
                walls,
                space: self.space.as_ref(),
                dt,
            };
            part.update(nodes, &around, found)?;
        }
        self.sum_loads();
        Ok(())
    }

    fn check_nodes(&self, nodes: &[NodalState]) -> Result<(), ContactError> {
        let expected = self.body_slots.total();
        if nodes.len() == expected {
            return Ok(());
        }
        Err(ContactError::StateCount {
            what: "nodal state",
            given: nodes.len(),
            expected,
        })
    }

    /// Starts the contact of A and a deformable body B with the friction of a contact that was computed elsewhere, such as
    /// that of rigid bodies: a force on B (N) and a moment on B about the normal (N m), spread over the triangles in
    /// contact in proportion to their normal loads. It takes effect in the next update, if the pair touches
    /// then and has no friction yet.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if A or B is not there or B not deformable, [`ContactError::Parameter`] if the force or the
    /// moment is not finite.
    pub fn begin_friction(
        &mut self,
        a: Partner,
        b: BodyId,
        force: Vector3,
        torsion: f64,
    ) -> Result<(), ContactError> {
        let load = SpringLoad {
            force,
            torsion,
            rolling: Vector3::zeros(),
        };
        self.begin_springs(a, b, load)
    }

    /// [`begin_friction`](Self::begin_friction) with all that springs carry.
    ///
    /// # Errors
    /// As from [`begin_friction`](Self::begin_friction).
    pub fn begin_springs(
        &mut self,
        a: Partner,
        b: BodyId,
        load: SpringLoad,
    ) -> Result<(), ContactError> {
        load.check()?;
        let (a, b, start) = match self.side(a)? {
            Side::Deformable(other) if other > b => {
                self.known_deformable(b)?;
                (Side::Deformable(b), other, load.seen_from(true))
            }
            side => (side, b, load),
        };
        self.known_deformable(b)?.begin_friction(a, b, start);
        Ok(())
    }

    /// What something is to a deformable body that meets it.
    pub(super) fn side(&self, thing: Partner) -> Result<Side, ContactError> {
        match thing {
            Partner::Body(body) if self.is_deformable(body) => Ok(Side::Deformable(body)),
            Partner::Body(body) => self.known_body(body).map(|()| Side::Rigid(body)),
            Partner::Wall(wall) => self.known_wall(wall).map(|()| Side::Wall(wall)),
        }
    }

    /// Whether anything touches a deformable body. If not, its [`nodal_loads`](Self::nodal_loads) are zero.
    pub fn touches(&self, body: BodyId) -> bool {
        let part = self.deformable.as_ref();
        part.is_some_and(|part| part.touches(body))
    }

    /// What the contacts do to the nodes of a deformable body; empty lists if there is no such body.
    pub fn nodal_loads(&self, body: BodyId) -> NodalLoads<'_> {
        let part = self.deformable.as_ref();
        part.map_or(NodalLoads::default(), |part| part.nodal_loads(body))
    }

    /// By number, whether anything is near a deformable body. The others touch nothing, and did not come near anything in the
    /// last update.
    pub fn have_neighbours(&self) -> Vec<bool> {
        let part = self.deformable.as_ref();
        part.map_or_else(Vec::new, |part| part.have_neighbours())
    }

    /// Rigid bodies that touch an awake deformable body, in ascending order.
    pub fn rigid_beside_awake(&self) -> Vec<BodyId> {
        let part = self.deformable.as_ref();
        part.map_or_else(Vec::new, |part| part.rigid_beside_awake())
    }

    /// Whether the forces on a deformable body may have changed in the last update: not if it sleeps among
    /// sleepers. `false` for a body that does not exist.
    pub fn is_stirred(&self, body: BodyId) -> bool {
        let part = self.deformable.as_ref();
        part.is_some_and(|part| part.is_stirred(body))
    }

    /// The contacts of deformable bodies, sorted by pair and patch.
    pub fn deformable_contacts(&self) -> impl Iterator<Item = &Contact> {
        self.deformable.iter().flat_map(|part| part.contacts())
    }

    /// Sums of the last update over the contacts of deformable bodies; `None` if there were never any.
    pub fn deformable_totals(&self) -> Option<&DeformableTotals> {
        self.deformable.as_ref().map(|part| part.totals())
    }

    /// The deformable part, made beside all rigid bodies and walls if it does not exist.
    pub(super) fn deformable_mut(&mut self) -> &mut DeformablePart {
        let (awake, walls) = (&self.awake, self.walls.len());
        if self.deformable.is_none() {
            self.all_loads = [self.sums.loads.clone(), self.sums.walls.clone()];
        }
        let part = self
            .deformable
            .get_or_insert_with(|| Box::new(DeformablePart::beside(awake, walls)));
        part.as_mut()
    }

    pub(super) fn known_deformable(
        &mut self,
        body: BodyId,
    ) -> Result<&mut DeformablePart, ContactError> {
        let count = self.deformable_count();
        let part = self.deformable.as_deref_mut();
        part.filter(|part| part.contains(body))
            .ok_or(ContactError::NoSuch {
                what: "deformable body",
                index: body as usize,
                count,
            })
    }

    /// Adds the loads by deformable bodies to those by rigid ones, if there ever were deformable ones.
    pub(super) fn sum_loads(&mut self) {
        if let Some(part) = &self.deformable {
            let numbers = 0..self.body_slots.total() as BodyId;
            let rigid = numbers.filter(|body| !part.contains(*body));
            add_up(&mut self.all_loads, &self.sums, part, rigid);
        }
    }

    /// The same, where only the loads of awake rigid bodies and of walls have changed.
    pub(super) fn sum_loads_of_awake(&mut self) {
        if let Some(part) = &self.deformable {
            let awake = self.awake_list.iter().copied();
            add_up(&mut self.all_loads, &self.sums, part, awake);
        }
    }
}

/// Sums the loads of `bodies`, and of the walls.
fn add_up(
    [of_bodies, of_walls]: &mut [Vec<Load>; 2],
    sums: &Sums,
    part: &DeformablePart,
    bodies: impl Iterator<Item = BodyId>,
) {
    let sum = |load: &Load, other: &Load| {
        let mut sum = *load;
        sum += other;
        sum
    };
    of_bodies.resize(sums.loads.len(), Load::default());
    for i in bodies.map(|body| body as usize) {
        of_bodies[i] = sum(&sums.loads[i], &part.rigid_loads()[i]);
    }
    of_walls.clear();
    let loads = sums.walls.iter().zip(part.wall_loads());
    of_walls.extend(loads.map(|(load, other)| sum(load, other)));
}
