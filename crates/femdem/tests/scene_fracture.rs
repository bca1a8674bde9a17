//! Breakable bodies in scenes: keys and refusals, results of a run that cracks, and going on in mid-crack.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, femdem, run, stdout};
use femdem::Usage;
use femdem::mesh::Vector3;
use femdem::picture::PictureOptions;
use femdem::run::{Run, Scenario, Simulation};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// A bar of 60 mm, weak in its middle by no more than chance, is pulled apart at its ends.
const BAR: &str = r#"
duration = 1e-4
every = 2e-5
gravity = [0, 0, 0]
tables = true
[material.mortar]
density = 2200
law = "neo-hookean"
young = 2e10
poisson = 0.2
[material.mortar.fracture]
tensile = 4e6
cohesion = 1.6e7
friction-angle = 35
energy = [20, 100]
[[body]]
name = "bar"
block = [2, 2, 6]
sides = [0.02, 0.02, 0.06]
material = "mortar"
behaviour = "breakable"
[[body.boundary]]
name = "low"
select = { plane = { normal = [0, 0, 1], offset = -0.03 } }
motion = { linear = { velocity = [0, 0, -0.5] } }
[[body.boundary]]
name = "high"
select = { plane = { normal = [0, 0, 1], offset = 0.03 } }
motion = { linear = { velocity = [0, 0, 0.5] } }
"#;

fn bar(from: &str, to: &str) -> String {
    assert!(BAR.contains(from), "{from}");
    BAR.replacen(from, to, 1)
}

fn refusal(text: &str) -> String {
    match Scenario::from_toml(text).and_then(Run::new) {
        Ok(_) => panic!("not refused: {text}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn what_cannot_break_is_refused_by_its_key() {
    let none = BAR.replace(
        "[material.mortar.fracture]\ntensile = 4e6\ncohesion = 1.6e7\nfriction-angle = 35\nenergy = [20, 100]\n",
        "",
    );
    let table = "energy = [20, 100]\n";
    for (text, words) in [
        (none, ["fracture = none", "[material.NAME.fracture]"]),
        (
            bar("behaviour = \"breakable\"", "behaviour = \"deformable\""),
            ["material.mortar: fracture = given", "no breakable body"],
        ),
        (
            bar("\"breakable\"", "\"brittle\""),
            ["brittle", "breakable"],
        ),
        (
            bar("\"breakable\"", "\"breakable\"\nelement = \"t10\""),
            ["element = T10", "linear elements"],
        ),
        (
            bar("tables = true", "relax = {}"),
            ["relax = given", "crack in motion"],
        ),
        (
            bar("tables = true", "cell.upper = [1, 1, 1]"),
            ["may break", "periodic cell"],
        ),
        (
            bar("tensile = 4e6", "tensile = 0"),
            ["fracture.tensile = 0", "Pa"],
        ),
        (
            bar("cohesion = 1.6e7", "cohesion = -1"),
            ["fracture.cohesion = -1", "Pa"],
        ),
        (
            bar("friction-angle = 35", "friction-angle = 90"),
            ["fracture.friction-angle = 90", "degrees"],
        ),
        (
            bar("energy = [20, 100]", "energy = [20, 10]"),
            ["fracture.energy = [20.0, 10.0]", "at least as large"],
        ),
        (
            bar("energy = [20, 100]", "energy = 20"),
            ["energy", "array"],
        ),
        (bar("tensile = 4e6\n", ""), ["missing field", "tensile"]),
        (
            bar(table, &format!("{table}mix = 0\n")),
            ["fracture.mix = 0", "above 0"],
        ),
        (
            bar(table, &format!("{table}every = 0\n")),
            ["fracture.every = 0", "1 step"],
        ),
        (
            bar(table, &format!("{table}softening = \"abrupt\"\n")),
            ["abrupt", "bilinear"],
        ),
        (
            bar(
                table,
                &format!("{table}weibull = {{ modulus = 0.5, volume = 1e-9 }}\n"),
            ),
            ["fracture.weibull.modulus = 0.5", "1"],
        ),
        (
            bar(
                table,
                &format!("{table}weibull = {{ modulus = 8, volume = 0 }}\n"),
            ),
            ["fracture.weibull.volume = 0", "positive"],
        ),
        // A process zone of 0.5 mm allows 0.2 mm.
        (
            bar("energy = [20", "energy = [0.4"),
            ["\"bar\"", "use a mesh with edges of"],
        ),
    ] {
        let said = refusal(&text);
        for word in words {
            assert!(said.contains(word), "{word:?} is not in: {said}");
        }
    }
    let coarse = bar("energy = [20, 100]", "energy = [0.4, 2]\ncoarse = true");
    Run::new(Scenario::from_toml(&coarse).unwrap()).unwrap();
}

/// 2e10 Pa times 20 J/m² over (4 MPa)² are 25 mm, and a tenth of four times that is the largest height.
#[test]
fn a_check_tells_the_process_zone() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("bar.toml");
    fs::write(&path, BAR).unwrap();
    let said = run(femdem("run").arg(&path).arg("--check"));
    let said = stdout(&said);
    let words = "cracks of bar: process zone 0.025 m; elements are 0.00";
    assert!(
        said.contains(words) && said.contains("at most 0.01 m is right"),
        "{said}"
    );
}

fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            all.extend(
                files(&path)
                    .into_iter()
                    .map(|(file, text)| (format!("{name}/{file}"), text)),
            );
        } else if name != "summary.json" && name != "run.ckpt" {
            all.push((name, fs::read(&path).unwrap()));
        }
    }
    all.sort();
    all
}

