//! Cohesive law of two faces that a crack separates: what still holds them, and how they press and rub.
//!
//! A [`GluedFacet`] joins the two sides of a cut facet. With the opening δ = x_b − x_a, linear between its three pairs of nodes, in
//! the axes of the mid-surface (normal n from side a to side b, and two in the facet), its energy per area is
//!
//! w = ½ S(λ_max) λ² + ½ k_c ⟨g − δ_n⟩² + ½ k_t |δ_t − s|²,   λ² = ⟨δ_n + t_n/k⟩² + |δ_t + τ/k|²
//!
//! - The **glue** is born with the traction (t_n, τ) that the facet carries when it is cut, so that nothing jumps: elastic, S = k,
//!   until the plane that fails reaches its [limits](GlueLimits), at once if it is cut beyond them. The mode that it has *then* stays.
//!   From there on S = T(λ_max)/λ_max falls with the largest λ so far, along a [`Softening`]; it never heals, and breaking takes
//!   exactly G of that mode per area, times the part n·m that the facet has of that plane, whatever it was born with, unless its
//!   peak is too high for that (pressed, askew, or of coarse elements), so that it would fall steeper than it rises. What it carried
//!   at birth of the stress [along](GlueLimits::aside) that plane counts neither for the limit nor for the mode. All of it is born
//!   when the first node of the facet splits; a node that does not has no opening.
//!   Born under pressure, it has no normal traction before the faces have opened so far that they no longer press: g for t_n = −k g.
//! - The **contact** of the faces, of stiffness k_c, is born with the pressure that the facet carries (g), and with friction that
//!   carries as much of the shear as it can. Where another law [presses](GlueLaw::presses) faces that overlap, the spring only
//!   keeps the pressure of the birth: ½ k_c ⟨g − ⟨δ_n⟩⟩² + k_c g ⟨−δ_n⟩, with g that fades once the glue is broken.
//! - These springs are stretched at birth: the energy in them is **lent** ([`GluedFacet::join`] returns it), as nothing else has
//!   lost it. It is T²/(2k) for the glue, and returns in what the glue dissipates.
//!
//! At each step call [`GluedFacet::advance`] and then [`GluedFacet::forces`], or [`GluedFacet::step`] for both. Forces are minus the exact gradient of the energy,
//! with the turning of the axes; forces and moments of a facet balance.
//!
//! ```
//! use femdem_contact::glue::{GlueLaw, GlueLimits, GluedFacet, Softening};
//! use femdem_mesh::Vector3;
//!
//! let law = GlueLaw {
//!     stiffness: 1e13, // Pa/m
//!     energies: [20.0, 100.0], // J/m²
//!     mix: 2.0,
//!     softening: Softening::Linear,
//!     contact: 1e13,
//!     tangential: 0.8e13,
//!     friction: 0.6,
//!     presses: true,
//! };
//! law.check()?;
//! let a = [Vector3::zeros(), Vector3::x() * 1e-3, Vector3::y() * 1e-3];
//! let mut facet = GluedFacet::new(0.5e-6)?;
//! let limits = GlueLimits::flat([5e6, 20e6], 0.6); // tensile strength, cohesion, Pa
//! let lent = facet.join(&law, [5e6, 0.0, 0.0], &limits, [1.0; 3]); // born under a tension of 5 MPa
//! // Side b pulls side a with 5 MPa, upwards.
//! let pull = facet.forces(&law, &a, &a).on[0].iter().sum::<Vector3>();
//! assert!((pull - Vector3::z() * 2.5).norm() < 1e-12);
//! // Pulled apart by a tenth of a millimetre it is broken, which has taken G A.
//! let b = a.map(|x| x + Vector3::z() * 1e-4);
//! let lost = facet.advance(&law, &a, &b);
//! assert!((lost.glue - lent - 20.0 * 0.5e-6).abs() < 1e-15 && facet.is_broken(&law));
//! # Ok::<(), femdem_contact::ContactError>(())
//! ```
//!
//! # Sources
//!
//! Camacho and Ortiz (1996), Int. J. Solids Struct. 33, 2899, for the extrinsic law; Papoulia, Sam and Vavasis (2003), Int. J.
//! Numer. Meth. Engng 58, 679, for its continuity in time; Benzeggagh and Kenane (1996), Compos. Sci. Technol. 56, 439, for mixed
//! modes; Petersson (1981), Lund, TVBM-1006, for the bilinear softening of concrete.

mod facet;
mod law;
mod mid_surface;
mod onset;
mod softening;

pub(crate) use facet::Openings;
pub use facet::{GlueLoss, GluedFacet, GluedForces};
pub use law::{GlueLaw, GlueLimits, mixed_energy, mixed_strength};
pub use mid_surface::MidSurface;
pub(crate) use onset::Onset;
pub use onset::least_compliance;
pub use softening::Softening;
