//! Bad input: each a clear error, an exit code that is not 0, and nothing lost.

use crate::common::{TINY, WEDGE, code, fails, femdem, run};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

#[test]
fn bad_options_say_what_is_allowed_and_leave_no_folder() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    for (options, words) in [
        (&["--count", "0"][..], &["count = 0", "at least 1"][..]),
        (
            &["--count", "4000000000"],
            &["count = 4000000000", "100,000,000"],
        ),
        (&["--count", "-3"], &["--count", "-3"]),
        (&["--unit", "mm"], &["unit = millimetres", "surface files"]),
        (&["--repair"], &["repair = true", "surface files"]),
        (&["--mesh-size", "0.1"], &["mesh-size = 0.1", "not convex"]),
        (
            &["--container", "silo", "--cylinder", "2.5"],
            &["cylinder = 2.5000 d", "wider than the outlet", "3 d"],
        ),
        (&["--count", "many"], &["--count", "many"]),
        (&["--diameter", "NaN"], &["diameter", "NaN"]),
        (&["--diameter", "-0.05"], &["diameter", "-0.05"]),
        (&["--diameter", "0"], &["diameter", "0"]),
        (&["--diameter", "20km"], &["--diameter", "20mm"]),
        (&["--density", "-1"], &["density = -1"]),
        (&["--density", "inf"], &["density = inf"]),
        (&["--friction", "-0.1"], &["friction = -0.1", "at least 0"]),
        (&["--friction", "nan"], &["friction = NaN"]),
        (
            &["--wall-friction", "-0.1"],
            &["wall-friction = -0.1", "at least 0"],
        ),
        (
            &["--tangential-ratio", "0"],
            &["tangential-ratio = 0", "above 0 and at most 2"],
        ),
        (
            &["--damping", "0.9"],
            &["error: damping = 0.9", "below 0.7071"],
        ),
        (&["--penalty", "0"], &["penalty = 0"]),
        (&["--penetration", "2"], &["penetration = 2"]),
        (&["--gravity", "0"], &["gravity = 0"]),
        (&["--drag", "-1/s"], &["drag = -1/s", "sqrt(g/d)"]),
        (&["--drag", "0.6"], &["drag = 0.6", "0.6/fall", "8.4/s"]),
        (&["--friction", "inf"], &["friction = inf", "finite"]),
        (
            &["--wall-friction", "inf"],
            &["wall-friction = inf", "finite"],
        ),
        (
            &["--container", "box", "--cylinder", "5"],
            &["cylinder = 5 beside container = box"],
        ),
        (
            &["--protocol", "release", "--batch", "2"],
            &["batch = 2", "release"],
        ),
        (&["--rate", "50"], &["rate = 50", "pour"]),
        (&["--height", "1m"], &["height = 1m", "pour"]),
        (&["--local-damping", "1"], &["local-damping = 1", "below 1"]),
        (&["--implicit=0"], &["error: implicit = 0", "9 is usual"]),
        (&["--implicit=NaN"], &["error: implicit = NaN"]),
        (
            &["--implicit", "--local-damping", "0.6"],
            &["--implicit", "--local-damping", "cannot be used"],
        ),
        (&["--box", "0.9x4"], &["box = 0.9x4", "metres are meant"]),
        (
            &["--cylinder", "0.5"],
            &["cylinder = 0.5", "metres are meant"],
        ),
        (&["--box", "6"], &["--box", "6x6"]),
        (&["--box", "NaNx6"], &["--box", "6x6"]),
        (&["--batch", "0"], &["batch = 0"]),
        (&["--protocol", "pour", "--rate", "0"], &["rate = 0"]),
        (&["--protocol", "rain"], &["sequential", "pour", "release"]),
        (&["--container", "sphere"], &["box", "cylinder"]),
        (&["--shape", "A14"], &["A14", "A13"]),
        (&["--shape", "missing.obj"], &["missing.obj"]),
        (&["--threads", "0"], &["--threads", "1.."]),
        (&["--checkpoint-every", "-1"], &["checkpoint-every = -1"]),
        (
            &["--penalty", "1e6", "--penetration", "0.01"],
            &["cannot be used with"],
        ),
        (&["--dencity", "1"], &["--dencity", "--density"]),
    ] {
        fails(femdem("pack").args(options).arg("--out").arg(&out), words);
        assert!(!out.exists(), "{options:?}");
    }
}

#[test]
fn a_folder_that_is_not_empty_needs_force() {
    let folder = tempdir().unwrap();
    let note = folder.path().join("note.txt");
    fs::write(&note, "keep").unwrap();
    fails(
        femdem("pack").args(TINY).arg("--out").arg(folder.path()),
        &["not empty", "--force", "--out"],
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let forced = run(femdem("pack")
        .args(TINY)
        .arg("--force")
        .arg("--out")
        .arg(folder.path()));
    assert_eq!(code(&forced), 0, "{forced:?}");
    assert_eq!(fs::read_to_string(&note).unwrap(), "keep");
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    fails(
        femdem("pack").args(TINY).arg("--out").arg(file.join("out")),
        &["cannot make the folder", "out"],
    );
    fails(
        femdem("pack").args(TINY).arg("--out").arg(&file),
        &["cannot", "file"],
    );
}

/// A device that takes no bytes stands for a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_and_the_old_checkpoint_stays() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    assert_eq!(
        code(&run(femdem("pack").args(TINY).arg("--out").arg(&out))),
        0
    );
    let checkpoint = fs::read(out.join("pack.ckpt")).unwrap();
    std::os::unix::fs::symlink("/dev/full", out.join("bodies.csv.partial")).unwrap();
    fails(
        femdem("analyse").arg(&out),
        &["bodies.csv", "No space left"],
    );
    assert_eq!(fs::read(out.join("pack.ckpt")).unwrap(), checkpoint);
    assert!(out.join("bodies.csv").is_file());
}

