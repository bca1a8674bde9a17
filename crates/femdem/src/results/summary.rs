//! `summary.json`: the result of a run in numbers.
//!
//! SI units throughout; `_over_d` is over the circumscribed diameter. A key keeps its meaning within a
//! [`SCHEMA`]; new keys may be added. Numbers that could not be computed are `null`.

use std::io::{self, Write};

use femdem_analysis::{
    AnalysisError, Bed, CoordinationOptions, CoreOptions, DensityOptions, Pack, SieveCurve, Vessel,
    WithImages, choose_core, coordination, measure_bed, packing_density,
};
use femdem_pack::Packing;
use serde::{Deserialize, Serialize};

use super::parts::{ContainerSummary, ShapeSummary, sieve};
use crate::{Body, Error, Snapshot};

/// Version of the keys of `summary.json`.
pub const SCHEMA: u32 = 2;

/// The cost of a run so far; the parts of a resumed run add up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Usage {
    /// Threads of the last part of the run.
    pub threads: usize,
    /// Time on the clock \[s\].
    pub wall_seconds: f64,
    /// Time of all processor cores \[s\]; `None` if the system does not report it.
    pub cpu_seconds: Option<f64>,
    /// Largest resident memory; `None` if the system does not report it.
    pub peak_memory_bytes: Option<u64>,
    /// Processor time in the contact stage \[s\]; time on the clock if the system does not report it.
    pub contact_seconds: f64,
    /// Evaluations of a pair that touched.
    pub touching_evaluations: u64,
}

/// The result of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of these keys: [`SCHEMA`].
    pub schema: u32,
    /// Name of the shape, such as "A10"; "mixed" for several.
    pub shape: String,
    /// Number of bodies in the container.
    pub count: usize,
    /// Mean circumscribed diameter d \[m\].
    pub diameter: f64,
    /// The shapes, by index.
    pub shapes: Vec<ShapeSummary>,
    /// The sizes of the bodies as a sieve curve by mass, as in `sieve.csv`.
    pub sieve: SieveCurve,
    /// The container.
    pub container: ContainerSummary,
    /// Density of the bodies \[kg/m³\]; of several, their mass over their volume.
    pub density: f64,
    /// Friction coefficient between bodies.
    pub friction: f64,
    /// Friction coefficient between bodies and walls.
    pub wall_friction: f64,
    /// Coefficient of rolling friction.
    pub rolling_friction: f64,
    /// Fraction of critical damping of normal contact.
    pub damping_ratio: f64,
    /// The contact law.
    pub contact: ContactLawSummary,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Threads used.
    pub threads: usize,
    /// Whether the pack is complete, at rest, and verified with all bodies awake.
    pub settled: bool,
    /// Simulated time \[s\].
    pub simulated_time: f64,
    /// Steps.
    pub steps: u64,
    /// Last time step \[s\].
    pub time_step: f64,
    /// Upper limit of implicit steps as a multiple of the explicit limit of one contact; `null` if only
    /// relaxations were implicit.
    pub implicit_multiple: Option<f64>,
    /// Whether bodies at rest slept while the pack was made.
    pub sleeping: bool,
    /// Time on the clock \[s\].
    pub wall_seconds: f64,
    /// Time of all processor cores \[s\].
    pub cpu_seconds: Option<f64>,
    /// Processor time of all threads in the contact stage (search, kernel, friction, gather), over evaluations of
    /// touching pairs \[ns\]; time on the clock if the system does not report it, and `cpu_seconds` is `null`.
    pub contact_nanoseconds_per_pair: Option<f64>,
    /// Packing density of the core, or of the whole bed if the core is too thin; `null` if the pack is too low to
    /// have a core, and in a container from a file.
    pub packing_density: Option<DensitySummary>,
    /// Void fraction and density of the whole bed, from the floor to the mean top, also over a cone and in a
    /// container from a file; `null` if it is not known.
    pub bed: Option<Bed>,
    /// Why there is no `bed`; `null` if there is one.
    pub bed_missing: Option<String>,
    /// Coordination number: bodies and walls that touch a body, each counted once; over all bodies.
    pub coordination: CoordinationSummary,
    /// Overlaps of the bodies with each other and with the walls.
    pub penetration: PenetrationSummary,
    /// How near to equilibrium the bodies are.
    pub residual: ResidualSummary,
    /// The energy ledger.
    pub energy: EnergySummary,
    /// Largest resident memory while the pack was made, before its results are written \[bytes\].
    pub peak_memory_bytes: Option<u64>,
    /// Fingerprint of all bits of the state, in 16 hexadecimal digits; equal in two runs if their states are.
    pub state_hash: String,
}

