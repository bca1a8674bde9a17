//! `femdem run`: stepping a scenario to its end, or to Ctrl-C.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use clap::Args;
use femdem::run::{Run, Scenario};
use femdem::{Usage, output};

use super::args::{ResumeArgs, RunArgs};
use super::meter::Meter;
use super::progress::Clock;
use super::running::{BREATH, Outcome, checkpoint_interval, in_pool, watch_for_interrupt};
use super::{check, complain, described, folder, overlaps, say, say_notes};

/// Options of `femdem run`. Those left out are taken from the scene.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Scene file (TOML), see docs/scenes.md
    pub scene: PathBuf,

    /// Folder for the results; must be new or empty [default: that of the scene, or out/run]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Write into --out even if it holds files; those of the same names are replaced, and the summary
    /// and the checkpoint of an earlier job go
    #[arg(long)]
    pub force: bool,

    /// Read the scene, list its bodies, masses and tetrahedra, estimate the cost, and stop
    #[arg(long)]
    pub check: bool,

    /// Run also if the forecast has more than a billion steps
    #[arg(long)]
    pub yes: bool,

    #[command(flatten)]
    pub run: RunArgs,
}

pub(crate) fn run(args: &SceneArgs) -> Result<Outcome> {
    let mut scenario = Scenario::read(&args.scene)?;
    if let Some(out) = &args.out {
        scenario.out.clone_from(out);
    }
    run_scenario(args, scenario)
}

/// Runs one scene.
pub(super) fn run_scenario(args: &SceneArgs, scenario: Scenario) -> Result<Outcome> {
    let every = args
        .run
        .checkpoint_every
        .unwrap_or(scenario.checkpoint_every);
    let every = checkpoint_interval(Some(every))?;
    let threads = args.run.threads.map(usize::from).or(scenario.threads);
    in_pool(threads, |threads| {
        // All refusals come before the folder is touched.
        let run = Run::new(scenario)?;
        if args.check {
            check::report(&run, threads)?;
            return Ok(Outcome::Finished);
        }
        if !args.yes {
            check::refuse_too_many_steps(&run)?;
        }
        if !args.run.quiet {
            say_notes(&run.simulation().notes);
        }
        let part = Part {
            folder: run.scenario().out.clone(),
            quiet: args.run.quiet,
            stop: args.run.stop.clone(),
            every,
        };
        let _claim = folder::prepare(&part.folder, args.force)?;
        write_scene(&part.folder, run.scenario())?;
        part.to_end(run, Usage::default(), threads)
    })
}

/// Continues a run, under the scene in its folder if that has changed.
pub(crate) fn resume(args: &ResumeArgs) -> Result<Outcome> {
    let _claim = folder::claim(&args.folder)?;
    let (mut run, usage) = Run::read(&args.folder)?;
    let scene = folder_scene(&args.folder, &run)?;
    let every = args.run.checkpoint_every;
    let every = checkpoint_interval(Some(every.unwrap_or(scene.checkpoint_every)))?;
    let threads = args.run.threads.map(usize::from).or(scene.threads);
    in_pool(threads, |threads| {
        let changed = apply(&mut run, scene, args)?;
        if args.duration.is_some() {
            write_scene(&args.folder, run.scenario())?;
        }
        if !args.run.quiet {
            changed.iter().for_each(|line| say(line));
        }
        if run.ending().is_none() {
            folder::warn_of_old_results(&args.folder, false);
        }
        let part = Part {
            folder: args.folder.clone(),
            quiet: args.run.quiet,
            stop: args.run.stop.clone(),
            every,
        };
        part.to_end(run, usage, threads)
    })
}

/// The scene in the folder of a run; that of the checkpoint, if there is none.
fn folder_scene(folder: &Path, run: &Run) -> Result<Scenario> {
    let path = folder.join(SCENE);
    if path.is_file() {
        Ok(Scenario::read(&path)?)
    } else {
        Ok(run.scenario().clone())
    }
}

/// Goes on under a scene and the duration of the command line; returns what to say about it.
fn apply(run: &mut Run, mut scene: Scenario, args: &ResumeArgs) -> Result<Vec<String>> {
    let relaxed = run.relaxation().is_some();
    let time = run.simulation().world.time();
    if let Some(duration) = args.duration {
        run.check_duration(duration)?;
        scene.duration = duration;
    }
    let shown = args.folder.join(SCENE);
    let mut keys = run
        .apply(scene)
        .with_context(|| shown.display().to_string())?;
    let mut lines = Vec::new();
    if let (Some(duration), Some(at)) =
        (args.duration, keys.iter().position(|key| key == "duration"))
    {
        keys.remove(at);
        lines.push(format!("applied from --duration: {duration} s"));
    }
    if !keys.is_empty() {
        lines.push(format!("applied from {SCENE}: {}", keys.join(", ")));
    }
    if relaxed && run.relaxation().is_none() {
        lines.push(format!(
            "the motion goes on from the state of the relaxation, at {} s",
            output::short_number(time)
        ));
    }
    Ok(lines)
}

