//! How the bodies of a scene were made, as text.

use std::fmt;
use std::path::PathBuf;

use femdem_mesh::Polyhedron;
use femdem_mesh::io::Report;
use femdem_mesh::tet::{MeshReport, Method};

use super::Unit;

/// How a shape of a scene, or a wall from a file, was made.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeNote {
    /// Name in results.
    pub name: String,
    /// The file it was read from, the unit of its coordinates, and what reading did.
    pub file: Option<(PathBuf, Unit, Report)>,
    /// Number of faces.
    pub faces: usize,
    /// Whether it is convex; if not, its contacts are computed with its tetrahedra.
    pub is_convex: bool,
    /// Circumscribed diameter \[m\].
    pub diameter: f64,
    /// Volume \[m³\].
    pub volume: f64,
    /// The mesh of a body that is not convex, or deforms.
    pub mesh: Option<MeshReport>,
    /// What came of the sizes of the bodies, if there are several; diameter, volume and mesh are then those of the largest.
    pub sizes: Option<String>,
}

impl ShapeNote {
    /// The note of a surface in m.
    pub(crate) fn new(
        name: String,
        file: Option<(PathBuf, Unit, Report)>,
        surface: &Polyhedron,
        mesh: Option<MeshReport>,
    ) -> Self {
        Self {
            name,
            file,
            faces: surface.face_count(),
            is_convex: surface.is_convex(),
            diameter: 2.0 * surface.bounding_radius(),
            volume: surface.mass_properties().volume,
            mesh,
            sizes: None,
        }
    }

    /// Whether there is anything to report beyond the command itself.
    #[must_use]
    pub fn is_news(&self) -> bool {
        self.file.is_some() || self.mesh.is_some() || self.sizes.is_some()
    }
}

impl fmt::Display for ShapeNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.name)?;
        if let Some((path, unit, report)) = &self.file {
            writeln!(f, "{} in {unit}", path.display())?;
            for line in report.to_string().lines() {
                writeln!(f, "  {line}")?;
            }
            f.write_str("  ")?;
        }
        write!(
            f,
            "{} faces, d = {:.4e} m, volume {:.4e} m3, {}",
            self.faces,
            self.diameter,
            self.volume,
            if self.is_convex {
                "convex"
            } else {
                "not convex"
            }
        )?;
        if let Some(mesh) = &self.mesh {
            write!(f, "\n  {}", mesh_text(mesh))?;
        }
        match &self.sizes {
            Some(sizes) => write!(f, "\n  {sizes}"),
            None => Ok(()),
        }
    }
}

/// How a body was meshed, in a sentence.
fn mesh_text(report: &MeshReport) -> String {
    let method = match (report.method, report.lattice_length) {
        (Method::CentroidFan, _) => "a fan about its centroid".to_owned(),
        (Method::StarFan, _) => "a fan about a point that sees all of it".to_owned(),
        (Method::Stuffing, None) => "a lattice fitted to the surface".to_owned(),
        (Method::Stuffing, Some(length)) => {
            format!("a lattice of edge length {length:.3e} m fitted to the surface")
        }
    };
    let quality = &report.quality;
    let [low, high] = [quality.min_dihedral, quality.max_dihedral].map(f64::to_degrees);
    format!(
        "meshed by {method}: {} tetrahedra, longest edge {:.3e} m\n  quality: dihedral angles {low:.0} to \
         {high:.0} degrees, radius ratio at least {:.3}, heights at least {:.1e} m\n  error: volume \
         {:+.2} %, surface within {:.1e} m",
        report.tets,
        report.longest_edge,
        quality.min_radius_ratio,
        quality.smallest_height,
        100.0 * report.volume_error,
        report.distance,
    )
}
