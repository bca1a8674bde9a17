//! Types of elements.

use super::TETRAHEDRON;
use crate::MeshError;

/// How the elements of a type are treated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Use {
    /// Four-node tetrahedra.
    Read,
    /// Skipped: elements of points, lines and surfaces, with this many nodes.
    Skip(u64),
}

/// How the elements of a type are treated, after the table of the Gmsh manual.
///
/// # Errors
///
/// Volume elements that are not four-node tetrahedra, and unknown ones.
pub(super) fn usage(code: i64) -> Result<Use, MeshError> {
    let nodes = match code {
        TETRAHEDRON => return Ok(Use::Read),
        15 => 1,
        1 => 2,
        2 | 8 => 3,
        3 | 26 => 4,
        27 => 5,
        9 | 28 => 6,
        16 => 8,
        10 | 20 => 9,
        21 => 10,
        22 => 12,
        23 | 24 => 15,
        25 => 21,
        _ => return Err(refused(code)),
    };
    Ok(Use::Skip(nodes))
}

fn refused(code: i64) -> MeshError {
    let what = match code {
        5 => "hexahedra",
        6 => "prisms",
        7 => "pyramids",
        11 => "second-order tetrahedra",
        12 | 17 => "second-order hexahedra",
        13 | 18 => "second-order prisms",
        14 | 19 => "second-order pyramids",
        29 => "third-order tetrahedra",
        30 => "fourth-order tetrahedra",
        31 => "fifth-order tetrahedra",
        _ => "elements of a type that is not known",
    };
    MeshError::Unsupported {
        what: format!("{what} (Gmsh type {code})"),
        advice: "mesh the body with four-node tetrahedra (in Gmsh: order 1, no recombination)",
    }
}
