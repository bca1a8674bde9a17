//! Scenes of several stages.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, fails, femdem, run, stdout, summary};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Four cubes fall, are pressed by a lid, and lie in a box whose side moves.
const SCENE: &str = r#"
title = "three stages"
duration = 0.08
every = 0.04

[contact]
penalty = 2e5
friction = 0.4

[material.stone]
density = 2500

[[wall]]
name = "box"
box = { lower = [0, 0, 0], upper = [0.05, 0.05, 0.1], open = true }

[[wall]]
name = "lid"
plane = { normal = [0, 0, -1], offset = -0.09 }

[[body]]
name = "cube"
shape = "cube"
size = 0.02
material = "stone"
position = [0.0125, 0.0125, 0.0125]
copies = { count = [2, 2, 1], spacing = [0.025, 0.025, 0] }

[[stage]]
name = "fall"

[[stage]]
name = "press"
duration = 0.3
contact = { friction = 0.2 }
wall = [{ name = "lid", control = { force = 5, speed = 0.5 } }]

[[stage]]
name = "lift"
duration = 0.01
gravity = [0, 0, 0]
wall = [{ name = "lid", motion = { linear = { velocity = [0, 0, 0.5] } } }]
"#;

fn bodies(folder: &Path) -> Vec<String> {
    let table = fs::read_to_string(folder.join("members.csv")).unwrap();
    table.lines().map(str::to_owned).collect()
}

#[test]
fn stages_are_runs_one_from_the_end_of_the_other() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = format!("track = true\n{SCENE}");
    fs::write(&scene, &text).unwrap();
    let out = folder.path().join("out");
    let result = run(femdem("run").arg(&scene).arg("--check"));
    let said = stdout(&result);
    assert!(
        said.contains("stage 1 of 3: fall") && said.contains("time step"),
        "{said}"
    );
    assert!(
        said.contains("the other stages start from the end"),
        "{said}"
    );
    let result = run(femdem("run")
        .arg(&scene)
        .arg("--out")
        .arg(&out)
        .args(["--threads", "1"]));
    assert_eq!(code(&result), 0, "{result:?}");
    let said = stdout(&result);
    for line in [
        "stage 1 of 3: fall",
        "stage 2 of 3: press",
        "stage 3 of 3: lift",
    ] {
        assert!(said.contains(line), "{said}");
    }
    fails(
        femdem("analyse").arg(&out),
        &["holds the stages", "fall", "press", "lift"],
    );
    let press = summary(&out.join("press"));
    let lid = press["walls"].as_array().unwrap();
    let lid = lid.iter().find(|wall| wall["name"] == "lid").unwrap();
    let force = lid["force"][2].as_f64().unwrap();
    assert!((force - 5.0).abs() < 0.05, "{force}");
    assert_eq!(
        summary(&out.join("lift"))["simulated_time"]
            .as_f64()
            .unwrap()
            .floor(),
        0.0
    );

    // By hand, from folder to folder, with the same bits.
    let (top, _) = text.split_once("[[stage]]").unwrap();
    let by_hand = folder.path().join("by-hand");
    let parts = [
        ("fall", String::new(), top.to_owned()),
        (
            "press",
            "from = \"FALL\"\n".to_owned(),
            top.replace("friction = 0.4", "friction = 0.2")
                .replace("duration = 0.08", "duration = 0.3")
                .replace(
                    "offset = -0.09 }",
                    "offset = -0.09 }\ncontrol = { force = 5, speed = 0.5 }",
                ),
        ),
        (
            "lift",
            "from = \"PRESS\"\ngravity = [0, 0, 0]\n".to_owned(),
            top.replace("duration = 0.08", "duration = 0.01").replace(
                "offset = -0.09 }",
                "offset = -0.09 }\nmotion = { linear = { velocity = [0, 0, 0.5] } }",
            ),
        ),
    ];
    for (name, head, text) in parts {
        let own = folder.path().join(format!("{name}.toml"));
        let head = head
            .replace("FALL", by_hand.join("fall").to_str().unwrap())
            .replace("PRESS", by_hand.join("press").to_str().unwrap());
        fs::write(&own, head + &text).unwrap();
        let own_out = by_hand.join(name);
        let result = run(femdem("run")
            .arg(&own)
            .arg("--out")
            .arg(&own_out)
            .args(["--threads", "2"]));
        assert_eq!(code(&result), 0, "{result:?}");
        assert_eq!(bodies(&own_out), bodies(&out.join(name)), "{name}");
    }

    // Stages that are missing are made again, those that are there stay.
    let before = bodies(&out.join("lift"));
    fs::remove_dir_all(out.join("lift")).unwrap();
    let result = run(femdem("resume").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(!stdout(&result).contains("stage 2"), "{result:?}");
    assert_eq!(bodies(&out.join("lift")), before);
    fails(
        femdem("resume").arg(&out).args(["--duration", "1"]),
        &["--duration", "several stages"],
    );
    fails(
        femdem("run").arg(&scene).arg("--out").arg(&out),
        &["not empty"],
    );
}

