//! Equilibria of scenes that have one shell, and what is read of them.

use costate::history::Watch;
use costate::integrators::StepRecord;
use costate::internals::{Model, march_dividing};
use costate::prelude::*;
use costate::scenes::AnyScene;

/// Equilibria with their model.
pub struct Solved {
    model: Model,
    p: Vec<f64>,
    start: Vec<f64>,
    /// Coordinates at equal parts of the load; the last is under the whole load.
    pub equilibria: Vec<Vec<f64>>,
}

/// Equilibria at as many equal parts of the load.
pub fn solve(scene: &dyn AnyScene, parts: usize) -> Result<Solved, String> {
    let prepared = Prepared::new(scene).map_err(|error| error.to_string())?;
    let mut equilibria: Vec<Vec<f64>> = Vec::new();
    let mut watch = Watch(|step: &StepRecord<f64>| {
        if step.t + step.h >= (equilibria.len() + 1) as f64 / parts as f64 - 1e-9 {
            equilibria.push(step.q.clone());
        }
        true
    });
    march_dividing(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch)
        .1
        .map_err(|error| error.to_string())?;
    let (model, numbers) = (prepared.mechanism.model, prepared.mechanism.numbers);
    Ok(Solved { start: numbers.q, p: numbers.p, model, equilibria })
}

impl Solved {
    /// Under the whole load.
    pub fn last(&self) -> &[f64] {
        &self.equilibria[self.equilibria.len() - 1]
    }
    /// Coordinates of node (i, j) of the shell among all.
    pub fn node<'q>(&self, q: &'q [f64], i: usize, j: usize) -> Result<&'q [f64], String> {
        let name = format!("shell[{i},{j}]");
        let node = self.model.nodes.iter().find(|node| node.name == name);
        node.map(|node| &q[node.dofs.clone()]).ok_or_else(|| format!("no node is named \"{name}\""))
    }
    /// Displacement of a node [m].
    pub fn displacement(&self, q: &[f64], i: usize, j: usize) -> Result<[f64; 3], String> {
        let (now, start) = (self.node(q, i, j)?, self.node(&self.start, i, j)?);
        Ok(std::array::from_fn(|k| now[k] - start[k]))
    }
    /// Strain energy [J] of the shell at coordinates of all nodes.
    pub fn energy(&self, q: &[f64]) -> f64 {
        let shells = self.model.elements.iter().filter(|element| element.name.starts_with("shell"));
        let energies = shells.map(|element| {
            let own: Vec<f64> =
                element.nodes.iter().flat_map(|node| q[self.model.node(*node).dofs.clone()].to_vec()).collect();
            element.physics.energies_at(&vec![0.0; own.len()], &own, &self.p[element.parameters.clone()])[1]
        });
        energies.sum()
    }
}
