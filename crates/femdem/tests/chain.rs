//! A pack as the beginning of a run, and the run as the end that is measured.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{code, fails, femdem, run, stdout, summary};
use femdem::run::Scenario;
use femdem::{Snapshot, results};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// Twenty-four cubes on a soft floor, at rest.
fn pack() -> (TempDir, PathBuf) {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    let options = "--shape P5 --count 24 --box 3x3 --penetration 0.01 --seed 3 --threads 2 --quiet";
    let mut command = femdem("pack");
    command.args(options.split(' ')).arg("--out").arg(&out);
    assert_eq!(code(&run(&mut command)), 0);
    (folder, out)
}

fn scene(pack: &Path, more: &str) -> String {
    format!("from = \"{}\"\nduration = 0.02\n{more}", pack.display())
}

/// Runs a scene into a folder beside the pack.
fn ran(pack: &Path, name: &str, more: &str) -> PathBuf {
    let file = pack.with_file_name(format!("{name}.toml"));
    fs::write(&file, scene(pack, more)).unwrap();
    let out = pack.with_file_name(name);
    let output = run(femdem("run").arg(&file).arg("--out").arg(&out));
    assert_eq!(
        code(&output),
        0,
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(
        output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    out
}

/// Fields of a table without its header.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    let row = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(row).collect()
}

/// Pairs of contacts, sorted.
fn pairs(path: &Path) -> Vec<String> {
    let mut pairs: Vec<String> = rows(path)
        .iter()
        .map(|row| format!("{} {}", row[0], row[1]))
        .collect();
    pairs.sort();
    pairs
}

fn wall<'a>(summary: &'a Value, name: &str) -> Option<&'a Value> {
    let walls = summary["walls"].as_array().unwrap();
    walls.iter().find(|wall| wall["name"] == name)
}

#[test]
fn a_pack_stays_at_rest_in_a_run() {
    let (_kept, pack) = pack();
    let out = ran(&pack, "still", "tables = true");
    let end = summary(&out);
    let rest = &end["rest"];
    assert_eq!(rest["at_rest"], true, "{rest}");
    assert!(rest["force_balance"].as_f64().unwrap() < 1e-3, "{rest}");
    assert_eq!(end["bodies"].as_array().unwrap().len(), 24);
    assert_eq!(end["bodies"][7]["name"], "pack 7");
    assert_eq!(end["penalty"]["reason"], "that of the pack");
    let own = summary(&pack);
    let penalty = own["contact"]["penalty"].as_f64().unwrap();
    assert_eq!(end["penalty"]["value"].as_f64().unwrap(), penalty);
    // The floor bears the weight from the row of time 0 on.
    let weight: f64 = rows(&pack.join("bodies.csv"))
        .iter()
        .map(|row| 9.81 * row[11].parse::<f64>().unwrap())
        .sum();
    let history = fs::read_to_string(out.join("history.csv")).unwrap();
    let column = history.lines().next().unwrap().split(',');
    let column = column
        .into_iter()
        .position(|name| name == "fz floor")
        .unwrap();
    for row in rows(&out.join("history.csv")) {
        let borne = -row[column].parse::<f64>().unwrap();
        assert!(
            (0.8..1.05).contains(&(borne / weight)),
            "{borne} of {weight}"
        );
    }
    // The frame of the start and that of the end hold the contacts of the pack.
    let frames = end["frames"].as_u64().unwrap();
    for number in [0, frames - 1] {
        let table = out.join(format!("frames/{number:05}/contacts.csv"));
        assert_eq!(pairs(&table), pairs(&pack.join("contacts.csv")), "{number}");
    }
    // The scene in the folder tells what the pack gave.
    let told = Scenario::read(out.join("scene.toml")).unwrap();
    let same = |told: f64| (told / penalty - 1.0).abs() < 1e-12;
    assert!(told.contact.penalty.is_some_and(same));
    assert_eq!(told.gravity, Some([0.0, 0.0, -9.81]));
}

