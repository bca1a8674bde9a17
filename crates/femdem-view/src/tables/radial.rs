//! The radial distribution function of the core.

use femdem_analysis::{CoreRegion, Pack, RadialBin, Region, radial_distribution};
use femdem_mesh::Point3;

use super::Tables;
use super::geometry::thin;
use crate::ViewError;

impl Tables {
    pub(super) fn add_radial_distribution(&mut self, pack: &Pack) -> Result<(), ViewError> {
        let name = "radial_distribution";
        let Some(core) = self.core.clone() else {
            self.miss(&[name], "it is measured in the core, and there is none");
            return Ok(());
        };
        if core.is_thin() {
            self.miss(
                &["radial_distribution.core"],
                &thin(&core, "the radial distribution function"),
            );
        }
        let space = inner_box(core.density_region());
        if pack.bodies_in(&space)?.len() < 2 {
            self.miss(
                &[name],
                "fewer than two bodies have their centre in the box within the core, or within the bed if \
                 the core is too thin",
            );
            return Ok(());
        }
        let found = radial_distribution(pack, &space, &self.options.radial)?;
        if found.bins.iter().all(RadialBin::is_rare) {
            let reason =
                "fewer than 5 pairs are expected in every bin, too few to draw: go by the table";
            self.miss(&["radial_distribution.plot"], reason);
        }
        self.radial_distribution = Some(found);
        Ok(())
    }

    /// Whether there is a core that is thinner than one body, so that nothing is headed by it.
    pub(crate) fn has_thin_core(&self) -> bool {
        self.core.as_ref().is_some_and(CoreRegion::is_thin)
    }

    /// What densities and the radial distribution function are measured in, in words.
    pub(crate) fn density_space(&self) -> &'static str {
        if self.has_thin_core() { "bed" } else { "core" }
    }
}

/// The largest upright box in a region that is square where the region is round.
fn inner_box(region: &Region) -> Region {
    let half = |radius: f64| radius / 2_f64.sqrt();
    match *region {
        Region::Box { .. } => *region,
        Region::Cylinder {
            centre: [x, y],
            radius,
            z_min,
            z_max,
        } => Region::Box {
            min: Point3::new(x - half(radius), y - half(radius), z_min),
            max: Point3::new(x + half(radius), y + half(radius), z_max),
        },
        Region::Sphere { centre, radius } => {
            let side = radius / 3_f64.sqrt();
            Region::Box {
                min: centre.map(|x| x - side),
                max: centre.map(|x| x + side),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_boxes_touch_the_round_side() {
        let drum = Region::Cylinder {
            centre: [1.0, 2.0],
            radius: 2.0,
            z_min: 0.0,
            z_max: 3.0,
        };
        let ball = Region::Sphere {
            centre: Point3::new(1.0, 2.0, 3.0),
            radius: 2.0,
        };
        for region in [drum, ball] {
            let (low, high) = inner_box(&region).corners();
            let grown = |factor: f64| low + (high - low) * factor;
            assert!(region.contains(&grown(0.999)) && !region.contains(&grown(1.001)));
        }
    }
}
