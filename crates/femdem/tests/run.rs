//! `femdem run` on small scenes: every file, resuming, refusals, and the scenes that are shipped.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, fails, femdem, run, stdout, summary};
use femdem::Usage;
use femdem::run::{MEMBER_COLUMNS, Run, Scenario, Stage};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::tempdir;

/// A soft cube and a rigid one fall on a floor beside a driven plate; the soft one flows.
const SCENE: &str = r#"
title = "small"
duration = 0.03
every = 0.005
track = true

[contact]
penalty = 1e5

[material.clay]
density = 1000
law = "j2"
young = 1e6
poisson = 0.3
yield-stress = 5e3

[material.stone]
density = 2500

[[wall]]
name = "floor"
plane = { normal = [0, 0, 1] }

[[body]]
name = "soft"
block = [2, 2, 2]
sides = [0.05, 0.05, 0.05]
material = "clay"
behaviour = "deformable"
position = [0, 0, 0.0255]
velocity = [0, 0, -1]

[[body]]
name = "hard"
shape = "cube"
size = 0.04
material = "stone"
position = [0.005, 0, 0.0715]
velocity = [0, 0, -1]
copies = { count = [1, 1, 2], spacing = [0, 0, 0.05] }
"#;

fn write(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    path
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_leaves_every_file() {
    let folder = tempdir().unwrap();
    let drawn = SCENE.replace("track = true", "track = true\npictures = true");
    let (scene, out) = (write(folder.path(), &drawn), folder.path().join("out"));
    let result = run(femdem("run")
        .arg(&scene)
        .arg("--out")
        .arg(&out)
        .args(["--threads", "2"]));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(
        stdout(&result).contains("small: to its end"),
        "{}",
        stdout(&result)
    );
    let expected = [
        "contacts.pvd",
        "frames",
        "history.csv",
        "members.csv",
        "run.ckpt",
        "run.png",
        "run.pvd",
        "scene.toml",
        "summary.json",
        "walls.pvd",
        "walls.vtp",
    ];
    assert_eq!(names(&out), expected);
    // Frames at 0, 0.005, ..., 0.03: one for each kind, and a picture.
    let frames = names(&out.join("frames"));
    assert_eq!(frames.len(), 4 * 7, "{frames:?}");
    let drawn = folder.path().join("side.png");
    let picture = run(femdem("picture")
        .arg(&out)
        .args(["--view", "side", "--size", "64x48", "--out"])
        .arg(&drawn));
    assert_eq!(code(&picture), 0, "{picture:?}");
    assert!(fs::read(&drawn).unwrap().starts_with(b"\x89PNG"));
    // As a pack: by other colours, and measured.
    let picture = run(femdem("picture")
        .arg(&out)
        .args(["--colour", "orientation", "--size", "64x48", "--out"])
        .arg(&drawn));
    assert_eq!(code(&picture), 0, "{picture:?}");
    let measured = folder.path().join("measured");
    let analysed = run(femdem("analyse").arg(&out).arg("--out").arg(&measured));
    assert_eq!(code(&analysed), 0, "{analysed:?}");
    let told = fs::read_to_string(measured.join("analysis.json")).unwrap();
    let told: serde_json::Value = serde_json::from_str(&told).unwrap();
    assert_eq!(told["bodies"], 3);
    fails(
        femdem("analyse").arg(&out).args(["--frame", "2"]),
        &["frame 2", "tables = true"],
    );
    let soft = fs::read_to_string(out.join("frames/deformable-00006.vtu")).unwrap();
    assert!(soft.contains("NumberOfPoints=\"27\" NumberOfCells=\"48\""));
    assert!(soft.contains("Name=\"plastic_strain\""));

    let summary = summary(&out);
    assert_eq!(summary["ending"], "time");
    assert_eq!(summary["bodies"][2]["name"], "hard 2");
    assert!(summary["energy"]["dissipated_plastic"].as_f64().unwrap() > 0.0);
    assert!(summary["strain"]["max_von_mises"].as_f64().unwrap() > 1e3);
    let mass = summary["bodies"][0]["mass"].as_f64().unwrap();
    assert!((mass - 0.125).abs() < 1e-12);
    // The floor is pressed down.
    assert!(summary["walls"][0]["peak_force"].as_f64().unwrap() > 3.0);

    let history = fs::read_to_string(out.join("history.csv")).unwrap();
    let columns: Vec<&str> = history.lines().next().unwrap().split(',').collect();
    assert_eq!(columns.last(), Some(&"fz floor"));
    assert!(
        history
            .lines()
            .skip(1)
            .all(|row| row.split(',').count() == columns.len())
    );
    assert!(history.lines().count() > 60);
    let members = fs::read_to_string(out.join("members.csv")).unwrap();
    assert_eq!(
        members.lines().count(),
        1 + 3 * (history.lines().count() - 1)
    );
    // A rigid body has a unit quaternion, a deformable one none.
    for row in members.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        assert_eq!(cells.len(), MEMBER_COLUMNS.len(), "{row}");
        let q: Vec<f64> = cells[13..].iter().filter_map(|x| x.parse().ok()).collect();
        let norm: f64 = q.iter().map(|x| x * x).sum();
        assert!(q.is_empty() || (norm - 1.0).abs() < 1e-12, "{row}");
    }
    let turned = |row: &&str| !row.ends_with(",,,,");
    assert!(members.lines().skip(1).any(|row| turned(&row)));
    let series = fs::read_to_string(out.join("run.pvd")).unwrap();
    assert_eq!(series.matches("part=\"1\"").count(), 7);
}

