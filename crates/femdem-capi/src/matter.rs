//! What deformable bodies are made of, and how they break.

use std::mem::MaybeUninit;

use femdem_solve::fem::element::Element;
use femdem_solve::fem::fracture::{Strength, Weibull};
use femdem_solve::fem::material::{
    AnyMaterial, DruckerPrager, Hencky, J2, MooneyRivlin, NeoHookean, Viscous, Voce,
};
use femdem_solve::fem::{FemError, MaterialRegion};
use femdem_solve::{Fracture, Fragments};

use crate::border::{Failure, FemdemStatus, border, place};
use crate::softening::{number, softening};

/// Law of a FemdemMatter: compressible neo-Hookean.
pub const FEMDEM_MATTER_NEO_HOOKEAN: i32 = 0;
/// Law of a FemdemMatter: linear in the logarithmic strain.
pub const FEMDEM_MATTER_HENCKY: i32 = 1;
/// Law of a FemdemMatter: Mooney-Rivlin, with `share`.
pub const FEMDEM_MATTER_MOONEY_RIVLIN: i32 = 2;
/// Law of a FemdemMatter: von Mises plasticity, with `yield_stress` and hardening.
pub const FEMDEM_MATTER_J2: i32 = 3;
/// Law of a FemdemMatter: Drucker-Prager plasticity, with `cohesion` and angles.
pub const FEMDEM_MATTER_DRUCKER_PRAGER: i32 = 4;

/// Elements of a FemdemMatter: linear tetrahedra.
pub const FEMDEM_ELEMENT_T4: i32 = 0;
/// Elements of a FemdemMatter: linear tetrahedra with pressures averaged at the nodes, for matter that hardly changes its volume.
pub const FEMDEM_ELEMENT_T4_NODAL_PRESSURE: i32 = 1;
/// Elements of a FemdemMatter: quadratic tetrahedra.
pub const FEMDEM_ELEMENT_T10: i32 = 2;
/// Elements of a FemdemMatter: quadratic tetrahedra with F-bar, for matter that hardly changes its volume.
pub const FEMDEM_ELEMENT_T10_FBAR: i32 = 3;

/// What deformable bodies are made of. Begin with femdem_matter_default. What its law has no use for is not read.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemMatter {
    /// In the reference state, kg/m^3.
    pub density: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson: f64,
    /// Shear viscosity beside any law, Pa s.
    pub shear_viscosity: f64,
    /// Bulk viscosity beside any law, Pa s.
    pub bulk_viscosity: f64,
    /// Stiffness of the contacts over that of the body: with 1 they cost 5 % of the force of a Hertz contact.
    pub contact_ratio: f64,
    /// Mooney-Rivlin: share of the second invariant in the shear modulus, from 0 to 1.
    pub share: f64,
    /// J2: yield stress, Pa.
    pub yield_stress: f64,
    /// J2: hardening modulus, Pa.
    pub hardening: f64,
    /// J2: yield stress at large plastic strain, Pa, approached exponentially; NaN, the default: none.
    pub saturation_stress: f64,
    /// J2: rate at which that is approached, per unit of plastic strain.
    pub saturation_rate: f64,
    /// Drucker-Prager: cohesion of Mohr-Coulomb, Pa.
    pub cohesion: f64,
    /// Drucker-Prager: angle of friction of Mohr-Coulomb, rad.
    pub friction_angle: f64,
    /// Drucker-Prager: angle of dilatancy, rad.
    pub dilatancy_angle: f64,
    /// One of the FEMDEM_MATTER constants.
    pub law: i32,
    /// One of the FEMDEM_ELEMENT constants.
    pub element: i32,
}

/// How bodies break. Begin with femdem_fracture_default.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemFracture {
    /// Tensile strength, Pa.
    pub tensile: f64,
    /// Cohesion of Mohr-Coulomb, Pa.
    pub cohesion: f64,
    /// Angle of friction of Mohr-Coulomb, rad.
    pub friction_angle: f64,
    /// Energy of fracture by opening, J/m^2.
    pub opening_energy: f64,
    /// Energy of fracture by sliding, J/m^2, at least that by opening.
    pub sliding_energy: f64,
    /// Exponent of mixed modes.
    pub mix: f64,
    /// Stiffness of a new crack over E/h, with Young's modulus E and the height h of the elements.
    pub stiffness: f64,
    /// Weibull's modulus of the scatter of the strength, at least 1; 0: none.
    pub weibull_modulus: f64,
    /// The volume whose characteristic strength is that above, m^3.
    pub weibull_volume: f64,
    /// Seed of the scatter.
    pub weibull_seed: u64,
    /// Steps between two looks at the stresses.
    pub every: u32,
    /// One of the FEMDEM_SOFTENING constants.
    pub softening: i32,
    /// 1: the mesh may be coarser than cracks need that take their energy and no more; 0: it is refused.
    pub coarse: i32,
    /// 1: the parts stay one body; 0: femdem_world_fragment_bodies makes bodies of them.
    pub pieces: i32,
}

