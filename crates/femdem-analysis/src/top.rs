//! The mean top plane of a pack.

use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Deserializer, Serialize};

use crate::axis::Axis;
use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::lines::{convex_span, crossing};
use crate::ordered::ordered_map;
use crate::pack::Pack;
use crate::region::Region;

/// Height of the top of a pack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TopPlane {
    /// Mean over the columns of the highest solid point (m); minus infinity if no column meets a body, written
    /// as null in text formats.
    #[serde(deserialize_with = "read_mean")]
    pub mean: f64,
    /// Standard deviation of the heights (m): how rough or tilted the top is.
    pub deviation: f64,
    /// Columns that meet a body.
    pub columns: usize,
    /// Columns in the container that meet no body; they are left out of the mean.
    pub empty_columns: usize,
}

fn read_mean<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    if from.is_human_readable() {
        Ok(Option::deserialize(from)?.unwrap_or(f64::NEG_INFINITY))
    } else {
        f64::deserialize(from)
    }
}

/// The mean top plane: vertical lines on a square grid of spacing near `spacing` (m) over the
/// container's floor, each giving the height of the highest solid point on it.
///
/// Lines that meet no body, as along a wall, are left out and counted. The container's height has no effect, so
/// that a pack that reaches above it is measured completely.
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::Option`] for a spacing that
/// is not above zero and finite, [`AnalysisError::GridTooFine`].
pub fn top_plane(pack: &Pack, container: &Region, spacing: f64) -> Result<TopPlane, AnalysisError> {
    let all: Vec<f64> = columns(pack, container, spacing)?
        .iter()
        .map(|column| column.height)
        .collect();
    let met: Vec<f64> = all.iter().copied().filter(|h| h.is_finite()).collect();
    let empty_columns = all.len() - met.len();
    if met.is_empty() {
        return Ok(TopPlane {
            mean: f64::NEG_INFINITY,
            deviation: 0.0,
            columns: 0,
            empty_columns,
        });
    }
    let count = met.len() as f64;
    let mean = met.iter().sum::<f64>() / count;
    let deviation = (met.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / count).sqrt();
    Ok(TopPlane {
        mean,
        deviation,
        columns: met.len(),
        empty_columns,
    })
}

/// An upright line over the floor of a container.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    pub x: f64,
    pub y: f64,
    /// Of the highest solid point on it (m); minus infinity if it meets no body.
    pub height: f64,
}

/// The columns over the floor of a container, along x and then along y.
pub(crate) fn columns(
    pack: &Pack,
    container: &Region,
    spacing: f64,
) -> Result<Vec<Column>, AnalysisError> {
    container.validate()?;
    if pack.is_empty() {
        return Err(AnalysisError::EmptyPack);
    }
    if !spacing.is_finite() || spacing <= 0.0 {
        return Err(AnalysisError::Option {
            name: "spacing",
            value: spacing,
            allowed: "above zero and finite (m)",
        });
    }
    let (min, max) = container.corners();
    // One cell in height: only the plan view matters.
    let footprint = Bounds {
        min: Point3::new(min.x, min.y, 0.0),
        max: Point3::new(max.x, max.y, spacing),
    };
    let [x_axis, y_axis, _] = Axis::grid(&footprint, spacing)?;
    let bodies = y_axis.sort_bodies(1, pack);
    let rows = ordered_map(y_axis.count, Vec::new, |planes, j| {
        let heights = row_heights(pack, planes, &x_axis, y_axis.centre(j), &bodies[j]);
        let on_floor = (0..x_axis.count)
            .filter(|&i| container.stands_over(x_axis.centre(i), y_axis.centre(j)));
        let column = |i: usize| Column {
            x: x_axis.centre(i),
            y: y_axis.centre(j),
            height: heights[i],
        };
        on_floor.map(column).collect::<Vec<Column>>()
    });
    Ok(rows.into_iter().flatten().collect())
}

/// Highest solid point over each cell centre of one row; minus infinity where there is none.
fn row_heights(
    pack: &Pack,
    planes: &mut Vec<(Vector3, f64)>,
    x_axis: &Axis,
    y: f64,
    bodies: &[usize],
) -> Vec<f64> {
    let mut heights = vec![f64::NEG_INFINITY; x_axis.count];
    for &body in bodies {
        let bounds = pack.bounds(body);
        let columns = x_axis.within(bounds.min.x, bounds.max.x);
        if pack.by_planes(body) {
            planes.clear();
            planes.extend(pack.world_planes(body));
            for i in columns {
                // A body whose highest point is lower cannot raise the column.
                if heights[i] < bounds.max.z
                    && let Some((_, top)) =
                        convex_span(planes, 2, &Point3::new(x_axis.centre(i), y, 0.0))
                {
                    heights[i] = heights[i].max(top);
                }
            }
        } else {
            pack.triangles_in(body, &Bounds::slab(1, y, y), |triangle| {
                let reach = Bounds::around(triangle);
                for i in x_axis.within(reach.min.x, reach.max.x) {
                    let at = Point3::new(x_axis.centre(i), y, 0.0);
                    if let Some(z) = crossing(&triangle, 2, &at) {
                        heights[i] = heights[i].max(z);
                    }
                }
            });
        }
    }
    heights
}
