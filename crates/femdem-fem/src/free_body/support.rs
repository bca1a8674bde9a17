//! Six supports that keep a body from moving as a whole.

use crate::error::FemError;
use crate::model::{Boundary, DeformableModel, Selection};
use femdem_mesh::Vector3;

/// Three nodes far from each other: the one farthest from the first, the one farthest from that, and the one farthest from
/// the line through both.
pub(super) fn nodes(model: &DeformableModel) -> [u32; 3] {
    let farthest = |measure: &dyn Fn(&Vector3) -> f64| {
        let mut best = (0, f64::NEG_INFINITY);
        for (i, x) in (0..).zip(model.nodes()) {
            let value = measure(x);
            if value > best.1 {
                best = (i, value);
            }
        }
        best.0
    };
    let place = |node: u32| model.nodes()[node as usize];
    let start = place(0);
    let a = farthest(&|x| (x - start).norm_squared());
    let b = farthest(&|x| (x - place(a)).norm_squared());
    let line = place(b) - place(a);
    let c = farthest(&|x| line.cross(&(x - place(a))).norm_squared());
    [a, b, c]
}

/// Holds node a, the two components of b across the longest one of b - a, and the component of c in which it moves most
/// as the body turns about the line through a and b. No motion of the whole body is left.
///
/// # Errors
///
/// [`FemError::NoSuch`] for nodes that the model has not.
pub(super) fn hold(model: &DeformableModel, [a, b, c]: [u32; 3]) -> Result<Boundary, FemError> {
    let mut boundary = Boundary::default();
    let mut fix = |node: u32, components: [bool; 3]| {
        boundary.fix(model, &Selection::Nodes(vec![node]), components)
    };
    fix(a, [true; 3])?;
    let place = |node: u32| model.nodes()[node as usize];
    let line = place(b) - place(a);
    let long = line.iamax();
    fix(b, [0, 1, 2].map(|k| k != long))?;
    let across = line.cross(&(place(c) - place(a))).iamax();
    fix(c, [0, 1, 2].map(|k| k == across))?;
    Ok(boundary)
}
