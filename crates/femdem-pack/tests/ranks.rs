//! Packs over ranks: the same bits as without.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::threads::Threads;
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::MeshOptions;
use femdem_pack::{Container, PackShape, PackSpec, Packing, Penalty, Pour, Protocol, Release};
use femdem_solve::{Alone, Halo, Medium, World, checkpoint};

const D: f64 = 0.02;

/// Bodies of two shapes in a narrow box.
fn mixed(count: u32) -> PackSpec {
    let shape = |name: &str, solid: Solid, d: f64| {
        let polyhedron = CatalogueShape::from(solid).polyhedron(d).unwrap();
        PackShape::new(name, polyhedron)
    };
    PackSpec {
        shapes: vec![
            shape("cube", Solid::P5, D),
            shape("large", Solid::A10, 1.3 * D),
        ],
        count,
        container: Container::Box {
            width: 5.0 * D,
            depth: 4.0 * D,
        },
        penalty: Penalty::Given { pressure: 1e6 },
        ..PackSpec::default()
    }
}

/// Bodies that are not convex, in a box whose ends know nothing of each other.
fn wide(count: u32) -> PackSpec {
    let ring: Shape = "hollow_cylinder:sides=6,aspect=0.5".parse().unwrap();
    let ring = ring.polyhedron(D).unwrap();
    let (ring, _) = PackShape::of_surface("ring", ring, &MeshOptions::default()).unwrap();
    PackSpec {
        shapes: vec![ring],
        container: Container::Box {
            width: 12.0 * D,
            depth: 2.0 * D,
        },
        ..mixed(count)
    }
}

/// A job that ranks share up to some point, as the first one has it; and whether that was ever without some of the bodies.
fn shared(packing: &Packing, size: usize, ends: fn(&Packing) -> bool) -> (Packing, bool) {
    let all = Threads::each(size, |halo| {
        let mut packing = packing.clone();
        packing.share_out(halo).unwrap();
        let mut lacks = false;
        while !ends(&packing) {
            packing.advance_on(100, halo).unwrap();
            let world = packing.world();
            lacks |= world.body_count() < world.count_in_whole();
        }
        Some((packing.gather(halo).unwrap()?, lacks))
    });
    all.into_iter().flatten().next().unwrap()
}

fn over_ranks(packing: &Packing, size: usize) -> Packing {
    shared(packing, size, Packing::is_done).0
}

fn assert_same(whole: &Packing, other: &Packing, what: &str) {
    assert_eq!(whole.report().unwrap(), other.report().unwrap(), "{what}");
    assert_eq!(whole.progress(), other.progress(), "{what}");
    let [a, b] = [whole, other].map(|packing| packing.world().checksum_of_motion().unwrap());
    assert_eq!(a, b, "{what}");
}

#[test]
fn ranks_make_the_same_pack() {
    let start = Packing::new(mixed(26)).unwrap();
    let mut whole = start.clone();
    let report = whole.run().unwrap();
    assert!(report.settled && report.relaxation.is_some(), "{report:?}");
    assert!(report.batches > 2, "{report:?}");
    assert_same(&whole, &over_ranks(&start, 3), "3 ranks");
}

/// Poured and awake, where no step is implicit; under local damping, whose relaxations are explicit; and all at once, with
/// implicit steps alone.
#[test]
fn ranks_make_the_same_pack_in_other_ways() {
    let pour = PackSpec {
        protocol: Protocol::Pour(Pour {
            rate: 100.0,
            layer: Some(4),
            ..Pour::default()
        }),
        ..mixed(16)
    };
    let mut awake = pour.clone();
    awake.sleeping.enabled = false;
    let damped = PackSpec {
        medium: Medium {
            local_damping: 0.3,
            ..Medium::default()
        },
        ..mixed(16)
    };
    let release = PackSpec {
        protocol: Protocol::Release(Release::default()),
        ..mixed(16)
    };
    for (what, spec) in [
        ("pour", pour),
        ("awake", awake),
        ("damped", damped),
        ("release", release),
    ] {
        let start = Packing::new(spec).unwrap();
        let mut whole = start.clone();
        whole.run().unwrap();
        assert_same(&whole, &over_ranks(&start, 2), what);
    }
}

#[test]
fn ranks_that_know_a_part_make_the_same_pack() {
    // The second batch starts above the top of the first.
    let ends = |packing: &Packing| packing.progress().batches == 2 || packing.is_done();
    let start = Packing::new(wide(14)).unwrap();
    let mut whole = start.clone();
    while !ends(&whole) {
        whole.advance(100).unwrap();
    }
    let (other, lacks) = shared(&start, 2, ends);
    assert!(lacks && !whole.is_done());
    assert_same(&whole, &other, "wide");
}

