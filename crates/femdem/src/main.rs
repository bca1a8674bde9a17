//! The femdem program.
fn main() {}
