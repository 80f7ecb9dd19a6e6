use super::Counters;
use super::lists::add_lists;
use super::newton::NewtonTolerance;
use super::record::{StageRecord, StepRecord};
use super::{Combination, ConstraintLevel, Embedded, InitialState, Quadrature, StabilityCourse, StepError, Table};
use crate::assembly::{Equations, Level, Model, System, SystemOptions, Variational};
use crate::elements::RunScalar;
use crate::linalg::Backend;
use smallvec::SmallVec;
use std::sync::Arc;

/// What is simulated: topology, parameters, start.
#[derive(Clone, Debug)]
pub struct Problem<'m, S> {
    pub model: &'m Model,
    pub p: Vec<S>,
    pub start: InitialState<S>,
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "Model of {} nodes, {} elements, {} constraints",
            self.nodes.len(),
            self.elements.len(),
            self.constraints.len()
        )
    }
}

/// How it is simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// The integrator.
    pub table: Table,
    /// The constraint level.
    pub level: ConstraintLevel,
    /// When Newton's method stops.
    pub tolerance: NewtonTolerance,
    /// Which solver factors.
    pub backend: Backend,
    /// Keep node-local constraints in the matrix: for tests.
    pub unreduced: bool,
    /// Measure what the parts of steps take, [`Counters::nanoseconds`]; looking at the clock takes a share of the steps of small systems.
    pub measures_phases: bool,
    /// Whether steps of motions end where elements pass from one piece of their formulas to another.
    pub locates: bool,
}

impl Method {
    /// A table and a level, with round-off tolerance.
    pub fn new(table: Table, level: ConstraintLevel) -> Self {
        let (tolerance, backend) = (NewtonTolerance::default(), Backend::default());
        Method {
            table: table.with_euler(),
            level,
            tolerance,
            backend,
            unreduced: false,
            measures_phases: false,
            locates: true,
        }
    }

    /// Whether steps end at switches of elements: not in equilibria, nor where elements add impulses of a step.
    pub(crate) fn ends_at_switches(&self, model: &Model) -> bool {
        (self.locates || !model.events.is_empty()) && !self.table.is_static() && self.table.variational.is_none()
    }

    pub(crate) fn unreduced(&self) -> Self {
        Method { unreduced: true, ..self.clone() }
    }

    /// The level at which constraints are kept: in an equilibrium and by a variational integrator that of positions, whatever is chosen.
    pub fn constraint_level(&self) -> ConstraintLevel {
        let given = self.table.is_static() || self.table.variational.is_some();
        if given { ConstraintLevel::Position } else { self.level }
    }

    /// The numbered equations of all systems of a run of a model, without the constraint equations `dropped`.
    pub fn system<'m>(&self, model: &'m Model, dropped: &[usize]) -> Arc<System<'m>> {
        let options = SystemOptions { dropped: dropped.to_vec(), unreduced: self.unreduced };
        Arc::new(System::new(model, options))
    }

    pub(crate) fn stage_equations(&self, table: &Table, index: usize, h: f64, constrained: bool) -> Equations {
        if let Some(Quadrature { alpha, first }) = table.variational {
            return Equations::variational(Variational { alpha, h, first });
        }
        let shift = table.shift(index, h);
        let level = match self.constraint_level() {
            // what moves accelerations alone leaves positions where they are
            ConstraintLevel::Position if constrained && (shift.beta, shift.alpha) != (0.0, 0.0) => Level::Position,
            _ => Level::Acceleration,
        };
        Equations::stage(shift, level)
    }
}

#[derive(Clone, Debug)]
pub struct Run<S> {
    pub q: Vec<S>,
    /// Steps that were tried and given up for shorter ones.
    pub rejected: usize,
    pub error: Option<StepError>,
    /// Start \[s\] and number of the first step that leaps over a dead point, where drives determine the motion: behind it the mechanism is on
    /// another branch.
    pub leap: Option<(f64, usize)>,
    /// Determinants that were looked at for it: two of each step in which coordinates do not change as their rates say.
    pub determinants: usize,
    /// Of equilibria: whether they stand.
    pub stability: Option<StabilityCourse>,
    pub counters: Counters,
}

/// Writes the sum of carried vectors and stage unknowns with the powers of h that belong to a vector of `order` time derivatives.
pub(crate) fn combine<S: RunScalar>(
    table: &Table,
    order: i32,
    combination: &Combination,
    h: f64,
    carried: &[Vec<S>],
    stages: &[StageRecord<S>],
    sum: &mut Vec<S>,
) {
    sum.clear();
    sum.resize(carried[0].len(), S::zero());
    let carried = carried.iter().zip(&table.carried).zip(&combination.carried);
    let of_carried = carried.map(|((values, kind), coefficient)| (coefficient * h.powi(kind.order() - order), &values[..]));
    let stages = stages.iter().zip(&combination.stages);
    let of_stages = stages.map(|(stage, coefficient)| (coefficient * h.powi(2 - order), &stage.solve.unknowns.x[..]));
    let terms: SmallVec<[(f64, &[S]); 12]> = of_carried.chain(of_stages).filter(|(factor, _)| *factor != 0.0).collect();
    add_lists(sum, &terms);
}

/// What the embedded solution of a step differs by: in coordinates (`order` 0) or velocities (1).
pub(super) fn embedded_difference<S: RunScalar>(
    (table, embedded): (&Table, &Embedded),
    order: i32,
    step: &StepRecord<S>,
    difference: &mut Vec<S>,
) {
    let combination = if order == 0 { &embedded.q } else { &embedded.v };
    combine(table, order, combination, step.h, &step.carried, &step.stages, difference);
}

pub(crate) fn add_scaled<S: RunScalar>(target: &mut [S], values: &[S], factor: f64) {
    for (target, &value) in target.iter_mut().zip(values) {
        *target += value * factor;
    }
}
