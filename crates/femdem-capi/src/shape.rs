//! Shapes of bodies.

use std::ffi::c_char;
use std::mem::MaybeUninit;
use std::path::Path;

use femdem_solve::contact::BodyShape;
use femdem_solve::mesh::shapes::Shape as Parametric;
use femdem_solve::mesh::{Polyhedron, convex_hull, io};

use crate::border::{Failure, FemdemStatus, border, list, place, points, room, text};
use crate::form::Form;
use crate::handles::FemdemShape;

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
        // Checkpoints have the name: not where the file was.
        let stem = Path::new(path).file_stem().and_then(|stem| stem.to_str());
        let form = Form::new(stem.unwrap_or(path), read.scaled(unit)?, mesh_size)?;
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
