//! The voxels: image, distances, pore sizes and paths.

use std::fmt;
use std::path::Path;

use anyhow::Result;
use femdem::analysis::pores::{
    PoreSizes, Solids, Tortuosity, VoxelCounts, VoxelImage, local_thickness, paths,
    signed_distance, voxel_image,
};
use femdem::analysis::{Table, exact_density};
use femdem::output::raw::{self, Voxels};
use femdem::output::{vti, write_file};
use serde::Serialize;

use super::space::Space;

/// Everything over voxels.
pub(super) struct Fields {
    pub image: VoxelImage,
    pub distances: Vec<f64>,
    diameters: Vec<f64>,
    lengths: Vec<f64>,
    sizes: PoreSizes,
}

/// What the voxels amount to.
#[derive(Debug, Serialize)]
pub(super) struct VoxelSummary {
    /// Number of voxels along x, y, z.
    counts: [usize; 3],
    /// Sides of a voxel \[m\].
    spacing: [f64; 3],
    voxels: VoxelCounts,
    porosity: Porosity,
    pore_diameter: PoreDiameter,
    tortuosity: Tortuosity,
    #[serde(skip)]
    mean_body: f64,
}

#[derive(Debug, Serialize)]
struct Porosity {
    /// Share of void voxels.
    image: f64,
    /// One minus the exact packing density of the same region.
    exact: f64,
}

/// By void volume \[m\].
#[derive(Debug, Serialize)]
struct PoreDiameter {
    mean: f64,
    median: f64,
    standard_deviation: f64,
    largest: f64,
}

/// Measures everything over voxels.
pub(super) fn measure(space: &Space, solids: &Solids) -> Result<(VoxelSummary, Fields)> {
    let image = voxel_image(solids, &space.region, space.voxel)?;
    let distances = signed_distance(solids, &image, space.sides);
    let diameters = local_thickness(&image, &distances)?;
    let sizes = PoreSizes::new(&image, &diameters)?;
    let found = paths(&image);
    let voxels = image.counts();
    let exact = 1.0 - exact_density(solids.pack(), &space.region)?.density;
    let summary = VoxelSummary {
        counts: image.grid.counts,
        spacing: image.grid.spacing,
        voxels,
        porosity: Porosity {
            image: voxels.porosity(),
            exact,
        },
        pore_diameter: PoreDiameter {
            mean: sizes.mean,
            median: sizes.median,
            standard_deviation: sizes.deviation,
            largest: sizes.largest,
        },
        tortuosity: found.tortuosity,
        mean_body: space.diameter,
    };
    let fields = Fields {
        image,
        distances,
        diameters,
        lengths: found.lengths,
        sizes,
    };
    Ok((summary, fields))
}

/// Writes the files of the voxels.
pub(super) fn write(out: &Path, fields: &Fields) -> Result<()> {
    let image = &fields.image;
    write_file(out.join("labels.vti"), |w| vti::write_labels(image, w))?;
    write_file(out.join("fields.vti"), |w| {
        let all = [
            ("distance_m", &fields.distances[..]),
            ("pore_diameter_m", &fields.diameters),
            ("path_m", &fields.lengths),
        ];
        vti::write_fields(&image.grid, &all, w)
    })?;
    for (name, voxels) in [("labels", Voxels::Labels), ("phases", Voxels::Phases)] {
        let numbers = format!("{name}.raw");
        write_file(out.join(&numbers), |w| raw::write_numbers(image, voxels, w))?;
        write_file(out.join(format!("{name}.mhd")), |w| {
            raw::write_header(image, voxels, &numbers, w)
        })?;
    }
    write_file(out.join("pore-sizes.csv"), |w| fields.sizes.write_csv(w))?;
    Ok(())
}

impl fmt::Display for VoxelSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [nx, ny, nz] = self.counts;
        let side = self.spacing.into_iter().fold(0.0, f64::max);
        writeln!(f, "  {:<20} {nx} x {ny} x {nz}, of {side:.3e} m", "voxels")?;
        let Porosity { image, exact } = self.porosity;
        writeln!(
            f,
            "  {:<20} {image:.4} of the image, {exact:.4} exact",
            "porosity"
        )?;
        let d = self.mean_body;
        let pores = &self.pore_diameter;
        writeln!(
            f,
            "  {:<20} median {:.3} d, mean {:.3} d, largest {:.3} d (d = {d:.4} m)",
            "pore diameter",
            pores.median / d,
            pores.mean / d,
            pores.largest / d
        )?;
        let found = &self.tortuosity;
        match (found.shortest, found.mean) {
            (Some(shortest), Some(mean)) => write!(
                f,
                "  {:<20} mean {mean:.3}, shortest path {shortest:.3} (fast marching along z)",
                "tortuosity"
            ),
            _ => write!(
                f,
                "  {:<20} no path leads through the voxels along z",
                "tortuosity"
            ),
        }
    }
}
