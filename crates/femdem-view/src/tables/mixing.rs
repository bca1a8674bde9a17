//! How well the classes of a mixture are mixed.

use std::collections::{BTreeMap, BTreeSet};

use femdem_analysis::{AnalysisError, Cell, Mixing, Pack, Table, mixing};
use femdem_mesh::Polyhedron;

use super::options::SAME_SIZE;
use super::{TableOptions, Tables};
use crate::{Snapshot, ViewError};

/// Largest number of shapes that are classes.
const MOST_SHAPES: usize = 50;

/// How well the classes of a pack are mixed.
pub(super) enum Mixed {
    Found(Mixing),
    /// There is nothing to be mixed.
    OneClass,
    /// With the reason.
    Unknown(String),
}

impl Tables {
    pub(super) fn add_mixing(&mut self, snapshot: &Snapshot, pack: &Pack) -> Result<(), ViewError> {
        let by_shape = by_shape(snapshot, pack, &self.options)?;
        let by_size = by_size(pack, &self.options)?;
        self.mixing_by_shape = self.known(by_shape, "mixing_by_shape");
        self.mixing_by_size = self.known(by_size, "mixing_by_size");
        Ok(())
    }

    fn known(&mut self, mixed: Mixed, table: &str) -> Option<Mixing> {
        if let Mixed::Unknown(reason) = &mixed {
            self.miss(&[table], reason);
        }
        mixed.found()
    }
}

impl Mixed {
    fn found(self) -> Option<Mixing> {
        match self {
            Self::Found(mixing) => Some(mixing),
            Self::OneClass | Self::Unknown(_) => None,
        }
    }

    fn of(
        pack: &Pack,
        class_of: &[u32],
        names: &[String],
        options: &TableOptions,
    ) -> Result<Self, ViewError> {
        match mixing(pack, class_of, names, &options.mixing) {
            Ok(found) => Ok(Self::Found(found)),
            Err(AnalysisError::GridTooFine { .. }) => Ok(Self::Unknown(format!(
                "the bodies are so far apart that there would be too many cells of {} d; take out those that have \
                 flown away",
                options.mixing.cell_over_d
            ))),
            Err(other) => Err(other.into()),
        }
    }
}

/// Of the shapes, by their names without a size or a number.
pub(super) fn by_shape(
    snapshot: &Snapshot,
    pack: &Pack,
    options: &TableOptions,
) -> Result<Mixed, ViewError> {
    let unknown = |reason: &str| Ok(Mixed::Unknown(reason.to_owned()));
    let bodies = snapshot.bodies.iter();
    let shapes: BTreeSet<&str> = bodies.map(|b| snapshot.shape_of(b).name.as_str()).collect();
    if shapes.len() < 2 {
        return Ok(Mixed::OneClass);
    }
    let classes = Classes::of(snapshot);
    let mut counts: BTreeMap<&str, u32> = BTreeMap::new();
    for body in &snapshot.bodies {
        *counts.entry(classes.name(body.shape)).or_default() += 1;
    }
    match counts.len() {
        1 => return unknown("the shapes differ in nothing but size or number"),
        2..=MOST_SHAPES => {}
        many => {
            let most = MOST_SHAPES;
            return unknown(&format!(
                "the bodies have {many} shapes, and at most {most} can be the classes of a mixture"
            ));
        }
    }
    if counts.values().all(|count| *count == 1) {
        return unknown("no two bodies have the same shape");
    }
    let names: Vec<String> = counts.keys().map(|name| (*name).to_owned()).collect();
    let numbers: BTreeMap<&str, u32> = counts.into_keys().zip(0..).collect();
    let bodies = snapshot.bodies.iter();
    let class_of: Vec<u32> = bodies
        .map(|body| numbers[classes.name(body.shape)])
        .collect();
    Mixed::of(pack, &class_of, &names, options)
}

/// Names of the classes of shapes, one for each shape.
struct Classes<'a>(Vec<&'a str>);

