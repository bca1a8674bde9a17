//! How well the classes of a mixture are mixed.

use std::collections::BTreeMap;

use femdem_analysis::{Mixing, Pack, mixing};

use super::{TableOptions, Tables};
use crate::{Snapshot, ViewError};

/// Largest number of shapes that are classes.
const MOST_SHAPES: usize = 50;

/// Sizes that differ by less than this share are one.
const SAME_SIZE: f64 = 0.01;

impl Tables {
    pub(super) fn add_mixing(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), ViewError> {
        self.mixing_by_shape = by_shape(snapshot, pack, &self.options)?;
        self.mixing_by_size = by_size(pack, &self.options)?;
        Ok(())
    }
}

/// Of the shapes, by their names; `None` for a single shape, or for so many that they are no classes.
pub(super) fn by_shape(
    snapshot: &Snapshot,
    pack: &Pack,
    options: &TableOptions,
) -> Result<Option<Mixing>, ViewError> {
    let mut numbers: BTreeMap<&str, u32> = BTreeMap::new();
    for body in &snapshot.bodies {
        numbers.insert(&snapshot.shape_of(body).name, 0);
    }
    if !(2..=MOST_SHAPES).contains(&numbers.len()) {
        return Ok(None);
    }
    for (number, k) in numbers.values_mut().zip(0..) {
        *number = k;
    }
    let names: Vec<String> = numbers.keys().map(|name| (*name).to_owned()).collect();
    let bodies = snapshot.bodies.iter();
    let class_of: Vec<u32> = bodies
        .map(|body| numbers[snapshot.shape_of(body).name.as_str()])
        .collect();
    Ok(Some(mixing(pack, &class_of, &names, &options.mixing)?))
}

/// Of two sizes: bodies smaller and larger than the geometric mean of the smallest and the largest circumscribed
/// diameter; `None` for bodies of one size.
pub(super) fn by_size(pack: &Pack, options: &TableOptions) -> Result<Option<Mixing>, ViewError> {
    let diameters: Vec<f64> = pack
        .bodies()
        .iter()
        .map(|body| 2.0 * pack.shapes()[body.shape as usize].bounding_radius())
        .collect();
    let least = diameters.iter().copied().fold(f64::INFINITY, f64::min);
    let most = diameters.iter().copied().fold(0.0, f64::max);
    // Also for no body.
    if most <= least * (1.0 + SAME_SIZE) {
        return Ok(None);
    }
    let middle = (least * most).sqrt();
    let class_of: Vec<u32> = diameters.iter().map(|d| u32::from(*d > middle)).collect();
    let names = ["smaller", "larger"].map(str::to_owned);
    Ok(Some(mixing(pack, &class_of, &names, &options.mixing)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Body;
    use crate::testing::two_cubes;
    use femdem_mesh::Pose;

    /// A layer of small cubes below one of cubes twice as large: apart by shape and by size.
    #[test]
    fn layers_are_apart_by_shape_and_by_size() {
        let mut snapshot = two_cubes();
        let mut large = snapshot.shapes[0].clone();
        large.polyhedron = large.polyhedron.scaled(2.0).unwrap();
        large.name = "large".to_owned();
        snapshot.shapes.push(large);
        snapshot.contacts.clear();
        let body = |k: u32| Body {
            shape: k / 64,
            pose: Pose::translation(
                2.0 * f64::from(k % 8),
                2.0 * f64::from(k / 8 % 8),
                9.0 * f64::from(k / 64),
            ),
            sequence: k,
            sleeping: false,
        };
        snapshot.bodies = (0..128).map(body).collect();
        let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
        for (found, names) in [
            (&tables.mixing_by_shape, ["P5", "large"]),
            (&tables.mixing_by_size, ["smaller", "larger"]),
        ] {
            let found = found.as_ref().unwrap();
            assert_eq!(found.lacey_index, Some(0.0));
            let classes = found.classes.iter().map(|class| class.class.as_str());
            assert!(classes.eq(names));
            assert_eq!(found.classes[1].height_difference, Some(9.0));
        }
        let one = Tables::compute(&two_cubes(), &TableOptions::default()).unwrap();
        assert!(one.mixing_by_shape.is_none() && one.mixing_by_size.is_none());
    }
}
