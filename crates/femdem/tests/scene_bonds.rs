//! Bonds in scenes: an agglomerate, its files, and faults by name.

use std::fs;

use femdem::run::{BOND_COLUMNS, Run, Scenario};

const SCENE: &str = r#"
duration = 4e-4
every = 2e-4
[material.grain]
density = 2500
[[wall]]
name = "plate"
plane = { normal = [0, 0, 1] }
[[body]]
name = "grain"
shape = "sphere"
size = 0.002
material = "grain"
position = [0, 0, 0.00101]
velocity = [20, 0, -20]
copies = { count = [2, 2, 3], spacing = [0.002, 0.002, 0.002] }
[[bond]]
between = ["grain", "grain"]
gap = 1e-6
ratio = 0.5
tensile = 1e6
cohesion = 3e6
energy = [2, 10]
stiffness = 1e12
damping = 0.05
"#;

#[test]
fn an_agglomerate_has_its_bonds_in_all_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let scenario = Scenario::from_toml(SCENE).unwrap();
    let mut run = Run::new(scenario).unwrap();
    while run.ending().is_none() {
        run.advance(path, 100).unwrap();
    }
    let summary = run.finish(path, &femdem::Usage::default()).unwrap();
    let bonds = summary.bonds.unwrap();
    // Four in each of three layers, and four between two layers.
    assert_eq!(bonds.count, 20);
    assert!(bonds.broken > 0 && bonds.pieces > 1, "{bonds:?}");
    let table = fs::read_to_string(path.join("bonds.csv")).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next().unwrap(), BOND_COLUMNS.join(","));
    assert_eq!(lines.count(), 20);
    let history = fs::read_to_string(path.join("history.csv")).unwrap();
    let ends = format!(",{},{}", bonds.count - bonds.broken, bonds.broken);
    assert!(history.lines().last().unwrap().contains(&ends), "{history}");
    assert!(path.join("frames/bonds-00002.vtp").exists() && path.join("bonds.pvd").exists());
    assert!(summary.energy.ledger_error_relative.abs() < 1e-3);
}

#[test]
fn faults_of_bonds_are_named() {
    for (from, to, words) in [
        (
            "tensile = 1e6",
            "tensile = -1",
            "tensile strength of the bond = -1",
        ),
        ("energy = [2, 10]", "energy = [0.4, 10]", "raise the energy"),
        (
            "[\"grain\", \"grain\"]",
            "[\"grain\", \"stone\"]",
            "between = \"stone\"",
        ),
        (
            "spacing = [0.002, 0.002, 0.002]",
            "spacing = [0.003, 0.003, 0.003]",
            "gap = 0.000001",
        ),
    ] {
        let scenario = Scenario::from_toml(&SCENE.replace(from, to)).unwrap();
        let message = scenario.build().unwrap_err().to_string();
        assert!(
            message.contains(words) && message.contains("bond 1"),
            "{message}"
        );
    }
}
