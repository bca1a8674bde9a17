//! Walls of revolution in scenes: what they hold, what they let through, and what is refused.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::picture::PictureOptions;
use femdem::run::{Run, Scenario, Stage};
use std::path::PathBuf;
use tempfile::tempdir;

/// A ball of 20 mm and 9.2 g in a scene with some walls.
fn scene(ball: &str, rest: &str) -> String {
    format!(
        "duration = 0.3
        sleeping = false
        contact.friction = 0.3
        [material.m]
        density = 2200
        [[body]]
        name = \"ball\"
        shape = \"sphere\"
        diameter = 0.02
        material = \"m\"
        {ball}
        {rest}"
    )
}

fn run(text: &str) -> Run {
    let folder = tempdir().unwrap();
    let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    run.advance(folder.path(), u64::MAX).unwrap();
    run
}

/// Where the ball is in the end, m.
fn end(text: &str) -> [f64; 3] {
    let run = run(text);
    run.simulation().world.position(0).unwrap().into()
}

const RADIUS: f64 = 0.01;

/// A ball between an end and the mantle stands where they meet, whatever the direction of the axis; where there is no end it
/// falls out.
#[test]
fn a_tube_holds_where_it_has_an_end() {
    let at = "position = [0.02, 0, 0.05]";
    for (ends, holds) in [
        ("ends = \"none\"", false),
        ("ends = \"to\"", false),
        ("ends = \"from\"", true),
        ("ends = \"both\"", true),
    ] {
        let tube = format!(
            "[[wall]]\ncylinder = {{ diameter = 0.1, from = [0, 0, 0], to = [0, 0, 0.2], {ends} }}"
        );
        let [x, _, z] = end(&scene(at, &tube));
        assert_eq!(z > 0.0, holds, "{ends}: {z}");
        if holds {
            assert!(
                (z - RADIUS).abs() < 2e-4 && (x - 0.02).abs() < 1e-3,
                "{x} {z}"
            );
        }
    }
    // Upside down, the end at `to` is the floor; lying, the mantle is.
    for (points, height) in [
        ("from = [0, 0, 0.2], to = [0, 0, 0], ends = \"to\"", RADIUS),
        ("from = [-0.1, 0, 0.05], to = [0.1, 0, 0.05]", RADIUS),
        (
            "from = [-0.1, 0, 0.05], to = [0.1, 0, 0.05], ends = \"both\"",
            RADIUS,
        ),
    ] {
        let tube = format!("[[wall]]\ncylinder = {{ diameter = 0.1, {points} }}");
        let [_, y, z] = end(&scene(at, &tube));
        assert!(
            (z - height).abs() < 2e-4 && y.abs() < 1e-3,
            "{points}: {y} {z}"
        );
    }
}

/// A ball on the axis of a hopper rests where the cone is as wide as it, and passes an outlet that is wider.
#[test]
fn a_silo_lets_through_what_its_outlet_is_wider_than() {
    let at = "position = [0, 0, 0.06]";
    // The sphere touches a cone of the half angle a at the height h above its apex, where R = h sin a.
    let half = 30.0_f64.to_radians();
    let apex = -0.5 * 0.012 / half.tan();
    let rests = apex + RADIUS / half.sin();
    for (form, height) in [
        (
            "silo = { diameter = 0.1, height = 0.1, outlet = 0.012, half-angle = 30 }",
            Some(rests),
        ),
        (
            "silo = { diameter = 0.1, outlet = 0.012, half-angle = 30 }",
            Some(rests),
        ),
        (
            "cone = { diameters = [0.012, 0.1], from = [0, 0, 0], to = [0, 0, 0.07621023553] }",
            Some(rests),
        ),
        (
            "silo = { diameter = 0.1, height = 0.1, outlet = 0, half-angle = 90 }",
            Some(RADIUS),
        ),
        (
            "silo = { diameter = 0.1, height = 0.1, outlet = 0.022, half-angle = 30 }",
            None,
        ),
        (
            "silo = { diameter = 0.1, height = 0.1, outlet = 0.022, half-angle = 90 }",
            None,
        ),
        (
            "plate = { diameter = 0.04, centre = [0, 0, 0.001] }",
            Some(0.001 + RADIUS),
        ),
    ] {
        let [x, y, z] = end(&scene(at, &format!("[[wall]]\n{form}")));
        match height {
            Some(height) => {
                assert!((z - height).abs() < 3e-4, "{form}: {z} {height}");
                assert!(x.hypot(y) < 1e-4, "{form}: {x} {y}");
            }
            None => assert!(z < -0.1, "{form}: {z}"),
        }
    }
}

