//! Shapes of bodies.

use std::ffi::c_char;
use std::mem::MaybeUninit;
use std::sync::{Arc, OnceLock};

use femdem_solve::contact::{BodyShape, ContactError, ConvexShape, Field, FieldMesh, Sphere};
use femdem_solve::mesh::shapes::Shape as Parametric;
use femdem_solve::mesh::tet::{self, MeshOptions};
use femdem_solve::mesh::{MassProperties, Matrix3, Point3, Polyhedron, Pose, TetMesh, Vector3};
use femdem_solve::mesh::{convex_hull, io};
use femdem_solve::{ShapeId, SolveError, World};

use crate::border::{Failure, FemdemStatus, border, list, place, room, text};
use crate::handles::FemdemShape;

/// Centroids within this part of the radius of the origin are there to rounding.
const CENTRED: f64 = 1e-12;

/// A shape with what contacts need of it. The origin of its coordinates is its centroid.
pub(crate) struct Form {
    name: String,
    surface: Polyhedron,
    /// The centroid in the coordinates that were given, m.
    centroid: Vector3,
    /// Tetrahedra with their field, of a body that is not convex.
    mesh: Option<(TetMesh, Field)>,
    pub contact: BodyShape,
    /// A convex one as tetrahedra, made once a mesh meets it.
    fan: OnceLock<Result<Arc<FieldMesh>, ContactError>>,
}

impl Form {
    /// `mesh_size` is the size of the tetrahedra of a body that is not convex over its diameter; 0: that of the mesher.
    fn new(name: &str, surface: Polyhedron, mesh_size: f64) -> Result<Self, Failure> {
        if !(0.0..=1.0).contains(&mesh_size) {
            let allowed = "above 0 and at most 1, in diameters; 0 for that of the mesher";
            return Err(Failure::refused("mesh_size", mesh_size, allowed));
        }
        let centroid = surface.mass_properties().centroid.coords;
        let surface = if centroid.norm() > CENTRED * surface.bounding_radius() {
            surface.transformed(&Pose::from(-centroid))?
        } else {
            surface
        };
        let (mesh, contact) = if surface.is_convex() {
            (None, BodyShape::from(ConvexShape::new(&surface)?))
        } else {
            let length = mesh_size * 2.0 * surface.bounding_radius();
            let options = MeshOptions {
                edge_length: (mesh_size > 0.0).then_some(length),
                ..MeshOptions::default()
            };
            let (mesh, _) = tet::mesh(&surface, &options)?;
            let origin = surface.mass_properties().centroid.coords;
            let contact = FieldMesh::new(&mesh, origin, Field::Body)?;
            (Some((mesh, Field::Body)), BodyShape::from(contact))
        };
        Ok(Self {
            name: name.to_owned(),
            surface,
            centroid,
            mesh,
            contact,
            fan: OnceLock::new(),
        })
    }

    /// The exact ball of a radius in m, of which the surface is a picture.
    fn ball(name: &str, surface: Polyhedron, radius: f64) -> Result<Self, Failure> {
        let contact = BodyShape::from(Sphere::new(radius)?);
        Ok(Self {
            name: name.to_owned(),
            surface,
            centroid: Vector3::zeros(),
            mesh: None,
            contact,
            fan: OnceLock::new(),
        })
    }

    /// Adds it to a world.
    pub fn add_to(&self, world: &mut World) -> Result<ShapeId, SolveError> {
        match (self.contact.sphere(), &self.mesh) {
            (Some(ball), _) => world.add_sphere(&self.name, ball.radius()),
            (None, Some((mesh, field))) => {
                world.add_mesh_shape(&self.name, &self.surface, mesh, *field)
            }
            (None, None) => world.add_shape(&self.name, &self.surface),
        }
    }

