//! Loads on bodies in a scenario: forces, torques and accelerations, constant or over time.

mod begin;

use std::collections::{BTreeMap, BTreeSet};

use femdem_contact::{BodyId, Wrench};
use femdem_fem::Curve;
use femdem_mesh::{Point3, Vector3};
use femdem_solve::{AppliedLoad, Halo, World};
use serde::{Deserialize, Serialize};

use super::Member;
use crate::Error;
use crate::error::wrong;
use crate::gather::of_all;
use crate::scene::in_metres;

/// A load on bodies: exactly one of `force`, `torque`, `acceleration` and `force-density`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct LoadEntry {
    /// Names of bodies, or of entries whose copies are meant. Empty: all bodies.
    pub bodies: Vec<String>,
    /// Force on each body \[N\], of which its fragments bear as much as they have of its mass.
    pub force: Option<[f64; 3]>,
    /// Torque on each rigid body \[N m\].
    pub torque: Option<[f64; 3]>,
    /// Force over the mass of each body \[m/s²\].
    pub acceleration: Option<[f64; 3]>,
    /// Force over the volume of each rigid body \[N/m³\].
    pub force_density: Option<[f64; 3]>,
    /// Point of each rigid body at which `force` acts, in the coordinates of its shape \[m\]. `None`: the centroid.
    #[serde(deserialize_with = "in_metres")]
    pub point: Option<[f64; 3]>,
    /// The axes of the vector.
    pub axes: Axes,
    /// Time over which the load rises from zero \[s\].
    pub rise: Option<f64>,
    /// Factor of the load over time, as points \[s, factor\] with straight lines between.
    pub table: Option<Vec<[f64; 2]>>,
}

/// The axes in which a load is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Axes {
    /// Those of the world: the load keeps its direction.
    #[default]
    World,
    /// Those of the body's shape: the load turns with the body.
    Body,
}

impl LoadEntry {
    /// The time from which on it is constant \[s\].
    pub(super) fn settled_from(&self) -> f64 {
        let table = self.table.iter().flatten().map(|[time, _]| *time);
        table.chain(self.rise).fold(0.0, f64::max)
    }

    /// Its factor over time.
    fn factor(&self) -> Result<Curve, Error> {
        let curve = match (self.rise, &self.table) {
            (None, None) => Curve::Constant(1.0),
            (Some(rise), None) => Curve::Ramp { value: 1.0, rise },
            (None, Some(table)) => Curve::Table(table.clone()),
            (Some(_), Some(_)) => {
                let allowed = "give one of the two, or neither";
                return Err(wrong("rise and table", "both given", allowed));
            }
        };
        curve.validate()?;
        Ok(curve)
    }

    fn kind(&self) -> Result<(Kind, Vector3), Error> {
        let given = [
            (Kind::Force, self.force),
            (Kind::Torque, self.torque),
            (Kind::Acceleration, self.acceleration),
            (Kind::Density, self.force_density),
        ];
        let mut given = given
            .into_iter()
            .filter_map(|(kind, vector)| Some((kind, vector?)));
        let (Some((kind, vector)), None) = (given.next(), given.next()) else {
            return Err(wrong(
                "load",
                "none or several of its kinds",
                "give exactly one of force, torque, acceleration and force-density",
            ));
        };
        if self.point.is_some() && kind != Kind::Force {
            let allowed = "for a force only: all others act on the whole body";
            return Err(wrong("point", "given", allowed));
        }
        let numbers = vector.into_iter().chain(self.point.into_iter().flatten());
        if numbers.into_iter().any(|x| !x.is_finite()) {
            let allowed = "three finite numbers each";
            return Err(wrong(
                "a vector of the load",
                &format!("{vector:?}"),
                allowed,
            ));
        }
        Ok((kind, Vector3::from(vector)))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum Kind {
    Force,
    Torque,
    Acceleration,
    Density,
}

/// A load of a simulation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct OnBodies {
    /// Names of bodies and of groups; empty: all.
    names: Vec<String>,
    kind: Kind,
    vector: Vector3,
    point: Option<Vector3>,
    axes: Axes,
    factor: Curve,
}

/// The loads of a simulation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyLoads {
    loads: Vec<OnBodies>,
    /// For each member, the numbers of the loads on it.
    of_members: Vec<Vec<u32>>,
    /// Factors of the loads on the bodies now; `None` if there is a body that has not got its load.
    acting: Option<Vec<f64>>,
}

