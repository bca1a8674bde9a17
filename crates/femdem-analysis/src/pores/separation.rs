//! The direction in which two convex bodies lie farthest apart.

use femdem_mesh::{Point3, Vector3};

use crate::pack::Pack;

/// First and last angle (rad) by which directions are turned in search of a better one.
const ANGLES: [f64; 2] = [0.25, 1e-6];

/// How two bodies lie along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Separation {
    /// Unit vector from the first body to the second.
    pub(super) normal: Vector3,
    /// Farthest the first body reaches along it.
    pub(super) end: f64,
    /// Where the second begins.
    pub(super) begin: f64,
}

impl Separation {
    /// Width of the slab between the two (m), negative where they overlap. The bodies are at least as far apart.
    pub(super) fn gap(&self) -> f64 {
        self.begin - self.end
    }
}

/// Corners of a body in the world frame.
pub(super) fn corners(pack: &Pack, body: usize) -> Vec<Point3> {
    let pose = pack.pose(body);
    pack.shape(body)
        .vertices()
        .iter()
        .map(|v| pose * v)
        .collect()
}

/// A direction in which two convex bodies have a wide slab between them, or overlap little: the best of the line of
/// centroids and the normals of all faces, turned until no turn by 1e-6 improves it. Any direction shows a lower
/// bound of the distance; this one is close to it.
pub(super) fn separation(pack: &Pack, pair: [usize; 2], all: [&[Point3]; 2]) -> Separation {
    let along = |normal: Vector3| {
        let reach = |p: &Point3| normal.dot(&p.coords);
        Separation {
            normal,
            end: all[0].iter().map(reach).fold(f64::NEG_INFINITY, f64::max),
            begin: all[1].iter().map(reach).fold(f64::INFINITY, f64::min),
        }
    };
    let [first, second] = pair;
    let line = pack.centroid(second) - pack.centroid(first);
    let mut best = along(line.try_normalize(0.0).unwrap_or(Vector3::z()));
    let mut try_all = |normals: &mut dyn Iterator<Item = Vector3>| {
        for normal in normals {
            let found = along(normal);
            if found.gap() > best.gap() {
                best = found;
            }
        }
    };
    // Of bodies with many faces the line is a good start.
    if pack.by_planes(first) {
        try_all(&mut pack.world_planes(first).map(|(normal, _)| normal));
    }
    if pack.by_planes(second) {
        try_all(&mut pack.world_planes(second).map(|(normal, _)| -normal));
    }
    let mut angle = ANGLES[0];
    while angle > ANGLES[1] {
        let [u, v] = across(&best.normal);
        let turns = [u, v, -u, -v, u + v, u - v, v - u, -u - v];
        let better = turns
            .into_iter()
            .filter_map(|turn| (best.normal + turn * angle).try_normalize(0.0))
            .map(along)
            .find(|found| found.gap() > best.gap());
        match better {
            Some(found) => best = found,
            None => angle *= 0.5,
        }
    }
    best
}

/// Two unit vectors at right angles to a unit vector and to each other.
fn across(normal: &Vector3) -> [Vector3; 2] {
    let axis = Vector3::ith(normal.iamin(), 1.0);
    let u = normal.cross(&axis).normalize();
    [u, normal.cross(&u)]
}
