//! Scenes of several stages, one run after another.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use femdem::output;
use femdem::run::{Run, Stage};

use super::args::{ResumeArgs, RunArgs};
use super::run::{SCENE, SceneArgs, resume as resume_run, run as run_whole, run_scenario};
use super::running::{Outcome, in_pool};
use super::{folder, say};

/// Runs a scene: all its stages, if it has any.
pub(crate) fn run(args: &SceneArgs) -> Result<Outcome> {
    let stages = Stage::read(&args.scene, args.out.as_deref())?;
    if stages.is_empty() {
        run_whole(args)
    } else {
        run_stages(args, &stages)
    }
}

/// Runs the stages of a scene, and keeps the scene in the folder that holds theirs.
fn run_stages(args: &SceneArgs, stages: &[Stage]) -> Result<Outcome> {
    let threads = args.run.threads.map(usize::from);
    in_pool(threads, |_| refuse_others(stages))?;
    if !args.check {
        let out = folder_of(stages);
        let text = fs::read(&args.scene)
            .with_context(|| format!("cannot read {}", args.scene.display()))?;
        // Only to refuse a folder that holds something: the stages claim theirs.
        drop(folder::prepare(&out, args.force)?);
        // What earlier stages left would count as finished.
        let own = stages.iter().map(|stage| stage.scenario.out.as_path());
        for folder in own.chain([out.as_path()]) {
            folder::forget_other_jobs(folder, "")?;
        }
        output::write_file(out.join(SCENE), |w| std::io::Write::write_all(w, &text))?;
    }
    for (k, stage) in stages.iter().enumerate() {
        announce(k, stages.len(), stage, args.run.quiet);
        if run_scenario(args, stage.scenario.clone())? == Outcome::Interrupted {
            return Ok(Outcome::Interrupted);
        }
        if args.check {
            if stages.len() > 1 {
                say(
                    "the other stages start from the end of this one: their cost is known when it is there",
                );
            }
            break;
        }
    }
    Ok(Outcome::Finished)
}

/// Refuses stages that cannot start after the one before: tried from the beginning of the first, before anything has run.
fn refuse_others(stages: &[Stage]) -> Result<()> {
    let Some((first, others)) = stages
        .split_first()
        .filter(|(_, others)| !others.is_empty())
    else {
        return Ok(());
    };
    let mut run = Run::new(first.scenario.clone())?;
    let mut brings = false;
    for stage in others {
        // Bodies that sources bring are not there yet, so that only what never changes can be compared.
        brings |= !run.scenario().source.is_empty();
        match run.followed_by(&stage.scenario) {
            Ok(next) => run = next,
            Err(error) if brings && !matches!(error, femdem::Error::Fixed { .. }) => {}
            Err(error) => return Err(error).with_context(|| format!("stage {}", stage.name)),
        }
    }
    Ok(())
}

/// Goes on with the first stage that is not finished; `None` if the folder holds none.
pub(super) fn resume(args: &ResumeArgs) -> Result<Option<Outcome>> {
    let scene = args.folder.join(SCENE);
    if !scene.is_file() {
        return Ok(None);
    }
    let stages = Stage::read(&scene, Some(&args.folder))?;
    if stages.is_empty() {
        return Ok(None);
    }
    if args.duration.is_some() {
        anyhow::bail!(
            "--duration is for one run, and {} holds several stages: give the folder of one of them",
            args.folder.display()
        );
    }
    if args.report {
        anyhow::bail!("a run of a scene has no report: leave --report out");
    }
    if !args.run.quiet
        && stages
            .iter()
            .all(|s| s.scenario.out.join(folder::SUMMARY).is_file())
    {
        say(&format!(
            "all stages in {} are finished",
            args.folder.display()
        ));
    }
    // Stages after one that goes on start from its new end.
    let mut went_on = false;
    for (k, stage) in stages.iter().enumerate() {
        let own = &stage.scenario.out;
        if !went_on && own.join(folder::SUMMARY).is_file() {
            continue;
        }
        announce(k, stages.len(), stage, args.run.quiet);
        let outcome = if !went_on && folder::holds_run(own) {
            resume_run(&ResumeArgs {
                folder: own.clone(),
                duration: None,
                report: false,
                run: args.run.clone(),
            })?
        } else {
            let fresh = SceneArgs {
                scene: scene.clone(),
                out: None,
                force: true,
                check: false,
                yes: true,
                run: RunArgs::clone(&args.run),
            };
            run_scenario(&fresh, stage.scenario.clone())?
        };
        went_on = true;
        if outcome == Outcome::Interrupted {
            return Ok(Some(Outcome::Interrupted));
        }
    }
    Ok(Some(Outcome::Finished))
}

/// Refuses the folder of a scene of several stages where that of one run is wanted, and names theirs.
pub(super) fn refuse_folder_of_stages(folder: &Path) -> Result<()> {
    let scene = folder.join(SCENE);
    let stages = Stage::read(&scene, Some(folder)).unwrap_or_default();
    let there = stages.iter().map(|stage| &stage.scenario.out);
    let there = there.filter(|own| folder::holds_run(own));
    let there: Vec<String> = there.map(|own| own.display().to_string()).collect();
    if stages.is_empty() {
        return Ok(());
    }
    let advice = match there.is_empty() {
        true => "none of them has begun".to_owned(),
        false => format!("give one of {}", there.join(", ")),
    };
    anyhow::bail!(
        "{} holds the stages of a scene, each in a folder of its own: {advice}",
        folder.display()
    );
}

fn announce(k: usize, count: usize, stage: &Stage, quiet: bool) {
    if !quiet {
        say(&format!("stage {} of {count}: {}", k + 1, stage.name));
    }
}

/// The folder that holds those of the stages.
fn folder_of(stages: &[Stage]) -> PathBuf {
    let first = stages.first().and_then(|stage| stage.scenario.out.parent());
    first.unwrap_or(Path::new("")).to_path_buf()
}
