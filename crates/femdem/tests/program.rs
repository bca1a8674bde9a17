//! The program on a tiny pack: every file, the summary's keys, refusals, resume and analyse.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use crate::common::{TINY, code, fails, femdem, run, stdout, summary};
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// Keys of an object, and of the objects in it as "outer.inner".
fn keys(value: &serde_json::Value) -> Vec<String> {
    let mut keys = Vec::new();
    for (key, inner) in value.as_object().unwrap() {
        match inner.as_object() {
            Some(_) => keys.extend(self::keys(inner).iter().map(|k| format!("{key}.{k}"))),
            None => keys.push(key.clone()),
        }
    }
    keys
}

/// The keys of docs/summary.md, without those of objects whose own keys follow. A key that begins with a dot has
/// the parent of the first key of its row.
fn documented() -> Vec<String> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/summary.md");
    let mut keys = Vec::new();
    for row in lines(&page).iter().filter(|line| line.starts_with("| `")) {
        let cell = row.split(" | ").next().unwrap();
        let names: Vec<&str> = cell.split('`').skip(1).step_by(2).collect();
        let parent = names[0].rsplit_once('.').map_or("", |(parent, _)| parent);
        keys.extend(names.iter().map(|name| match name.strip_prefix('.') {
            Some(rest) => format!("{parent}.{rest}"),
            None => (*name).to_owned(),
        }));
    }
    let is_object = |key: &String| {
        keys.iter()
            .any(|other| other.starts_with(&format!("{key}.")))
    };
    let is_leaf: Vec<bool> = keys.iter().map(|key| !is_object(key)).collect();
    let kept = keys.into_iter().zip(is_leaf).filter(|(_, leaf)| *leaf);
    kept.map(|(key, _)| key).collect()
}

fn lines(path: &Path) -> Vec<String> {
    fs::read_to_string(path)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect()
}

#[test]
fn a_pack_leaves_every_file_and_every_key() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("new/pack");
    let result = run(femdem("pack").args(TINY).arg("--out").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(
        stdout(&result).contains("8 bodies P5, d = 0.05 m, settled"),
        "{}",
        stdout(&result)
    );

    let mut names: Vec<String> = fs::read_dir(&out)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = [
        "bodies.csv",
        "contacts.csv",
        "contacts.vtp",
        "pack.ckpt",
        "pack.png",
        "pack.stl",
        "pack.vtu",
        "scene.toml",
        "shape-P5.obj",
        "sieve.csv",
        "summary.json",
    ];
    assert_eq!(names, expected);

    let summary = summary(&out);
    let mut found = keys(&summary);
    let mut wanted = documented();
    found.sort();
    wanted.sort();
    assert_eq!(found, wanted);
    assert_eq!(summary["count"], 8);
    assert_eq!(summary["settled"], true);
    assert!(summary["packing_density"]["exact"].as_f64().unwrap() > 0.2);

    let bodies = lines(&out.join("bodies.csv"));
    assert_eq!(
        bodies[0],
        "id,shape,x,y,z,qw,qx,qy,qz,sequence,sleeping,mass,velocity_x,velocity_y,velocity_z"
    );
    assert_eq!(bodies.len(), 9);
    let contacts = lines(&out.join("contacts.csv"));
    assert_eq!(
        contacts[0],
        "i,j,x,y,z,nx,ny,nz,normal_force,tangential_force,area,class,patch,volume,tx,ty,tz,mx,my,mz"
    );
    weight_rests_on_the_floor(&contacts, &summary);
}

/// In equilibrium the walls carry the weight: floor by normal force, side walls by friction at most.
fn weight_rests_on_the_floor(contacts: &[String], summary: &serde_json::Value) {
    let number = |key: &str| summary[key].as_f64().unwrap();
    // A cube with circumscribed diameter d has sides d/sqrt(3).
    let side = number("diameter") / 3.0_f64.sqrt();
    let weight = 8.0 * number("density") * side.powi(3) * 9.81;
    let columns = contacts
        .iter()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let floor: f64 = columns
        .filter(|c| c[1] == "floor")
        .map(|c| c[8].parse::<f64>().unwrap())
        .sum();
    assert!(
        (0.5..1.02).contains(&(floor / weight)),
        "{floor} N of {weight} N"
    );
}

/// Interrupts a run as soon as its first checkpoint is there, and returns its exit code: 130, or 0 if it
/// came to its end before.
#[cfg(unix)]
fn interrupted(options: &[&str], out: &Path) -> i32 {
    let mut child = femdem("pack")
        .args(options)
        .args(["--threads", "2", "-q", "--out"])
        .arg(out)
        .spawn()
        .unwrap();
    // The first checkpoint is written before the first step; Ctrl-C is watched for by then.
    while !out.join("pack.ckpt").is_file() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    if child.try_wait().unwrap().is_none() {
        crate::common::interrupt(&child);
    }
    let code = child.wait().unwrap().code().unwrap();
    assert!([0, 130].contains(&code), "exit code {code}");
    code
}

