//! Which of two overlapping tetrahedra of one body counts as A and which as B.

use super::shape::DeformableShape;

/// Pairs that hang together: the place of each in the list, and whether its second tetrahedron belongs to the part of the
/// first one's first.
type Part = Vec<(u32, bool)>;

/// Puts the tetrahedron of A first in each of `pairs`, which have the lower number first and are sorted.
///
/// Pairs that hang together are all the same way round. They keep the way of `before` (pairs with the lower number first,
/// sorted, and whether A has the lower number); new ones are such that a layer between two others is not B of both, if
/// possible: the springs of friction belong to the triangles of B.
pub(crate) fn orient(pairs: &mut [[u32; 2]], shape: &DeformableShape, before: &[([u32; 2], bool)]) {
    let beside = |i: u32| shape.wholes()[i as usize].neighbours.into_iter().flatten();
    orient_by(pairs, beside, shape.wholes().len(), before);
}

/// The same for `count` tetrahedra, with those across the faces of each.
fn orient_by<I: Iterator<Item = u32>>(
    pairs: &mut [[u32; 2]],
    beside: impl Fn(u32) -> I,
    count: usize,
    before: &[([u32; 2], bool)],
) {
    let parts = parts(pairs, beside);
    let ways: Vec<Option<bool>> = parts
        .iter()
        .map(|part| known(part, pairs, before))
        .collect();
    let mut in_b = vec![false; count];
    for is_new in [false, true] {
        for (part, way) in parts.iter().zip(&ways) {
            if way.is_none() == is_new {
                let swaps = way.unwrap_or_else(|| is_taken(part, pairs, &in_b));
                for &(place, turns) in part {
                    let pair = &mut pairs[place as usize];
                    if turns != swaps {
                        pair.swap(0, 1);
                    }
                    in_b[pair[1] as usize] = true;
                }
            }
        }
    }
}

/// Whether a part was the other way round on the last list; `None` if it is new.
fn known(part: &Part, pairs: &[[u32; 2]], before: &[([u32; 2], bool)]) -> Option<bool> {
    let mut votes = 0_i64;
    for &(place, turns) in part {
        let key = pairs[place as usize];
        if let Ok(found) = before.binary_search_by_key(&key, |(pair, _)| *pair) {
            // Its lower number is that of A if it does not turn.
            votes += if before[found].1 == turns { 1 } else { -1 };
        }
    }
    (votes != 0).then_some(votes > 0)
}

/// Whether more tetrahedra of the second side belong to a B than of the first.
fn is_taken(part: &Part, pairs: &[[u32; 2]], in_b: &[bool]) -> bool {
    let taken = |side: bool| {
        let own = part
            .iter()
            .map(|&(place, turns)| pairs[place as usize][usize::from(turns != side)]);
        own.filter(|tet| in_b[*tet as usize]).count()
    };
    taken(true) > taken(false)
}

/// The pairs that hang together: two with a common tetrahedron, if their others share a face.
fn parts<I: Iterator<Item = u32>>(pairs: &[[u32; 2]], beside: impl Fn(u32) -> I) -> Vec<Part> {
    let mut found = vec![false; pairs.len()];
    let mut parts = Vec::new();
    for seed in 0..pairs.len() {
        if std::mem::replace(&mut found[seed], true) {
            continue;
        }
        let mut part: Part = vec![(seed as u32, false)];
        let mut next = 0;
        while let Some(&(place, turns)) = part.get(next) {
            next += 1;
            let own = pairs[place as usize];
            for side in [false, true] {
                let (shared, other) = (own[usize::from(side)], own[usize::from(!side)]);
                for beyond in beside(other) {
                    let key = [shared.min(beyond), shared.max(beyond)];
                    if let Ok(at) = pairs.binary_search(&key)
                        && !std::mem::replace(&mut found[at], true)
                    {
                        // Whether the common tetrahedron is second there.
                        let its_side = shared > beyond;
                        part.push((at as u32, turns != (side != its_side)));
                    }
                }
            }
        }
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tetrahedra in a row: each shares a face with the next.
    fn orient(pairs: &mut [[u32; 2]], before: &[([u32; 2], bool)]) {
        let beside = |i: u32| [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
        orient_by(pairs, beside, 40, before);
    }

    /// A contact in which the numbers of both sides cross is one all the same.
    #[test]
    fn pairs_of_one_contact_are_the_same_way_round() {
        // The second of a pair moves down while the first stays, then the first moves up past it.
        let mut pairs = [[5, 12], [5, 11], [6, 11], [6, 10], [0, 19]];
        pairs.sort_unstable();
        orient(&mut pairs, &[]);
        for pair in [[5, 12], [5, 11], [6, 11], [6, 10]] {
            assert!(pairs.contains(&pair), "{pairs:?}");
        }
        let mut turned = [[5, 11], [5, 12], [6, 10], [6, 11]];
        orient(&mut turned, &[([5, 12], false)]);
        assert_eq!(turned, [[11, 5], [12, 5], [10, 6], [11, 6]]);
    }

    /// A layer between two others is B of one of them only.
    #[test]
    fn the_middle_layer_is_b_once() {
        let mut pairs = [[5, 20], [20, 35]];
        orient(&mut pairs, &[]);
        assert_eq!(pairs, [[5, 20], [20, 35]]);
        let mut pairs = [[5, 20], [10, 20]];
        orient(&mut pairs, &[]);
        assert_eq!(pairs, [[5, 20], [20, 10]]);
    }
}
