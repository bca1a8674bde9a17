//! The planes of the field body, restricted to the plane of a facet, for any number of planes.

use super::clip::{Clipper, Cut, Line, Point};
use super::plane::FieldPlane;
use crate::shape::PlaneFrame;
use femdem_mesh::Vector3;

/// Planes that pass the field's centre at less than this fraction of the field body's inradius are too close to the
/// singular point of the [`Brackets`](super::clip::Brackets).
pub(crate) const CLOSE: f64 = 1e-3;

/// Round-off of phi; choosing a wrong owner within it changes nothing.
pub(crate) const TIE: f64 = 1e-15;

/// Fields linear over a facet: phi_k = c_k - a_k x - b_k y.
#[derive(Debug)]
pub(crate) struct PlaneField<'a> {
    planes: &'a [FieldPlane],
    lines: Vec<Line>,
    /// Values of all lines at all vertices, line by line.
    values: Vec<f64>,
    lowest: Vec<f64>,
}

impl<'a> PlaneField<'a> {
    pub(crate) fn new(planes: &'a [FieldPlane]) -> Self {
        Self {
            planes,
            lines: Vec::with_capacity(planes.len()),
            values: Vec::new(),
            lowest: Vec::new(),
        }
    }

    /// Moves to the plane of a facet.
    pub(crate) fn place(&mut self, frame: &PlaneFrame) {
        self.lines.clear();
        self.lines.extend(self.planes.iter().map(|p| p.on(frame)));
    }

    /// phi of plane `k` on the present facet.
    pub(crate) fn line(&self, k: usize) -> Line {
        self.lines[k]
    }

    /// Stiffness weight of plane `k` for a facet with unit normal `n`.
    pub(crate) fn weight(&self, k: usize, n: &Vector3) -> f64 {
        self.planes[k].weight(n)
    }

    /// The planes that can be lowest somewhere on the polygon; exactly one if one is lowest
    /// at every vertex.
    pub(crate) fn competitors(&mut self, polygon: &[Point], out: &mut Vec<usize>) {
        out.clear();
        self.values.clear();
        self.lowest.clear();
        self.lowest.resize(polygon.len(), f64::INFINITY);
        for line in &self.lines {
            for (p, low) in polygon.iter().zip(&mut self.lowest) {
                let v = line.at(p);
                *low = low.min(v);
                self.values.push(v);
            }
        }
        let rows = || self.values.chunks_exact(polygon.len());
        let lowest_at = |v: &f64, low: &f64| *v <= low + TIE;
        for (k, row) in rows().enumerate() {
            let mut wins = row.iter().zip(&self.lowest).map(|(v, l)| lowest_at(v, l));
            if wins.clone().all(|w| w) {
                out.clear();
                out.push(k);
                return;
            }
            if wins.any(|w| w) {
                out.push(k);
            }
        }
        let winners = out.len();
        for (k, row) in rows().enumerate() {
            let undercut = out[..winners].iter().any(|&w| {
                let other = &self.values[w * polygon.len()..(w + 1) * polygon.len()];
                other.iter().zip(row).all(|(o, v)| o <= v)
            });
            if !undercut {
                out.push(k);
            }
        }
    }
}

/// Cuts the polygon in the clipper by the planes that bound the field.
pub(crate) fn cut_by_field(clipper: &mut Clipper, field: &PlaneField, bounding: usize) -> bool {
    (0..bounding).all(|k| clipper.cut(&field.line(k)) != Cut::Empty)
}
