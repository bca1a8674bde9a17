//! The folder of a run and the checkpoint in it.

use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use femdem::Usage;
use femdem::pack::Packing;
use femdem::results;
use femdem::run::Run;
use femdem::saved::forget_parts;

pub(crate) use femdem::results::{PACK_CHECKPOINT as CHECKPOINT, SavedPack as Saved};
pub(crate) use femdem::run::RUN_CHECKPOINT;

/// Keeps other jobs out of a folder for as long as it lives.
#[must_use]
pub struct Claim {
    _lock: Option<File>,
}

/// Claims a folder for a job that writes into it.
pub(crate) fn claim(folder: &Path) -> Result<Claim> {
    // Where folders cannot be opened or locked, other jobs cannot be detected.
    let handle = File::open(folder).ok();
    if let Some(Err(TryLockError::WouldBlock)) = handle.as_ref().map(File::try_lock) {
        bail!(
            "another femdem writes into the folder {}: wait until it has ended, or stop it first",
            folder.display()
        );
    }
    Ok(Claim { _lock: handle })
}

/// Creates the folder, or checks that an existing one is empty; `force` allows files in it. Claims it.
pub(crate) fn prepare(folder: &Path, force: bool) -> Result<Claim> {
    let shown = folder.display();
    fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder {shown}; give another with --out"))?;
    let claim = claim(folder)?;
    let mut entries =
        fs::read_dir(folder).with_context(|| format!("cannot look into the folder {shown}"))?;
    if !force && entries.next().is_some() {
        bail!(
            "the folder {shown} is not empty: give another with --out, or add --force to replace \
             files in it"
        );
    }
    Ok(claim)
}

/// Name of the results in numbers.
pub(super) const SUMMARY: &str = "summary.json";

/// Removes files of an earlier job in the folder that could be taken for those of the present, unfinished one:
/// the results in numbers, and the checkpoint of the other kind, with its parts.
pub(crate) fn forget_other_jobs(folder: &Path, own: &str) -> Result<()> {
    for name in [CHECKPOINT, RUN_CHECKPOINT, SUMMARY] {
        let path = folder.join(name);
        if name != own && path.is_file() {
            fs::remove_file(&path)
                .with_context(|| format!("cannot remove {}, of an earlier job", path.display()))?;
            if name != SUMMARY {
                forget_parts(folder, &[]);
            }
        }
    }
    Ok(())
}

/// Names the results in a folder that show the bodies as they were before the job goes on.
pub(crate) fn warn_of_old_results(folder: &Path, page_follows: bool) {
    let kept = |name: &str| {
        let is_made_anew = page_follows && name == "report.html";
        folder.join(name).exists() && !is_made_anew
    };
    let mut old = vec!["analysis.json", "resolved", "stresses", "report.html"];
    old.retain(|name| kept(name));
    if !old.is_empty() {
        super::complain(&format!(
            "{} in {} stay as they are, of the state so far: make them again after this",
            old.join(", "),
            folder.display()
        ));
    }
}

fn checkpoint_path(folder: &Path) -> PathBuf {
    folder.join(CHECKPOINT)
}

pub(crate) fn save(folder: &Path, packing: &Packing, usage: &Usage) -> Result<()> {
    results::save(folder, packing, usage)
        .context("the checkpoint was not written; an earlier one is kept")
}

pub(crate) fn has_checkpoint(folder: &Path) -> bool {
    checkpoint_path(folder).is_file()
}

pub(crate) fn load(folder: &Path) -> Result<Saved> {
    let path = checkpoint_path(folder);
    if !path.is_file() {
        bail!(
            "there is no {}: give the folder of a run of `femdem pack`",
            path.display()
        );
    }
    Ok(Saved::read(folder)?)
}

/// Whether a folder is that of a run of `femdem run`.
pub(crate) fn holds_run(folder: &Path) -> bool {
    folder.join(RUN_CHECKPOINT).is_file()
}

pub(crate) fn save_run(folder: &Path, run: &Run, usage: &Usage) -> Result<()> {
    run.save(folder, usage)
        .context("the checkpoint was not written; an earlier one is kept")
}
