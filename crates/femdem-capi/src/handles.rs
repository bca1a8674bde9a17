//! The table of what the caller has in hand. A handle is a number that is never given out again, so that one that was freed,
//! or belongs to something else, is always found out.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use crate::batch::Batch;
use crate::border::{Failure, FemdemStatus, border};
use crate::form::Form;
use crate::world::Hosted;

/// A shape. It never changes: any number of threads may use it at a time. Bodies keep what they need of it: it may be freed
/// before them.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FemdemShape {
    /// Its number; 0 is none.
    pub id: u64,
}

/// Contacts of many bodies that the caller moves.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FemdemBatch {
    /// Its number; 0 is none.
    pub id: u64,
}

/// Bodies in motion.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FemdemWorld {
    /// Its number; 0 is none.
    pub id: u64,
}

/// What there are handles of.
enum Object {
    Shape(Arc<Form>),
    Batch(Arc<Mutex<Batch>>),
    World(Arc<Mutex<Hosted>>),
}

impl Object {
    fn kind(&self) -> &'static str {
        match self {
            Self::Shape(_) => "shape",
            Self::Batch(_) => "batch",
            Self::World(_) => "world",
        }
    }
}

struct Table {
    last: u64,
    objects: BTreeMap<u64, Object>,
}

static TABLE: Mutex<Table> = Mutex::new(Table {
    last: 0,
    objects: BTreeMap::new(),
});

fn table() -> MutexGuard<'static, Table> {
    // Nothing panics while it is locked.
    TABLE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Table {
    fn insert(&mut self, object: Object) -> u64 {
        self.last += 1;
        self.objects.insert(self.last, object);
        self.last
    }

    /// Why a number is not a handle of a kind.
    fn refuse(&self, id: u64, wanted: &str) -> Failure {
        let (status, why) = match self.objects.get(&id) {
            _ if id == 0 => (FemdemStatus::Null, "is 0: make one first".to_owned()),
            Some(other) => (
                FemdemStatus::Handle,
                format!("is that of a {}", other.kind()),
            ),
            None if id <= self.last => (FemdemStatus::Handle, "has been freed".to_owned()),
            None => (FemdemStatus::Handle, "was never given out".to_owned()),
        };
        Failure::new(status, format!("the handle {id} of a {wanted} {why}"))
    }
}

/// Handles of one kind.
trait Handle: Copy {
    const KIND: &'static str;
    type Target;
    fn id(self) -> u64;
    fn of(object: &Object) -> Option<&Arc<Self::Target>>;
}

impl Handle for FemdemShape {
    const KIND: &'static str = "shape";
    type Target = Form;

    fn id(self) -> u64 {
        self.id
    }

    fn of(object: &Object) -> Option<&Arc<Form>> {
        match object {
            Object::Shape(form) => Some(form),
            _ => None,
        }
    }
}

impl Handle for FemdemBatch {
    const KIND: &'static str = "batch";
    type Target = Mutex<Batch>;

    fn id(self) -> u64 {
        self.id
    }

    fn of(object: &Object) -> Option<&Arc<Mutex<Batch>>> {
        match object {
            Object::Batch(batch) => Some(batch),
            _ => None,
        }
    }
}

impl Handle for FemdemWorld {
    const KIND: &'static str = "world";
    type Target = Mutex<Hosted>;

    fn id(self) -> u64 {
        self.id
    }

    fn of(object: &Object) -> Option<&Arc<Mutex<Hosted>>> {
        match object {
            Object::World(world) => Some(world),
            _ => None,
        }
    }
}

fn find<H: Handle>(handle: H) -> Result<Arc<H::Target>, Failure> {
    let table = table();
    let found = table.objects.get(&handle.id()).and_then(H::of);
    found
        .cloned()
        .ok_or_else(|| table.refuse(handle.id(), H::KIND))
}

/// Takes a handle out of the table; a handle of 0 is nothing to free.
fn free<H: Handle>(handle: H) -> FemdemStatus {
    border(|| {
        if handle.id() == 0 {
            return Ok(());
        }
        find(handle)?;
        let gone = table().objects.remove(&handle.id());
        // With the table unlocked, since it may take a while.
        drop(gone);
        Ok(())
    })
}

/// Works with an object that one thread at a time may use.
fn with<T, R>(
    object: &Mutex<T>,
    kind: &str,
    work: impl FnOnce(&mut T) -> Result<R, Failure>,
) -> Result<R, Failure> {
    let mut own = object.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => Failure::new(
            FemdemStatus::Busy,
            format!("another thread uses this {kind}: let one thread at a time use a handle"),
        ),
        TryLockError::Poisoned(_) => Failure::new(
            FemdemStatus::Fault,
            format!("a fault of femdem has broken this {kind} in an earlier call: free it"),
        ),
    })?;
    work(&mut own)
}

impl FemdemShape {
    pub(crate) fn new(form: Form) -> Self {
        let id = table().insert(Object::Shape(Arc::new(form)));
        Self { id }
    }

    pub(crate) fn form(self) -> Result<Arc<Form>, Failure> {
        find(self)
    }
}

impl FemdemBatch {
    pub(crate) fn new(batch: Batch) -> Self {
        let id = table().insert(Object::Batch(Arc::new(Mutex::new(batch))));
        Self { id }
    }

    pub(crate) fn with<R>(
        self,
        work: impl FnOnce(&mut Batch) -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        with(&*find(self)?, Self::KIND, work)
    }
}

impl FemdemWorld {
    pub(crate) fn new(world: Hosted) -> Self {
        let id = table().insert(Object::World(Arc::new(Mutex::new(world))));
        Self { id }
    }

    pub(crate) fn with<R>(
        self,
        work: impl FnOnce(&mut Hosted) -> Result<R, Failure>,
    ) -> Result<R, Failure> {
        with(&*find(self)?, Self::KIND, work)
    }
}

/// Frees a shape; does nothing with a handle of 0. Its memory stays as long as a batch or a world lives that has had a body of
/// it: make a shape once for all its bodies.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_shape_free(shape: FemdemShape) -> FemdemStatus {
    free(shape)
}

/// Frees a batch; does nothing with a handle of 0.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_free(batch: FemdemBatch) -> FemdemStatus {
    free(batch)
}

/// Frees a world; does nothing with a handle of 0.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_free(world: FemdemWorld) -> FemdemStatus {
    free(world)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_breaks_its_object_only_and_one_in_use_is_busy() {
        let object = Mutex::new(0);
        let inside = |_: &mut i32| with(&object, "batch", |_| Ok(()));
        let nested = border(|| with(&object, "batch", inside));
        assert_eq!(nested, FemdemStatus::Busy);
        assert_eq!(
            border(|| with(&object, "batch", |_| panic!("on purpose"))),
            FemdemStatus::Fault
        );
        // From now on without a panic.
        assert_eq!(
            border(|| with(&object, "batch", |_| Ok(()))),
            FemdemStatus::Fault
        );
    }
}
