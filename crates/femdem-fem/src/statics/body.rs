//! A deformable body, with supports and loads, as a static problem.

use super::{Noise, StaticProblem, WORST_ROUNDING};
use crate::FemError;
use crate::material::{AnyMaterial, Material};
use crate::model::{Boundary, DeformableModel, DeformableState, MaterialRegion, Workspace};
use femdem_mesh::Vector3;

/// A body under the loads and with the supports of one time. Its unknowns are the coordinates of all nodes;
/// held ones have no residual and do not move.
pub(crate) struct BodyProblem<'a> {
    model: &'a DeformableModel,
    boundary: &'a Boundary,
    /// Time of the loads, s, and the fraction of them that acts.
    time: f64,
    part: f64,
    held: Vec<[bool; 3]>,
    old: Vec<f64>,
    new: Vec<f64>,
    has_energy: bool,
    /// Norm and sum of the diagonal of the tangent, N/m.
    stiffness: f64,
    trace: f64,
    /// Moduli times volumes, J.
    largest_energy: f64,
    // Results of the last evaluation.
    internal: Vec<Vector3>,
    loads: Vec<Vector3>,
    scale: f64,
    /// Largest norm of the internal forces at the start and at the ends of the load steps so far, N.
    largest_internal: f64,
    noise: Noise,
    // Scratch space.
    positions: Vec<Vector3>,
    at_rest: Vec<Vector3>,
    change: Vec<Vector3>,
    image: Vec<Vector3>,
    work: Workspace,
}

/// Rounding error of a force over that due to the coordinates of its node alone.
const ROUNDINGS: f64 = 4.0;

impl<'a> BodyProblem<'a> {
    /// # Errors
    /// If the arrays do not match the model, or an element has no tangent at the start.
    pub(crate) fn new(
        model: &'a DeformableModel,
        boundary: &'a Boundary,
        start: &DeformableState,
    ) -> Result<Self, FemError> {
        boundary.check(model)?;
        model.check_lengths(&start.x, &start.history)?;
        let nodes = model.nodes().len();
        let mut held = vec![[false; 3]; nodes];
        for (node, axis) in boundary.held() {
            held[node as usize][axis] = true;
        }
        let zero = vec![Vector3::zeros(); nodes];
        let is_potential = |r: &MaterialRegion| has_potential(&r.material);
        let mut problem = Self {
            model,
            boundary,
            time: 0.0,
            part: 0.0,
            held,
            old: start.history.clone(),
            new: start.history.clone(),
            has_energy: !boundary.has_pressure() && model.regions().iter().all(is_potential),
            stiffness: 0.0,
            trace: 0.0,
            largest_energy: largest_energy(model),
            internal: zero.clone(),
            loads: zero.clone(),
            scale: 0.0,
            largest_internal: 0.0,
            noise: Noise::default(),
            positions: start.x.clone(),
            change: zero.clone(),
            image: zero.clone(),
            at_rest: zero,
            work: Workspace::default(),
        };
        let x = flat(&start.x);
        problem.measure_stiffness(&x)?;
        // No load acts yet: the scale is that of the initial stresses.
        problem.see_internal_forces(&x)?;
        Ok(problem)
    }

    fn measure_stiffness(&mut self, x: &[f64]) -> Result<(), FemError> {
        let mut diagonal = vec![0.0; x.len()];
        self.tangent(x, &mut |i, j, value| {
            if i == j {
                diagonal[i as usize] += value;
            }
        })?;
        self.stiffness = super::vector::norm(&diagonal);
        self.trace = diagonal.iter().sum();
        Ok(())
    }

    /// Sets the fraction `part` of the loads of a time.
    pub(super) fn set_loads(&mut self, time: f64, part: f64) {
        (self.time, self.part) = (time, part);
    }

    /// The displacement from `x` to the places of held coordinates at a time; zero for the others.
    pub(super) fn motion_to(&self, time: f64, x: &[f64]) -> Vec<f64> {
        let mut motion = vec![0.0; x.len()];
        self.boundary.for_held(time, |node, axis, place, _| {
            let at = 3 * node + axis;
            motion[at] = place - x[at];
        });
        motion
    }

    /// Makes the history at `x` the start of the next step.
    ///
    /// # Errors
    /// If an element has no stress at `x`.
    pub(super) fn commit(&mut self, x: &[f64]) -> Result<(), FemError> {
        self.see_internal_forces(x)?;
        std::mem::swap(&mut self.old, &mut self.new);
        Ok(())
    }

    /// Evaluates the forces at `x`, and includes the internal ones in the scale from now on.
    ///
    /// # Errors
    /// If an element has no stress at `x`.
    fn see_internal_forces(&mut self, x: &[f64]) -> Result<(), FemError> {
        let mut r = vec![0.0; x.len()];
        self.residual(x, &mut r)?;
        let squares: f64 = self.internal.iter().map(Vector3::norm_squared).sum();
        self.largest_internal = self.largest_internal.max(squares.sqrt());
        Ok(())
    }

    /// The history at the start of the step.
    pub(super) fn into_history(self) -> Vec<f64> {
        self.old
    }

    /// Forces of the supports on the body at the last evaluation, N.
    pub(super) fn reactions(&self) -> Vec<Vector3> {
        let parts = self.internal.iter().zip(&self.loads).zip(&self.held);
        parts
            .map(|((f, load), held)| only(held, -(f + load)))
            .collect()
    }

