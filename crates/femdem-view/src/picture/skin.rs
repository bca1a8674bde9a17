//! Pictures of surfaces with a value on every triangle.

use femdem_mesh::Point3;

use super::canvas::Image;
use super::colour::viridis;
use super::legend;
use super::options::PictureOptions;
use super::paint::{LEGEND, draw_outline, eye, paint, pixels_per_metre, radius};
use super::scale_bar;
use super::scene::{Facet, Mesh, Triangle, UNKNOWN};
use crate::{BodyValues, Drawing, ViewError};

/// The surface of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Points \[m\].
    pub points: Vec<Point3>,
    /// Triangles of points, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// A value for each triangle; NaN for none.
    pub values: Vec<f64>,
}

impl Mesh<'_> {
    /// Surfaces coloured by `scale`. Triangles with points that do not exist are left out.
    fn of_skins(skins: &[Skin], scale: &BodyValues) -> Self {
        let mut mesh = Self::default();
        let rest = &mut mesh.rest;
        for (body, skin) in (0..).zip(skins) {
            let first = rest.points.len() as u32;
            rest.points.extend(&skin.points);
            for (corners, &value) in skin.triangles.iter().zip(&skin.values) {
                let [Some(a), Some(b), Some(c)] = corners.map(|i| skin.points.get(i as usize))
                else {
                    continue;
                };
                let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) else {
                    continue;
                };
                rest.triangles.push(Triangle {
                    corners: corners.map(|i| first + i),
                    facet: rest.facets.len() as u32,
                });
                rest.facets.push(Facet {
                    normal,
                    colour: scale.place(value).map_or(UNKNOWN, viridis).to_light(),
                    body: Some(body),
                });
            }
        }
        mesh
    }
}

/// Part of the extent of a drawing that stands for the size of a body where there is none.
const NO_BODY: f64 = 0.05;

/// Draws surfaces, coloured by their values on a scale whose title is shown at the colour bar (the scale's own
/// values are not used). Without a surface the drawing alone, and no colour bar.
///
/// # Errors
///
/// [`ViewError::Option`] for options out of range, [`ViewError::NothingToDraw`] without a triangle and without a line.
pub fn draw_skins(
    skins: &[Skin],
    drawing: Option<&Drawing>,
    scale: &BodyValues,
    options: &PictureOptions,
) -> Result<Image, ViewError> {
    options.check()?;
    let mut mesh = Mesh::of_skins(skins, scale);
    let has_bodies = !mesh.is_empty();
    let lines = || drawing.iter().flat_map(|d| d.lines.iter().flatten());
    if !has_bodies && lines().next().is_none() {
        return Err(ViewError::NothingToDraw);
    }
    if let Some(drawing) = drawing {
        mesh.add_floor(&drawing.floor);
    }
    let mut extent: Vec<Point3> = mesh.points().collect();
    extent.extend(lines());
    let diameter = match has_bodies {
        true => {
            let sizes = skins.iter().map(|skin| 2.0 * radius(&skin.points));
            sizes.sum::<f64>() / skins.len() as f64
        }
        false => NO_BODY * radius(&extent),
    };
    let view = eye(&extent, options, LEGEND);
    let (mut image, seen) = paint(&mesh, &extent, &view, options, diameter);
    if let Some(drawing) = drawing {
        draw_outline(&mut image, drawing, &view, &seen);
    }
    scale_bar::draw(&mut image, pixels_per_metre(&view));
    if has_bodies {
        legend::draw(&mut image, LEGEND * options.width as f64, scale);
    }
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Spacing;

    #[test]
    fn a_triangle_has_the_colour_of_its_value_and_none_is_refused() {
        let scale = BodyValues {
            title: "stress / Pa".to_owned(),
            note: String::new(),
            values: Vec::new(),
            range: [0.0, 2.0],
            spacing: Spacing::Linear,
        };
        let options = PictureOptions {
            width: 120,
            height: 120,
            azimuth: 0.0,
            elevation: 0.0,
        };
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 0.0, 1.0],
        ];
        let skin = Skin {
            points: points.map(Point3::from).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 2, 9]],
            values: vec![2.0, 0.0, 1.0],
        };
        let image = draw_skins(&[skin], None, &scale, &options).unwrap();
        let pixels = || (0..100).flat_map(|x| (0..120).map(move |y| (x, y)));
        let count = |wanted: fn([u8; 3]) -> bool| {
            let seen = pixels().filter_map(|(x, y)| image.pixel(x, y));
            seen.filter(|p| wanted(*p)).count()
        };
        let yellow = count(|p| p[0] > 150 && p[1] > 120 && p[2] < 100);
        let violet = count(|p| p[1] < 40 && p[2] > 50);
        assert!(yellow > 1500 && violet > 1500, "{yellow} {violet}");
        let nothing = draw_skins(&[], None, &scale, &options);
        assert!(matches!(nothing, Err(ViewError::NothingToDraw)));
        // Walls without a body.
        let frame = Drawing {
            floor: Vec::new(),
            lines: crate::picture::sides(&points.map(Point3::from)).collect(),
        };
        let image = draw_skins(&[], Some(&frame), &scale, &options).unwrap();
        // The upper side of the frame, above the scale bar.
        let is_seen = |x: &usize| (0..60).any(|y| image.pixel(*x, y) != Some([255; 3]));
        assert!((0..100).filter(is_seen).count() > 40);
    }
}
