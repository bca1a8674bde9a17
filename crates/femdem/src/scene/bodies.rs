//! From the shapes named in a scene to bodies that can be packed.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use femdem_mesh::io::Report;
use femdem_mesh::shapes::Shape;
use femdem_mesh::tet::{MeshOptions, MeshReport};
use femdem_mesh::{MeshError, Polyhedron};
use femdem_pack::{PackError, PackShape, SizeClass};

use super::{DEFAULT_DIAMETER, Scene, ShapeNote, Unit, sizes, surface};
use crate::Error;

/// Whether a text names the exact ball: the sphere without its level, which would make it a polyhedron.
#[must_use]
pub fn is_ball(text: &str) -> bool {
    !text.contains(':') && matches!(text.parse(), Ok(Shape::Sphere(_)))
}

/// A shape before it has a size.
struct Source {
    name: String,
    form: Form,
    /// Whether it is the exact ball.
    ball: bool,
    share: f64,
    /// Number of the shape in the scene.
    entry: usize,
}

enum Form {
    /// A parametric shape or a solid of the catalogue.
    Shape(Shape),
    /// The surface of a file, in metres.
    File {
        path: PathBuf,
        polyhedron: Box<Polyhedron>,
        report: Report,
    },
}

/// The bodies of a scene, and how they were made.
pub(super) fn bodies(scene: &Scene) -> Result<(Vec<PackShape>, Vec<ShapeNote>), Error> {
    let mut shapes = Vec::new();
    let mut notes = Vec::new();
    let sources = sources(scene)?;
    refuse_files_missing(scene, &sources)?;
    let gradings = scene.gradings()?;
    let counts = counts(&shares(scene)?, scene.count);
    for variants in sources.chunk_by(|a, b| a.entry == b.entry) {
        let (entry, of) = (variants[0].entry, variants.len() as u32);
        let grading = gradings.get(entry);
        let graded = grading.map(|grading| (grading, grading.bodies(counts[entry])));
        for (source, k) in variants.iter().zip(0..) {
            let polyhedron = match grading {
                Some(grading) => source.scaled_to(grading.range()[1])?,
                None => source.sized(scene)?,
            };
            let options = mesh_options(scene, &polyhedron)?;
            let (shape, mesh) = PackShape::of_surface(&source.name, polyhedron, &options)
                .map_err(|error| source.named(error))?;
            let shape = PackShape {
                share: source.share,
                sphere: source.ball,
                density: source.own_density(scene)?,
                material: scene.material_of(source.entry)?,
                ..shape
            };
            let note = source.note(scene.unit, &shape, mesh);
            let Some((grading, sizes)) = &graded else {
                notes.push(note);
                shapes.push(shape);
                continue;
            };
            // Once for all variants.
            let is_told = k == 0 && !sizes.is_empty();
            notes.push(ShapeNote {
                sizes: is_told.then(|| sizes::note(grading, sizes, of)),
                ..note
            });
            shapes.extend(shape.in_sizes(&dealt(sizes, k, of))?);
        }
    }
    name_apart(shapes.iter_mut().map(|shape| &mut shape.name));
    if let (Some(size), true) = (scene.mesh_size, notes.iter().all(|note| note.is_convex)) {
        return Err(Error::Option {
            name: "mesh-size",
            value: size.to_string(),
            allowed: "for bodies that are not convex, and all of these are; leave it out",
        });
    }
    Ok((shapes, notes))
}

/// The bodies of variant k of so many: they are dealt one by one, from small to large.
fn dealt(sizes: &[SizeClass], k: u32, variants: u32) -> Vec<SizeClass> {
    // Those that the variant has of the first n bodies.
    let of_first = |n: u32| n / variants + u32::from(k < n % variants);
    let mut before = 0;
    let its = sizes.iter().map(|class| {
        let from = before;
        before += class.count;
        SizeClass {
            count: of_first(before) - of_first(from),
            ..*class
        }
    });
    its.filter(|class| class.count > 0).collect()
}

