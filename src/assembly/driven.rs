use super::numbering::System;

impl System<'_> {
    /// Rows of all constraints, those inside nodes included, towards the coordinates that move, one after the other, and their count; `None` if
    /// there are not as many as coordinates: the mechanism moves on its own.
    pub(crate) fn rows_of_drives(&self, q: &[f64], p: &[f64], t: f64) -> Option<(Vec<f64>, usize)> {
        let mut columns = vec![None; self.model.dofs];
        let moving = self.model.nodes.iter().filter(|node| !node.fixed).flat_map(|node| node.dofs.clone());
        let size = moving.enumerate().map(|(column, dof)| columns[dof] = Some(column)).count();
        let equations = self.model.equations - self.options.dropped.len() + self.local_equations;
        let nonholonomic = self.model.constraints.iter().any(|joint| joint.physics.is_nonholonomic());
        if equations != size || nonholonomic {
            return None;
        }
        let mut rows = Vec::with_capacity(size * size);
        let mut add = |dofs: &[usize], own: &[f64]| {
            let begin = rows.len();
            rows.resize(begin + size, 0.0);
            for (&dof, &entry) in dofs.iter().zip(own) {
                if let Some(column) = columns[dof] {
                    rows[begin + column] += entry;
                }
            }
        };
        for local in &self.locals {
            let dofs: Vec<usize> = self.model.nodes[local.node].dofs.clone().collect();
            let mut own = vec![0.0; local.equations.len() * dofs.len()];
            local.form.rows(&q[dofs[0]..dofs[0] + dofs.len()], &mut own);
            own.chunks(dofs.len()).for_each(|row| add(&dofs, row));
        }
        for joint in &self.model.constraints {
            let dofs: Vec<usize> = joint.nodes.iter().flat_map(|node| self.model.nodes[node.0].dofs.clone()).collect();
            let own: Vec<f64> = dofs.iter().map(|&dof| q[dof]).collect();
            let own = joint.physics.rows(&own, &p[joint.parameters.clone()], t);
            for (row, equation) in own.chunks(dofs.len()).zip(joint.equations.clone()) {
                if self.options.dropped.binary_search(&equation).is_err() {
                    add(&dofs, row);
                }
            }
        }
        Some((rows, size))
    }
}
