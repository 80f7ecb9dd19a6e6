use super::aggregate::{SUMS, Totals};
use super::load::JointLoad;
use super::measured_group::GroupWork;
use super::reactions::{AdjointSeeds, add_least_multipliers_transposed, least_multipliers};
use super::{ElementSum, MeasuredGroup, MeasuredQuantity, Over, PointWeights, SampleSeeds, Times};
use crate::assembly::{Clock, ConstraintId, Model, NodeId, VectorsAvq};
use crate::elements::RunScalar;
use crate::integrators::{Place, SetNumber, StartRecord, StepRecord, SwitchWatch};
use crate::program::{Formula, ProgramWork, SwitchKind};
use smallvec::SmallVec;
use std::ops::Range;
use std::sync::Arc;

/// What is measured at one time.
pub enum Measured {
    /// A quantity of some nodes and constraints.
    Local {
        /// Nodes, in the order in which it sees their coordinates.
        nodes: Vec<NodeId>,
        /// Constraints whose multipliers it sees.
        constraints: Vec<ConstraintId>,
        /// Place of its parameters in p.
        parameters: Range<usize>,
        /// The formula.
        quantity: MeasuredQuantity,
    },
    /// A quantity of the elements of a group, at one or several points of each.
    Group(MeasuredGroup),
    /// A force or moment with which a joint acts on one of its nodes.
    Load {
        /// The joint.
        joint: ConstraintId,
        /// Place of the load's parameters in p.
        parameters: Range<usize>,
        /// Which one.
        load: JointLoad,
    },
    /// Kinetic and potential energy of all elements as one number \[J\], see [`Measured::energy`].
    Energy(MeasuredGroup),
}

/// A functional f: what is measured at each time, and what is made of it over time and points.
pub struct Functional {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// What is measured.
    pub measured: Measured,
    /// What is made of it.
    pub over: Over,
}

/// States at which a functional reads: a stage, the start, or the end.
#[derive(Clone, Debug)]
pub struct Sample<S> {
    /// Time \[s\].
    pub t: S,
    /// Accelerations, velocities, coordinates.
    pub at: VectorsAvq<S>,
    /// Multipliers: of least norm where constraints are redundant.
    pub mu: Vec<S>,
    /// Multipliers as solved, where constraints are redundant; empty otherwise.
    pub solved_mu: Vec<S>,
    /// Redundant constraint equations that were left out.
    pub dropped: Vec<usize>,
}

impl<S: RunScalar> Sample<S> {
    /// At the start: projected state, first acceleration.
    pub fn initial(start: &StartRecord<S>) -> Self {
        let (dropped, start) = (start.dropped.clone(), &start.acceleration);
        let mu = start.unknowns.mu.clone();
        Sample { t: S::from(start.t), at: start.point(), mu, solved_mu: Vec::new(), dropped }
    }

    /// Room for a sample.
    pub fn empty() -> Self {
        Sample { t: S::zero(), at: VectorsAvq::default(), mu: Vec::new(), solved_mu: Vec::new(), dropped: Vec::new() }
    }

    /// Moves to the end of a step: its state, with acceleration and multipliers of the last stage (none without stages).
    pub fn set_terminal(&mut self, step: &StepRecord<S>) {
        self.t = S::from(step.t + step.h);
        self.at.v.clone_from(&step.v);
        self.at.q.clone_from(&step.q);
        self.solved_mu.clear();
        self.dropped.clone_from(&step.dropped);
        if let Some(last) = step.stages.last() {
            last.solve.write_acceleration(&mut self.at.a);
            self.mu.clone_from(&last.solve.unknowns.mu);
        }
    }

    /// Moves to the end of a step whose ends may have derivative parts: its time and its rates have them, too.
    pub(super) fn set_end(&mut self, step: &StepRecord<S>) {
        self.set_terminal(step);
        self.follow(step.clock);
        step.lengthened.iter().for_each(|&part| self.t += part);
    }

    /// Goes over to what events set at the end of a step.
    #[doc(hidden)]
    pub fn follow_events(&mut self, step: &StepRecord<S>, p: &[S]) {
        let last = step.set.iter().map(|own| own.event).chain(step.impacts.iter().map(|own| own.event)).max();
        for number in 0..=last.unwrap_or(0) {
            for SetNumber { target, value, .. } in step.set.iter().filter(|own| own.event == number) {
                *target.of([&mut self.at.v, &mut self.at.q]) = *value;
            }
            for own in step.impacts.iter().filter(|own| own.event == number) {
                own.add_to(&mut self.at.v, p, S::one());
            }
        }
    }

