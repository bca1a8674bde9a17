//! The program on bodies that are not convex, mixtures, variants and files.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{code, fails, femdem, run, stdout, summary};
use femdem::input::InputOptions;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Options of a pack that settles soon.
const QUICK: [&str; 4] = ["--penetration", "0.02", "--threads", "2"];

/// Columns of a table without its header.
fn table(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path).unwrap();
    let row = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().skip(1).map(row).collect()
}

/// A cube of side 40 whose top is pushed in to its middle: closed, not convex, and large for metres.
const DENTED: &str = "v 0 0 0\nv 40 0 0\nv 40 40 0\nv 0 40 0\nv 0 0 40\nv 40 0 40\nv 40 40 40\n\
    v 0 40 40\nv 20 20 20\n\
    f 1 4 3 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n";

#[test]
fn bodies_that_are_not_convex_come_from_files_in_millimetres() {
    let folder = tempdir().unwrap();
    let (obj, out) = (folder.path().join("dented.obj"), folder.path().join("out"));
    fs::write(&obj, DENTED).unwrap();
    let result = run(femdem("pack")
        .arg("--shape")
        .arg(&obj)
        .args(["--unit", "mm", "--count", "4", "--cylinder", "2"])
        .args(QUICK)
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let said = stdout(&result);
    for words in [
        "dented.obj in millimetres",
        "9 facets",
        "not convex",
        "tetrahedra",
        "volume",
    ] {
        assert!(said.contains(words), "{words:?} is not in: {said}");
    }
    let summary = summary(&out);
    assert_eq!(summary["settled"], true);
    let shape = &summary["shapes"][0];
    // A cube less a pyramid of a sixth of it.
    let volume = 0.04_f64.powi(3) * 5.0 / 6.0;
    assert!((shape["volume"].as_f64().unwrap() / volume - 1.0).abs() < 1e-9);
    assert_eq!(
        (&shape["count"], &shape["convex"]),
        (&4.into(), &false.into())
    );
    assert!(shape["tetrahedra"].as_u64().unwrap() >= 12);
    coordination_counts_pairs(&out, &summary);
}

/// The coordination number from the table by hand: partners of bodies with force above zero.
fn coordination_counts_pairs(out: &Path, summary: &serde_json::Value) {
    let rows = table(&out.join("contacts.csv"));
    let mut pairs = BTreeSet::new();
    for row in &rows {
        if row[8].parse::<f64>().unwrap() > 0.0 {
            pairs.insert((row[0].clone(), row[1].clone()));
            if row[1].parse::<u32>().is_ok() {
                pairs.insert((row[1].clone(), row[0].clone()));
            }
        }
    }
    let mean = pairs.len() as f64 / summary["count"].as_f64().unwrap();
    let found = summary["coordination"]["mean"].as_f64().unwrap();
    assert!((found - mean).abs() < 1e-12, "{found} {mean}");
    assert!(
        summary["coordination"]["patches_per_pair"]
            .as_f64()
            .unwrap()
            >= 1.0
    );
}

#[test]
fn mixtures_keep_their_shares_and_resume() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let options = [
        "--shape",
        "cube",
        "--shape",
        "hollow_cylinder:sides=8",
        "--share",
        "3",
    ];
    let result = run(femdem("pack")
        .args(options)
        .args([
            "--share",
            "1",
            "--count",
            "8",
            "--box",
            "3x3",
            "--diameter",
            "0.03",
        ])
        .args(QUICK)
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let first = summary(&out);
    assert_eq!(
        (&first["shape"], &first["settled"]),
        (&"mixed".into(), &true.into())
    );
    let counts: Vec<u64> = first["shapes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|shape| shape["count"].as_u64().unwrap())
        .collect();
    assert_eq!(counts, [6, 2]);
    assert!(out.join("shape-P5.obj").is_file());
    assert!(out.join("shape-hollow_cylinder_sides_8.obj").is_file());
    fs::remove_file(out.join("summary.json")).unwrap();
    assert_eq!(code(&run(femdem("analyse").arg(&out).arg("-q"))), 0);
    assert_eq!(summary(&out), first);
}

/// Names that differ in a replaced character only: each shape keeps its file, and is read from it.
#[test]
fn shapes_of_like_names_have_a_file_each() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let mut command = femdem("pack");
    for (name, text) in [
        ("a_b", crate::common::WEDGE.to_owned()),
        ("a b", crate::common::WEDGE.replace("0.1", "0.2")),
    ] {
        let path = folder.path().join(format!("{name}.obj"));
        fs::write(&path, text).unwrap();
        command.arg("--shape").arg(path);
    }
    let result = run(command
        .args(["--count", "4", "--box", "3x3", "-q"])
        .args(QUICK)
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let pack = femdem::input::read_folder(&out, &InputOptions::default()).unwrap();
    let density = summary(&out)["density"].as_f64().unwrap();
    for (body, mass) in pack.bodies.iter().zip(&pack.masses) {
        let shape = &pack.shapes[body.shape as usize];
        let wanted = density * shape.polyhedron.mass_properties().volume;
        assert!((mass / wanted - 1.0).abs() < 1e-9, "{}", shape.name);
    }
    let names: BTreeSet<&str> = pack.shapes.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, BTreeSet::from(["a b", "a_b"]));
}

#[test]
fn variants_differ_and_have_the_mass_asked_for() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let result = run(femdem("pack")
        .args([
            "--shape",
            "boulder:angularity=1",
            "--variety",
            "5",
            "--count",
            "5",
        ])
        .args(["--mass", "40", "--density", "2700", "--box", "1.5x1.6x3m"])
        .args([
            "--protocol",
            "pour",
            "--height",
            "2m",
            "--penetration",
            "0.01",
        ])
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let summary = summary(&out);
    let shapes = summary["shapes"].as_array().unwrap();
    assert_eq!(shapes.len(), 5);
    for shape in shapes {
        assert_eq!(shape["count"], 1);
        assert!((shape["volume"].as_f64().unwrap() * 2700.0 / 40.0 - 1.0).abs() < 1e-9);
    }
    let faces: BTreeSet<String> = shapes.iter().map(|s| s["diameter"].to_string()).collect();
    assert_eq!(faces.len(), 5);
    let container = &summary["container"];
    assert_eq!(
        (&container["width"], &container["rim"]),
        (&1.5.into(), &3.0.into())
    );
    assert_eq!(container["above_rim"], 0);
}

#[test]
fn a_silo_holds_its_pack_in_the_cone() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    let result = run(femdem("pack")
        .args([
            "--shape",
            "cube",
            "--count",
            "8",
            "--cylinder",
            "4",
            "--outlet",
            "1.5",
        ])
        .args(["--cone", "40"])
        .args(QUICK)
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let summary = summary(&out);
    assert_eq!(
        (&summary["settled"], &summary["container"]["kind"]),
        (&true.into(), &"silo".into())
    );
    // Lines of the table name the cone.
    let rows = table(&out.join("contacts.csv"));
    assert!(rows.iter().any(|row| row[1] == "cone"));
    for row in table(&out.join("bodies.csv")) {
        let [x, y, z] = [2, 3, 4].map(|k| row[k].parse::<f64>().unwrap());
        let wall = 0.75 * 0.05 + z * 40_f64.to_radians().tan();
        assert!(x.hypot(y) < wall.min(2.0 * 0.05), "{x} {y} {z}");
    }
}

#[test]
fn bad_shapes_say_what_is_allowed() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("out");
    for (options, words) in [
        (
            &["--shape", "dolos:waste=0.3"][..],
            &["dolos", "waste", "waist"][..],
        ),
        (&["--shape", "dolos:waist=3"], &["waist", "0.42"]),
        (&["--shape", "dulos"], &["dulos", "dolos"]),
        (&["--variety", "3"], &["variety = 3", "boulder"]),
        (&["--share", "3", "--share", "1"], &["one number for each"]),
        (&["--mass", "0"], &["mass = 0"]),
        (&["--mass", "1", "--size", "1"], &["--mass", "--size"]),
        (
            &["--shape", "dolos", "--mesh-size", "0"],
            &["mesh-size = 0"],
        ),
        (&["--box", "5x5x0m"], &["--box", "5.26x5.3x3.87m"]),
        (&["--cylinder", "4", "--cone", "95"], &["cone = 95"]),
    ] {
        fails(femdem("pack").args(options).arg("--out").arg(&out), words);
        assert!(!out.exists(), "{options:?}");
    }
}

