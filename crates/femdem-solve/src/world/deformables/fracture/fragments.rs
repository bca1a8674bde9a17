//! Fragments that go on as bodies.
//!
//! What hangs together by nodes and by joints is a fragment. Its elements, nodes, boundary conditions, joints and strengths are those
//! that it had, so mass, momentum, stresses and energies are too; only its tetrahedra and nodes have other numbers. Contacts
//! between fragments of one body go on as contacts of two: the field of the whole is the distance to the nearest skin, which for
//! a point of a fragment is that of the fragment, so that no energy jumps. What friction springs lose is booked as friction.

use super::CrackFacet;
use super::breakable::Breakable;
use super::cracks::CrackState;
use super::joints::Joint;
use crate::body::Body;
use crate::error::SolveError;
use crate::fracture::Fragments;
use crate::halo::{Alone, Halo};
use crate::world::World;
use crate::world::deformables::add::{held_energy, inverse_masses};
use crate::world::deformables::nodal_bound::NodalBound;
use crate::world::deformables::{Model, Scratch, State};
use crate::world::lists::place;
use femdem_contact::deform::{DeformableShape, FragmentShape};
use femdem_contact::{BodyId, Frame, Motion};
use femdem_mesh::tet::CrackedPart;
use femdem_mesh::{TetMesh, Vector3};
use std::sync::Arc;

/// A body that has fallen into several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fragmentation {
    /// The body, which is the largest of its fragments from now on; the one with the lowest element among equals.
    pub body: BodyId,
    /// The others, in the order of their lowest elements.
    pub fragments: Vec<BodyId>,
}

/// A fragment that becomes a body.
pub(in crate::world) struct Fragment {
    model: Model,
    shape: Arc<DeformableShape>,
    state: State,
    tets: Vec<u32>,
}

/// What ranks that have a body as a guest need to know of a fragment.
pub(in crate::world) type GuestFragment = (Model, State, Vec<u32>);

impl Fragment {
    /// What goes to the guests of the body.
    pub fn as_guest(&mut self) -> GuestFragment {
        let state = self.state.as_guest();
        (self.model.clone(), state, self.tets.clone())
    }

    /// That of a guest; `None` for what came and does not fit together.
    pub fn of_guest((model, state, tets): GuestFragment) -> Result<Option<Self>, SolveError> {
        if !state.is_of_guest(&model, tets.len()) {
            return Ok(None);
        }
        Ok(Some(Self {
            shape: Arc::new(model.shape()?),
            model,
            state,
            tets,
        }))
    }
}

impl World {
    /// Makes bodies of the fragments of the bodies that have broken, if their [`Fracture`](crate::Fracture) says so: of what facets that
    /// are whole, or not yet [spent](crate::Cracks::spent), hold together. The largest keeps the number of the body; the
    /// others take the next free ones. A body that may not [touch itself](Self::set_self_contact) stays one: its parts may lie in each
    /// other. Mass, momentum, stresses, cracks and strengths are as they were, conditions
    /// follow their nodes, and friction goes on where the skin stays. A host may ask after every step: nothing happens unless
    /// facets have come to be spent, or nodes have been split.
    ///
    /// # Errors
    /// [`SolveError::Fem`] and [`SolveError::Mesh`] where fragments are no sound bodies: no body has fallen into parts then. After an
    /// error of the contacts, [`SolveError::Contact`], the world is of no further use. [`SolveError::Ranks`] in a world that is
    /// [shared out](Self::share_out).
    pub fn fragment_bodies(&mut self) -> Result<Vec<Fragmentation>, SolveError> {
        self.not_shared("making bodies of fragments by one rank")?;
        self.fragment_bodies_on(&mut Alone)
    }

    /// As [`fragment_bodies`](Self::fragment_bodies), in a world that may be [shared out](Self::share_out), by all ranks. They get
    /// the same, by numbers in the whole. Where a body has fallen into parts, all bodies are dealt anew.
    ///
    /// # Errors
    /// As [`fragment_bodies`](Self::fragment_bodies), [`SolveError::Ranks`] if the world was not shared out over these ranks, and what
    /// `halo` reports.
    pub fn fragment_bodies_on(
        &mut self,
        halo: &mut dyn Halo,
    ) -> Result<Vec<Fragmentation>, SolveError> {
        self.restored()?;
        self.fits(halo)?;
        let mut broken = Vec::new();
        for id in self.deformable_ids().collect::<Vec<_>>() {
            broken.extend(self.parts_of(id).map(|parts| (id, parts)));
        }
        if !self.is_any_fallen(!broken.is_empty(), halo)? {
            return Ok(Vec::new());
        }
        self.evaluate_on(halo)?;
        let before = self.stored_in_soft_contacts();
        let (time, steps) = (self.time, self.steps);
        let in_body = |body| move |error: SolveError| error.in_body(body, steps, time);
        // All of them before anything changes.
        let mut fallen = Vec::new();
        for (id, parts) in broken {
            let named = self.named(id as usize);
            fallen.push((id, self.fragments_of(id, parts).map_err(in_body(named))?));
        }
        self.book_cracks();
        let (fallen, of_whole) = self.tell_fallen(fallen, halo)?;
        let mut fragmentations = Vec::new();
        for (id, fragments) in fallen {
            let named = self.named(id as usize);
            let parts = self.part(id, fragments).map_err(in_body(named))?;
            self.follow_whole(&parts);
            fragmentations.push(parts);
        }
        if self.is_shared() {
            self.deal_again(halo)?;
            fragmentations = of_whole;
        }
        self.meet_deformables(0.0)?;
        self.flows.cracks.released += before - self.stored_in_soft_contacts();
        Ok(fragmentations)
    }

