//! Checkpoints over ranks, a file for each: whole, or the one before.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::fs;
use std::path::Path;

use femdem::run::{Part, RUN_CHECKPOINT, Run};
use femdem::solve::Halo;

use crate::run_ranks::{STONES, alone, result, resumed, save, stopped};
use crate::threads::Threads;

/// Stones that fall and slide, for a while.
fn scene() -> String {
    STONES.replace("duration = 3", "duration = 0.2")
}

/// Names of the files of the parts, ascending.
pub fn parts(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder.join("parts")).into_iter().flatten();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

#[test]
fn a_checkpoint_of_ranks_is_read_by_one_process_and_by_any_ranks() {
    let text = scene();
    let expected = alone(&text);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    stopped(&text, path, 150, 3);
    assert_eq!(parts(path), ["1-1.ckpt", "1-2.ckpt"]);
    let copy = tempfile::tempdir().unwrap();
    for name in ["run.ckpt", "parts/1-1.ckpt", "parts/1-2.ckpt"] {
        fs::create_dir_all(copy.path().join("parts")).unwrap();
        fs::copy(path.join(name), copy.path().join(name)).unwrap();
    }
    let read = Run::read(path).unwrap().0;
    assert_eq!(read.simulation().world.steps(), 150);
    assert_eq!(read.simulation().world.body_count(), 28);
    // More ranks than parts; they write parts of their own.
    let mut last = resumed(path, 4);
    assert_eq!(parts(path), ["2-1.ckpt", "2-2.ckpt", "2-3.ckpt"]);
    assert!(result(&mut last, path) == expected);
    let [ended, whole] = [Run::read(path).unwrap().0, last].map(|run| {
        let world = &run.simulation().world;
        (run.ending(), world.checksum_of_motion().unwrap())
    });
    assert_eq!(ended, whole);

    let (run, usage) = Run::read(copy.path()).unwrap();
    run.save(copy.path(), &usage).unwrap();
    assert!(parts(copy.path()).is_empty() && !copy.path().join("parts").exists());
    let (mut run, _) = Run::read(copy.path()).unwrap();
    run.advance(copy.path(), u64::MAX).unwrap();
    assert_eq!(
        run.simulation().world.checksum_of_motion().unwrap(),
        whole.1
    );
}

#[test]
fn parts_that_do_not_belong_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    stopped(&scene(), path, 20, 3);
    let [first, second] = ["1-1.ckpt", "1-2.ckpt"].map(|name| path.join("parts").join(name));
    let good = fs::read(&second).unwrap();
    let version = |add: u8| {
        let mut bytes = good.clone();
        bytes[8] = bytes[8].wrapping_add(add);
        bytes
    };
    let mut altered = good.clone();
    let last = altered.len() - 1;
    altered[last] ^= 1;
    let damages = [
        (None, "cannot read"),
        (Some(good[..last].to_vec()), "cut short"),
        (Some(altered), "bytes were altered"),
        (Some(version(1)), "it is of version"),
        (Some(version(255)), "it is of version"),
        (Some(fs::read(&first).unwrap()), "of another checkpoint"),
        (
            Some(fs::read(path.join(RUN_CHECKPOINT)).unwrap()),
            "it holds a \"run\"",
        ),
    ];
    for (bytes, why) in damages {
        match bytes {
            Some(bytes) => fs::write(&second, bytes).unwrap(),
            None => fs::remove_file(&second).unwrap(),
        }
        let refused = Run::read(path).unwrap_err().to_string();
        let named = |error: &str| error.contains("1-2.ckpt") && error.contains(why);
        assert!(named(&refused), "{refused}");
        for error in Threads::each(2, |halo| Part::resume(path, halo).err().unwrap()) {
            assert!(named(&error.to_string()), "{error}");
        }
    }
    fs::write(&second, &good).unwrap();
    assert!(Run::read(path).is_ok());
    fs::remove_file(path.join(RUN_CHECKPOINT)).unwrap();
    for error in Threads::each(2, |halo| Part::resume(path, halo).err().unwrap()) {
        assert!(error.to_string().contains(RUN_CHECKPOINT), "{error}");
    }
}

