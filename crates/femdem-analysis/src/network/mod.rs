//! The input of all that concerns forces: bodies and contacts as plain data, checked once.

pub(crate) mod graph;
mod pairs;

use femdem_mesh::{Point3, Vector3};
use serde::{Deserialize, Serialize};

use crate::class::ContactClass;
use crate::coordination::{Partner, is_touching};
use crate::error::{AnalysisError, check_threshold};
use crate::images::PeriodicSpace;
use crate::pack::Pack;

pub use pairs::PairForce;

/// A body as a carrier of forces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceBody {
    /// Centre of mass (m).
    pub centre: Point3,
    /// Volume (m³), above zero.
    pub volume: f64,
    /// Circumscribed diameter (m), above zero.
    pub diameter: f64,
    /// Weight (N), along −z; 0 where it is not known or there is no gravity.
    pub weight: f64,
}

impl ForceBody {
    /// The bodies of a pack, of one specific weight ρ g (N/m³); 0 where it is not known.
    #[must_use]
    pub fn of_pack(pack: &Pack, specific_weight: f64) -> Vec<Self> {
        let body = |i: usize| {
            let volume = pack.shape(i).mass_properties().volume;
            Self {
                centre: pack.centroid(i),
                volume,
                diameter: 2.0 * pack.shape(i).bounding_radius(),
                weight: volume * specific_weight,
            }
        };
        (0..pack.len()).map(body).collect()
    }
}

/// A contact: one connected patch in which a body meets another or a wall.
///
/// The force on `second` is `normal * normal_force + tangential`; on `first` its opposite.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceContact {
    /// Index of the body.
    pub first: u32,
    /// What it touches.
    pub second: Partner,
    /// Where the force acts (m): the centre of pressure.
    pub point: Point3,
    /// Unit normal, from `first` towards `second`.
    pub normal: Vector3,
    /// Normal force (N), positive when it pushes the two apart.
    pub normal_force: f64,
    /// Friction force on `second` (N).
    pub tangential: Vector3,
    /// Moment on `second` about `point` (N m), such as torsion; zero where it is not known.
    pub moment: Vector3,
    /// How the surfaces meet, where it is known.
    pub class: Option<ContactClass>,
}

impl ForceContact {
    /// Force on `second` (N).
    #[must_use]
    pub fn force(&self) -> Vector3 {
        self.normal * self.normal_force + self.tangential
    }

    /// The two partners, as pairs have them.
    fn pair(&self) -> (u32, Partner) {
        match self.second {
            Partner::Body(second) if second < self.first => (second, Partner::Body(self.first)),
            second => (self.first, second),
        }
    }
}

/// Bodies and the contacts between them: the checked input of everything about forces.
///
/// ```
/// use femdem_analysis::{ForceBody, ForceContact, ForceNetwork, Partner};
/// use femdem_mesh::{Point3, Vector3};
///
/// // Two cubes of 1 m and 10 N, one upon the other, on a floor.
/// let cube = |z| ForceBody { centre: Point3::new(0.0, 0.0, z), volume: 1.0, diameter: 3_f64.sqrt(), weight: 10.0 };
/// let contact = |second, z, up: f64, normal_force| ForceContact {
///     first: 0,
///     second,
///     point: Point3::new(0.0, 0.0, z),
///     normal: Vector3::new(0.0, 0.0, up),
///     normal_force,
///     tangential: Vector3::zeros(),
///     moment: Vector3::zeros(),
///     class: None,
/// };
/// let bodies = [cube(0.5), cube(1.5)];
/// let contacts = [contact(Partner::Body(1), 1.0, 1.0, 10.0), contact(Partner::Wall(0), 0.0, -1.0, 20.0)];
/// let network = ForceNetwork::new(&bodies, &contacts, 0.0)?;
/// assert_eq!(network.pairs().len(), 2);
/// assert_eq!(network.pairs()[1].normal_force, 20.0);
/// # Ok::<(), femdem_analysis::AnalysisError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ForceNetwork<'a> {
    bodies: &'a [ForceBody],
    contacts: &'a [ForceContact],
    pairs: Vec<PairForce>,
    force_threshold: f64,
    space: Option<PeriodicSpace>,
}

