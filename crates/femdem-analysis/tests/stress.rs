//! Love-Weber stress and vertical balance against statics by hand, and identities between the two.

use crate::common::Random;
use crate::common::forces::{between, body, on_wall, random_network};
use femdem_analysis::{
    AnalysisError, BlockBootstrap, ForceBody, ForceContact, ForceNetwork, Partner, Region,
    body_stresses, region_stress, stress_profile, vertical_balance, wall_forces,
};
use femdem_mesh::{Matrix3, Point3, Vector3};

fn matrix(tensor: &[[f64; 3]; 3]) -> Matrix3 {
    Matrix3::from_fn(|i, j| tensor[i][j])
}

fn near(found: f64, expected: f64, scale: f64) {
    assert!(
        (found - expected).abs() < 1e-12 * scale,
        "{found} instead of {expected}"
    );
}

/// An arch of two leaning blocks with hinges at the feet (±L, 0) and at the crown (0, H), centres at
/// (±a, h), weights W. By hand: the feet carry W each and the thrust T = W (L − a)/H, the crown T alone.
/// In the right block σ V is then T L along x, W h along z, and −T H across.
#[test]
fn arch_of_two_blocks() {
    let (half_span, height, a, h, weight, volume) = (2.0, 1.5, 0.9, 0.8, 30.0, 0.7);
    let thrust = weight * (half_span - a) / height;
    let block = |side: f64| ForceBody {
        centre: Point3::new(side * a, 0.0, h),
        volume,
        diameter: 1.0,
        weight,
    };
    let foot = |i: u32, side: f64| {
        let point = Point3::new(side * half_span, 0.0, 0.0);
        let force = Vector3::new(side * thrust, 0.0, -weight);
        on_wall(i, 0, point, -Vector3::z(), force)
    };
    let crown = ForceContact {
        second: Partner::Body(1),
        point: Point3::new(0.0, 0.0, height),
        ..on_wall(
            0,
            0,
            Point3::origin(),
            -Vector3::x(),
            Vector3::new(-thrust, 0.0, 0.0),
        )
    };
    let bodies = [block(1.0), block(-1.0)];
    let contacts = [foot(0, 1.0), foot(1, -1.0), crown];
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let found = body_stresses(&network);
    for (side, block) in [1.0, -1.0].into_iter().zip(&found.bodies) {
        let [xx, zz] = [thrust * half_span, weight * h].map(|m| m / volume);
        let xz = -side * thrust * height / volume;
        let expected = Matrix3::new(xx, 0.0, xz, 0.0, 0.0, 0.0, xz, 0.0, zz);
        assert!((matrix(&block.stress.tensor) - expected).norm() < 1e-12 * expected.norm());
        // Mohr's circle.
        let (middle, radius) = (0.5 * (xx + zz), (0.5 * (xx - zz)).hypot(xz));
        near(block.stress.principal[0], middle + radius, middle);
        near(
            block.stress.principal[2],
            (middle - radius).min(0.0),
            middle,
        );
        near(block.stress.pressure, (xx + zz) / 3.0, middle);
        let [x, _, z] = block.stress.directions[0];
        near(z / x, (middle + radius - xx) / xz, 10.0);
        near(Vector3::from(block.net_force).z, weight, weight);
        near(Vector3::from(block.net_force).x, 0.0, weight);
        assert!(Vector3::from(block.net_moment).norm() < 1e-12 * weight);
        assert!(block.stress.asymmetry() < 1e-14);
    }
    let floor = wall_forces(&network).walls[0];
    near(floor.force[2], -2.0 * weight, weight);
    near(floor.mobilised_friction, thrust / weight, 1.0);
    let balance = vertical_balance(&network, &[0.1, 0.79, 0.81, 1.2]).unwrap();
    assert_eq!(balance.cuts[0].weight_above, 2.0 * weight);
    assert_eq!(balance.cuts[2].weight_above, 0.0);
    assert!(balance.worst < 1e-14);
}

/// A stack of five cubes: at mid height of cube k, and on the mean through it, the weight of all above and
/// of half the cube, over the area of its face. Sideways nothing.
#[test]
fn stack_of_cubes() {
    let (side, weight) = (0.2_f64, 3.0);
    let bodies: Vec<ForceBody> = (0..5)
        .map(|k| ForceBody {
            centre: Point3::new(7.0, -3.0, side * (f64::from(k) + 0.5)),
            volume: side.powi(3),
            diameter: side * 3_f64.sqrt(),
            weight,
        })
        .collect();
    let mut contacts: Vec<ForceContact> = (0..4)
        .map(|k| between(&bodies, k, k + 1, weight * f64::from(4 - k)))
        .collect();
    let foot = Point3::new(7.0, -3.0, 0.0);
    contacts.push(on_wall(
        0,
        0,
        foot,
        -Vector3::z(),
        -Vector3::z() * 5.0 * weight,
    ));
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let area = side * side;
    for (k, found) in (0..5).zip(&body_stresses(&network).bodies) {
        let expected = weight * (f64::from(4 - k) + 0.5) / area;
        near(found.stress.principal[0], expected, expected);
        near(found.stress.deviator, expected, expected);
        near(found.stress.tensor[0][0], 0.0, expected);
    }
    let container = Region::Box {
        min: Point3::new(6.9, -3.1, 0.0),
        max: Point3::new(7.1, -2.9, 5.0 * side),
    };
    // Slabs from centre to centre carry what lies above them.
    let profile = stress_profile(&network, &container, 10).unwrap();
    for (k, slab) in profile.slabs.iter().enumerate() {
        let above = 5 - k.div_ceil(2);
        near(
            slab.stress.tensor[2][2],
            weight * above as f64 / area,
            weight / area,
        );
    }
    let heights: Vec<f64> = (0..20).map(|k| 0.05 * f64::from(k)).collect();
    assert!(vertical_balance(&network, &heights).unwrap().worst < 1e-14);
}

