//! Contact meshes of deformable bodies.

use crate::error::{ContactError, STIFFNESSES, check, check_pressure};
use crate::general::{Field, gauge};
use crate::tets::cells::NONE;
use femdem_mesh::bvh::{Aabb, Bvh};
use femdem_mesh::{Point3, TetMesh, Vector3};
use serde::{Deserialize, Serialize};

/// A tetrahedron of a contact mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ContactTet {
    /// Contact nodes: first the nodes of the finite elements, then slaves.
    pub nodes: [u32; 4],
    /// The field at them.
    pub values: [f64; 4],
    /// Bit k: the face opposite node k lies on the skin.
    pub skin: u8,
    /// By face, its triangle of the skin; for faces inside, the triangle nearest to the
    /// tetrahedron.
    pub triangles: [u32; 4],
    /// The triangle of the skin nearest to the tetrahedron.
    pub nearest: u32,
}

/// A tetrahedron of the mesh of which a contact mesh is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WholeTet {
    pub nodes: [u32; 4],
    /// Those across the faces opposite its nodes.
    pub neighbours: [Option<u32>; 4],
}

/// The contact mesh of a deformable body: tetrahedra with a nodal field, fixed in the material. Immutable;
/// share it among bodies.
///
/// The field is 0 on the skin and grows inwards with the distance to it in the reference state, to 1 at the
/// depth [`inradius`](Self::inradius). A tetrahedron with all its nodes on the skin gets a slave node at its
/// centroid, so that the field is positive in all tetrahedra.
#[derive(Debug, Clone, PartialEq)]
pub struct DeformableShape {
    node_count: usize,
    /// By slave, the four nodes of which it is the mean.
    slaves: Vec<[u32; 4]>,
    tets: Vec<ContactTet>,
    /// The tetrahedra of the mesh.
    wholes: Vec<WholeTet>,
    /// By tetrahedron, of which of the mesh it is: all of it, or the part opposite its corner k.
    parents: Vec<(u32, Option<u8>)>,
    skin: Vec<[u32; 3]>,
    /// By triangle of the skin, its neighbours across the edges.
    beside: Vec<[u32; 3]>,
    tree: Bvh,
    /// The same over the triangles of the skin.
    skin_tree: Bvh,
    inradius: f64,
    radius: f64,
    edge: f64,
    /// Whether cracks have broken it: then it does not move as a whole.
    in_pieces: bool,
    /// Whether it is that of a body that has cracked.
    is_cracked: bool,
}

impl DeformableShape {
    /// The contact mesh of linear tetrahedra (T4): the nodes are the mesh's points.
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if a tetrahedron is too flat to be split.
    pub fn new(mesh: &TetMesh) -> Result<Self, ContactError> {
        Self::build(mesh, Field::Body)
    }

    /// The contact mesh of quadratic tetrahedra (T10) with straight edges in the reference state:
    /// eight linear ones for each. The nodes are the mesh's points, then a node on the middle of
    /// each edge of `mid_edges` (pairs of points, every edge of the mesh once).
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if `mid_edges` are not the edges of the mesh, or if a part is too
    /// flat.
    pub fn quadratic(mesh: &TetMesh, mid_edges: &[[u32; 2]]) -> Result<Self, ContactError> {
        Self::build(&halved(mesh, mid_edges)?, Field::Body)
    }

    /// The contact mesh of linear tetrahedra, or of quadratic ones if there are `mid_edges`, with the field
    /// of the same body as a rigid one. Contacts taken over from the rigid body then start with the same
    /// forces.
    ///
    /// # Errors
    /// As [`quadratic`](Self::quadratic), and [`ContactError::NotConvex`] for [`Field::Gauge`] of a body that
    /// is not convex.
    pub fn with_field(
        mesh: &TetMesh,
        mid_edges: &[[u32; 2]],
        field: Field,
    ) -> Result<Self, ContactError> {
        if mid_edges.is_empty() {
            Self::build(mesh, field)
        } else {
            Self::build(&halved(mesh, mid_edges)?, field)
        }
    }

