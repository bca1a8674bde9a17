//! `femdem stresses`: stresses inside the bodies of a pack, body by body.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Result, bail};
use clap::Args;
use femdem::fem::element::Element;
use femdem::mesh::{TetMesh, Vector3};
use femdem::run::{Behaviour, Run};
use femdem::solve::World;
use femdem::stresses::{StressOptions, Stresses, stresses};

use super::args::WorkArgs;
use super::resolve::check_rest;
use super::running::{Outcome, in_pool};
use super::source::{self, ForeignArgs, Found, FrameArgs, Origin};
use super::{complain, folder, say};

pub(crate) const HELP: &str = "\
The folder then holds
  stress.csv                 of each body: largest tension, von Mises stress, splitting estimate, mean stress
  stress.vtu                 tetrahedra with stresses, for ParaView
  stress.png                 the bodies coloured by their largest tension
  stresses.json              the result in numbers";

/// Options of `femdem stresses`.
#[derive(Debug, Args)]
pub(crate) struct StressesArgs {
    /// Folder of a run, which holds pack.ckpt or run.ckpt, or of a pack from elsewhere, which holds bodies.csv
    pub folder: PathBuf,

    /// Tensile strength of the material in Pa: tells which bodies would crack
    #[arg(long, value_name = "PA")]
    pub strength: Option<f64>,

    /// Young's modulus in Pa, which scales the displacements alone [default: 60e9]
    #[arg(long, value_name = "PA")]
    pub young: Option<f64>,

    /// Poisson's ratio, below 0.5 [default: 0.22]
    #[arg(long, value_name = "X")]
    pub poisson: Option<f64>,

    /// Target edge length of the tetrahedra, in d; bodies packed as tetrahedra keep theirs [default: 0.2]
    #[arg(long, value_name = "X")]
    pub mesh_size: Option<f64>,

    /// Four-node elements instead of ten-node ones: faster, and coarse
    #[arg(long)]
    pub linear: bool,

    /// Most bodies of which stress.vtu is written [default: 1000]
    #[arg(long, value_name = "N")]
    pub most_fields: Option<usize>,

    #[command(flatten)]
    pub frame: FrameArgs,

    #[command(flatten)]
    pub foreign: ForeignArgs,

    /// Folder for the results; must be new or empty [default: stresses, in the run's folder]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Write into --out even if it holds files; those of the same names are replaced
    #[arg(long)]
    pub force: bool,

    #[command(flatten)]
    pub work: WorkArgs,
}

impl StressesArgs {
    fn options(&self) -> StressOptions {
        let default = StressOptions::default();
        StressOptions {
            young: self.young.unwrap_or(default.young),
            poisson: self.poisson.unwrap_or(default.poisson),
            mesh_size: self.mesh_size.unwrap_or(default.mesh_size),
            element: if self.linear {
                Element::T4
            } else {
                default.element
            },
            strength: self.strength,
            most_fields: self.most_fields.unwrap_or(default.most_fields),
        }
    }
}

/// The tetrahedra that shapes were packed with.
fn meshes(found: &Found) -> Vec<Option<TetMesh>> {
    let of_world = |world: &World| {
        let shapes = world.shapes().iter();
        shapes
            .map(|shape| shape.mesh.as_ref().map(|(mesh, _)| mesh.clone()))
            .collect()
    };
    match &found.origin {
        Origin::Pack(saved) => of_world(saved.packing.world()),
        Origin::Run(saved, None) => of_world(&saved.0.simulation().world),
        Origin::Run(_, Some(_)) | Origin::Elsewhere => Vec::new(),
    }
}

/// Gravity [m/s²]; that of tables is the user's word.
fn gravity(found: &Found) -> Vector3 {
    match &found.origin {
        Origin::Pack(saved) => saved.packing.world().parameters().gravity,
        Origin::Run(saved, _) => saved.0.simulation().world.parameters().gravity,
        Origin::Elsewhere => Vector3::z() * -found.snapshot.gravity,
    }
}

/// Refuses runs in which other than rigid bodies, or other forces than those of contacts and gravity, are.
fn refuse_others(run: &Run) -> Result<()> {
    let (scene, simulation) = (run.scenario(), run.simulation());
    let world = &simulation.world;
    let rigid = |behaviour: Behaviour| behaviour == Behaviour::Rigid;
    if world.deformables().next().is_some()
        || simulation.members.iter().any(|member| member.of.is_some())
        || scene.body.iter().any(|body| !rigid(body.behaviour))
    {
        bail!(
            "the run has deformable bodies, which have stresses of their own, in its frames: `femdem stresses` is for rigid bodies"
        );
    }
    if world.bonds_added() > 0 {
        bail!(
            "the run has bonds, whose forces are no contacts: stresses inside its bodies without them would be wrong; \
             bonds.csv has the stresses of the bonds"
        );
    }
    let is_loaded = |id| {
        let load = world.applied_load(id);
        load.is_some_and(|load| load.force != Vector3::zeros() || load.torque != Vector3::zeros())
    };
    if !scene.load.is_empty() || world.body_ids().any(is_loaded) {
        bail!(
            "the run has a [[load]], which is no contact: stresses inside its bodies without it would be wrong; take them of a \
             stage without loads"
        );
    }
    Ok(())
}

/// Bodies are named up to this number.
const NAMED: usize = 5;

/// Warns of bodies whose contacts and weight do not balance.
fn warn(solved: &Stresses, unknown: usize) {
    let bodies: Vec<String> = solved.not_at_rest().map(|i| i.to_string()).collect();
    if !bodies.is_empty() {
        let named = bodies[..bodies.len().min(NAMED)].join(", ");
        let more = if bodies.len() > NAMED { ", ..." } else { "" };
        complain(&format!(
            "warning: {} of {} bodies have a net force above 5 % of their contact forces (rows {named}{more} of stress.csv): they are \
             not at rest, or held or driven, and accelerations balance their forces, as in flight",
            bodies.len(),
            solved.bodies.len()
        ));
    }
    if unknown > 0 {
        complain(&format!(
            "warning: whether {unknown} bodies are at rest is not known: they have no contact forces, or their masses are not known"
        ));
    }
}

pub(crate) fn run(args: &StressesArgs) -> Result<Outcome> {
    in_pool(args.work.threads.map(usize::from), |_| {
        let found = source::read(&args.folder, &args.foreign, &args.frame)?;
        found.refuse_moved_cell()?;
        if let Origin::Pack(saved) = &found.origin {
            check_rest(&saved.packing, &args.folder)?;
        }
        if let Origin::Run(saved, _) = &found.origin {
            refuse_others(&saved.0)?;
        }
        let out = match &args.out {
            Some(out) => out.clone(),
            None => found.folder.join("stresses"),
        };
        let _claim = folder::prepare(&out, args.force)?;
        let options = args.options();
        let start = Instant::now();
        let gravity = Some(gravity(&found));
        let solved = stresses(&found.snapshot, &meshes(&found), gravity, &options)?;
        let summary = solved.summary(&options, start.elapsed().as_secs_f64());
        solved.write(&out, &found.snapshot, &options, &summary)?;
        warn(&solved, summary.net_force_unknown);
        if !args.work.quiet {
            let shown = out.display();
            say(&format!("{summary}  {:<20} {shown}", "results in"));
            if !solved.has_fields() {
                say(&format!(
                    "  no stress.vtu: there are more than {} bodies; --most-fields {} writes it",
                    options.most_fields, summary.bodies
                ));
            }
        }
        Ok(Outcome::Finished)
    })
}
