//! Internal forces of deformable bodies on one thread, per element: the batched neo-Hookean kernel, the
//! same law one element at a time, and the other elements. Bodies of 162 (in the nearest cache) and
//! 6,000 tetrahedra.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use femdem::mesh::{TetMesh, Vector3};
use femdem::solve::deformable::{DeformableModel, MaterialRegion, Workspace};
use femdem::solve::element::Element;
use femdem::solve::material::{
    AnyMaterial, Deformation, Material, NeoHookean, Response, Tangent, difference_tangent,
};
use std::sync::Arc;

/// The same law from outside the crate: it takes the path of any material.
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

fn element_forces(c: &mut Criterion) {
    let law = NeoHookean::new(1e6, 0.3).expect("the moduli are valid");
    let batched = AnyMaterial::from(law);
    let foreign = AnyMaterial::custom(Arc::new(Foreign(law)));
    let cases = [
        ("T4_batched", Element::T4, &batched),
        ("T4_one_by_one", Element::T4, &foreign),
        ("T4_nodal_pressure", Element::T4NodalPressure, &batched),
        ("T10", Element::T10, &batched),
        ("T10_Fbar", Element::T10Fbar, &batched),
    ];
    let mut group = c.benchmark_group("element_forces");
    for cells in [3, 10] {
        let size = Vector3::repeat(0.1 * f64::from(cells));
        let mesh = TetMesh::block([cells; 3], &size).expect("the block is valid");
        for (name, element, material) in cases {
            let region = MaterialRegion {
                material: material.clone(),
                density: 1000.0,
            };
            let model = DeformableModel::new(&mesh, element, vec![region], None);
            let model = model.expect("the model is valid");
            let stretched = |x: &Vector3| Vector3::new(1.05 * x.x + 0.02 * x.y, 0.97 * x.y, x.z);
            let x: Vec<Vector3> = model.nodes().iter().map(stretched).collect();
            let v = vec![Vector3::zeros(); x.len()];
            let (mut forces, mut work) = (v.clone(), Workspace::default());
            let count = mesh.tets().len();
            group.throughput(Throughput::Elements(count as u64));
            group.bench_function(BenchmarkId::new(name, count), |b| {
                b.iter(|| {
                    model
                        .internal_forces(&x, &v, &[], &mut [], &mut forces, &mut work)
                        .expect("no element is inverted")
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, element_forces);
criterion_main!(benches);