impl<'a> Classes<'a> {
    /// Shapes whose names differ only in a size or a number are a class if they have equal numbers of vertices and
    /// faces.
    fn of(snapshot: &'a Snapshot) -> Self {
        let counts = |surface: &Polyhedron| (surface.vertices().len(), surface.face_count());
        let mut kinds: BTreeMap<&str, BTreeSet<(usize, usize)>> = BTreeMap::new();
        for shape in &snapshot.shapes {
            let of_stem = kinds.entry(stem(&shape.name)).or_default();
            of_stem.insert(counts(&shape.polyhedron));
        }
        let class = |name: &'a str| match kinds[stem(name)].len() {
            1 => stem(name),
            _ => name,
        };
        let shapes = snapshot.shapes.iter();
        Self(shapes.map(|shape| class(&shape.name)).collect())
    }

    fn name(&self, shape: u32) -> &'a str {
        self.0[shape as usize]
    }
}

/// A name without the size of a grading ("A10 20mm", or "A10 20mm-2" for a second of that size) and without the number
/// of a copy ("A10 3", "A10 (3)").
fn stem(name: &str) -> &str {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let is_size = |text: &str| {
        let (size, again) = text.split_once("mm").unwrap_or_default();
        let again = again.strip_prefix('-').map_or(again.is_empty(), is_number);
        size.parse::<f64>().is_ok() && again
    };
    let in_brackets = |text: &str| {
        let inner = text.strip_prefix('(').and_then(|t| t.strip_suffix(')'));
        inner.is_some_and(is_number)
    };
    let mut rest = name;
    while let Some((before, last)) = rest.rsplit_once(' ') {
        if before.is_empty() || !(is_number(last) || is_size(last) || in_brackets(last)) {
            break;
        }
        rest = before;
    }
    rest
}

/// Of two sizes: bodies smaller and larger than the geometric mean of the smallest and the largest circumscribed
/// diameter.
pub(super) fn by_size(pack: &Pack, options: &TableOptions) -> Result<Mixed, ViewError> {
    let diameters: Vec<f64> = pack
        .bodies()
        .iter()
        .map(|body| 2.0 * pack.shapes()[body.shape as usize].bounding_radius())
        .collect();
    let least = diameters.iter().copied().fold(f64::INFINITY, f64::min);
    let most = diameters.iter().copied().fold(0.0, f64::max);
    // Also for no body.
    if most <= least * (1.0 + SAME_SIZE) {
        return Ok(Mixed::OneClass);
    }
    let middle = (least * most).sqrt();
    let class_of: Vec<u32> = diameters.iter().map(|d| u32::from(*d > middle)).collect();
    let names = ["smaller", "larger"].map(str::to_owned);
    Mixed::of(pack, &class_of, &names, options)
}

/// Mixing over the frames of a run. As a [`Table`] one row per frame and class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MixingSeries {
    /// Number and time (s) of a frame, how its bodies are classed ("shape" or "size"), and how they are mixed.
    pub frames: Vec<(usize, f64, &'static str, Mixing)>,
}

impl MixingSeries {
    /// Name of its file in the folder of the tables.
    pub const FILE: &str = "mixing-over-time.csv";

