//! The bodies' own facets as one closed surface, with contacts opened.

use std::collections::BTreeSet;

use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, Vector3};

use super::separation::{Separation, corners, separation};
use super::solids::{Sides, side_distance};
use super::surface::{Surface, SurfacePatch};
use crate::clip::Clipper;
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::overlap::{PairOverlap, pair_overlaps};
use crate::pack::Pack;
use crate::region::{Region, Relation};

/// Smallest factor by which a body may shrink to leave a gap.
const LEAST_FACTOR: f64 = 0.5;

/// Cuts of one body along a round wall.
const MOST_CUTS: usize = 256;

/// How bodies that touch are taken apart, so that their surfaces have no common point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Treatment {
    /// Every body is scaled about its centroid by a factor.
    Shrink(f64),
    /// Bodies nearer to another than a gap (m) are scaled about their centroids, as much as needed to leave it. All
    /// bodies must be convex.
    Gap(f64),
    /// Bodies nearer to another than a gap (m) lose a flat cap there, so that the gap is left. All bodies must be
    /// convex.
    Cap(f64),
}

/// The surfaces of the bodies that reach into a region, none cut by it.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetSurface {
    /// The triangles, all of the part [`SurfacePatch::Bodies`].
    pub surface: Surface,
    /// Bodies; here and below a body with its images is one.
    pub bodies: usize,
    /// Bodies that were changed.
    pub changed: usize,
    /// Bodies that reach beyond the region as changed.
    pub beyond: usize,
    /// Pairs of bodies that still overlap: of shrunken bodies only.
    pub overlapping: usize,
    /// Volume of the bodies as given, each whole, overlaps subtracted (m³).
    pub volume_before: f64,
    /// Volume of the bodies as changed (m³).
    pub volume: f64,
}

