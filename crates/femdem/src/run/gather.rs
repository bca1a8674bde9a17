//! What ranks tell each other of a job.

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
