//! Watch over overlaps that the penalty cannot carry.

use std::collections::{BTreeMap, BTreeSet};

use femdem_contact::{Partner, WallShape};
use femdem_mesh::Vector3;
use femdem_solve::Alone;
use serde::{Deserialize, Serialize};

use super::Simulation;
use super::contacts::Side;
use super::depths::{Beside, Deep, Depth, Depths, EVERY};
use crate::Error;

/// A run stops where more than this share of the smaller body's volume lies in the other side.
const MOST: f64 = 0.5;

/// The share that a penalty should be chosen for, in the advice.
const WANTED: f64 = 0.05;

/// Overlap with a sheet, over its thickness times the section of the body, from which a contact whose normal turns round is that of
/// a body that passes through.
const WITHIN: f64 = 0.25;

/// What a run keeps in mind of overlaps from step to step.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Watch {
    /// The deepest contact of all steps.
    pub deepest: Deepest,
    /// Warnings so far.
    pub warnings: Vec<String>,
    /// Normals of the contacts between walls of tetrahedra and rigid bodies in the last step.
    sides: BTreeMap<(u32, u32), [f64; 3]>,
}

/// The deepest contact.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Deepest {
    /// m.
    pub depth: f64,
    /// s.
    pub time: f64,
    /// Names of the two sides.
    pub between: [String; 2],
}

impl Watch {
    /// Looks at the contacts after a step. Warns once of a deep overlap, and refuses to go on where a rigid body has gone through
    /// a wall, or lies in another or in a wall by more than half of the smaller one's volume: the contact force falls from there
    /// on, and what comes then means nothing.
    ///
    /// # Errors
    ///
    /// [`Error::Through`] with the pair and a penalty that would do.
    pub fn look(&mut self, simulation: &Simulation) -> Result<(), Error> {
        let warned = !self.warnings.is_empty();
        let depths = simulation.depths(self.deepest.depth, warned, &mut Alone)?;
        self.see(&depths, simulation);
        let through = match self.passed(simulation) {
            Some(pair) => Some((pair, 1.0)),
            None if simulation.world.steps().is_multiple_of(EVERY) => simulation.swallowed(),
            None => None,
        };
        let Some((pair, share)) = through else {
            return Ok(());
        };
        let penalty = simulation.penalty_between(pair);
        let [a, b] = pair.map(|side| simulation.name_of(side));
        Err(Error::Through {
            a,
            b,
            share,
            time: simulation.world.time(),
            penalty,
            // The energy of an impact is p times the square of the depth.
            enough: penalty * (share / WANTED).powi(2),
        })
    }

    /// Records the deepest contact, and warns of the first deep one.
    pub fn see(&mut self, depths: &Depths, simulation: &Simulation) {
        let time = simulation.world.time();
        let names = |sides: &[Partner; 2]| sides.map(|side| simulation.name_of_partner(side));
        if let Some(Depth { depth, sides }) = &depths.deepest {
            self.deepest = Deepest {
                depth: *depth,
                time,
                between: names(sides),
            };
        }
        let Some(Deep { at, of }) = &depths.deep else {
            return;
        };
        let ([a, b], depth) = (names(&at.sides), at.depth);
        self.warnings.push(match of {
            Beside::Thickness(thickness, penalty) => {
                let share = depth / thickness;
                let enough = penalty * (share / WANTED).powi(2);
                format!(
                    "{b} overlaps {a} by {:.0} % of its thickness, {depth:.2e} m, at {time:.6} s: the penalty of {penalty:.2e} Pa is soft \
                     for it; contact.penalty, or that of their pair, = {enough:.1e} would do",
                    100.0 * share,
                )
            }
            Beside::Extent(least) => format!(
                "{b} and {a} overlap by {depth:.2e} m at {time:.6} s, {:.0} % of what deforms: its contacts give way too, and forces are too \
                 low; take a larger contact-ratio",
                100.0 * depth / least,
            ),
        });
    }

