//! Translation of names of numbers that the libraries refuse to keys of scenes.

use femdem_pack::PackError;

use crate::Error;

/// Names in the libraries, and keys of scenes, which are also the options of `femdem pack`.
const KEYS: [(&str, &str); 16] = [
    ("wall_friction", "wall-friction"),
    ("rolling_friction", "rolling-friction"),
    (
        "rolling_friction with time_step.implicit",
        "rolling-friction with implicit steps",
    ),
    ("adhesion_energy", "adhesion-energy"),
    (
        "cohesion, adhesion or liquid bridge with time_step.implicit",
        "cohesion, adhesion or liquid bridge with implicit steps",
    ),
    ("damping_ratio", "damping"),
    ("tangential_ratio", "tangential-ratio"),
    ("tangential_damping", "tangential-damping"),
    ("medium.local_damping", "local-damping"),
    (
        "medium.local_damping with time_step.implicit",
        "local-damping with implicit steps",
    ),
    ("time_step.implicit.multiple", "implicit"),
    ("silo outlet", "outlet"),
    ("silo half_angle", "cone"),
    ("protocol rate", "rate"),
    ("protocol batch", "batch"),
    ("density of a shape", "density"),
];

/// The error with the key of the scene.
pub(super) fn in_words_of_scenes(error: PackError) -> Error {
    Error::from(error).by_keys(&KEYS)
}