    /// Adds a frame: its number, its time \[s\], and its bodies. How they are mixed is left out where it is not known,
    /// as in [`Tables::missing`].
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
        let (shapes, bodies) = snapshot.posed();
        let pack = Pack::new(&shapes, &bodies)?;
        let shape = by_shape(snapshot, &pack, options)?.found();
        let size = by_size(&pack, options)?.found();
        for (by, found) in [("shape", shape), ("size", size)] {
            let frame = found.map(|found| (number, time, by, found));
            self.frames.extend(frame);
        }
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
    use femdem_mesh::catalogue::{CatalogueShape, Solid};

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
        assert!(reason(&one, "mixing_by_shape").is_none());
    }

    fn reason<'a>(tables: &'a Tables, table: &str) -> Option<&'a str> {
        let mut entries = tables.missing.iter().filter(|entry| entry.table == table);
        entries.next().map(|entry| entry.reason.as_str())
    }

    /// Small and large cubes side by side, under the names given to the shapes.
    fn cubes(names: &[&str]) -> Snapshot {
        let mut snapshot = two_cubes();
        snapshot.contacts.clear();
        let cube = snapshot.shapes[0].clone();
        let shape = |(k, name): (usize, &&str)| crate::NamedShape {
            name: (*name).to_owned(),
            polyhedron: cube.polyhedron.scaled([1.0, 0.5][k % 2]).unwrap(),
        };
        snapshot.shapes = names.iter().enumerate().map(shape).collect();
        let body = |k: u32| Body {
            shape: k % names.len() as u32,
            pose: Pose::translation(0.0, 0.0, 2.0 * f64::from(k)),
            sequence: k,
            sleeping: false,
        };
        snapshot.bodies = (0..6).map(body).collect();
        snapshot
    }

    #[test]
    fn sizes_and_copies_of_one_shape_are_no_mixture_of_shapes() {
        for (names, words) in [
            (&["A10 20mm", "A10 12.5mm"][..], "size or number"),
            (&["A10 20mm", "A10 20mm-2"], "size or number"),
            (&["A10 (2)", "A10 13"], "size or number"),
            (&["a", "b", "c", "d", "e", "f"], "no two bodies"),
        ] {
            let tables = Tables::compute(&cubes(names), &TableOptions::default()).unwrap();
            assert!(tables.mixing_by_shape.is_none() && tables.mixing_by_size.is_some());
            let found = reason(&tables, "mixing_by_shape").unwrap();
            assert!(found.contains(words), "{found}");
        }
        let two = cubes(&["A10-2 20mm", "A10 20mm", "A10 40mm"]);
        let found = Tables::compute(&two, &TableOptions::default()).unwrap();
        let classes = found.mixing_by_shape.unwrap().classes;
        let classes = classes.iter().map(|c| (c.class.as_str(), c.bodies));
        assert!(classes.eq([("A10", 4), ("A10-2", 2)]));
        // Other surfaces of such names are other shapes.
        let mut two = cubes(&["stone 1", "stone 2"]);
        let solid = CatalogueShape::from(Solid::P4);
        two.shapes[1].polyhedron = solid.polyhedron(1.0).unwrap();
        let found = Tables::compute(&two, &TableOptions::default()).unwrap();
        assert_eq!(found.mixing_by_shape.unwrap().classes.len(), 2);
    }

    #[test]
    fn mixing_with_a_body_that_has_flown_away_is_missing() {
        let mut snapshot = cubes(&["a", "b"]);
        snapshot.bodies[0].pose.translation.x = 1e7;
        let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
        for table in ["mixing_by_shape", "mixing_by_size"] {
            assert!(reason(&tables, table).unwrap().contains("flown away"));
        }
    }

    #[test]
    fn many_shapes_are_no_classes_and_sizes_apart_by_little_are_one() {
        let names: Vec<String> = (0..60).map(|k| format!("stone{k}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut snapshot = cubes(&names);
        let body = |k: u32| Body {
            shape: k,
            pose: Pose::translation(0.0, 0.0, 2.0 * f64::from(k)),
            sequence: k,
            sleeping: false,
        };
        snapshot.bodies = (0..60).map(body).collect();
        let cube = two_cubes().shapes[0].polyhedron.clone();
        for (k, shape) in snapshot.shapes.iter_mut().enumerate() {
            shape.polyhedron = cube.scaled(1.0 + 1e-4 * k as f64).unwrap();
        }
        let tables = Tables::compute(&snapshot, &TableOptions::default()).unwrap();
        assert!(
            reason(&tables, "mixing_by_shape")
                .unwrap()
                .contains("60 shapes")
        );
        assert!(tables.mixing_by_size.is_none() && tables.sieve.is_none());
    }
}
