//! Where and how bodies start.

use crate::container::Container;
use crate::error::PackError;
use crate::protocol::Release;
use crate::random::{body_stream, random_rotation, shuffled, uniform};
use crate::spec::{Mixing, PackSpec};
use femdem_contact::BodyId;
use femdem_mesh::nalgebra::Translation3;
use femdem_mesh::{Polyhedron, Pose, Rotation, Vector3};
use femdem_solve::ShapeId;
use rand_chacha::ChaCha8Rng;

/// Places tried for a body before its batch ends without it.
const TRIES: u32 = 200;

/// Largest number of sites in a layer of a lattice.
const MOST_SITES: u64 = 10_000_000;

/// Factor on the radii by which the bounding circles of two bodies of a batch stay apart.
const APART: f64 = 1.01;

/// A body to be released at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    pub shape: ShapeId,
    pub pose: Pose,
    /// Centroid, m.
    pub centroid: Vector3,
    /// Bounding radius, m.
    pub radius: f64,
}

/// The draws of a body's random stream before its place: shape and orientation.
struct Draw<'a> {
    shape: ShapeId,
    polyhedron: &'a Polyhedron,
    rotation: Rotation,
    /// The stream after these draws.
    stream: ChaCha8Rng,
}

impl<'a> Draw<'a> {
    fn new(spec: &'a PackSpec, body: BodyId) -> Result<Self, PackError> {
        let mut stream = body_stream(spec.seed, body);
        let total: f64 = spec.shapes.iter().map(|s| s.share).sum();
        let drawn = match spec.mixing {
            Mixing::Drawn => uniform(&mut stream),
            // The number that would have been drawn is skipped, so that the rest of the stream does not depend
            // on the mixing.
            Mixing::Dealt => {
                uniform(&mut stream);
                dealt(body, spec.count)
            }
            Mixing::Shuffled => {
                uniform(&mut stream);
                let count = spec.count.max(1);
                (f64::from(shuffled(body, count, spec.seed)) + 0.5) / f64::from(count)
            }
        } * total;
        let rotation = random_rotation(&mut stream);
        let mut sum = 0.0;
        let mut chosen = None;
        for (k, shape) in (0..).zip(&spec.shapes) {
            sum += shape.share;
            chosen = Some((k, &shape.polyhedron));
            if drawn < sum {
                break;
            }
        }
        let (shape, polyhedron) = chosen.ok_or(PackError::NoShapes)?;
        Ok(Self {
            shape,
            polyhedron,
            rotation,
            stream,
        })
    }

    fn radius(&self) -> f64 {
        self.polyhedron.bounding_radius()
    }

    /// Depth of the lowest point of the turned body below its centroid, m.
    fn reach_below(&self) -> f64 {
        let centroid = self.polyhedron.mass_properties().centroid;
        let vertices = self.polyhedron.vertices().iter();
        let heights = vertices.map(|v| (self.rotation * (v - centroid)).z);
        -heights.fold(f64::INFINITY, f64::min)
    }

    fn start(&self, centroid: Vector3) -> Start {
        let origin = centroid - self.rotation * self.polyhedron.mass_properties().centroid.coords;
        Start {
            shape: self.shape,
            pose: Pose::from_parts(Translation3::from(origin), self.rotation),
            centroid,
            radius: self.radius(),
        }
    }
}

/// A number in (0, 1) for a body of `count`: the numbers of all bodies are the midpoints of `count`
/// equal parts, in an order that spreads them evenly over any run of bodies (steps of the golden
/// section, rounded to one that reaches every part).
fn dealt(body: BodyId, count: u32) -> f64 {
    const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;
    let count = u64::from(count.max(1));
    let mut step = (GOLDEN_SECTION * count as f64).round() as u64;
    // One of the next numbers is prime and no divisor.
    while gcd(step, count) != 1 {
        step += 1;
    }
    let part = u64::from(body) * step % count;
    (part as f64 + 0.5) / count as f64
}