    /// Tetrahedra of a body that is no ball.
    pub fn tetrahedra(&self) -> Result<Option<Arc<FieldMesh>>, ContactError> {
        match &self.contact {
            BodyShape::Mesh(mesh) => Ok(Some(Arc::clone(mesh))),
            BodyShape::Sphere(_) => Ok(None),
            BodyShape::Convex(convex) => {
                let fan = self.fan.get_or_init(|| convex.fan().map(Arc::new));
                fan.clone().map(Some)
            }
        }
    }

    /// Volume and inertia at unit density.
    pub fn mass(&self) -> MassProperties {
        match self.contact.sphere() {
            Some(ball) => {
                let (radius, centroid) = (ball.radius(), Point3::origin());
                let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
                let inertia = Matrix3::identity() * (0.4 * volume * radius * radius);
                MassProperties {
                    volume,
                    centroid,
                    inertia,
                }
            }
            None => *self.surface.mass_properties(),
        }
    }
}

/// A shape as numbers.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemShapeProperties {
    /// m^3.
    pub volume: f64,
    /// Of the surface, m^2.
    pub area: f64,
    /// Largest distance of a point from the centroid, m.
    pub radius: f64,
    /// Where the centroid was in the coordinates that were given, m. In those of the shape it is the origin.
    pub centroid: [f64; 3],
    /// Inertia tensor about the centroid at a density of 1 kg/m^3, row by row, kg m^2.
    pub inertia: [f64; 9],
    /// 0: convex, 1: an exact ball, 2: filled with tetrahedra.
    pub kind: i32,
    /// Vertices of the surface; of a ball, of its picture.
    pub vertex_count: u32,
    /// Triangles of the surface; of a ball, of its picture.
    pub triangle_count: u32,
}

/// Makes a shape by its name, such as "cube", "A10", "dolos" or "box:width=0.5", of a size in m. What the size of a shape
/// is stands in the book: of solids it is the diameter of the sphere around them. A "sphere" without a level is the exact ball.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_shape_named(
    name: *const c_char,
    size: f64,
    mesh_size: f64,
    shape: Option<&mut MaybeUninit<FemdemShape>>,
) -> FemdemStatus {
    border(|| {
        // SAFETY: as the caller promises.
        let name = unsafe { text("name", name)? };
        let shape = place("shape", shape)?;
        let parametric: Parametric = name.parse()?;
        let surface = parametric.polyhedron(size)?;
        // With a level it is a polyhedron.
        let form = match parametric {
            Parametric::Sphere(_) if !name.contains(':') => Form::ball(name, surface, 0.5 * size)?,
            _ => Form::new(name, surface, mesh_size)?,
        };
        shape.write(FemdemShape::new(form));
        Ok(())
    })
}

/// Three numbers for each of `count` points.
pub(crate) unsafe fn points(
    name: &str,
    start: *const f64,
    count: usize,
) -> Result<Vec<Point3>, Failure> {
    // SAFETY: an array of three numbers has the layout of three numbers; the rest the caller promises.
    let rows = unsafe { list(name, start.cast::<[f64; 3]>(), count)? };
    Ok(rows.iter().map(|row| Point3::from(*row)).collect())
}

/// Makes a shape of a closed surface: `vertex_count` vertices, three coordinates in m each, and `triangle_count` triangles,
/// three numbers of vertices each, counter-clockwise from outside. Any shape will do; triangles in one plane become one face.
/// `mesh_size` is the size of the tetrahedra of a body that is not convex over its diameter; 0: chosen.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_shape_surface(
    vertices: *const f64,
    vertex_count: usize,
    triangles: *const u32,
    triangle_count: usize,
    mesh_size: f64,
    shape: Option<&mut MaybeUninit<FemdemShape>>,
) -> FemdemStatus {
    border(|| {
        let shape = place("shape", shape)?;
        // SAFETY: as the caller promises.
        let vertices = unsafe { points("vertices", vertices, vertex_count)? };
        // SAFETY: an array of three numbers has the layout of three numbers; the rest the caller promises.
        let corners = unsafe { list("triangles", triangles.cast::<[u32; 3]>(), triangle_count)? };
        let faces = corners.iter().map(|corners| corners.to_vec()).collect();
        let surface = Polyhedron::new(vertices, faces)?.with_merged_faces();
        shape.write(FemdemShape::new(Form::new("surface", surface, mesh_size)?));
        Ok(())
    })
}

