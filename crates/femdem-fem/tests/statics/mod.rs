//! Static equilibrium of deformable bodies against closed forms and published values.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

#[path = "../../examples/statics/cantilever.rs"]
mod cantilever;
#[cfg(feature = "implicit")]
#[path = "../../examples/statics/cook.rs"]
mod cook;
#[path = "../../examples/statics/planes.rs"]
mod planes;
#[cfg(feature = "implicit")]
#[path = "../../examples/statics/sphere.rs"]
mod sphere;

mod bars;
mod cantilevers;
#[cfg(feature = "implicit")]
mod nearly_incompressible;
mod refusals;

use femdem_fem::statics::{Linear, NewtonOptions, StaticOptions};

/// The linear solvers of this build.
fn solvers() -> Vec<Linear> {
    let mut all = vec![Linear::Cg, Linear::CgAssembled];
    if cfg!(feature = "implicit") {
        all.push(Linear::Cholesky);
    }
    all
}

/// The fastest solver of this build, to a tolerance.
fn newton(tolerance: f64) -> StaticOptions {
    with(solvers().pop().unwrap_or_default(), tolerance)
}

fn with(linear: Linear, tolerance: f64) -> StaticOptions {
    StaticOptions {
        newton: NewtonOptions {
            linear,
            tolerance,
            ..NewtonOptions::default()
        },
        ..StaticOptions::default()
    }
}
