//! Shapes of bodies.

use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::Arc;

use femdem::contact::{BodyShape, ContactError, ConvexShape, Field, FieldMesh, Sphere};
use femdem::mesh::io::{self, Format, Options};
use femdem::mesh::shapes::Shape as Parametric;
use femdem::mesh::tet::{self, MeshOptions};
use femdem::mesh::{Matrix3, MeshError, Point3, Polyhedron, TetMesh, Vector3, convex_hull};
use femdem::scene::{Unit, is_ball};
use femdem::solve::checkpoint::{decode, encode};
use femdem::solve::{self, ShapeId, SolveError, World};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};

use crate::arrays::{rows, table};
use crate::error::{FemdemError, choice, refused, wrong};
use crate::threads::unlocked;

/// What a shape is. Never changed: worlds know it again by its place in memory.
#[derive(Serialize, Deserialize)]
pub struct Form {
    pub name: String,
    pub surface: Polyhedron,
    touch: Touch,
    /// Tetrahedra of its own, which deformable bodies have.
    mesh: Option<TetMesh>,
}

/// How a rigid body of a shape touches others.
#[derive(Serialize, Deserialize)]
enum Touch {
    /// By its surface, which is convex.
    Surface,
    /// By tetrahedra with a field.
    Mesh(TetMesh, Field),
    /// As the exact ball of a radius in m, of which the surface is a picture.
    Ball(f64),
    /// Not at all: it is drawn and measured only.
    Nothing,
}

impl Form {
    fn new(name: String, surface: Polyhedron, mesh_size: Option<f64>) -> Result<Self, MeshError> {
        let touch = match surface.is_convex() {
            true => Touch::Surface,
            false => Touch::Mesh(tetrahedra(&surface, mesh_size)?, Field::Body),
        };
        Ok(Self {
            name,
            surface,
            touch,
            mesh: None,
        })
    }

    /// Of tetrahedra of its own.
    fn of_mesh(name: String, mesh: TetMesh) -> Result<Self, MeshError> {
        let surface = mesh.surface()?.with_merged_faces();
        let touch = match surface.is_convex() {
            true => Touch::Surface,
            false => Touch::Mesh(mesh.clone(), Field::Body),
        };
        Ok(Self {
            name,
            surface,
            touch,
            mesh: Some(mesh),
        })
    }

    /// Whether it was made of tetrahedra.
    pub fn has_tetrahedra(&self) -> bool {
        self.mesh.is_some()
    }

    /// Its own tetrahedra, or such of a size in circumscribed diameters that fill it.
    pub fn tetrahedra(&self, size: f64) -> Result<TetMesh, MeshError> {
        match &self.mesh {
            Some(mesh) => Ok(mesh.clone()),
            None => tetrahedra(&self.surface, Some(size)),
        }
    }

    /// For a batch of contacts: about its centroid, in its own axes.
    pub fn contact(&self) -> Result<BodyShape, ContactError> {
        Ok(match &self.touch {
            Touch::Ball(radius) => Sphere::new(*radius)?.into(),
            Touch::Mesh(mesh, field) => FieldMesh::new(mesh, self.centroid(), *field)?.into(),
            Touch::Surface | Touch::Nothing => ConvexShape::new(&self.surface)?.into(),
        })
    }

    /// Centroid, m.
    pub fn centroid(&self) -> Vector3 {
        match self.touch {
            Touch::Ball(_) => Vector3::zeros(),
            _ => self.surface.mass_properties().centroid.coords,
        }
    }

    /// Volume, m^3.
    fn volume(&self) -> f64 {
        match self.touch {
            Touch::Ball(radius) => 4.0 / 3.0 * PI * radius.powi(3),
            _ => self.surface.mass_properties().volume,
        }
    }

    /// Mass (kg) at a density (kg/m^3), and the inertia about the centroid in its own axes (kg m^2).
    pub fn mass(&self, density: f64) -> (f64, Matrix3) {
        let mass = density * self.volume();
        let inertia = match self.touch {
            Touch::Ball(radius) => Matrix3::from_diagonal_element(0.4 * mass * radius * radius),
            _ => self.surface.mass_properties().inertia * density,
        };
        (mass, inertia)
    }

    /// Adds it to a world.
    pub fn add_to(&self, world: &mut World) -> Result<ShapeId, SolveError> {
        match &self.touch {
            Touch::Ball(radius) => world.add_sphere(&self.name, *radius),
            Touch::Mesh(mesh, field) => {
                world.add_mesh_shape(&self.name, &self.surface, mesh, *field)
            }
            Touch::Surface | Touch::Nothing => world.add_shape(&self.name, &self.surface),
        }
    }
}

