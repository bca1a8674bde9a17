//! Periodic cells in scenes.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::fs;
use std::path::Path;

use femdem::Usage;
use femdem::run::{Ending, Run, RunSummary, Scenario};
use tempfile::tempdir;

/// Runs a scene to its end in a folder, with a checkpoint at the end.
fn ran(text: &str, folder: &Path) -> Run {
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder, u64::MAX).unwrap();
    job.flush(folder).unwrap();
    job
}

fn summary(job: &Run) -> RunSummary {
    RunSummary::of(job, &Usage::default()).unwrap()
}

/// 64 grains of 20 mm.
fn grains(cell: &str, more: &str) -> String {
    format!(
        "{more}
        [contact]
        friction = 0.3
        [material.stone]
        density = 2500
        [cell]
        {cell}
        [[body]]
        name = \"grain\"
        shape = \"A13\"
        diameter = 0.02
        material = \"stone\"
        copies = {{ count = [4, 4, 4], spacing = [0.021, 0.021, 0.021], seed = 2 }}
        position = [0.0105, 0.0105, 0.0105]"
    )
}

const CUBE: &str = "upper = [0.084, 0.084, 0.084]";

const ISOTROPIC: &str = "x = { stress = 1e4, speed = 0.4 }, y = { stress = 1e4, speed = 0.4 }, \
                         z = { stress = 1e4, speed = 0.4 }";

const AT_REST: &str =
    "duration = 2\ngravity = [0, 0, 0]\nmedium.drag = 20\nrest = { energy = 1e-8, time = 0.005 }";

/// Compressed to rest under equal stresses, and sheared from there under a constant stress: the material resists, and dilates or not
/// as the cell says, whose strains are those of its rates.
#[test]
fn a_cell_is_compressed_and_sheared() {
    let folder = tempdir().unwrap();
    let first = folder.path().join("first");
    fs::create_dir_all(&first).unwrap();
    let text = grains(&format!("{CUBE}\ncontrol = {{ {ISOTROPIC} }}"), AT_REST);
    let job = ran(&text, &first);
    let pressed = summary(&job);
    assert_eq!(pressed.ending, Some(Ending::Rest), "{pressed}");
    assert!(pressed.rest.at_rest && pressed.walls.is_empty());
    let cell = &pressed.cells[0];
    for axis in 0..3 {
        assert!((cell.stress[axis] / 1e4 - 1.0).abs() < 2.5e-3, "{cell:?}");
        assert!(cell.errors[axis].unwrap().abs() < 2.5e-3, "{cell:?}");
    }
    let volume: f64 = cell.sides.iter().product();
    let mass: f64 = pressed.bodies.iter().map(|body| body.mass).sum();
    assert!((cell.solid_fraction * volume * 2500.0 / mass - 1.0).abs() < 1e-9);
    assert!(cell.solid_fraction > 0.5, "{cell:?}");
    assert!(
        pressed.energy.ledger_error_relative.abs() < 5e-3,
        "{pressed}"
    );
    // Every frame shows all bodies in the cell.
    let (lower, upper) = (0.042 - 0.5 * cell.sides[0], 0.042 + 0.5 * cell.sides[0]);
    for body in &job.simulation().rigid_snapshot().bodies {
        let x = body.pose.translation.vector.x;
        assert!(x > lower - 1e-3 && x < upper + 1e-3, "{x}");
    }
    job.save(&first, &Usage::default()).unwrap();

    let second = folder.path().join("second");
    fs::create_dir_all(&second).unwrap();
    let sheared = format!("{CUBE}\ncontrol = {{ {ISOTROPIC}, shear = {{ rate = 5 }} }}");
    let more = format!("duration = 0.04\ngravity = [0, 0, 0]\nfrom = {first:?}");
    let job = ran(&grains(&sheared, &more), &second);
    let end = summary(&job);
    let cell = &end.cells[0];
    // As the edges become shorter, the lean of edge z changes by more than its height, or less.
    let strain = cell.shear_strain.unwrap() / (5.0 * end.simulated_time);
    let uneven = (cell.strain[2] - cell.strain[0]).abs();
    assert!((strain - 1.0).abs() < 1e-3 + uneven, "{cell:?}");
    for error in cell.errors {
        assert!(error.unwrap().abs() < 0.05, "{cell:?}");
    }
    assert!(
        end.energy.work_in > 0.0 && end.energy.ledger_error_relative.abs() < 0.01,
        "{end}"
    );
    assert!(!end.rest.at_rest && end.rest.driven);
    // What is spent on the shear is dissipated: it resists in the mean.
    let rows = fs::read_to_string(second.join("cells.csv")).unwrap();
    let mut rows = rows.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let column = head
        .iter()
        .position(|name| *name == "shear_stress")
        .unwrap();
    let stresses: Vec<f64> = rows.map(|row| row[column].parse().unwrap()).collect();
    let mean = stresses.iter().sum::<f64>() / stresses.len() as f64;
    assert!(stresses.len() > 50 && mean > 100.0, "{mean}");

    // The same bits where it was interrupted.
    let third = folder.path().join("third");
    fs::create_dir_all(&third).unwrap();
    let mut job = Run::new(Scenario::from_toml(&grains(&sheared, &more)).unwrap()).unwrap();
    job.advance(&third, 200).unwrap();
    job.save(&third, &Usage::default()).unwrap();
    let (mut job, _) = Run::read(&third).unwrap();
    job.advance(&third, u64::MAX).unwrap();
    assert_eq!(summary(&job).state_hash, end.state_hash);
}

