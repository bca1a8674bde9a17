//! The contents of the 3-D view, as numbers for the page.

use std::collections::BTreeMap;

use femdem_analysis::ContactClass;
use femdem_mesh::{Point3, Vector3};
use serde_json::{Value, json};

use super::block::Block;
use super::mesh::Surface;
use crate::{BodyValues, ContactRow, Drawing, Partner, Snapshot};

/// Partner numbers from here up are walls: the largest number is the first wall.
const FIRST_WALL: u32 = u32::MAX;

/// The index and the base64 text of a pack for the 3-D view.
///
/// Bodies are listed shape by shape, in the order of drawing; `body` contains their numbers. Positions are
/// 16-bit fractions of a box, quaternions 16-bit: far finer than a pixel.
pub(super) fn of(snapshot: &Snapshot, fields: &[(&str, BodyValues)]) -> (Value, String) {
    let mut order: Vec<usize> = (0..snapshot.bodies.len()).collect();
    order.sort_by_key(|i| snapshot.bodies.get(*i).map(|body| body.shape));
    let mut block = Block::default();
    let shapes = shapes(snapshot, &mut block);
    let frame = Frame::around(snapshot);
    bodies(snapshot, &order, &frame, &mut block);
    let fields: Vec<Value> = fields
        .iter()
        .map(|(key, field)| {
            let values = order.iter().filter_map(|i| field.values.get(*i));
            block.floats(&format!("field-{key}"), values.map(|v| *v as f32));
            json!({"key": key, "title": field.title, "note": field.note, "range": field.range,
                   "spacing": field.spacing})
        })
        .collect();
    let walls = contacts(snapshot, &order, &frame, &mut block);
    container(snapshot, &frame, &mut block);
    let (arrays, text) = block.finish();
    let index = json!({
        "shapes": shapes, "origin": frame.low, "size": frame.size, "fields": fields, "walls": walls,
        "diameter": frame.diameter, "arrays": arrays,
    });
    (index, text)
}

fn shapes(snapshot: &Snapshot, block: &mut Block) -> Vec<Value> {
    let mut counts = vec![0_usize; snapshot.shapes.len()];
    for body in &snapshot.bodies {
        if let Some(count) = counts.get_mut(body.shape as usize) {
            *count += 1;
        }
    }
    let shapes = snapshot.shapes.iter().zip(counts).enumerate();
    let shapes = shapes.map(|(k, (shape, count))| {
        let surface = Surface::of(&shape.polyhedron);
        block.floats(&format!("points-{k}"), surface.points);
        block.floats(&format!("normals-{k}"), surface.normals);
        block.words(&format!("corners-{k}"), surface.corners);
        let radius = shape.polyhedron.bounding_radius();
        json!({"name": shape.name, "count": count, "radius": radius})
    });
    shapes.collect()
}

/// The box of which positions are fractions.
struct Frame {
    low: [f64; 3],
    size: [f64; 3],
    diameter: f64,
}

impl Frame {
    /// Around all centres of bodies and all contacts.
    fn around(snapshot: &Snapshot) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut diameter = 0.0;
        let mut take = |point: Point3| {
            for k in 0..3 {
                low[k] = low[k].min(point[k]);
                high[k] = high[k].max(point[k]);
            }
        };
        for body in &snapshot.bodies {
            let shape = &snapshot.shape_of(body).polyhedron;
            take(body.pose * shape.mass_properties().centroid);
            diameter += 2.0 * shape.bounding_radius() / snapshot.bodies.len() as f64;
        }
        snapshot.contacts.iter().for_each(|row| take(row.point));
        let size = [0, 1, 2].map(|k| (high[k] - low[k]).max(f64::MIN_POSITIVE));
        Self {
            low,
            size,
            diameter,
        }
    }

    fn fractions(&self, point: &Point3) -> [u16; 3] {
        // Conversion of a float to an integer saturates.
        [0, 1, 2].map(|k| ((point[k] - self.low[k]) / self.size[k] * 65535.0).round() as u16)
    }
}

fn bodies(snapshot: &Snapshot, order: &[usize], frame: &Frame, block: &mut Block) {
    let listed = || order.iter().filter_map(|i| snapshot.bodies.get(*i));
    block.words("body", order.iter().map(|i| *i as u32));
    let places = listed().flat_map(|body| {
        let centroid = snapshot
            .shape_of(body)
            .polyhedron
            .mass_properties()
            .centroid;
        frame.fractions(&(body.pose * centroid))
    });
    block.halves("place", places);
    let turns = listed().flat_map(|body| {
        let q = &body.pose.rotation.coords;
        [q.x, q.y, q.z, q.w].map(|c| (c * 32767.0).round() as i16)
    });
    block.signed_halves("turn", turns);
}