/// Whether `name` is that of a member, or of a group whose members have a number behind it.
fn names(name: &str, member: &str) -> bool {
    member.strip_prefix(name).is_some_and(|rest| {
        let number = rest.strip_prefix(' ');
        rest.is_empty() || number.is_some_and(|number| number.parse::<u32>().is_ok())
    })
}

impl OnBodies {
    fn new(entry: &LoadEntry) -> Result<Self, Error> {
        let (kind, vector) = entry.kind()?;
        Ok(Self {
            names: entry.bodies.clone(),
            kind,
            vector,
            point: entry.point.map(Vector3::from),
            axes: entry.axes,
            factor: entry.factor()?,
        })
    }

    fn is_on(&self, member: &str) -> bool {
        self.names.is_empty() || self.names.iter().any(|name| names(name, member))
    }

    /// The load at a factor of 1 on a body that has a share of the mass of the whole of which it is a fragment; `None` for a body that
    /// has left.
    fn on(&self, id: BodyId, share: f64, world: &World) -> Result<Option<AppliedLoad>, Error> {
        let Some(mass) = world.mass(id) else {
            return Ok(None);
        };
        let rigid = world.shape_of(id).and_then(|shape| world.shape(shape));
        let is_plain = matches!(self.kind, Kind::Force | Kind::Acceleration)
            && self.point.is_none()
            && self.axes == Axes::World;
        if !is_plain && (rigid.is_none() || world.is_adaptive(id)) {
            return Err(wrong(
                "load",
                "a torque, force-density, point or body axes for a deformable or adaptive body",
                "a force or an acceleration in world axes; give others by the boundary of a deformable one",
            ));
        }
        let Some(shape) = rigid else {
            let scale = if self.kind == Kind::Force {
                share
            } else {
                mass
            };
            return Ok(Some(force(self.vector * scale).into()));
        };
        let scale = match self.kind {
            Kind::Force | Kind::Torque => 1.0,
            Kind::Acceleration => mass,
            Kind::Density => shape.volume,
        };
        let vector = self.vector * scale;
        let arm = self.point.map_or(Vector3::zeros(), |point| {
            // A ball has its centre at the origin of its coordinates.
            let centroid = match shape.sphere {
                Some(_) => Point3::origin(),
                None => shape.polyhedron.mass_properties().centroid,
            };
            point - centroid.coords
        });
        Ok(Some(match (self.kind, self.axes) {
            (Kind::Torque, Axes::World) => torque(vector).into(),
            (Kind::Torque, Axes::Body) => AppliedLoad {
                turning: torque(vector),
                ..AppliedLoad::default()
            },
            (_, Axes::World) => AppliedLoad::at_point(vector, arm),
            (_, Axes::Body) => AppliedLoad::turning(vector, arm),
        }))
    }
}

fn force(force: Vector3) -> Wrench {
    Wrench {
        force,
        torque: Vector3::zeros(),
    }
}

fn torque(torque: Vector3) -> Wrench {
    Wrench {
        force: Vector3::zeros(),
        torque,
    }
}

/// Of bodies that have fragments and loads, with these, by number among the members, kg. `on` are the loads of each member, and
/// `mass` is that of a member of this rank.
fn masses_of_broken(
    members: &[Member],
    on: &[Vec<u32>],
    mass: impl Fn(&Member) -> Option<f64>,
    halo: &mut dyn Halo,
) -> Result<BTreeMap<u32, f64>, Error> {
    let loaded = (0..).zip(members).zip(on);
    let loaded = loaded.filter(|(_, on)| !on.is_empty());
    let loaded: Vec<(u32, &Member)> = loaded.map(|(member, _)| member).collect();
    let firsts: BTreeSet<u32> = loaded.iter().filter_map(|(_, member)| member.of).collect();
    let mut masses = BTreeMap::new();
    if firsts.is_empty() {
        return Ok(masses);
    }
    let broken = loaded.into_iter();
    let broken = broken.filter(|(number, member)| member.of.is_some() || firsts.contains(number));
    let own = broken.filter_map(|(number, member)| {
        let first = member.of.unwrap_or(number);
        Some((number, first, mass(member)?))
    });
    let own: Vec<(u32, u32, f64)> = own.collect();
    // In the order of the members, whichever rank they are on.
    let mut all = of_all(own, halo)?;
    all.sort_by_key(|(number, ..)| *number);
    for (_, first, mass) in all {
        *masses.entry(first).or_insert(0.0) += mass;
    }
    Ok(masses)
}