/// Greatest common divisor.
fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A batch of at most `most` bodies from number `first` on: lowest points at `height`, random orientations,
/// centroids uniform over the places that keep clear of the walls and of the earlier bodies of the batch. A
/// body whose place is taken tries the next place of its own stream; if none is free, the batch ends before it,
/// so that a batch may be smaller but is never empty.
pub(crate) fn batch(
    spec: &PackSpec,
    first: BodyId,
    most: u32,
    height: f64,
) -> Result<Vec<Start>, PackError> {
    let end = first.saturating_add(most).min(spec.count);
    let cell = spec.container.cell()?;
    let height = height.max(spec.container.base());
    let mut batch: Vec<Start> = Vec::new();
    for body in first..end {
        let mut draw = Draw::new(spec, body)?;
        let radius = draw.radius();
        let free = |[x, y]: &[f64; 2]| {
            batch.iter().all(|other| {
                let way = Vector3::new(other.centroid.x - x, other.centroid.y - y, 0.0);
                let way = cell.map_or(way, |cell| cell.shortest(&way));
                way.x.hypot(way.y) >= APART * (other.radius + radius)
            })
        };
        let place = (0..TRIES)
            .map(|_| {
                let (u, v) = (uniform(&mut draw.stream), uniform(&mut draw.stream));
                spec.container.point(u, v, radius)
            })
            .find(free);
        match place {
            Some([x, y]) => {
                let z = height + draw.reach_below();
                batch.push(draw.start(Vector3::new(x, y, z)));
            }
            None => break,
        }
    }
    Ok(batch)
}

/// All bodies of a release: layer upon layer of a square lattice centred over the floor, the
/// lowest half a spacing above it (above the cone of a silo), with random orientations.
pub(crate) fn lattice(spec: &PackSpec, release: &Release) -> Result<Vec<Start>, PackError> {
    let spacing = release.spacing * spec.largest_diameter();
    let layer = layer_sites(spec, release)?;
    let mut starts = Vec::new();
    let base = spec.container.base();
    let heights = (0..).map(|k| base + (f64::from(k) + 0.5) * spacing);
    let sites = heights.flat_map(|z| layer.iter().map(move |[x, y]| Vector3::new(*x, *y, z)));
    for (body, site) in (0..spec.count).zip(sites) {
        starts.push(Draw::new(spec, body)?.start(site));
    }
    Ok(starts)
}