/// So many bodies by the shares of shapes, each to within one body.
fn counts(shares: &[f64], count: u32) -> Vec<u32> {
    let total: f64 = shares.iter().sum();
    let (mut sum, mut placed) = (0.0, 0);
    let next = |share: &f64| {
        sum += share;
        let end = (sum / total * f64::from(count)).round() as u32;
        let own = end.clamp(placed, count) - placed;
        placed += own;
        own
    };
    shares.iter().map(next).collect()
}

/// Appends numbers to names that come again.
fn name_apart<'a>(names: impl Iterator<Item = &'a mut String>) {
    let mut taken = BTreeSet::new();
    for name in names {
        if taken.contains(name) {
            let mut numbered = (2..).map(|n| format!("{name}-{n}"));
            if let Some(free) = numbered.find(|name| !taken.contains(name)) {
                *name = free;
            }
        }
        taken.insert(name.clone());
    }
}

/// Refuses options for surface files if there is none.
fn refuse_files_missing(scene: &Scene, sources: &[Source]) -> Result<(), Error> {
    let is_file = |source: &Source| matches!(source.form, Form::File { .. });
    if scene.walls.is_some() || sources.iter().any(is_file) {
        return Ok(());
    }
    let refuse = |name, value: String| {
        let allowed = "for bodies or walls from surface files, and there are none; leave it out";
        Err(Error::Option {
            name,
            value,
            allowed,
        })
    };
    if scene.unit != Unit::M {
        return refuse("unit", scene.unit.to_string());
    }
    if scene.repair {
        return refuse("repair", "true".to_owned());
    }
    Ok(())
}

/// The shapes named, with the variants of those that have a seed.
fn sources(scene: &Scene) -> Result<Vec<Source>, Error> {
    let shares = shares(scene)?;
    let mut sources: Vec<Source> = Vec::new();
    for (entry, (text, share)) in scene.shape.iter().zip(shares).enumerate() {
        let form = form(text, scene)?;
        let ball = is_ball(text);
        let name = match &form {
            // With its level, which tells it from the ball.
            Form::Shape(shape @ Shape::Sphere(_)) if !ball => format!("{shape:#}"),
            Form::Shape(shape) => shape.to_string(),
            Form::File { path, .. } => file_stem(path),
        };
        let variants = variants(&form, scene.variety)?;
        let share = share / variants.len().max(1) as f64;
        if variants.is_empty() {
            sources.push(Source {
                name,
                form,
                ball,
                share,
                entry,
            });
        }
        sources.extend(variants.into_iter().map(|shape| Source {
            name: shape.to_string(),
            form: Form::Shape(shape),
            ball: false,
            share,
            entry,
        }));
    }
    if scene.variety > 1 && sources.len() == scene.shape.len() {
        return Err(Error::Option {
            name: "variety",
            value: scene.variety.to_string(),
            allowed: "1, unless a shape has a seed, as boulder has",
        });
    }
    name_apart(sources.iter_mut().map(|source| &mut source.name));
    Ok(sources)
}

fn shares(scene: &Scene) -> Result<Vec<f64>, Error> {
    if scene.share.is_empty() {
        return Ok(vec![1.0; scene.shape.len()]);
    }
    if scene.share.len() == scene.shape.len() {
        return Ok(scene.share.clone());
    }
    Err(Error::Option {
        name: "share",
        value: format!("{} numbers", scene.share.len()),
        allowed: "one number for each shape, or none at all",
    })
}

/// A parametric shape, or the surface in a file.
fn form(text: &str, scene: &Scene) -> Result<Form, Error> {
    match text.parse::<Shape>() {
        Ok(shape) => Ok(Form::Shape(shape)),
        Err(unknown) => {
            let path = Path::new(text);
            let family = text.split(':').next().unwrap_or_default();
            let is_shape = family.len() < text.len() && family.parse::<Shape>().is_ok();
            if is_shape || (path.extension().is_none() && !path.exists()) {
                return Err(unknown.into());
            }
            let (polyhedron, report) = surface::read(path, scene.unit, scene.repair)?;
            Ok(Form::File {
                path: path.to_path_buf(),
                polyhedron: Box::new(polyhedron),
                report,
            })
        }
    }
}

