//! What every function of the interface does at the border: it catches panics, states what went wrong, and checks pointers.

use std::cell::RefCell;
use std::ffi::{CStr, c_char};
use std::fmt::Display;
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use femdem_solve::SolveError;
use femdem_solve::contact::ContactError;
use femdem_solve::mesh::{MeshError, Point3};

/// What a function returns. Anything but FEMDEM_STATUS_OK has a message: femdem_last_error.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FemdemStatus {
    /// Done.
    Ok = 0,
    /// A pointer is null, or a handle is 0.
    Null = 1,
    /// A handle that was freed, is of another kind, or was never given out.
    Handle = 2,
    /// An array has the wrong length; the message has the right one. A function with a `count` to write has written it there.
    Size = 3,
    /// A value is out of range, or a number names nothing. Nothing was changed.
    Refused = 4,
    /// A file could not be read or written, or holds something else.
    File = 5,
    /// The simulation has left physical bounds; the world or batch is of no further use.
    Failed = 6,
    /// Another thread is in a call with this handle.
    Busy = 7,
    /// A fault of femdem itself; please report it. A batch or world of the call is of no further use, and can only be freed.
    Fault = 8,
}

/// Why a function did not do what it was asked.
#[derive(Debug)]
pub(crate) struct Failure {
    status: FemdemStatus,
    text: String,
}

impl Failure {
    pub fn new(status: FemdemStatus, text: impl Display) -> Self {
        let text = text.to_string();
        Self { status, text }
    }

    /// A value that is not allowed.
    pub fn refused(name: &str, value: impl Display, allowed: &str) -> Self {
        let text = format!("{name} = {value} is not allowed: it must be {allowed}");
        Self::new(FemdemStatus::Refused, text)
    }

    /// An array of the wrong length.
    pub fn size(name: &str, given: usize, needed: usize, what: &str) -> Self {
        let text = format!("{name} has {given} elements, and {needed} are needed: {what}");
        Self::new(FemdemStatus::Size, text)
    }

    /// The same failure at an element of an array.
    pub fn at(self, name: &str, index: usize) -> Self {
        let text = format!("{name}[{index}]: {}", self.text);
        Self { text, ..self }
    }
}

impl From<ContactError> for Failure {
    fn from(error: ContactError) -> Self {
        let status = match error {
            ContactError::LoadNotFinite { .. } => FemdemStatus::Failed,
            _ => FemdemStatus::Refused,
        };
        Self::new(status, error)
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::new(FemdemStatus::Refused, error)
    }
}

impl From<SolveError> for Failure {
    fn from(error: SolveError) -> Self {
        let status = match &error {
            SolveError::BlowUp { .. } | SolveError::BodyFailed { .. } => FemdemStatus::Failed,
            SolveError::Io { .. } | SolveError::BadCheckpoint { .. } => FemdemStatus::File,
            SolveError::Contact(ContactError::LoadNotFinite { .. }) => FemdemStatus::Failed,
            _ => FemdemStatus::Refused,
        };
        Self::new(status, error)
    }
}

/// Bytes of a message, with its end.
const MESSAGE: usize = 1024;

thread_local! {
    /// The last message of this thread. It needs no destructor, so that it can be read for as long as the thread runs.
    static LAST: RefCell<[u8; MESSAGE]> = const { RefCell::new([0; MESSAGE]) };
}

/// Runs the body of a function of the interface.
pub(crate) fn border(body: impl FnOnce() -> Result<(), Failure>) -> FemdemStatus {
    let failure = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return FemdemStatus::Ok,
        Ok(Err(failure)) => failure,
        Err(panic) => {
            let failure = fault(&*panic);
            // Its destructor could panic, and nothing would catch that.
            std::mem::forget(panic);
            failure
        }
    };
    keep(&failure.text);
    failure.status
}

/// A panic as a failure.
fn fault(panic: &(dyn std::any::Any + Send)) -> Failure {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    let text = text.unwrap_or("of unknown cause");
    let told = format!(
        "a fault of femdem itself, please report it; a batch or world of the call is of no further use: {text}"
    );
    Failure::new(FemdemStatus::Fault, told)
}

/// Keeps a message, cut to what there is room for.
fn keep(text: &str) {
    let mut end = text.len().min(MESSAGE - 1);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    LAST.with(|last| {
        let mut last = last.borrow_mut();
        for (to, from) in last.iter_mut().zip(&text.as_bytes()[..end]) {
            // A zero would end the message.
            *to = if *from == 0 { b' ' } else { *from };
        }
        last[end] = 0;
    });
}

/// The message of the last call of this thread that failed; empty if none has. At most 1,023 bytes of UTF-8, valid until the
/// next call of this thread that fails.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_last_error() -> *const c_char {
    LAST.with(|last| last.borrow().as_ptr().cast())
}

fn null(name: &str) -> Failure {
    Failure::new(
        FemdemStatus::Null,
        format!("{name} is null: give the address of a value"),
    )
}

/// What a pointer leads to.
pub(crate) fn given<'a, T>(name: &str, value: Option<&'a T>) -> Result<&'a T, Failure> {
    value.ok_or_else(|| null(name))
}

/// Where a result goes.
pub(crate) fn place<'a, T>(
    name: &str,
    place: Option<&'a mut MaybeUninit<T>>,
) -> Result<&'a mut MaybeUninit<T>, Failure> {
    place.ok_or_else(|| null(name))
}

