//! What bodies can be coloured by: one number for each body, in pictures and in the report.

use femdem_analysis::{BodyAxes, SetVoronoi};
use femdem_mesh::{Polyhedron, Pose, Vector3};
use serde::{Deserialize, Serialize};

use crate::tables::{SAME_SIZE, telling_axes};
use crate::ticks::{decades, even, to_the_last};
use crate::{Body, Snapshot, ViewError};

/// A quantity that each body has one value of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Colouring {
    /// Number in the order of placement; bodies placed together share one. If all are, the number of the body.
    #[default]
    Sequence,
    /// Number of bodies and walls that touch the body.
    Coordination,
    /// Sum of the normal forces on the body.
    Force,
    /// Volume of the body over the volume of its Set-Voronoi cell.
    Density,
    /// Angle between the body's axis, or its nearest face normal, and the vertical.
    Orientation,
    /// Number of the body's shape.
    Shape,
    /// Circumscribed diameter of the body.
    Size,
}

/// How values go to a scale of colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Evenly.
    Linear,
    /// By the logarithm; values that are not positive have the lowest colour.
    Log,
    /// Whole numbers, one colour each.
    Whole,
}

/// One value for each body, and the range of the colour scale.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyValues {
    /// Name of the quantity, with its unit, such as "force sum / N".
    pub title: String,
    /// What the quantity is, in a sentence.
    pub note: String,
    /// By body; NaN where a body has no value.
    pub values: Vec<f64>,
    /// Ends of the colour scale. Values beyond them have the colours of the ends.
    pub range: [f64; 2],
    /// How values go to colours.
    pub spacing: Spacing,
}

impl Colouring {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Sequence,
        Self::Coordination,
        Self::Force,
        Self::Density,
        Self::Orientation,
        Self::Shape,
        Self::Size,
    ];

    /// "sequence", "coordination", "force", "density", "orientation", "shape" or "size".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sequence => "sequence",
            Self::Coordination => "coordination",
            Self::Force => "force",
            Self::Density => "density",
            Self::Orientation => "orientation",
            Self::Shape => "shape",
            Self::Size => "size",
        }
    }

    /// The values of a snapshot's bodies; `cells` are their Set-Voronoi cells, if they are known
    /// ([`Tables::set_voronoi`](crate::tables::Tables::set_voronoi)). `None` where there is not what the
    /// quantity needs: a density needs the cells, a force and a coordination number need contacts, and shapes and sizes need several.
    ///
    /// # Errors
    ///
    /// As [`Snapshot::check`].
    pub fn values(
        self,
        snapshot: &Snapshot,
        cells: Option<&SetVoronoi>,
    ) -> Result<Option<BodyValues>, ViewError> {
        snapshot.check()?;
        let unknown = match self {
            Self::Force => snapshot.contacts.is_empty() || snapshot.gaps.forces,
            Self::Coordination => snapshot.contacts.is_empty(),
            _ => false,
        };
        if unknown {
            return Ok(None);
        }
        Ok(match self {
            Self::Sequence => Some(sequence(snapshot)),
            Self::Coordination => Some(coordination(snapshot)?),
            Self::Force => Some(force(snapshot)?),
            Self::Density => cells.and_then(|cells| density(snapshot, cells)),
            Self::Orientation => Some(orientation(snapshot)),
            Self::Shape => shape(snapshot),
            Self::Size => size(snapshot),
        })
    }
}

fn sequence(snapshot: &Snapshot) -> BodyValues {
    let bodies = &snapshot.bodies;
    let at_once = bodies.windows(2).all(|b| b[0].sequence == b[1].sequence);
    // One colour would tell nothing. Where all are released at once they are numbered from the floor up.
    let (title, note, values): (_, _, Vec<f64>) = if at_once {
        (
            "number of the body",
            "Number of the body, from 0; all were placed at once.",
            (0..bodies.len()).map(|body| body as f64).collect(),
        )
    } else {
        (
            "sequence of placement",
            "Number in the order of placement, from 0; bodies placed together share one.",
            bodies.iter().map(|b| b.sequence.into()).collect(),
        )
    };
    BodyValues {
        title: title.to_owned(),
        note: note.to_owned(),
        range: [0.0, largest(&values).max(1.0)],
        values,
        spacing: Spacing::Linear,
    }
}

fn coordination(snapshot: &Snapshot) -> Result<BodyValues, ViewError> {
    let loads = snapshot.loads()?;
    let values: Vec<f64> = loads.iter().map(|load| load.coordination.into()).collect();
    Ok(BodyValues {
        title: "coordination number".to_owned(),
        note: "Bodies and walls that touch the body, each counted once.".to_owned(),
        range: [0.0, largest(&values).max(1.0)],
        values,
        spacing: Spacing::Whole,
    })
}

