//! Rattlers, chains and thresholds on small graphs with known answers, and against brute force.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use std::f64::consts::FRAC_PI_4;

use crate::common::Random;
use crate::common::forces::{between, body, on_wall};
use femdem_analysis::{
    AnalysisError, BlockBootstrap, ChainNetwork, ChainOptions, ContactClass, ForceBody,
    ForceContact, ForceDistributionOptions, ForceNetwork, Partner, StressRule, SupportRule,
    ThresholdOptions, WeightRule, chains_by_stress, chains_by_weight, contact_classes,
    contact_fabric, force_distribution, force_maxima, rattlers, threshold_curve,
};
use femdem_mesh::{Point3, Vector3};

/// Chains of the network with all given links, by the weight rule.
fn chains_of(bodies: &[ForceBody], links: &[(u32, u32)]) -> ChainNetwork {
    let contacts: Vec<ForceContact> = links
        .iter()
        .map(|(i, j)| between(bodies, *i, *j, 4.0))
        .collect();
    let network = ForceNetwork::new(bodies, &contacts, 0.0).unwrap();
    chains_by_weight(
        &network,
        WeightRule { factor: 0.5 },
        &ChainOptions::default(),
    )
    .unwrap()
}

/// A triangle with a tail of three, a lone pair, and a hexagon. Straightness by hand.
#[test]
fn triangle_with_a_tail_and_a_ring() {
    let mut bodies = vec![
        body(0.0, 0.0, 0.0),
        body(1.0, 0.0, 0.0),
        body(0.5, 0.75_f64.sqrt(), 0.0),
        // The tail continues from body 1 along x, then turns up.
        body(2.0, 0.0, 0.0),
        body(3.0, 0.0, 0.0),
        body(3.0, 0.0, 1.0),
        body(9.0, 0.0, 0.0),
        body(9.0, 1.0, 0.0),
    ];
    for k in 0..6 {
        let (y, x) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        bodies.push(body(20.0 + x, y, 2.0));
    }
    let mut links = vec![(0, 1), (1, 2), (0, 2), (1, 3), (3, 4), (4, 5), (6, 7)];
    links.extend((0..6).map(|k| (8 + k, 8 + (k + 1) % 6)));
    let found = chains_of(&bodies, &links);
    assert_eq!(found.chains.len(), 2);
    assert_eq!(
        (found.bodies, found.cycles, found.branch_bodies),
        (12, 2, 1)
    );
    assert_eq!(found.links.len(), 12);
    assert_eq!(found.share_of_pairs, 12.0 / 13.0);
    assert_eq!(found.share_of_force, 12.0 / 13.0);
    assert_eq!(found.share_of_bodies, 12.0 / 14.0);
    let [kite, ring] = [found.chains[0], found.chains[1]];
    assert_eq!(
        (kite.bodies, kite.links, kite.cycles, kite.length_links),
        (6, 6, 1, 4)
    );
    // The backbone runs from body 0 to body 5: (0,0,0) to (3,0,1).
    assert!((kite.length - 4.0).abs() < 1e-12);
    assert!((kite.end_to_end - 10_f64.sqrt()).abs() < 1e-12);
    assert!((kite.straightness - 10_f64.sqrt() / 4.0).abs() < 1e-12);
    assert_eq!((kite.height, kite.largest_force), (1.0, 4.0));
    assert_eq!(
        (ring.bodies, ring.links, ring.cycles, ring.length_links),
        (6, 6, 1, 3)
    );
    // Half way round a hexagon: two radii over three sides.
    assert!((ring.straightness - 2.0 / 3.0).abs() < 1e-12);

    // Segments: the tail, the rest of the triangle, and the ring.
    let mut lengths: Vec<(u32, usize)> =
        found.segments.iter().map(|s| (s.chain, s.links)).collect();
    lengths.sort_unstable();
    assert_eq!(lengths, [(0, 3), (0, 3), (1, 6)]);
    let tail = found
        .segments
        .iter()
        .find(|s| s.chain == 0 && s.end_to_end > 0.0)
        .unwrap();
    assert!((tail.straightness - 5_f64.sqrt() / 3.0).abs() < 1e-12);
    let mut ends = tail.ends;
    ends.sort_unstable();
    assert_eq!(ends, [1, 5]);
    let mut turns = tail.turns.clone();
    turns.sort_by(f64::total_cmp);
    assert!(turns[0].abs() < 1e-7 && (turns[1] - 2.0 * FRAC_PI_4).abs() < 1e-12);
    let loops: Vec<f64> = found
        .segments
        .iter()
        .map(|s| s.straightness)
        .filter(|s| *s == 0.0)
        .collect();
    assert_eq!(loops.len(), 2);
    assert_eq!(found.chain_bodies.mean, 6.0);
    assert_eq!(found.segment_links.mean, 4.0);
    // No chain carries 0, not -0.
    let none = chains_of(&bodies, &[(0, 1)]);
    assert!(none.chains.is_empty() && none.share_of_force.is_sign_positive());
}

