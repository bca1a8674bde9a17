//! `summary.json` of a run.

use std::collections::BTreeMap;
use std::io::{self, Write};

use femdem_fem::DeformableModel;
use femdem_mesh::Vector3;
use femdem_solve::Alone;
use serde::{Deserialize, Serialize};

use super::{
    BondSummary, CellState, Ending, FidelitySummary, FlowSummary, FractureSummary, Penalty,
    Reached, RelaxSummary, RestSummary, Run, Side,
};
use crate::{Error, Usage};

/// Version of the keys of the summary of a run.
pub const RUN_SCHEMA: u32 = 1;

/// The result of a run in numbers; `docs/run.md` explains every key. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunSummary {
    /// Version of these keys: [`RUN_SCHEMA`].
    pub schema: u32,
    /// Title of the scenario.
    pub title: String,
    /// Why the run ended; `null` if it has not.
    pub ending: Option<Ending>,
    /// The limit of the scene that ended it; `null` if none did.
    pub reached: Option<Reached>,
    /// How the bodies were brought to rest after that; `null` if they were not.
    pub relaxed: Option<RelaxSummary>,
    /// How near to rest it is now.
    pub rest: RestSummary,
    /// The bodies by entry of the scenario.
    pub bodies: Vec<BodySummary>,
    /// The walls.
    pub walls: Vec<WallSummary>,
    /// The boxes whose walls are controlled.
    pub cells: Vec<CellState>,
    /// What gauges, sinks and sources have counted, by their names.
    pub flow: BTreeMap<String, FlowSummary>,
    /// Forces of the supports of deformable bodies.
    pub reactions: Vec<ReactionSummary>,
    /// The penalty of contacts between rigid bodies, and why it has its value.
    pub penalty: Penalty,
    /// What the run warned of.
    pub warnings: Vec<String>,
    /// How deep bodies and walls overlap; `null` if nothing touched.
    pub penetration: Option<PenetrationSummary>,
    /// Duration of the scenario \[s\].
    pub duration: f64,
    /// Simulated time \[s\].
    pub simulated_time: f64,
    /// Steps.
    pub steps: u64,
    /// The last step \[s\].
    pub time_step: f64,
    /// Frames written.
    pub frames: usize,
    /// Tetrahedra of the deformable bodies.
    pub tetrahedra: usize,
    /// Energies.
    pub energy: RunEnergy,
    /// Linear momentum \[kg m/s\].
    pub momentum: [f64; 3],
    /// The deformable bodies now; `null` without any.
    pub strain: Option<StrainSummary>,
    /// The breakable bodies now; `null` without any.
    pub fracture: Option<FractureSummary>,
    /// The adaptive bodies; `null` without any.
    pub fidelity: Option<FidelitySummary>,
    /// The bonds now; `null` without any.
    pub bonds: Option<BondSummary>,
    /// Contacts now.
    pub contacts: usize,
    /// Threads of the last part of the run.
    pub threads: usize,
    /// Time on the clock, over all parts \[s\].
    pub wall_seconds: f64,
    /// Time of all processor cores \[s\]; `null` if the system does not report it.
    pub cpu_seconds: Option<f64>,
    /// Time on the clock over tetrahedra and steps, contacts and output included \[ns\]; `null` without
    /// tetrahedra, and with a relaxation, whose steps of bodies as wholes are not among those of the world.
    pub nanoseconds_per_tet_step: Option<f64>,
    /// Largest resident memory; `null` if the system does not report it.
    pub peak_memory_bytes: Option<u64>,
    /// Hash of the state: equal for equal bits.
    pub state_hash: String,
}

/// A body of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodySummary {
    /// Its name.
    pub name: String,
    /// Its number: bodies that have left are not listed.
    pub number: usize,
    /// "rigid", "deformable" or "breakable".
    pub behaviour: String,
    /// Mass \[kg\], including mass scaling.
    pub mass: f64,
    /// Mass added by mass scaling \[kg\].
    pub added_mass: f64,
    /// Nodes, of which cracks make more; 0 for a rigid body.
    pub nodes: usize,
    /// Tetrahedra; 0 for a rigid body.
    pub tetrahedra: usize,
    /// Centroid \[m\].
    pub centroid: [f64; 3],
    /// Velocity of the centroid \[m/s\].
    pub velocity: [f64; 3],
    /// Largest equivalent plastic strain of an element; `null` where no material has one.
    pub max_plastic_strain: Option<f64>,
}

/// A wall of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallSummary {
    /// Its name.
    pub name: String,
    /// Force of the bodies on it now \[N\].
    pub force: [f64; 3],
    /// Largest size of that force among the rows of the history \[N\].
    pub peak_force: f64,
    /// When that was \[s\].
    pub peak_time: f64,
}

