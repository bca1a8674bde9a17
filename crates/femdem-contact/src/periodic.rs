//! Periodic space.

use crate::error::{ContactError, check};
use crate::motion::Motion;
use femdem_mesh::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// How many diameters of the largest body a periodic cell must measure along each of its axes: no body then touches another
/// one, or itself, on two sides at once.
pub(crate) const LEAST_DIAMETERS: f64 = 2.25;

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
/// use femdem_contact::PeriodicCell;
/// use femdem_mesh::Vector3;
///
/// let cell = PeriodicCell::new([Some(1.0), Some(1.0), None])?;
/// let image = cell.minimum_image(&Vector3::new(0.9, -1.2, 5.0));
/// assert_eq!(image, [1, -1, 0]);
/// assert_eq!(cell.offset(image), Vector3::new(1.0, -1.0, 0.0));
/// let wrapped = cell.wrapped(&Vector3::new(1.2, -0.1, 7.0));
/// assert!((wrapped - Vector3::new(0.2, 0.9, 7.0)).norm() < 1e-15);
/// # Ok::<(), femdem_contact::ContactError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PeriodicCell {
    /// Columns: the edges, m; zero where space does not repeat itself.
    edges: Matrix3,
    /// Their velocities, m/s.
    rates: Matrix3,
}

impl PeriodicCell {
    /// A cell at rest with edges along the axes, of these lengths (m); `None` where space does not repeat itself.
    ///
    /// # Errors
    /// [`ContactError::Parameter`] for a length that is not positive and finite, or without any.
    pub fn new(sides: [Option<f64>; 3]) -> Result<Self, ContactError> {
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
    /// [`ContactError::Parameter`] if they do not belong to the same axes, edge x is not along x, edge y leans along z,
    /// or a number is not finite.
    pub fn with_edges(self, edges: Matrix3) -> Result<Self, ContactError> {
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
    /// [`ContactError::Parameter`] as for [`with_edges`](Self::with_edges).
    pub fn with_rates(self, rates: Matrix3) -> Result<Self, ContactError> {
        self.check(&rates, "the velocity of an edge of a periodic cell")?;
        Ok(Self { rates, ..self })
    }

    fn check(&self, columns: &Matrix3, name: &'static str) -> Result<(), ContactError> {
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
        self.rates * self.inverse()
    }

    /// Inverse of the edges, with 1 for those that are not there.
    fn inverse(&self) -> Matrix3 {
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
    pub(crate) fn diagonal(&self) -> f64 {
        self.edges.column_iter().map(|edge| edge.norm()).sum()
    }

    /// The minimum image convention: which image of a point is nearest, axis by axis, to a place that lies `away` from the point, m, as
    /// numbers of edges.
    pub fn minimum_image(&self, away: &Vector3) -> [i32; 3] {
        self.reduce(*away, f64::round).0
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
        self.reduce(*point, f64::floor).1
    }

    /// Takes edges off, the last axis first, and returns how many and what is left.
    pub(crate) fn reduce(
        &self,
        mut rest: Vector3,
        whole: impl Fn(f64) -> f64,
    ) -> ([i32; 3], Vector3) {
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

/// The periodic cell of a batch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Space {
    pub cell: PeriodicCell,
    /// Length of the path of each edge so far, m.
    paths: [f64; 3],
    /// How much space was strained so far, to and fro.
    pub strain: f64,
}

impl Space {
    pub fn new(cell: PeriodicCell) -> Self {
        Self {
            cell,
            paths: [0.0; 3],
            strain: 0.0,
        }
    }

    /// The cell has changed.
    pub fn change(&mut self, cell: PeriodicCell) {
        let moved = cell.edges - self.cell.edges;
        for (k, path) in self.paths.iter_mut().enumerate() {
            *path += moved.column(k).norm();
        }
        let change = moved * self.cell.inverse();
        self.strain += change.norm();
        self.cell = cell;
    }

    /// How far the edges that lead to an image have carried it at most, m.
    pub fn path(&self, image: [i32; 3]) -> f64 {
        let paths = image
            .iter()
            .zip(self.paths)
            .map(|(&n, path)| f64::from(n).abs() * path);
        paths.sum()
    }

    /// Calls `f` with the way to each image of a point of the cell, its own place included, whose surroundings of the
    /// half-width `span` (m) meet the cell.
    pub fn beside(&self, point: &Vector3, span: f64, f: impl FnMut(&Vector3)) {
        let mut ways = vec![Vector3::zeros()];
        for k in [2, 1, 0] {
            if !self.cell.repeats(k) {
                continue;
            }
            let edge = self.cell.edges.column(k).into_owned();
            let side = edge[k];
            let mut further = Vec::with_capacity(3 * ways.len());
            for way in ways {
                // An edge that leans leads over neighbouring cells: back into the row of the cell.
                let way = way - edge * ((point[k] + way[k]) / side).floor();
                for number in [-1.0, 0.0, 1.0] {
                    let image = way + edge * number;
                    let x = point[k] + image[k];
                    if x + span >= 0.0 && x - span <= side {
                        further.push(image);
                    }
                }
            }
            ways = further;
        }
        ways.iter().for_each(f);
    }

    /// The image of A that B meets, as it moves.
    pub fn image(&self, a: &Motion, b: &Motion) -> (Motion, [i32; 3]) {
        let image = self
            .cell
            .minimum_image(&(b.frame.position - a.frame.position));
        let mut seen = *a;
        if image != [0; 3] {
            seen.frame.position += self.cell.offset(image);
            seen.velocity += self.cell.velocity_of(image);
            seen.travelled += self.path(image);
        }
        (seen, image)
    }
}
