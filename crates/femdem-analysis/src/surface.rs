//! The slope of the free surface of a pack.

use femdem_mesh::nalgebra::{Matrix3, Vector2};
use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::error::AnalysisError;
use crate::pack::Pack;
use crate::region::Region;
use crate::top::{Column, columns};

/// Part of the half-widths of the footprint, about its middle, over which the plane is fitted: the ends of the surface of
/// a bed in a drum bend.
const MIDDLE: f64 = 0.5;

/// Parts of the radius of a heap between which its slope is fitted: its tip is round, and its foot is single bodies.
const SLOPE: [f64; 2] = [0.2, 0.8];

/// Slopes of the free surface, as a plane (the bed of a drum, an avalanche) and as a cone (a heap).
///
/// Heights are those of the highest solid point on upright lines, as of the [top](crate::top_plane). The plane is the least
/// squares fit over the middle half of the footprint, along x and along y. The cone stands about the mean place of the lines, each
/// weighted with its height h above the floor of the container, or above the lowest point of all bodies. Its radius R follows from the same mean of r²,
/// which is 3 R²/10 for a cone; its slope is the least squares fit of h over r between 0.2 R and 0.8 R.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FreeSurface {
    /// Angle of the plane with the horizontal (degrees).
    pub plane_angle: f64,
    /// Standard error of that angle (degrees), from the scatter of the heights about the plane, of which those within a mean
    /// diameter squared count as one.
    pub plane_error: f64,
    /// Direction in which the plane rises (degrees from x towards y).
    pub plane_direction: f64,
    /// Angle of the cone's side with the horizontal (degrees), positive for a heap.
    pub cone_angle: f64,
    /// Axis of the cone (m).
    pub cone_centre: [f64; 2],
    /// Radius R of the cone (m).
    pub cone_radius: f64,
    /// Lines that meet a body.
    pub columns: usize,
}

/// Measures the free surface over the floor of `container`, or over the box around all bodies; `spacing_over_d` is the distance of
/// the lines in mean diameters. `None` if too few lines meet a body to fit a slope.
///
/// ```
/// use femdem_analysis::{Pack, PosedBody, free_surface};
/// use femdem_mesh::{Pose, Rotation, catalogue::CatalogueShape, nalgebra::Vector3};
///
/// // A cube of 1 m, leaning by 10 degrees.
/// let cube = ["P5".parse::<CatalogueShape>()?.polyhedron(3_f64.sqrt())?];
/// let turn = Rotation::from_axis_angle(&Vector3::y_axis(), -10_f64.to_radians());
/// let bodies = [PosedBody { shape: 0, pose: Pose::from_parts(Default::default(), turn) }];
/// let surface = free_surface(&Pack::new(&cube, &bodies)?, None, 0.02)?.ok_or("no surface")?;
/// assert!((surface.plane_angle - 10.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`AnalysisError::EmptyPack`], [`AnalysisError::Region`], [`AnalysisError::Option`] for the spacing,
/// [`AnalysisError::GridTooFine`].
pub fn free_surface(
    pack: &Pack,
    container: Option<&Region>,
    spacing_over_d: f64,
) -> Result<Option<FreeSurface>, AnalysisError> {
    let diameter = pack.mean_diameter()?;
    let (mut low, mut high) = (
        Point3::from([f64::INFINITY; 3]),
        Point3::from([-f64::INFINITY; 3]),
    );
    for body in 0..pack.len() {
        let bounds = pack.bounds(body);
        low = low.inf(&bounds.min);
        high = high.sup(&bounds.max);
    }
    let around = Region::Box {
        min: low,
        max: high,
    };
    let all = columns(
        pack,
        container.unwrap_or(&around),
        spacing_over_d * diameter,
    )?;
    let met: Vec<Column> = all.into_iter().filter(|c| c.height.is_finite()).collect();
    // Lines that meet the same body tell the same height.
    let alike = (1.0 / spacing_over_d).powi(2).max(1.0);
    let Some(Plane {
        plane_angle,
        plane_error,
        plane_direction,
    }) = plane(&met, alike)
    else {
        return Ok(None);
    };
    let floor = container.map_or(low.z, |region| region.corners().0.z);
    let Some((cone_centre, cone_radius, cone_angle)) = cone(&met, floor) else {
        return Ok(None);
    };
    Ok(Some(FreeSurface {
        plane_angle,
        plane_error,
        plane_direction,
        cone_angle,
        cone_centre,
        cone_radius,
        columns: met.len(),
    }))
}

/// Angle, its error and direction of the plane, degrees.
struct Plane {
    plane_angle: f64,
    plane_error: f64,
    plane_direction: f64,
}

