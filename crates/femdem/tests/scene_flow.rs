//! Walls that open, sources, sinks and gauges.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, fails, femdem, run as command, stdout};
use std::fs;
use std::path::Path;

use femdem::Usage;
use femdem::run::{Member, Run, RunSummary, Scenario};
use tempfile::tempdir;

/// Cubes with a diagonal of 10 mm that fall from a source on a plate, which opens, and leave below it.
const FLOW: &str = "duration = 0.5
    every = 0.05
    history-every = 0.01
    tables = true
    contact.friction = 0.4
    [material.m]
    density = 2000
    [[wall]]
    name = \"tube\"
    cylinder = { diameter = 0.05, from = [0, 0, -0.02], to = [0, 0, 0.2] }
    [[wall]]
    name = \"plug\"
    plate = { diameter = 0.06, centre = [0, 0, 0] }
    opens = 0.25
    [[source]]
    name = \"feed\"
    shape = \"cube\"
    diameter = 0.01
    material = \"m\"
    lower = [-0.012, -0.012, 0.06]
    upper = [0.012, 0.012, 0.12]
    rate = 200
    number = 12
    [[gauge]]
    name = \"mouth\"
    plane = { normal = [0, 0, 1], offset = -0.01 }
    [[sink]]
    name = \"below\"
    plane = { normal = [0, 0, 2], offset = -0.1 }
    ";

fn begun(text: &str) -> Run {
    Run::new(Scenario::from_toml(text).unwrap()).unwrap()
}

fn ended(text: &str, folder: &Path) -> (Run, RunSummary) {
    let mut run = begun(text);
    run.advance(folder, u64::MAX).unwrap();
    let summary = run.finish(folder, &Usage::default()).unwrap();
    (run, summary)
}

/// Rows of a table, without its header.
fn rows(folder: &Path, name: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join(name)).unwrap();
    let cells = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(cells).collect()
}

fn refused(text: &str) -> String {
    let built = Scenario::from_toml(text).and_then(|scene| scene.build());
    built.unwrap_err().to_string()
}

/// All that has come from the source has passed the gauge and left at the sink; every file tells the same, and the ledger closes.
#[test]
fn what_comes_goes_and_is_counted() {
    let folder = tempdir().unwrap();
    let (run, summary) = ended(FLOW, folder.path());
    let members = &run.simulation().members;
    assert_eq!(members.len(), 12);
    assert!(members.iter().all(|member| member.id == Member::GONE));
    assert_eq!(members[3].name, "feed 3");
    assert_eq!((summary.bodies.len(), summary.contacts), (0, 0));
    assert_eq!(run.simulation().world.body_count(), 0);
    let mass = 12.0 * 2000.0 * (0.01 / 3_f64.sqrt()).powi(3);
    let flow = rows(folder.path(), "flow.csv");
    let last = |name: &str| flow.iter().rfind(|row| row[1] == name).unwrap().clone();
    for name in ["mouth", "below", "feed"] {
        let row = last(name);
        assert_eq!(row[2], "12", "{row:?}");
        let found: f64 = row[3].parse().unwrap();
        assert!((found / mass - 1.0).abs() < 1e-3, "{found} {mass}");
    }
    // The mass is the sum of the rate over the time, and nothing passes before the plug opens.
    let mut sum = 0.0;
    let mut before = 0.0;
    for row in flow.iter().filter(|row| row[1] == "mouth") {
        let [time, bodies, rate] = [0, 2, 4].map(|k| row[k].parse::<f64>().unwrap());
        sum += rate * (time - before);
        before = time;
        assert!(bodies == 0.0 || time > 0.25, "{row:?}");
    }
    assert!((sum / mass - 1.0).abs() < 1e-3, "{sum}");
    let energy = &summary.energy;
    assert!(energy.ledger_error_relative.abs() < 0.01, "{energy:?}");
    assert!(energy.by_hand < 0.0 && energy.initial > 0.0, "{energy:?}");
    // The plug bore the bodies until it opened.
    let plug = summary
        .walls
        .iter()
        .find(|wall| wall.name == "plug")
        .unwrap();
    assert!(plug.peak_force > 0.5 * 9.81 * mass && plug.peak_time < 0.26);
    assert_eq!(plug.force, [0.0; 3]);
    // Tables of frames: before, with the plug and some bodies; in the end without.
    let frames = folder.path().join("frames");
    let walls = |frame: &str| rows(&frames.join(frame), "walls.csv").len();
    assert_eq!((walls("00004"), walls("00008")), (2, 1));
    assert_eq!(rows(&frames.join("00010"), "bodies.csv").len(), 0);
    // The summary tells the same, and the mean rate is that between the first and the latest passage.
    let mouth = &summary.flow["mouth"];
    assert_eq!((mouth.kind.as_str(), mouth.bodies), ("gauge", 12));
    let passing = flow.iter().filter(|row| row[1] == "mouth" && row[4] != "0");
    let times: Vec<f64> = passing.map(|row| row[0].parse().unwrap()).collect();
    let (first, last) = (times[0], times[times.len() - 1]);
    // All but the first of 12 equal bodies; rows are 0.01 s apart.
    let time = 11.0 / 12.0 * mass / mouth.mean_rate.unwrap();
    assert!(
        (time - (last - first)).abs() < 0.0102,
        "{time} {first} {last}"
    );
    // A file of the walls for each frame, since one opens: of the tube and the plug, and of the tube alone.
    let size = |frame: &str| {
        let path = frames.join(format!("walls-{frame}.vtp"));
        fs::metadata(path).unwrap().len()
    };
    assert!(size("00004") > size("00010") && size("00010") > 1000);
    // Nothing is left but the walls, which are drawn, and what was measured.
    assert!(folder.path().join("run.png").is_file());
    let course = run.course(folder.path()).unwrap();
    let plots: Vec<&str> = course.plots.iter().map(|plot| plot.name.as_str()).collect();
    for name in ["energies", "flow", "flow-rate", "wall-forces"] {
        assert!(plots.contains(&name), "{plots:?}");
    }
    let header = fs::read_to_string(folder.path().join("history.csv")).unwrap();
    let counts: Vec<usize> = header.lines().map(|line| line.split(',').count()).collect();
    assert!(counts.iter().all(|count| *count == counts[0]), "{counts:?}");
}

