//! Tests of the C bindings, as one program.
#![allow(
    clippy::unwrap_used,
    reason = "also what tests share stops where it fails"
)]

mod bonds;
mod cell;
mod common;
mod cracks;
mod deformable;
mod fortran;
mod header;
mod layers;
mod misuse;
mod moving_walls;
mod same_bits;
