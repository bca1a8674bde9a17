//! Shapes of bodies.

use std::path::PathBuf;
use std::sync::Arc;

use femdem::contact::Field;
use femdem::mesh::io::{self, Format, Options};
use femdem::mesh::shapes::Shape as Parametric;
use femdem::mesh::tet::{self, MeshOptions};
use femdem::mesh::{MeshError, Point3, Polyhedron, TetMesh, convex_hull};
use femdem::scene::{Unit, is_ball};
use femdem::solve::{ShapeId, SolveError, World};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{rows, table};
use crate::error::{options, refused, unlocked, wrong};

/// What a shape is. Never changed: worlds know it again by its place in memory.
pub struct Form {
    pub name: String,
    pub surface: Polyhedron,
    /// Tetrahedra for the contacts of a rigid body that is not convex.
    pub mesh: Option<TetMesh>,
    /// Whether it is the exact ball, of which `surface` is a picture.
    pub is_ball: bool,
}

impl Form {
    fn new(
        name: String,
        surface: Polyhedron,
        is_ball: bool,
        mesh_size: Option<f64>,
    ) -> Result<Self, MeshError> {
        let mesh = match surface.is_convex() {
            true => None,
            false => Some(tetrahedra(&surface, mesh_size)?),
        };
        Ok(Self {
            name,
            surface,
            mesh,
            is_ball,
        })
    }

    /// Adds it to a world.
    pub fn add_to(&self, world: &mut World) -> Result<ShapeId, SolveError> {
        match &self.mesh {
            _ if self.is_ball => world.add_sphere(&self.name, self.surface.bounding_radius()),
            Some(mesh) => world.add_mesh_shape(&self.name, &self.surface, mesh, Field::Body),
            None => world.add_shape(&self.name, &self.surface),
        }
    }
}

/// Tetrahedra that fill a surface; their size is in circumscribed diameters.
pub fn tetrahedra(surface: &Polyhedron, size: Option<f64>) -> Result<TetMesh, MeshError> {
    let options = MeshOptions {
        edge_length: size.map(|size| size * 2.0 * surface.bounding_radius()),
        ..MeshOptions::default()
    };
    Ok(tet::mesh(surface, &options)?.0)
}

/// Nodes and tetrahedra.
type Tets = (Vec<[f64; 3]>, Vec<[u32; 4]>);

/// Name, vertices, faces, whether it is a ball, and tetrahedra.
type Parts<'py> = (
    String,
    Bound<'py, PyArray2<f64>>,
    Vec<Vec<u32>>,
    bool,
    Option<Tets>,
);

/// A closed surface.
#[pyclass(frozen, module = "femdem._femdem")]
pub struct Shape {
    pub form: Arc<Form>,
}

impl Shape {
    /// A surface that is drawn and measured only.
    pub fn shown(name: String, surface: Polyhedron) -> Self {
        let form = Form {
            name,
            surface,
            mesh: None,
            is_ball: false,
        };
        Self {
            form: Arc::new(form),
        }
    }
}

#[pymethods]
impl Shape {
    /// A parametric shape by its size or its circumscribed diameter.
    #[staticmethod]
    fn named(
        py: Python<'_>,
        text: String,
        size: Option<f64>,
        diameter: Option<f64>,
        mesh_size: Option<f64>,
    ) -> PyResult<Self> {
        let length = match (size, diameter) {
            (Some(length), None) | (None, Some(length)) => length,
            _ => {
                return Err(wrong(
                    "size and diameter",
                    "none or both",
                    "give one of the two, in m",
                ));
            }
        };
        if !(length > 0.0 && length.is_finite()) {
            let name = if size.is_some() { "size" } else { "diameter" };
            return Err(wrong(name, length, "a positive, finite length, in m"));
        }
        let form = unlocked(py, || {
            let shape: Parametric = text.parse()?;
            let own = shape.polyhedron(1.0)?;
            let by = if size.is_some() {
                length
            } else {
                length / (2.0 * own.bounding_radius())
            };
            Form::new(
                shape.to_string(),
                own.scaled(by)?,
                is_ball(&text),
                mesh_size,
            )
        })?;
        Ok(Self {
            form: Arc::new(form),
        })
    }

