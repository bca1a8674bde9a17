//! The part of a plane-bounded wall near one body, as a solid for the general kernel.

use super::{Wall, WallPlane};
use crate::general::SolidWall;
use femdem_mesh::{Point3, TetMesh, Vector3};
use serde::{Deserialize, Serialize};

/// How far a body may move before its solid is rebuilt, over its radius.
const LASTS: f64 = 0.5;

/// Half-width of the part of the wall, over the body's radius.
const REACH: f64 = 2.0;

/// Points closer than this fraction of the body's radius are merged.
const SAME: f64 = 1e-9;

/// The part of a wall that a body can reach from its present position.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LocalSolid {
    /// Position of the body when this was built, in the wall's axes, m.
    centre: Option<Vector3>,
    /// The radius of that body, m.
    radius: f64,
    /// Built from the wall and `centre`; `None` if no plane is within reach.
    #[serde(skip)]
    solid: Option<Box<SolidWall>>,
    #[serde(skip)]
    made: bool,
}

impl LocalSolid {
    /// The wall near a body of `radius` at `x` (in the wall's axes), and whether the solid was rebuilt.
    pub fn near(&mut self, wall: &Wall, x: &Vector3, radius: f64) -> (Option<&SolidWall>, bool) {
        let fresh = !self.holds(x, radius);
        let centre = match self.centre {
            Some(c) if !fresh => c,
            _ => *x,
        };
        if fresh || !self.made {
            self.centre = Some(centre);
            self.radius = radius;
            self.solid = build(wall, &centre, radius).map(Box::new);
            self.made = true;
        }
        (self.solid.as_deref(), fresh)
    }

    /// Whether the stored part contains all of the wall that a body of `radius` at `x` can reach.
    pub fn holds(&self, x: &Vector3, radius: f64) -> bool {
        let stays = |c: &Vector3| (x - c).norm() <= LASTS * radius;
        radius == self.radius && self.centre.as_ref().is_some_and(stays)
    }
}

/// The solid behind the planes within reach of a body.
fn build(wall: &Wall, centre: &Vector3, radius: f64) -> Option<SolidWall> {
    let reach = REACH * radius;
    let near: Vec<WallPlane> = wall
        .planes()
        .iter()
        .map(|p| WallPlane {
            offset: p.offset - p.normal.dot(centre),
            ..*p
        })
        .filter(|p| -p.offset < reach)
        .collect();
    let mesh = match near.as_slice() {
        [] => None,
        [one] => half_space(one, reach),
        _ => shell(&near, reach, SAME * radius)
            .or_else(|| shell(&enclosed(&near, reach), reach, SAME * radius))
            .or_else(|| half_space(nearest(&near)?, reach)),
    }?;
    let back = mesh.points().iter().map(|p| p + centre).collect();
    let moved = TetMesh::new(back, mesh.tets().to_vec()).ok()?;
    Some(SolidWall::solid(&moved))
}

/// The planes together with the sides of a box out of the body's reach, which close the space between faces
/// that do not meet, as those of a slot.
fn enclosed(planes: &[WallPlane], reach: f64) -> Vec<WallPlane> {
    planes.iter().copied().chain(sides(reach)).collect()
}

/// The sides of a box of half-width 2 `reach`.
fn sides(reach: f64) -> impl Iterator<Item = WallPlane> {
    (0..6).map(move |i| {
        let mut normal = Vector3::zeros();
        normal[i / 2] = if i % 2 == 0 { 1.0 } else { -1.0 };
        WallPlane {
            normal,
            offset: -2.0 * reach,
        }
    })
}

/// The plane of which the body lies deepest on the wrong side.
fn nearest(planes: &[WallPlane]) -> Option<&WallPlane> {
    planes.iter().max_by(|a, b| a.offset.total_cmp(&b.offset))
}

/// One tetrahedron under a plane that contains the part of the ball of radius `reach` about the origin behind
/// the plane, and more.
fn half_space(plane: &WallPlane, reach: f64) -> Option<TetMesh> {
    let n = &plane.normal;
    let [_, e1, e2] = crate::axes::complete(n);
    let foot = n * plane.offset;
    // The inscribed circle of the triangle is 4 reach wide and the apex 4 reach deep.
    let size = 4.0 * reach;
    let half = 0.75_f64.sqrt() * size;
    let points = [
        foot + e1 * size,
        foot - e1 * (0.5 * size) + e2 * half,
        foot - e1 * (0.5 * size) - e2 * half,
        foot - n * size,
    ];
    let points = points.map(Point3::from).to_vec();
    TetMesh::new(points, vec![[0, 2, 1, 3]]).ok()
}

