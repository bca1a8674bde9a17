//! `femdem analyse` of a run and of a pack from elsewhere.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::fs;
use std::path::Path;

use crate::common::{TINY, code, fails, femdem, run, stdout};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

fn tables(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("analysis.json")).unwrap()).unwrap()
}

fn missing(tables: &Value) -> Vec<&str> {
    let list = tables["missing"].as_array().unwrap();
    list.iter().map(|m| m["table"].as_str().unwrap()).collect()
}

/// Columns `keep` of a table.
fn columns(text: &str, keep: impl Fn(&str) -> bool) -> String {
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let row = |line: &str| {
        let fields = line.split(',').zip(&header);
        let kept: Vec<&str> = fields.filter(|(_, name)| keep(name)).map(|f| f.0).collect();
        kept.join(",")
    };
    text.lines().map(|line| row(line) + "\n").collect()
}

/// Two numbers, or lists and maps of them, to 1e-6 of the larger. Principal directions turn with the last
/// digits of a table where their values are nearly equal: those of `b` must belong to the tensor of `a`.
fn agree(a: &Value, b: &Value, path: &str) {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            let [x, y] = [x, y].map(|n| n.as_f64().unwrap());
            let scale = x.abs().max(y.abs()).max(1e-9);
            assert!((x - y).abs() <= 1e-6 * scale, "{path}: {x} and {y}");
        }
        (Value::Array(x), Value::Array(y)) => {
            assert_eq!(x.len(), y.len(), "{path}");
            for (k, (x, y)) in x.iter().zip(y).enumerate() {
                agree(x, y, &format!("{path}[{k}]"));
            }
        }
        (Value::Object(x), Value::Object(y)) => {
            assert!(x.keys().eq(y.keys()), "{path}");
            let is_tensor = x.contains_key("tensor");
            for (key, of_x) in x {
                let path = format!("{path}.{key}");
                if key == "directions" && is_tensor {
                    assert_principal(a, &y[key], &path);
                } else {
                    agree(of_x, &y[key], &path);
                }
            }
        }
        _ => assert_eq!(a, b, "{path}"),
    }
}

/// Unit directions of the principal values of the symmetric part of a tensor, to 1e-6 of the largest value.
fn assert_principal(of: &Value, directions: &Value, path: &str) {
    let number = |x: &Value| x.as_f64().unwrap();
    let t = |i: usize, j: usize| number(&of["tensor"][i][j]);
    let largest = (0..3).map(|k| number(&of["principal"][k]).abs());
    let largest = largest.fold(0.0, f64::max);
    for k in 0..3 {
        let d: Vec<f64> = (0..3).map(|i| number(&directions[k][i])).collect();
        let norm2: f64 = d.iter().map(|x| x * x).sum();
        assert!((norm2 - 1.0).abs() < 1e-9, "{path}[{k}]: {d:?}");
        for i in 0..3 {
            let row: f64 = (0..3).map(|j| 0.5 * (t(i, j) + t(j, i)) * d[j]).sum();
            let left = row - number(&of["principal"][k]) * d[i];
            assert!(left.abs() <= 1e-6 * largest, "{path}[{k}]: {left} left");
        }
    }
}

/// A small pack, and a copy of its tables and shapes in a folder that knows nothing else.
fn packed() -> (TempDir, TempDir) {
    let (run_folder, foreign) = (tempdir().unwrap(), tempdir().unwrap());
    let out = run_folder.path();
    let mut command = femdem("pack");
    command
        .args(TINY)
        .args(["--force", "--quiet", "--out"])
        .arg(out);
    assert_eq!(code(&run(&mut command)), 0);
    for name in ["bodies.csv", "contacts.csv", "shape-P5.obj"] {
        fs::copy(out.join(name), foreign.path().join(name)).unwrap();
    }
    (run_folder, foreign)
}

