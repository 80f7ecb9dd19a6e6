use super::model::Spin;
use super::{Model, NodeId, VectorsAvq};
use crate::elements::{AtRest, ElementPhysics, OfStates, turn, turn_gradient};
use crate::scalar::Scalar;

/// A model at an equilibrium or about one, in the frame that turns with what spins: elements that turn have the parameters of the spin behind their
/// own, and states of first order are unknowns like coordinates, z in q.
#[derive(Clone)]
pub(crate) struct RestingModel {
    /// The model.
    pub model: Model,
    /// For each of its parameters the one of the moving model.
    sources: Vec<usize>,
    /// GatherMap of states that the moving model has elsewhere, in v.
    states: Vec<usize>,
}

impl RestingModel {
    /// Parameters, from those of the moving model.
    pub fn parameters<T: Copy>(&self, p: &[T]) -> Vec<T> {
        self.sources.iter().map(|&place| p[place]).collect()
    }

    /// Coordinates q, from (q, v) of the moving model.
    pub fn coordinates<T: Copy>(&self, q: &[T], v: &[T]) -> Vec<T> {
        let mut own = q.to_vec();
        self.states.iter().for_each(|&dof| own[dof] = v[dof]);
        own
    }

    /// Velocities at rest: zero, but for the given values of states, of which those are read that stay.
    pub fn velocities<S: Scalar>(&self, v: &[S]) -> Vec<S> {
        let mut rest = vec![S::zero(); v.len()];
        self.states.iter().for_each(|&dof| rest[dof] = v[dof]);
        rest
    }

    /// Moves (q, v) of the moving model to these coordinates at rest.
    pub fn set_motion<T: Copy>(&self, own: &[T], q: &mut [T], v: &mut [T]) {
        self.states.iter().for_each(|&dof| v[dof] = own[dof]);
        let given: Vec<T> = self.states.iter().map(|&dof| q[dof]).collect();
        q.copy_from_slice(own);
        self.states.iter().zip(given).for_each(|(&dof, given)| q[dof] = given);
    }

    /// Takes accelerations, velocities and coordinates about the equilibrium to those of the moving model.
    pub fn in_motion<S: Scalar>(&self, VectorsAvq { a, v, q }: &mut VectorsAvq<S>) {
        for &dof in &self.states {
            (a[dof], v[dof], q[dof]) = (v[dof], q[dof], S::zero());
        }
    }

    /// Adds what a gradient is towards its parameters to that towards those of the moving model.
    pub fn add_gradient(&self, own: &[f64], p: &mut [f64]) {
        self.sources.iter().zip(own).for_each(|(&place, own)| p[place] += own);
    }
}

impl Model {
    /// The model in a search for the equilibrium where its motion begins: what holds parts are constraints behind the others, states follow their rates,
    /// but for those that stay.
    pub(crate) fn at_rest(&self, stays: &[usize]) -> RestingModel {
        let mut resting = self.seen(self.spin.as_ref(), OfStates::InAcceleration, stays);
        let model = &mut resting.model;
        for mut hold in std::mem::take(&mut model.holds) {
            hold.equations = model.equations..model.equations + hold.physics.equation_count();
            model.equations = hold.equations.end;
            model.constraints.push(hold);
        }
        resting
    }

    /// The model of small motions about an equilibrium, in the frame that turns with what spins or in the world; states that nothing reads stay.
    pub(crate) fn about_rest(&self, turns: bool) -> RestingModel {
        self.seen(self.spin.as_ref().filter(|_| turns), OfStates::InVelocity, &self.unread_states())
    }

    /// The same in the frame of the world for equilibria under loads: all states are unknowns.
    pub(crate) fn with_states_as_coordinates(&self) -> Model {
        self.seen(None, OfStates::InVelocity, &[]).model
    }

    /// With states that do not change.
    pub(crate) fn with_states_held(&self) -> Model {
        let mut held = self.clone();
        held.nodes.iter_mut().filter(|node| node.kind.is_of_states()).for_each(|node| node.fixed = true);
        held
    }

    /// GatherMap of all states.
    pub(crate) fn state_dofs(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().filter(|node| node.kind.is_of_states()).flat_map(|node| node.dofs.clone())
    }

