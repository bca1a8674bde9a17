//! The container of a scene.

use std::f64::consts::FRAC_PI_4;

use femdem_pack::{Container, MeshContainer, PackSpec};

use super::bodies::{file_stem, read};
use super::{ContainerKind, Footprint, Length, Scene};
use crate::Error;

/// Packing density that the automatic size of a container counts on.
const EXPECTED_DENSITY: f64 = 0.6;

/// The container for the bodies of `spec`.
///
/// # Errors
/// [`Error::Option`] without a file for the walls, [`Error::Mesh`] or [`Error::Pack`] for one that
/// cannot be used.
pub(super) fn container(scene: &Scene, spec: &PackSpec) -> Result<Container, Error> {
    let diameter = spec.diameter();
    let pack = f64::from(spec.count) * spec.mean_volume() / diameter.powi(3) / EXPECTED_DENSITY;
    let round = || {
        let width = level_width(pack / FRAC_PI_4);
        let width = scene.cylinder.unwrap_or(Length::Diameters(width));
        width.metres(diameter)
    };
    Ok(match scene.container {
        ContainerKind::Walls => {
            let path = scene.walls.as_ref().ok_or(Error::Option {
                name: "container",
                value: "walls".to_owned(),
                allowed: "give the surface file of the walls with --walls",
            })?;
            let (surface, _) = read(path, scene)?;
            Container::Mesh(Box::new(MeshContainer::new(file_stem(path), &surface)?))
        }
        ContainerKind::Box => {
            let side = level_width(pack);
            let size = scene.r#box.unwrap_or(Footprint::diameters(side, side));
            Container::Box {
                width: size.width.metres(diameter),
                depth: size.depth.metres(diameter),
            }
        }
        ContainerKind::Cylinder => Container::Cylinder { diameter: round() },
        ContainerKind::Silo => Container::Silo {
            diameter: round(),
            outlet: scene.outlet.metres(diameter),
            half_angle: scene.cone,
        },
    })
}

/// Height of the container's rim \[m\], if it has one.
pub(super) fn rim(scene: &Scene, diameter: f64) -> Option<f64> {
    let height = scene.r#box?.height?.metres(diameter);
    (scene.container == ContainerKind::Box).then_some(height)
}

/// Side of the cube of a volume, to the nearest half, and 3 at least.
fn level_width(volume: f64) -> f64 {
    ((2.0 * volume.cbrt()).round() / 2.0).max(3.0)
}
