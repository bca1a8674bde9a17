//! Volume that two bodies share.

use std::ops::Range;

use femdem_mesh::{Point3, Polyhedron, Pose};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::clip::Clipper;
use crate::error::AnalysisError;
use crate::neighbours::neighbour_pairs;
use crate::ordered::ordered_map;
use crate::pack::{Pack, PosedBody};
use crate::prisms::{self, Shadows};
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
}

impl PairOverlaps {
    /// Sum of the shared volumes (m³).
    pub fn total(&self) -> f64 {
        // Not `sum`, which is -0 without pairs.
        self.pairs.iter().fold(0.0, |sum, pair| sum + pair.volume)
    }
}

/// Shared volume of every pair of bodies, exact to round-off for bodies of any form.
///
/// Where one body is convex and has few faces, the other is cut by its face planes. All other pairs are
/// measured by signed prisms between their triangles, which require neither convexity nor a mesh of the inside.
/// Bodies apart share nothing and are not listed. A volume at the level of round-off, as of faces that merely
/// touch (some 1e-16 of the body), is reported unchanged.
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
    // The pack's constructor has checked that indices fit.
    let pair = |((i, j), volume)| PairOverlap {
        first: i as u32,
        second: j as u32,
        volume,
    };
    let sharing = measure_pairs(pack, &candidates, None);
    PairOverlaps {
        pairs: sharing.into_iter().map(pair).collect(),
    }
}

/// Volume (m³) that two bodies of any form share, exact to round-off.
///
/// ```
/// use femdem_analysis::intersection_volume;
/// use femdem_mesh::{Pose, shapes::{Dolos, Shape}};
///
/// let dolos = Shape::from(Dolos::default()).polyhedron(1.0)?;
/// let (here, beside) = (Pose::identity(), Pose::translation(0.0, 0.0, 0.1));
/// let shared = intersection_volume((&dolos, &here), (&dolos, &beside))?;
/// assert!(shared > 0.0 && shared < dolos.mass_properties().volume);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Pose`] for a pose that is not finite or not a rotation.
pub fn intersection_volume(
    first: (&Polyhedron, &Pose),
    second: (&Polyhedron, &Pose),
) -> Result<f64, AnalysisError> {
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

/// Those of `pairs` that share volume inside `region`, and the volume.
pub(crate) fn measure_pairs(
    pack: &Pack,
    pairs: &[Pair],
    region: Option<&Region>,
) -> Vec<(Pair, f64)> {
    let volumes = ordered_map(pairs.len(), Scratch::default, |scratch, k| {
        shared_volume(scratch, pack, pairs[k], region)
    });
    let measured = pairs.iter().copied().zip(volumes);
    measured.filter(|(_, volume)| *volume > 0.0).collect()
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    clipper: Clipper,
    /// Planes that can cut: signed distance to the other body's centroid, and index.
    planes: Vec<(f64, usize)>,
    shadows: [Shadows; 2],
}

/// Volume of `i ∩ j ∩ region`.
pub(crate) fn shared_volume(
    scratch: &mut Scratch,
    pack: &Pack,
    (i, j): Pair,
    region: Option<&Region>,
) -> f64 {
    if !pack.bounds(i).meets(pack.bounds(j)) {
        return 0.0;
    }
    let common = pack.bounds(i).clamped_to(pack.bounds(j));
    // The region where it cuts, none where it contains all of the shared part.
    let region = match region.map(|r| (r, r.relation(&common))) {
        Some((_, Relation::Outside)) => return 0.0,
        Some((region, Relation::Crosses)) => Some(region),
        Some((_, Relation::Inside)) | None => None,
    };
    if pack.by_planes(j) {
        shared_by_planes(scratch, pack, i, j, region)
    } else if pack.by_planes(i) {
        shared_by_planes(scratch, pack, j, i, region)
    } else if matches!(region, Some(Region::Sphere { .. })) {
        shared_by_cones(scratch, pack, (i, j), region)
    } else {
        shared_by_prisms(scratch, pack, (i, j), region)
    }
}

/// The surface, in the world frame, of the part that two bodies share, if one of them is handled by its planes;
/// it may be empty.
pub(crate) fn load_shared<'a>(
    scratch: &'a mut Scratch,
    pack: &Pack,
    (i, j): Pair,
) -> Option<&'a Clipper> {
    let knife = [j, i].into_iter().find(|&body| pack.by_planes(body))?;
    cut_by_planes(scratch, pack, i + j - knife, knife);
    scratch.clipper.transform(pack.pose(knife));
    Some(&scratch.clipper)
}

/// `body` is cut by the half-spaces whose intersection is `knife`.
fn shared_by_planes(
    scratch: &mut Scratch,
    pack: &Pack,
    body: usize,
    knife: usize,
    region: Option<&Region>,
) -> f64 {
    cut_by_planes(scratch, pack, body, knife);
    let clipper = &mut scratch.clipper;
    if let Some(region) = region {
        clipper.transform(pack.pose(knife));
        return clipper.volume_in(region);
    }
    clipper.volume()
}

