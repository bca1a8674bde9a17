//! Taylor's impact test: a copper bar strikes a rigid, smooth wall.
//!
//! Wilkins and Guinan, J. Appl. Phys. 44, 1200 (1973), in the form that element studies use.

use super::cylinder::quarter_cylinder;
use super::planes::plane;
use femdem_fem::element::Element;
use femdem_fem::material::J2;
use femdem_fem::{Boundary, DeformableBody, DeformableModel, DeformableState, MaterialRegion};
use femdem_mesh::Vector3;
use std::sync::Arc;

const LENGTH: f64 = 32.4e-3;
const RADIUS: f64 = 3.2e-3;
const SPEED: f64 = 227.0;
const END: f64 = 80e-6;
/// Fraction of the stability bound that is used as step.
const SAFETY: f64 = 0.9;
/// Number of steps after which the bound is renewed.
const RENEWAL: u64 = 20;

/// Shape of the bar at the end.
#[derive(Debug)]
pub struct Outcome {
    pub elements: usize,
    pub steps: u64,
    /// m
    pub length: f64,
    /// Of the face on the wall, m.
    pub radius: f64,
    /// Energy missing in the ledger, over its largest entry.
    pub energy_error: f64,
}

/// Follows a quarter of the bar to 80 microseconds. The face on the wall stays on it, free to slide.
///
/// # Errors
/// If an element is inverted.
pub fn run(
    element: Element,
    rings: u32,
    layers: u32,
) -> Result<Outcome, Box<dyn std::error::Error>> {
    let mesh = quarter_cylinder(RADIUS, LENGTH, rings, layers)?;
    let copper = MaterialRegion {
        material: J2::new(117e9, 0.35, 400e6, 100e6)?.into(),
        density: 8930.0,
    };
    let model = Arc::new(DeformableModel::new(&mesh, element, vec![copper], None)?);
    let mut boundary = Boundary::default();
    for axis in 0..3 {
        boundary.fix(&model, &plane(axis, 0.0), [0, 1, 2].map(|k| k == axis))?;
    }
    let start = DeformableState {
        v: vec![Vector3::new(0.0, 0.0, -SPEED); model.nodes().len()],
        ..DeformableState::reference(&model)
    };
    let mut bar = DeformableBody::with_state(Arc::clone(&model), boundary, start, 0.0)?;
    let mut dt = 0.0;
    while bar.time() < END {
        if bar.steps() % RENEWAL == 0 {
            dt = SAFETY * bar.critical_step()?;
        }
        bar.step(dt.min(END - bar.time()).max(0.01 * dt))?;
    }
    let x = &bar.state().x;
    let on_wall = x.iter().zip(model.nodes()).filter(|(_, r)| r.z == 0.0);
    Ok(Outcome {
        elements: model.volumes().len(),
        steps: bar.steps(),
        length: x.iter().map(|x| x.z).fold(0.0, f64::max),
        radius: on_wall.map(|(x, _)| x.x.hypot(x.y)).fold(0.0, f64::max),
        energy_error: bar.ledger().error_relative(),
    })
}
