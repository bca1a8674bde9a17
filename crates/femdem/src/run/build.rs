//! From a scenario to a world.

use std::collections::{BTreeMap, BTreeSet};

use femdem_contact::{BodyId, Field, MaterialId};
use femdem_fem::{Boundary, DeformableModel, MaterialRegion};
use femdem_mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{
    BodySpec, ContactStiffness, DeformableSpec, ShapeId, SolveError, World, WorldParameters,
};

use super::geometry::Geometry;
use super::loads::Loads;
use super::names::{Names, check_names};
use super::of_pack::OF_PACK;
use super::places::Place;
use super::start::is_pack;
use super::words::{KEYS, in_entry};
use super::{
    Behaviour, BodyEntry, ControlEntry, MaterialEntry, Member, MotionEntry, NamedWall, Scenario,
    Simulation, Support, WallEntry,
};
use crate::Error;
use crate::error::wrong;
use crate::scene::ShapeNote;

/// Largest number of frames, and of rows of the history: outputs are counted one by one, and the count must not
/// be lost to rounding.
const MOST_OUTPUTS: f64 = 1e9;

/// Contact ratio of deformable bodies where walls, bodies or nodes move as prescribed: what is pressed gives way at its
/// contacts, at a ratio of 1 by a sixth of a strain of 0.16 and by half of one of 0.8, at 10 by a fiftieth of both.
const PRESSED: f64 = 10.0;

impl Scenario {
    /// The world of the scenario, at time 0; with [`from`](Self::from), in the state of that run or pack.
    ///
    /// # Errors
    ///
    /// [`Error::Entry`] with the wall, body or material at fault, and [`Error::Option`] or [`Error::Solve`] for
    /// faults of the whole scene; [`Error::Fixed`] if the run of `from` has other bodies or walls.
    pub fn build(&self) -> Result<Simulation, Error> {
        Ok(self.begin()?.1)
    }

    /// The scenario with gravity and the contact law written out, and its world.
    pub(super) fn begin(&self) -> Result<(Self, Simulation), Error> {
        self.check()?;
        match &self.from {
            None => {
                self.check_origin(false)?;
                let scene = self.filled(&WorldParameters::default(), false);
                let world = World::new(scene.parameters());
                let world = world.map_err(|error| Error::from(error).by_keys(&KEYS))?;
                let mut simulation = scene.build_on(Simulation::empty(world))?;
                simulation.set_loads(&scene)?;
                Ok((scene, simulation))
            }
            Some(folder) if is_pack(folder) => {
                let (scene, base) =
                    Simulation::of_pack(folder, self).map_err(|error| error.by_keys(&KEYS))?;
                let mut simulation = scene.build_on(base)?;
                simulation.set_loads(&scene)?;
                simulation.world.restart_ledger();
                let own = &self.contact;
                if own.penalty.or(own.penetration).is_none() {
                    OF_PACK.clone_into(&mut simulation.penalty.reason);
                }
                Ok((scene, simulation))
            }
            Some(folder) => self.start_from(folder),
        }
    }

