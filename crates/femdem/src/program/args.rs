//! Options of `femdem pack` and of commands that run long.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::Args;
use femdem::Scene;
use femdem::scene::{ContainerKind, Drag, Footprint, Length, ProtocolKind, StepKind, Unit, metres};

use super::complain;

/// Options of `femdem pack`. Those left out are taken from the scene file, or have their defaults.
#[derive(Debug, Default, Args)]
pub(crate) struct PackArgs {
    /// Scene file (TOML); options given beside it win
    pub scene: Option<PathBuf>,

    /// Shape: an identifier or name of `femdem shapes`, with parameters if you like, such as
    /// cylinder:aspect=2, or the path of an OBJ, STL, OFF or PLY file (one closed surface, convex or
    /// not); repeat it for a mixture [default: A10]
    #[arg(long, value_name = "NAME|FILE")]
    shape: Vec<String>,

    /// Relative number of bodies of a shape; give none, or one for each --shape [default: equal]
    #[arg(long, value_name = "X")]
    share: Vec<f64>,

    /// Variants of each shape that has a seed (boulder): its seed and the ones after it [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    variety: Option<u32>,

    /// Number of bodies [default: 200]
    #[arg(long, value_name = "N")]
    count: Option<u32>,

    /// Circumscribed diameter d of a body in m, or with a unit, such as 20mm [default: 0.05; for a file, its own size]
    #[arg(long, value_name = "M", conflicts_with_all = ["size", "mass"], value_parser = metres)]
    diameter: Option<f64>,

    /// Size of a body in m by the measure that `femdem shapes` names, instead of --diameter
    #[arg(long, value_name = "M", conflicts_with = "mass", value_parser = metres)]
    size: Option<f64>,

    /// Mass of a body in kg, instead of --diameter
    #[arg(long, value_name = "KG")]
    mass: Option<f64>,

    /// Sizes (d, in m or with a unit) with their shares of the mass, or a distribution; one for all, or one for each --shape:
    /// 20mm:0.3,30mm:0.7, lognormal-mass:MEDIAN:SIGMA, lognormal-number:MEDIAN:SIGMA, weibull-mass:SIZE:EXPONENT, each if you
    /// like with limits, as in lognormal-mass:20mm:0.3:10mm..40mm, or sieve:CURVE
    #[arg(long, value_name = "SIZES", conflicts_with_all = ["diameter", "size", "mass", "sieve"])]
    sizes: Vec<String>,

    /// Sieve curve by mass, such as 10mm:0,20mm:0.4,30mm:1: 40 % of the mass is finer than 20 mm; one for all, or one for each
    /// --shape. Between the points it is straight over the logarithm of the size
    #[arg(long, value_name = "CURVE", conflicts_with_all = ["diameter", "size", "mass"])]
    sieve: Vec<String>,

    /// Unit of the coordinates in surface files [default: m]
    #[arg(long, value_enum)]
    unit: Option<Unit>,

    /// Mend surface files that are nearly fine (gaps, doubled or flat facets, inside out), and say
    /// what was done
    #[arg(long)]
    repair: bool,

    /// Target edge length of the tetrahedra of a body that is not convex, in d [default: by the shape]
    #[arg(long, value_name = "X")]
    mesh_size: Option<f64>,

    /// Density of the bodies in kg/m3; one for all, or one for each --shape [default: 2560]
    #[arg(long, value_name = "KG/M3")]
    density: Vec<f64>,

    /// Coulomb friction coefficient, 0 or more, between bodies and with walls [default: 0.6]
    #[arg(long, value_name = "MU")]
    friction: Option<f64>,

    /// Coulomb friction coefficient between bodies and walls, 0 or more [default: as --friction]
    #[arg(long, value_name = "MU")]
    wall_friction: Option<f64>,

    /// Coefficient of rolling friction, 0 or more: the moment against rolling is at most this times the normal force
    /// and the rolling radius [default: 0]
    #[arg(long, value_name = "MU")]
    rolling_friction: Option<f64>,

    /// Cohesion in Pa: an attraction by this stress over the contact area [default: 0]
    #[arg(long, value_name = "PA")]
    cohesion: Option<f64>,

    /// Work of adhesion in J/m2 of spheres with spheres and planes, which pull off at 3/2 pi times this times the
    /// reduced radius [default: 0]
    #[arg(long, value_name = "J/M2")]
    adhesion_energy: Option<f64>,

    /// Material of the bodies, for the [[pair]] tables of a scene; one for all, or one for each --shape
    #[arg(long, value_name = "NAME")]
    material: Vec<String>,

    /// Material of the walls, for the [[pair]] tables of a scene
    #[arg(long, value_name = "NAME")]
    wall_material: Option<String>,

    /// Stiffness of the friction springs over that of normal contact, k_t/k_n, above 0 and at most 2
    /// [default: 0.8]
    #[arg(long, value_name = "RATIO", alias = "tangential-stiffness")]
    tangential_ratio: Option<f64>,

    /// Fraction of critical damping of the friction springs while they stick [default: 0.6]
    #[arg(long, value_name = "ZETA")]
    tangential_damping: Option<f64>,

