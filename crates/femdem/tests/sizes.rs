//! Sizes and densities of the bodies of a pack, from the command to a run that starts from it, forecasts, and sweeps.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{TINY, code, fails, femdem, run, stdout, summary};
use std::f64::consts::FRAC_PI_6;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Numbers of a column of a table, beside the texts of another.
fn columns(path: &Path, text: &str, number: &str) -> Vec<(String, f64)> {
    let table = fs::read_to_string(path).unwrap();
    let mut rows = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let at = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let (text, number) = (at(text), at(number));
    rows.map(|row| (row[text].to_owned(), row[number].parse().unwrap()))
        .collect()
}

/// Cubes of two sizes with equal masses, 8 small ones for a large one, and heavy balls.
#[test]
fn sizes_and_densities_go_through_to_a_run() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    let result = run(femdem("pack")
        .args([
            "--shape", "P5", "--shape", "sphere", "--share", "9", "--share", "3",
        ])
        .args(["--sizes", "20mm:1,40mm:1", "--sizes", "30mm"])
        .args([
            "--density",
            "1000",
            "--density",
            "8000",
            "--count",
            "12",
            "--box",
            "4x4",
        ])
        .args(["--penetration", "0.02", "--threads", "2", "--out"])
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let text = stdout(&result);
    assert!(
        text.contains("9 bodies of 20 to 40 mm in 2 sizes"),
        "{text}"
    );
    assert!(text.contains("d50 30, d90"), "{text}");

    let masses = columns(&out.join("bodies.csv"), "shape", "mass");
    let small = 1000.0 * (0.02 / 3.0_f64.sqrt()).powi(3);
    let ball = 8000.0 * FRAC_PI_6 * 0.03_f64.powi(3);
    for (name, mass, count) in [
        ("P5 20mm", small, 8),
        ("P5 40mm", 8.0 * small, 1),
        ("sphere 30mm", ball, 3),
    ] {
        let own: Vec<f64> = masses.iter().filter(|m| m.0 == name).map(|m| m.1).collect();
        assert_eq!(own.len(), count, "{name}");
        assert!(
            own.iter().all(|m| (m / mass - 1.0).abs() < 1e-9),
            "{name}: {own:?}"
        );
    }
    let total = 16.0 * small + 3.0 * ball;
    let curve = columns(&out.join("sieve.csv"), "size_m", "passing");
    let sizes: Vec<&str> = curve.iter().map(|point| point.0.as_str()).collect();
    assert_eq!(sizes.len(), 3, "{sizes:?}");
    for (point, wanted) in curve
        .iter()
        .zip([8.0 * small, 8.0 * small + 3.0 * ball, total])
    {
        assert!((point.1 - wanted / total).abs() < 1e-9, "{point:?}");
    }
    let volume = 16.0 * small / 1000.0 + 3.0 * ball / 8000.0;
    let density = summary(&out)["density"].as_f64().unwrap();
    assert!((density * volume / total - 1.0).abs() < 1e-9);

    // A run has the same masses.
    let scene = folder.path().join("run.toml");
    fs::write(
        &scene,
        format!("from = {:?}\nduration = 1e-4\n", out.to_str().unwrap()),
    )
    .unwrap();
    let later = folder.path().join("run");
    let result = run(femdem("run").arg(&scene).arg("--out").arg(&later));
    assert_eq!(code(&result), 0, "{result:?}");
    let bodies = summary(&later)["bodies"].as_array().unwrap().clone();
    for (body, (_, mass)) in bodies.iter().zip(&masses) {
        let own = body["mass"].as_f64().unwrap();
        assert!((own / mass - 1.0).abs() < 1e-12, "{own} {mass}");
    }
}

#[test]
fn a_pack_is_forecast_without_files_and_an_endless_run_is_refused() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    let result = run(femdem("pack")
        .args(TINY)
        .arg("--check")
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(stdout(&result).contains("cost: "), "{result:?}");
    assert!(!out.exists());

    let scene = folder.path().join("long.toml");
    let text = "duration = 1e6\nrest = { energy = 1e9, time = 1e-9 }\ncontact.penalty = 1e9\nmaterial.m.density = 1000\n\
                [[wall]]\nplane = { normal = [0, 0, 1] }\n\
                [[body]]\nshape = \"P5\"\nsize = 0.01\nmaterial = \"m\"\nposition = [0, 0, 0.0028]\n";
    fs::write(&scene, text).unwrap();
    let mut command = femdem("run");
    command.arg(&scene).arg("--out").arg(&out);
    fails(&mut command, &["--yes", "steps of"]);
    assert!(!out.exists());
}

#[test]
fn a_sweep_makes_all_combinations_once() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("tiny.toml");
    let printed = stdout(&run(femdem("pack").args(TINY).arg("--print-scene")));
    fs::write(&scene, &printed).unwrap();
    let out = folder.path().join("sweep");
    let sweep = || {
        let mut command = femdem("sweep");
        command
            .arg(&scene)
            .args(["--vary", "friction=0.3,0.6", "--seeds", "2", "--out"])
            .arg(&out)
            .args(["--chart", "coordination.mean"]);
        command
    };
    let result = run(&mut sweep());
    assert_eq!(code(&result), 0, "{result:?}");
    let rows = columns(&out.join("sweep.csv"), "row", "coordination.mean");
    let kinds: Vec<&str> = rows.iter().map(|row| row.0.as_str()).collect();
    assert_eq!(kinds, ["job", "job", "mean", "standard error"].repeat(2));
    let [a, b, mean, error] = [0, 1, 2, 3].map(|k| rows[k].1);
    assert!((mean - 0.5 * (a + b)).abs() < 1e-12);
    // Of two values the standard error is half their difference.
    assert!((error - 0.5 * (a - b).abs()).abs() < 1e-12);
    let chart = fs::read_to_string(out.join("sweep.svg")).unwrap();
    assert_eq!(chart.matches("<circle").count(), 2, "{chart}");
    assert!(chart.contains(">friction<") && chart.contains(">coordination.mean<"));
    let job = out.join("friction=0.3,seed=4");
    let made = fs::metadata(job.join("summary.json"))
        .unwrap()
        .modified()
        .unwrap();

    // What is finished stays; a job whose folder was lost is made again, to the same bits.
    let hash = summary(&out.join("friction=0.6,seed=3"))["state_hash"].clone();
    fs::remove_dir_all(out.join("friction=0.6,seed=3")).unwrap();
    assert_eq!(code(&run(&mut sweep())), 0);
    assert_eq!(
        fs::metadata(job.join("summary.json"))
            .unwrap()
            .modified()
            .unwrap(),
        made
    );
    assert_eq!(
        summary(&out.join("friction=0.6,seed=3"))["state_hash"],
        hash
    );

    fs::write(&scene, printed.replace("count = 8", "count = 7")).unwrap();
    fails(&mut sweep(), &["of another scene", "4 of 4 jobs failed"]);
    let rows = columns(&out.join("sweep.csv"), "row", "coordination.mean");
    assert!(rows.is_empty(), "{rows:?}");
    assert!(!out.join("sweep.svg").exists());
    fails(
        femdem("sweep").arg(&scene).args(["--chart", "height"]),
        &["--chart height", "coordination.mean"],
    );
    fails(
        femdem("sweep").arg(&scene).args(["--vary", "frction=1"]),
        &["frction"],
    );
}
