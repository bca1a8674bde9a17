//! Volume that two bodies share.

use femdem_mesh::{Polyhedron, Pose};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::clip::Clipper;
use crate::error::AnalysisError;
use crate::neighbours::neighbour_pairs;
use crate::ordered::ordered_map;
use crate::pack::{Pack, PosedBody};
use crate::region::{Region, Relation};

/// The overlap of one pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairOverlap {
    /// Index of the first body.
    pub first: u32,
    /// Index of the second body; larger than `first`.
    pub second: u32,
    /// Shared volume (m³), above zero.
    pub volume: f64,
}

/// All overlaps of a pack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PairOverlaps {
    /// The pairs that share volume, sorted by `(first, second)`.
    pub pairs: Vec<PairOverlap>,
    /// Pairs left out because both bodies are non-convex and their boxes meet.
    pub skipped: usize,
}

impl PairOverlaps {
    /// Sum of the shared volumes (m³).
    pub fn total(&self) -> f64 {
        self.pairs.iter().map(|p| p.volume).sum()
    }
}

/// Shared volume of every pair of bodies, exact to round-off.
///
/// A body is cut by the face planes of the other, so at least one of the two must be convex; other
/// pairs are counted in [`PairOverlaps::skipped`]. A volume as small as round-off makes of faces that
/// merely touch (about 1e-16 of the body) is reported as it comes.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, pair_overlaps};
/// use femdem_mesh::{Pose, catalogue::CatalogueShape};
///
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?]; // side 1 m
/// let at = |x| PosedBody { shape: 0, pose: Pose::translation(x, 0.0, 0.0) };
/// let bodies = [at(0.0), at(0.75)];
/// let overlaps = pair_overlaps(&Pack::new(&cube, &bodies)?);
/// assert!((overlaps.total() - 0.25).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn pair_overlaps(pack: &Pack) -> PairOverlaps {
    let members: Vec<usize> = (0..pack.len()).collect();
    let candidates = neighbour_pairs(pack, &members);
    let MeasuredPairs { sharing, skipped } = measure_pairs(pack, &candidates, None);
    // The pack's constructor has checked that indices fit.
    let pair = |((i, j), volume)| PairOverlap {
        first: i as u32,
        second: j as u32,
        volume,
    };
    PairOverlaps {
        pairs: sharing.into_iter().map(pair).collect(),
        skipped: skipped.len(),
    }
}

/// Volume (m³) that two bodies share; `None` when both are non-convex.
///
/// # Errors
/// [`AnalysisError::Pose`] for a pose that is not finite or not a rotation.
pub fn intersection_volume(
    first: (&Polyhedron, &Pose),
    second: (&Polyhedron, &Pose),
) -> Result<Option<f64>, AnalysisError> {
    let shapes = [first.0.clone(), second.0.clone()];
    let bodies = [
        PosedBody {
            shape: 0,
            pose: *first.1,
        },
        PosedBody {
            shape: 1,
            pose: *second.1,
        },
    ];
    let pack = Pack::new(&shapes, &bodies)?;
    Ok(shared_volume(&mut Scratch::default(), &pack, (0, 1), None))
}

/// Two bodies, by index.
pub(crate) type Pair = (usize, usize);

/// What [`measure_pairs`] finds.
pub(crate) struct MeasuredPairs {
    /// Pairs with a shared volume above zero, and that volume.
    pub(crate) sharing: Vec<(Pair, f64)>,
    /// Pairs that cannot be cut.
    pub(crate) skipped: Vec<Pair>,
}

/// Shared volumes of `pairs` inside `region`.
pub(crate) fn measure_pairs(pack: &Pack, pairs: &[Pair], region: Option<&Region>) -> MeasuredPairs {
    let volumes = ordered_map(pairs.len(), Scratch::default, |scratch, k| {
        shared_volume(scratch, pack, pairs[k], region)
    });
    let mut sharing = Vec::new();
    let mut skipped = Vec::new();
    for (&pair, volume) in pairs.iter().zip(volumes) {
        match volume {
            Some(volume) if volume > 0.0 => sharing.push((pair, volume)),
            Some(_) => {}
            None => skipped.push(pair),
        }
    }
    MeasuredPairs { sharing, skipped }
}

#[derive(Clone, Debug, Default)]
struct Scratch {
    clipper: Clipper,
    /// Planes that can cut: signed distance to the other body's centroid, and index.
    planes: Vec<(f64, usize)>,
}

/// Volume of `i ∩ j ∩ region`; `None` when both bodies are non-convex and their boxes meet there.
fn shared_volume(
    scratch: &mut Scratch,
    pack: &Pack,
    (i, j): Pair,
    region: Option<&Region>,
) -> Option<f64> {
    if !pack.bounds(i).meets(pack.bounds(j)) {
        return Some(0.0);
    }
    let common = Bounds {
        min: pack.bounds(i).min.sup(&pack.bounds(j).min),
        max: pack.bounds(i).max.inf(&pack.bounds(j).max),
    };
    let relation = region.map_or(Relation::Inside, |r| r.relation(&common));
    if relation == Relation::Outside {
        return Some(0.0);
    }
    // `knife` gives the half-spaces, `body` is cut by them.
    let (body, knife) = match (pack.shape(i).is_convex(), pack.shape(j).is_convex()) {
        (_, true) => (i, j),
        (true, false) => (j, i),
        (false, false) => return None,
    };
    let to_knife = pack.pose(knife).inverse();
    let Scratch { clipper, planes } = scratch;
    let centroid = to_knife * pack.centroid(body);
    let radius = pack.shape(body).bounding_radius();
    planes.clear();
    let distances = pack
        .planes(knife)
        .iter()
        .map(|(normal, offset)| normal.dot(&centroid.coords) - offset);
    planes.extend(
        distances
            .enumerate()
            .map(|(k, s)| (s, k))
            .filter(|(s, _)| *s > -radius),
    );
    // The plane that most nearly separates the two goes first: most pairs end there.
    planes.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    if planes.first().is_some_and(|(s, _)| *s >= radius) {
        return Some(0.0);
    }
    clipper.load(pack.shape(body), &(to_knife * pack.pose(body)));
    for &(_, k) in planes.iter() {
        let (normal, offset) = &pack.planes(knife)[k];
        clipper.clip(normal, *offset);
        if clipper.is_empty() {
            return Some(0.0);
        }
    }
    if let (Relation::Crosses, Some(region)) = (relation, region) {
        clipper.transform(pack.pose(knife));
        clipper.clip_to(region);
    }
    Some(clipper.volume())
}
