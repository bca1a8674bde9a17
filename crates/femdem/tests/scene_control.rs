//! Walls that are moved to reach a force, a stress or a rate of strain.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::fs;

use femdem::Usage;
use femdem::run::{Ending, Run, RunSummary, Scenario};
use tempfile::{TempDir, tempdir};

fn ran(text: &str) -> (RunSummary, TempDir) {
    let folder = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    job.flush(folder.path()).unwrap();
    (RunSummary::of(&job, &Usage::default()).unwrap(), folder)
}

/// 27 grains of 20 mm in a box of 70 mm.
fn grains(control: &str, more: &str) -> String {
    format!(
        "{more}
        [contact]
        friction = 0.3
        [material.stone]
        density = 2500
        [[wall]]
        name = \"cell\"
        box = {{ lower = [0, 0, 0], upper = [0.07, 0.07, 0.07] }}
        control = {{ {control} }}
        [[body]]
        name = \"grain\"
        shape = \"A13\"
        diameter = 0.02
        material = \"stone\"
        copies = {{ count = [3, 3, 3], spacing = [0.0225, 0.0225, 0.0225], seed = 2 }}
        position = [0.012, 0.012, 0.012]"
    )
}

const ISOTROPIC: &str = "x = { stress = 1e4, speed = 0.2 }, y = { stress = 1e4, speed = 0.2 }, \
                         z = { stress = 1e4, speed = 0.2 }";

const AT_REST: &str = "duration = 2\ngravity = [0, 0, 0]\nrest = { energy = 1e-8, time = 0.005 }";

/// The stresses are those wanted, the specimen is at rest and has stayed where it was.
#[test]
fn a_cell_is_compressed_to_the_same_stress_on_all_sides() {
    let (summary, _) = ran(&grains(ISOTROPIC, AT_REST));
    assert_eq!(summary.ending, Some(Ending::Rest), "{summary}");
    let cell = &summary.cells[0];
    for axis in 0..3 {
        assert!((cell.stress[axis] / 1e4 - 1.0).abs() < 2.5e-3, "{cell:?}");
        assert!(cell.strain[axis] > 0.1, "{cell:?}");
    }
    let middle = summary
        .bodies
        .iter()
        .map(|body| body.centroid[0])
        .sum::<f64>()
        / 27.0;
    assert!((middle - 0.035).abs() < 0.003, "{middle}");
    let volume: f64 = summary.bodies.iter().map(|body| body.mass / 2500.0).sum();
    let solid = volume / cell.sides.iter().product::<f64>();
    assert!(
        (cell.solid_fraction - solid).abs() < 1e-9,
        "{cell:?} {solid}"
    );
}

/// At rest the floor carries the load, the weight, and what the sides do not take by friction.
#[test]
fn an_oedometer_balances_its_forces() {
    let control = "z = { stress = 1e4, speed = 0.2, sides = \"upper\", \
                   table = [[0, 1], [0.4, 1], [0.45, 0.4]] }";
    let text = grains(control, AT_REST).replace("gravity = [0, 0, 0]", "");
    let (summary, folder) = ran(&text);
    assert_eq!(summary.ending, Some(Ending::Rest), "{summary}");
    let mass: f64 = summary.bodies.iter().map(|body| body.mass).sum();
    let vertical: f64 = summary.walls.iter().map(|wall| wall.force[2]).sum();
    let top = summary
        .walls
        .iter()
        .find(|wall| wall.name == "cell z+")
        .unwrap();
    assert!(
        (top.force[2] / (0.4e4 * 0.07 * 0.07) - 1.0).abs() < 2.5e-3,
        "{summary}"
    );
    assert!(
        (vertical + 9.81 * mass).abs() < 1e-3 * top.force[2],
        "{vertical} {summary}"
    );
    // Loading and unloading are on record.
    let table = fs::read_to_string(folder.path().join("cells.csv")).unwrap();
    let column = |row: &str, k: usize| row.split(',').nth(k).unwrap().parse::<f64>().unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    let peak = rows.iter().map(|row| column(row, 9)).fold(0.0, f64::max);
    assert!(peak > 0.99e4, "{peak}");
    let walls = fs::read_to_string(folder.path().join("wall_history.csv")).unwrap();
    assert_eq!(walls.lines().count(), 1 + 6 * rows.len());
}

