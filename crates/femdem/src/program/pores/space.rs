//! The pack and the part of space that are looked at.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use femdem::analysis::pores::{Sides, Solids, Treatment, flow_region, images_reach, shrink_factor};
use femdem::analysis::{Pack, PosedBody, Region, WithImages, top_plane};
use femdem::mesh::Polyhedron;
use femdem::output::short_number;
use femdem::scene::Length;
use femdem::solve::Shape;
use femdem::{NamedShape, Snapshot, results};

use super::args::{Contacts, Fluid, PoresArgs, SidesKind};
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

/// Relative difference of volumes that are equal to round-off.
const EQUAL: f64 = 1e-9;

/// Side of the voxels that find how far from a body a point of periodic space can be, in mean diameters.
const COARSE: f64 = 0.5;

/// A pack as read.
pub(super) struct Read {
    pub snapshot: Snapshot,
    pub shapes: Vec<Polyhedron>,
    pub bodies: Vec<PosedBody>,
    /// Mean circumscribed diameter \[m\].
    pub diameter: f64,
    /// Radius of each shape that is an exact ball \[m\].
    pub balls: Vec<Option<f64>>,
    /// What was read, in a line, where there is no summary of it.
    pub lead: Option<String>,
    /// Folder that results belong in.
    pub folder: PathBuf,
    /// Number and time \[s\] of the frame that was asked for.
    pub frame: Option<(usize, f64)>,
}

/// Reads the pack in a folder.
pub(super) fn read(args: &PoresArgs) -> Result<Read> {
    let found = source::read(&args.folder, &args.foreign, &args.frame)?;
    found.refuse_moved_cell()?;
    let lead = found.lead();
    let Found {
        snapshot,
        origin,
        folder,
    } = found;
    let mut balls = match &origin {
        Origin::Pack(saved) => results::ball_radii(saved.packing.world()),
        Origin::Run(saved, None) => results::ball_radii(&saved.0.simulation().world),
        Origin::Run(saved, Some(_)) => {
            let own = saved.0.simulation().world.shapes();
            let shapes = snapshot.shapes.iter();
            shapes.map(|shape| radius_among(own, shape)).collect()
        }
        Origin::Elsewhere => Vec::new(),
    };
    let frame = match &origin {
        Origin::Run(saved, Some(number)) => Some((*number, saved.0.frames()[*number])),
        _ => None,
    };
    snapshot.check()?;
    let (shapes, bodies) = snapshot.posed();
    // Shapes of deformable bodies, and of packs from elsewhere, are no balls.
    balls.resize(shapes.len(), None);
    let diameter = Pack::new(&shapes, &bodies)?.mean_diameter()?;
    Ok(Read {
        snapshot,
        shapes,
        bodies,
        diameter,
        balls,
        lead,
        folder,
        frame,
    })
}

impl Read {
    /// The bodies, and in periodic space their images within `reach` \[m\] of what may be looked at.
    pub(super) fn images(&self, args: &PoresArgs, reach: f64) -> Result<WithImages> {
        let given = args.region.as_ref().map(|given| &given.0);
        let region = given.or(self.snapshot.container.as_ref());
        Ok(match (&self.snapshot.space, region) {
            (Some(space), Some(region)) => {
                WithImages::new(&self.shapes, &self.bodies, space, region, reach)?
            }
            _ => WithImages::none(self.bodies.clone()),
        })
    }
}

/// The radius of the ball among the shapes of a run that a shape from the tables of a frame is \[m\]; `None` if it
/// is none. Tables have a number behind a name that several shapes have: those are told apart by their volume.
fn radius_among(shapes: &[Shape], shape: &NamedShape) -> Option<f64> {
    let volume = shape.polyhedron.mass_properties().volume;
    let is_it = |own: &&Shape| {
        let rest = shape.name.strip_prefix(&own.name);
        let has_name = rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(" ("));
        has_name && own.sphere.is_some() && (own.volume / volume - 1.0).abs() < EQUAL
    };
    shapes.iter().find(is_it).and_then(|own| own.sphere)
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
    /// Axes along which the region repeats itself, and the space of the surfaces does.
    pub repeats: [bool; 3],
    /// Side of a voxel \[m\].
    pub voxel: f64,
    /// The space of the surfaces.
    pub tube: Region,
    pub treatment: Option<Treated>,
    /// What flows there.
    pub fluid: Fluid,
}

