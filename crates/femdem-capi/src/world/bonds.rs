//! Bonds between the bodies of a world.

use std::mem::MaybeUninit;

use femdem_solve::contact::BodyId;
use femdem_solve::contact::bond::{Bond, BondLaw, BondSection};
use femdem_solve::mesh::Vector3;

use super::Hosted;
use super::query::no_such;
use crate::border::{Failure, FemdemStatus, answer, border, given, place, points};
use crate::handles::FemdemWorld;
use crate::softening::{number, softening};

/// How a bond holds and breaks, per area of its section. Begin with femdem_bond_law_default.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemBondLaw {
    /// Along and across the normal, Pa/m: Young's modulus over the thickness.
    pub stiffness: f64,
    /// Tensile strength, Pa.
    pub tensile: f64,
    /// Shear strength without pressure, Pa.
    pub cohesion: f64,
    /// Coefficient of friction, of the strength under pressure and of the broken faces.
    pub friction: f64,
    /// Energy of fracture by opening, J/m^2.
    pub opening_energy: f64,
    /// Energy of fracture by sliding, J/m^2.
    pub sliding_energy: f64,
    /// Exponent of mixed modes.
    pub mix: f64,
    /// Part of the critical damping of the two bodies along the normal, from 0 to below 10.
    pub damping: f64,
    /// One of the FEMDEM_SOFTENING constants.
    pub softening: i32,
}

/// A bond between the bodies A and B. Vectors are in world axes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FemdemBond {
    /// Its number.
    pub bond: u32,
    /// Number of the body A.
    pub a: u32,
    /// Number of the body B.
    pub b: u32,
    /// 1 if nothing holds any more, else 0.
    pub broken: i32,
    /// 1 if it carries nothing any more and the bodies meet by their contacts again, else 0.
    pub ended: i32,
    /// m^2.
    pub area: f64,
    /// Centroid of the section midway between its sides, m.
    pub centre: [f64; 3],
    /// Unit vector from A to B.
    pub normal: [f64; 3],
    /// With which B pulls A, without dashpots, N: along the normal in tension.
    pub force: [f64; 3],
    /// Of B on A about the centre, without dashpots, N m.
    pub moment: [f64; 3],
    /// Largest normal traction, Pa.
    pub tension: f64,
    /// Stored energy, J.
    pub energy: f64,
    /// Dissipated by fracture and friction, J.
    pub dissipated: f64,
    /// Part of the stiffness that is lost: 0 whole, 1 broken.
    pub damage: f64,
    /// Part of sliding in what gave way: 0 by opening, 1 by sliding.
    pub mode: f64,
    /// When it was found broken, s; NaN if it is not.
    pub broken_at: f64,
}

impl FemdemBondLaw {
    fn law(&self) -> Result<BondLaw, Failure> {
        Ok(BondLaw {
            stiffness: self.stiffness,
            tensile: self.tensile,
            cohesion: self.cohesion,
            friction: self.friction,
            energies: [self.opening_energy, self.sliding_energy],
            mix: self.mix,
            softening: softening(self.softening)?,
            damping: self.damping,
        })
    }
}

impl From<BondLaw> for FemdemBondLaw {
    fn from(law: BondLaw) -> Self {
        let [opening_energy, sliding_energy] = law.energies;
        Self {
            stiffness: law.stiffness,
            tensile: law.tensile,
            cohesion: law.cohesion,
            friction: law.friction,
            opening_energy,
            sliding_energy,
            mix: law.mix,
            damping: law.damping,
            softening: number(law.softening),
        }
    }
}

impl FemdemBond {
    fn of((number, bond): (u32, &Bond)) -> Self {
        let ([a, b], state, lost) = (bond.bodies(), bond.state(), bond.lost());
        Self {
            bond: number,
            a,
            b,
            broken: i32::from(bond.is_broken()),
            ended: i32::from(bond.has_ended()),
            area: bond.area(),
            centre: state.centre.into(),
            normal: state.normal.into(),
            force: state.force.into(),
            moment: state.moment.into(),
            tension: state.tension,
            energy: state.energy,
            dissipated: lost.glue + lost.friction,
            damage: bond.damage(),
            mode: bond.mode(),
            broken_at: bond.broken_at().unwrap_or(f64::NAN),
        }
    }
}

