use super::numbering::{Local, Part, System};
use super::{Equations, Impulse, Level, Unknowns, Variational, VectorsAvq};
use crate::elements::{RunScalar, State};
use crate::scalar::{Scalar, Taylor};
use rayon::prelude::*;
use smallvec::SmallVec;
use std::ops::Range;

/// Values of one element or constraint: on the stack for up to two bodies.
pub(super) type LocalVec<S> = SmallVec<[S; 32]>;

/// Share of the largest force below which a stalled residual counts as round-off.
const FORCE_FLOOR: f64 = 1e-10;
/// How many times the effect of one rounding of the coordinates counts as round-off.
const ROUNDINGS: f64 = 8.0;

/// Most corrections of a node's own equations; each gains many digits.
const RESTORATIONS: usize = 8;

/// Pieces into which the evaluation of many elements is divided, whatever the number of threads.
const JOBS: usize = 64;

/// Fewer parts than this are evaluated on one thread: waking others costs more.
const PARALLEL_RESIDUALS: usize = 512;

/// The next number above or below, by a place in a list: in no pattern that coordinates could follow.
fn neighbour<S: Scalar>(value: S, place: usize) -> S {
    let up = (place as u32).wrapping_mul(0x9e37_79b9).wrapping_add(0x7f4a_7c15) >> 31 == 0;
    value * (1.0 + if up { f64::EPSILON } else { -f64::EPSILON })
}

/// Adds local values to the places of some nodes' coordinates.
fn add_segments<'s, S: Scalar>(segments: impl IntoIterator<Item = &'s Range<usize>>, local: &[S], values: &mut [S]) {
    let mut first = 0;
    for dofs in segments {
        for (value, &l) in values[dofs.clone()].iter_mut().zip(&local[first..]) {
            *value += l;
        }
        first += dofs.len();
    }
}

/// Numbers of one part, where they don't stand next to each other in the model's vectors.
#[derive(Clone, Debug, Default)]
pub(super) struct Local3<S> {
    a: Vec<S>,
    v: Vec<S>,
    q: Vec<S>,
}

impl<S: Copy> Local3<S> {
    /// (a, v, q) of a part: the model's own numbers for one node, copies for several.
    #[inline]
    pub fn state<'s>(&'s mut self, part: &Part, at: &'s VectorsAvq<S>) -> State<'s, S> {
        if let [only] = part.segments.as_slice() {
            return State { a: &at.a[only.clone()], v: &at.v[only.clone()], q: &at.q[only.clone()] };
        }
        for (own, all) in [(&mut self.a, &at.a), (&mut self.v, &at.v), (&mut self.q, &at.q)] {
            own.clear();
            for segment in &part.segments {
                own.extend_from_slice(&all[segment.clone()]);
            }
        }
        State { a: &self.a, v: &self.v, q: &self.q }
    }
}

/// What the evaluation of one part writes to.
#[derive(Clone, Debug, Default)]
struct Workspace<S> {
    state: Local3<S>,
    force: Vec<S>,
    eta: Vec<S>,
    g: Vec<Taylor<S>>,
    moved: Vec<S>,
    change: Vec<S>,
    rounded: Vec<f64>,
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
    /// Leave unknowns as they are and move (a, v, q) to neighbouring numbers, some up and some down: what that changes is round-off.
    pub last_bits: bool,
    /// Point at which reactions act, where that is another one than the constraints': in a step of a variational integrator.
    pub reaction_at: VectorsAvq<S>,
    /// What is subtracted: R at the base point, for a metric, or what the step before left.
    base: Vec<S>,
    /// The base, moved to where constraints hold in a step of a variational integrator.
    constraint_base: VectorsAvq<S>,
    /// Where R is evaluated for an impulse, and their sum.
    impulse_at: VectorsAvq<S>,
    sum: Vec<S>,
    /// One place for each element's own residual, so that any number of threads adds in the same order.
    parts: Vec<S>,
    work: Workspace<S>,
    /// Of each piece.
    locals: Vec<Local3<S>>,
    restored: VectorsAvq<S>,
}