    /// Moves to a stage.
    pub fn set_stage(&mut self, step: &StepRecord<S>, stage: usize) {
        let solve = &step.stages[stage].solve;
        self.t = S::from(solve.t);
        self.at.a.resize(solve.base.a.len(), S::zero());
        self.at.v.resize(solve.base.v.len(), S::zero());
        self.at.q.resize(solve.base.q.len(), S::zero());
        self.at.set_shifted(&solve.base, solve.equations.residual, &solve.unknowns);
        self.mu.clone_from(&solve.unknowns.mu);
        self.solved_mu.clear();
        self.dropped.clone_from(&step.dropped);
    }

    /// Goes over from laid time to the time of a clock, where there is one.
    pub(crate) fn follow(&mut self, clock: Option<Clock<S>>) {
        let Some(clock) = clock else { return };
        self.t = clock.time(self.t.value());
        clock.set_pace(&mut self.at);
    }

    /// Shares the forces of redundant constraints among all of them, if equations were dropped.
    #[doc(hidden)]
    pub fn share(&mut self, model: &Model, p: &[S]) {
        if self.dropped.iter().any(|row| !model.comes_and_goes(*row)) && !self.mu.is_empty() {
            let shared = least_multipliers(model, &self.dropped, p, &self.at.q, &self.mu, self.t);
            self.solved_mu = std::mem::replace(&mut self.mu, shared);
        }
    }
}

impl Sample<f64> {
    /// The same in other numbers, with multipliers as solved.
    pub(super) fn lifted<S: RunScalar>(&self) -> Sample<S> {
        let lift = |values: &[f64]| values.iter().map(|&value| S::from(value)).collect::<Vec<_>>();
        let VectorsAvq { a, v, q } = &self.at;
        let mu = if self.solved_mu.is_empty() { &self.mu } else { &self.solved_mu };
        let at = VectorsAvq { a: lift(a), v: lift(v), q: lift(q) };
        Sample { t: S::from(self.t), at, mu: lift(mu), solved_mu: Vec::new(), dropped: self.dropped.clone() }
    }

    /// Goes back through [`Sample::share`]: from the adjoints of shared multipliers to those of solved ones, of coordinates and of
    /// parameters.
    pub(crate) fn share_transposed(
        &self,
        model: &Model,
        p: &[f64],
        mu_bar: &mut [f64],
        q_bar: &mut [f64],
        p_bar: &mut [f64],
    ) {
        if !self.solved_mu.is_empty() && mu_bar.iter().any(|&bar| bar != 0.0) {
            let shared = mu_bar.to_vec();
            mu_bar.fill(0.0);
            let seeds = AdjointSeeds { q: q_bar, mu: mu_bar, p: p_bar };
            add_least_multipliers_transposed(model, &self.dropped, (p, &self.at.q, &self.solved_mu), self.t, &shared, seeds);
        }
    }
}

impl Functional {
    /// Unit of its value: an integral has the second of the integration in it, squared aggregates the square of what is measured.
    pub fn value_unit(&self) -> String {
        let squared = self.over.aggregate().is_some_and(|aggregate| aggregate.kind.is_squared());
        match (self.over, self.unit) {
            (Over::Integral, "-") => "s".into(),
            (Over::Integral, "W") => "J".into(),
            (Over::Integral, unit) => format!("{unit} s"),
            (_, "-") => "-".into(),
            (_, unit) if squared => format!("({unit})^2"),
            (_, unit) => unit.into(),
        }
    }

    /// Has its formulas watched in a run, if it reads all of it: where what it measures jumps, derivatives of what it makes of that over time
    /// are wrong; kinks take one order of the step from those of an integral.
    pub(crate) fn watch(&self, model: &Model, watch: &mut SwitchWatch) {
        let told = if self.over == Over::Integral { SwitchKind::Kink } else { SwitchKind::Jump };
        self.each_formula(model, |formula, lengths, places| watch.add((&self.name, Some(told)), formula, lengths, places));
    }

