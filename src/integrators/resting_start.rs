//! A motion that begins at rest: the equilibrium under the loads of its start, near the coordinates that are given.
//!
//! Steps of an implicit Euler method that forgets its velocities, x = argmin V(q + h^2 x) + |h^2 x|^2_M / (2 h^2), follow the energy downhill to an
//! equilibrium that stands, with reactions and loads that have no energy as they come: R(x, 0, q + h^2 x, p, t) + A^T mu = 0,
//! g(q + h^2 x, p, t) = 0, and states of first order by their rates, x = f(z + h^2 x). One that ends where that sum is not least is too long. They grow until they end where R(0, 0, q + x, p, t) + A^T mu = 0
//! does, which is solved last and alone counts: its solution does not depend on the way there.

use super::initial_guess::{InitialGuess, solve};
use super::newton::{Newton, NewtonTolerance};
use super::record::SolveRecord;
use super::{Counters, InitialState, Method, Problem, RestingPlan, RunError, Stability, StartPlan, Stop, Verdict};
use crate::assembly::{Attached, Equations, Level, Model, Residual, StageCoefficients, Unknowns, VectorsAvq};
use crate::elements::{ElementPhysics, RunScalar, State};
use crate::scalar::{COMPLEX_STEP, Complex64};

/// Size of the first step \[s\]; it is divided and multiplied until steps are of a good length.
const FIRST: f64 = 0.05;
const GROWTH: f64 = 4.0;
/// Displacement of the longest step that is taken, by the model's length; the next one is as long beyond a [`SHORT`] one.
const LONGEST: f64 = 0.3;
/// Displacement behind which the next step is longer, and at which an equilibrium still is the one that steps lead to.
const SHORT: f64 = 0.1;
/// Displacement behind which the equilibrium itself is looked for.
const NEAR: f64 = 0.02;
/// Displacement of steps that do not leave an equilibrium which does not stand.
const NONE: f64 = 1e-10;
/// Steps above this size \[s\] have come to rest, but for what only inertia holds.
const LARGEST: f64 = 1e4;
/// Steps below this size \[s\] find nothing any more.
const SMALLEST: f64 = 1e-9;
const MOST: usize = 200;
const PLACE: &str = "equilibrium at the start (t = 0 s)";

pub(super) struct RestingStart<S> {
    /// Its system, whose base are the given coordinates.
    pub record: SolveRecord<S>,
    /// Whether it stands; not known of derivative parts, which follow a real run.
    pub stability: Option<Stability>,
    pub counters: Counters,
}

impl<S: RunScalar> RestingStart<S> {
    /// Finds the equilibrium near the start, or follows that of a real run.
    pub fn find(
        problem: &Problem<S>,
        method: &Method,
        RestingPlan { dropped, stays }: &RestingPlan,
        t: f64,
        guide: Option<&SolveRecord<f64>>,
    ) -> Result<Self, RunError> {
        let resting = problem.model.at_rest(stays);
        let (model, p) = (&resting.model, resting.parameters(&problem.p));
        let system = method.system(model, dropped);
        let newton = Newton::new(system, NewtonTolerance::RoundOff, method.backend).map(Newton::divided);
        let mut newton = newton.map_err(|singular| RunError::of_pattern(PLACE, singular))?;
        newton.counters = Counters::measuring(method.measures_phases);
        let InitialState { q, v } = &problem.start;
        let base = VectorsAvq { a: vec![S::zero(); model.dofs], v: resting.velocities(v), q: resting.coordinates(q, v) };
        let mut record = SolveRecord { t, equations: Equations::EQUILIBRIUM, base, unknowns: Unknowns::default() };
        if guide.is_some() {
            solve(&mut newton, &mut record, InitialGuess::guided(guide), &p, &|| PLACE.into())?;
            return Ok(RestingStart { record, stability: None, counters: newton.counters });
        }
        let mut search = Search { newton, p: &p, record, h: FIRST, at: Vec::new(), ended: None };
        search.run().or_else(|why| search.turns_on(why))?;
        let real = |values: &[S]| values.iter().map(|value| value.value()).collect::<Vec<f64>>();
        check_staying(problem.model, stays, &real(&problem.p), &real(&search.record.point().q))?;
        let stability = Stability { turns: model.spin.is_some(), ..search.newton.stability() };
        Ok(RestingStart { record: search.record, stability: Some(stability), counters: search.newton.counters })
    }
}

/// Coordinates and states at which a motion begins: those of the equilibrium near the given ones, if the plan says so; with the velocities that are
/// given, but for those of a turn.
pub fn resting_start(problem: &Problem<f64>, method: &Method, plan: &StartPlan) -> Result<InitialState<f64>, RunError> {
    let mut start = problem.start.clone();
    if let Some(plan) = &plan.equilibrium {
        let found = RestingStart::find(problem, method, plan, 0.0, None)?.record.point().q;
        problem.model.at_rest(&plan.stays).set_motion(&found, &mut start.q, &mut start.v);
    }
    Ok(start)
}

