//! Plans: what a facet can meet in the other body's field, computed once for many steps.
//!
//! Consider a point of the facet that lies in the field body at some later time. While two bodies move
//! relative to each other by less than a margin m, its position in that body's axes is now within m of the
//! later one. So its depth under a plane differs by at most m, and the difference of the fields of two planes
//! by at most m times the difference of their gradients. The facet cut by all planes moved outwards by m
//! therefore contains every later polygon, and the values at its corners determine which planes can cut it or
//! own a gauge cell on it.

use super::candidates::{Candidates, ContactBox};
use super::clip::{Clipper, Cut, Point};
use super::plane::FieldPlane;
use super::region::BOX_FACES;
use crate::shape::{ConvexShape, PlaneFrame};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// Largest number of planes in a plan, one bit each; the faces of the contact box count too.
pub(crate) const MOST_PLANES: usize = u64::BITS as usize;

/// Tolerance of comparisons of distances, times the margin.
const HAIR: f64 = 1e-6;

/// A facet of the skin and the planes of the field that matter to it: a [`Reach`] in half the memory.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct FacetPlan {
    pub facet: u16,
    main: u8,
    cut: u32,
    own: u32,
}

impl FacetPlan {
    /// A plan in which every plane matters.
    fn general(facet: u16) -> Self {
        Self {
            facet,
            main: 0,
            cut: 0,
            own: 0,
        }
    }

    #[inline]
    pub fn reach(&self) -> Reach {
        Reach {
            main: self.main,
            cut: self.cut.into(),
            own: self.own.into(),
        }
    }
}

/// The planes of a field that matter to a polygon, a bit for each.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Reach {
    /// The plane that is lowest in the middle of the polygon.
    pub main: u8,
    /// Planes that can cut the polygon.
    pub cut: u64,
    /// Planes that can own a cell on it.
    pub own: u64,
}

/// One side of a contact: a body's field on the other's skin.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SidePlan {
    /// Planes of the field body.
    pub planes: SmallVec<[u16; 8]>,
    /// The first `bounding` planes can cut.
    pub bounding: u16,
    /// Faces of the contact box that can cut, a bit for each. Their bits in the facets'
    /// plans follow those of the planes.
    pub box_faces: u8,
    /// Too many planes for the bits: every plane and the box matter to every facet.
    pub general: bool,
    pub facets: SmallVec<[FacetPlan; 4]>,
}

/// Buffers of the planning.
#[derive(Debug, Default)]
pub(crate) struct PlanScratch {
    clipper: Clipper,
    values: Vec<f64>,
    lowest: Vec<f64>,
}

/// How far the polygons may move relative to the field's planes and relative to the box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Margins {
    pub field: f64,
    pub region: f64,
}

/// Whether all `indices` are below `count`.
pub(super) fn below(indices: &[u16], count: usize) -> bool {
    indices.iter().all(|&i| usize::from(i) < count)
}

impl SidePlan {
    /// Whether the planes and facets that it names are there.
    pub(super) fn fits(&self, field: &ConvexShape, skin: &ConvexShape) -> bool {
        let count = skin.facets.len();
        below(&self.planes, field.planes.len())
            && self.facets.iter().all(|f| usize::from(f.facet) < count)
    }

    /// The plan of `skin` (its facets, in its axes) in a field. `planes` are the candidates
    /// of the field body, `posed` the same in the skin's axes; so is `region`.
    pub(crate) fn new(
        skin: &ConvexShape,
        facets: &[u16],
        planes: &Candidates,
        posed: &[FieldPlane],
        region: &ContactBox,
        margins: Margins,
        scratch: &mut PlanScratch,
    ) -> Self {
        if posed.len() + BOX_FACES > MOST_PLANES {
            return Self::general(facets, planes);
        }
        let mut reaches: SmallVec<[(u16, Reach); 16]> = SmallVec::new();
        for &facet in facets {
            let place = Place {
                corners: skin.polygon(&skin.facets[usize::from(facet)]),
                frame: &skin.facets[usize::from(facet)].frame,
                posed,
                bounding: usize::from(planes.bounding),
            };
            if let Some(reach) = place.plan(Some(region), margins, scratch) {
                reaches.push((facet, reach));
            }
        }
        Self::compact(&reaches, planes, posed.len())
            .unwrap_or_else(|| Self::general(facets, planes))
    }

