//! The smallest box around a body, turned as it may be.

use std::collections::BTreeMap;

use femdem_mesh::{MeshError, Point3, Polyhedron, Vector3, convex_hull};

/// Directions that miss an arc by less than this are tried too: each gives a box that holds the body.
const ARC: f64 = 1e-9;

/// Sides \[m\] of the smallest box around points, rising.
///
/// A box is tried for each direction along which the hull is locally thinnest: normal to a face, or to two edges on
/// opposite sides; one of these has the least width of all (M. E. Houle and G. T. Toussaint, IEEE Trans. Pattern Anal.
/// Mach. Intell. 10 (1988) 761-765). The box lies between the two planes there, around the outline's rectangle of
/// smallest area, which has a side along an edge of the outline (H. Freeman and R. Shapira, Commun. ACM 18 (1975)
/// 409-413). The box of smallest volume is taken, the first of equal ones.
pub(super) fn sides(points: &[Point3]) -> Result<[f64; 3], MeshError> {
    let hull = convex_hull(points)?;
    let mut best: Option<([f64; 3], f64)> = None;
    for direction in thin_directions(&hull) {
        let sides = standing(hull.vertices(), &direction);
        let volume = sides.iter().product();
        if best.is_none_or(|(_, least)| volume < least) {
            best = Some((sides, volume));
        }
    }
    // A hull has faces, so that there is a box.
    let (mut sides, _) = best.ok_or(MeshError::TooFewPoints {
        points: points.len(),
    })?;
    sides.sort_by(f64::total_cmp);
    Ok(sides)
}

/// An edge of the hull, and the normals of its two faces.
struct Edge {
    along: Vector3,
    normals: [Vector3; 2],
}

/// Normals of the faces, and of the pairs of edges that two parallel planes can touch from outside.
fn thin_directions(hull: &Polyhedron) -> Vec<Vector3> {
    let mut directions: Vec<Vector3> = (0..hull.face_count())
        .map(|face| hull.face_normal(face))
        .collect();
    let edges = edges(hull);
    for (k, one) in edges.iter().enumerate() {
        for other in &edges[k + 1..] {
            let normal = one.along.cross(&other.along);
            let length = normal.norm();
            if length <= ARC {
                continue;
            }
            let normal = normal / length;
            let opposite = |n: Vector3| one.is_touched_along(&n) && other.is_touched_along(&(-n));
            if opposite(normal) || opposite(-normal) {
                directions.push(normal);
            }
        }
    }
    directions
}

fn edges(hull: &Polyhedron) -> Vec<Edge> {
    let mut faces_of: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (face, corners) in hull.faces().enumerate() {
        let next = corners.iter().cycle().skip(1);
        for (a, b) in corners.iter().zip(next) {
            let key = [*a.min(b), *a.max(b)];
            faces_of.entry(key).or_default().push(face);
        }
    }
    let vertex = |v: u32| hull.vertices()[v as usize];
    faces_of
        .into_iter()
        .filter_map(|([a, b], faces)| {
            let normals = [*faces.first()?, *faces.get(1)?].map(|face| hull.face_normal(face));
            let along = (vertex(b) - vertex(a)).normalize();
            Some(Edge { along, normals })
        })
        .collect()
}

impl Edge {
    /// Whether a plane with this outward normal, at right angles to the edge, touches the hull in the edge.
    fn is_touched_along(&self, normal: &Vector3) -> bool {
        let [a, b] = self.normals;
        let turn = a.cross(&b);
        normal.dot(&(a + b)) > 0.0
            && a.cross(normal).dot(&turn) >= -ARC
            && normal.cross(&b).dot(&turn) >= -ARC
    }
}

/// Sides of the smallest box around points with a face at right angles to a unit vector: height first.
fn standing(points: &[Point3], normal: &Vector3) -> [f64; 3] {
    let first = Vector3::ith(normal.iamin(), 1.0).cross(normal).normalize();
    let second = normal.cross(&first);
    let heights = points.iter().map(|p| normal.dot(&p.coords));
    let height = spread(heights);
    let flat: Vec<[f64; 2]> = points
        .iter()
        .map(|p| [first.dot(&p.coords), second.dot(&p.coords)])
        .collect();
    let outline = outline(flat);
    let mut best = [height, f64::INFINITY, f64::INFINITY];
    for (k, a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % outline.len()];
        let (x, y) = (b[0] - a[0], b[1] - a[1]);
        let length = x.hypot(y);
        if length <= 0.0 {
            continue;
        }
        let (x, y) = (x / length, y / length);
        let along = spread(outline.iter().map(|p| x * p[0] + y * p[1]));
        let across = spread(outline.iter().map(|p| x * p[1] - y * p[0]));
        if along * across < best[1] * best[2] {
            best = [height, along, across];
        }
    }
    best
}

fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    high - low
}

/// The convex outline of points in a plane, by the monotone chain of A. M. Andrew (Inf. Process. Lett. 9 (1979) 216-219).
fn outline(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b[0] - a[0]) * (p[1] - a[1]) <= (b[1] - a[1]) * (p[0] - a[0])
            {
                chain.pop();
            }
            chain.push(p);
        }
        // The last point is the first of the other half.
        chain.pop();
        chain
    };
    let mut whole = half(&mut points.iter().copied());
    whole.extend(half(&mut points.iter().rev().copied()));
    whole
}
