//! Closed surfaces of the void, and the case of OpenFOAM around them.

use std::fmt;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use femdem::Snapshot;
use femdem::analysis::pores::{
    Bridge, Sides, Solids, Surface, SurfaceCheck, SurfacePatch, Treatment, deepest_void,
    facet_surface, signed_distance, surface_region, tube_surface, void_surface, voxel_image,
};
use femdem::analysis::{Region, exact_density};
use femdem::mesh::Point3;
use femdem::output::openfoam::{CasePatch, FlowCase, PatchKind};
use femdem::output::{counted, short_number, stl, write_file};
use serde::Serialize;

use super::image::Fields;
use super::space::{Space, Treated};

/// Folder of the case.
const FOLDER: &str = "flow";

/// Folder of the surfaces in it.
const SURFACES: &str = "constant/triSurface";

/// Cells of the background, in voxels, and how often they are halved at the bodies.
const CELL: f64 = 4.0;
const LEVEL: u32 = 2;

/// Surfaces, and what is known of them.
pub(super) struct Flow {
    surfaces: Vec<Surface>,
    inside: Point3,
    summary: FlowSummary,
}

/// What the surfaces amount to.
#[derive(Debug, Serialize)]
pub(super) struct FlowSummary {
    /// How contacts were treated, and the length or factor of it.
    contacts: &'static str,
    value: f64,
    /// The space that the surfaces lie in.
    region: Region,
    /// Names of the patches.
    patches: Vec<&'static str>,
    /// Checks of the closed surfaces.
    checks: Vec<Check>,
    /// Bodies that were changed; none by bridges.
    changed: usize,
    /// Bodies that reach beyond the region and are cut by nothing.
    beyond: usize,
    /// Pairs that still overlap after shrinking.
    overlapping: usize,
    /// Volume between the surfaces \[m³\]; `None` where bodies reach beyond the region or overlap.
    void_volume: Option<f64>,
    /// The same by the analysis, of the bodies as they are \[m³\].
    exact_void_volume: f64,
    /// Superficial velocity \[m/s\] and kinematic viscosity \[m²/s\] of the case.
    velocity: f64,
    viscosity: f64,
}

/// A closed surface and its exact counterpart.
#[derive(Debug, Serialize)]
struct Check {
    surface: &'static str,
    closed: bool,
    #[serde(flatten)]
    counts: SurfaceCheck,
    /// Volume that the analysis has for it \[m³\].
    analysis: f64,
}

/// Makes the surfaces of a pack.
pub(super) fn make(
    space: &Space,
    solids: &Solids,
    treated: &Treated,
    snapshot: &Snapshot,
    fields: &Fields,
) -> Result<Flow> {
    let exact = exact_density(solids.pack(), &space.tube)?;
    let exact_void = exact.region_volume * (1.0 - exact.density);
    let inside = deepest_void(&fields.image, &fields.distances)
        .context("no voxel of the image is void: give smaller voxels")?;
    let mut summary = FlowSummary {
        contacts: "",
        value: 0.0,
        region: space.tube,
        patches: patches(space).map(|(name, _)| name).collect(),
        checks: Vec::new(),
        changed: 0,
        beyond: 0,
        overlapping: 0,
        void_volume: None,
        exact_void_volume: exact_void,
        velocity: space.fluid.velocity,
        viscosity: space.fluid.viscosity,
    };
    let surfaces = match *treated {
        Treated::Facets(treatment) => {
            (summary.contacts, summary.value) = match treatment {
                Treatment::Shrink(factor) => ("shrink", factor),
                Treatment::Gap(gap) => ("gap", gap),
                Treatment::Cap(gap) => ("cap", gap),
            };
            let bodies = facet_surface(solids.pack(), &space.tube, space.sides, treatment)?;
            let tube = tube_surface(&space.tube, space.repeats)?;
            (summary.changed, summary.beyond) = (bodies.changed, bodies.beyond);
            summary.overlapping = bodies.overlapping;
            summary.check("bodies", &bodies.surface, bodies.volume_before);
            summary.check("tube", &tube, space.tube.volume());
            if bodies.beyond == 0 && bodies.overlapping == 0 {
                let [solid, whole] = [0, 1].map(|k| summary.checks[k].counts.volume);
                summary.void_volume = Some(whole - solid);
            }
            vec![bodies.surface, tube]
        }
        Treated::Bridges(radius) => {
            (summary.contacts, summary.value) = ("bridge", radius);
            let image = voxel_image(solids, &space.tube, space.voxel)?;
            let distances = signed_distance(solids, &image, Sides::Open);
            let bridges = snapshot.contacts.iter().map(|row| Bridge {
                point: row.point,
                normal: row.normal,
                radius,
            });
            let bridges: Vec<Bridge> = match &snapshot.space {
                Some(space) => bridges.flat_map(|b| b.images(space, &image)).collect(),
                None => bridges.collect(),
            };
            let void = void_surface(&image, &distances, &bridges)?;
            summary.region = surface_region(&image);
            summary.check("void", &void, exact_void);
            summary.void_volume = Some(summary.checks[0].counts.volume);
            vec![void]
        }
    };
    Ok(Flow {
        surfaces,
        inside,
        summary,
    })
}

