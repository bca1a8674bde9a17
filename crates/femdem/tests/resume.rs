//! Runs that go on under a changed scene, and runs that start from the state of others.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, fails, femdem, run, stdout, summary};
use femdem::Usage;
use femdem::run::{Ending, Run, Scenario};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Two cubes fall on a floor beside a wall.
const SCENE: &str = r#"
duration = 0.2
every = 0.05
history-every = 0.01
track = true
contact.penalty = 3e4
[material.stone]
density = 2500
[[wall]]
name = "floor"
plane = { normal = [0, 0, 1] }
[[wall]]
name = "side"
plane = { normal = [1, 0, 0], offset = -0.021 }
[[body]]
name = "low"
shape = "box:width=1,height=1"
size = 0.04
material = "stone"
position = [0, 0, 0.021]
[[body]]
name = "high"
shape = "box:width=1,height=1"
size = 0.04
material = "stone"
position = [0.004, 0.002, 0.063]
velocity = [0, 0, -0.1]
"#;

const REST: &str = "rest = { energy = 1e-6, time = 0.02 }";

fn scene(from: &str, to: &str) -> String {
    assert!(SCENE.contains(from), "{from}");
    SCENE.replacen(from, to, 1)
}

fn scenario(from: &str, to: &str) -> Scenario {
    Scenario::from_toml(&scene(from, to)).unwrap()
}

/// Runs a scene into a folder.
fn ran(text: &str, out: &Path) {
    let path = out.with_extension("toml");
    fs::write(&path, text).unwrap();
    let result = run(femdem("run").arg(&path).args(["-q", "--out"]).arg(out));
    assert_eq!(code(&result), 0, "{result:?}");
}

fn resumed(out: &Path, options: &[&str]) -> String {
    let result = run(femdem("resume").arg(out).args(options));
    assert_eq!(code(&result), 0, "{result:?}");
    stdout(&result)
}

/// Replaces a part of the scene in a folder.
fn edit(out: &Path, from: &str, to: &str) {
    let path = out.join("scene.toml");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from} is not in {text}");
    fs::write(&path, text.replacen(from, to, 1)).unwrap();
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(files(&path));
        } else {
            all.insert(path.display().to_string(), fs::read(&path).unwrap());
        }
    }
    all
}

/// Rows of a table, without the header.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    let row = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(row).collect()
}

#[test]
fn a_run_that_has_ended_goes_on_to_a_longer_duration() {
    let folder = tempdir().unwrap();
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    ran(&scene("duration = 0.2", "duration = 0.4"), &whole);
    ran(SCENE, &parts);
    let before = files(&parts);
    for short in ["0.2", "-1", "nan"] {
        let words = ["duration = ", "present time of the run, 0.20", "longer"];
        fails(
            femdem("resume")
                .arg(&parts)
                .arg(format!("--duration={short}")),
            &words,
        );
    }
    assert!(files(&parts) == before);
    let said = resumed(&parts, &["--duration", "0.4"]);
    assert!(said.contains("applied from --duration: 0.4 s"), "{said}");
    assert_eq!(summary(&parts)["duration"], 0.4);
    assert_eq!(summary(&parts)["state_hash"], summary(&whole)["state_hash"]);
    let times: Vec<f64> = rows(&parts.join("history.csv"))
        .iter()
        .map(|row| row[0].parse().unwrap())
        .collect();
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    assert!(times.len() >= 41, "{}", times.len());
    // The folder has the scene that was run, and nothing more to do.
    let said = resumed(&parts, &[]);
    assert!(!said.contains("applied"), "{said}");
    assert_eq!(summary(&parts)["state_hash"], summary(&whole)["state_hash"]);
}

