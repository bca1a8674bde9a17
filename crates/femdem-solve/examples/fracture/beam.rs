//! Beams with a notch along their middle, which ends in a weak seam.
//!
//! What drives the crack is read from outside: forces F along z at nodes where the beam has the slopes u_z,x give
//! J = -Σ F u_z,x/b (J. R. Rice, J. Appl. Mech. 35 (1968) 379-386, around the whole beam; A. J. Paris and P. C. Paris,
//! Int. J. Fract. 38 (1988) R19-R21), whatever the stiffness of mesh and seam.

use super::setting::{POISSON, YOUNG, add_moving, damped_world, facets, model};
use femdem_contact::BodyId;
use femdem_fem::{Boundary, Curve, Drive, Selection};
use femdem_mesh::{Point3, TetMesh, Vector3};
use femdem_solve::{CrackFacet, Fracture, World};
use std::error::Error;

/// How much stronger all but the seam is.
const STRONGER: f64 = 10.0;

/// Local damping, which quiets the vibrations of a crack that runs from node to node.
const DAMPING: f64 = 0.1;

/// Layers of cells beside the seam that are as thin as it asks for.
const THIN: usize = 3;

/// Most that cells grow from layer to layer beyond them.
const GROWTH: f64 = 1.5;

/// A notched beam along x. The notch is the middle plane up to its tip; from 1.5 mm before the tip on, cells are fine.
pub struct Beam {
    /// Places of the planes of nodes along x, across y and along z from the middle up, m.
    planes: [Vec<f64>; 3],
    /// The plane along x in which the notch ends.
    tip: usize,
    /// Edge of the fine cells, m.
    fine: f64,
    /// Whether the nodes of the seam are off its plane, too.
    rough: bool,
}

/// Nodes across the beam that are driven along z.
pub struct Column {
    /// The plane along x.
    pub plane: usize,
    /// Whether the half above the notch, and that below.
    pub halves: [bool; 2],
    /// m/s.
    pub speed: f64,
}

/// Nodes and their velocity along z, m/s.
pub struct Driven {
    nodes: Vec<u32>,
    speed: f64,
}

/// What a beam shows from outside.
#[derive(Default)]
pub struct Seen {
    /// Force on the first column, N, and its way, m.
    pub force: f64,
    pub way: f64,
    /// J, J/m².
    pub released: f64,
}

/// Places from 0 to a length in equal parts of about an edge.
fn even(length: f64, edge: f64) -> impl Iterator<Item = f64> {
    let parts = (length / edge).round().max(1.0) as u32;
    (0..=parts).map(move |i| length * f64::from(i) / f64::from(parts))
}

impl Beam {
    /// A beam of a width and a height of each half (m), whose planes along x lie at the stops (m) and between them as close as the
    /// edges ask for; at the stop of the tip the notch ends.
    pub fn new(
        [width, height]: [f64; 2],
        stops: &[(f64, f64)],
        tip: f64,
        fine: f64,
        rough: bool,
    ) -> Self {
        let mut along = vec![0.0];
        for &(stop, edge) in stops {
            let last = along[along.len() - 1];
            along.extend(even(stop - last, edge).skip(1).map(|x| last + x));
        }
        let mut up = vec![0.0];
        let mut edge = fine;
        while up[up.len() - 1] < height - 1e-9 {
            let last = up[up.len() - 1];
            if up.len() > THIN {
                edge *= GROWTH;
            }
            // Two layers more, or one.
            let rest = height - last;
            let next = if rest < 1.6 * edge { rest } else { edge };
            up.push(last + next);
        }
        let across = even(width, 1.5 * fine).collect();
        let tip = along.iter().position(|x| (x - tip).abs() < 1e-9);
        Self {
            planes: [along, across, up],
            tip: tip.unwrap_or(0),
            fine,
            rough,
        }
    }

    /// The plane of nodes nearest to a place along x, m.
    pub fn plane(&self, x: f64) -> usize {
        let planes = self.planes[0].iter().enumerate();
        let nearest = planes.min_by(|(_, a), (_, b)| (*a - x).abs().total_cmp(&(*b - x).abs()));
        nearest.map_or(0, |(i, _)| i)
    }

    fn width(&self) -> f64 {
        self.planes[1][self.planes[1].len() - 1]
    }

    /// Number of planes; those along z for both halves.
    fn counts(&self) -> [usize; 3] {
        let [x, y, z] = [0, 1, 2].map(|k| self.planes[k].len());
        [x, y, 2 * z - 1]
    }

