//! The faster paths against the plain one: batches of tetrahedra, many threads.

use super::*;

/// A law of this crate wrapped as a custom one: it takes the path of any material.
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
        self.0.tangent(d, old)
    }
    fn wave_modulus(&self) -> f64 {
        self.0.wave_modulus()
    }
    fn stiffness_bound(&self, d: &Deformation, old: &[f64]) -> f64 {
        self.0.stiffness_bound(d, old)
    }
}

fn block() -> TetMesh {
    TetMesh::block([9, 7, 5], &Vector3::new(0.9, 0.7, 0.5)).unwrap()
}

/// Blocks of eight give the forces of one at a time to rounding, including two materials and a last block
/// that is not full, at small and at large strain.
#[test]
fn batches_are_the_plain_kernel() {
    for mesh in [block(), crooked()] {
        let laws = [
            NeoHookean::new(1e6, 0.3).unwrap(),
            NeoHookean::new(3e5, 0.45).unwrap(),
        ];
        let half = mesh.tets().len() / 2 + 1;
        let of: Vec<u32> = (0..mesh.tets().len())
            .map(|e| u32::from(e >= half))
            .collect();
        let make = |batched: bool| {
            let regions = laws.map(|law| MaterialRegion {
                material: if batched {
                    law.into()
                } else {
                    AnyMaterial::custom(Arc::new(Foreign(law)))
                },
                density: 1000.0,
            });
            DeformableModel::new(&mesh, Element::T4, regions.to_vec(), Some(of.clone())).unwrap()
        };
        let (batched, plain) = (make(true), make(false));
        for (map, wobble) in [(turned() * strained(), 0.01), (Matrix3::identity(), 1e-7)] {
            let x = placed(&batched, &map, wobble);
            let (fast, slow) = (forces(&batched, &x), forces(&plain, &x));
            let stiffness = 1e6 * 0.1;
            assert!(
                (fast.0.energy - slow.0.energy).abs() < 1e-12 * slow.0.energy + 1e-13 * stiffness
            );
            for (a, b) in fast.1.iter().zip(&slow.1) {
                assert!((a - b).norm() < 1e-12 * largest(&slow.1) + 1e-15 * stiffness);
            }
        }
    }
}

/// Only the last element is inverted: the batch names it, not its block.
#[test]
fn a_batch_names_the_element() {
    let mesh = block();
    let model = model(&mesh, Element::T4, neo_hookean(1e6, 0.3));
    let last = mesh.tets().len() - 1;
    let mut x = model.nodes().to_vec();
    // Only its elements contain the corner node; it is moved through the body.
    let corner = mesh.tets()[last].iter().copied().max().unwrap() as usize;
    x[corner] = Vector3::new(0.1, 0.1, 0.1);
    let v = vec![Vector3::zeros(); x.len()];
    let mut f = v.clone();
    let failure = model
        .internal_forces(&x, &v, &[], &mut [], &mut f, &mut Workspace::default())
        .unwrap_err();
    let named = mesh.tets()[failure.element().unwrap()];
    assert!(named.contains(&(corner as u32)));
    assert!(failure.volume_ratio().unwrap() <= 0.0);
}

/// One thread, two, four, and the serial function: the same bits, histories included.
#[cfg(feature = "parallel")]
#[test]
fn any_number_of_threads_gives_the_same_forces() {
    use femdem_fem::material::J2;
    let metal: AnyMaterial = J2::new(1e6, 0.3, 1e4, 1e5).unwrap().into();
    for element in ELEMENTS {
        for law in [neo_hookean(1e6, 0.3), split(4e5, 2e6, 100.0), metal.clone()] {
            let model = model(&block(), element, law);
            let x = placed(&model, &strained(), 0.005);
            let v = placed(&model, &turned(), 0.1);
            let old = vec![0.0; model.history_len()];
            let run = |parallel: bool| {
                let mut new = old.clone();
                let mut f = vec![Vector3::zeros(); x.len()];
                let mut work = Workspace::default();
                let state = if parallel {
                    model.internal_forces_parallel(&x, &v, &old, &mut new, &mut f, &mut work)
                } else {
                    model.internal_forces(&x, &v, &old, &mut new, &mut f, &mut work)
                };
                (state.unwrap(), new, f)
            };
            let serial = run(false);
            for threads in [1, 2, 4] {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                assert!(
                    serial == pool.install(|| run(true)),
                    "{element:?}, {threads} threads"
                );
            }
        }
    }
}
