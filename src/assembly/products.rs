use super::numbering::System;
use super::residual::{LocalVec, gather, scatter_add, select};
use super::{Equations, Level, NodeId, Unknowns, VectorsAvq};
use crate::elements::{AnyConstraint, ConstraintIn, ElementIn, State};
use crate::scalar::{Dual, Rev, Taylor, add_gradient};
use smallvec::SmallVec;
use std::ops::Range;

/// Adjoint variables of one system: one number for each row of F, Y, G, and of the equations inside nodes.
#[derive(Clone, Debug, Default)]
pub struct Adjoints {
    /// Of F.
    pub f: Vec<f64>,
    /// Of Y; empty unless stabilized.
    pub y: Vec<f64>,
    /// Of the scaled G.
    pub g: Vec<f64>,
    /// Of the second set; empty unless stabilized.
    pub g_second: Vec<f64>,
    /// Of the scaled equations inside nodes (both sets one after the other if stabilized).
    pub local: Vec<f64>,
}

impl Adjoints {
    /// Zeros for a system.
    pub fn zeros(system: &System) -> Self {
        let second = |n: usize| vec![0.0; if system.options.stabilized { n } else { 0 }];
        Adjoints {
            f: vec![0.0; system.model.dofs],
            y: second(system.model.dofs),
            g: vec![0.0; system.multipliers()],
            g_second: second(system.multipliers()),
            local: vec![0.0; system.local_equations * if system.options.stabilized { 2 } else { 1 }],
        }
    }
}

/// Gradient of a scalar function of (a, v, q, p) of one part, one after the other.
fn gradient(local: [&[f64]; 4], function: impl FnOnce(State<Rev>, &[Rev]) -> Rev) -> LocalVec<f64> {
    let [a, v, q, p] = local.map(<[f64]>::len);
    let mut gradient = SmallVec::from_elem(0.0, a + v + q + p);
    let values = local.into_iter().flatten().copied();
    let work = |x: &[Rev]| {
        let (a, rest) = x.split_at(a);
        let (v, rest) = rest.split_at(v);
        let (q, p) = rest.split_at(q);
        function(State { a, v, q }, p)
    };
    add_gradient(values, work, &mut gradient);
    gradient
}