/// The threshold is the factor times the mean of the largest F_c/W, with friction and with the mean weight of a
/// pair; a contact at the threshold does not count.
#[test]
fn weight_rule_by_hand() {
    let mut bodies = vec![
        body(0.0, 0.0, 0.0),
        body(1.0, 0.0, 0.0),
        body(2.0, 0.0, 0.0),
        body(3.0, 0.0, 0.0),
    ];
    bodies[3].weight = 3.0;
    let mut contacts = vec![
        between(&bodies, 0, 1, 3.0),
        between(&bodies, 1, 2, 6.0),
        between(&bodies, 2, 3, 12.0),
        on_wall(
            0,
            0,
            Point3::origin(),
            -Vector3::z(),
            Vector3::new(0.0, 0.0, -6.0),
        ),
    ];
    contacts[0].tangential = Vector3::z() * 4.0;
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    // Largest of each body: wall 6; 6; 12; 12 over 3. Mean 7.
    let maxima = force_maxima(&network, BlockBootstrap::default()).unwrap();
    assert_eq!(maxima.bodies, [6.0, 6.0, 12.0, 4.0]);
    assert_eq!(
        (maxima.mean.mean, maxima.median, maxima.largest),
        (7.0, 6.0, 12.0)
    );
    // F_c/W: 5, 6, 12/2 = 6, wall 6.
    let options = ChainOptions {
        least_bodies: 2,
        ..ChainOptions::default()
    };
    let chains = |factor: f64| {
        let found = chains_by_weight(&network, WeightRule { factor }, &options).unwrap();
        let links: Vec<(u32, u32)> = found.links.iter().map(|l| (l.first, l.second)).collect();
        (links, found.wall_contacts)
    };
    assert_eq!(chains(5.9 / 7.0), (vec![(1, 2), (2, 3)], 1));
    assert_eq!(chains(4.9 / 7.0), (vec![(0, 1), (1, 2), (2, 3)], 1));
    assert_eq!(chains(6.0 / 7.0), (vec![], 0));
    assert!(matches!(
        chains_by_weight(&network, WeightRule { factor: 0.0 }, &options),
        Err(AnalysisError::Option { name: "factor", .. })
    ));
}

/// Two loaded columns of five that touch in the middle: two chains, as the contact between them lies across the
/// stress. Leaning the line between the columns to within 45° joins them.
#[test]
fn stress_rule_on_two_columns() {
    let with_offset = |offset: f64| {
        let mut bodies: Vec<ForceBody> = (0..5).map(|k| body(0.0, 0.0, f64::from(k))).collect();
        bodies.extend((0..5).map(|k| body(1.0, 0.0, f64::from(k) + offset)));
        // Bodies that carry next to nothing lower the mean.
        bodies.extend((0..10).map(|k| body(5.0 + f64::from(k), 0.0, 0.0)));
        let mut contacts = Vec::new();
        for column in [0, 5] {
            contacts.extend((0..4).map(|k| between(&bodies, column + k, column + k + 1, 100.0)));
            for (k, up) in [(0, -1.0), (4, 1.0)] {
                let point = bodies[column as usize + k].centre + Vector3::z() * (0.5 * up);
                let force = Vector3::z() * (100.0 * up);
                contacts.push(on_wall(
                    column + k as u32,
                    0,
                    point,
                    Vector3::z() * up,
                    force,
                ));
            }
        }
        contacts.push(between(&bodies, 2, 7, 1.0));
        contacts.extend((0..9).map(|k| between(&bodies, 10 + k, 11 + k, 0.1)));
        let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
        chains_by_stress(&network, StressRule::default(), &ChainOptions::default()).unwrap()
    };
    let apart = with_offset(0.5);
    assert_eq!(
        apart.chains.iter().map(|c| c.bodies).collect::<Vec<_>>(),
        [5, 5]
    );
    assert!(
        apart
            .chains
            .iter()
            .all(|c| c.straightness == 1.0 && c.length_links == 4)
    );
    let joined = with_offset(1.2);
    assert_eq!(
        joined.chains.iter().map(|c| c.bodies).collect::<Vec<_>>(),
        [10]
    );
    // Mean major stress: ten bodies with 100 Pa, ten with 0.1 Pa but the ends with half; the cross contact
    // adds to two.
    assert!((apart.threshold - 50.0).abs() < 1.0, "{}", apart.threshold);
}