#[test]
fn a_scene_moves_opens_and_adds_to_the_pack() {
    let (_kept, pack) = pack();
    let out = ran(
        &pack,
        "pressed",
        r#"
        remove = ["x+"]
        contact.friction = 0.3
        [material.steel]
        density = 7800
        [[wall]]
        name = "y-"
        motion = { linear = { velocity = [0, 0.05, 0] } }
        [[wall]]
        name = "lid"
        plane = { normal = [0, 0, -1], offset = -1 }
        [[body]]
        name = "intruder"
        shape = "sphere"
        diameter = 0.03
        material = "steel"
        position = [0, 0, 0.4]
        velocity = [0, 0, -1]
        "#,
    );
    let end = summary(&out);
    assert!(wall(&end, "x+").is_none() && wall(&end, "lid").is_some());
    // A wall that moves in pushes harder than it did.
    let peak = |of: &Value| wall(of, "y-").unwrap()["peak_force"].as_f64().unwrap();
    let still = summary(&ran(&pack, "still", ""));
    assert!(
        peak(&end) > 1.5 * peak(&still),
        "{} {}",
        peak(&end),
        peak(&still)
    );
    let intruder = end["bodies"].as_array().unwrap().last().unwrap();
    assert_eq!(intruder["name"], "intruder");
    let speed = intruder["velocity"][2].as_f64().unwrap();
    assert!((speed + 1.0 + 9.81 * 0.02).abs() < 0.02, "{speed}");
    let told = Scenario::read(out.join("scene.toml")).unwrap();
    assert_eq!(told.contact.friction, Some(0.3));

    // The run can go on, and be the start of another.
    let output = run(femdem("resume").arg(&out).args(["--duration", "0.025"]));
    assert_eq!(
        code(&output),
        0,
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(stdout(&output).contains("--duration"));
    let text = fs::read_to_string(out.join("scene.toml")).unwrap();
    let from = format!("from = \"{}\"", pack.display());
    assert!(text.contains(&from), "{text}");
    let text = text.replace(&from, &format!("from = \"{}\"", out.display()));
    let file = pack.with_file_name("again.toml");
    fs::write(&file, &text).unwrap();
    let again = pack.with_file_name("again");
    let output = run(femdem("run").arg(&file).arg("--out").arg(&again));
    assert_eq!(
        code(&output),
        0,
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let further = summary(&again);
    assert_eq!(further["bodies"].as_array().unwrap().len(), 25);
    let height = |of: &Value| of["bodies"][24]["centroid"][2].as_f64().unwrap();
    assert!(height(&further) < height(&end) - 0.01);
    // Its walls are those of the state.
    let closed = text.replace("remove = [\"x+\"]", "remove = []");
    fs::write(&file, closed).unwrap();
    fails(
        femdem("run")
            .arg(&file)
            .arg("--out")
            .arg(pack.with_file_name("no")),
        &["remove", "pressed"],
    );
}

#[test]
fn what_a_scene_cannot_do_with_a_pack_is_named() {
    let (_kept, pack) = pack();
    let file = pack.with_file_name("refused.toml");
    let out = pack.with_file_name("refused");
    for (text, words) in [
        (
            scene(&pack, "remove = [\"north\"]"),
            ["remove = \"north\"", "floor, x-, x+, y-, y+"],
        ),
        (
            scene(&pack, "remove = [\"x+\", \"x+\"]"),
            ["remove", "each once"],
        ),
        (
            scene(&pack, "[[wall]]\nname = \"north\""),
            ["wall \"north\"", "floor, x-, x+, y-, y+"],
        ),
        (
            scene(&pack, "[[wall]]\nname = \"x-\"\n[[wall]]\nname = \"x-\""),
            ["name = \"x-\"", "another wall has it"],
        ),
        (
            scene(
                &pack,
                "[[wall]]\nname = \"x-\"\nplane = { normal = [1, 0, 0] }",
            ),
            ["name = \"x-\"", "another wall has it"],
        ),
        (
            scene(&pack, "contact = { penalty = 1e6, penetration = 0.01 }"),
            ["contact.penetration", "give one of the two"],
        ),
        (
            scene(&pack.with_file_name("nowhere"), ""),
            ["run.ckpt", "pack.ckpt"],
        ),
        (
            "remove = [\"x+\"]\n".to_owned(),
            ["remove", "give `from` with the folder of `femdem pack`"],
        ),
    ] {
        fs::write(&file, text).unwrap();
        fails(femdem("run").arg(&file).arg("--out").arg(&out), &words);
        assert!(!out.exists());
    }
}

fn analysis(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("analysis.json")).unwrap()).unwrap()
}