impl System<'_> {
    /// Adds the gradient of lambda . R(a, v, q, p, t) to `at_bar` and `p_bar`.
    pub fn add_element_products(
        &self,
        lambda: &[f64],
        at: &VectorsAvq<f64>,
        p: &[f64],
        t: f64,
        at_bar: &mut VectorsAvq<f64>,
        p_bar: &mut [f64],
    ) {
        for element in &self.model.elements {
            let weights = gather(self.model, &element.nodes, lambda);
            if weights.iter().all(|&w| w == 0.0) {
                continue;
            }
            let [a, v, q] = [&at.a, &at.v, &at.q].map(|x| gather(self.model, &element.nodes, x));
            let own = element.parameters.clone();
            let physics: &dyn ElementIn<Rev> = &*element.physics;
            let gradient = gradient([&a, &v, &q, &p[own.clone()]], |s, p| {
                let mut r: LocalVec<Rev> = SmallVec::from_elem(Rev::default(), s.q.len());
                physics.add_residual(s, p, Rev::from(t), &mut r);
                r.iter().zip(&weights).map(|(&r, &w)| r * w).sum()
            });
            self.scatter_gradient(&element.nodes, own, &gradient, at_bar, p_bar);
        }
    }

    /// Adds the gradient of lambda_F . A^T mu - lambda_Y . A^T eta + lambda_G . G for all joints.
    #[allow(clippy::too_many_arguments)]
    pub fn add_constraint_products(
        &self,
        equations: &Equations,
        adjoints: &Adjoints,
        unknowns: &Unknowns<f64>,
        at: &VectorsAvq<f64>,
        p: &[f64],
        t: f64,
        at_bar: &mut VectorsAvq<f64>,
        p_bar: &mut [f64],
    ) {
        for joint in self.global_constraints() {
            let rows = joint.equations.clone();
            let second = |x: &[f64]| x.get(rows.clone()).map(<[f64]>::to_vec).unwrap_or_default();
            let weights = JointWeights {
                mu: unknowns.mu[rows.clone()].to_vec(),
                eta: second(&unknowns.eta),
                g: adjoints.g[rows.clone()].to_vec(),
                g_second: second(&adjoints.g_second),
            };
            self.add_joint_products(
                joint.physics,
                &joint.nodes,
                joint.parameters,
                &weights,
                equations,
                adjoints,
                at,
                p,
                t,
                at_bar,
                p_bar,
            );
        }
    }

    /// The same for constraints inside nodes: reactions always, their equations' adjoints only if `with_equations`.
    #[allow(clippy::too_many_arguments)]
    pub fn add_local_products(
        &self,
        with_equations: bool,
        equations: &Equations,
        adjoints: &Adjoints,
        unknowns: &Unknowns<f64>,
        at: &VectorsAvq<f64>,
        t: f64,
        at_bar: &mut VectorsAvq<f64>,
    ) {
        for local in self.eliminated() {
            let rows = local.equations.clone();
            let count = rows.len();
            let shifted = rows.start + self.local_equations..rows.end + self.local_equations;
            let second = |x: &[f64], rows: Range<usize>| x.get(rows).map_or_else(|| vec![0.0; 0], <[f64]>::to_vec);
            let weights = if with_equations {
                let none = vec![0.0; if unknowns.local_eta.is_empty() { 0 } else { count }];
                let (g, g_second) = (adjoints.local[rows.clone()].to_vec(), second(&adjoints.local, shifted));
                JointWeights { mu: vec![0.0; count], eta: none, g, g_second }
            } else {
                let (mu, eta) = (unknowns.local_mu[rows.clone()].to_vec(), second(&unknowns.local_eta, rows));
                let none = vec![0.0; eta.len()];
                JointWeights { mu, eta, g: vec![0.0; count], g_second: none }
            };
            let silent = Adjoints { f: vec![0.0; 0], ..Adjoints::default() };
            let adjoints = if with_equations { &silent } else { adjoints };
            let nodes = [NodeId(local.node)];
            self.add_joint_products(
                &*local.physics,
                &nodes,
                0..0,
                &weights,
                equations,
                adjoints,
                at,
                &[],
                t,
                at_bar,
                &mut [],
            );
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn add_joint_products(
        &self,
        physics: &dyn AnyConstraint,
        nodes: &[NodeId],
        parameters: Range<usize>,
        weights: &JointWeights,
        equations: &Equations,
        adjoints: &Adjoints,
        at: &VectorsAvq<f64>,
        p: &[f64],
        t: f64,
        at_bar: &mut VectorsAvq<f64>,
        p_bar: &mut [f64],
    ) {
        let direction = |x: &[f64]| if x.is_empty() { LocalVec::new() } else { gather(self.model, nodes, x) };
        let (lambda_f, lambda_y): (LocalVec<f64>, LocalVec<f64>) = (direction(&adjoints.f), direction(&adjoints.y));
        let [a, v, q] = [&at.a, &at.v, &at.q].map(|x| gather(self.model, nodes, x));
        let scales = equations.row_scales();
        let reaction = physics;
        let physics: &dyn ConstraintIn<Rev> = physics;
        let (count, dofs) = (weights.g.len(), q.len());
        let zeros: LocalVec<Rev> = SmallVec::from_elem(Rev::default(), dofs);
        let time = Rev::from(t);
        // without rates in the level's equations, a and v have no derivative
        let rates = equations.level != Level::Position;
        let none: &[f64] = &[];
        let (a, v) = if rates { (&a[..], &v[..]) } else { (none, none) };
        let gradient = gradient([a, v, &q, &p[parameters.clone()]], |s, p| {
            let mut g: SmallVec<[Taylor<Rev>; 6]> = SmallVec::from_elem(Taylor::default(), count);
            let mut total = Rev::default();
            // lambda . A^T mu is the derivative of mu . g along lambda
            for (lambda, multipliers, sign) in [(&lambda_f, &weights.mu, 1.0), (&lambda_y, &weights.eta, -1.0)] {
                if lambda.iter().any(|&l| l != 0.0) && multipliers.iter().any(|&m| m != 0.0) {
                    let mut along: SmallVec<[Dual<Rev, 1>; 6]> = SmallVec::from_elem(Dual::default(), count);
                    reaction.along(s.q, lambda, p, t, &mut along);
                    total += along.iter().zip(multipliers).map(|(g, &m)| g.eps[0] * (m * sign)).sum::<Rev>();
                }
            }
            if weights.g.iter().chain(&weights.g_second).all(|&weight| weight == 0.0) {
                return total;
            }
            let state = State { a: if rates { s.a } else { &zeros }, v: if rates { s.v } else { &zeros }, q: s.q };
            physics.derivatives(state, p, time, 1.0, &mut g);
            for (row, g) in g.iter().enumerate() {
                let (first, second) = select(equations.level, *g);
                total += first * (weights.g[row] * scales[0]);
                if let Some(&weight) = weights.g_second.get(row) {
                    total += second * (weight * scales[1]);
                }
            }
            total
        });
        let padded: LocalVec<f64> =
            if rates { gradient } else { std::iter::repeat_n(0.0, 2 * dofs).chain(gradient).collect() };
        self.scatter_gradient(nodes, parameters, &padded, at_bar, p_bar);
    }

    fn scatter_gradient(
        &self,
        nodes: &[NodeId],
        parameters: Range<usize>,
        gradient: &[f64],
        at_bar: &mut VectorsAvq<f64>,
        p_bar: &mut [f64],
    ) {
        let dofs = (gradient.len() - parameters.len()) / 3;
        scatter_add(self.model, nodes, &gradient[..dofs], &mut at_bar.a);
        scatter_add(self.model, nodes, &gradient[dofs..2 * dofs], &mut at_bar.v);
        scatter_add(self.model, nodes, &gradient[2 * dofs..3 * dofs], &mut at_bar.q);
        if !parameters.is_empty() {
            for (bar, &g) in p_bar[parameters].iter_mut().zip(&gradient[3 * dofs..]) {
                *bar += g;
            }
        }
    }

    /// Sets the adjoints of the equations inside nodes so that the gradient with respect to each node's unknowns vanishes along
    /// the directions that were eliminated: x_bar + (J^T lambda) + C^T lambda_local = 0, given the left part in (x, y).
    pub fn set_local_adjoints(
        &self,
        equations: &Equations,
        at: &VectorsAvq<f64>,
        t: f64,
        unbalanced_x: &[f64],
        unbalanced_y: &[f64],
        adjoints: &mut Adjoints,
    ) {
        for local in self.eliminated() {
            let dofs = self.model.nodes[local.node].dofs.clone();
            let state = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
            let rows = super::local::equation_rows(local, equations, state, t);
            let mut unbalanced: LocalVec<f64> = unbalanced_x[dofs.clone()].into();
            if let Some(y) = unbalanced_y.get(dofs) {
                unbalanced.extend_from_slice(y);
            }
            let count = rows.len() / unbalanced.len();
            let multipliers = super::local::least_squares(&rows, count, &unbalanced);
            let own = local.equations.len();
            adjoints.local[local.equations.clone()].copy_from_slice(&multipliers[..own]);
            if count > own {
                let start = self.local_equations + local.equations.start;
                adjoints.local[start..start + own].copy_from_slice(&multipliers[own..]);
            }
        }
    }
}

/// Multipliers and adjoints of one joint.
struct JointWeights {
    mu: Vec<f64>,
    eta: Vec<f64>,
    g: Vec<f64>,
    g_second: Vec<f64>,
}
