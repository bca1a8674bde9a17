//! How far a body has been broken: the size curve, its laws, and the indices t_n.

use serde::{Deserialize, Serialize};

use super::{SizeFit, SizeFitOptions, SizeLaw, check_pieces, check_size, fit_sizes};
use crate::error::AnalysisError;
use crate::sieve::SieveCurve;
use crate::table::{Cell, Table};

/// The part of the mass that passes the n-th part of the parent's size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BreakageIndex {
    /// n, such as 10.
    pub ratio: f64,
    /// t_n, 0 to 1.
    pub share: f64,
}

/// What [`fragmentation`] measures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FragmentationOptions {
    /// Size of the unbroken body \[m\], measured as that of the pieces. Without it there are no indices t_n. Default
    /// none.
    pub parent_size: Option<f64>,
    /// The n of the indices t_n, each at least 1. Default 2, 4, 10, 25, 50, 75.
    pub ratios: Vec<f64>,
    /// How the laws are fitted.
    pub fit: SizeFitOptions,
}

impl Default for FragmentationOptions {
    fn default() -> Self {
        Self {
            parent_size: None,
            ratios: vec![2.0, 4.0, 10.0, 25.0, 50.0, 75.0],
            fit: SizeFitOptions::default(),
        }
    }
}

/// The size distribution of fragments. As a [`Table`] the fitted parameters and the indices, with their intervals; the
/// curve is a table of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fragmentation {
    /// Number of pieces.
    pub pieces: usize,
    /// Their mass \[kg\].
    pub mass: f64,
    /// Size of the unbroken body \[m\], as given.
    pub parent_size: Option<f64>,
    /// Part of the mass that passes each size.
    pub curve: SieveCurve,
    /// The fit of Rosin and Rammler.
    pub rosin_rammler: Option<SizeFit>,
    /// The fit of Gaudin and Schuhmann.
    pub gaudin_schuhmann: Option<SizeFit>,
    /// The indices t_n, in the order of their n as given.
    pub indices: Vec<BreakageIndex>,
}

impl Fragmentation {
    /// t_n for an n that was asked for.
    #[must_use]
    pub fn index(&self, ratio: f64) -> Option<f64> {
        let found = self.indices.iter().find(|index| index.ratio == ratio);
        found.map(|index| index.share)
    }
}

impl Table for Fragmentation {
    fn columns(&self) -> &'static [&'static str] {
        &["quantity", "value", "low", "high"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let plain = |name: String, value: Option<f64>| {
            let blank = Cell::Empty;
            vec![name.into(), value.into(), blank.clone(), blank]
        };
        let fit = |name: &'static str, value: f64, [low, high]: [f64; 2]| {
            vec![name.into(), value.into(), low.into(), high.into()]
        };
        let mut rows = vec![
            plain("pieces".to_owned(), Some(self.pieces as f64)),
            plain("mass_kg".to_owned(), Some(self.mass)),
            plain("parent_size_m".to_owned(), self.parent_size),
        ];
        if let Some(law) = &self.rosin_rammler {
            rows.push(fit("rosin_rammler_n", law.exponent, law.exponent_interval));
            rows.push(fit("rosin_rammler_d63_m", law.size, law.size_interval));
        }
        if let Some(law) = &self.gaudin_schuhmann {
            rows.push(fit(
                "gaudin_schuhmann_m",
                law.exponent,
                law.exponent_interval,
            ));
            rows.push(fit("gaudin_schuhmann_d_max_m", law.size, law.size_interval));
        }
        let indices = self.indices.iter();
        rows.extend(indices.map(|t| plain(format!("t{}", t.ratio), Some(t.share))));
        Box::new(rows.into_iter())
    }
}

/// The index t_n: the part of the mass in pieces not larger than `parent_size`/n, where a piece is a size \[m\] and a
/// mass \[kg\]. t10 is the usual measure of how far an impact breaks a body (S. S. Narayanan and W. J. Whiten, Trans.
/// Inst. Min. Metall. C 97 (1988) 115-124). Sizes that differ by less than a billionth are one.
///
/// For parents of several sizes give each piece by its size over that of its own parent, and 1 as the size of the
/// parent.
///
/// ```
/// use femdem_analysis::breakage_index;
///
/// let pieces = [(0.09, 7.0), (0.02, 2.0), (0.008, 1.0)];
/// assert_eq!(breakage_index(&pieces, 0.1, 10.0)?, 0.1);
/// # Ok::<(), femdem_analysis::AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::NoFragments`]; [`AnalysisError::Fragment`] for a size or mass that is not 1e-60 to 1e60;
/// [`AnalysisError::Option`] for such a size of the parent, or an n below 1.
pub fn breakage_index(
    pieces: &[(f64, f64)],
    parent_size: f64,
    ratio: f64,
) -> Result<f64, AnalysisError> {
    check_size("parent_size", Some(parent_size))?;
    if !(1.0..=1e30).contains(&ratio) {
        return Err(AnalysisError::Option {
            name: "ratio",
            value: ratio,
            allowed: "1 to 1e30",
        });
    }
    check_pieces(pieces)?;
    let mesh = parent_size / ratio * (1.0 + 1e-9);
    let total: f64 = pieces.iter().map(|(_, mass)| mass).sum();
    let passing = pieces.iter().filter(|(size, _)| *size <= mesh);
    Ok(passing.map(|(_, mass)| mass).sum::<f64>() / total)
}

/// Measures the size distribution of pieces, each given by its size \[m\] (see
/// [`FragmentSizes`](super::FragmentSizes)) and its mass \[kg\]: the curve, both laws ([`fit_sizes`]), and the indices
/// t_n ([`breakage_index`]).
///
/// # Errors
/// As [`fit_sizes`] and [`breakage_index`].
pub fn fragmentation(
    pieces: &[(f64, f64)],
    options: &FragmentationOptions,
) -> Result<Fragmentation, AnalysisError> {
    let fit = |law| fit_sizes(pieces, law, &options.fit);
    let rosin_rammler = fit(SizeLaw::RosinRammler)?;
    let gaudin_schuhmann = fit(SizeLaw::GaudinSchuhmann)?;
    let index = |parent: f64, ratio: f64| {
        let share = breakage_index(pieces, parent, ratio)?;
        Ok(BreakageIndex { ratio, share })
    };
    let ratios = options.ratios.iter();
    let indices = match options.parent_size {
        Some(parent) => ratios
            .map(|ratio| index(parent, *ratio))
            .collect::<Result<_, AnalysisError>>()?,
        None => Vec::new(),
    };
    Ok(Fragmentation {
        pieces: pieces.len(),
        mass: pieces.iter().map(|(_, mass)| mass).sum(),
        parent_size: options.parent_size,
        curve: SieveCurve::new(pieces.iter().copied()),
        rosin_rammler,
        gaudin_schuhmann,
        indices,
    })
}
