//! Stresses inside the bodies of a rigid pack.

use crate::common::pack;
use femdem::resolve::{ResolveOptions, resolve};
use femdem::results;

/// Bodies come to rest without moving from their places, with the contact forces that they had, and their mean
/// stresses are those of the forces on them. This holds for convex bodies, also those that a lattice would not
/// leave convex, and for bodies that are not convex.
#[test]
fn a_pack_of_stone_keeps_its_forces_and_its_stresses_balance() {
    for (shape, count) in [("P5", 6), ("boulder", 3), ("cylinder", 2), ("dolos", 2)] {
        let packing = pack(shape, count);
        let rigid = packing.world();
        let options = ResolveOptions {
            mesh_size: 0.6,
            ..ResolveOptions::default()
        };
        let resolved = resolve(rigid, &options).unwrap();
        assert!(resolved.relaxed.residual <= options.relaxation.tolerance);
        let diameter = packing.spec().diameter();
        assert!(resolved.moves[1] < 5e-3 * diameter, "{shape}");
        for body in &resolved.bodies {
            let [nodes, _] = body.differences();
            assert!(nodes < 0.01, "{shape}: {nodes}");
        }
        let load = |forces: Vec<f64>| forces.iter().sum::<f64>();
        let before = load(rigid.contacts().iter().map(|c| c.normal_force).collect());
        let world = &resolved.simulation.world;
        let after = load(
            world
                .deformable_contacts()
                .map(|c| c.normal_force)
                .collect(),
        );
        assert!(
            (after / before - 1.0).abs() < 0.1,
            "{shape}: {before} {after}"
        );
    }
}

#[test]
fn the_files_of_a_resolved_pack() {
    let packing = pack("P5", 2);
    let options = ResolveOptions {
        mesh_size: 1.0,
        ..ResolveOptions::default()
    };
    let resolved = resolve(packing.world(), &options).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let drawing = results::snapshot(&packing).outline();
    assert!(drawing.is_some());
    let summary = resolved
        .write(folder.path(), &options, drawing.as_ref())
        .unwrap();
    assert_eq!(summary.bodies, 2);
    let text = std::fs::read_to_string(folder.path().join("resolve.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["bodies"], 2);
    assert!(json["relaxed"]["residual"].as_f64().unwrap() <= 1e-4);
    let csv = std::fs::read_to_string(folder.path().join("stress.csv")).unwrap();
    assert_eq!(csv.lines().count(), 3);
    for name in ["stress.vtu", "contacts.vtp", "stress.png"] {
        assert!(folder.path().join(name).metadata().unwrap().len() > 100);
    }
}

#[test]
fn materials_out_of_range_are_refused_by_name() {
    let packing = pack("P5", 1);
    let options = ResolveOptions {
        poisson: 0.5,
        ..ResolveOptions::default()
    };
    let error = resolve(packing.world(), &options).unwrap_err().to_string();
    assert!(error.contains("poisson = 0.5"), "{error}");
}