#[test]
fn a_changed_scene_is_applied_or_refused_by_its_key() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    ran(SCENE, &out);
    let original = fs::read_to_string(out.join("scene.toml")).unwrap();
    let ckpt = fs::read(out.join("run.ckpt")).unwrap();
    for (from, to, words) in [
        (
            "size = 0.04",
            "size = 0.05",
            ["scene.toml changes [[body]] number 1 (size)", "another run"],
        ),
        (
            "density = 2500.0",
            "density = 2600.0",
            ["changes material.stone", "checkpoint fixes"],
        ),
        (
            "offset = -0.021",
            "offset = -0.02",
            ["changes [[wall]] number 2 (plane)", "put it back"],
        ),
        (
            "friction = 0.6",
            "friction = 0.1",
            ["contact.friction, which the end of the run", "`duration`"],
        ),
        (
            "duration = 0.2",
            "duration = 0.1",
            ["duration = 0.1", "present time"],
        ),
        (
            "safety = 0.9",
            "safety = 9",
            ["time-step.safety = 9", "1e-6 to 1"],
        ),
        (
            "duration = 0.2",
            "duration = 0.2 0.3",
            ["scene.toml", "0.2 0.3"],
        ),
    ] {
        edit(&out, from, to);
        fails(femdem("resume").arg(&out).arg("-q"), &words);
        fs::write(out.join("scene.toml"), &original).unwrap();
    }
    assert!(fs::read(out.join("run.ckpt")).unwrap() == ckpt);
    // The floor is pulled down and friction ends.
    edit(&out, "duration = 0.2", "duration = 0.3");
    edit(&out, "\nfriction = 0.6", "\nfriction = 0.0");
    edit(
        &out,
        "name = \"floor\"",
        "name = \"floor\"\nmotion = { linear = { velocity = [0, 0, -0.1], start = 0.2, end = 0.25 } }",
    );
    let said = resumed(&out, &[]);
    let words = "applied from scene.toml: contact.friction, duration, [[wall]] number 1 (motion)";
    assert!(said.contains(words), "{said}");
    let heights: Vec<f64> = rows(&out.join("members.csv"))
        .iter()
        .filter(|row| row[1] == "low")
        .map(|row| row[4].parse().unwrap())
        .collect();
    let fall = heights.last().unwrap() - heights[20];
    assert!((fall + 0.005).abs() < 5e-4, "{fall}");
    let energy = &summary(&out)["energy"];
    assert!(
        energy["ledger_error_relative"].as_f64().unwrap().abs() < 0.02,
        "{energy}"
    );
    assert!(
        fs::read_to_string(out.join("scene.toml"))
            .unwrap()
            .contains("end = 0.25")
    );
}

/// A bounce without losses, of which any error of the energy is too large.
#[test]
fn the_limit_of_the_energy_error_can_be_raised() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let path = folder.path().join("scene.toml");
    let text = "duration = 0.5
        energy-error-limit = 1e-9
        sleeping = false
        contact.friction = 0
        contact.damping = 0
        time-step.safety = 0.3
        [material.m]
        density = 1000
        [[wall]]
        plane = { normal = [0, 0, 1] }
        [[body]]
        material = \"m\"
        shape = \"cube\"
        size = 0.1
        position = [0, 0, 0.15]";
    fs::write(&path, text).unwrap();
    let stopped = [
        "energy ledger",
        "energy-error-limit",
        "femdem resume",
        "run.ckpt",
    ];
    fails(
        femdem("run").arg(&path).args(["-q", "--out"]).arg(&out),
        &stopped,
    );
    fails(femdem("resume").arg(&out).arg("-q"), &stopped);
    let path = out.join("scene.toml");
    let text = fs::read_to_string(&path).unwrap();
    let limit = |line: &str| line.starts_with("energy-error-limit");
    let lines = text.lines().map(|line| {
        if limit(line) {
            "energy-error-limit = inf"
        } else {
            line
        }
    });
    fs::write(&path, lines.collect::<Vec<_>>().join("\n")).unwrap();
    let said = resumed(&out, &[]);
    assert!(
        said.contains("applied from scene.toml: energy-error-limit"),
        "{said}"
    );
    assert_eq!(summary(&out)["ending"], "time");
}