/// The contact law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactLawSummary {
    /// Name of the law.
    pub law: String,
    /// Penalty p \[Pa\].
    pub penalty: f64,
    /// Tangential over normal foundation modulus, k_t/k_n.
    pub tangential_ratio: f64,
}

/// Packing density: solid volume over volume, 0 to 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DensitySummary {
    /// By exact clipping, overlaps subtracted.
    pub exact: f64,
    /// By counting cells of a grid of d/20; `null` for a core too wide for it.
    pub grid: Option<f64>,
    /// Of `exact`, by block bootstrap; `null` for a core too small for it.
    pub standard_error: Option<f64>,
    /// Where it was measured.
    pub core: Core,
    /// Why it is that of the whole bed, from the floor to the mean top; `null` if it is that of the core.
    pub bed_reason: Option<String>,
}

/// Corners of the core region \[m\], or of the bed if that was measured; of the box around it, for a cylinder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Core {
    /// Lower corner.
    pub min: [f64; 3],
    /// Upper corner.
    pub max: [f64; 3],
}

/// Coordination number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoordinationSummary {
    /// Mean.
    pub mean: f64,
    /// Standard deviation over the bodies.
    pub sd: f64,
    /// Entry k: number of bodies with k partners.
    pub histogram: Vec<u64>,
    /// Mean number of patches in which a pair touches; 1 for convex bodies. `null` without contacts.
    pub patches_per_pair: Option<f64>,
}

/// Penetration: overlap volume over contact area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PenetrationSummary {
    /// Mean over the contacts.
    pub mean_over_d: f64,
    /// Largest.
    pub max_over_d: f64,
    /// Sum of the overlap volumes, walls included, over the volume of the bodies.
    pub overlap_volume_fraction: f64,
}

/// Net force over weight, and motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualSummary {
    /// Mean over the bodies.
    pub mean_over_weight: f64,
    /// Largest.
    pub max_over_weight: f64,
    /// Largest kinetic energy of a body over its m g d.
    pub kinetic_energy_over_mgd: f64,
}

/// The energy ledger \[J\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EnergySummary {
    /// Potential and kinetic energy of the bodies when they were added, and work of driven walls.
    pub initial: f64,
    /// Kinetic, potential, contact and spring energy now.
    #[serde(rename = "final")]
    pub final_energy: f64,
    /// Dissipated by friction.
    pub dissipated_friction: f64,
    /// Dissipated by normal damping.
    pub dissipated_damping: f64,
    /// Error of the energy ledger, over the energy turned over.
    pub ledger_error_relative: f64,
}

impl Summary {
    /// Measures a pack.
    ///
    /// # Errors
    ///
    /// [`Error::Analysis`] if the pack cannot be measured (it has no bodies, for instance),
    /// [`Error::Solve`] if its state cannot be hashed.
    pub fn of(packing: &Packing, snapshot: &Snapshot, usage: &Usage) -> Result<Self, Error> {
        let (spec, world, report) = (packing.spec(), packing.world(), packing.report()?);
        let ledger = world.ledger();
        let (shapes, images) = match &snapshot.container {
            Some(container) => snapshot.with_images(container, 0.0)?,
            None => {
                let (shapes, bodies) = snapshot.posed();
                (shapes, WithImages::none(bodies))
            }
        };
        let pack = images.pack(&shapes)?;
        let (bed, bed_missing) = bed(snapshot, &pack)?;
        Ok(Self {
            schema: SCHEMA,
            shape: snapshot.shape_name().to_owned(),
            count: world.body_count(),
            shapes: ShapeSummary::all(packing, snapshot),
            sieve: sieve(packing, snapshot),
            container: ContainerSummary::of(packing, &report),
            diameter: spec.diameter(),
            density: spec.mean_density(),
            friction: spec.friction,
            wall_friction: spec.wall_friction.unwrap_or(spec.friction),
            rolling_friction: spec.rolling_friction,
            damping_ratio: spec.damping_ratio,
            contact: ContactLawSummary {
                law: law(packing).to_owned(),
                penalty: packing.penalty(),
                tangential_ratio: spec.tangential_ratio,
            },
            seed: spec.seed,
            threads: usage.threads,
            settled: report.settled,
            simulated_time: world.time(),
            steps: world.steps(),
            time_step: world.time_step(),
            implicit_multiple: spec.time_step.implicit.map(|step| step.multiple),
            sleeping: spec.sleeping.enabled,
            wall_seconds: usage.wall_seconds,
            cpu_seconds: usage.cpu_seconds,
            contact_nanoseconds_per_pair: usage.contact_nanoseconds_per_pair(),
            packing_density: density(snapshot, &pack)?,
            bed,
            bed_missing,
            coordination: coordination_of(snapshot)?,
            penetration: PenetrationSummary {
                mean_over_d: report.penetration_mean_over_d,
                max_over_d: report.penetration_max_over_d,
                overlap_volume_fraction: overlap_volume_fraction(snapshot),
            },
            residual: ResidualSummary {
                mean_over_weight: report.residual_mean_over_weight,
                max_over_weight: report.residual_max_over_weight,
                kinetic_energy_over_mgd: report.kinetic_energy_over_mgd,
            },
            energy: EnergySummary {
                initial: ledger.initial + ledger.work_in,
                final_energy: ledger.final_energy(),
                dissipated_friction: ledger.dissipated_friction,
                dissipated_damping: ledger.dissipated_damping,
                ledger_error_relative: ledger.error_relative(),
            },
            peak_memory_bytes: usage.peak_memory_bytes,
            state_hash: format!("{:016x}", world.state_hash()?),
        })
    }

