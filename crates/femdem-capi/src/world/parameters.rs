//! The parameters of a world.

use std::mem::MaybeUninit;

use femdem_solve::contact::ContactParameters;
use femdem_solve::{
    ImplicitStep, Medium, SleepParameters, TimeStepParameters, World, WorldParameters,
};

use crate::border::{FemdemStatus, border, given, place};
use crate::handles::FemdemWorld;
use crate::law::{FemdemLaw, material};
use crate::threads::Threads;

/// What a world needs to know besides its bodies and walls. Begin with femdem_world_defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FemdemWorldParameters {
    /// Acceleration of gravity, m/s^2.
    pub gravity: [f64; 3],
    /// The law of all pairs of materials without one of their own.
    pub law: FemdemLaw,
    /// Part of the largest stable step that is taken, from 1e-6 to 1.
    pub safety: f64,
    /// Upper limit of the step, s; infinite: none.
    pub largest_step: f64,
    /// Rate of drag, 1/s.
    pub drag: f64,
    /// Part by which the net force is reduced against the motion, from 0 to below 1.
    pub local_damping: f64,
    /// Net force of a body at rest over its weight, from 1e-12 to 0.06.
    pub sleep_tolerance: f64,
    /// Steps over which rest is judged, at least 10.
    pub sleep_window: u32,
    /// Whether bodies at rest are frozen: 0 or 1.
    pub sleeping: i32,
    /// Whether steps are linearly implicit, which brings packs to rest faster: 0 or 1.
    pub implicit: i32,
}

impl From<&FemdemWorldParameters> for WorldParameters {
    fn from(own: &FemdemWorldParameters) -> Self {
        Self {
            gravity: own.gravity.into(),
            contact: own.law.parameters(),
            time_step: TimeStepParameters {
                safety: own.safety,
                largest: (own.largest_step != f64::INFINITY).then_some(own.largest_step),
                implicit: (own.implicit != 0).then(ImplicitStep::default),
            },
            sleeping: SleepParameters {
                enabled: own.sleeping != 0,
                tolerance: own.sleep_tolerance,
                window: own.sleep_window,
                ..SleepParameters::default()
            },
            medium: Medium {
                drag: own.drag,
                local_damping: own.local_damping,
            },
        }
    }
}

impl From<&WorldParameters> for FemdemWorldParameters {
    fn from(own: &WorldParameters) -> Self {
        Self {
            gravity: own.gravity.into(),
            law: FemdemLaw::from(&own.contact),
            safety: own.time_step.safety,
            largest_step: own.time_step.largest.unwrap_or(f64::INFINITY),
            drag: own.medium.drag,
            local_damping: own.medium.local_damping,
            sleep_tolerance: own.sleeping.tolerance,
            sleep_window: own.sleeping.window,
            sleeping: i32::from(own.sleeping.enabled),
            implicit: i32::from(own.time_step.implicit.is_some()),
        }
    }
}

/// Writes the default parameters: gravity along -z, the default law, explicit steps, bodies that sleep.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_defaults(
    parameters: Option<&mut MaybeUninit<FemdemWorldParameters>>,
) -> FemdemStatus {
    border(|| {
        let usual = FemdemWorldParameters::from(&WorldParameters::default());
        place("parameters", parameters)?.write(usual);
        Ok(())
    })
}

/// Makes an empty world.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_new(
    parameters: Option<&FemdemWorldParameters>,
    world: Option<&mut MaybeUninit<FemdemWorld>>,
) -> FemdemStatus {
    border(|| {
        let world = place("world", world)?;
        let parameters = WorldParameters::from(given("parameters", parameters)?);
        world.write(FemdemWorld::new(World::new(parameters)?.into()));
        Ok(())
    })
}

/// Gives a world threads of its own; 0: those of the process again. Results are the same bits for any number.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_threads(world: FemdemWorld, threads: u32) -> FemdemStatus {
    border(|| {
        world.with(|own| {
            own.threads = Threads::new(threads)?;
            Ok(())
        })
    })
}

/// Gives two materials, from 0 to 255, or a material and itself, a law of their own; null: that of the parameters again.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_law(
    world: FemdemWorld,
    material_a: u32,
    material_b: u32,
    law: Option<&FemdemLaw>,
) -> FemdemStatus {
    border(|| {
        let (a, b) = (material(material_a)?, material(material_b)?);
        let law: Option<ContactParameters> = law.map(FemdemLaw::parameters);
        world.with(|own| {
            let world = &mut own.world;
            Ok(own.threads.run(|| world.set_law(a, b, law))?)
        })
    })
}

/// Replaces the acceleration of gravity, m/s^2. All bodies wake.
#[unsafe(no_mangle)]
pub extern "C" fn femdem_world_set_gravity(
    world: FemdemWorld,
    x: f64,
    y: f64,
    z: f64,
) -> FemdemStatus {
    border(|| world.with(|own| Ok(own.world.set_gravity([x, y, z].into())?)))
}
