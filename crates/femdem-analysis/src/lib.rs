//! Statistics of packs of polyhedra, convex or not: packing density, contacts, forces and stress.
//!
//! Input and output are plain data and plain tables. The bodies may come from femdem, from a file or from
//! another code; this crate does not depend on how they were made or stored.
//!
//! **Use it** to measure settled packs of rigid polyhedra: the density of a region, exactly and by the counting
//! grid of the founding paper (Xiang, Latham and Farsi 2016), with its error; how bodies lie and touch; how
//! contact forces are distributed, which chains carry them, and the stress. The tables of contacts and forces
//! need no shapes, so that they also serve for spheres or clumps. **Do not use it** to find contacts
//! (femdem-contact does), for the density of deformable bodies or of spheres (closed formulas are better), or
//! for periodic boxes, whose images it does not make.
//!
//! ```
//! use femdem_analysis::*;
//! use femdem_mesh::{Point3, Pose, catalogue::CatalogueShape};
//!
//! // 8 x 8 x 8 cubes of side 1 m, 0.25 m apart.
//! let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
//! let place = |i: i32| 1.25 * f64::from(i) + 0.625;
//! let bodies: Vec<PosedBody> = (0..512)
//!     .map(|i| Pose::translation(place(i % 8), place(i / 8 % 8), place(i / 64)))
//!     .map(|pose| PosedBody { shape: 0, pose })
//!     .collect();
//! let pack = Pack::new(&cube, &bodies)?;
//! let region = Region::Box { min: Point3::new(1.25, 1.25, 1.25), max: Point3::new(7.5, 7.5, 7.5) };
//! let density = packing_density(&pack, &region, &DensityOptions::default())?;
//! assert!((density.exact - 0.8_f64.powi(3)).abs() < 1e-12);
//! // Bodies in step with one another err together, so more than `grid_error`, which is for random poses.
//! assert!(density.grid.is_some_and(|grid| (grid - density.exact).abs() < 0.02));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is where
//! - [`Pack`], [`PosedBody`]: the input. [`Region`]: where to measure. [`mesh`]: femdem-mesh, for shapes and poses.
//! - [`choose_core`], [`top_plane`], [`Region::inset`]: the core region away from walls, floor and top.
//! - [`free_surface`]: the slope of a bed in a drum or of a heap.
//! - [`measure_bed`]: void fraction of the whole bed, also over a cone and in the hollow of a solid ([`Vessel`]).
//! - [`packing_density`]; its parts [`exact_density`] and [`grid_density`].
//! - [`height_profile`], [`wall_profile`]: packing density and layers against height and wall distance.
//! - [`density_map`]: local packing density on a grid.
//! - [`set_voronoi`]: the space and the density of every body.
//! - [`body_directions`], [`stereonet`], [`orientation_order`]: orientations of the bodies.
//! - [`tilts`] of bodies and their histogram near walls and in the core ([`tilt_histogram`]).
//! - [`radial_distribution`]: distances between bodies. [`mixing`]: Lacey's index of classes of bodies.
//! - [`pores`]: the void space as voxels, distances, pore sizes, paths and closed surfaces, for flow codes.
//! - [`pair_overlaps`]: volumes that bodies share. [`volume_inside`] and [`intersection_volume`] are the
//!   kernels, for one body and for one pair.
//! - [`measure_fragments`]: sizes of fragments; [`fragmentation`]: their size curve with fitted laws, and t10.
//! - [`Table`]: every result as CSV; JSON through serde. [`BlockBootstrap`]: errors of means.
//! - [`coordination`] from [`Touch`]es; [`contact_counts`] body by body.
//! - [`ForceNetwork`] of [`ForceBody`]s and [`ForceContact`]s: the input of everything below.
//! - [`ContactClass`], [`contact_classes`], [`rattlers`] with the count of constraints,
//!   [`mean_coordination`] with its error.
//! - [`force_distribution`], P(f) with its tail ([`fit_tail`]); [`force_maxima`]; [`wall_forces`].
//! - [`chains_by_weight`], [`chains_by_stress`]: force chains by two rules, their length, straightness and
//!   loops; [`threshold_curve`]: components and cycles.
//! - [`body_stresses`], [`region_stress`], [`stress_profile`]: Love-Weber stress, compression positive;
//!   [`vertical_balance`]: whether the forces carry the weight. [`contact_fabric`]: anisotropy.
//! - [`coarse_grained_fields`]: density, velocity, stress and fabric as fields on a grid.
//!
//! # Units
//! SI: metres, cubic metres, newtons. Lengths `_over_d` are in mean circumscribed diameters.
//!
//! # Features
//! - `parallel` (default): work on the caller's rayon pool. Results are the same bits with any number
//!   of threads and without the feature.
//!
//! # Accuracy
//! Clipped volumes are exact to round-off (about 1e-13 of a body), in boxes, cylinders and spheres. Bodies may
//! have any closed surface, and overlaps of non-convex bodies are as exact as all others. Overlaps are
//! subtracted pair by pair: volume shared by three bodies is subtracted once too often. Errors of the grid are
//! given with its result. Set-Voronoi cells sum to the region; a single one has an error of about 0.1 %
//! ([`set_voronoi`]). Stresses and balances are sums of the given forces, exact to round-off. If the start of a
//! tail is given, its interval contains the true exponent with the stated probability ([`fit_tail`]). Volumes
//! of shells in the radial distribution function are exact.
//!
//! # Time
//! One thread of a busy machine, 343 bodies with some 900 overlaps, density by both methods with bootstrap:
//! 0.03 s for truncated dodecahedra, 0.1 s for dolosse, 0.5 s for surfaces of 1,280 triangles, 2 s for 5,120.
//!
//! 11,000 truncated dodecahedra with 23,000 overlaps on a busy machine: 11 s of processor time and 34 MB for
//! overlaps, density, both profiles, density map, Set-Voronoi cells (half of it), stereonet of 134,000 face
//! normals, order and radial distribution function, all of which can use any number of threads. A wall profile
//! of as many bodies in a cylinder takes 2.5 s. `tests/cost.rs` states the command. All tables of forces of
//! 11,000 bodies with 32,000 contacts take 1 s on two threads, most of it for the bootstrap of the tail
//! (`tests/cost_forces.rs`).

