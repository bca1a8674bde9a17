//! Periodic space.

use crate::error::MeshError;
use crate::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Space that repeats itself along one, two or three axes: every body is there again, and moves the same way, at all sums of
/// whole multiples of the edges.
///
/// Edge x is along the x axis, edge y may lean along x, and edge z along x and y. The edges may move, so that the cell
/// is compressed, stretched or sheared; an image n edges away then has n times their velocity more. This is the boundary condition
/// of Lees and Edwards (1972) for edge z moving along x.
///
/// Positions of bodies are not wrapped into the cell: two bodies meet as the nearest images of each other, wherever
/// they are.
///
/// ```
/// use femdem_mesh::{PeriodicCell, Vector3};
///
/// let cell = PeriodicCell::new([Some(1.0), Some(1.0), None])?;
/// let image = cell.minimum_image(&Vector3::new(0.9, -1.2, 5.0));
/// assert_eq!(image, [1, -1, 0]);
/// assert_eq!(cell.offset(image), Vector3::new(1.0, -1.0, 0.0));
/// let wrapped = cell.wrapped(&Vector3::new(1.2, -0.1, 7.0));
/// assert!((wrapped - Vector3::new(0.2, 0.9, 7.0)).norm() < 1e-15);
/// # Ok::<(), femdem_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PeriodicCell {
    /// Columns: the edges, m; zero where space does not repeat itself.
    edges: Matrix3,
    /// Their velocities, m/s.
    rates: Matrix3,
}

impl PeriodicCell {
    /// How many diameters of the largest body a cell must measure along each of its axes: no body then touches another one, or
    /// itself, on two sides at once.
    pub const LEAST_DIAMETERS: f64 = 2.25;

    /// A cell at rest with edges along the axes, of these lengths (m); `None` where space does not repeat itself.
    ///
    /// # Errors
    /// [`MeshError::Cell`] for a length that is not positive and finite, or without any.
    pub fn new(sides: [Option<f64>; 3]) -> Result<Self, MeshError> {
        let given = sides.iter().flatten().count() as f64;
        let allowed = "at least 1: give an axis along which space repeats itself";
        check("number of periodic axes", given, given > 0.0, allowed)?;
        let mut edges = Matrix3::zeros();
        for (k, side) in sides.into_iter().enumerate() {
            if let Some(side) = side {
                let allowed = "positive and finite, in m";
                check("side of a periodic cell", side, side > 0.0, allowed)?;
                edges[(k, k)] = side;
            }
        }
        Ok(Self {
            edges,
            rates: Matrix3::zeros(),
        })
    }

    /// The same cell with these edges, the columns of a matrix, m.
    ///
    /// # Errors
    /// [`MeshError::Cell`] if they do not belong to the same axes, edge x is not along x, edge y leans along z,
    /// or a number is not finite.
    pub fn with_edges(self, edges: Matrix3) -> Result<Self, MeshError> {
        self.check(&edges, "an edge of a periodic cell")?;
        for k in 0..3 {
            let allowed = "positive and finite, in m";
            check(
                "side of a periodic cell",
                edges[(k, k)],
                !self.repeats(k) || edges[(k, k)] > 0.0,
                allowed,
            )?;
        }
        Ok(Self { edges, ..self })
    }

    /// The same cell with these velocities of its edges, the columns of a matrix, m/s.
    ///
    /// # Errors
    /// [`MeshError::Cell`] as for [`with_edges`](Self::with_edges).
    pub fn with_rates(self, rates: Matrix3) -> Result<Self, MeshError> {
        self.check(&rates, "the velocity of an edge of a periodic cell")?;
        Ok(Self { rates, ..self })
    }

    fn check(&self, columns: &Matrix3, name: &'static str) -> Result<(), MeshError> {
        for (k, column) in columns.column_iter().enumerate() {
            for (i, &x) in column.iter().enumerate() {
                let allowed = "finite, and 0 above its own axis and where space does not repeat itself: edge x is along x, \
                               edge y in the plane of x and y";
                check(name, x, x == 0.0 || (self.repeats(k) && i <= k), allowed)?;
            }
        }
        Ok(())
    }

    /// Whether space repeats itself along an axis.
    pub fn repeats(&self, axis: usize) -> bool {
        self.edges[(axis, axis)] > 0.0
    }

    /// The edges, the columns of a matrix, m; zero where space does not repeat itself.
    pub fn edges(&self) -> &Matrix3 {
        &self.edges
    }

    /// Velocities of the edges, m/s.
    pub fn rates(&self) -> &Matrix3 {
        &self.rates
    }

    /// Whether an edge moves.
    pub fn moves(&self) -> bool {
        self.rates != Matrix3::zeros()
    }

    /// Gradient of the velocity with which space is deformed, 1/s: an image at the offset x moves by this times x.
    pub fn velocity_gradient(&self) -> Matrix3 {
        self.rates * self.inverse_edges()
    }