/// Soft cubes and hard grains, compressed to unequal stresses: the cell reaches them, the books close, and the solid fraction
/// includes both kinds.
#[test]
fn a_cell_of_deformable_bodies_reaches_its_stresses() {
    let folder = tempdir().unwrap();
    let text = "
        duration = 0.06
        gravity = [0, 0, 0]
        medium.drag = 20
        [contact]
        friction = 0.3
        [material.rubber]
        density = 2500
        law = \"neo-hookean\"
        young = 1e6
        poisson = 0.3
        [cell]
        upper = [0.082, 0.082, 0.082]
        control = { x = { stress = 2e4, speed = 0.8 }, y = { stress = 1e4, speed = 0.8 }, z = { stress = 2e4, speed = 0.8 } }
        [[body]]
        shape = \"cube\"
        diameter = 0.02
        material = \"rubber\"
        behaviour = \"deformable\"
        mesh-size = 1
        copies = { count = [4, 4, 2], spacing = [0.0205, 0.0205, 0.0205], seed = 2 }
        position = [0.01025, 0.01025, 0.01025]
        [[body]]
        shape = \"A13\"
        diameter = 0.02
        material = \"rubber\"
        copies = { count = [4, 4, 2], spacing = [0.0205, 0.0205, 0.0205], seed = 3 }
        position = [0.01025, 0.01025, 0.05125]";
    let end = summary(&ran(text, folder.path()));
    let cell = &end.cells[0];
    for (stress, wanted) in cell.stress.iter().zip([2e4, 1e4, 2e4]) {
        assert!((stress / wanted - 1.0).abs() < 0.01, "{cell:?}");
    }
    let volume: f64 = cell.sides.iter().product();
    let mass: f64 = end.bodies.iter().map(|body| body.mass).sum();
    assert!((cell.solid_fraction * volume * 2500.0 / mass - 1.0).abs() < 1e-9);
    let energy = &end.energy;
    assert!(
        energy.work_in > 0.0 && energy.ledger_error_relative.abs() < 2e-3,
        "{end}"
    );
    assert!(energy.strain > 0.0, "{end}");
}

/// A bed without side walls bears its weight on the floor alone.
#[test]
fn a_bed_that_is_periodic_across_rests_on_its_floor() {
    let folder = tempdir().unwrap();
    let more = "duration = 3\nrest = { energy = 1e-6, time = 0.02 }\n[[wall]]\nname = \"floor\"\nplane = { normal = [0, 0, 1] }";
    let text = grains("upper = [0.084, 0.084, 1]\naxes = \"xy\"", more);
    let job = ran(&text, folder.path());
    let end = summary(&job);
    assert_eq!(end.ending, Some(Ending::Rest), "{end}");
    let weight: f64 = end.bodies.iter().map(|body| body.mass * 9.81).sum();
    let force = end.walls[0].force;
    assert!((force[2] / weight + 1.0).abs() < 1e-3, "{force:?} {weight}");
    assert!(end.cells.is_empty());
    let highest = end
        .bodies
        .iter()
        .map(|body| body.centroid[2])
        .fold(0.0, f64::max);
    assert!(highest < 0.084, "nothing flowed away: {highest}");
}

