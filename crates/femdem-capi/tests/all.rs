//! Tests of the C bindings, as one program.

mod common;
mod fortran;
mod header;
mod layers;
mod misuse;
mod same_bits;
