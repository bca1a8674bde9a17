//! Materials against differences, closed forms and the general properties of any law.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "helpers of tests fail the test and print what they measure"
)]

mod bounds;
mod cap;
mod closed_forms;
mod derivatives;
mod files;
mod invariance;
mod plasticity;
mod states;
