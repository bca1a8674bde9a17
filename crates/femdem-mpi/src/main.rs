//! `femdem-mpi`: scenes of rigid bodies over several processes.
//!
//! `mpirun -n 4 femdem-mpi run scene.toml`; the results are those of `femdem run`, to the last bit of the motion.

mod job;

use anyhow::{Context, Result};
use clap::{Args, Parser, Subcommand};
use femdem::solve::Halo;
use femdem_mpi::MpiHalo;
use job::Job;
use mpi::Threading;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;

/// Runs scenes of rigid bodies over the processes that mpirun starts.
#[derive(Parser)]
#[command(name = "femdem-mpi", version)]
struct Cli {
    #[command(subcommand)]
    command: Task,
}

#[derive(Subcommand)]
enum Task {
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
    /// Go on with a run, of `femdem run` or over any number of ranks
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
    let (Task::Run { options, .. } | Task::Resume { options, .. }) = &cli.command;
    rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.map_or(1, NonZeroUsize::get))
        .build_global()
        .context("the threads cannot be started")?;
    let (every, steps) = (options.checkpoint_every, options.steps);
    anyhow::ensure!(
        every > 0.0,
        "--checkpoint-every {every} is not allowed: it must be more than 0, in s"
    );
    let job = match cli.command {
        Task::Run { scene, out, .. } => Job::begin(&scene, out, halo)?,
        Task::Resume { folder, .. } => Job::resume(&folder, halo)?,
    };
    job.go_on(every, steps, halo)
}
