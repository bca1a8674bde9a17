//! What a batch knows after an update.

use std::mem::MaybeUninit;

use crate::border::{Failure, FemdemStatus, answer, border, place, room};
use crate::handles::FemdemBatch;
use crate::plain::{FemdemContact, FemdemLoad};

/// Sums over the contacts of a batch.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemBatchTotals {
    /// Energy of the normal contacts, J.
    pub energy: f64,
    /// Energy in the friction springs, J.
    pub spring_energy: f64,
    /// Largest stable step of leapfrog for the contacts of the last update, s; infinite without contacts. Take a small part of
    /// it: contacts that begin are stiffer.
    pub stable_step: f64,
    /// Pairs near each other.
    pub candidates: usize,
    /// Pairs in touch.
    pub touching: usize,
}

/// Writes the sums of the last update.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_batch_totals(
    batch: FemdemBatch,
    totals: Option<&mut MaybeUninit<FemdemBatchTotals>>,
) -> FemdemStatus {
    border(|| {
        let totals = place("totals", totals)?;
        batch.with(|own| {
            let sums = own.batch.totals();
            totals.write(FemdemBatchTotals {
                energy: sums.energy,
                spring_energy: sums.spring_energy,
                stable_step: own.batch.stable_step(&own.motions),
                candidates: sums.candidates,
                touching: sums.touching,
            });
            Ok(())
        })
    })
}

/// Writes the loads on the walls about their origins, by number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_batch_wall_loads(
    batch: FemdemBatch,
    loads: *mut FemdemLoad,
    count: usize,
) -> FemdemStatus {
    border(|| {
        batch.with(|own| {
            let all = own.batch.wall_loads();
            if count != all.len() {
                let what =
                    "one for each number of a wall in use so far, as femdem_batch_slots tells";
                return Err(Failure::size("loads", count, all.len(), what));
            }
            // SAFETY: as the caller promises.
            let to = unsafe { room("loads", loads, count)? };
            for (to, load) in to.iter_mut().zip(all) {
                to.write(FemdemLoad::from(load));
            }
            Ok(())
        })
    })
}

/// Writes the number of contacts of the last update, and the contacts if `room` is not 0: then it must suffice for all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_batch_contacts(
    batch: FemdemBatch,
    contacts: *mut FemdemContact,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = batch.with(|own| Ok(own.batch.contacts()))?;
        let all = all.iter().map(FemdemContact::from);
        // SAFETY: as the caller promises.
        unsafe { answer("contacts", all, (contacts, room), count) }
    })
}
