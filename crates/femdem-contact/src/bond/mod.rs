//! Bonds between rigid bodies: mortar, cement, glued clumps.
//!
//! A [`Bond`] holds two bodies together over a flat [`BondSection`], by the law of [glue](crate::glue). The section is cut into
//! triangles about its centroid, and each is a [`GluedFacet`](crate::glue::GluedFacet) between three points of body A and three
//! of body B, the middles of the triangle's edges. These integrate quadratic functions exactly, so that for small openings a
//! whole bond has the stiffnesses of a layer of springs k per area:
//!
//! | motion | stiffness | first damage |
//! |---|---|---|
//! | along the normal | k A | N = f_t A |
//! | across | k A | V = c A |
//! | bending | k I | M = f_t I/c_max |
//! | twisting | k (I_1 + I_2) | T = c (I_1 + I_2)/r_max |
//!
//! with the second moments I of the section and the distances c_max and r_max of the outermost points: the middles of its
//! edges. For mortar of modulus E and thickness t, k = E/t.
//!
//! - **Whole** points are linear, in tension and in pressure. Bodies are bonded as they lie, without force, whatever their gap or
//!   overlap.
//! - A point **gives way** where (t_n/f_t)² + (τ/c)² reaches 1, or τ reaches c + μ p under a pressure p. From then on it is glue
//!   at its peak, which softens with its largest opening, and contact with friction. A pure mode dissipates its energy G per area
//!   exactly; friction under pressure comes on top.
//! - Bonded bodies do not meet otherwise: the bond alone presses while it lasts. A [broken](Bond::is_broken) bond that carries
//!   no energy, or has opened or slid somewhere by a tenth of its width, [ends](crate::ContactBatch::end_bonds), and the two meet
//!   by the kernel.
//! - A **dashpot** of a ratio ζ of critical damping is proportional to the stiffness that is left: nothing where a broken bond is
//!   open, and nothing along broken faces that slide, where friction alone resists.
//!
//! Forces are minus the exact gradient of the energy, dashpots apart; forces and moments on the two bodies balance to round-off.
//!
//! ```
//! use femdem_contact::bond::{Bond, BondLaw, BondSection};
//! use femdem_contact::{Frame, Motion};
//! use femdem_mesh::Vector3;
//!
//! // Two bodies, 0.1 m apart, and a disc of mortar of radius 0.02 m between.
//! let section = BondSection::disc(Vector3::x() * 0.05, Vector3::x(), 0.02)?;
//! let law = BondLaw { stiffness: 1e11, tensile: 1e6, cohesion: 3e6, energies: [20.0, 100.0], ..BondLaw::default() };
//! let at = |x: f64| Motion { inverse_mass: 1.0, ..Motion::fixed(Frame { position: Vector3::x() * x, ..Frame::identity() }) };
//! let mut bond = Bond::new([0, 1], &section, law, [&at(0.0), &at(0.1)])?;
//! bond.update([&at(0.0), &at(0.1 + 1e-7)]);
//! // F = k A d
//! let force = bond.state().force;
//! assert!((force.x / (1e11 * section.area() * 1e-7) - 1.0).abs() < 1e-6);
//! # Ok::<(), femdem_contact::ContactError>(())
//! ```
//!
//! # Sources
//!
//! Potyondy and Cundall (2004), Int. J. Rock Mech. Min. Sci. 41, 1329, for bonds with a section ("parallel bonds"), which break
//! at once; the energies of fracture are those of [`glue`](crate::glue).

mod faces;
mod law;
mod part;
mod section;
mod sound;
mod state;

pub use faces::{between_shapes, between_spheres};
pub use law::BondLaw;
pub use part::BondFacet;
pub use section::BondSection;
pub use state::{Bond, BondState};
