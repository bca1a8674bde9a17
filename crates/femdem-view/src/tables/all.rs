//! All tables of a pack.

use femdem_analysis::{
    Bed, BodyStresses, ChainNetwork, ContactClasses, ContactFabric, Coordination, CoreRegion,
    DensityMap, DensityProfile, Estimate, Fields, ForceDistribution, ForceMaxima, ForceNetwork,
    FreeSurface, Mixing, Pack, PackingDensity, RadialDistribution, Rattlers, RegionStress,
    SetVoronoi, SieveCurve, StressProfile, ThresholdCurve, TiltHistogram, VerticalBalance,
    WallForces,
};
use serde::{Deserialize, Serialize, Serializer};

use super::network::Data;
use super::options::{SAME_SIZE, TableOptions};
use super::orientation::Orientation;
use crate::{Snapshot, ViewError};

/// Version of the keys of `analysis.json`.
pub const SCHEMA: u32 = 1;

/// A table, or a value of one, that could not be computed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Missing {
    /// Name of the table (its field in [`Tables`]), or the path of the value in it.
    pub table: String,
    /// The reason, and the input needed.
    pub reason: String,
}

/// Everything that was computed about a pack. A table that could not be made is `None` and has an entry in
/// [`missing`](Self::missing).
///
/// Serialised, it is `analysis.json`. Lists by body and by cell are left out there because of their length:
/// they are in the CSV files written by [`write`](Self::write).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tables {
    /// Version of these keys: [`SCHEMA`].
    pub schema: u32,
    /// How it was measured.
    pub options: TableOptions,
    /// What could not be computed, with the reasons.
    pub missing: Vec<Missing>,
    /// Number of bodies.
    pub bodies: usize,
    /// Number of contacts.
    pub contacts: usize,
    /// Mean circumscribed diameter d \[m\].
    pub diameter: f64,
    /// Sizes of the bodies as a sieve curve by mass, or by volume without masses; `None` if all have one size, to 1 %. In CSV only.
    #[serde(skip)]
    pub sieve: Option<SieveCurve>,
    /// Names of the walls, by the numbers that tables use.
    pub walls: Vec<String>,
    /// The core region.
    pub core: Option<CoreRegion>,
    /// Void fraction of the whole bed, from the floor to the mean top.
    pub bed: Option<Bed>,
    /// Slope of the free surface, where bodies cover at least the square of 8 mean diameters; `None`, without an entry in
    /// `missing`, if space repeats itself along z.
    pub surface: Option<FreeSurface>,
    /// Packing density of the core.
    pub density: Option<PackingDensity>,
    /// Packing density over the height of the container.
    pub height_profile: Option<DensityProfile>,
    /// Packing density over the distance from the side walls, between the core's heights.
    pub wall_profile: Option<DensityProfile>,
    /// Local packing density in the container; in CSV and VTI only.
    #[serde(skip)]
    pub density_map: Option<DensityMap>,
    /// Set-Voronoi cells between the floor and the mean top; the cells themselves in CSV only.
    #[serde(serialize_with = "without_cells")]
    pub set_voronoi: Option<SetVoronoi>,
    /// Orientations of the bodies.
    pub orientation: Option<Orientation>,
    /// Tilt of each body in degrees; in CSV only.
    #[serde(skip)]
    pub tilts: Vec<Option<f64>>,
    /// Histogram of the tilts.
    pub tilt: Option<TiltHistogram>,
    /// Mixing of the shapes of a mixture; `None`, without an entry in `missing`, for a single shape.
    pub mixing_by_shape: Option<Mixing>,
    /// Mixing of smaller and larger bodies; `None`, without an entry in `missing`, for a single size.
    pub mixing_by_size: Option<Mixing>,
    /// Radial distribution function of the centres in the core.
    pub radial_distribution: Option<RadialDistribution>,
    /// Coordination number over all bodies.
    pub coordination: Option<Coordination>,
    /// Its mean with the error by block bootstrap.
    pub mean_coordination: Option<Estimate>,
    /// Coordination number over the bodies with their centre in the core.
    pub core_coordination: Option<Coordination>,
    /// Its mean with the error by block bootstrap.
    pub core_mean_coordination: Option<Estimate>,
    /// Contacts by class.
    pub classes: Option<ContactClasses>,
    /// Rattlers, and the count of constraints.
    pub rattlers: Option<Rattlers>,
    /// P(f).
    pub force_distribution: Option<ForceDistribution>,
    /// Largest contact force of each body over its weight.
    pub force_maxima: Option<ForceMaxima>,
    /// Force chains by the founding paper's rule.
    pub chains_by_weight: Option<ChainNetwork>,
    /// Force chains by the rule of Peters et al. (2005).
    pub chains_by_stress: Option<ChainNetwork>,
    /// Components and cycles against threshold.
    pub threshold_curve: Option<ThresholdCurve>,
    /// Love-Weber stress of each body; in CSV only.
    #[serde(skip)]
    pub body_stresses: Option<BodyStresses>,
    /// Mean stress of the core.
    pub core_stress: Option<RegionStress>,
    /// Stress over the height of the container.
    pub stress_profile: Option<StressProfile>,
    /// Vertical balance.
    pub vertical_balance: Option<VerticalBalance>,
    /// Forces on the walls.
    pub wall_forces: Option<WallForces>,
    /// Fabric of the contacts between bodies.
    pub fabric: Option<ContactFabric>,
    /// Coarse-grained fields, if the options ask for them; in VTI only.
    #[serde(skip)]
    pub fields: Option<Fields>,
}

