//! Tests of the fast path against the general path, which uses no plans.

use super::candidates::{KeptBox, candidates, contact_box};
use super::pair::{Near, Scratch, find_near, sides};
use super::plan::SidePlan;
use super::region::Pose;
use super::skin::SideSums;
use super::trail::Trail;
use crate::shape::ConvexShape;
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::UnitQuaternion;
use femdem_mesh::{Matrix3, Vector3};
use proptest::prelude::*;

/// The candidates of `find_near`, without any plan.
fn find_general(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    axis: &Vector3,
    margin: f64,
) -> Option<Near> {
    let region = contact_box(a, b, rotation, offset, axis, margin, &mut Vec::new())?;
    let region_b = Pose::new(rotation, offset).in_b(&region);
    let in_a = candidates(a, &region, 0.0, axis)?;
    let in_b = candidates(b, &region_b, margin, &-region_b.axes[0])?;
    Some(Near {
        region: KeptBox::from(&region),
        on_b: SidePlan::general(&in_b.facets, &in_a),
        on_a: SidePlan::general(&in_a.facets, &in_b),
        trail: Trail::default(),
    })
}

/// All integrals of one side, each with its magnitude for a body of size 1 in a field of 1.
fn numbers(s: &SideSums) -> Vec<f64> {
    let mut all = vec![
        s.pressure,
        s.pressure_second,
        s.stiffness,
        s.energy,
        s.volume,
    ];
    for v in [
        s.force,
        s.torque,
        s.pressure_moment,
        s.stiffness_moment,
        s.vector_area,
    ] {
        all.extend(v.iter());
    }
    all.extend(s.stiffness_second.iter());
    all
}

fn vector() -> impl Strategy<Value = Vector3> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(Vector3::from)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Every solid, from a touch to half way in; the plan is made at one pose and used at
    /// another within its margin.
    #[test]
    fn plans_leave_out_nothing(
        turn in vector(),
        direction in vector(),
        shift in vector(),
        depth in 1e-3..0.5_f64,
        margin in prop::sample::select(vec![1e-5, 1e-3, 2e-2]),
    ) {
        prop_assume!(direction.norm() > 0.1 && shift.norm() > 0.1);
        let axis = direction.normalize();
        let turned = |angle: f64| {
            UnitQuaternion::from_scaled_axis(turn * 3.0 + shift * angle)
                .to_rotation_matrix()
                .into_inner()
        };
        for solid in CatalogueShape::all() {
            let shape = ConvexShape::new(&solid.polyhedron(1.0).unwrap()).unwrap();
            let then = turned(0.0);
            let reach = shape.support(&axis) + shape.support(&-then.tr_mul(&axis));
            let place = axis * (reach * (1.0 - depth));
            let mut scratch = Scratch::default();
            let Some(near) = find_near(&shape, &shape, &then, &place, &axis, margin, &mut scratch)
            else {
                continue;
            };
            // Half of the margin by translation, less than half of it by rotation.
            let now = turned(0.4 * margin);
            let offset = place + shift.normalize() * (0.5 * margin);
            let fast = sides(&shape, &shape, &now, &offset, &near, &mut scratch);
            let general = find_general(&shape, &shape, &then, &place, &axis, margin);
            let slow = general.map_or([SideSums::default(); 2], |near| {
                sides(&shape, &shape, &now, &offset, &near, &mut scratch)
            });
            for (f, s) in fast.iter().zip(&slow) {
                let scale = 1e-12 * s.vector_area.norm().max(s.pressure) + 1e-15;
                for (got, want) in numbers(f).iter().zip(numbers(s)) {
                    prop_assert!(
                        (got - want).abs() <= scale,
                        "{}: {got:e} for {want:e}", solid.id()
                    );
                }
            }
        }
    }
}
