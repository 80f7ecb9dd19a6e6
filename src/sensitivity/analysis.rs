// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::adjoint::adjoint;
use super::signature::Signature;
use crate::assembly::{Model, StructuralSignature};
use crate::design::{DesignChain, DesignMap, ModelNumbers};
use crate::elements::RunScalar;
use crate::functionals::{Extremes, Functional, Sample, StepEnds, Totals, Values};
use crate::history::{Direction, History, Keep, Rerun, Snapshot, Watch, moments};
use crate::integrators::{
    Clocks, ConstraintLevel, Counters, Crossing, InitialState, Method, NewtonTolerance, Observer, Pause, Problem, Replay,
    RunError, StabilityCourse, StartPlan, StartRecord, StepControl, StepError, StepRecord, StepRule, Steps, SwitchWatch,
    TimeGrid, march_adaptive, march_along, march_dividing, march_given, unit_part,
};
use crate::program::Digest;
use crate::scalar::{Complex64, Tangents};
use crate::tolerances::SAME_DERIVATIVE;
use std::hash::Hasher;

/// Everything that defines a functional's dependence on a design: model, map from the design, functionals, method, grid.
#[derive(Clone, Copy)]
pub struct Analysis<'m> {
    /// Topology.
    pub model: &'m Model,
    /// From design variables to numbers.
    pub map: &'m dyn DesignMap,
    /// What is asked for.
    pub functionals: &'m [Functional],
    /// How it is integrated.
    pub method: &'m Method,
    /// The steps, which move with the breakpoints of each design; with a control the stretches between these, which each real run divides.
    pub grid: &'m TimeGrid,
    /// How real runs choose their steps; runs with derivative parts and the adjoint take the same ones.
    pub control: Option<StepControl>,
    /// Halve given steps that Newton's method cannot make; not with checkpoints, which are laid out for a number of steps.
    pub divide: bool,
    /// Decisions about the start, the same for every run.
    pub plan: &'m StartPlan,
    /// How runs keep their steps for gradients.
    pub keep: &'m Keep,
}

/// A real run with its functionals.
#[derive(Debug)]
pub struct Forward {
    /// The design.
    pub x: Vec<f64>,
    /// The numbers of the design.
    pub numbers: ModelNumbers<f64>,
    /// Its steps, as they were kept.
    pub history: Box<dyn History>,
    /// The steps taken, or the given ones where they were not chosen.
    pub grid: TimeGrid,
    /// Steps that were tried and given up for shorter ones.
    pub rejected: usize,
    /// Values of the functionals.
    pub values: Vec<f64>,
    /// The sums of which these are made.
    pub totals: Vec<Totals<f64>>,
    /// Smallest and largest value of what each aggregate is made of.
    pub extremes: Vec<Option<Extremes>>,
    /// Largest estimated error of a step, where steps of a motion are given.
    pub error: Option<StepError>,
    /// Start \[s\] and number of the first step that leaps over a dead point of a driven mechanism onto another branch.
    pub leap: Option<(f64, usize)>,
    /// With which share of their largest value functionals that read multipliers at the end, with constraints at position level, alternate from each
    /// of the last steps to the next.
    pub swings: Vec<f64>,
    /// Of equilibria: whether they stand; gradients at an unstable one are those of a state that no structure keeps.
    pub stability: Option<StabilityCourse>,
    /// Parts and functionals whose formulas pass from one piece to another on the way: behind a jump the gradient is wrong, behind a kink right to first order of
    /// the step.
    pub crossings: Vec<Crossing>,
    /// Work done.
    pub counters: Counters,
    pub(super) signature: Signature,
}

/// df/dx for each functional: `rows[functional][variable]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradient {
    /// One row for each functional.
    pub rows: Vec<Vec<f64>>,
    /// Work done.
    pub counters: Counters,
}

/// Numbers below this are what cancelling terms of order one leave.
const MAP_FLOOR: f64 = 1e-5;