/// A folder in the place of the file that is written first: of the part of one rank, or of the run.
#[test]
fn a_checkpoint_that_one_rank_cannot_write_leaves_the_old_one() {
    let text = scene();
    let expected = alone(&text);
    for (blocked, stays) in [
        (
            "parts/2-1.ckpt.tmp",
            vec!["1-1.ckpt", "1-2.ckpt", "2-1.ckpt.tmp"],
        ),
        (
            "run.ckpt.tmp",
            vec!["1-1.ckpt", "1-2.ckpt", "2-1.ckpt", "2-2.ckpt"],
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        stopped(&text, path, 100, 3);
        fs::create_dir(path.join(blocked)).unwrap();
        let errors = Threads::each(3, |halo| {
            let (mut part, read) = Part::resume(path, halo).unwrap();
            let mut run = read.map(|(run, _)| run);
            for _ in 0..7 {
                part.step(halo).unwrap();
            }
            // Whose parts the next try writes over.
            save(&mut part, run.as_mut(), path, halo).unwrap_err();
            let error = save(&mut part, run.as_mut(), path, halo).unwrap_err();
            assert_eq!(part.world().steps(), 107);
            error.to_string()
        });
        let name = blocked.rsplit('/').next().unwrap();
        for error in errors {
            assert!(
                error.contains("cannot create") && error.contains(name),
                "{error}"
            );
        }
        assert_eq!(parts(path), stays);
        assert_eq!(Run::read(path).unwrap().0.simulation().world.steps(), 100);
        fs::remove_dir(path.join(blocked)).unwrap();
        let mut last = resumed(path, 2);
        assert!(result(&mut last, path) == expected);
        assert_eq!(parts(path), ["2-1.ckpt"]);
    }
}

/// A folder in the place of a file of the next frame.
#[test]
fn a_frame_that_cannot_be_written_is_the_error_of_all_ranks() {
    let text = scene();
    let expected = alone(&text);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    stopped(&text, path, 20, 3);
    for kind in ["rigid", "contacts"] {
        let frames = fs::read_dir(path.join("frames")).unwrap();
        let mut names = frames.map(|file| file.unwrap().file_name().into_string().unwrap());
        let first = names.find(|name| name.starts_with(kind)).unwrap();
        let blocked = first.replace("0.vt", "1.vt");
        assert_ne!(first, blocked);
        fs::create_dir(path.join("frames").join(&blocked)).unwrap();
        let errors = Threads::each(3, |halo| {
            let (mut part, read) = Part::resume(path, halo).unwrap();
            let mut run = read.map(|(run, _)| run);
            loop {
                part.step(halo).unwrap();
                let mut due = [run.as_ref().map_or(f64::INFINITY, Run::next_due)];
                halo.least(&mut due).unwrap();
                if part.world().time() >= due[0]
                    && let Err(error) = part.go_on(run.as_mut(), path, halo)
                {
                    return error.to_string();
                }
                assert!(part.world().time() < 0.06);
            }
        });
        for error in errors {
            assert!(error.contains(&blocked), "{error}");
        }
        fs::remove_dir(path.join("frames").join(&blocked)).unwrap();
    }
    let mut last = resumed(path, 2);
    assert!(result(&mut last, path) == expected);
}

/// The first rank must see the parts that it names.
#[test]
fn a_folder_that_is_not_one_for_all_ranks_is_noticed_before_the_checkpoint_is() {
    let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let path = folders[0].path();
    stopped(&scene(), path, 20, 2);
    let tries = |cut: bool| {
        let errors = Threads::each(2, |halo| {
            let (mut part, read) = Part::resume(path, halo).unwrap();
            let mut run = read.map(|(run, _)| run);
            let own = folders[halo.rank()].path();
            let error = save(&mut part, run.as_mut(), own, halo).unwrap_err();
            error.to_string()
        });
        for error in errors {
            let why = if cut { "finds 3:" } else { "must see" };
            assert!(error.contains("2-1.ckpt") && error.contains(why), "{error}");
        }
        assert_eq!(Run::read(path).unwrap().0.simulation().world.steps(), 20);
    };
    tries(false);
    fs::write(path.join("parts/2-1.ckpt"), "old").unwrap();
    tries(true);
}

#[test]
fn files_of_the_user_among_the_parts_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let foreign = ["1-1.stl", "1-a.ckpt", "a.ckpt", "-1.ckpt"];
    let of_others = ["7-2.ckpt", "7-3.ckpt.tmp"];
    fs::create_dir(path.join("parts")).unwrap();
    for name in foreign.iter().chain(&of_others) {
        fs::write(path.join("parts").join(name), "x").unwrap();
    }
    stopped(&scene(), path, 20, 2);
    assert_eq!(
        parts(path),
        ["-1.ckpt", "1-1.ckpt", "1-1.stl", "1-a.ckpt", "a.ckpt"]
    );
    let (run, usage) = Run::read(path).unwrap();
    run.save(path, &usage).unwrap();
    assert_eq!(parts(path), ["-1.ckpt", "1-1.stl", "1-a.ckpt", "a.ckpt"]);

    // A folder elsewhere.
    #[cfg(unix)]
    {
        let (elsewhere, linked) = (path.join("parts"), tempfile::tempdir().unwrap());
        fs::write(elsewhere.join("7-2.ckpt"), "x").unwrap();
        std::os::unix::fs::symlink(&elsewhere, linked.path().join("parts")).unwrap();
        run.save(linked.path(), &usage).unwrap();
        assert!(parts(path).contains(&"7-2.ckpt".to_owned()));
    }
}