/// A row that hangs on one body falls with it, by either rule; a ring of points stays by partners, not by
/// constraints without friction.
#[test]
fn rattlers_by_hand() {
    let bodies: Vec<ForceBody> = (0..9).map(|k| body(f64::from(k), 0.0, 0.0)).collect();
    let touch = |i: u32, j: u32, class: ContactClass| ForceContact {
        class: Some(class),
        ..between(&bodies, i, j, 1.0)
    };
    let wall = |i: u32, class| ForceContact {
        class: Some(class),
        ..on_wall(
            i,
            0,
            bodies[i as usize].centre,
            -Vector3::z(),
            -Vector3::z(),
        )
    };
    use ContactClass::{EdgeFace, FaceFace, Point};
    let contacts = [
        // 0 stands on the floor; 1 and 2 lie upon one another on it by faces.
        wall(0, FaceFace),
        touch(0, 1, FaceFace),
        touch(1, 2, FaceFace),
        // 3, 4 and 5 form a ring of points with an edge on the floor each.
        touch(3, 4, Point),
        touch(4, 5, Point),
        touch(5, 3, Point),
        wall(3, EdgeFace),
        // 6 hangs on 5 by a point, 7 on 6; 8 touches nothing.
        touch(5, 6, Point),
        touch(6, 7, Point),
    ];
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let by = |rule| rattlers(&network, rule).unwrap();
    let partners = by(SupportRule::Partners { least: 2 });
    // 7, 6; and from the top of the stack 2, 1, 0.
    assert_eq!(partners.bodies, [0, 1, 2, 6, 7, 8]);
    let friction = by(SupportRule::default());
    assert_eq!(friction.bodies, [6, 7, 8]);
    assert_eq!((friction.held, friction.pairs), (6, 7));
    // Three stacked faces, three points, one edge.
    assert_eq!(friction.constraints_frictionless, 9 + 3 + 2);
    assert_eq!(friction.constraints_frictional, 18 + 9 + 5);
    assert_eq!(friction.degrees_of_freedom, 36);
    assert_eq!(friction.stiffness_ratio_frictional, 32.0 / 36.0);
    assert_eq!(friction.mean_coordination, 12.0 / 6.0);
    let smooth = by(SupportRule::Constraints { friction: false });
    // Without friction a face takes 3 motions: only the stack below its top, then nothing, is held.
    assert_eq!(smooth.held, 0);
    assert_eq!(smooth.stiffness_ratio_frictional, 0.0);
    assert_eq!(by(SupportRule::Partners { least: 1 }).bodies, [8]);
    let classes = contact_classes(&network);
    assert_eq!(classes.bodies.map(|c| c.contacts), [2, 0, 5, 0]);
    assert_eq!(classes.walls.map(|c| c.contacts), [1, 1, 0, 0]);
}

fn random_links(random: &mut Random, count: u32, links: usize) -> Vec<(u32, u32, f64)> {
    let mut pick = |n: f64| random.uniform(0.0, n);
    let mut found = Vec::new();
    while found.len() < links {
        let (i, j) = (pick(f64::from(count)) as u32, pick(f64::from(count)) as u32);
        if i != j
            && !found
                .iter()
                .any(|(a, b, _)| (*a, *b) == (i.min(j), i.max(j)))
        {
            found.push((i.min(j), i.max(j), pick(3.0)));
        }
    }
    found
}

