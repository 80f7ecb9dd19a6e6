use super::batches::Batch;
use super::constraint_programs::{Asked, ConstraintPart, values};
use super::element_programs::Force;
use super::evaluation::{BatchWork, run_lanes};
use super::inside_nodes::InsideNodes;
use super::lanes::last_bit;
use super::numbering::System;
use super::reduction::NodeReduction;
use super::{Clock, Equations, StageSystem, TermPoint, Unknowns, VectorsAvq};
use crate::elements::{FormulaWork, RunScalar};
use crate::scalar::Scalar;

/// How many times the effect of one rounding of the coordinates counts as round-off.
const ROUNDINGS: f64 = 8.0;

/// Most corrections of a node's own equations; each gains many digits.
const RESTORATIONS: usize = 8;

/// The next number above or below, by a place in a list: in no pattern that coordinates could follow.
fn neighbour<S: Scalar>(value: S, place: usize) -> S {
    value * (1.0 + last_bit(place))
}

/// Residuals of one system at one point, with the workspace to evaluate them, which takes memory at its first use.
pub struct Residual<S> {
    /// Point at which R is evaluated.
    pub at: VectorsAvq<S>,
    /// F, reactions inside nodes included.
    pub f: Vec<S>,
    /// G, scaled; zero for dropped equations.
    pub g: Vec<S>,
    /// Leave the values of unknowns as they are given: they are a solution already, and only derivative parts are solved for.
    pub keep_values: bool,
    /// Leave unknowns as they are and move (a, v, q), and what each element and joint adds to a force, to neighbouring numbers, some up and
    /// some down: what that changes is round-off.
    pub last_bits: bool,
    /// How time goes, where derivative parts move the ends of steps.
    pub clock: Option<Clock<S>>,
    /// What is taken off G, by rows: what an impact keeps.
    pub kept: Vec<(usize, S)>,
    /// Point at which reactions act, where that is another one than the constraints': in a step of a variational integrator.
    pub reaction_at: VectorsAvq<S>,
    /// Point at which constraints and reactions are evaluated, unless that is the one of R.
    constraint_at: VectorsAvq<S>,
    pub(super) has_one_point: bool,
    /// What is subtracted: R at the base point, for a metric, or what the step before left.
    base: Vec<S>,
    /// The base, moved to where constraints hold in a step of a variational integrator.
    constraint_base: VectorsAvq<S>,
    work: BatchWork<S>,
    inside_nodes: InsideNodes<S>,
    floor: Floor,
}

/// Parts that are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scope {
    /// All.
    Model,
    /// Those at nodes with constraints inside.
    InsideNodes,
}

impl Scope {
    fn has<L>(self, batch: &Batch<L>) -> bool {
        let is_free = |node: &NodeReduction| matches!(node, NodeReduction::Fixed { .. } | NodeReduction::Free { .. });
        self == Scope::Model || !batch.nodes.iter().all(is_free)
    }
}

/// Where constraints are evaluated: at the point of R, or at another one.
fn of_constraints<'r, S>(has_one_point: bool, at: &'r VectorsAvq<S>, other: &'r VectorsAvq<S>) -> &'r VectorsAvq<S> {
    if has_one_point { at } else { other }
}

/// Workspace of [`Residual::force_floor`].
#[derive(Default)]
struct Floor {
    work: FormulaWork<f64>,
    /// Arguments, force, and what one rounding of its arguments changes of it.
    numbers: [Vec<f64>; 3],
    q: Vec<f64>,
    mu: Vec<f64>,
    own_p: Vec<f64>,
}

super::empty_fields!(Residual {
    at,
    f,
    g,
    keep_values,
    last_bits,
    clock,
    kept,
    reaction_at,
    constraint_at,
    has_one_point,
    base,
    constraint_base,
    work,
    inside_nodes,
    floor,
});

impl<S: RunScalar> Residual<S> {
    /// One that all ranks evaluate in the same order: they share its elements.
    pub fn shared() -> Self {
        Residual { work: BatchWork::shared(), ..Residual::default() }
    }

    /// Point at which constraints and reactions were evaluated.
    pub fn constraint_at(&self) -> &VectorsAvq<S> {
        of_constraints(self.has_one_point, &self.at, &self.constraint_at)
    }