/// The same numbers from the checkpoint and from the tables; without a column, a file or the container, less,
/// and words why.
#[test]
fn a_run_and_its_tables_give_the_same_results() {
    let (own, foreign) = packed();
    // Three axes at right angles have no nematic director: one that has.
    let axes = ["--axes", "0.1,0.2,1"];
    let output = run(femdem("analyse").arg(own.path()).args(axes));
    assert_eq!(code(&output), 0);
    assert!(stdout(&output).contains("vertical balance"));
    let complete = tables(own.path());
    assert_eq!(complete["bodies"], 8);
    for key in [
        "coordination",
        "force_distribution",
        "stress_profile",
        "vertical_balance",
        "fabric",
    ] {
        assert!(complete[key].is_object(), "{key}");
    }
    let lists = own.path().join("analysis");
    let bodies = fs::read_to_string(lists.join("bodies.csv")).unwrap();
    assert_eq!(bodies.lines().count(), 9);
    assert!(lists.join("density-map.vti").is_file());

    // The container of the run: 3 d wide, one d of air above the pack.
    let container = &complete["height_profile"]["region"];
    let corner = |name: &str, k: usize| container[name][k].as_f64().unwrap().to_string();
    let corners: Vec<String> = ["min", "max"]
        .iter()
        .flat_map(|n| (0..3).map(|k| corner(n, k)))
        .collect();
    let mut command = femdem("analyse");
    command
        .arg(foreign.path())
        .args(["--quiet", "--inside", &corners.join(",")]);
    command.args(axes);
    assert_eq!(code(&run(&mut command)), 0);
    agree(&complete, &tables(foreign.path()), "analysis");

    // No container: no profile, and the files of the earlier analysis are gone.
    let output = run(femdem("analyse").arg(foreign.path()));
    assert!(stdout(&output).contains("the container is not known"));
    let found = tables(foreign.path());
    assert!(missing(&found).contains(&"height_profile") && found["stress_profile"].is_null());
    assert!(!foreign.path().join("analysis/height-profile.csv").exists());
    agree(
        &complete["vertical_balance"],
        &found["vertical_balance"],
        "vertical_balance",
    );

    // The table has masses; no body is there.
    for (option, value, words) in [
        ("--density", "1000", "column mass"),
        (
            "--inside",
            "9,9,9,10,10,10",
            "inside = a region without a body",
        ),
    ] {
        let mut command = femdem("analyse");
        fails(command.arg(foreign.path()).args([option, value]), &[words]);
    }
}

#[test]
fn what_the_tables_do_not_tell_is_said() {
    let (_own, foreign) = packed();
    let folder = foreign.path();
    let [bodies, contacts] =
        ["bodies.csv", "contacts.csv"].map(|name| fs::read_to_string(folder.join(name)).unwrap());
    let analyse = |arguments: &[&str]| {
        let output = run(femdem("analyse").arg(folder).args(arguments));
        assert_eq!(code(&output), 0, "{output:?}");
        (stdout(&output), tables(folder))
    };
    // No masses: nothing against weights, unless a density is given.
    fs::write(folder.join("bodies.csv"), columns(&bodies, |c| c != "mass")).unwrap();
    let (text, found) = analyse(&[]);
    assert!(text.contains("masses of the bodies") && found["force_maxima"].is_null());
    assert!(found["chains_by_stress"].is_object());
    let (_, found) = analyse(&["--density", "2560"]);
    assert!(found["vertical_balance"]["worst"].as_f64().unwrap() < 0.02);

    // No friction vectors: no stress. No classes: no rattlers.
    let short = columns(&contacts, |c| !["tx", "ty", "tz", "class"].contains(&c));
    fs::write(folder.join("contacts.csv"), short).unwrap();
    let (text, found) = analyse(&["--density", "2560"]);
    assert!(text.contains("tx, ty, tz") && text.contains("column class"));
    for key in ["body_stresses", "chains_by_weight", "rattlers", "classes"] {
        assert!(
            missing(&found).contains(&key) && found[key].is_null(),
            "{key}"
        );
    }
    assert!(found["force_distribution"].is_object() && found["coordination"].is_object());

    // No contacts: those that the overlaps show, without forces.
    fs::remove_file(folder.join("contacts.csv")).unwrap();
    let (text, found) = analyse(&["--inside", "cylinder:0,0,0.2,0,0.2"]);
    assert!(text.contains("give contacts.csv"));
    assert!(found["coordination"].is_object() && found["height_profile"].is_object());
    assert!(found["force_distribution"].is_null());
    let rows = fs::read_to_string(folder.join("analysis/bodies.csv")).unwrap();
    // No force is known of a body.
    let fields: Vec<&str> = rows.lines().nth(1).unwrap().split(',').collect();
    let known: Vec<usize> = (0..fields.len())
        .filter(|k| !fields[*k].is_empty())
        .collect();
    assert_eq!((known, fields[0]), (vec![0, 1, 2, 3, 4], "0"));
}

