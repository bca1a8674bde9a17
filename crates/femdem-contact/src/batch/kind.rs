//! Rigid bodies that become deformable, and deformable ones that become rigid.

use super::ContactBatch;
use super::pairs::Cache;
use crate::body_shape::{BodyShape, Kind};
use crate::contact::{BodyId, Load, Partner};
use crate::deform::{DeformableShape, Modulus};
use crate::error::ContactError;
use crate::motion::Motion;
use crate::spring_load::{Part, SpringLoad};
use std::collections::BTreeMap;
use std::sync::Arc;

impl ContactBatch {
    /// Makes a rigid body deformable, awake, with the shape of deformable bodies of index `shape`. It keeps its number and its material. Its
    /// contacts end with their history, its bonds too: start them with [what their springs carry](Self::begin_springs). Returns the bodies that it
    /// touched, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such rigid body or shape, [`ContactError::Parameter`] if the modulus is out of
    /// its range.
    pub fn make_deformable(
        &mut self,
        body: BodyId,
        shape: u32,
        modulus: Modulus,
    ) -> Result<Vec<BodyId>, ContactError> {
        modulus.check()?;
        self.known_rigid(body)?;
        let count = self.deformable_shapes().len();
        if shape as usize >= count {
            return Err(ContactError::NoSuch {
                what: "shape of deformable bodies",
                index: shape as usize,
                count,
            });
        }
        let touched = self.leave(body)?;
        let i = body as usize;
        self.awake[i] = false;
        self.awake_list.retain(|other| *other != body);
        self.sums.loads[i] = Load::default();
        self.pairs.set_body(i, Kind::Convex);
        let part = self.deformable_mut();
        part.remove_body(body);
        part.add_body(body, shape, modulus);
        self.sum_loads();
        Ok(touched)
    }

    /// Makes a deformable body rigid, awake, with the shape of index `shape`. It keeps its number and its material. Its contacts end
    /// with their history: once an update has found the new ones, [`set_springs`](Self::set_springs) continues that with rigid bodies and walls,
    /// [`begin_springs`](Self::begin_springs) before it that with deformable ones. Returns the bodies that it touched, ascending.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such deformable body or shape.
    pub fn make_rigid(&mut self, body: BodyId, shape: u32) -> Result<Vec<BodyId>, ContactError> {
        let kind = self.known_shape(shape)?.kind();
        self.known_deformable(body)?;
        let touched = self.leave(body)?;
        let part = self.deformable_mut();
        part.remove_body(body);
        part.add_rigid(body);
        let i = body as usize;
        self.body_shapes[i] = shape;
        self.pairs.set_body(i, kind);
        self.awake[i] = true;
        self.awake_changed = true;
        self.sum_loads();
        Ok(touched)
    }

    /// Replaces a shape of rigid bodies. Contacts of bodies that have it are those of the old one until the next update.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such shape.
    pub fn replace_shape(
        &mut self,
        shape: u32,
        new: impl Into<BodyShape>,
    ) -> Result<(), ContactError> {
        self.known_shape(shape)?;
        self.shapes[shape as usize] = new.into();
        // Tetrahedra are made of shapes in their order.
        self.fans.truncate(shape as usize);
        Ok(())
    }

    /// Replaces a shape of deformable bodies that no body has.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such shape, or a body has it.
    pub fn replace_deformable_shape(
        &mut self,
        shape: u32,
        new: impl Into<Arc<DeformableShape>>,
    ) -> Result<(), ContactError> {
        let count = self.deformable_shapes().len();
        let part = self.deformable_mut();
        if shape as usize >= count || part.has_another(BodyId::MAX, shape) {
            return Err(ContactError::NoSuch {
                what: "shape of no deformable body",
                index: shape as usize,
                count,
            });
        }
        part.replace_shape(shape, new.into());
        Ok(())
    }

    /// Gives the springs of a contact of two rigid bodies, or of one with a wall, of which a mesh is a side, a load instead of that which they
    /// carry; patches share it in proportion to their normal forces. They
    /// act from the next update on, within the bound of friction. Nothing happens if the two do not touch. `motions` are those of
    /// the last update, of bodies and of walls.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] if the load is not finite, [`ContactError::StateCount`] if a motion is missing.
    pub fn set_springs(
        &mut self,
        (a, b): (Partner, BodyId),
        load: &SpringLoad,
        [bodies, walls]: [&[Motion]; 2],
    ) -> Result<(), ContactError> {
        load.check()?;
        let (of_a, number) = match a {
            Partner::Body(body) => (bodies, body),
            Partner::Wall(wall) => (walls, wall),
        };
        let missing = |given: usize| ContactError::StateCount {
            what: "side of a contact",
            given,
            expected: given + 1,
        };
        let of_a = of_a.get(number as usize);
        let of_a = of_a.ok_or_else(|| missing(walls.len()))?;
        let of_b = bodies.get(b as usize);
        let of_b = of_b.ok_or_else(|| missing(bodies.len()))?;
        let ratio = self.materials.law(a, b).tangential_ratio;
        let Some(pair) = self.pairs.between_mut(a, b) else {
            return Ok(());
        };
        let Cache::Mesh(mesh) = &mut pair.cache else {
            return Ok(());
        };
        let pressing: f64 = mesh.patches.iter().map(|p| p.contact.normal_force).sum();
        if pressing > 0.0 {
            for patch in &mut mesh.patches {
                let share = patch.contact.normal_force / pressing;
                patch.carry([of_a, of_b], &load.share(share), ratio);
            }
        }
        Ok(())
    }

    /// What the springs of the contacts of a body with others carry, by pair.
    pub fn springs_of(&self, body: BodyId) -> BTreeMap<(Partner, BodyId), SpringLoad> {
        let mut pairs: BTreeMap<(Partner, BodyId), Vec<Part>> = BTreeMap::new();
        for contact in self.rigid_contacts_of(body) {
            let parts = pairs.entry((contact.a, contact.b)).or_default();
            parts.push(contact.into());
        }
        let part = self.deformable.iter();
        for (pair, patch) in part.flat_map(|part| part.springs_of(body)) {
            pairs.entry(pair).or_default().push(patch);
        }
        let pairs = pairs.into_iter();
        pairs
            .map(|(pair, parts)| (pair, SpringLoad::of_pair(&parts)))
            .collect()
    }

    fn known_rigid(&self, body: BodyId) -> Result<(), ContactError> {
        if self.is_rigid(body) {
            return Ok(());
        }
        Err(ContactError::NoSuch {
            what: "rigid body",
            index: body as usize,
            count: self.rigid_count(),
        })
    }
}
