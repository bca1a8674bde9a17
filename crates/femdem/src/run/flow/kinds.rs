//! The sizes of the bodies of a source.

use std::f64::consts::PI;

use femdem_pack::Grading;

use super::SourceEntry;
use super::state::Kind;
use crate::Error;
use crate::run::Simulation;
use crate::run::geometry::Geometry;

/// Bodies whose mean mass stands for that of all where their number follows from it.
const MANY: u64 = 1000;

/// The kinds of a source, its bodies per second, and how many there are.
pub(super) struct Kinds {
    pub kinds: Vec<Kind>,
    pub rate: f64,
    pub most: u64,
}

impl Kinds {
    /// Those of an entry, with their shapes in the world, for a run of a duration \[s\].
    pub(super) fn new(
        simulation: &mut Simulation,
        entry: &SourceEntry,
        name: &str,
        (density, duration): (f64, f64),
    ) -> Result<Self, Error> {
        let grading = entry.grading()?;
        let geometry = entry.geometry(grading.is_some())?;
        simulation.note(geometry.note.as_ref());
        let one = density * volume(&geometry);
        let total = |sizes: &[(f64, u32)]| -> f64 {
            let each = sizes.iter();
            each.map(|(scale, count)| f64::from(*count) * scale.powi(3) * one)
                .sum()
        };
        let mean = total(&sizes(grading.as_ref(), MANY)) / MANY as f64;
        let rate = entry.bodies_per_second(mean)?;
        let mut most = entry.most(mean, rate, duration)?;
        let mut dealt = sizes(grading.as_ref(), most);
        if let (Some(mass), Some(_)) = (entry.mass, &grading) {
            // So many bodies have another mean mass.
            while most > 1 && total(&dealt) > mass {
                let fitting = most as f64 * mass / total(&dealt);
                most = (most - 1).min(fitting as u64).max(1);
                dealt = sizes(grading.as_ref(), most);
            }
        }
        let (mut kinds, mut end) = (Vec::with_capacity(dealt.len()), 0);
        for (scale, count) in dealt {
            let shape = match grading {
                None => simulation.add_shape(name, &geometry)?,
                Some(_) => simulation.add_shape(name, &geometry.scaled(scale)?)?,
            };
            end += count;
            kinds.push(Kind {
                shape,
                mass: density * simulation.world.shapes()[shape as usize].volume,
                radius: simulation.reach_of(shape),
                end,
            });
        }
        Ok(Self { kinds, rate, most })
    }
}

/// Sizes over that of the shape, rising, with the numbers of bodies.
fn sizes(grading: Option<&Grading>, number: u64) -> Vec<(f64, u32)> {
    // A source has at most a million bodies.
    let number = number as u32;
    match grading {
        None => vec![(1.0, number)],
        Some(grading) => {
            let classes = grading.bodies(number);
            classes.iter().map(|c| (c.diameter, c.count)).collect()
        }
    }
}

/// Volume of a body of a shape \[m^3\].
fn volume(geometry: &Geometry) -> f64 {
    match geometry.is_ball {
        true => 4.0 / 3.0 * PI * geometry.surface.bounding_radius().powi(3),
        false => geometry.surface.mass_properties().volume,
    }
}
