//! Cracks and fragments as plain data.

use femdem_analysis::Fragmentation;
use femdem_mesh::{Point3, Vector3};

use crate::ViewError;

/// How a crack opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CrackMode {
    /// Mostly pulled apart (mode I).
    #[default]
    Tension,
    /// Mostly slid (modes II and III).
    Shear,
}

impl CrackMode {
    /// 0 for tension, 1 for shear: the number in files.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::Tension => 0,
            Self::Shear => 1,
        }
    }
}

/// A facet along which a body breaks or has broken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackFacet {
    /// The body.
    pub body: u32,
    /// The facet's corners, in the middle between its two sides \[m\].
    pub points: [Point3; 3],
    /// How far the sides are apart along the normal \[m\]; negative where they press on each other.
    pub opening: f64,
    /// How far the sides have slid, a length of 0 or more \[m\].
    pub slip: f64,
    /// Lost share of the strength, 0 to 1; 1 is a free surface.
    pub damage: f64,
    /// How it opened.
    pub mode: CrackMode,
    /// When damage began \[s\].
    pub birth: f64,
    /// Energy that breaking it has taken so far \[J\].
    pub dissipated: f64,
}

impl CrackFacet {
    /// Normal times twice the area \[m^2\].
    pub(crate) fn normal(&self) -> Vector3 {
        let [a, b, c] = self.points;
        (b - a).cross(&(c - a))
    }
}

/// A facet that has broken through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackEvent {
    /// When \[s\].
    pub time: f64,
    /// Where \[m\].
    pub point: Point3,
    /// Energy that breaking it took \[J\].
    pub energy: f64,
    /// How it opened.
    pub mode: CrackMode,
}

/// A fragment: what it is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FragmentRow {
    /// The body that it is a part of.
    pub body: u32,
    /// Volume \[m^3\].
    pub volume: f64,
    /// Mass \[kg\].
    pub mass: f64,
    /// Sieve size \[m\], [`FragmentSize::sieve_size`](femdem_analysis::FragmentSize::sieve_size).
    pub sieve_size: f64,
    /// Wadell's sphericity, if known.
    pub sphericity: Option<f64>,
    /// Centre of mass \[m\].
    pub centre: Point3,
    /// Velocity of the centre of mass \[m/s\].
    pub velocity: Vector3,
}

/// What a report shows of fracture; what is empty is left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fracture {
    /// The size distribution of the fragments.
    pub fragmentation: Option<Fragmentation>,
    /// Times \[s\] and the energy that fracture has taken up to them \[J\].
    pub dissipated: Vec<[f64; 2]>,
    /// The facets of the cracks.
    pub cracks: Vec<CrackFacet>,
}

/// Refuses facets with numbers that are not finite or out of their range.
pub(crate) fn check_cracks(facets: &[CrackFacet]) -> Result<(), ViewError> {
    for (index, facet) in facets.iter().enumerate() {
        let of = Quantities("crack facet", index);
        for point in &facet.points {
            of.finite("points", point.iter())?;
        }
        of.finite("opening", [&facet.opening])?;
        of.positive("slip", facet.slip)?;
        of.within("damage", facet.damage, 1.0, "0 to 1")?;
        of.finite("birth", [&facet.birth])?;
        of.positive("dissipated", facet.dissipated)?;
    }
    Ok(())
}

pub(crate) fn check_events(events: &[CrackEvent]) -> Result<(), ViewError> {
    for (index, event) in events.iter().enumerate() {
        let of = Quantities("event", index);
        of.finite("time", [&event.time])?;
        of.finite("point", event.point.iter())?;
        of.positive("energy", event.energy)?;
    }
    Ok(())
}

pub(crate) fn check_fragments(fragments: &[FragmentRow]) -> Result<(), ViewError> {
    for (index, row) in fragments.iter().enumerate() {
        let of = Quantities("fragment", index);
        of.positive("volume", row.volume)?;
        of.positive("mass", row.mass)?;
        of.positive("sieve_size", row.sieve_size)?;
        // Rounding may take that of a ball above 1.
        of.within(
            "sphericity",
            row.sphericity.unwrap_or(1.0),
            1.0 + 1e-6,
            "0 to 1",
        )?;
        of.finite("centre", row.centre.iter())?;
        of.finite("velocity", row.velocity.iter())?;
    }
    Ok(())
}

/// What is checked, and its index.
struct Quantities(&'static str, usize);

impl Quantities {
    fn finite<'a>(
        &self,
        name: &'static str,
        values: impl IntoIterator<Item = &'a f64>,
    ) -> Result<(), ViewError> {
        match values.into_iter().find(|x| !x.is_finite()) {
            Some(bad) => self.refuse(name, *bad, "finite"),
            None => Ok(()),
        }
    }

    fn positive(&self, name: &'static str, value: f64) -> Result<(), ViewError> {
        self.within(name, value, f64::MAX, "0 or more and finite")
    }

    fn within(
        &self,
        name: &'static str,
        value: f64,
        most: f64,
        allowed: &'static str,
    ) -> Result<(), ViewError> {
        if (0.0..=most).contains(&value) {
            return Ok(());
        }
        self.refuse(name, value, allowed)
    }

    fn refuse(
        &self,
        name: &'static str,
        value: f64,
        allowed: &'static str,
    ) -> Result<(), ViewError> {
        Err(ViewError::Quantity {
            what: self.0,
            index: self.1,
            name,
            value,
            allowed,
        })
    }
}
