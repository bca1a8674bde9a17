//! The closed surface of the void of a voxel image.

use femdem_mesh::{Point3, Vector3};

use super::grid::VoxelGrid;
use super::image::{OUTSIDE, VoxelImage};
use super::surface::{Surface, SurfacePatch};
use super::tetrahedra::triangles_of_cube;
use super::thickness::check_length;
use crate::error::AnalysisError;
use crate::images::PeriodicSpace;
use crate::ordered::ordered_map;
use crate::region::Region;

/// Corners of the surface stay this share of an edge away from its ends, so that no triangle is a line.
const LEAST_PART: f64 = 0.01;

/// Cut edges that begin at one node.
const DIRECTIONS: usize = 7;

/// What a corner of the surface lies on.
const BODIES: u8 = 1;
const SIDES: u8 = 2;
/// The lower and the upper end along each axis.
const ENDS: [[u8; 2]; 3] = [[4, 8], [16, 32], [64, 128]];

/// The parts that they are.
const PARTS: [[SurfacePatch; 2]; 3] = [
    [SurfacePatch::XLow, SurfacePatch::XHigh],
    [SurfacePatch::YLow, SurfacePatch::YHigh],
    [SurfacePatch::Low, SurfacePatch::High],
];

/// A solid cylinder through a contact: as long as it is wide, about the contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridge {
    /// Contact point (m).
    pub point: Point3,
    /// Unit normal of the contact: the axis.
    pub normal: Vector3,
    /// Radius (m).
    pub radius: f64,
}

impl Bridge {
    /// The bridge and its images in periodic space that count in an image.
    pub fn images(&self, space: &PeriodicSpace, image: &VoxelImage) -> Vec<Self> {
        let ways = space.images(&self.point, &image.region, self.reach(&image.grid));
        let moved = |way| Self {
            point: self.point + way,
            ..*self
        };
        ways.into_iter().map(moved).collect()
    }

    /// Farther away (m) along an axis its distance is of no account to the surface.
    fn reach(&self, grid: &VoxelGrid) -> f64 {
        2.0 * (self.radius + grid.spacing.into_iter().fold(0.0, f64::max))
    }

    /// Signed distance (m), negative inside.
    fn distance(&self, point: &Point3) -> f64 {
        let arm = point - self.point;
        let along = arm.dot(&self.normal);
        let across = (arm - self.normal * along).norm() - self.radius;
        let along = along.abs() - self.radius;
        across.max(along).min(0.0) + across.max(0.0).hypot(along.max(0.0))
    }
}

/// The closed surface of the void of an image, by marching tetrahedra between the centres of the voxels, with bridges
/// joined to the bodies, in periodic space with their [images](Bridge::images). Its normals point out of the void.
///
/// `distances` are those of [`signed_distance`](super::signed_distance) with [`Sides::Open`](super::Sides::Open): the
/// sides and ends of the region are placed exactly, the bodies to second order in the voxel where they are smooth;
/// their edges and what is thinner than a voxel are cut off.
///
/// Along axes on which the image repeats itself the surface is that of the period which begins at the centres of the first voxels
/// ([`surface_region`]), and its two sides have the same triangles, a period apart.
///
/// # Errors
/// [`AnalysisError::ListLength`] if there is not one distance per voxel, [`AnalysisError::Option`] for a bridge with a
/// radius that is not above zero and finite.
pub fn void_surface(
    image: &VoxelImage,
    distances: &[f64],
    bridges: &[Bridge],
) -> Result<Surface, AnalysisError> {
    check_length("distances", distances.len(), image.grid.len())?;
    for bridge in bridges {
        if !(bridge.radius > 0.0 && bridge.radius.is_finite()) {
            return Err(AnalysisError::Option {
                name: "radius",
                value: bridge.radius,
                allowed: "above zero and finite (m)",
            });
        }
    }
    let mut distances = distances.to_vec();
    for bridge in bridges {
        join(image, bridge, &mut distances);
    }
    let nodes = Nodes {
        image,
        distances: &distances,
        counts: [0, 1, 2].map(|k| image.grid.counts[k] + 2 + usize::from(image.repeats[k])),
        ends: surface_region(image).corners().into(),
    };
    let layers = ordered_map(nodes.counts[2], || (), |(), k| nodes.cut_edges(k));
    let mut surface = Surface::default();
    let mut masks = Vec::new();
    let mut firsts = Vec::with_capacity(layers.len());
    for layer in &layers {
        firsts.push(surface.vertices.len() as u32);
        surface.vertices.extend(layer.iter().map(|cut| cut.point));
        masks.extend(layer.iter().map(|cut| cut.mask));
    }
    let triangles = ordered_map(nodes.counts[2] - 1, Vec::new, |tables, k| {
        tables.resize_with(2, Vec::new);
        for (table, layer) in tables.iter_mut().zip(k..) {
            nodes.table(&layers[layer], firsts[layer], table);
        }
        nodes.triangles(k, tables)
    });
    for triangle in triangles.into_iter().flatten() {
        surface.triangles.push(triangle);
        surface
            .patches
            .push(patch_of(triangle.map(|v| masks[v as usize])));
    }
    surface.drop_degenerate();
    Ok(surface)
}