    /// A node by its planes, in the half above the middle or below.
    fn node(&self, [i, j, k]: [usize; 3], above: bool) -> usize {
        let [nx, ny, nz] = self.counts();
        if above && 2 * k + 1 == nz && i < self.tip {
            return nx * ny * nz + i + self.tip * j;
        }
        i + nx * (j + ny * k)
    }

    /// Where a plane of nodes is, m, and the distances to its neighbours; none at the skin.
    fn place(&self, axis: usize, at: usize) -> (f64, Option<[f64; 2]>) {
        let planes = &self.planes[axis];
        let middle = if axis == 2 { planes.len() - 1 } else { 0 };
        let of = |at: usize| {
            let own = planes[at.abs_diff(middle)];
            if at < middle { -own } else { own }
        };
        let last = self.counts()[axis] - 1;
        let gaps = (at > 0 && at < last).then(|| [of(at) - of(at - 1), of(at + 1) - of(at)]);
        (of(at), gaps)
    }

    /// The mesh, whose nodes are moved by up to a fifth of an edge, those of skin and notch along it.
    fn mesh(&self) -> Result<TetMesh, Box<dyn Error>> {
        let [nx, ny, nz] = self.counts();
        let cells = [nx, ny, nz].map(|n| n as u32 - 1);
        let block = TetMesh::block(cells, &Vector3::repeat(1.0))?;
        let noise = |n: usize, k: usize| (12.9898 * n as f64 + 78.233 * k as f64).sin();
        let mut points = Vec::new();
        for n in 0..nx * ny * nz {
            let at = [n % nx, n / nx % ny, n / (nx * ny)];
            let is_seam = 2 * at[2] + 1 == nz;
            points.push(Point3::from([0, 1, 2].map(|axis| {
                let (place, gaps) = self.place(axis, at[axis]);
                let is_free = |gaps: &[f64; 2]| match axis {
                    // Planes that are driven stay plane: else they would hold the slope, too.
                    0 => gaps[0].max(gaps[1]) < 1.3 * self.fine && !(is_seam && at[0] == self.tip),
                    2 => !is_seam || (self.rough && at[0] > self.tip),
                    _ => true,
                };
                let gaps = gaps.filter(is_free).unwrap_or([0.0; 2]);
                place + 0.2 * gaps[0].min(gaps[1]) * noise(n, axis)
            })));
        }
        for j in 0..ny {
            for i in 0..self.tip {
                points.push(points[self.node([i, j, nz / 2], false)]);
            }
        }
        let layer = |n: u32| n as usize / (nx * ny);
        let mut tets = block.tets().to_vec();
        for tet in &mut tets {
            if tet.iter().any(|n| layer(*n) > nz / 2) {
                for n in tet.iter_mut().filter(|n| layer(**n) == nz / 2) {
                    let own = *n as usize;
                    *n = self.node([own % nx, own / nx % ny, nz / 2], true) as u32;
                }
            }
        }
        Ok(TetMesh::new(points, tets)?)
    }

    /// The planes of the nodes in a column, with whether they are above.
    fn corners(&self, column: &Column) -> Vec<([usize; 3], bool)> {
        let [_, ny, nz] = self.counts();
        let mut all = Vec::new();
        for (above, layers) in [(true, nz / 2..nz), (false, 0..nz / 2 + 1)] {
            for k in layers.filter(|_| column.halves[usize::from(!above)]) {
                // Where the beam is whole, its middle is of both halves.
                let is_shared = 2 * k + 1 == nz && column.plane >= self.tip;
                if !(is_shared && !above && column.halves[0]) {
                    all.extend((0..ny).map(|j| ([column.plane, j, k], above)));
                }
            }
        }
        all
    }

    /// The nodes of a column.
    pub fn driven(&self, column: &Column) -> Driven {
        let corners = self.corners(column).into_iter();
        Driven {
            nodes: corners
                .map(|(at, above)| self.node(at, above) as u32)
                .collect(),
            speed: column.speed,
        }
    }

