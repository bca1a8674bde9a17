//! The folder of a job, which the first rank claims.

use anyhow::{Context, Error, Result, ensure};
use femdem::program::{self, Claim};
use femdem::solve::Halo;
use femdem_mpi::MpiHalo;
use std::fs;
use std::path::Path;

/// What the first rank makes. If it cannot, all ranks get its error.
pub(crate) fn of_first<T>(
    halo: &mut MpiHalo,
    make: impl FnOnce() -> Result<T>,
) -> Result<Option<T>> {
    let made = (halo.rank() == 0).then(make).transpose();
    let why = made.as_ref().err().map(|error| format!("{error:#}"));
    let mut messages = Vec::new();
    if let Some(why) = why {
        messages.extend((1..halo.size()).map(|rank| (rank, why.clone().into_bytes())));
    }
    match halo.send(messages)?.first() {
        Some((_, why)) => Err(Error::msg(String::from_utf8_lossy(why).into_owned())),
        None => made,
    }
}

/// Keeps other jobs out of a folder.
pub(crate) fn claim(folder: &Path) -> Result<Claim> {
    program::claim(folder).map_err(Error::msg)
}

/// Makes the folder of a new job, with its scene in it, and claims it.
pub(crate) fn make(folder: &Path, scene: &str) -> Result<Claim> {
    let shown = folder.display();
    fs::create_dir_all(folder).with_context(|| format!("cannot make {shown}"))?;
    let claim = claim(folder)?;
    let mut files = fs::read_dir(folder).with_context(|| format!("cannot read {shown}"))?;
    ensure!(
        files.next().is_none(),
        "{shown} holds files: name another folder by --out"
    );
    fs::write(folder.join("scene.toml"), scene)
        .with_context(|| format!("cannot write into {shown}"))?;
    Ok(claim)
}
