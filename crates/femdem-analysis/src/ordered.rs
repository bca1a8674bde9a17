//! Parallel map with ordered results: the only use of threads.

/// `work(scratch, i)` for `i` in `0..count`, results in index order.
///
/// With the feature `parallel` the calls run on the caller's rayon pool. `scratch` is memory to be reused and
/// must not carry a value from one call to the next, so that the result does not depend on how the calls are
/// distributed to threads.
#[cfg(feature = "parallel")]
pub(crate) fn ordered_map<T: Send, S>(
    count: usize,
    scratch: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, usize) -> T + Sync + Send,
) -> Vec<T> {
    use rayon::prelude::*;
    (0..count).into_par_iter().map_init(scratch, work).collect()
}

/// `work(scratch, i)` for `i` in `0..count`, results in index order, on this thread.
#[cfg(not(feature = "parallel"))]
pub(crate) fn ordered_map<T, S>(
    count: usize,
    scratch: impl Fn() -> S,
    work: impl Fn(&mut S, usize) -> T,
) -> Vec<T> {
    let mut memory = scratch();
    (0..count).map(|i| work(&mut memory, i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results come in index order whatever the threads do; this runs with and without `parallel`.
    #[test]
    fn results_keep_their_order() {
        let work = |scratch: &mut Vec<usize>, i: usize| {
            scratch.clear();
            scratch.extend(0..i % 97);
            scratch.iter().map(|&k| 1.0 / (k as f64 + 1.0)).sum::<f64>()
        };
        let expected: Vec<f64> = (0..5000).map(|i| work(&mut Vec::new(), i)).collect();
        assert_eq!(ordered_map(5000, Vec::new, work), expected);
    }
}