impl From<&solve::Shape> for Form {
    fn from(shape: &solve::Shape) -> Self {
        let touch = match (&shape.mesh, shape.sphere) {
            (_, Some(radius)) => Touch::Ball(radius),
            (Some((mesh, field)), None) => Touch::Mesh(mesh.clone(), *field),
            (None, None) => Touch::Surface,
        };
        Self {
            name: shape.name.clone(),
            surface: shape.polyhedron.clone(),
            touch,
            mesh: None,
        }
    }
}

/// Tetrahedra that fill a surface; their size is in circumscribed diameters.
fn tetrahedra(surface: &Polyhedron, size: Option<f64>) -> Result<TetMesh, MeshError> {
    let options = MeshOptions {
        edge_length: size.map(|size| size * 2.0 * surface.bounding_radius()),
        ..MeshOptions::default()
    };
    Ok(tet::mesh(surface, &options)?.0)
}

/// A closed surface.
#[pyclass(frozen, module = "femdem._femdem")]
pub struct Shape {
    form: Arc<Form>,
}

impl From<Arc<Form>> for Shape {
    fn from(form: Arc<Form>) -> Self {
        Self { form }
    }
}

impl From<Form> for Shape {
    fn from(form: Form) -> Self {
        Arc::new(form).into()
    }
}

impl Shape {
    /// A surface in results: what is kept of it does not tell how it touches others.
    pub fn picture(name: String, surface: Polyhedron) -> Self {
        let touch = Touch::Nothing;
        Form {
            name,
            surface,
            touch,
            mesh: None,
        }
        .into()
    }

    /// For bodies.
    pub fn solid(&self) -> PyResult<&Arc<Form>> {
        if self.is_picture() {
            return Err(FemdemError::new_err(format!(
                "the shape {:?} of a result is drawn and measured only: take it from the shapes of its world",
                self.form.name
            )));
        }
        Ok(&self.form)
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
            let (name, surface) = (shape.to_string(), own.scaled(by)?);
            if is_ball(&text) {
                let touch = Touch::Ball(surface.bounding_radius());
                return Ok(Form {
                    name,
                    surface,
                    touch,
                    mesh: None,
                });
            }
            Form::new(name, surface, mesh_size)
        })?;
        Ok(form.into())
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
            Form::new(name, surface, mesh_size)
        })?;
        Ok(form.into())
    }

    /// A body of tetrahedra.
    #[staticmethod]
    fn of_tetrahedra(
        py: Python<'_>,
        name: String,
        points: &Bound<'_, PyAny>,
        tets: Vec<[u32; 4]>,
    ) -> PyResult<Self> {
        let points = rows::<3>("points", points)?;
        let points: Vec<Point3> = points.into_iter().map(Point3::from).collect();
        let form = unlocked(py, || Form::of_mesh(name, TetMesh::new(points, tets)?))?;
        Ok(form.into())
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
        let unit: Unit = choice("unit", unit)?;
        let stem = path.file_stem().unwrap_or_default();
        let stem = stem.to_string_lossy().into_owned();
        if path.extension().is_some_and(|own| own == "msh") {
            if repair || mesh_size.is_some() {
                return Err(FemdemError::new_err(
                    "repair and mesh_size are for surfaces: leave them out, a file .msh has tetrahedra",
                ));
            }
            let form = unlocked(py, || {
                let own = io::msh::read_file(&path)?;
                let by = match diameter {
                    Some(diameter) => diameter / (2.0 * own.surface()?.bounding_radius()),
                    None => unit.metres(),
                };
                let points = own.points().iter().map(|point| point * by).collect();
                Form::of_mesh(stem, TetMesh::new(points, own.tets().to_vec())?)
            })?;
            return Ok(form.into());
        }
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
            Form::new(stem, surface, mesh_size)
        })?;
        Ok(form.into())
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
        self.form.volume()
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
        matches!(self.form.touch, Touch::Ball(_))
    }

    #[getter]
    fn is_picture(&self) -> bool {
        matches!(self.form.touch, Touch::Nothing)
    }

    #[getter]
    fn centroid<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.form.centroid().as_slice())
    }

    /// What makes an equal shape.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = encode(&*self.form).map_err(refused)?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let form: Form = decode(bytes).map_err(refused)?;
        Ok(form.into())
    }
}