    /// A wall of tetrahedra and a rigid body whose contact has turned round while the body was within it.
    fn passed(&mut self, simulation: &Simulation) -> Option<[Side; 2]> {
        let world = &simulation.world;
        let is_mesh = |(_, wall)| matches!(wall, &WallShape::Mesh(_));
        if !world.walls().any(is_mesh) {
            return None;
        }
        let before = std::mem::take(&mut self.sides);
        let mut turned = None;
        // A pair with several patches has no one side.
        let mut several = BTreeSet::new();
        for contact in world.rigid_contacts() {
            let Partner::Wall(wall) = contact.a else {
                continue;
            };
            let Some(WallShape::Mesh(mesh)) = world.wall(wall) else {
                continue;
            };
            let pair = (wall, contact.b);
            if self.sides.insert(pair, contact.normal.into()).is_some() {
                several.insert(pair);
            }
            let last = before.get(&pair).map(|&normal| Vector3::from(normal));
            let round = last.is_some_and(|normal| normal.dot(&contact.normal) < 0.0);
            if !round {
                continue;
            }
            if let Some(member) = simulation.member_of(contact.b) {
                let volume = simulation.rigid_volume(Side::Member(member));
                let section = volume.zip(simulation.diameter(member)).map(|(v, d)| v / d);
                let within = section.map(|section| WITHIN * mesh.thickness() * section);
                if within.is_some_and(|within| contact.volume > within) {
                    turned = turned.or(Some((pair, member)));
                }
            }
        }
        self.sides.retain(|pair, _| !several.contains(pair));
        let (pair, member) = turned?;
        (!several.contains(&pair)).then_some([Side::Wall(pair.0 as usize), Side::Member(member)])
    }
}

impl Simulation {
    /// The number of a body among the members.
    pub(super) fn member_of(&self, body: u32) -> Option<usize> {
        let mut members = self.members.iter();
        members.position(|member| member.id == body)
    }

    /// The penalty of the law of two sides, Pa.
    pub(super) fn penalty_between(&self, sides: [Side; 2]) -> f64 {
        let material = |side| match side {
            Side::Wall(wall) => self.world.wall_material(wall as u32),
            Side::Member(member) => self.world.material(self.members[member].id),
        };
        let materials = sides.map(|side| material(side).unwrap_or_default());
        self.world.laws().between(materials).penalty
    }

    /// The first pair of which one has gone too deep, and the share of the smaller one's volume.
    fn swallowed(&self) -> Option<([Side; 2], f64)> {
        let sides = |contact: &super::contacts::ContactLine| [contact.a, Side::Member(contact.b)];
        let contacts = self.contacts().into_iter();
        let mut deep = contacts.filter_map(|contact| {
            let volumes = sides(&contact).map(|side| self.rigid_volume(side));
            let of_b = volumes[1]?;
            // Of a deformable body and a rigid one the depth is their own affair.
            let smaller = match contact.a {
                Side::Wall(_) => of_b,
                Side::Member(_) => of_b.min(volumes[0]?),
            };
            let share = contact.volume / smaller;
            (share > MOST).then(|| (sides(&contact), share))
        });
        deep.next().or_else(|| {
            let mut beyond = self.world.walls().flat_map(|(wall, shape)| {
                let wall = wall as usize;
                let planes = matches!(shape, WallShape::Planes(_));
                let members = 0..if planes { self.members.len() } else { 0 };
                let through = move |member: &usize| {
                    self.moves(*member) && self.is_beyond(wall, shape, *member)
                };
                let pair = move |member| ([Side::Wall(wall), Side::Member(member)], 1.0);
                members.filter(through).map(pair)
            });
            beyond.next()
        })
    }

    /// Whether a member is a rigid body that contacts move.
    fn moves(&self, member: usize) -> bool {
        self.world.follows_drive(self.members[member].id) == Some(false)
    }

    /// Volume of a rigid body \[m³\].
    fn rigid_volume(&self, side: Side) -> Option<f64> {
        let Side::Member(member) = side else {
            return None;
        };
        let id = self.members.get(member)?.id;
        let shape = self.world.shape(self.world.shape_of(id)?)?;
        Some(shape.volume)
    }
}

#[cfg(test)]
mod tests {
    use crate::run::{Run, Scenario};
    use crate::{Error, Usage};

    fn ran(text: &str) -> Result<(), Error> {
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
        run.advance(folder.path(), u64::MAX)
    }

