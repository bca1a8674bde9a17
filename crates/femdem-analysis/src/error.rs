//! The crate's error type.

use thiserror::Error;

/// Why an analysis was refused. Every message names the value, what is allowed and what to do.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// The pack is empty, so that it has no size, no top and no mean.
    #[error("the pack holds no body; an analysis needs at least one")]
    EmptyPack,
    /// More bodies than a body index (`u32`) can name.
    #[error("{bodies} bodies are more than the 4294967295 a body index can name; split the pack")]
    TooManyBodies {
        /// Number of bodies given.
        bodies: usize,
    },
    /// A body names a shape that is not in the list of shapes.
    #[error("body {body} has shape index {shape}, but there are {shapes} shapes (indices from 0)")]
    ShapeIndex {
        /// Index of the body.
        body: usize,
        /// The shape index it gives.
        shape: u32,
        /// Number of shapes.
        shapes: usize,
    },
    /// A pose contains NaN or infinity, or its rotation is not of unit length.
    #[error(
        "body {body} has the translation {translation:?} m and a quaternion of length {length}; they must be finite \
         and 1 to 1e-6"
    )]
    Pose {
        /// Index of the body.
        body: usize,
        /// Its translation (m).
        translation: [f64; 3],
        /// Length of its quaternion.
        length: f64,
    },
    /// A region with NaN, infinity, or no volume.
    #[error("region: {name} = {value} is not allowed; it must be {allowed}")]
    Region {
        /// The offending quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A kind of region for which there is no such analysis.
    #[error("{what} cannot be had in such a region; give {instead}")]
    RegionKind {
        /// The analysis.
        what: &'static str,
        /// The regions for which it is possible.
        instead: &'static str,
    },
    /// Voxels over all of a periodic cell whose edges lean.
    #[error(
        "edge {axis} of the periodic cell leans by {lean} m, and voxels over all of such a cell do not repeat themselves; \
         give a region narrower than the cell, or a state in which it is upright"
    )]
    TiltedCell {
        /// The axis of the edge.
        axis: &'static str,
        /// How far its end lies off that axis (m).
        lean: f64,
    },
    /// Fewer bodies in a region than an analysis needs.
    #[error(
        "the region holds the centroids of {bodies} bodies, but at least {least} are needed; enlarge it"
    )]
    TooFewBodies {
        /// Number of bodies there.
        bodies: usize,
        /// The smallest number required.
        least: usize,
    },
    /// An empty set of directions.
    #[error("there is no direction to analyse; select bodies, and faces that they have")]
    NoDirections,
    /// Faces with a number of sides that no face of the bodies has.
    #[error(
        "no body has a face of {sides} sides; there are faces of {}",
        listed(found)
    )]
    NoFaces {
        /// Number of sides specified.
        sides: u32,
        /// Numbers of sides that faces of the bodies have, ascending.
        found: Vec<usize>,
    },
    /// A direction that is not finite or has no length.
    #[error("direction {index} is {vector:?}; it must be finite and not zero")]
    Direction {
        /// Its index.
        index: usize,
        /// The direction as given.
        vector: [f64; 3],
    },
    /// An option outside its range.
    #[error("option {name} = {value} is not allowed; it must be {allowed}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The counting grid would not fit in memory or in a day.
    #[error(
        "a grid of {cells:.3e} cells ({layer:.3e} per layer) is above the limit of 4.3e9 (1.3e8 per layer); \
         raise the grid spacing or shrink the region"
    )]
    GridTooFine {
        /// Number of cells.
        cells: f64,
        /// Cells in one horizontal layer.
        layer: f64,
    },
    /// No body lies over the floor of the container, so that there is no pack for a core.
    #[error(
        "the mean top of the pack, z = {mean_top} m, is not above the container's floor, z = {floor} m; \
         check that container and pack use the same frame"
    )]
    NoPackInContainer {
        /// Mean height of the pack's top (m); minus infinity where no body lies in the container.
        mean_top: f64,
        /// Height of the floor (m).
        floor: f64,
    },
    /// A bed whose top lies above the solid that holds it.
    #[error(
        "the mean top of the pack, z = {top} m, is above the rim of its container, z = {rim} m, where no walls bound \
         it; take a higher container or fewer bodies"
    )]
    AboveRim {
        /// Mean height of the pack's top (m).
        top: f64,
        /// Highest point of the container (m).
        rim: f64,
    },
    /// A body that a solid container does not surround.
    #[error(
        "the container has no wall on some side of body {body}, at the height of its centroid: the body lies outside, \
         or the container is open there, so that its volume is not known"
    )]
    NotEnclosed {
        /// Index of the first such body.
        body: usize,
    },
    /// A touch or a selection names a body that is not there.
    #[error("{what} {index} names body {body}, but there are {bodies} bodies (indices from 0)")]
    BodyIndex {
        /// "touch" or "selection entry".
        what: &'static str,
        /// Its index.
        index: usize,
        /// The body it names.
        body: u32,
        /// Number of bodies.
        bodies: usize,
    },
    /// A touch of a body with itself.
    #[error("touch {index} is of body {body} with itself; the two partners must differ")]
    SelfTouch {
        /// Index of the touch.
        index: usize,
        /// The body.
        body: u32,
    },
    /// A contact force that is NaN or infinite.
    #[error("touch {index} has normal force {force} N; it must be finite")]
    TouchForce {
        /// Index of the touch.
        index: usize,
        /// The force (N).
        force: f64,
    },
    /// A body of a force network with a number out of its range.
    #[error("body {index}: its {name} = {value} is not allowed; it must be {allowed}")]
    Body {
        /// Index of the body.
        index: usize,
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A contact of a force network with a number out of its range.
    #[error("contact {index}: its {name} = {value} is not allowed; it must be {allowed}")]
    Contact {
        /// Index of the contact.
        index: usize,
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// No fragment to measure.
    #[error("there is no fragment; give at least one, the unbroken body if nothing broke")]
    NoFragments,
    /// A fragment with a number out of its range.
    #[error("fragment {index}: its {name} = {value} is not allowed; it must be {allowed}")]
    Fragment {
        /// Index of the fragment.
        index: usize,
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Points of a fragment around which there is no box.
    #[error("fragment {index}: no box around its points: {why}")]
    FragmentPoints {
        /// Index of the fragment.
        index: usize,
        /// What is wrong with the points.
        why: String,
    },
    /// Radii of balls for another number of shapes than there are.
    #[error("{given} radii of balls for {shapes} shapes; give a radius, or none, for each shape")]
    BallCount {
        /// Number of entries given.
        given: usize,
        /// Number of shapes.
        shapes: usize,
    },
    /// A list that does not have one value per voxel.
    #[error("{given} {name} for {voxels} voxels; give those of the same image")]
    ListLength {
        /// What the list holds.
        name: &'static str,
        /// Its length.
        given: usize,
        /// Number of voxels.
        voxels: usize,
    },
    /// A list that has neither one value per body nor none.
    #[error("{given} {name} for {bodies} bodies; give one for each body")]
    BodyList {
        /// What the list holds.
        name: &'static str,
        /// Its length.
        given: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// An image without void.
    #[error("no voxel of the image is void; use smaller voxels or another region")]
    NoVoid,
    /// A body that is not convex where only convex ones can be treated.
    #[error("body {body} is not convex, which {what} needs; {instead}")]
    NotConvex {
        /// Index of the first such body.
        body: usize,
        /// What needs it.
        what: &'static str,
        /// What to do instead.
        instead: &'static str,
    },
    /// A body that would lose too much of its size to leave a gap.
    #[error(
        "body {body} would shrink to {factor:.3} of its size to leave a gap of {gap} m; give a smaller gap"
    )]
    GapTooWide {
        /// Index of the body.
        body: usize,
        /// The factor.
        factor: f64,
        /// The gap (m).
        gap: f64,
    },
    /// An analysis that compares forces with weights was given a body without weight.
    #[error("body {body} has no weight; give the mass or the density of the bodies, and gravity")]
    NoWeight {
        /// Index of the first body without a weight.
        body: usize,
    },
}

/// Such as "3, 4 and 6 sides".
fn listed(sides: &[usize]) -> String {
    let words: Vec<String> = sides.iter().map(usize::to_string).collect();
    match words.split_last() {
        Some((last, before)) if !before.is_empty() => {
            format!("{} and {last} sides", before.join(", "))
        }
        _ => format!("{} sides", words.concat()),
    }
}

/// Refuses a threshold of force (N) below which no pair could be, or that no number is above.
pub(crate) fn check_threshold(force_threshold: f64) -> Result<(), AnalysisError> {
    if force_threshold.is_finite() && force_threshold >= 0.0 {
        return Ok(());
    }
    Err(AnalysisError::Option {
        name: "force_threshold",
        value: force_threshold,
        allowed: "zero or more and finite (N)",
    })
}
