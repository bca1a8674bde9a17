//! The command line.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::{Args, Parser, Subcommand};

use super::analyse::AnalyseArgs;
use super::args::{PackArgs, ResumeArgs};
use super::picture::PictureArgs;
use super::pores::PoresArgs;
use super::report::ReportArgs;
use super::resolve::ResolveArgs;
use super::run::SceneArgs;
use super::stresses::StressesArgs;
use super::sweep::SweepArgs;

/// Pack bodies of any shape, rigid or deformable, or let them collide, and measure what comes of it
#[derive(Debug, Parser)]
#[command(name = "femdem", version, propagate_version = true, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

const EXAMPLES: &str = "\
Examples:
  femdem pack                                      200 truncated dodecahedra into out/pack
  femdem pack --shape A10 --count 500 --friction 0.6 --seed 1 --out out/a10
  femdem pack --shape cube --container cylinder --protocol pour --out out/cubes
  femdem pack --shape stone.stl --unit mm --box 8x8 --out out/stones
  femdem pack --shape boulder --variety 50 --mass 40 --box 5.26x5.3x3.87m --out out/boulders
  femdem pack --sieve 10mm:0,20mm:0.4,30mm:1 --count 500 --out out/gravel
  femdem pack --shape cube --shape dolos:waist=0.36 --share 3 --share 1 --out out/mixed
  femdem pack --count 2000 --print-scene > big.toml && femdem pack big.toml
  femdem run scenes/bouncing-cube.toml             bodies that deform, collide, or are driven
  femdem resume out/a10                            go on after Ctrl-C or a crash
  femdem resume out/run --duration 2               go on with a run that has ended
  femdem analyse out/a10                           forces, chains, stress, profiles: all tables
  femdem report out/a10                            a page for the browser
  femdem picture out/a10 --view front --colour force --out a10.png
  femdem pores out/a10                             the void between the bodies, for flow codes
  femdem stresses out/a10 --strength 5e6           the stresses inside the bodies, and which would crack
  femdem sweep pack.toml --vary friction=0.2,0.4,0.6 --seeds 5
  femdem shapes                                    what --shape knows

d is the circumscribed diameter of a body. Units are SI.";