impl<S: RunScalar> Residual<S> {
    /// Workspace for a system.
    pub fn new(system: &System) -> Self {
        let dofs = system.model.dofs;
        let second = |n: usize| vec![S::zero(); if system.options.stabilized { n } else { 0 }];
        let parallel = system.model.elements.len() >= PARALLEL_RESIDUALS;
        let most = system.element_parts.iter().chain(&system.constraint_parts).map(|part| part.dofs).max().unwrap_or(0);
        let room = || Vec::with_capacity(most);
        let (moved, change, rounded) = (room(), room(), Vec::with_capacity(most));
        let work = Workspace { moved, change, rounded, ..Workspace::default() };
        Residual {
            at: VectorsAvq::zeros(dofs),
            constraint_at: VectorsAvq::zeros(dofs),
            f: vec![S::zero(); dofs],
            y: second(dofs),
            g: vec![S::zero(); system.multipliers()],
            g_second: second(system.multipliers()),
            keep_values: false,
            last_bits: false,
            reaction_at: VectorsAvq::default(),
            base: vec![S::zero(); dofs],
            constraint_base: VectorsAvq::default(),
            impulse_at: VectorsAvq::default(),
            sum: Vec::new(),
            parts: vec![S::zero(); if parallel { system.element_parts.iter().map(|part| part.dofs).sum() } else { 0 }],
            work,
            locals: Vec::new(),
            restored: VectorsAvq::default(),
        }
    }

    /// Zero unknowns for a system.
    pub fn unknowns(system: &System) -> Unknowns<S> {
        let mut unknowns = Unknowns::default();
        Self::shape(system, &mut unknowns, true);
        unknowns
    }

    /// Gives unknowns the lengths that a system asks for, with zeros where there was nothing or everywhere if `anew`.
    pub fn shape(system: &System, unknowns: &mut Unknowns<S>, anew: bool) {
        let second = |n: usize| if system.options.stabilized { n } else { 0 };
        let Unknowns { x, y, mu, eta, local_mu, local_eta } = unknowns;
        let (dofs, rows, local) = (system.model.dofs, system.multipliers(), system.local_equations);
        let lengths = [dofs, second(dofs), rows, second(rows), local, second(local)];
        for (values, length) in [x, y, mu, eta, local_mu, local_eta].into_iter().zip(lengths) {
            if anew {
                values.clear();
            }
            values.resize(length, S::zero());
        }
    }

    /// Prepares for a solve from `base`: for a metric, R there is what is subtracted.
    pub fn start(&mut self, system: &System, equations: &Equations, base: &VectorsAvq<S>, p: &[S], t: f64) {
        if equations.metric {
            self.add_elements(system, base, p, t);
            std::mem::swap(&mut self.f, &mut self.base);
        }
        if let Some(step) = equations.variational {
            let mut before = std::mem::take(&mut self.constraint_base);
            Variational::write_moved(base, step.to_before(), &mut before);
            self.add_impulses(system, &before, p, t + step.to_before(), step.before());
            std::mem::swap(&mut self.f, &mut self.base);
            self.constraint_base = before;
        }
    }

    /// F = sum of the elements' impulses for (v, q) of a point.
    fn add_impulses(&mut self, system: &System, point: &VectorsAvq<S>, p: &[S], t: f64, impulse: Impulse) {
        let mut at = std::mem::take(&mut self.impulse_at);
        let mut sum = std::mem::take(&mut self.sum);
        sum.clear();
        sum.resize(point.q.len(), S::zero());
        at.q.clone_from(&point.q);
        for term in impulse.terms() {
            for (own, factor) in [(&mut at.a, term.a), (&mut at.v, term.v)] {
                own.clear();
                own.extend(point.v.iter().map(|&v| v * factor));
            }
            self.add_elements(system, &at, p, t);
            sum.iter_mut().zip(&self.f).for_each(|(sum, &f)| *sum += f * term.weight);
        }
        if impulse.force != 0.0 {
            let Workspace { state, force, .. } = &mut self.work;
            for (element, part) in system.model.elements.iter().zip(&system.element_parts) {
                if element.physics.has_constant_mass() {
                    continue;
                }
                let own = state.state(part, point);
                force.clear();
                force.resize(part.dofs, S::zero());
                S::element(&*element.physics).add_momentum_rate(own.v, own.q, &p[part.parameters.clone()], force);
                force.iter_mut().for_each(|force| *force = *force * impulse.force);
                add_segments(&part.segments, force, &mut sum);
            }
        }
        std::mem::swap(&mut self.f, &mut sum);
        (self.impulse_at, self.sum) = (at, sum);
    }

