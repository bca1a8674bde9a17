//! Time per tetrahedron and step on one thread, the fastest of many rounds: forces of the elements alone, with
//! the energy, with the bound of the step, and whole steps of a world of bodies that touch nothing. A name as
//! argument runs that row alone.

use femdem::fem::element::Element;
use femdem::fem::material::{
    AnyMaterial, Deformation, Material, NeoHookean, Response, Tangent, difference_tangent,
};
use femdem::fem::{DeformableModel, MaterialRegion, Workspace};
use femdem::mesh::{Pose, TetMesh, Vector3};
use femdem::solve::{ContactStiffness, DeformableSpec, World, WorldParameters};
use std::sync::Arc;
use std::time::Instant;

/// The same law defined outside the crate, so that it takes the general path of any material.
#[derive(Debug)]
struct Foreign(NeoHookean);

impl Material for Foreign {
    fn name(&self) -> &str {
        "foreign"
    }
    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        self.0.respond(d, old, new)
    }
    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        difference_tangent(self, d, old)
    }
    fn wave_modulus(&self) -> f64 {
        self.0.wave_modulus()
    }
    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        self.0.stiffness_bound(d, old)
    }
}

/// Repeats `work` on `count` tetrahedra for about a second and prints the fastest round.
fn time(name: &str, count: usize, mut work: impl FnMut()) {
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    if only.is_some_and(|only| only != name) {
        return;
    }
    let (start, mut best) = (Instant::now(), f64::INFINITY);
    while start.elapsed().as_secs_f64() < 1.0 {
        let round = Instant::now();
        work();
        best = best.min(round.elapsed().as_secs_f64());
    }
    println!(
        "{name:24} {count:6} tetrahedra {:8.2} ns each",
        best * 1e9 / count as f64
    );
}

fn model(cells: u32, element: Element, material: &AnyMaterial) -> DeformableModel {
    let mesh = TetMesh::block([cells; 3], &Vector3::repeat(0.1 * f64::from(cells)));
    let region = MaterialRegion {
        material: material.clone(),
        density: 1000.0,
    };
    DeformableModel::new(
        &mesh.expect("the block is valid"),
        element,
        vec![region],
        None,
    )
    .expect("the model is valid")
}

fn elements(name: &str, cells: u32, element: Element, material: &AnyMaterial) {
    let model = model(cells, element, material);
    let stretched = |x: &Vector3| Vector3::new(1.05 * x.x + 0.02 * x.y, 0.97 * x.y, x.z);
    let x: Vec<Vector3> = model.nodes().iter().map(stretched).collect();
    let v = vec![Vector3::zeros(); x.len()];
    let (mut forces, mut work) = (v.clone(), Workspace::default());
    let count = model.mesh().tets().len();
    time(name, count, || {
        model
            .forces_without_energy(&x, &v, &[], &mut [], &mut forces, &mut work)
            .expect("no element is inverted");
    });
    time(&format!("{name}_energy"), count, || {
        model
            .internal_forces(&x, &v, &[], &mut [], &mut forces, &mut work)
            .expect("no element is inverted");
    });
    time(&format!("{name}_bound"), count, || {
        model
            .stable_frequency2(&x, &[])
            .expect("no element is inverted");
    });
}

/// Bodies beside each other that spin, so that they are strained, and do not touch.
fn world(cells: u32, bodies: usize, material: &AnyMaterial) {
    let mut world = World::new(WorldParameters::default()).expect("the parameters are valid");
    let model = model(cells, Element::T4, material);
    let count = model.mesh().tets().len() * bodies;
    let model = world
        .add_model("block", model, ContactStiffness::default())
        .expect("the model is valid");
    for k in 0..bodies {
        let place = Pose::translation(k as f64 * 0.3 * f64::from(cells), 0.0, 0.0);
        let mut spec = DeformableSpec::at_rest(model, place);
        spec.angular_velocity = Vector3::new(1.0, 2.0, 3.0);
        world.add_deformable(spec).expect("the body is valid");
    }
    // Ten steps a round: the bound of the elements is renewed in one of them.
    time("world_ten_steps", 10 * count, || {
        for _ in 0..10 {
            world.step().expect("nothing is inverted");
        }
    });
}

fn main() {
    let law = NeoHookean::new(1e6, 0.3).expect("the moduli are valid");
    let batched = AnyMaterial::from(law);
    let foreign = AnyMaterial::custom(Arc::new(Foreign(law)));
    for cells in [3, 10] {
        elements("T4_batched", cells, Element::T4, &batched);
        elements("T4_one_by_one", cells, Element::T4, &foreign);
        elements(
            "T4_nodal_pressure",
            cells,
            Element::T4NodalPressure,
            &batched,
        );
        elements("T10", cells, Element::T10, &batched);
        elements("T10_Fbar", cells, Element::T10Fbar, &batched);
    }
    world(3, 32, &batched);
}