    /// Fraction of critical damping of normal contact, 0 to below 0.707; 0.6 gives a coefficient of
    /// restitution of 0.25 [default: 0.6]
    #[arg(long, value_name = "ZETA")]
    damping: Option<f64>,

    /// Penalty of the contact law in Pa: stiffer contacts overlap less and cost more steps [default:
    /// automatic, from --penetration]
    #[arg(long, value_name = "PA")]
    penalty: Option<f64>,

    /// Mean penetration over d that the automatic penalty aims at [default: 0.0035;
    /// 0.0012 with --protocol release, which keeps the largest below 0.01]
    #[arg(long, value_name = "X", conflicts_with = "penalty")]
    penetration: Option<f64>,

    /// Drag of the medium while the pack is made: a rate with its unit, such as 8.4/s, or 0.6/fall in sqrt(g/d); 0 is none
    /// [default: 0]
    #[arg(long, value_name = "RATE", allow_hyphen_values = true)]
    drag: Option<Drag>,

    /// Cundall's local damping while the pack is made: the part of each component of a body's net force
    /// and moment that is taken off against the motion, 0 to below 1 [default: 0]
    #[arg(long, value_name = "X")]
    local_damping: Option<f64>,

    /// Implicit steps, X times the explicit limit of one contact; 9 without a number. A release of 500 bodies takes a sixth to
    /// a quarter of the processor time until all is at rest, comes out looser by 0.005 ± 0.003, and its energy ledger misses
    /// up to 5 %. The verification ends with explicit steps [default: with --protocol release, friction
    /// and a --damping of 0.1 or more]
    #[arg(
        long,
        value_name = "X",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "9",
        conflicts_with_all = ["local_damping", "explicit"]
    )]
    implicit: Option<f64>,

    /// Explicit steps, also where implicit ones are the default
    #[arg(long)]
    explicit: bool,

    /// Keep all bodies awake: several times the processor time; packs in sequence come out lower by about 1.5 %
    /// [default: bodies at rest sleep until something moves them]
    #[arg(long)]
    awake: bool,

    /// Gravity in m/s2 [default: 9.81]
    #[arg(long, value_name = "M/S2")]
    gravity: Option<f64>,

    /// Kind of container [default: box]
    #[arg(long, value_enum)]
    container: Option<ContainerKind>,

    /// Inner width and depth of the box, or of the periodic floor, in d, each at least 1, such as 6x6, or in m, such as
    /// 0.3x0.4m (cm, mm, um, in, ft too); a third number is the height of its rim [default: as wide as the pack will be high]
    #[arg(long, value_name = "WxD[xH][m]")]
    r#box: Option<Footprint>,

    /// Inner diameter of the cylinder in d, at least 1, or in m, such as 0.3m [default: as wide as the
    /// pack will be high]
    #[arg(long, value_name = "X[m]", conflicts_with = "box")]
    cylinder: Option<Length>,

    /// Diameter of the closed outlet of a silo, in d or in m [default: 3]
    #[arg(long, value_name = "X[m]", conflicts_with = "box")]
    outlet: Option<Length>,

    /// Angle between a silo's cone and the vertical, in degrees [default: 30]
    #[arg(long, value_name = "DEGREES", conflicts_with = "box")]
    cone: Option<f64>,

    /// Surface file of the solid that makes the walls, such as a hopper: z up, open at the top; bodies
    /// come in from above, and a floor at its lowest point closes it
    #[arg(long, value_name = "FILE", conflicts_with_all = ["box", "cylinder", "outlet", "cone"])]
    walls: Option<PathBuf>,

    /// How bodies come into the container [default: sequential]
    #[arg(long, value_enum)]
    protocol: Option<ProtocolKind>,

    /// Bodies in a batch (sequential) or a layer (pour) [default: one for each 1.5d x 1.5d of the floor]
    #[arg(long, value_name = "N")]
    batch: Option<u32>,

    /// Bodies per second (pour) [default: 200]
    #[arg(long, value_name = "1/S")]
    rate: Option<f64>,

    /// Height of the release above the floor (pour), in d or in m, such as 3.87m [default: 1 d above
    /// the pack to come]
    #[arg(long, value_name = "X[m]")]
    height: Option<Length>,

    /// Seed of all random numbers; the same seed gives the same pack, bit for bit, on any number of
    /// threads [default: 1]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Folder for the results; must be new or empty [default: out/pack]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Write into --out even if it holds files; those of the same names are replaced, and the summary
    /// and the checkpoint of an earlier job go
    #[arg(long)]
    pub force: bool,

    /// Write report.html too, as `femdem report` does
    #[arg(long)]
    pub report: bool,

    /// List the shapes, estimate the cost from the first bodies, and stop; no files are written
    #[arg(long)]
    pub check: bool,

    /// Write the scene of these options to the terminal, and stop
    #[arg(long)]
    pub print_scene: bool,

    #[command(flatten)]
    pub run: RunArgs,
}