/// The sides along an axis on which space repeats itself.
const PAIRS: [[(&str, SurfacePatch); 2]; 3] = [
    [
        ("x_low", SurfacePatch::XLow),
        ("x_high", SurfacePatch::XHigh),
    ],
    [
        ("y_low", SurfacePatch::YLow),
        ("y_high", SurfacePatch::YHigh),
    ],
    [("z_low", SurfacePatch::Low), ("z_high", SurfacePatch::High)],
];

/// The sides and ends elsewhere.
const OTHERS: [(&str, SurfacePatch); 4] = [
    ("wall", SurfacePatch::Sides),
    ("sides", SurfacePatch::Sides),
    ("inlet", SurfacePatch::Low),
    ("outlet", SurfacePatch::High),
];

/// Names of the patches, and the parts of the surfaces that they are.
fn patches(space: &Space) -> impl Iterator<Item = (&'static str, SurfacePatch)> {
    let repeats = space.repeats;
    let [wall, sides, inlet, outlet] = OTHERS;
    let side = match space.sides {
        Sides::Wall => wall,
        Sides::Open => sides,
    };
    let pairs = PAIRS.into_iter().zip(repeats);
    let pairs = pairs.filter_map(|(pair, repeats)| repeats.then_some(pair));
    let side = (!(repeats[0] && repeats[1])).then_some(side);
    let ends = (!repeats[2]).then_some([inlet, outlet]);
    [("bodies", SurfacePatch::Bodies)]
        .into_iter()
        .chain(side)
        .chain(ends.into_iter().flatten())
        .chain(pairs.flatten())
}

impl FlowSummary {
    fn check(&mut self, name: &'static str, surface: &Surface, analysis: f64) {
        let counts = surface.check();
        self.checks.push(Check {
            surface: name,
            closed: counts.is_closed(),
            counts,
            analysis,
        });
    }
}

impl Flow {
    /// Writes the case; returns what it amounts to.
    pub(super) fn write(self, out: &Path, space: &Space) -> Result<FlowSummary> {
        let folder = out.join(FOLDER);
        let surfaces = folder.join(SURFACES);
        for made in [&surfaces, &folder.join("system"), &folder.join("0")] {
            fs::create_dir_all(made)
                .with_context(|| format!("cannot make the folder {}", made.display()))?;
        }
        // Those of an earlier case may have other names.
        for (name, _) in PAIRS.as_flattened().iter().chain(&OTHERS) {
            let path = surfaces.join(format!("{name}.stl"));
            if path.is_file() {
                fs::remove_file(&path)
                    .with_context(|| format!("cannot remove {}", path.display()))?;
            }
        }
        for (name, part) in patches(space) {
            let triangles = self.surfaces.iter().flat_map(|surface| surface.part(part));
            write_file(surfaces.join(format!("{name}.stl")), |w| {
                stl::write_triangles(triangles, w)
            })?;
        }
        let patch = |name: &&'static str| {
            let kind = match *name {
                "bodies" => PatchKind::Bodies,
                "wall" => PatchKind::Wall,
                "sides" => PatchKind::Slip,
                "inlet" => PatchKind::Inlet,
                "outlet" => PatchKind::Outlet,
                // Sides that repeat are made with the block.
                _ => return None,
            };
            Some(CasePatch {
                name: (*name).to_owned(),
                kind,
            })
        };
        let region = self.summary.region;
        let case = FlowCase {
            region,
            repeats: space.repeats,
            patches: self.summary.patches.iter().filter_map(patch).collect(),
            inside: self.inside,
            cell: CELL * space.voxel,
            level: LEVEL,
            velocity: space.fluid.velocity,
            viscosity: space.fluid.viscosity,
            porosity: self.summary.exact_void_volume / region.volume(),
        };
        let note = self.summary.note();
        for (name, text) in case.files().into_iter().chain([("README.txt", note)]) {
            write_file(folder.join(name), |w| {
                std::io::Write::write_all(w, text.as_bytes())
            })?;
        }
        Ok(self.summary)
    }
}