    /// The tetrahedra of the fragments of a body, the largest first; `None` for a body that is one, or has to stay it. They are looked
    /// for once after facets have come to be spent or nodes have been split.
    fn parts_of(&mut self, id: BodyId) -> Option<Vec<Vec<u32>>> {
        let may_touch_itself = self.batch.self_contact(id);
        let (model, state) = self.deformables.as_deref_mut()?.parts(id);
        let breakable = state.breakable.as_deref_mut()?;
        let cracks = breakable.cracks.as_deref_mut()?;
        let may_part = breakable.fracture.fragments == Fragments::Bodies && may_touch_itself;
        if !may_part || !cracks.loosened {
            return None;
        }
        let joined: Vec<u32> = cracks.joints.iter().map(|joint| joint.facet).collect();
        let parts = cracks.mesh.hanging(&joined);
        let count = parts.iter().max().map_or(0, |last| *last as usize + 1);
        if count < 2 {
            cracks.loosened = false;
            return None;
        }
        let mut tets = vec![Vec::new(); count];
        let mut volumes = vec![0.0; count];
        for ((part, t), volume) in parts.iter().zip(0..).zip(model.model.volumes()) {
            tets[*part as usize].push(t);
            volumes[*part as usize] += volume;
        }
        let larger = |most: usize, i: usize| if volumes[i] > volumes[most] { i } else { most };
        let largest = tets.remove((0..count).fold(0, larger));
        tets.insert(0, largest);
        Some(tets)
    }

    /// The fragments of a body.
    fn fragments_of(
        &mut self,
        id: BodyId,
        parts: Vec<Vec<u32>>,
    ) -> Result<Vec<Fragment>, SolveError> {
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(Vec::new());
        };
        let (model, state) = deformables.parts(id);
        let parts = parts.into_iter();
        parts.map(|tets| state.fragment(model, tets)).collect()
    }

    /// Makes bodies of the fragments of a body; the first keeps its number.
    fn part(&mut self, id: BodyId, fragments: Vec<Fragment>) -> Result<Fragmentation, SolveError> {
        let none = Fragmentation {
            body: id,
            fragments: Vec::new(),
        };
        let Some(deformables) = self.deformables.as_deref_mut() else {
            return Ok(none);
        };
        let own = deformables.bodies[id as usize].model;
        let fallen = fragments.iter().map(|fragment| FragmentShape {
            shape: Arc::clone(&fragment.shape),
            tets: fragment.tets.clone(),
        });
        let ids = self.batch.fragment_deformable(id, fallen.collect())?;
        deformables.bound = None;
        for (&id, fragment) in ids.iter().zip(fragments) {
            let Fragment {
                model,
                shape,
                mut state,
                ..
            } = fragment;
            // A body in pieces has dashpots that know the mass of the touching nodes only.
            if model.model.mesh().pieces() == 1 {
                self.batch.set_frequency(id, model.frequency(&shape))?;
            }
            if let Some(modulus) = self.batch.modulus(id) {
                state.contact_step = model.contact_step(&shape, modulus);
            }
            if id == ids[0] {
                state.model = own;
                deformables.models[own as usize] = model;
            } else {
                state.model = deformables.models.len() as u32;
                deformables.models.push(model);
                place(&mut self.bodies, id, Body::vacant());
                place(&mut self.motions, id, Motion::fixed(Frame::identity()));
            }
            place(&mut deformables.bodies, id, state);
        }
        Ok(Fragmentation {
            fragments: ids[1..].to_vec(),
            ..none
        })
    }
}

