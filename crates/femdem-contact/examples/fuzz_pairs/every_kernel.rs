//! One pair through every kernel.

use femdem_contact::general::GeneralScratch;
use femdem_contact::kernel::{CavityKernel, PairCache, Scratch};
use femdem_contact::strategies::TestPair;
use femdem_contact::{ContactError, Frame, GeneralKernel, Overlap, PairKernel, SolidWall, Wall};
use femdem_mesh::{Point3, TetMesh, Vector3};

/// The penalty of all kernels, Pa.
const PENALTY: f64 = 1e6;

/// The kernels by name. The first three and the last but one of them are for convex bodies only.
pub const KERNELS: [&str; 7] = [
    "convex",
    "convex, cached",
    "general",
    "general, cached",
    "wall of planes",
    "wall of a mesh",
    "body as a wall",
];

/// All kernels with their buffers.
pub struct Kernels {
    pair: PairKernel,
    cavity: CavityKernel,
    meshes: GeneralKernel,
    plane: Wall,
    scratch: Scratch,
    general: GeneralScratch,
}

/// The results of the kernels for a pair.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Verdict {
    /// Whether each of [`KERNELS`] was evaluated, and whether it found a contact.
    pub asked: [bool; KERNELS.len()],
    pub touching: [bool; KERNELS.len()],
    /// What is wrong with a result, by kernel.
    pub faults: Vec<(usize, String)>,
    /// Difference of the energies of the convex and the general kernel over p r^3, r the radius
    /// of the smaller body.
    pub energy_difference: f64,
}

impl Verdict {
    fn add<'o>(
        &mut self,
        kernel: usize,
        size: f64,
        overlaps: impl IntoIterator<Item = &'o Overlap>,
    ) -> f64 {
        self.asked[kernel] = true;
        let mut energy = 0.0;
        for overlap in overlaps {
            self.touching[kernel] = true;
            energy += overlap.energy;
            if let Some(fault) = fault(overlap, size) {
                self.faults.push((kernel, fault));
            }
        }
        energy
    }
}

/// A number counts as negative if it is below minus this fraction of that of a deep overlap.
const ROUND_OFF: f64 = 1e-9;

/// What is wrong with an overlap of a body of radius `size`, if anything.
fn fault(overlap: &Overlap, size: f64) -> Option<String> {
    let Overlap {
        force,
        moment,
        arm_a,
        arm_b,
        normal,
        energy,
        volume,
        area,
        foundation,
        torsion_radius,
    } = overlap;
    let (centre, axis) = (&foundation.centre, &foundation.axis);
    let vectors = [force, moment, arm_a, arm_b, normal, centre, axis];
    let polar = foundation.polar();
    let scalars = [
        energy,
        volume,
        area,
        &foundation.stiffness,
        &polar,
        torsion_radius,
    ];
    let mut all = vectors.into_iter().flatten().chain(scalars);
    if !all.all(|x| x.is_finite()) {
        return Some(format!("not finite: {overlap:?}"));
    }
    let stiffness_scale = PENALTY * size;
    let scales = [
        stiffness_scale * size * size,
        size.powi(3),
        size.powi(2),
        stiffness_scale,
        stiffness_scale * size * size,
        size,
    ];
    let mut parts = scalars.into_iter().zip(scales);
    if parts.any(|(x, scale)| *x < -ROUND_OFF * scale) {
        return Some(format!("negative: {overlap:?}"));
    }
    let unit = (normal.norm() - 1.0).abs() < 1e-6;
    (!unit).then(|| format!("the normal is not a unit vector: {overlap:?}"))
}

/// A tetrahedron below z = 0 that is wide and deep enough for a body of the given radius.
fn slab(radius: f64) -> Result<SolidWall, ContactError> {
    let size = 8.0 * radius;
    let points = [
        [size, 0.0, 0.0],
        [-size, size, 0.0],
        [-size, -size, 0.0],
        [0.0, 0.0, -size],
    ];
    let points = points.map(Point3::from).to_vec();
    let mesh = TetMesh::new(points, vec![[0, 2, 1, 3]])?;
    Ok(SolidWall::solid(&mesh))
}

