//! Bodies brought to rest under loads that grow from zero.

use super::body::{BodyProblem, flat, unflatten};
use super::{LoadPath, Newton, NewtonReport, StaticOptions, StaticProblem, vector};
use super::{StaticReport, StaticSolution};
use crate::FemError;
use crate::model::{Boundary, DeformableModel, DeformableState};

/// A body during the load steps.
struct March<'a> {
    problem: BodyProblem<'a>,
    options: &'a StaticOptions,
    newton: Newton,
    x: Vec<f64>,
    report: StaticReport,
}

/// The equilibrium of a body, from its reference state, under the loads and with the supports of a
/// moment, [`StaticOptions::time`].
///
/// Supports must hold the body: free rigid motion is not removed. The tangent does not include that pressure follows the rotation of its faces, so Newton's
/// method converges more slowly under pressures that are not small beside the moduli.
///
/// Residuals are compared with the norm of loads and reactions, or with the largest norm of the nodes'
/// internal forces at the start and at the ends of the load steps so far if that is larger. So a body that is
/// unloaded, whose loads and reactions return to zero, has a scale too.
///
/// ```
/// use femdem_mesh::{TetMesh, Vector3};
/// use femdem_fem::{Boundary, DeformableModel, MaterialRegion, Selection};
/// use femdem_fem::element::Element;
/// use femdem_fem::material::NeoHookean;
/// use femdem_fem::statics::{StaticOptions, solve_static};
///
/// // A beam of 10 x 1 x 1 m bends under its own weight: w L^4 / (8 E I) and some shear.
/// let mesh = TetMesh::block([10, 2, 2], &Vector3::new(10.0, 1.0, 1.0))?;
/// let solid = MaterialRegion { material: NeoHookean::new(1e9, 0.3)?.into(), density: 1000.0 };
/// let model = DeformableModel::new(&mesh, Element::T10, vec![solid], None)?;
/// let mut boundary = Boundary::new(Vector3::new(0.0, 0.0, -9.81))?;
/// let wall = Selection::Plane { normal: Vector3::x(), offset: 0.0, tolerance: 1e-9 };
/// boundary.fix(&model, &wall, [true; 3])?;
///
/// let solution = solve_static(&model, &boundary, &StaticOptions::default())?;
/// let sag = -solution.state.x.iter().map(|x| x.z).fold(0.0, f64::min);
/// let theory = 9810.0 * 10.0_f64.powi(4) / (8.0 * 1e9 / 12.0);
/// assert!((sag / theory - 1.0).abs() < 0.05, "{sag} {theory}");
/// let weight: f64 = solution.reactions.iter().map(|f| f.z).sum();
/// assert!((weight / 98100.0 - 1.0).abs() < 1e-6);
/// # Ok::<(), femdem_fem::FemError>(())
/// ```
///
/// # Errors
/// [`FemError::NotConverged`] or the body's [`FemError::Element`] for a step that failed at any size;
/// [`FemError::Parameter`] for options out of range; [`FemError::NoSuch`] for a boundary of another
/// model.
pub fn solve_static(
    model: &DeformableModel,
    boundary: &Boundary,
    options: &StaticOptions,
) -> Result<StaticSolution, FemError> {
    solve_static_from(model, boundary, &DeformableState::reference(model), options)
}

/// As [`solve_static`], from a given state. Loads still grow from zero, unless the path is
/// [`LoadPath::InTime`].
///
/// # Errors
/// As [`solve_static`], and if the state does not fit the model or has no stress.
pub fn solve_static_from(
    model: &DeformableModel,
    boundary: &Boundary,
    start: &DeformableState,
    options: &StaticOptions,
) -> Result<StaticSolution, FemError> {
    options.check()?;
    let mut march = March {
        problem: BodyProblem::new(model, boundary, start)?,
        options,
        newton: Newton::new(options.newton.clone())?,
        x: flat(&start.x),
        report: StaticReport::default(),
    };
    march.run()?;
    let mut state = DeformableState::reference(model);
    unflatten(&march.x, &mut state.x);
    let reactions = march.problem.reactions();
    state.history = march.problem.into_history();
    Ok(StaticSolution {
        state,
        reactions,
        report: march.report,
    })
}

impl March<'_> {
    fn run(&mut self) -> Result<(), FemError> {
        let longest = 1.0 / self.options.steps as f64;
        let (mut done, mut step, mut halvings) = (0.0, longest, 0);
        while done < 1.0 {
            // The last step ends at 1 exactly, and no tiny one is left before it.
            let next = if done + 1.001 * step >= 1.0 {
                1.0
            } else {
                done + step
            };
            match self.advance(next) {
                Ok(report) => {
                    self.report.steps.push((next, report));
                    done = next;
                    if halvings > 0 {
                        (step, halvings) = (2.0 * step, halvings - 1);
                    }
                }
                Err(error) => {
                    self.report.failed += 1;
                    if halvings >= self.options.max_halvings {
                        return Err(error);
                    }
                    (step, halvings) = (0.5 * step, halvings + 1);
                }
            }
        }
        Ok(())
    }

    /// Advances to a fraction of the whole load path.
    fn advance(&mut self, part: f64) -> Result<NewtonReport, FemError> {
        let (end, now) = (self.options.time, self.options.time * part);
        match self.options.path {
            LoadPath::Proportional => self.problem.set_loads(end, part),
            LoadPath::InTime => self.problem.set_loads(now, 1.0),
        }
        let mut x = self.x.clone();
        let motion = self.problem.motion_to(now, &x);
        if motion.iter().any(|&m| m != 0.0) {
            self.predict(&mut x, &motion)?;
        }
        let report = self.newton.solve(&mut self.problem, &mut x)?;
        self.problem.commit(&x)?;
        self.x = x;
        Ok(report)
    }

    /// Moves held coordinates, and the others according to the tangent, so that the whole body follows and not only the
    /// elements at the supports.
    fn predict(&mut self, x: &mut [f64], motion: &[f64]) -> Result<(), FemError> {
        let mut force = vec![0.0; x.len()];
        self.problem.residual(x, &mut force)?;
        let mut pull = vec![0.0; x.len()];
        self.problem.pull_of(x, motion, &mut pull)?;
        vector::add_scaled(&mut force, -1.0, &pull);
        let follow = self.newton.predict(&mut self.problem, x, &force)?;
        vector::add_scaled(x, 1.0, &follow);
        vector::add_scaled(x, 1.0, motion);
        Ok(())
    }
}
