//! Disjoint sets of numbered things. The root of a set is its lowest member, so that nothing depends on the order in
//! which they are joined.

/// The root of the set of thing `n`.
pub(crate) fn find(root: &[u32], mut n: u32) -> u32 {
    while root[n as usize] != n {
        n = root[n as usize];
    }
    n
}

/// Joins the sets of two things; whether they were different sets.
pub(crate) fn join(root: &mut [u32], n: u32, m: u32) -> bool {
    let (x, y) = (find(root, n), find(root, m));
    let low = x.min(y);
    // The paths stay short.
    for thing in [x, y, n, m] {
        root[thing as usize] = low;
    }
    x != y
}