fn force(snapshot: &Snapshot) -> Result<BodyValues, ViewError> {
    let loads = snapshot.loads()?;
    let values: Vec<f64> = loads.iter().map(|load| load.force_sum).collect();
    let mut positive: Vec<f64> = values.iter().copied().filter(|f| *f > 0.0).collect();
    positive.sort_by(f64::total_cmp);
    let range = match positive.as_slice() {
        [] => [1e-3, 1.0],
        sorted => [quantile(sorted, 0.02), quantile(sorted, 0.998)],
    };
    Ok(BodyValues {
        title: "sum of normal forces / N".to_owned(),
        note: "Sum of the normal forces of all contacts of the body. The scale is logarithmic."
            .to_owned(),
        range: spread(range, 1.01),
        values,
        spacing: Spacing::Log,
    })
}

fn density(snapshot: &Snapshot, cells: &SetVoronoi) -> Option<BodyValues> {
    let mut values = vec![f64::NAN; snapshot.bodies.len()];
    for cell in cells.cells.iter().filter(|cell| cell.volume > 0.0) {
        if let Some(value) = values.get_mut(cell.body as usize) {
            *value = cell.density;
        }
    }
    // Cells at walls and at the top are cut off: they are shown, but do not set the scale.
    let counted = cells.cells.iter().filter(|cell| cell.counted);
    let mut sorted: Vec<f64> = counted.map(|cell| cell.density).collect();
    if sorted.is_empty() {
        sorted = values.iter().copied().filter(|v| v.is_finite()).collect();
    }
    sorted.sort_by(f64::total_cmp);
    if sorted.is_empty() {
        return None;
    }
    Some(BodyValues {
        title: "local packing density".to_owned(),
        note:
            "Volume of the body over the volume of its Set-Voronoi cell, the points nearer to it \
               than to any other body; cells end at the walls and at the mean top."
                .to_owned(),
        range: spread(
            [quantile(&sorted, 0.005), quantile(&sorted, 0.995)],
            1.0 + 1e-6,
        ),
        values,
        spacing: Spacing::Linear,
    })
}

/// The part of a sorted list below which the share `q` of its values lies, at most.
fn quantile(sorted: &[f64], q: f64) -> f64 {
    let index = (q * (sorted.len().saturating_sub(1)) as f64).round() as usize;
    sorted.get(index).copied().unwrap_or(f64::NAN)
}

