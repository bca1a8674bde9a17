//! Options of the solution of a body.

use super::NewtonOptions;
use crate::FemError;
use crate::error::check;
use serde::{Deserialize, Serialize};

/// How loads and weight grow. Driven nodes follow their path in time in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LoadPath {
    /// Together, in proportion from zero to their values at the end.
    #[default]
    Proportional,
    /// As given by their curves at every time: loading and unloading.
    InTime,
}

/// Options of [`solve_static`](super::solve_static).
///
/// ```
/// use femdem_fem::element::Element;
/// use femdem_fem::material::NeoHookean;
/// use femdem_fem::statics::{StaticOptions, solve_static};
/// use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
/// use femdem_mesh::{TetMesh, Vector3};
///
/// // A column of 1 m under its own weight: u = rho g L^2/(2 E) at the top, 0.5 mm here, and a little less
/// // where its foot cannot widen.
/// let mesh = TetMesh::block([2, 2, 10], &Vector3::new(0.1, 0.1, 1.0))?;
/// let soft = MaterialRegion { material: NeoHookean::new(1e7, 0.3)?.into(), density: 1000.0 };
/// let model = DeformableModel::new(&mesh, Element::T10, vec![soft], None)?;
/// let mut boundary = Boundary::new(Vector3::new(0.0, 0.0, -10.0))?;
/// let foot = Selection::Plane { normal: Vector3::z(), offset: 0.0, tolerance: 1e-9 };
/// boundary.fix(&model, &foot, [true; 3])?;
/// let solution = solve_static(&model, &boundary, &StaticOptions::default())?;
/// let top = model.nodes().iter().zip(&solution.state.x).map(|(before, now)| before.z - now.z).fold(0.0, f64::max);
/// assert!(top > 0.48e-3 && top < 0.5e-3, "{top}");
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct StaticOptions {
    /// How each equilibrium is found.
    pub newton: NewtonOptions,
    /// The time of the boundary conditions that is to be reached, s.
    pub time: f64,
    /// How loads grow up to then.
    pub path: LoadPath,
    /// Number of equal steps of loads and driven nodes. A step that fails is halved; after a successful one
    /// the next is longer again. Plasticity needs many, and so do large motions of quadratic elements, which
    /// may fold between their points in a single step.
    pub steps: usize,
    /// Halvings of the step before giving up.
    pub max_halvings: usize,
}

impl Default for StaticOptions {
    fn default() -> Self {
        Self {
            newton: NewtonOptions::default(),
            time: 1.0,
            path: LoadPath::default(),
            steps: 1,
            max_halvings: 10,
        }
    }
}

impl StaticOptions {
    /// # Errors
    /// [`FemError::Parameter`].
    pub(super) fn check(&self) -> Result<(), FemError> {
        let steps = self.steps as f64;
        check("steps", steps, steps >= 1.0, "at least 1")?;
        let time = self.time;
        check("time", time, time >= 0.0, "zero or positive, in s")
    }
}
