//! Deformable bodies: against mechanics, against Rust, and what is refused.

use std::ptr::{null, null_mut};

use femdem_capi::*;
use femdem_solve::fem::element::Element;
use femdem_solve::fem::material::NeoHookean;
use femdem_solve::fem::{DeformableModel, MaterialRegion};
use femdem_solve::mesh::{Pose, TetMesh, Vector3};
use femdem_solve::{ContactStiffness, DeformableSpec, World, WorldParameters};

use crate::common::{all, at, fails, got, named, ok, resting, world};

/// A bar from the origin, 0.1 m by 0.1 m, of this length along z, m.
fn bar(length: f64) -> TetMesh {
    TetMesh::block([2, 2, 5], &Vector3::new(0.1, 0.1, length)).unwrap()
}

fn rubber() -> FemdemMatter {
    FemdemMatter {
        density: 1000.0,
        young: 1e6,
        poisson: 0.3,
        ..got(|to| femdem_matter_default(to))
    }
}

pub fn add_mesh(world: FemdemWorld, mesh: &TetMesh, matter: &FemdemMatter) -> u32 {
    let points: Vec<f64> = mesh.points().iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let tets = mesh.tets().as_flattened();
    // SAFETY: both lists are as long as said.
    got(|to| unsafe {
        femdem_world_add_model(
            world,
            points.as_ptr(),
            points.len() / 3,
            tets.as_ptr(),
            tets.len() / 4,
            Some(matter),
            to,
        )
    })
}

pub fn add(world: FemdemWorld, model: u32, place: FemdemPose) -> u32 {
    let motion = resting(place);
    got(|to| femdem_world_add_deformable(world, model, Some(&motion), None, 0, to))
}

pub fn state(world: FemdemWorld, body: u32) -> FemdemDeformable {
    got(|to| femdem_world_deformable(world, body, to))
}

pub fn positions(world: FemdemWorld, body: u32) -> Vec<[f64; 3]> {
    let mut rows = vec![[0.0; 3]; state(world, body).node_count];
    let to = rows.as_mut_ptr().cast();
    // SAFETY: there is room for as many rows as said.
    ok(unsafe { femdem_world_node_positions(world, body, to, rows.len()) });
    rows
}

fn stresses(world: FemdemWorld, body: u32) -> Vec<[f64; 6]> {
    let mut rows = vec![[0.0; 6]; state(world, body).tet_count];
    let to = rows.as_mut_ptr().cast();
    // SAFETY: there is room for as many rows as said.
    ok(unsafe { femdem_world_stresses(world, body, to, rows.len()) });
    rows
}

pub fn drive(kind: i32, vector: [f64; 3]) -> FemdemDrive {
    FemdemDrive {
        kind,
        periods: 0,
        vector,
        point: [0.0; 3],
        rate: 0.0,
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    }
}

pub fn drive_nodes(world: FemdemWorld, body: u32, nodes: &[u32], axes: u32, drive: FemdemDrive) {
    let (start, count) = (nodes.as_ptr(), nodes.len());
    // SAFETY: the list is as long as said.
    ok(unsafe { femdem_world_drive_nodes(world, body, start, count, axes, Some(&drive)) });
}

const ALL: u32 = FEMDEM_AXIS_X | FEMDEM_AXIS_Y | FEMDEM_AXIS_Z;

#[test]
fn a_bar_hangs_by_its_weight() {
    let (world, length) = (world(), 0.2);
    let mesh = bar(length);
    let matter = FemdemMatter {
        shear_viscosity: 300.0,
        ..rubber()
    };
    let model = add_mesh(world, &mesh, &matter);
    let body = add(world, model, at(1.0, 2.0, 3.0));
    let top = |p: &[f64; 3]| p[2] > 3.0 + length - 1e-9;
    let nodes = positions(world, body);
    assert_eq!(nodes[0], [1.0, 2.0, 3.0], "its first nodes are the points");
    let held: Vec<u32> = (0..)
        .zip(&nodes)
        .filter(|(_, p)| top(p))
        .map(|(i, _)| i)
        .collect();
    drive_nodes(world, body, &held, ALL, drive(FEMDEM_DRIVE_FIXED, [0.0; 3]));
    ok(femdem_world_step_until(world, 0.25));
    let now = state(world, body);
    assert!((now.mass / (1000.0 * 0.1 * 0.1 * length) - 1.0).abs() < 1e-12);
    assert!(now.kinetic_energy < 1e-4 * now.strain_energy && now.strain_energy > 0.0);
    // The mean of rho g (distance from the lower end).
    let all = stresses(world, body);
    let mean = all.iter().map(|s| s[2]).sum::<f64>() / all.len() as f64;
    let wanted = 1000.0 * 9.81 * length / 2.0;
    assert!((mean / wanted - 1.0).abs() < 0.02, "{mean} {wanted}");
    let ledger = got(|to| femdem_world_ledger(world, to));
    assert!((ledger.strain / now.strain_energy - 1.0).abs() < 1e-12);
    assert!(ledger.dissipated_viscous > 0.0 && ledger.error_relative.abs() < 0.01);

    // Let go, it falls.
    ok(femdem_world_release(world, body));
    let (began, low) = (
        got(|to| femdem_world_state(world, to)).time,
        now.centroid[2],
    );
    ok(femdem_world_step_until(world, began + 0.1));
    let fallen = got(|to| femdem_world_state(world, to)).time - began;
    let wanted = low - 0.5 * 9.81 * fallen * fallen;
    assert!((state(world, body).centroid[2] - wanted).abs() < 1e-4);
    ok(femdem_world_free(world));
}

