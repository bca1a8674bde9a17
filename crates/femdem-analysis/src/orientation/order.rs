//! Nematic and cubatic order, with what random orientations give.

use std::f64::consts::TAU;

use femdem_mesh::nalgebra::Quaternion;
use femdem_mesh::{Matrix3, Point3, Rotation, Vector3};
use serde::{Deserialize, Serialize};

use super::quartic::{Moments, p4};
use super::{BodyAxes, axes_of_shapes, selected};
use crate::blocks::Blocks;
use crate::bootstrap::{BlockBootstrap, MOST_DRAWS, SplitMix64, check_draws};
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::fabric::Fabric;
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::tensor::principal;

/// Most bodies in one random pack; larger packs are scaled from it.
const MOST_BODIES: usize = 500;

/// How [`orientation_order`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct OrientationOptions {
    /// Number of packs of randomly turned bodies for the baseline, 2 to 1e6. Default 200.
    pub random_packs: u32,
    /// How the errors are drawn, and the seed of the random packs.
    pub bootstrap: BlockBootstrap,
}

impl Default for OrientationOptions {
    fn default() -> Self {
        Self {
            random_packs: 200,
            bootstrap: BlockBootstrap::default(),
        }
    }
}

/// An order parameter beside what chance makes of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrderParameter {
    /// Its value.
    pub value: f64,
    /// The direction that it is largest about, a unit vector.
    pub director: [f64; 3],
    /// Standard error by block bootstrap with the director held; `None` with fewer than four blocks.
    pub standard_error: Option<f64>,
    /// Mean value for as many bodies turned at random: it is not zero, since the director is chosen.
    pub random_mean: f64,
    /// Standard deviation of that value from pack to pack.
    pub random_deviation: f64,
}

/// Order of the axes of a pack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct OrientationOrder {
    /// Number of bodies.
    pub bodies: usize,
    /// Number of axes.
    pub axes: usize,
    /// Nematic order: largest eigenvalue of the mean of `(3 u uᵀ - 1)/2`, 1 when all axes are parallel, 0 at
    /// random in a large pack, at least 0.
    pub nematic: OrderParameter,
    /// Cubatic order: largest mean over directions n of `P4(u · n)`, times 12/7, so that bodies with three axes at right
    /// angles give 1 when all are aligned (Batten, Stillinger and Torquato, Phys. Rev. E 81, 061105, 2010). Single
    /// parallel axes give 12/7.
    pub cubatic: OrderParameter,
    /// Second moment of the axes: mean of `u uᵀ`, its principal values and directions.
    pub fabric: Fabric,
}

/// Order of the axes of bodies: of those listed in `among`, or of all.
///
/// The baseline comes from packs of the same bodies (500 of them at most), each body turned at random with all its
/// axes together, scaled as `1/√N` to the number of bodies. Sets of axes of high symmetry have no order to show: all
/// face normals of a cube no nematic, those of a dodecahedron neither; choose a fixed axis, or look at the stereonet.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Pose, catalogue::CatalogueShape};
///
/// // Aligned cubes have perfect cubatic and no nematic order.
/// let shapes = ["P5".parse::<CatalogueShape>()?.polyhedron(1.0)?];
/// let at = |i: i32| PosedBody { shape: 0, pose: Pose::translation(f64::from(i), 0.0, 0.0) };
/// let bodies: Vec<PosedBody> = (0..40).map(at).collect();
/// let axes = BodyAxes::FaceNormals { sides: None };
/// let order = orientation_order(&Pack::new(&shapes, &bodies)?, &axes, None, &Default::default())?;
/// assert!((order.cubatic.value - 1.0).abs() < 1e-9 && order.nematic.value < 1e-9);
/// assert!(order.cubatic.random_mean < 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::NoDirections`], [`AnalysisError::Direction`],
/// [`AnalysisError::BodyIndex`], [`AnalysisError::Option`].
pub fn orientation_order(
    pack: &Pack,
    axes: &BodyAxes,
    among: Option<&[u32]>,
    options: &OrientationOptions,
) -> Result<OrientationOrder, AnalysisError> {
    options.bootstrap.validate()?;
    check_draws(
        "random_packs",
        options.random_packs,
        2..=MOST_DRAWS,
        "2 to 1e6",
    )?;
    let diameter = pack.mean_diameter()?;
    let of_shapes = axes_of_shapes(pack, axes)?;
    let of_body = |body: u32| of_shapes[pack.bodies()[body as usize].shape as usize].as_slice();
    let bodies: Vec<u32> = selected(pack, among)?
        .into_iter()
        .filter(|&body| !of_body(body).is_empty())
        .collect();
    if bodies.is_empty() {
        return Err(AnalysisError::NoDirections);
    }
    let in_world = |body: u32| {
        let turn = pack.pose(body as usize).rotation;
        of_body(body).iter().map(move |axis| turn * axis)
    };
    let all = || bodies.iter().flat_map(|&b| in_world(b));
    let mut moments = Moments::default();
    all().for_each(|axis| moments.add(&axis));
    let found = Order::of(&moments);

    let places: Vec<Point3> = bodies.iter().map(|&b| pack.centroid(b as usize)).collect();
    let blocks = Blocks::cut(
        &Bounds::around(places.iter().copied()),
        diameter,
        options.bootstrap,
    );
    let error = |measure: &dyn Fn(&Vector3) -> f64| {
        let item = |(&body, &place): (&u32, &Point3)| {
            let sum: f64 = in_world(body).map(|axis| measure(&axis)).sum();
            (place, sum, of_body(body).len() as f64)
        };
        blocks.ratio(bodies.iter().zip(&places).map(item)).1
    };
    let [nematic, cubatic] = baseline(&bodies, &of_body, options);
    let parameter = |(value, director): (f64, Vector3), error, random: [f64; 2]| OrderParameter {
        value,
        director: director.into(),
        standard_error: error,
        random_mean: random[0],
        random_deviation: random[1],
    };
    Ok(OrientationOrder {
        bodies: bodies.len(),
        axes: all().count(),
        nematic: parameter(
            found.nematic,
            error(&|u| 1.5 * u.dot(&found.nematic.1).powi(2) - 0.5),
            nematic,
        ),
        cubatic: parameter(
            found.cubatic,
            error(&|u| 12.0 / 7.0 * p4(u.dot(&found.cubatic.1))),
            cubatic,
        ),
        fabric: Fabric::of(all().map(|axis| (axis, 1.0))),
    })
}