/// Impulse of the floor and of gravity is the change of momentum, row by row.
#[test]
fn wall_forces_and_momentum_agree() {
    let folder = tempdir().unwrap();
    let text = SCENE.replace("every = 0.005", "every = 0.005\nhistory-every = 1e-9");
    let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    job.flush(folder.path()).unwrap();
    let history = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let head: Vec<&str> = history.lines().next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|known| *known == name).unwrap();
    let rows: Vec<Vec<f64>> = history
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|x| x.parse().unwrap()).collect())
        .collect();
    let (time, momentum, force) = (column("time"), column("pz"), column("fz floor"));
    let masses = job.simulation().bodies().into_iter().map(|body| body.mass);
    let weight = 9.81 * masses.sum::<f64>();
    let mut impulse = 0.0;
    let mut pushed = 0.0;
    for pair in rows.windows(2) {
        let (before, after) = (&pair[0], &pair[1]);
        let dt = after[time] - before[time];
        // On the bodies, against that on the floor; the trapezoidal rule is that of the step.
        impulse += dt * (-0.5 * (before[force] + after[force]) - weight);
        pushed += dt * after[force].abs();
    }
    let change = rows.last().unwrap()[momentum] - rows[0][momentum];
    assert!(pushed > 0.1, "{pushed}");
    assert!((impulse - change).abs() < 1e-9, "{impulse} {change}");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_resumes_to_the_same_bits() {
    let folder = tempdir().unwrap();
    let scene = write(
        folder.path(),
        &SCENE.replace("duration = 0.03", "duration = 0.3"),
    );
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    let start = |out: &Path, threads: &str| {
        let mut command = femdem("run");
        command
            .arg(&scene)
            .args(["--threads", threads, "-q", "--out"])
            .arg(out);
        command
    };
    let result = run(&mut start(&whole, "1"));
    assert_eq!(code(&result), 0, "{result:?}");
    let mut child = start(&parts, "2").spawn().unwrap();
    while !parts.join("frames/contacts-00002.vtp").is_file() {
        assert_eq!(child.try_wait().unwrap(), None);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    crate::common::interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!parts.join("summary.json").exists());
    // While another writes into the folder nobody else does.
    let held = fs::File::open(&parts).unwrap();
    held.lock().unwrap();
    for command in [
        femdem("resume").arg(&parts),
        start(&parts, "1").arg("--force"),
    ] {
        fails(command, &["another femdem"]);
    }
    drop(held);
    let result = run(femdem("resume").arg(&parts).arg("-q"));
    assert_eq!(code(&result), 0, "{result:?}");
    assert_eq!(summary(&parts)["state_hash"], summary(&whole)["state_hash"]);
    for name in ["history.csv", "members.csv", "run.pvd"] {
        let read = |folder: &Path| fs::read_to_string(folder.join(name)).unwrap();
        assert!(read(&parts) == read(&whole), "{name}");
    }
    assert_eq!(names(&parts.join("frames")), names(&whole.join("frames")));
}