#[test]
fn a_block_that_falls_on_a_rigid_body_has_the_bits_of_rust() {
    let mesh = bar(0.1);
    let c = world();
    let cube = named("cube", 0.2);
    let motion = resting(at(0.05, 0.05, -0.06));
    got(|to| femdem_world_add_body(c, cube, 2000.0, Some(&motion), 0, to));
    let model = add_mesh(c, &mesh, &rubber());
    let body = add(c, model, at(0.0, 0.0, 0.01));
    ok(femdem_world_set_threads(c, 2));

    let mut rust = World::new(WorldParameters::default()).unwrap();
    let surface = "cube".parse::<femdem_solve::mesh::shapes::Shape>().unwrap();
    let shape = rust
        .add_shape("cube", &surface.polyhedron(0.2).unwrap())
        .unwrap();
    let place = Pose::translation(0.05, 0.05, -0.06);
    let spec = femdem_solve::BodySpec::at_rest(shape, 2000.0, place);
    rust.add_body(spec).unwrap();
    let region = MaterialRegion {
        material: NeoHookean::new(1e6, 0.3).unwrap().into(),
        density: 1000.0,
    };
    let own = DeformableModel::new(&mesh, Element::T4, vec![region], None).unwrap();
    let own = rust
        .add_model("block", own, ContactStiffness::Ratio(1.0))
        .unwrap();
    let place = Pose::translation(0.0, 0.0, 0.01);
    let same = rust
        .add_deformable(DeformableSpec::at_rest(own, place))
        .unwrap();

    for _ in 0..400 {
        rust.step().unwrap();
    }
    ok(femdem_world_step(c, 400));
    let soft = rust.deformable(same).unwrap();
    let wanted: Vec<[f64; 3]> = soft.positions().iter().map(|x| (*x).into()).collect();
    assert_eq!(positions(c, body), wanted);
    let first = soft.stresses().unwrap()[0].cauchy;
    assert_eq!(stresses(c, body)[0][..3], [first.m11, first.m22, first.m33]);
    // SAFETY: lists and rooms of `all` fit.
    let ids = all(0, |to, room, count| unsafe {
        femdem_world_deformables(c, to, room, count)
    });
    let counted = got(|to| femdem_world_state(c, to));
    assert_eq!((ids, counted.deformable_count), (vec![body], 1));
    assert_eq!(counted.body_count, 1);
    // SAFETY: lists and rooms of `all` fit.
    let bytes = all(0_u8, |to, room, count| unsafe {
        femdem_world_to_bytes(c, to, room, count)
    });
    // SAFETY: the bytes live longer.
    let again = got(|to| unsafe { femdem_world_from_bytes(bytes.as_ptr(), bytes.len(), to) });
    let hashes = [c, again].map(|world| {
        ok(femdem_world_step(world, 50));
        got(|to| femdem_world_hash(world, to))
    });
    assert_eq!(hashes[0], hashes[1]);
    ok(femdem_world_free(again));
    ok(femdem_world_free(c));
}

#[test]
fn a_shape_is_filled_with_tetrahedra_about_its_centroid() {
    let world = world();
    let shape = named("dolos", 0.3);
    let matter = FemdemMatter {
        element: FEMDEM_ELEMENT_T10,
        ..rubber()
    };
    let model = got(|to| femdem_world_add_model_of_shape(world, shape, 0.3, Some(&matter), to));
    let body = add(world, model, at(0.0, 0.0, 1.0));
    let properties = got(|to| femdem_shape_properties(shape, to));
    let now = state(world, body);
    // Though tetrahedra cut off what is convex.
    assert!((now.mass / (1000.0 * properties.volume) - 1.0).abs() < 1e-9);
    assert!((now.centroid[2] - 1.0).abs() < 1e-3);
    let (mut tets, mut skin) = (vec![0; 4 * now.tet_count], vec![0; 3 * now.triangle_count]);
    // SAFETY: there is room for as many rows as said.
    ok(unsafe { femdem_world_tets(world, body, tets.as_mut_ptr(), now.tet_count) });
    // SAFETY: there is room for as many rows as said.
    ok(unsafe { femdem_world_skin(world, body, skin.as_mut_ptr(), now.triangle_count) });
    // Corners come before the nodes in the middle of edges.
    let corners = tets.iter().copied().max().unwrap() as usize + 1;
    assert!(corners < now.node_count && skin.iter().all(|node| tets.contains(node)));
    ok(femdem_world_free(world));
}