impl Space {
    pub(super) fn new(args: &PoresArgs, read: &Read, pack: &Pack) -> Result<Self> {
        let diameter = read.diameter;
        let metres = |given: Option<Length>, default: f64| {
            given.map_or(default * diameter, |size| size.metres(diameter))
        };
        let container = read.snapshot.container.as_ref();
        let endless = read
            .snapshot
            .space
            .is_some_and(|space| space.cell.repeats(2));
        let (region, tube) = match (&args.region, container) {
            (Some(given), _) => (given.0, given.0),
            (None, Some(container)) if endless => {
                if args.margin.is_some() {
                    bail!(
                        "--margin has no effect in space that repeats itself along z: leave it out"
                    );
                }
                (*container, *container)
            }
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
        let repeats = pack.repeats_over(&region)?;
        if repeats[0] && repeats[1] && args.sides.is_some() {
            bail!("--sides has no effect where space repeats itself along x and y: leave it out");
        }
        let sides = match (args.sides, container) {
            (Some(SidesKind::Wall), _) => Sides::Wall,
            (None, Some(container)) if pack.has_sides_of(&region, container)? => Sides::Wall,
            (Some(SidesKind::Open), _) | (None, _) => Sides::Open,
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
                    "bridge = {} m is not allowed with voxels of {} m: give at least {THINNEST} voxels, \
                     or smaller voxels",
                    short_number(radius),
                    short_number(voxel)
                );
            }
            if read.snapshot.gaps.contacts {
                bail!(
                    "--contacts bridge needs the contacts of the pack, which could not be found from its bodies: \
                     add contacts.csv, or give another way with --contacts"
                );
            }
        }
        Ok(Self {
            diameter,
            region,
            sides,
            repeats,
            voxel,
            tube,
            treatment,
            fluid: args.fluid(diameter)?,
        })
    }
}

impl Space {
    /// How far bodies count \[m\], of all images of `near`.
    pub(super) fn reach(&self, read: &Read, near: &WithImages) -> Result<f64> {
        if read.snapshot.space.is_none() {
            return Ok(0.0);
        }
        let pack = near.pack(&read.shapes)?;
        let solids = Solids::new(&pack).with_balls(&read.balls)?;
        let gap = match self.treatment {
            Some(Treated::Facets(Treatment::Gap(gap) | Treatment::Cap(gap))) => gap,
            _ => 0.0,
        };
        let voxel = COARSE * self.diameter;
        Ok(images_reach(&solids, &self.region, voxel, gap)?)
    }

    /// What the upright sides are, in a word.
    pub(super) fn sides_word(&self) -> &'static str {
        match (self.repeats, self.sides) {
            ([true, true, _], _) => "periodic",
            (_, Sides::Wall) => "wall",
            (_, Sides::Open) => "open",
        }
    }
}

#[cfg(test)]
mod tests {
    use femdem::solve::{World, WorldParameters};

    use super::*;

    /// Of two balls of one name, and not of a body that has the name but not the volume.
    #[test]
    fn balls_are_found_by_name_and_volume() {
        let mut world = World::new(WorldParameters::default()).unwrap();
        world.add_sphere("grain", 0.5).unwrap();
        world.add_sphere("grain", 0.25).unwrap();
        let own = world.shapes();
        let of = |name: &str, number: usize| {
            // Tables have a polyhedron of the volume of the ball.
            let facets = &own[number].polyhedron;
            let ratio = own[number].volume / facets.mass_properties().volume;
            let shape = NamedShape {
                name: name.to_owned(),
                polyhedron: facets.scaled(ratio.cbrt()).unwrap(),
            };
            radius_among(own, &shape)
        };
        assert_eq!(of("grain", 0), Some(0.5));
        assert_eq!(of("grain (2)", 1), Some(0.25));
        assert_eq!((of("stone", 1), of("grains", 0)), (None, None));
        let cut = NamedShape {
            name: "grain".to_owned(),
            polyhedron: own[0].polyhedron.clone(),
        };
        assert_eq!(radius_among(own, &cut), None);
    }
}
