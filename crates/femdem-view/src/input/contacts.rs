//! `contacts.csv`.

use std::path::Path;

use femdem_analysis::ContactClass;
use femdem_mesh::{Point3, Vector3};

use super::bodies::{LENGTH_TOLERANCE, Posed};
use super::csv::{Column, Record, Text};
use crate::{ContactRow, Partner, ViewError};

/// Name of the table of contacts.
pub const CONTACTS: &str = "contacts.csv";

/// The optional columns.
struct Optional {
    friction: Option<[Column; 3]>,
    friction_size: Option<Column>,
    moment: Option<[Column; 3]>,
    area: Option<Column>,
    volume: Option<Column>,
    class: Option<Column>,
    patch: Option<Column>,
}

pub(super) fn read(path: &Path, pack: &mut Posed) -> Result<(), ViewError> {
    let text = Text::read(path)?;
    let [first, second] = text.need_all(["i", "j"])?;
    let place = text.need_all(["x", "y", "z"])?;
    let normal = text.need_all(["nx", "ny", "nz"])?;
    let normal_force = text.need("normal_force")?;
    let optional = Optional {
        friction: text.find_all(["tx", "ty", "tz"]),
        friction_size: text.find("tangential_force"),
        moment: text.find_all(["mx", "my", "mz"]),
        area: text.find("area"),
        volume: text.find("volume"),
        class: text.find("class"),
        patch: text.find("patch"),
    };
    let gaps = &mut pack.snapshot.gaps;
    let is_told = |column| text.records().all(|record| !record.text(column).is_empty());
    let class = optional.class.filter(|column| is_told(*column));
    gaps.classes = class.is_none();
    gaps.friction = optional.friction.is_none();
    // Zero friction needs no direction.
    if let (None, Some(size)) = (optional.friction, optional.friction_size) {
        let mut none = true;
        for record in text.records() {
            none &= record.number(size)? == 0.0;
        }
        gaps.friction = !none;
    }
    for record in text.records() {
        let body = body_of(pack, &record, record.text(first))?;
        let row = ContactRow {
            body,
            partner: partner_of(pack, &record, record.text(second), body)?,
            point: Point3::from(record.numbers(place)?),
            normal: unit(&record, record.numbers(normal)?)?,
            normal_force: record.number(normal_force)?,
            friction: vector(&record, optional.friction)?,
            moment: vector(&record, optional.moment)?,
            area: or_zero(&record, optional.area)?,
            volume: or_zero(&record, optional.volume)?,
            class: class_of(&record, class)?,
            patch: optional
                .patch
                .map_or(Ok(0), |column| record.whole(column))?,
        };
        pack.snapshot.contacts.push(row);
    }
    check_normals(path, pack)
}

fn body_of(pack: &Posed, record: &Record, text: &str) -> Result<u32, ViewError> {
    let known = text.parse().ok().and_then(|id: u32| pack.index_of.get(&id));
    known
        .copied()
        .ok_or_else(|| record.refuse(format!("i = `{text}` is the id of no body in bodies.csv")))
}

/// A number is a body, any other word a wall.
fn partner_of(pack: &Posed, record: &Record, text: &str, body: u32) -> Result<Partner, ViewError> {
    let Ok(id) = text.parse::<i64>() else {
        if text.is_empty() {
            return Err(record.refuse("j is empty; give a body's id or a wall's name".to_owned()));
        }
        return Ok(Partner::Wall(text.to_owned()));
    };
    let known = u32::try_from(id).ok().and_then(|id| pack.index_of.get(&id));
    match known {
        Some(other) if *other == body => {
            Err(record.refuse(format!("body {text} is said to touch itself")))
        }
        Some(other) => Ok(Partner::Body(*other)),
        None => Err(record.refuse(format!(
            "j = {text} is the id of no body in bodies.csv; walls are given by a name that is no number"
        ))),
    }
}

fn unit(record: &Record, normal: [f64; 3]) -> Result<Vector3, ViewError> {
    let normal = Vector3::from(normal);
    let length = normal.norm();
    if (length - 1.0).abs() > LENGTH_TOLERANCE {
        return Err(record.refuse(format!(
            "the normal nx, ny, nz has length {length}; it must be 1 to within {LENGTH_TOLERANCE}"
        )));
    }
    Ok(normal / length)
}

fn vector(record: &Record, columns: Option<[Column; 3]>) -> Result<Vector3, ViewError> {
    let numbers = columns.map_or(Ok([0.0; 3]), |columns| record.numbers(columns))?;
    Ok(numbers.into())
}

fn or_zero(record: &Record, column: Option<Column>) -> Result<f64, ViewError> {
    column.map_or(Ok(0.0), |column| record.number(column))
}

/// The class, where all rows have one.
fn class_of(record: &Record, column: Option<Column>) -> Result<ContactClass, ViewError> {
    let Some(column) = column else {
        return Ok(ContactClass::Point);
    };
    let name = record.text(column);
    ContactClass::from_name(name).ok_or_else(|| {
        let allowed = ContactClass::ALL.map(ContactClass::name).join(", ");
        record.refuse(format!("class = `{name}` is none of {allowed}"))
    })
}

/// Checks that normals point from i to j: for most of them the partner's centre lies ahead.
fn check_normals(path: &Path, pack: &Posed) -> Result<(), ViewError> {
    let snapshot = &pack.snapshot;
    let centre = |index: u32| {
        let body = &snapshot.bodies[index as usize];
        body.pose
            * snapshot
                .shape_of(body)
                .polyhedron
                .mass_properties()
                .centroid
    };
    let mut balance = 0_i64;
    for row in &snapshot.contacts {
        let ahead = match &row.partner {
            Partner::Body(other) => centre(*other) - centre(row.body),
            Partner::Wall(_) => row.point - centre(row.body),
        };
        balance += if row.normal.dot(&ahead) < 0.0 { -1 } else { 1 };
    }
    if balance < 0 {
        return Err(ViewError::Table {
            path: path.to_path_buf(),
            line: 1,
            message:
                "most normals point from j to i; they must point from i to j: change the sign of \
                      nx, ny, nz (and of tx, ty, tz, mx, my, mz if they act on i)"
                    .to_owned(),
        });
    }
    Ok(())
}