/// Fits the plane; so many columns are `alike`.
fn plane(columns: &[Column], alike: f64) -> Option<Plane> {
    let span = |of: fn(&Column) -> f64| {
        let list = columns.iter().map(of);
        let least = list.clone().fold(f64::INFINITY, f64::min);
        let most = list.fold(f64::NEG_INFINITY, f64::max);
        (0.5 * (least + most), 0.5 * MIDDLE * (most - least))
    };
    let (x, y) = (span(|c| c.x), span(|c| c.y));
    let middle = columns.iter().filter(|c| {
        let within = |at: f64, (centre, reach): (f64, f64)| (at - centre).abs() <= reach;
        within(c.x, x) && within(c.y, y)
    });
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let row = |column: &Column| Vector3::new(1.0, column.x - x.0, column.y - y.0);
    for column in middle.clone() {
        let row = row(column);
        matrix += row * row.transpose();
        right += row * column.height;
    }
    let inverse = matrix.try_inverse()?;
    let fit = inverse * right;
    let slope = Vector2::new(fit.y, fit.z);
    let direction = slope.y.atan2(slope.x);
    // The variance of the slope along its direction u is s² uᵀ (XᵀX)⁻¹ u with s² = Σ (h - fit)²/(n/m - 3) of n lines, m of them
    // alike, and that of the angle arctan |slope| smaller by (1 + slope²)².
    let squares = middle
        .clone()
        .map(|c| (c.height - row(c).dot(&fit)).powi(2));
    let degrees_of_freedom = (middle.count() as f64 / alike - 3.0).max(1.0);
    let along = Vector3::new(0.0, direction.cos(), direction.sin());
    let variance = squares.sum::<f64>() / degrees_of_freedom * along.dot(&(inverse * along));
    let error = variance.max(0.0).sqrt() / (1.0 + slope.norm_squared());
    Some(Plane {
        plane_angle: slope.norm().atan().to_degrees(),
        plane_error: error.to_degrees(),
        plane_direction: direction.to_degrees(),
    })
}

/// Centre, radius and angle (degrees) of the cone above a height.
fn cone(columns: &[Column], floor: f64) -> Option<([f64; 2], f64, f64)> {
    let weight = |c: &Column| c.height - floor;
    let total: f64 = columns.iter().map(weight).sum();
    let mean = |of: &dyn Fn(&Column) -> f64| {
        columns.iter().map(|c| weight(c) * of(c)).sum::<f64>() / total
    };
    let centre = [mean(&|c| c.x), mean(&|c| c.y)];
    let distance = |c: &Column| (c.x - centre[0]).hypot(c.y - centre[1]);
    let radius = (mean(&|c| distance(c).powi(2)) / 0.3).sqrt();
    let side = columns
        .iter()
        .map(|c| (distance(c), c.height))
        .filter(|(r, _)| (SLOPE[0] * radius..=SLOPE[1] * radius).contains(r));
    let (mut n, mut sums) = (0.0, [0.0; 4]);
    for (r, h) in side {
        n += 1.0;
        for (sum, term) in sums.iter_mut().zip([r, h, r * r, r * h]) {
            *sum += term;
        }
    }
    let [r, h, rr, rh] = sums;
    let spread = n * rr - r * r;
    (spread > 0.0).then(|| {
        let slope = (n * rh - r * h) / spread;
        (centre, radius, (-slope).atan().to_degrees())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PosedBody;
    use femdem_mesh::Pose;
    use femdem_mesh::catalogue::CatalogueShape;

    /// Small cubes on a square grid whose tops are at the heights of a function.
    fn surface(height: impl Fn(f64, f64) -> f64) -> FreeSurface {
        let cube = ["P5"
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(0.1 * 3_f64.sqrt())
            .unwrap()];
        let mut bodies = Vec::new();
        for i in -30..=30 {
            for j in -30..=30 {
                let (x, y) = (0.1 * f64::from(i), 0.1 * f64::from(j));
                let z = height(x, y);
                // The lowest stand on a floor at 0.
                if z > 0.1 {
                    let pose = Pose::translation(x + 5.0, y - 2.0, z - 0.05);
                    bodies.push(PosedBody { shape: 0, pose });
                }
            }
        }
        let pack = Pack::new(&cube, &bodies).unwrap();
        free_surface(&pack, None, 0.25).unwrap().unwrap()
    }

    #[test]
    fn a_leaning_bed_has_the_angle_of_its_plane() {
        for (dx, dy) in [(0.4, 0.0), (-0.2, 0.3), (0.0, -0.05)] {
            let found = surface(|x, y| 2.0 + dx * x + dy * y);
            let want = f64::hypot(dx, dy).atan().to_degrees();
            assert!((found.plane_angle - want).abs() < 0.4, "{found:?} {want}");
            let direction = f64::atan2(dy, dx).to_degrees();
            assert!((found.plane_direction - direction).abs() < 1.0, "{found:?}");
        }
    }

    /// Rows of cubes that lie alternately a little above and below a plane.
    #[test]
    fn the_error_of_the_angle_is_that_of_the_scatter() {
        let scattered = |by: f64| {
            let sign = |x: f64| {
                if (10.0 * x).round() as i64 % 2 == 0 {
                    by
                } else {
                    -by
                }
            };
            surface(|x, y| 2.0 + 0.3 * y + sign(x))
        };
        let (smooth, rough, rougher) = (scattered(0.0), scattered(0.05), scattered(0.1));
        assert!(
            smooth.plane_error < 0.3 * rough.plane_error,
            "{smooth:?} {rough:?}"
        );
        let ratio = rougher.plane_error / rough.plane_error;
        assert!((1.7..2.1).contains(&ratio), "{ratio}");
        // s/(√n Δ (1 + 0.3²)) with s = 0.05 m, n = (3 m/d)² and Δ = 3 m/√12: 0.176 degrees.
        assert!((0.15..0.21).contains(&rough.plane_error), "{rough:?}");
    }

    #[test]
    fn a_heap_has_the_angle_of_its_cone() {
        for slope in [0.4, 0.6, 0.9] {
            let found = surface(|x, y| slope * (2.5 - x.hypot(y)));
            let want = slope.atan().to_degrees();
            assert!((found.cone_angle - want).abs() < 0.5, "{found:?} {want}");
            assert!((found.cone_radius - 2.5).abs() < 0.15, "{found:?}");
            let [x, y] = found.cone_centre;
            assert!(
                (x - 5.0).abs() < 1e-9 && (y + 2.0).abs() < 1e-9,
                "{found:?}"
            );
            assert!(found.plane_angle < 2.0, "{found:?}");
        }
    }
}
