//! Equal parts of a region that cut across all bins of a profile: the blocks of its bootstrap.

use std::f64::consts::TAU;

use femdem_mesh::{Point3, Vector3};

use super::nest::Direction;
use crate::bounds::Bounds;
use crate::region::Region;

/// Half-spaces `normal · x <= offset` whose intersection is a block.
pub(super) type Sector = Vec<(Vector3, f64)>;

/// Equal blocks of width `side` or more that each have the same part of every bin: columns of a box (at most 8
/// by 8) for bins stacked on one another, slices along z of a box for nested bins (at most 64), wedges of a
/// cylinder (at most 64). One block without planes if there is no room for two.
pub(super) fn sectors(region: &Region, direction: Direction, side: f64) -> Vec<Sector> {
    // Round-off in an extent that is a whole multiple of the side must not cost a block.
    let parts = |extent: f64, most: f64| (extent / side + 1e-9).floor().clamp(1.0, most) as usize;
    let (min, max) = region.corners();
    match *region {
        Region::Box { .. } => {
            let axes: &[usize] = match direction {
                Direction::Up => &[0, 1],
                Direction::Inwards => &[2],
            };
            let most = if axes.len() == 1 { 64.0 } else { 8.0 };
            let mut blocks = vec![Sector::new()];
            for &k in axes {
                let cuts = parts(max[k] - min[k], most);
                let width = (max[k] - min[k]) / cuts as f64;
                let slices = (0..cuts).map(|i| slice(k, min[k], width, i, cuts));
                blocks = slices
                    .flat_map(|slice| blocks.iter().map(move |b| [b.as_slice(), &slice].concat()))
                    .collect();
            }
            blocks
        }
        Region::Cylinder { centre, radius, .. } => {
            let count = parts(TAU * radius, 64.0);
            let centre = Vector3::new(centre[0], centre[1], 0.0);
            (0..count).map(|i| wedge(&centre, i, count)).collect()
        }
        Region::Sphere { .. } => vec![Sector::new()],
    }
}

/// The slice `i` of `count` along axis `k`; the outermost are open, so that all of space is in a slice.
fn slice(k: usize, low: f64, width: f64, i: usize, count: usize) -> Sector {
    let mut axis = Vector3::zeros();
    axis[k] = 1.0;
    let mut planes = Sector::new();
    if i > 0 {
        planes.push((-axis, -(low + width * i as f64)));
    }
    if i + 1 < count {
        planes.push((axis, low + width * (i + 1) as f64));
    }
    planes
}

/// The wedge `i` of `count` about the upright line through `centre`.
fn wedge(centre: &Vector3, i: usize, count: usize) -> Sector {
    if count < 2 {
        return Sector::new();
    }
    // Outward normals of the two sides; those of neighbours are the same vector except for the sign.
    let normal = |i: usize| {
        let (sin, cos) = (TAU * (i % count) as f64 / count as f64).sin_cos();
        Vector3::new(-sin, cos, 0.0)
    };
    let [low, high] = [-normal(i), normal(i + 1)];
    let planes = [low, high].map(|n| (n, n.dot(centre)));
    // With two halves both sides are one plane.
    planes[..if count == 2 { 1 } else { 2 }].to_vec()
}

/// Whether a box may overlap a block.
pub(super) fn reaches(sector: &Sector, bounds: &Bounds) -> bool {
    let (middle, half) = bounds.middle_and_half();
    sector
        .iter()
        .all(|(normal, offset)| normal.dot(&middle.coords) - normal.abs().dot(&half) <= *offset)
}

/// The first block that holds a point; if round-off at the axis of wedges leaves it to none, the nearest. `None`
/// without blocks.
pub(super) fn block_at(blocks: &[Sector], point: &Point3) -> Option<usize> {
    let outside = |sector: &Sector| {
        let beyond = sector
            .iter()
            .map(|(n, offset)| n.dot(&point.coords) - offset);
        beyond.fold(0.0, f64::max)
    };
    let ways: Vec<f64> = blocks.iter().map(outside).collect();
    (0..ways.len()).min_by(|a, b| ways[*a].total_cmp(&ways[*b]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::Clipper;
    use femdem_mesh::Pose;
    use femdem_mesh::catalogue::CatalogueShape;

    /// The blocks' parts of a body sum to the body, wherever it lies.
    #[test]
    fn blocks_tile_space() {
        let shape = "A10"
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(1.0)
            .unwrap();
        let whole = shape.mass_properties().volume;
        let tank = Region::Box {
            min: Point3::new(-2.0, -1.0, 0.0),
            max: Point3::new(2.0, 3.0, 5.0),
        };
        let drum = |radius| Region::Cylinder {
            centre: [0.3, -0.2],
            radius,
            z_min: 0.0,
            z_max: 3.0,
        };
        let cases = [
            (tank, Direction::Up, 16),
            (tank, Direction::Inwards, 5),
            (drum(2.0), Direction::Up, 12),
            (drum(0.35), Direction::Inwards, 2),
            (drum(0.1), Direction::Inwards, 1),
        ];
        for (region, direction, count) in cases {
            let blocks = sectors(&region, direction, 1.0);
            assert_eq!(blocks.len(), count);
            for place in [[0.3, -0.2, 1.0], [-2.0, -1.1, 2.1], [0.9, 0.7, 4.9]] {
                let pose = Pose::translation(place[0], place[1], place[2]);
                let bounds = Bounds::around(shape.vertices().iter().map(|v| pose * v));
                let mut sum = 0.0;
                for block in &blocks {
                    let mut clipper = Clipper::default();
                    clipper.load(&shape, &pose);
                    block
                        .iter()
                        .for_each(|(normal, offset)| clipper.clip(normal, *offset));
                    assert!(reaches(block, &bounds) || clipper.volume() == 0.0);
                    sum += clipper.volume();
                }
                assert!(
                    (sum - whole).abs() < 1e-12,
                    "{region:?}: {sum}, not {whole}"
                );
            }
        }
    }

    /// Every point is in the block whose planes hold it, and on the axis of wedges in one of them.
    #[test]
    fn every_point_has_a_block() {
        let drum = Region::Cylinder {
            centre: [0.3, -0.2],
            radius: 2.0,
            z_min: 0.0,
            z_max: 3.0,
        };
        let blocks = sectors(&drum, Direction::Up, 1.0);
        for k in 0..12 {
            let angle = TAU * (f64::from(k) + 0.5) / 12.0;
            let point = Point3::new(0.3 + angle.cos(), -0.2 + angle.sin(), 1.0);
            assert_eq!(block_at(&blocks, &point), Some(k as usize));
        }
        let off = 1e-17;
        for [x, y] in [[0.0, 0.0], [off, off], [-off, off], [5e-17, -5e-17]] {
            assert!(block_at(&blocks, &Point3::new(0.3 + x, -0.2 + y, 1.0)).is_some());
        }
        assert_eq!(block_at(&[], &Point3::origin()), None);
    }
}