    /// A world with what the entries of bodies and walls describe, without loads: these may be on bodies that came earlier.
    pub(super) fn build_on(&self, mut simulation: Simulation) -> Result<Simulation, Error> {
        self.make_periodic(&mut simulation)?;
        let mut names = Names::default();
        let mut of_pack: BTreeSet<String> = BTreeSet::new();
        for (_, wall) in simulation.world.walls() {
            of_pack.insert(names.of("wall", wall.name(), "")?);
        }
        for (number, wall) in (1..).zip(&self.wall) {
            let named = simulation.named_wall(wall);
            let place = |name: &str| in_entry(format!("wall \"{name}\""));
            if let Some(id) = named.map_err(place(&wall.name))? {
                if !of_pack.remove(&wall.name) {
                    let allowed = "another wall has it: give each its own";
                    return Err(wrong("name", &format!("\"{}\"", wall.name), allowed));
                }
                let set = self.set_wall(wall, id, &mut simulation.world);
                set.map_err(place(&wall.name))?;
                simulation.origin.walls.push(vec![id]);
                continue;
            }
            let name = names.of("wall", &wall.name, &format!("wall {number}"))?;
            let before: BTreeSet<u32> = simulation.world.walls().map(|(id, _)| id).collect();
            let mut add = || {
                let material = self.wall_material(wall)?;
                wall.add_to(&name, material, &mut simulation.world)
            };
            let note = add().map_err(place(&name))?;
            simulation.note(note.as_ref());
            let ids = simulation.world.walls().map(|(id, _)| id);
            let added = ids.filter(|id| !before.contains(id)).collect();
            simulation.origin.walls.push(added);
        }
        let mut names = Names::default();
        for member in &simulation.members {
            names.of("body", &member.name, "")?;
        }
        // Successive entries often have the same geometry, and meshing can take long.
        let mut last: Option<(&BodyEntry, Geometry)> = None;
        for (number, body) in (1..).zip(&self.body) {
            let place = if body.name.is_empty() {
                format!("body {number}")
            } else {
                format!("body \"{}\"", body.name)
            };
            let mut add = || {
                body.refuse_strangers()?;
                let known = last.take().filter(|(of, _)| of.has_geometry_of(body));
                let geometry = known.map_or_else(|| body.geometry(), |(_, known)| Ok(known))?;
                let name = names.of("body", &body.name, &geometry.name)?;
                simulation.add(self, body, &name, &geometry)?;
                simulation.note(geometry.note.as_ref());
                last = Some((body, geometry));
                Ok(())
            };
            add().map_err(in_entry(place))?;
        }
        let comes = !self.source.is_empty() || self.from.is_some();
        if simulation.members.is_empty() && !comes {
            let allowed = "give at least one [[body]] or [[source]]";
            return Err(wrong("body", "none", allowed));
        }
        check_names(&simulation)?;
        self.check_materials()?;
        let walls = simulation.world.walls().map(|(id, wall)| NamedWall {
            name: wall.name().to_owned(),
            id,
        });
        simulation.walls = walls.collect();
        simulation.set_flow(self)?;
        self.check_sleep(&simulation)?;
        self.check_relaxation(&simulation)?;
        let loads = Loads::of(self, &simulation);
        self.set_penalty(&mut simulation, &loads)?;
        self.set_pairs(&mut simulation)?;
        loads.bound_step(&mut simulation)?;
        simulation.control(self)?;
        self.add_bonds(&mut simulation)?;
        Ok(simulation)
    }

    /// The material of a wall, by number.
    fn wall_material(&self, wall: &WallEntry) -> Result<MaterialId, Error> {
        match &wall.material {
            Some(name) => self.material_id(name),
            None => Ok(MaterialId::default()),
        }
    }

    /// Gives a wall of a pack the material and the motion of an entry.
    fn set_wall(&self, entry: &WallEntry, id: u32, world: &mut World) -> Result<(), Error> {
        entry.refuse_strangers()?;
        if let Some(motion) = entry.motion {
            world.drive_wall(id, motion.drive())?;
        }
        Ok(world.set_wall_material(id, self.wall_material(entry)?)?)
    }

    /// The prescribed motions of walls, rigid bodies and nodes.
    pub(super) fn motions(&self) -> impl Iterator<Item = MotionEntry> {
        let walls = self.wall.iter().filter_map(|wall| wall.motion);
        let bodies = self.body.iter().filter_map(|body| body.motion);
        let conditions = self.body.iter().flat_map(|body| &body.boundary);
        let nodes = conditions.filter_map(|condition| condition.motion);
        walls.chain(bodies).chain(nodes)
    }

    /// The controls of walls and of the periodic cell.
    pub(super) fn controls(&self) -> impl Iterator<Item = &ControlEntry> {
        let walls = self.wall.iter().map(|wall| &wall.control);
        let cell = self.cell.iter().map(|cell| &cell.control);
        walls.chain(cell).filter_map(Option::as_ref)
    }

    /// Whether a wall moves as prescribed, or is controlled.
    pub(super) fn moves_walls(&self) -> bool {
        self.wall
            .iter()
            .any(|wall| wall.motion.is_some() || wall.control.is_some())
    }

