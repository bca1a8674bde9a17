//! `femdem stresses`: stresses inside the bodies of a pack, body by body.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::Result;
use clap::Args;
use femdem::fem::element::Element;
use femdem::mesh::TetMesh;
use femdem::solve::World;
use femdem::stresses::{StressOptions, stresses};

use super::resolve::check_rest;
use super::running::{Outcome, in_pool};
use super::source::{self, ForeignArgs, Found, FrameArgs, Origin};
use super::{complain, folder, say};

pub(crate) const HELP: &str = "\
The folder then holds
  stress.csv                 of each body: largest tension, von Mises stress, bound, mean stress
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

    /// Threads, 1 or more [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,

    /// No summary on the terminal; errors are still shown
    #[arg(long, short)]
    pub quiet: bool,
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

/// Net forces above this part of the contact forces are told: the bodies are not at rest.
const AT_REST: f64 = 0.05;

pub(crate) fn run(args: &StressesArgs) -> Result<Outcome> {
    in_pool(args.threads.map(usize::from), |_| {
        let found = source::read(&args.folder, &args.foreign, &args.frame)?;
        found.refuse_moved_cell()?;
        if let Origin::Pack(saved) = &found.origin {
            check_rest(&saved.packing, &args.folder)?;
        }
        let out = match &args.out {
            Some(out) => out.clone(),
            None => found.folder.join("stresses"),
        };
        let _claim = folder::prepare(&out, args.force)?;
        let options = args.options();
        let start = Instant::now();
        let solved = stresses(&found.snapshot, &meshes(&found), &options)?;
        let summary = solved.summary(&options, start.elapsed().as_secs_f64());
        solved.write(&out, &found.snapshot, &options, &summary)?;
        if summary.net_force[0] > AT_REST {
            complain(
                "warning: half of the bodies are not at rest: their net forces are balanced by their accelerations, as in flight",
            );
        }
        if !args.quiet {
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
