//! C bindings: the contacts and the worlds of femdem for C, C++, Fortran and every language that calls C.
//!
//! **Use it** to add contacts of bodies of any shape to a code that is not written in Rust, or to run whole simulations from
//! it. **Do not use it** from Rust (take femdem-contact and femdem-solve) or from Python (femdem-python). Scenes and packs are not
//! here: run the program `femdem`, whose results are files.
//!
//! ```c
//! #include <femdem.h>
//! #include <math.h>
//! #include <stdio.h>
//!
//! int main(void) {
//!     /* Two cubes of side 1 m, face on face, 1 mm into each other: p a delta (1/h_A + 1/h_B) = 4000 N, less the rim. */
//!     FemdemShape cube;
//!     FemdemPose below = {{0, 0, 0}, {1, 0, 0, 0}}, above = {{0, 0, 0.999}, {1, 0, 0, 0}};
//!     FemdemPair pair;
//!     if (femdem_shape_named("cube", sqrt(3.0), 0.0, &cube) != FEMDEM_STATUS_OK ||
//!         femdem_pair_evaluate(1e6, cube, &below, cube, &above, &pair) != FEMDEM_STATUS_OK) {
//!         fprintf(stderr, "%s\n", femdem_last_error());
//!         return 1;
//!     }
//!     printf("%.1f N on the upper cube\n", pair.on_b.force[2]);
//!     femdem_shape_free(cube);
//!     return fabs(pair.on_b.force[2] / 4000.0 - 1.0) < 0.003 ? 0 : 1;
//! }
//! ```
//!
//! # What is here
//!
//! Three layers, as in Rust: shapes and pairs (`femdem_shape_*`,
//! [`femdem_pair_evaluate`]); batches of bodies that the caller moves (`femdem_batch_*`); worlds (`femdem_world_*`).
//! `cargo xtask capi --prefix FOLDER` builds and installs the shared and the static library, `femdem.h`, `femdem.hpp` (C++: owners
//! that throw), `femdem.f90` (a Fortran module) and `femdem.pc`.
//!
//! # Errors
//!
//! Every function but [`femdem_abi`], [`femdem_version`] and [`femdem_last_error`] returns a [`FemdemStatus`]; the last has the
//! message of the thread: the value, what is allowed, what to do. What fails changes nothing, except steps: those taken before
//! one that fails stay. Handles are numbers that are never given out twice, so that a
//! handle that is 0, freed or of another kind is a status, and null pointers and wrong lengths are, too. A pointer to anything else
//! cannot be found out. A panic, which would be a fault of femdem, is caught and becomes [`FemdemStatus::Fault`].
//!
//! # Threads
//!
//! Any thread may use any handle, one at a time: a second gets [`FemdemStatus::Busy`] at once. Shapes are for all at a time.
//! Batches and worlds compute on the threads of the process, one per core or as many as `RAYON_NUM_THREADS` says, or on threads
//! of their own ([`femdem_world_set_threads`]). Results are the same bits for any number.
//!
//! # Units
//!
//! SI, as in the libraries. The origin of a shape is its centroid, in all layers.
//!
//! # Accuracy
//!
//! The same bits as the Rust libraries, which compute all that is physics.
//!
//! # Safety
//!
//! This crate contains the unsafe code of the border, and nothing else does: symbols by name, and slices and texts of pointers with
//! lengths. A caller must give pointers that are null or lead to as many values as said, which nothing else writes during the call.
//! Outputs are aligned and do not overlap each other or inputs.
#![expect(
    clippy::missing_safety_doc,
    reason = "what a caller must do stands above, for all functions; arrays come with their lengths"
)]

mod batch;
mod border;
mod form;
mod handles;
mod law;
mod matter;
mod pair;
mod plain;
mod shape;
mod softening;
mod threads;
mod wall;
mod world;

use std::ffi::c_char;

pub use batch::*;
pub use border::{FemdemStatus, femdem_last_error};
pub use handles::*;
pub use law::{FemdemLaw, femdem_law_default};
pub use matter::*;
pub use pair::{FemdemPair, femdem_pair_evaluate};
pub use plain::*;
pub use shape::*;
pub use softening::{
    FEMDEM_SOFTENING_BILINEAR, FEMDEM_SOFTENING_EXPONENTIAL, FEMDEM_SOFTENING_LINEAR,
};
pub use wall::FemdemSides;
pub use world::*;

/// Number of the interface: it rises with every change after which a program has to be compiled anew.
pub const FEMDEM_ABI_VERSION: u32 = 3;

/// The number of the interface of the library that is loaded: compare it with FEMDEM_ABI_VERSION of the header.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_abi() -> u32 {
    FEMDEM_ABI_VERSION
}

/// The version of femdem, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn femdem_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
