//! Bodies and walls that go, and bodies that a host moves by hand.

use super::DeformablePart;
use super::body::SoftBody;
use crate::contact::{BodyId, Partner};
use crate::deform::side::Side;
use crate::generalized::Resistance;

impl DeformablePart {
    /// Removes a body, rigid or deformable, that [has left](Self::leave) its contacts.
    pub fn remove_body(&mut self, body: BodyId) {
        let i = body as usize;
        self.count -= usize::from(self.bodies[i].is_there);
        self.bodies[i] = SoftBody::vacant();
        self.rigid_resistances[i] = Resistance::default();
    }

    /// The bodies that touch a body or a wall. The next update evaluates the contacts of the deformable ones among them, and
    /// of itself, even if they sleep.
    pub fn stir_around(&mut self, thing: Side) -> Vec<BodyId> {
        let mut touched = Vec::new();
        let own = |a: Side, b: BodyId| a == thing || Side::Deformable(b) == thing;
        let pairs = self.pairs.list().iter().filter(|pair| own(pair.a, pair.b));
        for pair in pairs.filter(|pair| !pair.outcome.contacts.is_empty()) {
            for other in [pair.a, Side::Deformable(pair.b)] {
                if other != thing
                    && let Partner::Body(body) = other.into()
                {
                    touched.push(body);
                }
            }
        }
        let itself = match thing {
            Side::Deformable(body) => Some(body),
            Side::Rigid(_) | Side::Wall(_) => None,
        };
        for body in touched.iter().copied().chain(itself) {
            self.bodies[body as usize].sleep.stir();
        }
        touched
    }

    /// Ends all pairs of a body or wall, and sums the forces of the others again. The place of a deformable body is forgotten.
    pub fn leave(&mut self, thing: Side) {
        let own = |a: Side, b: BodyId| a == thing || Side::Deformable(b) == thing;
        self.pairs.end(|pair| own(pair.a, pair.b));
        self.starts.retain(|(a, b), _| !own(*a, *b));
        if let Partner::Body(body) = thing.into() {
            self.entered.remove(&body);
        }
        if let Side::Deformable(body) = thing {
            self.bodies[body as usize].displaced();
        }
        self.gather_again(false);
    }
}
