//! Level sections of a solid, and the volume of its hollow.

use std::collections::BTreeMap;

use femdem_mesh::Polyhedron;

use crate::ordered::ordered_map;

/// Largest number of slabs between heights of vertices; with more vertices the slabs are equally high.
const MOST_SLABS: usize = 4096;

/// Nodes of Gauss's rule with two points, from the middle of an interval, over its half width.
const GAUSS: f64 = 0.577_350_269_189_625_8;

type Place = [f64; 2];
type Edge = (u32, u32);

/// Volume (m³) between two heights that a solid encloses sideways without being there itself.
///
/// Areas of level sections are quadratic functions of the height between the heights of the vertices, so that two
/// points integrate them exactly.
pub(super) fn hollow_volume(solid: &Polyhedron, low: f64, high: f64) -> f64 {
    let mut heights: Vec<f64> = solid.vertices().iter().map(|v| v.z).collect();
    heights.retain(|z| low < *z && *z < high);
    heights.extend([low, high]);
    heights.sort_unstable_by(f64::total_cmp);
    // Heights that differ by round-off would only make empty slabs.
    let least = 1e-12 * (high - low);
    heights.dedup_by(|next, before| *next - *before <= least);
    if heights.len() > MOST_SLABS {
        let at = |k: usize| low + (high - low) * (k as f64 / MOST_SLABS as f64);
        heights = (0..=MOST_SLABS).map(at).collect();
    }
    let triangles = solid.triangles();
    let slabs = ordered_map(
        heights.len() - 1,
        || (),
        |(), k| {
            let (middle, half) = (
                0.5 * (heights[k] + heights[k + 1]),
                0.5 * (heights[k + 1] - heights[k]),
            );
            let ends = [-GAUSS, GAUSS].map(|at| hollow_area(solid, &triangles, middle + half * at));
            half * (ends[0] + ends[1])
        },
    );
    slabs.iter().fold(0.0, |sum, slab| sum + slab)
}

/// Area (m²) within the outermost borders of a level section that is not solid.
fn hollow_area(solid: &Polyhedron, triangles: &[[u32; 3]], z: f64) -> f64 {
    let borders = borders(solid, triangles, z);
    let areas: Vec<f64> = borders.iter().map(|border| area(border)).collect();
    let mut hollow = 0.0;
    for (i, border) in borders.iter().enumerate() {
        let within = |(j, other): (usize, &Vec<Place>)| j != i && holds(other, border[0]);
        if !borders.iter().enumerate().any(within) {
            hollow += areas[i];
        }
        hollow -= areas[i];
    }
    hollow
}

/// Borders of the section, with the solid on their left.
fn borders(solid: &Polyhedron, triangles: &[[u32; 3]], z: f64) -> Vec<Vec<Place>> {
    let height = |v: u32| solid.vertices()[v as usize].z;
    // Where the border crosses a triangle: from the edge on which the triangle goes down to that on which it goes up,
    // which is the edge on which the next triangle goes down.
    let mut next: BTreeMap<Edge, Vec<Edge>> = BTreeMap::new();
    for triangle in triangles {
        let (mut down, mut up) = (None, None);
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let edge = (a.min(b), a.max(b));
            match (height(a) > z, height(b) > z) {
                (true, false) => down = Some(edge),
                (false, true) => up = Some(edge),
                _ => {}
            }
        }
        if let (Some(down), Some(up)) = (down, up) {
            next.entry(down).or_default().push(up);
        }
    }
    let place = |(a, b): Edge| {
        let [p, q] = [a, b].map(|v| &solid.vertices()[v as usize]);
        let at = p + (q - p) * ((z - p.z) / (q.z - p.z));
        [at.x, at.y]
    };
    let mut borders = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let mut border = Vec::new();
        let mut at = start;
        // A closed surface leads back to the start.
        while let Some(ways) = next.get_mut(&at) {
            border.push(place(at));
            let way = ways.pop();
            if ways.is_empty() {
                next.remove(&at);
            }
            match way {
                Some(way) if way != start => at = way,
                _ => break,
            }
        }
        borders.push(border);
    }
    borders
}

/// Signed area of a polygon, positive if it runs counter-clockwise (m²).
fn area(polygon: &[Place]) -> f64 {
    let [x, y] = polygon[0];
    let from = |p: &Place| [p[0] - x, p[1] - y];
    let twice = polygon.windows(2).map(|side| {
        let [p, q] = [from(&side[0]), from(&side[1])];
        p[0] * q[1] - p[1] * q[0]
    });
    0.5 * twice.sum::<f64>()
}

/// Whether a polygon contains a point, by the crossings of a line along x.
fn holds(polygon: &[Place], [x, y]: Place) -> bool {
    let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = ends.filter(|(p, q)| {
        (p[1] > y) != (q[1] > y) && x < p[0] + (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1])
    });
    crossed.count() % 2 == 1
}