/// The force of a support: of nodes of a body that are held or moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReactionSummary {
    /// Name of the body.
    pub body: String,
    /// Name of the boundary condition.
    pub boundary: String,
    /// Force of the support on the body now \[N\].
    pub force: [f64; 3],
    /// Largest size of that force among the rows of the history \[N\].
    pub peak_force: f64,
    /// When that was \[s\].
    pub peak_time: f64,
}

/// Depths of contacts: overlap volume over area, at most the diameter of the smaller body \[m\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PenetrationSummary {
    /// Largest now; 0 where nothing touches.
    pub now: f64,
    /// Largest of all steps.
    pub peak: f64,
    /// When that was \[s\].
    pub peak_time: f64,
    /// Names of the two sides.
    pub peak_between: [String; 2],
}

/// Energies of a run \[J\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunEnergy {
    /// Of all bodies when they were added.
    pub initial: f64,
    /// Work of prescribed motions and loads.
    pub work_in: f64,
    /// What walls that opened and bodies that left took with them, negative.
    pub by_hand: f64,
    /// Lent to cracks at their births.
    pub lent: f64,
    /// Given to adaptive bodies when they became deformable, less what was taken when they became rigid.
    pub fidelity: f64,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy in gravity.
    pub potential: f64,
    /// Strain energy of deformable bodies.
    pub strain: f64,
    /// Elastic energy of contacts.
    pub contact: f64,
    /// Energy of the friction springs.
    pub friction_springs: f64,
    /// Energy in the cracks of bodies.
    pub cracks: f64,
    /// Energy in bonds.
    pub bonds: f64,
    /// Dissipated by friction.
    pub dissipated_friction: f64,
    /// Dissipated by the damping of contacts.
    pub dissipated_damping: f64,
    /// Dissipated by the medium.
    pub dissipated_medium: f64,
    /// Dissipated by the viscosity of materials.
    pub dissipated_viscous: f64,
    /// Dissipated by plastic flow.
    pub dissipated_plastic: f64,
    /// Dissipated where liquid bridges broke.
    pub dissipated_bridges: f64,
    /// Dissipated by breaking; less what was lent, this is the energy of fracture.
    pub dissipated_fracture: f64,
    /// Dissipated by breaking bonds.
    pub dissipated_bonds: f64,
    /// Dissipated where the sides of cracks became skin, and where bonds ended.
    pub dissipated_release: f64,
    /// Kinetic energy removed when bodies were frozen.
    pub frozen: f64,
    /// Error of the energy ledger, over the energy turned over.
    pub ledger_error_relative: f64,
}

/// Stresses and strains of the deformable bodies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrainSummary {
    /// Largest von Mises stress \[Pa\].
    pub max_von_mises: f64,
    /// Smallest volume ratio of an element.
    pub min_volume_ratio: f64,
    /// Largest volume ratio of an element.
    pub max_volume_ratio: f64,
}

impl RunSummary {
    /// The summary of a run at this moment.
    ///
    /// # Errors
    ///
    /// [`Error::Solve`] if an element has no stress, or the state cannot be hashed.
    pub fn of(run: &Run, usage: &Usage) -> Result<Self, Error> {
        let simulation = run.simulation();
        let world = &simulation.world;
        let contacts = simulation.contacts();
        let forces = simulation.forces(&contacts);
        let walls = simulation.walls.iter().zip(&forces.walls).zip(run.peaks());
        let walls = walls.map(|((wall, force), peak)| WallSummary {
            name: wall.name.clone(),
            force: (force + Vector3::zeros()).into(),
            peak_force: peak.force,
            peak_time: peak.time,
        });
        let forces = simulation.reactions();
        let supports = simulation.supports.iter().zip(&forces);
        let reactions = supports.zip(run.reaction_peaks());
        let reactions = reactions.map(|((support, force), peak)| ReactionSummary {
            body: simulation.name_of(Side::Member(support.member)),
            boundary: support.name.clone(),
            force: (*force).into(),
            peak_force: peak.force,
            peak_time: peak.time,
        });
        let deepest = run.deepest();
        let penetration = (deepest.depth > 0.0).then(|| PenetrationSummary {
            now: contacts
                .iter()
                .map(|contact| simulation.depth_of(contact))
                .fold(0.0, f64::max),
            peak: deepest.depth,
            peak_time: deepest.time,
            peak_between: deepest.between.clone(),
        });
        let bodies: Vec<_> = simulation.bodies();
        let tetrahedra = bodies.iter().map(|body| body.tetrahedra).sum();
        let steps = world.steps();
        let work = tetrahedra as f64 * steps as f64;
        Ok(Self {
            schema: RUN_SCHEMA,
            title: run.scenario().title.clone(),
            ending: run.ending(),
            relaxed: run.relaxation().copied(),
            reached: run.reached().cloned(),
            rest: simulation.rest(),
            bodies,
            walls: walls.collect(),
            cells: simulation.controls.cells(world, &mut Alone)?,
            flow: simulation.flow.summary(),
            reactions: reactions.collect(),
            penalty: simulation.penalty.clone(),
            warnings: run
                .warnings()
                .iter()
                .cloned()
                .chain(simulation.missing_bodies())
                .collect(),
            penetration,
            duration: run.scenario().duration,
            simulated_time: world.time(),
            steps,
            time_step: run.time_step(),
            frames: run.frames().len(),
            tetrahedra,
            energy: energy(&world.ledger()),
            momentum: (world.linear_momentum_on(&mut Alone)? + Vector3::zeros()).into(),
            strain: strain(run)?,
            fracture: simulation.fracture_summary(),
            fidelity: simulation.fidelity_summary(),
            bonds: simulation.bond_summary(),
            contacts: contacts.len(),
            threads: usage.threads,
            wall_seconds: usage.wall_seconds,
            cpu_seconds: usage.cpu_seconds,
            nanoseconds_per_tet_step: (work > 0.0 && run.relaxation().is_none())
                .then(|| 1e9 * usage.wall_seconds / work),
            peak_memory_bytes: usage.peak_memory_bytes,
            state_hash: format!("{:016x}", world.state_hash()?),
        })
    }