/// Makes the convex hull of `count` points, three coordinates in m each.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_shape_hull(
    vertices: *const f64,
    count: usize,
    shape: Option<&mut MaybeUninit<FemdemShape>>,
) -> FemdemStatus {
    border(|| {
        let shape = place("shape", shape)?;
        // SAFETY: as the caller promises.
        let vertices = unsafe { points("vertices", vertices, count)? };
        shape.write(FemdemShape::new(Form::new(
            "hull",
            convex_hull(&vertices)?,
            0.0,
        )?));
        Ok(())
    })
}

/// Makes a shape of a file (STL, OBJ, OFF or PLY) with one closed surface. `unit` is the length in m of 1 in the file, 0.001 for
/// millimetres.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_shape_file(
    path: *const c_char,
    unit: f64,
    mesh_size: f64,
    shape: Option<&mut MaybeUninit<FemdemShape>>,
) -> FemdemStatus {
    border(|| {
        let shape = place("shape", shape)?;
        // SAFETY: as the caller promises.
        let path = unsafe { text("path", path)? };
        let read = io::read_file(path);
        let read = read.map_err(|error| Failure::new(FemdemStatus::File, error))?;
        let form = Form::new(path, read.scaled(unit)?, mesh_size)?;
        shape.write(FemdemShape::new(form));
        Ok(())
    })
}

/// Writes the properties of a shape.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_shape_properties(
    shape: FemdemShape,
    properties: Option<&mut MaybeUninit<FemdemShapeProperties>>,
) -> FemdemStatus {
    border(|| {
        let properties = place("properties", properties)?;
        let form = shape.form()?;
        let (mass, surface) = (form.mass(), &form.surface);
        let area = match form.contact.sphere() {
            Some(ball) => 4.0 * std::f64::consts::PI * ball.radius().powi(2),
            None => surface.area(),
        };
        // Symmetric: its rows are its columns.
        let mut inertia = [0.0; 9];
        inertia.copy_from_slice(mass.inertia.as_slice());
        properties.write(FemdemShapeProperties {
            volume: mass.volume,
            area,
            radius: form.contact.radius(),
            centroid: form.centroid.into(),
            inertia,
            kind: match form.contact {
                BodyShape::Convex(_) => 0,
                BodyShape::Sphere(_) => 1,
                BodyShape::Mesh(_) => 2,
            },
            vertex_count: surface.vertices().len() as u32,
            triangle_count: surface.triangles().len() as u32,
        });
        Ok(())
    })
}

/// Writes the surface of a shape: three coordinates for each of its vertices, about the centroid, and three numbers of vertices
/// for each of its triangles. The counts are those of femdem_shape_properties.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_shape_triangles(
    shape: FemdemShape,
    vertices: *mut f64,
    vertex_count: usize,
    triangles: *mut u32,
    triangle_count: usize,
) -> FemdemStatus {
    border(|| {
        let form = shape.form()?;
        let (own, corners) = (form.surface.vertices(), form.surface.triangles());
        for (name, given, needed) in [
            ("vertices", vertex_count, own.len()),
            ("triangles", triangle_count, corners.len()),
        ] {
            if given != needed {
                let what = "rows of three, as femdem_shape_properties counts them";
                return Err(Failure::size(name, given, needed, what));
            }
        }
        // SAFETY: rows of three numbers have the layout of the numbers; the rest the caller promises.
        let to = unsafe { room("vertices", vertices.cast::<[f64; 3]>(), vertex_count)? };
        for (to, vertex) in to.iter_mut().zip(own) {
            to.write(vertex.coords.into());
        }
        // SAFETY: as above.
        let to = unsafe { room("triangles", triangles.cast::<[u32; 3]>(), triangle_count)? };
        for (to, corners) in to.iter_mut().zip(corners) {
            to.write(corners);
        }
        Ok(())
    })
}
