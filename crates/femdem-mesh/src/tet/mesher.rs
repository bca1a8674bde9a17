//! The general mesher: a mesh of any closed surface.

use super::body::Body;
use super::distance::Triangles;
use super::draft::Draft;
use super::features::Features;
use super::lattice::Lattice;
use super::{EDGES, Quality, TetMesh, snap, stuffing};
use crate::{MeshError, Point3, Polyhedron};

/// Lattices of more nodes are refused.
const MOST_NODES: f64 = 2e7;
/// Meshes are not refined beyond this number of tetrahedra.
const MOST_TETS: usize = 20_000_000;
/// If an edge length is given, fans with smaller dihedral angles \[rad\] than this (15 degrees) are used only
/// if stuffing fails.
const GOOD_FAN: f64 = 0.26;
/// Samples along an edge, for distances.
const SAMPLES: usize = 4;
/// Largest number of parts into which a side of a triangle is cut, for distances.
const MOST_PARTS: u32 = 64;

/// Options of the mesher.
///
/// ```
/// use femdem_mesh::shapes::Shape;
/// use femdem_mesh::tet::{MeshOptions, mesh};
///
/// let dolos = "dolos".parse::<Shape>()?.polyhedron(1.0)?;
/// let options = MeshOptions { edge_length: Some(0.1), ..MeshOptions::default() };
/// let (tets, report) = mesh(&dolos, &options)?;
/// assert!(report.volume_error.abs() <= options.max_volume_error);
/// assert!(tets.quality().min_dihedral >= options.min_dihedral);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// The only method to try; with none the mesher chooses.
    pub method: Option<Method>,
    /// Target length of edges \[m\], positive and finite. With none fans are not refined, and other bodies use
    /// twice the volume over the area of the surface (half the width of a square bar).
    pub edge_length: Option<f64>,
    /// Smallest dihedral angle allowed \[rad\], 0 or more and below 0.7: meshes with smaller ones are refused.
    pub min_dihedral: f64,
    /// Largest error of the volume allowed, relative to the body's, 0 to 1.
    pub max_volume_error: f64,
    /// How often the length may be divided by the square root of 2 if a mesh with the given length fails; not
    /// beyond lattices of 2e7 nodes.
    pub refinements: u32,
}

impl Default for MeshOptions {
    /// No edge length; dihedral angles of at least 5 degrees, volume within 5 %, 4 refinements.
    fn default() -> Self {
        Self {
            method: None,
            edge_length: None,
            min_dihedral: 5_f64.to_radians(),
            max_volume_error: 0.05,
            refinements: 4,
        }
    }
}

/// How a mesh was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Tetrahedra about the centroid of a convex body, refined as often as needed.
    CentroidFan,
    /// Tetrahedra about the centre of a star-shaped body's kernel, refined as often as needed.
    StarFan,
    /// A lattice of tetrahedra fitted to the surface (isosurface stuffing).
    Stuffing,
}

/// Properties of the mesh that was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshReport {
    /// How the mesh was made.
    pub method: Method,
    /// Number of points.
    pub points: usize,
    /// Number of tetrahedra.
    pub tets: usize,
    /// Longest edge \[m\].
    pub longest_edge: f64,
    /// The length with which the lattice was made \[m\]: less than the given one if the body required it; none
    /// for fans.
    pub lattice_length: Option<f64>,
    /// Whether sharp edges of the surface longer than the lattice's length were kept; false where keeping them
    /// would have spoiled the shapes.
    pub edges_kept: bool,
    /// Shapes of the tetrahedra.
    pub quality: Quality,
    /// Volume of the mesh minus that of the body, relative to the latter.
    pub volume_error: f64,
    /// Largest distance between the skin and the surface, either way, by samples \[m\].
    pub distance: f64,
    /// Largest distance to the skin of the surface's sharp edges (those in chains longer than the
    /// lattice's length), by samples \[m\].
    pub edge_distance: f64,
}

