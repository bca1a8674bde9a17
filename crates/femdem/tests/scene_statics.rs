//! Scenes that end in equilibrium, their stresses, and mass scaling.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::Usage;
use femdem::mesh::nalgebra::Unit;
use femdem::mesh::{Rotation, Vector3};
use femdem::run::{Run, RunSummary, Scenario};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

const GEL: &str = "
[material.gel]
density = 1000
law = \"neo-hookean\"
young = 1e6
poisson = 0.3
";

/// A block of 40 mm.
fn block(rest: &str) -> String {
    format!(
        "[[body]]\nname = \"soft\"\nblock = [2, 2, 2]\nsides = [0.04, 0.04, 0.04]\n\
         material = \"gel\"\nbehaviour = \"deformable\"\n{rest}\n"
    )
}

fn to_end(text: &str, folder: &Path) -> RunSummary {
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder, u64::MAX).unwrap();
    job.finish(folder, &Usage::default()).unwrap()
}

/// The numbers of an array of a VTK file.
fn array(path: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap();
    let tag = text
        .split('<')
        .find(|tag| tag.contains(&format!("Name=\"{name}\"")))
        .unwrap();
    let offset = tag.split("offset=\"").nth(1).unwrap();
    let offset: usize = offset.split('"').next().unwrap().parse().unwrap();
    let data = text.split("\n_").nth(1).unwrap();
    let bytes = decoded(&data.as_bytes()[offset..]);
    let (count, values) = bytes.split_at(8);
    let count = u64::from_le_bytes(count.try_into().unwrap()) as usize;
    let numbers = values[..count].chunks_exact(8);
    numbers
        .map(|number| f64::from_le_bytes(number.try_into().unwrap()))
        .collect()
}

/// Base64, to the first padding or the end.
fn decoded(text: &[u8]) -> Vec<u8> {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let sixes = text
        .iter()
        .map_while(|letter| alphabet.iter().position(|known| known == letter));
    let sixes: Vec<u8> = sixes.map(|six| six as u8).collect();
    let bytes = sixes.chunks(4).flat_map(|four| {
        let at = |k: usize| four.get(k).copied().unwrap_or(0);
        let bytes = [
            at(0) << 2 | at(1) >> 4,
            at(1) << 4 | at(2) >> 2,
            at(2) << 6 | at(3),
        ];
        bytes.into_iter().take(four.len() - 1)
    });
    bytes.collect()
}

/// A block that is turned and pulled along its own x axis n with a stress t has the stress t n n^T.
#[test]
fn the_stress_of_a_bar_under_tension_is_in_the_frames() {
    let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, -2.0));
    let n = Rotation::from_axis_angle(&axis, 50_f64.to_radians()) * Vector3::x();
    let end = |side: f64| {
        let pull: [f64; 3] = (n * (side * 1e3)).into();
        format!(
            "[[body.boundary]]\ntraction = {pull:?}\nrise = 1e-3\n\
             select = {{ plane = {{ normal = [1, 0, 0], offset = {} }} }}\n",
            0.02 * side
        )
    };
    let turned = "rotation = { axis = [1, 2, -2], angle = 50 }\n";
    let text = format!(
        "duration = 1e-3\nevery = 1e-3\ngravity = [0, 0, 0]\nrelax.tolerance = 1e-3\n{GEL}{}",
        block(&format!("{turned}{}{}", end(1.0), end(-1.0)))
    );
    let folder = tempdir().unwrap();
    let summary = to_end(&text, folder.path());
    assert!(summary.relaxed.unwrap().converged);
    let last = format!("frames/deformable-{:05}.vtu", summary.frames - 1);
    let stress = array(&folder.path().join(last), "stress");
    assert_eq!(stress.len(), 6 * summary.tetrahedra);
    let order = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];
    for of_element in stress.chunks_exact(6) {
        for ((i, j), found) in order.into_iter().zip(of_element) {
            let wanted = 1e3 * n[i] * n[j];
            // Strains are of a thousandth.
            assert!((found - wanted).abs() < 5.0, "{i}{j}: {found} {wanted}");
        }
    }
}

/// A relaxed block presses on the floor with its weight; in parts or at once it ends with the same bits.
#[test]
fn a_relaxed_body_stands_on_the_floor_with_its_weight() {
    let text = format!(
        "duration = 1e-3\nrelax = {{}}\n[[wall]]\nname = \"floor\"\nplane = {{ normal = [0, 0, 1] }}\n{GEL}{}",
        block("position = [0, 0, 0.02]")
    );
    let folder = tempdir().unwrap();
    let summary = to_end(&text, folder.path());
    let relaxed = summary.relaxed.unwrap();
    assert!(relaxed.converged && relaxed.residual <= 1e-4, "{relaxed:?}");
    let weight = 9.81 * 1000.0 * 0.04_f64.powi(3);
    // It pushes the floor down.
    let pushed = -summary.walls[0].force[2];
    assert!((pushed / weight - 1.0).abs() < 1e-3, "{pushed} {weight}");
    assert_eq!(summary.energy.kinetic, 0.0);
    assert!(summary.time_step > 0.0);
    assert!(summary.energy.ledger_error_relative.abs() < 0.02);
    assert!(summary.to_string().contains("in equilibrium after"));
    assert!(!summary.to_string().contains("NOT"));
    // One row at the end of the motion, and one of the equilibrium.
    let history = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let times: Vec<f64> = history
        .lines()
        .skip(1)
        .map(|row| row.split(',').next().unwrap().parse().unwrap())
        .collect();
    assert_eq!(times.iter().filter(|time| **time > 1.1e-3).count(), 1);
    assert_eq!(times.last(), Some(&summary.simulated_time));

    let by_parts = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    while job.ending().is_none() {
        job.advance(by_parts.path(), 1).unwrap();
    }
    let same = job.finish(by_parts.path(), &Usage::default()).unwrap();
    assert_eq!(same.state_hash, summary.state_hash);
}