/// A rest that was found is looked for anew.
#[test]
fn a_run_that_came_to_rest_looks_for_it_again() {
    let folder = tempdir().unwrap();
    let text = scene("duration = 0.2", &format!("duration = 2\n{REST}"));
    let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    assert_eq!(job.ending(), Some(Ending::Rest));
    let first = job.simulation().world.time();
    let mut longer = job.scenario().clone();
    longer.title = "named".to_owned();
    assert_eq!(job.apply(longer.clone()).unwrap(), ["title"]);
    assert_eq!(job.ending(), Some(Ending::Rest));
    longer.duration = 3.0;
    assert_eq!(job.apply(longer).unwrap(), ["duration"]);
    assert_eq!(job.ending(), None);
    job.advance(folder.path(), u64::MAX).unwrap();
    assert_eq!(job.ending(), Some(Ending::Rest));
    let again = job.simulation().world.time() - first;
    assert!((0.02..0.9).contains(&again), "{again}");
    assert_eq!(
        job.finish(folder.path(), &Usage::default()).unwrap().title,
        "named"
    );
}

/// An ended run is relaxed on demand, and its motion goes on from there to a longer duration.
#[test]
fn a_relaxed_run_goes_on_with_its_motion() {
    let folder = tempdir().unwrap();
    let mut job = Run::new(scenario("", "")).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    let end = job.simulation().world.time();
    let mut relaxed = job.scenario().clone();
    relaxed.relax = Some(femdem::run::RelaxEntry {
        tolerance: 1e-2,
        steps: 100_000,
    });
    assert_eq!(job.apply(relaxed.clone()).unwrap(), ["relax"]);
    assert_eq!(job.ending(), None);
    job.advance(folder.path(), u64::MAX).unwrap();
    assert_eq!(job.ending(), Some(Ending::Time));
    let first = *job.relaxation().unwrap();
    assert!(first.converged && first.residual < 1e-2, "{first:?}");
    // A stricter one goes on, and a run that was relaxed cannot say that it was not.
    let strict = femdem::run::RelaxEntry {
        tolerance: 0.5 * first.residual,
        steps: 100_000,
    };
    relaxed.relax = Some(strict);
    assert_eq!(job.apply(relaxed.clone()).unwrap(), ["relax.tolerance"]);
    job.advance(folder.path(), u64::MAX).unwrap();
    assert!(job.relaxation().unwrap().residual <= strict.tolerance);
    let mut never = relaxed.clone();
    never.relax = None;
    let message = job.apply(never).unwrap_err().to_string();
    assert!(message.contains("relax = none"), "{message}");
    let rested = job.simulation().world.time();
    assert!(rested > end);
    relaxed.duration = 0.5 * (end + rested);
    assert!(job.apply(relaxed.clone()).is_err());
    relaxed.duration = rested + 0.1;
    job.apply(relaxed).unwrap();
    assert!(job.relaxation().is_none() && job.ending().is_none());
    job.advance(folder.path(), u64::MAX).unwrap();
    assert!(job.relaxation().is_some_and(|again| again.converged));
    assert!(job.simulation().world.time() > rested + 0.1);
}

/// Intervals that follow the duration have neither gaps nor a burst of rows when it changes.
#[test]
fn rows_go_on_at_new_intervals() {
    let folder = tempdir().unwrap();
    let text = scene(
        "every = 0.05\nhistory-every = 0.01",
        "every = 0.02\ntime-step.largest = 5e-4",
    );
    let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    let mut other = job.scenario().clone();
    (other.duration, other.every) = (0.4, Some(0.1));
    job.apply(other).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    job.flush(folder.path()).unwrap();
    // 100 to 0.2 s, one at its end, and 20 more.
    let count = rows(&folder.path().join("history.csv")).len();
    assert!((120..=123).contains(&count), "{count}");
    assert!(
        (12..=14).contains(&job.frames().len()),
        "{:?}",
        job.frames()
    );
}

