//! Bonds in scenes: an agglomerate, its files, and faults by name.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

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

/// The number in a row and a column of a table; the header is row 0.
fn value(table: &str, row: usize, column: &str) -> f64 {
    let mut lines = table.lines();
    let mut names = lines.clone().next().unwrap().split(',');
    let at = names.position(|name| name == column).unwrap();
    let row = lines.nth(row).unwrap();
    row.split(',').nth(at).unwrap().parse().unwrap()
}

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
    let [first, last] = [1, history.lines().count() - 1]
        .map(|row| ["bonds_holding", "bonds_broken"].map(|name| value(&history, row, name)));
    assert_eq!(first, [20.0, 0.0]);
    let ends = [bonds.count - bonds.broken, bonds.broken];
    assert_eq!(last, ends.map(|count| count as f64));
    assert!(path.join("frames/bonds-00002.vtp").exists() && path.join("bonds.pvd").exists());
    assert!(summary.energy.ledger_error_relative.abs() < 1e-3);
}

/// The files of bonds are those of the scene, also when all bodies have left: nothing of an earlier state stays in them.
#[test]
fn bonds_that_left_with_their_bodies_are_in_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // They fly up, and beyond the sink after the first frame.
    let scene = SCENE.replace("velocity = [20, 0, -20]", "velocity = [0, 0, 30]");
    let sink = "[[sink]]\nplane = { normal = [0, 0, -1], offset = -0.006 }\n";
    let mut run = Run::new(Scenario::from_toml(&(scene + sink)).unwrap()).unwrap();
    while run.ending().is_none() {
        run.advance(path, 100).unwrap();
    }
    let summary = run.finish(path, &femdem::Usage::default()).unwrap();
    assert_eq!(run.simulation().world.body_count(), 0);
    let bonds = summary.bonds.unwrap();
    assert_eq!(
        (bonds.count, bonds.pieces, bonds.largest_share),
        (0, 0, 0.0)
    );
    let table = fs::read_to_string(path.join("bonds.csv")).unwrap();
    assert_eq!(table.trim_end(), BOND_COLUMNS.join(","));
    let list = fs::read_to_string(path.join("bonds.pvd")).unwrap();
    assert_eq!(list.matches("frames/bonds-").count(), 3, "{list}");
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

/// Two entries that bond a pair would double its mortar, and relaxations know no bonds: both are refused when the scene is built.
#[test]
fn pairs_bonded_twice_and_relaxations_are_refused() {
    let entry = &SCENE[SCENE.find("[[bond]]").unwrap()..];
    let refused = |scene: &str| {
        let scenario = Scenario::from_toml(scene).unwrap();
        scenario.build().unwrap_err().to_string()
    };
    let twice = refused(&format!("{SCENE}{entry}"));
    for words in ["bond 2", "between", "grain 1", "twice the mortar"] {
        assert!(twice.contains(words), "{words}: {twice}");
    }
    let relaxed = refused(&format!("{SCENE}[relax]\n"));
    assert!(
        relaxed.contains("relax") && relaxed.contains("[[bond]]"),
        "{relaxed}"
    );
}
