//! Laws in files, custom laws, and parameters that are refused.

use super::states::rand_free::Random;
use super::states::{self, respond};
use femdem_fem::FemError;
use femdem_fem::material::{
    AnyMaterial, Deformation, DruckerPrager, DruckerPragerCap, Hencky, J2, Material, MooneyRivlin,
    NeoHookean, Response, Tangent, Viscous, Voce, difference_tangent,
};
use femdem_mesh::Matrix3;
use std::sync::Arc;

fn encode(law: &AnyMaterial) -> Result<Vec<u8>, bincode::error::EncodeError> {
    bincode::serde::encode_to_vec(law, bincode::config::standard())
}

fn decode(bytes: &[u8]) -> Result<AnyMaterial, bincode::error::DecodeError> {
    Ok(bincode::serde::decode_from_slice(bytes, bincode::config::standard())?.0)
}

#[test]
fn laws_come_back_from_files_with_the_same_bits() {
    let mut random = Random(12);
    for case in states::all() {
        let text = serde_json::to_string(&case.law).unwrap();
        let read: AnyMaterial = serde_json::from_str(&text).unwrap();
        assert_eq!(read, case.law);
        let bytes = encode(&case.law).unwrap();
        assert_eq!(decode(&bytes).unwrap(), case.law);
        let (old, d) = states::state(&mut random, &case);
        assert_eq!(respond(&read, &d, &old), respond(&case.law, &d, &old));
    }
    let law: AnyMaterial =
        serde_json::from_str(r#"{"j2": {"young": 2e11, "poisson": 0.3, "yield_stress": 4e8}}"#)
            .unwrap();
    assert_eq!(law, J2::new(2e11, 0.3, 4e8, 0.0).unwrap().into());
}

#[test]
fn bad_values_in_files_are_refused() {
    for (text, word) in [
        (
            r#"{"neo_hookean": {"young": 1e9, "poisson": 0.5}}"#,
            "poisson",
        ),
        (r#"{"hencky": {"young": -1.0, "poisson": 0.2}}"#, "young"),
        (
            r#"{"mooney_rivlin": {"c10": 0.0, "c01": 0.0, "bulk": 1e9}}"#,
            "c10 + c01",
        ),
        (
            r#"{"neo_hookean": {"young": 1e9, "poison": 0.2}}"#,
            "poison",
        ),
        (r#"{"steel": {"young": 1e9}}"#, "steel"),
    ] {
        let error = serde_json::from_str::<AnyMaterial>(text)
            .unwrap_err()
            .to_string();
        assert!(error.contains(word), "{error}");
    }
}

#[derive(Debug)]
struct Spring(f64);

impl Material for Spring {
    fn name(&self) -> &str {
        "spring"
    }

    fn history_len(&self) -> usize {
        1
    }

    fn respond(&self, d: &Deformation, old: &[f64], new: &mut [f64]) -> Option<Response> {
        *new.first_mut()? = old.first()? + 1.0;
        let stretch = d.gradient - Matrix3::identity();
        Response::elastic(0.5 * self.0 * stretch.norm_squared(), stretch * self.0)
    }

    fn tangent(&self, d: &Deformation, old: &[f64]) -> Option<Tangent> {
        difference_tangent(self, d, old)
    }

    fn wave_modulus(&self) -> f64 {
        self.0
    }

    fn stiffness_bound(&self, _d: &Deformation, _old: &[f64]) -> f64 {
        self.0
    }
}

#[test]
fn custom_laws_are_bound_by_name() {
    let spring: Arc<dyn Material> = Arc::new(Spring(3.0));
    let d = Deformation::at_rest(Matrix3::identity() * 1.5);
    for law in [
        AnyMaterial::custom(Arc::clone(&spring)),
        Viscous::new(AnyMaterial::custom(Arc::clone(&spring)), 1.0, 0.0)
            .unwrap()
            .into(),
    ] {
        let text = serde_json::to_string(&law).unwrap();
        let mut read: AnyMaterial = serde_json::from_str(&text).unwrap();
        assert_eq!(read.unbound(), Some("spring"));
        assert_eq!(read.respond(&d, &[0.0], &mut [0.0]), None);
        assert_eq!(read.tangent(&d, &[0.0]), None);
        let other: Arc<dyn Material> = Arc::new(NeoHookean::new(1.0, 0.0).unwrap());
        let error = read.bind(&[Arc::clone(&other)]).unwrap_err();
        assert!(matches!(&error, FemError::UnboundMaterial { name, given }
            if name == "spring" && given == "neo-Hookean"));
        read.bind(&[other, Arc::clone(&spring)]).unwrap();
        assert_eq!(read.unbound(), None);
        assert_eq!(respond(&read, &d, &[0.0]), respond(&law, &d, &[0.0]));
        let error = read.tangent(&d, &[0.0]).unwrap() - Tangent::identity() * 3.0;
        assert!(error.norm() < 1e-8);
    }
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let good = J2::new(1e9, 0.3, 1e6, 0.0).unwrap();
    let voce = |stress, rate| good.with_saturation(Voce { stress, rate }).err();
    let soil = |c, phi, psi| DruckerPrager::new(1e9, 0.3, c, phi, psi).err();
    let powder = |c, beta, r, curve: &[[f64; 2]]| {
        DruckerPragerCap::new(1e9, 0.3, c, beta, r, curve.to_vec()).err()
    };
    let curve = [[0.0, 1e6], [0.5, 1e7]];
    let mixed = |share| MooneyRivlin::new(1e9, 0.3, share).err();
    let damped = |shear, bulk| Viscous::new(good, shear, bulk).err();
    for (error, name) in [
        (NeoHookean::new(0.0, 0.3).err(), "young"),
        (NeoHookean::new(f64::NAN, 0.3).err(), "young"),
        (Hencky::new(1e9, 0.5).err(), "poisson"),
        (Hencky::new(1e9, -1.0).err(), "poisson"),
        (mixed(1.1), "share"),
        (mixed(-0.1), "share"),
        (MooneyRivlin::from_constants(1.0, 1.0, 0.0).err(), "bulk"),
        (MooneyRivlin::from_constants(-1.0, 2.0, 1.0).err(), "c10"),
        (J2::new(1e9, 0.3, 0.0, 0.0).err(), "yield_stress"),
        (J2::new(1e9, 0.3, 1e6, -1.0).err(), "hardening"),
        (voce(0.9e6, 1.0), "saturation stress"),
        (voce(2e6, 0.0), "saturation rate"),
        (soil(-1.0, 0.5, 0.0), "cohesion"),
        (soil(0.0, 0.0, 0.0), "cohesion"),
        (soil(1.0, 1.6, 0.0), "friction_angle"),
        (soil(1.0, 0.5, 0.51), "dilatancy_angle"),
        (powder(-1.0, 1.0, 0.5, &curve), "cohesion"),
        (powder(0.0, 0.0, 0.5, &curve), "friction_angle"),
        (powder(0.0, 1.6, 0.5, &curve), "friction_angle"),
        (powder(0.0, 1.0, 0.0, &curve), "eccentricity"),
        (powder(0.0, 1.0, 0.5, &curve[..1]), "yield pressures"),
        (powder(0.0, 1.0, 0.5, &[]), "yield pressures"),
        (powder(0.0, 1.0, 0.5, &curve[..1].repeat(2)), "compaction"),
        (
            powder(0.0, 1.0, 0.5, &[[0.1, 1.0], [0.2, 2.0]]),
            "compaction",
        ),
        (
            powder(0.0, 1.0, 0.5, &[[0.0, 0.0], [0.2, 2.0]]),
            "yield pressure",
        ),
        (
            powder(0.0, 1.0, 0.5, &[[0.0, 3.0], [0.2, 2.0]]),
            "yield pressure",
        ),
        (
            powder(0.0, 1.0, 0.5, &[[0.0, 3.0], [0.2, f64::NAN]]),
            "yield pressure",
        ),
        (damped(-1.0, 0.0), "shear viscosity"),
        (damped(0.0, f64::INFINITY), "bulk viscosity"),
    ] {
        let message = error.map(|e| e.to_string()).unwrap_or_default();
        assert!(message.starts_with(name), "{name}: {message}");
    }
}