/// One settled state serves several second stages.
#[test]
fn runs_start_from_the_state_of_another() {
    let folder = tempdir().unwrap();
    let settled = folder.path().join("settled");
    let rest = format!("duration = 2\n{REST}");
    ran(&scene("duration = 0.2", &rest), &settled);
    let before = files(&settled);
    let end: Vec<Vec<String>> = rows(&settled.join("members.csv"));
    let end = &end[end.len() - 2..];
    let second = |motion: &str| {
        scene("velocity = [0, 0, -0.1]\n", "")
            .replacen(
                "duration = 0.2",
                &format!("from = \"{}\"\nduration = 0.1", settled.display()),
                1,
            )
            .replacen("name = \"side\"", &format!("name = \"side\"\n{motion}"), 1)
    };
    let push = |speed: &str| {
        format!("motion = {{ linear = {{ velocity = [{speed}, 0, 0], start = 0.01 }} }}")
    };
    let mut ends = Vec::new();
    for (name, text) in [
        ("still", second("")),
        ("pushed", second(&push("0.2"))),
        ("left", second(&push("-0.2"))),
    ] {
        let out = folder.path().join(name);
        ran(&text, &out);
        let table = rows(&out.join("members.csv"));
        for (first, last) in table.iter().zip(end) {
            assert_eq!(first[0], "0", "{name}");
            assert_eq!(first[1..5], last[1..5], "{name}");
            assert_eq!(first[13..], last[13..], "{name}");
        }
        let history = rows(&out.join("history.csv"));
        assert_eq!(history[0][..2], ["0", "0"], "{name}");
        assert!(
            history[0][8..16].iter().all(|x| x == "0"),
            "{name}: {:?}",
            history[0]
        );
        let energy = &summary(&out)["energy"];
        assert!(
            energy["ledger_error_relative"].as_f64().unwrap().abs() < 0.05,
            "{name}: {energy}"
        );
        ends.push(table[table.len() - 2][2].parse::<f64>().unwrap());
        // It needs the other folder no more.
        let said = resumed(&out, &["--duration", "0.12"]);
        assert!(said.contains("0.12"), "{said}");
    }
    let start: f64 = end[0][2].parse().unwrap();
    assert!(
        (ends[0] - start).abs() < 1e-3 && (ends[2] - start).abs() < 1e-3,
        "{ends:?}"
    );
    assert!(ends[1] - start > 0.01, "{ends:?}");
    assert!(files(&settled) == before);
    let out = folder.path().join("refused");
    for (text, words) in [
        (
            second("").replacen("size = 0.04", "size = 0.05", 1),
            ["[[body]] number 1 (size)", "settled"],
        ),
        (
            second("").replacen("velocity", "spin", 1).replacen(
                "position = [0, 0, 0.021]",
                "position = [0, 0, 0.021]\nvelocity = [1, 0, 0]",
                1,
            ),
            ["[[body]] number 1 (velocity)", "settled"],
        ),
        (
            second("").replacen("offset = -0.021", "offset = -0.022", 1),
            ["[[wall]] number 2 (plane)", "settled"],
        ),
        (
            second("").replacen("/settled", "/nowhere", 1),
            ["from = ", "run.ckpt"],
        ),
    ] {
        let path = folder.path().join("refused.toml");
        fs::write(&path, text).unwrap();
        fails(femdem("run").arg(&path).arg("--out").arg(&out), &words);
        assert!(!out.exists());
    }
}

