//! Packs over ranks, whose checkpoints are a file for each.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::fs;
use std::path::Path;

use femdem::pack::Packing;
use femdem::results::{self, PACK_CHECKPOINT, PackPart, SavedPack};
use femdem::solve::Halo;
use femdem::{Error, Scene, Usage};

use crate::common::{code, fails, femdem, run};
use crate::part_files::parts;
use crate::threads::Threads;

/// Steps after which the first ranks stop, and the next ones: bodies are still to come, and most are in.
const STOP: u64 = 300;
const NEXT: u64 = 1100;

/// Cubes that come in several batches into a box that is wider than their reach.
fn start() -> Packing {
    let scene = Scene {
        shape: vec!["P5".to_owned()],
        count: 14,
        r#box: Some("9x2".parse().unwrap()),
        penetration: Some(0.02),
        seed: 3,
        ..Scene::default()
    };
    scene.packing().unwrap().0
}

fn alone() -> Packing {
    let mut packing = start();
    packing.run().unwrap();
    packing
}

/// Goes on until so many steps are taken, or the pack is done, with a checkpoint then; returns the checksum of the motion.
fn finish(mut part: PackPart, folder: &Path, steps: u64, halo: &mut dyn Halo) -> u64 {
    let left = steps.saturating_sub(part.packing().world().steps());
    part.advance(left, halo).unwrap();
    part.save(folder, &Usage::default(), halo).unwrap();
    let motion = part.packing().world().checksum_of_motion_on(halo);
    motion.unwrap()
}

/// A pack that so many ranks begin.
fn stopped(folder: &Path, size: usize) {
    Threads::each(size, |halo| {
        let part = PackPart::share_out(start(), halo).unwrap();
        finish(part, folder, STOP, halo)
    });
}

/// The same on from its checkpoint, by so many ranks.
fn resumed(folder: &Path, steps: u64, size: usize) -> u64 {
    let motions = Threads::each(size, |halo| {
        let (part, usage) = PackPart::resume(folder, halo).unwrap();
        assert_eq!(usage.is_some(), halo.rank() == 0);
        finish(part, folder, steps, halo)
    });
    motions[0]
}

fn read(folder: &Path) -> Packing {
    SavedPack::read(folder).unwrap().packing
}

fn assert_same(folder: &Path, expected: &Packing) {
    let packing = read(folder);
    assert!(packing.is_done() && !packing.world().is_shared());
    assert_eq!(packing.report().unwrap(), expected.report().unwrap());
    assert_eq!(packing.progress(), expected.progress());
    let [own, other] = [&packing, expected].map(|p| p.world().checksum_of_motion().unwrap());
    assert_eq!(own, other);
}

#[test]
fn a_pack_of_ranks_is_read_by_one_process_and_by_any_ranks() {
    let expected = alone();
    let motion = expected.world().checksum_of_motion().unwrap();
    let folders = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let [path, copy, other] = folders.each_ref().map(|folder| folder.path());
    stopped(path, 4);
    assert_eq!(parts(path), ["1-1.ckpt", "1-2.ckpt", "1-3.ckpt"]);
    fs::create_dir(copy.join("parts")).unwrap();
    for part in parts(path) {
        let part = Path::new("parts").join(part);
        fs::copy(path.join(&part), copy.join(part)).unwrap();
    }
    fs::copy(path.join(PACK_CHECKPOINT), copy.join(PACK_CHECKPOINT)).unwrap();
    let at = read(path).progress();
    assert!(at.steps == STOP && at.placed < at.count, "{at:?}");

    // By fewer ranks, by more, and to the end.
    resumed(path, NEXT, 3);
    assert_eq!(parts(path), ["2-1.ckpt", "2-2.ckpt"]);
    resumed(path, NEXT + 100, 4);
    assert_eq!(resumed(path, u64::MAX, 2), motion);
    assert_eq!(parts(path), ["4-1.ckpt"]);
    assert_same(path, &expected);

    // By the program, which reads them, makes one file of all, and goes on.
    results::save(other, &read(copy), &Usage::default()).unwrap();
    let measured = [copy, other].map(|folder| {
        let made = run(femdem("analyse")
            .args(["-q", "--out"])
            .arg(folder)
            .arg(folder));
        let drawn = run(femdem("picture")
            .arg(folder)
            .arg("--out")
            .arg(folder.join("x.png")));
        assert_eq!((code(&made), code(&drawn)), (0, 0), "{made:?} {drawn:?}");
        ["analysis.json", "x.png"].map(|name| fs::read(folder.join(name)).unwrap())
    });
    assert!(measured[0] == measured[1]);
    let ended = run(femdem("resume").arg(copy).args(["-q", "--report"]));
    assert_eq!(code(&ended), 0, "{ended:?}");
    assert!(!copy.join("parts").exists() && copy.join("summary.json").is_file());
    assert_same(copy, &expected);

    // What one process has written, by ranks.
    assert_eq!(resumed(other, u64::MAX, 3), motion);
    assert_same(other, &expected);
}

