//! Laws and random states for the tests.

use femdem_fem::material::{
    AnyMaterial, Deformation, DruckerPrager, DruckerPragerCap, Hencky, J2, Material, MooneyRivlin,
    NeoHookean, Response, Viscous, Voce,
};
use femdem_mesh::nalgebra::{Rotation3, Unit};
use femdem_mesh::{Matrix3, Vector3};
use rand_free::Random;

pub const YOUNG: f64 = 2e9;

/// A law, and the size of logarithmic strains its tests use.
pub struct Case {
    pub law: AnyMaterial,
    pub strain: f64,
}

/// All elastic laws, with moderate, zero, negative and nearly incompressible Poisson's ratios.
pub fn elastic() -> Vec<Case> {
    let mut laws: Vec<AnyMaterial> = Vec::new();
    for poisson in [0.3, 0.0, -0.3, 0.49] {
        laws.push(NeoHookean::new(YOUNG, poisson).unwrap().into());
        laws.push(Hencky::new(YOUNG, poisson).unwrap().into());
    }
    for (poisson, share) in [(0.3, 0.0), (0.3, 1.0), (0.45, 0.2)] {
        laws.push(MooneyRivlin::new(YOUNG, poisson, share).unwrap().into());
    }
    laws.into_iter()
        .map(|law| Case { law, strain: 0.5 })
        .collect()
}

/// Plastic laws; strains go from deep in the elastic range to far beyond yield.
pub fn plastic() -> Vec<Case> {
    let metal = J2::new(YOUNG, 0.3, 0.01 * YOUNG, 0.05 * YOUNG).unwrap();
    let voce = Voce {
        stress: 0.03 * YOUNG,
        rate: 15.0,
    };
    let rubble = |dilatancy| DruckerPrager::new(YOUNG, 0.25, 0.01 * YOUNG, 0.6, dilatancy).unwrap();
    let laws: [AnyMaterial; 8] = [
        metal.into(),
        J2::new(YOUNG, 0.3, 0.01 * YOUNG, 0.0).unwrap().into(),
        metal.with_saturation(voce).unwrap().into(),
        rubble(0.6).into(),
        rubble(0.2).into(),
        rubble(0.0).into(),
        powder(5e-3, 0.6).into(),
        powder(2e-2, 1.5).into(),
    ];
    laws.into_iter()
        .map(|law| Case { law, strain: 0.1 })
        .collect()
}

/// A powder with this cohesion over Young's modulus and eccentricity, whose curve has three lines.
pub fn powder(cohesion: f64, eccentricity: f64) -> DruckerPragerCap {
    let curve = [[0.0, 5e-3], [0.05, 1e-2], [0.1, 0.1], [0.2, 0.2]].map(|[x, y]| [x, y * YOUNG]);
    let (cohesion, slope) = (cohesion * YOUNG, 1.1);
    DruckerPragerCap::new(YOUNG, 0.2, cohesion, slope, eccentricity, curve.to_vec()).unwrap()
}

/// Viscosity beside an elastic and a plastic law.
pub fn viscous() -> Vec<Case> {
    let elastic = NeoHookean::new(YOUNG, 0.3).unwrap();
    let plastic = J2::new(YOUNG, 0.3, 0.01 * YOUNG, 0.05 * YOUNG).unwrap();
    vec![
        Case {
            law: Viscous::new(elastic, 3e5, 1e5).unwrap().into(),
            strain: 0.5,
        },
        Case {
            law: Viscous::new(plastic, 3e5, 0.0).unwrap().into(),
            strain: 0.1,
        },
    ]
}

/// All laws.
pub fn all() -> Vec<Case> {
    elastic()
        .into_iter()
        .chain(plastic())
        .chain(viscous())
        .collect()
}

/// A rotation by any angle.
pub fn rotation(random: &mut Random) -> Matrix3 {
    let axis = Vector3::new(random.signed(), random.signed(), random.signed());
    *Rotation3::from_axis_angle(&Unit::new_normalize(axis), 3.0 * random.signed()).matrix()
}

/// R U with principal logarithmic strains up to `strain`.
pub fn gradient(random: &mut Random, strain: f64) -> Matrix3 {
    let (turn, frame) = (rotation(random), rotation(random));
    let stretches = Vector3::from_fn(|_, _| (strain * random.signed()).exp());
    turn * frame * Matrix3::from_diagonal(&stretches) * frame.transpose()
}

/// The history of a virgin point after a random first step, and a second deformation: a third of them
/// close to the first, so that plastic laws unload, the others far from it. Rates up to 100 per second.
pub fn state(random: &mut Random, case: &Case) -> (Vec<f64>, Deformation) {
    let virgin = vec![0.0; case.law.history_len()];
    let first = gradient(random, case.strain);
    let old = respond(&case.law, &Deformation::at_rest(first), &virgin).1;
    let size = if random.signed() < -1.0 / 3.0 {
        0.05
    } else {
        1.0
    };
    let stretch = gradient(random, size * case.strain);
    let rate = Matrix3::from_fn(|_, _| 100.0 * random.signed());
    (
        old,
        Deformation {
            gradient: stretch * first,
            rate,
        },
    )
}

/// Response and new history.
pub fn respond(law: &AnyMaterial, d: &Deformation, old: &[f64]) -> (Response, Vec<f64>) {
    let mut new = vec![f64::NAN; law.history_len()];
    let response = law.respond(d, old, &mut new).unwrap();
    (response, new)
}

/// Random numbers without a crate: a 64-bit linear congruential generator, of which the high bits are used.
pub mod rand_free {
    pub struct Random(pub u64);

    impl Random {
        /// Uniform in -1..1.
        pub fn signed(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }
}