    /// Refuses unused materials, and keys of materials without effect.
    fn check_materials(&self) -> Result<(), Error> {
        let parts = self.body.iter().flat_map(|body| &body.region);
        let used: BTreeSet<&String> = self
            .body
            .iter()
            .map(|body| &body.material)
            .chain(parts.map(|part| &part.material))
            .chain(self.source.iter().map(|source| &source.material))
            .collect();
        let of_walls: BTreeSet<&String> = self
            .wall
            .iter()
            .filter_map(|wall| wall.material.as_ref())
            .collect();
        // An entry with a name that is not known says so itself.
        let mut named = used.iter().chain(&of_walls);
        let is_misspelt = named.any(|name| !self.material.contains_key(*name));
        for (name, material) in &self.material {
            let checked = if used.contains(name) {
                material.check()
            } else if !of_walls.contains(name) && (self.from.is_some() || is_misspelt) {
                // Perhaps of bodies that have come from a source of the other run.
                Ok(())
            } else if !of_walls.contains(name) {
                Err(wrong(
                    "material",
                    "unused",
                    "no body, source or wall is made of it: name it in one, or take it out",
                ))
            } else if *material != MaterialEntry::default() {
                Err(wrong(
                    "material",
                    "of walls only",
                    "walls have neither density nor law: leave its table empty",
                ))
            } else {
                Ok(())
            };
            let checked = checked.and_then(|()| self.refuse_idle_fracture(name));
            checked.map_err(in_entry(format!("material.{name}")))?;
        }
        Ok(())
    }

    /// Refuses sleep of deformable bodies if it has no effect.
    pub(super) fn check_sleep(&self, simulation: &Simulation) -> Result<(), Error> {
        let possible = self.sleeping && simulation.has_deformable();
        if self.sleeping_deformables && !possible {
            return Err(wrong(
                "sleeping-deformables",
                "true",
                "false, unless there are deformable bodies and sleeping is true",
            ));
        }
        Ok(())
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        let times = [
            ("duration", Some(self.duration)),
            ("every", self.every),
            ("history-every", self.history_every),
            ("rest.energy", self.rest.map(|rest| rest.energy)),
            ("rest.time", self.rest.map(|rest| rest.time)),
        ];
        for (name, value) in times {
            if let Some(value) = value.filter(|value| !(*value > 0.0 && value.is_finite())) {
                return Err(wrong(name, &value.to_string(), "a positive, finite number"));
            }
        }
        let limit = self.energy_error_limit;
        if limit.is_nan() || limit <= 0.0 {
            let value = limit.to_string();
            return Err(wrong("energy-error-limit", &value, "above 0; inf for none"));
        }
        let intervals = [
            ("every", self.frame_interval()),
            ("history-every", self.history_interval()),
        ];
        for (name, interval) in intervals {
            if self.duration / interval > MOST_OUTPUTS {
                return Err(wrong(
                    name,
                    &interval.to_string(),
                    "at least a billionth of the duration, in s",
                ));
            }
        }
        self.check_openings()
    }

    /// Contact stiffness of a deformable body, κ h/E.
    pub(super) fn contact_ratio(&self, entry: &BodyEntry) -> f64 {
        let is_driven = self.motions().next().is_some() || self.controls().next().is_some();
        let usual = if is_driven { PRESSED } else { 1.0 };
        entry.contact_ratio.unwrap_or(usual)
    }

    /// The law and density of a material.
    pub(super) fn region(&self, name: &str) -> Result<MaterialRegion, Error> {
        let region = self.material(name)?.region();
        region.map_err(in_entry(format!("material.{name}")))
    }

    pub(super) fn material(&self, name: &str) -> Result<&MaterialEntry, Error> {
        self.material.get(name).ok_or_else(|| {
            let names: Vec<&str> = self.material.keys().map(String::as_str).collect();
            Error::Unknown {
                name: "material",
                value: name.to_owned(),
                known: format!(
                    "the tables [material.NAME] of the scene: {}",
                    names.join(", ")
                ),
            }
        })
    }