/// The same shape with successive seeds, from its own on; none if it has no seed or one variant is enough.
fn variants(form: &Form, variety: u32) -> Result<Vec<Shape>, Error> {
    let Form::Shape(shape) = form else {
        return Ok(Vec::new());
    };
    let seed = shape.parameters().into_iter().find(|p| p.name == "seed");
    let Some(first) = seed.and_then(|p| p.value.parse::<u64>().ok()) else {
        return Ok(Vec::new());
    };
    if variety <= 1 {
        return Ok(Vec::new());
    }
    let variant = |k: u32| {
        let mut variant = shape.clone();
        let seed = first.wrapping_add(u64::from(k));
        variant.set("seed", &seed.to_string())?;
        Ok::<_, MeshError>(variant)
    };
    Ok((0..variety).map(variant).collect::<Result<_, _>>()?)
}

impl Source {
    /// The surface with a circumscribed diameter \[m\].
    fn scaled_to(&self, diameter: f64) -> Result<Polyhedron, Error> {
        let own = self.own()?;
        let by = diameter / (2.0 * own.bounding_radius());
        Ok(own.scaled(by)?)
    }

    /// The surface before it has a size.
    fn own(&self) -> Result<Polyhedron, Error> {
        Ok(match &self.form {
            Form::Shape(shape) => shape.polyhedron(1.0)?,
            Form::File { polyhedron, .. } => polyhedron.as_ref().clone(),
        })
    }

    /// The density of its own, if the shapes have several \[kg/m³\].
    fn own_density(&self, scene: &Scene) -> Result<Option<f64>, Error> {
        let densities = scene.densities()?;
        if densities.len() == 1 {
            return Ok(None);
        }
        Ok(Some(positive("density", densities[self.entry])?))
    }

    /// The surface in the size of the scene \[m\].
    fn sized(&self, scene: &Scene) -> Result<Polyhedron, Error> {
        let own = self.own()?;
        let by = match (&self.form, scene.diameter, scene.size, scene.mass) {
            (_, Some(diameter), None, None) => {
                positive("diameter", diameter)? / (2.0 * own.bounding_radius())
            }
            (Form::Shape(_), None, Some(size), None) => positive("size", size)?,
            (_, None, None, Some(mass)) => {
                let density = match self.own_density(scene)? {
                    Some(density) => density,
                    None => positive("density", scene.densities()?[0])?,
                };
                let volume = positive("mass", mass)? / density;
                let of_own = if self.ball {
                    4.0 / 3.0 * PI * own.bounding_radius().powi(3)
                } else {
                    own.mass_properties().volume
                };
                (volume / of_own).cbrt()
            }
            (Form::Shape(_), None, None, None) => DEFAULT_DIAMETER / (2.0 * own.bounding_radius()),
            (Form::File { .. }, None, None, None) => return Ok(own),
            (Form::File { .. }, None, Some(size), None) => {
                return Err(Error::Option {
                    name: "size",
                    value: size.to_string(),
                    allowed: "for shapes of `femdem shapes`; give the diameter or the mass of bodies \
                              from a file",
                });
            }
            _ => {
                return Err(Error::Option {
                    name: "diameter, size and mass",
                    value: "several".to_owned(),
                    allowed: "only one of the three",
                });
            }
        };
        Ok(own.scaled(by)?)
    }

    fn note(&self, unit: Unit, shape: &PackShape, mesh: Option<MeshReport>) -> ShapeNote {
        let file = match &self.form {
            Form::Shape(_) => None,
            Form::File { path, report, .. } => Some((path.clone(), unit, report.clone())),
        };
        ShapeNote {
            volume: shape.volume(),
            ..ShapeNote::new(shape.name.clone(), file, &shape.polyhedron, mesh)
        }
    }

