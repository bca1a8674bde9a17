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

    /// Ends all pairs of a body or wall, and sums the forces of the others again. Returns the bodies that touched it,
    /// ascending: those asleep among them may have lost their balance. The place of a deformable body is forgotten.
    pub fn leave(&mut self, thing: Side) -> Vec<BodyId> {
        let own = |a: Side, b: BodyId| a == thing || Side::Deformable(b) == thing;
        let mut touched = Vec::new();
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
        touched.sort_unstable();
        self.pairs.end(|pair| own(pair.a, pair.b));
        self.starts.retain(|(a, b), _| !own(*a, *b));
        for &body in &touched {
            self.bodies[body as usize].sleep.stir();
        }
        if let Side::Deformable(body) = thing {
            self.bodies[body as usize].displaced();
        }
        self.gather(false);
        touched
    }
}
