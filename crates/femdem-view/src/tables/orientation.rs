//! Orientations of the bodies of a snapshot, by axes that suit their shapes.

use femdem_analysis::{
    BodyAxes, OrientationOrder, Pack, Stereonet, body_directions, distinct_axis, orientation_order,
    stereonet,
};
use femdem_mesh::Polyhedron;
use serde::{Deserialize, Serialize};

use super::TableOptions;
use crate::ViewError;

/// Largest number of axes for which the order is computed; its baseline needs many random packs.
const MOST_AXES: usize = 400_000;

/// Directions of body axes or faces: their stereonet and their order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orientation {
    /// The directions used.
    pub axes: BodyAxes,
    /// The Schmidt net with Kamb density; in CSV only, because it is long.
    #[serde(skip)]
    pub net: Option<Stereonet>,
    /// Nematic and cubatic order, compared with random orientations.
    pub order: OrientationOrder,
    /// The directions used for the order.
    pub order_axes: BodyAxes,
}

/// The axis that describes a shape's orientation: the principal axis that differs most from the other two, or
/// the normals of the faces with most sides if the moments are equal.
#[must_use]
pub fn telling_axes(shape: &Polyhedron) -> BodyAxes {
    distinct_axis(shape).unwrap_or_else(|| BodyAxes::FaceNormals {
        sides: shape.faces().map(|face| face.len() as u32).max(),
    })
}

/// For the axes of the options; without them by the shapes, or by all face normals if the shapes need different
/// kinds of axes. `None` without bodies.
pub(super) fn of_pack(
    pack: &Pack,
    options: &TableOptions,
) -> Result<Option<Orientation>, ViewError> {
    let kinds: Vec<BodyAxes> = pack.shapes().iter().map(telling_axes).collect();
    let Some(first) = kinds.first().filter(|_| !pack.is_empty()) else {
        return Ok(None);
    };
    let axes = match &options.axes {
        Some(axes) => axes.clone(),
        None if kinds.iter().all(|kind| kind == first) => first.clone(),
        None => BodyAxes::FaceNormals { sides: None },
    };
    let order_axes = match &axes {
        // All normals of a regular solid together show no order.
        BodyAxes::FaceNormals { .. } if options.axes.is_none() => {
            BodyAxes::Fixed(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        }
        axes => axes.clone(),
    };
    let directions = body_directions(pack, &axes, None)?;
    if directions.len() > MOST_AXES {
        return Ok(None);
    }
    let list: Vec<[f64; 3]> = directions.iter().map(|d| d.direction).collect();
    Ok(Some(Orientation {
        net: Some(stereonet(&list, &options.net)?),
        order: orientation_order(pack, &order_axes, None, &options.order)?,
        order_axes,
        axes,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use femdem_mesh::catalogue::CatalogueShape;
    use femdem_mesh::{Point3, convex_hull};

    #[test]
    fn solids_go_by_their_largest_faces_bars_and_plates_by_their_axes() {
        let solid = |name: &str| {
            name.parse::<CatalogueShape>()
                .unwrap()
                .polyhedron(1.0)
                .unwrap()
        };
        assert_eq!(
            telling_axes(&solid("A10")),
            BodyAxes::FaceNormals { sides: Some(10) }
        );
        assert_eq!(
            telling_axes(&solid("P5")),
            BodyAxes::FaceNormals { sides: Some(4) }
        );
        let block = |x: f64, y: f64, z: f64| {
            let corner = |i: usize| {
                Point3::from([0, 1, 2].map(|k| f64::from(i as u8 >> k & 1) * [x, y, z][k]))
            };
            convex_hull(&(0..8).map(corner).collect::<Vec<_>>()).unwrap()
        };
        assert_eq!(telling_axes(&block(5.0, 1.0, 1.0)), BodyAxes::Long);
        assert_eq!(telling_axes(&block(5.0, 5.0, 1.0)), BodyAxes::Short);
    }
}
