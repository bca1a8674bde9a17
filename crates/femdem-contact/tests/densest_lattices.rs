//! The densest lattice packings of six solids: every neighbour touches and none overlaps, so the pair kernel
//! has to distinguish a gap of 1e-6 from an overlap of 1e-3.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail the test")]

use femdem_contact::kernel::Scratch;
use femdem_contact::{ConvexShape, Frame, PairKernel};
use femdem_mesh::catalogue::CatalogueShape;
use femdem_mesh::nalgebra::{Matrix3, Vector3};

/// Bases and neighbour counts; the file names its source.
const TABLE: &str = include_str!("data/densest-lattices.csv");

/// Lattice vectors have coefficients up to this. The longest basis vector is 2.83 and
/// neighbours lie within 2 circumradii; the test checks that the shell holds none of them.
const SHELL: i32 = 5;

struct Lattice {
    id: &'static str,
    density: f64,
    neighbours: usize,
    basis: Matrix3<f64>,
}

fn lattices() -> Vec<Lattice> {
    TABLE
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let cells: Vec<&'static str> = line.split(',').collect();
            let numbers: Vec<f64> = cells[1..].iter().map(|c| c.parse().unwrap()).collect();
            Lattice {
                id: cells[0],
                density: numbers[0],
                neighbours: numbers[1] as usize,
                basis: Matrix3::from_column_slice(&numbers[2..]),
            }
        })
        .collect()
}

/// The number of overlapping neighbours of the body at the origin, and of those in the outermost shell.
fn overlapping(shape: &ConvexShape, basis: &Matrix3<f64>) -> (usize, usize) {
    let kernel = PairKernel::new(1.0).unwrap();
    let mut scratch = Scratch::default();
    let centre = Frame::identity();
    let (mut count, mut rim) = (0, 0);
    for i in -SHELL..=SHELL {
        for j in -SHELL..=SHELL {
            for k in -SHELL..=SHELL {
                if (i, j, k) == (0, 0, 0) {
                    continue;
                }
                let mut other = Frame::identity();
                other.position = basis * Vector3::new(f64::from(i), f64::from(j), f64::from(k));
                if kernel
                    .evaluate(shape, &centre, shape, &other, &mut scratch)
                    .is_some()
                {
                    count += 1;
                    rim += usize::from(i.abs().max(j.abs()).max(k.abs()) == SHELL);
                }
            }
        }
    }
    (count, rim)
}

#[test]
fn neighbours_of_the_densest_lattices() {
    let lattices = lattices();
    assert_eq!(lattices.len(), 6);
    for Lattice {
        id,
        density,
        neighbours,
        basis,
    } in lattices
    {
        let solid = id
            .parse::<CatalogueShape>()
            .unwrap()
            .polyhedron(2.0)
            .unwrap();
        let got = solid.mass_properties().volume / basis.determinant().abs();
        assert!((got - density).abs() < 1e-7, "{id}: density {got}");
        let shape = ConvexShape::new(&solid).unwrap();
        let apart = overlapping(&shape, &(basis * (1.0 + 1e-6)));
        assert_eq!(apart, (0, 0), "{id} scaled by 1 + 1e-6");
        let pressed = overlapping(&shape, &(basis * (1.0 - 1e-3)));
        assert_eq!(pressed, (neighbours, 0), "{id} scaled by 1 - 1e-3");
    }
}
