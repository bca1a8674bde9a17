//! Loops over all bodies: with the feature `parallel` on the caller's thread pool. Results come in the order
//! of the bodies, so that sums over them have the same bits on any number of threads.

#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Runs `work` on every item with its index and a reused buffer, which must not carry values from one item to
/// the next.
#[cfg(feature = "parallel")]
pub(super) fn on_each_with<T: Send, S, R: Send>(
    items: &mut [T],
    memory: impl Fn() -> S + Sync + Send,
    work: impl Fn(&mut S, usize, &mut T) -> R + Sync + Send,
) -> Vec<R> {
    let items = items.par_iter_mut().enumerate().with_min_len(4);
    items
        .map_init(memory, |memory, (i, item)| work(memory, i, item))
        .collect()
}

/// Runs `work` on every item with its index and a reused buffer, which must not carry values from one item to
/// the next.
#[cfg(not(feature = "parallel"))]
pub(super) fn on_each_with<T, S, R>(
    items: &mut [T],
    memory: impl Fn() -> S,
    work: impl Fn(&mut S, usize, &mut T) -> R,
) -> Vec<R> {
    let mut memory = memory();
    let items = items.iter_mut().enumerate();
    items.map(|(i, item)| work(&mut memory, i, item)).collect()
}

/// Runs `work` on every item with its index.
pub(super) fn on_each<T: Send, R: Send>(
    items: &mut [T],
    work: impl Fn(usize, &mut T) -> R + Sync + Send,
) -> Vec<R> {
    on_each_with(items, || (), |(), i, item| work(i, item))
}