#[test]
fn cells_that_cannot_be_are_refused_by_key() {
    let message = |cell: &str, more: &str| {
        let weightless = match more.contains("gravity") {
            true => String::new(),
            false => "gravity = [0, 0, 0]\n".to_owned(),
        };
        let scene = Scenario::from_toml(&grains(cell, &(weightless + more))).unwrap();
        let simulation = scene.build();
        let refused = simulation.and_then(|mut simulation| simulation.step());
        refused.unwrap_err().to_string()
    };
    for (cell, more, wanted) in [
        ("upper = [1, 1, 1]\naxes = \"xx\"", "", "cell.axes"),
        ("upper = [1, 1, 1]\naxes = \"xw\"", "", "cell.axes"),
        ("upper = [1, 1, 1]\naxes = \"\"", "", "cell.axes"),
        ("upper = [1, -1, 1]", "", "cell.upper"),
        ("upper = [1, inf, 1]", "", "cell.upper"),
        ("upper = [0.03, 1, 1]", "", "2.25"),
        (
            "upper = [1, 1, 1]\naxes = \"xy\"\ncontrol = { shear = { rate = 1 } }",
            "",
            "cell.control",
        ),
        ("upper = [1, 1, 1]\ncontrol = { force = 1 }", "", "control"),
        ("upper = [1, 1, 1]\ncontrol = {}", "", "control"),
        (
            "upper = [1, 1, 1]\ncontrol = { z = { strain-rate = 1, sides = \"upper\" } }",
            "",
            "control.sides",
        ),
        (
            "upper = [1, 1, 1]",
            "[[wall]]\nname = \"side\"\nplane = { normal = [1, 0, 0] }",
            "side",
        ),
        (
            "upper = [1, 1, 1]",
            "[[sink]]\nname = \"out\"\nplane = { normal = [1, 0, 0] }",
            "sink \"out\"",
        ),
        (
            "upper = [1, 1, 1]\naxes = \"xy\"",
            "[[wall]]\nplane = { normal = [0, 0, 1] }\ncontrol = { force = 1, speed = 1, shear = { rate = 1 } }",
            "control.shear",
        ),
    ] {
        let found = message(cell, more);
        assert!(found.contains(wanted), "{cell} {more}: {found}");
    }
    let weight = message(CUBE, "gravity = [0, 0, -9.81]");
    assert!(weight.contains("nothing can bear a weight"), "{weight}");
    // Deformable bodies may be in a cell that is not too small for them.
    let step = |cell: &str| {
        let soft = grains(cell, "gravity = [0, 0, 0]").replace(
            "density = 2500",
            "density = 2500\nlaw = \"neo-hookean\"\nyoung = 1e6\npoisson = 0.3",
        );
        let soft = soft.replace(
            "shape = \"A13\"",
            "shape = \"A13\"\nbehaviour = \"deformable\"",
        );
        Scenario::from_toml(&soft).unwrap().build()?.step()
    };
    step(CUBE).unwrap();
    let tight = step("upper = [0.03, 1, 1]").unwrap_err().to_string();
    assert!(tight.contains("2.25"), "{tight}");
}

/// A face-centred cubic array of balls under a stress across fails where the ratio of the stresses is 2 (1 + m)/(1 - m), with the
/// coefficient of friction m (Thornton 1979).
#[test]
fn a_regular_array_fails_at_the_ratio_of_its_friction() {
    let place = |k: usize| {
        let at = |axis| {
            if k == 0 || k == axis {
                0.0
            } else {
                0.0070710678
            }
        };
        format!(
            "[[body]]
            name = \"ball {k}\"
            shape = \"sphere\"
            diameter = 0.01
            material = \"ball\"
            position = [{}, {}, {}]
            copies = {{ count = [2, 2, 2], spacing = [0.0141421356, 0.0141421356, 0.0141421356] }}\n",
            at(1),
            at(2),
            at(3)
        )
    };
    let balls: String = (0..4).map(place).collect();
    let text = format!(
        "duration = 0.05
        history-every = 5e-4
        gravity = [0, 0, 0]
        sleeping = false
        medium.drag = 200
        [contact]
        friction = 0.25
        penalty = 1e9
        damping = 0.3
        tangential-damping = 0.3
        [material.ball]
        density = 2600
        [cell]
        upper = [0.0282842712, 0.0282842712, 0.0282842712]
        [cell.control]
        x = {{ stress = 1e4, speed = 0.02 }}
        y = {{ stress = 1e4, speed = 0.02 }}
        z = {{ strain-rate = 0.1, table = [[0, 0], [0.004, 0], [0.005, 1]] }}
        {balls}"
    );
    let folder = tempdir().unwrap();
    ran(&text, folder.path());
    let rows = fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    let mut rows = rows.lines().map(|row| row.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let column = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let (across, along) = (column("stress_x"), column("stress_z"));
    let number = |text: &str| text.parse::<f64>().unwrap();
    let ratios = rows.filter_map(|row| {
        let stress = number(row[across]);
        (stress > 9e3).then(|| number(row[along]) / stress)
    });
    let most = ratios.fold(0.0, f64::max);
    assert!(most < 3.34 && most > 0.97 * 10.0 / 3.0, "{most}");
}