    fn seen(&self, spin: Option<&Spin>, of_states: OfStates, stays: &[usize]) -> RestingModel {
        let mut model = self.clone();
        let mut sources: Vec<usize> = (0..self.parameters).collect();
        let states: Vec<usize> = self.state_dofs().filter(|_| !self.states_are_coordinates).collect();
        let of_states = (!states.is_empty()).then_some(of_states);
        // what happens at instants of a motion is none of an equilibrium
        model.events.clear();
        model.states_are_coordinates = true;
        let (mut turns, mut staying) = (vec![false; self.nodes.len()], vec![false; self.dofs]);
        spin.iter().flat_map(|spin| &spin.nodes).for_each(|node| turns[node.0] = true);
        stays.iter().for_each(|&dof| staying[dof] = true);
        let spin: Vec<usize> = spin.iter().flat_map(|spin| spin.parameters.clone()).collect();
        // one recording for elements of one law
        let mut known: Vec<(AtRest, ElementPhysics)> = Vec::new();
        for element in &mut model.elements {
            let own_turns = element.nodes.iter().map(|node| turns[node.0]).collect();
            let stays = element.nodes.iter().flat_map(|node| staying[self.nodes[node.0].dofs.clone()].to_vec());
            let own = AtRest::new(&element.physics, own_turns, of_states, stays.collect());
            if !own.differs() {
                continue;
            }
            if own.turns() {
                let first = sources.len();
                sources.extend(element.parameters.clone().chain(spin.iter().copied()));
                element.parameters = first..sources.len();
            }
            let same = known.iter().rev().find(|(other, _)| own.is_same(other));
            element.physics = match same {
                Some((_, physics)) => physics.clone(),
                None => {
                    let physics = own.clone().physics();
                    known.push((own, physics.clone()));
                    physics
                }
            };
        }
        model.parameters = sources.len();
        RestingModel { model, sources, states }
    }

    /// States on which nothing depends but others of the kind: they are measured alone, and the equilibrium is that of all others.
    pub(crate) fn unread_states(&self) -> Vec<usize> {
        let mut unread: Vec<usize> = self.state_dofs().collect();
        let mut readers: Vec<(Vec<usize>, Vec<Vec<bool>>)> = Vec::new();
        let is_of_states = |node: &NodeId| self.nodes[node.0].kind.is_of_states();
        for element in self.elements.iter().filter(|element| element.nodes.iter().any(is_of_states)) {
            let dofs: Vec<usize> = element.nodes.iter().flat_map(|node| self.nodes[node.0].dofs.clone()).collect();
            let count = if self.states_are_coordinates { 2 } else { 1 } * dofs.len();
            let rows = element.physics.residual().inspect(|graph, outputs| {
                let of_row = |&row| graph.reads(&[row], count + dofs.len())[count..].to_vec();
                outputs.iter().map(of_row).collect()
            });
            readers.push((dofs, rows));
        }
        let joints: Vec<usize> = self.constraints.iter().flat_map(|joint| &joint.nodes).map(|node| node.0).collect();
        unread.retain(|dof| !joints.iter().any(|&node| self.nodes[node].dofs.contains(dof)));
        // from all that may be read by each other alone to those that are read by none but later ones
        let mut kept: Vec<usize> = Vec::new();
        loop {
            let reads = |state: usize| {
                readers.iter().any(|(dofs, rows)| {
                    let place = dofs.iter().position(|&dof| dof == state);
                    place.is_some_and(|place| dofs.iter().zip(rows).any(|(row, reads)| reads[place] && !kept.contains(row)))
                })
            };
            let more: Vec<usize> = unread.iter().copied().filter(|dof| !kept.contains(dof) && !reads(*dof)).collect();
            if more.is_empty() {
                return kept;
            }
            kept.extend(more);
        }
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
            let seeds = q_bar[own.clone()].iter_mut().chain(&mut p_bar[spin.parameters.clone()]);
            seeds.zip(gradient).for_each(|(bar, own)| *bar += own);
            v_bar[own].fill(0.0);
        }
    }
}