    /// A cube with the half edge R that rests on its face overlaps by a tenth of its thickness where p is 5 rho g R, 1.4 kPa.
    #[test]
    fn a_deep_overlap_warns_once_and_the_summary_has_it() {
        for (penalty, warns) in [(1.0e3, true), (4.0e4, false)] {
            let text = format!(
                "duration = 0.5
                contact.penalty = {penalty}
                [material.m]
                density = 1000
                [[wall]]
                name = \"floor\"
                plane = {{ normal = [0, 0, 1] }}
                [[body]]
                name = \"block\"
                shape = \"cube\"
                size = 0.1
                material = \"m\"
                position = [0, 0, 0.0289]"
            );
            let folder = tempfile::tempdir().unwrap();
            let mut run = Run::new(Scenario::from_toml(&text).unwrap()).unwrap();
            run.advance(folder.path(), u64::MAX).unwrap();
            let summary = run.finish(folder.path(), &Usage::default()).unwrap();
            assert_eq!(summary.warnings.len(), usize::from(warns), "{summary}");
            if warns {
                assert!(
                    summary.warnings[0].contains("block overlaps floor"),
                    "{summary}"
                );
            }
        }
    }

    /// A body that a soft penalty lets through a sheet is no result; the penalty that the run chooses holds it.
    #[test]
    fn a_body_does_not_pass_a_sheet_in_silence() {
        let folder = tempfile::tempdir().unwrap();
        let sheet = folder.path().join("sheet.obj");
        let (x, z) = (0.02, 0.001);
        let mut text = String::new();
        for k in 0..8 {
            let sign = |bit: usize, size: f64| if k >> bit & 1 == 1 { size } else { -size };
            text += &format!("v {} {} {}\n", sign(0, x), sign(1, x), sign(2, z));
        }
        text += "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
        std::fs::write(&sheet, text).unwrap();
        let scene = |contact: &str| {
            format!(
                "duration = 0.02
                gravity = [0, 0, 0]
                {contact}
                [material.m]
                density = 2500
                [[wall]]
                name = \"sheet\"
                file = \"{}\"
                [[body]]
                name = \"ball\"
                shape = \"A10\"
                size = 0.03
                material = \"m\"
                position = [0, 0, 0.05]
                velocity = [0, 0, -10]",
                sheet.display()
            )
        };
        let error = ran(&scene("contact.penalty = 3e4")).unwrap_err();
        let Error::Through { a, b, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!([&**a, &**b], ["sheet", "ball"]);
        ran(&scene("")).unwrap();
    }

    /// A scene fails between two sides, and not with the penalty that the message names.
    fn assert_advice(scene: impl Fn(&str) -> String, penalty: &str, sides: [&str; 2]) {
        let error = ran(&scene(penalty)).unwrap_err();
        let Error::Through { a, b, enough, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!([&**a, &**b], sides);
        let after = ran(&scene(&format!("{enough:e}")));
        assert!(after.is_ok(), "{error}: {after:?}");
    }

    /// A boulder that is too fast for the penalty, and one that is not.
    #[test]
    fn a_boulder_is_held_or_the_run_stops() {
        let scene = |penalty: &str| {
            format!(
                "duration = 0.1
                contact.penalty = {penalty}
                [material.m]
                density = 2500
                [[wall]]
                name = \"floor\"
                plane = {{ normal = [0, 0, 1] }}
                [[body]]
                name = \"boulder\"
                shape = \"A10\"
                size = 1
                material = \"m\"
                position = [0, 0, 0.6]
                velocity = [0, 0, -40]"
            )
        };
        assert_advice(scene, "1e6", ["floor", "boulder"]);
    }

    /// A body much heavier than the one below squeezes it out of the way of the contact law.
    #[test]
    fn a_heavy_box_is_not_let_through_a_light_one() {
        let scene = |penalty: &str| {
            format!(
                "duration = 0.5
                contact.penalty = {penalty}
                [material.light]
                density = 1000
                [material.heavy]
                density = 600000
                [[wall]]
                name = \"floor\"
                plane = {{ normal = [0, 0, 1] }}
                [[body]]
                name = \"below\"
                shape = \"cube\"
                size = 0.1
                material = \"light\"
                position = [0, 0, 0.0289]
                [[body]]
                name = \"above\"
                shape = \"cube\"
                size = 0.1
                material = \"heavy\"
                position = [0, 0, 0.0866]"
            )
        };
        assert_advice(scene, "3e5", ["below", "above"]);
    }
}
