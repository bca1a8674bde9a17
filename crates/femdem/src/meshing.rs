//! How the bodies of a pack are meshed.

use femdem_mesh::Polyhedron;
use femdem_mesh::tet::MeshOptions;

/// For tetrahedra with edges of about `size` circumscribed diameters.
pub(crate) fn options_of(surface: &Polyhedron, size: f64) -> MeshOptions {
    MeshOptions {
        edge_length: Some(size * 2.0 * surface.bounding_radius()),
        ..MeshOptions::default()
    }
}