    /// Numbers for a system.
    fn make_room(&mut self, system: &System) {
        let (dofs, rows) = (system.model.dofs, system.multipliers());
        if self.f.len() == dofs && self.g.len() == rows {
            return;
        }
        let lists = [(&mut self.f, dofs), (&mut self.base, dofs), (&mut self.g, rows)];
        lists.into_iter().for_each(|(list, length)| list.resize(length, S::zero()));
        (self.at, self.constraint_at) = (VectorsAvq::zeros(dofs), VectorsAvq::zeros(dofs));
    }

    /// Zero unknowns for a system.
    pub fn unknowns(system: &System) -> Unknowns<S> {
        let mut unknowns = Unknowns::default();
        Self::shape(system, &mut unknowns, true);
        unknowns
    }

    /// Gives unknowns the lengths that a system asks for, with zeros where there was nothing or everywhere if `anew`.
    pub fn shape(system: &System, unknowns: &mut Unknowns<S>, anew: bool) {
        let Unknowns { x, mu, local_mu } = unknowns;
        let lengths = [system.model.dofs, system.multipliers(), system.local_equations];
        for (values, length) in [x, mu, local_mu].into_iter().zip(lengths) {
            if anew {
                values.clear();
            }
            values.resize(length, S::zero());
        }
    }

    /// Prepares for a solve from `base`: of a metric that is a difference, R there is what is subtracted.
    pub fn start(&mut self, system: &System, stage: StageSystem<S>) {
        self.start_in(Scope::Model, system, stage);
    }

    fn start_in(&mut self, scope: Scope, system: &System, stage: StageSystem<S>) {
        let StageSystem { equations, base, p, t } = stage;
        self.make_room(system);
        let Some((force, point)) = equations.subtracted() else { return };
        let mut moved = std::mem::take(&mut self.constraint_base);
        let there = equations.point_of(point, base, &mut moved);
        let by_clock = self.clock.map(|clock| {
            let mut own = there.clone();
            clock.set_pace(&mut own);
            own
        });
        let time = equations.time_at(point, t);
        self.add_elements(scope, system, force, by_clock.as_ref().unwrap_or(there), p, time);
        std::mem::swap(&mut self.f, &mut self.base);
        self.constraint_base = moved;
    }

    /// Moves to the point of `unknowns`, satisfies the constraints inside nodes there, and evaluates F and G.
    pub fn evaluate(&mut self, system: &System, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) {
        self.evaluate_in(Scope::Model, system, stage, unknowns);
    }

    /// Moves from `base` to the point of a solution, and sets the multipliers inside nodes that follow from it: all that a matrix and products
    /// need of the evaluation there. F and G have no meaning then.
    pub fn move_to(&mut self, system: &System, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) {
        self.start_in(Scope::InsideNodes, system, stage);
        self.evaluate_in(Scope::InsideNodes, system, stage, unknowns);
    }

