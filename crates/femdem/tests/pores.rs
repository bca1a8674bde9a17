//! `femdem pores`: from a pack, from tables and from a run of a scene to files for flow codes.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::common::{TINY, code, fails, femdem, run, stdout, summary};
use serde_json::Value;
use tempfile::{TempDir, tempdir};

/// One cube of 1 m in the middle of a box of 2 m, as tables.
fn one_cube() -> TempDir {
    let folder = tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "bodies.csv",
        "shape,x,y,z,qw,qx,qy,qz\ncube,0,0,1,1,0,0,0\n",
    );
    write(
        "shape-cube.obj",
        "v -.5 -.5 -.5\nv .5 -.5 -.5\nv .5 .5 -.5\nv -.5 .5 -.5\nv -.5 -.5 .5\nv .5 -.5 .5\nv .5 .5 .5\nv -.5 .5 .5\n\
         f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n",
    );
    folder
}

const AROUND: [&str; 2] = ["--region", "-1,-1,0,1,1,2"];

fn results(folder: &Path) -> Value {
    serde_json::from_slice(&fs::read(folder.join("pores.json")).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn one_cube_in_a_box_has_its_porosity_and_closed_surfaces() {
    let folder = one_cube();
    let out = folder.path().join("pores");
    let mut command = femdem("pores");
    command.arg(folder.path()).args(AROUND);
    let output = run(command.args(["--voxel", "100mm", "--sides", "wall", "--gap", "10mm"]));
    assert_eq!(code(&output), 0, "{output:?}");
    let found = results(&out);
    assert_eq!(found["counts"], serde_json::json!([20, 20, 20]));
    assert_eq!(number(&found["porosity"]["image"]), 0.875);
    assert!((number(&found["porosity"]["exact"]) - 0.875).abs() < 1e-12);
    assert!((number(&found["tortuosity"]["shortest"]) - 1.0).abs() < 1e-12);
    // Nothing touches: the cube stays as it is.
    let surface = &found["surface"];
    assert_eq!(surface["contacts"], "cap");
    assert_eq!(surface["changed"], 0);
    assert!((number(&surface["void_volume"]) - 7.0).abs() < 1e-6);
    for check in surface["checks"].as_array().unwrap() {
        assert_eq!(
            (&check["closed"], &check["open_edges"]),
            (&true.into(), &0.into())
        );
        let [own, exact] = ["volume", "analysis"].map(|key| number(&check[key]));
        assert!((own / exact - 1.0).abs() < 1e-6);
    }
    assert!(stdout(&output).contains("closed, 18 edges in two triangles each"));
    // The files fit together.
    let size = |name: &str| fs::metadata(out.join(name)).unwrap().len();
    assert_eq!((size("labels.raw"), size("phases.raw")), (4 * 8000, 8000));
    let header = fs::read_to_string(out.join("labels.mhd")).unwrap();
    assert!(header.contains("DimSize = 20 20 20\n"));
    let flow = out.join("flow");
    for (name, triangles) in [("bodies", 12), ("wall", 8), ("inlet", 4), ("outlet", 4)] {
        let path = flow.join(format!("constant/triSurface/{name}.stl"));
        assert_eq!(
            fs::metadata(&path).unwrap().len(),
            84 + 50 * triangles,
            "{name}"
        );
    }
    let dictionary = fs::read_to_string(flow.join("system/snappyHexMeshDict")).unwrap();
    let note = fs::read_to_string(flow.join("README.txt")).unwrap();
    // The mesh begins at a point that is in no face of its cells, whole or halved.
    let (_, point) = dictionary.split_once("locationInMesh (").unwrap();
    let (point, _) = point.split_once(')').unwrap();
    for x in point.split(' ') {
        let halves = 20.0 * x.parse::<f64>().unwrap();
        assert!((halves - halves.round()).abs() > 0.1, "{point}");
    }
    for name in ["bodies", "wall", "inlet", "outlet"] {
        assert!(
            dictionary.contains(&format!("{name}.stl")) && note.contains(&format!("{name}.stl"))
        );
    }
    // Cut sides are another patch, and the old one goes.
    let mut command = femdem("pores");
    command.arg(folder.path()).args(AROUND);
    let output = run(command.args(["--voxel", "0.1m", "--quiet"]));
    assert_eq!((code(&output), stdout(&output).as_str()), (0, ""));
    assert!(flow.join("constant/triSurface/sides.stl").is_file());
    assert!(!flow.join("constant/triSurface/wall.stl").exists());
}

/// All files of a folder and those below it.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

/// A pack from its checkpoint: every treatment leaves closed surfaces, with the same bits by one and two threads.
#[test]
fn a_pack_has_closed_surfaces_by_every_treatment_and_the_same_bits_by_any_threads() {
    let (pack, out) = (tempdir().unwrap(), tempdir().unwrap());
    let mut command = femdem("pack");
    command
        .args(TINY)
        .args(["--force", "--quiet", "--out"])
        .arg(pack.path());
    assert_eq!(code(&run(&mut command)), 0);
    for contacts in ["shrink", "gap", "cap", "bridge"] {
        let with = |threads: &str| {
            let folder = out.path().join(threads);
            let mut command = femdem("pores");
            command
                .arg(pack.path())
                .args(["--contacts", contacts, "--quiet"]);
            command.args(["--voxel", "0.06", "--threads", threads, "--out"]);
            assert_eq!(code(&run(command.arg(&folder))), 0, "{contacts}");
            (results(&folder), files(&folder))
        };
        let (found, one) = with("1");
        assert_eq!(found["sides"], "wall");
        assert_eq!(found["bodies"], 8);
        let surface = &found["surface"];
        assert_eq!(surface["contacts"], contacts);
        for check in surface["checks"].as_array().unwrap() {
            assert_eq!(check["closed"], true, "{contacts}: {check}");
        }
        // Soft contacts may be too deep to be taken apart by shrinking; there is no such volume then.
        let exact = number(&surface["exact_void_volume"]);
        match surface["void_volume"].as_f64() {
            Some(own) => assert!((own / exact - 1.0).abs() < 0.2, "{contacts}: {own} {exact}"),
            None => assert_eq!(contacts, "shrink"),
        }
        let (_, two) = with("2");
        assert!(one.len() > 15 && one == two, "{contacts}");
    }
}

/// A run of a scene, with a rigid ball and a deformable cube: the region has to be given, the ball is exact, at the end
/// and in the tables of a frame.
#[test]
fn a_run_of_a_scene_has_pores_too() {
    let folder = tempdir().unwrap();
    let scene = folder.path().join("scene.toml");
    let text = r#"
duration = 1e-5
tables = true
gravity = [0, 0, 0]
[material.rubber]
density = 1100
law = "neo-hookean"
young = 1e6
poisson = 0.4
[[body]]
shape = "sphere"
size = 1.0
material = "rubber"
position = [0, 0, 0.6]
[[body]]
shape = "cube"
size = 0.5
material = "rubber"
behaviour = "deformable"
mesh-size = 0.5
position = [0, 0, 1.5]
"#;
    fs::write(&scene, text).unwrap();
    let out = folder.path().join("run");
    let mut command = femdem("run");
    let output = run(command.arg(&scene).args(["--quiet", "--out"]).arg(&out));
    assert_eq!(code(&output), 0, "{output:?}");
    fails(
        femdem("pores").arg(&out),
        &["container is not known", "--region"],
    );
    let mut command = femdem("pores");
    command
        .arg(&out)
        .args(["--region", "-1,-1,0,1,1,2", "--voxel", "0.02m", "--quiet"]);
    assert_eq!(code(&run(&mut command)), 0);
    let found = results(&out.join("pores"));
    assert!(found["time"].is_null() && found["frame"].is_null());
    // Sizes are circumscribed diameters.
    let solid = std::f64::consts::PI / 6.0 + (0.5 / 3_f64.sqrt()).powi(3);
    for key in ["image", "exact"] {
        let porosity = number(&found["porosity"][key]);
        assert!(
            (porosity - (1.0 - solid / 8.0)).abs() < 5e-4,
            "{key}: {porosity}"
        );
    }
    // The last frame is the end, and has a folder of its own.
    let end = summary(&out);
    let last = end["frames"].as_u64().unwrap() - 1;
    let mut command = femdem("pores");
    command
        .arg(&out)
        .args(["--time", "1", "--region", "-1,-1,0,1,1,2"]);
    let output = run(command.args(["--voxel", "0.02m", "--no-surface"]));
    assert_eq!(code(&output), 0, "{output:?}");
    assert!(stdout(&output).contains(&format!("of frame {last} at ")));
    let frame = results(&out.join(format!("frames/{last:05}/pores")));
    assert_eq!(frame["frame"], last);
    assert!((number(&frame["time"]) / number(&end["simulated_time"]) - 1.0).abs() < 1e-9);
    for path in ["/porosity/image", "/pore_diameter/mean", "/tortuosity/mean"] {
        let [a, b] = [&found, &frame].map(|of| number(of.pointer(path).unwrap()));
        assert!((a / b - 1.0).abs() < 1e-7, "{path}: {a} {b}");
    }
}

#[test]
fn bad_options_of_pores_say_what_to_do() {
    let folder = one_cube();
    fails(
        femdem("pores").arg(folder.path()),
        &["container is not known", "--region"],
    );
    for (options, words) in [
        (&["--voxel", "1km"][..], &["--voxel", "44mm"][..]),
        (&["--voxel", "0"], &["voxel = 0", "above zero"]),
        (&["--voxel", "1e-6"], &["voxel", "1000000000 voxels"]),
        (
            &["--factor", "0.9"],
            &["--factor has no effect", "cap", "shrink"],
        ),
        (
            &["--contacts", "shrink", "--factor", "1.5"],
            &["factor = 1.5", "0.5 to 1"],
        ),
        (
            &["--contacts", "shrink", "--gap", "1mm"],
            &["--gap", "gap or cap"],
        ),
        (
            &["--contacts", "gap", "--gap", "0"],
            &["gap = 0", "above zero"],
        ),
        (
            &["--contacts", "bridge", "--bridge", "1mm"],
            &["bridge = 0.001", "1.5 voxels"],
        ),
        (&["--contacts", "glue"], &["glue", "bridge"]),
        (&["--margin", "1"], &["--margin", "--region"]),
        (
            &["--no-surface", "--gap", "1mm"],
            &["--no-surface", "--gap"],
        ),
    ] {
        let mut command = femdem("pores");
        fails(command.arg(folder.path()).args(AROUND).args(options), words);
        assert!(!folder.path().join("pores").exists(), "{options:?}");
    }
    let mut command = femdem("pores");
    fails(
        command.arg(folder.path()).args(["--region", "1,2,3"]),
        &["X0,Y0,Z0"],
    );
    fails(
        femdem("pores").arg(folder.path().join("none")),
        &["bodies.csv"],
    );
}