/// A design with derivatives along as many of some variables at a time as a number has parts, and along how many.
pub(super) fn seeded_designs<S: RunScalar>(x: &[f64], variables: &[usize]) -> impl Iterator<Item = (Vec<S>, usize)> {
    variables.chunks(S::PARTS).map(|chosen| {
        let mut seeded: Vec<S> = x.iter().map(|&x| S::from(x)).collect();
        (0..).zip(chosen).for_each(|(lane, &variable)| seeded[variable].add_to_part(lane, unit_part::<S>()));
        (seeded, chosen.len())
    })
}

impl<'m> Analysis<'m> {
    pub(super) fn problem<S>(&self, numbers: &ModelNumbers<S>) -> Problem<'m, S>
    where
        S: Clone,
    {
        let start = InitialState { q: numbers.q.clone(), v: numbers.v.clone() };
        Problem { model: self.model, p: numbers.p.clone(), start }
    }

    /// Simulates a design and evaluates its functionals.
    ///
    /// # Errors
    /// Those of the map, of the run and of the history.
    pub fn forward(&self, x: &[f64]) -> Result<Forward, RunError> {
        self.finished(self.observed(x, &mut Watch(|_: &StepRecord<f64>| true))?)
    }

    /// A run that reached its end, with the values of functionals.
    fn finished(&self, (forward, stopped): (Forward, Option<RunError>)) -> Result<Forward, RunError> {
        stopped.map_or(Ok(()), Err)?;
        self.check_values(&forward)?;
        Ok(forward)
    }

    /// As [`Analysis::forward`], with an observer who sees each step and may stop the run; one that stops early gives its finished
    /// steps and the reason.
    ///
    /// # Errors
    /// Those of the map, and a history that cannot be begun.
    pub fn observed(&self, x: &[f64], observer: &mut dyn Observer) -> Result<(Forward, Option<RunError>), RunError> {
        let numbers = self.map.real(x).map_err(RunError::Input)?;
        self.plan.check(&self.problem(&numbers), &self.method.table)?;
        self.run(x, numbers, observer)
    }

    /// Whether steps may end at switches of elements.
    fn ends_at_switches(&self) -> bool {
        let has_switches = || self.model.elements.iter().any(|element| element.physics.sides() > 0);
        self.method.ends_at_switches(self.model) && (!self.model.events.is_empty() || has_switches())
    }

    /// Tells runs apart: a file goes on with the same laws, numbers, method and steps alone.
    fn fingerprint(&self, laws: &StructuralSignature, numbers: &ModelNumbers<f64>) -> u64 {
        let Analysis { method, grid, control, divide, plan, .. } = self;
        let version = env!("CARGO_PKG_VERSION");
        let words = format!("{version}{method:?}{control:?}{divide}{plan:?}{:?}", grid.breakpoints);
        let ModelNumbers { p, q, v } = numbers;
        let numbers = [p, q, v, &grid.times].map(|own| own.iter().map(|number| number.to_bits()).collect::<Vec<_>>());
        Digest::of(&(laws, words, numbers)).finish()
    }