impl Tables {
    /// Computes every measurement that the data of a pack allow.
    ///
    /// # Errors
    ///
    /// As [`Snapshot::check`], and [`ViewError::Analysis`] for a pack without bodies, an invalid contact or an
    /// option out of its range.
    pub fn compute(snapshot: &Snapshot, options: &TableOptions) -> Result<Self, ViewError> {
        snapshot.check()?;
        let (shapes, bodies) = snapshot.posed();
        let pack = Pack::new(&shapes, &bodies)?;
        let data = Data::of(snapshot);
        let network = ForceNetwork::new(&data.bodies, &data.contacts, options.force_threshold)?
            .in_space(snapshot.space);
        let mut tables = Self::empty(snapshot, options, &network, data.walls.clone());
        tables.add_orientation(&pack)?;
        tables.add_geometry(snapshot)?;
        tables.add_tilt(snapshot, &pack)?;
        tables.add_mixing(snapshot, &pack)?;
        tables.add_radial_distribution(&pack)?;
        tables.add_contacts(snapshot, &pack)?;
        tables.add_forces(snapshot, &network)?;
        tables.add_fields(snapshot, &network)?;
        Ok(tables)
    }

    fn empty(
        snapshot: &Snapshot,
        options: &TableOptions,
        network: &ForceNetwork,
        walls: Vec<String>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            options: options.clone(),
            missing: Vec::new(),
            bodies: snapshot.bodies.len(),
            contacts: snapshot.contacts.len(),
            diameter: network.mean_diameter(),
            sieve: sieve(snapshot),
            walls,
            core: None,
            bed: None,
            surface: None,
            density: None,
            height_profile: None,
            wall_profile: None,
            density_map: None,
            set_voronoi: None,
            orientation: None,
            tilts: Vec::new(),
            tilt: None,
            mixing_by_shape: None,
            mixing_by_size: None,
            radial_distribution: None,
            coordination: None,
            mean_coordination: None,
            core_coordination: None,
            core_mean_coordination: None,
            classes: None,
            rattlers: None,
            force_distribution: None,
            force_maxima: None,
            chains_by_weight: None,
            chains_by_stress: None,
            threshold_curve: None,
            body_stresses: None,
            core_stress: None,
            stress_profile: None,
            vertical_balance: None,
            wall_forces: None,
            fabric: None,
            fields: None,
        }
    }

    /// Records tables that cannot be made.
    pub(super) fn miss(&mut self, tables: &[&str], reason: &str) {
        self.missing.extend(tables.iter().map(|table| Missing {
            table: (*table).to_owned(),
            reason: reason.to_owned(),
        }));
    }
}

/// The sieve curve of bodies that differ in size.
fn sieve(snapshot: &Snapshot) -> Option<SieveCurve> {
    let bodies = snapshot.bodies.iter().enumerate().map(|(row, body)| {
        let surface = &snapshot.shape_of(body).polyhedron;
        let mass = snapshot.masses.get(row).copied();
        let mass = mass.unwrap_or_else(|| surface.mass_properties().volume);
        (2.0 * surface.bounding_radius(), mass)
    });
    let curve = SieveCurve::new(bodies);
    let (least, most) = (curve.points.first()?.size, curve.points.last()?.size);
    (most > least * (1.0 + SAME_SIZE)).then_some(curve)
}

fn without_cells<S: Serializer>(found: &Option<SetVoronoi>, to: S) -> Result<S::Ok, S::Error> {
    let short = found.as_ref().map(|found| SetVoronoi {
        cells: Vec::new(),
        ..found.clone()
    });
    short.serialize(to)
}
