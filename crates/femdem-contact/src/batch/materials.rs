//! Laws, and materials that are given to bodies and walls.

use super::ContactBatch;
use crate::contact::{BodyId, Partner};
use crate::deform::Side;
use crate::error::{ContactError, check};
use crate::law::ContactParameters;
use crate::laws::{ContactLaws, MaterialId};

impl ContactBatch {
    /// The laws.
    pub fn laws(&self) -> &ContactLaws {
        &self.materials.laws
    }

    /// Replaces the laws; contacts keep their history.
    pub fn set_laws(&mut self, laws: impl Into<ContactLaws>) {
        let laws = laws.into();
        // Also bodies asleep are then looked up again.
        self.awake_changed |= self.broadphase.set_range(laws.attraction_range());
        self.materials.laws = laws;
        if let Some(part) = &mut self.deformable {
            part.evaluate_all();
        }
    }

    /// Refuses attraction that contacts would not have: all of deformable bodies, and adhesion and liquid bridges of what is not
    /// round.
    pub(super) fn check_attraction(&self) -> Result<(), ContactError> {
        let laws = &self.materials.laws;
        if !laws.all().any(ContactParameters::attracts) {
            return Ok(());
        }
        type Of = fn(&ContactParameters) -> f64;
        const ROUND: [(&str, Of); 2] = [
            ("adhesion_energy", |law| law.adhesion_energy),
            ("liquid_bridge.tension", |law| {
                law.bridge().map_or(0.0, |bridge| bridge.tension)
            }),
        ];
        const ALL: [(&str, Of); 3] = [("cohesion", |law| law.cohesion), ROUND[0], ROUND[1]];
        let refuse = |kinds: &[(&'static str, Of)], material: MaterialId, allowed| {
            kinds.iter().try_for_each(|(name, of)| {
                let most = laws.of(material).map(of).fold(0.0, f64::max);
                check(name, most, most == 0.0, allowed)
            })
        };
        for body in self.body_ids() {
            let material = self.materials.of_bodies[body as usize];
            let shape = self.shapes.get(self.body_shapes[body as usize] as usize);
            if self.is_deformable(body) {
                let allowed =
                    "0 for the materials of deformable bodies: give it to pairs of others";
                refuse(&ALL, material, allowed)?;
            } else if shape.is_some_and(|shape| shape.sphere().is_none()) {
                let allowed =
                    "0 but for materials of spheres: give polyhedra and meshes a cohesion";
                refuse(&ROUND, material, allowed)?;
            } else if let Some(shape) = shape {
                let bridges = laws.of(material).filter_map(ContactParameters::bridge);
                let most = bridges.map(|bridge| bridge.volume).fold(0.0, f64::max);
                let allowed = "at most the cube of the radius of each ball, m^3";
                let is_small = most <= shape.radius().powi(3);
                check("liquid_bridge.volume", most, is_small, allowed)?;
            }
        }
        for (wall, _) in self.walls().filter(|(_, shape)| shape.is_mesh()) {
            let material = self.materials.of_walls[wall as usize];
            let allowed =
                "0 for the materials of walls from files and of plates, which are not plane";
            refuse(&ROUND, material, allowed)?;
        }
        Ok(())
    }

    /// The law of a contact of `a` and `b`; that with a wall has the friction of walls. `None` if one is not there.
    pub fn law_of(&self, a: Partner, b: BodyId) -> Option<ContactParameters> {
        let a_is_there = match a {
            Partner::Body(a) => self.contains(a),
            Partner::Wall(wall) => self.wall(wall).is_some(),
        };
        (a_is_there && self.contains(b)).then(|| self.materials.law(a, b))
    }

    /// The material of a body.
    pub fn material(&self, body: BodyId) -> Option<MaterialId> {
        self.contains(body)
            .then(|| self.materials.of_bodies[body as usize])
    }

    /// Gives the materials other numbers, with their laws: that of material k is `numbers[k]`. No contact changes.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] for a body or wall whose material is beyond the list, [`ContactError::Parameter`] where two
    /// materials would become one; nothing is changed then.
    pub fn renumber_materials(&mut self, numbers: &[MaterialId]) -> Result<(), ContactError> {
        let mut known = numbers.to_vec();
        known.sort_unstable();
        known.dedup();
        let twice = (numbers.len() - known.len()) as f64;
        let allowed = "0: each material needs a number of its own";
        check(
            "materials with the number of another",
            twice,
            twice == 0.0,
            allowed,
        )?;
        let (of_bodies, of_walls) = (&mut self.materials.of_bodies, &mut self.materials.of_walls);
        let used = of_bodies
            .iter()
            .chain(of_walls.iter())
            .map(|id| usize::from(id.0));
        if let Some(index) = used.max().filter(|&most| most >= numbers.len()) {
            return Err(ContactError::NoSuch {
                what: "number of a material",
                index,
                count: numbers.len(),
            });
        }
        for id in of_bodies.iter_mut().chain(of_walls) {
            *id = numbers[usize::from(id.0)];
        }
        self.materials.laws = self.materials.laws.renumbered(numbers);
        Ok(())
    }

    /// The material of a wall.
    pub fn wall_material(&self, wall: u32) -> Option<MaterialId> {
        self.wall(wall)?;
        self.materials.of_walls.get(wall as usize).copied()
    }

    /// Gives a body another material. A deformable one keeps its [modulus](Self::set_modulus). Its contacts keep their history, and have the laws of the new material from the next
    /// update on. Returns the bodies that it touches, ascending: it and those asleep among them may lose their balance.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such body.
    pub fn set_material(
        &mut self,
        body: BodyId,
        material: MaterialId,
    ) -> Result<Vec<BodyId>, ContactError> {
        let side = self.side(Partner::Body(body))?;
        if self.materials.of_bodies[body as usize] == material {
            return Ok(Vec::new());
        }
        self.materials.of_bodies[body as usize] = material;
        Ok(self.touched_by(side))
    }

    /// The same for a wall.
    ///
    /// # Errors
    /// [`ContactError::NoSuch`] if there is no such wall.
    pub fn set_wall_material(
        &mut self,
        wall: u32,
        material: MaterialId,
    ) -> Result<Vec<BodyId>, ContactError> {
        self.known_wall(wall)?;
        if self.materials.of_walls[wall as usize] == material {
            return Ok(Vec::new());
        }
        self.materials.of_walls[wall as usize] = material;
        Ok(self.touched_by(Side::Wall(wall)))
    }
}