/// A body held by a wrench that balances all others: the tensor is symmetric with the moment, not without it.
#[test]
fn moments_of_patches_make_the_tensor_symmetric() {
    let mut random = Random(8);
    let mut vector = |size: f64| {
        Vector3::new(
            random.uniform(-size, size),
            random.uniform(-size, size),
            random.uniform(-size, size),
        )
    };
    for _ in 0..20 {
        let centre = Point3::from(vector(3.0));
        let bodies = [ForceBody {
            centre,
            ..body(0.0, 0.0, 0.0)
        }];
        let mut contacts: Vec<ForceContact> = (0..4)
            .map(|k| {
                on_wall(
                    0,
                    k,
                    centre + vector(0.5),
                    vector(1.0).normalize(),
                    vector(10.0),
                )
            })
            .collect();
        let sum: Vector3 = contacts.iter().map(ForceContact::force).sum();
        let torque = |c: &ForceContact| (c.point - centre).cross(&c.force()) + c.moment;
        let mut last = on_wall(0, 9, centre + vector(0.5), Vector3::z(), -sum);
        let total: Vector3 = contacts.iter().chain([&last]).map(torque).sum();
        contacts.push(last);
        let asymmetry = |contacts: &[ForceContact]| {
            let network = ForceNetwork::new(&bodies, contacts, 0.0).unwrap();
            body_stresses(&network).bodies[0].stress.asymmetry()
        };
        assert!(asymmetry(&contacts) > 1e-3);
        last.moment = -total;
        contacts[4] = last;
        assert!(asymmetry(&contacts) < 1e-14);
    }
}

/// For any forces: σ_zz of a slab times its volume is the force carried through cuts, integrated over its
/// height. The carried force changes only at centres and contact points.
#[test]
fn stress_of_a_slab_is_the_carried_force() {
    let mut random = Random(3);
    let (bodies, contacts) = random_network(&mut random, 30);
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    for (low, high) in [(-0.5, 0.4), (-3.0, 3.0), (0.1, 0.11)] {
        let region = Region::Box {
            min: Point3::new(-5.0, -5.0, low),
            max: Point3::new(5.0, 5.0, high),
        };
        let points = contacts.iter().map(|c| c.point.z);
        let mut breaks: Vec<f64> = points
            .chain(bodies.iter().map(|b| b.centre.z))
            .filter(|z| low < *z && *z < high)
            .chain([low, high])
            .collect();
        breaks.sort_by(f64::total_cmp);
        let middles: Vec<f64> = breaks.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        let balance = vertical_balance(&network, &middles).unwrap();
        let steps = breaks.windows(2).map(|w| w[1] - w[0]);
        let carried: f64 = steps
            .zip(&balance.cuts)
            .map(|(dz, cut)| dz * cut.carried)
            .sum();
        let no_moments: Vec<ForceContact> = contacts
            .iter()
            .map(|c| ForceContact {
                moment: Vector3::zeros(),
                ..*c
            })
            .collect();
        // Moments are antisymmetric, hence nothing of zz.
        for contacts in [&contacts, &no_moments] {
            let network = ForceNetwork::new(&bodies, contacts, 0.0).unwrap();
            let found = region_stress(&network, &region, BlockBootstrap::default()).unwrap();
            near(found.stress.tensor[2][2] * region.volume(), carried, 30.0);
            let profile = stress_profile(&network, &region, 1).unwrap();
            let difference = matrix(&profile.slabs[0].stress.tensor) - matrix(&found.stress.tensor);
            assert!(difference.norm() * region.volume() < 1e-12 * 30.0);
        }
    }
}