    /// The contact mesh of a body that has cracked, or of a part that has broken off it. `mesh` has nodes of their own on the sides
    /// of cracks, as from [`CrackedMesh::mesh`](femdem_mesh::tet::CrackedMesh::mesh), and may be in pieces; `edge` is the
    /// [edge](Self::edge) of the body when it was whole (m), which stays.
    ///
    /// The field is the distance to all of its skin: sides of a crack lie on each other when it is born, and begin without
    /// overlap and without energy.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`ContactError::Parameter`] for an edge that is not positive and finite.
    pub fn cracked(mesh: &TetMesh, edge: f64) -> Result<Self, ContactError> {
        check(
            "edge of the skin",
            edge,
            edge > 0.0,
            "positive and finite, in m",
        )?;
        Ok(Self {
            edge,
            is_cracked: true,
            ..Self::build(mesh, Field::Body)?
        })
    }

    fn build(mesh: &TetMesh, field: Field) -> Result<Self, ContactError> {
        let node_count = mesh.points().len();
        let (split, slaves, parents) = with_centroids(mesh)?;
        let (values, inradius) = match field {
            Field::Body => {
                let distance = split.distance_to_skin();
                let h0 = distance.iter().copied().fold(0.0, f64::max);
                (distance.iter().map(|d| (d / h0).min(1.0)).collect(), h0)
            }
            Field::Gauge => gauge(&split)?,
        };
        let value = |i: u32| values[i as usize];
        let point = |i: u32| split.points()[i as usize];
        let surface: Vec<[Point3; 3]> = split.skin().iter().map(|t| t.map(point)).collect();
        let boxes: Vec<Aabb> = surface.iter().map(|t| Aabb::of_points(*t)).collect();
        let finder = Bvh::new(&boxes);
        let mut tets = Vec::with_capacity(split.tets().len());
        let mut skin_count = 0_u32;
        for (nodes, next) in split.tets().iter().zip(split.neighbours()) {
            let centre =
                Point3::from(nodes.iter().map(|&i| point(i).coords).sum::<Vector3>() / 4.0);
            // The nearest one lies before it. The other side of a crack lies in the same place, and behind it.
            let to = |i: u32| match is_before(&centre, &surface[i as usize]) {
                true => distance_squared(&centre, &surface[i as usize]),
                false => f64::INFINITY,
            };
            let Some((nearest, _)) = finder.nearest(&centre, to) else {
                return Err(ContactError::Mesh {
                    why: "the distances of its tetrahedra from its skin are not finite: scale it down"
                        .to_owned(),
                });
            };
            let mut tet = ContactTet {
                nodes: *nodes,
                values: nodes.map(value),
                skin: 0,
                triangles: [nearest; 4],
                nearest,
            };
            // The skin lists its triangles in the order of the tetrahedra and their faces.
            for (k, next) in next.iter().enumerate() {
                if next.is_none() {
                    tet.skin |= 1 << k;
                    tet.triangles[k] = skin_count;
                    skin_count += 1;
                }
            }
            tets.push(tet);
        }
        let skin = split.skin().to_vec();
        let tet_box = |t: &[u32; 4]| Aabb::of_points(t.map(point));
        Ok(Self {
            node_count,
            slaves,
            tree: Bvh::new(&split.tets().iter().map(tet_box).collect::<Vec<_>>()),
            tets,
            wholes: wholes(mesh),
            parents,
            beside: beside(&skin),
            edge: mean_edge(&surface),
            skin,
            skin_tree: finder,
            inradius,
            radius: radius(mesh),
            in_pieces: mesh.pieces() > 1,
            is_cracked: false,
        })
    }

    /// Number of nodes of the finite elements: the length of every nodal slice.
    pub fn node_count(&self) -> usize {
        self.node_count
    }

    /// Number of linear tetrahedra.
    pub fn tet_count(&self) -> usize {
        self.tets.len()
    }

    /// The field's length h0 in the reference state, m: the largest distance of a node from the
    /// skin.
    pub fn inradius(&self) -> f64 {
        self.inradius
    }

    /// Largest distance of a node from the mean position of all nodes in the reference state, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Mean edge of the skin's triangles in the reference state, m.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// Whether cracks have broken it: then it does not move as a whole.
    pub(crate) fn is_in_pieces(&self) -> bool {
        self.in_pieces
    }

    /// Whether it is that of a body that has [cracked](Self::cracked), which no other body has.
    pub(crate) fn is_cracked(&self) -> bool {
        self.is_cracked
    }

    /// Triangles of the skin, counter-clockwise seen from outside, as nodes.
    pub fn skin(&self) -> &[[u32; 3]] {
        &self.skin
    }

    pub(crate) fn tets(&self) -> &[ContactTet] {
        &self.tets
    }