/// What is written when does not change the motion.
#[test]
fn the_motion_does_not_depend_on_the_output() {
    let folder = tempdir().unwrap();
    let end = |every: &str| {
        let text = SCENE.replace("every = 0.005", &format!("every = {every}"));
        let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        job.advance(folder.path(), u64::MAX).unwrap();
        job.simulation().world.state_hash().unwrap()
    };
    assert_eq!(end("0.005"), end("0.0017"));
}

/// Neither intervals that do not divide the duration nor a step of many durations give a row twice.
#[test]
fn the_end_has_one_row_and_one_frame() {
    for (times, frames) in [
        ("duration = 0.03\nevery = 0.009\nhistory-every = 0.003", 5),
        ("duration = 0.03\nevery = 0.01\nhistory-every = 0.007", 4),
        ("duration = 1e-300\nevery = 1e-301", 2),
    ] {
        let folder = tempdir().unwrap();
        let text = SCENE.replace("duration = 0.03\nevery = 0.005", times);
        let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        job.advance(folder.path(), u64::MAX).unwrap();
        // Nothing is due any more.
        job.advance(folder.path(), 1).unwrap();
        job.finish(folder.path(), &Usage::default()).unwrap();
        assert_eq!(job.frames().len(), frames, "{times}");
        let end = job.simulation().world.time();
        assert_eq!(job.frames().last(), Some(&end), "{times}");
        let history = fs::read_to_string(folder.path().join("history.csv")).unwrap();
        let time = |row: &str| row.split(',').next().unwrap().parse::<f64>().unwrap();
        let rows: Vec<f64> = history.lines().skip(1).map(time).collect();
        assert!(rows.windows(2).all(|pair| pair[0] < pair[1]), "{rows:?}");
        assert_eq!(rows.last(), Some(&end), "{times}");
        let members = fs::read_to_string(folder.path().join("members.csv")).unwrap();
        assert_eq!(members.lines().count(), 1 + 3 * rows.len(), "{times}");
    }
}

