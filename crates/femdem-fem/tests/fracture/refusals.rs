//! What is refused by name.

use super::*;
use femdem_fem::FemError;
use femdem_fem::fracture::Weibull;

#[test]
fn strengths_that_mean_nothing() {
    let say = |tensile, cohesion, angle| {
        let error = Strength::new(tensile, cohesion, angle).unwrap_err();
        error.to_string()
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(say(bad, 1e6, 0.5).contains("tensile strength"));
        assert!(say(1e6, bad, 0.5).contains("cohesion"));
    }
    for bad in [-0.1, 1.6, f64::NAN] {
        assert!(say(1e6, 1e6, bad).contains("friction angle"));
    }
    // Above the tension that no plane can bear.
    assert!(say(2.1e6, 1e6, 0.5_f64.atan()).contains("cohesion / tan"));
    for (modulus, volume, name) in [
        (0.5, 1.0, "modulus"),
        (f64::NAN, 1.0, "modulus"),
        (5.0, 0.0, "volume"),
        (5.0, f64::INFINITY, "volume"),
    ] {
        let error = Weibull::new(modulus, volume, 0).unwrap_err().to_string();
        assert!(error.contains(name), "{error}");
    }
}

/// Each is named, and nothing is cut.
#[test]
fn states_that_mean_nothing() {
    let mesh = TetMesh::block([2, 1, 1], &Vector3::new(2.0, 1.0, 1.0)).unwrap();
    let refused = |spoil: &dyn Fn(&mut Body)| {
        let mut body = Body::new(&mesh, uniaxial(&Vector3::x(), 2.0 * TENSILE));
        spoil(&mut body);
        let mut cracked = body.cracked.clone();
        let error = body.state().decide(&mut cracked).unwrap_err();
        assert_eq!(cracked, body.cracked);
        assert!(body.state().ratios(&cracked).is_err());
        error
    };
    let short = |name: &str, spoil: &dyn Fn(&mut Body)| {
        let error = refused(spoil);
        assert!(matches!(error, FemError::WrongLength { .. }));
        assert!(error.to_string().contains(name), "{error}");
    };
    short("regions", &|b| b.regions.truncate(2));
    short("stresses", &|b| b.stresses.truncate(2));
    short("positions", &|b| b.positions.push(Vector3::zeros()));
    short("factors", &|b| b.factors.clear());
    assert!(
        refused(&|b| b.regions[3] = 1)
            .to_string()
            .contains("region 1")
    );
    assert!(
        refused(&|b| b.strengths.clear())
            .to_string()
            .contains("region 0")
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for entry in [0, 3, 8] {
            let error = refused(&|b| b.stresses[5].cauchy[entry] = bad);
            assert!(matches!(error, FemError::StressNotFinite { element: 5 }));
        }
        assert!(
            refused(&|b| b.positions[4].y = bad)
                .to_string()
                .contains("volume")
        );
    }
    for bad in [f64::NAN, 0.0, -1.0] {
        assert!(
            refused(&|b| b.factors[2] = bad)
                .to_string()
                .contains("factor")
        );
    }
    let inverted = refused(&|b| b.positions.iter_mut().for_each(|x| x.z = -x.z));
    assert!(inverted.to_string().contains("inside out"));
}