    /// A surface of vertices and faces, or the convex hull of points.
    #[staticmethod]
    fn of_arrays(
        py: Python<'_>,
        name: String,
        vertices: &Bound<'_, PyAny>,
        faces: Option<Vec<Vec<u32>>>,
        mesh_size: Option<f64>,
    ) -> PyResult<Self> {
        let vertices = rows::<3>("vertices", vertices)?;
        let points: Vec<Point3> = vertices.into_iter().map(Point3::from).collect();
        let form = unlocked(py, || {
            let surface = match faces {
                Some(faces) => Polyhedron::new(points, faces)?,
                None => convex_hull(&points)?,
            };
            Form::new(name, surface, false, mesh_size)
        })?;
        Ok(Self {
            form: Arc::new(form),
        })
    }

    /// A surface from a file.
    #[staticmethod]
    fn of_file(
        py: Python<'_>,
        path: PathBuf,
        unit: &str,
        repair: bool,
        diameter: Option<f64>,
        mesh_size: Option<f64>,
    ) -> PyResult<Self> {
        let unit: Unit = options("unit", &format!("{unit:?}"))?;
        let reading = if repair {
            Options::REPAIR
        } else {
            Options::default()
        };
        let form = unlocked(py, || {
            let (own, _) = io::read_file_with(&path, &reading)?;
            let by = match diameter {
                Some(diameter) => diameter / (2.0 * own.bounding_radius()),
                None => unit.metres(),
            };
            let surface = if by == 1.0 { own } else { own.scaled(by)? };
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            Form::new(stem.into_owned(), surface, false, mesh_size)
        })?;
        Ok(Self {
            form: Arc::new(form),
        })
    }

    /// Writes the surface into a file.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        unlocked(py, || {
            let format = Format::of_path(&path)?;
            let (body, to) = (&self.form.surface, std::fs::File::create(&path)?);
            match format {
                Format::Obj => io::obj::write(body, to),
                Format::Stl => io::stl::write_binary(body, to),
                Format::Off => io::off::write(body, to),
                Format::Ply => io::ply::write(body, to),
            }
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.form.name
    }

    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        table(
            py,
            self.form
                .surface
                .vertices()
                .iter()
                .map(|x| <[f64; 3]>::from(x.coords)),
        )
    }

    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        table(py, self.form.surface.triangles())
    }

    #[getter]
    fn faces(&self) -> Vec<Vec<u32>> {
        self.form.surface.faces().map(<[u32]>::to_vec).collect()
    }

    #[getter]
    fn volume(&self) -> f64 {
        if self.form.is_ball {
            return 4.0 / 3.0 * std::f64::consts::PI * self.form.surface.bounding_radius().powi(3);
        }
        self.form.surface.mass_properties().volume
    }

    #[getter]
    fn area(&self) -> f64 {
        self.form.surface.area()
    }

    #[getter]
    fn diameter(&self) -> f64 {
        2.0 * self.form.surface.bounding_radius()
    }

    #[getter]
    fn is_convex(&self) -> bool {
        self.form.surface.is_convex()
    }

    #[getter]
    fn is_ball(&self) -> bool {
        self.form.is_ball
    }

    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let centroid = self.form.surface.mass_properties().centroid;
        PyArray1::from_slice(py, centroid.coords.as_slice())
    }

    /// What makes an equal shape.
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Parts<'py>> {
        let Form {
            name,
            mesh,
            is_ball,
            ..
        } = &*self.form;
        let mesh = mesh.as_ref().map(|mesh| {
            let points = mesh.points().iter().map(|x| <[f64; 3]>::from(x.coords));
            (points.collect(), mesh.tets().to_vec())
        });
        Ok((
            name.clone(),
            self.vertices(py)?,
            self.faces(),
            *is_ball,
            mesh,
        ))
    }

    /// A shape from the parts of another one.
    #[staticmethod]
    fn of_parts(
        name: String,
        vertices: &Bound<'_, PyAny>,
        faces: Vec<Vec<u32>>,
        is_ball: bool,
        mesh: Option<Tets>,
    ) -> PyResult<Self> {
        let points = |list: Vec<[f64; 3]>| list.into_iter().map(Point3::from).collect::<Vec<_>>();
        let surface =
            Polyhedron::new(points(rows::<3>("vertices", vertices)?), faces).map_err(refused)?;
        let mesh = mesh.map(|(nodes, tets)| TetMesh::new(points(nodes), tets));
        let mesh = mesh.transpose().map_err(refused)?;
        let form = Form {
            name,
            surface,
            mesh,
            is_ball,
        };
        Ok(Self {
            form: Arc::new(form),
        })
    }
}