/// A run that is stopped and read back at any time goes on to the same bits and files.
#[test]
fn a_run_with_flow_resumes_with_the_same_bits() {
    let whole = tempdir().unwrap();
    let (run, summary) = ended(FLOW, whole.path());
    let parts = tempdir().unwrap();
    let mut run_in_parts = begun(FLOW);
    let mut stops = 0;
    while run_in_parts.ending().is_none() {
        run_in_parts.advance(parts.path(), 700).unwrap();
        run_in_parts.flush(parts.path()).unwrap();
        run_in_parts.save(parts.path(), &Usage::default()).unwrap();
        run_in_parts = Run::read(parts.path()).unwrap().0;
        stops += 1;
    }
    assert!(stops > 5, "{stops}");
    let again = run_in_parts
        .finish(parts.path(), &Usage::default())
        .unwrap();
    assert_eq!(again.state_hash, summary.state_hash);
    assert_eq!(run.simulation().members, run_in_parts.simulation().members);
    for name in ["flow.csv", "history.csv"] {
        assert_eq!(rows(parts.path(), name), rows(whole.path(), name), "{name}");
    }
}

/// A run that goes on to a longer duration has its source go on, too.
#[test]
fn sources_go_on_to_a_longer_duration() {
    let longer = FLOW.replace("number = 12\n", "");
    let duration = "duration = 0.5";
    assert!(longer != FLOW && longer.contains(duration));
    let short = longer.replace(duration, "duration = 0.3");
    let (whole, parts) = (tempdir().unwrap(), tempdir().unwrap());
    let (run, _) = ended(&longer, whole.path());
    let (mut in_parts, _) = ended(&short, parts.path());
    assert!(in_parts.simulation().members.len() < run.simulation().members.len());
    in_parts
        .apply(Scenario::from_toml(&longer).unwrap())
        .unwrap();
    in_parts.advance(parts.path(), u64::MAX).unwrap();
    assert_eq!(
        run.simulation().members.len(),
        in_parts.simulation().members.len()
    );
}

/// Bodies of a source come where there is room: their contacts begin at the surface. Another seed puts them elsewhere.
#[test]
fn sources_place_bodies_where_there_is_room() {
    let crowded = FLOW
        .replace("opens = 0.25", "")
        .replace("rate = 200", "rate = 20000");
    let folder = tempdir().unwrap();
    let (run, summary) = ended(&crowded, folder.path());
    assert_eq!(run.simulation().world.body_count(), 12);
    let deepest = summary.penetration.unwrap().peak;
    assert!(deepest < 5e-4, "{deepest}");
    let places = |run: &Run| -> Vec<[f64; 3]> {
        let members = run.simulation().members.iter();
        members
            .map(|member| member.placed.translation.vector.into())
            .collect()
    };
    let other = ended(
        &crowded.replace("number = 12", "number = 12\nseed = 7"),
        folder.path(),
    )
    .0;
    assert_ne!(places(&run), places(&other));
    // A mass is not exceeded: three of 0.385 g each.
    let by_mass = crowded.replace("number = 12", "mass = 0.0013");
    assert_eq!(
        ended(&by_mass, folder.path()).0.simulation().members.len(),
        3
    );
}