    /// Calls `see` with each formula that it reads during all of a run, whether lengths of vectors in it tell anything, and the places of its
    /// arguments.
    pub(crate) fn each_formula(&self, model: &Model, mut see: impl FnMut(&Arc<Formula>, bool, &dyn Fn() -> Vec<Place>)) {
        if self.over.times() != Times::Run {
            return;
        }
        match &self.measured {
            Measured::Energy(_) => {}
            Measured::Group(group) => group.each_formula(model, |formula, places| see(formula, false, places)),
            local => {
                if let Some(Reading { formula, places }) = local.reading(model) {
                    see(formula, true, &|| places.to_vec());
                }
            }
        }
    }

    /// The formula of what it measures of nodes and joints, and where its arguments stand.
    #[doc(hidden)]
    pub fn formula(&self, model: &Model) -> Option<(Arc<Formula>, Vec<Place>)> {
        match &self.measured {
            Measured::Energy(_) | Measured::Group(_) => None,
            local => local.reading(model).map(|own| (Arc::clone(own.formula), own.places.to_vec())),
        }
    }

    /// Whether it reads multipliers.
    #[doc(hidden)]
    pub fn reads_multipliers(&self) -> bool {
        match &self.measured {
            Measured::Local { constraints, .. } => !constraints.is_empty(),
            Measured::Load { .. } => true,
            Measured::Group(_) | Measured::Energy(_) => false,
        }
    }

    /// Whether it changes with multipliers that may be added to those of a sample: what it measures beside round-off.
    pub(crate) fn changes_with(&self, model: &Model, sample: &Sample<f64>, p: &[f64], added: &[f64]) -> bool {
        if !self.reads_multipliers() {
            return false;
        }
        let size = sample.mu.iter().fold(1.0, |size: f64, mu| size.max(mu.abs()));
        let mut moved = sample.clone();
        let mut value = |add: &dyn Fn(usize) -> f64| {
            moved.mu.iter_mut().zip(&sample.mu).enumerate().for_each(|(row, (own, mu))| *own = mu + size * add(row));
            self.measured.value(model, &moved, p)
        };
        let before = value(&|_| 0.0);
        let rows = (0..added.len()).filter(|&row| added[row] != 0.0);
        let apart: f64 = rows.map(|one| (value(&|row| if row == one { added[row] } else { 0.0 }) - before).abs()).sum();
        (value(&|row| added[row]) - before).abs() > SURELY * apart
    }

    /// What it measures at one time: of points that it aggregates, the aggregate at that time.
    pub fn measured_at<S: RunScalar>(&self, model: &Model, sample: &Sample<S>, p: &[S]) -> S {
        let (Measured::Group(group), Over::Aggregate { aggregate, .. }) = (&self.measured, self.over) else {
            return self.measured.value(model, sample, p);
        };
        let mut work = GroupWork::default();
        group.write_values(model, sample, p, self.over.points(), &mut work);
        let offset = aggregate.following(aggregate.first_offset(), &work.values);
        let mut sums = [S::zero(); SUMS];
        self.over.add_terms(&work.values, offset, S::one(), &mut sums);
        self.over.value(Totals { offset, sums })
    }
}

/// Share of the changes by single multipliers above which that by all of them together is no round-off.
const SURELY: f64 = 1e-7;

/// A formula with the places of its arguments.
struct Reading<'m> {
    formula: &'m Arc<Formula>,
    places: SmallVec<[Place; 64]>,
}

fn dofs<'m>(model: &'m Model, nodes: &'m [NodeId]) -> impl Iterator<Item = usize> + 'm {
    nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone())
}

