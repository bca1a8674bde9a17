//! Tests of the C bindings, as one program.

mod header;
