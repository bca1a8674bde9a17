//! Surfaces and tetrahedra of the bodies of a scenario.

use std::path::{Path, PathBuf};

use femdem_mesh::io::{self, Report};
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::{self, MeshOptions};
use femdem_mesh::{Point3, Polyhedron, TetMesh, Vector3};

use super::BodyEntry;
use crate::Error;
use crate::error::wrong;
use crate::scene::{ShapeNote, Unit, is_ball, surface};

/// Edge length of the tetrahedra of deformable bodies, in circumscribed diameters.
const DEFAULT_MESH_SIZE: f64 = 0.2;

/// Meshes whose volume is that of their surface to this, relative, are exact.
const EXACT: f64 = 1e-9;

/// The geometry described by an entry.
pub(super) struct Geometry {
    /// Name of the shape.
    pub name: String,
    pub surface: Polyhedron,
    /// Tetrahedra, if the entry or its behaviour needs them.
    pub mesh: Option<TetMesh>,
    /// Whether the body is the exact ball around the surface.
    pub is_ball: bool,
    /// How the surface was read and meshed.
    pub note: Option<ShapeNote>,
}

/// A surface in the size of its entry.
struct Source {
    name: String,
    surface: Polyhedron,
    /// The file that it was read from, and what reading did.
    file: Option<(PathBuf, Unit, Report)>,
}

impl Geometry {
    /// [`density_factor`] of its tetrahedra.
    pub fn density_factor(&self) -> f64 {
        let mesh = self.mesh.as_ref();
        mesh.map_or(1.0, |mesh| density_factor(&self.surface, mesh))
    }
}

/// By how much the density of tetrahedra must be larger than that of the material for the body to have the mass
/// that its surface encloses: a mesh that is not exact cuts off what is convex.
#[must_use]
pub fn density_factor(surface: &Polyhedron, mesh: &TetMesh) -> f64 {
    let factor = surface.mass_properties().volume / mesh.volume();
    if (factor - 1.0).abs() > EXACT {
        factor
    } else {
        1.0
    }
}

impl BodyEntry {
    pub(super) fn geometry(&self) -> Result<Geometry, Error> {
        match (&self.shape, &self.mesh, &self.block) {
            (Some(text), None, None) => self.of_surface(text),
            (None, ..) if self.focus.is_some() => Err(wrong(
                "focus",
                "given",
                "give it with a shape that is a sphere only",
            )),
            (None, Some(path), None) => {
                let by = self.unit.metres();
                let mesh = moved(&io::msh::read_file(path)?, |p| p * by)?;
                Geometry::of_mesh(stem(path), mesh)
            }
            (None, None, Some(cells)) => {
                let Some(sides) = self.sides.map(Vector3::from) else {
                    return Err(wrong("sides", "none", "give the sides of the block, in m"));
                };
                let mesh = TetMesh::block(*cells, &sides)?;
                Geometry::of_mesh("block".to_owned(), moved(&mesh, |p| p - 0.5 * sides)?)
            }
            _ => Err(wrong(
                "body",
                "none or several of its kinds",
                "give exactly one of shape, mesh and block",
            )),
        }
    }

    /// Whether another entry has the same surface and tetrahedra.
    pub(super) fn has_geometry_of(&self, other: &Self) -> bool {
        let key = |entry: &Self| {
            let files = (entry.shape.clone(), entry.mesh.clone());
            let reading = (entry.unit, entry.repair);
            let sizes = (entry.block, entry.sides, entry.diameter, entry.size);
            let sized = entry.poses.is_some();
            let meshing = (entry.mesh_size, entry.focus, entry.behaviour.is_meshed());
            (files, reading, sizes, sized, meshing)
        };
        key(self) == key(other)
    }

