use super::Model;
use super::model::Spin;
use crate::elements::{ElementPhysics, InTurningFrame, turn, turn_gradient};
use crate::scalar::Scalar;

/// A model at the equilibrium where its motion begins, in the frame that turns with what spins: what holds parts are constraints behind the others,
/// states stay, elements that turn have the parameters of the spin behind their own.
#[derive(Clone)]
pub(crate) struct RestingModel {
    /// The model.
    pub model: Model,
    /// For each of its parameters the one of the moving model.
    sources: Vec<usize>,
}

impl RestingModel {
    /// Parameters, from those of the moving model.
    pub fn parameters<T: Copy>(&self, p: &[T]) -> Vec<T> {
        self.sources.iter().map(|&place| p[place]).collect()
    }

    /// Adds what a gradient is towards its parameters to that towards those of the moving model.
    pub fn add_gradient(&self, own: &[f64], p: &mut [f64]) {
        self.sources.iter().zip(own).for_each(|(&place, own)| p[place] += own);
    }
}

impl Model {
    /// The model at the equilibrium where its motion begins.
    pub(crate) fn at_rest(&self) -> RestingModel {
        let mut resting = self.in_frame();
        let model = &mut resting.model;
        self.states.iter().for_each(|node| model.nodes[node.0].fixed = true);
        for mut hold in std::mem::take(&mut model.holds) {
            hold.equations = model.equations..model.equations + hold.physics.equation_count();
            model.equations = hold.equations.end;
            model.constraints.push(hold);
        }
        resting
    }

    /// The model in the frame that turns with what spins.
    pub(crate) fn in_frame(&self) -> RestingModel {
        let mut model = self.clone();
        let mut sources: Vec<usize> = (0..self.parameters).collect();
        if let Some(spin) = &self.spin {
            model.turn_elements(spin, &mut sources);
        }
        RestingModel { model, sources }
    }

    /// Puts elements in the frame of what spins.
    fn turn_elements(&mut self, spin: &Spin, sources: &mut Vec<usize>) {
        let mut turns = vec![false; self.nodes.len()];
        spin.nodes.iter().for_each(|node| turns[node.0] = true);
        // one recording for elements of one law
        let mut known: Vec<(ElementPhysics, Vec<bool>, ElementPhysics)> = Vec::new();
        for element in &mut self.elements {
            let own: Vec<bool> = element.nodes.iter().map(|node| turns[node.0]).collect();
            if !own.contains(&true) {
                continue;
            }
            let same = known.iter().rev().find(|(physics, turns, _)| physics.is_same(&element.physics) && *turns == own);
            let turned = match same {
                Some((_, _, turned)) => turned.clone(),
                None => {
                    let turned = InTurningFrame::physics(&element.physics, &own);
                    known.push((element.physics.clone(), own, turned.clone()));
                    turned
                }
            };
            element.physics = turned;
            let first = sources.len();
            sources.extend(element.parameters.clone().chain(spin.parameters.clone()));
            element.parameters = first..sources.len();
        }
        self.parameters = sources.len();
    }

    /// Velocities of the model at rest, in its frame: zero, but for states.
    pub(crate) fn velocities_at_rest<S: Scalar>(&self, v: &[S]) -> Vec<S> {
        let mut rest = vec![S::zero(); v.len()];
        for place in self.states.iter().flat_map(|node| self.nodes[node.0].dofs.clone()) {
            rest[place] = v[place];
        }
        rest
    }

    /// Writes the velocities of what spins.
    pub(crate) fn spin_velocities<S: Scalar>(&self, q: &[S], p: &[S], v: &mut [S]) {
        let Some(spin) = &self.spin else { return };
        for node in spin.nodes.iter().map(|node| &self.nodes[node.0]) {
            turn(node.kind, &q[node.dofs.clone()], &p[spin.parameters.clone()], &mut v[node.dofs.clone()]);
        }
    }

    /// Takes a gradient towards the velocities of what spins back to coordinates and parameters, of which they are made.
    pub(crate) fn spin_velocities_back(&self, (q, p): (&[f64], &[f64]), [q_bar, v_bar, p_bar]: [&mut [f64]; 3]) {
        let Some(spin) = &self.spin else { return };
        for node in spin.nodes.iter().map(|node| &self.nodes[node.0]) {
            let own = node.dofs.clone();
            let gradient = turn_gradient(node.kind, &q[own.clone()], &p[spin.parameters.clone()], &v_bar[own.clone()]);
            let bars = q_bar[own.clone()].iter_mut().chain(&mut p_bar[spin.parameters.clone()]);
            bars.zip(gradient).for_each(|(bar, own)| *bar += own);
            v_bar[own].fill(0.0);
        }
    }
}
