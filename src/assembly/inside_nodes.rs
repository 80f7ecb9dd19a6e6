//! Constraints inside a node: satisfied there, and removed from the matrix exactly.
//!
//! With B = A^T (the reaction's direction) and C the derivative of the node's own equations with respect to its unknowns, the matrix gets
//! N_L^T J N_R, where N_L is orthogonal to B and N_R to C. Unknowns move along N_R and are then brought back onto the node's equations.

use super::batches::ConstraintBatch;
use super::constraint_programs::{Asked, ConstraintPart};
use super::evaluation::{BatchWork, run_lanes};
use super::lanes::LaneResults;
use super::node_programs;
use super::numbering::System;
use super::unit_length::UnitLengths;
use super::{Equations, StageCoefficients, Unknowns, VectorsAvq};
use crate::elements::RunScalar;

/// Codes of programs of nodes, beside those of the orders of equations.
pub(super) const ELIMINATION: u32 = 1 << 31;
pub(super) const CURVATURE: u32 = 1 << 30;
pub(super) const PRODUCTS: u32 = 1 << 29;

/// Evaluates constraints inside nodes, those of a kind side by side.
pub(super) struct InsideNodes<S> {
    work: BatchWork<S>,
    /// How far each node was off before its last correction, zero where it is done.
    gaps: Vec<f64>,
    /// What it is about to change.
    before: Vec<S>,
}

super::empty_fields!(InsideNodes { work, gaps, before });

impl<S: RunScalar> InsideNodes<S> {
    /// Moves unknowns along C^T until the equations inside each node hold to round-off, in every derivative part; with `keep_values` in the
    /// derivative parts only; at most `corrections` times.
    pub fn restore(
        &mut self,
        system: &System,
        equations: &Equations,
        base: &VectorsAvq<S>,
        unknowns: &mut Unknowns<S>,
        (keep_values, corrections): (bool, usize),
    ) {
        if keep_values && S::PARTS == 0 {
            return;
        }
        let (asked, scale) = Asked::inside(ConstraintPart::Equations, equations);
        let StageCoefficients { gamma, beta, alpha } = equations.constraint;
        let InsideNodes { work, gaps, before } = self;
        gaps.clear();
        gaps.resize(system.locals.len(), f64::INFINITY);
        for batch in system.node_batches() {
            if let (Some(lengths), 0) = (UnitLengths::of(batch), S::PARTS) {
                lengths.restore(equations, base, unknowns, corrections);
                continue;
            }
            let (physics, nodes) = (system.constraint_inside(batch), &batch.places.nodes);
            let make = || node_programs::correction(physics, batch.layout, asked);
            let program = batch.programs.get(asked.short_code([false; 3]), make);
            for _ in 0..corrections {
                before.clear();
                before.extend_from_slice(&unknowns.x);
                let mut is_moved = false;
                run_lanes(
                    program,
                    batch.parts.len(),
                    work,
                    |mut lanes| {
                        lanes.skip(batch.formula.inputs);
                        lanes.gather_nodes(nodes, [&base.v, &base.q]);
                        lanes.skip(1);
                        lanes.gather_nodes(nodes, [&base.a]);
                        lanes.skip(batch.layout.equations);
                        [scale, gamma, beta, alpha].into_iter().for_each(|number| lanes.spread(S::from(number)));
                        lanes.gather_nodes(nodes, [before]);
                    },
                    |results| is_moved |= correct(batch, keep_values, &results, gaps, &mut unknowns.x),
                );
                if !is_moved {
                    break;
                }
            }
        }
    }

    /// Sets multipliers inside nodes so that a force has no part along their reactions, and adds these.
    pub fn eliminate(&mut self, system: &System, q: &[S], force: &mut [S], multipliers: &mut [S]) {
        let InsideNodes { work, before, .. } = self;
        multipliers.fill(S::zero());
        for batch in system.node_batches() {
            if let Some(lengths) = UnitLengths::of(batch) {
                lengths.eliminate(q, force, multipliers);
                continue;
            }
            let nodes = &batch.places.nodes;
            let make = || node_programs::elimination(system.constraint_inside(batch), batch.layout);
            let program = batch.programs.get(ELIMINATION, make);
            before.clear();
            before.extend_from_slice(force);
            run_lanes(
                program,
                batch.parts.len(),
                work,
                |mut lanes| {
                    lanes.skip(batch.formula.inputs + batch.layout.n);
                    lanes.gather_nodes(nodes, [q]);
                    lanes.skip(1);
                    lanes.gather_nodes(nodes, [before]);
                },
                |results| {
                    let behind = results.add_to_nodes(0, nodes, 1.0, force);
                    results.add_to_nodes(behind, std::slice::from_ref(&batch.places.multipliers), 1.0, multipliers);
                },
            );
        }
    }
}

/// Corrects the unknowns x of nodes that are off by more than round-off and still come nearer; returns whether there are any.
#[inline(always)]
fn correct<S: RunScalar>(
    batch: &ConstraintBatch,
    keep_values: bool,
    results: &LaneResults<S>,
    gaps: &mut [f64],
    x: &mut [S],
) -> bool {
    let mut is_any_moved = false;
    results.for_each_part(|place, mut numbers| {
        let mut next = || numbers.next().unwrap_or(S::zero());
        let (mut gap, mut is_settled): (f64, bool) = (0.0, true);
        let round_off = next().value();
        for _ in 0..batch.layout.equations {
            let g = next();
            gap = gap.max(magnitude(g));
            is_settled &= g.value().abs() <= round_off;
        }
        is_settled |= keep_values;
        let before = &mut gaps[batch.parts[place]];
        // below a quarter of the last one: still converging; otherwise round-off is reached
        if (is_settled && S::PARTS == 0) || gap == 0.0 || gap >= 0.25 * *before {
            *before = 0.0;
            return;
        }
        (*before, is_any_moved) = (gap, true);
        for own in &mut x[batch.places.nodes[0].of(place)] {
            let change = next();
            // a value at round-off stays what it is
            *own += if is_settled { change - S::from(change.value()) } else { change };
        }
    });
    is_any_moved
}

/// Size of a number with its derivative parts.
fn magnitude<S: RunScalar>(s: S) -> f64 {
    (0..S::PARTS).map(|part| s.part(part).abs()).fold(s.value().abs(), f64::max)
}
