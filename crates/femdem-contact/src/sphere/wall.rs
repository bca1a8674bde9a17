//! A ball and a wall of planes: the ball's field over the planes within it.

use super::disc::Disc;
use super::patch::{Face, Patch};
use super::sums::{FieldSums, SolidSums};
use crate::kernel::{Clipper, Cut, Line, Point};
use crate::walls::Wall;
use femdem_mesh::Vector3;
use smallvec::SmallVec;

/// The sums over the planes of a wall for a ball at `centre` in its axes; `None` if the ball does not reach the wall.
pub(super) fn patch(wall: &Wall, centre: &Vector3, radius: f64) -> Option<Patch> {
    let faces = wall.planes().iter().filter_map(|plane| {
        let distance = plane.normal.dot(centre) - plane.offset;
        (distance < radius).then(|| Face::new(plane.normal, -distance))
    });
    let faces: SmallVec<[Face; 4]> = faces.collect();
    let mut patch = Patch::default();
    for (k, face) in faces.iter().enumerate() {
        let Some(disc) = Disc::new(radius, face.height) else {
            continue;
        };
        let mut sums = (FieldSums::default(), SolidSums::default());
        let some = if faces.len() == 1 {
            disc.add_whole(&mut sums);
            true
        } else {
            let others = faces.iter().enumerate().filter(|(j, _)| *j != k);
            add_free(&disc, face, others.map(|(_, other)| other), &mut sums)
        };
        if some {
            patch.add_face(&disc, face, &sums.0, &sums.1);
        }
    }
    if faces.iter().any(|face| face.height > 0.0) {
        patch.add_centre(radius);
    }
    (!faces.is_empty()).then_some(patch)
}

/// Adds the part of a plane on the free sides of the others.
fn add_free<'a>(
    disc: &Disc,
    face: &Face,
    mut others: impl Iterator<Item = &'a Face>,
    sums: &mut (FieldSums, SolidSums),
) -> bool {
    let mut clipper = Clipper::default();
    let size = 2.0 * disc.square.sqrt();
    let corners = [(-size, -size), (size, -size), (size, size), (-size, size)];
    clipper.load(&corners.map(|(x, y)| Point { x, y }));
    let free = |other: &Face| Line {
        a: -other.normal.dot(&face.frame.e1),
        b: -other.normal.dot(&face.frame.e2),
        c: other.normal.dot(face.foot()) - other.height,
    };
    others.all(|other| clipper.cut(&free(other)) != Cut::Empty)
        && disc.add_polygon(clipper.polygon(), sums)
}