/// The elements that see states, with the places of their coordinates.
fn of_states(model: &Model) -> impl Iterator<Item = (&Attached<ElementPhysics>, Vec<usize>)> {
    let nodes =
        |element: &Attached<ElementPhysics>| element.nodes.iter().map(|node| &model.nodes[node.0]).collect::<Vec<_>>();
    let seeing = model.elements.iter().map(move |element| (element, nodes(element)));
    let seeing = seeing.filter(|(_, nodes)| nodes.iter().any(|node| node.kind.is_of_states()));
    seeing.map(|(element, nodes)| (element, nodes.iter().flat_map(|node| node.dofs.clone()).collect()))
}

fn still_residual<S: RunScalar>(element: &Attached<ElementPhysics>, p: &[S], q: &[S]) -> Vec<S> {
    let still = vec![S::zero(); q.len()];
    element.physics.residual_at(State { a: &still, v: &still, q }, &p[element.parameters.clone()], S::zero())
}

/// Places of states that stay where a motion begins at an equilibrium: those that nothing reads, and those whose rates depend at rest on no place and on
/// no other state, at the given start.
pub(crate) fn staying_states(problem: &Problem<f64>) -> Vec<usize> {
    let (model, InitialState { q, v }) = (problem.model, &problem.start);
    let mut stays = model.unread_states();
    let states: Vec<usize> = model.state_dofs().collect();
    if states.len() == stays.len() {
        return stays;
    }
    let resting = model.at_rest(&[]);
    let lift = |list: Vec<f64>| list.into_iter().map(Complex64::from).collect::<Vec<_>>();
    let (p, q) = (lift(resting.parameters(&problem.p)), lift(resting.coordinates(q, v)));
    // what each rate depends on
    let mut read = vec![Vec::new(); model.dofs];
    for (element, dofs) in of_states(&resting.model) {
        for place in 0..dofs.len() {
            let mut own: Vec<Complex64> = dofs.iter().map(|&dof| q[dof]).collect();
            own[place].im = COMPLEX_STEP;
            let rows = dofs.iter().zip(still_residual(element, &p, &own));
            rows.filter(|(_, row)| row.im != 0.0).for_each(|(&row, _)| read[row].push(dofs[place]));
        }
    }
    loop {
        let depends = |state: usize| read[state].iter().any(|dof| !stays.contains(dof));
        let more: Vec<usize> = states.iter().copied().filter(|dof| !stays.contains(dof) && !depends(*dof)).collect();
        if more.is_empty() {
            return stays;
        }
        stays.extend(more);
    }
}

/// States that stay and are read must have come to rest where they are.
fn check_staying(model: &Model, stays: &[usize], p: &[f64], q: &[f64]) -> Result<(), RunError> {
    let (unread, resting) = (model.unread_states(), model.at_rest(&[]));
    let (mut rates, p) = (vec![0.0; model.dofs], resting.parameters(p));
    for (element, dofs) in of_states(&resting.model) {
        let own: Vec<f64> = dofs.iter().map(|&dof| q[dof]).collect();
        dofs.iter().zip(still_residual(element, &p, &own)).for_each(|(&dof, row)| rates[dof] -= row);
    }
    match stays.iter().find(|&dof| rates[*dof] != 0.0 && !unread.contains(dof)) {
        Some(&dof) => Err(RunError::Input(format!(
            "{PLACE}: {} never rests: its rate there is {:.6e}, whatever the places and the other states are; hold it at its start ([[hold]] of a scene file, \
             `MechanismBuilder::hold` in a program), or start the motion from given coordinates",
            model.dof_name(dof),
            rates[dof]
        ))),
        None => Ok(()),
    }
}

struct Search<'m, 'p, S> {
    newton: Newton<'m, S>,
    p: &'p [S],
    /// The equilibrium's own system, from where it is looked for.
    record: SolveRecord<S>,
    h: f64,
    /// Coordinates that it has come to.
    at: Vec<S>,
    /// What the last look for the equilibrium itself ended with.
    ended: Option<Ended>,
}

/// Where a step leads, with its displacement by the model's length.
enum Step {
    To(f64),
    TooLong,
    /// To a state that energy and way do not make the least one.
    NotLeast(f64),
}

/// Why a state was not taken for the equilibrium.
enum Ended {
    Failed(RunError),
    /// It lies elsewhere, or does not stand.
    Refused,
}

