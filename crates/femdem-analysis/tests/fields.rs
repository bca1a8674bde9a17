//! Coarse-grained fields: what their integrals must be, and the balance of momentum.

use crate::common::Random;
use crate::common::forces::{body, on_wall, random_network};
use femdem_analysis::*;
use femdem_mesh::{Point3, Vector3};

fn options(width_over_d: f64, spacing_over_d: f64) -> FieldOptions {
    FieldOptions {
        width_over_d,
        spacing_over_d,
    }
}

/// Nine bodies of 1 N above one another, each a little beside the one below, at rest under a constant shear force;
/// they touch at points beside the lines between their centres, and the lowest lies on a floor at z = 0.
fn leaning_column() -> (Vec<ForceBody>, Vec<ForceContact>) {
    let mut random = Random(5);
    let mut beside = || random.uniform(-0.3, 0.3);
    let bodies: Vec<ForceBody> = (0..9)
        .map(|k| body(beside(), beside(), f64::from(k) + 0.5 + 0.3 * beside()))
        .collect();
    let mut contacts = Vec::new();
    for k in 0..9_u32 {
        let point = Point3::new(beside(), beside(), f64::from(k));
        // What lies above presses down; the lowest body pushes the floor.
        let above = f64::from(9 - k);
        let down = Vector3::new(0.25, 0.0, -above);
        let contact = on_wall(k, 0, point, -Vector3::z(), down);
        let second = match k {
            0 => Partner::Wall(0),
            _ => Partner::Body(k - 1),
        };
        contacts.push(ForceContact { second, ..contact });
    }
    (bodies, contacts)
}

/// Sum over the cells of layer `k` (m²), or of all layers above it and half of its own, times a cell's face or volume.
fn plane(fields: &Fields, values: &[f64], k: usize) -> f64 {
    let cells = fields.counts[0] * fields.counts[1];
    values[k * cells..(k + 1) * cells].iter().sum::<f64>() * fields.spacing.powi(2)
}

fn component(tensors: &[Tensor], k: usize) -> Vec<f64> {
    tensors.iter().map(|t| t[k]).collect()
}

/// Planes that no centre is near carry exactly the weight of the bodies above; the shear force goes through all.
#[test]
fn the_stress_over_a_plane_of_a_column_at_rest_is_the_weight_above_it() {
    let (bodies, contacts) = leaning_column();
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let fields = coarse_grained_fields(&network, &[], &[], &options(0.35, 0.05)).unwrap();
    let [vertical, shear, across] = [8, 2, 5].map(|k| component(&fields.contact_stress, k));
    let mut planes = 0;
    for k in 0..fields.counts[2] {
        let z = fields.origin.z + (k as f64 + 0.5) * fields.spacing;
        let clear = bodies.iter().all(|b| (b.centre.z - z).abs() > 0.35);
        if !clear || z < 0.36 {
            continue;
        }
        planes += 1;
        let above = bodies.iter().filter(|b| b.centre.z > z).count() as f64;
        let found = plane(&fields, &vertical, k);
        assert!(
            (found - above).abs() < 2e-3 * above.max(0.5),
            "{z}: {found} for {above}"
        );
        // The force on what lies below is along +x: it is handed down to the floor.
        let handed = if above > 0.0 { 0.25 } else { 0.0 };
        let found = plane(&fields, &shear, k);
        assert!((found.abs() - handed).abs() < 1e-3, "{z}: {found}");
        assert!(plane(&fields, &across, k).abs() < 1e-12);
    }
    assert!(planes > 20, "{planes}");
}

/// With a wide function every plane cuts several bodies: what it carries is the smeared weight above, from the field of
/// density, less what the floor carries above it.
#[test]
fn smeared_weights_are_carried_at_every_height() {
    let (bodies, contacts) = leaning_column();
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let masses = [1.0 / 9.81; 9];
    let fields = coarse_grained_fields(&network, &masses, &[], &options(1.5, 0.1)).unwrap();
    let (stress, density) = (
        component(&fields.contact_stress, 8),
        fields.density.clone().unwrap(),
    );
    let slices: Vec<f64> = (0..fields.counts[2])
        .map(|k| plane(&fields, &density, k))
        .collect();
    for k in 0..fields.counts[2] {
        let z = fields.origin.z + (k as f64 + 0.5) * fields.spacing;
        if z < 1.5 {
            continue;
        }
        let above: f64 = slices[k + 1..].iter().sum::<f64>() + 0.5 * slices[k];
        let weight = 9.81 * above * fields.spacing;
        let found = plane(&fields, &stress, k);
        assert!((found - weight).abs() < 2e-3, "{z}: {found} for {weight}");
    }
}