#[test]
fn bad_entries_are_refused_by_name_and_leave_no_folder() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    for (from, to, words) in [
        ("duration = 0.03", "duration = -1", &["duration = -1"][..]),
        ("every = 0.005", "evry = 0.005", &["evry"]),
        (
            "every = 0.005",
            "every = 1e-30",
            &["every = 0.000", "billionth"],
        ),
        (
            "every = 0.005",
            "every = 0.005\nhistory-every = 2e-11",
            &["history-every = 0.00000000002", "billionth"],
        ),
        (
            "duration = 0.03\nevery = 0.005",
            "duration = 5e-324",
            &["every = 0 ", "billionth"],
        ),
        (
            "poisson = 0.3",
            "poisson = 0.5",
            &["soft", "material.clay", "poisson = 0.5"],
        ),
        (
            "young = 1e6\n",
            "",
            &["soft", "material.clay", "young", "needs it"],
        ),
        ("law = \"j2\"", "law = \"jelly\"", &["jelly", "neo-hookean"]),
        ("density = 1000", "density = 0", &["soft", "density"]),
        (
            "material = \"stone\"",
            "material = \"wood\"",
            &["hard", "\"wood\"", "[material.NAME]"],
        ),
        ("block = [2, 2, 2]", "block = [0, 2, 2]", &["soft", "cells"]),
        ("shape = \"cube\"", "shape = \"cueb\"", &["hard", "cueb"]),
        ("size = 0.04\n", "", &["hard", "diameter and size"]),
        (
            "name = \"hard\"",
            "name = \"soft\"",
            &["\"soft\"", "another body"],
        ),
        (
            "name = \"soft\"",
            "name = \"hard 2\"",
            &["\"hard 2\"", "a copy of another body"],
        ),
        (
            "[[wall]]",
            "[[wall]]\nname = \"bin\"\nbox = { lower = [-9, -9, -9], upper = [9, 9, 9] }\n\
             [[wall]]\nname = \"bin x-\"\nplane = { normal = [1, 0, 0], offset = -9 }\n[[wall]]",
            &["\"bin x-\"", "another wall"],
        ),
        (
            "normal = [0, 0, 1]",
            "normal = [0, 0, 0]",
            &["floor", "normal"],
        ),
        (
            "plane = {",
            "cylinder = { diameter = 1 }\nplane = {",
            &["floor", "exactly one"],
        ),
        (
            "size = 0.04",
            "size = 0.04\nelement = \"t10\"",
            &["hard", "element", "rigid"],
        ),
        (
            "spacing = [0, 0, 0.05] }",
            "spacing = [0, 0, 0.05] }\n[[body.boundary]]\nselect = \"all\"\nfix = true",
            &["hard", "boundary", "rigid"],
        ),
        (
            "velocity = [0, 0, -1]\n\n[[body]]",
            "[[body.boundary]]\nselect = { plane = { normal = [1, 0, 0], offset = 9 } }\nfix = true\n[[body]]",
            &["soft", "nothing is selected"],
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let scene = write(folder.path(), &SCENE.replacen(from, to, 1));
        fails(femdem("run").arg(&scene).arg("--out").arg(&out), words);
        assert!(!out.exists(), "{to}");
    }
    fails(
        femdem("run").arg(folder.path().join("none.toml")),
        &["none.toml"],
    );
    fails(
        femdem("resume").arg(folder.path()),
        &["pack.ckpt", "run.ckpt"],
    );
}

/// Every key is of use or refused.
#[test]
fn keys_without_effect_are_refused() {
    let motion = "motion = { linear = { velocity = [0, 0, 1] } }";
    let soft = "velocity = [0, 0, -1]\n\n[[body]]";
    let boundary = |keys: &str| format!("[[body.boundary]]\nselect = \"all\"\n{keys}\n[[body]]");
    let sides = "sides = [0.05, 0.05, 0.05]";
    let block = |key: &str| format!("{sides}\n{key}");
    let cube = |key: &str| format!("size = 0.04\n{key}");
    for (from, to, words) in [
        ("size = 0.04", cube("mesh-size = 0.3"), ["hard", "mesh-size = 0.3", "convex"]),
        ("size = 0.04", cube("unit = \"mm\""), ["hard", "unit", "file"]),
        ("size = 0.04", cube(motion), ["hard", "velocity", "motion"]),
        (
            "velocity = [0, 0, -1]\ncopies",
            format!("spin = [0, 0, 1]\n{motion}\ncopies"),
            ["hard", "spin", "motion"],
        ),
        (sides, block("size = 0.05"), ["soft", "size = 0.05", "shape only"]),
        (sides, block("diameter = 1"), ["soft", "diameter = 1", "shape only"]),
        (sides, block("mesh-size = 0.2"), ["soft", "mesh-size = 0.2", "shape only"]),
        (sides, block("unit = \"cm\""), ["soft", "unit", "file"]),
        (
            "name = \"floor\"",
            "name = \"floor\"\nunit = \"mm\"".to_owned(),
            ["floor", "unit", "file"],
        ),
        (
            "copies = { count = [1, 1, 2], ",
            "rotation = { axis = [0, 0, 1], angle = 10 }\ncopies = { seed = 1, count = [1, 1, 2], "
                .to_owned(),
            ["hard", "rotation", "seed"],
        ),
        (
            "density = 2500",
            "density = 2500\nyoung = 1e9".to_owned(),
            ["material.stone", "young = 1000000000", "law"],
        ),
        (
            "[material.stone]",
            "[material.unused]\ndensity = -1\n[material.stone]".to_owned(),
            ["material.unused", "no body", "take it out"],
        ),
        (
            soft,
            boundary("pressure = 10\ndirections = [true, false, true]"),
            ["soft", "directions", "fix or motion"],
        ),
        (
            soft,
            boundary("fix = true\ndirections = [false, false, false]"),
            ["soft", "directions = [false, false, false]", "at least one"],
        ),
        (
            soft,
            "[[body.region]]\nmaterial = \"clay\"\nwithin = { half-space = { normal = [0, 0, 0] } }\n[[body]]"
                .to_owned(),
            ["soft", "half-space.normal = zero", "above zero"],
        ),
    ] {
        assert!(SCENE.contains(from), "{from}");
        let scenario = Scenario::from_toml(&SCENE.replacen(from, &to, 1)).unwrap();
        let message = scenario.build().unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{to}: {word:?} is not in: {message}");
        }
    }
}

