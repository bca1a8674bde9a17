//! Continuum fields on a grid, by coarse graining of bodies and contacts.

mod kernel;
mod layer;

use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::bounds::Bounds;
use crate::error::AnalysisError;
use crate::network::ForceNetwork;
use crate::ordered::ordered_map;
use kernel::Lucy;
use layer::{Layer, Sources};

/// Largest number of cells.
const MOST_CELLS: f64 = 1e7;

/// Largest coordinate over the spacing: round-off is then below a thousandth of the spacing.
const FARTHEST: f64 = 1e12;

/// How [`coarse_grained_fields`] smooths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FieldOptions {
    /// Width of the coarse-graining function over the mean diameter: the radius c within which it is not zero; above
    /// 0. Default 1.5. Fields of less than 1 show single bodies, wide ones smear gradients and walls.
    pub width_over_d: f64,
    /// Distance of the points of the grid over the mean diameter, above 0 and at most the width. Default 0.5.
    pub spacing_over_d: f64,
}

impl Default for FieldOptions {
    fn default() -> Self {
        Self {
            width_over_d: 1.5,
            spacing_over_d: 0.5,
        }
    }
}

/// A tensor by rows: xx, xy, xz, yx, ... zz.
pub type Tensor = [f64; 9];

/// Continuum fields at the centres of the cells of a regular grid, x running fastest, then y, then z. The grid covers
/// everything that is not zero, also outside of walls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fields {
    /// Lower corner of the grid (m).
    pub origin: Point3,
    /// Side of a cell (m).
    pub spacing: f64,
    /// Number of cells along x, y, z.
    pub counts: [usize; 3],
    /// Radius of the coarse-graining function (m).
    pub width: f64,
    /// Volume of the bodies per volume.
    pub solid_fraction: Vec<f64>,
    /// Mass per volume (kg/m³); `None` where masses are not known.
    pub density: Option<Vec<f64>>,
    /// Momentum per volume (kg/(m² s)); `None` where masses or velocities are not known.
    pub momentum: Option<Vec<[f64; 3]>>,
    /// Momentum over mass (m/s), zero where there is no mass.
    pub velocity: Option<Vec<[f64; 3]>>,
    /// Stress of the motion about the mean velocity (Pa), compression positive.
    pub kinetic_stress: Option<Vec<Tensor>>,
    /// Stress of the contacts (Pa), compression positive; the row is the direction of the force.
    pub contact_stress: Vec<Tensor>,
    /// Fabric (1): its trace over the solid fraction is the mean number of contacts of a body.
    pub fabric: Vec<Tensor>,
}

/// Coarse-grained fields of bodies and contacts (I. Goldhirsch, Granul. Matter 12, 239, 2010, with the boundary
/// forces of T. Weinhart et al., Granul. Matter 14, 289, 2012), with Lucy's function φ of radius c = width:
///
/// - density ρ = Σ m φ(x − x_i), momentum ρ V = Σ m v φ(x − x_i), solid fraction Σ V_i φ(x − x_i);
/// - kinetic stress Σ m (v − V)(v − V) φ(x − x_i);
/// - contact stress −Σ_c Σ_b f (p − x_b) ∫₀¹ φ(x − x_b − s (p − x_b)) ds, with f the force on body b at the contact
///   point p: exact integrals along the lines from the centres to the contact points, of contacts with walls too;
/// - fabric Σ V_i φ(x − x_i) Σ_c n n, over the touching contacts of a body.
///
/// Momentum is thus balanced at every point: at rest div σ = ρ g + t in the signs of this crate, with t the forces of
/// the walls spread by φ about their contact points. Where no wall is within c, the stress integrated over a
/// horizontal plane is the weight above it. Moments that act at contacts show as an asymmetry of the stress.
///
/// `masses` (kg) and `velocities` (m/s) have one entry for each body, or none if they are not known.
///
/// ```
/// use femdem_analysis::*;
/// use femdem_mesh::{Point3, Vector3};
///
/// let body = ForceBody { centre: Point3::origin(), volume: 0.5, diameter: 1.0, weight: 0.0 };
/// let network_of_one = [body];
/// let network = ForceNetwork::new(&network_of_one, &[], 0.0)?;
/// let options = FieldOptions { width_over_d: 1.0, spacing_over_d: 0.25 };
/// let fields = coarse_grained_fields(&network, &[2.0], &[Vector3::x()], &options)?;
/// let mass: f64 = fields.density.unwrap().iter().map(|rho| rho * fields.spacing.powi(3)).sum();
/// assert!((mass / 2.0 - 1.0).abs() < 0.01);
/// # Ok::<(), AnalysisError>(())
/// ```
///
/// # Errors
/// [`AnalysisError::Option`], also for more than ten million cells and for coordinates above 1e12 spacings,
/// [`AnalysisError::BodyList`] for a list of another length, [`AnalysisError::Body`] for a mass or a velocity out of its range.
pub fn coarse_grained_fields(
    network: &ForceNetwork,
    masses: &[f64],
    velocities: &[Vector3],
    options: &FieldOptions,
) -> Result<Fields, AnalysisError> {
    check_lists(network.bodies().len(), masses, velocities)?;
    let diameter = network.mean_diameter();
    let (width, spacing) = options.lengths(diameter)?;
    let centres = network.bodies().iter().map(|body| body.centre);
    let points = network.contacts().iter().map(|contact| contact.point);
    let bounds = Bounds::around(centres.chain(points));
    let needed =
        [0, 1, 2].map(|k| ((bounds.max[k] - bounds.min[k] + 2.0 * width) / spacing).ceil());
    if needed.iter().product::<f64>() > MOST_CELLS {
        return Err(AnalysisError::Option {
            name: "spacing_over_d",
            value: options.spacing_over_d,
            allowed: "wide enough for at most 10000000 cells",
        });
    }
    let farthest = bounds.min.coords.amax().max(bounds.max.coords.amax());
    if farthest > FARTHEST * spacing {
        return Err(AnalysisError::Option {
            name: "spacing_over_d",
            value: options.spacing_over_d,
            allowed: "such that no coordinate is above 1e12 spacings, or it is lost to round-off; move the bodies to \
                      the origin",
        });
    }
    let counts = needed.map(|n| n as usize);
    let (middle, _) = bounds.middle_and_half();
    let origin = middle - Vector3::from(needed) * (0.5 * spacing);
    let sources = Sources::new(network, masses, velocities, Lucy::new(width));
    let centre = |k: usize, i: usize| origin[k] + (i as f64 + 0.5) * spacing;
    let lists = sources.by_layer(counts[2], |k| centre(2, k));
    let layers = ordered_map(
        counts[2],
        || (),
        |(), k| {
            let mut layer = Layer::new(origin, spacing, [counts[0], counts[1]], centre(2, k));
            layer.add(&sources, &lists[k]);
            layer
        },
    );
    Ok(gathered(
        layers,
        origin,
        spacing,
        counts,
        width,
        [!masses.is_empty(), !velocities.is_empty()],
    ))
}

