//! How well classes of bodies are mixed.

use serde::{Deserialize, Serialize};

use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::table::{Cell, Table};

/// How [`mixing`] measures.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MixingOptions {
    /// Side of a cell over the mean diameter; above 0. Default 3, about twenty bodies. It is changed so that a whole
    /// number of cells fits.
    pub cell_over_d: f64,
}

impl Default for MixingOptions {
    fn default() -> Self {
        Self { cell_over_d: 3.0 }
    }
}

/// Mixing of one class with the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClassMixing {
    /// Name of the class.
    pub class: String,
    /// Bodies of the class.
    pub bodies: u32,
    /// Their share of all bodies.
    pub share: f64,
    /// Lacey's index of this class against all others; `None` for a single class, a single cell, or less than two
    /// bodies per cell.
    pub lacey_index: Option<f64>,
    /// Mean height of the centroids (m).
    pub mean_height: f64,
    /// The same less that of all other bodies (m): positive for a class that has risen. `None` for a single class.
    pub height_difference: Option<f64>,
    /// Standard deviation of that difference (m) if the classes were drawn at random.
    pub height_difference_random: Option<f64>,
}

/// How well classes are mixed. As a [`Table`] one row per class.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mixing {
    /// Sides of a cell along x, y, z (m).
    pub cell: [f64; 3],
    /// Cells that hold the centroid of a body.
    pub cells: usize,
    /// Mean number of bodies in them.
    pub bodies_per_cell: f64,
    /// Mean circumscribed diameter d (m).
    pub diameter: f64,
    /// Lacey's index of all classes together.
    pub lacey_index: Option<f64>,
    /// The classes.
    pub classes: Vec<ClassMixing>,
}

