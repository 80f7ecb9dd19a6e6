use super::numbering::{Local, System};
use super::{Equations, Level, Model, NodeId, Unknowns, VectorsAvq};
use crate::elements::{RunScalar, State};
use crate::scalar::{Scalar, Taylor};
use rayon::prelude::*;
use smallvec::SmallVec;

/// Values of one element or constraint: on the stack for up to two bodies.
pub(super) type LocalVec<S> = SmallVec<[S; 16]>;

/// Fewer parts than this are evaluated on one thread: waking others costs more.
const PARALLEL_RESIDUALS: usize = 512;

/// Values of the coordinates of some nodes, one after the other.
pub(super) fn gather<S: Copy>(model: &Model, nodes: &[NodeId], values: &[S]) -> LocalVec<S> {
    let mut local = LocalVec::new();
    for node in nodes {
        local.extend_from_slice(&values[model.nodes[node.0].dofs.clone()]);
    }
    local
}

/// Adds local values to the places of some nodes' coordinates.
pub(super) fn scatter_add<S: Scalar>(model: &Model, nodes: &[NodeId], local: &[S], values: &mut [S]) {
    let mut first = 0;
    for node in nodes {
        let dofs = model.nodes[node.0].dofs.clone();
        for (value, &l) in values[dofs.clone()].iter_mut().zip(&local[first..]) {
            *value += l;
        }
        first += dofs.len();
    }
}

/// Residuals of one system at one point, with the workspace to evaluate them.
pub struct Residual<S> {
    /// Point at which R is evaluated.
    pub at: VectorsAvq<S>,
    /// Point at which constraints and reactions are evaluated.
    pub constraint_at: VectorsAvq<S>,
    /// F, reactions inside nodes included.
    pub f: Vec<S>,
    /// Y; empty unless stabilized.
    pub y: Vec<S>,
    /// G, scaled; zero for dropped equations.
    pub g: Vec<S>,
    /// Second set of G, scaled; empty unless stabilized.
    pub g_second: Vec<S>,
    /// Leave the values of unknowns as they are given: they are a solution already, and only derivative parts are solved for.
    pub keep_values: bool,
    /// Largest contribution of one part to F: what round-off of F is measured against.
    pub force_scale: f64,
    /// R at the base point, for a metric.
    base: Vec<S>,
    /// One place for each element's own residual, so that any number of threads adds in the same order.
    parts: Vec<S>,
}

impl<S: RunScalar> Residual<S> {
    /// Workspace for a system.
    pub fn new(system: &System) -> Self {
        let dofs = system.model.dofs;
        let second = |n: usize| vec![S::zero(); if system.options.stabilized { n } else { 0 }];
        Residual {
            at: VectorsAvq::zeros(dofs),
            constraint_at: VectorsAvq::zeros(dofs),
            f: vec![S::zero(); dofs],
            y: second(dofs),
            g: vec![S::zero(); system.multipliers()],
            g_second: second(system.multipliers()),
            keep_values: false,
            force_scale: 0.0,
            base: vec![S::zero(); dofs],
            parts: vec![S::zero(); system.model.elements.iter().map(|e| e.physics.dof_count()).sum()],
        }
    }

    /// Zero unknowns for a system.
    pub fn unknowns(system: &System) -> Unknowns<S> {
        let second = |n: usize| vec![S::zero(); if system.options.stabilized { n } else { 0 }];
        Unknowns {
            x: vec![S::zero(); system.model.dofs],
            y: second(system.model.dofs),
            mu: vec![S::zero(); system.multipliers()],
            eta: second(system.multipliers()),
            local_mu: vec![S::zero(); system.local_equations],
            local_eta: second(system.local_equations),
        }
    }

    /// Prepares for a solve from `base`: for a metric, R there is what is subtracted.
    pub fn start(&mut self, system: &System, equations: &Equations, base: &VectorsAvq<S>, p: &[S], t: f64) {
        if equations.metric {
            self.add_elements(system, base, p, t);
            std::mem::swap(&mut self.f, &mut self.base);
        }
    }

    /// Moves to the point of `unknowns`, satisfies the constraints inside nodes there, and evaluates F, Y and G.
    pub fn evaluate(
        &mut self,
        system: &System,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        p: &[S],
        t: f64,
    ) {
        self.restore(system, equations, base, unknowns);
        self.at.set_shifted(base, equations.residual, unknowns);
        self.constraint_at.set_shifted(base, equations.constraint, unknowns);
        let at = std::mem::take(&mut self.at);
        self.add_elements(system, &at, p, t);
        self.at = at;
        if equations.metric {
            for (f, &r) in self.f.iter_mut().zip(&self.base) {
                *f -= r;
            }
        }
        self.y.copy_from_slice(&unknowns.y);
        self.add_constraints(system, equations, unknowns, p, t);
        for local in system.eliminated() {
            self.eliminate(system, local, unknowns, t);
        }
        for (node, unknowns) in system.model.nodes.iter().zip(&system.nodes) {
            if unknowns.columns.is_empty() {
                self.f[node.dofs.clone()].fill(S::zero());
            }
        }
    }

    /// Brings unknowns back onto the equations inside nodes, from which a step along an older basis leads away a little.
    pub fn restore(&self, system: &System, equations: &Equations, base: &VectorsAvq<S>, unknowns: &mut Unknowns<S>) {
        super::local::restore(system, equations, base, unknowns, self.keep_values);
    }