impl Reading<'_> {
    fn value<S: RunScalar>(&self, sample: &Sample<S>, p: &[S], all: &mut [Vec<S>; 2], work: &mut ProgramWork<S>) -> S {
        let [inputs, outputs] = all;
        self.write_arguments(sample, p, inputs);
        outputs.clear();
        outputs.resize(self.formula.outputs.len(), S::zero());
        S::run(self.formula.values(), inputs, outputs, work);
        outputs[0]
    }

    fn write_arguments<S: RunScalar>(&self, sample: &Sample<S>, p: &[S], inputs: &mut Vec<S>) {
        inputs.clear();
        inputs.extend(self.places.iter().map(|&place| match place {
            Place::A(dof) => sample.at.a[dof],
            Place::V(dof) => sample.at.v[dof],
            Place::Q(dof) => sample.at.q[dof],
            Place::Mu(row) => sample.mu[row],
            Place::P(index) => p[index],
            Place::Time => sample.t,
        }));
    }

    /// Adds `factor` times the gradient of its first result.
    fn add_gradient(&self, sample: &Sample<f64>, p: &[f64], factor: f64, mut add: impl FnMut(Place, f64)) {
        let program = self.formula.gradient(&[0]);
        f64::with_work(|[inputs, outputs], work| {
            self.write_arguments(sample, p, inputs);
            outputs.clear();
            outputs.resize(program.outputs(), 0.0);
            program.run(inputs, outputs, work);
            for (&label, &entry) in program.labels().iter().zip(&*outputs) {
                add(self.places[label as usize], factor * entry);
            }
        });
    }
}

impl Measured {
    /// Kinetic and potential energy of all elements \[J\].
    pub fn energy() -> Self {
        Measured::Energy(MeasuredGroup::new(None, ElementSum::Energy.into(), 0..0))
    }

    /// The formula that it is; a group has a way of its own.
    fn reading<'m>(&'m self, model: &'m Model) -> Option<Reading<'m>> {
        match self {
            Measured::Local { nodes, constraints, parameters, quantity } => {
                let rows = constraints.iter().flat_map(|id| model.constraints[id.0].equations.clone());
                let state = dofs(model, nodes).map(Place::A).chain(dofs(model, nodes).map(Place::V));
                let places = state
                    .chain(dofs(model, nodes).map(Place::Q))
                    .chain(rows.map(Place::Mu))
                    .chain(parameters.clone().map(Place::P))
                    .chain([Place::Time]);
                Some(Reading { formula: quantity.formula(), places: places.collect() })
            }
            Measured::Group(_) | Measured::Energy(_) => None,
            Measured::Load { joint, parameters, load } => {
                let joint = &model.constraints[joint.0];
                let places = dofs(model, &joint.nodes)
                    .map(Place::V)
                    .chain(dofs(model, &joint.nodes).map(Place::Q))
                    .chain(joint.equations.clone().map(Place::Mu))
                    .chain(joint.parameters.clone().chain(parameters.clone()).map(Place::P))
                    .chain([Place::Time]);
                Some(Reading { formula: load.formula(&joint.physics), places: places.collect() })
            }
        }
    }

    /// Writes its values at a sample, one or those of all points, with their weights where these are asked for and otherwise 1.
    pub(super) fn write_values<S: RunScalar>(
        &self,
        model: &Model,
        sample: &Sample<S>,
        p: &[S],
        points: PointWeights,
        work: &mut GroupWork<S>,
    ) {
        let value = match self {
            Measured::Group(group) => return group.write_values(model, sample, p, points, work),
            Measured::Energy(group) => group.sum(model, sample, p, work),
            _ => self.value(model, sample, p),
        };
        work.values.clear();
        work.values.push([value, S::one()]);
    }

    /// The value at a sample; of points their sum by weights.
    pub fn value<S: RunScalar>(&self, model: &Model, sample: &Sample<S>, p: &[S]) -> S {
        match self {
            Measured::Group(group) | Measured::Energy(group) => group.sum(model, sample, p, &mut GroupWork::default()),
            _ => S::with_work(|numbers, work| {
                self.reading(model).map_or(S::zero(), |reading| reading.value(sample, p, numbers, work))
            }),
        }
    }

    /// Adds `factor` times the gradient of its only value at a sample; a group has a way of its own.
    pub(super) fn add_gradient(&self, model: &Model, sample: &Sample<f64>, p: &[f64], factor: f64, seeds: &mut SampleSeeds) {
        let Some(reading) = self.reading(model) else { return };
        reading.add_gradient(sample, p, factor, |place, entry| match place {
            Place::A(dof) => seeds.at.a[dof] += entry,
            Place::V(dof) => seeds.at.v[dof] += entry,
            Place::Q(dof) => seeds.at.q[dof] += entry,
            Place::Mu(row) => seeds.mu[row] += entry,
            Place::P(index) => seeds.p[index] += entry,
            Place::Time => {}
        });
    }
}
