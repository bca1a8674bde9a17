//! The bodies of a scenario that may break.

use femdem_fem::element::Element;
use femdem_solve::Fracture;

use super::words::in_entry;
use super::{BodyEntry, MaterialEntry, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;

/// The mesh of a breakable body beside the zone in which its cracks open.
#[derive(Clone, Debug, PartialEq)]
pub struct FractureMesh {
    /// Name of the body.
    pub body: String,
    /// Length of the zone \[m\]: [`Fracture::process_zone`].
    pub process_zone: f64,
    /// Largest height of the elements with which cracks take the energy given \[m\]: [`Fracture::largest_height`].
    pub largest_height: f64,
    /// Mean height of the elements beside facets, by area \[m\].
    pub height: f64,
}

impl BodyEntry {
    /// Refuses elements that cannot break.
    pub(super) fn refuse_unbreakable(&self) -> Result<(), Error> {
        if self.behaviour.breaks() && self.element != Element::T4 {
            let allowed = "breakable bodies have linear elements: leave it out, or give \"t4\"";
            let value = format!("{:?}", self.element);
            return Err(wrong("element", &value, allowed));
        }
        Ok(())
    }
}

impl MaterialEntry {
    /// How bodies of it break; an error for a material that does not say.
    fn breaks(&self) -> Result<Fracture, Error> {
        let entry = self.fracture.as_ref().ok_or_else(|| {
            let allowed =
                "a breakable body needs the fracture of its material: give [material.NAME.fracture]";
            wrong("fracture", "none", allowed)
        })?;
        entry.fracture()
    }
}

impl Scenario {
    /// How a body breaks; `None` if it does not.
    pub(super) fn fracture_of(&self, body: &BodyEntry) -> Result<Option<Fracture>, Error> {
        if !body.behaviour.breaks() {
            return Ok(None);
        }
        let fracture = self.material(&body.material)?.breaks();
        let named = in_entry(format!("material.{}", body.material));
        fracture.map(Some).map_err(named)
    }

    /// Whether a body may break.
    pub(super) fn has_breakable(&self) -> bool {
        let mut bodies = self.body.iter();
        bodies.any(|body| body.behaviour.breaks())
    }

    /// Refuses the fracture of a material of which no breakable body is made.
    pub(super) fn refuse_idle_fracture(&self, name: &str) -> Result<(), Error> {
        let mut bodies = self.body.iter();
        let breaks = |body: &BodyEntry| body.behaviour.breaks() && body.material == name;
        if self
            .material
            .get(name)
            .is_some_and(|m| m.fracture.is_some())
            && !bodies.any(breaks)
        {
            let allowed = "no breakable body is made of the material: add behaviour = \"breakable\" or \"adaptive\" to one, or take it out; \
                           a body breaks by its own material, not by that of a region";
            return Err(wrong("fracture", "given", allowed));
        }
        Ok(())
    }
}

impl Simulation {
    /// For each entry of breakable bodies, the mesh and the zone in which cracks open.
    #[must_use]
    pub fn fracture_meshes(&self) -> Vec<FractureMesh> {
        let mut found = Vec::new();
        let mut first = self.origin.bodies;
        for count in &self.origin.members {
            let member = self.members.get(first);
            first += count;
            let Some(member) = member else { continue };
            let Some(body) = self.world.deformable(member.id) else {
                continue;
            };
            let Some(cracks) = body.cracks() else {
                continue;
            };
            found.push(FractureMesh {
                body: member.name.clone(),
                process_zone: cracks.process_zone(),
                largest_height: cracks.largest_height(),
                height: cracks.element_height(),
            });
        }
        found
    }
}
