//! Measurements of the poses of a pack, by any engine.

use crate::settle::surface;
use anyhow::Result;
use femdem_analysis::{CoreOptions, Pack, PosedBody, Region, choose_core, exact_density};
use femdem_mesh::{Point3, Pose};
use femdem_pack::PackSpec;
use femdem_solve::{BodySpec, Drive, World, WorldParameters};

/// A step that moves nothing, s.
const MOMENT: f64 = 1e-12;

/// A pack in numbers.
#[derive(Debug, Clone, Copy)]
pub struct Measures {
    /// Largest overlap volume over contact area of a pair of bodies, or of a body and a wall, over d.
    pub penetration_max: f64,
    /// Mean of the same over the touching pairs.
    pub penetration_mean: f64,
    /// Touching pairs, walls included.
    pub touching: usize,
    /// Solid volume over the volume of the core that `femdem pack` would choose.
    pub density: f64,
    /// Mean height of the bodies' centroids over the floor, over d.
    pub mean_height: f64,
}

/// Measures bodies of one shape at given poses in the container of a job.
pub fn measure(spec: &PackSpec, poses: &[Pose]) -> Result<Measures> {
    let depths = penetrations(spec, poses)?;
    let [x, y] = spec.container.half_extent();
    let top = 100.0 * spec.expected_height();
    let container = Region::Box {
        min: Point3::new(-x, -y, 0.0),
        max: Point3::new(x, y, top),
    };
    let shapes = [surface(spec)?.clone()];
    let bodies: Vec<PosedBody> = poses
        .iter()
        .map(|&pose| PosedBody { shape: 0, pose })
        .collect();
    let pack = Pack::new(&shapes, &bodies)?;
    let core = choose_core(&pack, &container, &CoreOptions::default())?;
    Ok(Measures {
        penetration_max: depths.iter().copied().fold(0.0, f64::max),
        penetration_mean: depths.iter().sum::<f64>() / depths.len().max(1) as f64,
        touching: depths.len(),
        density: exact_density(&pack, &core.region)?.density,
        mean_height: poses.iter().map(|p| p.translation.z).sum::<f64>()
            / (poses.len().max(1) as f64 * spec.diameter()),
    })
}

/// Overlap volume over contact area of all touching pairs, over d.
fn penetrations(spec: &PackSpec, poses: &[Pose]) -> Result<Vec<f64>> {
    let mut parameters = WorldParameters::default();
    parameters.time_step.largest = Some(MOMENT);
    let mut world = World::new(parameters)?;
    let shape = world.add_shape("body", surface(spec)?)?;
    for wall in spec.container.walls()? {
        world.add_wall(wall, Drive::Fixed)?;
    }
    for &pose in poses {
        world.add_body(BodySpec::at_rest(shape, spec.density, pose))?;
    }
    world.step()?;
    let contacts = world.contacts();
    Ok(contacts
        .iter()
        .map(|c| c.penetration() / spec.diameter())
        .collect())
}
