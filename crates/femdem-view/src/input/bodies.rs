//! `bodies.csv` and the shapes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use femdem_mesh::nalgebra::{Quaternion, Translation3};
use femdem_mesh::{Pose, Rotation, io};

use super::csv::{Column, Record, Text};
use crate::output::surface::{distinct_file_name, shape_file_name};
use crate::{Body, NamedShape, Snapshot, ViewError};

/// Name of the table of bodies.
pub const BODIES: &str = "bodies.csv";

/// Tolerance of the length of a direction or a quaternion, which is then normalised.
pub(super) const LENGTH_TOLERANCE: f64 = 1e-3;

/// Bodies, and the index of each id of the file.
pub(super) struct Posed {
    pub(super) snapshot: Snapshot,
    pub(super) index_of: BTreeMap<u32, u32>,
}

pub(super) fn read(folder: &Path, density: Option<f64>) -> Result<Posed, ViewError> {
    let text = Text::read(&folder.join(BODIES))?;
    let shape_column = text.need("shape")?;
    let place = text.need_all(["x", "y", "z"])?;
    let turn = text.need_all(["qw", "qx", "qy", "qz"])?;
    let id_column = text.find("id");
    let mass = text.find("mass");
    let velocity = ["velocity_x", "velocity_y", "velocity_z"].map(|name| text.find(name));
    let sequence = text.find("sequence");
    let sleeping = text.find("sleeping");
    let mut shape_of: BTreeMap<String, u32> = BTreeMap::new();
    let mut snapshot = Snapshot::default();
    let mut index_of = BTreeMap::new();
    let mut taken = BTreeMap::new();
    for (record, index) in text.records().zip(0_u32..) {
        let id = id_column.map_or(Ok(index), |column| record.whole(column))?;
        if index_of.insert(id, index).is_some() {
            return Err(record.refuse(format!("id {id} has been given before")));
        }
        let name = record.text(shape_column);
        let shape = match shape_of.get(name) {
            Some(shape) => *shape,
            None => {
                let shape = snapshot.shapes.len() as u32;
                snapshot.shapes.push(read_shape(folder, name, &record)?);
                shape_of.insert(name.to_owned(), shape);
                shape
            }
        };
        let pose = pose(&record, place, turn)?;
        let bits = <[f64; 3]>::from(pose.translation.vector).map(f64::to_bits);
        if let Some(other) = taken.insert((shape, bits), index) {
            let what =
                format!("the body has the shape and the place of row {other}, counted from 0");
            return Err(record.refuse(what));
        }
        snapshot.bodies.push(Body {
            shape,
            pose,
            sequence: sequence.map_or(Ok(index), |column| record.whole(column))?,
            sleeping: sleeping.is_some_and(|column| record.text(column) == "1"),
        });
        let column = mass.filter(|column| !record.text(*column).is_empty());
        if column.is_some() != (snapshot.masses.len() == snapshot.bodies.len() - 1) && index > 0 {
            let what = "some rows have a mass and others have none: give it to all or to none";
            return Err(record.refuse(what.to_owned()));
        }
        if let Some(column) = column {
            let mass = record.number(column)?;
            if mass <= 0.0 {
                return Err(record.refuse(format!("mass = {mass} kg must be above zero")));
            }
            snapshot.masses.push(mass);
        }
        if let [Some(x), Some(y), Some(z)] = velocity
            && !record.text(x).is_empty()
        {
            if snapshot.velocities.len() != snapshot.bodies.len() - 1 {
                let what =
                    "some rows have a velocity and others have none: give it to all or to none";
                return Err(record.refuse(what.to_owned()));
            }
            snapshot.velocities.push(record.numbers([x, y, z])?.into());
        }
    }
    if !snapshot.velocities.is_empty() && snapshot.velocities.len() != snapshot.bodies.len() {
        let (velocities, bodies) = (snapshot.velocities.len(), snapshot.bodies.len());
        return Err(ViewError::Velocities { velocities, bodies });
    }
    if let (false, Some(density)) = (snapshot.masses.is_empty(), density) {
        return Err(ViewError::Option {
            name: "density",
            value: density.to_string(),
            allowed: "for tables of bodies without masses, and this one has a column mass; leave it out",
        });
    }
    if let (true, Some(density)) = (snapshot.masses.is_empty(), density) {
        let volume = |body: &Body| snapshot.shape_of(body).polyhedron.mass_properties().volume;
        let masses = snapshot.bodies.iter().map(|body| density * volume(body));
        snapshot.masses = masses.collect();
    }
    Ok(Posed { snapshot, index_of })
}

/// The pose in a row.
pub(super) fn pose(
    record: &Record,
    place: [Column; 3],
    turn: [Column; 4],
) -> Result<Pose, ViewError> {
    let [x, y, z] = record.numbers(place)?;
    let rotation = rotation(record, record.numbers(turn)?)?;
    Ok(Pose::from_parts(Translation3::new(x, y, z), rotation))
}

fn rotation(record: &Record, [w, x, y, z]: [f64; 4]) -> Result<Rotation, ViewError> {
    let quaternion = Quaternion::new(w, x, y, z);
    let length = quaternion.norm();
    // The condition is false for NaN.
    let unit = (length - 1.0).abs() <= LENGTH_TOLERANCE;
    if !unit {
        return Err(record.refuse(format!(
            "the quaternion qw, qx, qy, qz has length {length}; it must be 1 to within {LENGTH_TOLERANCE}"
        )));
    }
    Ok(Rotation::from_quaternion(quaternion))
}

fn read_shape(folder: &Path, name: &str, record: &Record) -> Result<NamedShape, ViewError> {
    // A file with the first name exists only if another shape has the second.
    let mut candidates = vec![
        distinct_file_name(name),
        shape_file_name(name),
        format!("{name}.obj"),
        name.to_owned(),
    ];
    candidates.dedup();
    let folders = [Some(folder), folder.parent()];
    let path = folders
        .into_iter()
        .flatten()
        .flat_map(|folder| candidates.iter().map(|file| folder.join(file)))
        .find(|path: &PathBuf| !name.is_empty() && path.is_file());
    let Some(path) = path else {
        return Err(record.refuse(format!(
            "shape `{name}` is in none of the files {}; write its surface to one of them",
            candidates.join(", ")
        )));
    };
    Ok(NamedShape {
        name: name.to_owned(),
        polyhedron: io::read_file(path)?,
    })
}