impl<'a> ForceNetwork<'a> {
    /// Checks bodies and contacts, and sums the contacts of each pair. A pair whose summed normal force, pressing or pulling, is
    /// not larger than `force_threshold` (N) does not count as touching; stress and balance use all contacts.
    ///
    /// # Errors
    /// [`AnalysisError::EmptyPack`], [`AnalysisError::TooManyBodies`], [`AnalysisError::BodyIndex`],
    /// [`AnalysisError::SelfTouch`], [`AnalysisError::Option`] for a threshold that is below zero or not finite, and
    /// [`AnalysisError::Body`] or [`AnalysisError::Contact`] naming a quantity out of its range.
    pub fn new(
        bodies: &'a [ForceBody],
        contacts: &'a [ForceContact],
        force_threshold: f64,
    ) -> Result<Self, AnalysisError> {
        if bodies.is_empty() {
            return Err(AnalysisError::EmptyPack);
        }
        if u32::try_from(bodies.len()).is_err() {
            return Err(AnalysisError::TooManyBodies {
                bodies: bodies.len(),
            });
        }
        check_threshold(force_threshold)?;
        for (index, body) in bodies.iter().enumerate() {
            body.check(index)?;
        }
        for (index, contact) in contacts.iter().enumerate() {
            contact.check(index, bodies.len())?;
        }
        let mut pairs = pairs::of_contacts(contacts);
        pairs.retain(|pair| is_touching(pair.normal_force, force_threshold));
        Ok(Self {
            bodies,
            contacts,
            pairs,
            force_threshold,
            space: None,
        })
    }

    /// The same network in periodic space: every way between two bodies, and from a body to its contact, is the shortest of
    /// all images.
    #[must_use]
    pub fn in_space(self, space: Option<PeriodicSpace>) -> Self {
        Self { space, ..self }
    }

    /// The periodic space in which it lies, if it does.
    #[must_use]
    pub fn space(&self) -> Option<&PeriodicSpace> {
        self.space.as_ref()
    }

    /// Whether space repeats itself along an axis, 0 to 2.
    pub(crate) fn repeats(&self, axis: usize) -> bool {
        self.space.is_some_and(|space| space.cell.repeats(axis))
    }

    /// From the centre of one body to that of another (m).
    pub(crate) fn branch(&self, from: u32, to: u32) -> Vector3 {
        self.shortest(self.centre(to) - self.centre(from))
    }

    /// From the centre of a body to the contact that loads it (m).
    pub(crate) fn lever(&self, load: &Load) -> Vector3 {
        self.shortest(load.contact.point - self.centre(load.body))
    }

    fn shortest(&self, way: Vector3) -> Vector3 {
        self.space.map_or(way, |space| space.cell.shortest(&way))
    }

    /// The bodies.
    #[must_use]
    pub fn bodies(&self) -> &'a [ForceBody] {
        self.bodies
    }

    /// The contacts, as given.
    #[must_use]
    pub fn contacts(&self) -> &'a [ForceContact] {
        self.contacts
    }

    /// The touching pairs, sorted; pairs of bodies have the lower index first.
    #[must_use]
    pub fn pairs(&self) -> &[PairForce] {
        &self.pairs
    }

    /// Force above which a pair counts (N).
    #[must_use]
    pub fn force_threshold(&self) -> f64 {
        self.force_threshold
    }

    /// Mean circumscribed diameter (m).
    #[must_use]
    pub fn mean_diameter(&self) -> f64 {
        self.bodies.iter().map(|b| b.diameter).sum::<f64>() / self.bodies.len() as f64
    }

    /// Mean normal force of the pairs of bodies that press on each other (N), walls left out; `None` without any.
    #[must_use]
    pub fn mean_force(&self) -> Option<f64> {
        let forces = self.pressing_pairs().map(|(_, _, pair)| pair.normal_force);
        let (sum, count) = forces.fold((0.0, 0_u32), |(sum, n), f| (sum + f, n + 1));
        (count > 0).then(|| sum / f64::from(count))
    }

    /// The touching pairs of bodies.
    pub(crate) fn body_pairs(&self) -> impl Iterator<Item = (u32, u32, &PairForce)> {
        self.pairs.iter().filter_map(|pair| match pair.second {
            Partner::Body(second) => Some((pair.first, second, pair)),
            Partner::Wall(_) => None,
        })
    }

    /// Those that press on each other.
    pub(crate) fn pressing_pairs(&self) -> impl Iterator<Item = (u32, u32, &PairForce)> {
        self.body_pairs()
            .filter(|(_, _, pair)| pair.normal_force > 0.0)
    }

    /// The contacts of touching pairs: every patch, however weak it is.
    pub(crate) fn touching_contacts(&self) -> impl Iterator<Item = &'a ForceContact> {
        self.contacts.iter().filter(|contact| {
            let key = contact.pair();
            self.pairs
                .binary_search_by_key(&key, |pair| (pair.first, pair.second))
                .is_ok()
        })
    }

    /// Per body whether it touches anything.
    pub(crate) fn touches(&self) -> Vec<bool> {
        let mut touches = vec![false; self.bodies.len()];
        for pair in &self.pairs {
            touches[pair.first as usize] = true;
            if let Partner::Body(second) = pair.second {
                touches[second as usize] = true;
            }
        }
        touches
    }

    /// For each contact the bodies that it acts on, with the force and moment on them.
    pub(crate) fn loads(&self) -> impl Iterator<Item = Load<'a>> {
        self.contacts.iter().flat_map(|contact| {
            let second = match contact.second {
                Partner::Body(second) => Some((second, 1.0)),
                Partner::Wall(_) => None,
            };
            [Some((contact.first, -1.0)), second]
                .into_iter()
                .flatten()
                .map(move |(body, sign)| Load {
                    body,
                    force: contact.force() * sign,
                    moment: contact.moment * sign,
                    contact,
                })
        })
    }

    /// Centre of a body; the constructor has checked all indices.
    pub(crate) fn centre(&self, body: u32) -> Point3 {
        self.bodies[body as usize].centre
    }

    /// That every body has a weight.
    pub(crate) fn need_weights(&self) -> Result<(), AnalysisError> {
        match self.bodies.iter().position(|b| b.weight <= 0.0) {
            Some(body) => Err(AnalysisError::NoWeight { body }),
            None => Ok(()),
        }
    }
}