/// Name of the scene in the folder of a run.
pub(super) const SCENE: &str = "scene.toml";

fn write_scene(folder: &Path, scenario: &Scenario) -> Result<()> {
    let text = format!(
        "# The scene of this run, for `femdem run`.\n{}",
        scenario.to_toml()?
    );
    Ok(output::write_file(folder.join(SCENE), |w| {
        std::io::Write::write_all(w, text.as_bytes())
    })?)
}

/// One part of a run: from here to the end or to Ctrl-C.
struct Part {
    folder: PathBuf,
    stop: Option<Arc<AtomicBool>>,
    quiet: bool,
    every: Duration,
}

impl Part {
    fn to_end(&self, mut run: Run, before: Usage, threads: usize) -> Result<Outcome> {
        let interrupted = watch_for_interrupt(self.stop.as_ref())?;
        let done = run.ending().is_some();
        let meter = Meter::start(before, threads, done);
        // Written at once, so that a folder without write access is detected before the work.
        self.save(&mut run, &meter)?;
        if !done {
            folder::forget_other_jobs(&self.folder, folder::RUN_CHECKPOINT)?;
        }
        let clock = Clock::new(run.scenario().duration, run.simulation(), self.quiet)?;
        let advanced = self.advance(&mut run, &meter, &clock, &interrupted);
        clock.clear();
        if advanced.is_err() {
            // The rows up to the failure help to understand it; if they cannot be written, that is not a second
            // error.
            let _ = run.flush(&self.folder);
        }
        advanced.with_context(|| self.after_failure())?;

        if run.ending().is_none() {
            self.save(&mut run, &meter)?;
            let (time, duration) = (run.simulation().world.time(), run.scenario().duration);
            let place = if time > duration {
                format!("in the relaxation after {duration} s")
            } else {
                format!("at {} of {duration} s", output::short_number(time))
            };
            complain(&format!(
                "stopped {place}; continue with: femdem resume {}",
                self.folder.display()
            ));
            return Ok(Outcome::Interrupted);
        }
        if done && !self.quiet {
            say("the run was finished before; --duration S takes it further");
        }
        let summary = run.finish(&self.folder, &meter.read(run.simulation().world.counters()))?;
        self.save(&mut run, &meter)?;
        if !self.quiet {
            say(&format!(
                "{summary}  {:<20} {}",
                "results in",
                self.folder.display()
            ));
        }
        Ok(Outcome::Finished)
    }

    /// Advances to the end or to an interrupt, with checkpoints on the way.
    fn advance(
        &self,
        run: &mut Run,
        meter: &Meter,
        clock: &Clock,
        interrupted: &AtomicBool,
    ) -> Result<()> {
        // The bodies of another run rest against each other, as they did at its end.
        let of_pack = run.simulation().origin.bodies > 0;
        let continues = run.scenario().from.is_some() && !of_pack;
        let mut saved = Instant::now();
        let mut steps = 1;
        let mut told = run.warnings().len();
        while run.ending().is_none() && !interrupted.load(Ordering::Relaxed) {
            let began = Instant::now();
            let first = run.simulation().world.steps() == 0;
            let advanced = run.advance(&self.folder, steps);
            if first && !continues {
                // In particular if that step has failed.
                overlaps::warn(run.simulation(), |text| clock.note(text));
            }
            for text in &run.warnings()[told..] {
                clock.note(&format!("warning: {text}"));
            }
            told = run.warnings().len();
            advanced?;
            clock.show(run);
            // The run does not depend on how its steps are divided, so that the clock may be used here.
            steps = if began.elapsed() < BREATH {
                (steps * 2).min(1 << 16)
            } else {
                (steps / 2).max(1)
            };
            if saved.elapsed() >= self.every {
                // A full disk may have room again when the run ends; until then the last checkpoint remains.
                if let Err(error) = self.save(run, meter) {
                    clock.note(&format!("warning: {}", described(&error)));
                }
                saved = Instant::now();
            }
        }
        Ok(())
    }

    fn save(&self, run: &mut Run, meter: &Meter) -> Result<()> {
        run.flush(&self.folder)?;
        let usage = meter.read(run.simulation().world.counters());
        folder::save_run(&self.folder, run, &usage)
    }

    fn after_failure(&self) -> String {
        format!(
            "the run failed; the last good state is {}",
            self.folder.join(folder::RUN_CHECKPOINT).display()
        )
    }
}
