//! Test bodies in all representations that the kernels take.

use crate::error::ContactError;
use crate::general::{Field, FieldMesh};
use crate::shape::ConvexShape;
use femdem_mesh::strategies::{catalogue_shapes, convex_polyhedra};
use femdem_mesh::{Point3, Polyhedron, TetMesh, Vector3};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

/// A body in all representations that the kernels take, about its centroid.
#[derive(Clone, PartialEq)]
pub struct TestBody {
    /// The surface of a convex body.
    pub surface: Option<Arc<Polyhedron>>,
    /// A convex body, for [`PairKernel`](crate::PairKernel).
    pub convex: Option<Arc<ConvexShape>>,
    /// The body as tetrahedra, in coordinates about its centroid.
    pub mesh: Arc<TetMesh>,
    /// The tetrahedra with a field: the gauge field for convex bodies (so that both kernels give the same
    /// results), the body field for others.
    pub field: Arc<FieldMesh>,
}

impl fmt::Debug for TestBody {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("TestBody")
            .field("convex", &self.convex.is_some())
            .field("points", &self.mesh.points())
            .field("tets", &self.mesh.tets())
            .finish()
    }
}

impl TestBody {
    /// A convex body.
    ///
    /// # Errors
    /// As [`ConvexShape::new`] and [`FieldMesh::from_convex`].
    pub fn from_convex(polyhedron: &Polyhedron) -> Result<Self, ContactError> {
        let centroid = polyhedron.mass_properties().centroid.coords;
        let vertices = polyhedron.vertices().iter().map(|v| v - centroid).collect();
        let faces = polyhedron.faces().map(<[u32]>::to_vec).collect();
        let surface = Polyhedron::new(vertices, faces)?;
        let mesh = TetMesh::centroid_fan(&surface)?;
        Ok(Self {
            convex: Some(Arc::new(ConvexShape::new(&surface)?)),
            field: Arc::new(FieldMesh::from_convex(&surface)?),
            surface: Some(Arc::new(surface)),
            mesh: Arc::new(mesh),
        })
    }

    /// A body of any shape, with the body field.
    ///
    /// # Errors
    /// As [`FieldMesh::new`], and [`ContactError::Mesh`] if the mesh cannot be moved to its
    /// centroid.
    pub fn from_mesh(mesh: &TetMesh) -> Result<Self, ContactError> {
        let centroid = mesh.mass_properties().centroid.coords;
        let points = mesh.points().iter().map(|p| p - centroid).collect();
        let mesh = TetMesh::new(points, mesh.tets().to_vec())?;
        let field = FieldMesh::new(&mesh, Vector3::zeros(), Field::Body)?;
        Ok(Self {
            surface: None,
            convex: None,
            mesh: Arc::new(mesh),
            field: Arc::new(field),
        })
    }

    /// The body with all lengths multiplied.
    ///
    /// # Errors
    /// [`ContactError::Mesh`] if the result is too large or too small for a mesh.
    pub fn scaled(&self, factor: f64) -> Result<Self, ContactError> {
        if let Some(surface) = &self.surface {
            return Self::from_convex(&surface.scaled(factor)?);
        }
        let points = self.mesh.points().iter().map(|p| p * factor).collect();
        Self::from_mesh(&TetMesh::new(points, self.mesh.tets().to_vec())?)
    }

    /// Largest distance of a point from the centroid, m.
    pub fn radius(&self) -> f64 {
        self.field.radius()
    }
}

/// Convex bodies of a radius near 1 m: solids of the catalogue, boxes and hulls of random points.
pub fn convex_bodies() -> impl Strategy<Value = TestBody> + Clone {
    let solids = catalogue_shapes().prop_filter_map("in the catalogue", |s| s.polyhedron(2.0).ok());
    let boxes = prop::array::uniform3(0.2..1.0_f64).prop_filter_map("a box", |sides| {
        let corner = |i: usize| {
            Point3::from([0, 1, 2].map(|k| if i >> k & 1 == 1 { sides[k] } else { -sides[k] }))
        };
        femdem_mesh::convex_hull(&(0..8).map(corner).collect::<Vec<_>>()).ok()
    });
    let surfaces = prop_oneof![2 => solids, 1 => boxes, 2 => convex_polyhedra()];
    surfaces
        .prop_filter_map("a convex body", |s| TestBody::from_convex(&s).ok())
        .boxed()
}

/// Bodies of a radius near 1 m that are not convex: cubes joined at their faces, on the lattice or
/// with moved corners; pellets with a hole; stars.
pub fn non_convex_bodies() -> impl Strategy<Value = TestBody> + Clone {
    prop_oneof![3 => joined_cubes(), 1 => pellets(), 1 => stars()]
        .prop_filter_map("a meshed body", |mesh| TestBody::from_mesh(&mesh).ok())
        .prop_filter("not convex", |body| !body.field.is_convex())
        .boxed()
}