/// A block that is driven inside out: the message names the body, the element, the step and what to
/// do, and the checkpoint stays.
#[test]
fn a_failure_names_the_body_and_keeps_the_checkpoint() {
    let folder = tempdir().unwrap();
    let text = r#"
duration = 1
every = 0.01
gravity = [0, 0, 0]
[material.clay]
density = 1000
law = "neo-hookean"
young = 1e5
poisson = 0.3
[[body]]
name = "sample"
block = [1, 1, 2]
sides = [0.1, 0.1, 0.2]
material = "clay"
behaviour = "deformable"
[[body.boundary]]
select = { plane = { normal = [0, 0, 1], offset = -0.1 } }
fix = true
[[body.boundary]]
select = { plane = { normal = [0, 0, 1], offset = 0.1 } }
motion = { linear = { velocity = [0, 0, -4] } }
"#;
    let (scene, out) = (write(folder.path(), text), folder.path().join("out"));
    let words = ["sample", "element", "step", "smaller step", "run.ckpt"];
    let message = fails(
        femdem("run").arg(&scene).args(["-q", "--out"]).arg(&out),
        &words,
    );
    assert_eq!(message.matches("sample").count(), 1, "{message}");
    assert!(out.join("run.ckpt").is_file());
    assert!(out.join("frames/deformable-00001.vtu").is_file());
    assert!(!out.join("summary.json").exists());
    // The way there is the same again.
    fails(femdem("resume").arg(&out).arg("-q"), &words);
}

#[test]
fn every_shipped_scene_is_read_and_checked() {
    // Scenes name their meshes from the root.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let scenes = root.join("scenes");
    let mut names = names(&scenes);
    names.retain(|name| name.ends_with(".toml"));
    assert!(names.len() >= 9, "{names:?}");
    for name in names {
        let path = scenes.join(&name);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("# ") && text.contains("# Takes"), "{name}");
        let mut scenes: Vec<Scenario> = Stage::read(&path, None)
            .unwrap()
            .into_iter()
            .map(|stage| stage.scenario)
            .collect();
        if scenes.is_empty() {
            scenes.push(Scenario::read(&path).unwrap());
        }
        assert!(scenes.iter().all(|scene| !scene.title.is_empty()), "{name}");
        let result =
            run(femdem("run")
                .current_dir(&root)
                .arg(&path)
                .args(["--check", "--threads", "2"]));
        assert_eq!(code(&result), 0, "{name}: {result:?}");
        assert!(stdout(&result).contains("steps for"), "{name}");
    }
}

/// Sums over no deformable body are 0, not -0.
#[test]
fn nothing_is_not_negative() {
    let folder = tempdir().unwrap();
    let text = "duration = 1e-3\n[material.stone]\ndensity = 2500\n[[body]]\nshape = \"cube\"\n\
                size = 0.1\nmaterial = \"stone\"\n";
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    let summary = job.finish(folder.path(), &Usage::default()).unwrap();
    assert!(!summary.to_string().contains("-0 J"), "{summary}");
    assert!(summary.energy.strain.is_sign_positive());
    let history = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    assert!(!history.contains(",-0,"), "{history}");
}
