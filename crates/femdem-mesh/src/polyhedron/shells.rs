//! Several closed surfaces where there should be one: beside each other, or one inside another.

use super::bounding_box;
use super::topology::shell_of;
use crate::tet::{Triangles, Winding};
use crate::{MeshError, Point3};

/// Shells within the box of the largest one that are looked for inside it.
const MOST_TRIED: usize = 64;

/// Vertices of such a shell that must lie inside the largest one, spread over all.
const SAMPLES: usize = 64;

/// The error for a surface of several closed shells: [`MeshError::Hollow`] if the largest of them has another one
/// inside, else [`MeshError::Disconnected`]. Every edge must have two faces; coordinates must be finite.
pub(crate) fn refusal(points: &[Point3], faces: &[Vec<u32>]) -> MeshError {
    let shells = Shell::all(points, faces);
    let largest = shells
        .iter()
        .reduce(|a, b| if b.diagonal() > a.diagonal() { b } else { a });
    let inner = largest.and_then(|outer| {
        let within = |shell: &&Shell| {
            let above = |k: usize| shell.low[k] > outer.low[k] && shell.high[k] < outer.high[k];
            (0..3).all(above)
        };
        let inside = outer.inside(points, faces);
        let mut tried = shells.iter().filter(within).take(MOST_TRIED);
        tried.find(|shell| shell.samples(faces).all(|v| inside(&points[v as usize])))
    });
    match inner {
        Some(inner) => MeshError::Hollow {
            shells: shells.len(),
            face: inner.faces[0],
        },
        None => MeshError::Disconnected {
            components: shells.len(),
        },
    }
}

/// A closed part of the surface.
struct Shell {
    faces: Vec<usize>,
    low: Point3,
    high: Point3,
}

impl Shell {
    /// The shells in the order of their first faces.
    fn all(points: &[Point3], faces: &[Vec<u32>]) -> Vec<Self> {
        let root_of = shell_of(faces);
        let mut number_of = vec![usize::MAX; faces.len()];
        let mut members: Vec<Vec<usize>> = Vec::new();
        for (face, &root) in root_of.iter().enumerate() {
            if number_of[root] == usize::MAX {
                number_of[root] = members.len();
                members.push(Vec::new());
            }
            members[number_of[root]].push(face);
        }
        let shell = |members: Vec<usize>| {
            let corners = members.iter().flat_map(|&face| &faces[face]);
            let corners: Vec<Point3> = corners.map(|&v| points[v as usize]).collect();
            let (low, high) = bounding_box(&corners);
            Self {
                faces: members,
                low,
                high,
            }
        };
        members.into_iter().map(shell).collect()
    }

    fn diagonal(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// Whether a point lies inside, whichever way the faces look.
    fn inside(&self, points: &[Point3], faces: &[Vec<u32>]) -> impl Fn(&Point3) -> bool {
        // Where faces are not convex, triangles of a fan that look the other way cancel.
        let fan = |&face: &usize| {
            let corners = &faces[face];
            let at = |v: u32| points[v as usize];
            let pairs = corners[1..].windows(2);
            pairs.map(move |pair| [at(corners[0]), at(pair[0]), at(pair[1])])
        };
        let winding = Winding::new(&Triangles::new(self.faces.iter().flat_map(fan)));
        move |p| winding.number(p).abs() > 0.5
    }

    /// Some corners, spread evenly over all faces.
    fn samples<'a>(&'a self, faces: &'a [Vec<u32>]) -> impl Iterator<Item = u32> + 'a {
        let stride = self.faces.len().div_ceil(SAMPLES);
        self.faces
            .iter()
            .step_by(stride)
            .map(|&face| faces[face][0])
    }
}