    /// Writes `summary.json`.
    ///
    /// # Errors
    ///
    /// If writing fails.
    pub fn write_json(&self, mut writer: impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut writer, self)?;
        writer.write_all(b"\n")
    }
}

impl Usage {
    fn contact_nanoseconds_per_pair(&self) -> Option<f64> {
        let pairs = self.touching_evaluations as f64;
        (pairs > 0.0).then(|| 1e9 * self.contact_seconds / pairs)
    }
}

/// Density of the core, or of the bed if the core is thin, or none where the pack is too low to have one, or the container is from a file.
fn density(snapshot: &Snapshot, pack: &Pack) -> Result<Option<DensitySummary>, Error> {
    use AnalysisError::{NoPackInContainer, Region};
    let Some(container) = &snapshot.container else {
        return Ok(None);
    };
    let core = match choose_core(pack, container, &CoreOptions::default()) {
        Ok(core) => core,
        Err(NoPackInContainer { .. } | Region { .. }) => return Ok(None),
        Err(other) => return Err(other.into()),
    };
    let space = core.density_region();
    let density = packing_density(pack, space, &DensityOptions::default())?;
    let (min, max) = space.corners();
    Ok(Some(DensitySummary {
        exact: density.exact,
        grid: density.grid,
        standard_error: density.standard_error,
        core: Core {
            min: min.into(),
            max: max.into(),
        },
        bed_reason: core.is_thin().then(|| {
            format!(
                "the core would be {:.2} d thin, less than one circumscribed diameter",
                core.extent_over_d
            )
        }),
    }))
}

/// The whole bed, or why it is not known.
fn bed(snapshot: &Snapshot, pack: &Pack) -> Result<(Option<Bed>, Option<String>), Error> {
    use AnalysisError::{AboveRim, NoPackInContainer, NotEnclosed};
    let vessel = snapshot.vessel.clone();
    let Some(vessel) = vessel.or_else(|| snapshot.container.map(Vessel::Upright)) else {
        return Ok((None, Some("the container is not known".to_owned())));
    };
    let spacing = CoreOptions::default().column_spacing_over_d;
    match measure_bed(pack, &vessel, spacing) {
        Ok(bed) => Ok((Some(bed), None)),
        Err(error @ (AboveRim { .. } | NotEnclosed { .. } | NoPackInContainer { .. })) => {
            Ok((None, Some(error.to_string())))
        }
        Err(other) => Err(other.into()),
    }
}

fn coordination_of(snapshot: &Snapshot) -> Result<CoordinationSummary, Error> {
    let options = CoordinationOptions::default();
    let result = coordination(snapshot.bodies.len(), &snapshot.touches(), &options)?;
    Ok(CoordinationSummary {
        mean: result.mean,
        sd: result.sd,
        histogram: result.histogram,
        patches_per_pair: patches_per_pair(snapshot),
    })
}