#[test]
fn a_relaxation_that_does_not_end_is_told() {
    let text = format!(
        "duration = 1e-3\nrelax.steps = 40\n[[wall]]\nplane = {{ normal = [0, 0, 1] }}\n{GEL}{}",
        block("position = [0, 0, 0.02]")
    );
    let folder = tempdir().unwrap();
    let summary = to_end(&text, folder.path());
    let relaxed = summary.relaxed.unwrap();
    assert!(!relaxed.converged && relaxed.residual > 1e-4 && relaxed.steps == 40);
    assert!(summary.to_string().contains("NOT in equilibrium"));
}

#[test]
fn what_still_moves_or_grows_is_not_relaxed() {
    let scene = |relax: &str, more: &str| format!("duration = 0.3\nrelax.{relax}\n{GEL}{more}");
    let wall = |motion: &str| {
        let body = block("");
        format!(
            "[[wall]]\nplane = {{ normal = [0, 0, 1], offset = -1 }}\nmotion = {{ {motion} }}\n{body}"
        )
    };
    let top = "select = { plane = { normal = [0, 0, 1], offset = 0.02 } }";
    let node = |what: &str| block(&format!("[[body.boundary]]\n{what}\n{top}\n"));
    let three = "shake = { stroke = [1, 0, 0], frequency = 10, periods = 3 }";
    let taps = |taps: u32| {
        format!("tap = {{ stroke = [0, 0, 0.1], frequency = 10, interval = 0.2, taps = {taps} }}")
    };
    let refused = |text: &str, words: &[&str]| {
        let message = Run::new(Scenario::from_toml(text).unwrap());
        let message = message.unwrap_err().to_string();
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    };
    let usual = "steps = 9";
    refused(
        &scene("tolerance = 0", &block("")),
        &["relax.tolerance", "0"],
    );
    refused(
        &scene("steps = 0", &block("")),
        &["relax.steps", "at least 1"],
    );
    refused(
        &scene(usual, &wall("linear = { velocity = [0, 0, 1] }")),
        &["motion", "without end"],
    );
    refused(&scene(usual, &wall(&taps(3))), &["motion", "0.5"]);
    refused(
        &scene(
            usual,
            &node("motion = { linear = { velocity = [0, 0, 1], end = 0.4 } }"),
        ),
        &["motion", "0.4"],
    );
    refused(
        &scene(usual, &node("pressure = 1\nrise = 0.5")),
        &["rise", "0.5"],
    );
    refused(
        &scene(usual, &node("pressure = 1\ntable = [[0, 1], [0.7, 0]]")),
        &["table", "0.7"],
    );
    for fine in [
        wall(three),
        wall(&taps(2)),
        node("pressure = 1\nrise = 0.3"),
    ] {
        assert!(Run::new(Scenario::from_toml(&scene(usual, &fine)).unwrap()).is_ok());
    }
}

/// The added mass of a bar scaled to twice its step is reported, and the step is reached.
#[test]
fn mass_scaling_reaches_its_step_and_says_what_it_adds() {
    let of = |body: &str| {
        let text = format!("duration = 1e-4\ngravity = [0, 0, 0]\n{GEL}{}", block(body));
        let folder = tempdir().unwrap();
        to_end(&text, folder.path())
    };
    let plain = of("");
    let critical = plain.time_step / 0.9;
    let scaled = of(&format!("mass-scaling = {}", 2.0 * critical));
    // Steps are of levels of one hundredth.
    let gain = scaled.time_step / plain.time_step;
    assert!((1.95..2.02).contains(&gain), "{gain}");
    let [before, after] = [&plain, &scaled].map(|summary| &summary.bodies[0]);
    assert_eq!(before.added_mass, 0.0);
    let added = after.mass - before.mass;
    assert!((after.added_mass / added - 1.0).abs() < 1e-12);
    assert!(added > before.mass && scaled.to_string().contains("added by scaling"));
    let message = |text: &str| {
        let scenario = Scenario::from_toml(&format!("{GEL}{}", block(text))).unwrap();
        Run::new(scenario).unwrap_err().to_string()
    };
    assert!(message("mass-scaling = 0").contains("mass-scaling"));
    let rigid = format!("{GEL}[[body]]\nshape = \"cube\"\nmaterial = \"gel\"\nmass-scaling = 1\n");
    let rigid = Run::new(Scenario::from_toml(&rigid).unwrap()).unwrap_err();
    assert!(rigid.to_string().contains("a rigid body has none"));
}