    /// K dx at `x` on free coordinates, also for a motion of held ones.
    ///
    /// # Errors
    /// Of the tangent.
    pub(super) fn pull_of(
        &mut self,
        x: &[f64],
        dx: &[f64],
        out: &mut [f64],
    ) -> Result<(), FemError> {
        unflatten(x, &mut self.positions);
        unflatten(dx, &mut self.change);
        self.model
            .tangent_apply(&self.positions, &self.old, &self.change, &mut self.image)?;
        let images = self.image.iter().zip(&self.held);
        for (out, (image, held)) in out.as_chunks_mut::<3>().0.iter_mut().zip(images) {
            *out = (image - only(held, *image)).into();
        }
        Ok(())
    }
}

impl StaticProblem for BodyProblem<'_> {
    fn len(&self) -> usize {
        3 * self.held.len()
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<f64, FemError> {
        unflatten(x, &mut self.positions);
        let state = self.model.internal_forces(
            &self.positions,
            &self.at_rest,
            &self.old,
            &mut self.new,
            &mut self.internal,
            &mut self.work,
        )?;
        self.loads.fill(Vector3::zeros());
        self.boundary
            .add_forces(self.model, self.time, &self.positions, &mut self.loads)?;
        let (mut energy, mut squares, mut farthest) = (state.energy + state.plastic_work, 0.0, 0.0);
        let mut is_loaded = false;
        let nodes = self.positions.iter().zip(self.model.nodes());
        let forces = self.internal.iter().zip(&mut self.loads).zip(&self.held);
        for (((x, reference), ((f, load), held)), r) in
            nodes.zip(forces).zip(r.as_chunks_mut::<3>().0)
        {
            *load *= self.part;
            is_loaded |= *load != Vector3::zeros();
            let total = f + *load;
            let reaction = only(held, total);
            energy -= load.dot(&(x - reference));
            squares += load.norm_squared() + reaction.norm_squared();
            farthest = x.amax().max(farthest);
            *r = (total - reaction).into();
        }
        // After unloading there may be no load to compare with: then the earlier internal forces are the
        // scale.
        self.scale = squares.sqrt().max(self.largest_internal);
        // A coordinate has an error of up to eps |x|, a force one of that times its stiffness, and the energy
        // one of at most |E'| |dx| <= sqrt(2 E) sqrt(dx . K dx). Elements sum terms of the size of their
        // moduli.
        let rounding = f64::EPSILON * farthest;
        let carried = rounding * (2.0 * state.energy.abs() * self.trace).sqrt();
        self.noise = Noise {
            force: ROUNDINGS * rounding * self.stiffness,
            energy: ROUNDINGS * (carried + f64::EPSILON * self.largest_energy),
        };
        if !is_loaded && self.scale <= self.noise.force {
            // All forces are round-off, which counts as rest.
            self.scale = self.noise.force / WORST_ROUNDING;
        }
        Ok(energy)
    }

    fn has_energy(&self) -> bool {
        self.has_energy
    }

    fn force_scale(&self) -> f64 {
        self.scale
    }

    fn noise(&self) -> Noise {
        self.noise
    }

    fn tangent_apply(&mut self, x: &[f64], dx: &[f64], out: &mut [f64]) -> Result<(), FemError> {
        self.pull_of(x, dx, out)
    }

    fn tangent(&mut self, x: &[f64], entry: &mut dyn FnMut(u32, u32, f64)) -> Result<(), FemError> {
        unflatten(x, &mut self.positions);
        let held = &self.held;
        let is_free = |node: u32, axis: usize| !held[node as usize][axis];
        self.model
            .for_element_tangents(&self.positions, &self.old, |nodes, matrix| {
                let mut values = matrix.iter();
                for &a in nodes {
                    for i in 0..3 {
                        for &b in nodes {
                            for (j, value) in (0..3).zip(&mut values) {
                                if is_free(a, i) && is_free(b, j) {
                                    entry(3 * a + i as u32, 3 * b + j as u32, *value);
                                }
                            }
                        }
                    }
                }
            })?;
        // Held coordinates stay at their places.
        for (node, held) in (0..).zip(held) {
            for axis in (0..3).filter(|&axis| held[axis]) {
                entry(3 * node + axis as u32, 3 * node + axis as u32, 1.0);
            }
        }
        Ok(())
    }
}

/// The components of `force` along held axes.
fn only(held: &[bool; 3], force: Vector3) -> Vector3 {
    Vector3::from_fn(|axis, _| if held[axis] { force[axis] } else { 0.0 })
}

/// The sum of the elements' wave moduli times volumes, J.
fn largest_energy(model: &DeformableModel) -> f64 {
    let elements = model.volumes().iter().zip(model.region_of_tet());
    let modulus = |region: u32| model.regions()[region as usize].material.wave_modulus();
    elements
        .map(|(volume, &region)| volume * modulus(region))
        .sum()
}

/// Whether stored energy plus plastic work is a potential of the stress over a step.
fn has_potential(material: &AnyMaterial) -> bool {
    match material {
        AnyMaterial::J2(_) => true,
        other => other.history_len() == 0,
    }
}

/// Three numbers for each vector.
pub(super) fn flat(vectors: &[Vector3]) -> Vec<f64> {
    vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

/// The reverse of [`flat`].
pub(super) fn unflatten(numbers: &[f64], vectors: &mut [Vector3]) {
    for (v, n) in vectors.iter_mut().zip(numbers.as_chunks::<3>().0) {
        *v = Vector3::from(*n);
    }
}
