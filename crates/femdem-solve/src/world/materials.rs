//! Contact laws of pairs of materials, and the materials of bodies and walls.

use super::World;
use super::deformables::check_laws;
use crate::error::SolveError;
use crate::parameters::WorldParameters;
use femdem_contact::{BodyId, ContactLaw, ContactLaws, ContactParameters, MaterialId};

impl World {
    /// Replaces the contact law of all pairs of materials without one of their own; contacts keep their friction history. Frozen
    /// bodies wake, and what the contacts and their springs hold more than before is on the books as work, except before the
    /// first step, when nothing has been held yet.
    ///
    /// # Errors
    /// As [`World::new`], and the errors of [`World::step`].
    pub fn set_contact(&mut self, contact: ContactParameters) -> Result<(), SolveError> {
        let laws = self.batch.laws().clone();
        self.set_laws(laws.with_usual(ContactLaw::new(contact)?))
    }

    /// Gives a pair of materials, or a material and itself, a contact law of its own; `None`: that of the
    /// [parameters](Self::set_contact) again. Contacts, frozen bodies and books as there.
    ///
    /// The penalty is that of the fields of rigid bodies; a deformable body keeps the stiffness of its model, unless that is
    /// [by the law](crate::ContactStiffness::Law): then it is the penalty of its material with itself. The step is stable for
    /// every law of a material and for that of the parameters, also before bodies meet.
    ///
    /// ```
    /// use femdem_contact::{ContactParameters, MaterialId, Wall};
    /// use femdem_mesh::{Pose, Vector3, catalogue::CatalogueShape};
    /// use femdem_solve::{BodySpec, Drive, World, WorldParameters};
    ///
    /// // Two cubes on one ramp of 20 degrees: that of ice slides.
    /// let mut world = World::new(WorldParameters::default())?;
    /// let ice = MaterialId(1);
    /// let usual = world.parameters().contact;
    /// world.set_law(ice, MaterialId::default(), ContactParameters { friction: 0.05, ..usual })?;
    /// let slope = 20_f64.to_radians();
    /// let up = Vector3::new(slope.sin(), 0.0, slope.cos());
    /// world.add_wall(Wall::half_space("ramp", up, 0.0)?, Drive::Fixed)?;
    /// let shape = world.add_shape("cube", &"P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?)?;
    /// let place = |y| Pose::new(0.4995 * up + y * Vector3::y(), slope * Vector3::y());
    /// let stone = world.add_body(BodySpec::at_rest(shape, 2000.0, place(0.0)))?;
    /// let cold = world.add_body(BodySpec { material: ice, ..BodySpec::at_rest(shape, 2000.0, place(2.0)) })?;
    /// while world.time() < 0.2 {
    ///     world.step()?;
    /// }
    /// let speed = |body| world.velocity(body).map_or(f64::NAN, |v| v.norm());
    /// assert!(speed(stone) < 0.05 && speed(cold) > 0.5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`World::set_contact`].
    pub fn set_law(
        &mut self,
        a: MaterialId,
        b: MaterialId,
        law: impl Into<Option<ContactParameters>>,
    ) -> Result<(), SolveError> {
        let law = law.into().map(ContactLaw::new).transpose()?;
        let mut laws = self.batch.laws().clone();
        laws.set([a, b], law);
        self.set_laws(laws)
    }

    /// The contact laws.
    pub fn laws(&self) -> &ContactLaws {
        self.batch.laws()
    }

    /// Replaces the contact law of the parameters and those of all pairs of materials. Contacts, frozen bodies and books as in
    /// [`set_contact`](Self::set_contact).
    ///
    /// # Errors
    /// As [`World::set_contact`].
    pub fn set_laws(&mut self, laws: ContactLaws) -> Result<(), SolveError> {
        let parameters = WorldParameters {
            contact: *laws.usual(),
            ..self.parameters
        };
        parameters.laws(&laws)?;
        self.change_contacts(|world| {
            world.wake_all();
            world.replace_laws(parameters, &laws)
        })
    }

    /// Changes what contacts are, and books what they hold more than before.
    fn change_contacts(
        &mut self,
        change: impl FnOnce(&mut Self) -> Result<(), SolveError>,
    ) -> Result<(), SolveError> {
        self.restored()?;
        self.not_shared("changing laws or materials")?;
        if self.steps == 0 && !self.loaded {
            return change(self);
        }
        self.evaluate_if_due()?;
        let before = self.ledger();
        change(self)?;
        self.evaluate(0.0)?;
        self.loaded = true;
        let after = self.ledger();
        let springs = after.friction_springs - before.friction_springs;
        self.flows.work_in += after.elastic - before.elastic + springs;
        // What friction has dissipated is its work less what its springs hold.
        self.flows.friction_work -= springs;
        Ok(())
    }

    /// Gives the materials other numbers, with their laws: that of material k is `numbers[k]`. No contact changes, and nothing
    /// wakes.
    ///
    /// # Errors
    /// [`SolveError::Contact`] for a material in use beyond the list, and where two would become one; nothing is changed then.
    pub fn renumber_materials(&mut self, numbers: &[MaterialId]) -> Result<(), SolveError> {
        Ok(self.batch.renumber_materials(numbers)?)
    }

    /// The material of a body; of a deformable one, that of its skin.
    pub fn material(&self, id: BodyId) -> Option<MaterialId> {
        self.batch.material(id)
    }

    /// The material of a wall.
    pub fn wall_material(&self, wall: u32) -> Option<MaterialId> {
        self.batch.wall_material(wall)
    }

    /// Gives a body another material. Its contacts keep their friction; it and what it touches wake. What contacts and their
    /// springs hold more than before is on the books as work. Once the world has stepped, this evaluates all contacts: give many
    /// bodies their materials [as they are added](crate::BodySpec::material).
    ///
    /// # Errors
    /// [`SolveError::NoSuch`] for an unknown body, and the errors of [`World::step`].
    pub fn set_material(&mut self, id: BodyId, material: MaterialId) -> Result<(), SolveError> {
        self.known(id)?;
        if self.material(id) == Some(material) {
            return Ok(());
        }
        if self.is_adaptive(id) {
            check_laws(self.batch.laws(), material)?;
        }
        self.change_contacts(|world| {
            let mut touched = world.batch.set_material(id, material)?;
            touched.push(id);
            if let Some(deformables) = &mut world.deformables
                && world.batch.is_deformable(id)
            {
                deformables.renew_modulus(id, &mut world.batch)?;
            }
            world.judge_anew(&touched);
            world.step_control.lose();
            Ok(())
        })
    }

    /// The same for a wall, which is of material 0 when it is added.
    ///
    /// # Errors
    /// As [`World::set_material`].
    pub fn set_wall_material(&mut self, wall: u32, material: MaterialId) -> Result<(), SolveError> {
        self.known_wall(wall)?;
        if self.wall_material(wall) == Some(material) {
            return Ok(());
        }
        self.change_contacts(|world| {
            let touched = world.batch.set_wall_material(wall, material)?;
            world.judge_anew(&touched);
            world.step_control.lose();
            Ok(())
        })
    }
}
