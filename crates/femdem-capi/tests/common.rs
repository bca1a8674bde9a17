//! What the tests share: results out of pointers, messages.

use std::ffi::{CStr, CString};
use std::mem::MaybeUninit;

use femdem_capi::*;

/// What a function writes that must succeed.
pub fn got<T>(ask: impl FnOnce(Option<&mut MaybeUninit<T>>) -> FemdemStatus) -> T {
    let mut place = MaybeUninit::uninit();
    let status = ask(Some(&mut place));
    assert_eq!(status, FemdemStatus::Ok, "{}", message());
    // SAFETY: the function has succeeded, and thus written it.
    unsafe { place.assume_init() }
}

/// A function that must succeed.
pub fn ok(status: FemdemStatus) {
    assert_eq!(status, FemdemStatus::Ok, "{}", message());
}

/// A function that must fail, with a word in its message.
#[track_caller]
pub fn fails(status: FemdemStatus, wanted: FemdemStatus, word: &str) {
    let told = message();
    assert!(
        status == wanted && told.contains(word),
        "{status:?}: {told}"
    );
}

pub fn message() -> String {
    // SAFETY: the message ends with a zero, and this thread does not change it now.
    let text = unsafe { CStr::from_ptr(femdem_last_error()) };
    text.to_str().unwrap().to_owned()
}

pub fn text(text: &str) -> CString {
    CString::new(text).unwrap()
}

pub fn named(name: &str, size: f64) -> FemdemShape {
    let name = text(name);
    // SAFETY: the text lives until the call ends.
    got(|to| unsafe { femdem_shape_named(name.as_ptr(), size, 0.0, to) })
}

pub fn at(x: f64, y: f64, z: f64) -> FemdemPose {
    FemdemPose {
        position: [x, y, z],
        rotation: [1.0, 0.0, 0.0, 0.0],
    }
}

pub fn resting(pose: FemdemPose) -> FemdemMotion {
    FemdemMotion {
        pose,
        velocity: FemdemVelocity::default(),
    }
}

pub fn world() -> FemdemWorld {
    let parameters = got(|to| femdem_world_defaults(to));
    got(|to| femdem_world_new(Some(&parameters), to))
}

pub fn batch() -> FemdemBatch {
    let law = got(|to| femdem_law_default(to));
    got(|to| femdem_batch_new(Some(&law), to))
}

/// A list of a function that writes how many there are.
pub fn all<T: Clone>(
    nothing: T,
    ask: impl Fn(*mut T, usize, Option<&mut MaybeUninit<usize>>) -> FemdemStatus,
) -> Vec<T> {
    let count = got(|count| ask(std::ptr::null_mut(), 0, count));
    let mut items = vec![nothing; count];
    got(|count| ask(items.as_mut_ptr(), items.len(), count));
    items
}

/// Loads of a batch.
pub fn update(batch: FemdemBatch, motions: &[FemdemMotion], dt: f64) -> Vec<FemdemLoad> {
    let mut loads = vec![FemdemLoad::default(); motions.len()];
    let (from, to) = (motions.as_ptr(), loads.as_mut_ptr());
    // SAFETY: both are as long as said.
    ok(unsafe { femdem_batch_update(batch, from, motions.len(), dt, to, loads.len()) });
    loads
}