    /// The materials of a deformable body, and the material of each tetrahedron.
    fn regions(
        &self,
        entry: &BodyEntry,
        mesh: &TetMesh,
    ) -> Result<(Vec<MaterialRegion>, Vec<u32>), Error> {
        let mut regions = vec![self.region(&entry.material)?];
        let mut region_of = vec![0; mesh.tets().len()];
        for part in &entry.region {
            let index = regions.len() as u32;
            regions.push(self.region(&part.material)?);
            part.within.check()?;
            let mut empty = true;
            for (tet, region) in mesh.tets().iter().zip(&mut region_of) {
                let corners = tet.map(|i| mesh.points()[i as usize].coords);
                let centroid = corners.iter().sum::<Vector3>() / 4.0;
                if part.within.holds(&centroid.into()) {
                    (*region, empty) = (index, false);
                }
            }
            if empty {
                return Err(Error::Option {
                    name: "region.within",
                    value: format!("a place without tetrahedra, for \"{}\"", part.material),
                    allowed: "check its place and size, in the coordinates of the shape in m",
                });
            }
        }
        Ok((regions, region_of))
    }
}

impl Simulation {
    /// Keeps how a shape was made, if that is news.
    pub(super) fn note(&mut self, note: Option<&ShapeNote>) {
        if let Some(note) = note.filter(|note| note.is_news() && !self.notes.contains(note)) {
            self.notes.push(note.clone());
        }
    }

    fn add(
        &mut self,
        scenario: &Scenario,
        entry: &BodyEntry,
        name: &str,
        geometry: &Geometry,
    ) -> Result<(), Error> {
        let places = entry.places(geometry)?;
        let ids = match (entry.behaviour, &geometry.mesh) {
            (Behaviour::Deformable | Behaviour::Breakable, Some(mesh)) => {
                let factor = geometry.density_factor();
                self.add_deformable(scenario, entry, name, (mesh, factor), &places)?
            }
            (Behaviour::Adaptive, Some(mesh)) => {
                let factor = geometry.density_factor();
                self.add_adaptive(scenario, entry, name, (mesh, factor), &places)?
            }
            _ => self.add_rigid(scenario, entry, name, geometry, &places)?,
        };
        self.origin.members.push(ids.len());
        let copies = entry.copies.is_some() || entry.poses.is_some();
        let member = |(number, (id, placed))| Member {
            name: if copies {
                format!("{name} {number}")
            } else {
                name.to_owned()
            },
            id,
            placed,
            of: None,
        };
        self.members.extend((1..).zip(ids).map(member));
        Ok(())
    }

    fn add_rigid(
        &mut self,
        scenario: &Scenario,
        entry: &BodyEntry,
        name: &str,
        geometry: &Geometry,
        places: &[Place],
    ) -> Result<Vec<(BodyId, Pose)>, Error> {
        let density = scenario.material(&entry.material)?.density()?;
        let material = scenario.material_id(&entry.material)?;
        let mut shapes = BTreeMap::new();
        let mut ids = Vec::new();
        for place in places {
            let size = place.scale.to_bits();
            let shape = match shapes.get(&size) {
                Some(shape) => *shape,
                None if place.scale == 1.0 => self.add_shape(name, geometry)?,
                None => self.add_shape(name, &geometry.scaled(place.scale)?)?,
            };
            shapes.insert(size, shape);
            let spec = BodySpec {
                shape,
                density,
                pose: place.pose,
                velocity: place.velocity,
                angular_velocity: place.spin,
                material,
            };
            let id = match entry.motion {
                Some(motion) => self.world.add_driven_body(spec, motion.drive())?,
                None => self.world.add_body(spec)?,
            };
            ids.push((id, place.pose));
        }
        Ok(ids)
    }