/// Makes a tetrahedral mesh of a body: a centroid fan if it is convex, else a star fan if it is star-shaped,
/// else by isosurface stuffing with corners and sharp edges (more than 34 degrees between normals) recovered.
/// Stuffing is also used where a fan does not meet the options, or if an edge length is given and the fan has
/// dihedral angles below 15 degrees. Every tetrahedron has a point inside the body. The same input gives the
/// same bits.
///
/// The skin of fans is exactly the surface. That of a stuffed lattice approximates it: see [`MeshReport`]. It
/// is always one valid surface that does not cut itself, with as many holes as the body's.
///
/// # Errors
///
/// If options are out of range, the lattice would be too large ([`MeshError::TooThin`] if no edge length is given),
/// or no mesh meets the options within the refinements allowed: the error states what failed at the finest length
/// tried.
pub fn mesh(body: &Polyhedron, options: &MeshOptions) -> Result<(TetMesh, MeshReport), MeshError> {
    check(options)?;
    let least = options.min_dihedral;
    // If there is a length to keep, a fan of lesser shape is refined only after stuffing has failed.
    let good = match options.edge_length {
        Some(_) => least.max(GOOD_FAN),
        None => least,
    };
    let try_fan = |least: f64| match options.method {
        Some(Method::Stuffing) => Err(MeshError::NotConvex),
        Some(method) => fan(method, body, options, least),
        None if body.is_convex() => fan(Method::CentroidFan, body, options, least),
        None => fan(Method::StarFan, body, options, least),
    };
    if !matches!(options.method, None | Some(Method::Stuffing)) {
        return try_fan(least);
    }
    let fan = match try_fan(good) {
        Ok((mesh, report))
            if options.edge_length.is_none() || report.quality.min_dihedral > GOOD_FAN =>
        {
            return Ok((mesh, report));
        }
        other => other,
    };
    let mass = body.mass_properties();
    let first = options
        .edge_length
        .unwrap_or(2.0 * mass.volume / body.area());
    if options.edge_length.is_none() && is_too_fine(body, first) {
        return Err(MeshError::TooThin {
            length: first,
            nodes: Lattice::estimate(body, first),
        });
    }
    let prepared = Body::new(body);
    let mut length = first;
    let mut result = stuff(body, &prepared, length, options);
    for _ in 0..options.refinements {
        let finer = length * std::f64::consts::FRAC_1_SQRT_2;
        // A lattice that is too large stays so; the earlier failure is more informative.
        if result.is_ok() || is_too_fine(body, finer) {
            break;
        }
        length = finer;
        result = stuff(body, &prepared, length, options);
    }
    let fan = || match fan {
        Err(MeshError::BadShape { .. }) if good > least => try_fan(least),
        other => other,
    };
    result
        .or_else(|problem| fan().map_err(|_| problem))
        .map_err(|problem| match problem {
            MeshError::OutOfRange { .. } => problem,
            problem => MeshError::MeshingFailed {
                asked: first,
                tried: length,
                problem: Box::new(problem),
            },
        })
}

/// A fan, refined as often as the edge length requires, if it meets the options and has no dihedral angle below
/// `least` \[rad\] before refinement.
fn fan(
    method: Method,
    body: &Polyhedron,
    options: &MeshOptions,
    least: f64,
) -> Result<(TetMesh, MeshReport), MeshError> {
    let mesh = match method {
        Method::StarFan => TetMesh::star_fan(body)?,
        Method::CentroidFan | Method::Stuffing => TetMesh::centroid_fan(body)?,
    };
    // The corners of a refined tetrahedron have its shape, so that refinement does not improve any angle.
    check_shape(&mesh.quality(), least)?;
    let mesh = refine_to(mesh, options.edge_length)?;
    accept(mesh, body, method, None, options)
}

fn check(options: &MeshOptions) -> Result<(), MeshError> {
    let refuse = |what, value, allowed| {
        Err(MeshError::OutOfRange {
            what,
            value,
            allowed,
        })
    };
    if let Some(length) = options.edge_length
        && !(length > 0.0 && length.is_finite())
    {
        return refuse(
            "the edge length",
            length,
            "a positive, finite number of metres",
        );
    }
    // Neither the regular tetrahedron's 70.5 degrees can be reached throughout, nor 45 degrees by a lattice.
    if !(0.0..0.7).contains(&options.min_dihedral) {
        return refuse(
            "the smallest dihedral angle",
            options.min_dihedral,
            "0 to 0.7 rad",
        );
    }
    if !(0.0..=1.0).contains(&options.max_volume_error) {
        return refuse(
            "the largest volume error",
            options.max_volume_error,
            "0 to 1",
        );
    }
    Ok(())
}

/// Refines until no edge is longer than twice the root of 1/2 of the length, so that edges have about that
/// length on average.
fn refine_to(mut mesh: TetMesh, length: Option<f64>) -> Result<TetMesh, MeshError> {
    let Some(length) = length else {
        return Ok(mesh);
    };
    while longest_edge(&mesh) > std::f64::consts::SQRT_2 * length {
        if mesh.tets.len() > MOST_TETS / 8 {
            return Err(too_fine(length));
        }
        mesh = mesh.refined()?;
    }
    Ok(mesh)
}

/// Whether a lattice of this length \[m\] would have too many nodes.
fn is_too_fine(body: &Polyhedron, length: f64) -> bool {
    Lattice::estimate(body, length) > MOST_NODES
}

fn too_fine(length: f64) -> MeshError {
    MeshError::OutOfRange {
        what: "the edge length",
        value: length,
        allowed: "a length that gives at most 2e7 lattice nodes or tetrahedra",
    }
}

fn longest_edge(mesh: &TetMesh) -> f64 {
    let length = |tet: &[u32; 4], [i, j]: [usize; 2]| {
        let corners = mesh.corners(*tet);
        (corners[i] - corners[j]).norm()
    };
    let lengths = mesh
        .tets
        .iter()
        .flat_map(|tet| EDGES.map(|edge| length(tet, edge)));
    lengths.fold(0.0, f64::max)
}