/// Rows of a table as numbers, under its header.
fn table(path: &Path) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines
        .next()
        .unwrap()
        .split(',')
        .map(str::to_owned)
        .collect();
    let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect();
    (header, lines.map(row).collect())
}

/// A column of a table with this header.
fn column((header, rows): &(Vec<String>, Vec<Vec<f64>>), name: &str) -> Vec<f64> {
    let at = header.iter().position(|known| known == name).unwrap();
    rows.iter().map(|row| row[at]).collect()
}

#[test]
fn a_bar_pulled_apart_is_in_all_results_in_pieces() {
    let folder = tempdir().unwrap();
    let path = folder.path();
    let pieces = bar(
        "energy = [20, 100]",
        "energy = [20, 100]\nfragments = \"pieces\"",
    );
    let mut job = Run::new(Scenario::from_toml(&pieces).unwrap()).unwrap();
    job.advance(path, u64::MAX).unwrap();
    let summary = job.finish(path, &Usage::default()).unwrap();
    let found = summary.fracture.unwrap();
    assert!(found.bodies == 1 && found.fragments >= 2, "{summary}");
    assert!(
        found.broken_area >= 4e-4 && found.cut_area >= found.broken_area,
        "{found:?}"
    );
    assert!(summary.bodies[0].behaviour == "breakable" && summary.bodies[0].nodes > 63);
    assert!(
        summary.energy.ledger_error_relative.abs() < 0.01,
        "{summary}"
    );

    // The pieces are the bar: its mass, its volume, and its momentum.
    let fragments = table(&path.join("fragments.csv"));
    let [mass, volume, vz] = ["mass", "volume", "vz"].map(|name| column(&fragments, name));
    assert_eq!(mass.len(), found.fragments);
    assert!((mass.iter().sum::<f64>() / summary.bodies[0].mass - 1.0).abs() < 1e-12);
    assert!((volume.iter().sum::<f64>() / 2.4e-5 - 1.0).abs() < 1e-12);
    let momentum: f64 = mass.iter().zip(&vz).map(|(m, v)| m * v).sum();
    let whole = summary.bodies[0].mass * summary.bodies[0].velocity[2];
    assert!(
        (momentum - whole).abs() < 1e-12 * summary.bodies[0].mass,
        "{momentum} {whole}"
    );
    let largest = mass.iter().copied().fold(0.0, f64::max);
    assert!((largest / summary.bodies[0].mass - found.largest_share).abs() < 1e-12);

    // What broke, when, and what it took: no more than all cracks.
    let events = table(&path.join("events.csv"));
    let times = column(&events, "time");
    assert!(!times.is_empty() && times.windows(2).all(|pair| pair[0] <= pair[1]));
    assert!(
        times
            .iter()
            .all(|t| (0.0..=summary.simulated_time).contains(t))
    );
    let taken: f64 = column(&events, "energy").iter().sum();
    let energy = &summary.energy;
    let all = energy.dissipated_fracture + energy.cracks - energy.lent;
    assert!(taken > 0.0 && taken <= all + energy.lent, "{taken} {all}");
    assert!(column(&events, "z").iter().all(|z| z.abs() < 0.03));

    let history = table(&path.join("history.csv"));
    let count = column(&history, "fragments");
    assert!(count[0] == 1.0 && count.last() == Some(&(found.fragments as f64)));
    let fracture = column(&history, "dissipated_fracture");
    assert!((fracture.last().unwrap() - summary.energy.dissipated_fracture).abs() < 1e-15);
    // Both ends hold the same force, before and after.
    for (low, high) in column(&history, "rz bar low")
        .iter()
        .zip(column(&history, "rz bar high"))
    {
        assert!((low + high).abs() < 1e3, "{low} {high}");
    }

    let last = job.frames().len() - 1;
    let read = |name: String| fs::read_to_string(path.join(name)).unwrap();
    for number in 0..=last {
        assert!(
            path.join(format!("frames/cracks-{number:05}.vtp"))
                .is_file()
        );
    }
    let grid = read(format!("frames/deformable-{last:05}.vtu"));
    assert!(grid.contains("Name=\"fragment\"") && grid.contains("Name=\"damage\""));
    assert!(read("cracks.pvd".to_owned()).contains("frames/cracks-00001.vtp"));
    assert!(read("cracks.vtp".to_owned()).contains("Name=\"opening\""));
    assert!(
        summary.to_string().contains("1 breakable body in"),
        "{summary}"
    );

    // Each piece is a body, with the volume that it has now.
    let snapshot = job.simulation().snapshot().unwrap();
    assert_eq!(snapshot.bodies.len(), found.fragments);
    let shown = snapshot
        .shapes
        .iter()
        .map(|s| s.polyhedron.mass_properties().volume);
    let shown: f64 = shown.sum();
    assert!((shown / 2.4e-5 - 1.0).abs() < 0.01, "{shown}");
    let tables = job.read_frame(path, last).unwrap();
    assert_eq!(tables.bodies.len(), found.fragments);
    job.picture(&PictureOptions::default()).unwrap();
    let told = job.fracture(path).unwrap().unwrap();
    assert_eq!(told.fragmentation.unwrap().pieces, found.fragments);
    assert!((told.dissipated.last().unwrap()[1] - all).abs() < 1e-12);
}