    /// Writes it as JSON, one key per line.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_json(&self, mut writer: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut writer, self)?;
        writeln!(writer)
    }
}

impl super::Simulation {
    /// Data of each member, in the order of the scenario.
    #[must_use]
    pub fn bodies(&self) -> Vec<BodySummary> {
        let world = &self.world;
        let summary = self
            .members
            .iter()
            .enumerate()
            .filter_map(|(number, member)| {
                let body = world.deformable(member.id);
                let behaviour = match body {
                    Some(body) if body.cracks().is_some() => "breakable",
                    Some(_) => "deformable",
                    None => "rigid",
                };
                let count = |of: fn(&DeformableModel) -> usize| body.map_or(0, |b| of(b.model()));
                Some(BodySummary {
                    name: member.name.clone(),
                    number,
                    behaviour: behaviour.to_owned(),
                    mass: world.mass(member.id)?,
                    added_mass: body.map_or(0.0, |body| body.model().added_mass()),
                    nodes: count(|model| model.nodes().len()),
                    tetrahedra: count(|model| model.volumes().len()),
                    centroid: world.position(member.id)?.into(),
                    velocity: world.velocity(member.id)?.into(),
                    max_plastic_strain: body.as_ref().and_then(max_plastic_strain),
                })
            });
        summary.collect()
    }
}

fn max_plastic_strain(body: &femdem_solve::Deformable) -> Option<f64> {
    // Only a history that is not the body's own could fail.
    let strains = body.model().plastic_strains(body.history()).ok()??;
    Some(strains.into_iter().fold(0.0, f64::max))
}

fn energy(ledger: &femdem_solve::Ledger) -> RunEnergy {
    // A sum over no bodies is -0; adding zero makes it 0.
    let plain = |joules: f64| joules + 0.0;
    RunEnergy {
        initial: plain(ledger.initial),
        work_in: plain(ledger.work_in + ledger.load_work),
        by_hand: plain(ledger.by_hand),
        kinetic: plain(ledger.kinetic),
        potential: plain(ledger.potential),
        strain: plain(ledger.strain),
        contact: plain(ledger.elastic),
        friction_springs: plain(ledger.friction_springs),
        lent: plain(ledger.lent),
        fidelity: plain(ledger.fidelity),
        cracks: plain(ledger.cracks),
        bonds: plain(ledger.bonds),
        dissipated_friction: plain(ledger.dissipated_friction),
        dissipated_damping: plain(ledger.dissipated_damping),
        dissipated_medium: plain(ledger.dissipated_medium),
        dissipated_viscous: plain(ledger.dissipated_viscous),
        dissipated_plastic: plain(ledger.dissipated_plastic),
        dissipated_bridges: plain(ledger.dissipated_bridges),
        dissipated_fracture: plain(ledger.dissipated_fracture),
        dissipated_bonds: plain(ledger.dissipated_bonds),
        dissipated_release: plain(ledger.dissipated_release),
        frozen: plain(ledger.frozen),
        ledger_error_relative: plain(ledger.error_relative()),
    }
}

fn strain(run: &Run) -> Result<Option<StrainSummary>, Error> {
    let bodies = run.simulation().strained()?;
    let mut stresses = bodies.iter().flat_map(|body| &body.stresses).peekable();
    if stresses.peek().is_none() {
        return Ok(None);
    }
    let start = StrainSummary {
        max_von_mises: 0.0,
        min_volume_ratio: f64::INFINITY,
        max_volume_ratio: 0.0,
    };
    Ok(Some(stresses.fold(start, |so_far, s| StrainSummary {
        max_von_mises: so_far.max_von_mises.max(s.von_mises()),
        min_volume_ratio: so_far.min_volume_ratio.min(s.volume_ratio),
        max_volume_ratio: so_far.max_volume_ratio.max(s.volume_ratio),
    })))
}
