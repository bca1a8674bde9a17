//! Overlaps of bodies and walls added since the contacts were last evaluated.

use super::World;
use crate::error::SolveError;
use femdem_contact::Partner;
use femdem_contact::deform::DeformablePartner;
use serde::{Deserialize, Serialize};

/// Numbers of each kind when the contacts were last evaluated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Met {
    bodies: u32,
    deformables: u32,
    walls: u32,
}

impl World {
    /// Evaluates the loads at the present positions, if they are out of date. The elastic energy of overlaps
    /// with bodies and walls added since the last evaluation is booked as brought in by them.
    pub(super) fn evaluate_if_due(&mut self) -> Result<(), SolveError> {
        if !self.loaded {
            self.evaluate(0.0)?;
            self.loaded = true;
            self.wake_left();
            self.initial_energy += self.elastic_energy_of_newcomers();
            self.meet_newcomers();
        }
        Ok(())
    }

    /// Marks everything present as evaluated.
    pub(super) fn meet_newcomers(&mut self) {
        self.met = self.present();
    }

    fn present(&self) -> Met {
        Met {
            bodies: self.bodies.len() as u32,
            deformables: self.deformable_count() as u32,
            walls: self.wall_drives.len() as u32,
        }
    }

    fn elastic_energy_of_newcomers(&self) -> f64 {
        let met = self.met;
        if met == self.present() {
            return 0.0;
        }
        let rigid = self.batch.contacts().into_iter().filter(|c| {
            c.b >= met.bodies
                || match c.a {
                    Partner::Body(a) => a >= met.bodies,
                    Partner::Wall(wall) => wall >= met.walls,
                }
        });
        let soft = self.deformable_contacts().filter(|c| {
            c.b >= met.deformables
                || match c.a {
                    DeformablePartner::Deformable(a) => a >= met.deformables,
                    DeformablePartner::Rigid(a) => a >= met.bodies,
                    DeformablePartner::Wall(wall) => wall >= met.walls,
                }
        });
        rigid.map(|c| c.energy).sum::<f64>() + soft.map(|c| c.energy).sum::<f64>()
    }
}