/// A force stays while the area grows under it, also on the sides of a box without a lid.
#[test]
fn an_axis_may_press_with_a_force() {
    let control = "x = { force = 30, speed = 0.2 }, z = { strain-rate = -0.3 }";
    let (summary, _) = ran(&grains(control, "duration = 0.2\ngravity = [0, 0, 0]"));
    let cell = &summary.cells[0];
    assert!(cell.sides[2] > 0.074, "{cell:?}");
    let force = cell.stress[0] * cell.sides[1] * cell.sides[2];
    assert!((force / 30.0 - 1.0).abs() < 0.02, "{force} {cell:?}");
    let error = cell.errors[0].unwrap();
    assert!(
        (error - (force / 30.0 - 1.0)).abs() < 1e-9,
        "{error} {force}"
    );

    let open = grains("x = { force = 30, speed = 0.2 }", "duration = 0.2").replace(
        "upper = [0.07, 0.07, 0.07] }",
        "upper = [0.07, 0.07, 0.07], open = true }",
    );
    let (summary, _) = ran(&open);
    let side = |name: &str| summary.walls.iter().find(|wall| wall.name == name).unwrap();
    let mean = (side("cell x+").force[0] - side("cell x-").force[0]) / 2.0;
    assert!((mean / 30.0 - 1.0).abs() < 0.02, "{mean}");
}

/// A rate of strain is kept however far the cell is squeezed: L = L0 e^(-rate t). No step is shortened for the table, whose
/// corner may be missed by one.
#[test]
fn a_rate_of_strain_is_logarithmic() {
    let control =
        "z = { strain-rate = 0.5, sides = \"lower\", table = [[0, 1], [0.1, 1], [0.2, -1]] }";
    let (summary, _) = ran(&grains(control, "duration = 0.1\ngravity = [0, 0, 0]"));
    let [x, y, z] = summary.cells[0].strain;
    assert_eq!([x, y], [0.0, 0.0]);
    assert!((z - 0.5 * summary.simulated_time).abs() < 1e-5, "{z}");
    let moved = summary.cells[0].sides[2];
    assert!(
        (moved - 0.07 * f64::exp(-0.5 * summary.simulated_time)).abs() < 1e-6,
        "{moved}"
    );
}

/// A dead load on a single cube.
#[test]
fn a_plane_presses_with_its_force() {
    let text = |control: &str| {
        format!(
            "duration = 2
            rest = {{ energy = 1e-9, time = 0.01 }}
            [material.stone]
            density = 2500
            [[wall]]
            name = \"floor\"
            plane = {{ normal = [0, 0, 1] }}
            [[wall]]
            name = \"press\"
            plane = {{ normal = [0, 0, -1], offset = -0.06 }}
            control = {{ {control} }}
            [[body]]
            shape = \"box:width=1,height=1\"
            size = 0.04
            material = \"stone\"
            position = [0, 0, 0.0201]"
        )
    };
    for control in [
        "force = 30, speed = 0.1",
        "pressure = 1e4, area = 3e-3, speed = 0.1",
    ] {
        let (summary, _) = ran(&text(control));
        assert_eq!(summary.ending, Some(Ending::Rest), "{summary}");
        let [floor, press] = [0, 1].map(|wall| summary.walls[wall].force[2]);
        assert!((press / 30.0 - 1.0).abs() < 2e-3, "{summary}");
        let weight = 9.81 * summary.bodies[0].mass;
        assert!((floor + 30.0 + weight).abs() < 0.1, "{summary}");
    }
}

