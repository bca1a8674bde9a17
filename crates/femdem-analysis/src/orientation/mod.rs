//! Orientations of bodies: directions of axes and faces, their stereonet, order and fabric.

mod order;
mod quartic;
mod stereonet;
mod tilt;

use std::collections::BTreeSet;

use femdem_mesh::{Polyhedron, Vector3};
use serde::{Deserialize, Serialize};

pub use order::{OrderParameter, OrientationOptions, OrientationOrder, orientation_order};
pub use stereonet::{NetNode, Stereonet, StereonetOptions, schmidt, stereonet};
pub use tilt::{TiltGroup, TiltHistogram, TiltOptions, distinct_axis, tilt_histogram, tilts};

use crate::error::AnalysisError;
use crate::pack::Pack;

/// Which directions of a body are used. All are axes: a direction and its opposite are the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyAxes {
    /// The principal axis of smallest moment of inertia: the long axis. Meaningless for bodies with equal
    /// moments, such as the Platonic solids; use face normals for them.
    Long,
    /// The principal axis of largest moment of inertia: the short axis.
    Short,
    /// All three principal axes.
    Principal,
    /// Directions in the body frame, of any length; the same for all shapes.
    Fixed(Vec<[f64; 3]>),
    /// Normals of all faces, or of those with this many sides.
    FaceNormals {
        /// Number of sides of the faces used; `None`: all faces.
        sides: Option<u32>,
    },
}

/// An axis of a body in the world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyDirection {
    /// Index of the body.
    pub body: u32,
    /// Unit vector, world frame.
    pub direction: [f64; 3],
}

/// The axes of bodies in the world: of those listed in `among`, or of all.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Pose, Vector3, catalogue::CatalogueShape};
///
/// // A truncated dodecahedron has 12 faces of 10 sides.
/// let shapes = ["A10".parse::<CatalogueShape>()?.polyhedron(1.0)?];
/// let bodies = [PosedBody { shape: 0, pose: Pose::new(Vector3::zeros(), Vector3::x()) }];
/// let pack = Pack::new(&shapes, &bodies)?;
/// let axes = BodyAxes::FaceNormals { sides: Some(10) };
/// assert_eq!(body_directions(&pack, &axes, None)?.len(), 12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::NoDirections`], [`AnalysisError::NoFaces`] for a number of sides that no face has,
/// [`AnalysisError::Direction`] for a fixed axis, [`AnalysisError::BodyIndex`].
pub fn body_directions(
    pack: &Pack,
    axes: &BodyAxes,
    among: Option<&[u32]>,
) -> Result<Vec<BodyDirection>, AnalysisError> {
    let of_shapes = axes_of_shapes(pack, axes)?;
    let mut found = Vec::new();
    for body in selected(pack, among)? {
        let shape = pack.bodies()[body as usize].shape as usize;
        let turn = pack.pose(body as usize).rotation;
        found.extend(of_shapes[shape].iter().map(|axis| BodyDirection {
            body,
            direction: (turn * axis).into(),
        }));
    }
    if found.is_empty() {
        return Err(no_directions(pack, axes));
    }
    Ok(found)
}

/// The reason why there is no axis: no face with the given number of sides, or no bodies or axes at all.
fn no_directions(pack: &Pack, axes: &BodyAxes) -> AnalysisError {
    let faces = pack.shapes().iter().flat_map(|shape| {
        let count = shape.face_count();
        (0..count).map(|k| shape.face(k).len())
    });
    let found: BTreeSet<usize> = faces.collect();
    match axes {
        BodyAxes::FaceNormals { sides: Some(sides) } if !found.contains(&(*sides as usize)) => {
            AnalysisError::NoFaces {
                sides: *sides,
                found: found.into_iter().collect(),
            }
        }
        _ => AnalysisError::NoDirections,
    }
}

/// The bodies listed, once each and ascending; all without a list.
fn selected(pack: &Pack, among: Option<&[u32]>) -> Result<Vec<u32>, AnalysisError> {
    let Some(list) = among else {
        // The constructor has checked that the indices fit.
        return Ok((0..pack.len() as u32).collect());
    };
    if let Some((index, &body)) = list
        .iter()
        .enumerate()
        .find(|(_, b)| **b as usize >= pack.len())
    {
        return Err(AnalysisError::BodyIndex {
            what: "selection entry",
            index,
            body,
            bodies: pack.len(),
        });
    }
    let mut bodies = list.to_vec();
    bodies.sort_unstable();
    bodies.dedup();
    Ok(bodies)
}

/// Unit axes of every shape, body frame.
fn axes_of_shapes(pack: &Pack, axes: &BodyAxes) -> Result<Vec<Vec<Vector3>>, AnalysisError> {
    if let BodyAxes::Fixed(list) = axes {
        let unit = unit_vectors(list)?;
        return Ok(vec![unit; pack.shapes().len()]);
    }
    Ok(pack.shapes().iter().map(|s| axes_of(s, axes)).collect())
}

fn axes_of(shape: &Polyhedron, axes: &BodyAxes) -> Vec<Vector3> {
    let sorted = || {
        let frame = shape.mass_properties().principal();
        let mut order = [0, 1, 2];
        order.sort_by(|&i: &usize, &j| frame.moments[i].total_cmp(&frame.moments[j]));
        order.map(|k| frame.rotation * Vector3::ith(k, 1.0))
    };
    match axes {
        BodyAxes::Long => vec![sorted()[0]],
        BodyAxes::Short => vec![sorted()[2]],
        BodyAxes::Principal => sorted().to_vec(),
        BodyAxes::Fixed(_) => Vec::new(),
        BodyAxes::FaceNormals { sides } => (0..shape.face_count())
            .filter(|&k| sides.is_none_or(|n| shape.face(k).len() == n as usize))
            .map(|k| shape.face_normal(k))
            .collect(),
    }
}

/// The vectors, normalised.
fn unit_vectors(list: &[[f64; 3]]) -> Result<Vec<Vector3>, AnalysisError> {
    let unit = |(index, &vector): (usize, &[f64; 3])| {
        let v = Vector3::from(vector);
        // Divided by the largest component first, so that squares neither overflow nor vanish.
        let scaled = v / v.amax();
        let unit = scaled.normalize();
        if unit.iter().all(|x| x.is_finite()) {
            Ok(unit)
        } else {
            Err(AnalysisError::Direction { index, vector })
        }
    };
    list.iter().enumerate().map(unit).collect()
}