/// Fragments are bodies of the run, of which all results know from which body they are. Supports hold what is left to them, and
/// runs go on, and begin, with what is there.
#[test]
fn fragments_of_a_bar_are_bodies_of_the_run() {
    let folder = tempdir().unwrap();
    let [whole, parts, next] = ["whole", "parts", "next"].map(|name| folder.path().join(name));
    for path in [&whole, &parts, &next] {
        fs::create_dir(path).unwrap();
    }
    let scene = Scenario::from_toml(&bar("duration = 1e-4", "duration = 2e-4")).unwrap();
    let mut job = Run::new(scene.clone()).unwrap();
    job.advance(&whole, u64::MAX).unwrap();
    let summary = job.finish(&whole, &Usage::default()).unwrap();
    let found = summary.fracture.as_ref().unwrap();
    let bodies = &summary.bodies;
    assert!(found.bodies == 1 && bodies.len() >= 2, "{summary}");
    assert!(bodies.iter().all(|body| body.behaviour == "breakable"));
    assert!(bodies[0].name == "bar" && bodies[1].name == "bar fragment 1");
    let mass: f64 = bodies.iter().map(|body| body.mass).sum();
    assert!((mass / (2.4e-5 * 2200.0) - 1.0).abs() < 1e-12);
    assert!(
        summary.energy.ledger_error_relative.abs() < 0.01,
        "{summary}"
    );
    let fragments = table(&whole.join("fragments.csv"));
    assert_eq!(fragments.1.len(), found.fragments);
    assert!(column(&fragments, "body").iter().all(|body| *body == 0.0));
    let areas = job.simulation().crack_facets().len();
    assert!(areas > 0 && found.broken_area >= 4e-4);
    // Both ends are held by fragments, with opposite forces.
    let history = table(&whole.join("history.csv"));
    let [low, high] = ["low", "high"].map(|end| column(&history, &format!("rz bar {end}")));
    let largest = low
        .iter()
        .fold(0.0_f64, |most, force| most.max(force.abs()));
    assert!(largest > 1000.0, "{low:?}");
    for (low, high) in low.iter().zip(&high) {
        assert!((low + high).abs() < 1e-3 * largest, "{low} {high}");
    }
    let snapshot = job.simulation().snapshot().unwrap();
    assert_eq!(snapshot.bodies.len(), found.fragments);
    let told = job
        .fracture(&whole)
        .unwrap()
        .unwrap()
        .fragmentation
        .unwrap();
    let parent = told.parent_size.unwrap();
    assert!((parent / 0.02 - 1.0).abs() < 1e-6, "{parent}");

    // Going on right after it has fallen apart.
    let mut job = Run::new(scene.clone()).unwrap();
    while job.simulation().members.len() == 1 {
        job.advance(&parts, 1).unwrap();
    }
    job.flush(&parts).unwrap();
    job.save(&parts, &Usage::default()).unwrap();
    let (mut again, _) = Run::read(&parts).unwrap();
    assert!(again.apply(scene).unwrap().is_empty());
    again.advance(&parts, u64::MAX).unwrap();
    let same = again.finish(&parts, &Usage::default()).unwrap();
    assert_eq!(same.state_hash, summary.state_hash);
    again.save(&parts, &Usage::default()).unwrap();

    // Another run begins with the fragments, and moves their ends.
    let from = format!("from = \"{}\"\n{BAR}", parts.display());
    let from = from.replace("velocity = [0, 0, 0.5]", "velocity = [0, 0, 0.1]");
    let mut job = Run::new(Scenario::from_toml(&from).unwrap()).unwrap();
    assert_eq!(job.simulation().members.len(), bodies.len());
    job.advance(&next, 20).unwrap();
    let held: usize = job
        .simulation()
        .world
        .deformables()
        .map(|b| b.boundary().held().count())
        .sum();
    assert!(held >= 2 * 9 * 3, "{held}");
}