/// A deformable block between two controlled walls is strained by the stress over its modulus.
#[test]
fn a_deformable_block_yields_to_the_stress() {
    let text = "duration = 1
        gravity = [0, 0, 0]
        rest = { energy = 1e-9, time = 0.01 }
        [contact]
        friction = 0
        damping = 0.5
        [medium]
        drag = 60
        [material.rubber]
        density = 1100
        law = \"neo-hookean\"
        young = 1e6
        poisson = 0.3
        [[wall]]
        name = \"cell\"
        box = { lower = [-1, -1, 0], upper = [1, 1, 0.0401] }
        [wall.control]
        z = { strain-rate = 0, sides = \"lower\" }
        [[wall]]
        name = \"press\"
        plane = { normal = [0, 0, -1], offset = -0.0401 }
        control = { pressure = 2e4, area = 1.6e-3, speed = 0.05 }
        [[body]]
        block = [3, 3, 3]
        sides = [0.04, 0.04, 0.04]
        material = \"rubber\"
        behaviour = \"deformable\"
        position = [0, 0, 0.02005]";
    let (summary, _) = ran(text);
    let press = summary
        .walls
        .iter()
        .find(|wall| wall.name == "press")
        .unwrap();
    assert!((press.force[2] / 32.0 - 1.0).abs() < 2.5e-3, "{summary}");
    assert_eq!(summary.ending, Some(Ending::Rest), "{summary}");
    // Its energy is that of a stress of 20 kPa in 6.4e-5 m³ of 1 MPa, and 4 % more of what is not linear.
    let wanted = 0.5 * 2e4 * 2e4 / 1e6 * 6.4e-5;
    assert!(
        (summary.energy.strain / wanted - 1.0).abs() < 0.05,
        "{summary}"
    );
}

/// A run of two parts, the second with other controls, has the strain of its own beginning.
#[test]
fn a_specimen_is_sheared_after_its_compression() {
    let (_, folder) = {
        let folder = tempdir().unwrap();
        let mut job = Run::new(Scenario::from_toml(&grains(ISOTROPIC, AT_REST)).unwrap()).unwrap();
        job.advance(folder.path(), u64::MAX).unwrap();
        job.flush(folder.path()).unwrap();
        job.save(folder.path(), &Usage::default()).unwrap();
        (job, folder)
    };
    let shear = "x = { stress = 1e4, speed = 0.2 }, y = { stress = 1e4, speed = 0.2 }, \
                 z = { strain-rate = 0.5 }";
    let more = format!(
        "duration = 0.1\ngravity = [0, 0, 0]\nfrom = \"{}\"",
        folder.path().display()
    );
    let text = grains(shear, &more);
    let (summary, _) = ran(&text);
    let cell = &summary.cells[0];
    assert!(
        (cell.strain[2] - 0.5 * summary.simulated_time).abs() < 1e-5,
        "{cell:?}"
    );
    assert!(cell.stress[2] > 1.2e4, "{cell:?}");
    for axis in 0..2 {
        assert!((cell.stress[axis] / 1e4 - 1.0).abs() < 0.05, "{cell:?}");
    }
    assert_eq!(ran(&text).0.state_hash, summary.state_hash);
}

/// A run that is stopped and read back goes on to the same bits.
#[test]
fn control_survives_a_checkpoint() {
    let scene = grains(ISOTROPIC, "duration = 0.05\ngravity = [0, 0, 0]");
    let folder = tempdir().unwrap();
    let new = || Run::new(Scenario::from_toml(&scene).unwrap()).unwrap();
    let mut whole = new();
    whole.advance(folder.path(), u64::MAX).unwrap();
    let mut part = new();
    part.advance(folder.path(), 300).unwrap();
    part.flush(folder.path()).unwrap();
    part.save(folder.path(), &Usage::default()).unwrap();
    let (mut again, _) = Run::read(folder.path()).unwrap();
    again.advance(folder.path(), u64::MAX).unwrap();
    let hash = |run: &Run| RunSummary::of(run, &Usage::default()).unwrap().state_hash;
    assert_eq!(hash(&whole), hash(&again));
}

#[test]
fn controls_that_mean_nothing_are_refused_by_name() {
    let refused = |control: &str| {
        let scene = Scenario::from_toml(&grains(control, "")).unwrap();
        scene.build().unwrap_err().to_string()
    };
    for (control, words) in [
        ("force = 3, speed = 1", "give them to the axes"),
        ("", "at least one of the axes"),
        ("x = { stress = 1e4 }", "speed = none"),
        ("x = { speed = 1 }", "one of stress, force and strain-rate"),
        ("x = { stress = -1, speed = 1 }", "they cannot pull"),
        (
            "x = { stress = 1, speed = -1 }",
            "positive and finite, in m/s",
        ),
        ("x = { strain-rate = 1, speed = 1 }", "for a stress only"),
        (
            "x = { stress = 1, speed = 1, table = [[0, 1], [1, -1]] }",
            "they cannot pull",
        ),
        (
            "x = { strain-rate = 1, table = [[1, 1], [0, 1]] }",
            "time between points",
        ),
    ] {
        let message = refused(control);
        assert!(
            message.contains(words) && message.contains("cell"),
            "{control}: {message}"
        );
    }
    let plane = |control: &str| {
        let text = grains("", "").replace(
            "box = { lower = [0, 0, 0], upper = [0.07, 0.07, 0.07] }",
            "plane = { normal = [0, 0, 1] }",
        );
        let text = text.replace("control = {  }", &format!("control = {{ {control} }}"));
        Scenario::from_toml(&text)
            .unwrap()
            .build()
            .unwrap_err()
            .to_string()
    };
    for (control, words) in [
        ("force = 3", "speed = none"),
        ("pressure = 3, speed = 1", "pressure together with area"),
        (
            "force = 3, speed = 1, direction = [0, 0, 0]",
            "not all zero",
        ),
        ("z = { stress = 1, speed = 1 }", "`box` only"),
    ] {
        let message = plane(control);
        assert!(message.contains(words), "{control}: {message}");
    }
    let text = grains(ISOTROPIC, "relax = {}");
    let message = Scenario::from_toml(&text)
        .unwrap()
        .build()
        .unwrap_err()
        .to_string();
    assert!(message.contains("[rest]"), "{message}");
}
