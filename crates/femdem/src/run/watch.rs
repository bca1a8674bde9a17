//! Watch over overlaps that the penalty cannot carry.

use femdem_contact::WallShape;

use super::contacts::Side;
use super::{MemberId, Run, Simulation};
use crate::Error;

/// Steps between looks.
const EVERY: u64 = 16;

/// A run stops where more than this share of the smaller body's volume lies in the other side.
const MOST: f64 = 0.5;

/// The share that a penalty should be chosen for, in the advice.
const WANTED: f64 = 0.05;

impl Run {
    /// Refuses to go on where a rigid body has gone through a wall of planes, or lies in another or in a wall by more than
    /// half of the smaller one's volume: the contact force falls from there on, and what comes then means nothing.
    ///
    /// # Errors
    ///
    /// [`Error::Through`] with the pair and a penalty that would do.
    pub(super) fn check_overlaps(&self) -> Result<(), Error> {
        let simulation = self.simulation();
        if !simulation.world.steps().is_multiple_of(EVERY) {
            return Ok(());
        }
        let Some((pair, share)) = simulation.swallowed() else {
            return Ok(());
        };
        let penalty = self.scenario().contact.penalty;
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
}

impl Simulation {
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
            let walls = self.world.walls().iter().enumerate();
            let mut beyond = walls.flat_map(|(wall, shape)| {
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
        match self.members[member].id {
            MemberId::Rigid(id) => self.world.follows_drive(id) == Some(false),
            MemberId::Deformable(_) => false,
        }
    }

    /// Volume of a rigid body \[m³\].
    fn rigid_volume(&self, side: Side) -> Option<f64> {
        let Side::Member(member) = side else {
            return None;
        };
        let MemberId::Rigid(id) = self.members.get(member)?.id else {
            return None;
        };
        let shape = self.world.shape(self.world.shape_of(id)?)?;
        Some(shape.volume)
    }
}

#[cfg(test)]
mod tests {
    use crate::Error;
    use crate::run::{Run, Scenario};

    fn ran(text: &str) -> Result<(), Error> {
        let folder = tempfile::tempdir().unwrap();
        let mut run = Run::new(Scenario::from_toml(text).unwrap()).unwrap();
        run.advance(folder.path(), u64::MAX)
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