/// Largest magnitude of anything given, in its SI unit: its square is a number.
const LARGEST: f64 = 1e100;

fn usable(number: f64) -> bool {
    number.abs() <= LARGEST
}

fn first_not_usable<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> Option<f64> {
    numbers.into_iter().copied().find(|x| !usable(*x))
}

/// What a contact does to one of its bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Load<'a> {
    pub(crate) body: u32,
    /// Force on the body (N).
    pub(crate) force: Vector3,
    /// Moment on the body about the contact point (N m).
    pub(crate) moment: Vector3,
    pub(crate) contact: &'a ForceContact,
}

impl ForceBody {
    fn check(&self, index: usize) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Body {
                index,
                name,
                value,
                allowed,
            })
        };
        if let Some(bad) = first_not_usable(self.centre.iter()) {
            return refuse("centre", bad, "within ±1e100 (m)");
        }
        if !usable(self.volume) || self.volume <= 0.0 {
            return refuse("volume", self.volume, "above 0, at most 1e100 (m³)");
        }
        if !usable(self.diameter) || self.diameter <= 0.0 {
            return refuse("diameter", self.diameter, "above 0, at most 1e100 (m)");
        }
        if !usable(self.weight) || self.weight < 0.0 {
            return refuse("weight", self.weight, "0 to 1e100 (N)");
        }
        Ok(())
    }
}

impl ForceContact {
    fn check(&self, index: usize, bodies: usize) -> Result<(), AnalysisError> {
        let refuse = |name, value, allowed| {
            Err(AnalysisError::Contact {
                index,
                name,
                value,
                allowed,
            })
        };
        let known = |body: u32| {
            let inside = (body as usize) < bodies;
            inside.then_some(()).ok_or(AnalysisError::BodyIndex {
                what: "contact",
                index,
                body,
                bodies,
            })
        };
        known(self.first)?;
        if let Partner::Body(second) = self.second {
            known(second)?;
            if second == self.first {
                return Err(AnalysisError::SelfTouch {
                    index,
                    body: second,
                });
            }
        }
        if let Some(bad) = first_not_usable(self.point.iter()) {
            return refuse("point", bad, "within ±1e100 (m)");
        }
        // Written so that NaN fails it too.
        let length = self.normal.norm();
        let unit = (length - 1.0).abs() <= 1e-6;
        if !unit {
            return refuse("normal's length", length, "1 to 1e-6");
        }
        if !usable(self.normal_force) {
            return refuse("normal_force", self.normal_force, "within ±1e100 (N)");
        }
        if let Some(bad) = first_not_usable(self.tangential.iter()) {
            return refuse("tangential", bad, "within ±1e100 (N)");
        }
        if let Some(bad) = first_not_usable(self.moment.iter()) {
            return refuse("moment", bad, "within ±1e100 (N m)");
        }
        Ok(())
    }
}
