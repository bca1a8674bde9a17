//! Packs over ranks: the same bits as without.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use crate::threads::Threads;
use femdem_mesh::catalogue::{CatalogueShape, Solid};
use femdem_pack::{Container, PackShape, PackSpec, Packing, Penalty, Pour, Protocol, Release};
use femdem_solve::{Halo, Medium, checkpoint};

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

/// A job that ranks share and finish, as the first one has it.
fn over_ranks(packing: &Packing, size: usize) -> Packing {
    let all = Threads::each(size, |halo| {
        let mut packing = packing.clone();
        packing.share_out(halo).unwrap();
        while !packing.is_done() {
            packing.advance_on(100, halo).unwrap();
        }
        packing.gather(halo).unwrap()
    });
    all.into_iter().flatten().next().unwrap()
}

fn assert_same(whole: &Packing, other: &Packing, what: &str) {
    assert_eq!(whole.report(), other.report(), "{what}");
    assert_eq!(whole.progress(), other.progress(), "{what}");
    let [a, b] = [whole, other].map(|packing| packing.world().checksum_of_motion().unwrap());
    assert_eq!(a, b, "{what}");
}

#[test]
fn ranks_make_the_same_pack() {
    let start = Packing::new(mixed(40)).unwrap();
    let mut whole = start.clone();
    let report = whole.run().unwrap();
    assert!(report.settled && report.relaxation.is_some(), "{report:?}");
    assert!(report.batches > 3, "{report:?}");
    for size in [2, 3] {
        assert_same(&whole, &over_ranks(&start, size), &format!("{size} ranks"));
    }
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

/// A job that some ranks have left at any stage goes on over others.
#[test]
fn a_job_goes_on_over_another_number_of_ranks() {
    let start = Packing::new(mixed(12)).unwrap();
    let mut whole = start.clone();
    whole.run().unwrap();
    let half = |packing: &Packing, size: usize, steps: u64| {
        let all = Threads::each(size, |halo| {
            let mut packing = packing.clone();
            packing.share_out(halo).unwrap();
            packing.advance_on(steps, halo).unwrap();
            let gathered = packing.gather(halo).unwrap();
            assert_eq!(gathered.is_some(), halo.rank() == 0);
            gathered
        });
        let bytes = checkpoint::encode(&all.into_iter().flatten().next().unwrap());
        checkpoint::decode::<Packing>(&bytes.unwrap()).unwrap()
    };
    let mut parts = start;
    let mut size = 1;
    while !parts.is_done() {
        size = size % 3 + 1;
        parts = half(&parts, size, 397);
    }
    assert_same(&whole, &parts, "parts");
}
