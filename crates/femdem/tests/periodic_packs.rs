//! Packs without side walls: made, measured, shown, and gone on with.

use std::fs;

use crate::common::{code, fails, femdem, run, stdout, summary};
use serde_json::Value;
use tempfile::tempdir;

#[test]
fn a_bed_without_sides_is_a_piece_of_an_endless_one() {
    let folder = tempdir().unwrap();
    let out = folder.path().join("pack");
    let options = "--shape P5 --count 40 --container periodic --box 3x3 --protocol release \
                   --penetration 0.005 --friction 0.4 --seed 2 --threads 2 --quiet --report";
    let result = run(femdem("pack")
        .args(options.split_whitespace())
        .arg("--out")
        .arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let pack = summary(&out);
    assert_eq!(pack["container"]["kind"], "periodic");
    assert_eq!(pack["settled"], true);
    assert!(out.join("report.html").is_file() && out.join("pack.png").is_file());
    let width = pack["container"]["width"].as_f64().unwrap();
    assert!((width - 0.15).abs() < 1e-12, "{width}");

    let result = run(femdem("analyse").arg(&out));
    assert_eq!(code(&result), 0, "{result:?}");
    let text = fs::read_to_string(out.join("analysis.json")).unwrap();
    let analysis: Value = serde_json::from_str(&text).unwrap();
    // All of the cross-section is core, and all of the weight is on the floor.
    let core = &analysis["core"]["region"];
    let across = |k: usize| core["max"][k].as_f64().unwrap() - core["min"][k].as_f64().unwrap();
    assert!(
        (across(0) - width).abs() < 1e-9 && (across(1) - width).abs() < 1e-9,
        "{core}"
    );
    let said = stdout(&result);
    assert!(said.contains("vertical balance     holds"), "{said}");
    let missing = analysis["missing"].to_string();
    assert!(missing.contains("no side walls"), "{missing}");

    // Its void is that of the endless bed.
    let mut command = femdem("pores");
    let result = run(command
        .arg(&out)
        .args(["--voxel", "0.06", "--contacts", "bridge"]));
    assert_eq!(code(&result), 0, "{result:?}");
    let text = fs::read_to_string(out.join("pores/pores.json")).unwrap();
    let pores: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(pores["periodic"], serde_json::json!([true, true, false]));
    assert_eq!(
        (&pores["sides"], &pores["bodies"]),
        (&"periodic".into(), &40.into())
    );
    let [image, exact] = ["/porosity/image", "/porosity/exact"]
        .map(|key| pores.pointer(key).unwrap().as_f64().unwrap());
    let bed = analysis
        .pointer("/bed/void_fraction")
        .unwrap()
        .as_f64()
        .unwrap();
    // The cubes of the lowest layer lie flat: their upper faces are up to half a voxel off, all alike. That is 0.0015 m of a bed some
    // 0.08 m high, over the 0.6 of its floor that they cover. For 0.002 voxels would have to be six times as fine.
    assert!(
        (image - exact).abs() < 0.012 && (exact - bed).abs() < 1e-3,
        "{image} {exact} {bed}"
    );
    let surface = &pores["surface"];
    assert_eq!(surface["checks"][0]["closed"], true, "{surface}");
    let flow = out.join("pores/flow/constant/triSurface");
    let size = |name: &str| fs::metadata(flow.join(name)).unwrap().len();
    assert_eq!(size("x_low.stl"), size("x_high.stl"));
    assert_eq!(size("y_low.stl"), size("y_high.stl"));
    assert!(size("inlet.stl") > 84 && !flow.join("sides.stl").exists());
    fails(
        femdem("pores").arg(&out).args(["--sides", "wall"]),
        &["--sides has no effect", "x and y"],
    );

    // It stays at rest in a run, whose end is measured alike.
    let scene = folder.path().join("scene.toml");
    let text = format!("from = \"{}\"\nduration = 0.01\n", out.display());
    fs::write(&scene, text).unwrap();
    let on = folder.path().join("run");
    let result = run(femdem("run").arg(&scene).arg("--out").arg(&on));
    assert_eq!(code(&result), 0, "{result:?}");
    assert!(code(&run(femdem("analyse").arg(&on))) == 0);
    let text = fs::read_to_string(on.join("analysis.json")).unwrap();
    let later: Value = serde_json::from_str(&text).unwrap();
    for key in [
        "/density/exact",
        "/bed/void_fraction",
        "/mean_coordination/mean",
    ] {
        let [a, b] = [&analysis, &later].map(|of| of.pointer(key).and_then(Value::as_f64).unwrap());
        assert!((a - b).abs() < 2e-3 * a.abs(), "{key}: {a} {b}");
    }
}
