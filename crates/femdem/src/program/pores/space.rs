//! The pack and the part of space that are looked at.

use anyhow::{Context, Result, bail};
use femdem::analysis::pores::{Sides, Treatment, flow_region, shrink_factor};
use femdem::analysis::{Pack, PosedBody, Region, top_plane};
use femdem::mesh::Polyhedron;
use femdem::{Snapshot, results};

use super::args::{Contacts, PoresArgs, SidesKind, Size};
use crate::program::source::{self, Found, Origin};

/// Defaults over the mean diameter.
const VOXEL: f64 = 0.05;
const GAP: f64 = 0.01;
const BRIDGE: f64 = 0.1;
const MARGIN: f64 = 1.0;

/// Smallest radius of a bridge, in voxels.
const THINNEST: f64 = 1.5;

/// Spacing of the lines that find the mean top, in mean diameters, as that of the core.
const LINES: f64 = 0.25;

/// A pack as read.
pub(super) struct Read {
    pub snapshot: Snapshot,
    pub shapes: Vec<Polyhedron>,
    pub bodies: Vec<PosedBody>,
    /// Radius of each shape that is an exact ball \[m\].
    pub balls: Vec<Option<f64>>,
}

/// Reads the pack in a folder.
pub(super) fn read(args: &PoresArgs) -> Result<Read> {
    let Found {
        snapshot, origin, ..
    } = source::read(&args.folder, &args.foreign, &args.frame)?;
    let balls = match &origin {
        Origin::Pack(saved) => results::ball_radii(saved.packing.world()),
        Origin::Run(saved, None) => results::ball_radii(&saved.0.simulation().world),
        Origin::Run(_, Some(_)) | Origin::Elsewhere => Vec::new(),
    };
    snapshot.check()?;
    let shapes: Vec<Polyhedron> = snapshot
        .shapes
        .iter()
        .map(|s| s.polyhedron.clone())
        .collect();
    let posed = snapshot.bodies.iter().map(|body| PosedBody {
        shape: body.shape,
        pose: body.pose,
    });
    let bodies = posed.collect();
    // Shapes of deformable bodies, and of packs from elsewhere, are no balls.
    let mut balls = balls;
    balls.resize(shapes.len(), None);
    Ok(Read {
        snapshot,
        shapes,
        bodies,
        balls,
    })
}

/// How contacts are treated, in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Treated {
    Facets(Treatment),
    Bridges(f64),
}

/// What is looked at, and how finely.
pub(super) struct Space {
    /// Mean circumscribed diameter \[m\].
    pub diameter: f64,
    pub region: Region,
    pub sides: Sides,
    /// Side of a voxel \[m\].
    pub voxel: f64,
    /// The space of the surfaces.
    pub tube: Region,
    pub treatment: Option<Treated>,
}

impl Space {
    pub(super) fn new(args: &PoresArgs, read: &Read, pack: &Pack) -> Result<Self> {
        let diameter = pack.mean_diameter()?;
        let metres = |given: Option<Size>, default: f64| {
            given.map_or(default * diameter, |size| size.0.metres(diameter))
        };
        let container = read.snapshot.container.as_ref();
        let (region, tube) = match (&args.region, container) {
            (Some(given), _) => (given.0, given.0),
            (None, Some(container)) => {
                let top = top_plane(pack, container, LINES * diameter)?;
                let filled = container
                    .slab(f64::NEG_INFINITY, top.mean)
                    .context("the pack does not reach into its container; give --region")?;
                let margin = metres(args.margin, MARGIN);
                (filled, flow_region(pack, container, margin)?)
            }
            (None, None) => bail!(
                "the inside of the container is not known: give --region X0,Y0,Z0,X1,Y1,Z1 or --region \
                 cylinder:X,Y,RADIUS,Z0,Z1, in m"
            ),
        };
        let sides = match args.sides {
            Some(SidesKind::Wall) => Sides::Wall,
            Some(SidesKind::Open) => Sides::Open,
            None if container.is_some_and(|container| is_as_wide(&region, container)) => {
                Sides::Wall
            }
            None => Sides::Open,
        };
        let voxel = metres(args.voxel, VOXEL);
        let all_convex = read.shapes.iter().all(Polyhedron::is_convex);
        let treatment = match args.treatment(all_convex) {
            None => None,
            Some(contacts) => {
                args.refuse_idle(contacts)?;
                Some(match contacts {
                    Contacts::Shrink => {
                        let usual = || shrink_factor(pack, &tube, sides);
                        let factor = args.factor.map_or_else(usual, Ok)?;
                        Treated::Facets(Treatment::Shrink(factor))
                    }
                    Contacts::Gap => Treated::Facets(Treatment::Gap(metres(args.gap, GAP))),
                    Contacts::Cap => Treated::Facets(Treatment::Cap(metres(args.gap, GAP))),
                    Contacts::Bridge => Treated::Bridges(metres(args.bridge, BRIDGE)),
                })
            }
        };
        if let Some(Treated::Bridges(radius)) = treatment {
            if radius < THINNEST * voxel {
                bail!(
                    "bridge = {radius} m is not allowed with voxels of {voxel} m: give at least {THINNEST} voxels, \
                     or smaller voxels"
                );
            }
            if read.snapshot.gaps.contacts {
                bail!(
                    "--contacts bridge needs the contacts of the pack: add contacts.csv, or give another way with \
                     --contacts"
                );
            }
        }
        Ok(Self {
            diameter,
            region,
            sides,
            voxel,
            tube,
            treatment,
        })
    }
}

/// Whether two regions have the same upright sides.
fn is_as_wide(region: &Region, container: &Region) -> bool {
    match (*region, *container) {
        (
            Region::Box { min, max },
            Region::Box {
                min: low,
                max: high,
            },
        ) => {
            let size = (high - low).norm();
            (min - low).xy().norm() + (max - high).xy().norm() < 1e-6 * size
        }
        (
            Region::Cylinder { centre, radius, .. },
            Region::Cylinder {
                centre: middle,
                radius: whole,
                ..
            },
        ) => {
            let off = (centre[0] - middle[0]).hypot(centre[1] - middle[1]);
            off + (radius - whole).abs() < 1e-6 * whole
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_walls_where_they_are_those_of_the_container() {
        let drum = |radius: f64, z_max: f64| Region::Cylinder {
            centre: [0.0; 2],
            radius,
            z_min: 0.0,
            z_max,
        };
        assert!(is_as_wide(&drum(1.0, 2.0), &drum(1.0, 5.0)));
        assert!(!is_as_wide(&drum(0.9, 2.0), &drum(1.0, 5.0)));
        let cube = Region::Box {
            min: [-1.0; 3].into(),
            max: [1.0; 3].into(),
        };
        assert!(!is_as_wide(&cube, &drum(1.0, 5.0)) && is_as_wide(&cube, &cube));
    }
}
