//! Coordination numbers: how many partners a body touches.

use serde::{Deserialize, Serialize};

use crate::error::{AnalysisError, check_threshold};
use crate::table::{Cell, Table};

/// What a body touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Partner {
    /// Another body, by index.
    Body(u32),
    /// A wall, by any number that tells walls apart.
    Wall(u32),
}

/// A contact between a body and its partner. A pair may be listed more than once and either way round.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// Index of the body.
    pub first: u32,
    /// What it touches.
    pub second: Partner,
    /// Normal force (N), positive when it pushes the two apart.
    pub normal_force: f64,
}

/// How [`coordination`] counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinationOptions<'a> {
    /// A pair counts when the sum of its normal forces, pressing or pulling, is larger than this (N); 0 or more. Default 0.
    pub force_threshold: f64,
    /// The bodies to average over, for instance those of
    /// [`Pack::bodies_in`](crate::Pack::bodies_in); repeats count once. `None`: all.
    pub among: Option<&'a [u32]>,
}

/// How many partners one body touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ContactCount {
    /// Bodies touched.
    pub bodies: u32,
    /// Walls touched.
    pub walls: u32,
}

impl ContactCount {
    /// Bodies and walls.
    pub fn total(&self) -> u32 {
        self.bodies.saturating_add(self.walls)
    }
}

/// Coordination number of a pack: partners per body, one for each touching pair whatever the number of
/// contacts between the two, and one for each wall, as the founding paper (Xiang, Latham and Farsi
/// 2016) counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coordination {
    /// Mean number of partners, walls included.
    pub mean: f64,
    /// Sample standard deviation of the number of partners over the bodies; 0 for a single body.
    pub sd: f64,
    /// Entry `k`: number of bodies with `k` partners, walls included.
    pub histogram: Vec<u64>,
    /// Mean number of bodies touched, walls left out.
    pub mean_without_walls: f64,
    /// Body-wall pairs of the bodies averaged over.
    pub wall_contacts: u64,
    /// Number of bodies averaged over.
    pub bodies: usize,
    /// Force above which a pair counts (N).
    pub force_threshold: f64,
}

/// Partners of each of `bodies` bodies whose summed normal force, pressing or pulling, is larger than `force_threshold` (N).
///
/// # Errors
/// [`AnalysisError::TooManyBodies`], [`AnalysisError::BodyIndex`], [`AnalysisError::SelfTouch`],
/// [`AnalysisError::TouchForce`], and [`AnalysisError::Option`] for a threshold that is below zero or not finite.
pub fn contact_counts(
    bodies: usize,
    touches: &[Touch],
    force_threshold: f64,
) -> Result<Vec<ContactCount>, AnalysisError> {
    if u32::try_from(bodies).is_err() {
        return Err(AnalysisError::TooManyBodies { bodies });
    }
    check_threshold(force_threshold)?;
    let mut pairs = Vec::with_capacity(touches.len());
    for (index, touch) in touches.iter().enumerate() {
        check(index, touch, bodies)?;
        // Body pairs in one order, so that both ways round are one pair.
        pairs.push(match touch.second {
            Partner::Body(j) if j < touch.first => {
                (j, Partner::Body(touch.first), touch.normal_force)
            }
            second => (touch.first, second, touch.normal_force),
        });
    }
    // A stable sort, so that the forces of a pair are summed in the order given.
    pairs.sort_by_key(|(first, second, _)| (*first, *second));
    let mut counts = vec![ContactCount::default(); bodies];
    for pair in pairs.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (first, second, _) = pair[0];
        let force: f64 = pair.iter().map(|(_, _, force)| force).sum();
        if !is_touching(force, force_threshold) {
            continue;
        }
        match second {
            Partner::Body(j) => {
                counts[first as usize].bodies += 1;
                counts[j as usize].bodies += 1;
            }
            Partner::Wall(_) => counts[first as usize].walls += 1,
        }
    }
    Ok(counts)
}

