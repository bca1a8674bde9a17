//! Scenes that other codes, or earlier laws, got wrong, at the program's own choices.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use femdem::Usage;
use femdem::run::{Run, RunSummary, Scenario};
use std::fmt::Write as _;
use tempfile::tempdir;

const FLOOR: &str = "[[wall]]
    name = \"floor\"
    plane = { normal = [0, 0, 1] }
";

fn ran(text: &str) -> (Run, RunSummary) {
    let folder = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    let summary = RunSummary::of(&job, &Usage::default()).unwrap();
    (job, summary)
}

/// A column ten times as high as wide, tilted by a tenth of a degree, and a stack of ten cubes that are slightly off stand.
#[test]
fn slender_columns_and_stacks_stand() {
    let column = format!(
        "duration = 3
        sleeping = false
        [material.m]
        density = 2400
        {FLOOR}
        [[body]]
        material = \"m\"
        shape = \"box:width=1,height=10\"
        size = 0.2
        position = [0, 0, 1]
        rotation = {{ axis = [1, 0, 0], angle = 0.1 }}"
    );
    let mut stack = format!(
        "duration = 3
        sleeping = false
        [material.m]
        density = 2400
        {FLOOR}"
    );
    let off = [[-2e-4, -2e-4], [0.0, 2e-4], [2e-4, 0.0]];
    for k in 0..10 {
        let ([x, y], z) = (off[k % 3], 0.1 + 0.2 * k as f64);
        writeln!(
            stack,
            "[[body]]\nmaterial = \"m\"\nshape = \"box:width=1,height=1\"\nsize = 0.2\nposition = [{x}, {y}, {z}]"
        )
        .unwrap();
    }
    for text in [&column, &stack] {
        let (_, summary) = ran(text);
        let start = Scenario::from_toml(text).unwrap().build().unwrap().bodies();
        for (body, before) in summary.bodies.iter().zip(start) {
            let way = (0..3).map(|k| (body.centroid[k] - before.centroid[k]).powi(2));
            assert!(way.sum::<f64>().sqrt() < 0.01, "{summary}");
        }
        assert!(summary.rest.at_rest, "{summary}");
    }
}

/// A box a thousand times as heavy rests on a light one, and a boulder at 40 m/s is held by the floor.
#[test]
fn what_is_heavy_or_fast_is_held() {
    let heavy = format!(
        "duration = 1
        sleeping = false
        [material.light]
        density = 1000
        [material.heavy]
        density = 1000000
        {FLOOR}
        [[body]]
        name = \"low\"
        material = \"light\"
        shape = \"box:width=1,height=1\"
        size = 0.1
        position = [0, 0, 0.05]
        [[body]]
        name = \"high\"
        material = \"heavy\"
        shape = \"box:width=1,height=1\"
        size = 0.1
        position = [0, 0, 0.15]"
    );
    let (_, summary) = ran(&heavy);
    assert!(
        (summary.bodies[1].centroid[2] - 0.15).abs() < 1e-3,
        "{summary}"
    );
    // A hundred times as heavy, the two have come to rest within a second.
    let (_, summary) = ran(&heavy.replace("1000000", "100000"));
    for body in &summary.bodies {
        let speed = body.velocity.map(f64::abs).into_iter().fold(0.0, f64::max);
        assert!(speed < 1e-4, "{summary}");
    }
    assert!(summary.rest.at_rest, "{summary}");
    let boulder = format!(
        "duration = 0.4
        [material.m]
        density = 2560
        {FLOOR}
        [[body]]
        material = \"m\"
        shape = \"boulder\"
        diameter = 0.5
        position = [0, 0, 0.3]
        velocity = [0, 0, -40]"
    );
    let (_, summary) = ran(&boulder);
    let depth = summary.penetration.unwrap().peak;
    assert!(depth < 0.05 * 0.5, "{depth}");
    assert!(summary.bodies[0].centroid[2] > 0.1);
}