    /// The tetrahedra of the mesh.
    pub(crate) fn wholes(&self) -> &[WholeTet] {
        &self.wholes
    }

    /// Of which tetrahedron of the mesh tetrahedron `i` is: all of it, or the part opposite its corner k.
    pub(crate) fn parent(&self, i: u32) -> Option<(u32, Option<u8>)> {
        self.parents.get(i as usize).copied()
    }

    /// The first of the tetrahedra that tetrahedron `parent` of the mesh became, and whether there are four, in the order of
    /// the corners opposite to them.
    pub(crate) fn child(&self, parent: u32) -> Option<(u32, bool)> {
        let first = self.parents.partition_point(|(p, _)| *p < parent);
        let (found, part) = self.parents.get(first)?;
        (*found == parent).then_some((first as u32, part.is_some()))
    }

    /// The four nodes of which contact node `i` is the mean; `None` for nodes of the finite elements.
    #[inline]
    pub(crate) fn masters(&self, i: u32) -> Option<&[u32; 4]> {
        self.slaves.get((i as usize).checked_sub(self.node_count)?)
    }

    /// Position of contact node `i`, m.
    #[inline]
    pub(crate) fn place(&self, i: u32, x: &[Vector3]) -> Option<Vector3> {
        match self.masters(i) {
            None => x.get(i as usize).copied(),
            Some(masters) => {
                let mut sum = Vector3::zeros();
                for &m in masters {
                    sum += x.get(m as usize)?;
                }
                Some(sum * 0.25)
            }
        }
    }

    /// The corners of tetrahedron `i`, m.
    #[inline(always)]
    pub(crate) fn corners(&self, i: u32, x: &[Vector3]) -> Option<[Vector3; 4]> {
        let [a, b, c, d] = self.tets.get(i as usize)?.nodes;
        if self.slaves.is_empty() {
            let at = |i: u32| x.get(i as usize).copied();
            return Some([at(a)?, at(b)?, at(c)?, at(d)?]);
        }
        Some([
            self.place(a, x)?,
            self.place(b, x)?,
            self.place(c, x)?,
            self.place(d, x)?,
        ])
    }

    /// Inverse mass of contact node `i`, 1/kg.
    pub(crate) fn inverse_mass(&self, i: u32, inverse_masses: &[f64]) -> f64 {
        let of = |i: u32| inverse_masses[i as usize];
        match self.masters(i) {
            None => of(i),
            Some(masters) => masters.iter().map(|&m| of(m)).sum::<f64>() / 16.0,
        }
    }

    /// Triangles that share an edge with triangle `i` of the skin.
    pub(crate) fn beside(&self, i: u32) -> [u32; 3] {
        self.beside[i as usize]
    }

    /// The tree over the tetrahedra in the reference state.
    pub(crate) fn tree(&self) -> &Bvh {
        &self.tree
    }

    /// The tree over the triangles of the skin in the reference state.
    pub(crate) fn skin_tree(&self) -> &Bvh {
        &self.skin_tree
    }
}

/// Sub-tetrahedra at the corners, by corner and then the middles of its edges to the others.
const MIDDLES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The mesh with every tetrahedron cut into eight at given nodes.
fn halved(mesh: &TetMesh, mid_edges: &[[u32; 2]]) -> Result<TetMesh, ContactError> {
    let fail = |why: String| ContactError::Mesh { why };
    let count = mesh.points().len();
    let mut points = mesh.points().to_vec();
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(mid_edges.len());
    for (k, &[i, j]) in mid_edges.iter().enumerate() {
        let (Some(a), Some(b)) = (mesh.points().get(i as usize), mesh.points().get(j as usize))
        else {
            return Err(fail(format!(
                "mid-edge {k} joins points {i} and {j}, but there are {count} points"
            )));
        };
        points.push(Point3::from((a.coords + b.coords) * 0.5));
        edges.push(([i.min(j), i.max(j)], (count + k) as u32));
    }
    edges.sort_unstable();
    let middle = |i: u32, j: u32| {
        let key = [i.min(j), i.max(j)];
        let place = edges.binary_search_by_key(&key, |e| e.0);
        place.map(|p| edges[p].1).map_err(|_| {
            fail(format!(
                "the edge of points {i} and {j} has no node: give every edge of the mesh once"
            ))
        })
    };
    let mut tets = Vec::with_capacity(8 * mesh.tets().len());
    for t in mesh.tets() {
        let mut m = [0; 6];
        for (m, [i, j]) in m.iter_mut().zip(MIDDLES) {
            *m = middle(t[i], t[j])?;
        }
        let [m01, m02, m03, m12, m13, m23] = m;
        tets.extend([
            [t[0], m01, m02, m03],
            [m01, t[1], m12, m13],
            [m02, m12, t[2], m23],
            [m03, m13, m23, t[3]],
        ]);
        // The octahedron inside is split along its shortest diagonal: its ends, and the other corners in
        // order around it.
        let rings = [
            ([m01, m23], [m02, m12, m13, m03]),
            ([m02, m13], [m01, m03, m23, m12]),
            ([m03, m12], [m01, m13, m23, m02]),
        ];
        let length = |[i, j]: [u32; 2]| (points[i as usize] - points[j as usize]).norm_squared();
        let mut best = rings[0];
        for ring in rings {
            if length(ring.0) < length(best.0) {
                best = ring;
            }
        }
        let ([p, q], ring) = best;
        for k in 0..4 {
            let tet = [p, q, ring[k], ring[(k + 1) % 4]];
            let [a, b, c, d] = tet.map(|i| points[i as usize]);
            let right = (b - a).dot(&(c - a).cross(&(d - a))) > 0.0;
            tets.push(if right { tet } else { [p, q, tet[3], tet[2]] });
        }
    }
    Ok(TetMesh::new(points, tets)?)
}

