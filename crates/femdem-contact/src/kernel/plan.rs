//! What one facet can meet in the other body's field: worked out once for many steps.
//!
//! While two bodies move relative to each other by less than a margin m, a point of the
//! facet that lies in the field body now was within m of where it is now in that body's
//! axes. So its depth under a plane differs by at most m, and the difference of the fields
//! of two planes by at most m times the difference of their gradients. The facet cut by all
//! planes moved outwards by m therefore holds every later polygon, and the values at its
//! corners tell which planes can cut it or own a gauge cell on it.

use super::candidates::{Candidates, ContactBox};
use super::clip::{Clipper, Cut, Line, Point};
use super::side::{BOX_FACES, FieldPlane};
use crate::shape::{ConvexShape, Facet};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// Planes that the bits of a plan can name, the faces of the contact box included.
const MOST_PLANES: usize = u64::BITS as usize;

/// Distances are compared with this much to spare, times the margin.
const HAIR: f64 = 1e-6;

/// A facet of the skin and the planes of the field that matter to it, a bit for each.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct FacetPlan {
    pub facet: u16,
    /// Planes that can cut the facet.
    pub cut: u64,
    /// Planes that can own a cell on it.
    pub own: u64,
}

/// One side of a contact: a body's field on the other's skin.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SidePlan {
    /// Planes of the field body.
    pub planes: SmallVec<[u16; 8]>,
    /// How many of the planes, the first ones, can cut.
    pub bounding: u16,
    /// Faces of the contact box that can cut, a bit for each. Their bits in the facets'
    /// plans follow those of the planes.
    pub box_faces: u8,
    /// Too many planes for bits: every plane and the box matter to every facet.
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

/// How far the polygons may move: along the field's planes, and along the box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Margins {
    pub field: f64,
    pub region: f64,
}

impl SidePlan {
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
        let mut plan = Self {
            planes: planes.planes.iter().copied().collect(),
            bounding: planes.bounding,
            box_faces: 0,
            general: posed.len() + BOX_FACES > MOST_PLANES,
            facets: SmallVec::new(),
        };
        if plan.general {
            let all = |&facet: &u16| FacetPlan {
                facet,
                cut: 0,
                own: 0,
            };
            plan.facets.extend(facets.iter().map(all));
            return plan;
        }
        let bounding = usize::from(planes.bounding);
        for &facet in facets {
            let place = Place {
                skin,
                facet: &skin.facets[usize::from(facet)],
                posed,
                region,
            };
            if let Some((cut, own)) = place.plan(bounding, margins, scratch) {
                plan.facets.push(FacetPlan { facet, cut, own });
            }
        }
        plan.compact(posed.len());
        plan
    }

    /// Leaves out the planes that no facet needs.
    fn compact(&mut self, planes: usize) {
        let used = self.facets.iter().fold(0, |set, f| set | f.cut | f.own);
        let is_used = |k: usize| used >> k & 1 == 1;
        let packed = |set: u64| {
            let mut out = 0;
            let mut bit = 1_u64;
            for k in 0..MOST_PLANES {
                if is_used(k) {
                    out |= if set >> k & 1 == 1 { bit } else { 0 };
                    bit = bit.wrapping_shl(1);
                }
            }
            out
        };
        for f in &mut self.facets {
            (f.cut, f.own) = (packed(f.cut), packed(f.own));
        }
        let all = usize::from(self.bounding);
        self.bounding = (0..all).filter(|&k| is_used(k)).count() as u16;
        let mut k = 0;
        self.planes.retain(|_| {
            k += 1;
            is_used(k - 1)
        });
        self.box_faces = (used >> planes) as u8;
    }
}

/// A facet among the planes of a field.
struct Place<'a> {
    skin: &'a ConvexShape,
    facet: &'a Facet,
    posed: &'a [FieldPlane],
    region: &'a ContactBox,
}

impl Place<'_> {
    fn box_face(&self, face: usize) -> Line {
        self.region.face(face).on(&self.facet.frame)
    }

    /// Planes that can cut and planes that can own; `None` if nothing of the facet can
    /// come to lie in the field.
    fn plan(
        &self,
        bounding: usize,
        margins: Margins,
        scratch: &mut PlanScratch,
    ) -> Option<(u64, u64)> {
        let PlanScratch {
            clipper,
            values,
            lowest,
        } = scratch;
        let frame = &self.facet.frame;
        clipper.load(self.skin.polygon(self.facet));
        for plane in &self.posed[..bounding] {
            let mut line = plane.on(frame);
            line.c += margins.field * plane.gradient.norm();
            if clipper.cut(&line) == Cut::Empty {
                return None;
            }
        }
        for face in 0..BOX_FACES {
            let mut line = self.box_face(face);
            line.c += margins.region;
            if clipper.cut(&line) == Cut::Empty {
                return None;
            }
        }
        let polygon = clipper.polygon();
        let mut cut = 0;
        values.clear();
        lowest.clear();
        lowest.resize(polygon.len(), f64::INFINITY);
        for (k, plane) in self.posed.iter().enumerate() {
            let line = plane.on(frame);
            let mut least = f64::INFINITY;
            for (p, low) in polygon.iter().zip(lowest.iter_mut()) {
                let v = line.at(p);
                least = least.min(v);
                *low = low.min(v);
                values.push(v);
            }
            let reach = margins.field * (1.0 + HAIR) * plane.gradient.norm();
            cut |= u64::from(k < bounding && least <= reach) << k;
        }
        let reach = margins.region + HAIR * margins.field;
        for face in 0..BOX_FACES {
            let line = self.box_face(face);
            let near = |p: &Point| line.at(p) <= reach;
            cut |= u64::from(polygon.iter().any(near)) << (self.posed.len() + face);
        }
        let rows = Rows {
            values,
            lowest,
            planes: self.posed,
        };
        Some((cut, rows.owners(margins.field * (1.0 + HAIR))))
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

    /// The planes that can be lowest somewhere: those that no plane, lowest at some corner
    /// now, stays below at all corners.
    fn owners(&self, margin: f64) -> u64 {
        let wins = |&k: &usize| {
            let mut pairs = self.row(k).iter().zip(self.lowest);
            pairs.any(|(v, low)| v <= low)
        };
        let winners: SmallVec<[usize; 8]> = (0..self.planes.len()).filter(wins).collect();
        let stays_below = |w: usize, k: usize| {
            let slope = (self.planes[k].gradient - self.planes[w].gradient).norm();
            let mut pairs = self.row(w).iter().zip(self.row(k));
            pairs.all(|(low, v)| v - low > margin * slope)
        };
        (0..self.planes.len())
            .filter(|&k| !winners.iter().any(|&w| w != k && stays_below(w, k)))
            .fold(0, |set, k| set | 1 << k)
    }
}