#[test]
fn faulty_tables_are_refused_with_file_and_line() {
    let (own, foreign) = packed();
    let folder = foreign.path();
    let [bodies, contacts] =
        ["bodies.csv", "contacts.csv"].map(|name| fs::read_to_string(folder.join(name)).unwrap());
    let refused = |file: &str, text: &str, words: &[&str]| {
        fs::write(folder.join(file), text).unwrap();
        let words: Vec<&str> = words.iter().copied().chain([file]).collect();
        fails(femdem("analyse").arg(folder), &words);
        fs::write(folder.join("bodies.csv"), &bodies).unwrap();
        fs::write(folder.join("contacts.csv"), &contacts).unwrap();
    };
    let with = |text: &str, line: usize, column: usize, value: &str| -> String {
        let change = |(k, row): (usize, &str)| {
            let mut fields: Vec<&str> = row.split(',').collect();
            if k + 1 == line {
                fields[column] = value;
            }
            fields.join(",") + "\n"
        };
        text.lines().enumerate().map(change).collect()
    };
    refused("bodies.csv", "", &["line 1", "empty"]);
    refused(
        "bodies.csv",
        &columns(&bodies, |c| c != "qw"),
        &["no column `qw`"],
    );
    refused(
        "bodies.csv",
        &with(&bodies, 3, 2, "inf"),
        &["line 3", "x = `inf`"],
    );
    refused(
        "bodies.csv",
        &with(&bodies, 4, 5, "7"),
        &["line 4", "length"],
    );
    refused("bodies.csv", &with(&bodies, 4, 0, "1"), &["line 4", "id 1"]);
    refused(
        "bodies.csv",
        &with(&bodies, 2, 1, "../P5"),
        &["line 2", "shape-___P5.obj"],
    );
    refused(
        "bodies.csv",
        &with(&bodies, 2, 11, "-1"),
        &["line 2", "above zero"],
    );
    refused(
        "contacts.csv",
        &with(&contacts, 2, 0, "99"),
        &["line 2", "i = `99`"],
    );
    refused(
        "contacts.csv",
        &with(&contacts, 2, 1, "99"),
        &["line 2", "j = 99"],
    );
    refused(
        "contacts.csv",
        &with(&contacts, 3, 5, "3"),
        &["line 3", "normal"],
    );
    refused(
        "contacts.csv",
        &with(&contacts, 3, 11, "flat"),
        &["line 3", "class", "edge-face"],
    );
    let turned = contacts.lines().enumerate().map(|(k, row)| {
        let mut fields: Vec<String> = row.split(',').map(str::to_owned).collect();
        for field in fields[5..8].iter_mut().filter(|_| k > 0) {
            *field = (-field.parse::<f64>().unwrap()).to_string();
        }
        fields.join(",") + "\n"
    });
    refused(
        "contacts.csv",
        &turned.collect::<String>(),
        &["from i to j"],
    );
    // Options for packs from elsewhere have no place with a run.
    fails(
        femdem("analyse")
            .arg(own.path())
            .args(["--density", "1000"]),
        &["--density", "checkpoint"],
    );
    fails(
        femdem("analyse").arg(folder).args(["--inside", "1,2,3"]),
        &["X0,Y0,Z0"],
    );
    fails(
        femdem("analyse").arg(folder).args(["--density=-1"]),
        &["density", "above zero"],
    );
}