fn wholes(mesh: &TetMesh) -> Vec<WholeTet> {
    let whole = |(nodes, beside): (&[u32; 4], &[Option<u32>; 4])| WholeTet {
        nodes: *nodes,
        neighbours: *beside,
    };
    mesh.tets()
        .iter()
        .zip(mesh.neighbours())
        .map(whole)
        .collect()
}

/// A mesh, for each point added to it the four points of which it is the mean, and the [parents](DeformableShape::parent) of its
/// tetrahedra.
type Centred = (TetMesh, Vec<[u32; 4]>, Vec<(u32, Option<u8>)>);

/// The mesh with a point added at the centroid of every tetrahedron whose points all lie on the skin.
fn with_centroids(mesh: &TetMesh) -> Result<Centred, ContactError> {
    let mut points = mesh.points().to_vec();
    let mut slaves = Vec::new();
    let mut tets = Vec::with_capacity(mesh.tets().len());
    let mut parents = Vec::with_capacity(mesh.tets().len());
    for (tet, parent) in mesh.tets().iter().zip(0..) {
        if tet.iter().any(|&i| !mesh.is_skin_point(i as usize)) {
            tets.push(*tet);
            parents.push((parent, None));
            continue;
        }
        let centre = points.len() as u32;
        let sum: Vector3 = tet.iter().map(|&i| points[i as usize].coords).sum();
        points.push(Point3::from(sum / 4.0));
        slaves.push(*tet);
        for k in 0..4 {
            let mut part = *tet;
            part[k as usize] = centre;
            tets.push(part);
            parents.push((parent, Some(k)));
        }
    }
    let mesh = if slaves.is_empty() {
        mesh.clone()
    } else {
        TetMesh::in_pieces(points, tets)?
    };
    Ok((mesh, slaves, parents))
}

/// For each triangle its neighbours across the three edges.
fn beside(skin: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut edges: Vec<([u32; 2], usize, usize)> = Vec::with_capacity(3 * skin.len());
    for (t, nodes) in skin.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (nodes[k], nodes[(k + 1) % 3]);
            edges.push(([i.min(j), i.max(j)], t, k));
        }
    }
    edges.sort_unstable();
    let mut beside = vec![[NONE; 3]; skin.len()];
    for pair in edges.windows(2) {
        let [(e, t, k), (f, u, l)] = [pair[0], pair[1]];
        if e == f {
            beside[t][k] = u as u32;
            beside[u][l] = t as u32;
        }
    }
    beside
}

fn radius(mesh: &TetMesh) -> f64 {
    let points = mesh.points();
    let centre = points.iter().map(|p| p.coords).sum::<Vector3>() / points.len() as f64;
    let distance = |p: &Point3| (p.coords - centre).norm();
    points.iter().map(distance).fold(0.0, f64::max)
}

fn mean_edge(surface: &[[Point3; 3]]) -> f64 {
    let around = |[a, b, c]: &[Point3; 3]| (b - a).norm() + (c - b).norm() + (a - c).norm();
    surface.iter().map(around).sum::<f64>() / (3 * surface.len()) as f64
}