impl PackArgs {
    /// The scene file, or the defaults, with the options of the command line in their places.
    pub(crate) fn scene(&self) -> Result<Scene, femdem::Error> {
        let mut scene = match &self.scene {
            Some(path) => {
                let (scene, old_words) = Scene::read_saying(path)?;
                old_words.iter().for_each(|line| complain(line));
                scene
            }
            None => Scene::default(),
        };
        self.set_shapes(&mut scene);
        set(&mut scene.count, &self.count);
        set(&mut scene.friction, &self.friction);
        set(&mut scene.rolling_friction, &self.rolling_friction);
        set(&mut scene.cohesion, &self.cohesion);
        set(&mut scene.adhesion_energy, &self.adhesion_energy);
        if !self.material.is_empty() {
            scene.material.clone_from(&self.material);
        }
        if self.wall_material.is_some() {
            scene.wall_material.clone_from(&self.wall_material);
        }
        set(&mut scene.tangential_ratio, &self.tangential_ratio);
        set(&mut scene.tangential_damping, &self.tangential_damping);
        set(&mut scene.damping, &self.damping);
        set(&mut scene.drag, &self.drag);
        set(&mut scene.local_damping, &self.local_damping);
        set(&mut scene.gravity, &self.gravity);
        scene.take_container(&Scene {
            container: self.container,
            r#box: self.r#box,
            cylinder: self.cylinder,
            outlet: self.outlet,
            cone: self.cone,
            walls: self.walls.clone(),
            ..Scene::default()
        });
        set(&mut scene.protocol, &self.protocol);
        set(&mut scene.rate, &self.rate);
        set(&mut scene.seed, &self.seed);
        set(&mut scene.out, &self.out);
        set(&mut scene.checkpoint_every, &self.run.checkpoint_every);
        scene.wall_friction = self.wall_friction.or(scene.wall_friction);
        scene.implicit = self.steps().or(scene.implicit);
        scene.sleeping &= !self.awake;
        scene.height = self.height.or(scene.height);
        scene.batch = self.batch.or(scene.batch);
        scene.penetration = self.penetration.or(scene.penetration);
        scene.threads = self.run.threads.map(usize::from).or(scene.threads);
        // A penetration asked for here undoes a penalty in the file.
        if self.penetration.is_some() {
            scene.penalty = None;
        }
        scene.penalty = self.penalty.or(scene.penalty);
        Ok(scene)
    }

    /// The first option that is given and does not belong to the scene.
    pub(crate) fn beside_the_scene(&self) -> Option<&'static str> {
        let given = [
            (self.check, "check"),
            (self.force, "force"),
            (self.print_scene, "print-scene"),
            (self.report, "report"),
            (self.run.quiet, "quiet"),
        ];
        given.into_iter().find_map(|(so, name)| so.then_some(name))
    }

    fn steps(&self) -> Option<StepKind> {
        let explicit = self.explicit.then_some(StepKind::Explicit);
        explicit.or(self.implicit.map(StepKind::Implicit))
    }

    /// Shapes given here take the place of all shapes in the file, and their size that of any other.
    fn set_shapes(&self, scene: &mut Scene) {
        if !self.shape.is_empty() {
            scene.shape.clone_from(&self.shape);
            scene.share.clear();
        }
        if !self.share.is_empty() {
            scene.share.clone_from(&self.share);
        }
        set(&mut scene.variety, &self.variety);
        if !self.density.is_empty() {
            scene.density.clone_from(&self.density);
        }
        let measured = self.diameter.or(self.size).or(self.mass).is_some();
        if measured || !self.sizes.is_empty() || !self.sieve.is_empty() {
            (scene.diameter, scene.size, scene.mass) = (self.diameter, self.size, self.mass);
            scene.sizes.clone_from(&self.sizes);
            scene.sieve.clone_from(&self.sieve);
        }
        set(&mut scene.unit, &self.unit);
        scene.repair |= self.repair;
        scene.mesh_size = self.mesh_size.or(scene.mesh_size);
    }
}

fn set<T: Clone>(to: &mut T, from: &Option<T>) {
    if let Some(value) = from {
        to.clone_from(value);
    }
}

/// Options of all that measures or computes once.
#[derive(Debug, Args)]
pub(crate) struct WorkArgs {
    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// No summary on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,
}

/// How to run.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct RunArgs {
    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// Seconds between checkpoints, 0 or more [default: 60]
    #[arg(long, value_name = "S")]
    pub checkpoint_every: Option<f64>,

    /// No progress and no summary on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,

    /// What ends the run, where a host and not the program watches for it.
    #[arg(skip)]
    pub stop: Option<Arc<AtomicBool>>,
}

#[derive(Debug, Args)]
pub(crate) struct ResumeArgs {
    /// Folder of the run, which holds pack.ckpt or run.ckpt
    pub folder: PathBuf,

    /// Go on to this simulated time in s, beyond the present one, also if the run of a scene has ended
    #[arg(long, value_name = "S")]
    pub duration: Option<f64>,

    /// Write report.html of a pack too, as `femdem report` does
    #[arg(long)]
    pub report: bool,

    #[command(flatten)]
    pub run: RunArgs,
}