/// Writes the default law of bonds: a mortar.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_bond_law_default(
    law: Option<&mut MaybeUninit<FemdemBondLaw>>,
) -> FemdemStatus {
    border(|| {
        place("law", law)?.write(FemdemBondLaw::from(BondLaw::default()));
        Ok(())
    })
}

/// Bonds two bodies as they lie, without force, over a flat, convex polygon: its corners in order, in world coordinates, three
/// numbers each. Their contacts end; the bond alone acts between them until it has ended. It goes with its bodies. Steps must
/// be explicit.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_add_bond(
    world: FemdemWorld,
    body_a: u32,
    body_b: u32,
    corners: *const f64,
    corner_count: usize,
    law: Option<&FemdemBondLaw>,
    bond: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let (to, law) = (place("bond", bond)?, given("law", law)?.law()?);
        // SAFETY: as the caller promises.
        let corners = unsafe { points("corners", corners, corner_count)? };
        let corners: Vec<Vector3> = corners.iter().map(|corner| corner.coords).collect();
        world.with(|own| {
            let [from, towards] = own.centroids([body_a, body_b])?;
            let section = BondSection::polygon(&corners, towards - from)?;
            to.write(own.world.add_bond([body_a, body_b], &section, law)?);
            Ok(())
        })
    })
}

/// The same over the section that two balls or two convex polyhedra have between them which are at most `gap` m apart: of balls
/// a disc of `ratio` times the smaller radius, of polyhedra the common part of facing faces, shrunk by `ratio`. Refuses others,
/// and bodies that are bonded already.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_add_bond_between(
    world: FemdemWorld,
    body_a: u32,
    body_b: u32,
    gap: f64,
    ratio: f64,
    law: Option<&FemdemBondLaw>,
    bond: Option<&mut MaybeUninit<u32>>,
) -> FemdemStatus {
    border(|| {
        let (to, law) = (place("bond", bond)?, given("law", law)?.law()?);
        let pair = [body_a, body_b];
        let named = format!("{body_a}, {body_b}");
        world.with(|own| {
            own.centroids(pair)?;
            if own.world.are_bonded(pair) {
                let allowed = "not bonded to each other already: it would be twice the mortar";
                return Err(Failure::refused("bodies of a bond", named, allowed));
            }
            let section = own.world.section_between(pair, gap, ratio)?;
            let allowed = "two balls or two convex polyhedra with facing faces, at most the gap apart; else give a polygon";
            let section =
                section.ok_or_else(|| Failure::refused("bodies of a bond", named, allowed))?;
            to.write(own.world.add_bond(pair, &section, law)?);
            Ok(())
        })
    })
}

/// Writes the number of bonds, and the bonds, ascending, if `room` is not 0: then it must suffice for all. Those that have ended
/// are among them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn femdem_world_bonds(
    world: FemdemWorld,
    bonds: *mut FemdemBond,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> FemdemStatus {
    border(|| {
        let all = |own: &mut Hosted| Ok(own.world.bonds().map(FemdemBond::of).collect::<Vec<_>>());
        let all = world.with(all)?;
        // SAFETY: as the caller promises.
        unsafe { answer("bonds", all.into_iter(), (bonds, room), count) }
    })
}

impl Hosted {
    /// Of two different bodies.
    fn centroids(&self, [a, b]: [BodyId; 2]) -> Result<[Vector3; 2], Failure> {
        if a == b {
            let allowed = "two bodies: give two different numbers";
            let named = format!("{a}, {b}");
            return Err(Failure::refused("bodies of a bond", named, allowed));
        }
        let at = |body: BodyId| {
            let found = self.world.position(body);
            found.ok_or_else(|| no_such("rigid body", body, self.world.rigid_count()))
        };
        Ok([at(a)?, at(b)?])
    }
}