/// A job that is forced into a folder leaves nothing there that would pass for its own.
#[cfg(unix)]
#[test]
fn a_forced_job_forgets_the_one_before() {
    let folder = tempdir().unwrap();
    let (out, scene) = (folder.path().join("out"), folder.path().join("run.toml"));
    fs::write(
        &scene,
        "duration = 0.001\n[material.m]\ndensity = 1000\n\
         [[body]]\nshape = \"cube\"\ndiameter = 0.1\nmaterial = \"m\"\n",
    )
    .unwrap();
    let scene_run = run(femdem("run").arg(&scene).arg("-q").arg("--out").arg(&out));
    assert_eq!(code(&scene_run), 0, "{scene_run:?}");
    let refused = run(femdem("pack")
        .args(["--count", "0", "--force", "--out"])
        .arg(&out));
    assert_eq!(code(&refused), 1, "{refused:?}");
    assert!(out.join("run.ckpt").is_file() && out.join("summary.json").is_file());

    let long = ["--count", "60", "--batch", "1", "--force", "--report"];
    let mut tries = 0..20;
    while interrupted(&long, &out) != 130 {
        assert!(tries.next().is_some(), "never interrupted before its end");
        std::fs::remove_dir_all(&out).unwrap();
    }
    assert!(out.join("pack.ckpt").is_file());
    assert!(!out.join("run.ckpt").exists() && !out.join("summary.json").exists());
    // Bodies that still fall do not lie where stresses could be found.
    let early = run(femdem("resolve").arg(&out));
    assert_eq!(code(&early), 1, "{early:?}");
    assert!(!out.join("resolved").exists());
    let resumed = run(femdem("resume").arg(&out).args(["--report", "-q"]));
    assert_eq!(code(&resumed), 0, "{resumed:?}");
    assert_eq!(summary(&out)["count"], 60);
    assert!(out.join("report.html").is_file());

    // Nothing was left to do: looking again costs nothing.
    let wall = summary(&out)["wall_seconds"].clone();
    let again = run(femdem("resume").arg(&out).arg("-q"));
    assert_eq!(code(&again), 0, "{again:?}");
    assert_eq!(summary(&out)["wall_seconds"], wall);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_resumes_to_the_same_bits() {
    let folder = tempdir().unwrap();
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    // Small batches make the run long enough to be interrupted before its end.
    let options = [
        "--shape",
        "P5",
        "--count",
        "12",
        "--box",
        "3x3",
        "--penetration",
        "0.005",
        "--batch",
        "1",
    ];
    let result = run(femdem("pack")
        .args(options)
        .args(["--threads", "1", "-q", "--out"])
        .arg(&whole));
    assert_eq!(code(&result), 0, "{result:?}");

    // On a busy machine the run may have ended before it is interrupted: then it is made again.
    let mut tries = 0..20;
    while interrupted(&options, &parts) != 130 {
        assert!(tries.next().is_some(), "never interrupted before its end");
        std::fs::remove_dir_all(&parts).unwrap();
    }
    assert!(!parts.join("summary.json").exists());
    let result = run(femdem("resume").arg(&parts).args(["--threads", "3"]));
    assert_eq!(code(&result), 0, "{result:?}");
    let hash = |folder: &Path| summary(folder)["state_hash"].clone();
    assert_eq!(hash(&parts), hash(&whole));
    assert_eq!(
        fs::read(parts.join("bodies.csv")).unwrap(),
        fs::read(whole.join("bodies.csv")).unwrap()
    );
}

#[test]
fn analyse_writes_the_same_results_again() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("a");
    assert_eq!(
        code(&run(femdem("pack").args(TINY).arg("--out").arg(&out))),
        0
    );
    let first = summary(&out);
    let checkpoint = fs::read(out.join("pack.ckpt")).unwrap();
    for name in ["summary.json", "bodies.csv", "pack.png"] {
        fs::remove_file(out.join(name)).unwrap();
    }
    assert_eq!(code(&run(femdem("analyse").arg(&out).arg("--quiet"))), 0);
    assert_eq!(summary(&out), first);
    assert!(out.join("bodies.csv").is_file() && out.join("pack.png").is_file());
    assert_eq!(fs::read(out.join("pack.ckpt")).unwrap(), checkpoint);
}