fn analysed(folder: &Path, options: &[&str]) -> String {
    let output = run(femdem("analyse").arg(folder).args(options));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(code(&output), 0, "{message}");
    stdout(&output)
}

/// Two numbers of two analyses, relative to the first.
fn apart(a: &Value, b: &Value, path: &str) -> f64 {
    let number = |of: &Value| of.pointer(path).and_then(Value::as_f64);
    let both = number(a).zip(number(b));
    let (a, b) = both.unwrap_or_else(|| panic!("{path} is missing"));
    (a / b - 1.0).abs()
}

/// Of a pack and of a run that starts from it the same is measured, from the checkpoint and from the tables.
#[test]
fn a_run_is_measured_as_the_pack_is() {
    let (_kept, pack) = pack();
    let out = ran(&pack, "still", "tables = true\nevery = 0.005");
    analysed(&pack, &[]);
    let own = analysis(&pack);
    let said = analysed(&out, &[]);
    assert!(said.contains("24 bodies P5"), "{said}");
    let end = analysis(&out);
    let inside = "/height_profile/region";
    for k in 0..3 {
        for corner in ["min", "max"] {
            let path = format!("{inside}/{corner}/{k}");
            let [a, b] = [&own, &end].map(|of| of.pointer(&path).unwrap().as_f64().unwrap());
            assert!((a - b).abs() < 1e-5, "{path}: {a} {b}");
        }
    }
    for path in [
        "/density/exact",
        "/bed/void_fraction",
        "/bed/area_per_volume",
        "/coordination/mean",
        "/core/region/max/2",
    ] {
        assert!(apart(&own, &end, path) < 1e-4, "{path}");
    }
    let bed = summary(&pack)["bed"].clone();
    assert_eq!(bed["void_fraction"], own["bed"]["void_fraction"]);
    assert!(apart(&own, &end, "/vertical_balance/cuts/0/carried") < 0.02);

    // The last frame has the state of the end, to all digits of the tables.
    let last = summary(&out)["frames"].as_u64().unwrap() - 1;
    let said = analysed(&out, &["--frame", &last.to_string()]);
    assert!(said.contains(&format!("frame {last}")), "{said}");
    let tables = out.join(format!("frames/{last:05}"));
    let frame = analysis(&tables);
    for path in [
        "/density/exact",
        "/coordination/mean",
        "/core_stress/stress/pressure",
    ] {
        assert!(apart(&end, &frame, path) < 1e-9, "{path}");
    }
    assert_eq!(end["missing"], frame["missing"]);
    // The fields of both have all parts, and as many cells.
    let fields = |folder: &Path, place: &Path, more: &[&str]| {
        analysed(folder, &[&["--fields"], more].concat());
        let text = fs::read_to_string(place.join("analysis/fields.vti")).unwrap();
        let arrays = text.lines().filter(|line| line.starts_with("<DataArray"));
        arrays.collect::<Vec<_>>().join("\n")
    };
    let head = fields(&out, &out, &[]);
    for name in [
        "solid_fraction",
        "density",
        "momentum",
        "velocity",
        "kinetic_stress",
        "contact_stress",
        "fabric",
    ] {
        assert!(head.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    assert_eq!(head, fields(&out, &tables, &["--frame", &last.to_string()]));
    let finer = fields(
        &pack,
        &pack,
        &["--fields-width", "1", "--fields-spacing", "0.25"],
    );
    assert!(finer != head && finer.contains("Name=\"kinetic_stress\""));
    // Without --fields the file of before is gone.
    analysed(&pack, &[]);
    assert!(!pack.join("analysis/fields.vti").exists());
    for (folder, options, words) in [
        (&pack, &["--fields-width", "1"][..], "--fields"),
        (
            &pack,
            &["--fields", "--fields-spacing", "9"],
            "spacing_over_d = 9",
        ),
        (&pack, &["--over-time"], "run.ckpt"),
        (&out, &["--over-time"], "several shapes or sizes"),
    ] {
        fails(femdem("analyse").arg(folder).args(options), &[words]);
    }
    // By time, and as a pack from elsewhere.
    let said = analysed(&out, &["--time", "0.0101"]);
    assert!(said.contains("frame 2 at 0.01"), "{said}");
    analysed(&tables, &[]);
    let elsewhere = analysis(&tables);
    assert!(elsewhere["density"].is_null());
    assert!(apart(&end, &elsewhere, "/coordination/mean") < 1e-9);

    // The page and pictures.
    for options in [&["--frame", "1"][..], &[]] {
        let place = out.join("page");
        let output = run(femdem("report")
            .arg(&out)
            .args(options)
            .arg("--out")
            .arg(&place));
        assert_eq!(
            code(&output),
            0,
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let page = fs::read_to_string(place.join("report.html")).unwrap();
        let words = match options.is_empty() {
            true => ["at rest", "that of the pack"],
            false => ["frame 1 at 0.005", "Packing density"],
        };
        assert!(words.iter().all(|word| page.contains(word)), "{words:?}");
    }
    let drawn = out.join("frame.png");
    let mut picture = femdem("picture");
    picture
        .arg(&out)
        .args(["--time", "0", "--colour", "coordination", "--size", "64x48"]);
    assert_eq!(code(&run(picture.arg("--out").arg(&drawn))), 0);
    assert!(drawn.is_file());

    for (options, words) in [
        (["--frame", "99"], ["--frame = 99", "0 to"]),
        (["--time", "nan"], ["--time = NaN", "time in s"]),
        (["--density", "1000"], ["--density", "checkpoint"]),
    ] {
        fails(femdem("analyse").arg(&out).args(options), &words);
    }
    fails(
        femdem("analyse").arg(&pack).args(["--frame", "1"]),
        &["--frame", "run.ckpt"],
    );
}

/// Points of all bodies in the world.
fn points(snapshot: &Snapshot) -> Vec<[f64; 3]> {
    let of = |body: &femdem::Body| {
        let surface = &snapshot.shapes[body.shape as usize].polyhedron;
        let points = surface.vertices().iter();
        points.map(|p| (body.pose * p).into()).collect::<Vec<_>>()
    };
    snapshot.bodies.iter().flat_map(of).collect()
}

/// The tables of a pack place the same bodies in a scene.
#[test]
fn bodies_of_a_table_are_where_they_were() {
    let (_kept, pack) = pack();
    let own = results::snapshot(&results::SavedPack::read(&pack).unwrap().packing);
    let text = |more: &str| {
        format!(
            "[material.m]\ndensity = 2560\n[[body]]\nmaterial = \"m\"\nposes = \"{}\"\n{more}",
            pack.join("bodies.csv").display()
        )
    };
    let file = pack.join("shape-P5.obj");
    let scene = Scenario::from_toml(&text(&format!("shape = \"{}\"", file.display()))).unwrap();
    let read = scene.build().unwrap().snapshot().unwrap();
    let (a, b) = (points(&own), points(&read));
    assert_eq!(a.len(), 24 * 8);
    for (a, b) in a.iter().zip(&b) {
        for k in 0..3 {
            assert!((a[k] - b[k]).abs() < 1e-12, "{a:?} {b:?}");
        }
    }
    for (a, b) in own.masses.iter().zip(&read.masses) {
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    // Another shape at the same places.
    let scene = Scenario::from_toml(&text("shape = \"sphere\"\ndiameter = 0.01")).unwrap();
    let spheres = scene.build().unwrap().snapshot().unwrap();
    for (a, b) in own.bodies.iter().zip(&spheres.bodies) {
        assert!((a.pose.translation.vector - b.pose.translation.vector).norm() < 1e-12);
    }
}

#[test]
fn a_table_gives_sizes_and_velocities_too() {
    let folder = tempdir().unwrap();
    let table = folder.path().join("poses.csv");
    let scene = |columns: &str, rows: &str, more: &str| {
        fs::write(&table, format!("x,y,z,qw,qx,qy,qz{columns}\n{rows}")).unwrap();
        let text = format!(
            "[material.m]\ndensity = 1000\nlaw = \"neo-hookean\"\nyoung = 1e6\npoisson = 0.3\n[[body]]\nmaterial = \"m\"\nposes = \"{}\"\n{more}",
            table.display()
        );
        let text = match text.contains("deformable") {
            true => text,
            false => text.replace("law = \"neo-hookean\"\nyoung = 1e6\npoisson = 0.3\n", ""),
        };
        Scenario::from_toml(&text).unwrap().build()
    };
    let rows = "0,0,0,1,0,0,0,0.1,0,0,0,0,2,0.02\n1,0,0,0,1,0,0,0,0.3,0,0,0,0,0.04\n2,0,0,1,0,0,0,0,0,0,0,0,0,0.02\n";
    let made = scene(
        ",vx,vy,vz,wx,wy,wz,D",
        rows,
        "shape = \"cube\"\nname = \"grain\"",
    )
    .unwrap();
    let names: Vec<&str> = made.members.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["grain 1", "grain 2", "grain 3"]);
    assert_eq!(made.world.shapes().len(), 2);
    let mass = |k: usize| made.world.mass(made.members[k].id).unwrap();
    // A cube of the diagonal d has the volume d³/(3 √3).
    assert!((mass(0) / (1000.0 * 0.02_f64.powi(3) / 27_f64.sqrt()) - 1.0).abs() < 1e-9);
    assert!((mass(1) / mass(0) - 8.0).abs() < 1e-9 && mass(2) == mass(0));
    let moves = |k: usize| made.world.velocity(made.members[k].id).unwrap();
    assert!((moves(0).x, moves(1).y) == (0.1, 0.3));
    let spin = made.world.angular_velocity(made.members[0].id).unwrap();
    assert!((spin.z - 2.0).abs() < 1e-12);

    let one = "0,0,0,1,0,0,0,2\n";
    for (columns, rows, more, words) in [
        (
            ",d",
            one,
            "shape = \"cube\"\ndiameter = 1",
            "with a column d",
        ),
        (",scale", one, "shape = \"cube\"", "without a column d"),
        (
            ",scale",
            one,
            "shape = \"cube\"\nsize = 1\nbehaviour = \"deformable\"",
            "with a column d or scale",
        ),
        (",d", "0,0,0,1,0,0,0,0\n", "shape = \"cube\"", "line 2"),
        (",d", "0,0,0,2,0,0,0,1\n", "shape = \"cube\"", "length"),
        (
            ",n",
            one,
            "shape = \"cube\"\nsize = 1\nposition = [0, 0, 1]",
            "position",
        ),
        (
            ",n",
            one,
            "shape = \"cube\"\nsize = 1\ncopies = { count = [1, 1, 1], spacing = [1, 1, 1] }",
            "copies",
        ),
        (",n", "", "shape = \"cube\"\nsize = 1", "at least one row"),
        (
            ",shape",
            "0,0,0,1,0,0,0,a\n9,0,0,1,0,0,0,b\n",
            "shape = \"cube\"\nsize = 1",
            "several: a, b",
        ),
    ] {
        let message = scene(columns, rows, more).unwrap_err().to_string();
        assert!(message.contains(words), "{words}: {message}");
    }
    // Of several shapes the rows of one.
    let rows = "0,0,0,1,0,0,0,P5\n9,0,0,1,0,0,0,b\n";
    let made = scene(",shape", rows, "shape = \"cube\"\nsize = 1").unwrap();
    assert_eq!(made.members.len(), 1);
}

/// Contacts that are found from the poses are those of the pack.
#[test]
fn contacts_are_found_as_the_pack_has_them() {
    let (_kept, pack) = pack();
    let own = results::snapshot(&results::SavedPack::read(&pack).unwrap().packing);
    let mut found = Snapshot {
        contacts: Vec::new(),
        ..own.clone()
    };
    found.gaps.contacts = true;
    results::find_contacts(&mut found).unwrap();
    assert!(!found.gaps.contacts && found.gaps.forces);
    let sorted = |snapshot: &Snapshot| {
        let mut rows = snapshot.contacts.clone();
        let key = |row: &femdem::ContactRow| (row.body, row.partner.to_string(), row.patch);
        rows.sort_by_key(key);
        rows
    };
    let (a, b) = (sorted(&own), sorted(&found));
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(&b) {
        assert_eq!((a.body, &a.partner, a.class), (b.body, &b.partner, b.class));
        assert!((a.point - b.point).norm() < 1e-9 && (a.normal - b.normal).norm() < 1e-9);
        assert!((a.area / b.area - 1.0).abs() < 1e-6, "{a:?} {b:?}");
    }

    // The same in the program, which has files alone.
    let elsewhere = pack.with_file_name("elsewhere");
    fs::create_dir(&elsewhere).unwrap();
    for name in ["bodies.csv", "shape-P5.obj"] {
        fs::copy(pack.join(name), elsewhere.join(name)).unwrap();
    }
    analysed(&pack, &[]);
    let complete = analysis(&pack);
    let corner = |name: &str, k: usize| {
        let path = format!("/height_profile/region/{name}/{k}");
        complete.pointer(&path).unwrap().to_string()
    };
    let corners = ["min", "max"].map(|name| [0, 1, 2].map(|k| corner(name, k)).join(","));
    let said = analysed(&elsewhere, &["--inside", &corners.join(",")]);
    assert!(said.contains("found from their overlaps"), "{said}");
    assert!(said.contains("do not tell the forces"), "{said}");
    let told = analysis(&elsewhere);
    for key in ["coordination", "rattlers"] {
        assert_eq!(complete[key], told[key], "{key}");
    }
    for key in [
        "force_distribution",
        "fabric",
        "classes",
        "chains_by_weight",
    ] {
        assert!(told[key].is_null(), "{key}");
    }
    fails(
        femdem("analyse").arg(&elsewhere).args(["--threshold", "1"]),
        &["--threshold", "contacts.csv"],
    );
    fails(
        femdem("picture")
            .arg(&elsewhere)
            .args(["--colour", "force"]),
        &["force", "--colour"],
    );
    let output = run(femdem("report").arg(&elsewhere));
    assert_eq!(code(&output), 0);
}

/// A deformable body is in the tables with its skin.
#[test]
fn deformable_bodies_are_measured_by_their_skins() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    let out = folder.path().join("run");
    fs::write(
        &file,
        r#"
        duration = 0.01
        every = 0.005
        tables = true
        [material.rubber]
        density = 1000
        law = "neo-hookean"
        young = 1e5
        poisson = 0.3
        [material.steel]
        density = 7800
        [[wall]]
        name = "floor"
        plane = { normal = [0, 0, 1] }
        [[body]]
        name = "pad"
        block = [2, 2, 2]
        sides = [0.1, 0.1, 0.1]
        material = "rubber"
        behaviour = "deformable"
        position = [0, 0, 0.05]
        [[body]]
        name = "ball"
        shape = "sphere"
        diameter = 0.05
        material = "steel"
        position = [0, 0, 0.126]
        velocity = [0, 0, -1]
        "#,
    )
    .unwrap();
    let output = run(femdem("run").arg(&file).arg("--out").arg(&out));
    assert_eq!(
        code(&output),
        0,
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let said = analysed(&out, &["--frame", "2"]);
    assert!(said.contains("2 bodies mixed"), "{said}");
    let told = analysis(&out.join("frames/00002"));
    // The classes of its contacts are not known.
    let missing = told["missing"].as_array().unwrap();
    assert!(
        missing.iter().any(|m| m["table"] == "rattlers"),
        "{missing:?}"
    );
    // Compressed, but no more than a ball at 1 m/s can.
    let volume = |frame: &str| {
        let path = out.join(format!("frames/{frame}/shape-pad.obj"));
        let skin = femdem::mesh::io::read_file(path).unwrap();
        skin.mass_properties().volume
    };
    assert!((volume("00000") / 1e-3 - 1.0).abs() < 1e-9);
    assert!(
        (0.9..1.0).contains(&(volume("00002") / 1e-3)),
        "{}",
        volume("00002")
    );
    let contacts = rows(&out.join("frames/00002/contacts.csv"));
    let pairs: Vec<String> = contacts
        .iter()
        .map(|row| format!("{} {}", row[0], row[1]))
        .collect();
    assert_eq!(pairs.len(), 2, "{pairs:?}");
    assert!(pairs.contains(&"0 floor".to_owned()), "{pairs:?}");
    let walls = rows(&out.join("frames/00002/walls.csv"));
    assert_eq!(walls[0][..5], ["floor", "0", "0", "0", "1"]);
    assert!(walls[0][10].parse::<f64>().unwrap() < -1.0, "{walls:?}");
}

/// A side of the container is pressed with a force, by its name.
#[test]
fn a_wall_of_a_pack_is_controlled() {
    let (_kept, pack) = pack();
    let control = "[[wall]]\nname = \"x+\"\ncontrol = { force = 10, speed = 0.2 }";
    let file = pack.with_file_name("press.toml");
    let press = |more: &str| {
        let from = pack.display();
        fs::write(
            &file,
            format!("from = \"{from}\"\nduration = 0.6\n{more}\n{control}"),
        )
        .unwrap();
        let out = pack.with_file_name("pressed");
        let mut command = femdem("run");
        command
            .arg(&file)
            .args(["--quiet", "--force", "--out"])
            .arg(&out);
        assert_eq!(code(&run(&mut command)), 0);
        out
    };
    // With another side open the numbers of the walls have a gap.
    for open in ["", "remove = [\"y-\"]"] {
        let out = press(open);
        let end = summary(&out);
        let side = wall(&end, "x+").unwrap();
        let force = side["force"][0].as_f64().unwrap();
        assert!(
            (force / 10.0 - 1.0).abs() < 0.05 || !open.is_empty(),
            "{side}"
        );
        let walls = rows(&out.join("wall_history.csv"));
        let last = walls.iter().rfind(|row| row[1] == "x+").unwrap();
        assert!(last[2].parse::<f64>().unwrap() < 0.0, "{last:?}");
        for wall in end["walls"].as_array().unwrap() {
            let row = walls
                .iter()
                .rfind(|row| wall["name"] == row[1].as_str())
                .unwrap();
            let (told, found) = (
                wall["force"][0].as_f64().unwrap(),
                row[5].parse::<f64>().unwrap(),
            );
            assert!((told - found).abs() <= 1e-9 * told.abs(), "{wall} {row:?}");
        }
    }
    let both = format!("{control}\nmotion = {{ linear = {{ velocity = [1, 0, 0] }} }}");
    fs::write(&file, scene(&pack, &both)).unwrap();
    fails(
        femdem("run").arg(&file),
        &["x+", "either a motion or a control"],
    );
}

/// A pack of two materials brings the laws of their pairs along; a `[[pair]]` of the scene takes the place of one of them, and a
/// run from such a run has them in turn.
#[test]
fn a_pack_brings_its_laws_of_pairs() {
    let folder = tempdir().unwrap();
    let file = folder.path().join("pack.toml");
    fs::write(
        &file,
        "shape = [\"P5\", \"A10\"]\ncount = 8\nbox = \"3x3\"\npenetration = 0.01\n\
         material = [\"steel\", \"ice\"]\nwall-material = \"wood\"\n\
         [[pair]]\nmaterials = [\"ice\", \"steel\"]\ncohesion = 50\n\
         [[pair]]\nmaterials = [\"wood\", \"steel\"]\nfriction = 0.2\n",
    )
    .unwrap();
    let pack = folder.path().join("pack");
    let output = run(femdem("pack")
        .arg(&file)
        .arg("--out")
        .arg(&pack)
        .arg("--quiet"));
    assert_eq!(code(&output), 0);
    let built = |text: &str| Scenario::from_toml(text).unwrap().build().unwrap();
    let laws = |text: &str| {
        let simulation = built(text);
        let world = &simulation.world;
        let walls: Vec<_> = world.walls().map(|(wall, _)| wall).collect();
        let of = |shape: &str| {
            let mut ids = world.body_ids();
            let is = |id: &u32| {
                let shape_id = world.shape_of(*id).unwrap();
                world.shape(shape_id).unwrap().name == shape
            };
            world.material(ids.find(is).unwrap()).unwrap()
        };
        let (steel, ice) = (of("P5"), of("A10"));
        let wood = world.wall_material(walls[0]).unwrap();
        let [stuck, slides] = [[ice, steel], [steel, wood]].map(|ids| *world.laws().between(ids));
        assert_eq!(world.laws().between([ice, ice]), world.laws().usual());
        (stuck.cohesion, slides.friction, stuck.friction)
    };
    assert_eq!(laws(&scene(&pack, "")), (50.0, 0.2, 0.6));
    let own = "contact.friction = 0.5\n[material.steel]\n[material.ice]\n\
               [[pair]]\nmaterials = [\"steel\", \"ice\"]\ncohesion = 70\n";
    assert_eq!(laws(&scene(&pack, own)), (70.0, 0.2, 0.5));
    let still = ran(&pack, "still", "");
    assert_eq!(summary(&still)["rest"]["at_rest"], true);
    assert_eq!(laws(&scene(&still, "")), (50.0, 0.2, 0.6));
    let told = Scenario::read(still.join("scene.toml")).unwrap();
    assert_eq!(told.pair.len(), 2);
}