    /// The plan that excludes nothing.
    pub(crate) fn general(facets: &[u16], planes: &Candidates) -> Self {
        Self {
            planes: planes.planes.iter().copied().collect(),
            bounding: planes.bounding,
            box_faces: 0,
            general: true,
            facets: facets.iter().map(|&f| FacetPlan::general(f)).collect(),
        }
    }

    /// The plan without the planes that no facet needs; `None` if more planes are needed than there are bits.
    fn compact(reaches: &[(u16, Reach)], list: &Candidates, planes: usize) -> Option<Self> {
        let used = reaches.iter().fold(0, |set, (_, r)| set | r.cut | r.own);
        if used.count_ones() > u32::BITS {
            return None;
        }
        let is_used = |k: usize| used >> k & 1 == 1;
        let packed = |set: u64| {
            let mut out = 0;
            let mut bit = 1_u32;
            for k in 0..MOST_PLANES {
                if is_used(k) {
                    out |= if set >> k & 1 == 1 { bit } else { 0 };
                    bit = bit.wrapping_shl(1);
                }
            }
            out
        };
        let facets = reaches.iter().map(|&(facet, reach)| FacetPlan {
            facet,
            main: packed(1 << reach.main).trailing_zeros() as u8,
            cut: packed(reach.cut),
            own: packed(reach.own),
        });
        let mut kept = list.planes.clone();
        let mut k = 0;
        kept.retain(|_| {
            k += 1;
            is_used(k - 1)
        });
        Some(Self {
            planes: SmallVec::from_slice(&kept),
            bounding: (0..usize::from(list.bounding))
                .filter(|&k| is_used(k))
                .count() as u16,
            box_faces: (used >> planes) as u8,
            general: false,
            facets: facets.collect(),
        })
    }
}

/// A polygon among the planes of a field; the first `bounding` of them can cut.
pub(crate) struct Place<'a> {
    pub corners: &'a [Point],
    pub frame: &'a PlaneFrame,
    pub posed: &'a [FieldPlane],
    pub bounding: usize,
}

impl Place<'_> {
    /// Planes that can cut and planes that can own a cell while the polygon moves by less than the margins;
    /// `None` if no part of it can come to lie in the field. Without a region, only the field bounds it.
    pub(crate) fn plan(
        &self,
        region: Option<&ContactBox>,
        margins: Margins,
        scratch: &mut PlanScratch,
    ) -> Option<Reach> {
        let PlanScratch {
            clipper,
            values,
            lowest,
        } = scratch;
        clipper.load(self.corners);
        for plane in &self.posed[..self.bounding] {
            let mut line = plane.on(self.frame);
            line.c += margins.field * plane.gradient.norm();
            if clipper.cut(&line) == Cut::Empty {
                return None;
            }
        }
        let mut cut = 0;
        if let Some(region) = region {
            cut = self.plan_region(region, margins, clipper)? << self.posed.len();
        }
        let polygon = clipper.polygon();
        values.clear();
        lowest.clear();
        lowest.resize(polygon.len(), f64::INFINITY);
        let margin = margins.field * (1.0 + HAIR);
        for (k, plane) in self.posed.iter().enumerate() {
            let line = plane.on(self.frame);
            let mut least = f64::INFINITY;
            for (p, low) in polygon.iter().zip(lowest.iter_mut()) {
                let v = line.at(p);
                least = if v < least { v } else { least };
                *low = if v < *low { v } else { *low };
                values.push(v);
            }
            let near = k < self.bounding && least <= margin * plane.gradient.norm();
            cut |= u64::from(near) << k;
        }
        let rows = Rows {
            values,
            lowest,
            planes: self.posed,
        };
        let own = rows.owners(margin);
        let main = rows.lowest_amid(own);
        Some(Reach { main, cut, own })
    }

    /// Cuts by the region, and the faces of it that can cut later; `None` if nothing is left.
    fn plan_region(
        &self,
        region: &ContactBox,
        margins: Margins,
        clipper: &mut Clipper,
    ) -> Option<u64> {
        let reach = margins.region + HAIR * margins.field;
        let mut set = 0;
        for face in 0..BOX_FACES {
            let mut line = region.face(face).on(self.frame);
            let near = |p: &Point| line.at(p) <= reach;
            if clipper.polygon().iter().any(near) {
                set |= 1 << face;
                line.c += margins.region;
                if clipper.cut(&line) == Cut::Empty {
                    return None;
                }
            }
        }
        Some(set)
    }
}

