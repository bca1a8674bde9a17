//! Fracture of the materials of a scenario.

use femdem_contact::glue::Softening;
use femdem_fem::element::Element;
use femdem_fem::fracture::{Strength, Weibull};
use femdem_mesh::tet::Facets;
use femdem_solve::Fracture;
use serde::{Deserialize, Serialize};

use super::{Behaviour, BodyEntry, MaterialEntry, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;

/// How the bodies of a material break; see [`Fracture`]. What is `None` has the usual value of that.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct FractureEntry {
    /// Tensile strength \[Pa\].
    pub tensile: f64,
    /// Cohesion of Mohr-Coulomb \[Pa\].
    pub cohesion: f64,
    /// Angle of friction of Mohr-Coulomb \[degrees\].
    pub friction_angle: f64,
    /// Energies of fracture by opening and by sliding \[J/m²\].
    pub energy: [f64; 2],
    /// Exponent of mixed modes.
    #[serde(default)]
    pub mix: Option<f64>,
    /// How the traction of a crack falls.
    #[serde(default)]
    pub softening: Option<Softening>,
    /// Scatter of the strength from place to place.
    #[serde(default)]
    pub weibull: Option<WeibullEntry>,
    /// Steps between two looks at the stresses.
    #[serde(default)]
    pub every: Option<u32>,
    /// Stiffness of a new crack over E/h.
    #[serde(default)]
    pub stiffness: Option<f64>,
    /// Slip over h at which the sides of a broken facet become skin.
    #[serde(default)]
    pub release: Option<f64>,
    /// Whether the mesh may be too coarse for the process zone.
    #[serde(default)]
    pub coarse: bool,
}

/// Weibull's scatter of the strength.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct WeibullEntry {
    /// Modulus; a large one means little scatter.
    pub modulus: f64,
    /// The volume whose characteristic strength is that of the material \[m³\].
    pub volume: f64,
    /// Seed of the scatter.
    #[serde(default)]
    pub seed: u64,
}

impl FractureEntry {
    /// The same for the engine.
    ///
    /// # Errors
    ///
    /// [`Error::Option`] with the key that is out of its range.
    pub fn fracture(&self) -> Result<Fracture, Error> {
        let positive = "above 0 and finite";
        let check = |name: &'static str, value: f64, allowed| match value > 0.0 && value.is_finite()
        {
            true => Ok(()),
            false => Err(wrong(name, &value.to_string(), allowed)),
        };
        check(
            "fracture.tensile",
            self.tensile,
            "above 0 and finite, in Pa",
        )?;
        check(
            "fracture.cohesion",
            self.cohesion,
            "above 0 and finite, in Pa",
        )?;
        let angle = self.friction_angle;
        if !(0.0..90.0).contains(&angle) {
            let allowed = "from 0 to below 90, in degrees";
            return Err(wrong(
                "fracture.friction-angle",
                &angle.to_string(),
                allowed,
            ));
        }
        let [opening, sliding] = self.energy;
        if !(opening > 0.0 && sliding >= opening && sliding.is_finite()) {
            let allowed =
                "that of opening above 0, then that of sliding, at least as large, in J/m²";
            return Err(wrong(
                "fracture.energy",
                &format!("{:?}", self.energy),
                allowed,
            ));
        }
        if self.every == Some(0) {
            return Err(wrong("fracture.every", "0", "at least 1 step"));
        }
        for (name, value) in [
            ("fracture.mix", self.mix),
            ("fracture.stiffness", self.stiffness),
            ("fracture.release", self.release),
        ] {
            value.map_or(Ok(()), |value| check(name, value, positive))?;
        }
        let scatter = self
            .weibull
            .map(|entry| Weibull::new(entry.modulus, entry.volume, entry.seed));
        let strength = Strength::new(self.tensile, self.cohesion, angle.to_radians())?;
        let usual = Fracture::new(strength, self.energy);
        Ok(Fracture {
            mix: self.mix.unwrap_or(usual.mix),
            softening: self.softening.unwrap_or(usual.softening),
            every: self.every.unwrap_or(usual.every),
            stiffness: self.stiffness.unwrap_or(usual.stiffness),
            release: self.release.unwrap_or(usual.release),
            coarse: self.coarse,
            scatter: scatter.transpose()?,
            ..usual
        })
    }
}

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
        if self.behaviour == Behaviour::Breakable && self.element != Element::T4 {
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
        if body.behaviour != Behaviour::Breakable {
            return Ok(None);
        }
        let fracture = self.material(&body.material)?.breaks();
        let named = super::build::in_entry(format!("material.{}", body.material));
        fracture.map(Some).map_err(named)
    }

    /// Whether a body may break.
    pub(super) fn has_breakable(&self) -> bool {
        let mut bodies = self.body.iter();
        bodies.any(|body| body.behaviour == Behaviour::Breakable)
    }

    /// Refuses the fracture of a material of which no breakable body is made.
    pub(super) fn refuse_idle_fracture(&self, name: &str) -> Result<(), Error> {
        let mut bodies = self.body.iter();
        let breaks =
            |body: &BodyEntry| body.behaviour == Behaviour::Breakable && body.material == name;
        if self
            .material
            .get(name)
            .is_some_and(|m| m.fracture.is_some())
            && !bodies.any(breaks)
        {
            let allowed = "no breakable body is made of the material: add behaviour = \"breakable\" to one, or take it out; \
                           a body breaks by its own material, not by that of a region";
            return Err(wrong("fracture", "given", allowed));
        }
        Ok(())
    }

    /// For each entry of breakable bodies, the mesh and the zone in which cracks open.
    #[must_use]
    pub fn fracture_meshes(&self, simulation: &Simulation) -> Vec<FractureMesh> {
        let mut found = Vec::new();
        let mut first = simulation.origin.bodies;
        for (entry, count) in self.body.iter().zip(&simulation.origin.members) {
            let member = simulation.members.get(first);
            first += count;
            let Some(member) = member else { continue };
            let Some(body) = simulation.world.deformable(member.id) else {
                continue;
            };
            let Some(cracks) = body.cracks() else {
                continue;
            };
            let names = [&entry.material].into_iter();
            let names = names.chain(entry.region.iter().map(|part| &part.material));
            let youngs = names.filter_map(|name| self.material.get(name)?.young);
            let young = youngs.fold(0.0, f64::max);
            let model = body.model();
            let (mut volume, mut area) = (0.0, 0.0);
            for facet in Facets::new(model.mesh()).all() {
                let [a, b, c] = facet.points.map(|i| model.nodes()[i as usize]);
                area += 0.5 * (b - a).cross(&(c - a)).norm();
                let beside = facet.tets.iter().map(|t| model.volumes()[*t as usize]);
                volume += beside.sum::<f64>();
            }
            found.push(FractureMesh {
                body: member.name.clone(),
                process_zone: cracks.fracture().process_zone(young),
                largest_height: cracks.fracture().largest_height(young),
                height: if area > 0.0 { 1.5 * volume / area } else { 0.0 },
            });
        }
        found
    }
}