/// The shell around the free space that the planes leave of a box: over each face of the space a frustum that
/// widens away from a point inside.
fn shell(planes: &[WallPlane], reach: f64, same: f64) -> Option<TetMesh> {
    let inside = interior_point(planes, reach)?;
    let depth = |p: &WallPlane| p.normal.dot(&inside) - p.offset;
    let least = planes.iter().map(depth).fold(f64::INFINITY, f64::min);
    let widen = 1.0 + reach / least;
    let mut points: Vec<Vector3> = Vec::new();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for k in 0..planes.len() {
        let mut corners: Vec<u32> = face(planes, k, reach, same)
            .into_iter()
            .map(|x| weld(&mut points, x, same))
            .collect();
        corners.dedup();
        for i in 2..corners.len() {
            let t = [corners[0], corners[i - 1], corners[i]];
            if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
                triangles.push(t);
            }
        }
    }
    let count = points.len() as u32;
    let outer: Vec<Vector3> = points
        .iter()
        .map(|x| inside + (x - inside) * widen)
        .collect();
    points.extend(outer);
    let mut tets = Vec::with_capacity(3 * triangles.len());
    for mut t in triangles {
        t.sort_unstable();
        let [a, b, c] = t;
        let [u, v, w] = t.map(|i| i + count);
        for tet in [[a, b, c, w], [a, b, v, w], [a, u, v, w]] {
            let [p, q, r, s] = tet.map(|i| points[i as usize]);
            let volume = (q - p).dot(&(r - p).cross(&(s - p)));
            tets.push(if volume > 0.0 {
                tet
            } else {
                [tet[0], tet[2], tet[1], tet[3]]
            });
        }
    }
    TetMesh::new(points.into_iter().map(Point3::from).collect(), tets).ok()
}

/// A point in the free space, at a distance of half the reach from the planes where there is room.
fn interior_point(planes: &[WallPlane], reach: f64) -> Option<Vector3> {
    for share in [0.5, 0.1, 0.02] {
        let mut x = Vector3::zeros();
        for _ in 0..64 {
            let lack = |p: &WallPlane| share * reach - (p.normal.dot(&x) - p.offset);
            let (worst, by) = planes
                .iter()
                .map(|p| (p, lack(p)))
                .max_by(|a, b| a.1.total_cmp(&b.1))?;
            if by <= 1e-3 * share * reach {
                return Some(x);
            }
            x += worst.normal * by;
        }
    }
    None
}

/// The face of the free space on plane `k`, within a box of half-width 2 `reach`.
fn face(planes: &[WallPlane], k: usize, reach: f64, same: f64) -> Vec<Vector3> {
    let n = &planes[k].normal;
    let foot = n * planes[k].offset;
    let [_, e1, e2] = crate::axes::complete(n);
    let size = 8.0 * reach;
    let mut polygon = vec![
        foot + (e1 + e2) * size,
        foot + (e2 - e1) * size,
        foot - (e1 + e2) * size,
        foot + (e1 - e2) * size,
    ];
    let others = planes.iter().enumerate().filter(|(j, _)| *j != k);
    for plane in others.map(|(_, p)| *p).chain(sides(reach)) {
        polygon = clip(&polygon, &plane, same);
    }
    polygon
}

/// The part of a polygon on the free side of a plane.
fn clip(polygon: &[Vector3], plane: &WallPlane, same: f64) -> Vec<Vector3> {
    let height = |x: &Vector3| plane.normal.dot(x) - plane.offset;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, x) in polygon.iter().enumerate() {
        let y = &polygon[(i + 1) % polygon.len()];
        let (u, v) = (height(x), height(y));
        if u >= -same {
            kept.push(*x);
        }
        if (u < -same && v > same) || (u > same && v < -same) {
            kept.push(x + (y - x) * (u / (u - v)));
        }
    }
    kept
}

/// Index of a point; an earlier point within `same` is reused.
fn weld(points: &mut Vec<Vector3>, x: Vector3, same: f64) -> u32 {
    let known = points.iter().position(|p| (p - x).norm() <= 16.0 * same);
    let index = known.unwrap_or_else(|| {
        points.push(x);
        points.len() - 1
    });
    index as u32
}