/// Three cards of 88 x 63 x 0.3 mm lie on one another without a step that is given.
#[test]
fn cards_rest() {
    let folder = tempdir().unwrap();
    let card = folder.path().join("card.obj");
    let mut corners = String::new();
    for k in 0..8 {
        let sign = |bit: usize, size: f64| if k >> bit & 1 == 1 { size } else { -size };
        writeln!(
            corners,
            "v {} {} {}",
            sign(0, 0.044),
            sign(1, 0.0315),
            sign(2, 1.5e-4)
        )
        .unwrap();
    }
    corners += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    std::fs::write(&card, corners).unwrap();
    let mut text = format!(
        "duration = 0.1
        sleeping = false
        contact.friction = 0
        [material.m]
        density = 1200
        {FLOOR}"
    );
    for z in [1.5e-4, 4.5e-4, 7.5e-4] {
        let shape = card.display();
        writeln!(
            text,
            "[[body]]\nmaterial = \"m\"\nshape = \"{shape}\"\nposition = [0, 0, {z}]"
        )
        .unwrap();
    }
    let (_, summary) = ran(&text);
    for (k, body) in summary.bodies.iter().enumerate() {
        assert!(
            (body.centroid[2] - (1.5 + 3.0 * k as f64) * 1e-4).abs() < 1e-5,
            "{summary}"
        );
    }
    assert!(summary.rest.at_rest, "{summary}");
}

/// A pressed block of rubber bears 33.9 N at 16 % of compression: the converged value, with very stiff contacts.
#[test]
fn a_pressed_block_is_as_stiff_as_its_material() {
    let text = format!(
        "duration = 0.2
        gravity = [0, 0, 0]
        contact.friction = 0.3
        [material.soft]
        density = 1000
        law = \"neo-hookean\"
        young = 1e5
        poisson = 0.4
        {FLOOR}
        [[wall]]
        name = \"top\"
        plane = {{ normal = [0, 0, -1], offset = -0.04 }}
        motion = {{ linear = {{ velocity = [0, 0, -0.032], end = 1 }} }}
        [[body]]
        material = \"soft\"
        behaviour = \"deformable\"
        block = [4, 4, 4]
        sides = [0.04, 0.04, 0.04]
        position = [0, 0, 0.02]"
    );
    let (_, summary) = ran(&text);
    let force = summary.walls[1].force[2];
    assert!((force / 33.9 - 1.0).abs() < 0.03, "{force} N");
    assert!(summary.warnings.is_empty(), "{summary}");
    // With soft contacts it is they that give way, and the run says so.
    let soft = format!("{text}\n        contact-ratio = 0.05");
    let (_, summary) = ran(&soft);
    assert!(summary.warnings[0].contains("contact-ratio"), "{summary}");
}

/// More copies than can be counted are refused in words.
#[test]
fn copies_beyond_counting_are_refused() {
    let text = format!(
        "duration = 0.1
        [material.m]
        density = 1000
        {FLOOR}
        [[body]]
        material = \"m\"
        shape = \"cube\"
        size = 0.1
        copies = {{ count = [4294967295, 4294967295, 4294967295], spacing = [1, 1, 1] }}"
    );
    let message = Scenario::from_toml(&text).unwrap().build().err().unwrap();
    assert!(message.to_string().contains("copies"), "{message}");
}

/// Needles that land cost at most three times the steps that they take without damping.
#[test]
fn damping_does_not_make_needles_slow() {
    let steps = |damping: f64| {
        let text = format!(
            "duration = 0.12
            sleeping = false
            contact.damping = {damping}
            [material.m]
            density = 1000
            {FLOOR}
            [[body]]
            material = \"m\"
            shape = \"box:width=0.01,height=0.01\"
            size = 0.05
            position = [0, 0, 0.03]
            copies = {{ count = [2, 2, 1], spacing = [0.06, 0.06, 0.06], seed = 4 }}"
        );
        let (_, summary) = ran(&text);
        assert!(summary.penetration.is_some(), "{summary}");
        summary.steps
    };
    let (damped, free) = (steps(0.6), steps(0.0));
    assert!(damped < 3 * free, "{damped} and {free} steps");
}