/// Rattlers are compared with a repeated check of every body, the curve with a flood fill for each threshold.
#[test]
fn random_graphs_against_brute_force() {
    for seed in 1..40 {
        let mut random = Random(seed);
        let count = 25;
        let bodies: Vec<ForceBody> = (0..count)
            .map(|_| {
                let mut x = || random.uniform(0.0, 9.0);
                body(x(), x(), x())
            })
            .collect();
        let links = random_links(&mut random, count, 20 + seed as usize);
        let contacts: Vec<ForceContact> = links
            .iter()
            .map(|(i, j, f)| between(&bodies, *i, *j, *f))
            .collect();
        let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
        for least in 1..4 {
            let mut held = vec![true; count as usize];
            loop {
                let partners = |i: u32| {
                    links
                        .iter()
                        .filter(|(a, b, _)| {
                            (*a == i && held[*b as usize]) || (*b == i && held[*a as usize])
                        })
                        .count()
                };
                let falls = (0..count).find(|i| held[*i as usize] && partners(*i) < least as usize);
                let Some(falls) = falls else { break };
                held[falls as usize] = false;
            }
            let expected: Vec<u32> = (0..count).filter(|i| !held[*i as usize]).collect();
            let found = rattlers(&network, SupportRule::Partners { least }).unwrap();
            assert_eq!(found.bodies, expected);
        }
        let mean = links.iter().map(|l| l.2).sum::<f64>() / links.len() as f64;
        let options = ThresholdOptions {
            thresholds: vec![1.2, 0.0, 0.5, 0.5, 1.7, 3.0, -1.0],
        };
        for point in threshold_curve(&network, &options).unwrap().points {
            let strong: Vec<_> = links
                .iter()
                .filter(|l| l.2 > point.threshold * mean)
                .collect();
            let mut label: Vec<u32> = (0..count).collect();
            for _ in 0..count {
                for (i, j, _) in &strong {
                    let low = label[*i as usize].min(label[*j as usize]);
                    (label[*i as usize], label[*j as usize]) = (low, low);
                }
            }
            let sizes: Vec<usize> = (0..count)
                .map(|l| label.iter().filter(|x| **x == l).count())
                .filter(|n| *n > 1)
                .collect();
            assert_eq!(point.links, strong.len());
            assert_eq!(point.components, sizes.len());
            assert_eq!(point.largest, sizes.iter().copied().max().unwrap_or(0));
            assert_eq!(point.bodies, sizes.iter().sum::<usize>());
            assert_eq!(point.cycles, strong.len() + sizes.len() - point.bodies);
        }
    }
}

/// The backbone is the longest of the shortest ways between any two bodies (Floyd and Warshall's).
#[test]
fn backbones_against_all_pairs() {
    for seed in 1..20 {
        let mut random = Random(seed + 100);
        let count = 30_u32;
        let bodies: Vec<ForceBody> = (0..count)
            .map(|_| {
                let mut x = || random.uniform(0.0, 9.0);
                body(x(), x(), x())
            })
            .collect();
        let links: Vec<(u32, u32)> = random_links(&mut random, count, 35)
            .into_iter()
            .map(|(i, j, _)| (i, j))
            .collect();
        let found = chains_of(&bodies, &links);
        let n = count as usize;
        let mut far = vec![vec![usize::MAX / 4; n]; n];
        for (i, j) in &links {
            far[*i as usize][*j as usize] = 1;
            far[*j as usize][*i as usize] = 1;
        }
        for k in 0..n {
            for i in 0..n {
                for j in 0..n {
                    far[i][j] = far[i][j].min(far[i][k] + far[k][j]);
                }
            }
        }
        let widest = (0..n)
            .flat_map(|i| (0..n).map(move |j| (i, j)))
            .filter(|(i, j)| i != j)
            .map(|(i, j)| far[i][j])
            .filter(|d| *d < usize::MAX / 4)
            .max();
        let longest = found.chains.iter().map(|c| c.length_links).max();
        assert_eq!(longest, widest);
        // Every link is in one segment, and segments end where chains branch or end.
        let in_segments: usize = found.segments.iter().map(|s| s.links).sum();
        assert_eq!(in_segments, found.links.len());
        assert!(
            found
                .chains
                .iter()
                .all(|c| c.end_to_end <= c.length + 1e-12)
        );
    }
}

