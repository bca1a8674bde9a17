//! How well the classes of a mixture are mixed.

use std::collections::BTreeMap;

use femdem_analysis::{Cell, Mixing, Pack, PosedBody, Table, mixing};
use femdem_mesh::Polyhedron;

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

/// Mixing over the frames of a run. As a [`Table`] one row per frame and class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MixingSeries {
    /// Number and time (s) of a frame, how its bodies are classed ("shape" or "size"), and how they are mixed.
    pub frames: Vec<(usize, f64, &'static str, Mixing)>,
}

impl MixingSeries {
    /// Adds a frame: its number, its time \[s\], and its bodies.
    ///
    /// # Errors
    ///
    /// As [`Tables::compute`].
    pub fn add(
        &mut self,
        number: usize,
        time: f64,
        snapshot: &Snapshot,
        options: &TableOptions,
    ) -> Result<(), ViewError> {
        snapshot.check()?;
        let shapes = snapshot.shapes.iter();
        let shapes: Vec<Polyhedron> = shapes.map(|shape| shape.polyhedron.clone()).collect();
        let posed = |body: &crate::Body| PosedBody {
            shape: body.shape,
            pose: body.pose,
        };
        let bodies: Vec<PosedBody> = snapshot.bodies.iter().map(posed).collect();
        let pack = Pack::new(&shapes, &bodies)?;
        let shape = by_shape(snapshot, &pack, options)?.map(|found| ("shape", found));
        let size = by_size(&pack, options)?.map(|found| ("size", found));
        let both = shape.into_iter().chain(size);
        self.frames
            .extend(both.map(|(by, found)| (number, time, by, found)));
        Ok(())
    }
}

impl Table for MixingSeries {
    fn columns(&self) -> &'static [&'static str] {
        &[
            "frame",
            "time_s",
            "classes",
            "class",
            "bodies",
            "lacey_index",
            "mean_height_m",
            "height_difference_m",
            "height_difference_over_d",
        ]
    }

    fn rows(&self) -> Box<dyn Iterator<Item = Vec<Cell>> + '_> {
        Box::new(self.frames.iter().flat_map(|(number, time, by, found)| {
            found.classes.iter().map(|class| {
                let difference = class.height_difference;
                vec![
                    (*number).into(),
                    (*time).into(),
                    (*by).into(),
                    class.class.clone().into(),
                    class.bodies.into(),
                    class.lacey_index.into(),
                    class.mean_height.into(),
                    difference.into(),
                    difference.map(|h| h / found.diameter).into(),
                ]
            })
        }))
    }
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
                20.0 * f64::from(k / 64),
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
            assert_eq!(found.classes[1].height_difference, Some(20.0));
        }
        // A second frame with the layers exchanged.
        let mut series = MixingSeries::default();
        let options = TableOptions::default();
        series.add(0, 0.0, &snapshot, &options).unwrap();
        for body in &mut snapshot.bodies {
            body.pose.translation.z *= -1.0;
        }
        series.add(4, 0.5, &snapshot, &options).unwrap();
        let text = series.to_csv();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 9);
        assert!(lines[2].starts_with("0,0.0,shape,large,64,0.0,20.0,20.0,"));
        assert!(lines[8].starts_with("4,0.5,size,larger,64,0.0,-20.0,-20.0,"));
        let one = Tables::compute(&two_cubes(), &TableOptions::default()).unwrap();
        assert!(one.mixing_by_shape.is_none() && one.mixing_by_size.is_none());
    }
}