#[test]
fn damaged_and_missing_checkpoints_are_refused() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    assert_eq!(
        code(&run(femdem("pack").args(TINY).arg("--out").arg(&out))),
        0
    );
    let path = out.join("pack.ckpt");
    let good = fs::read(&path).unwrap();
    let refused = |bytes: &[u8], words: &[&str]| {
        fs::write(&path, bytes).unwrap();
        for command in ["resume", "analyse"] {
            fails(femdem(command).arg(&out), words);
        }
        assert_eq!(fs::read(&path).unwrap(), bytes);
    };
    for length in [0, 10, 60, good.len() / 2, good.len() - 1] {
        refused(&good[..length], &["pack.ckpt"]);
    }
    for position in (0..good.len()).step_by(good.len() / 7) {
        let mut flipped = good.clone();
        flipped[position] ^= 1;
        refused(&flipped, &["pack.ckpt"]);
    }
    fs::remove_file(&path).unwrap();
    fails(femdem("resume").arg(&out), &["there is no", "pack.ckpt"]);
    fails(
        femdem("analyse").arg(folder.path().join("nowhere")),
        &["there is no", "pack.ckpt", "bodies.csv"],
    );
}

#[test]
fn bodies_that_are_not_closed_surfaces_are_refused() {
    let folder = tempdir().unwrap();
    let open = WEDGE.replace("f 1 2 5\n", "");
    let inside_out = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
    let not_a_number = WEDGE.replace("v 0.1 0 0\n", "v nan 0 0\n");
    for (name, text, words) in [
        ("open.obj", open.as_str(), &["open"][..]),
        ("inside_out.obj", inside_out, &["inside out"]),
        ("nan.obj", &not_a_number, &["nan"]),
        ("empty.obj", "", &["no"]),
        ("other.step", "step", &["other.step", "obj"]),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        refuse_shape(&path, words);
    }
}

fn refuse_shape(path: &Path, words: &[&str]) {
    let out = path.with_extension("out");
    fails(
        femdem("pack")
            .arg("--shape")
            .arg(path)
            .arg("--out")
            .arg(&out),
        words,
    );
    assert!(!out.exists());
}

#[test]
fn bad_scene_files_are_refused_with_their_name() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("bad.toml");
    for (text, words) in [
        ("cuont = 3\n", &["bad.toml", "cuont"][..]),
        ("count = \"three\"\n", &["bad.toml", "count"]),
        (
            "shape = \"A10\"\nshape = \"P5\"\n",
            &["bad.toml", "duplicate"],
        ),
        ("protocol = \"rain\"\n", &["bad.toml", "sequential"]),
    ] {
        fs::write(&path, text).unwrap();
        fails(femdem("pack").arg(&path), words);
    }
    fails(
        femdem("pack").arg(folder.path().join("none.toml")),
        &["cannot read", "none.toml"],
    );
}

#[test]
fn refusals_of_the_other_commands_name_what_is_wrong() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let made = run(femdem("pack").args(TINY).arg("--out").arg(&out));
    assert_eq!(code(&made), 0, "{made:?}");
    let before = fs::metadata(out.join("summary.json"))
        .unwrap()
        .modified()
        .unwrap();
    for (command, options, words) in [
        (
            "analyse",
            ["--threshold", "nan"],
            ["force_threshold", "NaN"],
        ),
        ("analyse", ["--core-inset", "nan"], ["inset", "NaN"]),
        (
            "analyse",
            ["--axes", "faces:99"],
            ["99 sides", "faces of 4"],
        ),
        ("resolve", ["--young", "-1"], ["young", "-1"]),
        ("resolve", ["--poisson", "-3"], ["oisson", "-3"]),
    ] {
        fails(femdem(command).arg(&out).args(options), &words);
    }
    let after = fs::metadata(out.join("summary.json")).unwrap();
    assert_eq!(after.modified().unwrap(), before);
    for name in ["x.jpg", "x.svg", "x"] {
        let picture = folder.path().join(name);
        fails(
            femdem("shapes").arg("--picture").arg(&picture),
            &[name, ".png"],
        );
        assert!(!picture.exists());
    }
}

#[test]
fn scenes_have_at_least_one_thread() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    for (command, text) in [
        ("pack", "threads = 0\n"),
        (
            "run",
            "threads = 0\n[material.m]\ndensity = 1000\n\
             [[body]]\nshape = \"cube\"\ndiameter = 0.1\nmaterial = \"m\"\n",
        ),
    ] {
        fs::write(&scene, text).unwrap();
        let out = folder.path().join(command);
        fails(
            femdem(command).arg(&scene).arg("--out").arg(&out),
            &["threads = 0", "1 or more"],
        );
        assert!(!out.exists());
    }
}