/// Whether a pair of this summed normal force (N) touches: one that is held by attraction pulls.
pub(crate) fn is_touching(normal_force: f64, force_threshold: f64) -> bool {
    normal_force.abs() > force_threshold
}

fn check(index: usize, touch: &Touch, bodies: usize) -> Result<(), AnalysisError> {
    let known = |body: u32| {
        let inside = (body as usize) < bodies;
        inside.then_some(()).ok_or(AnalysisError::BodyIndex {
            what: "touch",
            index,
            body,
            bodies,
        })
    };
    known(touch.first)?;
    if let Partner::Body(other) = touch.second {
        known(other)?;
        if other == touch.first {
            return Err(AnalysisError::SelfTouch { index, body: other });
        }
    }
    if !touch.normal_force.is_finite() {
        return Err(AnalysisError::TouchForce {
            index,
            force: touch.normal_force,
        });
    }
    Ok(())
}

/// Coordination number of `bodies` bodies from their touches.
///
/// ```
/// use femdem_analysis::{CoordinationOptions, Partner, Touch, coordination};
///
/// // A stack of two on a floor; the two meet at two points.
/// let touch = |first, second| Touch { first, second, normal_force: 1.0 };
/// let touches = [touch(0, Partner::Wall(0)), touch(0, Partner::Body(1)), touch(1, Partner::Body(0))];
/// let result = coordination(2, &touches, &CoordinationOptions::default())?;
/// assert_eq!(result.mean, 1.5);
/// assert_eq!(result.histogram, [0, 1, 1]);
/// assert_eq!(result.mean_without_walls, 1.0);
/// # Ok::<(), femdem_analysis::AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`] when there is no body to average over, and those of
/// [`contact_counts`].
pub fn coordination(
    bodies: usize,
    touches: &[Touch],
    options: &CoordinationOptions,
) -> Result<Coordination, AnalysisError> {
    let counts = contact_counts(bodies, touches, options.force_threshold)?;
    let selected = match options.among {
        None => counts,
        Some(among) => select(&counts, among)?,
    };
    if selected.is_empty() {
        return Err(AnalysisError::EmptyPack);
    }
    let number = selected.len() as f64;
    let sum = |of: fn(&ContactCount) -> u32| selected.iter().map(|c| u64::from(of(c))).sum::<u64>();
    let mean = sum(ContactCount::total) as f64 / number;
    let squares: f64 = selected
        .iter()
        .map(|c| (f64::from(c.total()) - mean).powi(2))
        .sum();
    let most = selected.iter().map(ContactCount::total).max().unwrap_or(0);
    let mut histogram = vec![0; most as usize + 1];
    for count in &selected {
        histogram[count.total() as usize] += 1;
    }
    Ok(Coordination {
        mean,
        sd: (squares / (number - 1.0).max(1.0)).sqrt(),
        histogram,
        mean_without_walls: sum(|c| c.bodies) as f64 / number,
        wall_contacts: sum(|c| c.walls),
        bodies: selected.len(),
        force_threshold: options.force_threshold,
    })
}

impl Table for Coordination {
    fn columns(&self) -> &'static [&'static str] {
        &["partners", "bodies"]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        let rows = (0_u32..).zip(&self.histogram);
        Box::new(rows.map(|(partners, bodies)| vec![partners.into(), (*bodies).into()]))
    }
}

fn select(counts: &[ContactCount], among: &[u32]) -> Result<Vec<ContactCount>, AnalysisError> {
    for (index, &body) in among.iter().enumerate() {
        if body as usize >= counts.len() {
            return Err(AnalysisError::BodyIndex {
                what: "selection entry",
                index,
                body,
                bodies: counts.len(),
            });
        }
    }
    let mut wanted = among.to_vec();
    wanted.sort_unstable();
    wanted.dedup();
    Ok(wanted.into_iter().map(|i| counts[i as usize]).collect())
}
