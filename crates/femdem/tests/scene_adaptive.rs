//! Adaptive bodies in scenes: stages, files and refusals.

use crate::common::{code, fails, femdem, run, summary};
use femdem::Usage;
use femdem::run::{Run, Scenario};
use std::fs;
use tempfile::tempdir;

/// One cube is pressed until it is deformable, one lies apart; then the platen stands still.
const SCENE: &str = r#"
duration = 1e-4
every = 5e-5
gravity = [0, 0, 0]
tables = true
[contact]
penalty = 3e9
[material.rock]
density = 2500
law = "neo-hookean"
young = 2e10
poisson = 0.2
[material.rock.fracture]
tensile = 5e6
cohesion = 2e7
friction-angle = 38
energy = [40, 200]
[[wall]]
name = "floor"
plane = { normal = [0, 0, 1], offset = 0 }
[[wall]]
name = "platen"
plane = { normal = [0, 0, -1], offset = -0.01 }
[[body]]
name = "cube"
block = [3, 3, 3]
sides = [0.01, 0.01, 0.01]
material = "rock"
behaviour = "adaptive"
position = [0, 0, 0.005]
[[body]]
name = "free"
block = [3, 3, 3]
sides = [0.008, 0.008, 0.008]
material = "rock"
behaviour = "adaptive"
position = [0.03, 0, 0.005]
[[stage]]
name = "press"
wall = [{ name = "platen", motion = { linear = { velocity = [0, 0, -1] } } }]
[[stage]]
name = "hold"
duration = 2e-5
wall = [{ name = "platen", motion = { linear = { velocity = [0, 0, 0] } } }]
"#;

#[test]
fn a_stage_starts_from_bodies_that_have_become_deformable() {
    let folder = tempdir().unwrap();
    let (scene, out) = (folder.path().join("scene.toml"), folder.path().join("out"));
    fs::write(&scene, SCENE).unwrap();
    let result = run(femdem("run").arg(&scene).arg("--out").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let [press, hold] = ["press", "hold"].map(|stage| summary(&out.join(stage)));
    assert_eq!(press["fidelity"]["bodies"], 2, "{press}");
    assert_eq!(press["fidelity"]["softened"], 1, "{press}");
    // Each stage has a record of its own.
    assert_eq!(hold["fidelity"]["bodies"], 2, "{hold}");
    assert_eq!(hold["fidelity"]["softened"], 0, "{hold}");
    // A body that is whole is a piece, rigid or not.
    assert_eq!(hold["fracture"]["bodies"], 2, "{hold}");
    assert_eq!(hold["fracture"]["fragments"], 2, "{hold}");
    let share = hold["fracture"]["largest_share"].as_f64().unwrap();
    let right = 1.0 / (1.0 + 0.8_f64.powi(3));
    assert!((share - right).abs() < 1e-9, "{share} {right}");
    let table = fs::read_to_string(out.join("hold/fragments.csv")).unwrap();
    assert_eq!(table.lines().count(), 3, "{table}");
    assert_eq!(
        table.lines().filter(|line| line.starts_with("1,")).count(),
        1
    );
}

/// Stopped, written and read again every 97 steps, before and after a body has become deformable.
#[test]
fn a_run_goes_on_from_its_checkpoints_with_the_same_bits() {
    let (top, _) = SCENE.split_once("[[stage]]").unwrap();
    let offset = "offset = -0.01 }";
    let motion = "motion = { linear = { velocity = [0, 0, -1] } }";
    let text = top.replacen(offset, &format!("{offset}\n{motion}"), 1);
    let new = || Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    let folders = [tempdir().unwrap(), tempdir().unwrap()];
    let [whole, parts] = [folders[0].path(), folders[1].path()];
    let (mut one, mut other) = (new(), new());
    one.advance(whole, u64::MAX).unwrap();
    let softened = one.simulation().fidelity_summary().map(|all| all.softened);
    assert_eq!(softened, Some(1));
    while other.ending().is_none() {
        other.advance(parts, 97).unwrap();
        other.flush(parts).unwrap();
        other.save(parts, &Usage::default()).unwrap();
        (other, _) = Run::read(parts).unwrap();
    }
    let hash = |run: &Run| run.simulation().world.state_hash().unwrap();
    assert_eq!(hash(&one), hash(&other));
    assert_eq!(
        one.simulation().fidelity_summary(),
        other.simulation().fidelity_summary()
    );
}

#[test]
fn what_an_adaptive_body_cannot_have_is_refused_before_the_run() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let (top, _) = SCENE.split_once("[[stage]]").unwrap();
    let density = "[[load]]\nbodies = [\"cube\"]\nforce-density = [0, 0, 1]\nrise = 5e-5\n";
    for (text, words) in [
        (format!("{top}{density}"), ["torque", "adaptive body"]),
        (
            top.replacen("\"adaptive\"", "\"adaptive\"\ncontact-ratio = -1", 1)
                .replace("penalty = 3e9", ""),
            ["contact-ratio", "positive"],
        ),
        (
            top.replacen("penalty", "wall-response = \"mirror\"\npenalty", 1),
            ["mirror", "rigid"],
        ),
    ] {
        fs::write(&scene, text).unwrap();
        fails(femdem("run").arg(&scene).arg("--check"), &words);
    }
}