/// Contacts over touching pairs.
fn patches_per_pair(snapshot: &Snapshot) -> Option<f64> {
    let contacts = &snapshot.contacts;
    let mut pairs: Vec<_> = contacts.iter().map(|c| (c.body, &c.partner)).collect();
    pairs.sort_unstable();
    pairs.dedup();
    (!pairs.is_empty()).then(|| contacts.len() as f64 / pairs.len() as f64)
}

/// Name of the contact law; the field is that of the bodies.
fn law(packing: &Packing) -> &'static str {
    let shapes = &packing.spec().shapes;
    let meshed = shapes.iter().filter(|shape| shape.mesh.is_some()).count();
    if shapes.iter().all(|shape| shape.sphere) {
        "boundary-integral penalty, gauge field, of exact balls"
    } else if meshed == 0 {
        "boundary-integral penalty, gauge field"
    } else if meshed == shapes.len() {
        "volume-integral penalty, body field"
    } else {
        "boundary-integral penalty, gauge field; volume-integral penalty, body field for bodies that \
         are not convex"
    }
}

fn overlap_volume_fraction(snapshot: &Snapshot) -> f64 {
    let volume = |body: &Body| {
        let shape = snapshot.shapes.get(body.shape as usize)?;
        Some(shape.polyhedron.mass_properties().volume)
    };
    let solid: f64 = snapshot.bodies.iter().filter_map(volume).sum();
    // Not `sum`, which is -0 without contacts.
    let overlap = snapshot
        .contacts
        .iter()
        .fold(0.0, |sum, row| sum + row.volume);
    if solid > 0.0 { overlap / solid } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ContactClass, ContactRow, NamedShape, Partner};
    use femdem_mesh::catalogue::{CatalogueShape, Solid};
    use femdem_mesh::{Point3, Pose, Vector3};

    /// Two cubes of side 1 m, one on the other, on a floor.
    fn two_cubes() -> Snapshot {
        let cube = CatalogueShape::from(Solid::P5);
        let body = |sequence: u32| Body {
            shape: 0,
            pose: Pose::translation(0.0, 0.0, 0.5 + f64::from(sequence)),
            sequence,
            sleeping: false,
        };
        let contact = |partner, z, up: f64, normal_force| ContactRow {
            body: 0,
            partner,
            point: Point3::new(0.0, 0.0, z),
            normal: Vector3::z() * up,
            normal_force,
            friction: Vector3::zeros(),
            moment: Vector3::zeros(),
            area: 1.0,
            volume: 0.001,
            class: ContactClass::FaceFace,
            patch: 0,
        };
        Snapshot {
            shapes: vec![NamedShape {
                name: "P5".to_owned(),
                polyhedron: cube.polyhedron(3.0_f64.sqrt()).unwrap(),
            }],
            bodies: vec![body(0), body(1)],
            contacts: vec![
                contact(Partner::Body(1), 1.0, 1.0, 10.0),
                contact(Partner::Wall("floor".to_owned()), 0.0, -1.0, 20.0),
            ],
            ..Snapshot::default()
        }
    }

    #[test]
    fn two_cubes_of_volume_1_overlap_by_a_thousandth_each_contact() {
        assert!((overlap_volume_fraction(&two_cubes()) - 0.001).abs() < 1e-12);
    }

    #[test]
    fn coordination_counts_bodies_and_walls() {
        let result = coordination_of(&two_cubes()).unwrap();
        assert_eq!((result.mean, result.histogram), (1.5, vec![0, 1, 1]));
    }

    /// A second patch of a pair is a contact more, and no partner more.
    #[test]
    fn coordination_counts_pairs_and_not_patches() {
        let mut snapshot = two_cubes();
        let mut second = snapshot.contacts[0].clone();
        second.patch = 1;
        snapshot.contacts.insert(1, second);
        let result = coordination_of(&snapshot).unwrap();
        assert_eq!(result.histogram, [0, 1, 1]);
        assert_eq!(result.patches_per_pair, Some(1.5));
        let loads = snapshot.loads().unwrap();
        assert_eq!((loads[0].coordination, loads[1].coordination), (2, 1));
        assert_eq!((loads[0].force_sum, loads[1].force_sum), (40.0, 20.0));
    }

    #[test]
    fn nanoseconds_per_pair_of_a_run_without_contacts_are_unknown() {
        assert_eq!(Usage::default().contact_nanoseconds_per_pair(), None);
        let usage = Usage {
            contact_seconds: 2e-3,
            touching_evaluations: 4000,
            ..Usage::default()
        };
        assert!((usage.contact_nanoseconds_per_pair().unwrap() - 500.0).abs() < 1e-9);
    }
}