/// A range that is not empty: of two values in a ratio of at least `ratio`.
fn spread([low, high]: [f64; 2], ratio: f64) -> [f64; 2] {
    if high > low * ratio {
        [low, high]
    } else {
        [low / ratio, low * ratio]
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// What stands for the orientation of a shape.
enum Axis {
    /// The axis of the moment of inertia that differs from the other two.
    Own(Vector3),
    /// The normals of its faces.
    Faces(Vec<Vector3>),
}

impl Axis {
    fn of(shape: &Polyhedron) -> Self {
        let frame = shape.mass_properties().principal();
        let axis = |k: usize| frame.rotation * Vector3::ith(k, 1.0);
        match telling_axes(shape) {
            BodyAxes::Long => Self::Own(axis(frame.moments.imin())),
            BodyAxes::Short => Self::Own(axis(frame.moments.imax())),
            _ => Self::Faces(
                (0..shape.face_count())
                    .map(|i| shape.face_normal(i))
                    .collect(),
            ),
        }
    }

    /// Angle to the vertical \[degrees\].
    fn tilt(&self, pose: &Pose) -> f64 {
        let up = |axis: &Vector3| (pose.rotation * axis).z;
        let cosine = match self {
            Self::Own(axis) => up(axis).abs(),
            // Down: the face that the body would lie on.
            Self::Faces(normals) => normals.iter().map(|n| -up(n)).fold(-1.0, f64::max),
        };
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    }
}

fn orientation(snapshot: &Snapshot) -> BodyValues {
    let axes: Vec<Axis> = snapshot
        .shapes
        .iter()
        .map(|s| Axis::of(&s.polyhedron))
        .collect();
    let tilt = |body: &Body| {
        axes.get(body.shape as usize)
            .map(|axis| axis.tilt(&body.pose))
    };
    let values: Vec<f64> = snapshot
        .bodies
        .iter()
        .map(|b| tilt(b).unwrap_or(f64::NAN))
        .collect();
    let own = axes
        .iter()
        .filter(|axis| matches!(axis, Axis::Own(_)))
        .count();
    let note = match own {
        0 => {
            "Angle between the downward vertical and the nearest face normal: 0° for a body that \
              lies flat on a face."
        }
        n if n == axes.len() => {
            "Angle between the vertical and the body's axis, the principal axis whose moment of \
             inertia differs most from the other two."
        }
        _ => {
            "Angle between the vertical and the body's axis; for bodies with equal moments of \
             inertia, between the downward vertical and the nearest face normal."
        }
    };
    let flat = values
        .iter()
        .copied()
        .filter(|v| v.is_finite())
        .fold(0.0, f64::max);
    BodyValues {
        title: "tilt / degrees".to_owned(),
        note: note.to_owned(),
        values,
        range: [0.0, if own > 0 { 90.0 } else { flat.max(1.0) }],
        spacing: Spacing::Linear,
    }
}

/// Names of shapes that are listed beside a scale.
const LISTED: usize = 12;

fn shape(snapshot: &Snapshot) -> Option<BodyValues> {
    let values: Vec<f64> = snapshot.bodies.iter().map(|b| b.shape.into()).collect();
    let first = values.first()?;
    if values.iter().all(|value| value == first) {
        return None;
    }
    let names = snapshot.shapes.iter().zip(0..LISTED);
    let names = names.map(|(shape, number)| format!("{number} {}", shape.name));
    let more = if snapshot.shapes.len() > LISTED {
        " and others"
    } else {
        ""
    };
    Some(BodyValues {
        title: "shape".to_owned(),
        note: format!("Shape: {}{more}.", names.collect::<Vec<_>>().join(", ")),
        range: [0.0, largest(&values)],
        values,
        spacing: Spacing::Whole,
    })
}

fn size(snapshot: &Snapshot) -> Option<BodyValues> {
    let diameter = |b: &Body| 2e3 * snapshot.shape_of(b).polyhedron.bounding_radius();
    let values: Vec<f64> = snapshot.bodies.iter().map(diameter).collect();
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = largest(&values);
    (most > least * (1.0 + SAME_SIZE)).then(|| BodyValues {
        title: "diameter / mm".to_owned(),
        note: "Circumscribed diameter of the body.".to_owned(),
        range: [least, most],
        values,
        spacing: Spacing::Linear,
    })
}

impl BodyValues {
    /// Round numbers on the scale, about six, and the last number of a sequence. None on a scale that has no ends,
    /// or is logarithmic and does not begin above zero.
    #[must_use]
    pub fn ticks(&self) -> Vec<f64> {
        let [low, high] = self.range;
        let has_logarithm = self.spacing != Spacing::Log || low > 0.0;
        if !(low.is_finite() && high.is_finite() && has_logarithm) {
            return Vec::new();
        }
        match self.spacing {
            Spacing::Log => decades(low, high),
            Spacing::Linear if low == 0.0 && high.fract() == 0.0 && high > 6.0 => to_the_last(high),
            Spacing::Linear => even(low, high, 0.0),
            Spacing::Whole => even(low, high, 1.0),
        }
    }

    /// Place of a value on the colour scale, 0 to 1; `None` for NaN.
    #[must_use]
    pub fn place(&self, value: f64) -> Option<f64> {
        let [low, high] = self.range;
        let at = match self.spacing {
            Spacing::Log => (value.max(low) / low).ln() / (high / low).ln(),
            Spacing::Linear | Spacing::Whole => (value - low) / (high - low),
        };
        (!value.is_nan()).then(|| at.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NamedShape;
    use crate::testing::two_cubes;
    use femdem_analysis::{Pack, SetVoronoiOptions, set_voronoi};
    use femdem_mesh::{Point3, Rotation, convex_hull};

    fn values(colouring: Colouring) -> Vec<f64> {
        colouring
            .values(&two_cubes(), None)
            .unwrap()
            .unwrap()
            .values
    }

    #[test]
    fn two_cubes_have_known_values() {
        assert_eq!(values(Colouring::Sequence), [0.0, 1.0]);
        assert_eq!(values(Colouring::Coordination), [2.0, 1.0]);
        assert_eq!(values(Colouring::Force), [30.0, 10.0]);
        assert!(
            values(Colouring::Orientation)
                .iter()
                .all(|tilt| tilt.abs() < 1e-6)
        );
    }

    #[test]
    fn bodies_released_at_once_are_told_apart_by_their_number() {
        let mut snapshot = two_cubes();
        snapshot.bodies[0].sequence = 1;
        let found = Colouring::Sequence
            .values(&snapshot, None)
            .unwrap()
            .unwrap();
        assert_eq!(found.title, "number of the body");
        assert_eq!(found.values, [0.0, 1.0]);
    }

    #[test]
    fn shapes_and_sizes_are_told_where_there_are_several() {
        for alike in [Colouring::Shape, Colouring::Size] {
            assert_eq!(alike.values(&two_cubes(), None).unwrap(), None);
        }
        let mut snapshot = two_cubes();
        let polyhedron = snapshot.shapes[0].polyhedron.scaled(2.0).unwrap();
        let name = "large".to_owned();
        snapshot.shapes.push(NamedShape { name, polyhedron });
        snapshot.bodies[1].shape = 1;
        let of = |colouring: Colouring| colouring.values(&snapshot, None).unwrap().unwrap();
        assert_eq!(of(Colouring::Shape).values, [0.0, 1.0]);
        assert!(of(Colouring::Shape).note.contains("1 large"));
        let size = of(Colouring::Size);
        assert!((size.values[0] - 1e3 * 3_f64.sqrt()).abs() < 1e-9);
        assert_eq!(size.range, [size.values[0], size.values[1]]);
    }

    /// Two cubes of 1 m³ in a column of 2.5 x 2 m: each has half of what is below the top of the stack.
    #[test]
    fn density_is_solid_volume_over_cell() {
        let snapshot = two_cubes();
        let (shapes, bodies) = snapshot.posed();
        let pack = Pack::new(&shapes, &bodies).unwrap();
        let column = snapshot.container.unwrap().slab(0.0, 2.0).unwrap();
        let cells = set_voronoi(&pack, &column, &SetVoronoiOptions::default()).unwrap();
        let density = Colouring::Density
            .values(&snapshot, Some(&cells))
            .unwrap()
            .unwrap();
        for value in density.values {
            assert!((value - 0.2).abs() < 2e-3, "{value}");
        }
    }

    #[test]
    fn what_is_not_known_is_none() {
        assert_eq!(Colouring::Density.values(&two_cubes(), None).unwrap(), None);
        let without = Snapshot {
            contacts: Vec::new(),
            ..two_cubes()
        };
        assert_eq!(Colouring::Force.values(&without, None).unwrap(), None);
    }

    /// A cube on an edge is 45 degrees off its faces; a bar that lies has its axis at 90 degrees.
    #[test]
    fn tilt_of_a_turned_cube_and_of_a_lying_bar() {
        let mut snapshot = two_cubes();
        let quarter = Rotation::from_axis_angle(&Vector3::x_axis(), 0.25 * std::f64::consts::PI);
        snapshot.bodies[0].pose.rotation = quarter;
        let bar: Vec<Point3> = (0..8)
            .map(|i| Point3::from([0, 1, 2].map(|k| f64::from(i >> k & 1) * [5.0, 1.0, 1.0][k])))
            .collect();
        snapshot.shapes.push(NamedShape {
            name: "bar".to_owned(),
            polyhedron: convex_hull(&bar).unwrap(),
        });
        snapshot.bodies.push(Body {
            shape: 1,
            ..snapshot.bodies[1]
        });
        let tilt = orientation(&snapshot);
        for (value, expected) in tilt.values.iter().zip([45.0, 0.0, 90.0]) {
            assert!((value - expected).abs() < 1e-6, "{value} {expected}");
        }
        assert_eq!(tilt.range, [0.0, 90.0]);
    }

    #[test]
    fn values_have_places_within_the_scale() {
        let force = BodyValues {
            title: String::new(),
            note: String::new(),
            values: Vec::new(),
            range: [1.0, 100.0],
            spacing: Spacing::Log,
        };
        assert_eq!(force.place(0.0), Some(0.0));
        assert!((force.place(10.0).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(force.place(1e9), Some(1.0));
        assert_eq!(force.place(f64::NAN), None);
    }

    #[test]
    fn a_scale_without_ends_has_no_ticks() {
        let ticks = |range, spacing| {
            let values = BodyValues {
                title: String::new(),
                note: String::new(),
                values: Vec::new(),
                range,
                spacing,
            };
            values.ticks()
        };
        for spacing in [Spacing::Linear, Spacing::Log, Spacing::Whole] {
            for range in [[0.0, f64::INFINITY], [f64::NAN, 1.0], [-f64::INFINITY, 1.0]] {
                assert!(ticks(range, spacing).is_empty(), "{range:?} {spacing:?}");
            }
        }
        assert!(ticks([0.0, 1.0], Spacing::Log).is_empty());
        assert_eq!(ticks([1.0, 100.0], Spacing::Log).len(), 5);
    }
}