    pub(super) fn add_shape(&mut self, name: &str, geometry: &Geometry) -> Result<ShapeId, Error> {
        let Geometry { surface, mesh, .. } = geometry;
        Ok(match mesh {
            Some(mesh) if !surface.is_convex() => {
                self.world
                    .add_mesh_shape(name, surface, mesh, Field::Body)?
            }
            _ if geometry.is_ball => self.world.add_sphere(name, surface.bounding_radius())?,
            _ => self.world.add_shape(name, surface)?,
        })
    }

    fn add_deformable(
        &mut self,
        scenario: &Scenario,
        entry: &BodyEntry,
        name: &str,
        (mesh, density_factor): (&TetMesh, f64),
        places: &[Place],
    ) -> Result<Vec<(BodyId, Pose)>, Error> {
        let (mut regions, region_of) = scenario.regions(entry, mesh)?;
        let material = scenario.material_id(&entry.material)?;
        for region in &mut regions {
            region.density *= density_factor;
        }
        let mut model = DeformableModel::new(mesh, entry.element, regions, Some(region_of))?;
        if let Some(step) = entry.mass_scaling {
            model = model.with_mass_scaling(step)?;
        }
        let radius = model.nodes().iter().map(|x| x.norm()).fold(0.0, f64::max);
        let mut boundary = Boundary::default();
        for condition in &entry.boundary {
            condition.add_to(&mut boundary, &model, radius)?;
        }
        let supports = entry.supports(self.members.len(), &model, radius)?;
        let ratio = scenario.contact_ratio(entry);
        check_ratio(ratio)?;
        let stiffness = ContactStiffness::Ratio(ratio);
        let fracture = scenario.fracture_of(entry)?;
        let model = self.world.add_model(name, model, stiffness)?;
        let mut ids = Vec::new();
        for (copy, place) in places.iter().enumerate() {
            let of_copy = supports.iter().cloned();
            self.supports.extend(of_copy.map(|support| Support {
                member: support.member + copy,
                ..support
            }));
            let id = self.world.add_deformable(DeformableSpec {
                model,
                pose: place.pose,
                velocity: place.velocity,
                angular_velocity: place.spin,
                boundary: boundary.clone(),
                material,
                fracture,
            })?;
            if entry.self_contact == Some(false) {
                self.world.set_self_contact(id, false)?;
            }
            ids.push((id, place.pose));
        }
        Ok(ids)
    }

    /// Advances by one step, whose size the world chooses. Walls open and bodies come before it, and bodies leave after it.
    ///
    /// # Errors
    ///
    /// [`Error::Entry`] with the name of the body at fault: an element that is turned inside out or has no
    /// stress, a body that blew up. The simulation can then not be continued.
    pub fn step(&mut self) -> Result<(), Error> {
        self.open_walls()?;
        self.bring_bodies()?;
        self.load_bodies_in_step()?;
        let stepped = if self.controls.is_empty() {
            self.world.step()
        } else {
            self.controls.step(&mut self.world)
        };
        stepped.map_err(|source| self.named(source))?;
        self.note_fidelity();
        self.fragment_bodies()?;
        self.pass_gates()
    }

    /// The same error with the name of the body at fault.
    pub(super) fn named(&self, source: SolveError) -> Error {
        let id = match &source {
            SolveError::BodyFailed { body, .. } | SolveError::BlowUp { body, .. } => {
                *body as BodyId
            }
            _ => return source.into(),
        };
        match self.members.iter().find(|member| member.id == id) {
            Some(member) => in_entry(format!("body \"{}\"", member.name))(source.into()),
            None => source.into(),
        }
    }

    /// The deformable bodies with their names.
    pub(super) fn deformables(
        &self,
    ) -> impl Iterator<Item = (usize, &Member, femdem_solve::Deformable<'_>)> {
        self.members
            .iter()
            .enumerate()
            .filter_map(|(i, member)| Some((i, member, self.world.deformable(member.id)?)))
    }
}

/// Refuses a contact stiffness that is none.
pub(super) fn check_ratio(ratio: f64) -> Result<(), Error> {
    if ratio > 0.0 && ratio.is_finite() {
        return Ok(());
    }
    let allowed = "a positive, finite number: κ h/E";
    Err(wrong("contact-ratio", &ratio.to_string(), allowed))
}