    /// The base from which unknowns move to where constraints hold.
    fn move_base<'b>(equations: &Equations, base: &'b VectorsAvq<S>, moved: &'b mut VectorsAvq<S>) -> &'b VectorsAvq<S> {
        let Some(step) = equations.variational else { return base };
        Variational::write_moved(base, step.to_end(), moved);
        moved
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
        // in real numbers one correction keeps up with Newton's method; derivative parts are solved for once
        let corrections = if S::PARTS == 0 { 1 } else { RESTORATIONS };
        let mut moved = std::mem::take(&mut self.constraint_base);
        let constraint_base = Self::move_base(equations, base, &mut moved);
        if !self.last_bits {
            let work = &mut self.restored;
            super::local::restore(system, equations, constraint_base, unknowns, self.keep_values, corrections, work);
        }
        self.at.set_shifted(base, equations.residual, unknowns);
        self.constraint_at.set_shifted(constraint_base, equations.constraint, unknowns);
        self.constraint_base = moved;
        if let Some(step) = equations.variational {
            Variational::write_moved(base, step.to_start(), &mut self.reaction_at);
        }
        if self.last_bits {
            for at in [&mut self.at, &mut self.constraint_at] {
                for (which, values) in [&mut at.a, &mut at.v, &mut at.q].into_iter().enumerate() {
                    values.iter_mut().enumerate().for_each(|(i, value)| *value = neighbour(*value, 3 * i + which));
                }
            }
        }
        let at = std::mem::take(&mut self.at);
        match equations.variational {
            Some(step) => self.add_impulses(system, &at, p, t, step.now()),
            None => self.add_elements(system, &at, p, t),
        }
        self.at = at;
        if equations.subtracts() {
            for (f, &r) in self.f.iter_mut().zip(&self.base) {
                *f -= r;
            }
        }
        self.y.copy_from_slice(&unknowns.y);
        self.add_constraints(system, equations, unknowns, p, t);
        for local in system.eliminated() {
            self.eliminate(system, equations, local, unknowns);
        }
        for (node, unknowns) in system.model.nodes.iter().zip(&system.nodes) {
            if unknowns.columns.is_empty() {
                self.f[node.dofs.clone()].fill(S::zero());
            }
        }
    }

    /// Brings unknowns back onto the equations inside nodes, from which a step along an older basis leads away a little.
    pub fn restore(&mut self, system: &System, equations: &Equations, base: &VectorsAvq<S>, unknowns: &mut Unknowns<S>) {
        let mut moved = std::mem::take(&mut self.constraint_base);
        let base = Self::move_base(equations, base, &mut moved);
        super::local::restore(system, equations, base, unknowns, self.keep_values, RESTORATIONS, &mut self.restored);
        self.constraint_base = moved;
    }

    /// Where reactions act.
    pub(super) fn reaction_point(&self, equations: &Equations) -> &VectorsAvq<S> {
        if equations.variational.is_some() { &self.reaction_at } else { &self.constraint_at }
    }

    /// Force below which F is round-off at the point evaluated last: a share of the largest contribution of one element or joint,
    /// or what the last bit of the coordinates does to a stiff element.
    pub fn force_floor(&mut self, system: &System, unknowns: &Unknowns<S>, p: &[S], t: f64) -> f64 {
        let (mut scale, mut noise): (f64, f64) = (0.0, 0.0);
        let Workspace { state, force, moved, change, rounded, .. } = &mut self.work;
        let largest = |force: &[S]| force.iter().fold(0.0, |scale: f64, r| scale.max(r.value().abs()));
        for (element, part) in system.model.elements.iter().zip(&system.element_parts) {
            force.clear();
            force.resize(part.dofs, S::zero());
            let own = state.state(part, &self.at);
            let (physics, p) = (S::element(&*element.physics), &p[part.parameters.clone()]);
            physics.add_residual(own, p, S::from(t), force);
            scale = scale.max(largest(force));
            // what the last bit of each coordinate does, added up: signs that go against each other would hide it
            moved.clear();
            moved.extend_from_slice(own.q);
            rounded.clear();
            rounded.resize(part.dofs, 0.0);
            for place in 0..part.dofs {
                moved[place] = own.q[place] * (1.0 + f64::EPSILON);
                change.clear();
                change.extend(force.iter().map(|&r| -r));
                physics.add_residual(State { q: moved, ..own }, p, S::from(t), change);
                rounded.iter_mut().zip(&*change).for_each(|(sum, change)| *sum += change.value().abs());
                moved[place] = own.q[place];
            }
            noise = rounded.iter().fold(noise, |noise: f64, &sum| noise.max(sum));
        }
        for (joint, part) in system.global_constraints().zip(&system.constraint_parts) {
            force.clear();
            force.resize(part.dofs, S::zero());
            let own = state.state(part, &self.constraint_at);
            let mu = &unknowns.mu[joint.equations.clone()];
            S::constraint(joint.physics).add_reaction(own.q, mu, &p[part.parameters.clone()], S::from(t), force);
            scale = scale.max(largest(force));
        }
        (FORCE_FLOOR * scale).max(ROUNDINGS * noise)
    }

