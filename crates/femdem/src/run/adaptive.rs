//! Bodies of a scenario that are rigid far from their strength, and deformable near it.

use std::io::{self, Write};

use femdem_contact::{BodyId, Field};
use femdem_fem::{DeformableModel, MaterialRegion};
use femdem_mesh::{Pose, TetMesh};
use femdem_solve::{Adaptive, BodySpec, ContactStiffness, Fidelity};
use femdem_view::output::csv::quoted;

use super::build::check_ratio;
use super::fidelity::FidelitySummary;
use super::history::number;
use super::places::Place;
use super::{Behaviour, BodyEntry, Member, Scenario, Simulation};
use crate::Error;
use crate::error::wrong;

/// Columns of `fidelity.csv`.
pub const FIDELITY_COLUMNS: [&str; 5] = ["time", "body", "to", "strength_ratio", "energy"];

impl BodyEntry {
    /// Refuses keys that a body cannot have that is rigid and deformable by turns.
    pub(super) fn refuse_unadaptive(&self) -> Result<(), Error> {
        if self.behaviour != Behaviour::Adaptive {
            return Ok(());
        }
        let of_others = [
            ("motion", self.motion.is_some()),
            ("boundary", !self.boundary.is_empty()),
            ("region", !self.region.is_empty()),
            ("self-contact", self.self_contact.is_some()),
            ("mass-scaling", self.mass_scaling.is_some()),
        ];
        match of_others.iter().find(|(_, given)| *given) {
            Some((name, _)) => Err(wrong(
                name,
                "given",
                "an adaptive body has none, since it is rigid at times: take it out, or give behaviour = \"breakable\"",
            )),
            None => Ok(()),
        }
    }
}

impl Scenario {
    /// Whether a body is adaptive.
    pub(super) fn has_adaptive(&self) -> bool {
        let mut bodies = self.body.iter();
        bodies.any(|body| body.behaviour == Behaviour::Adaptive)
    }
}

impl Simulation {
    pub(super) fn add_adaptive(
        &mut self,
        scenario: &Scenario,
        entry: &BodyEntry,
        name: &str,
        (mesh, density_factor): (&TetMesh, f64),
        places: &[Place],
    ) -> Result<Vec<(BodyId, Pose)>, Error> {
        let region = scenario.region(&entry.material)?;
        let density = region.density * density_factor;
        let regions = vec![MaterialRegion { density, ..region }];
        let model = DeformableModel::new(mesh, entry.element, regions, None)?;
        let material = scenario.material_id(&entry.material)?;
        let ratio = scenario.contact_ratio(entry);
        check_ratio(ratio)?;
        let Some(fracture) = scenario.fracture_of(entry)? else {
            return Ok(Vec::new());
        };
        let shape = self
            .world
            .add_mesh_shape(name, &mesh.surface()?, mesh, Field::Body)?;
        let model = self.world.add_model(name, model, ContactStiffness::Law)?;
        let mut ids = Vec::new();
        for place in places {
            let id = self.world.add_body(BodySpec {
                shape,
                density,
                pose: place.pose,
                velocity: place.velocity,
                angular_velocity: place.spin,
                material,
            })?;
            self.world.set_adaptive(id, Adaptive { model, fracture })?;
            self.fidelity.bodies += 1;
            ids.push((id, place.pose));
        }
        Ok(ids)
    }

    /// Whether the scene has adaptive bodies.
    pub(super) fn has_adaptive(&self) -> bool {
        self.fidelity.bodies > 0
    }

    /// Whether there are, or may be, deformable bodies.
    pub(super) fn has_deformable(&self) -> bool {
        self.world.deformable_count() > 0 || self.has_adaptive()
    }

    /// Adaptive bodies that are rigid now, with their numbers among the members and their tetrahedra.
    pub(super) fn adaptive_rigid(&self) -> impl Iterator<Item = (usize, &Member, &TetMesh)> {
        let members = self.members.iter().enumerate();
        members
            .filter_map(|(number, member)| Some((number, member, self.adaptive_mesh(member.id)?)))
    }

    /// The tetrahedra of an adaptive body that is rigid now.
    pub(super) fn adaptive_mesh(&self, id: BodyId) -> Option<&TetMesh> {
        let shape = self.world.shape_of(id)?;
        let is_adaptive = self.world.is_adaptive(id);
        let mesh = self.world.shape(shape)?.mesh.as_ref();
        mesh.filter(|_| is_adaptive).map(|(mesh, _)| mesh)
    }

    /// Notes which adaptive bodies have changed in the last step.
    pub(super) fn note_fidelity(&mut self) {
        let changes = self.world.take_fidelity_changes();
        if changes.is_empty() {
            return;
        }
        for change in changes {
            let member = self.members.iter().find(|member| member.id == change.body);
            let name = member.map_or_else(String::new, |member| member.name.clone());
            self.fidelity.changes.push((name, change));
        }
        let share = self.deformable_share();
        self.fidelity.largest_share = self.fidelity.largest_share.max(share);
    }

    /// Mass of the deformable bodies over that of all bodies.
    pub(super) fn deformable_share(&self) -> f64 {
        let mass = |id: BodyId| self.world.mass(id).unwrap_or(0.0);
        let soft: f64 = self.world.deformable_ids().map(mass).sum();
        let all: f64 = self.world.body_ids().map(mass).sum();
        if soft > 0.0 { soft / all } else { 0.0 }
    }

    /// The adaptive bodies in numbers; `None` without any.
    #[must_use]
    pub fn fidelity_summary(&self) -> Option<FidelitySummary> {
        let bodies = self.fidelity.bodies;
        let changes = || self.fidelity.changes.iter().map(|(_, change)| change);
        let to = |kind: Fidelity| changes().filter(move |change| change.to == kind);
        let highest = to(Fidelity::Deformable).map(|change| change.ratio);
        let share = self.deformable_share();
        (bodies > 0).then(|| FidelitySummary {
            bodies,
            softened: to(Fidelity::Deformable).count(),
            hardened: to(Fidelity::Rigid).count(),
            highest: highest.fold(0.0, f64::max),
            deformable_share: share,
            largest_share: self.fidelity.largest_share.max(share),
        })
    }

    /// Writes `fidelity.csv`.
    pub(super) fn write_fidelity(&self, mut writer: impl Write) -> io::Result<()> {
        writeln!(writer, "{}", FIDELITY_COLUMNS.join(","))?;
        for (name, change) in &self.fidelity.changes {
            let to = match change.to {
                Fidelity::Rigid => "rigid",
                Fidelity::Deformable => "deformable",
            };
            let [time, ratio, energy] = [change.time, change.ratio, change.energy].map(number);
            writeln!(writer, "{time},{},{to},{ratio},{energy}", quoted(name))?;
        }
        Ok(())
    }

    /// The penalties by which adaptive bodies have their contact ratios, with their names.
    pub(super) fn adaptive_penalties(&self, scenario: &Scenario) -> Vec<(f64, String)> {
        let mut found = Vec::new();
        let mut first = self.origin.bodies;
        for (entry, count) in scenario.body.iter().zip(&self.origin.members) {
            let member = self.members.get(first);
            first += count;
            if entry.behaviour != Behaviour::Adaptive {
                continue;
            }
            let ratio = scenario.contact_ratio(entry);
            let penalty = member.and_then(|m| self.world.penalty_of_ratio(m.id, ratio));
            let name = member.map_or_else(String::new, |member| member.name.clone());
            found.extend(penalty.map(|penalty| (penalty, name)));
        }
        found
    }
}
