//! Tables with one header line, comma-separated, SI units, all digits.

use std::io::{self, Write};

use femdem_analysis::ContactClass;

use crate::{Partner, Snapshot, ViewError};

/// Header of `bodies.csv`.
pub const BODY_COLUMNS: &str =
    "id,shape,x,y,z,qw,qx,qy,qz,sequence,sleeping,mass,velocity_x,velocity_y,velocity_z";

/// Header of `contacts.csv`.
pub const CONTACT_COLUMNS: &str =
    "i,j,x,y,z,nx,ny,nz,normal_force,tangential_force,area,class,patch,volume,tx,ty,tz,mx,my,mz";

/// Writes the bodies, one per line.
///
/// `x, y, z` \[m\] and the unit quaternion `qw, qx, qy, qz` are the pose, which transforms a point of
/// `shape-<name>.obj` to the world. `sleeping` is 0 or 1; `mass` is in kg, and `velocity_x` ... in m/s is
/// the velocity of the centre of mass; both are empty if unknown.
///
/// # Errors
///
/// If writing fails, or the snapshot does not pass [`Snapshot::check`] (as
/// [`io::ErrorKind::InvalidInput`]).
pub fn write_bodies(snapshot: &Snapshot, mut writer: impl Write) -> io::Result<()> {
    snapshot.check().map_err(invalid)?;
    writeln!(writer, "{BODY_COLUMNS}")?;
    let velocity = |id: usize| {
        let known = snapshot.velocities.get(id);
        known.map_or(",,".to_owned(), |v| format!("{},{},{}", v.x, v.y, v.z))
    };
    for (id, body) in snapshot.bodies.iter().enumerate() {
        let shape = quoted(&snapshot.shape_of(body).name);
        let (t, q) = (&body.pose.translation, &body.pose.rotation);
        writeln!(
            writer,
            "{id},{shape},{},{},{},{},{},{},{},{},{},{},{}",
            t.x,
            t.y,
            t.z,
            q.w,
            q.i,
            q.j,
            q.k,
            body.sequence,
            u8::from(body.sleeping),
            snapshot
                .masses
                .get(id)
                .map_or(String::new(), f64::to_string),
            velocity(id),
        )?;
    }
    Ok(())
}

/// Writes the contacts, one per line: bodies that are not convex may touch in several patches, each of which is
/// a contact.
///
/// `i` is a body, `j` a body or the name of a wall. `x, y, z` \[m\] is the centre of pressure, `nx, ny, nz` the
/// unit normal from `i` to `j`. The forces \[N\] are magnitudes, the normal one positive when it pushes the two
/// apart; `area` is in m²; `class` is face-face, edge-face or point (see
/// [`ContactClass`]), empty if unknown; `patch` numbers the patches of a pair, from 0; `volume` is that of
/// the overlap in m³. `tx, ty, tz` \[N\] is the friction force on `j`, and `mx, my, mz` \[N m\] the moment on
/// it about the centre of pressure.
///
/// # Errors
///
/// As [`write_bodies`].
pub fn write_contacts(snapshot: &Snapshot, mut writer: impl Write) -> io::Result<()> {
    snapshot.check().map_err(invalid)?;
    writeln!(writer, "{CONTACT_COLUMNS}")?;
    let unknown = snapshot.gaps.classes;
    let class = |class: ContactClass| if unknown { "" } else { class.name() };
    for row in &snapshot.contacts {
        let partner = match &row.partner {
            Partner::Body(body) => body.to_string(),
            Partner::Wall(name) => quoted(name),
        };
        let (p, n) = (&row.point, &row.normal);
        writeln!(
            writer,
            "{},{partner},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            row.body,
            p.x,
            p.y,
            p.z,
            n.x,
            n.y,
            n.z,
            row.normal_force,
            row.friction.norm(),
            row.area,
            class(row.class),
            row.patch,
            row.volume,
            row.friction.x,
            row.friction.y,
            row.friction.z,
            row.moment.x,
            row.moment.y,
            row.moment.z,
        )?;
    }
    Ok(())
}

pub(super) fn invalid(error: ViewError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, error)
}

/// A field, quoted where needed (RFC 4180).
#[must_use]
pub fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_cubes;

    fn text(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Vec<Vec<String>> {
        let mut bytes = Vec::new();
        write(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        text.lines()
            .map(|l| l.split(',').map(str::to_owned).collect())
            .collect()
    }

    #[test]
    fn bodies_have_the_columns_of_the_header() {
        let rows = text(|w| write_bodies(&two_cubes(), w));
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|row| row.len() == rows[0].len()));
        assert_eq!(rows[2][..2], ["1", "P5"]);
        assert_eq!(
            rows[2][4].parse::<f64>().unwrap(),
            two_cubes().bodies[1].pose.translation.z
        );
        assert_eq!(rows[2][9..], ["1", "1", "", "", "", ""]);
        let mut moving = two_cubes();
        moving.velocities = vec![femdem_mesh::Vector3::new(0.5, -1.0, 0.0); 2];
        let rows = text(|w| write_bodies(&moving, w));
        assert_eq!(rows[2][12..], ["0.5", "-1", "0"]);
        moving.velocities.pop();
        assert!(write_bodies(&moving, io::sink()).is_err());
    }

    #[test]
    fn contacts_name_bodies_and_walls() {
        let rows = text(|w| write_contacts(&two_cubes(), w));
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|row| row.len() == rows[0].len()));
        assert_eq!(rows[1][..2], ["0", "1"]);
        assert_eq!(rows[2][..2], ["0", "floor"]);
        assert_eq!(rows[2][9].parse::<f64>().unwrap(), 5.0);
        assert_eq!(rows[1][11..14], ["face-face", "0", "0.001"]);
        assert_eq!(rows[2][14..], ["5", "0", "0", "0", "0", "0"]);
    }

    #[test]
    fn classes_that_are_not_known_are_empty() {
        let mut snapshot = two_cubes();
        snapshot.gaps.classes = true;
        let rows = text(|w| write_contacts(&snapshot, w));
        assert_eq!([&rows[1][11], &rows[2][11]], ["", ""]);
    }

    #[test]
    fn names_with_commas_are_quoted() {
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(quoted("x-"), "x-");
    }

    #[test]
    fn a_snapshot_with_a_missing_body_is_refused() {
        let mut snapshot = two_cubes();
        snapshot.contacts[0].partner = Partner::Body(7);
        let error = write_contacts(&snapshot, io::sink()).unwrap_err();
        assert!(error.to_string().contains("names body 7"), "{error}");
    }
}