/// The contacts, and the names of the walls.
fn contacts<'a>(
    snapshot: &'a Snapshot,
    order: &[usize],
    frame: &Frame,
    block: &mut Block,
) -> Vec<&'a str> {
    let mut listed_as = vec![0_u32; order.len()];
    for (place, body) in (0..).zip(order) {
        if let Some(entry) = listed_as.get_mut(*body) {
            *entry = place;
        }
    }
    let listed = |body: u32| listed_as[body as usize];
    let mut walls: Vec<&str> = Vec::new();
    let mut partners = Vec::with_capacity(snapshot.contacts.len());
    for row in &snapshot.contacts {
        partners.push(match &row.partner {
            Partner::Body(other) => listed(*other),
            Partner::Wall(name) => {
                let known = walls.iter().position(|wall| wall == name);
                let wall = known.unwrap_or_else(|| {
                    walls.push(name);
                    walls.len() - 1
                });
                FIRST_WALL - wall as u32
            }
        });
    }
    let rows = &snapshot.contacts;
    block.words("contact-first", rows.iter().map(|row| listed(row.body)));
    block.words("contact-second", partners);
    block.halves(
        "contact-point",
        rows.iter().flat_map(|row| frame.fractions(&row.point)),
    );
    block.floats(
        "contact-force",
        rows.iter().map(|row| row.normal_force as f32),
    );
    block.floats(
        "contact-friction",
        rows.iter().map(|row| row.friction.norm() as f32),
    );
    block.floats(
        "contact-strength",
        strengths(snapshot).into_iter().map(|s| s as f32),
    );
    let class = |row: &ContactRow| match row.class {
        ContactClass::FaceFace => 2,
        ContactClass::EdgeFace => 1,
        ContactClass::Point => 0,
    };
    block.bytes("contact-class", rows.iter().map(class));
    walls
}

/// Strength of each contact: the ratio of the force of its pair, friction included, to the weight of the body
/// (of two bodies their mean weight), divided by the mean over the bodies of their largest such ratio. Contacts
/// above 1.5 belong to chains by the rule of Xiang, Latham and Farsi (2016).
pub(super) fn strengths(snapshot: &Snapshot) -> Vec<f64> {
    // Weights enter as a ratio only, so that volumes suffice if masses are not known.
    let weights: Vec<f64> = if snapshot.masses.is_empty() {
        let volume = |body| snapshot.shape_of(body).polyhedron.mass_properties().volume;
        snapshot.bodies.iter().map(volume).collect()
    } else {
        snapshot.masses.clone()
    };
    let weight = |body: u32| weights[body as usize];
    let mut pairs: BTreeMap<(u32, &Partner), Vector3> = BTreeMap::new();
    for row in &snapshot.contacts {
        let force = row.normal * row.normal_force + row.friction;
        *pairs.entry((row.body, &row.partner)).or_default() += force;
    }
    let mut largest = vec![0.0_f64; weights.len()];
    for ((first, partner), force) in &pairs {
        let second = match partner {
            Partner::Body(second) => Some(*second),
            Partner::Wall(_) => None,
        };
        for body in [Some(*first), second].into_iter().flatten() {
            let most = &mut largest[body as usize];
            *most = most.max(force.norm() / weight(body));
        }
    }
    let touching = largest.iter().filter(|most| **most > 0.0);
    let (sum, count) = touching.fold((0.0, 0.0), |(sum, count), most| (sum + most, count + 1.0));
    let mean = f64::max(sum / f64::max(count, 1.0), f64::MIN_POSITIVE);
    let strength = |row: &ContactRow| {
        let force = pairs[&(row.body, &row.partner)].norm();
        let shared = match row.partner {
            Partner::Body(second) => 0.5 * (weight(row.body) + weight(second)),
            Partner::Wall(_) => weight(row.body),
        };
        force / shared / mean
    };
    snapshot.contacts.iter().map(strength).collect()
}

fn container(snapshot: &Snapshot, frame: &Frame, block: &mut Block) {
    let top = frame.low[2] + frame.size[2] + 1.1 * frame.diameter;
    let drawing = snapshot.drawing.clone();
    let drawing = drawing.or_else(|| {
        let region = snapshot.container.as_ref()?;
        Some(Drawing::of_region(region, region.corners().1.z.min(top)))
    });
    let Drawing { floor, lines } = drawing.unwrap_or_default();
    let numbers = |points: &[Point3]| -> Vec<f32> {
        points
            .iter()
            .flat_map(|p| [p.x as f32, p.y as f32, p.z as f32])
            .collect()
    };
    block.floats("floor", numbers(&floor));
    block.floats("lines", numbers(lines.as_flattened()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Colouring;
    use crate::testing::two_cubes;

    #[test]
    fn the_index_names_every_array_of_two_cubes() {
        let snapshot = two_cubes();
        let field = Colouring::Force.values(&snapshot, None).unwrap().unwrap();
        let (index, text) = of(&snapshot, &[("force", field)]);
        let length = |name: &str| index["arrays"][name][2].as_u64().unwrap();
        assert_eq!((length("place"), length("turn")), (6, 8));
        assert_eq!((length("corners-0"), length("field-force")), (36, 2));
        assert_eq!((length("contact-first"), length("lines")), (2, 72));
        assert_eq!(index["walls"], json!(["floor"]));
        let end = index["arrays"]["lines"][1].as_u64().unwrap() + 4 * length("lines");
        assert_eq!(text.len() as u64, end.div_ceil(3) * 4);
    }

    /// Weights are equal; the upper cube's largest force is 10 N, the lower one's that on the floor, with
    /// 5 N of friction.
    #[test]
    fn strength_is_force_over_the_mean_of_the_largest() {
        let strengths = strengths(&two_cubes());
        let floor = 20.0_f64.hypot(5.0);
        let mean = 0.5 * (10.0 + floor);
        for (strength, expected) in strengths.iter().zip([10.0 / mean, floor / mean]) {
            assert!((strength - expected).abs() < 1e-12);
        }
    }
}
