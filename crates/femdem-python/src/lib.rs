//! Python bindings: the compiled half of the Python package `femdem`. Its Python half, in `python/femdem`, has the
//! documented interface; here are arrays in and out, the interpreter lock, and errors.
//!
//! ```python
//! import femdem
//!
//! world = femdem.World(friction=0.5)
//! world.add_wall("floor", plane={"normal": [0, 0, 1]})
//! world.add(femdem.Shape("cube", size=0.1), [0, 0, 0.2, 1, 0, 0, 0], density=2000)
//! world.step(1000)
//! print(world.poses, world.contacts()["force"])
//! ```
//!
//! # Units
//!
//! SI, as in the libraries. Poses are rows x, y, z, qw, qx, qy, qz.
//!
//! # Accuracy
//!
//! The same bits as the Rust libraries and the program, which compute all that is physics.
//!
//! # Safety
//!
//! This crate contains no `unsafe` code of its own; that of the interpreter's interface is in PyO3.

mod arrays;
mod batch;
mod command;
mod contacts;
mod error;
mod shape;
mod snapshot;
mod threads;
mod world;

use pyo3::prelude::*;

/// The compiled half of the package.
#[pymodule]
fn _femdem(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("FemdemError", module.py().get_type::<error::FemdemError>())?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<batch::ContactBatch>()?;
    module.add_class::<shape::Shape>()?;
    module.add_class::<snapshot::Snapshot>()?;
    module.add_class::<world::World>()?;
    module.add_function(wrap_pyfunction!(command::command, module)?)?;
    module.add_function(wrap_pyfunction!(snapshot::stages, module)?)?;
    module.add_function(wrap_pyfunction!(threads::set_threads, module)?)
}
