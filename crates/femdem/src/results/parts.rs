//! Parts of `summary.json`: the shapes and the container.

use femdem_analysis::SieveCurve;
use femdem_pack::{Container, PackReport, Packing};
use serde::{Deserialize, Serialize};

use crate::{Body, Snapshot};

/// Kind of a container from a surface file.
pub(super) const SOLID: &str = "solid";

/// A shape of a pack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShapeSummary {
    /// Name, as in `bodies.csv`.
    pub name: String,
    /// Number of bodies in the container.
    pub count: usize,
    /// Circumscribed diameter \[m\].
    pub diameter: f64,
    /// Volume \[m³\].
    pub volume: f64,
    /// Density \[kg/m³\].
    pub density: f64,
    /// Number of faces.
    pub faces: usize,
    /// Whether it is convex.
    pub convex: bool,
    /// Number of tetrahedra with which its contacts are computed; `null` for a convex shape.
    pub tetrahedra: Option<usize>,
}

/// The container \[m\]; values that its kind does not have are `null`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContainerSummary {
    /// "box", "cylinder", "silo" or "solid".
    pub kind: String,
    /// Inner dimension along x, of a box.
    pub width: Option<f64>,
    /// Inner dimension along y, of a box.
    pub depth: Option<f64>,
    /// Inner diameter, of a cylinder or silo; of the opening, of a solid.
    pub diameter: Option<f64>,
    /// Diameter of the closed outlet, of a silo.
    pub outlet: Option<f64>,
    /// Angle between the cone of a silo and the vertical \[degrees\].
    pub half_angle: Option<f64>,
    /// Height of the rim, if it has one.
    pub rim: Option<f64>,
    /// Highest point of the bodies.
    pub top: f64,
    /// Mean height of the pack: highest points over squares of side d, averaged.
    pub mean_top: f64,
    /// Bodies that reach above the rim, if there is one.
    pub above_rim: Option<usize>,
}

impl ShapeSummary {
    pub(super) fn all(packing: &Packing, snapshot: &Snapshot) -> Vec<Self> {
        let mut counts = vec![0; packing.spec().shapes.len()];
        for body in &snapshot.bodies {
            if let Some(count) = counts.get_mut(body.shape as usize) {
                *count += 1;
            }
        }
        let shapes = packing.spec().shapes.iter().zip(counts);
        let summary = shapes.map(|(shape, count)| Self {
            name: shape.name.clone(),
            count,
            diameter: shape.diameter(),
            volume: shape.volume(),
            density: shape.density.unwrap_or(packing.spec().density),
            faces: shape.polyhedron.face_count(),
            convex: shape.polyhedron.is_convex(),
            tetrahedra: shape.mesh.as_ref().map(|mesh| mesh.tets().len()),
        });
        summary.collect()
    }
}

/// The sizes of the bodies in the container.
pub(super) fn sieve(packing: &Packing, snapshot: &Snapshot) -> SieveCurve {
    // Of the specification: the surface that stands for a ball is larger than the ball.
    let size = |body: &Body| packing.spec().shapes[body.shape as usize].diameter();
    let bodies = snapshot.bodies.iter().zip(&snapshot.masses);
    SieveCurve::new(bodies.map(|(body, mass)| (size(body), *mass)))
}

impl ContainerSummary {
    pub(super) fn of(packing: &Packing, report: &PackReport) -> Self {
        let rim = packing.spec().rim;
        let world = packing.world();
        let highest = || world.body_ids().filter_map(|id| world.bounds(id));
        let mut summary = Self {
            kind: String::new(),
            width: None,
            depth: None,
            diameter: None,
            outlet: None,
            half_angle: None,
            rim,
            top: report.top,
            mean_top: report.mean_top,
            above_rim: rim.map(|rim| highest().filter(|(_, high)| high.z > rim).count()),
        };
        match packing.spec().container {
            Container::Mesh(ref mesh) => {
                SOLID.clone_into(&mut summary.kind);
                summary.diameter = Some(2.0 * mesh.opening());
                summary.rim = Some(mesh.height());
                let above = highest().filter(|(_, high)| high.z > mesh.height());
                summary.above_rim = Some(above.count());
            }
            Container::Box { width, depth } => {
                "box".clone_into(&mut summary.kind);
                (summary.width, summary.depth) = (Some(width), Some(depth));
            }
            Container::Periodic { width, depth } => {
                "periodic".clone_into(&mut summary.kind);
                (summary.width, summary.depth) = (Some(width), Some(depth));
            }
            Container::Cylinder { diameter } => {
                "cylinder".clone_into(&mut summary.kind);
                summary.diameter = Some(diameter);
            }
            Container::Silo {
                diameter,
                outlet,
                half_angle,
            } => {
                "silo".clone_into(&mut summary.kind);
                summary.diameter = Some(diameter);
                (summary.outlet, summary.half_angle) = (Some(outlet), Some(half_angle));
            }
        }
        summary
    }
}