    /// Inverse of the matrix of the edges, 1/m, with 1 on the diagonal where space does not repeat itself.
    pub fn inverse_edges(&self) -> Matrix3 {
        let [a, b, c] = [0, 1, 2].map(|k| {
            let side = self.edges[(k, k)];
            if side > 0.0 { 1.0 / side } else { 1.0 }
        });
        let (xy, xz, yz) = (self.edges[(0, 1)], self.edges[(0, 2)], self.edges[(1, 2)]);
        Matrix3::new(
            a,
            -xy * a * b,
            (xy * yz * b - xz) * a * c,
            0.0,
            b,
            -yz * b * c,
            0.0,
            0.0,
            c,
        )
    }

    /// Volume, m³, if space repeats itself along all axes.
    pub fn volume(&self) -> Option<f64> {
        (0..3)
            .all(|k| self.repeats(k))
            .then(|| self.edges.diagonal().product())
    }

    /// Sum of the lengths of the edges, which no diagonal exceeds, m.
    pub fn diagonal(&self) -> f64 {
        self.edges.column_iter().map(|edge| edge.norm()).sum()
    }

    /// The minimum image convention: which image of a point is nearest, axis by axis, to a place that lies `away` from the point, m, as
    /// numbers of edges.
    pub fn minimum_image(&self, away: &Vector3) -> [i32; 3] {
        self.reduce(*away, f64::round).0
    }

    /// The ways to all images of a point, its own place included, whose surroundings of the half-width `span` (m) meet the box of the
    /// cell's sides with a corner at the origin, m. Along an axis without edges nothing is asked.
    ///
    /// ```
    /// use femdem_mesh::{PeriodicCell, Vector3};
    ///
    /// let cell = PeriodicCell::new([Some(1.0), None, None])?;
    /// let ways = cell.images(&Vector3::new(0.95, 7.0, 0.0), 0.1);
    /// assert_eq!(ways, [-Vector3::x(), Vector3::zeros()]);
    /// # Ok::<(), femdem_mesh::MeshError>(())
    /// ```
    pub fn images(&self, point: &Vector3, span: f64) -> Vec<Vector3> {
        let mut ways = vec![Vector3::zeros()];
        for k in [2, 1, 0] {
            if !self.repeats(k) {
                continue;
            }
            let edge = self.edges.column(k).into_owned();
            let side = edge[k];
            // The cast saturates.
            let most = (span / side).ceil().max(1.0) as i32;
            let mut further = Vec::with_capacity(3 * ways.len());
            for way in ways {
                // An edge that leans leads over neighbouring cells: back into the row of the cell.
                let way = way - edge * ((point[k] + way[k]) / side).floor();
                for number in -most..=most {
                    let image = way + edge * f64::from(number);
                    let x = point[k] + image[k];
                    if x + span >= 0.0 && x - span <= side {
                        further.push(image);
                    }
                }
            }
            ways = further;
        }
        ways
    }

    /// The shortest way between two places, of all images, axis by axis, that lie `way` apart, m: the minimum image of it.
    pub fn shortest(&self, way: &Vector3) -> Vector3 {
        self.reduce(*way, f64::round).1
    }

    /// Where an image lies, m.
    pub fn offset(&self, image: [i32; 3]) -> Vector3 {
        self.edges * Vector3::from(image.map(f64::from))
    }

    /// How much faster an image moves, m/s.
    pub fn velocity_of(&self, image: [i32; 3]) -> Vector3 {
        self.rates * Vector3::from(image.map(f64::from))
    }

    /// The image of a point that lies in the box of the cell's sides with a corner at the origin, m. Its images fill space, also where
    /// the edges lean.
    pub fn wrapped(&self, point: &Vector3) -> Vector3 {
        self.split(point).1
    }

    /// The image of a point that lies in the box of the cell's sides, m, and the numbers of edges from there to the point.
    pub fn split(&self, point: &Vector3) -> ([i32; 3], Vector3) {
        self.reduce(*point, f64::floor)
    }

    /// Takes edges off, the last axis first, and returns how many and what is left.
    fn reduce(&self, mut rest: Vector3, whole: impl Fn(f64) -> f64) -> ([i32; 3], Vector3) {
        let mut image = [0; 3];
        for k in [2, 1, 0] {
            if self.repeats(k) {
                // A body that is lost is told by its position; the cast saturates.
                let number = whole(rest[k] / self.edges[(k, k)]) as i32;
                rest -= self.edges.column(k) * f64::from(number);
                image[k] = number;
            }
        }
        (image, rest)
    }
}

/// Refuses a number of a cell that is not finite or not as it must be.
fn check(name: &'static str, value: f64, ok: bool, allowed: &'static str) -> Result<(), MeshError> {
    if value.is_finite() && ok {
        Ok(())
    } else {
        Err(MeshError::Cell {
            name,
            value,
            allowed,
        })
    }
}