/// A region around everything holds the volume-weighted mean of the bodies' stresses, whatever its kind,
/// and the parts of a partition add up.
#[test]
fn regions_add_up() {
    let mut random = Random(5);
    let (bodies, contacts) = random_network(&mut random, 40);
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let stress = |region: &Region| {
        let found = region_stress(&network, region, BlockBootstrap::default()).unwrap();
        matrix(&found.stress.tensor) * region.volume()
    };
    let of_bodies: Matrix3 = body_stresses(&network)
        .bodies
        .iter()
        .map(|b| matrix(&b.stress.tensor))
        .sum();
    let boxed = |min: [f64; 3], max: [f64; 3]| Region::Box {
        min: min.into(),
        max: max.into(),
    };
    let around = [
        boxed([-4.0; 3], [4.0; 3]),
        Region::Sphere {
            centre: Point3::origin(),
            radius: 9.0,
        },
        Region::Cylinder {
            centre: [0.0; 2],
            radius: 9.0,
            z_min: -4.0,
            z_max: 4.0,
        },
    ];
    for region in &around {
        assert!((stress(region) - of_bodies).norm() < 1e-12 * of_bodies.norm());
    }
    let parts = [
        boxed([-4.0; 3], [0.3, 4.0, 4.0]),
        boxed([0.3, -4.0, -4.0], [4.0, -0.2, 4.0]),
        boxed([0.3, -0.2, -4.0], [4.0; 3]),
    ];
    let sum: Matrix3 = parts.iter().map(stress).sum();
    assert!((sum - of_bodies).norm() < 1e-12 * of_bodies.norm());
    let profile = stress_profile(&network, &around[0], 37).unwrap();
    let slab = around[0].volume() / 37.0;
    let sum: Matrix3 = profile
        .slabs
        .iter()
        .map(|s| matrix(&s.stress.tensor) * slab)
        .sum();
    assert!((sum - of_bodies).norm() < 1e-12 * of_bodies.norm());
}

/// Equal layers of equal columns: the error of the pressure by blocks is that of the layers, exactly known.
#[test]
fn error_of_a_pressure() {
    let bodies: Vec<ForceBody> = (0..2).map(|k| body(0.0, 0.0, f64::from(k))).collect();
    let contacts = [between(&bodies, 0, 1, 6.0)];
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    // A quarter with 6 N over 1 m² in a part of its height, the others with none.
    let region = Region::Box {
        min: Point3::new(-0.5, -0.5, -1.5),
        max: Point3::new(0.5, 0.5, 6.5),
    };
    let options = BlockBootstrap {
        block_over_d: 2.0,
        resamples: 100_000,
        seed: 4,
    };
    let network_in_blocks = region_stress(&network, &region, options).unwrap();
    near(network_in_blocks.stress.pressure, 0.25, 1.0);
    assert_eq!(network_in_blocks.contacts, 1);
    // The point at z = 0.5 m is on the border and belongs to the upper block: one pressure of 1 Pa and three of 0, of
    // standard deviation 1/2, so that of the mean is 1/4.
    let error = network_in_blocks.pressure_error.unwrap();
    assert!((error * 4.0 - 1.0).abs() < 0.01, "{error}");
    // Two blocks give no error.
    let lower = region.slab(-1.5, 2.5).unwrap();
    let of_two = region_stress(&network, &lower, options).unwrap();
    assert_eq!(of_two.pressure_error, None);
}

#[test]
fn bad_input_is_refused_by_name() {
    let bodies = [body(0.0, 0.0, 0.0), body(0.0, 0.0, 1.0)];
    let good = between(&bodies, 0, 1, 1.0);
    let refused = |contact: ForceContact| match ForceNetwork::new(&bodies, &[good, contact], 0.0) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("accepted {contact:?}"),
    };
    let nan = Vector3::new(0.0, f64::NAN, 0.0);
    assert!(refused(ForceContact { first: 2, ..good }).contains("contact 1 names body 2"));
    assert!(
        refused(ForceContact {
            second: Partner::Body(0),
            ..good
        })
        .contains("with itself")
    );
    assert!(
        refused(ForceContact {
            normal: nan,
            ..good
        })
        .contains("its normal")
    );
    assert!(
        refused(ForceContact {
            normal: Vector3::z() * 2.0,
            ..good
        })
        .contains("its normal's length = 2")
    );
    assert!(
        refused(ForceContact {
            tangential: nan,
            ..good
        })
        .contains("its tangential = NaN")
    );
    assert!(
        refused(ForceContact {
            moment: nan,
            ..good
        })
        .contains("its moment")
    );
    assert!(
        refused(ForceContact {
            point: nan.into(),
            ..good
        })
        .contains("its point")
    );
    let refused = |body: ForceBody| {
        ForceNetwork::new(&[body], &[], 0.0)
            .unwrap_err()
            .to_string()
    };
    assert!(
        refused(ForceBody {
            volume: 0.0,
            ..bodies[0]
        })
        .contains("its volume")
    );
    assert!(
        refused(ForceBody {
            weight: -1.0,
            ..bodies[0]
        })
        .contains("its weight")
    );
    assert!(
        refused(ForceBody {
            diameter: f64::INFINITY,
            ..bodies[0]
        })
        .contains("its diameter")
    );
    assert_eq!(
        ForceNetwork::new(&[], &[], 0.0).unwrap_err(),
        AnalysisError::EmptyPack
    );
    let weightless = [ForceBody {
        weight: 0.0,
        ..bodies[0]
    }];
    let network = ForceNetwork::new(&weightless, &[], 0.0).unwrap();
    assert_eq!(
        vertical_balance(&network, &[0.0]).unwrap_err(),
        AnalysisError::NoWeight { body: 0 }
    );
}