    pub(super) fn run(
        &self,
        x: &[f64],
        numbers: ModelNumbers<f64>,
        observer: &mut dyn Observer,
    ) -> Result<(Forward, Option<RunError>), RunError> {
        let refused = self.functionals.iter().find_map(|functional| functional.refused(self.model));
        refused.map_or(Ok(()), |why| Err(RunError::Input(why)))?;
        let divides = self.divide && !matches!(self.keep, Keep::Checkpoints(_));
        let are_given = self.control.is_none() && !divides && !self.ends_at_switches();
        let steps = self.grid.moved_to(&self.breakpoints(&numbers)?.times()).map_err(RunError::Input)?;
        let signature = Signature::of(self);
        let run = self.fingerprint(&signature.structure, &numbers);
        let history = self.keep.history(are_given.then(|| steps.steps()), run)?;
        let mut values = Values::new(self.functionals, self.model, &self.method.table, &numbers.p);
        if self.method.constraint_level() == ConstraintLevel::Position && !self.method.table.is_static() {
            values.watch_swings();
        }
        let mut switches = SwitchWatch::new(self.model, self.method.ends_at_switches(self.model));
        self.functionals.iter().for_each(|functional| functional.watch(self.model, &mut switches));
        let mut recorder = Measuring { values, history, observer, switches, p: &numbers.p };
        let problem = self.problem(&numbers);
        let (grid, run) = match &self.control {
            Some(control) => march_adaptive(&problem, self.method, control, &steps, self.plan, &mut recorder),
            None if divides => march_dividing(&problem, self.method, &steps, self.plan, &mut recorder),
            None => march_given(&problem, self.method, (&steps, 0), self.plan, &mut recorder),
        };
        let Measuring { values, history, switches, .. } = recorder;
        let crossings = switches.finish();
        let swings = values.swings();
        let (values, totals, extremes) = values.finish();
        let (counters, rejected, error, leap, stability, stopped) = match run {
            Ok(run) => (run.counters, run.rejected, run.error, run.leap, run.stability, None),
            Err(error) => (Counters::default(), 0, None, None, None, Some(error)),
        };
        let x = x.to_vec();
        let forward = Forward {
            x,
            numbers,
            history,
            grid,
            rejected,
            values,
            totals,
            extremes,
            error,
            leap,
            swings,
            stability,
            crossings,
            counters,
            signature,
        };
        Ok((forward, stopped))
    }

    /// Values of the functionals alone: no step is kept.
    ///
    /// # Errors
    /// As for [`Analysis::forward`].
    pub fn values(&self, x: &[f64]) -> Result<Vec<f64>, RunError> {
        Ok(Analysis { keep: &Keep::Nothing, ..*self }.forward(x)?.values)
    }

    /// The same at a design beside one within the bounds, as difference quotients ask for it.
    ///
    /// # Errors
    /// As for [`Analysis::forward`], but for the bounds; a rule for Newton's method that leaves more than round-off.
    pub fn values_nearby(&self, x: &[f64]) -> Result<Vec<f64>, RunError> {
        self.check_exactness()?;
        let own = Analysis { keep: &Keep::Nothing, ..*self };
        let numbers = self.map.nearby(x).map_err(RunError::Input)?;
        Ok(own.finished(own.run(x, numbers, &mut Watch(|_: &StepRecord<f64>| true))?)?.values)
    }

