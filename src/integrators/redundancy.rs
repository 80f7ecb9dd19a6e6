//! Redundant constraints: which equations are kept, and a watch over those that are left out.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::amplitudes::entries;
use super::{Problem, RunError, Stop};
use crate::assembly::{Equations, Jacobian, Model, Residual, StageSystem, System, SystemOptions, VectorsAvq};
use crate::elements::{FormulaWork, RunScalar};
use crate::linalg::{SparseRow, independent_rows};

/// A dropped equation may be violated by this share of the largest coordinate ...
const VIOLATED: f64 = 1e-8;
/// ... or by so many times the violation of the kept ones: at stages' ends these are as large as the method's error.
const WORSE: f64 = 1e3;
/// Violation of kept equations, by the largest coordinate, that leaves the bound of dropped ones what it is.
pub(super) const KEPT: f64 = VIOLATED / WORSE;

/// Rows of the constraint equations in an assembled matrix, towards the unknowns of nodes.
fn constraint_rows(system: &System, jacobian: &Jacobian) -> Vec<SparseRow> {
    let pattern = &system.pattern;
    let places = system.multiplier_places();
    let nodes = places.iter().flatten().min().copied().unwrap_or(pattern.size);
    let mut row_of = vec![None; pattern.size];
    for (row, place) in places.iter().enumerate() {
        if let Some(place) = *place {
            row_of[place] = Some(row);
        }
    }
    let mut rows = vec![SparseRow::new(); places.len()];
    for (place, column, value) in entries(pattern, &jacobian.values).filter(|own| own.1 < nodes) {
        if let Some(row) = row_of[place] {
            rows[row].push((column, value));
        }
    }
    rows
}

/// The equations to leave out at a state (q, v), so that an independent subset is kept; with `count` exactly so many: those that
/// depend most on the kept ones. Those that are not there now are among them.
pub(super) fn dependent_equations<S: RunScalar>(
    problem: &Problem<S>,
    absent: &[usize],
    (q, v): (&[S], &[S]),
    t: f64,
    count: Option<usize>,
) -> Vec<usize> {
    let real = |values: &[S]| values.iter().map(|value| value.value()).collect::<Vec<f64>>();
    dependent((problem.model, &real(&problem.p)), absent, [&real(q), &real(v)], t, count)
}

fn dependent(
    (model, p): (&Model, &[f64]),
    absent: &[usize],
    [q, v]: [&[f64]; 2],
    t: f64,
    count: Option<usize>,
) -> Vec<usize> {
    let system = System::new(model, SystemOptions { dropped: absent.to_vec(), ..SystemOptions::default() });
    let (mut residual, mut jacobian) = (Residual::<f64>::default(), Jacobian::default());
    let mut unknowns = Residual::unknowns(&system);
    let base = VectorsAvq { a: vec![0.0; model.dofs], v: v.to_vec(), q: q.to_vec() };
    let equations = Equations::acceleration();
    residual.evaluate(&system, StageSystem { equations: &equations, base: &base, p, t }, &mut unknowns);
    jacobian.assemble(&system, &equations, &residual, &unknowns, p, t);
    let rows = constraint_rows(&system, &jacobian);
    let kept = independent_rows(&rows, count.map(|count| rows.len() - count));
    (0..rows.len()).filter(|row| kept.binary_search(row).is_err()).collect()
}

/// The equations to leave out at a state (q, v), beyond those that are: of some equations these which depend on all others or on the ones of them
/// before them.
pub(super) fn dependent_among(
    of: (&Model, &[f64]),
    dropped: &[usize],
    state: [&[f64]; 2],
    t: f64,
    some: &[usize],
) -> Vec<usize> {
    let joined = |more: &[usize]| {
        let mut all = [dropped, more].concat();
        all.sort_unstable();
        all
    };
    let is_independent = |more: &[usize]| {
        let absent = joined(more);
        dependent(of, &absent, state, t, None).len() == absent.len()
    };
    let mut left_out = Vec::new();
    if some.is_empty() || is_independent(&[]) {
        return joined(&left_out);
    }
    for (place, &row) in some.iter().enumerate() {
        if !is_independent(&[&left_out, &some[place + 1..]].concat()) {
            left_out.push(row);
        }
    }
    joined(&left_out)
}

pub(super) struct Watch<S> {
    q: Vec<S>,
    work: FormulaWork<S>,
}

crate::assembly::empty_fields!(Watch { q, work });

impl<S: RunScalar> Watch<S> {
    /// The dropped equation that is there and violated most at a state, if it is violated more than round-off and the kept equations explain, and
    /// by how much.
    pub fn worst(
        &mut self,
        model: &Model,
        p: &[S],
        [dropped, absent]: [&[usize]; 2],
        q: &[S],
        t: f64,
    ) -> Option<(usize, f64)> {
        let (mut worst, mut kept) = ((0, 0.0), 0.0_f64);
        for joint in &model.constraints {
            self.q.clear();
            joint.nodes.iter().for_each(|node| self.q.extend_from_slice(&q[model.nodes[node.0].dofs.clone()]));
            let own = joint.physics.value_in(&self.q, &p[joint.parameters.clone()], S::from(t), &mut self.work);
            for (row, g) in joint.equations.clone().zip(own) {
                let g = g.value().abs();
                if dropped.binary_search(&row).is_err() {
                    kept = kept.max(g);
                } else if !(g <= worst.1) && absent.binary_search(&row).is_err() {
                    worst = (row, g);
                }
            }
        }
        let length = q.iter().fold(1.0, |length: f64, q| length.max(q.value().abs()));
        (!(worst.1 <= (VIOLATED * length).max(WORSE * kept))).then_some(worst)
    }
}

pub(super) fn violated(model: &Model, place: String, (row, g): (usize, f64)) -> RunError {
    let cause = format!(
        "{} was left out as redundant, but is violated by {g:.1e}: the constraints depend on each other \
         at the start only, and the mechanism is locked or singular here",
        model.equation_name(row)
    );
    RunError::stopped(Stop::Redundant, place, cause, "check the directions of axes and the closing of loops")
}