/// Mixing of classes of bodies: `class_of` gives for each body the index of its class in `names`.
///
/// **Lacey's index** (P. M. C. Lacey, J. Appl. Chem. 4, 257, 1954) is (σ₀² − σ²)/(σ₀² − σ_r²): 0 when the classes are
/// apart, 1 when they are mixed at random. The box around the centroids is divided into cells; σ² is the variance of
/// a class's share p of the bodies of a cell, each cell weighted by its bodies; σ₀² = p(1 − p) with the share in the
/// whole; and σ_r² = p(1 − p)(K − 1)/(N − 1) is exactly what random labels give on average for N bodies in K cells.
/// The index of all classes uses the sums of these variances. It depends on the size of the cells, and single
/// packs scatter about 1, also above it.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Pose, catalogue::CatalogueShape};
///
/// // Two classes, one above the other.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let at = |i: i32| Pose::translation(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16));
/// let bodies: Vec<_> = (0..64).map(|i| PosedBody { shape: 0, pose: at(i) }).collect();
/// let class_of: Vec<u32> = (0..64).map(|i| i / 32).collect();
/// let names = ["low".to_owned(), "high".to_owned()];
/// let options = MixingOptions { cell_over_d: 1.0 };
/// let found = mixing(&Pack::new(&cube, &bodies)?, &class_of, &names, &options)?;
/// assert_eq!(found.classes[1].height_difference, Some(2.0));
/// assert_eq!(found.lacey_index, Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::BodyList`] for a list of another length, [`AnalysisError::Option`] for
/// a cell or a class out of its range, [`AnalysisError::GridTooFine`].
pub fn mixing(
    pack: &Pack,
    class_of: &[u32],
    names: &[String],
    options: &MixingOptions,
) -> Result<Mixing, AnalysisError> {
    let diameter = pack.mean_diameter()?;
    let side = options.cell_over_d * diameter;
    if !(side > 0.0 && side.is_finite()) {
        return Err(AnalysisError::Option {
            name: "cell_over_d",
            value: options.cell_over_d,
            allowed: "above zero and finite",
        });
    }
    if class_of.len() != pack.len() {
        return Err(AnalysisError::BodyList {
            name: "classes",
            given: class_of.len(),
            bodies: pack.len(),
        });
    }
    if let Some(class) = class_of
        .iter()
        .find(|class| **class as usize >= names.len())
    {
        return Err(AnalysisError::Option {
            name: "class_of",
            value: f64::from(*class),
            allowed: "the index of a name",
        });
    }
    let centroids = pack.centroids();
    let bounds = Bounds::around(centroids.iter().copied());
    let axes = Axis::grid(&bounds, side)?;
    let index = |k: usize, x: f64| {
        // All in one plane: the step is 0, and the quotient NaN, which converts to 0.
        let i = ((x - bounds.min[k]) / axes[k].step) as usize;
        i.min(axes[k].count - 1)
    };
    let mut members: Vec<([usize; 3], u32)> = centroids
        .iter()
        .zip(class_of)
        .map(|(p, class)| ([2, 1, 0].map(|k| index(k, p[k])), *class))
        .collect();
    members.sort_unstable();
    // For each cell its bodies by class.
    let cells: Vec<Vec<u32>> = members
        .chunk_by(|a, b| a.0 == b.0)
        .map(|cell| {
            let mut counts = vec![0; names.len()];
            cell.iter()
                .for_each(|(_, class)| counts[*class as usize] += 1);
            counts
        })
        .collect();
    let count = pack.len() as f64;
    let random = (cells.len() as f64 - 1.0) / (count - 1.0);
    let variances: Vec<[f64; 2]> = (0..names.len())
        .map(|class| variances(&cells, class, count))
        .collect();
    let lacey = |[apart, found]: [f64; 2]| {
        let known = apart > 0.0 && cells.len() > 1 && random <= 0.5;
        known.then(|| (1.0 - found / apart) / (1.0 - random))
    };
    let classes = names.iter().enumerate().map(|(class, name)| {
        let heights = centroids.iter().map(|p| p.z).zip(class_of);
        let of_class = |own: bool| {
            let some = heights
                .clone()
                .filter(move |(_, c)| (**c as usize == class) == own);
            some.fold((0.0, 0_u32), |(sum, n), (z, _)| (sum + z, n + 1))
        };
        let ((own, bodies), (others, rest)) = (of_class(true), of_class(false));
        let mean_height = own / f64::from(bodies);
        let both = bodies > 0 && rest > 0;
        ClassMixing {
            class: name.clone(),
            bodies,
            share: f64::from(bodies) / count,
            lacey_index: lacey(variances[class]),
            mean_height,
            height_difference: both.then(|| mean_height - others / f64::from(rest)),
            height_difference_random: both.then(|| {
                let mean = (own + others) / count;
                let square: f64 = centroids.iter().map(|p| (p.z - mean).powi(2)).sum();
                let parts = 1.0 / f64::from(bodies) + 1.0 / f64::from(rest);
                (square / (count - 1.0) * parts).sqrt()
            }),
        }
    });
    Ok(Mixing {
        cell: axes.map(|axis| axis.step),
        cells: cells.len(),
        bodies_per_cell: count / cells.len() as f64,
        diameter,
        lacey_index: lacey(
            variances
                .iter()
                .fold([0.0; 2], |sum, v| [sum[0] + v[0], sum[1] + v[1]]),
        ),
        classes: classes.filter(|class| class.bodies > 0).collect(),
    })
}

/// Variance of a class's share in cells when the classes are apart, and as it is.
fn variances(cells: &[Vec<u32>], class: usize, count: f64) -> [f64; 2] {
    let own: u32 = cells.iter().map(|cell| cell[class]).sum();
    let share = f64::from(own) / count;
    let squares = cells.iter().map(|cell| {
        let all = f64::from(cell.iter().sum::<u32>());
        all * (f64::from(cell[class]) / all - share).powi(2)
    });
    [share * (1.0 - share), squares.sum::<f64>() / count]
}

impl Table for Mixing {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "class",
            "bodies",
            "share",
            "lacey_index",
            "mean_height_m",
            "height_difference_m",
            "height_difference_over_d",
            "height_difference_random_m",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.classes.iter().map(|class| {
            vec![
                class.class.clone().into(),
                class.bodies.into(),
                class.share.into(),
                class.lacey_index.into(),
                class.mean_height.into(),
                class.height_difference.into(),
                class.height_difference.map(|h| h / self.diameter).into(),
                class.height_difference_random.into(),
            ]
        }))
    }
}