/// Whether a triangle lies with its back to a point.
fn is_before(p: &Point3, [a, b, c]: &[Point3; 3]) -> bool {
    (b - a).cross(&(c - a)).dot(&(p - a)) < 0.0
}

/// Squared distance of a point from a triangle, m^2.
fn distance_squared(p: &Point3, [a, b, c]: &[Point3; 3]) -> f64 {
    let along = |from: &Point3, to: &Point3| {
        let edge = to - from;
        let t = (p - from).dot(&edge) / edge.norm_squared();
        (from + edge * t.clamp(0.0, 1.0) - p).norm_squared()
    };
    let n = (b - a).cross(&(c - a));
    let inside = |from: &Point3, to: &Point3| n.dot(&(to - from).cross(&(p - from))) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        let height = n.dot(&(p - a));
        height * height / n.norm_squared()
    } else {
        along(a, b).min(along(b, c)).min(along(c, a))
    }
}

/// Stiffness of the field of a deformable body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Modulus {
    /// Penalty p, 1e-100 to 1e100 Pa: U = p int phi dV.
    Penalty(f64),
    /// Foundation modulus kappa = p/h0, 1e-100 to 1e100 Pa/m: pressure over depth.
    Foundation(f64),
    /// A penalty (Pa) of a body that has cracked: the pressure over depth is still that of the field which had this length, m.
    Kept {
        /// 1e-100 to 1e100 Pa.
        penalty: f64,
        /// m.
        length: f64,
    },
}

impl Modulus {
    /// The foundation modulus `ratio` E/h, with h the mean edge of the skin. A ratio of 1 costs
    /// 5 % of the force of a Hertz contact whose radius is 3 h, 1 to 3 % at 4 h to 6 h.
    pub fn of_material(young: f64, ratio: f64, shape: &DeformableShape) -> Self {
        Self::Foundation(ratio * young / shape.edge())
    }

    /// The penalty p of a body whose field has the length `inradius` (m), Pa.
    pub fn penalty(&self, inradius: f64) -> f64 {
        match self {
            Self::Penalty(p) => *p,
            Self::Foundation(kappa) => kappa * inradius,
            Self::Kept { penalty, length } => penalty * (inradius / length),
        }
    }

    /// The same pressure over depth, whatever becomes of the length of the field, which is `inradius` (m) now.
    pub(crate) fn kept(self, inradius: f64) -> Self {
        match self {
            Self::Penalty(penalty) => Self::Kept {
                penalty,
                length: inradius,
            },
            Self::Foundation(kappa) => Self::Foundation(kappa),
            Self::Kept { .. } => self,
        }
    }

    /// Checks that the value is within its range.
    pub(crate) fn check(&self) -> Result<(), ContactError> {
        match *self {
            Self::Penalty(p) => check_pressure("penalty", p),
            Self::Kept { penalty, length } => {
                check_pressure("penalty", penalty)?;
                check("length", length, length > 0.0, "positive and finite, in m")
            }
            Self::Foundation(k) => check(
                "foundation modulus",
                k,
                STIFFNESSES.contains(&k),
                "between 1e-100 and 1e100 Pa/m",
            ),
        }
    }

    /// Pressures by which the fields of A and B are multiplied, Pa: U = int (p_A phi_A + p_B phi_B) dV.
    /// `lengths` are those of the fields, m.
    ///
    /// For two penalties, both are the harmonic mean, as if each were half of a pair of equal bodies; of one that is kept,
    /// over the length that the field had. If one side is given by its foundation modulus, the harmonic mean of the foundation moduli is used.
    pub(crate) fn combine(of: [Self; 2], lengths: [f64; 2]) -> [f64; 2] {
        let harmonic = |x: f64, y: f64| 2.0 / (1.0 / x + 1.0 / y);
        // Penalties, and the lengths of the fields now over those for which they were given.
        let grown = [0, 1].map(|i| match of[i] {
            Self::Penalty(p) => Some((p, 1.0)),
            Self::Kept { penalty, length } => Some((penalty, lengths[i] / length)),
            Self::Foundation(_) => None,
        });
        if let [Some((p, a)), Some((q, b))] = grown {
            return [a, b].map(|grown| harmonic(p, q) * grown);
        }
        let kappa = [0, 1].map(|i| of[i].penalty(lengths[i]) / lengths[i]);
        lengths.map(|h| harmonic(kappa[0], kappa[1]) * h)
    }
}