    /// F = sum of the elements' residuals at `at`.
    fn add_elements(&mut self, system: &System, at: &VectorsAvq<S>, p: &[S], t: f64) {
        let model = system.model;
        let evaluate = |element: &super::Attached<dyn crate::elements::AnyElement>, r: &mut [S]| {
            let [a, v, q] = [&at.a, &at.v, &at.q].map(|x| gather(model, &element.nodes, x));
            r.fill(S::zero());
            let state = State { a: &a, v: &v, q: &q };
            S::element(&*element.physics).add_residual(state, &p[element.parameters.clone()], S::from(t), r);
        };
        let mut rest = self.parts.as_mut_slice();
        if model.elements.len() < PARALLEL_RESIDUALS {
            for element in &model.elements {
                let (own, others) = rest.split_at_mut(element.physics.dof_count());
                evaluate(element, own);
                rest = others;
            }
        } else {
            let mut jobs = Vec::with_capacity(model.elements.len());
            for element in &model.elements {
                let (own, others) = rest.split_at_mut(element.physics.dof_count());
                jobs.push((element, own));
                rest = others;
            }
            jobs.into_par_iter().with_min_len(64).for_each(|(element, own)| evaluate(element, own));
        }
        self.f.fill(S::zero());
        self.force_scale = 0.0;
        let mut first = 0;
        for element in &model.elements {
            let own = &self.parts[first..first + element.physics.dof_count()];
            scatter_add(model, &element.nodes, own, &mut self.f);
            self.force_scale = own.iter().fold(self.force_scale, |scale, r| scale.max(r.value().abs()));
            first += own.len();
        }
    }

    /// Adds the reactions of joints to F (and Y), and writes their scaled equations to G.
    fn add_constraints(&mut self, system: &System, equations: &Equations, unknowns: &Unknowns<S>, p: &[S], t: f64) {
        let model = system.model;
        let scales = equations.row_scales();
        for joint in system.global_constraints() {
            let physics = S::constraint(joint.physics);
            let point = &self.constraint_at;
            let [a, v, q] = [&point.a, &point.v, &point.q].map(|x| gather(model, &joint.nodes, x));
            let p = &p[joint.parameters.clone()];
            let mut reaction: LocalVec<S> = SmallVec::from_elem(S::zero(), q.len());
            physics.add_reaction(&q, &unknowns.mu[joint.equations.clone()], p, S::from(t), &mut reaction);
            scatter_add(model, &joint.nodes, &reaction, &mut self.f);
            self.force_scale = reaction.iter().fold(self.force_scale, |scale, r| scale.max(r.value().abs()));
            if equations.level == Level::Stabilized {
                let eta: LocalVec<S> = unknowns.eta[joint.equations.clone()].iter().map(|&eta| -eta).collect();
                reaction.fill(S::zero());
                physics.add_reaction(&q, &eta, p, S::from(t), &mut reaction);
                scatter_add(model, &joint.nodes, &reaction, &mut self.y);
            }
            let mut g: SmallVec<[Taylor<S>; 6]> = SmallVec::from_elem(Taylor::default(), joint.equations.len());
            write_level(physics, equations.level, State { a: &a, v: &v, q: &q }, p, S::from(t), &mut g);
            for (row, g) in joint.equations.clone().zip(&g) {
                if system.multiplier_columns[row].is_some() {
                    let (first, second) = select(equations.level, *g);
                    self.g[row] = first * scales[0];
                    if let Some(g_second) = self.g_second.get_mut(row) {
                        *g_second = second * scales[1];
                    }
                }
            }
        }
    }

    /// Sets the multipliers inside a node so that F (and Y) have no part along its reaction, and adds that reaction.
    fn eliminate(&mut self, system: &System, local: &Local, unknowns: &mut Unknowns<S>, t: f64) {
        let dofs = system.model.nodes[local.node].dofs.clone();
        let rows = super::local::reaction_rows(local, &self.constraint_at.q[dofs.clone()], t);
        let mu = super::local::least_squares(&rows, local.equations.len(), &self.f[dofs.clone()]);
        super::local::add_combination(&rows, &mu, &mut self.f[dofs.clone()]);
        unknowns.local_mu[local.equations.clone()].copy_from_slice(&mu);
        if !self.y.is_empty() {
            // Y = y - A^T eta: the sign of eta is the opposite one
            let negative = super::local::least_squares(&rows, local.equations.len(), &self.y[dofs.clone()]);
            super::local::add_combination(&rows, &negative, &mut self.y[dofs]);
            for (eta, n) in unknowns.local_eta[local.equations.clone()].iter_mut().zip(negative) {
                *eta = -n;
            }
        }
    }
}

/// Writes g with the derivatives that the level needs.
pub(super) fn write_level<S: RunScalar>(
    physics: &dyn crate::elements::ConstraintIn<S>,
    level: Level,
    s: State<S>,
    p: &[S],
    t: S,
    g: &mut [Taylor<S>],
) {
    if level == Level::Position {
        let mut value: SmallVec<[S; 6]> = SmallVec::from_elem(S::zero(), g.len());
        physics.value(s.q, p, t, &mut value);
        for (g, value) in g.iter_mut().zip(value) {
            g.value = value;
        }
    } else {
        physics.derivatives(s, p, t, 1.0, g);
    }
}

/// The one or two derivatives that are the equations of a level.
pub(super) fn select<S: Scalar>(level: Level, g: Taylor<S>) -> (S, S) {
    match level {
        Level::Position => (g.value, S::zero()),
        Level::Velocity => (g.first, S::zero()),
        Level::Acceleration => (g.second, S::zero()),
        Level::Stabilized => (g.value, g.first),
    }
}