/// Bodies of either kind.
pub fn bodies() -> impl Strategy<Value = TestBody> + Clone {
    prop_oneof![convex_bodies(), non_convex_bodies()].boxed()
}

type Node = [i32; 3];

/// The paths along the axes from the lowest to the highest corner of a cell: its six tetrahedra.
const PATHS: [[usize; 3]; 6] = [
    [0, 1, 2],
    [0, 2, 1],
    [1, 0, 2],
    [1, 2, 0],
    [2, 0, 1],
    [2, 1, 0],
];

/// The six tetrahedra of every cell. `name` may identify several nodes by one name; `place` gives the
/// position of a name.
fn mesh_of_cells(
    cells: &BTreeSet<Node>,
    name: impl Fn(Node) -> Node,
    place: impl Fn(Node) -> Vector3,
) -> Option<TetMesh> {
    let mut known: BTreeMap<Node, u32> = BTreeMap::new();
    let mut points: Vec<Point3> = Vec::new();
    let mut tets = Vec::new();
    for cell in cells {
        for path in PATHS {
            let mut node = *cell;
            let mut tet = [0; 4];
            for (k, corner) in tet.iter_mut().enumerate() {
                let key = name(node);
                *corner = *known.entry(key).or_insert_with(|| {
                    points.push(Point3::from(place(key)));
                    points.len() as u32 - 1
                });
                if let Some(&axis) = path.get(k) {
                    node[axis] += 1;
                }
            }
            let [a, b, c, d] = tet.map(|i| points[i as usize]);
            if (b - a).dot(&(c - a).cross(&(d - a))) < 0.0 {
                tet.swap(2, 3);
            }
            tets.push(tet);
        }
    }
    TetMesh::new(points, tets).ok()
}

/// Two to seven cubes, each on a face of an earlier one.
fn joined_cubes() -> impl Strategy<Value = TetMesh> {
    let steps = prop::collection::vec((any::<prop::sample::Index>(), 0..6_usize), 2..=6);
    let shifts = prop::collection::vec(prop::array::uniform3(-0.15..0.15_f64), 64);
    (steps, prop::option::of(shifts)).prop_filter_map("joined cubes", |(steps, shifts)| {
        let mut cells = vec![[0; 3]];
        for (from, side) in steps {
            let mut cell = *from.get(&cells);
            cell[side / 2] += if side % 2 == 0 { 1 } else { -1 };
            cells.push(cell);
        }
        let shift = |[x, y, z]: Node| {
            let place = (x * 25 + y * 5 + z).rem_euclid(64) as usize;
            let own = shifts.as_ref().and_then(|s| s.get(place));
            own.map_or(Vector3::zeros(), |s| Vector3::from(*s))
        };
        let place = |n: Node| (Vector3::from(n.map(f64::from)) + shift(n)) * 0.5;
        let mesh = mesh_of_cells(&cells.into_iter().collect(), |n| n, place)?;
        mesh.surface().is_ok().then_some(mesh)
    })
}

/// Prisms with a hole along z.
fn pellets() -> impl Strategy<Value = TetMesh> {
    (4..10_i32, 0.2..0.8_f64, 0.3..1.5_f64).prop_filter_map("a pellet", |(sides, hole, height)| {
        let cells = (0..sides).map(|k| [0, k, 0]).collect();
        let place = |[i, k, j]: Node| {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(sides)).sin_cos();
            let r = if i == 0 { hole } else { 1.0 };
            Vector3::new(r * cos, r * sin, height * f64::from(j))
        };
        mesh_of_cells(&cells, |[i, k, j]| [i, k % sides, j], place)
    })
}

/// Solids of the catalogue with their vertices moved inwards or outwards along the radius.
fn stars() -> impl Strategy<Value = TetMesh> {
    let radii = prop::collection::vec(0.5..1.0_f64, 12);
    (catalogue_shapes(), radii).prop_filter_map("a star", |(solid, radii)| {
        let hull = solid.polyhedron(2.0).ok()?;
        let mut points: Vec<Point3> = hull.vertices().to_vec();
        for (i, p) in points.iter_mut().enumerate() {
            *p *= radii[i % radii.len()];
        }
        points.push(Point3::origin());
        let centre = points.len() as u32 - 1;
        let tets = hull
            .triangles()
            .into_iter()
            .map(|[a, b, c]| [centre, a, b, c]);
        TetMesh::new(points, tets.collect()).ok()
    })
}