#[test]
fn the_gallery_is_a_picture() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("shapes.png");
    let result = run(femdem("shapes").arg("--picture").arg(&path));
    assert_eq!(code(&result), 0, "{result:?}");
    assert_eq!(fs::read(&path).unwrap()[..4], *b"\x89PNG");
}

/// A square funnel of plates 10 mm thick, 0.4 m wide above and 0.1 m below, 0.3 m high.
fn funnel() -> String {
    let mut text = String::new();
    for (z, inner, outer) in [(0.0, 0.05, 0.06), (0.3, 0.2, 0.21)] {
        for half in [inner, outer] {
            for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                text += &format!("v {} {} {z}\n", half * x, half * y);
            }
        }
    }
    // Corners: 1-4 inner and 5-8 outer below, 9-12 inner and 13-16 outer above.
    for k in 0..4 {
        let n = (k + 1) % 4;
        let [a, b] = [k + 1, n + 1];
        text += &format!("f {a} {} {} {b}\n", a + 8, b + 8);
        text += &format!("f {} {} {} {}\n", a + 4, b + 4, b + 12, a + 12);
        text += &format!("f {a} {b} {} {}\n", b + 4, a + 4);
        text += &format!("f {} {} {} {}\n", a + 8, a + 12, b + 12, b + 8);
    }
    text
}