    fn evaluate_in(&mut self, scope: Scope, system: &System, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) {
        let StageSystem { equations, base, p, t } = stage;
        self.make_room(system);
        // in real numbers one correction keeps up with Newton's method; derivative parts are solved for once
        let corrections = if S::PARTS == 0 { 1 } else { RESTORATIONS };
        let mut moved = std::mem::take(&mut self.constraint_base);
        let constraint_base = equations.point_of(TermPoint::Constraints, base, &mut moved);
        if !self.last_bits {
            let how = (self.keep_values, corrections);
            self.inside_nodes.restore(system, equations, constraint_base, unknowns, how);
        }
        self.at.set_shifted(base, equations.residual, unknowns);
        if equations.is_of_inertia() {
            self.at.a.iter_mut().zip(&unknowns.x).for_each(|(a, &x)| *a = x * equations.residual.gamma);
        }
        self.has_one_point = equations.has_one_point();
        if !self.has_one_point {
            self.constraint_at.set_shifted(constraint_base, equations.constraint, unknowns);
        }
        self.constraint_base = moved;
        // what unknowns do not move is no point by itself elsewhere
        let parts_reactions = equations.parts_reactions();
        if parts_reactions {
            equations.point_of(TermPoint::Reactions, base, &mut self.reaction_at);
        }
        if let Some(clock) = self.clock {
            let further = (!self.has_one_point).then_some(&mut self.constraint_at);
            let points = [Some(&mut self.at), further, parts_reactions.then_some(&mut self.reaction_at)];
            points.into_iter().flatten().for_each(|at| clock.set_pace(at));
        }
        if self.last_bits {
            let further = (!self.has_one_point).then_some(&mut self.constraint_at);
            for at in [Some(&mut self.at), further].into_iter().flatten() {
                for (which, values) in [&mut at.a, &mut at.v, &mut at.q].into_iter().enumerate() {
                    values.iter_mut().enumerate().for_each(|(i, value)| *value = neighbour(*value, 3 * i + which));
                }
            }
        }
        let at = std::mem::take(&mut self.at);
        self.add_elements(scope, system, Force::of(equations), &at, p, t);
        self.at = at;
        if equations.subtracted().is_some() {
            for (f, &r) in self.f.iter_mut().zip(&self.base) {
                *f -= r;
            }
        }
        self.add_constraints(scope, system, equations, unknowns, p, t);
        for run in system.node_runs.iter().filter(|run| matches!(run.reduction, NodeReduction::Fixed { .. })) {
            self.f[run.all_dofs()].fill(S::zero());
        }
        let Residual { f, inside_nodes, at, constraint_at, reaction_at, has_one_point, .. } = self;
        let there = if parts_reactions { reaction_at } else { of_constraints(*has_one_point, at, constraint_at) };
        let q = &there.q;
        inside_nodes.eliminate(system, q, f, &mut unknowns.local_mu);
    }

    /// Brings unknowns back onto the equations inside nodes, from which a step along an older basis leads away a little.
    pub fn restore(&mut self, system: &System, stage: StageSystem<S>, unknowns: &mut Unknowns<S>) {
        let StageSystem { equations, base, .. } = stage;
        let mut moved = std::mem::take(&mut self.constraint_base);
        let base = equations.point_of(TermPoint::Constraints, base, &mut moved);
        self.inside_nodes.restore(system, equations, base, unknowns, (self.keep_values, RESTORATIONS));
        self.constraint_base = moved;
    }

    /// Force below which F is round-off at the point evaluated last: a share of the largest contribution of one element or joint,
    /// or what the last bit of the coordinates does to a stiff element.
    pub fn force_floor(&mut self, system: &System, stage: StageSystem<S>, unknowns: &Unknowns<S>) -> f64 {
        let StageSystem { p, t, .. } = stage;
        let (mut scale, mut noise): (f64, f64) = (0.0, 0.0);
        let largest = |force: &[f64]| force.iter().fold(0.0, |scale: f64, r| scale.max(r.abs()));
        let constraint_at = of_constraints(self.has_one_point, &self.at, &self.constraint_at);
        let Floor { work, numbers: [inputs, force, rounded], q, mu, own_p } = &mut self.floor;
        for batch in system.element_batches(Force::Residual) {
            let (program, layout) = (batch.formula.values(), batch.layout);
            for part in batch.parts.iter().map(|&part| &system.element_parts[part]) {
                inputs.clear();
                for values in [&self.at.a, &self.at.v, &self.at.q] {
                    inputs.extend(part.segments.iter().flat_map(|dofs| &values[dofs.clone()]).map(|x| x.value()));
                }
                inputs.extend(p[part.parameters.clone()].iter().map(|p| p.value()));
                inputs.push(t);
                force.clear();
                force.extend_from_slice(work.run(program, inputs.iter().copied()));
                scale = scale.max(largest(force));
                // what the last bit of each coordinate does, added up: signs that go against each other would hide it
                rounded.clear();
                rounded.resize(layout.n, 0.0);
                for place in 2 * layout.n..3 * layout.n {
                    let at = inputs[place];
                    inputs[place] = at * (1.0 + f64::EPSILON);
                    let changed = work.run(program, inputs.iter().copied());
                    rounded
                        .iter_mut()
                        .zip(changed.iter().zip(&*force))
                        .for_each(|(sum, (new, old))| *sum += (new - old).abs());
                    inputs[place] = at;
                }
                noise = noise.max(largest(rounded));
            }
        }
        let real = |to: &mut Vec<f64>, from: &mut dyn Iterator<Item = &S>| {
            to.clear();
            to.extend(from.map(|x| x.value()));
        };
        for (number, part) in system.constraint_parts.iter().enumerate() {
            let is_loaded = unknowns.mu[system.equations_of(number)].iter().any(|mu| mu.value() != 0.0);
            if !is_loaded && !system.global_constraint(number).has_friction() {
                continue;
            }
            real(q, &mut part.segments.iter().flat_map(|dofs| &constraint_at.q[dofs.clone()]));
            real(mu, &mut unknowns.mu[system.equations_of(number)].iter());
            real(own_p, &mut p[part.parameters.clone()].iter());
            scale = scale.max(largest(system.global_constraint(number).reaction_in((q, own_p, t), mu, work)));
        }
        (crate::tolerances::STALLED * scale).max(ROUNDINGS * noise)
    }