/// Friction with the turning mantle carries a ball up on the rising side, which is -x for a turn about +y.
#[test]
fn a_drum_takes_its_filling_along() {
    for ends in ["both", "none"] {
        let drum = format!(
            "[[wall]]
            cylinder = {{ diameter = 0.1, from = [0, -0.03, 0.05], to = [0, 0.03, 0.05], ends = \"{ends}\" }}
            motion = {{ turn = {{ axis = [0, 1, 0], point = [0, 0, 0.05], rate = 3 }} }}"
        );
        let cube = scene("position = [0, 0, 0.0101]", &drum)
            .replace("shape = \"sphere\"", "shape = \"cube\"");
        let [x, y, z] = end(&cube);
        assert!(x < -0.005 && y.abs() < 0.01, "{ends}: {x} {y} {z}");
    }
}

#[test]
fn walls_that_cannot_be_are_refused_with_their_key() {
    for (form, words) in [
        (
            "silo = { diameter = 0.1, outlet = 0.1, half-angle = 30 }",
            "silo.outlet = 0.1",
        ),
        (
            "silo = { diameter = 0.1, outlet = 0.02, half-angle = 91 }",
            "silo.half-angle = 91",
        ),
        (
            "silo = { diameter = -1, outlet = 0.02, half-angle = 30 }",
            "silo.diameter = -1",
        ),
        (
            "silo = { diameter = 0.1, outlet = 0.02, half-angle = 30, thickness = 0 }",
            "thickness = 0",
        ),
        (
            "silo = { diameter = 0.1, outlet = 0.02, half-angle = 30, facets = 2 }",
            "number of facets",
        ),
        (
            "cylinder = { diameter = 0.1, from = [0, 0, 0] }",
            "cylinder.from and to",
        ),
        (
            "cylinder = { diameter = 0.1, ends = \"both\" }",
            "two points only",
        ),
        (
            "cylinder = { diameter = 0.1, from = [0, 0, 0], to = [0, 0, 0] }",
            "cylinder.to = [0.0, 0.0, 0.0]",
        ),
        (
            "cylinder = { diameter = 0.1, from = [0, 0, 0], to = [0, 0, 1], ends = \"both\", thickness = 1 }",
            "both ends are closed",
        ),
        (
            "cone = { diameters = [0, 1], from = [0, 0, 0], to = [0, 0, 1] }",
            "cone.diameters = 0",
        ),
        (
            "plate = { diameter = 1, centre = [0, 0, 0], normal = [0, 0, 0] }",
            "plate.normal",
        ),
        (
            "plate = { diameter = 1, centre = [0, 0, 0] }\nplane = { normal = [0, 0, 1] }",
            "exactly one of plane, box, cylinder, cone, silo, hopper, plate and file",
        ),
    ] {
        let text = scene("position = [0, 0, 0.5]", &format!("[[wall]]\n{form}"));
        let error = Scenario::from_toml(&text)
            .unwrap()
            .build()
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{form}: {error}");
    }
}

/// The edges of a silo are in the picture, whose frame they widen.
#[test]
fn pictures_show_walls_of_revolution() {
    let draw = |wall: &str| {
        let text = scene("position = [0, 0, 0.05]", wall);
        let run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
        let mut png = Vec::new();
        let options = PictureOptions::default();
        run.picture(&options).unwrap().write_png(&mut png).unwrap();
        png
    };
    let silo = "[[wall]]\nsilo = { diameter = 0.1, height = 0.1, outlet = 0.02, half-angle = 30 }";
    assert_ne!(draw(silo), draw(""));
}

/// A ball comes to lie in a wedge whose slot is too narrow for it, at (R/cos a - s/2)/tan a, and passes a wider one.
#[test]
fn a_wedge_holds_a_ball_over_a_narrow_slot() {
    let wedge = |slot: f64| {
        let wedge = format!(
            "[[wall]]
            hopper = {{ section = [0.08, 0.06], outlet = [{slot}, 0.06], half-angle = 30, height = 0.05 }}"
        );
        let text = scene("position = [0.004, 0.003, 0.03]", &wedge);
        end(&text.replace(
            "friction = 0.3",
            "friction = 0.3\n        contact.penetration = 5e-4",
        ))
    };
    let [x, y, z] = wedge(0.01);
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let expected = (RADIUS / cos - 0.005) * cos / sin;
    assert!(x.abs() < 2e-4 && (y - 0.003).abs() < 2e-3, "{x} {y}");
    assert!((z / expected - 1.0).abs() < 0.005, "{z}, {expected}");
    assert!(wedge(0.024)[2] < -0.05);
    let refused = scene(
        "",
        "[[wall]]\nhopper = { section = [0.1, 0.1], outlet = [0.1, 0.1], half-angle = 30 }",
    );
    let error = Run::new(Scenario::from_toml(&refused).unwrap())
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("hopper.outlet") && error.contains("one shorter"),
        "{error}"
    );
}

/// Scenes whose meshes take a quarter of a minute each to make; like all others they are checked by the program in `run.rs`.
const LARGE: [&str; 3] = ["hertz", "chung-ooi-1", "chung-ooi-2"];

/// All other scenes that ship take their first steps without deep overlaps, and are drawn.
#[test]
fn shipped_scenes_are_drawn() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let folder = std::fs::read_dir(format!("{root}/scenes")).unwrap();
    let files = folder.map(|file| file.unwrap().path());
    let is_taken = |file: &PathBuf| {
        let name = file.file_stem().unwrap().to_string_lossy();
        file.extension() == Some("toml".as_ref()) && !LARGE.contains(&&*name)
    };
    let mut files: Vec<PathBuf> = files.filter(is_taken).collect();
    files.sort();
    assert!(files.len() > 18);
    for file in files {
        // Files that a scene names are relative to the root of the repository.
        let text = std::fs::read_to_string(&file).unwrap();
        let text = text.replace("\"scenes/", &format!("\"{root}/scenes/"));
        let stages = Stage::from_toml(&text, None).unwrap();
        let scene = match stages.first() {
            Some(first) => first.scenario.clone(),
            None => Scenario::from_toml(&text).unwrap(),
        };
        let folder = tempdir().unwrap();
        let mut run = Run::new(scene).unwrap();
        run.advance(folder.path(), 5).unwrap();
        let simulation = run.simulation();
        assert!(simulation.deep_overlaps().is_empty(), "{}", file.display());
        if !simulation.members.is_empty() {
            run.picture(&PictureOptions::default()).unwrap();
        }
    }
}

/// A plane that moves along itself carries what lies on it, and stays where it is.
#[test]
fn a_plane_that_moves_along_itself_is_a_belt() {
    let belt = "[[wall]]
        plane = { normal = [0, 0, 1] }
        motion = { linear = { velocity = [0.2, 0, 0] } }";
    let cube =
        scene("position = [0, 0, 0.00577]", belt).replace("shape = \"sphere\"", "shape = \"cube\"");
    let run = run(&cube);
    let world = &run.simulation().world;
    let (x, v) = (world.position(0).unwrap(), world.velocity(0).unwrap());
    assert!((v.x - 0.2).abs() < 2e-3 && v.y.abs() < 1e-3, "{v}");
    assert!((x.z - 0.00577).abs() < 1e-4, "{x}");
    // It slides until friction of 0.3 has given it the velocity, at 0.2/(0.3 g) = 0.068 s.
    let way = 0.2 * (0.3 - 0.5 * 0.068);
    assert!((x.x - way).abs() < 2e-3, "{} {way}", x.x);
}
