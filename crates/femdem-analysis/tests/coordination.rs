//! Coordination numbers on packs and graphs with known answers.

use crate::common::{at, cube};
use femdem_analysis::{
    AnalysisError, ContactCount, CoordinationOptions, Pack, Partner, Region, Touch, contact_counts,
    coordination,
};
use femdem_mesh::{Point3, Vector3};
use proptest::prelude::*;

fn touch(first: u32, second: Partner, normal_force: f64) -> Touch {
    Touch {
        first,
        second,
        normal_force,
    }
}

/// A simple cubic block of 4 x 4 x 4: six neighbours each, with walls in place of neighbours at the faces.
#[test]
fn simple_cubic_block() {
    let n = 4;
    let index = |x: u32, y: u32, z: u32| x + n * (y + n * z);
    let mut touches = Vec::new();
    for (x, y, z) in (0..n * n * n).map(|i| (i % n, i / n % n, i / (n * n))) {
        let i = index(x, y, z);
        for (k, at) in (0..).zip([x, y, z]) {
            if at == 0 {
                touches.push(touch(i, Partner::Wall(2 * k), 1.0));
            }
            let next = [index(x + 1, y, z), index(x, y + 1, z), index(x, y, z + 1)][k as usize];
            let partner = if at + 1 == n {
                Partner::Wall(2 * k + 1)
            } else {
                Partner::Body(next)
            };
            touches.push(touch(i, partner, 1.0));
        }
    }
    let all = coordination(64, &touches, &CoordinationOptions::default()).unwrap();
    assert_eq!((all.mean, all.sd, all.bodies), (6.0, 0.0, 64));
    assert_eq!(all.histogram, [0, 0, 0, 0, 0, 0, 64]);
    assert_eq!(all.wall_contacts, 6 * 16);
    assert_eq!(all.mean_without_walls, 6.0 - 96.0 / 64.0);

    let shape = cube(1.0);
    let place = |i: u32| f64::from(i);
    let bodies = at((0..64).map(|i| Vector3::new(place(i % 4), place(i / 4 % 4), place(i / 16))));
    let pack = Pack::new(std::slice::from_ref(&shape), &bodies).unwrap();
    let core = Region::Box {
        min: Point3::from([0.5; 3]),
        max: Point3::from([2.5; 3]),
    };
    let inner = pack.bodies_in(&core).unwrap();
    assert_eq!(inner, [21, 22, 25, 26, 37, 38, 41, 42]);
    let options = CoordinationOptions {
        among: Some(&inner),
        ..CoordinationOptions::default()
    };
    let inner = coordination(64, &touches, &options).unwrap();
    assert_eq!(
        (inner.bodies, inner.wall_contacts, inner.mean_without_walls),
        (8, 0, 6.0)
    );
}