/// Fragments bear a force on the bar by mass, as long as it acts, and take what they weigh past a gauge.
#[test]
fn fragments_bear_what_is_on_the_bar() {
    let folder = tempdir().unwrap();
    let path = folder.path();
    let text = bar("duration = 1e-4", "duration = 1.6e-4");
    let loads = "[[load]]
        bodies = [\"bar\"]
        force = [30, 0, 0]
        table = [[1.2e-4, 1], [1.3e-4, 0]]
        [[load]]
        force = [0, 6, 0]";
    let gauge = "[[gauge]]
        name = \"low\"
        plane = { normal = [0, 0, 1], offset = -0.005 }";
    let scene = Scenario::from_toml(&format!("{text}{loads}\n{gauge}")).unwrap();
    let mut job = Run::new(scene).unwrap();
    let check = |job: &Run, wanted: [f64; 3]| {
        let Simulation { members, world, .. } = job.simulation();
        let mass: f64 = members.iter().map(|m| world.mass(m.id).unwrap()).sum();
        for member in members {
            let found = world.applied_load(member.id).unwrap().force;
            let share = world.mass(member.id).unwrap() / mass;
            let wanted = Vector3::from(wanted) * share;
            assert!((found - wanted).norm() < 1e-9, "{found} {wanted}");
        }
    };
    while job.simulation().members.len() == 1 {
        job.advance(path, 1).unwrap();
    }
    job.advance(path, 1).unwrap();
    assert!(job.simulation().world.time() < 1.2e-4);
    check(&job, [30.0, 6.0, 0.0]);
    job.advance(path, u64::MAX).unwrap();
    check(&job, [0.0, 6.0, 0.0]);
    job.finish(path, &Usage::default()).unwrap();
    let Simulation { members, world, .. } = job.simulation();
    let beyond = members.iter().map(|member| member.id);
    let beyond = beyond.filter(|id| world.position(*id).unwrap().z < -0.005);
    let beyond: f64 = beyond.map(|id| world.mass(id).unwrap()).sum();
    let flow = fs::read_to_string(path.join("flow.csv")).unwrap();
    let passed = flow.lines().last().unwrap().split(',').nth(3).unwrap();
    let passed: f64 = passed.parse().unwrap();
    assert!(
        beyond > 0.0 && (passed / beyond - 1.0).abs() < 1e-6,
        "{passed} {beyond}"
    );
    job.save(path, &Usage::default()).unwrap();
    // Another run without the loads.
    let from = format!("from = \"{}\"\n{text}{gauge}", path.display());
    let next = Run::new(Scenario::from_toml(&from).unwrap()).unwrap();
    assert!(next.simulation().members.len() > 1);
    check(&next, [0.0; 3]);
}

/// A bar that may not touch itself stays one body.
#[test]
fn a_bar_that_may_not_touch_itself_breaks_into_pieces() {
    let folder = tempdir().unwrap();
    let text = bar(
        "behaviour = \"breakable\"",
        "behaviour = \"breakable\"\nself-contact = false",
    );
    let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    assert!(job.simulation().fracture_summary().unwrap().fragments > 1);
    assert_eq!(job.simulation().members.len(), 1);
}

#[test]
fn a_run_goes_on_in_mid_crack_with_the_same_bits() {
    let folder = tempdir().unwrap();
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    for path in [&whole, &parts] {
        fs::create_dir(path).unwrap();
    }
    let scene = Scenario::from_toml(BAR).unwrap();
    let mut once = Run::new(scene.clone()).unwrap();
    once.advance(&whole, u64::MAX).unwrap();
    let wanted = once.finish(&whole, &Usage::default()).unwrap();

    let mut job = Run::new(scene.clone()).unwrap();
    let half_broken = |job: &Run| {
        let facets = job.simulation().crack_facets();
        facets
            .iter()
            .any(|facet| facet.damage > 0.1 && facet.damage < 0.9)
    };
    while !half_broken(&job) {
        assert_eq!(job.ending(), None);
        job.advance(&parts, 1).unwrap();
    }
    job.flush(&parts).unwrap();
    job.save(&parts, &Usage::default()).unwrap();
    // What comes after the checkpoint is lost.
    job.advance(&parts, 7).unwrap();
    let (mut again, _) = Run::read(&parts).unwrap();
    assert!(again.apply(scene).unwrap().is_empty());
    again.advance(&parts, u64::MAX).unwrap();
    let found = again.finish(&parts, &Usage::default()).unwrap();
    assert_eq!(found.state_hash, wanted.state_hash);
    again.save(&parts, &Usage::default()).unwrap();
    for (a, b) in files(&parts).iter().zip(&files(&whole)) {
        assert_eq!(a.0, b.0);
        assert!(a.1 == b.1, "{}", a.0);
    }

    // Another run starts from the broken bar, whose halves are held by the nodes that they have now.
    let from = format!("from = \"{}\"\n{BAR}", parts.display());
    let from = from.replace("velocity = [0, 0, 0.5]", "velocity = [0, 0, 0.1]");
    let mut next = Run::new(Scenario::from_toml(&from).unwrap()).unwrap();
    let start = next.simulation().world.mass(0).unwrap();
    assert!((start / wanted.bodies[0].mass - 1.0).abs() < 1e-12);
    next.advance(&whole, 20).unwrap();
    assert!(next.simulation().fracture_summary().unwrap().fragments >= 2);
}

/// The page of a run that broke a body has a section on it.
#[test]
fn a_report_has_a_section_on_fracture() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("bar.toml");
    let out = folder.path().join("out");
    fs::write(&path, BAR).unwrap();
    let result = run(femdem("run").arg(&path).args(["-q", "--out"]).arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let result = run(femdem("report").arg(&out).arg("-q"));
    assert_eq!(code(&result), 0, "{result:?}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("<h2>Fracture</h2>") && page.contains("Energy of fracture"));
    assert!(out.join("plots/fracture-energy.svg").is_file());
    // One that cannot break has none.
    let text = BAR.replace("\"breakable\"", "\"deformable\"");
    let text = text.split("[material.mortar.fracture]").collect::<Vec<_>>();
    let rest = text[1].split_once("[[body]]").unwrap().1;
    fs::write(&path, format!("{}[[body]]{rest}", text[0])).unwrap();
    let result = run(femdem("run")
        .arg(&path)
        .args(["-q", "--force", "--out"])
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let result = run(femdem("report").arg(&out).arg("-q"));
    assert_eq!(code(&result), 0, "{result:?}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(!page.contains("<h2>Fracture</h2>"));
}

/// A cube that a floor shatters is shown in pieces, each with a closed surface, and together as large as the cube.
#[test]
fn pieces_of_a_shattered_cube_have_surfaces() {
    let (head, _) = BAR.split_once("[[body]]").unwrap();
    let text = format!(
        "{head}[[wall]]
        name = \"floor\"
        plane = {{ normal = [0, 0, 1] }}
        [[body]]
        name = \"cube\"
        block = [4, 4, 4]
        sides = [0.02, 0.02, 0.02]
        material = \"mortar\"
        behaviour = \"breakable\"
        position = [0, 0, 0.0101]
        velocity = [0, 0, -20]"
    );
    let text = text.replace("duration = 1e-4", "duration = 5e-5");
    let folder = tempdir().unwrap();
    let mut job = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
    job.advance(folder.path(), u64::MAX).unwrap();
    let pieces = job.simulation().fracture_summary().unwrap().fragments;
    let snapshot = job.simulation().snapshot().unwrap();
    assert!(pieces >= 5 && snapshot.bodies.len() == pieces, "{pieces}");
    let volumes = snapshot.shapes.iter();
    let volume: f64 = volumes.map(|s| s.polyhedron.mass_properties().volume).sum();
    assert!((volume / 8e-6 - 1.0).abs() < 0.05, "{volume}");
    let mass: f64 = snapshot.masses.iter().sum();
    assert!((mass / (2200.0 * 8e-6) - 1.0).abs() < 1e-12, "{mass}");
}
