//! `femdem pores`: the void space of a pack, for flow codes.

mod args;
mod flow;
mod image;
mod space;
mod summary;

use std::fs;

use anyhow::{Context, Result};
use femdem::analysis::pores::Solids;
use femdem::output::write_file;

pub(crate) use args::{HELP, PoresArgs};

use super::running::{Outcome, in_pool};
use super::say;
use space::Space;

/// Folder of the results within that of the pack.
const FOLDER: &str = "pores";

/// Name of the results in numbers.
const JSON: &str = "pores.json";

pub(crate) fn run(args: &PoresArgs) -> Result<Outcome> {
    in_pool(args.work.threads.map(usize::from), |_| {
        let read = space::read(args)?;
        let near = read.images(args, read.diameter)?;
        let space = Space::new(args, &read, &near.pack(&read.shapes)?)?;
        let images = read.images(args, space.reach(&read, &near)?)?;
        let pack = images.pack(&read.shapes)?;
        let solids = Solids::new(&pack).with_balls(&read.balls)?;
        let out = args.out.clone();
        let out = out.unwrap_or_else(|| read.folder.join(FOLDER));
        let tell = |text: &dyn std::fmt::Display| {
            if !args.work.quiet {
                say(&text.to_string());
            }
        };
        if let Some(lead) = &read.lead {
            tell(lead);
        }
        let (voxels, fields) = image::measure(&space, &solids)?;
        tell(&voxels);
        // Options that cannot be met are refused before any file is written.
        let flow = match &space.treatment {
            Some(treated) => Some(flow::make(
                &space,
                &solids,
                treated,
                &read.snapshot,
                &fields,
            )?),
            None => None,
        };
        fs::create_dir_all(&out)
            .with_context(|| format!("cannot make the folder {}", out.display()))?;
        image::write(&out, &fields)?;
        let flow = flow.map(|made| made.write(&out, &space)).transpose()?;
        if let Some(written) = &flow {
            tell(written);
        }
        let summary = summary::Summary::new(&space, &read, voxels, flow);
        write_file(out.join(JSON), |w| {
            serde_json::to_writer_pretty(&mut *w, &summary)?;
            std::io::Write::write_all(w, b"\n")
        })?;
        tell(&format!("  {:<20} {}", "results in", out.display()));
        Ok(Outcome::Finished)
    })
}
