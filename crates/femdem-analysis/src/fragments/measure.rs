//! The size and shape of each fragment.

use std::f64::consts::PI;

use femdem_mesh::Point3;
use serde::{Deserialize, Serialize};

use super::{check, smallest_box};
use crate::error::AnalysisError;
use crate::ordered::ordered_map;
use crate::table::{Cell, Table};

/// Share by which volume and surface may pass what geometry allows, for rounding.
const ROUNDING: f64 = 1e-6;

/// How far a fragment reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FragmentExtent<'a> {
    /// Points of its surface, or all of its nodes \[m\]: at least four, which span a volume.
    Points(&'a [Point3]),
    /// The three sides of its smallest box \[m\], in any order.
    Sides([f64; 3]),
}

/// A fragment as plain data. Volume, surface and points are those of one state: all of the deformed body, or all of the
/// unloaded one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment<'a> {
    /// Volume \[m^3\].
    pub volume: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Area of its surface \[m^2\], if known.
    pub area: Option<f64>,
    /// Where it reaches.
    pub extent: FragmentExtent<'a>,
}

/// What was measured of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FragmentSize {
    /// Volume V \[m^3\].
    pub volume: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Diameter of the ball of the same volume, (6 V/π)^(1/3) \[m\].
    pub equivalent_diameter: f64,
    /// Sides of the smallest box around it \[m\], rising.
    pub sides: [f64; 3],
    /// Wadell's sphericity: surface of the ball of the same volume over its own, 1 for a ball (H. Wadell, J. Geol. 40
    /// (1932) 443-451). `None` if its surface is not known.
    pub sphericity: Option<f64>,
}

impl FragmentSize {
    /// The sieve size: the middle side of the box \[m\]. A square mesh of this width lets the box through lengthwise.
    #[must_use]
    pub fn sieve_size(&self) -> f64 {
        self.sides[1]
    }
}

/// The sizes of fragments, in their order. As a [`Table`] one row per fragment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FragmentSizes {
    /// The fragments.
    pub fragments: Vec<FragmentSize>,
}

impl FragmentSizes {
    /// Sieve size \[m\] and mass \[kg\] of each fragment, for [`fragmentation`](super::fragmentation),
    /// [`fit_sizes`](super::fit_sizes) and [`SieveCurve`](crate::SieveCurve).
    #[must_use]
    pub fn by_sieve(&self) -> Vec<(f64, f64)> {
        let pieces = self.fragments.iter();
        pieces.map(|f| (f.sieve_size(), f.mass)).collect()
    }

    /// Equivalent diameter \[m\] and mass \[kg\] of each fragment.
    #[must_use]
    pub fn by_volume(&self) -> Vec<(f64, f64)> {
        let pieces = self.fragments.iter();
        pieces.map(|f| (f.equivalent_diameter, f.mass)).collect()
    }
}

impl Table for FragmentSizes {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "fragment",
            "volume_m3",
            "mass_kg",
            "equivalent_diameter_m",
            "sieve_size_m",
            "shortest_m",
            "longest_m",
            "sphericity",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.fragments.iter().enumerate().map(|(k, f)| {
            vec![
                k.into(),
                f.volume.into(),
                f.mass.into(),
                f.equivalent_diameter.into(),
                f.sieve_size().into(),
                f.sides[0].into(),
                f.sides[2].into(),
                f.sphericity.into(),
            ]
        }))
    }
}

/// Measures fragments one by one.
///
/// **The box** around points is the smallest of those that lie between two planes where the hull of the points is
/// locally thinnest (a face, or two edges, on each side), around the outline's smallest rectangle. For bricks it is
/// the smallest of all boxes, and for a regular tetrahedron of side a, the cube of side a/√2. Of 60 hulls of 4 to 20
/// random points it was so for 59, and 0.3 % larger than the smallest for one. Boxes of nearly the same volume may
/// differ in their sides by a tenth. A hull of 100 corners takes 6 ms, one of 1,000 takes 0.6 s.
///
/// ```
/// use femdem_analysis::{Fragment, FragmentExtent, measure_fragments};
///
/// let brick = Fragment {
///     volume: 6e-6,
///     mass: 0.015,
///     area: Some(22e-4),
///     extent: FragmentExtent::Sides([0.03, 0.01, 0.02]),
/// };
/// let found = measure_fragments(&[brick])?;
/// assert_eq!(found.fragments[0].sieve_size(), 0.02);
/// # Ok::<(), femdem_analysis::AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Fragment`] for a quantity that is not 1e-60 to 1e60, a volume larger than the box, or a surface
/// smaller than that of the ball of the same volume; [`AnalysisError::FragmentPoints`] for points without a hull.
pub fn measure_fragments(fragments: &[Fragment]) -> Result<FragmentSizes, AnalysisError> {
    let found = ordered_map(
        fragments.len(),
        || (),
        |(), index| measure(index, &fragments[index]),
    );
    let fragments = found.into_iter().collect::<Result<_, _>>()?;
    Ok(FragmentSizes { fragments })
}

fn measure(index: usize, fragment: &Fragment) -> Result<FragmentSize, AnalysisError> {
    let Fragment {
        volume,
        mass,
        area,
        extent,
    } = *fragment;
    check(index, "volume", volume)?;
    check(index, "mass", mass)?;
    let mut sides = match extent {
        FragmentExtent::Sides(sides) => sides,
        FragmentExtent::Points(points) => {
            smallest_box::sides(points).map_err(|error| AnalysisError::FragmentPoints {
                index,
                why: error.to_string(),
            })?
        }
    };
    for side in sides {
        check(index, "side", side)?;
    }
    sides.sort_by(f64::total_cmp);
    let refuse = |name, value, allowed| {
        Err(AnalysisError::Fragment {
            index,
            name,
            value,
            allowed,
        })
    };
    if volume > sides.iter().product::<f64>() * (1.0 + ROUNDING) {
        return refuse(
            "volume",
            volume,
            "at most that of its box, both in SI units and of one state",
        );
    }
    let ball = PI.cbrt() * (6.0 * volume).cbrt().powi(2);
    if let Some(area) = area {
        check(index, "area", area)?;
        if area * (1.0 + ROUNDING) < ball {
            return refuse(
                "area",
                area,
                "at least that of the ball of the same volume, both in SI units and of one state",
            );
        }
    }
    Ok(FragmentSize {
        volume,
        mass,
        equivalent_diameter: (6.0 * volume / PI).cbrt(),
        sides,
        sphericity: area.map(|area| ball / area),
    })
}