/// Anisotropy of normals drawn with P(n) ~ 1 + a (3 cos² − 1)/2 comes back as a; uniform ones are below
/// three times their noise.
#[test]
fn anisotropy_of_drawn_normals() {
    let mut random = Random(77);
    let bodies: Vec<ForceBody> = (0..2).map(|k| body(f64::from(k), 0.0, 0.0)).collect();
    for a in [0.0, 0.6, -0.5] {
        let mut contacts = Vec::new();
        while contacts.len() < 60_000 {
            let cosine = random.uniform(-1.0, 1.0);
            let chance = 1.0 + a * (3.0 * cosine * cosine - 1.0) / 2.0;
            if random.uniform(0.0, 2.0) > chance {
                continue;
            }
            let angle = random.uniform(0.0, std::f64::consts::TAU);
            let sine = (1.0 - cosine * cosine).sqrt();
            contacts.push(ForceContact {
                normal: Vector3::new(cosine, sine * angle.cos(), sine * angle.sin()),
                second: Partner::Body(1),
                ..between(&bodies, 0, 1, 1.0)
            });
        }
        let fabric = contact_fabric(&ForceNetwork::new(&bodies, &contacts, 0.0).unwrap());
        let noise = fabric.normals.anisotropy_noise;
        assert!((noise - 7.5 / 60_000_f64.sqrt()).abs() < 1e-12);
        // A uniaxial deviator of size a has invariant 3/2 |a|... of A = a diag(1, -1/2, -1/2).
        let expected = 1.5 * f64::abs(a);
        let error = (fabric.normals.anisotropy - expected).abs();
        assert!(
            error < 3.0 * noise,
            "{a}: {} {error}",
            fabric.normals.anisotropy
        );
        assert!((fabric.normals.principal.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(fabric.forces, fabric.normals);
    }
}

/// Three bodies that hang from a wall by attraction, 3, 2 and 1 N, beside two that press on each other with 4 N: those that
/// hang are held and are links, and the mean of what presses, to which thresholds refer, is 4 N.
#[test]
fn pairs_that_pull_are_in_the_network() {
    let bodies = [
        body(0.0, 0.0, 3.0),
        body(0.0, 0.0, 2.0),
        body(0.0, 0.0, 1.0),
        body(5.0, 0.0, 0.0),
        body(6.0, 0.0, 0.0),
    ];
    let hook = on_wall(
        0,
        0,
        Point3::new(0.0, 0.0, 3.5),
        Vector3::z(),
        Vector3::z() * -3.0,
    );
    let contacts = [
        hook,
        between(&bodies, 0, 1, -2.0),
        between(&bodies, 1, 2, -1.0),
        between(&bodies, 3, 4, 4.0),
    ];
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    assert_eq!(network.pairs().len(), 4);
    let found = rattlers(&network, SupportRule::Partners { least: 1 }).unwrap();
    assert_eq!((found.held, found.mean_coordination), (5, 7.0 / 5.0));
    let largest = force_maxima(&network, BlockBootstrap::default()).unwrap();
    assert_eq!(largest.bodies, [3.0, 2.0, 1.0, 4.0, 4.0]);
    assert_eq!(network.mean_force(), Some(4.0));
    let options = ThresholdOptions {
        thresholds: vec![0.0, 1.5],
    };
    let curve = threshold_curve(&network, &options).unwrap();
    assert_eq!([0, 1].map(|k| curve.points[k].links), [1, 0]);
    let forces = ForceDistributionOptions::default();
    let forces = force_distribution(&network, &forces).unwrap().unwrap();
    assert_eq!((forces.mean_force.mean, forces.largest), (4.0, 1.0));
    let above = ForceNetwork::new(&bodies, &contacts, 1.5).unwrap();
    assert_eq!(above.pairs().len(), 3);
}