impl<S: RunScalar> Search<'_, '_, S> {
    fn run(&mut self) -> Result<(), RunError> {
        self.at.clone_from(&self.record.base.q);
        let mut step = SolveRecord::default();
        step.base.clone_from(&self.record.base);
        Residual::shape(&self.newton.system, &mut step.unknowns, true);
        for _ in 0..MOST {
            let before = step.unknowns.clone();
            match self.step(&mut step) {
                Ok(Step::To(displacement)) => {
                    if displacement <= NEAR && self.looks_at_rest(&step.unknowns) {
                        return Ok(());
                    }
                    if displacement <= SHORT {
                        self.h *= GROWTH;
                    }
                    if self.h > LARGEST {
                        return self.end();
                    }
                }
                // nothing leads away from an equilibrium that does not stand
                Ok(Step::NotLeast(displacement)) if displacement <= NONE => {
                    if self.ended.is_none() {
                        self.looks_at_rest(&step.unknowns);
                    }
                    return self.end();
                }
                failed => {
                    step.unknowns = before;
                    self.h /= GROWTH;
                    if self.h < SMALLEST {
                        return Err(failed.err().unwrap_or_else(|| self.moves_on(&step.unknowns)));
                    }
                }
            }
        }
        Err(self.moves_on(&step.unknowns))
    }

    /// A turn may go on where energies are not least: its equilibrium nearest to the given coordinates, or why none was found before.
    fn turns_on(&mut self, why: RunError) -> Result<(), RunError> {
        let Search { newton, p, record, .. } = self;
        if newton.system.model.spin.is_none() {
            return Err(why);
        }
        record.unknowns = Residual::unknowns(&newton.system);
        solve(newton, record, InitialGuess::Given, p, &|| PLACE.into()).map_err(|_| why)
    }

    /// Makes a step from rest, and goes where it leads if it is not too long.
    fn step(&mut self, step: &mut SolveRecord<S>) -> Result<Step, RunError> {
        let Search { newton, p, record, h, at, .. } = self;
        step.t = record.t;
        step.equations = Equations::stage(StageCoefficients::new(1.0, 0.0, *h * *h), Level::Position);
        step.base.q.clone_from(at);
        step.unknowns.x.fill(S::zero());
        solve(newton, step, InitialGuess::Given, p, &|| PLACE.into())?;
        let moved = step.point().q;
        let displacement = self.displacement(&moved);
        if self.newton.stability().verdict() == Verdict::Unstable {
            return Ok(Step::NotLeast(displacement));
        }
        if displacement > LONGEST {
            return Ok(Step::TooLong);
        }
        self.at = moved;
        Ok(Step::To(displacement))
    }

    /// Looks for the equilibrium itself from where the steps have come to; one that lies elsewhere or does not stand is not taken while steps go on.
    fn looks_at_rest(&mut self, reactions: &Unknowns<S>) -> bool {
        let Search { newton, p, record, at, .. } = self;
        record.unknowns.clone_from(reactions);
        let moved = at.iter().zip(&record.base.q);
        record.unknowns.x.iter_mut().zip(moved).for_each(|(x, (&at, &base))| *x = at - base);
        if let Err(why) = solve(newton, record, InitialGuess::Given, p, &|| PLACE.into()) {
            self.ended = Some(Ended::Failed(why));
            return false;
        }
        let away = self.displacement(&self.record.point().q);
        let is_taken = away <= SHORT && self.newton.stability().verdict() != Verdict::Unstable;
        self.ended = (!is_taken).then_some(Ended::Refused);
        is_taken
    }

    /// Largest displacement from where the search has come to, by the model's length; states have no length.
    fn displacement(&self, moved: &[S]) -> f64 {
        let (Search { newton, at, .. }, mut moved) = (self, moved.to_vec());
        newton.system.model.state_dofs().for_each(|dof| moved[dof] = at[dof]);
        newton.distance(&moved, at) / newton.length
    }

    /// Steps have come to rest at a state that was not taken.
    fn end(&mut self) -> Result<(), RunError> {
        match self.ended.take() {
            Some(Ended::Failed(RunError::Stopped { reason: Stop::Singular, place, cause, .. })) => Err(RunError::stopped(
                Stop::Singular,
                place,
                cause,
                "nothing but inertia holds it, so its equilibrium is not determined: hold it there ([[hold]] of a scene file, \
                 `MechanismBuilder::hold` in a program), or give it a spring",
            )),
            Some(Ended::Failed(why)) => Err(why),
            // a structure without imperfection on its straight path: that it does not stand is told with the results
            _ => Ok(()),
        }
    }

    /// What moves fastest, and does not come to rest.
    fn moves_on(&self, last: &Unknowns<S>) -> RunError {
        let sizes = last.x.iter().zip(&self.newton.coordinate_scales).map(|(x, scale)| x.value().abs() * scale);
        let fastest = sizes.enumerate().max_by(|one, other| one.1.total_cmp(&other.1)).map_or(0, |(dof, _)| dof);
        let name = self.newton.system.model.dof_name(fastest);
        RunError::Input(format!(
            "{PLACE}: {name} goes on moving and comes to no rest: hold it there ([[hold]] of a scene file, `MechanismBuilder::hold` in a program), \
             give it a spring or a stop, or start the motion from given coordinates"
        ))
    }
}
