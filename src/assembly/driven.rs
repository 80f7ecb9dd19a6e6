use super::Model;
use super::numbering::System;
use crate::elements::FormulaWork;

/// Rows of all constraints towards the coordinates that move, of a mechanism whose drives determine its motion.
#[derive(Default)]
pub(crate) struct RowsOfDrives {
    /// One after the other.
    pub rows: Vec<f64>,
    /// Their count, and that of coordinates.
    pub size: usize,
    /// Column of each coordinate of the model.
    columns: Vec<Option<usize>>,
    own: Vec<f64>,
    work: FormulaWork<f64>,
}

impl RowsOfDrives {
    /// Room for those of a system; `None` if there are not as many, those inside nodes included, as coordinates: the mechanism moves on its own.
    pub fn new(system: &System) -> Option<Self> {
        let model = system.model;
        let mut columns = vec![None; model.dofs];
        let moving = model.nodes.iter().filter(|node| !node.fixed).flat_map(|node| node.dofs.clone());
        let size = moving.enumerate().map(|(column, dof)| columns[dof] = Some(column)).count();
        let equations = model.equations - system.options.dropped.len() + system.local_equations;
        let is_driven = equations == size && model.constraints.iter().all(|joint| !joint.physics.is_nonholonomic());
        is_driven.then(|| RowsOfDrives { size, columns, ..Self::default() })
    }

    /// Evaluates them.
    pub fn evaluate(&mut self, system: &System, q: &[f64], p: &[f64], t: f64) {
        let RowsOfDrives { rows, size, columns, own, work } = self;
        let model: &Model = system.model;
        rows.clear();
        let begin_row = |rows: &mut Vec<f64>| {
            rows.resize(rows.len() + *size, 0.0);
            rows.len() - *size
        };
        for inside in &system.locals {
            let dofs = model.nodes[inside.node].dofs.clone();
            for row in inside.physics.rows_in(&q[dofs.clone()], &[], t, work).chunks(dofs.len()) {
                let begin = begin_row(rows);
                for (dof, entry) in dofs.clone().zip(row) {
                    columns[dof].iter().for_each(|column| rows[begin + column] += entry);
                }
            }
        }
        for joint in &model.constraints {
            let dofs = || joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone());
            own.clear();
            own.extend(dofs().map(|dof| q[dof]));
            let found = joint.physics.rows_in(own, &p[joint.parameters.clone()], t, work);
            for (row, equation) in found.chunks(own.len()).zip(joint.equations.clone()) {
                if system.options.dropped.binary_search(&equation).is_ok() {
                    continue;
                }
                let begin = begin_row(rows);
                for (dof, entry) in dofs().zip(row) {
                    columns[dof].iter().for_each(|column| rows[begin + column] += entry);
                }
            }
        }
    }
}
