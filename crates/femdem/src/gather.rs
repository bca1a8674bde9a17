//! What ranks tell each other of a job.

use femdem_contact::BodyId;
use femdem_solve::{Halo, SolveError, checkpoint};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::Error;

/// The items of all ranks, by rank.
pub(crate) fn of_all<T: Serialize + DeserializeOwned>(
    own: Vec<T>,
    halo: &mut dyn Halo,
) -> Result<Vec<T>, SolveError> {
    let mut count = [own.len() as u64];
    halo.sum(&mut count)?;
    if count[0] == 0 || halo.size() == 1 {
        return Ok(own);
    }
    let mut messages = Vec::new();
    if !own.is_empty() {
        let bytes = checkpoint::encode(&own)?;
        messages.extend((0..halo.size()).map(|rank| (rank, bytes.clone())));
    }
    let mut all = Vec::new();
    for (_, bytes) in halo.send(messages)? {
        let part: Vec<T> = checkpoint::decode(&bytes)?;
        all.extend(part);
    }
    Ok(all)
}

/// Bodies of which the first rank gets to know at a time.
const SLICE: usize = 1 << 14;

/// Tells the first rank of bodies, which it names by their numbers in the whole: what the rank says `of` each that it owns. The
/// first one `take`s that in the order of its list, with the place in it, and has no more of it at a time than of a slice. If that
/// fails, the others are asked on, and all have the error.
pub(crate) fn by_slices<T: Serialize + DeserializeOwned>(
    numbers: &[BodyId],
    halo: &mut dyn Halo,
    of: impl Fn(BodyId) -> Option<T>,
    mut take: impl FnMut(usize, T) -> Result<(), Error>,
) -> Result<(), Error> {
    let mut slices = numbers.chunks(SLICE);
    let mut first = 0;
    let mut taken = Ok(());
    loop {
        let slice = slices.next().unwrap_or_default();
        let mut messages = Vec::new();
        if halo.rank() == 0 {
            let bytes = checkpoint::encode(&slice)?;
            messages.extend((0..halo.size()).map(|rank| (rank, bytes.clone())));
        }
        let asked: Vec<BodyId> = match halo.send(messages)?.first() {
            Some((_, bytes)) => checkpoint::decode(bytes)?,
            None => Vec::new(),
        };
        if asked.is_empty() {
            return or_error_of_another(taken, halo);
        }
        let own = (0_u32..).zip(asked);
        let own: Vec<(u32, T)> = own.filter_map(|(at, body)| Some((at, of(body)?))).collect();
        let mut all: Vec<(u32, T)> = Vec::new();
        for (_, bytes) in halo.send(vec![(0, checkpoint::encode(&own)?)])? {
            let part: Vec<(u32, T)> = checkpoint::decode(&bytes)?;
            all.extend(part);
        }
        all.sort_by_key(|(at, _)| *at);
        for (at, item) in all {
            if taken.is_ok() {
                taken = take(first + at as usize, item);
            }
        }
        first += slice.len();
    }
}

/// What a rank has made, unless it or another has failed: then all have an error, which says why.
pub(crate) fn or_error_of_another<T>(
    made: Result<T, Error>,
    halo: &mut dyn Halo,
) -> Result<T, Error> {
    let own = made.as_ref().err().map(ToString::to_string);
    let errors = of_all(own.into_iter().collect(), halo)?;
    match (made, errors.into_iter().next()) {
        (Ok(_), Some(why)) => Err(SolveError::Ranks { why }.into()),
        (made, _) => made,
    }
}

#[cfg(test)]
mod tests {
    use femdem_solve::Alone;

    use super::*;

    /// Several slices; a number that no rank owns has no item.
    #[test]
    fn items_come_in_the_order_of_the_numbers() {
        let count = 2 * SLICE + 5;
        let numbers: Vec<BodyId> = (0..count as BodyId).rev().collect();
        let of = |number: BodyId| (number != 7).then_some(number);
        let mut all = Vec::new();
        by_slices(&numbers, &mut Alone, of, |at, number| {
            all.push((at, number));
            Ok(())
        })
        .unwrap();
        let expected = numbers.iter().copied().enumerate();
        let expected: Vec<(usize, BodyId)> = expected.filter(|(_, number)| *number != 7).collect();
        assert!(all == expected);
    }
}