impl Kernels {
    pub fn new() -> Result<Self, ContactError> {
        Ok(Self {
            pair: PairKernel::new(PENALTY)?,
            cavity: CavityKernel::new(PENALTY)?,
            meshes: GeneralKernel::new(PENALTY)?,
            plane: Wall::half_space("floor", Vector3::z(), 0.0)?,
            scratch: Scratch::default(),
            general: GeneralScratch::default(),
        })
    }

    /// Evaluates a pair with every kernel and checks the results.
    ///
    /// # Errors
    /// If the wall beside the pair cannot be built.
    pub fn check(&mut self, pair: &TestPair) -> Result<Verdict, ContactError> {
        let mut verdict = Verdict::default();
        let (energy, force) = self.check_general(pair, &mut verdict);
        if let Some((convex, convex_force)) = self.check_convex(pair, &mut verdict) {
            let scale = PENALTY * size(pair).powi(3);
            // Where the force is zero there is no normal and a kernel may return no contact: two bodies, each
            // symmetric about the same centre.
            let none = !verdict.touching[0] || !verdict.touching[2];
            let largest = force.norm().max(convex_force.norm());
            if !(none && largest * size(pair) < ROUND_OFF * scale) {
                verdict.energy_difference = (convex - energy).abs() / scale;
            }
        }
        let scratch = &mut self.general;
        let slab = slab(pair.a.radius())?;
        let patches = self.meshes.evaluate_wall(
            &slab,
            &pair.frame_wall,
            &pair.a.field,
            &pair.frame_a,
            scratch,
        );
        verdict.add(5, size(pair), patches.iter().map(|p| &p.overlap));
        let wall = SolidWall::solid(&pair.b.mesh);
        let patches =
            self.meshes
                .evaluate_wall(&wall, &pair.frame_b, &pair.a.field, &pair.frame_a, scratch);
        verdict.add(6, size(pair), patches.iter().map(|p| &p.overlap));
        Ok(verdict)
    }

    /// The kernels of convex bodies; energy and force, if both are.
    fn check_convex(&mut self, pair: &TestPair, verdict: &mut Verdict) -> Option<(f64, Vector3)> {
        let a = pair.a.convex.as_deref()?;
        let scratch = &mut self.scratch;
        let floor = self
            .cavity
            .evaluate(&self.plane, &pair.frame_wall, a, &pair.frame_a, scratch);
        verdict.add(4, size(pair), &floor);
        let b = pair.b.convex.as_deref()?;
        let cold = self
            .pair
            .evaluate(a, &pair.frame_a, b, &pair.frame_b, scratch);
        let force = cold.iter().map(|overlap| overlap.force).sum();
        let energy = verdict.add(0, size(pair), &cold);
        let mut cache = PairCache::default();
        for (frame, motion) in path(pair) {
            let warm =
                self.pair
                    .evaluate_cached(a, &pair.frame_a, b, &frame, &mut cache, motion, scratch);
            verdict.add(1, size(pair), &warm);
        }
        Some((energy, force))
    }

    /// The general kernel; energy and force.
    fn check_general(&mut self, pair: &TestPair, verdict: &mut Verdict) -> (f64, Vector3) {
        let (a, b) = (&pair.a.field, &pair.b.field);
        let scratch = &mut self.general;
        let patches = self
            .meshes
            .evaluate(a, &pair.frame_a, b, &pair.frame_b, scratch);
        let force = patches.iter().map(|p| p.overlap.force).sum();
        let energy = verdict.add(2, size(pair), patches.iter().map(|p| &p.overlap));
        let mut cache = Default::default();
        for (frame, motion) in path(pair) {
            let patches = self.meshes.evaluate_cached(
                a,
                &pair.frame_a,
                b,
                &frame,
                &mut cache,
                motion,
                scratch,
            );
            verdict.add(3, size(pair), patches.iter().map(|p| &p.overlap));
        }
        (energy, force)
    }
}

/// Radius of the smaller body, m.
fn size(pair: &TestPair) -> f64 {
    pair.a.radius().min(pair.b.radius())
}

/// The pose of B at the first, second and third call of a kernel with a cache, and the motion.
fn path(pair: &TestPair) -> [(Frame, f64); 3] {
    let step = 1e-3 * size(pair);
    [0.0, 1.0, 30.0].map(|steps| {
        let mut frame = pair.frame_b;
        frame.position.x += steps * step;
        (frame, steps * step)
    })
}