const PACK_HELP: &str = "\
The folder then holds
  summary.json               the result in numbers
  sieve.csv                  the sizes, as a sieve curve by mass
  bodies.csv, contacts.csv   poses; contact points, forces and areas
  pack.vtu, contacts.vtp     for ParaView
  pack.stl, shape-NAME.obj   surfaces
  pack.png                   the pack from above the front, coloured by sequence of placement
  report.html, plots/*.svg   with --report: a page for the browser, and its plots
  scene.toml                 the options of this run
  pack.ckpt                  a checkpoint, for `femdem resume` and `femdem analyse`

Ctrl-C stops cleanly, with a checkpoint.";

const RUN_HELP: &str = "\
The folder then holds
  summary.json               the result in numbers
  history.csv                energies, momentum, forces of walls and supports over time
  members.csv                places, velocities and forces of the bodies, with `track = true`
  flow.csv                   what has passed gauges and sinks and come from sources over time
  run.pvd, contacts.pvd      time series for ParaView, of the files in frames/
  walls.pvd                  the walls for ParaView, with the forces on them
  run.png                    the end, deformable bodies coloured by von Mises stress
  fragments.csv, events.csv  of breakable bodies: pieces, facets that broke; and cracks.vtp, cracks.pvd
  scene.toml                 the scene
  run.ckpt                   a checkpoint, for `femdem resume`; of ranks with the files in parts/

Ctrl-C stops cleanly, with a checkpoint.";

const RESUME_HELP: &str = "\
The scene.toml in the folder of a run of a scene may be changed before: duration, output, rest, relax,
energy-error-limit, the contact law, the step, sleep, gravity, medium and motions are applied, and named.
Bodies, materials and walls stay as they are.";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Pour bodies into a container, let them settle, measure and draw the pack
    #[command(after_help = PACK_HELP, allow_negative_numbers = true)]
    Pack(Box<PackArgs>),
    /// Step any mixture of rigid and deformable bodies and walls, as a scene file says
    #[command(after_help = RUN_HELP)]
    Run(Box<SceneArgs>),
    /// Continue a run of `pack` or `run` from the checkpoint in its folder
    #[command(after_help = RESUME_HELP)]
    Resume(ResumeArgs),
    /// Measure a pack in every way, without simulating: of a run, or from tables and shapes
    #[command(after_help = super::analyse::HELP, allow_negative_numbers = true)]
    Analyse(AnalyseArgs),
    /// Write report.html, a page that shows a pack in any browser
    Report(ReportArgs),
    /// Draw a pack, or the end of a run, from any side, coloured by any quantity
    Picture(PictureArgs),
    /// Make the void of a pack usable by flow codes: voxels, distances, pore sizes, paths, closed surfaces
    #[command(after_help = super::pores::HELP)]
    Pores(Box<PoresArgs>),
    /// Find the stresses inside the bodies of a pack, body by body, under the forces of their contacts
    #[command(after_help = super::stresses::HELP, allow_negative_numbers = true)]
    Stresses(StressesArgs),
    /// Make the bodies of a pack deformable where they lie, and find the stresses inside them
    #[command(after_help = super::resolve::HELP, allow_negative_numbers = true)]
    Resolve(ResolveArgs),
    /// Make the packs or runs of all combinations of values, one after another, with a table of their results
    #[command(after_help = super::sweep::HELP)]
    Sweep(SweepArgs),
    /// List the shapes that --shape knows, with their parameters, or draw them
    Shapes(ShapesArgs),
}

impl Command {
    /// Lets a flag end the commands that run long, instead of Ctrl-C.
    pub(super) fn stop_by(&mut self, flag: &Arc<AtomicBool>) {
        let stop = match self {
            Self::Pack(args) => &mut args.run.stop,
            Self::Run(args) => &mut args.run.stop,
            Self::Resume(args) => &mut args.run.stop,
            Self::Sweep(args) => &mut args.stop,
            _ => return,
        };
        *stop = Some(Arc::clone(flag));
    }
}

#[derive(Debug, Args)]
pub(crate) struct ShapesArgs {
    /// Write a list of JSON objects
    #[arg(long)]
    pub json: bool,

    /// Draw all shapes side by side into a PNG file instead
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    pub picture: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use femdem::Scene;
    use femdem::pack::{Protocol, Release};
    use femdem::scene::{ContainerKind, Footprint, Length, StepKind, Unit};

    fn scene(options: &str) -> Scene {
        let words = ["femdem", "pack"]
            .into_iter()
            .chain(options.split_whitespace());
        match Cli::try_parse_from(words).unwrap().command {
            Command::Pack(args) => args.scene().unwrap(),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }

    #[test]
    fn without_options_the_scene_is_the_default() {
        assert_eq!(scene(""), Scene::default());
    }

    #[test]
    fn options_go_to_their_places() {
        let scene =
            scene("--shape P5 --count 7 --box 4x5 --seed 9 --threads 2 --penalty 1e6 --out x");
        assert_eq!(
            (scene.shape.as_slice(), scene.count, scene.seed),
            (&["P5".to_owned()][..], 7, 9)
        );
        assert_eq!(scene.r#box, Some(Footprint::diameters(4.0, 5.0)));
        assert_eq!((scene.threads, scene.penalty), (Some(2), Some(1e6)));
    }

    #[test]
    fn implicit_steps_without_a_number_have_the_usual_length() {
        assert_eq!(scene("--implicit").implicit, Some(StepKind::implicit()));
        assert_eq!(
            scene("--implicit=3").implicit,
            Some(StepKind::Implicit(3.0))
        );
        assert_eq!(scene("--explicit").implicit, Some(StepKind::Explicit));
        assert_eq!(scene("--protocol release").implicit, None);
    }

    #[test]
    fn bodies_can_be_kept_awake() {
        assert!(scene("").sleeping && !scene("--awake").sleeping);
    }

    #[test]
    fn the_size_of_a_cylinder_makes_the_container_one() {
        let kind = |options: &str| scene(options).container_kind();
        assert_eq!(kind("--cylinder 5").unwrap(), ContainerKind::Cylinder);
        let five = Length::Diameters(5.0);
        assert_eq!(scene("--cylinder 5").cylinder, Some(five));
        assert_eq!(kind("--cylinder 5 --cone 40").unwrap(), ContainerKind::Silo);
        assert_eq!(
            kind("--container cylinder").unwrap(),
            ContainerKind::Cylinder
        );
        assert!(kind("--container box --cylinder 5").is_err());
    }

    /// The command that a report shows makes the scene that it is of.
    #[test]
    fn the_command_of_a_scene_gives_the_scene() {
        for options in [
            "",
            "--shape cube --shape dolos:waist=0.36 --share 3 --share 1 --mass 2 --unit mm --repair",
            "--shape cube --shape A10 --sizes 20mm:0.3,30mm:0.7 --sizes weibull-mass:30mm:2:10mm..50mm --density 1e3 --density 2e3",
            "--sieve 10mm:0,20mm:0.4,30mm:1",
            "--cylinder 5 --cone 40 --outlet 0.1m --protocol pour --rate 50 --height 3.87m",
            "--box 4x5x6m --seed 9 --threads 2 --penalty 1e6 --drag 0.6/fall --local-damping 0.3 --variety 3 --out a/b",
            "--friction 0.5 --wall-friction 0 --tangential-ratio 1.6 --tangential-damping 0.2 --drag 8.4/s",
        ] {
            let made = scene(options);
            let command = made.command();
            let again = scene(command.strip_prefix("femdem pack").unwrap());
            assert_eq!(again, made, "{command}");
        }
    }

    #[test]
    fn shapes_and_shares_are_lists() {
        let mixed = scene("--shape cube --shape A10 --share 3 --share 1 --mass 2 --unit mm");
        assert_eq!(mixed.shape, ["cube", "A10"]);
        assert_eq!(mixed.share, [3.0, 1.0]);
        assert_eq!((mixed.mass, mixed.diameter), (Some(2.0), None));
        assert_eq!(mixed.unit, Unit::Mm);
    }

    /// The defaults in the help are those of the scene.
    #[test]
    fn help_states_the_defaults() {
        let mut command = Cli::command();
        let pack = command.find_subcommand_mut("pack").unwrap();
        let help = pack.render_long_help().to_string();
        let words = help.split_whitespace().collect::<Vec<_>>().join(" ");
        let d = Scene::default();
        for text in [
            format!("Number of bodies [default: {}]", d.count),
            format!("[default: {}; for a file", femdem::scene::DEFAULT_DIAMETER),
            format!("each --shape [default: {}]", d.density[0]),
            format!("with walls [default: {}]", d.friction),
            format!("at most 2 [default: {}]", d.tangential_ratio),
            format!("0.25 [default: {}]", d.damping),
            format!(
                "aims at [default: {}; {} with --protocol release",
                Protocol::default().usual_penetration(),
                Protocol::Release(Release::default()).usual_penetration()
            ),
            format!("m/s2 [default: {}]", d.gravity),
            format!("second (pour) [default: {}]", d.rate),
            format!("in m [default: {}]", femdem::scene::DEFAULT_OUTLET),
            format!("degrees [default: {}]", femdem::scene::DEFAULT_CONE),
            format!("after it [default: {}]", d.variety),
            "[default: A10]".to_owned(),
            format!("empty [default: {}]", d.out.display()),
            format!("0 or more [default: {}]", d.checkpoint_every),
        ] {
            assert!(words.contains(&text), "{text:?} is not in\n{words}");
        }
    }
}
