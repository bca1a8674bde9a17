//! The femdem program: pack bodies, run scenes, resume, analyse, list shapes.

use std::process::ExitCode;

fn main() -> ExitCode {
    femdem::program::main()
}
