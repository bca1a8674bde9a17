//! Tables of poses.

use std::path::Path;

use femdem_mesh::{Pose, Vector3};

use super::bodies::pose;
use super::csv::{Column, Record, Text};
use crate::ViewError;

/// A row of a table of poses. What the table has no column of is `None` in all rows.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseRow {
    /// Name of the shape.
    pub shape: Option<String>,
    /// Coordinates of the shape -> world.
    pub pose: Pose,
    /// Velocity of the centroid \[m/s\].
    pub velocity: Option<Vector3>,
    /// Angular velocity \[rad/s\].
    pub spin: Option<Vector3>,
    /// Circumscribed diameter \[m\].
    pub diameter: Option<f64>,
    /// Size over that of the shape.
    pub scale: Option<f64>,
}

/// Reads a table with the columns `x`, `y`, `z`, `qw`, `qx`, `qy`, `qz` and, optionally, `shape`, `vx`, `vy`, `vz`, `wx`, `wy`,
/// `wz`, and one of `d` and `scale`, such as `bodies.csv`.
///
/// # Errors
///
/// [`ViewError::Read`], and [`ViewError::Table`] with file and line.
pub fn read_poses(path: &Path) -> Result<Vec<PoseRow>, ViewError> {
    let text = Text::read(path)?;
    let place = text.need_all(["x", "y", "z"])?;
    let turn = text.need_all(["qw", "qx", "qy", "qz"])?;
    let shape = text.find("shape");
    let velocity = text.find_all(["vx", "vy", "vz"]);
    let spin = text.find_all(["wx", "wy", "wz"]);
    let (diameter, scale) = (text.find("d"), text.find("scale"));
    let vector = |record: &Record, columns: Option<[Column; 3]>| {
        let numbers = columns.map(|columns| record.numbers(columns)).transpose()?;
        Ok::<_, ViewError>(numbers.map(Vector3::from))
    };
    let row = |record: Record| {
        if diameter.is_some() && scale.is_some() {
            return Err(record.refuse("there are both d and scale: give one of the two".to_owned()));
        }
        Ok(PoseRow {
            shape: shape.map(|column| record.text(column).to_owned()),
            pose: pose(&record, place, turn)?,
            velocity: vector(&record, velocity)?,
            spin: vector(&record, spin)?,
            diameter: size(&record, diameter)?,
            scale: size(&record, scale)?,
        })
    };
    text.records().map(row).collect()
}

fn size(record: &Record, column: Option<Column>) -> Result<Option<f64>, ViewError> {
    let Some(column) = column else {
        return Ok(None);
    };
    let size = record.number(column)?;
    if size <= 0.0 {
        return Err(record.refuse(format!("a size of {size} must be above zero")));
    }
    Ok(Some(size))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<PoseRow>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("poses.csv");
        std::fs::write(&path, text).unwrap();
        read_poses(&path).map_err(|error| error.to_string())
    }

    #[test]
    fn columns_that_are_there_are_read() {
        let rows = read("qx,qw,qy,qz,z,y,x\n0,1,0,0,3,2,1\n").unwrap();
        let row = &rows[0];
        let place: [f64; 3] = row.pose.translation.vector.into();
        assert_eq!(place, [1.0, 2.0, 3.0]);
        assert_eq!(row.pose.rotation.w, 1.0);
        let none = (&row.shape, row.velocity, row.spin, row.diameter, row.scale);
        assert_eq!(none, (&None, None, None, None, None));
        let rows = read("x,y,z,qw,qx,qy,qz,shape,d,vx,vy,vz\n0,0,0,0,1,0,0,a,0.5,1,2,3\n").unwrap();
        assert_eq!(rows[0].shape.as_deref(), Some("a"));
        assert_eq!(rows[0].diameter, Some(0.5));
        assert_eq!(rows[0].velocity, Some(Vector3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn faults_are_named() {
        for (text, words) in [
            ("x,y,z\n0,0,0\n", "no column `qw`"),
            (
                "x,y,z,qw,qx,qy,qz,d\n0,0,0,1,0,0,0,-1\n",
                "line 2: a size of -1",
            ),
            (
                "x,y,z,qw,qx,qy,qz,d,scale\n0,0,0,1,0,0,0,1,1\n",
                "both d and scale",
            ),
            ("x,y,z,qw,qx,qy,qz\n0,0,0,1,1,0,0\n", "length"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(words), "{message}");
        }
    }
}