impl FlowSummary {
    /// The text beside the case.
    fn note(&self) -> String {
        let about = |name: &str| match name {
            "bodies" => format!(
                "the bodies; contacts: {} {}",
                self.contacts,
                short_number(self.value)
            ),
            "wall" => "the side wall of the container".to_owned(),
            "sides" => {
                "the upright sides, cut through a pack that goes on: the fluid slides along them"
                    .to_owned()
            }
            "inlet" => "the lower end (smallest z)".to_owned(),
            "outlet" => "the upper end".to_owned(),
            _ => format!(
                "a side of the periodic cell, a period from the other along {}",
                &name[..1]
            ),
        };
        let line = |name: &&str| format!("  {:<12} {}\n", format!("{name}.stl"), about(name));
        let list: String = self.patches.iter().map(line).collect();
        let repeats = |name: &&str| name.ends_with("_low");
        let cyclic = if self.patches.iter().any(repeats) {
            "Sides of the periodic cell are patches of the block, of type cyclic. Their surfaces are for other programs.\n\n"
        } else {
            ""
        };
        let result = if self.patches.contains(&"inlet") {
            "It prints \"areaAverage(inlet) of p\", the drop of pressure over the density of the fluid, in m2/s2."
        } else {
            "It prints \"pressure gradient\", over the density of the fluid, in m/s2, and \"volIntegrate(region0) of U\", the\n\
             superficial velocity in m/s, which is a little off where narrow gaps are not meshed."
        };
        format!(
            "Surfaces of the void of a pack, in m (constant/triSurface), and a case of OpenFOAM around them.\n\n{list}\n{cyclic}\
             With OpenFOAM in the shell, in this folder:\n\n  blockMesh\n  snappyHexMesh -overwrite\n  checkMesh\n  simpleFoam\n\n\
             The mesh of the void has these patches. Cells are halved {LEVEL} times at the bodies: see level in\n\
             system/snappyHexMeshDict. Gaps narrower than such a cell are not meshed.\n\n\
             simpleFoam computes the steady laminar flow along z, of a superficial velocity of {} m/s and a kinematic\n\
             viscosity of {} m2/s.\n{result}\n",
            short_number(self.velocity),
            short_number(self.viscosity)
        )
    }
}

impl fmt::Display for FlowSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let title = format!("contacts: {} {}", self.contacts, short_number(self.value));
        writeln!(
            f,
            "  {:<20} {title}, {} changed",
            "surfaces",
            counted(self.changed, "body", "bodies")
        )?;
        for check in &self.checks {
            let counts = &check.counts;
            let state = if check.closed {
                format!("closed, {} edges in two triangles each", counts.edges)
            } else {
                format!(
                    "NOT CLOSED: {} of {} edges",
                    counts.open_edges, counts.edges
                )
            };
            writeln!(
                f,
                "  {:<20} {state}; {:.6e} m3, by the analysis {:.6e} m3",
                check.surface, counts.volume, check.analysis
            )?;
        }
        if self.overlapping > 0 {
            writeln!(
                f,
                "  {:<20} {} pairs of bodies still overlap: give a smaller --factor",
                "warning", self.overlapping
            )?;
        }
        if self.beyond > 0 {
            writeln!(
                f,
                "  {:<20} {} bodies reach beyond the region; their surfaces are not cut",
                "note", self.beyond
            )?;
        }
        let exact = self.exact_void_volume;
        match self.void_volume {
            Some(void) => write!(
                f,
                "  {:<20} {void:.6e} m3, {:+.2} % of the exact one",
                "void in surfaces",
                100.0 * (void / exact - 1.0)
            ),
            None => write!(f, "  {:<20} {exact:.6e} m3, exact", "void"),
        }
    }
}