/// An array of the caller.
///
/// # Safety
/// `start` is null, or leads to `count` values that nothing writes as long as the slice is in use.
pub(crate) unsafe fn list<'a, T>(
    name: &str,
    start: *const T,
    count: usize,
) -> Result<&'a [T], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if start.is_null() {
        return Err(null(name));
    }
    fits::<T>(name, count)?;
    // SAFETY: not null and no longer than memory can be; the rest the caller promises.
    Ok(unsafe { slice::from_raw_parts(start, count) })
}

/// Points of the caller, three numbers for each of `count`.
///
/// # Safety
/// As [`list`].
pub(crate) unsafe fn points(
    name: &str,
    start: *const f64,
    count: usize,
) -> Result<Vec<Point3>, Failure> {
    // SAFETY: an array of three numbers has the layout of three numbers; the rest the caller promises.
    let rows = unsafe { list(name, start.cast::<[f64; 3]>(), count)? };
    Ok(rows.iter().map(|row| Point3::from(*row)).collect())
}

/// An array of the caller to be written.
///
/// # Safety
/// `start` is null, or leads to room for `count` values that nothing else reads or writes as long as the slice is in use.
pub(crate) unsafe fn room<'a, T>(
    name: &str,
    start: *mut T,
    count: usize,
) -> Result<&'a mut [MaybeUninit<T>], Failure> {
    if count == 0 {
        return Ok(&mut []);
    }
    if start.is_null() {
        return Err(null(name));
    }
    fits::<T>(name, count)?;
    // SAFETY: as in `list`; values that were never written are allowed.
    Ok(unsafe { slice::from_raw_parts_mut(start.cast(), count) })
}

/// Refuses a length that no array has, such as that of a negative number.
fn fits<T>(name: &str, count: usize) -> Result<(), Failure> {
    let most = isize::MAX as usize / size_of::<T>();
    if count <= most {
        return Ok(());
    }
    let text = format!("{name} cannot have {count} elements: give the length of the array");
    Err(Failure::new(FemdemStatus::Size, text))
}

/// Writes a list whose length the caller may not know: `count` gets the length, and the list goes to `start` if there is `room`
/// for it; none is asked for with a `room` of 0.
///
/// # Safety
/// As [`room`].
pub(crate) unsafe fn answer<T>(
    name: &str,
    items: impl ExactSizeIterator<Item = T>,
    (start, available): (*mut T, usize),
    count: Option<&mut MaybeUninit<usize>>,
) -> Result<(), Failure> {
    let needed = items.len();
    place("count", count)?.write(needed);
    if available == 0 || needed == 0 {
        return Ok(());
    }
    if available < needed {
        let what = "count has the number now; ask for it with a room of 0";
        return Err(Failure::size(name, available, needed, what));
    }
    // SAFETY: as the caller promises.
    let to = unsafe { room(name, start, needed)? };
    for (to, item) in to.iter_mut().zip(items) {
        to.write(item);
    }
    Ok(())
}

/// A text of the caller.
///
/// # Safety
/// `start` is null, or leads to a text that ends with a zero and that nothing writes as long as it is in use.
pub(crate) unsafe fn text<'a>(name: &str, start: *const c_char) -> Result<&'a str, Failure> {
    if start.is_null() {
        return Err(null(name));
    }
    // SAFETY: not null; the rest the caller promises.
    let text = unsafe { CStr::from_ptr(start) };
    text.to_str()
        .map_err(|_| Failure::refused(name, text.to_string_lossy(), "text in UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message() -> String {
        // SAFETY: the message ends with a zero, and this thread does not change it now.
        let text = unsafe { CStr::from_ptr(femdem_last_error()) };
        text.to_str().unwrap().to_owned()
    }

    #[test]
    fn a_panic_becomes_a_status_with_its_words() {
        let index = 7;
        let status = border(|| panic!("no element {index}"));
        assert_eq!(status, FemdemStatus::Fault);
        assert!(message().ends_with("no element 7"), "{}", message());
        let plain = border(|| std::panic::panic_any("plain"));
        assert_eq!(
            (plain, message().ends_with("plain")),
            (FemdemStatus::Fault, true)
        );
        let strange = border(|| std::panic::panic_any(1_u8));
        assert_eq!(strange, FemdemStatus::Fault);
        assert!(message().ends_with("unknown cause"));
    }

    /// What panics again where it is dropped.
    struct Again;

    impl Drop for Again {
        fn drop(&mut self) {
            panic!("again");
        }
    }

    #[test]
    fn what_a_panic_carries_is_not_dropped() {
        let status = border(|| std::panic::panic_any(Again));
        assert_eq!(status, FemdemStatus::Fault);
    }

    #[test]
    fn messages_are_cut_between_characters_and_have_no_zero_inside() {
        let long = "\u{e9}".repeat(MESSAGE);
        let fail = |text: &str| border(|| Err(Failure::new(FemdemStatus::Refused, text)));
        assert_eq!(fail(&long), FemdemStatus::Refused);
        assert_eq!(message(), "\u{e9}".repeat((MESSAGE - 1) / 2));
        fail("a\0b");
        assert_eq!(message(), "a b");
    }

    #[test]
    fn messages_are_those_of_the_thread() {
        border(|| Err(Failure::new(FemdemStatus::Refused, "mine")));
        let other = std::thread::spawn(message).join().unwrap();
        assert_eq!((other.as_str(), message().as_str()), ("", "mine"));
    }

    #[test]
    fn lengths_that_no_array_has_are_refused() {
        let one = 1.0_f64;
        // SAFETY: refused before it is read.
        let list = unsafe { list("x", &raw const one, usize::MAX) };
        assert_eq!(list.unwrap_err().status, FemdemStatus::Size);
    }
}