#[test]
fn a_printed_scene_gives_the_same_pack() {
    let folder = tempdir().unwrap();
    let printed = run(femdem("pack").args(TINY).arg("--print-scene"));
    assert_eq!(code(&printed), 0);
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, stdout(&printed)).unwrap();
    let hash = |name: &str, command: &mut std::process::Command| {
        let out = folder.path().join(name);
        assert_eq!(code(&run(command.arg("--out").arg(&out))), 0);
        summary(&out)["state_hash"].clone()
    };
    let by_options = hash("a", femdem("pack").args(TINY));
    assert_eq!(hash("b", femdem("pack").arg(&scene)), by_options);
    // An option beside the scene wins.
    assert_ne!(
        hash("c", femdem("pack").arg(&scene).args(["--seed", "2"])),
        by_options
    );
}

#[test]
fn a_body_from_a_file_is_packed_in_a_cylinder() {
    let folder = tempdir().unwrap();
    let (obj, out) = (folder.path().join("wedge.obj"), folder.path().join("out"));
    fs::write(&obj, crate::common::WEDGE).unwrap();
    let options = [
        "--count",
        "3",
        "--cylinder",
        "2.5",
        "--penetration",
        "0.02",
        "--diameter",
        "0.1",
    ];
    let result = run(femdem("pack")
        .arg("--shape")
        .arg(&obj)
        .args(options)
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    assert_eq!(summary(&out)["shape"], "wedge");
    assert!((summary(&out)["diameter"].as_f64().unwrap() - 0.1).abs() < 1e-12);
    assert!(out.join("shape-wedge.obj").is_file());
}

#[test]
fn shapes_are_18_solids_with_known_values_and_families_with_parameters() {
    let table = stdout(&run(&mut femdem("shapes")));
    assert!(table.contains("truncated icosidodecahedron"));
    let words: Vec<&str> = table.split_whitespace().collect();
    for alias in [
        ["raschig", "hollow_cylinder"],
        ["rock", "boulder"],
        ["brick", "box"],
    ] {
        assert!(words.windows(2).any(|w| w == alias), "{alias:?}");
    }
    let json = stdout(&run(femdem("shapes").arg("--json")));
    let rows: Vec<serde_json::Value> = serde_json::from_str(&json).unwrap();
    assert!(rows.len() > 18);
    let dolos = rows.iter().find(|row| row["id"] == "dolos").unwrap();
    assert_eq!(
        (&dolos["convex"], &dolos["inradius_over_d"]),
        (&false.into(), &serde_json::Value::Null)
    );
    let parameters = dolos["parameters"].as_array().unwrap();
    for p in parameters {
        let setting = format!(
            "{}={}",
            p["name"].as_str().unwrap(),
            p["default"].as_str().unwrap()
        );
        assert!(table.contains(&setting), "{setting}");
    }
    assert!(!parameters.is_empty());
    let cube = rows.iter().find(|row| row["id"] == "P5").unwrap();
    let expect = |key: &str, value: f64| {
        assert!((cube[key].as_f64().unwrap() - value).abs() < 1e-12, "{key}");
    };
    // A cube of side a = d/sqrt(3): a^3, 6 a^2, a/2 and a^2/6.
    expect("volume_over_d3", 3.0_f64.sqrt() / 9.0);
    expect("area_over_d2", 2.0);
    expect("inradius_over_d", 3.0_f64.sqrt() / 6.0);
    expect("inertia_over_m_d2", 1.0 / 18.0);
    assert_eq!(
        (&cube["name"], &cube["vertices"], &cube["faces"]),
        (&"cube".into(), &8.into(), &6.into())
    );
}

#[test]
fn quiet_is_quiet_and_help_teaches() {
    let folder = tempdir().unwrap();
    let result = run(femdem("pack")
        .args(TINY)
        .args(["-q", "--out"])
        .arg(folder.path().join("x")));
    assert_eq!(
        (code(&result), result.stdout.len(), result.stderr.len()),
        (0, 0, 0)
    );
    let help = stdout(&run(femdem("pack").arg("--help")));
    for word in [
        "--friction",
        "kg/m3",
        "summary.json",
        "Ctrl-C",
        "sequential",
        "such as 6x6",
    ] {
        assert!(help.contains(word), "{word}");
    }
    fails(&mut femdem("nonsense"), &["nonsense"]);
}

/// A core too wide for counting cells has no density by the grid, and all else.
#[test]
fn a_wide_box_has_its_results() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("wide");
    let result = run(femdem("pack")
        .args(["--count", "5", "--box", "600x600", "--threads", "2"])
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(stdout(&result).contains("none by grid"), "{result:?}");
    let density = &summary(&out)["packing_density"];
    assert!(density["grid"].is_null() && density["exact"].as_f64().unwrap() > 0.0);
}