/// A block that was pressed stays pressed, and is let go by the next run.
#[test]
fn a_deformable_body_starts_from_its_state() {
    let folder = tempdir().unwrap();
    let scene = |head: &str, top: &str| {
        format!(
            "{head}
            gravity = [0, 0, 0]
            [material.clay]
            density = 1000
            law = \"neo-hookean\"
            young = 1e5
            poisson = 0.3
            [[body]]
            name = \"sample\"
            block = [1, 1, 2]
            sides = [0.1, 0.1, 0.2]
            material = \"clay\"
            behaviour = \"deformable\"
            position = [0, 0, 1]
            [[body.boundary]]
            select = {{ plane = {{ normal = [0, 0, 1], offset = -0.1 }} }}
            fix = true
            [[body.boundary]]
            select = {{ plane = {{ normal = [0, 0, 1], offset = 0.1 }} }}
            {top}"
        )
    };
    let press = "motion = { linear = { velocity = [0, 0, -0.1], end = 0.1 } }";
    let first = Scenario::from_toml(&scene("duration = 0.15", press)).unwrap();
    let mut job = Run::new(first).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    job.flush(folder.path()).unwrap();
    job.save(folder.path(), &Usage::default()).unwrap();
    let nodes = |job: &Run| {
        job.simulation()
            .world
            .deformable(0)
            .unwrap()
            .positions()
            .to_vec()
    };
    let top = |job: &Run| nodes(job).iter().map(|x| x.z).fold(f64::MIN, f64::max);
    assert!((top(&job) - 1.09).abs() < 1e-9);
    let from = format!("from = \"{}\"\nduration = 0.15", folder.path().display());
    for (next, height) in [
        ("fix = true", 1.09),
        (
            "motion = { linear = { velocity = [0, 0, 0.1], end = 0.05 } }",
            1.095,
        ),
        (press, 1.08),
    ] {
        let text = scene(&from, next);
        let mut other = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        assert_eq!(nodes(&other), nodes(&job));
        assert_eq!(other.simulation().world.ledger().error(), 0.0);
        let results = tempdir().unwrap();
        other.advance(results.path(), u64::MAX).unwrap();
        assert!(
            (top(&other) - height).abs() < 1e-9,
            "{next}: {}",
            top(&other)
        );
        let missing = other.simulation().world.ledger().error_relative();
        assert!(missing.abs() < 0.02, "{next}: {missing}");
    }
    // Without the support at its top it springs back.
    let text = scene(&from, "pressure = 0");
    let mut other = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    assert_eq!(other.simulation().supports.len(), 1);
    other.advance(tempdir().unwrap().path(), 4000).unwrap();
    assert!(top(&other) > 1.0905, "{}", top(&other));
    let text = scene(&from, "fix = true").replace("young = 1e5", "young = 2e5");
    let message = Run::new(Scenario::from_toml(&text).unwrap())
        .err()
        .unwrap()
        .to_string();
    assert!(message.contains("material.clay"), "{message}");
}

/// A plate stays where its motion has ended, or flies on as it moved, once it is free.
#[test]
fn a_body_is_set_free_with_the_velocity_that_it_had() {
    let folder = tempdir().unwrap();
    let scene = |head: &str, motion: &str| {
        let text = format!(
            "{head}
            gravity = [0, 0, 0]
            [material.m]
            density = 1000
            [[body]]
            shape = \"cube\"
            size = 0.1
            material = \"m\"
            {motion}"
        );
        Scenario::from_toml(&text).unwrap()
    };
    let place = |job: &Run| job.simulation().world.position(0).unwrap().x;
    for (end, speed) in [(0.1, 0.0), (1.0, 0.3)] {
        let motion = format!("motion = {{ linear = {{ velocity = [0.3, 0, 0], end = {end} }} }}");
        let mut job = Run::new(scene("duration = 0.2", &motion)).unwrap();
        job.advance(folder.path(), u64::MAX).unwrap();
        job.save(folder.path(), &Usage::default()).unwrap();
        let from = format!("from = \"{}\"\nduration = 0.2", folder.path().display());
        let mut free = Run::new(scene(&from, "")).unwrap();
        assert_eq!(place(&free), place(&job));
        free.advance(tempdir().unwrap().path(), u64::MAX).unwrap();
        let way = place(&free) - place(&job);
        let time = free.simulation().world.time();
        assert!((way - speed * time).abs() < 1e-9, "{way} {speed}");
        // The same in one run, at its own time.
        let mut longer = scene("duration = 0.4", "");
        longer.every = job.scenario().every;
        assert!(job.apply(longer).is_ok());
        let (start, since) = (place(&job), job.simulation().world.time());
        job.advance(folder.path(), u64::MAX).unwrap();
        let time = job.simulation().world.time() - since;
        let way = place(&job) - start;
        assert!((way - speed * time).abs() < 1e-9, "{way} {speed}");
    }
}