/// Leaves the part that `body` shares with `knife` in the scratch's clipper, in the frame of `knife`.
fn cut_by_planes(scratch: &mut Scratch, pack: &Pack, body: usize, knife: usize) {
    let to_knife = pack.pose(knife).inverse();
    let Scratch {
        clipper, planes, ..
    } = scratch;
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
    // The plane that separates the two best goes first: most pairs end there.
    planes.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    if planes.first().is_some_and(|(s, _)| *s >= radius) {
        clipper.clear();
        return;
    }
    clipper.load(pack.shape(body), &(to_knife * pack.pose(body)));
    for &(_, k) in planes.iter() {
        let (normal, offset) = &pack.planes(knife)[k];
        clipper.clip(normal, *offset);
        if clipper.is_empty() {
            return;
        }
    }
}

/// By signed tetrahedra between a point and the triangles of `i`, for bodies that are not handled by planes and
/// a region that prisms cannot be cut by. Slower than prisms: every tetrahedron cuts all of `j`.
fn shared_by_cones(
    scratch: &mut Scratch,
    pack: &Pack,
    (i, j): Pair,
    region: Option<&Region>,
) -> f64 {
    let clipper = &mut scratch.clipper;
    let common = pack.bounds(i).clamped_to(pack.bounds(j));
    let apex = common.middle_and_half().0;
    let mut total = 0.0;
    pack.triangles_in(i, pack.bounds(i), |[a, b, c]| {
        let six_volumes = (a - apex).dot(&(b - apex).cross(&(c - apex)));
        if !Bounds::around([apex, a, b, c]).meets(&common) || six_volumes == 0.0 {
            return;
        }
        clipper.load(pack.shape(j), pack.pose(j));
        for ([p, q, r], inner) in [
            ([a, b, c], apex),
            ([apex, a, b], c),
            ([apex, b, c], a),
            ([apex, c, a], b),
        ] {
            let Some(normal) = (q - p).cross(&(r - p)).try_normalize(0.0) else {
                return;
            };
            let outward = if normal.dot(&(inner - p)) > 0.0 {
                -normal
            } else {
                normal
            };
            clipper.clip(&outward, outward.dot(&p.coords));
            if clipper.is_empty() {
                return;
            }
        }
        let part = match region {
            Some(region) => clipper.volume_in(region),
            None => clipper.volume(),
        };
        total += part * six_volumes.signum();
    });
    total
}

/// By signed prisms, for bodies that are not handled by planes, cut by a region of planes or an upright
/// cylinder.
fn shared_by_prisms(
    scratch: &mut Scratch,
    pack: &Pack,
    (i, j): Pair,
    region: Option<&Region>,
) -> f64 {
    let Scratch {
        clipper, shadows, ..
    } = scratch;
    let mut reach = [*pack.bounds(i), *pack.bounds(j)];
    if let Some(region) = region {
        clipper.load(pack.shape(i), pack.pose(i));
        clipper.clip_to_planes(region);
        if clipper.is_empty() {
            return 0.0;
        }
        reach[0] = clipper.bounds();
    }
    let common = reach[0].clamped_to(&reach[1]);
    let mut origin = common.middle_and_half().0;
    let (axes, radius) = match region {
        // The round side projects to a circle along z only.
        Some(Region::Cylinder { centre, radius, .. }) => {
            [origin.x, origin.y] = *centre;
            (2..3, Some(*radius))
        }
        _ => (0..3, None),
    };
    let view = View::choose(axes, &reach, &common);
    for ((shadows, body), place) in shadows.iter_mut().zip([i, j]).zip(0..) {
        let window = view.window(&common, place == view.lower);
        shadows.clear();
        let mut add = |t: [Point3; 3]| shadows.push(&t, view.axis, &origin);
        if place == 0 && region.is_some() {
            clipper.each_triangle(|t| {
                if Bounds::around(t).meets(&window) {
                    add(t);
                }
            });
        } else {
            pack.triangles_in(body, &window, add);
        }
    }
    let [first, second] = shadows;
    if view.lower == 0 {
        prisms::shared_volume(first, second, radius)
    } else {
        prisms::shared_volume(second, first, radius)
    }
}

/// The direction along which the prisms between two bodies are projected.
#[derive(Clone, Copy, Debug)]
struct View {
    axis: usize,
    /// Which of the two bodies forms the lower ends of the prisms.
    lower: usize,
}

impl View {
    /// The view along one of `axes` with the smallest windows, so that few triangles are in them.
    fn choose(axes: Range<usize>, reach: &[Bounds; 2], common: &Bounds) -> Self {
        let size = common.max - common.min;
        let content = |view: &Self| {
            let Self { axis, lower } = *view;
            let below = common.max[axis] - reach[lower].min[axis];
            let above = reach[1 - lower].max[axis] - common.min[axis];
            (size[(axis + 1) % 3] * size[(axis + 2) % 3]).powi(2) * below * above
        };
        let mut best = Self {
            axis: axes.start,
            lower: 0,
        };
        for axis in axes {
            for lower in 0..2 {
                let view = Self { axis, lower };
                if content(&view) < content(&best) {
                    best = view;
                }
            }
        }
        best
    }

    /// Where triangles of the lower or the upper body contribute to the shared volume.
    fn window(&self, common: &Bounds, lower: bool) -> Bounds {
        let mut window = *common;
        if lower {
            window.min[self.axis] = f64::NEG_INFINITY;
        } else {
            window.max[self.axis] = f64::INFINITY;
        }
        window
    }
}