#[test]
fn parts_of_a_pack_that_do_not_belong_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    stopped(path, 3);
    let second = path.join("parts/1-2.ckpt");
    let good = fs::read(&second).unwrap();
    let mut altered = good.clone();
    *altered.last_mut().unwrap() ^= 1;
    for (bytes, why) in [
        (None, "cannot read"),
        (Some(&altered), "bytes were altered"),
        (
            Some(&fs::read(path.join("parts/1-1.ckpt")).unwrap()),
            "of another checkpoint",
        ),
    ] {
        match bytes {
            Some(bytes) => fs::write(&second, bytes).unwrap(),
            None => fs::remove_file(&second).unwrap(),
        }
        let refused = SavedPack::read(path).err().unwrap().to_string();
        assert!(
            refused.contains("1-2.ckpt") && refused.contains(why),
            "{refused}"
        );
        for refused in Threads::each(2, |halo| PackPart::resume(path, halo).err().unwrap()) {
            let refused = refused.to_string();
            assert!(
                refused.contains("1-2.ckpt") && refused.contains(why),
                "{refused}"
            );
        }
        for command in ["resume", "report", "analyse"] {
            fails(femdem(command).arg(path), &["1-2.ckpt", why]);
        }
        fails(
            femdem("picture")
                .arg(path)
                .arg("--out")
                .arg(path.join("x.png")),
            &["1-2.ckpt", why],
        );
    }
    fs::write(&second, good).unwrap();
    assert_eq!(read(path).progress().steps, STOP);
    fs::remove_file(path.join(PACK_CHECKPOINT)).unwrap();
    for refused in Threads::each(2, |halo| PackPart::resume(path, halo).err().unwrap()) {
        assert!(refused.to_string().contains(PACK_CHECKPOINT), "{refused}");
    }
}

/// A folder in the place of the file that is written first: of the part of one rank, or of the pack.
#[test]
fn a_pack_that_one_rank_cannot_write_leaves_the_old_checkpoint() {
    let expected = alone();
    for (blocked, stays) in [
        (
            "parts/2-1.ckpt.tmp",
            vec!["1-1.ckpt", "1-2.ckpt", "2-1.ckpt.tmp", "x-1.ckpt"],
        ),
        (
            "pack.ckpt.tmp",
            vec!["1-1.ckpt", "1-2.ckpt", "2-1.ckpt", "2-2.ckpt", "x-1.ckpt"],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        stopped(path, 3);
        fs::create_dir(path.join(blocked)).unwrap();
        // Of the user.
        fs::write(path.join("parts/x-1.ckpt"), "x").unwrap();
        let errors = Threads::each(3, |halo| {
            let (mut part, _) = PackPart::resume(path, halo).unwrap();
            part.advance(7, halo).unwrap();
            let mut save = || part.save(path, &Usage::default(), halo).unwrap_err();
            // Whose parts the next try writes over.
            let _: Error = save();
            save().to_string()
        });
        let name = blocked.rsplit('/').next().unwrap();
        for error in errors {
            assert!(
                error.contains("cannot create") && error.contains(name),
                "{error}"
            );
        }
        assert_eq!(parts(path), stays);
        assert_eq!(read(path).progress().steps, STOP);
        fs::remove_dir(path.join(blocked)).unwrap();
        resumed(path, u64::MAX, 2);
        assert_eq!(parts(path), ["2-1.ckpt", "x-1.ckpt"]);
        assert_same(path, &expected);
    }
}
