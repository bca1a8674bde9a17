//! Which planes and facets of two bodies can take part in their overlap.
//!
//! The overlap lies in a box aligned with the contact direction: between the supports
//! of the two bodies along it, and within the lateral extents of both slabs. Only
//! planes that can bound the overlap or own a gauge cell in it are kept. All bounds
//! are inflated by a margin, so that the lists stay valid while the bodies move
//! relative to each other by less than that margin.

use super::plane::FieldPlane;
use crate::axes::complete;
use crate::shape::{ConvexShape, Facet};
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

/// A box in A's axes: rows of `axes` are its directions, the first the contact direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ContactBox {
    pub axes: [Vector3; 3],
    pub centre: Vector3,
    pub half: Vector3,
}

impl ContactBox {
    /// A face of the box as a plane whose "field" is the depth below it, m.
    pub fn face(&self, face: usize) -> FieldPlane {
        let axis = face % 3;
        let outward = if face < 3 {
            self.axes[axis]
        } else {
            -self.axes[axis]
        };
        FieldPlane {
            gradient: outward,
            level: outward.dot(&self.centre) + self.half[axis],
        }
    }
}

/// A [`ContactBox`] in compact form for storage: the other two directions follow from the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct KeptBox {
    axis: Vector3,
    pub centre: Vector3,
    half: Vector3,
}

impl KeptBox {
    pub fn open(&self) -> ContactBox {
        ContactBox {
            axes: complete(&self.axis),
            centre: self.centre,
            half: self.half,
        }
    }
}

/// Valid for a box whose other directions are those that `complete` gives for the first.
impl From<&ContactBox> for KeptBox {
    fn from(region: &ContactBox) -> Self {
        Self {
            axis: region.axes[0],
            centre: region.centre,
            half: region.half,
        }
    }
}

/// Indices into a shape's planes and facets.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Candidates {
    pub planes: SmallVec<[u16; 10]>,
    /// The first `bounding` planes can cut; the others only own cells.
    pub bounding: u16,
    pub facets: SmallVec<[u16; 8]>,
}

/// Lateral extents of the part of a body beyond a level along the first axis.
struct Extents {
    low: [f64; 2],
    high: [f64; 2],
}

/// Extents of {x in shape: u(x) <= level}, with u, v, w the coordinates along three
/// directions given in the shape's own axes, relative to `origin` values.
fn extents_below(
    shape: &ConvexShape,
    directions: &[Vector3; 3],
    level: f64,
    heights: &mut Vec<f64>,
) -> Extents {
    heights.clear();
    heights.extend(shape.vertices().iter().map(|x| directions[0].dot(x)));
    let mut e = Extents {
        low: [f64::INFINITY; 2],
        high: [f64::NEG_INFINITY; 2],
    };
    let mut take = |x: &Vector3| {
        for k in 0..2 {
            let c = directions[k + 1].dot(x);
            e.low[k] = e.low[k].min(c);
            e.high[k] = e.high[k].max(c);
        }
    };
    for (x, u) in shape.vertices().iter().zip(heights.iter()) {
        if *u <= level {
            take(x);
        }
    }
    for edge in &shape.edges {
        let [i, j] = edge.map(usize::from);
        let (ui, uj) = (heights[i], heights[j]);
        if (ui <= level) != (uj <= level) {
            let t = (level - ui) / (uj - ui);
            take(&(shape.vertices()[i] + (shape.vertices()[j] - shape.vertices()[i]) * t));
        }
    }
    e
}