    /// The beam with nodes driven, under a pressure on its ends (Pa), its nodes moving as the function of their place and half says.
    pub fn start(
        &self,
        driven: &[Driven],
        fracture: Fracture,
        pressure: f64,
        velocity: impl Fn(&Point3, bool) -> Vector3,
    ) -> Result<(World, BodyId, usize), Box<dyn Error>> {
        let mesh = self.mesh()?;
        let model = model(&mesh, YOUNG)?;
        let strain = Vector3::new(-1.0, POISSON, POISSON) * (pressure / YOUNG);
        let pressed = |x: &Vector3| x + x.component_mul(&strain);
        let places: Vec<Vector3> = model.nodes().iter().map(pressed).collect();
        let mut boundary = Boundary::default();
        let ends = &self.planes[0];
        for (offset, way) in [(0.0, 1.0), (ends[ends.len() - 1], -1.0)] {
            let end = Selection::Plane {
                normal: Vector3::x(),
                offset,
                tolerance: 1e-9,
            };
            let pull = Vector3::x() * (way * pressure);
            boundary.pull(&model, &end, pull, Curve::Constant(1.0))?;
        }
        for part in driven {
            let drive = Drive::Linear {
                velocity: Vector3::z() * part.speed,
                start: 0.0,
                end: 1.0,
            };
            let nodes = Selection::Nodes(part.nodes.clone());
            boundary.drive_from(&model, &nodes, [false, false, true], drive, &places)?;
        }
        let factors: Vec<f64> = mesh.points().iter().map(|p| self.seam(p)).collect();
        let [nx, ny, nz] = self.counts();
        let start = |(n, p): (usize, &Point3)| velocity(p, n >= nx * ny * nz || p.z > 1e-9);
        let velocities: Vec<Vector3> = mesh.points().iter().enumerate().map(start).collect();
        let mut world = damped_world(DAMPING)?;
        let body = add_moving(&mut world, model, boundary, fracture, &velocities)?;
        world.set_nodes(body, &places, &velocities)?;
        world.scale_strength(body, &factors)?;
        // Nothing presses the halves on each other.
        world.set_self_contact(body, false)?;
        Ok((world, body, mesh.tets().len()))
    }

    /// The factor of the strength of a node, in the seam or elsewhere. The faces of the notch are not of the seam: there the arms are
    /// bent most.
    fn seam(&self, p: &Point3) -> f64 {
        let band = if self.rough { 0.9 * self.fine } else { 1e-9 };
        let is_ahead = p.x > self.planes[0][self.tip] - 1e-9;
        if is_ahead && p.z.abs() < band {
            1.0
        } else {
            STRONGER
        }
    }

    /// The facets of the seam that are broken, with their centres.
    fn broken(&self, world: &World, body: BodyId) -> Vec<(Vector3, CrackFacet)> {
        let centre = |f: CrackFacet| ((f.place[0] + f.place[1] + f.place[2]) / 3.0, f);
        let all = facets(world, body).into_iter();
        let broken = all.filter(|f| f.end.is_some()).map(centre);
        broken
            .filter(|(c, _)| c.z.abs() < 0.5 * self.fine)
            .collect()
    }

    /// How far along the beam the seam is broken, m.
    pub fn front(&self, world: &World, body: BodyId) -> f64 {
        let broken = self.broken(world, body);
        let places = broken.iter().map(|(centre, _)| centre.x);
        places.fold(self.planes[0][self.tip], f64::max)
    }

    /// Energy that the broken facets of the seam have taken over their area in its plane, J/m².
    pub fn taken(&self, world: &World, body: BodyId) -> f64 {
        let (mut taken, mut area) = (0.0, 0.0);
        for (_, facet) in self.broken(world, body) {
            let [a, b, c] = facet.place;
            taken += facet.taken;
            area += 0.5 * (b - a).cross(&(c - a)).z.abs();
        }
        taken / area
    }

    /// What is seen of it.
    pub fn see(
        &self,
        world: &World,
        body: BodyId,
        columns: &[Column],
    ) -> Result<Seen, Box<dyn Error>> {
        let own = world.deformable(body).ok_or("no body")?;
        let (now, then) = (own.positions(), own.model().nodes());
        let mut seen = Seen::default();
        for (c, column) in columns.iter().enumerate() {
            for ([i, j, k], above) in self.corners(column) {
                let [before, node, after] = [i - 1, i, i + 1].map(|i| self.node([i, j, k], above));
                let force = -own.internal_forces()[node].z;
                let rise = now[after].z - then[after].z - now[before].z + then[before].z;
                let slope = rise / (then[after].x - then[before].x);
                seen.released -= force * slope / self.width();
                if c == 0 {
                    seen.force += force;
                    seen.way = now[node].z - then[node].z;
                }
            }
        }
        Ok(seen)
    }
}