    /// The same analysis on the steps of a run: what its gradients are the derivative of.
    pub fn on_steps_of<'f>(&self, forward: &'f Forward) -> Analysis<'f>
    where
        'm: 'f,
    {
        Analysis { grid: &forward.grid, control: None, divide: false, ..*self }
    }

    /// The states of a run at given times, which increase and lie within it, whatever its steps.
    ///
    /// # Errors
    /// [`RunError::Input`] for other times or a run that kept no steps; what the history says where it can't give a step.
    pub fn motion(&self, forward: &Forward, times: &[f64]) -> Result<Vec<Snapshot>, RunError> {
        self.check_signature(forward)?;
        let problem = self.problem(&forward.numbers);
        moments(&*forward.history, &Rerun::new(&problem, self.method, &forward.grid, self.plan), times)
    }

    /// Calls `see` with the start of a run and with the end of each of its steps: coordinates, rates, accelerations, multipliers.
    ///
    /// # Errors
    /// A run that kept no steps; what the history says where it can't give a step.
    pub fn for_each_sample(&self, forward: &Forward, mut see: impl FnMut(&Sample<f64>)) -> Result<(), RunError> {
        self.check_signature(forward)?;
        let problem = self.problem(&forward.numbers);
        let rerun = Rerun::new(&problem, self.method, &forward.grid, self.plan);
        let mut steps = forward.history.read(&rerun, Direction::Forward)?;
        let start = forward.history.start_record();
        let start = start.ok_or_else(|| RunError::Input("a run that was not begun has no motion".into()))?;
        let mut sample = Sample::initial(start);
        sample.share(self.model, &forward.numbers.p);
        see(&sample);
        let mut ends = StepEnds::new(&self.method.table);
        let mut see_end = |sample: Option<Sample<f64>>| {
            let Some(mut sample) = sample else { return };
            sample.share(self.model, &forward.numbers.p);
            see(&sample);
        };
        while let Some(step) = steps.next()? {
            see_end(ends.add(step));
        }
        see_end(ends.end());
        Ok(())
    }

    /// Whether all functionals of a run are numbers.
    ///
    /// # Errors
    /// [`RunError::Input`] with the name of one that is not.
    pub fn check_values(&self, forward: &Forward) -> Result<(), RunError> {
        self.check_signature(forward)?;
        let Some(k) = forward.values.iter().position(|value| !value.is_finite()) else { return Ok(()) };
        let (name, value) = (&self.functionals[k].name, forward.values[k]);
        let why = match self.model.events.is_empty() {
            true => "what it measures is no number at a state of the run: look at its formula and parameters",
            false => {
                "what it measures is no number at a state of the run: an event whose time it is did not happen so often, or look at its formula and \
                 parameters"
            }
        };
        Err(RunError::Input(format!("functional \"{name}\" is {value}: {why}")))
    }

    /// Gradients of all functionals by the discrete adjoint, for any number of variables at the price of one sweep.
    ///
    /// # Errors
    /// Those of the map, a singular pose on the way, and a functional without a derivative.
    pub fn adjoint(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        self.adjoint_of(x, forward, &vec![true; self.functionals.len()])
    }

    /// As [`Analysis::adjoint`], for those functionals alone that are `wanted`; the rows of the others are zero.
    ///
    /// # Errors
    /// As there.
    pub fn adjoint_of(&self, x: &[f64], forward: &Forward, wanted: &[bool]) -> Result<Gradient, RunError> {
        Ok(self.sweep(x, forward, wanted, &[])?.0)
    }

    /// As [`Analysis::adjoint`], with df/dp of each functional in the same sweep: `rows[functional][parameter]`, the derivative by a
    /// parameter of the model alone while all others and the initial state stay, for parameters that are `asked` for, whether a variable
    /// touches them or not.
    ///
    /// # Errors
    /// As for [`Analysis::adjoint`], and flags that are not as many as parameters.
    pub fn adjoint_by_parameters(
        &self,
        x: &[f64],
        forward: &Forward,
        asked: &[bool],
    ) -> Result<(Gradient, Vec<Vec<f64>>), RunError> {
        let (flags, parameters) = (asked.len(), self.model.parameters);
        if flags != parameters {
            return Err(RunError::Input(format!(
                "the model has {parameters} parameters, but {flags} flags say which of them are asked for"
            )));
        }
        let (gradient, mut rows) = self.sweep(x, forward, &vec![true; self.functionals.len()], asked)?;
        for row in &mut rows {
            row.iter_mut().zip(asked).filter(|(_, asked)| !**asked).for_each(|(own, _)| *own = 0.0);
        }
        Ok((gradient, rows))
    }

    /// Gradients of the `wanted` functionals, and df/dp for parameters that a variable touches or that are asked for `also`.
    fn sweep(
        &self,
        x: &[f64],
        forward: &Forward,
        wanted: &[bool],
        also: &[bool],
    ) -> Result<(Gradient, Vec<Vec<f64>>), RunError> {
        self.check_exactness()?;
        let (flags, functionals) = (wanted.len(), self.functionals.len());
        if flags != functionals {
            return Err(RunError::Input(format!(
                "the analysis has {functionals} functionals, but {flags} flags say which of them are wanted"
            )));
        }
        self.check_signature(forward)?;
        let problem = self.problem(&forward.numbers);
        self.check_directions(forward)?;
        let rerun = Rerun::new(&problem, self.method, &forward.grid, self.plan);
        let chain = self.checked_chain(x)?;
        // a power may be rounded otherwise where it is recorded
        if check_belonging(x, chain.real(), forward).is_err() {
            check_belonging(x, &self.map.real(x).map_err(RunError::Input)?, forward)?;
        }
        let mut active = chain.active_parameters();
        active.iter_mut().zip(also).for_each(|(active, also)| *active |= also);
        let kept = self.model.frictions.iter().flat_map(|own| own.kept.clone());
        kept.for_each(|place| active[place] = true);
        // directions of slip, and of what sticks, follow from the motion
        let two = self.model.frictions.iter().filter(|own| own.kept.len() == 2);
        let places = two.flat_map(|own| own.direction.iter().chain([&own.axis])).flat_map(Clone::clone);
        places.for_each(|place| active[place] = true);
        let places: Vec<usize> = (0..self.functionals.len()).filter(|&k| wanted[k]).collect();
        let functionals: Vec<&Functional> = places.iter().map(|&k| &self.functionals[k]).collect();
        let totals: Vec<Totals<f64>> = places.iter().map(|&k| forward.totals[k]).collect();
        let breakpoints = self.breakpoints(&forward.numbers)?;
        let moving = self.moving_breakpoints(&breakpoints, &forward.grid, &chain, &active)?;
        let (ends, numbers): (Vec<usize>, Vec<usize>) = moving.into_iter().unzip();
        let mut run = adjoint(&rerun, &*forward.history, &functionals, &totals, &active, &ends)?;
        for (rates, bar) in run.by_breakpoints.iter().zip(&mut run.gradients) {
            breakpoints.add_transposed(numbers.iter().copied().zip(rates.iter().copied()), &mut bar.p);
        }
        if run.passes_together {
            self.check_together(x, forward)?;
        }
        let mut rows = vec![vec![0.0; x.len()]; self.functionals.len()];
        let mut by_parameters = vec![Vec::new(); self.functionals.len()];
        for (&k, bar) in places.iter().zip(run.gradients) {
            rows[k] = chain.gradient(&bar);
            by_parameters[k] = bar.p;
        }
        let gradient = self.checked(Gradient { rows, counters: run.counters })?;
        Ok((gradient, by_parameters))
    }

    /// Whether no variable moves apart what passes at once: a tangent run along all of them tells.
    fn check_together(&self, x: &[f64], forward: &Forward) -> Result<(), RunError> {
        let along = |(i, &x): (usize, &f64)| {
            let mut own = Tangents::from(x);
            // weights that no two numbers of a design share
            own.add_to_part(0, (1.0 + (GOLDEN * (i + 1) as f64).fract()) * if x == 0.0 { 1.0 } else { x });
            own
        };
        let x: Vec<Tangents> = x.iter().enumerate().map(along).collect();
        self.perturbed_values(&x, forward).map(|_| ())
    }

    /// Gradients by tangent runs (direct differentiation), eight variables at a time.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn tangent(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        self.by_perturbed_runs::<Tangents>(x, forward)
    }

    /// Gradients by complex-step runs of the whole simulation, one for each variable.
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn complex_step(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        self.by_perturbed_runs::<Complex64>(x, forward)
    }

    fn by_perturbed_runs<S: RunScalar>(&self, x: &[f64], forward: &Forward) -> Result<Gradient, RunError> {
        self.check_forward(x, forward)?;
        let (mut rows, mut counters) = (vec![Vec::new(); self.functionals.len()], Counters::default());
        for (seeded, lanes) in seeded_designs::<S>(x, &(0..x.len()).collect::<Vec<_>>()) {
            let (values, own) = self.perturbed_values(&seeded, forward)?;
            counters += own;
            for (row, value) in rows.iter_mut().zip(values) {
                row.extend((0..lanes).map(|lane| value.part(lane) / unit_part::<S>()));
            }
        }
        self.checked(Gradient { rows, counters })
    }

    /// Derivatives along one direction by central differences of separate real runs, extrapolated once (error of order h^4).
    ///
    /// # Errors
    /// Those of the map and of the runs.
    pub fn central_difference(&self, x: &[f64], direction: &[f64], step: f64) -> Result<Vec<f64>, RunError> {
        let (coarse, fine) = (self.central(x, direction, step)?, self.central(x, direction, step / 2.0)?);
        Ok(coarse.iter().zip(fine).map(|(c, f)| (4.0 * f - c) / 3.0).collect())
    }

    /// Whether a run with derivative parts may go along a run at a design.
    pub(super) fn check_forward(&self, x: &[f64], forward: &Forward) -> Result<(), RunError> {
        self.check_signature(forward)?;
        check_belonging(x, &self.map.real(x).map_err(RunError::Input)?, forward)?;
        self.checked_chain(x).map(|_| ())
    }

    /// The recorded map at a design, whose derivatives are those of its numbers.
    pub(crate) fn checked_chain(&self, x: &[f64]) -> Result<DesignChain, RunError> {
        let chain = DesignChain::record(self.map, x).map_err(RunError::Input)?;
        chain.check(self.map).map_err(RunError::Input)?;
        Ok(chain)
    }

    fn checked(&self, gradient: Gradient) -> Result<Gradient, RunError> {
        for (functional, row) in self.functionals.iter().zip(&gradient.rows) {
            let Some(variable) = row.iter().position(|entry| !entry.is_finite()) else { continue };
            return Err(RunError::Input(format!(
                "the derivative of functional \"{}\" by variable {} is {}: what it measures has none at a state of the run, as a \
                 distance or a norm has none where it vanishes; measure its square or a component, or leave the functional out",
                functional.name,
                self.map.variable_name(variable),
                row[variable]
            )));
        }
        Ok(gradient)
    }

    /// (p, q0, v0) of a design with derivative parts: computed with these, and then given the parts that the recorded map has, from which
    /// they differ by round-off. A stiff member turns a rounding of its length against that of its ends into a force.
    pub(crate) fn numbers_with_parts<S: RunScalar>(&self, x: &[S]) -> Result<ModelNumbers<S>, RunError> {
        let real: Vec<f64> = x.iter().map(|x| x.value()).collect();
        let chain = DesignChain::record(self.map, &real).map_err(RunError::Input)?;
        let mut numbers = chain.numbers(x);
        for part in 0..S::PARTS {
            let direction: Vec<f64> = x.iter().map(|x| x.part(part)).collect();
            let size = direction.iter().fold(0.0, |size: f64, d| size.max(d.abs()));
            if size == 0.0 {
                continue;
            }
            let unit: Vec<f64> = direction.iter().map(|d| d / size).collect();
            let ModelNumbers { p, q, v } = chain.tangent(&unit);
            let lists =
                [("parameter", &mut numbers.p, p), ("coordinate", &mut numbers.q, q), ("velocity", &mut numbers.v, v)];
            for (what, own, recorded) in lists {
                // a derivative that cancels keeps the round-off of its terms, which are of the size of the other derivatives
                let terms = recorded.iter().fold(0.0, |largest: f64, rate| largest.max(rate.abs()));
                for (place, (own, recorded)) in own.iter_mut().zip(recorded).enumerate() {
                    let difference = recorded - own.part(part) / size;
                    if !(difference.abs() <= SAME_DERIVATIVE * (terms + own.value().abs() + MAP_FLOOR)) {
                        return Err(RunError::Input(format!(
                            "derivative of {what} {place} by the design: {recorded} recorded, {} with derivative parts",
                            own.part(part) / size
                        )));
                    }
                    own.add_to_part(part, recorded * size - own.part(part));
                }
            }
        }
        Ok(numbers)
    }

    /// Whether a run follows from the laws, the method and the functionals of this analysis.
    pub(super) fn check_signature(&self, forward: &Forward) -> Result<(), RunError> {
        let why = Signature::of(self).difference(&forward.signature, self);
        why.map_or(Ok(()), |why| {
            Err(RunError::Input(format!("the forward run belongs to another analysis: {why}; run forward with this one")))
        })
    }

    /// Whether runs solve their equations to the digits that derivatives need.
    fn check_exactness(&self) -> Result<(), RunError> {
        if self.method.tolerance != NewtonTolerance::Scaled {
            return Ok(());
        }
        Err(RunError::Input(format!(
            "a run whose Newton's method stops by the rule \"{}\" solves its equations to the error of its steps, so no derivative of it \
             is exact; take \"{}\"",
            NewtonTolerance::Scaled.name(),
            NewtonTolerance::RoundOff.name()
        )))
    }

    fn perturbed_values<S: RunScalar>(&self, x: &[S], forward: &Forward) -> Result<(Vec<S>, Counters), RunError> {
        let numbers = self.numbers_with_parts(x)?;
        let clocks = self.clocks(&numbers.p, forward)?;
        let mut values = Values::along(self.functionals, self.model, &self.method.table, &numbers.p, &forward.totals);
        let counters = self.perturbed_run(&numbers, &clocks, forward, &mut values)?;
        Ok((values.finish().0, counters))
    }

    /// A run with derivative parts along the states of the real run: round-off of a second solution would be magnified into
    /// derivatives at position level, and nothing converged is solved for again.
    pub(super) fn perturbed_run<S: RunScalar>(
        &self,
        numbers: &ModelNumbers<S>,
        clocks: &Clocks<S>,
        forward: &Forward,
        recorder: &mut dyn Observer<S>,
    ) -> Result<Counters, RunError> {
        self.check_exactness()?;
        self.check_directions(forward)?;
        let real = self.problem(&forward.numbers);
        let rerun = Rerun::new(&real, self.method, &forward.grid, self.plan);
        let mut steps = forward.history.read(&rerun, Direction::Forward)?;
        let guide = forward.history.start_record().map(|start| (start, &mut *steps as &mut dyn Steps));
        let steps = (&forward.grid, clocks);
        Ok(march_along(&self.problem(numbers), self.method, steps, self.plan, guide, recorder)?.counters)
    }
}