/// The space that [`void_surface`] is about: the region, or the next period from the centres of the first voxels on.
pub fn surface_region(image: &VoxelImage) -> Region {
    let mut region = image.region;
    let half = |k: usize| match image.repeats[k] {
        true => 0.5 * image.grid.spacing[k],
        false => 0.0,
    };
    match &mut region {
        Region::Box { min, max } => {
            for k in 0..3 {
                min[k] += half(k);
                max[k] += half(k);
            }
        }
        Region::Cylinder { z_min, z_max, .. } => {
            *z_min += half(2);
            *z_max += half(2);
        }
        Region::Sphere { .. } => {}
    }
    region
}

/// Joins a bridge to the solids around it.
fn join(image: &VoxelImage, bridge: &Bridge, distances: &mut [f64]) {
    let grid = &image.grid;
    let range = |k: usize| {
        let at = (bridge.point[k] - grid.origin[k]) / grid.spacing[k];
        let reach = bridge.reach(grid) / grid.spacing[k];
        // Conversion to usize saturates.
        let end = ((at + reach).ceil() as usize).min(grid.counts[k]);
        ((at - reach).floor() as usize).min(end)..end
    };
    for k in range(2) {
        for j in range(1) {
            for i in range(0) {
                let index = grid.index([i, j, k]);
                let distance = bridge.distance(&grid.centre([i, j, k]));
                distances[index] = distances[index].min(distance);
            }
        }
    }
}

/// The part of a triangle, by what its corners lie on.
fn patch_of(masks: [u8; 3]) -> SurfacePatch {
    let all = masks[0] & masks[1] & masks[2];
    let parts = ENDS.as_flattened().iter().zip(PARTS.as_flattened());
    // The ends along z first.
    for (end, part) in parts.rev() {
        if all & end > 0 {
            return *part;
        }
    }
    if masks.iter().any(|mask| mask & BODIES > 0) {
        SurfacePatch::Bodies
    } else {
        SurfacePatch::Sides
    }
}

/// An edge between nodes that the surface cuts.
struct Cut {
    /// Node in its layer times the directions, plus the direction.
    code: u32,
    point: Point3,
    mask: u8,
}

/// The centres of the voxels, along axes on which the image repeats itself also the first of the next period, and one more layer
/// of nodes on every side, which are outside.
struct Nodes<'a> {
    image: &'a VoxelImage,
    distances: &'a [f64],
    counts: [usize; 3],
    /// Corners of the space of the surface.
    ends: [Point3; 2],
}

