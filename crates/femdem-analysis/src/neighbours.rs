//! Pairs of bodies whose boxes overlap.

use crate::bounds::Bounds;
use crate::ordered::ordered_map;
use crate::pack::Pack;

type Cell = [i64; 3];

/// Pairs `(i, j)`, `i < j`, of `members` whose boxes overlap, sorted.
///
/// Boxes are sorted into cubic cells of the largest extent, so partners lie in adjoining cells.
pub(crate) fn neighbour_pairs(pack: &Pack, members: &[usize]) -> Vec<(usize, usize)> {
    let extent = members
        .iter()
        .map(|&i| (pack.bounds(i).max - pack.bounds(i).min).max())
        .fold(0.0, f64::max);
    if extent <= 0.0 {
        return Vec::new();
    }
    let mut cells: Vec<(Cell, usize)> = members
        .iter()
        .map(|&i| (cell_of(pack.bounds(i), extent), i))
        .collect();
    cells.sort_unstable();
    let partners = ordered_map(
        cells.len(),
        || (),
        |(), at| partners_of(pack, &cells, cells[at]),
    );
    let mut pairs: Vec<_> = partners.into_iter().flatten().collect();
    pairs.sort_unstable();
    pairs
}

fn cell_of(bounds: &Bounds, extent: f64) -> Cell {
    [0, 1, 2].map(|k| (0.5 * (bounds.min[k] + bounds.max[k]) / extent).floor() as i64)
}

fn partners_of(
    pack: &Pack,
    cells: &[(Cell, usize)],
    (cell, i): (Cell, usize),
) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for dx in -1..=1 {
        for dy in -1..=1 {
            // The three cells that follow one another along z lie side by side in the list.
            let column = [cell[0].saturating_add(dx), cell[1].saturating_add(dy)];
            let low = ([column[0], column[1], cell[2].saturating_sub(1)], 0);
            let high = (
                [column[0], column[1], cell[2].saturating_add(1)],
                usize::MAX,
            );
            let range = cells.partition_point(|c| *c < low)..cells.partition_point(|c| *c <= high);
            for &(_, j) in &cells[range] {
                if i < j && pack.bounds(i).meets(pack.bounds(j)) {
                    found.push((i, j));
                }
            }
        }
    }
    found
}