#[test]
fn a_container_comes_from_a_file() {
    let folder = tempdir().unwrap();
    let (walls, out) = (folder.path().join("funnel.obj"), folder.path().join("out"));
    fs::write(&walls, funnel()).unwrap();
    let result = run(femdem("pack")
        .args([
            "--shape",
            "P3",
            "--count",
            "12",
            "--protocol",
            "pour",
            "--walls",
        ])
        .arg(&walls)
        .args(QUICK)
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let summary = summary(&out);
    let container = &summary["container"];
    assert_eq!(
        (&summary["settled"], &container["kind"]),
        (&true.into(), &"solid".into())
    );
    let opening = container["diameter"].as_f64().unwrap();
    assert!((opening - 0.4).abs() < 1e-3, "{opening}");
    assert_eq!(container["above_rim"], 0);
    assert!(summary["packing_density"].is_null());
    let said = stdout(&result);
    assert!(
        said.contains("none: a container from a file has no core"),
        "{said}"
    );
    // Inside it is a frustum 0.1 m wide below, widening by the height.
    let number = |key: &str| summary["bed"][key].as_f64().unwrap();
    let wide = 0.1 + number("top");
    let frustum = (wide.powi(3) - 0.1_f64.powi(3)) / 3.0;
    assert!((number("volume") / frustum - 1.0).abs() < 1e-9, "{summary}");
    let void = number("void_fraction");
    assert!(
        (0.3..0.9).contains(&void) && said.contains("void fraction 0."),
        "{said}"
    );
    let rows = table(&out.join("contacts.csv"));
    assert!(rows.iter().any(|row| row[1] == "funnel"));
    for row in table(&out.join("bodies.csv")) {
        let [x, y, z] = [2, 3, 4].map(|k| row[k].parse::<f64>().unwrap());
        let wall = 0.05 + 0.5 * z;
        assert!(x.abs() < wall && y.abs() < wall && z > 0.0, "{x} {y} {z}");
    }
}

#[test]
fn damaged_files_are_mended_only_when_asked() {
    let folder = tempdir().unwrap();
    let (obj, out) = (folder.path().join("twice.obj"), folder.path().join("out"));
    fs::write(&obj, format!("{DENTED}f 1 4 3 2\n")).unwrap();
    let pack = || {
        let mut command = femdem("pack");
        command.arg("--shape").arg(&obj);
        command.args(["--unit", "mm", "--count", "1", "--cylinder", "2"]);
        command.args(QUICK).arg("--out").arg(&out);
        command
    };
    fails(
        &mut pack(),
        &["twice.obj", "facet 9 is a copy of an earlier one", "repair"],
    );
    assert!(!out.exists());
    let result = run(pack().arg("--repair"));
    assert_eq!(code(&result), 0, "{result:?}");
    let said = stdout(&result);
    assert!(said.contains("1 facets given twice dropped"), "{said}");
}
