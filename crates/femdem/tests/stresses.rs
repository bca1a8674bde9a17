//! Stresses inside the bodies of a rigid pack, body by body.

use crate::common::{TINY, code, fails, femdem, pack, run};
use femdem::analysis::{TableOptions, Tables};
use femdem::fem::element::Element;
use femdem::mesh::Matrix3;
use femdem::resolve::{ResolveOptions, resolve};
use femdem::results;
use femdem::stresses::{StressOptions, stresses};

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// The mean stress is that of the contacts, as the analysis of rigid packs has it, and about that of the bodies made
/// deformable together.
#[test]
fn mean_stresses_are_those_of_the_contacts_and_of_resolve() {
    let packing = pack("A10", 8);
    let snapshot = results::snapshot(&packing);
    let gravity = packing.world().parameters().gravity;
    let found = stresses(&snapshot, &[], Some(gravity), &StressOptions::default()).unwrap();
    let unknown = stresses(&snapshot, &[], None, &StressOptions::default()).unwrap();
    assert_eq!(
        unknown.summary(&StressOptions::default(), 0.0).net_force,
        None
    );
    let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
    let love_weber = tables.body_stresses.unwrap();
    for (body, other) in found.bodies.iter().zip(&love_weber.bodies) {
        let t = Matrix3::from_fn(|i, j| -other.stress.tensor[i][j]);
        let other = (t + t.transpose()) * 0.5;
        assert!((body.contacts_mean - other).norm() < 1e-9 * other.norm());
        assert!((body.elements - other).norm() < 0.02 * other.norm());
        assert!(body.residual < 1e-9 && body.net_force.unwrap() < 0.01);
    }
    let options = ResolveOptions {
        mesh_size: 0.5,
        ..ResolveOptions::default()
    };
    let resolved = resolve(packing.world(), &options).unwrap();
    let apart = found.bodies.iter().zip(&resolved.bodies);
    let apart = apart.map(|(a, b)| (a.elements - b.elements).norm() / b.elements.norm());
    let apart = median(apart.collect());
    assert!(apart < 0.1, "{apart}");
}

/// Bodies that are not convex keep the tetrahedra that they were packed with, and balls are meshed.
#[test]
fn bodies_of_other_kinds() {
    for (shape, count) in [("dolos", 2), ("sphere", 3)] {
        let packing = pack(shape, count);
        let shapes = packing.world().shapes().iter();
        let meshes: Vec<_> = shapes
            .map(|s| s.mesh.as_ref().map(|(mesh, _)| mesh.clone()))
            .collect();
        let options = StressOptions {
            element: Element::T4,
            ..StressOptions::default()
        };
        let found = stresses(&results::snapshot(&packing), &meshes, None, &options).unwrap();
        let apart = found
            .bodies
            .iter()
            .map(|b| (b.elements - b.contacts_mean).norm() / b.elements.norm());
        assert!(apart.fold(0.0, f64::max) < 0.1, "{shape}");
    }
}

#[test]
fn the_program_writes_the_same_bits_with_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("pack");
    assert_eq!(
        code(&run(femdem("pack").args(TINY).arg("--out").arg(&own))),
        0
    );
    let tables = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads);
        let mut command = femdem("stresses");
        command.arg(&own).args([
            "--strength",
            "100",
            "--mesh-size",
            "0.5",
            "--threads",
            threads,
        ]);
        let output = run(command.arg("--out").arg(&out));
        assert_eq!(code(&output), 0, "{output:?}");
        assert!(
            String::from_utf8(output.stdout)
                .unwrap()
                .contains("would crack")
        );
        for name in ["stress.vtu", "stress.png", "stresses.json"] {
            assert!(out.join(name).metadata().unwrap().len() > 100, "{name}");
        }
        std::fs::read_to_string(out.join("stress.csv")).unwrap()
    });
    assert_eq!(tables[0], tables[1]);
    let mut rows = tables[0].lines();
    let columns: Vec<&str> = rows.next().unwrap().split(',').collect();
    let at = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let ratio = cells[at("strength_ratio")];
        if cells[at("tension_pa")].is_empty() {
            assert_eq!([ratio, cells[at("cracks")]], ["", ""]);
        } else {
            let cracks = ratio.parse::<f64>().unwrap() > 1.0;
            assert_eq!(cells[at("cracks")], if cracks { "1" } else { "0" });
        }
        count += 1;
    }
    assert_eq!(count, 8);
    let mut refused = femdem("stresses");
    refused
        .arg(&own)
        .args(["--strength", "-1", "--out"])
        .arg(folder.path().join("no"));
    fails(&mut refused, &["strength", "above 0"]);
}

#[test]
fn packs_without_forces_are_refused() {
    let mut snapshot = results::snapshot(&pack("P5", 2));
    snapshot.gaps.forces = true;
    let error = stresses(&snapshot, &[], None, &StressOptions::default()).unwrap_err();
    assert!(
        error.to_string().contains("add a contacts.csv with forces"),
        "{error}"
    );
}

/// Forces that are no contacts, and bodies with stresses of their own, would be left out in silence.
#[test]
fn runs_with_loads_or_deformable_bodies_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let brick =
        "[[body]]\nshape = \"box\"\nsize = 0.04\nmaterial = \"m\"\nposition = [0, 0, 0.5]\n";
    let cases = [
        (format!("{brick}[[load]]\nforce = [1, 0, 0]\n"), "[[load]]"),
        (
            format!("{brick}behaviour = \"deformable\"\nmesh-size = 1\n"),
            "stresses of their own",
        ),
    ];
    for (k, (text, words)) in cases.into_iter().enumerate() {
        let (scene, out) = (
            folder.path().join(format!("{k}.toml")),
            folder.path().join(k.to_string()),
        );
        let material =
            "[material.m]\ndensity = 1000\nlaw = \"neo-hookean\"\nyoung = 1e6\npoisson = 0.3\n";
        std::fs::write(&scene, format!("duration = 1e-4\n{material}{text}")).unwrap();
        let done = run(femdem("run").arg(&scene).arg("--out").arg(&out));
        assert_eq!(code(&done), 0, "{done:?}");
        fails(femdem("stresses").arg(&out), &[words]);
    }
}
