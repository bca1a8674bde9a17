//! Contributions of each body and each overlap to the bins.

use super::nest::{Nest, first};
use super::sectors::{Sector, block_at, reaches};
use crate::bounds::Bounds;
use crate::clip::Clipper;
use crate::neighbours::neighbour_pairs;
use crate::ordered::ordered_map;
use crate::overlap::{Pair, Scratch, load_shared, measure_pairs, shared_volume};
use crate::pack::Pack;
use crate::region::{Region, Relation};

/// Solid volume (m³) in successive bins, from one body or, negative, from one overlap.
pub(super) struct Deposit {
    pub(super) block: usize,
    pub(super) first: usize,
    pub(super) volumes: Vec<f64>,
}

/// All deposits, in the order of the bodies and then of the overlaps.
pub(super) fn deposits(
    pack: &Pack,
    region: &Region,
    nest: &Nest,
    blocks: &[Sector],
) -> Vec<Deposit> {
    let members: Vec<usize> = (0..pack.len())
        .filter(|&i| region.relation(pack.bounds(i)) != Relation::Outside)
        .collect();
    let bodies = ordered_map(members.len(), Clipper::default, |clipper, k| {
        let body = members[k];
        let load = |clipper: &mut Clipper| clipper.load(pack.shape(body), pack.pose(body));
        by_blocks(clipper, pack.bounds(body), nest, blocks, 1.0, load)
    });
    let pairs = measure_pairs(pack, &neighbour_pairs(pack, &members), Some(region));
    let overlaps = ordered_map(pairs.len(), Memory::default, |memory, k| {
        overlap(memory, pack, pairs[k].0, nest, blocks)
    });
    bodies.into_iter().chain(overlaps).flatten().collect()
}

#[derive(Default)]
struct Memory {
    scratch: Scratch,
    clipper: Clipper,
}

/// Cuts a surface by the blocks that it reaches, and each part into bins.
fn by_blocks(
    clipper: &mut Clipper,
    bounds: &Bounds,
    nest: &Nest,
    blocks: &[Sector],
    sign: f64,
    load: impl Fn(&mut Clipper),
) -> Vec<Deposit> {
    let reached = (0..blocks.len()).filter(|&b| reaches(&blocks[b], bounds));
    let deposit = |block: usize| {
        load(clipper);
        for (normal, offset) in &blocks[block] {
            clipper.clip(normal, *offset);
        }
        let bounds = clipper.bounds();
        if clipper.is_empty() {
            return None;
        }
        let (first, mut volumes) = into_bins(nest, &bounds, clipper.volume(), |part| {
            clipper.volume_in(part)
        });
        volumes.iter_mut().for_each(|v| *v *= sign);
        Some(Deposit {
            block,
            first,
            volumes,
        })
    };
    reached.filter_map(deposit).collect()
}

/// The first bin that a part within `bounds` reaches, and its volume in that bin and the following ones;
/// `within` returns its volume in nested parts of the region.
fn into_bins(
    nest: &Nest,
    bounds: &Bounds,
    whole: f64,
    mut within: impl FnMut(&Region) -> f64,
) -> (usize, Vec<f64>) {
    let relation = |k: usize| {
        nest.part(k)
            .map_or(Relation::Outside, |part| part.relation(bounds))
    };
    let crossed = first(0..nest.count, |k| relation(k) != Relation::Inside);
    let left = first(crossed..nest.count, |k| relation(k) == Relation::Outside);
    let mut volumes = Vec::with_capacity(left - crossed + 1);
    let mut rest = whole;
    for k in crossed..=left {
        let next = match nest.part(k) {
            Some(part) if k < left => within(&part),
            _ => 0.0,
        };
        // What lies outside the first part is in no bin.
        if k > 0 {
            volumes.push(rest - next);
        }
        rest = next;
    }
    (crossed.saturating_sub(1), volumes)
}

fn overlap(
    memory: &mut Memory,
    pack: &Pack,
    pair: Pair,
    nest: &Nest,
    blocks: &[Sector],
) -> Vec<Deposit> {
    let Memory { scratch, clipper } = memory;
    if let Some(shared) = load_shared(scratch, pack, pair) {
        let bounds = shared.bounds();
        return by_blocks(clipper, &bounds, nest, blocks, -1.0, |clipper| {
            clipper.copy_from(shared);
        });
    }
    // For bodies that are not handled by planes, blocks do not cut the volume; they only decide to which block
    // it belongs.
    let common = pack.bounds(pair.0).clamped_to(pack.bounds(pair.1));
    let (middle, half) = common.middle_and_half();
    if half.min() < 0.0 {
        return Vec::new();
    }
    let Some(block) = block_at(blocks, &middle) else {
        return Vec::new();
    };
    let whole = shared_volume(scratch, pack, pair, None);
    let (first, mut volumes) = into_bins(nest, &common, whole, |part| {
        shared_volume(scratch, pack, pair, Some(part))
    });
    volumes.iter_mut().for_each(|v| *v = -*v);
    vec![Deposit {
        block,
        first,
        volumes,
    }]
}