    /// The time as formulas see it.
    fn time(&self, t: f64) -> S {
        self.clock.map_or(S::from(t), |clock| clock.time(t))
    }

    /// F = sum of what the elements add at `at`.
    fn add_elements(&mut self, scope: Scope, system: &System, force: Force, at: &VectorsAvq<S>, p: &[S], t: f64) {
        self.f.fill(S::zero());
        let time = self.time(t);
        let pace = self.clock.map_or(S::one(), |clock| clock.pace());
        for batch in system.element_batches(force).iter().filter(|batch| scope.has(batch)) {
            let program = batch.formula.values();
            let (f, last_bits) = (&mut self.f, self.last_bits);
            run_lanes(
                program,
                batch.parts.len(),
                &mut self.work,
                |mut lanes| batch.places.write_elements(&mut lanes, (at, p, time), (force, pace)),
                |results| {
                    results.add_to_nodes(0, &batch.places.nodes, 1.0, f);
                    if last_bits {
                        results.add_last_bits(&batch.places.nodes, f);
                    }
                },
            );
        }
    }

    /// Adds the reactions of joints to F, and writes their scaled equations to G.
    fn add_constraints(
        &mut self,
        scope: Scope,
        system: &System,
        equations: &Equations,
        unknowns: &Unknowns<S>,
        p: &[S],
        t: f64,
    ) {
        for (which, point) in equations.constraint_terms() {
            let time = self.time(equations.time_at(point, t));
            self.add_constraints_at(scope, system, (equations, which, point), (unknowns, p, time));
        }
        self.kept.iter().for_each(|&(row, kept)| self.g[row] -= kept);
    }

    /// The same at one point: equations, reactions or both.
    fn add_constraints_at(
        &mut self,
        scope: Scope,
        system: &System,
        (equations, which, point): (&Equations, ConstraintPart, TermPoint),
        (unknowns, p, time): (&Unknowns<S>, &[S], S),
    ) {
        for batch in system.constraint_batches().iter().filter(|batch| scope.has(batch)) {
            let physics = system.constraint_of(batch);
            let ((asked, scale), factor) = (Asked::of(which, equations, physics), which.factor());
            let program = batch.programs.get(asked.short_code([false; 3]), || values(physics, asked));
            let Residual { f, g, at, constraint_at, reaction_at, has_one_point, work, last_bits, .. } = self;
            let constraint_at = of_constraints(*has_one_point, at, constraint_at);
            let at = if point == TermPoint::Reactions { reaction_at } else { constraint_at };
            run_lanes(
                program,
                batch.parts.len(),
                work,
                |mut lanes| batch.places.write_constraints(&mut lanes, (at, p, time), &unknowns.mu, scale),
                |results| {
                    let mut place = 0;
                    if asked.reactions {
                        if *last_bits {
                            results.add_last_bits(&batch.places.nodes, f);
                        }
                        place = results.add_to_nodes(place, &batch.places.nodes, factor, f);
                    }
                    if asked.equations.is_some() {
                        results.write(place, &batch.places.multipliers, &system.multiplier_columns, g);
                    }
                },
            );
        }
    }
}