    fn of_surface(&self, text: &str) -> Result<Geometry, Error> {
        let Source {
            name,
            surface,
            file,
        } = self.surface(text)?;
        let deforms = self.behaviour.is_meshed();
        if let Some(size) = self.mesh_size
            && !deforms
            && surface.is_convex()
        {
            return Err(wrong(
                "mesh-size",
                &size.to_string(),
                "a rigid body that is convex has no tetrahedra: take it out",
            ));
        }
        let label = if file.is_some() { &name } else { text };
        let note = |mesh| ShapeNote::new(label.to_owned(), file.clone(), &surface, mesh);
        if !deforms && surface.is_convex() {
            let note = Some(note(None));
            return Ok(Geometry {
                name,
                surface,
                mesh: None,
                is_ball: is_ball(text),
                note,
            });
        }
        let size = self.mesh_size.or(deforms.then_some(DEFAULT_MESH_SIZE));
        let options = MeshOptions {
            edge_length: size.map(|size| size * 2.0 * surface.bounding_radius()),
            ..MeshOptions::default()
        };
        let named = |problem| match &file {
            Some((path, ..)) => surface::in_file(path, problem),
            None => problem,
        };
        let (mesh, report) = tet::mesh(&surface, &options).map_err(named)?;
        let (mesh, note) = match &self.focus {
            // The report is that of the mesh before its nodes were moved.
            Some(focus) => {
                let mesh = focus.of_sphere(&mesh, surface.bounding_radius(), text)?;
                (mesh, note(None))
            }
            None => (mesh, note(Some(report))),
        };
        Ok(Geometry {
            name,
            surface,
            mesh: Some(mesh),
            is_ball: false,
            note: Some(note),
        })
    }

    fn surface(&self, text: &str) -> Result<Source, Error> {
        let (name, own, file) = match text.parse::<Shape>() {
            Ok(shape) => (shape.name(), shape.polyhedron(1.0)?, None),
            Err(unknown) => {
                let path = Path::new(text);
                // A parameter out of its range may look like the ending of a file's name, as in ".001".
                let of_file = io::Format::of_path(path).is_ok();
                if !of_file && !path.exists() {
                    return Err(unknown.into());
                }
                let (surface, report) = surface::read(path, self.unit, self.repair)?;
                let file = (path.to_path_buf(), self.unit, report);
                (stem(path), surface, Some(file))
            }
        };
        let by = match (self.diameter, self.size) {
            (Some(diameter), None) => diameter / (2.0 * own.bounding_radius()),
            (None, Some(size)) if file.is_none() => size,
            (None, None) if file.is_some() => 1.0,
            // The table of poses has the sizes.
            (None, None) if self.poses.is_some() => 0.5 / own.bounding_radius(),
            _ => {
                return Err(wrong(
                    "diameter and size",
                    "none, both, or size for a file",
                    "give one of the two for a parametric shape; for a file diameter or none",
                ));
            }
        };
        let lengths = [("diameter", self.diameter), ("size", self.size)];
        for (name, length) in lengths {
            if let Some(length) = length.filter(|length| !(*length > 0.0 && length.is_finite())) {
                let allowed = "a positive, finite length, in m";
                return Err(wrong(name, &length.to_string(), allowed));
            }
        }
        Ok(Source {
            name,
            surface: own.scaled(by)?,
            file,
        })
    }
}

impl Geometry {
    /// The same in another size.
    pub fn scaled(&self, by: f64) -> Result<Self, Error> {
        let mesh = self.mesh.as_ref().map(|mesh| moved(mesh, |p| p * by));
        Ok(Self {
            name: self.name.clone(),
            surface: self.surface.scaled(by)?,
            mesh: mesh.transpose()?,
            is_ball: self.is_ball,
            note: None,
        })
    }

    fn of_mesh(name: String, mesh: TetMesh) -> Result<Self, Error> {
        Ok(Self {
            name,
            surface: mesh.surface()?,
            mesh: Some(mesh),
            is_ball: false,
            note: None,
        })
    }
}

fn stem(path: &Path) -> String {
    path.file_stem()
        .map_or_else(|| "body".to_owned(), |s| s.to_string_lossy().into_owned())
}

fn moved(mesh: &TetMesh, to: impl Fn(Point3) -> Point3) -> Result<TetMesh, Error> {
    let points = mesh.points().iter().map(|p| to(*p)).collect();
    Ok(TetMesh::new(points, mesh.tets().to_vec())?)
}