#[test]
fn misuse_is_named() {
    use FemdemStatus::{Null, Refused, Size};
    let world = world();
    let good = rubber();
    let model = add_mesh(world, &bar(0.1), &good);
    let motion = resting(at(0.0, 0.0, 0.0));
    let body = add(world, model, motion.pose);
    let cube = named("cube", 0.1);
    let far = resting(at(5.0, 0.0, 0.0));
    let rigid = got(|to| femdem_world_add_body(world, cube, 1e3, Some(&far), 0, to));
    let hash = || got(|to| femdem_world_hash(world, to));
    let before = hash();

    let mut to = std::mem::MaybeUninit::uninit();
    let mut make = |change: &dyn Fn(&mut FemdemMatter)| {
        let mut matter = good;
        change(&mut matter);
        femdem_world_add_model_of_shape(world, cube, 0.5, Some(&matter), Some(&mut to))
    };
    fails(make(&|m| m.density = -1.0), Refused, "density = -1");
    fails(make(&|m| m.young = f64::NAN), Refused, "young = NaN");
    fails(make(&|m| m.poisson = 0.5), Refused, "poisson = 0.5");
    fails(make(&|m| m.law = 9), Refused, "law = 9");
    fails(make(&|m| m.element = -1), Refused, "element = -1");
    fails(
        make(&|m| m.contact_ratio = 0.0),
        Refused,
        "contact stiffness = 0",
    );
    let yields = |m: &mut FemdemMatter| (m.law, m.yield_stress) = (FEMDEM_MATTER_J2, -5.0);
    fails(make(&yields), Refused, "-5");
    let no_matter = femdem_world_add_model_of_shape(world, cube, 0.5, None, Some(&mut to));
    fails(no_matter, Null, "matter");
    let huge = femdem_world_add_model_of_shape(world, cube, 2.0, Some(&good), Some(&mut to));
    fails(huge, Refused, "mesh_size = 2");

    let points = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0_f64,
    ];
    let mut mesh = |tets: &[u32; 4], points: *const f64| {
        // SAFETY: the lists are as long as said, or null.
        unsafe {
            femdem_world_add_model(
                world,
                points,
                4,
                tets.as_ptr(),
                1,
                Some(&good),
                Some(&mut to),
            )
        }
    };
    fails(mesh(&[0, 1, 2, 3], null()), Null, "points");
    fails(mesh(&[0, 1, 2, 7], points.as_ptr()), Refused, "7");
    fails(mesh(&[0, 2, 1, 3], points.as_ptr()), Refused, "volume");

    let mut add = |model, motion: Option<&FemdemMotion>, fracture: Option<&FemdemFracture>| {
        femdem_world_add_deformable(world, model, motion, fracture, 0, Some(&mut to))
    };
    fails(add(model + 1, Some(&motion), None), Refused, "no model");
    fails(add(model, None, None), Null, "motion");
    let brittle = got(|to| femdem_fracture_default(to));
    let soft = FemdemFracture {
        tensile: 1e9,
        cohesion: 1e10,
        ..brittle
    };
    fails(add(model, Some(&motion), Some(&soft)), Refused, "elements");
    let wrong = FemdemFracture {
        softening: 7,
        ..brittle
    };
    fails(
        add(model, Some(&motion), Some(&wrong)),
        Refused,
        "softening = 7",
    );
    let wrong = FemdemFracture {
        weibull_modulus: 0.5,
        ..brittle
    };
    fails(
        add(model, Some(&motion), Some(&wrong)),
        Refused,
        "Weibull modulus = 0.5",
    );

    let still = drive(FEMDEM_DRIVE_FIXED, [0.0; 3]);
    let drive = |body, node: u32, axes| {
        // SAFETY: the list is as long as said.
        unsafe { femdem_world_drive_nodes(world, body, &raw const node, 1, axes, Some(&still)) }
    };
    fails(drive(rigid, 0, ALL), Refused, "no deformable body");
    fails(drive(body, 9999, ALL), Refused, "9999");
    fails(drive(body, 0, 0), Refused, "axes = 0");
    fails(drive(body, 0, 8), Refused, "axes = 8");
    fails(
        femdem_world_release(world, rigid),
        Refused,
        "no deformable body",
    );

    let mut rows = [0.0; 9];
    // SAFETY: there is room for as many rows as said.
    let short = unsafe { femdem_world_node_positions(world, body, rows.as_mut_ptr(), 3) };
    fails(short, Size, "positions has 3");
    let nodes = state(world, body).node_count;
    // SAFETY: null is refused.
    let none = unsafe { femdem_world_node_velocities(world, body, null_mut(), nodes) };
    fails(none, Null, "velocities");
    // SAFETY: none is asked for.
    let whole =
        got_status(|count| unsafe { femdem_world_cracks(world, body, null_mut(), 0, count) });
    fails(whole, Refused, "may break");
    assert_eq!(hash(), before);
    ok(femdem_world_free(world));
}

/// The status of a function that writes a count.
fn got_status(
    ask: impl FnOnce(Option<&mut std::mem::MaybeUninit<usize>>) -> FemdemStatus,
) -> FemdemStatus {
    ask(Some(&mut std::mem::MaybeUninit::uninit()))
}
