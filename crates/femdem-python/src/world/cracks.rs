//! The cracks of the deformable bodies of a world, and what holds these.

use femdem::contact::BodyId;
use femdem::fem::Boundary;
use femdem::fem::fracture::FractureMode;
use femdem::run::BoundaryEntry;
use femdem::solve::{CrackFacet, Cracks, ModelId};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::{World, no_such};
use crate::arrays::{column, table};
use crate::error::{FemdemError, options, refused, wrong};

impl World {
    /// Conditions on a body of a model, as a scene describes them.
    pub(super) fn boundary(&self, text: &str, model: ModelId) -> PyResult<Boundary> {
        let entries: Vec<BoundaryEntry> = options("boundary", text)?;
        let mut boundary = Boundary::default();
        let known = self.world.model(model);
        let known = known.ok_or_else(|| no_such("model", model, self.models.len()));
        let model = known?;
        let radius = model.nodes().iter().map(|x| x.norm()).fold(0.0, f64::max);
        for entry in entries {
            if !entry.name.is_empty() {
                let allowed = "leave it out: names are for the results of scenes";
                return Err(wrong("boundary.name", format!("{:?}", entry.name), allowed));
            }
            let added = entry.add_to(&mut boundary, model, radius);
            added.map_err(refused)?;
        }
        Ok(boundary)
    }

    fn cracks_of(&self, body: BodyId) -> PyResult<Cracks<'_>> {
        self.soft(body)?.cracks().ok_or_else(|| {
            FemdemError::new_err(format!(
                "body {body} cannot break: give its matter a fracture when it is added"
            ))
        })
    }
}

#[pymethods]
impl World {
    /// The facets of a breakable body that are cut, as columns: first those that carry nothing any more.
    fn cracks<'py>(&self, py: Python<'py>, body: BodyId) -> PyResult<Bound<'py, PyDict>> {
        let cracks = self.cracks_of(body)?;
        let spent = cracks.spent().iter().copied();
        let facets: Vec<CrackFacet> = spent.chain(cracks.facets()).collect();
        let each = |of: fn(&CrackFacet) -> f64| column(py, facets.iter().map(of));
        let corners = facets.iter().map(|facet| {
            let [a, b, c] = facet.corners;
            [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
        });
        let sheared = facets.iter().map(|f| f.mode == FractureMode::Shear);
        let columns = PyDict::new(py);
        let element = |tet: Option<u32>| tet.map_or(-1, i64::from);
        let elements = facets.iter().map(|f| f.tets.map(element));
        columns.set_item("elements", table(py, elements)?)?;
        columns.set_item("corners", table(py, corners)?)?;
        columns.set_item("opening", each(|f| f.opening))?;
        columns.set_item("slip", each(|f| f.slip))?;
        columns.set_item("damage", each(|f| f.damage))?;
        columns.set_item("sheared", column(py, sheared))?;
        columns.set_item("birth", each(|f| f.birth))?;
        columns.set_item("broken_at", each(|f| f.end.unwrap_or(f64::NAN)))?;
        columns.set_item("dissipated", each(|f| f.taken))?;
        Ok(columns)
    }

    /// Lengths of the mesh and of the cracks, the largest stress over strength, and the energy stored in the cracks.
    fn crack_facts(&self, body: BodyId) -> PyResult<(f64, f64, f64, f64, f64)> {
        let cracks = self.cracks_of(body)?;
        Ok((
            cracks.process_zone(),
            cracks.element_height(),
            cracks.largest_height(),
            cracks.highest(),
            cracks.stored(),
        ))
    }

    /// The number of the fragment of each element.
    fn fragments<'py>(&self, py: Python<'py>, body: BodyId) -> PyResult<Bound<'py, PyArray1<u32>>> {
        let fragments = self.cracks_of(body)?.fragments();
        if !fragments.is_empty() {
            return Ok(column(py, fragments));
        }
        let elements = self.soft(body)?.model().mesh().tets().len();
        Ok(column(py, vec![0; elements]))
    }

    /// Makes bodies of the fragments of broken bodies: each body that had some, with the new ones.
    fn fragment_bodies(&mut self) -> PyResult<Vec<(BodyId, Vec<BodyId>)>> {
        let fragmentations = self.world.fragment_bodies().map_err(refused)?;
        Ok(fragmentations
            .into_iter()
            .map(|p| (p.body, p.fragments))
            .collect())
    }

    /// Takes all conditions off a deformable body.
    fn release(&mut self, body: BodyId) -> PyResult<()> {
        self.soft(body)?;
        let none = Boundary::default();
        self.world.set_boundary(body, none).map_err(refused)
    }
}