    /// The error of a body with its file, if it has one.
    fn named(&self, error: PackError) -> Error {
        match (&self.form, error) {
            (Form::File { path, .. }, PackError::Mesh(problem)) => {
                surface::in_file(path, problem).into()
            }
            (_, error) => error.into(),
        }
    }
}

/// The mesh options of a body that is not convex.
fn mesh_options(scene: &Scene, body: &Polyhedron) -> Result<MeshOptions, Error> {
    let size = scene.mesh_size.map(|size| positive("mesh-size", size));
    let diameter = 2.0 * body.bounding_radius();
    Ok(MeshOptions {
        edge_length: size.transpose()?.map(|size| size * diameter),
        ..MeshOptions::default()
    })
}

fn positive(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    Err(Error::Option {
        name,
        value: value.to_string(),
        allowed: "above 0 and finite",
    })
}

pub(super) fn file_stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(scene: &Scene) -> Vec<PackShape> {
        bodies(scene).unwrap().0
    }

    #[test]
    fn shapes_of_one_name_are_told_apart() {
        let shape = ["P5", "cube", "A10"].map(str::to_owned).to_vec();
        let names: Vec<String> = packed(&Scene {
            shape,
            ..Scene::default()
        })
        .into_iter()
        .map(|shape| shape.name)
        .collect();
        assert_eq!(names, ["P5", "P5-2", "A10"]);
    }

    #[test]
    fn variants_divide_the_share_of_their_shape() {
        let shapes = packed(&Scene {
            shape: vec!["boulder:seed=7".to_owned(), "P5".to_owned()],
            share: vec![3.0, 1.0],
            variety: 3,
            ..Scene::default()
        });
        let shares: Vec<f64> = shapes.iter().map(|shape| shape.share).collect();
        assert_eq!(shares, [1.0, 1.0, 1.0, 1.0]);
        let names: Vec<&str> = shapes.iter().map(|shape| shape.name.as_str()).collect();
        assert_eq!(
            names,
            ["boulder:seed=7", "boulder:seed=8", "boulder:seed=9", "P5"]
        );
        assert_ne!(shapes[0].polyhedron, shapes[1].polyhedron);
    }

    /// Variants have together the sizes of their shape without variety, and each as many bodies, to within one.
    #[test]
    fn variants_share_the_sizes_of_their_shape() {
        let of = |variety| {
            let text = format!(
                "shape = [\"boulder:seed=7\", \"P5\"]\nshare = [3, 1]\ncount = 80\nvariety = {variety}\n\
                 sizes = [\"sieve:10mm:0,20mm:0.4,30mm:1\", \"40mm\"]"
            );
            let (shapes, notes) = bodies(&Scene::from_toml(&text).unwrap()).unwrap();
            let is_boulder = |shape: &PackShape| shape.name.starts_with("boulder");
            let told = notes.into_iter().filter_map(|note| note.sizes);
            let boulders: Vec<_> = shapes.into_iter().filter(is_boulder).collect();
            (boulders, told.collect::<Vec<_>>())
        };
        let ((one, told), (seven, told_of_seven)) = (of(1), of(7));
        let count = |shapes: &[PackShape], wanted: &dyn Fn(&PackShape) -> bool| -> f64 {
            let its = shapes.iter().filter(|shape| wanted(shape));
            its.map(|shape| shape.share).sum()
        };
        assert_eq!(count(&seven, &|_| true), 60.0);
        for shape in &one {
            let same = |other: &PackShape| (other.diameter() / shape.diameter() - 1.0).abs() < 1e-9;
            assert_eq!(count(&seven, &same), shape.share, "{}", shape.name);
        }
        for seed in 7..14 {
            let name = format!("boulder:seed={seed} ");
            let its = count(&seven, &|shape| shape.name.starts_with(&name));
            assert!((8.0..=9.0).contains(&its), "{name}: {its}");
        }
        // A sentence for all variants, and one for the cubes.
        assert_eq!((told.len(), told_of_seven.len()), (2, 2));
        let sentence = told_of_seven[0].replace(" and 7 variants", "");
        assert_ne!(sentence, told_of_seven[0]);
        assert_eq!(sentence, told[0]);
    }

    /// A sphere is the exact ball unless it has a level, which is then in its name; both have the mass asked for.
    #[test]
    fn a_sphere_without_a_level_is_a_ball() {
        let shape = ["sphere", "sphere:level=3"].map(str::to_owned).to_vec();
        let scene = Scene {
            shape,
            mass: Some(2.0),
            density: vec![1000.0],
            ..Scene::default()
        };
        let shapes = packed(&scene);
        let names: Vec<&str> = shapes.iter().map(|shape| shape.name.as_str()).collect();
        assert_eq!(names, ["sphere", "sphere:level=3"]);
        assert_eq!([shapes[0].sphere, shapes[1].sphere], [true, false]);
        for shape in &shapes {
            assert!((shape.volume() / 0.002 - 1.0).abs() < 1e-12);
        }
        let radius = (0.006 / (4.0 * PI)).cbrt();
        assert!((shapes[0].diameter() / (2.0 * radius) - 1.0).abs() < 1e-12);
        assert!(shapes[1].diameter() > 1.002 * shapes[0].diameter());
    }

    /// Numbers of bodies come by the shares, sizes by the curve of the shape, and every shape has its density.
    #[test]
    fn shapes_of_a_mixture_have_sizes_and_densities_of_their_own() {
        let text = "shape = [\"P5\", \"sphere\"]\nshare = [1, 3]\ncount = 400\ndensity = [7800, 2000]\n\
                    sizes = [\"20mm:1,40mm:1\", \"sieve:10mm:0,20mm:1\"]";
        let shapes = packed(&Scene::from_toml(text).unwrap());
        let of = |density| shapes.iter().filter(move |s| s.density == Some(density));
        let count = |density| of(density).map(|s| s.share).sum::<f64>();
        assert_eq!((count(7800.0), count(2000.0)), (100.0, 300.0));
        let names: Vec<&str> = of(7800.0).map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["P5 20mm", "P5 40mm"]);
        assert!(of(2000.0).all(|s| s.sphere && (0.01..=0.02).contains(&s.diameter())));
        for (text, part) in [
            ("sizes = [\"20mm\", \"30mm\"]", "one for each shape"),
            ("sizes = \"20mm\"\ndiameter = 0.02", "only one of the five"),
            (
                "sizes = \"20mm\"\nsieve = \"10mm:0,20mm:1\"",
                "only one of the five",
            ),
            ("density = [1000, 2000]", "one for each shape"),
            ("sieve = \"10mm:0,20mm:0.9\"", "last sieve = 0.9"),
        ] {
            let message = bodies(&Scene::from_toml(text).unwrap())
                .unwrap_err()
                .to_string();
            assert!(message.contains(part), "{text}: {message}");
        }
    }

    /// Diameter is that of the sphere around the body, size a length of the shape, mass by density.
    #[test]
    fn bodies_have_the_size_asked_for() {
        let cylinder = |change: fn(&mut Scene)| {
            let mut scene = Scene {
                shape: vec!["cylinder:aspect=2".to_owned()],
                density: vec![2000.0],
                ..Scene::default()
            };
            change(&mut scene);
            packed(&scene).remove(0).polyhedron
        };
        let diameter = |body: &Polyhedron| 2.0 * body.bounding_radius();
        assert!((diameter(&cylinder(|s| s.diameter = Some(0.3))) - 0.3).abs() < 1e-12);
        let sized = diameter(&cylinder(|s| s.size = Some(0.1)));
        assert!((sized - 0.1 * 5.0_f64.sqrt()).abs() < 1e-12);
        let volume = cylinder(|s| s.mass = Some(8.0)).mass_properties().volume;
        assert!((volume - 0.004).abs() < 1e-15);
        assert!((diameter(&cylinder(|_| {})) - DEFAULT_DIAMETER).abs() < 1e-12);
    }
}