/// Fields of all planes at the corners of a polygon, plane by plane.
struct Rows<'a> {
    values: &'a [f64],
    lowest: &'a [f64],
    planes: &'a [FieldPlane],
}

impl Rows<'_> {
    fn row(&self, k: usize) -> &[f64] {
        let n = self.lowest.len();
        &self.values[k * n..(k + 1) * n]
    }

    /// The plane of `own` that is lowest at the mean of the corners.
    fn lowest_amid(&self, own: u64) -> u8 {
        let mut best = (f64::INFINITY, 0);
        for k in (0..self.planes.len()).filter(|&k| own >> k & 1 == 1) {
            let sum = self.row(k).iter().sum();
            best = if sum < best.0 { (sum, k as u8) } else { best };
        }
        best.1
    }

    /// The planes that can be lowest somewhere: those that no plane, lowest at some corner
    /// now, stays below at all corners.
    fn owners(&self, margin: f64) -> u64 {
        let wins = |&k: &usize| {
            let mut pairs = self.row(k).iter().zip(self.lowest);
            pairs.any(|(v, low)| v <= low)
        };
        let winners: SmallVec<[usize; 8]> = (0..self.planes.len()).filter(wins).collect();
        let stays_below = |w: usize, k: usize| {
            let gap = self
                .row(w)
                .iter()
                .zip(self.row(k))
                .fold(f64::INFINITY, |gap, (low, v)| gap.min(v - low));
            let slope = self.planes[k].gradient - self.planes[w].gradient;
            gap > 0.0 && gap * gap > margin * margin * slope.norm_squared()
        };
        (0..self.planes.len())
            .filter(|&k| !winners.iter().any(|&w| w != k && stays_below(w, k)))
            .fold(0, |set, k| set | 1 << k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(main: u8, cut: u64, own: u64) -> Reach {
        Reach { main, cut, own }
    }

    #[test]
    fn a_plan_names_the_planes_it_needs_and_no_more_than_it_has_bits() {
        let list = Candidates {
            planes: (0..40).map(|k| 100 + k).collect(),
            bounding: 39,
            facets: SmallVec::from_slice(&[7, 8]),
        };
        // Plane 39 only owns; the bit after the planes is a face of the box.
        let reaches = [
            (7, reach(39, 1 << 3 | 1 << 40, 1 << 39)),
            (8, reach(3, 0, 1 << 3)),
        ];
        let plan = SidePlan::compact(&reaches, &list, 40).unwrap();
        assert_eq!(plan.planes.as_slice(), [103, 139]);
        assert_eq!((plan.bounding, plan.box_faces), (1, 1));
        assert_eq!(plan.facets[0].reach(), reach(1, 0b101, 0b10));
        assert_eq!(plan.facets[1].reach(), reach(0, 0, 1));

        let first = |planes: u32| [(7, reach(0, (1 << planes) - 1, 1))];
        let all = SidePlan::compact(&first(32), &list, 40).unwrap();
        assert_eq!(all.facets[0].reach(), first(32)[0].1);
        assert_eq!(SidePlan::compact(&first(33), &list, 40), None);
    }
}