/// Stuffs the body, keeping the sharp edges that are longer than `length` or, if that fails, ignoring edges.
fn stuff(
    polyhedron: &Polyhedron,
    body: &Body,
    length: f64,
    options: &MeshOptions,
) -> Result<(TetMesh, MeshReport), MeshError> {
    if is_too_fine(polyhedron, length) {
        return Err(too_fine(length));
    }
    let lattice = Lattice::around(polyhedron, length);
    let stuffed = stuffing::stuff(body, &lattice, length);
    if stuffed.tets.is_empty() {
        return Err(MeshError::NoTetrahedra);
    }
    let attempt = |shortest_edge: f64| {
        let features = Features::new(polyhedron, shortest_edge);
        let mut draft = Draft::new(&features, stuffed.clone(), length)?;
        snap::snap(&mut draft, &features, length)?;
        let (mesh, mut report) = accept(
            draft.finish()?,
            polyhedron,
            Method::Stuffing,
            Some(length),
            options,
        )?;
        report.edges_kept = shortest_edge.is_finite();
        Ok((mesh, report))
    };
    attempt(length).or_else(|_| attempt(f64::INFINITY))
}

/// Measures a mesh and refuses it if it does not meet the options.
fn accept(
    mesh: TetMesh,
    body: &Polyhedron,
    method: Method,
    lattice_length: Option<f64>,
    options: &MeshOptions,
) -> Result<(TetMesh, MeshReport), MeshError> {
    let mesh = mesh.with_interior_points();
    let skin = mesh.surface()?;
    let (found, expected) = (skin.euler_characteristic(), body.euler_characteristic());
    if found != expected {
        return Err(MeshError::WrongTopology { found, expected });
    }
    // The skin of a fan is the body's surface; that of a lattice is new.
    if method == Method::Stuffing {
        let pairs = skin.self_intersections(8);
        if !pairs.is_empty() {
            return Err(MeshError::SelfIntersecting { pairs });
        }
    }
    let report = measure(&mesh, body, method, lattice_length);
    if report.volume_error.abs() > options.max_volume_error {
        return Err(MeshError::VolumeError {
            error: report.volume_error,
            allowed: options.max_volume_error,
        });
    }
    check_shape(&report.quality, options.min_dihedral)?;
    Ok((mesh, report))
}

fn check_shape(quality: &Quality, least: f64) -> Result<(), MeshError> {
    if quality.min_dihedral < least {
        return Err(MeshError::BadShape {
            dihedral: quality.min_dihedral,
            allowed: least,
        });
    }
    Ok(())
}

fn measure(
    mesh: &TetMesh,
    body: &Polyhedron,
    method: Method,
    lattice_length: Option<f64>,
) -> MeshReport {
    let volume = body.mass_properties().volume;
    let surface = Features::new(body, lattice_length.unwrap_or(0.0));
    let skin_triangles = mesh.skin.iter().map(|t| t.map(|i| mesh.points[i as usize]));
    let skin = Triangles::new(skin_triangles);
    let outward = skin
        .corners
        .iter()
        .flat_map(samples)
        .map(|p| surface.triangles.distance(&p));
    // The body's faces, sampled as finely as the mesh could miss something there.
    let step = 0.5 * lattice_length.unwrap_or(f64::INFINITY);
    let faces = surface.triangles.corners.iter();
    let inward = faces
        .flat_map(|triangle| grid(triangle, step))
        .map(|p| skin.distance(&p));
    let edge_distance = surface
        .sharp_edges()
        .flat_map(|[a, b]| (0..=SAMPLES).map(move |i| a + (b - a) * (i as f64 / SAMPLES as f64)))
        .map(|p| skin.distance(&p))
        .fold(0.0, f64::max);
    MeshReport {
        method,
        points: mesh.points.len(),
        tets: mesh.tets.len(),
        longest_edge: longest_edge(mesh),
        lattice_length,
        edges_kept: true,
        quality: mesh.quality(),
        volume_error: mesh.volume() / volume - 1.0,
        distance: outward.chain(inward).fold(edge_distance, f64::max),
        edge_distance,
    }
}

/// Points of a triangle, corners included, about `step` apart.
fn grid(&[a, b, c]: &[Point3; 3], step: f64) -> impl Iterator<Item = Point3> {
    let sides = [b - a, c - b, a - c].map(|side| side.norm());
    let parts = sides.iter().fold(0.0, |most: f64, side| most.max(*side)) / step;
    // Conversion to an integer saturates, and makes 0 of NaN.
    let parts = (parts.ceil() as u32).clamp(1, MOST_PARTS);
    let at = move |i: u32| f64::from(i) / f64::from(parts);
    (0..=parts)
        .flat_map(move |i| (0..=parts - i).map(move |j| a + (b - a) * at(i) + (c - a) * at(j)))
}

/// Corners, middles of edges and the centroid of a triangle.
fn samples(&[a, b, c]: &[Point3; 3]) -> [Point3; 7] {
    let middle = |p: Point3, q: Point3| nalgebra::center(&p, &q);
    let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
    [a, b, c, middle(a, b), middle(b, c), middle(c, a), centroid]
}