/// Integrals over space: volumes, Love-Weber's stress of the whole times the volume, the numbers of contacts.
#[test]
fn integrals_are_those_of_bodies_and_contacts() {
    let (bodies, contacts) = random_network(&mut Random(11), 12);
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let masses: Vec<f64> = (0..12).map(|k| 1.0 + f64::from(k)).collect();
    let mut random = Random(3);
    let velocities: Vec<Vector3> = (0..12)
        .map(|_| Vector3::new(random.uniform(-1.0, 1.0), 2.0, random.uniform(0.0, 1.0)))
        .collect();
    let fields =
        coarse_grained_fields(&network, &masses, &velocities, &options(1.0, 0.125)).unwrap();
    let cell = fields.spacing.powi(3);
    let close = |found: f64, expected: f64, what: &str| {
        assert!(
            (found - expected).abs() < 2e-3 * expected.abs().max(1.0),
            "{what}: {found} for {expected}"
        );
    };
    let integral = |values: &[f64]| values.iter().sum::<f64>() * cell;
    close(integral(&fields.solid_fraction), 12.0, "volume");
    close(integral(fields.density.as_ref().unwrap()), 78.0, "mass");
    let momentum: Vec<f64> = fields
        .momentum
        .as_ref()
        .unwrap()
        .iter()
        .map(|p| p[1])
        .collect();
    close(integral(&momentum), 156.0, "momentum");
    // All move alike along y: there is no motion about the mean.
    for (velocity, rho) in fields
        .velocity
        .as_ref()
        .unwrap()
        .iter()
        .zip(fields.density.as_ref().unwrap())
    {
        assert!(*rho == 0.0 || (velocity[1] - 2.0).abs() < 1e-9);
    }
    let kinetic = fields.kinetic_stress.as_ref().unwrap();
    assert!(
        kinetic
            .iter()
            .all(|t| t[4].abs() < 1e-9 && t[0] > -1e-9 && t[8] > -1e-9)
    );

    let all = Region::Box {
        min: Point3::from([-9.0; 3]),
        max: Point3::from([9.0; 3]),
    };
    let whole = region_stress(&network, &all, BlockBootstrap::default()).unwrap();
    let without_moments: Vec<ForceContact> = contacts
        .iter()
        .map(|c| ForceContact {
            moment: Vector3::zeros(),
            ..*c
        })
        .collect();
    let plain = ForceNetwork::new(&bodies, &without_moments, 0.0).unwrap();
    let plain = region_stress(&plain, &all, BlockBootstrap::default()).unwrap();
    for k in 0..9 {
        let expected = plain.stress.tensor[k / 3][k % 3] * all.volume();
        close(
            integral(&component(&fields.contact_stress, k)),
            expected,
            "stress",
        );
    }
    // Moments change the antisymmetric part of Love-Weber's stress alone.
    close(plain.stress.pressure, whole.stress.pressure, "pressure");
    let trace: Vec<f64> = fields.fabric.iter().map(|t| t[0] + t[4] + t[8]).collect();
    // All of these contacts push: each counts for both of its bodies, or for the one at a wall.
    let sides = contacts.iter().map(|contact| match contact.second {
        Partner::Body(_) => 2.0,
        Partner::Wall(_) => 1.0,
    });
    close(integral(&trace), sides.sum(), "sides of contacts");
}

/// Two bodies in one place, of opposite velocities: all of their motion is about the mean.
#[test]
fn kinetic_stress_is_that_of_the_motion_about_the_mean() {
    let bodies = [body(0.0, 0.0, 0.0); 2];
    let network = ForceNetwork::new(&bodies, &[], 0.0).unwrap();
    let velocities = [Vector3::new(3.0, 1.0, 0.0), Vector3::new(-3.0, 1.0, 0.0)];
    let fields =
        coarse_grained_fields(&network, &[2.0; 2], &velocities, &options(1.0, 0.1)).unwrap();
    let kinetic = fields.kinetic_stress.unwrap();
    let xx: f64 = component(&kinetic, 0).iter().sum();
    assert!((xx * fields.spacing.powi(3) / 36.0 - 1.0).abs() < 1e-3);
    assert!(
        kinetic
            .iter()
            .all(|t| t[4].abs() < 1e-12 && t[1].abs() < 1e-12)
    );
}

#[test]
fn what_has_no_meaning_is_refused_and_what_is_unknown_left_out() {
    let bodies = [body(0.0, 0.0, 0.0), body(1.0, 0.0, 0.0)];
    let network = ForceNetwork::new(&bodies, &[], 0.0).unwrap();
    let says = |masses: &[f64], velocities: &[Vector3], options| {
        coarse_grained_fields(&network, masses, velocities, &options)
            .unwrap_err()
            .to_string()
    };
    let usual = FieldOptions::default();
    assert!(says(&[], &[], options(0.0, 0.5)).contains("width_over_d = 0"));
    assert!(says(&[], &[], options(1.0, 1.1)).contains("spacing_over_d = 1.1"));
    assert!(says(&[], &[], options(1.0, f64::NAN)).contains("spacing_over_d = NaN"));
    assert!(says(&[], &[], options(1.0, 1e-3)).contains("10000000 cells"));
    assert!(says(&[1.0], &[], usual).contains("1 masses for 2 bodies"));
    assert!(says(&[1.0, -1.0], &[], usual).contains("mass = -1"));
    let wild = [Vector3::zeros(), Vector3::new(0.0, f64::INFINITY, 0.0)];
    assert!(says(&[1.0; 2], &wild, usual).contains("velocity = inf"));
    // So far from the origin that the width is lost to round-off.
    let far = [body(0.0, 0.0, 1e20)];
    let far = ForceNetwork::new(&far, &[], 0.0).unwrap();
    let refused = coarse_grained_fields(&far, &[], &[], &usual).unwrap_err();
    assert!(refused.to_string().contains("spacing_over_d = 0.5"));
    let fields = coarse_grained_fields(&network, &[1.0; 2], &[], &usual).unwrap();
    assert!(
        fields.density.is_some() && fields.momentum.is_none() && fields.kinetic_stress.is_none()
    );
}

#[cfg(feature = "parallel")]
#[test]
fn same_bits_of_fields_with_any_number_of_threads() {
    let (bodies, contacts) = random_network(&mut Random(2), 40);
    let network = ForceNetwork::new(&bodies, &contacts, 0.0).unwrap();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            coarse_grained_fields(
                &network,
                &[1.5; 40],
                &[Vector3::x(); 40],
                &FieldOptions::default(),
            )
            .unwrap()
        })
    };
    let one = with(1);
    for threads in [2, 3] {
        assert!(with(threads) == one, "{threads} threads");
    }
}