/// The threshold is on the sum over a pair's contacts, and repeats of a pair or a body count once.
#[test]
fn pairs_count_once_above_the_threshold() {
    let touches = [
        touch(0, Partner::Body(1), 0.6),
        touch(1, Partner::Body(0), 0.6),
        touch(2, Partner::Body(1), 0.9),
        touch(2, Partner::Wall(7), 5.0),
        touch(2, Partner::Wall(7), 5.0),
        touch(2, Partner::Wall(9), 5.0),
        touch(0, Partner::Wall(7), 0.0),
    ];
    let counts = contact_counts(4, &touches, 1.0).unwrap();
    let count = |bodies, walls| ContactCount { bodies, walls };
    assert_eq!(counts, [count(1, 0), count(1, 0), count(0, 2), count(0, 0)]);
    let result = coordination(4, &touches, &CoordinationOptions::default()).unwrap();
    assert_eq!(result.histogram, [1, 1, 1, 1]);
    assert!(
        (result.mean - 1.5).abs() < 1e-15 && (result.sd - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15
    );
    let repeated = CoordinationOptions {
        among: Some(&[2, 2, 0]),
        ..CoordinationOptions::default()
    };
    assert_eq!(coordination(4, &touches, &repeated).unwrap().bodies, 2);
}

/// Two interlocked hooks that pull on one another in several patches, listed patch by patch in any
/// order and either way round, are one pair; so is a hook that lies on a wall in two places.
#[test]
fn patches_of_a_pair_count_once() {
    let patches = [
        touch(0, Partner::Body(1), 2.0),
        touch(2, Partner::Body(1), 0.5),
        touch(1, Partner::Body(0), 3.0),
        touch(0, Partner::Wall(4), 0.1),
        touch(0, Partner::Body(1), 0.0),
        touch(0, Partner::Wall(4), 0.1),
        touch(1, Partner::Body(2), 0.25),
    ];
    let result = coordination(3, &patches, &CoordinationOptions::default()).unwrap();
    assert_eq!(result.histogram, [0, 1, 2]);
    assert_eq!((result.wall_contacts, result.mean), (1, 5.0 / 3.0));
    // The forces of a pair's patches are summed before the threshold: 0.5 + 0.25 passes, 0.2 does not.
    let options = CoordinationOptions {
        force_threshold: 0.6,
        ..CoordinationOptions::default()
    };
    let result = coordination(3, &patches, &options).unwrap();
    assert_eq!(result.histogram, [0, 2, 1]);
    assert_eq!(result.wall_contacts, 0);
}

/// A body that hangs from a wall by attraction, and another from it, touch: the threshold is on the size of the force.
#[test]
fn pairs_that_pull_touch() {
    let touches = [
        touch(0, Partner::Wall(0), -2.0),
        touch(1, Partner::Body(0), -1.0),
        touch(1, Partner::Body(2), 0.0),
    ];
    let result = coordination(3, &touches, &CoordinationOptions::default()).unwrap();
    assert_eq!(result.histogram, [1, 1, 1]);
    let counts = contact_counts(3, &touches, 1.5).unwrap();
    assert_eq!(counts[1], ContactCount::default());
    assert_eq!(counts[0].total(), 1);
}

#[test]
fn bad_touches_are_refused() {
    let refused =
        |touches: &[Touch]| coordination(3, touches, &CoordinationOptions::default()).unwrap_err();
    let good = touch(0, Partner::Body(1), 1.0);
    assert!(matches!(
        refused(&[good, touch(3, Partner::Wall(0), 1.0)]),
        AnalysisError::BodyIndex {
            index: 1,
            body: 3,
            ..
        }
    ));
    assert!(matches!(
        refused(&[touch(0, Partner::Body(9), 1.0)]),
        AnalysisError::BodyIndex { body: 9, .. }
    ));
    assert_eq!(
        refused(&[touch(2, Partner::Body(2), 1.0)]),
        AnalysisError::SelfTouch { index: 0, body: 2 }
    );
    assert!(matches!(
        refused(&[touch(0, Partner::Wall(0), f64::NAN)]),
        AnalysisError::TouchForce { .. }
    ));
    assert_eq!(
        coordination(0, &[], &CoordinationOptions::default()),
        Err(AnalysisError::EmptyPack)
    );
    let options = CoordinationOptions {
        force_threshold: f64::NAN,
        among: None,
    };
    assert!(matches!(
        coordination(3, &[good], &options),
        Err(AnalysisError::Option { .. })
    ));
    let options = CoordinationOptions {
        among: Some(&[5]),
        ..CoordinationOptions::default()
    };
    assert!(matches!(
        coordination(3, &[good], &options),
        Err(AnalysisError::BodyIndex { body: 5, .. })
    ));
}

proptest! {
    /// Compared with a matrix of touching pairs; the order of the list and of each pair does not matter.
    #[test]
    fn counts_agree_with_a_matrix(list in prop::collection::vec((0_u32..12, 0_u32..15, any::<bool>()), 0..80)) {
        let mut met = [[false; 15]; 12];
        let mut touches = Vec::new();
        for &(i, j, swap) in list.iter().filter(|(i, j, _)| i != j) {
            met[i as usize][j as usize] = true;
            if j < 12 {
                met[j as usize][i as usize] = true;
                let (a, b) = if swap { (j, i) } else { (i, j) };
                touches.push(touch(a, Partner::Body(b), 1.0));
            } else {
                touches.push(touch(i, Partner::Wall(j), 1.0));
            }
        }
        let expected: Vec<u32> = met.iter().map(|row| row.iter().filter(|m| **m).count() as u32).collect();
        let counts = contact_counts(12, &touches, 0.0).unwrap();
        prop_assert_eq!(counts.iter().map(ContactCount::total).collect::<Vec<_>>(), expected);
        let result = coordination(12, &touches, &CoordinationOptions::default()).unwrap();
        let bodies: u64 = result.histogram.iter().sum();
        let partners: u64 = (0..).zip(&result.histogram).map(|(k, n)| k * n).sum();
        prop_assert_eq!(bodies, 12);
        prop_assert!((result.mean * 12.0 - partners as f64).abs() < 1e-9);
    }
}