    /// F = sum of the elements' residuals at `at`.
    fn add_elements(&mut self, system: &System, at: &VectorsAvq<S>, p: &[S], t: f64) {
        let evaluate = |index: usize, state: State<S>, r: &mut [S]| {
            let parameters = &p[system.element_parts[index].parameters.clone()];
            S::element(&*system.model.elements[index].physics).add_residual(state, parameters, S::from(t), r);
        };
        self.f.fill(S::zero());
        let Workspace { state, force, .. } = &mut self.work;
        if self.parts.is_empty() {
            for (index, part) in system.element_parts.iter().enumerate() {
                let own = state.state(part, at);
                if let [only] = part.segments.as_slice() {
                    evaluate(index, own, &mut self.f[only.clone()]);
                } else {
                    force.clear();
                    force.resize(part.dofs, S::zero());
                    evaluate(index, own, force);
                    add_segments(&part.segments, force, &mut self.f);
                }
            }
            return;
        }
        let count = system.element_parts.len();
        let each = count.div_ceil(JOBS);
        let mut rest = self.parts.as_mut_slice();
        let mut jobs: SmallVec<[(usize, &mut [S]); JOBS]> = SmallVec::new();
        for first in (0..count).step_by(each) {
            let dofs = system.element_parts[first..count.min(first + each)].iter().map(|part| part.dofs).sum();
            let (own, others) = rest.split_at_mut(dofs);
            jobs.push((first, own));
            rest = others;
        }
        self.locals.resize_with(jobs.len(), Local3::default);
        jobs.par_iter_mut().zip(&mut self.locals).for_each(|((first, own), state)| {
            let mut rest = &mut **own;
            rest.fill(S::zero());
            for (index, part) in system.element_parts.iter().enumerate().skip(*first).take(each) {
                let (own, others) = std::mem::take(&mut rest).split_at_mut(part.dofs);
                evaluate(index, state.state(part, at), own);
                rest = others;
            }
        });
        drop(jobs);
        let mut first = 0;
        for part in &system.element_parts {
            add_segments(&part.segments, &self.parts[first..first + part.dofs], &mut self.f);
            first += part.dofs;
        }
    }

    /// Adds the reactions of joints to F (and Y), and writes their scaled equations to G.
    fn add_constraints(&mut self, system: &System, equations: &Equations, unknowns: &Unknowns<S>, p: &[S], t: f64) {
        let scales = equations.row_scales();
        let (time, reaction_time) = (S::from(equations.constraint_time(t)), S::from(equations.reaction_time(t)));
        let Workspace { state, force, eta, g, .. } = &mut self.work;
        for (joint, part) in system.global_constraints().zip(&system.constraint_parts) {
            let physics = S::constraint(joint.physics);
            let p = &p[part.parameters.clone()];
            force.clear();
            force.resize(part.dofs, S::zero());
            if let Some(step) = equations.variational {
                let q = state.state(part, &self.reaction_at).q;
                physics.add_reaction(q, &unknowns.mu[joint.equations.clone()], p, reaction_time, force);
                force.iter_mut().for_each(|force| *force = *force * step.reaction());
            }
            let own = state.state(part, &self.constraint_at);
            if equations.variational.is_none() {
                physics.add_reaction(own.q, &unknowns.mu[joint.equations.clone()], p, time, force);
            }
            add_segments(&part.segments, force, &mut self.f);
            if equations.level == Level::Stabilized {
                eta.clear();
                eta.extend(unknowns.eta[joint.equations.clone()].iter().map(|&eta| -eta));
                force.fill(S::zero());
                physics.add_reaction(own.q, eta, p, time, force);
                add_segments(&part.segments, force, &mut self.y);
            }
            g.clear();
            g.resize(joint.equations.len(), Taylor::default());
            if joint.physics.is_nonholonomic() {
                physics.derivatives(own, p, time, 1.0, g);
                let wanted = [equations.nonholonomic(false), equations.nonholonomic(true)];
                let rows = [(&mut self.g, &unknowns.mu), (&mut self.g_second, &unknowns.eta)];
                for (wanted, (target, multipliers)) in wanted.into_iter().zip(rows) {
                    for (row, g) in joint.equations.clone().zip(&*g) {
                        if row < target.len() && system.multiplier_columns[row].is_some() {
                            target[row] = match wanted {
                                Some((level, scale)) => select(level, *g).0 * scale,
                                None => multipliers[row],
                            };
                        }
                    }
                }
                continue;
            }
            write_level(physics, equations.level, own, p, time, g);
            for (row, g) in joint.equations.clone().zip(&*g) {
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
    fn eliminate(&mut self, system: &System, equations: &Equations, local: &Local, unknowns: &mut Unknowns<S>) {
        let dofs = system.model.nodes[local.node].dofs.clone();
        let rows = super::local::reaction_rows(local, &self.reaction_point(equations).q[dofs.clone()]);
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