impl FemdemMatter {
    pub(crate) fn region(&self) -> Result<MaterialRegion, Failure> {
        let mut material = self.law()?;
        if self.shear_viscosity != 0.0 || self.bulk_viscosity != 0.0 {
            let viscous = Viscous::new(material, self.shear_viscosity, self.bulk_viscosity);
            material = viscous?.into();
        }
        let density = self.density;
        Ok(MaterialRegion { material, density })
    }

    fn law(&self) -> Result<AnyMaterial, Failure> {
        let (young, poisson) = (self.young, self.poisson);
        Ok(match self.law {
            FEMDEM_MATTER_NEO_HOOKEAN => NeoHookean::new(young, poisson)?.into(),
            FEMDEM_MATTER_HENCKY => Hencky::new(young, poisson)?.into(),
            FEMDEM_MATTER_MOONEY_RIVLIN => MooneyRivlin::new(young, poisson, self.share)?.into(),
            FEMDEM_MATTER_J2 => {
                let law = J2::new(young, poisson, self.yield_stress, self.hardening)?;
                let (stress, rate) = (self.saturation_stress, self.saturation_rate);
                match stress.is_nan() {
                    true => law.into(),
                    false => law.with_saturation(Voce { stress, rate })?.into(),
                }
            }
            FEMDEM_MATTER_DRUCKER_PRAGER => {
                let angles = [self.friction_angle, self.dilatancy_angle];
                let [friction, dilatancy] = angles;
                DruckerPrager::new(young, poisson, self.cohesion, friction, dilatancy)?.into()
            }
            other => {
                let allowed = "one of the FEMDEM_MATTER constants";
                return Err(Failure::refused("law", other, allowed));
            }
        })
    }

    pub(crate) fn element(&self) -> Result<Element, Failure> {
        Ok(match self.element {
            FEMDEM_ELEMENT_T4 => Element::T4,
            FEMDEM_ELEMENT_T4_NODAL_PRESSURE => Element::T4NodalPressure,
            FEMDEM_ELEMENT_T10 => Element::T10,
            FEMDEM_ELEMENT_T10_FBAR => Element::T10Fbar,
            other => {
                let allowed = "one of the FEMDEM_ELEMENT constants";
                return Err(Failure::refused("element", other, allowed));
            }
        })
    }
}

impl FemdemFracture {
    pub(crate) fn fracture(&self) -> Result<Fracture, Failure> {
        let strength = Strength::new(self.tensile, self.cohesion, self.friction_angle)?;
        let scatter = match self.weibull_modulus {
            0.0 => None,
            modulus => Some(Weibull::new(
                modulus,
                self.weibull_volume,
                self.weibull_seed,
            )?),
        };
        Ok(Fracture {
            mix: self.mix,
            softening: softening(self.softening)?,
            scatter,
            every: self.every,
            stiffness: self.stiffness,
            coarse: self.coarse != 0,
            fragments: if self.pieces != 0 {
                Fragments::Pieces
            } else {
                Fragments::Bodies
            },
            ..Fracture::new(strength, [self.opening_energy, self.sliding_energy])
        })
    }
}

/// Writes the default matter: a rubber of 1100 kg/m^3, 1 MPa and a Poisson's ratio of 0.45, in linear tetrahedra.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_matter_default(
    matter: Option<&mut MaybeUninit<FemdemMatter>>,
) -> FemdemStatus {
    border(|| {
        place("matter", matter)?.write(FemdemMatter {
            density: 1100.0,
            young: 1e6,
            poisson: 0.45,
            shear_viscosity: 0.0,
            bulk_viscosity: 0.0,
            contact_ratio: 1.0,
            share: 0.0,
            yield_stress: 0.0,
            hardening: 0.0,
            saturation_stress: f64::NAN,
            saturation_rate: 0.0,
            cohesion: 0.0,
            friction_angle: 0.0,
            dilatancy_angle: 0.0,
            law: FEMDEM_MATTER_NEO_HOOKEAN,
            element: FEMDEM_ELEMENT_T4,
        });
        Ok(())
    })
}

/// Writes the default fracture: a concrete of 3 MPa and 90 J/m^2.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_fracture_default(
    fracture: Option<&mut MaybeUninit<FemdemFracture>>,
) -> FemdemStatus {
    border(|| {
        let to = place("fracture", fracture)?;
        let [tensile, cohesion, friction_angle] = [3e6, 12e6, 38_f64.to_radians()];
        let [opening_energy, sliding_energy] = [90.0, 450.0];
        let strength = Strength::new(tensile, cohesion, friction_angle)?;
        let usual = Fracture::new(strength, [opening_energy, sliding_energy]);
        to.write(FemdemFracture {
            tensile,
            cohesion,
            friction_angle,
            opening_energy,
            sliding_energy,
            mix: usual.mix,
            stiffness: usual.stiffness,
            weibull_modulus: 0.0,
            weibull_volume: 0.0,
            weibull_seed: 0,
            every: usual.every,
            softening: number(usual.softening),
            coarse: i32::from(usual.coarse),
            pieces: i32::from(usual.fragments == Fragments::Pieces),
        });
        Ok(())
    })
}

impl From<FemError> for Failure {
    fn from(error: FemError) -> Self {
        Self::new(FemdemStatus::Refused, error)
    }
}
