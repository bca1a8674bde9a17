//! `femdem resolve`: stresses inside the bodies of a pack.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::Args;
use femdem::fem::element::Element;
use femdem::pack::Packing;
use femdem::resolve::{ResolveOptions, resolve};
use femdem::results;

use super::args::WorkArgs;
use super::running::{Outcome, in_pool};
use super::{complain, folder, say};

pub(crate) const HELP: &str = "\
The folder then holds
  stress.vtu, contacts.vtp   tetrahedra with stresses, contacts with forces, for ParaView
  stress.csv                 mean stress of each body: of its elements, and by Love-Weber
  stress.png                 the bodies coloured by von Mises stress
  resolve.json               the result in numbers";

/// Options of `femdem resolve`.
#[derive(Debug, Args)]
pub(crate) struct ResolveArgs {
    /// Folder of a run of `femdem pack`, which holds pack.ckpt
    pub folder: PathBuf,

    /// Young's modulus in Pa [default: 60e9]
    #[arg(long, value_name = "PA")]
    pub young: Option<f64>,

    /// Poisson's ratio, below 0.5 [default: 0.22]
    #[arg(long, value_name = "X")]
    pub poisson: Option<f64>,

    /// Target edge length of the tetrahedra of convex bodies, in d; others keep theirs [default: 0.3]
    #[arg(long, value_name = "X")]
    pub mesh_size: Option<f64>,

    /// Ten-node elements instead of four-node ones
    #[arg(long)]
    pub quadratic: bool,

    /// Largest force left over, as a part of the mean contact force [default: 1e-4]
    #[arg(long, value_name = "X")]
    pub tolerance: Option<f64>,

    /// Most steps of the relaxation [default: 200000]
    #[arg(long, value_name = "N")]
    pub steps: Option<u64>,

    /// Folder for the results; must be new or empty [default: resolved, in the run's folder]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Write into --out even if it holds files; those of the same names are replaced
    #[arg(long)]
    pub force: bool,

    #[command(flatten)]
    pub work: WorkArgs,
}

impl ResolveArgs {
    fn options(&self) -> ResolveOptions {
        let mut options = ResolveOptions::default();
        options.young = self.young.unwrap_or(options.young);
        options.poisson = self.poisson.unwrap_or(options.poisson);
        options.mesh_size = self.mesh_size.unwrap_or(options.mesh_size);
        if self.quadratic {
            options.element = Element::T10;
        }
        let relaxation = &mut options.relaxation;
        relaxation.tolerance = self.tolerance.unwrap_or(relaxation.tolerance);
        relaxation.steps = self.steps.unwrap_or(relaxation.steps);
        options
    }
}

/// Refuses a pack that is not finished; warns if it is finished but did not come to rest.
pub(super) fn check_rest(packing: &Packing, folder: &Path) -> Result<()> {
    let shown = folder.display();
    if !packing.is_done() {
        let at = packing.progress();
        bail!(
            "the pack in {shown} is not finished ({} of {} bodies placed): bodies that still fall lie nowhere; \
             go on with it first: femdem resume {shown}",
            at.placed,
            at.count
        );
    }
    if !packing.report()?.settled {
        complain(&format!(
            "the pack in {shown} did not come to rest: its bodies may end elsewhere than they are in it"
        ));
    }
    Ok(())
}

pub(crate) fn run(args: &ResolveArgs) -> Result<Outcome> {
    in_pool(args.work.threads.map(usize::from), |_| {
        let saved = folder::load(&args.folder)?;
        check_rest(&saved.packing, &args.folder)?;
        let out = match &args.out {
            Some(out) => out.clone(),
            None => args.folder.join("resolved"),
        };
        let _claim = folder::prepare(&out, args.force)?;
        let options = args.options();
        let resolved = resolve(saved.packing.world(), &options)?;
        let outline = results::snapshot(&saved.packing).outline();
        let summary = resolved.write(&out, &options, outline.as_ref())?;
        if !args.work.quiet {
            let shown = out.display();
            say(&format!("{summary}  {:<20} {shown}", "results in"));
        }
        Ok(Outcome::Finished)
    })
}