impl BodyLoads {
    /// The number of a load on a member that is not there, and how many are.
    pub(super) fn misfit(&self) -> Option<[usize; 2]> {
        let count = self.loads.len();
        let mut numbers = self.of_members.iter().flatten().map(|n| *n as usize);
        Some([numbers.find(|number| *number >= count)?, count])
    }

    /// Notes a new member. A fragment has the loads of the body that broke.
    pub(super) fn add_member(&mut self, member: &Member) {
        let whole = member.of.and_then(|of| self.of_members.get(of as usize));
        let on = whole.cloned().unwrap_or_else(|| {
            let loads = (0..).zip(&self.loads);
            let on = loads.filter(|(_, load)| load.is_on(&member.name));
            on.map(|(number, _)| number).collect()
        });
        self.of_members.push(on);
        self.acting = None;
    }

    /// Whether there are none.
    pub(in crate::run) fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Loads the members of a world, which ranks may share, with the loads at a time \[s\].
    pub(in crate::run) fn apply(
        &mut self,
        members: &[Member],
        world: &mut World,
        time: f64,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        let factors: Vec<f64> = self.loads.iter().map(|load| load.factor.at(time)).collect();
        if self.acting.as_ref() == Some(&factors) {
            return Ok(());
        }
        let here = |id: BodyId| world.number_here(id).filter(|id| !world.is_guest(*id));
        let mass = |member: &Member| here(member.id).and_then(|id| world.mass(id));
        let masses = masses_of_broken(members, &self.of_members, mass, halo)?;
        let mut loads = Vec::new();
        let each = (0..).zip(members).zip(&self.of_members);
        for ((number, member), numbers) in each {
            let Some(id) = here(member.id).filter(|_| !numbers.is_empty()) else {
                continue;
            };
            let whole = masses.get(&member.of.unwrap_or(number));
            let share = whole
                .zip(world.mass(id))
                .map_or(1.0, |(all, own)| own / all);
            let mut sum = AppliedLoad::default();
            for &number in numbers {
                let load = self.loads[number as usize].on(id, share, world)?;
                let Some(load) = load else { continue };
                sum = sum + load * factors[number as usize];
            }
            loads.push((member.id, sum));
        }
        world.set_loads_on(&loads, halo)?;
        self.acting = Some(factors);
        Ok(())
    }
}

/// The loads of a run over ranks, with the bodies that have any.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct LoadedMembers {
    members: Vec<Member>,
    loads: BodyLoads,
}

impl LoadedMembers {
    /// Those of a run; all members if some of its bodies may break, since fragments tell by number of which they are.
    pub fn of(loads: &BodyLoads, members: &[Member], may_break: bool) -> Self {
        let each = members.iter().zip(&loads.of_members);
        let loaded = each.filter(|(_, numbers)| may_break || !numbers.is_empty());
        let (members, of_members) = loaded.map(|(m, n)| (m.clone(), n.clone())).unzip();
        let loads = BodyLoads {
            loads: loads.loads.clone(),
            of_members,
            acting: loads.acting.clone(),
        };
        Self { members, loads }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.loads.is_empty()
    }

    /// Notes a new member of the run.
    pub fn add(&mut self, member: &Member) {
        if !self.is_empty() {
            self.loads.add_member(member);
            self.members.push(member.clone());
        }
    }

    /// Forgets bodies that have left.
    pub fn forget(&mut self, gone: &[BodyId]) {
        for member in self.members.iter_mut().filter(|m| gone.contains(&m.id)) {
            member.id = Member::GONE;
        }
    }

    /// As [`BodyLoads::apply`].
    pub fn apply(
        &mut self,
        world: &mut World,
        time: f64,
        halo: &mut dyn Halo,
    ) -> Result<(), Error> {
        self.loads.apply(&self.members, world, time, halo)
    }

    /// Tells the loads of the run what acts now.
    pub fn give_back(&self, loads: &mut BodyLoads) {
        loads.acting.clone_from(&self.loads.acting);
    }
}
