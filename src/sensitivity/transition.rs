//! How small changes of the state at the start of a run change that at its end: its monodromy matrix, where the run is a period.

use super::{Analysis, Forward};
use crate::assembly::Model;
use crate::design::ModelNumbers;
use crate::elements::RunScalar;
use crate::history::Keep;
use crate::integrators::{Crossing, Observer, RunError, StartPlan, StartRecord, StepRecord};
use crate::scalar::{TANGENTS, Tangents};
use nalgebra::DMatrix;

/// States at the start and the end of a run, and small changes of both: coordinates above velocities, without what is given or is no state.
pub(crate) struct Transition {
    /// Places of the coordinates, and of the velocities, that may change.
    pub places: [Vec<usize>; 2],
    pub ends: [ModelNumbers<f64>; 2],
    /// Changes of the start that keep all constraints, orthogonal and of length one.
    pub basis: DMatrix<f64>,
    /// What becomes of each of them.
    pub changed: DMatrix<f64>,
    /// Formulas that pass from one piece to another on the way.
    pub crossings: Vec<Crossing>,
}

/// Singular value of the projection onto the constraints above which a direction keeps them: such have at least 1, the others round-off.
const KEPT: f64 = 0.5;

/// Most coordinates: changes are dense lists, and as many as there are degrees of freedom.
const MOST_COORDINATES: usize = 1000;

impl<'m> Analysis<'m> {
    /// Of the run of a problem with these numbers.
    pub(crate) fn transition(&self, numbers: &ModelNumbers<f64>) -> Result<Transition, RunError> {
        let places = changing_places(self.model);
        if places[1].len() > MOST_COORDINATES {
            return Err(RunError::Input(format!(
                "the modes of a period are found for up to {MOST_COORDINATES} coordinates, and these are {}: take coarser members",
                places[1].len()
            )));
        }
        let mut begun = Ends { stops: true, ..Ends::default() };
        // runs with derivative parts go along its steps
        let keep = Keep::default();
        let without = Analysis { functionals: &[], keep: &keep, ..*self };
        match without.run(&[], numbers.clone(), &mut begun)?.1 {
            None | Some(RunError::Interrupted { .. }) => {}
            Some(error) => return Err(error),
        }
        let ModelNumbers { q, v, .. } = begun.start;
        let numbers = ModelNumbers { p: numbers.p.clone(), q, v };
        // what a projection leaves of changes keeps the constraints, velocities with the changed coordinates
        let plan = StartPlan { project: true, equilibrium: None, ..self.plan.clone() };
        let own = Analysis { plan: &plan, ..without };
        let mut real = Ends::default();
        let (forward, stopped) = own.run(&[], numbers, &mut real)?;
        stopped.map_or(Ok(()), Err)?;
        let size = places.iter().map(Vec::len).sum();
        let unit = DMatrix::identity(size, size);
        let [projection, _] = own.changes(&forward, &places, &unit, false)?;
        let svd = projection.svd(true, false);
        let left =
            svd.u.ok_or_else(|| RunError::Input("the constraints at the start leave nothing that could change".into()))?;
        let kept: Vec<usize> = (0..left.ncols()).filter(|&k| svd.singular_values[k] > KEPT).collect();
        let [basis, changed] = own.changes(&forward, &places, &left.select_columns(&kept), true)?;
        Ok(Transition { places, ends: [real.start, real.end], basis, changed, crossings: forward.crossings })
    }

    /// Changes of the start after its projection, and those of the end, of the `whole` run or of its first step.
    fn changes(
        &self,
        forward: &Forward,
        places: &[Vec<usize>; 2],
        given: &DMatrix<f64>,
        whole: bool,
    ) -> Result<[DMatrix<f64>; 2], RunError> {
        let mut made = [given.clone(), given.clone()];
        for first in (0..given.ncols()).step_by(TANGENTS) {
            let lanes = TANGENTS.min(given.ncols() - first);
            let numbers = seeded(&forward.numbers, places, given, first..first + lanes);
            let mut ends = Ends::<Tangents> { stops: !whole, ..Ends::default() };
            let clocks = self.clocks(&numbers.p, forward)?;
            match self.perturbed_run(&numbers, &clocks, forward, &mut ends) {
                Err(RunError::Interrupted { .. }) if !whole => {}
                run => drop(run?),
            }
            for (made, ModelNumbers { q, v, .. }) in made.iter_mut().zip([&ends.start, &ends.end]) {
                let rows = places[0].iter().map(|&place| &q[place]).chain(places[1].iter().map(|&place| &v[place]));
                for (row, own) in rows.enumerate() {
                    (0..lanes).for_each(|lane| made[(row, first + lane)] = own.part(lane));
                }
            }
        }
        Ok(made)
    }
}

/// Numbers of a run whose start changes along some columns.
fn seeded(
    numbers: &ModelNumbers<f64>,
    places: &[Vec<usize>; 2],
    given: &DMatrix<f64>,
    columns: std::ops::Range<usize>,
) -> ModelNumbers<Tangents> {
    let lift = |list: &[f64]| list.iter().map(|&value| Tangents::from(value)).collect::<Vec<_>>();
    let [p, mut q, mut v] = [&numbers.p, &numbers.q, &numbers.v].map(|list| lift(list));
    for (lane, column) in columns.enumerate() {
        let column = given.column(column);
        let mut changes = column.iter();
        for (list, places) in [&mut q, &mut v].into_iter().zip(places) {
            places.iter().zip(&mut changes).for_each(|(&place, &change)| list[place].add_to_part(lane, change));
        }
    }
    ModelNumbers { p, q, v }
}

/// Of what is not given: coordinates and velocities; of states of first order, which are velocities, not their integrals, on which nothing depends.
fn changing_places(model: &Model) -> [Vec<usize>; 2] {
    let free = || model.nodes.iter().filter(|node| !node.fixed);
    let moving = free().filter(|node| !node.kind.is_of_states());
    [moving.flat_map(|node| node.dofs.clone()).collect(), free().flat_map(|node| node.dofs.clone()).collect()]
}

struct Ends<S> {
    start: ModelNumbers<S>,
    end: ModelNumbers<S>,
    /// Whether the run stops behind its first step.
    stops: bool,
}

crate::assembly::empty_fields!(Ends { start, end, stops });

impl<S: RunScalar> Observer<S> for Ends<S> {
    fn start(&mut self, start: &StartRecord<S>) -> Result<(), RunError> {
        let point = start.acceleration.point();
        self.start = ModelNumbers { p: Vec::new(), q: point.q, v: point.v };
        Ok(())
    }
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError> {
        self.end.q.clone_from(&step.q);
        self.end.v.clone_from(&step.v);
        if let Some(clock) = &step.clock {
            self.end.v.iter_mut().for_each(|v| *v *= clock.pace());
        }
        Ok(!self.stops)
    }
}