/// The sites of one layer, at least one.
fn layer_sites(spec: &PackSpec, release: &Release) -> Result<Vec<[f64; 2]>, PackError> {
    let diameter = spec.largest_diameter();
    let spacing = release.spacing * diameter;
    let periodic = matches!(spec.container, Container::Periodic { .. });
    // A body beside a wall has half a spacing less there than its next image in periodic space. The slack keeps a container of exactly n spacings from losing a row to round-off.
    let most = spec.container.half_extent().map(|h| match periodic {
        true => ((2.0 * h / spacing + 1e-9) as u32).max(1),
        false => (((2.0 * h - diameter) / spacing + 1e-9).max(0.0) as u32).saturating_add(1),
    });
    let counts = release.per_layer.unwrap_or(most);
    for ((axis, given), most) in ["x", "y"].into_iter().zip(counts).zip(most) {
        if given > most {
            return Err(PackError::LayerTooWide {
                axis,
                given,
                most,
                spacing,
            });
        }
    }
    if u64::from(counts[0]) * u64::from(counts[1]) > MOST_SITES {
        return Err(PackError::LayerTooLarge {
            sites: counts,
            most: MOST_SITES,
        });
    }
    let margin = diameter / 2.0 * (1.0 - 1e-9);
    let sites = |[nx, ny]: [u32; 2]| -> Vec<[f64; 2]> {
        // Rows are as far from their next images as from each other.
        let pitch = |n: u32, half: f64| match periodic {
            true => 2.0 * half / f64::from(n),
            false => spacing,
        };
        let half = spec.container.half_extent();
        let (along_x, along_y) = (pitch(nx, half[0]), pitch(ny, half[1]));
        let centred = |i: u32, n: u32, pitch: f64| (f64::from(i) - 0.5 * f64::from(n - 1)) * pitch;
        let points = (0..ny)
            .flat_map(|j| (0..nx).map(move |i| [centred(i, nx, along_x), centred(j, ny, along_y)]));
        points
            .filter(|[x, y]| spec.container.contains(*x, *y, margin))
            .collect()
    };
    if let Some(per_layer) = release.per_layer {
        let layer = sites(per_layer);
        if layer.is_empty() {
            return Err(PackError::LayerOutside {
                per_layer,
                spacing,
                diameter: 2.0 * spec.container.half_extent()[0],
            });
        }
        return Ok(layer);
    }
    // In a cylinder one row less may hold more bodies, and one in the middle always fits.
    let fewer = most.map(|n| (n - 1).max(1));
    let choices = [counts, fewer, [1, 1]].map(sites);
    let more = |best: Vec<_>, next: Vec<_>| if next.len() > best.len() { next } else { best };
    Ok(choices.into_iter().fold(Vec::new(), more))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::PackShape;
    use femdem_mesh::catalogue::{CatalogueShape, Solid};

    fn spec(container: Container) -> PackSpec {
        let shape = |solid: Solid, d| {
            PackShape::new(
                solid.id(),
                CatalogueShape::from(solid).polyhedron(d).unwrap(),
            )
        };
        PackSpec {
            shapes: vec![shape(Solid::P1, 0.01), shape(Solid::P5, 0.02)],
            container,
            ..PackSpec::default()
        }
    }

    fn square(width: f64) -> Container {
        Container::Box {
            width,
            depth: width,
        }
    }

    fn vertices(spec: &PackSpec, start: &Start) -> Vec<Vector3> {
        let polyhedron = &spec.shapes[start.shape as usize].polyhedron;
        let points = polyhedron.vertices().iter();
        points.map(|v| (start.pose * v).coords).collect()
    }

    /// Whatever the shares, each shape has its share of the bodies to within one, and of every run of
    /// 20 bodies to within three.
    #[test]
    fn dealt_shapes_keep_their_shares() {
        let mut spec = spec(square(0.4));
        spec.mixing = Mixing::Dealt;
        for (count, share) in [(100, 3.0), (97, 1.0), (10, 4.0), (1, 1.0)] {
            spec.count = count;
            spec.shapes[1].share = share;
            let starts = lattice(&spec, &Release::default()).unwrap();
            let first = |starts: &[Start]| starts.iter().filter(|s| s.shape == 0).count() as f64;
            let wanted = f64::from(count) / (1.0 + share);
            assert!((first(&starts) - wanted).abs() <= 1.0, "{count} {share}");
            for run in starts.windows(20) {
                assert!((first(run) - 20.0 / (1.0 + share)).abs() < 3.0);
            }
        }
    }

    /// Shuffled bodies have the shares of dealt ones, in an order that is another for every seed.
    #[test]
    fn shuffled_shapes_keep_their_shares_in_an_order_of_the_seed() {
        let mut spec = spec(square(0.4));
        spec.mixing = Mixing::Shuffled;
        (spec.count, spec.shapes[0].share, spec.shapes[1].share) = (97, 60.0, 37.0);
        let order = |seed| {
            let spec = PackSpec {
                seed,
                ..spec.clone()
            };
            let starts = lattice(&spec, &Release::default()).unwrap();
            starts.iter().map(|s| s.shape).collect::<Vec<_>>()
        };
        let orders = [1, 2, 3].map(order);
        for shapes in &orders {
            assert_eq!(shapes.iter().filter(|shape| **shape == 0).count(), 60);
            // Runs of one shape: 2·60·37/97 + 1 = 46.8 in a random order, with a standard deviation of 4.6.
            let runs = 1 + shapes.windows(2).filter(|w| w[0] != w[1]).count();
            assert!((30..=63).contains(&runs), "{runs}");
        }
        assert_ne!(orders[0], orders[1]);
        assert_ne!(orders[1], orders[2]);
    }

    /// As many shapes as bodies: each once.
    #[test]
    fn dealt_shapes_all_differ_if_there_are_as_many_as_bodies() {
        for count in [1_u32, 2, 12, 97, 288] {
            let mut numbers: Vec<u32> = (0..count)
                .map(|k| (dealt(k, count) * f64::from(count)) as u32)
                .collect();
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..count));
        }
    }

    #[test]
    fn batches_stand_at_the_height_inside_the_walls_and_apart() {
        for container in [square(0.12), Container::Cylinder { diameter: 0.12 }] {
            let spec = spec(container.clone());
            let starts = batch(&spec, 3, 12, 0.5).unwrap();
            assert_eq!(starts.len(), 12);
            for (k, a) in starts.iter().enumerate() {
                let points = vertices(&spec, a);
                let lowest = points.iter().map(|v| v.z).fold(f64::INFINITY, f64::min);
                assert!((lowest - 0.5).abs() < 1e-12);
                assert!(points.iter().all(|v| container.contains(v.x, v.y, -1e-12)));
                for b in &starts[..k] {
                    let apart = (a.centroid - b.centroid).xy().norm();
                    assert!(apart >= a.radius + b.radius);
                }
            }
        }
    }

    #[test]
    fn a_body_starts_the_same_whatever_the_batch_if_its_place_is_free() {
        let spec = spec(square(0.4));
        let all = batch(&spec, 0, 20, 0.1).unwrap();
        let mut same_place = 0;
        for (k, start) in (0..).zip(&all) {
            let alone = batch(&spec, k, 1, 0.1).unwrap()[0];
            assert_eq!(alone.shape, start.shape);
            assert_eq!(alone.pose.rotation, start.pose.rotation);
            same_place += u32::from(alone.pose == start.pose);
        }
        // About 20 d^2 of 400 d^2 are covered, so few bodies find their first place taken.
        assert!((15..=20).contains(&same_place), "{same_place}");
    }

    #[test]
    fn a_full_floor_ends_the_batch_and_the_last_batch_ends_with_the_count() {
        let spec = spec(square(0.021));
        assert_eq!(batch(&spec, 0, 50, 0.0).unwrap().len(), 1);
        assert_eq!(batch(&spec, 499, 50, 0.0).unwrap().len(), 1);
        assert!(batch(&spec, 500, 50, 0.0).unwrap().is_empty());
    }

    #[test]
    fn a_box_six_diameters_wide_takes_layers_of_five_by_five() {
        let spec = spec(square(0.12));
        let starts = lattice(&spec, &Release::default()).unwrap();
        assert_eq!(starts.len(), 500);
        let layer = |z: f64| {
            starts
                .iter()
                .filter(move |s| (s.centroid.z - z).abs() < 1e-12)
        };
        assert_eq!(layer(0.5 * 0.021).count(), 25);
        assert_eq!(layer(19.5 * 0.021).count(), 25);
        let mean = starts.iter().map(|s| s.centroid).sum::<Vector3>() / 500.0;
        assert!(mean.xy().norm() < 1e-12, "{mean}");
    }

    /// Bodies are as far from images as from each other, and stand anywhere.
    #[test]
    fn periodic_starts_keep_apart_over_the_edges() {
        let (width, depth) = (0.13, 0.1);
        let spec = spec(Container::Periodic { width, depth });
        let cell = spec.container.cell().unwrap().unwrap();
        let rows = lattice(&spec, &Release::default()).unwrap();
        let layer: Vec<Start> = rows.into_iter().take(6 * 4).collect();
        // As many of 1.05 d as fit, over all of the width.
        assert!(
            layer
                .iter()
                .all(|s| (s.centroid.z - 0.5 * 0.021).abs() < 1e-12)
        );
        for starts in [layer, batch(&spec, 0, 12, 0.5).unwrap()] {
            for (k, a) in starts.iter().enumerate() {
                for b in &starts[..k] {
                    let way = cell.shortest(&(a.centroid - b.centroid));
                    assert!(way.xy().norm() >= a.radius + b.radius, "{a:?} {b:?}");
                }
            }
        }
        let many = (0..40).map(|k| batch(&spec, k, 1, 0.0).unwrap()[0].centroid.x);
        let farthest = many.fold(0.0, |most: f64, x| most.max(x.abs()));
        assert!(farthest > 0.5 * width - 0.01, "over the edge: {farthest}");
    }

    #[test]
    fn lattices_fit_into_cylinders_of_any_width() {
        for step in 0..60 {
            let diameter = 0.02 + 0.001 * f64::from(step);
            let container = Container::Cylinder { diameter };
            let starts = lattice(&spec(container.clone()), &Release::default()).unwrap();
            assert_eq!(starts.len(), 500);
            let inside = |s: &Start| container.contains(s.centroid.x, s.centroid.y, 0.0099999);
            assert!(starts.iter().all(inside), "diameter {diameter}");
        }
    }

    #[test]
    fn too_wide_a_layer_is_refused_by_name() {
        let release = Release {
            per_layer: Some([5, 6]),
            ..Release::default()
        };
        let error = lattice(&spec(square(0.12)), &release).unwrap_err();
        assert!(error.to_string().contains("6 bodies"), "{error}");
        assert!(error.to_string().contains("y axis"), "{error}");
    }

    /// Shares 1 and 3 of 4,000 bodies: 1,000 +- 27 (one standard deviation).
    #[test]
    fn shapes_are_drawn_by_share() {
        let mut spec = spec(square(0.12));
        spec.count = 4000;
        spec.shapes[1].share = 3.0;
        let starts = lattice(&spec, &Release::default()).unwrap();
        let first = starts.iter().filter(|s| s.shape == 0).count();
        assert!((890..=1110).contains(&first), "{first}");
    }
}