#[test]
fn stages_that_cannot_be_are_refused() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let out = folder.path().join("out");
    let refused = |from: &str, to: &str, words: &[&str]| {
        let text = SCENE.replacen(from, to, 1);
        assert_ne!(text, SCENE);
        fs::write(&scene, text).unwrap();
        fails(femdem("run").arg(&scene).arg("--out").arg(&out), words);
        assert!(!out.exists());
    };
    let name = "name = \"press\"";
    refused(name, "", &["stage 1", "`name`", "has none"]);
    refused(name, "name = \"a/b\"", &["stage 1", "a/b"]);
    refused(name, "name = \"fall\"", &["two stages", "fall"]);
    refused(name, "name = \"press\"\nout = \"x\"", &["press", "`out`"]);
    refused(name, "name = \"press\"\nfrom = \"x\"", &["press", "`from`"]);
    refused(name, "name = \"press\"\nspeed = 1", &["press", "speed"]);
}

/// `--check` looks at the first stage, and a sweep takes its numbers from the last one.
#[test]
fn stages_are_checked_and_swept() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, SCENE).unwrap();
    let result = run(femdem("run").arg(&scene).arg("--check"));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(stdout(&result).contains("steps for 0.08 s"), "{result:?}");
    let out = folder.path().join("sweep");
    for _ in 0..2 {
        let result = run(femdem("sweep")
            .arg(&scene)
            .args(["--vary", "contact.damping=0.3,0.6", "--out"])
            .arg(&out));
        assert_eq!(code(&result), 0, "{result:?}");
    }
    let table = fs::read_to_string(out.join("sweep.csv")).unwrap();
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let time = header
        .iter()
        .position(|name| *name == "simulated_time")
        .unwrap();
    let jobs = lines.filter(|line| line.starts_with("job"));
    let times: Vec<f64> = jobs
        .map(|line| line.split(',').nth(time).unwrap().parse().unwrap())
        .collect();
    assert_eq!(times.len(), 2);
    for time in times {
        assert!((time - 0.01).abs() < 1e-3, "{time}");
    }
}

/// A load of a stage is on bodies that a source brought in the stage before.
#[test]
fn a_load_is_on_bodies_of_an_earlier_stage() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = r#"
duration = 0.1
gravity = [0, 0, 0]
track = true

[material.stone]
density = 1000

[[wall]]
name = "floor"
plane = { normal = [0, 0, 1] }

[[stage]]
name = "come"
source = [{ name = "feed", shape = "cube", size = 0.02, material = "stone", lower = [0, 0, 0.1], upper = [0, 0, 0.1], rate = 100, number = 1 }]

[[stage]]
name = "pull"
load = [{ bodies = ["feed"], acceleration = [2, 0, 0] }]
"#;
    fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let result = run(femdem("run").arg(&scene).arg("--out").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let rows = bodies(&out.join("pull"));
    let last: Vec<&str> = rows.last().unwrap().split(',').collect();
    let [time, x] = [0, 2].map(|column| last[column].parse::<f64>().unwrap());
    assert!((x - time * time).abs() < 1e-3 * x, "{x} at {time}");
    // The scene in the folder may be the one that is run again.
    let own = out.join("scene.toml");
    let result = run(femdem("run")
        .arg(&own)
        .arg("--out")
        .arg(&out)
        .arg("--force"));
    assert_eq!(code(&result), 0, "{result:?}");
    assert_eq!(fs::read_to_string(&own).unwrap(), text);
    assert_eq!(bodies(&out.join("pull")), rows);
}

#[test]
fn stages_that_cannot_follow_are_refused_before_anything_runs() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let misspelt = "wall = [{ name = \"ldi\", motion";
    let text = SCENE.replace("wall = [{ name = \"lid\", motion", misspelt);
    assert!(text.contains(misspelt));
    fs::write(&scene, &text).unwrap();
    let out = folder.path().join("out");
    for check in [&["--check"][..], &[]] {
        let words = "stage lift: the scene changes the number of [[wall]] from 2 to 3";
        let run = &mut femdem("run");
        fails(run.arg(&scene).arg("--out").arg(&out).args(check), &[words]);
        assert!(!out.exists());
    }
}
