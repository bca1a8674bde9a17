//! `femdem-mpi`: packs and scenes over several processes.
//!
//! `mpirun -n 4 femdem-mpi pack --count 10000` and `mpirun -n 4 femdem-mpi run scene.toml`; the results are those of
//! `femdem pack` and `femdem run`, to the last bit of the motion.

mod cost;
mod folder;
mod job;
mod pack;

use anyhow::{Context, Error, Result, ensure};
use clap::{Args, Parser, Subcommand};
use femdem::program::pack_scene;
use femdem::results::PACK_CHECKPOINT;
use femdem::solve::Halo;
use femdem_mpi::MpiHalo;
use job::Job;
use mpi::Threading;
use pack::Pack;
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;

/// Makes packs and runs scenes over the processes that mpirun starts.
#[derive(Parser)]
#[command(name = "femdem-mpi", version)]
struct Cli {
    #[command(subcommand)]
    command: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Pack bodies, as `femdem pack` does
    Pack {
        /// Stop after so many steps, with a checkpoint; before the others
        #[arg(long, value_name = "N")]
        steps: Option<u64>,
        /// Scene file and options of `femdem pack`; --threads are those of each rank [default: 1]
        #[arg(
            value_name = "OPTIONS",
            trailing_var_arg = true,
            allow_hyphen_values = true
        )]
        words: Vec<OsString>,
    },
    /// Run a scene
    Run {
        /// Scene file (TOML), as of `femdem run`
        scene: PathBuf,
        /// Folder for the results, new or empty [default: that of the scene]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        options: Options,
    },
    /// Go on with a pack or a run, of `femdem` or over any number of ranks
    Resume {
        /// Its folder
        folder: PathBuf,
        #[command(flatten)]
        options: Options,
    },
}

/// What a run and its continuation have in common.
#[derive(Args)]
struct Options {
    /// Threads of each rank [default: 1]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Seconds between two checkpoints
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0)]
    checkpoint_every: f64,
    /// Stop after so many steps, with a checkpoint
    #[arg(long, value_name = "N")]
    steps: Option<u64>,
}

fn main() -> ExitCode {
    // Before MPI starts: what is wrong with the command line is said once a rank, and ends all.
    let cli = Cli::parse();
    // MPI is called by the main thread alone.
    let Some((universe, _)) = mpi::initialize_with_threading(Threading::Funneled) else {
        eprintln!("femdem-mpi: MPI cannot be started");
        return ExitCode::FAILURE;
    };
    let mut halo = MpiHalo::new(&universe.world());
    // The others wait for a rank that fails.
    match catch_unwind(AssertUnwindSafe(|| work(cli, &mut halo))) {
        Ok(Ok(())) => {}
        Ok(Err(error)) => {
            eprintln!("femdem-mpi: rank {}: {error:#}", halo.rank());
            halo.abort(1);
        }
        Err(_) => halo.abort(1),
    }
    ExitCode::SUCCESS
}

fn work(cli: Cli, halo: &mut MpiHalo) -> Result<()> {
    match cli.command {
        Task::Pack { steps, words } => {
            let scene = pack_scene(words).map_err(Error::msg)?;
            start_threads(scene.threads)?;
            Pack::begin(&scene, halo)?.go_on(scene.checkpoint_every, steps, halo)
        }
        Task::Run {
            scene,
            out,
            options,
        } => {
            let every = options.take()?;
            Job::begin(&scene, out, halo)?.go_on(every, options.steps, halo)
        }
        Task::Resume { folder, options } => {
            let every = options.take()?;
            // The first rank looks, for all.
            let mut packs = [0];
            if halo.rank() == 0 {
                packs = [u64::from(folder.join(PACK_CHECKPOINT).is_file())];
            }
            halo.sum(&mut packs)?;
            if packs[0] > 0 {
                return Pack::resume(&folder, halo)?.go_on(every, options.steps, halo);
            }
            Job::resume(&folder, halo)?.go_on(every, options.steps, halo)
        }
    }
}

impl Options {
    /// Starts the threads, and returns the seconds between checkpoints.
    fn take(&self) -> Result<f64> {
        start_threads(self.threads.map(NonZeroUsize::get))?;
        let every = self.checkpoint_every;
        ensure!(
            every > 0.0,
            "--checkpoint-every {every} is not allowed: it must be more than 0, in s"
        );
        Ok(every)
    }
}

fn start_threads(threads: Option<usize>) -> Result<()> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(1))
        .build_global()
        .context("the threads cannot be started")
}
