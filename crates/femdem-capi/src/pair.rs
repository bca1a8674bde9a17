//! Layer 1: what two bodies do to each other.

use std::cell::RefCell;
use std::mem::MaybeUninit;

use femdem_solve::contact::general::GeneralScratch;
use femdem_solve::contact::kernel::Scratch;
use femdem_solve::contact::{BodyShape, Frame, GeneralKernel, Overlap, PairKernel, SphereKernel};
use femdem_solve::mesh::Vector3;

use crate::border::{Failure, FemdemStatus, border, given, place};
use crate::form::Form;
use crate::handles::FemdemShape;
use crate::plain::{FemdemLoad, FemdemPose};

/// The elastic contact of two bodies, without friction and damping.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FemdemPair {
    /// On body A.
    pub on_a: FemdemLoad,
    /// On body B.
    pub on_b: FemdemLoad,
    /// Contact energy, J: the forces are minus its gradient.
    pub energy: f64,
    /// Volume of the overlap, m^3.
    pub volume: f64,
    /// Contact area, m^2, the sum of that of the patches.
    pub area: f64,
    /// Normal stiffness, N/m, the sum of that of the patches.
    pub stiffness: f64,
    /// Connected parts of the overlap: 0 if the bodies are apart.
    pub patches: u32,
}

impl FemdemPair {
    fn add(&mut self, overlap: &Overlap) {
        let sum = |to: &mut [f64; 3], by: Vector3| *to = (Vector3::from(*to) + by).into();
        sum(&mut self.on_a.force, -overlap.force);
        sum(&mut self.on_a.torque, overlap.torque_a());
        sum(&mut self.on_b.force, overlap.force);
        sum(&mut self.on_b.torque, overlap.torque_b());
        self.energy += overlap.energy;
        self.volume += overlap.volume;
        self.area += overlap.area;
        self.stiffness += overlap.foundation.stiffness;
        self.patches += 1;
    }
}

thread_local! {
    static CONVEX: RefCell<Scratch> = RefCell::default();
    static GENERAL: RefCell<GeneralScratch> = RefCell::default();
}

/// Takes the kernel that the two shapes need.
fn meet(
    penalty: f64,
    [a, b]: [&Form; 2],
    [at_a, at_b]: [&Frame; 2],
) -> Result<FemdemPair, Failure> {
    let mut all = FemdemPair::default();
    let ball = SphereKernel::new(penalty)?;
    match (&a.contact, &b.contact) {
        (BodyShape::Convex(a), BodyShape::Convex(b)) => {
            let kernel = PairKernel::new(penalty)?;
            let found =
                CONVEX.with_borrow_mut(|scratch| kernel.evaluate(a, at_a, b, at_b, scratch));
            found.iter().for_each(|overlap| all.add(overlap));
        }
        (BodyShape::Sphere(a), BodyShape::Sphere(b)) => {
            let found = ball.evaluate(a, b, &(at_b.position - at_a.position));
            found.iter().for_each(|overlap| all.add(overlap));
        }
        (BodyShape::Convex(body), BodyShape::Sphere(sphere)) => {
            let found = ball.evaluate_convex(body, at_a, sphere, &at_b.position);
            found.iter().for_each(|overlap| all.add(overlap));
        }
        (BodyShape::Mesh(body), BodyShape::Sphere(sphere)) => {
            let found = ball.evaluate_mesh(body, at_a, sphere, &at_b.position);
            found.iter().for_each(|patch| all.add(&patch.overlap));
        }
        (BodyShape::Sphere(_), _) => {
            let other = meet(penalty, [b, a], [at_b, at_a])?;
            let (on_a, on_b) = (other.on_b, other.on_a);
            all = FemdemPair {
                on_a,
                on_b,
                ..other
            };
        }
        _ => {
            let kernel = GeneralKernel::new(penalty)?;
            if let (Some(a), Some(b)) = (a.tetrahedra()?, b.tetrahedra()?) {
                GENERAL.with_borrow_mut(|scratch| {
                    let found = kernel.evaluate(&a, at_a, &b, at_b, scratch);
                    found.iter().for_each(|patch| all.add(&patch.overlap));
                });
            }
        }
    }
    Ok(all)
}

/// Writes what two bodies do to each other under a penalty in Pa: all zeros if they are apart. It keeps no state.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_pair_evaluate(
    penalty: f64,
    a: FemdemShape,
    pose_a: Option<&FemdemPose>,
    b: FemdemShape,
    pose_b: Option<&FemdemPose>,
    pair: Option<&mut MaybeUninit<FemdemPair>>,
) -> FemdemStatus {
    border(|| {
        let pair = place("pair", pair)?;
        let frames = [
            given("pose_a", pose_a)?.frame()?,
            given("pose_b", pose_b)?.frame()?,
        ];
        let (a, b) = (a.form()?, b.form()?);
        pair.write(meet(penalty, [&a, &b], [&frames[0], &frames[1]])?);
        Ok(())
    })
}