/// What sleeps on a plug wakes when it opens, and what its contacts stored is booked.
#[test]
fn an_opening_wakes_what_rests_on_it() {
    let text = "duration = 0.6
        contact.penalty = 1e5
        [material.m]
        density = 1000
        [[wall]]
        name = \"floor\"
        plane = { normal = [0, 0, 1] }
        opens = 0.5
        [[wall]]
        name = \"cellar\"
        plane = { normal = [0, 0, 1], offset = -0.02 }
        [[body]]
        shape = \"cube\"
        size = 0.05
        material = \"m\"
        position = [0, 0, 0.0144]";
    let folder = tempdir().unwrap();
    let mut run = begun(text);
    while run.simulation().world.time() < 0.49 {
        run.advance(folder.path(), 1).unwrap();
    }
    let id = run.simulation().members[0].id;
    assert!(run.simulation().world.is_asleep(id));
    run.advance(folder.path(), u64::MAX).unwrap();
    let z = run.simulation().world.position(id).unwrap().z;
    assert!((z + 0.02 - 0.0144).abs() < 1e-3, "{z}");
    let ledger = run.simulation().world.ledger();
    assert!(
        ledger.by_hand < 0.0 && ledger.error_relative().abs() < 0.02,
        "{ledger:?}"
    );
}

/// One run fills a container by a source, and the next one, which starts from it, empties it.
#[test]
fn a_filled_container_is_emptied_by_the_next_run() {
    let folder = tempdir().unwrap();
    let (text, flow) = FLOW.split_at(FLOW.find("[[source]]").unwrap());
    let source = &flow[..flow.find("[[gauge]]").unwrap()];
    let fill = text.replace("opens = 0.25", "");
    let (mut run, filled) = ended(&format!("{fill}{source}"), folder.path());
    run.save(folder.path(), &Usage::default()).unwrap();
    assert_eq!(filled.bodies.len(), 12);
    let empties = &flow[source.len()..];
    let next = format!("from = {:?}\n{text}{empties}", folder.path());
    let other = tempdir().unwrap();
    let (_, emptied) = ended(&next, other.path());
    assert_eq!(emptied.bodies.len(), 0);
    assert!(emptied.energy.ledger_error_relative.abs() < 0.02);
    let flow = rows(other.path(), "flow.csv");
    let below = flow.iter().rfind(|row| row[1] == "below");
    assert_eq!(below.unwrap()[2], "12");
    // A third one goes on from the empty container, whose plug stays away.
    run = begun(&next);
    run.advance(other.path(), u64::MAX).unwrap();
    run.save(other.path(), &Usage::default()).unwrap();
    let third = format!("from = {:?}\n{fill}{source}", other.path());
    let third = begun(&third);
    assert_eq!(third.simulation().world.walls().count(), 1);
}

#[test]
fn flow_that_cannot_be_is_refused_with_its_key() {
    for (from, to, words) in [
        ("opens = 0.25", "opens = 0.5", "wall.opens = 0.5"),
        ("opens = 0.25", "opens = -1", "wall.opens = -1"),
        ("rate = 200", "", "rate and mass-rate = none or both"),
        ("rate = 200", "rate = 0", "rate = 0"),
        ("rate = 200", "mass-rate = inf", "mass-rate = inf"),
        (
            "number = 12",
            "number = 12\nmass = 1",
            "number and mass = both",
        ),
        ("number = 12", "number = 0", "a source = 0 bodies"),
        ("number = 12", "mass = 1e-9", "mass = 0.000000001"),
        ("number = 12", "start = 2", "a source = "),
        ("number = 12", "start = 0.2\nend = 0.1", "start and end"),
        ("shape = \"cube\"", "", "shape = none"),
        ("diameter = 0.01", "", "diameter and size"),
        (
            "diameter = 0.01",
            "diameter = 0.01\nsizes = \"1cm\"",
            "sizes, sieve, diameter and size = several",
        ),
        (
            "diameter = 0.01",
            "sieve = \"1cm:1\"\nsizes = \"1cm\"",
            "sizes and sieve = both",
        ),
        ("diameter = 0.01", "sizes = \"1cm:x\"", "20mm:0.3,30mm:0.7"),
        ("lower = [-0.012", "lower = [1", "lower and upper"),
        (
            "material = \"m\"",
            "material = \"n\"",
            "source \"feed\": material = \"n\"",
        ),
        ("offset = -0.1 }", "offset = nan }", "plane.offset"),
        (
            "plane = { normal = [0, 0, 2], offset = -0.1 }",
            "",
            "plane and box = none or both",
        ),
        (
            "name = \"below\"",
            "name = \"mouth\"",
            "another sink, gauge or source",
        ),
    ] {
        assert!(FLOW.contains(from), "{from}");
        let error = refused(&FLOW.replace(from, to));
        assert!(error.contains(words), "{to}: {error}");
    }
}

