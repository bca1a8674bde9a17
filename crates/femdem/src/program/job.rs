//! Running a packing job to its end, or to Ctrl-C, and writing the results.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use femdem::pack::{PackError, Packing};
use femdem::{Scene, Summary, Usage, output, results};

use super::args::{PackArgs, ResumeArgs, RunArgs};
use super::meter::Meter;
use super::progress::Bar;
use super::running::{BREATH, Outcome, checkpoint_interval, in_pool, watch_for_interrupt};
use super::{check, complain, described, folder, say, say_notes};

pub(crate) fn pack(args: &PackArgs) -> Result<Outcome> {
    let scene = args.scene()?;
    if args.print_scene {
        say(scene.to_toml()?.trim_end());
        return Ok(Outcome::Finished);
    }
    let every = checkpoint_interval(Some(scene.checkpoint_every))?;
    in_pool(scene.threads, |threads| {
        // All refusals come before the folder is touched.
        let (packing, notes) = scene.packing()?;
        if args.check {
            say_notes(&notes);
            return check::pack(packing, threads).map(|()| Outcome::Finished);
        }
        if !args.run.quiet {
            say_notes(&notes);
        }
        let _claim = folder::prepare(&scene.out, args.force)?;
        write_scene(&scene)?;
        let run = Run {
            folder: scene.out.clone(),
            stop: args.run.stop.clone(),
            quiet: args.run.quiet,
            every,
            page: args.report,
        };
        run.to_end(packing, Usage::default(), threads)
    })
}

pub(crate) fn resume(args: &ResumeArgs) -> Result<Outcome> {
    if folder::holds_run(&args.folder) {
        if args.report {
            bail!("a run of a scene has no report: leave --report out");
        }
        return super::run::resume(args);
    }
    if !args.folder.join(folder::CHECKPOINT).is_file()
        && let Some(outcome) = super::stages::resume(args)?
    {
        return Ok(outcome);
    }
    if args.duration.is_some() {
        bail!("--duration is for a run of a scene, with its run.ckpt: leave it out");
    }
    if !args.folder.join(folder::CHECKPOINT).is_file() {
        bail!(
            "there is no {} and no {} in {}: give the folder of a run",
            folder::CHECKPOINT,
            folder::RUN_CHECKPOINT,
            args.folder.display()
        );
    }
    let RunArgs {
        threads,
        checkpoint_every,
        quiet,
        stop,
    } = args.run.clone();
    let every = checkpoint_interval(checkpoint_every)?;
    in_pool(threads.map(usize::from), |threads| {
        let _claim = folder::claim(&args.folder)?;
        let saved = folder::load(&args.folder)?;
        if !saved.packing.is_done() {
            folder::warn_of_old_results(&args.folder, args.report);
        }
        let run = Run {
            folder: args.folder.clone(),
            stop,
            quiet,
            every,
            page: args.report,
        };
        run.to_end(saved.packing, saved.usage, threads)
    })
}

fn write_scene(scene: &Scene) -> Result<()> {
    let text = scene.to_toml()?;
    Ok(output::write_file(scene.out.join("scene.toml"), |w| {
        std::io::Write::write_all(w, text.as_bytes())
    })?)
}

/// One part of a run: from here to the end or to Ctrl-C.
struct Run {
    folder: PathBuf,
    stop: Option<Arc<AtomicBool>>,
    quiet: bool,
    every: Duration,
    /// Whether the report page is written too.
    page: bool,
}

impl Run {
    fn to_end(&self, mut packing: Packing, before: Usage, threads: usize) -> Result<Outcome> {
        let interrupted = watch_for_interrupt(self.stop.as_ref())?;
        let meter = Meter::start(before, threads, packing.is_done());
        // Written at once, so that a folder without write access is detected before the work.
        folder::save(
            &self.folder,
            &packing,
            &meter.read(packing.world().counters()),
        )?;
        if !packing.is_done() {
            folder::forget_other_jobs(&self.folder, folder::CHECKPOINT)?;
        }
        let bar = Bar::new(&packing.progress(), self.quiet)?;
        let advanced = self.advance(&mut packing, &meter, &bar, &interrupted);
        bar.clear();
        advanced.with_context(|| self.after_failure())?;

        let usage = meter.read(packing.world().counters());
        folder::save(&self.folder, &packing, &usage)?;
        if !packing.is_done() {
            let at = packing.progress();
            complain(&format!(
                "stopped with {} of {} bodies placed; continue with: femdem resume {}{}",
                at.placed,
                at.count,
                self.folder.display(),
                if self.page { " --report" } else { "" }
            ));
            return Ok(Outcome::Interrupted);
        }
        let summary = results::write(&self.folder, &packing, &usage)?;
        if self.page {
            let snapshot = results::snapshot(&packing);
            super::report::write(
                &self.folder,
                &self.folder,
                &snapshot,
                Some((&packing, &usage)),
            )?;
        }
        report(&summary, &packing, &self.folder, self.quiet)?;
        Ok(Outcome::Finished)
    }

    /// Advances to the end or to an interrupt, with checkpoints on the way.
    fn advance(
        &self,
        packing: &mut Packing,
        meter: &Meter,
        bar: &Bar,
        interrupted: &AtomicBool,
    ) -> Result<(), PackError> {
        let mut saved = Instant::now();
        let mut steps = 1;
        while !packing.is_done() && !interrupted.load(Ordering::Relaxed) {
            let began = Instant::now();
            let progress = packing.advance(steps)?;
            bar.show(&progress);
            // The job does not depend on how its steps are divided, so that the clock may be used here.
            steps = if began.elapsed() < BREATH {
                (steps * 2).min(1 << 16)
            } else {
                (steps / 2).max(1)
            };
            if saved.elapsed() >= self.every {
                // A full disk may have room again when the job ends; until then the last checkpoint remains.
                if let Err(error) = folder::save(
                    &self.folder,
                    packing,
                    &meter.read(packing.world().counters()),
                ) {
                    bar.note(&format!("warning: {}", described(&error)));
                }
                saved = Instant::now();
            }
        }
        Ok(())
    }

    fn after_failure(&self) -> String {
        format!(
            "the run failed; the last good state is {}",
            self.folder.join(folder::CHECKPOINT).display()
        )
    }
}

/// Prints the summary, and the ratio of the step to its measured limit.
pub(crate) fn report(
    summary: &Summary,
    packing: &Packing,
    folder: &Path,
    quiet: bool,
) -> Result<()> {
    if quiet {
        return Ok(());
    }
    let mut text = summary.to_string();
    if let Some(stability) = packing.world().stability()? {
        text += &format!(
            "  {:<20} {:.2} of the measured limit, {:.2e} s\n",
            "time step",
            stability.used(),
            stability.limit
        );
    }
    say(&format!(
        "{text}  {:<20} {}",
        "results in",
        folder.display()
    ));
    Ok(())
}