/// The golden ratio, whose multiples lie apart from each other.
const GOLDEN: f64 = 1.618_033_988_749_895;

fn check_belonging(x: &[f64], numbers: &ModelNumbers<f64>, forward: &Forward) -> Result<(), RunError> {
    let differing = x.iter().zip(&forward.x).position(|(own, of_run)| own.to_bits() != of_run.to_bits());
    let why = match differing {
        Some(i) => format!("variable {i} is {} in the run and {} here", forward.x[i], x[i]),
        None if *numbers != forward.numbers => "its model has other numbers".into(),
        None => return Ok(()),
    };
    Err(RunError::Input(format!(
        "the forward run belongs to another design: {why}; run forward at the design that is differentiated"
    )))
}

/// Evaluates functionals, keeps steps, and lets an observer see them.
struct Measuring<'f, 'o> {
    values: Values<'f, f64>,
    history: Box<dyn History>,
    observer: &'o mut dyn Observer,
    switches: SwitchWatch,
    p: &'f [f64],
}

impl Observer for Measuring<'_, '_> {
    fn start(&mut self, start: &StartRecord<f64>) -> Result<(), RunError> {
        self.values.start(start);
        self.switches.start(start, self.p);
        self.observer.start(start)?;
        self.history.start(start)
    }
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.values.step(step);
        self.switches.step(step, self.p);
        let wanted = self.observer.step(step)?;
        Ok(self.history.step(step)? && wanted)
    }
    fn checkpoint(&mut self, index: usize, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        self.history.checkpoint(index, pause)
    }
    fn end(&mut self, pause: &dyn Fn() -> Pause<f64>) -> Result<(), RunError> {
        self.history.end(pause)
    }
    fn take_up(&mut self, rule: StepRule, steps: Replay<f64>) -> Result<Option<Pause<f64>>, RunError> {
        let Measuring { values, history, observer, switches, p } = self;
        history.take_up(rule, &mut |step| {
            values.step(step);
            switches.step(step, p);
            Ok(observer.step(step)? && steps(step)?)
        })
    }
}

impl<S: RunScalar> Observer<S> for Values<'_, S> {
    fn start(&mut self, start: &StartRecord<S>) -> Result<(), RunError> {
        Values::start(self, start);
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError> {
        Values::step(self, step);
        Ok(true)
    }
}
