//! The meaning of a scene and the results of a run: planes, supports, overlaps, the largest values.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, femdem, run, stdout};
use femdem::Usage;
use femdem::contact::WallShape;
use femdem::run::{Run, RunSummary, Scenario};
use std::fs;
use tempfile::tempdir;

const CLAY: &str = "
[material.clay]
density = 1000
law = \"j2\"
young = 1e6
poisson = 0.3
yield-stress = 5e3
";

/// A block of 40 mm.
fn block(rest: &str) -> String {
    format!(
        "[[body]]\nname = \"soft\"\nblock = [2, 2, 2]\nsides = [0.04, 0.04, 0.04]\n\
         material = \"clay\"\nbehaviour = \"deformable\"\n{rest}\n"
    )
}

fn to_end(text: &str) -> (RunSummary, String) {
    let folder = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    job.flush(folder.path()).unwrap();
    let summary = RunSummary::of(&job, &Usage::default()).unwrap();
    let history = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    (summary, history)
}

/// The offset of a plane is a length, however long the normal is.
#[test]
fn a_normal_of_any_length_leaves_the_offset_alone() {
    for (normal, unit) in [
        ([0.0, 0.0, 2.0], [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
        ([0.0, -0.3, 0.4], [0.0, -0.6, 0.8]),
    ] {
        let text = format!(
            "{CLAY}{}[[wall]]\nname = \"floor\"\nplane = {{ normal = {normal:?}, offset = 0.1 }}\n",
            block("position = [0, 0, 9]")
        );
        let simulation = Scenario::from_toml(&text).unwrap().build().unwrap();
        let Some(WallShape::Planes(wall)) = simulation.world.wall(0) else {
            panic!("not of planes");
        };
        let plane = wall.planes()[0];
        assert!((plane.offset - 0.1).abs() < 1e-16, "{plane:?}");
        let off = (0..3).map(|k| (plane.normal[k] - unit[k]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{plane:?}");
    }
}

/// A block hangs from its upper side: its support carries its weight.
#[test]
fn a_support_bears_the_weight_of_a_hanging_body() {
    let hung = "[[body.boundary]]\nname = \"top\"\nfix = true\n\
                select = { plane = { normal = [0, 0, 1], offset = 0.02 } }\n\
                [[body.boundary]]\nfix = true\ndirections = [true, false, false]\n\
                select = { plane = { normal = [0, 0, 1], offset = -0.02 } }\n";
    let text = format!(
        "duration = 0.2\nevery = 0.1\nmedium.drag = 300\n{CLAY}{}",
        block(hung)
    );
    let (summary, history) = to_end(&text);
    let weight = 9.81 * 1000.0 * 0.04_f64.powi(3);
    let [top, bottom] = &summary.reactions[..] else {
        panic!("{:?}", summary.reactions);
    };
    assert_eq!((&*top.body, &*top.boundary), ("soft", "top"));
    assert_eq!(bottom.boundary, "boundary 2");
    let [x, y, z] = top.force;
    assert!((z / weight - 1.0).abs() < 1e-3, "{z} {weight}");
    // The sideways forces of the two supports balance.
    assert!((x + bottom.force[0]).abs() < 1e-3 * weight && y.abs() < 1e-3 * weight);
    assert_eq!(bottom.force[1..], [0.0, 0.0]);
    assert!(top.peak_force >= z && top.peak_time > 0.0);

    let mut rows = history
        .lines()
        .map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let place = header
        .iter()
        .position(|name| *name == "rz soft top")
        .unwrap();
    assert_eq!(header.last(), Some(&"rz soft boundary 2"));
    let rows: Vec<_> = rows.collect();
    assert!(rows.iter().all(|row| row.len() == header.len()));
    assert_eq!(rows[0][place], "0");
    assert_eq!(rows.last().unwrap()[place].parse(), Ok(z));
}

/// The work of the supports, computed from their forces, agrees with the ledger.
#[test]
fn a_driven_support_does_the_work_of_its_force() {
    let pulled = "[[body.boundary]]\nfix = true\n\
                  select = { plane = { normal = [0, 0, 1], offset = -0.02 } }\n\
                  [[body.boundary]]\nname = \"grip\"\n\
                  motion = { linear = { velocity = [0, 0, 0.01] } }\n\
                  select = { plane = { normal = [0, 0, 1], offset = 0.02 } }\n";
    let text = format!(
        "duration = 0.05\nevery = 0.05\nhistory-every = 1e-9\ngravity = [0, 0, 0]\n{CLAY}{}",
        block(pulled)
    );
    let (summary, history) = to_end(&text);
    let mut rows = history
        .lines()
        .map(|row| row.split(',').collect::<Vec<_>>());
    let header = rows.next().unwrap();
    let of = |name: &str| header.iter().position(|column| *column == name).unwrap();
    let (time, force) = (of("time"), of("rz soft grip"));
    let rows: Vec<[f64; 2]> = rows
        .map(|row| [time, force].map(|k| row[k].parse().unwrap()))
        .collect();
    let work: f64 = rows
        .windows(2)
        .map(|pair| 0.01 * (pair[1][0] - pair[0][0]) * 0.5 * (pair[0][1] + pair[1][1]))
        .sum();
    // The ledger also counts the kinetic energy of the gripped nodes as work, which is put in at once.
    let nodes = summary.bodies[0].mass / 4.0;
    let booked = summary.energy.work_in;
    assert!(work > 1e-6 && (work - booked).abs() < 0.02 * booked + nodes * 0.01_f64.powi(2));
}

#[test]
fn a_condition_that_holds_nothing_is_refused() {
    let fix = |name: &str, select: &str| {
        format!("[[body.boundary]]\nname = \"{name}\"\nselect = {select}\nfix = true\n")
    };
    let top = "{ plane = { normal = [0, 0, 1], offset = 0.02 } }";
    for (rest, words) in [
        (
            fix("top", top) + &fix("all", "\"all\""),
            ["soft", "\"top\"", "put it last"],
        ),
        (
            fix("a", top) + &fix("a", "\"all\""),
            ["soft", "\"a\"", "its own"],
        ),
        (
            "[[body.boundary]]\nname = \"p\"\nselect = \"skin\"\npressure = 1\n".to_owned(),
            ["soft", "boundary.name = \"p\"", "fix or motion"],
        ),
    ] {
        let scenario = Scenario::from_toml(&format!("{CLAY}{}", block(&rest))).unwrap();
        let message = scenario.build().unwrap_err().to_string();
        for word in words {
            assert!(message.contains(word), "{word:?} is not in: {message}");
        }
    }
}

/// Bodies that begin deep in each other or in a wall are named.
#[test]
fn deep_overlaps_at_the_start_are_told() {
    let folder = tempdir().unwrap();
    let cube = |name: &str, z: f64| {
        format!(
            "[[body]]\nname = \"{name}\"\nshape = \"box:width=1,height=1\"\nsize = 0.04\nmaterial = \"stone\"\n\
             position = [0, 0, {z}]\n"
        )
    };
    let soft = |z: f64| block(&format!("position = [0, 0, {z}]"));
    let both = CLAY.to_owned() + "[material.stone]\ndensity = 2500\n";
    let stone = "[material.stone]\ndensity = 2500\n".to_owned();
    for (bodies, told) in [
        (
            both.clone() + &soft(0.0201) + &cube("hard", 0.0402 + 0.02),
            None,
        ),
        (
            both.clone() + &soft(0.0201) + &cube("hard", 0.05),
            Some(["\"hard\"", "\"soft\""]),
        ),
        (
            stone.clone() + &cube("a", 0.0201) + &cube("b", 0.05),
            Some(["\"a\"", "\"b\""]),
        ),
        (
            stone.clone() + &cube("a", 0.01),
            Some(["\"floor\"", "\"a\""]),
        ),
        (stone + &cube("a", -1.0), Some(["\"floor\"", "\"a\""])),
        (
            CLAY.to_owned() + &soft(-0.021),
            Some(["\"floor\"", "\"soft\""]),
        ),
        (
            CLAY.to_owned() + &soft(0.01),
            Some(["\"floor\"", "\"soft\""]),
        ),
    ] {
        let floor = "[[wall]]\nname = \"floor\"\nplane = { normal = [0, 0, 1] }\n";
        let scene = folder.path().join("scene.toml");
        fs::write(&scene, format!("duration = 1e-4\n{bodies}{floor}")).unwrap();
        let out = folder.path().join("out");
        for options in [["-q", "--force"], ["-q", "--check"]] {
            let mut command = femdem("run");
            let result = run(command.arg(&scene).args(options).arg("--out").arg(&out));
            let text = String::from_utf8_lossy(&result.stderr);
            assert_eq!(
                text.contains("overlap at the start"),
                told.is_some(),
                "{bodies}: {text}"
            );
            for name in told.iter().flatten() {
                assert!(text.contains(name), "{text}");
            }
        }
    }
}

/// The summary states the largest plastic strain of each body, the deepest contact, and how far the last step
/// went beyond the duration.
#[test]
fn the_summary_has_the_largest_values() {
    let folder = tempdir().unwrap();
    let text = format!(
        "duration = 0.01\n{CLAY}[[wall]]\nname = \"floor\"\nplane = {{ normal = [0, 0, 1] }}\n{}",
        block("position = [0, 0, 0.0201]\nvelocity = [0, 0, -2]")
    );
    let (summary, _) = to_end(&text);
    let strain = summary.bodies[0].max_plastic_strain.unwrap();
    assert!(strain > 1e-3, "{strain}");
    let deep = summary.penetration.unwrap();
    assert!(
        deep.peak >= deep.now && deep.peak > 1e-5 && deep.peak < 0.01,
        "{deep:?}"
    );
    assert!(deep.peak_time > 0.0 && deep.peak_time <= summary.simulated_time);
    assert_eq!(deep.peak_between, ["floor", "soft"]);
    assert_eq!(summary.duration, 0.01);
    let beyond = summary.simulated_time - summary.duration;
    assert!((0.0..summary.time_step).contains(&beyond), "{beyond}");

    let scene = folder.path().join("scene.toml");
    fs::write(&scene, text).unwrap();
    let out = folder.path().join("out");
    let result = run(femdem("run").arg(&scene).arg("--out").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    for words in [
        "s beyond the duration",
        "plastic strain",
        "of floor and soft",
    ] {
        assert!(
            stdout(&result).contains(words),
            "{words}: {}",
            stdout(&result)
        );
    }
}

/// Deformable bodies at rest are frozen if the scene says so, which frames show; a scene in which that has no
/// effect is refused.
#[test]
fn deformable_bodies_sleep_if_asked_for() {
    let scene = |keys: &str, body: &str| {
        let text = format!(
            "duration = 0.8\nevery = 0.8\n{keys}\n{CLAY}{body}[[wall]]\nname = \"floor\"\nplane = {{ normal = [0, 0, 1] }}\n"
        );
        Scenario::from_toml(&text).unwrap()
    };
    let soft = block("position = [0, 0, 0.021]");
    let awake = |keys: &str| {
        let folder = tempdir().unwrap();
        let mut job = Run::new(scene(keys, &soft)).unwrap();
        // Near its end nothing sleeps.
        while job.simulation().world.time() < 0.5 {
            job.advance(folder.path(), 8).unwrap();
        }
        let mut frame = Vec::new();
        job.simulation().write_deformables(&mut frame).unwrap();
        let frame = String::from_utf8(frame).unwrap();
        assert!(frame.contains("Name=\"sleeping\""), "{frame}");
        // Bytes that are all 1, in base64.
        let shown = frame.contains("AQEBAQEB");
        (job.simulation().world.awake_deformable_count(), shown)
    };
    assert_eq!(awake(""), (1, false));
    assert_eq!(awake("sleeping-deformables = true"), (0, true));
    let hard = soft.replace("deformable", "rigid");
    for (keys, body) in [
        ("sleeping-deformables = true", &hard),
        ("sleeping = false\nsleeping-deformables = true", &soft),
    ] {
        let message = scene(keys, body).build().unwrap_err().to_string();
        assert!(message.contains("sleeping-deformables"), "{message}");
    }
}

/// A mesh that cuts off corners is as heavy as what its surface encloses, deformable as rigid.
#[test]
fn a_body_weighs_the_same_whether_it_deforms_or_not() {
    for shape in ["boulder", "sphere:level=2", "dolos"] {
        let mass = |behaviour: &str| {
            let text = format!(
                "duration = 1\n{CLAY}[[body]]\nshape = \"{shape}\"\nsize = 0.05\nmaterial = \"clay\"\n\
                 behaviour = \"{behaviour}\"\n"
            );
            let simulation = Scenario::from_toml(&text).unwrap().build().unwrap();
            simulation.bodies()[0].mass
        };
        let (rigid, soft) = (mass("rigid"), mass("deformable"));
        assert!(
            (soft / rigid - 1.0).abs() < 1e-12,
            "{shape}: {rigid} {soft}"
        );
    }
}

/// A rigid body named a sphere is the exact ball, one with a level a polyhedron, and one that deforms is meshed.
#[test]
fn a_rigid_sphere_without_a_level_is_a_ball() {
    let ball = std::f64::consts::FRAC_PI_6 * 0.05_f64.powi(3);
    for (shape, behaviour, least, most) in [
        ("sphere", "rigid", 1.0 - 1e-12, 1.0 + 1e-12),
        ("sphere:level=3", "rigid", 0.99, 0.993),
        ("sphere", "deformable", 0.99, 0.993),
    ] {
        let text = format!(
            "duration = 1\n{CLAY}[[body]]\nshape = \"{shape}\"\nsize = 0.05\nmaterial = \"clay\"\n\
             behaviour = \"{behaviour}\"\n"
        );
        let simulation = Scenario::from_toml(&text).unwrap().build().unwrap();
        let share = simulation.bodies()[0].mass / (1000.0 * ball);
        assert!(
            (least..most).contains(&share),
            "{shape}, {behaviour}: {share}"
        );
    }
}

/// A parameter that is out of its range is no file, though a point stands in it.
#[test]
fn a_parameter_out_of_range_is_named() {
    let text = format!(
        "duration = 1\n{CLAY}[[body]]\nshape = \"cylinder:aspect=0.001\"\nsize = 0.05\nmaterial = \"clay\"\n"
    );
    let error = Scenario::from_toml(&text)
        .unwrap()
        .build()
        .map(|_| ())
        .unwrap_err();
    assert!(error.to_string().contains("0.02 to 50"), "{error}");
}

/// Rigid bodies have the numbers of the scene in their frames, as contacts have.
#[test]
fn rigid_frames_number_bodies_as_the_scene_does() {
    let text = format!(
        "duration = 1\n{CLAY}{}[[body]]\nshape = \"P5\"\ndiameter = 0.05\nmaterial = \"clay\"\nposition = [0, 0, 1]\n",
        block("position = [0, 0, 9]")
    );
    let simulation = Scenario::from_toml(&text).unwrap().build().unwrap();
    assert_eq!(simulation.rigid_snapshot().bodies[0].sequence, 1);
    let mut of_scene = Vec::new();
    simulation.write_rigid(&mut of_scene).unwrap();
    let mut alone = Vec::new();
    femdem::output::vtu::write(&simulation.rigid_snapshot(), &mut alone).unwrap();
    assert!(of_scene.len() == alone.len() && of_scene != alone);
}

/// The numbers of a law are checked, though only rigid bodies are made of it.
#[test]
fn laws_of_rigid_bodies_are_checked() {
    let text = format!(
        "duration = 1\n{}[[body]]\nshape = \"P5\"\ndiameter = 0.05\nmaterial = \"clay\"\n",
        CLAY.replace("young = 1e6", "young = -5")
    );
    let error = Scenario::from_toml(&text).unwrap().build().map(|_| ());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("clay") && error.contains("-5"), "{error}");
}