/// The largest factor of 0.99, 0.98, ... 0.9 with which [`Treatment::Shrink`] takes all bodies apart, and keeps them
/// within the upright sides of the region where those are walls; 0.9 if none does. Bodies may reach beyond its ends.
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::EmptyPack`].
pub fn shrink_factor(pack: &Pack, region: &Region, sides: Sides) -> Result<f64, AnalysisError> {
    let repeats = pack.repeats_over(region)?;
    let mut factor = 1.0;
    for step in 1..=10 {
        factor = 1.0 - 0.01 * f64::from(step);
        let found = facet_surface(pack, region, sides, Treatment::Shrink(factor))?;
        let mut corners = found.surface.vertices.iter();
        let is_within =
            sides == Sides::Open || corners.all(|p| side_distance(region, repeats, p) >= 0.0);
        if found.overlapping == 0 && is_within {
            break;
        }
    }
    Ok(factor)
}

/// The surfaces of the bodies that reach into a region, with their contacts treated. Where the sides are walls,
/// [`Treatment::Gap`] and [`Treatment::Cap`] leave the gap there, too: exactly at a flat wall, at least three
/// quarters of it at a round one after [`Treatment::Cap`].
///
/// # Errors
/// [`AnalysisError::Region`], [`AnalysisError::EmptyPack`], [`AnalysisError::Option`] for a factor outside 0.5 to
/// 1 or a gap that is not above zero and finite, [`AnalysisError::NotConvex`], [`AnalysisError::GapTooWide`].
pub fn facet_surface(
    pack: &Pack,
    region: &Region,
    sides: Sides,
    treatment: Treatment,
) -> Result<FacetSurface, AnalysisError> {
    region.validate()?;
    treatment.validate()?;
    if pack.is_empty() {
        return Err(AnalysisError::EmptyPack);
    }
    let repeats = pack.repeats_over(region)?;
    let (members, beyond): (Vec<usize>, Vec<usize>) =
        (0..pack.len()).partition(|&i| region.relation(pack.bounds(i)) != Relation::Outside);
    let sources: BTreeSet<usize> = members.iter().map(|&i| pack.source(i)).collect();
    let mut partners = members.clone();
    if repeats != [false; 3] {
        // An image beyond a side changes a body there as the body itself does at the other side.
        let images = beyond.into_iter();
        partners.extend(images.filter(|&i| sources.contains(&pack.source(i))));
    }
    let bodies: Vec<Vec<Point3>> =
        ordered_map(partners.len(), || (), |(), k| corners(pack, partners[k]));
    let walls = Walls {
        region,
        sides,
        repeats,
    };
    let mut found = FacetSurface {
        surface: Surface::default(),
        bodies: sources.len(),
        changed: 0,
        beyond: 0,
        overlapping: 0,
        volume_before: volume_of(pack, &members),
        volume: 0.0,
    };
    match treatment {
        Treatment::Shrink(factor) => {
            found.add_scaled(
                pack,
                region,
                &members,
                &bodies,
                &vec![factor; members.len()],
            );
            found.overlapping = overlapping(pack, &members, factor)?;
        }
        Treatment::Gap(gap) => {
            let gaps = Gaps::new(pack, &partners, members.len(), &bodies, gap)?;
            found.add_scaled(pack, region, &members, &bodies, &gaps.factors(&walls)?);
        }
        Treatment::Cap(gap) => {
            let cuts = Gaps::new(pack, &partners, members.len(), &bodies, gap)?.cuts(&walls);
            let wall = match (*region, sides) {
                (Region::Cylinder { centre, radius, .. }, Sides::Wall) => {
                    Some((centre, radius, gap))
                }
                _ => None,
            };
            found.add_cut(pack, region, &members, &cuts, wall);
        }
    }
    Ok(found)
}

impl Treatment {
    fn validate(self) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        match self {
            Self::Shrink(factor) if !(LEAST_FACTOR..=1.0).contains(&factor) => {
                refuse("factor", factor, "0.5 to 1")
            }
            Self::Gap(gap) | Self::Cap(gap) if !(gap > 0.0 && gap.is_finite()) => {
                refuse("gap", gap, "above zero and finite (m)")
            }
            _ => Ok(()),
        }
    }
}

/// Volume of some bodies, what pairs share counted once.
fn volume_of(pack: &Pack, members: &[usize]) -> f64 {
    let mut is_member = vec![false; pack.len()];
    for &i in members {
        is_member[i] = true;
    }
    let whole = |sum, &i: &usize| sum + pack.shape(i).mass_properties().volume;
    let all = members.iter().fold(0.0, whole);
    let shared = pair_overlaps(pack);
    let own = shared
        .pairs
        .iter()
        .filter(|pair| is_member[pair.first as usize] && is_member[pair.second as usize]);
    own.fold(all, |sum, pair| sum - pair.volume)
}

/// Pairs of bodies, each with its images, that overlap after scaling all by a factor about their centroids.
fn overlapping(pack: &Pack, members: &[usize], factor: f64) -> Result<usize, AnalysisError> {
    let scaled: Result<Vec<_>, _> = pack.shapes().iter().map(|s| s.scaled(factor)).collect();
    let Ok(shapes) = scaled else {
        // A shape at the limits of size; it cannot be smaller.
        return Ok(0);
    };
    let mut bodies = Vec::with_capacity(members.len());
    for &i in members {
        let mut body = pack.bodies()[i];
        body.pose = *pack.pose(i);
        let centroid = pack.shape(i).mass_properties().centroid.coords;
        // Scaling acts about the origin of the shape's frame.
        body.pose.translation.vector += body.pose.rotation * (centroid * (1.0 - factor));
        bodies.push(body);
    }
    let overlaps = pair_overlaps(&Pack::new(&shapes, &bodies)?);
    // Less is round-off of faces that merely touch.
    let counts = |volume: f64, body: usize| {
        volume > 1e-12 * pack.shape(members[body]).mass_properties().volume
    };
    let real = overlaps
        .pairs
        .iter()
        .filter(|pair| counts(pair.volume, pair.first as usize));
    let source = |body: u32| pack.source(members[body as usize]);
    let named = |pair: &PairOverlap| {
        let [a, b] = [pair.first, pair.second].map(source);
        [a.min(b), a.max(b)]
    };
    Ok(real.map(named).collect::<BTreeSet<_>>().len())
}

impl FacetSurface {
    fn add_scaled(
        &mut self,
        pack: &Pack,
        region: &Region,
        members: &[usize],
        bodies: &[Vec<Point3>],
        factors: &[f64],
    ) {
        let (mut changed, mut beyond) = (BTreeSet::new(), BTreeSet::new());
        for ((&i, corners), &factor) in members.iter().zip(bodies).zip(factors) {
            let centroid = pack.centroid(i);
            let first = self.surface.vertices.len() as u32;
            let scaled = corners.iter().map(|p| centroid + (p - centroid) * factor);
            self.surface.vertices.extend(scaled);
            let own = &self.surface.vertices[first as usize..];
            if own.iter().any(|p| !region.contains(p)) {
                beyond.insert(pack.source(i));
            }
            let triangles = pack.shape(i).triangles();
            let patches = triangles.iter().map(|_| SurfacePatch::Bodies);
            self.surface.patches.extend(patches);
            let shifted = triangles.iter().map(|t| t.map(|v| v + first));
            self.surface.triangles.extend(shifted);
            if factor < 1.0 {
                changed.insert(pack.source(i));
            }
            self.volume += factor.powi(3) * pack.shape(i).mass_properties().volume;
        }
        (self.changed, self.beyond) = (changed.len(), beyond.len());
    }

    /// Bodies cut by planes, and by a round wall about an axis, of a radius, to stay a gap from it.
    fn add_cut(
        &mut self,
        pack: &Pack,
        region: &Region,
        members: &[usize],
        cuts: &[Vec<(Vector3, f64)>],
        wall: Option<([f64; 2], f64, f64)>,
    ) {
        let (mut changed, mut beyond) = (BTreeSet::new(), BTreeSet::new());
        let mut clipper = Clipper::default();
        for (&i, cuts) in members.iter().zip(cuts) {
            clipper.load(pack.shape(i), pack.pose(i));
            for (normal, offset) in cuts {
                clipper.clip(normal, *offset);
            }
            let mut is_cut = !cuts.is_empty();
            if let Some((centre, radius, gap)) = wall {
                for _ in 0..MOST_CUTS {
                    let Some((normal, reach)) = farthest(&clipper, centre) else {
                        break;
                    };
                    if reach <= radius - 0.75 * gap {
                        break;
                    }
                    let axis = Vector3::new(centre[0], centre[1], 0.0);
                    clipper.clip(&normal, radius - gap + normal.dot(&axis));
                    is_cut = true;
                }
            }
            if is_cut {
                changed.insert(pack.source(i));
            }
            self.volume += clipper.volume();
            let mut leaves = false;
            clipper.each_triangle(|corners| {
                leaves |= corners.iter().any(|p| !region.contains(p));
                self.surface.push(corners, SurfacePatch::Bodies);
            });
            if leaves {
                beyond.insert(pack.source(i));
            }
        }
        (self.changed, self.beyond) = (changed.len(), beyond.len());
    }
}

/// Direction and distance from an upright axis of the corner farthest from it.
fn farthest(clipper: &Clipper, centre: [f64; 2]) -> Option<(Vector3, f64)> {
    let mut best: Option<(Vector3, f64)> = None;
    clipper.each_triangle(|corners| {
        for p in corners {
            let out = Vector3::new(p.x - centre[0], p.y - centre[1], 0.0);
            if best.is_none_or(|(_, reach)| out.norm() > reach) {
                best = Some((out, out.norm()));
            }
        }
    });
    best.and_then(|(out, reach)| Some((out.try_normalize(0.0)?, reach)))
}

/// Convex bodies nearer to each other than a gap.
struct Gaps<'a> {
    pack: &'a Pack<'a>,
    partners: &'a [usize],
    /// How many of the partners, the first ones, are changed; the others are images of them.
    members: usize,
    bodies: &'a [Vec<Point3>],
    gap: f64,
    /// Numbers among the partners, the first one of one that is changed, and how they lie.
    pairs: Vec<([usize; 2], Separation)>,
}

impl<'a> Gaps<'a> {
    fn new(
        pack: &'a Pack<'a>,
        partners: &'a [usize],
        members: usize,
        bodies: &'a [Vec<Point3>],
        gap: f64,
    ) -> Result<Self, AnalysisError> {
        if let Some(&body) = partners.iter().find(|&&i| !pack.shape(i).is_convex()) {
            return Err(AnalysisError::NotConvex {
                body: pack.source(body),
                what: "a gap between bodies",
                instead: "shrink all bodies, or bridge their contacts",
            });
        }
        let boxes: Vec<Aabb> = bodies
            .iter()
            .map(|corners| Aabb::of_points(corners.iter().copied()))
            .collect();
        let tree = Bvh::new(&boxes);
        let near = ordered_map(
            members,
            || (),
            |(), i| {
                let mut found = Vec::new();
                tree.query(&boxes[i].grown(gap), |j| {
                    if (j as usize) > i {
                        found.push(j as usize);
                    }
                });
                found.sort_unstable();
                let lie = |j: usize| {
                    let pair = [partners[i], partners[j]];
                    let separation = separation(pack, pair, [&bodies[i], &bodies[j]]);
                    ([i, j], separation)
                };
                let close = found.into_iter().map(lie);
                close.filter(|(_, s)| s.gap() < gap).collect::<Vec<_>>()
            },
        );
        Ok(Self {
            pack,
            partners,
            members,
            bodies,
            gap,
            pairs: near.into_iter().flatten().collect(),
        })
    }

    /// The factor of each body.
    fn factors(&self, walls: &Walls) -> Result<Vec<f64>, AnalysisError> {
        let centroid = |k: usize| self.pack.centroid(self.partners[k]);
        let mut factors = vec![1.0_f64; self.members];
        for ([i, j], separation) in &self.pairs {
            let apart = separation.normal.dot(&(centroid(*j) - centroid(*i)));
            let factor = (apart - self.gap) / (apart - separation.gap());
            for k in [*i, *j] {
                if let Some(least) = factors.get_mut(k) {
                    *least = least.min(factor);
                }
            }
        }
        for (k, factor) in factors.iter_mut().enumerate() {
            if walls.sides == Sides::Wall {
                let at_wall = walls.factor(&self.bodies[k], &centroid(k), self.gap);
                *factor = factor.min(at_wall);
            }
            if *factor < LEAST_FACTOR {
                return Err(AnalysisError::GapTooWide {
                    body: self.pack.source(self.partners[k]),
                    factor: *factor,
                    gap: self.gap,
                });
            }
        }
        Ok(factors)
    }

    /// The planes that each body is cut by, outward.
    fn cuts(&self, walls: &Walls) -> Vec<Vec<(Vector3, f64)>> {
        let mut cuts = vec![Vec::new(); self.members];
        for ([i, j], separation) in &self.pairs {
            let middle = 0.5 * (separation.begin + separation.end);
            let half = 0.5 * self.gap;
            cuts[*i].push((separation.normal, middle - half));
            if let Some(other) = cuts.get_mut(*j) {
                other.push((-separation.normal, -(middle + half)));
            }
        }
        if let (Region::Box { min, max }, Sides::Wall) = (walls.region, walls.sides) {
            for (corners, cuts) in self.bodies.iter().zip(&mut cuts) {
                for k in (0..2).filter(|&k| !walls.repeats[k]) {
                    let axis: Vector3 = Vector3::ith(k, 1.0);
                    for (normal, offset) in [(axis, max[k] - self.gap), (-axis, -min[k] - self.gap)]
                    {
                        if corners.iter().any(|p| normal.dot(&p.coords) > offset) {
                            cuts.push((normal, offset));
                        }
                    }
                }
            }
        }
        cuts
    }
}

/// The upright sides of a region.
struct Walls<'a> {
    region: &'a Region,
    sides: Sides,
    /// Axes along which it has none.
    repeats: [bool; 3],
}

impl Walls<'_> {
    /// The largest factor, at most 1, that keeps a body scaled about its centroid a gap from the sides.
    fn factor(&self, corners: &[Point3], centroid: &Point3, gap: f64) -> f64 {
        let mut factor = 1.0_f64;
        for corner in corners {
            let arm = corner - centroid;
            match *self.region {
                Region::Box { min, max } => {
                    for k in (0..2).filter(|&k| !self.repeats[k]) {
                        let room = if arm[k] > 0.0 {
                            max[k] - gap - centroid[k]
                        } else {
                            centroid[k] - gap - min[k]
                        };
                        if arm[k].abs() > room {
                            factor = factor.min(room / arm[k].abs());
                        }
                    }
                }
                Region::Cylinder { centre, radius, .. } => {
                    let out = [centroid.x - centre[0], centroid.y - centre[1]];
                    let square =
                        |s: f64| (out[0] + s * arm.x).powi(2) + (out[1] + s * arm.y).powi(2);
                    let limit = (radius - gap).max(0.0).powi(2);
                    if square(0.0) >= limit {
                        return 0.0;
                    }
                    if square(factor) > limit {
                        // The positive root of |out + s arm|² = limit.
                        let a = arm.x * arm.x + arm.y * arm.y;
                        let b = out[0] * arm.x + out[1] * arm.y;
                        let c = out[0] * out[0] + out[1] * out[1] - limit;
                        factor = ((b * b - a * c).sqrt() - b) / a;
                    }
                }
                Region::Sphere { .. } => {}
            }
        }
        factor
    }
}

#[cfg(test)]
mod tests {
    use femdem_mesh::Pose;
    use femdem_mesh::catalogue::CatalogueShape;

    use super::*;
    use crate::pack::PosedBody;

    /// Bodies that the ends of a slab cut need no smaller factor; some that reach into a wall by 0.019 m do.
    #[test]
    fn the_usual_factor_is_that_of_the_sides() {
        let cube: CatalogueShape = "P5".parse().unwrap();
        let shapes = [cube.polyhedron(3_f64.sqrt()).unwrap()];
        let slab = Region::Box {
            min: Point3::new(0.0, 0.0, 0.25),
            max: Point3::new(3.0, 3.0, 1.75),
        };
        let factor = |x: f64| {
            let bodies = [0.4, 1.5].map(|z| PosedBody {
                shape: 0,
                pose: Pose::translation(x, 1.5, z),
            });
            let pack = Pack::new(&shapes, &bodies).unwrap();
            shrink_factor(&pack, &slab, Sides::Wall).unwrap()
        };
        assert!((factor(1.5) - 0.99).abs() < 1e-12);
        assert!((factor(0.481) - 0.96).abs() < 1e-12);
    }
}