/// A crane lets bodies down one after another: each begins at its own place, and waits until that is clear.
#[test]
fn places_are_taken_one_by_one() {
    let box_of = "lower = [-0.012, -0.012, 0.06]
    upper = [0.012, 0.012, 0.12]";
    let places = "places = [[0, 0, 0.05], [0, 0, 0.05], [0.015, 0, 0.03]]";
    let text = FLOW
        .replace(box_of, places)
        .replace("number = 12", "")
        .replace("opens = 0.25", "")
        .replace("duration = 0.5", "duration = 0.3");
    assert!(text.contains(places));
    let folder = tempdir().unwrap();
    let mut run = begun(&text);
    let mut seen = Vec::new();
    while run.ending().is_none() {
        run.advance(folder.path(), 1).unwrap();
        let simulation = run.simulation();
        for member in &simulation.members[seen.len()..] {
            let x = simulation.world.position(member.id).unwrap();
            seen.push((simulation.world.time(), x));
        }
    }
    assert_eq!(seen.len(), 3);
    for ((_, x), place) in seen
        .iter()
        .zip([[0.0, 0.0, 0.05], [0.0, 0.0, 0.05], [0.015, 0.0, 0.03]])
    {
        assert!(
            (x - femdem::mesh::Vector3::from(place)).norm() < 2e-4,
            "{x} {place:?}"
        );
    }
    // The second is due 5 ms after the first, but has to wait until that has fallen by its diameter.
    let wait = seen[1].0 - seen[0].0;
    assert!(wait > (2.0 * 0.0099 / 9.81_f64).sqrt() - 1e-3, "{wait}");
    let bad = text.replace("rate = 200", "rate = 200\n    number = 4");
    let error = Run::new(Scenario::from_toml(&bad).unwrap())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("number") && error.contains("places"),
        "{error}"
    );
}

/// Half of the mass in cubes with a diagonal of 8 mm, half in such with 16 mm, of 8 times the mass.
#[test]
fn a_source_brings_bodies_by_their_shares_of_the_mass() {
    let small = 2000.0 * (0.008_f64 / 3_f64.sqrt()).powi(3);
    let text = FLOW
        .replace("    opens = 0.25\n", "")
        .replace("duration = 0.5", "duration = 0.2")
        .replace("diameter = 0.01", "sizes = \"8mm:0.5,16mm:0.5\"");
    for (end, count) in [
        ("number = 18".to_owned(), [16, 2]),
        (format!("mass = {}", 32.001 * small), [16, 2]),
        // It ends before the body that would be too much.
        (format!("mass = {}", 31.9 * small), [15, 2]),
        (format!("mass = {}", 5.0 * small), [4, 0]),
    ] {
        let text = text.replace("number = 12", &end);
        let folder = tempdir().unwrap();
        let mut run = begun(&text);
        run.advance(folder.path(), u64::MAX).unwrap();
        let masses: Vec<f64> = run.simulation().bodies().iter().map(|b| b.mass).collect();
        let of = |mass: f64| {
            let same = |m: &&f64| (**m / mass - 1.0).abs() < 1e-9;
            masses.iter().filter(same).count()
        };
        assert_eq!([of(small), of(8.0 * small)], count, "{end}: {masses:?}");
        assert_eq!(masses.len(), count.iter().sum::<usize>());
        // In no order of size.
        assert!(count[1] == 0 || !masses.is_sorted(), "{masses:?}");
    }
}

/// A run that has run empty has a page and a picture; what needs bodies names the last frame with some.
#[test]
fn the_program_shows_a_run_without_a_body() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let short = FLOW
        .replace("number = 12", "number = 3")
        .replace("rate = 200", "rate = 400");
    fs::write(&scene, short.replace("opens = 0.25", "opens = 0.05")).unwrap();
    let out = folder.path().join("out");
    let result = command(
        femdem("run")
            .arg(&scene)
            .args(["--quiet", "--out"])
            .arg(&out),
    );
    assert_eq!(code(&result), 0, "{result:?}");
    let said = fails(femdem("analyse").arg(&out), &["holds no body", "--frame"]);
    let frame = said
        .split("--frame ")
        .nth(1)
        .unwrap()
        .split(',')
        .next()
        .unwrap();
    let result = command(femdem("analyse").arg(&out).args(["-q", "--frame", frame]));
    assert_eq!(code(&result), 0, "{result:?}");
    let result = command(femdem("report").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    for part in [
        "<h3>Rate of flow</h3>",
        "gauge mouth",
        "3 bodies",
        "<h3>Energies</h3>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    assert!(!page.contains("<canvas"));
    let picture = folder.path().join("a.png");
    let result = command(
        femdem("picture")
            .arg(&out)
            .args(["--size", "64x64", "--out"])
            .arg(&picture),
    );
    assert!(stdout(&result).contains("its walls are drawn") && picture.is_file());
}
