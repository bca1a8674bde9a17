//! Bonds between the rigid bodies of a world.

use std::collections::BTreeSet;

use femdem::contact::bond::{Bond, BondSection};
use femdem::contact::{BodyId, BondId};
use femdem::mesh::Vector3;
use femdem::run::BondEntry;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::World;
use crate::arrays::{column, rows, vectors};
use crate::error::{FemdemError, options, refused, wrong};
use crate::threads::unlocked;

impl World {
    /// Refuses a pair that is bonded already.
    fn not_bonded(&self, pair: [BodyId; 2]) -> PyResult<()> {
        if !self.world.are_bonded(pair) {
            return Ok(());
        }
        let [a, b] = pair;
        Err(FemdemError::new_err(format!(
            "bodies {a} and {b} are bonded already: two bonds would be twice the mortar"
        )))
    }
}

#[pymethods]
impl World {
    /// Bonds the rigid bodies of two groups that nearly touch; returns the numbers of the bonds.
    fn add_bonds<'py>(
        &mut self,
        py: Python<'py>,
        bodies: Vec<BodyId>,
        others: Vec<BodyId>,
        entry: &str,
    ) -> PyResult<Bound<'py, PyArray1<BondId>>> {
        let entry: BondEntry = options("bonds", entry)?;
        let law = entry.law().map_err(refused)?;
        self.are_rigid(&bodies)?;
        self.are_rigid(&others)?;
        let groups = [bodies, others].map(BTreeSet::from_iter);
        let world = &mut self.world;
        let found = unlocked(py, || entry.sections(world, &groups))?;
        found
            .iter()
            .try_for_each(|(pair, _)| self.not_bonded(*pair))?;
        let mut each = found.into_iter();
        let ids: PyResult<Vec<BondId>> = each
            .try_fold(Vec::new(), |mut ids, (pair, section)| {
                ids.push(self.world.add_bond(pair, &section, law)?);
                Ok::<_, femdem::solve::SolveError>(ids)
            })
            .map_err(refused);
        Ok(column(py, ids?))
    }

    /// Bonds two rigid bodies over a polygon; returns the number of the bond.
    fn add_bond(
        &mut self,
        pair: [BodyId; 2],
        corners: &Bound<'_, PyAny>,
        entry: &str,
    ) -> PyResult<BondId> {
        let entry: BondEntry = options("bond", entry)?;
        let law = entry.law().map_err(refused)?;
        let [a, b] = pair;
        if a == b {
            let allowed = "two bodies: give two different numbers";
            return Err(wrong("bodies of a bond", format!("{a}, {b}"), allowed));
        }
        self.are_rigid(&pair)?;
        let [from, to] = pair.map(|id| self.world.position(id).unwrap_or_default());
        let corners = rows::<3>("corners", corners)?;
        let corners: Vec<Vector3> = corners.into_iter().map(Vector3::from).collect();
        let section = BondSection::polygon(&corners, to - from).map_err(refused)?;
        self.world.add_bond(pair, &section, law).map_err(refused)
    }

    /// All bonds as columns; those that have ended too.
    fn bonds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let bonds: Vec<(BondId, &Bond)> = self.world.bonds().collect();
        let each = |of: fn(&Bond) -> f64| column(py, bonds.iter().map(|(_, bond)| of(bond)));
        let three = |of: fn(&Bond) -> Vector3| vectors(py, bonds.iter().map(|(_, bond)| of(bond)));
        let side = |k: usize| column(py, bonds.iter().map(|(_, bond)| bond.bodies()[k]));
        let flag = |of: fn(&Bond) -> bool| column(py, bonds.iter().map(|(_, bond)| of(bond)));
        let columns = PyDict::new(py);
        columns.set_item("bond", column(py, bonds.iter().map(|(id, _)| *id)))?;
        columns.set_item("a", side(0))?;
        columns.set_item("b", side(1))?;
        columns.set_item("area", each(Bond::area))?;
        columns.set_item("centre", three(|bond| bond.state().centre)?)?;
        columns.set_item("normal", three(|bond| bond.state().normal)?)?;
        columns.set_item("force", three(|bond| bond.state().force)?)?;
        columns.set_item("moment", three(|bond| bond.state().moment)?)?;
        columns.set_item("tension", each(|bond| bond.state().tension))?;
        columns.set_item("energy", each(|bond| bond.state().energy))?;
        let lost = |bond: &Bond| bond.lost().glue + bond.lost().friction;
        columns.set_item("dissipated", each(lost))?;
        columns.set_item("damage", each(Bond::damage))?;
        columns.set_item("mode", each(Bond::mode))?;
        columns.set_item("broken", flag(Bond::is_broken))?;
        columns.set_item(
            "broken_at",
            each(|bond| bond.broken_at().unwrap_or(f64::NAN)),
        )?;
        columns.set_item("ended", flag(Bond::has_ended))?;
        Ok(columns)
    }

    fn bonded_with<'py>(
        &self,
        py: Python<'py>,
        body: BodyId,
    ) -> PyResult<Bound<'py, PyArray1<BodyId>>> {
        self.are_rigid(&[body])?;
        Ok(column(py, self.world.bonded_with(body)))
    }

    fn bonded_pieces<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<BodyId>>> {
        let pieces = self.world.bonded_pieces().into_iter();
        pieces.map(|piece| column(py, piece)).collect()
    }
}
