use super::numbering::System;
use crate::elements::FormulaWork;
use crate::linalg::SparseRow;

/// Rows of all constraints towards the coordinates that move: those of joints, then those inside nodes.
#[derive(Default)]
pub(crate) struct ConstraintRows {
    rows: Vec<SparseRow>,
    /// Column of each coordinate of the model.
    columns: Vec<Option<usize>>,
    own: Vec<f64>,
    work: FormulaWork<f64>,
}

impl ConstraintRows {
    /// Room for those of a system, and whether there are as many of those that are kept as coordinates: drives determine the motion.
    pub fn new(system: &System) -> (Self, bool) {
        let model = system.model;
        let mut columns = vec![None; model.dofs];
        let moving = model.nodes.iter().filter(|node| !node.fixed).flat_map(|node| node.dofs.clone());
        let size = moving.enumerate().map(|(column, dof)| columns[dof] = Some(column)).count();
        let equations = model.equations - system.options.dropped.len() + system.local_equations;
        let is_driven = equations == size && model.constraints.iter().all(|joint| !joint.physics.is_nonholonomic());
        (ConstraintRows { columns, ..Self::default() }, is_driven)
    }

    /// Evaluates those that are kept.
    pub fn evaluate(&mut self, system: &System, (q, p): (&[f64], &[f64]), t: f64) -> &[SparseRow] {
        let ConstraintRows { rows, columns, own, work } = self;
        let model = system.model;
        rows.clear();
        let mut add = |dofs: &mut dyn Iterator<Item = usize>, row: &[f64]| {
            rows.push(dofs.zip(row).filter_map(|(dof, &entry)| Some((columns[dof]?, entry))).collect());
        };
        for joint in &model.constraints {
            let dofs = || joint.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone());
            own.clear();
            own.extend(dofs().map(|dof| q[dof]));
            let found = joint.physics.rows_in(own, &p[joint.parameters.clone()], t, work);
            for (row, equation) in found.chunks(own.len()).zip(joint.equations.clone()) {
                if system.options.dropped.binary_search(&equation).is_err() {
                    add(&mut dofs(), row);
                }
            }
        }
        for inside in &system.locals {
            let dofs = model.nodes[inside.node].dofs.clone();
            for row in inside.physics.rows_in(&q[dofs.clone()], &[], t, work).chunks(dofs.len()) {
                add(&mut dofs.clone(), row);
            }
        }
        rows
    }
}