/// The box that holds every overlap of A and B while they move by less than `margin`;
/// `None` if there can be none. B is posed by `rotation`, `offset` in A's axes.
pub(crate) fn contact_box(
    a: &ConvexShape,
    b: &ConvexShape,
    rotation: &Matrix3,
    offset: &Vector3,
    axis: &Vector3,
    margin: f64,
    heights: &mut Vec<f64>,
) -> Option<ContactBox> {
    let axes = complete(axis);
    let in_b = axes.map(|d| rotation.tr_mul(&d));
    let shift = axes.map(|d| d.dot(offset));
    let top = a.support(axis);
    let bottom = shift[0] - b.support(&-in_b[0]) - margin;
    if bottom > top {
        return None;
    }
    let ea = extents_below(a, &axes.map(|d| -d), -bottom, heights);
    let eb = extents_below(b, &in_b, top + margin - shift[0], heights);
    let mut low = Vector3::new(bottom, 0.0, 0.0);
    let mut high = Vector3::new(top, 0.0, 0.0);
    for k in 0..2 {
        low[k + 1] = (-ea.high[k]).max(eb.low[k] + shift[k + 1] - margin);
        high[k + 1] = (-ea.low[k]).min(eb.high[k] + shift[k + 1] + margin);
    }
    // Slightly wider than needed, so that no true vertex of the overlap is cut off by the box.
    let hair = Vector3::repeat(1e-3 * margin);
    let half = (high - low) * 0.5 + hair;
    if half.min() <= 0.0 {
        return None;
    }
    let mid = (high + low) * 0.5;
    Some(ContactBox {
        axes,
        centre: axes[0] * mid[0] + axes[1] * mid[1] + axes[2] * mid[2],
        half,
    })
}

/// Planes of `shape` that bound the box's content or own a gauge cell there, the one
/// facing `towards` first, and facets that can meet the box. The box is given in the
/// shape's axes. `None` if the box lies outside a plane.
pub(crate) fn candidates(
    shape: &ConvexShape,
    region: &ContactBox,
    inflate: f64,
    towards: &Vector3,
) -> Option<Candidates> {
    let half = region.half.add_scalar(inflate);
    let bounds = |k: usize| {
        let p = &shape.planes[k];
        let mid = p.gauge.dot(&region.centre);
        let along = |i: usize| half[i] * p.gauge.dot(&region.axes[i]).abs();
        let reach = along(0) + along(1) + along(2);
        (mid - reach, mid + reach)
    };
    // A cell of the gauge is the region where its plane has the largest gauge.
    let all: SmallVec<[(f64, f64); 64]> = (0..shape.planes.len()).map(bounds).collect();
    let floor = all.iter().map(|b| b.0).fold(f64::NEG_INFINITY, f64::max);
    if floor >= 1.0 {
        return None;
    }
    let mut list = Candidates::default();
    let mut kept: SmallVec<[(bool, f64, u16); 32]> = SmallVec::new();
    for (k, (plane, &(_, high))) in shape.planes.iter().zip(&all).enumerate() {
        if high >= floor {
            kept.push((high < 1.0, -plane.normal.dot(towards), k as u16));
        }
    }
    kept.sort_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)).then(x.2.cmp(&y.2)));
    list.planes.extend(kept.iter().map(|x| x.2));
    list.bounding = kept.iter().filter(|x| !x.0).count() as u16;
    for (i, facet) in shape.facets.iter().enumerate() {
        let (low, high) = all[usize::from(facet.plane)];
        if low <= 1.0 && high >= 1.0 && meets(shape, facet, region, &half) {
            list.facets.push(i as u16);
        }
    }
    Some(list)
}

/// Whether the facet's extents along the box axes reach into the box.
fn meets(shape: &ConvexShape, facet: &Facet, region: &ContactBox, half: &Vector3) -> bool {
    let from = facet.frame.origin - region.centre;
    (0..3).all(|k| {
        let axis = &region.axes[k];
        let (a, b) = (axis.dot(&facet.frame.e1), axis.dot(&facet.frame.e2));
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in shape.polygon(facet) {
            let c = a * p.x + b * p.y;
            low = low.min(c);
            high = high.max(c);
        }
        let base = axis.dot(&from);
        base + low <= half[k] && base + high >= -half[k]
    })
}