/// Values of the order parameters, each with its director.
struct Order {
    nematic: (f64, Vector3),
    cubatic: (f64, Vector3),
}

impl Order {
    fn of(moments: &Moments) -> Self {
        let q = moments.mean_square() * 1.5 - Matrix3::identity() * 0.5;
        let (values, directions) = principal(&q);
        let (director, p4) = moments.largest_p4();
        Self {
            nematic: (values[0], directions[0]),
            cubatic: (12.0 / 7.0 * p4, director),
        }
    }
}

/// Mean and standard deviation of nematic and cubatic order over packs of randomly turned bodies.
fn baseline<'a>(
    bodies: &[u32],
    of_body: &(impl Fn(u32) -> &'a [Vector3] + Sync),
    options: &OrientationOptions,
) -> [[f64; 2]; 2] {
    let sample = bodies.len().min(MOST_BODIES);
    // Bodies from all parts of the list, so that shapes are met as often as in the pack.
    let chosen: Vec<u32> = (0..sample)
        .map(|i| bodies[i * bodies.len() / sample])
        .collect();
    let packs = options.random_packs as usize;
    let found = ordered_map(
        packs,
        || (),
        |(), pack| {
            let mut seeds = SplitMix64 {
                state: options.bootstrap.seed ^ (pack as u64).wrapping_mul(0xD134_2543_DE82_EF95),
            };
            let mut stream = SplitMix64 {
                state: seeds.next(),
            };
            let mut moments = Moments::default();
            for &body in &chosen {
                let turn = random_rotation(&mut stream);
                of_body(body)
                    .iter()
                    .for_each(|axis| moments.add(&(turn * axis)));
            }
            let order = Order::of(&moments);
            [order.nematic.0, order.cubatic.0]
        },
    );
    let scale = (sample as f64 / bodies.len() as f64).sqrt();
    [0, 1].map(|k| {
        let mean = found.iter().map(|f| f[k]).sum::<f64>() / packs as f64;
        let squares: f64 = found.iter().map(|f| (f[k] - mean).powi(2)).sum();
        [mean, (squares / (packs - 1) as f64).sqrt()].map(|x| x * scale)
    })
}

/// A uniform rotation, after Shoemake (Graphics Gems III, 1992).
fn random_rotation(stream: &mut SplitMix64) -> Rotation {
    let mut uniform = || (stream.next() >> 11) as f64 / (1_u64 << 53) as f64;
    let (share, first, second) = (uniform(), TAU * uniform(), TAU * uniform());
    let (a, b) = ((1.0 - share).sqrt(), share.sqrt());
    Rotation::new_normalize(Quaternion::new(
        a * first.sin(),
        a * first.cos(),
        b * second.sin(),
        b * second.cos(),
    ))
}