impl State {
    /// The fragment of some of the tetrahedra.
    fn fragment(&self, whole: &Model, tets: Vec<u32>) -> Result<Fragment, SolveError> {
        let missing = || SolveError::CannotBreak {
            needs: "cracks",
            found: "a body that is whole".to_owned(),
        };
        let breakable = self.breakable.as_deref().ok_or_else(missing)?;
        let cracks = breakable.cracks.as_deref().ok_or_else(missing)?;
        let part = cracks.mesh.part(&tets)?;
        let points = part.nodes.iter();
        let points = points.map(|node| whole.model.mesh().points()[*node as usize]);
        let mesh = TetMesh::in_pieces(points.collect(), part.mesh.tets().to_vec())?;
        let model = whole.model.part(&tets, mesh)?;
        let mut numbers = vec![None; self.positions.len()];
        for (node, number) in part.nodes.iter().zip(0_u32..) {
            numbers[*node as usize] = Some(number);
        }
        let boundary = self
            .boundary
            .part(|node| numbers.get(node as usize).copied().flatten());
        let of = |all: &[_]| part.nodes.iter().map(|node| all[*node as usize]).collect();
        let velocities: Vec<_> = of(&self.velocities);
        let speeds = velocities.iter().map(|v| v.norm());
        let positions: Vec<_> = of(&self.positions);
        let mut state = Self {
            model: self.model,
            inverse_masses: inverse_masses(model.masses(), &boundary),
            history: whole.model.part_of_history(&self.history, &tets),
            pull: self.pull,
            strain_forces: of(&self.strain_forces),
            loads: of(&self.loads),
            held_energy: held_energy(&boundary, model.masses(), &velocities),
            fastest: speeds.fold(0.0, f64::max),
            velocities,
            boundary,
            nodal: NodalBound::new(&model)?,
            breakable: Some(Box::new(breakable.part(&part, &tets, &positions)?)),
            positions,
            ..Self::default()
        };
        // The forces are there, and joints are not to advance once more.
        let Scratch { history, work } = &mut Scratch::default();
        history.resize(state.history.len(), 0.0);
        state.internal = model.forces_without_energy(
            &state.positions,
            &state.velocities,
            &state.history,
            history,
            &mut vec![Vector3::zeros(); state.positions.len()],
            work,
        )?;
        state.bound = model.stable_frequency2(&state.positions, &state.history)?;
        let model = Model {
            name: whole.name.clone(),
            model,
            ..*whole
        };
        Ok(Fragment {
            shape: Arc::new(model.shape()?),
            model,
            state,
            tets,
        })
    }
}

impl Breakable {
    /// That of a part of the body, which has the tetrahedra `tets`, and its nodes at `positions`, m.
    fn part(
        &self,
        part: &CrackedPart,
        tets: &[u32],
        positions: &[Vector3],
    ) -> Result<Self, SolveError> {
        let old = self.cracks.as_deref();
        let of_point = |own: &u32| old.map_or(*own, |cracks| cracks.mesh.points()[*own as usize]);
        let firsts = (0_u32..).zip(part.mesh.points());
        let points: Vec<u32> = firsts
            .filter(|(node, point)| node == *point)
            .map(|(node, _)| of_point(&part.nodes[node as usize]))
            .collect();
        let own = |facet: &CrackFacet| {
            let now = facet.tets.map(|t| tets.binary_search(&t?).ok());
            let tets = now.map(|t| t.map(|t| t as u32));
            let stays = tets.iter().any(Option::is_some);
            stays.then_some(CrackFacet { tets, ..*facet })
        };
        let is_cut = part.mesh.is_cut().iter().any(|cut| *cut);
        let cracks = match old.filter(|_| is_cut) {
            Some(cracks) => Some(Box::new(cracks.part(part, positions)?)),
            None => None,
        };
        Ok(Self {
            factors: points.iter().map(|p| self.factors[*p as usize]).collect(),
            points: points.iter().map(|p| self.points[*p as usize]).collect(),
            spent: self.spent.iter().filter_map(own).collect(),
            cracks,
            fracture: self.fracture,
            harmless: self.harmless,
            highest: self.highest,
            whole: None,
        })
    }
}

impl CrackState {
    fn part(&self, part: &CrackedPart, positions: &[Vector3]) -> Result<Self, SolveError> {
        let number = |facet: u32| part.facets.binary_search(&facet).ok().map(|f| f as u32);
        let joint = |joint: &Joint| {
            let facet = number(joint.facet)?;
            let sides = part.mesh.sides(facet)?;
            Some(Joint {
                facet,
                sides,
                ..joint.clone()
            })
        };
        let all = (0_u32..).zip(&part.facets);
        let broken: Vec<u32> = all
            .filter(|(_, facet)| self.broken.is_cut()[**facet as usize])
            .map(|(number, _)| number)
            .collect();
        let mut own = Self::new(part.mesh.clone(), part.mesh.cut_along(&broken)?);
        own.joints = self.joints.iter().filter_map(joint).collect();
        let held = |joint: &Joint| {
            let now = joint.forces(positions);
            now.glue + now.contact
        };
        own.stored = own.joints.iter().map(held).sum();
        own.stiffen(positions.len());
        // Until its contacts are known.
        own.both.clone_from(&own.stiffness);
        Ok(own)
    }
}
