//! Loops over all bodies or pairs, on the threads of the caller's pool.

/// Runs `work` on every item with its index; results in the order of the items. A thread takes at least `grain` of them at
/// a time.
pub(super) fn on_each<T: Send, R: Send>(
    items: &mut [T],
    grain: usize,
    work: impl Fn(usize, &mut T) -> R + Sync + Send,
) -> Vec<R> {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        let items = items.par_iter_mut().enumerate().with_min_len(grain);
        return items.map(|(i, item)| work(i, item)).collect();
    }
    #[cfg(not(feature = "parallel"))]
    let _ = grain;
    let items = items.iter_mut().enumerate();
    items.map(|(i, item)| work(i, item)).collect()
}