mod axis;
mod ball;
mod bed;
mod blocks;
mod bootstrap;
mod bounds;
mod chains;
mod class;
mod clip;
mod coordination;
mod core_region;
mod density;
mod error;
mod fabric;
mod fields;
mod forces;
mod fragments;
mod images;
mod lines;
mod map;
mod mixing;
mod neighbours;
mod network;
mod ordered;
mod orientation;
mod overlap;
mod pack;
mod polygon;
pub mod pores;
mod prisms;
mod profile;
mod radial;
mod region;
mod rows;
mod segment;
mod sieve;
mod stress;
mod structure;
mod surface;
mod table;
mod tensor;
mod top;
mod voronoi;

pub use femdem_mesh as mesh;

pub use bed::{Bed, Vessel, measure_bed};
pub use blocks::Estimate;
pub use bootstrap::BlockBootstrap;
pub use chains::{
    Chain, ChainLink, ChainNetwork, ChainOptions, ChainSegment, StressRule, ThresholdCurve,
    ThresholdOptions, ThresholdPoint, WeightRule, chains_by_stress, chains_by_weight,
    threshold_curve,
};
pub use class::{ContactClass, Patch};
pub use coordination::{
    ContactCount, Coordination, CoordinationOptions, Partner, Touch, contact_counts, coordination,
};
pub use core_region::{CoreOptions, CoreRegion, InsetLimit, choose_core};
pub use density::{
    DensityOptions, ExactDensity, GridDensity, PackingDensity, exact_density, grid_density,
    packing_density, volume_inside,
};
pub use error::AnalysisError;
pub use fabric::{ContactFabric, Fabric, contact_fabric};
pub use fields::{FieldOptions, Fields, Tensor, coarse_grained_fields};
pub use forces::{
    ForceBin, ForceDistribution, ForceDistributionOptions, ForceMaxima, TailFit, TailLaw,
    TailOptions, WallForce, WallForces, fit_tail, force_distribution, force_maxima, wall_forces,
};
pub use fragments::{
    BreakageIndex, Fragment, FragmentExtent, FragmentSize, FragmentSizes, Fragmentation,
    FragmentationOptions, SizeFit, SizeFitOptions, SizeLaw, breakage_index, fit_sizes,
    fragmentation, measure_fragments,
};
pub use images::{PeriodicSpace, WithImages};
pub use map::{DensityMap, DensityMapOptions, density_map};
pub use mixing::{ClassMixing, Mixing, MixingOptions, mixing};
pub use network::{ForceBody, ForceContact, ForceNetwork, PairForce};
pub use orientation::{
    BodyAxes, BodyDirection, NetNode, OrderParameter, OrientationOptions, OrientationOrder,
    Stereonet, StereonetOptions, TiltGroup, TiltHistogram, TiltOptions, body_directions,
    distinct_axis, orientation_order, schmidt, stereonet, tilt_histogram, tilts,
};
pub use overlap::{PairOverlap, PairOverlaps, intersection_volume, pair_overlaps};
pub use pack::{Pack, PosedBody};
pub use profile::{
    DensityProfile, ProfileBin, ProfileCoordinate, ProfileOptions, height_profile, wall_profile,
};
pub use radial::{RadialBin, RadialDistribution, RadialOptions, radial_distribution};
pub use region::Region;
pub use sieve::{SieveCurve, SievePoint};
pub use stress::{
    BalanceCut, BodyStress, BodyStresses, RegionStress, Stress, StressProfile, StressSlab,
    VerticalBalance, body_stresses, region_stress, stress_profile, vertical_balance,
};
pub use structure::{
    ClassCount, ContactClasses, Rattlers, SupportRule, contact_classes, mean_coordination, rattlers,
};
pub use surface::{FreeSurface, free_surface};
pub use table::{Cell, Table};
pub use top::{TopPlane, top_plane};
pub use voronoi::{SetVoronoi, SetVoronoiOptions, VoronoiCell, set_voronoi};
