//! Powders in scenes: the law with a cap, and the forces on a die.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::Usage;
use femdem::fem::material::{AnyMaterial, Deformation, DruckerPragerCap, Material};
use femdem::mesh::{Matrix3, Vector3};
use femdem::run::{Run, RunSummary, Scenario, WALL_HISTORY_COLUMNS};
use std::fs;
use tempfile::tempdir;

const SIDE: f64 = 0.01;
const STROKE: f64 = 0.003;

/// A cube of powder in a square die without friction, of which the upper punch moves once and stays at the end.
const PRESS: &str = r#"
duration = 0.005
every = 0.005
history-every = 0.0005
gravity = [0, 0, 0]
contact.friction = 0
[material.powder]
density = 2000
law = "drucker-prager-cap"
young = 1e8
poisson = 0.2
cohesion = 5e4
friction-angle = 60
cap-eccentricity = 0.6
yield-pressure = [[0, 1e5], [0.1, 3e5], [0.4, 3e6]]
[[wall]]
name = "die"
cylinder = { diameter = 0.01, from = [0, 0, -0.01], to = [0, 0, 0.01], facets = 4 }
[[wall]]
name = "lower"
plane = { normal = [0, 0, 1], offset = -0.005 }
[[wall]]
name = "upper"
plane = { normal = [0, 0, -1], offset = -0.005 }
motion = { shake = { stroke = [0, 0, -0.003], frequency = 100 } }
[[body]]
name = "tablet"
block = [2, 2, 2]
sides = [0.01, 0.01, 0.01]
material = "powder"
behaviour = "deformable"
"#;

/// Axial and radial true stress of the law itself after compression in a die.
fn point() -> [f64; 2] {
    let table = vec![[0.0, 1e5], [0.1, 3e5], [0.4, 3e6]];
    let beta = 60_f64.to_radians();
    let law = DruckerPragerCap::new(1e8, 0.2, 5e4, beta, 0.6, table).unwrap();
    let law = AnyMaterial::from(law);
    let mut old = vec![0.0; law.history_len()];
    let mut cauchy = Matrix3::zeros();
    for step in 1..=1000 {
        let height = 1.0 - STROKE / SIDE * f64::from(step) / 1000.0;
        let d = Deformation::at_rest(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, height)));
        let mut new = old.clone();
        let response = law.respond(&d, &old, &mut new).unwrap();
        cauchy = response.piola * d.gradient.transpose() / height;
        old = new;
    }
    [-cauchy.m33, -cauchy.m11]
}

/// The punches bear the axial stress and the sides of the die the radial one, though their forces cancel; and the state is
/// the same, bit for bit, through a checkpoint.
#[test]
fn a_die_bears_the_stress_of_the_law() {
    let ran = |stop: Option<u64>| {
        let folder = tempdir().unwrap();
        let mut job = Run::new(Scenario::from_toml(PRESS).unwrap()).unwrap();
        if let Some(steps) = stop {
            job.advance(folder.path(), steps).unwrap();
            job.flush(folder.path()).unwrap();
            job.save(folder.path(), &Usage::default()).unwrap();
            job = Run::read(folder.path()).unwrap().0;
        }
        job.advance(folder.path(), u64::MAX).unwrap();
        job.flush(folder.path()).unwrap();
        let walls = fs::read_to_string(folder.path().join("wall_history.csv")).unwrap();
        let summary = RunSummary::of(&job, &Usage::default()).unwrap();
        (summary, walls)
    };
    let (summary, walls) = ran(None);
    assert!(summary.warnings.is_empty(), "{summary}");
    let column = WALL_HISTORY_COLUMNS
        .iter()
        .position(|name| *name == "pressing")
        .unwrap();
    let last = |name: &str| {
        let row = walls
            .lines()
            .rfind(|row| row.split(',').nth(1) == Some(name));
        let value = row.and_then(|row| row.split(',').nth(column));
        value.unwrap().parse::<f64>().unwrap()
    };
    let [axial, radial] = point();
    let sides = 4.0 * SIDE * (SIDE - STROKE);
    for (name, stress, area) in [
        ("upper", axial, SIDE * SIDE),
        ("lower", axial, SIDE * SIDE),
        ("die", radial, sides),
    ] {
        let ratio = last(name) / (stress * area);
        println!("{name}: {ratio}");
        assert!((ratio - 1.0).abs() < 0.02, "{name}: {ratio}");
    }
    let die = summary
        .walls
        .iter()
        .find(|wall| wall.name == "die")
        .unwrap();
    assert!(die.force.iter().all(|f| f.abs() < 0.01 * last("die")));
    let depth = summary.penetration.as_ref().unwrap().now;
    assert!(depth < 0.01 * SIDE, "{depth}");
    let plastic = summary.bodies[0].max_plastic_strain.unwrap();
    assert!(plastic > 0.25 && plastic < 0.36, "{plastic}");
    assert_eq!(ran(Some(700)).0.state_hash, summary.state_hash);
}
