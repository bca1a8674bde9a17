//! Runs that end at rest, and say whether they do: what walls carry is the weight, whether bodies were frozen on the way or not.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::Usage;
use femdem::run::{Ending, Run, RunSummary, Scenario};
use tempfile::tempdir;

fn to_end(text: &str) -> RunSummary {
    let folder = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    RunSummary::of(&job, &Usage::default()).unwrap()
}

/// Grains over a floor: 3 x 3 x 3 in a box that is open at the top, of 20 mm each.
fn grains(sleeping: bool, container: &str, more: &str) -> String {
    format!(
        "duration = 6
        sleeping = {sleeping}
        rest = {{ energy = 1e-7, time = 0.05 }}
        [contact]
        friction = 0.4
        [material.stone]
        density = 2500
        [[wall]]
        name = \"floor\"
        plane = {{ normal = [0, 0, 1] }}
        {container}
        [[body]]
        name = \"grain\"
        shape = \"A13\"
        diameter = 0.02
        material = \"stone\"
        copies = {{ count = [3, 3, 3], spacing = [0.021, 0.021, 0.021] }}
        position = [-0.021, -0.021, 0.011]
        rotation = {{ axis = [1, 2, 3], angle = 40 }}
        {more}"
    )
}

const SIDES: &str = "[[wall]]
        name = \"sides\"
        cylinder = { diameter = 0.085 }";

/// The run has ended at rest, and its walls carry the weight.
fn assert_carries(summary: &RunSummary) {
    let rest = &summary.rest;
    assert_eq!(summary.ending, Some(Ending::Rest), "{summary}");
    assert!(rest.at_rest && rest.frozen == 0, "{summary}");
    let mass: f64 = summary.bodies.iter().map(|body| body.mass).sum();
    let carried: f64 = summary.walls.iter().map(|wall| wall.force[2]).sum();
    let ratio = -carried / (9.81 * mass);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}\n{summary}");
}

#[test]
fn the_walls_of_a_silo_carry_the_weight() {
    for sleeping in [true, false] {
        assert_carries(&to_end(&grains(sleeping, SIDES, "")));
    }
}

/// A lid a hundred times as heavy as a grain falls on them.
#[test]
fn the_walls_carry_a_dead_load() {
    let lid = "[[body]]
        name = \"lid\"
        shape = \"box:width=1,height=0.2\"
        size = 0.055
        material = \"stone\"
        position = [0, 0, 0.11]";
    for sleeping in [true, false] {
        assert_carries(&to_end(&grains(sleeping, SIDES, lid)));
    }
}

/// A piston presses the grains and stays: floor, sides and piston together carry the weight.
#[test]
fn the_walls_of_an_oedometer_carry_the_weight() {
    let piston = format!(
        "{SIDES}
        [[wall]]
        name = \"piston\"
        plane = {{ normal = [0, 0, -1], offset = -0.066 }}
        motion = {{ linear = {{ velocity = [0, 0, -0.075], start = 0.5, end = 1.0 }} }}"
    );
    for sleeping in [true, false] {
        let summary = to_end(&grains(sleeping, &piston, ""));
        assert_carries(&summary);
        let piston = &summary.walls[2];
        let mass: f64 = summary.bodies.iter().map(|body| body.mass).sum();
        assert!(piston.force[2] > 9.81 * mass, "{summary}");
        // Not before the piston has arrived.
        assert!(summary.simulated_time > 1.0);
    }
}

/// A run that ends while bodies fall says that it is not at rest, and why.
#[test]
fn a_run_that_ends_in_motion_says_so() {
    let text = grains(true, SIDES, "").replace("duration = 6", "duration = 0.03");
    let summary = to_end(&text);
    assert_eq!(summary.ending, Some(Ending::Time));
    assert!(!summary.rest.at_rest);
    assert!(summary.to_string().contains("NOT at rest"), "{summary}");
}

/// Near the end of its duration a run has no frozen body, however long they have been at rest.
#[test]
fn nothing_is_frozen_at_the_end() {
    let text = "duration = 1
        [material.stone]
        density = 2500
        [[wall]]
        name = \"floor\"
        plane = { normal = [0, 0, 1] }
        [[body]]
        name = \"cube\"
        shape = \"cube\"
        size = 0.1
        material = \"stone\"
        position = [0, 0, 0.0289]";
    let folder = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    while job.simulation().world.time() < 0.9 {
        job.advance(folder.path(), 8).unwrap();
    }
    assert_eq!(job.simulation().rest().frozen, 1);
    job.advance(folder.path(), u64::MAX).unwrap();
    let standing = job.simulation().rest();
    assert!(standing.frozen == 0 && standing.at_rest, "{standing:?}");
}

/// The chosen penalty keeps impacts within 5 % of the diameter, whichever the shape and its side.
#[test]
fn impacts_go_no_deeper_than_the_chosen_penalty_allows() {
    for shape in [
        "A10",
        "P1",
        "P5",
        "cylinder:aspect=4",
        "box:width=1,height=0.2",
    ] {
        for (axis, angle) in [
            ([0, 0, 1], 0),
            ([1, 0, 0], 45),
            ([1, 2, 0], 54),
            ([3, -1, 2], 130),
        ] {
            let summary = to_end(&format!(
                "duration = 0.02
                gravity = [0, 0, 0]
                [material.m]
                density = 2500
                [[wall]]
                name = \"floor\"
                plane = {{ normal = [0, 0, 1] }}
                [[body]]
                shape = \"{shape}\"
                diameter = 0.1
                material = \"m\"
                position = [0, 0, 0.06]
                velocity = [0, 0, -10]
                rotation = {{ axis = {axis:?}, angle = {angle} }}"
            ));
            let depth = summary.penetration.map_or(0.0, |found| found.peak) / 0.1;
            assert!(
                (0.002..=0.05).contains(&depth),
                "{shape} {axis:?} {angle}: {depth}"
            );
        }
    }
}

/// A penalty and a penetration decide the same, and a wanted penetration is met.
#[test]
fn a_wanted_penetration_is_met_or_refused() {
    let text = |keys: &str| grains(false, SIDES, "").replace("friction = 0.4", keys);
    let both = Scenario::from_toml(&text("penalty = 1e6\npenetration = 0.01")).unwrap();
    let message = both.build().err().unwrap().to_string();
    assert!(message.contains("penetration"), "{message}");
    for wanted in [0.002, 0.01] {
        let folder = tempdir().unwrap();
        let scene = Scenario::from_toml(&text(&format!("penetration = {wanted}"))).unwrap();
        let mut job = Run::new(scene).unwrap();
        job.advance(folder.path(), u64::MAX).unwrap();
        let contacts = job.simulation().contacts();
        let depths = contacts
            .iter()
            .map(|contact| job.simulation().depth_of(contact));
        let mean = depths.sum::<f64>() / contacts.len() as f64 / 0.02;
        assert!(mean < wanted && mean > 0.1 * wanted, "{mean} for {wanted}");
    }
}