impl Nodes<'_> {
    /// Number of a node in the image.
    fn voxel(&self, at: [usize; 3]) -> Option<usize> {
        let grid = &self.image.grid;
        let within = (0..3).all(|k| (1..self.counts[k] - 1).contains(&at[k]));
        within.then(|| grid.index([0, 1, 2].map(|k| (at[k] - 1) % grid.counts[k])))
    }

    /// Whether a layer of nodes along axis `k` is the first or the last that is not outside: 0 or 1.
    fn end(&self, at: usize, k: usize) -> Option<usize> {
        (at == 1)
            .then_some(0)
            .or((at + 2 == self.counts[k]).then_some(1))
    }

    /// Whether a layer of nodes along axis `k` lies before all or behind all that are not outside: 0 or 1.
    fn beyond(&self, at: usize, k: usize) -> Option<usize> {
        (at == 0)
            .then_some(0)
            .or((at + 1 == self.counts[k]).then_some(1))
    }

    /// Whether a node is in the void, that is, inside.
    fn is_void(&self, at: [usize; 3]) -> bool {
        self.voxel(at)
            .is_some_and(|index| self.image.labels[index] != OUTSIDE && self.distances[index] > 0.0)
    }

    /// Whether a node is outside only along axes on which the image repeats itself. The planes there go through the last nodes that
    /// are not: what is cut on the way to it is drawn back.
    fn is_drawn_back(&self, at: [usize; 3]) -> bool {
        let beyond = [0, 1, 2].map(|k| self.beyond(at[k], k).is_some());
        let repeats = self.image.repeats;
        beyond != [false; 3] && (0..3).all(|k| !beyond[k] || repeats[k])
    }

    fn place(&self, at: [usize; 3]) -> Point3 {
        let grid = &self.image.grid;
        let along = |k: usize| grid.origin[k] + (at[k] as f64 - 0.5) * grid.spacing[k];
        Point3::from([0, 1, 2].map(along))
    }

    /// The cut edges that begin in a layer of nodes, by ascending code.
    fn cut_edges(&self, k: usize) -> Vec<Cut> {
        let mut cuts = Vec::new();
        for j in 0..self.counts[1] {
            for i in 0..self.counts[0] {
                let from = [i, j, k];
                let is_void = self.is_void(from);
                for direction in 1..=DIRECTIONS {
                    let to = step(from, direction);
                    if (0..3).any(|axis| to[axis] >= self.counts[axis])
                        || self.is_void(to) == is_void
                    {
                        continue;
                    }
                    let (inner, outer) = if is_void { (from, to) } else { (to, from) };
                    let (point, mask) = self.cut(inner, outer);
                    cuts.push(Cut {
                        code: self.code(from, direction),
                        point,
                        mask,
                    });
                }
            }
        }
        cuts
    }

    fn code(&self, from: [usize; 3], direction: usize) -> u32 {
        // The grid has refused layers of more than 1.3e8 cells.
        ((from[1] * self.counts[0] + from[0]) * DIRECTIONS + direction - 1) as u32
    }

    /// Where the surface cuts the edge between a node in the void and another, and what it is there.
    fn cut(&self, inner: [usize; 3], outer: [usize; 3]) -> (Point3, u8) {
        let [from, to] = [inner, outer].map(|at| self.place(at));
        let repeats = self.image.repeats;
        let beyond = [0, 1, 2].map(|k| self.beyond(outer[k], k));
        let mut part = 1.0;
        let mut mask = 0;
        // The planes lie halfway to the outermost nodes.
        if let Some(end) = beyond[2].filter(|_| !repeats[2]) {
            part = 0.5;
            mask = ENDS[2][end];
        }
        match self.image.region {
            Region::Cylinder { centre, radius, .. } => {
                let at_wall = to_circle(&from, &to, centre, radius);
                if let Some(at_wall) = at_wall
                    && at_wall < part
                {
                    (part, mask) = (at_wall, SIDES);
                }
            }
            _ => {
                if (0..2).any(|k| beyond[k].is_some() && !repeats[k]) {
                    part = 0.5;
                    mask |= SIDES;
                }
            }
        }
        let drawn_back = self.is_drawn_back(outer);
        if drawn_back {
            part = 0.0;
        } else if mask == 0 {
            mask = BODIES;
            if let (Some(inner), Some(outer)) = (self.voxel(inner), self.voxel(outer)) {
                let [a, b] = [inner, outer].map(|index| self.distances[index]);
                part = a / (a - b);
            }
        }
        if !drawn_back {
            part = part.clamp(LEAST_PART, 1.0 - LEAST_PART);
        }
        let mut point = from + (to - from) * part;
        for k in (0..3).filter(|&k| repeats[k]) {
            // What is drawn back lies where its inner node does.
            let stays = drawn_back || inner[k] == outer[k];
            let within = self.end(inner[k], k).filter(|_| stays);
            if let Some(end) = beyond[k].or(within) {
                point[k] = self.ends[end][k];
                mask |= ENDS[k][end];
            }
        }
        (point, mask)
    }

    /// The number of the surface's corner for each code of a layer.
    fn table(&self, layer: &[Cut], first: u32, table: &mut Vec<u32>) {
        table.clear();
        table.resize(self.counts[0] * self.counts[1] * DIRECTIONS, u32::MAX);
        for (cut, vertex) in layer.iter().zip(first..) {
            table[cut.code as usize] = vertex;
        }
    }

    /// The triangles between two layers of nodes.
    fn triangles(&self, k: usize, tables: &[Vec<u32>]) -> Vec<[u32; 3]> {
        let mut found = Vec::new();
        for j in 0..self.counts[1] - 1 {
            for i in 0..self.counts[0] - 1 {
                let corner = |code: u8| step([i, j, k], usize::from(code));
                let inside = (0..8).fold(0, |inside, code| {
                    inside | u8::from(self.is_void(corner(code))) << code
                });
                // So that quadrangles in the two planes of a period are halved alike.
                let drawn_back = |code: u8| self.is_drawn_back(corner(code));
                triangles_of_cube(inside, drawn_back, |edges| {
                    let vertex = |(p, q): (u8, u8)| {
                        let (low, high) = (p & q, p | q);
                        let from = corner(low);
                        let code = self.code(from, usize::from(high - low));
                        tables[from[2] - k][code as usize]
                    };
                    found.push(edges.map(vertex));
                });
            }
        }
        found
    }
}

/// A node and the bits of a direction: x = 1, y = 2, z = 4.
fn step(from: [usize; 3], direction: usize) -> [usize; 3] {
    [0, 1, 2].map(|k| from[k] + (direction >> k & 1))
}

/// Where a line from inside an upright circle leaves it, as a share of the way; `None` if the way ends inside.
fn to_circle(from: &Point3, to: &Point3, centre: [f64; 2], radius: f64) -> Option<f64> {
    let start = [from.x - centre[0], from.y - centre[1]];
    let way = [to.x - from.x, to.y - from.y];
    let a = way[0] * way[0] + way[1] * way[1];
    let b = start[0] * way[0] + start[1] * way[1];
    let c = start[0] * start[0] + start[1] * start[1] - radius * radius;
    let end = [to.x - centre[0], to.y - centre[1]];
    let leaves = end[0] * end[0] + end[1] * end[1] > radius * radius;
    leaves.then(|| ((b * b - a * c).max(0.0).sqrt() - b) / a)
}