/// The layers one after the other; `known` says whether masses and velocities are.
fn gathered(
    layers: Vec<Layer>,
    origin: Point3,
    spacing: f64,
    counts: [usize; 3],
    width: f64,
    [masses, velocities]: [bool; 2],
) -> Fields {
    let mut all = Fields {
        origin,
        spacing,
        counts,
        width,
        solid_fraction: Vec::new(),
        density: masses.then(Vec::new),
        momentum: (masses && velocities).then(Vec::new),
        velocity: (masses && velocities).then(Vec::new),
        kinetic_stress: (masses && velocities).then(Vec::new),
        contact_stress: Vec::new(),
        fabric: Vec::new(),
    };
    for layer in layers {
        all.solid_fraction.extend(&layer.solid);
        if let Some(kinetic) = &mut all.kinetic_stress {
            kinetic.extend(layer.kinetic_stress());
        }
        if let Some(velocity) = &mut all.velocity {
            velocity.extend(layer.velocity());
        }
        if let Some(momentum) = &mut all.momentum {
            momentum.extend(&layer.momentum);
        }
        if let Some(density) = &mut all.density {
            density.extend(&layer.mass);
        }
        all.contact_stress.extend(&layer.stress);
        all.fabric.extend(&layer.fabric);
    }
    all
}

impl FieldOptions {
    /// Width and spacing (m).
    fn lengths(&self, diameter: f64) -> Result<(f64, f64), AnalysisError> {
        let lengths = [self.width_over_d, self.spacing_over_d].map(|x| x * diameter);
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Option {
                name,
                value,
                allowed,
            })
        };
        if !(lengths[0] > 0.0 && lengths[0].is_finite()) {
            return refuse("width_over_d", self.width_over_d, "above zero and finite");
        }
        if !(lengths[1] > 0.0 && lengths[1] <= lengths[0]) {
            let allowed = "above zero and at most the width";
            return refuse("spacing_over_d", self.spacing_over_d, allowed);
        }
        Ok((lengths[0], lengths[1]))
    }
}

fn check_lists(bodies: usize, masses: &[f64], velocities: &[Vector3]) -> Result<(), AnalysisError> {
    for (name, given) in [("masses", masses.len()), ("velocities", velocities.len())] {
        if given != 0 && given != bodies {
            return Err(AnalysisError::BodyList {
                name,
                given,
                bodies,
            });
        }
    }
    if let Some(index) = masses.iter().position(|m| !(0.0..=1e100).contains(m)) {
        return Err(AnalysisError::Body {
            index,
            name: "mass",
            value: masses[index],
            allowed: "0 to 1e100 (kg)",
        });
    }
    let fast = |v: &Vector3| v.iter().copied().find(|x| x.is_nan() || x.abs() > 1e100);
    if let Some((index, value)) = velocities
        .iter()
        .enumerate()
        .find_map(|(i, v)| Some((i, fast(v)?)))
    {
        return Err(AnalysisError::Body {
            index,
            name: "velocity",
            value,
            allowed: "within ±1e100 (m/s)",
        });
    }
    Ok(())
}