#[test]
fn jobs_that_differ_are_not_shared() {
    let refused = Threads::each(2, |halo| {
        let mut spec = mixed(4);
        spec.settling.residual *= 1.0 + halo.rank() as f64;
        let mut packing = Packing::new(spec).unwrap();
        packing.share_out(halo).unwrap_err().to_string()
    });
    for refused in refused {
        assert!(refused.contains("different worlds or jobs"), "{refused}");
    }
}

#[test]
fn a_part_of_a_job_gives_no_report() {
    let mut packing = Packing::new(mixed(4)).unwrap();
    packing.share_out(&mut Alone).unwrap();
    let refused = packing.report().unwrap_err().to_string();
    assert!(refused.contains("gather it first"), "{refused}");
}

/// A job as ranks have it, in bytes: of the first one, and the worlds of the others.
type Parts = (Vec<u8>, Vec<Vec<u8>>);

fn read(parts: &Parts) -> (Packing, impl Iterator<Item = World>) {
    let others = parts.1.iter();
    (
        checkpoint::decode(&parts.0).unwrap(),
        others.map(|bytes| World::from_bytes(bytes).unwrap()),
    )
}

/// Goes on from parts for some steps, over so many ranks. Returns the whole and its parts then.
fn on(parts: &Parts, size: usize, steps: u64) -> (Packing, Parts) {
    let all = Threads::each(size, |halo| {
        let rank = halo.rank();
        let (first, others) = read(parts);
        let own = others.skip(rank).step_by(size).collect();
        let first = (rank == 0).then_some(first);
        let mut packing = Packing::share_from_first(first, own, halo).unwrap();
        packing.advance_on(steps, halo).unwrap();
        let whole = packing.gather(halo).unwrap();
        assert_eq!(whole.is_some(), rank == 0);
        let bytes = match rank {
            0 => checkpoint::encode(&packing),
            _ => packing.world().to_bytes(),
        };
        (whole, bytes.unwrap())
    });
    let (wholes, bytes): (Vec<_>, Vec<_>) = all.into_iter().unzip();
    let mut bytes = bytes.into_iter();
    let parts = (bytes.next().unwrap(), bytes.collect());
    (wholes.into_iter().flatten().next().unwrap(), parts)
}

/// A job that some ranks have left at any stage goes on over others, and is whole in one process.
#[test]
fn a_job_goes_on_over_another_number_of_ranks() {
    let start = Packing::new(mixed(12)).unwrap();
    let mut alone = start.clone();
    alone.run().unwrap();
    let mut parts = (checkpoint::encode(&start).unwrap(), Vec::new());
    let mut whole = start;
    let mut size = 1;
    while !whole.is_done() {
        size = size % 3 + 1;
        (whole, parts) = on(&parts, size, 397);
        let (first, others) = read(&parts);
        let joined = Packing::of_parts(first, others.map(Ok)).unwrap();
        assert_same(&whole, &joined, "joined");
        if size == 2 {
            // By one process for a while.
            whole = checkpoint::decode(&checkpoint::encode(&joined).unwrap()).unwrap();
            whole.advance(99).unwrap();
            parts = (checkpoint::encode(&whole).unwrap(), Vec::new());
        }
    }
    assert_same(&alone, &whole, "parts");
}

/// What a rank gives: the job, and worlds of others.
type Given = (Option<Packing>, Vec<World>);

#[test]
fn parts_that_are_no_job_are_refused_on_all_ranks() {
    let start = Packing::new(wide(14)).unwrap();
    let (_, parts) = on(&(checkpoint::encode(&start).unwrap(), Vec::new()), 3, 50);
    let whys = |give: fn(&Parts, usize) -> Given| {
        Threads::each(2, |halo| {
            let (first, others) = give(&parts, halo.rank());
            let refused = Packing::share_from_first(first, others, halo);
            refused.unwrap_err().to_string()
        })
    };
    let lacks = whys(|parts, rank| {
        let (first, others) = read(parts);
        (
            (rank == 0).then_some(first),
            others.skip(1 + rank).collect(),
        )
    });
    let second = whys(|parts, rank| ((rank == 1).then(|| read(parts).0), Vec::new()));
    for (refused, why) in [
        (lacks, "do not have all bodies"),
        (second, "the first rank gives"),
    ] {
        assert!(refused.iter().all(|text| text.contains(why)), "{refused:?}");
    }
    let (first, others) = read(&parts);
    let refused = Packing::of_parts(first, others.skip(1).map(Ok)).unwrap_err();
    assert!(refused.to_string().contains("do not have all bodies"));
    assert_eq!(read(&parts).1.count(), 2);
}
