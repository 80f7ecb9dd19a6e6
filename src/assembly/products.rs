use super::batches::{BatchWork, run_parts};
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::local::dot4;
use super::numbering::{DofMap, System};
use super::residual::LocalVec;
use super::{Equations, Level, Rates, Unknowns, VectorsAvq};
use crate::elements::State;
use crate::program::Program;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

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
        let mut adjoints = Adjoints::default();
        adjoints.set_zeros(system);
        adjoints
    }

    /// Zeros for a system, in the memory that is there.
    pub fn set_zeros(&mut self, system: &System) {
        let copies = if system.options.stabilized { 2 } else { 1 };
        let (dofs, rows) = (system.model.dofs, system.multipliers());
        let Adjoints { f, y, g, g_second, local } = self;
        let lengths = [dofs, (copies - 1) * dofs, rows, (copies - 1) * rows, copies * system.local_equations];
        for (values, length) in [f, y, g, g_second, local].into_iter().zip(lengths) {
            values.clear();
            values.resize(length, 0.0);
        }
    }
}

/// Where products are taken.
#[derive(Clone, Copy)]
pub struct ProductPoint<'p> {
    /// (a, v, q).
    pub at: &'p VectorsAvq<f64>,
    /// Parameters.
    pub p: &'p [f64],
    /// Time \[s\].
    pub t: f64,
}

/// Where products go, for one functional.
pub struct ProductBars<'b> {
    /// Adjoint of a, v and q, one behind the other.
    pub avq: &'b mut [f64],
    /// Adjoint of the parameters.
    pub p: &'b mut [f64],
}

/// Parts of a batch with the same parameters that are asked for.
struct Selection {
    /// Number of the batch.
    batch: usize,
    /// Which parameters.
    asked: Vec<bool>,
    /// Parts.
    parts: Vec<usize>,
    programs: HashMap<u32, ProductProgram>,
}

fn select<'p>(parts: impl Iterator<Item = &'p [usize]>, all: &[DofMap], active: &[bool]) -> Vec<Selection> {
    let mut selections: Vec<Selection> = Vec::new();
    for (batch, parts) in parts.enumerate() {
        let mut places: HashMap<&[bool], usize> = HashMap::new();
        for &part in parts {
            let asked = &active[all[part].parameters.clone()];
            let place = *places.entry(asked).or_insert_with(|| {
                selections.push(Selection { batch, asked: asked.to_vec(), parts: Vec::new(), programs: HashMap::new() });
                selections.len() - 1
            });
            selections[place].parts.push(part);
        }
    }
    selections
}

/// What a result of a program is the derivative towards.
enum ProductArgument {
    /// A coordinate of the part, of a (0), v (1) or q (2).
    Coordinate(usize, usize),
    /// A parameter of the part.
    Parameter(usize),
}

/// Functionals whose products share what depends on the state alone.
const TOGETHER: usize = 2;

/// A program for some functionals, and where its results go.
struct ProductProgram {
    program: Arc<Program>,
    /// Results for one functional.
    count: usize,
    /// Which of them belong to parameters.
    of_parameters: Range<usize>,
    /// Places of the results of one functional in (a, v, q) or p, part by part.
    places: Vec<u32>,
}

impl ProductProgram {
    /// For some parts of a model with so many coordinates. Results are labelled by `size` times the number of the functional, and the number of
    /// an argument, of which `argument` tells what it is; those of parameters stand together.
    fn new<'s>(
        program: Arc<Program>,
        size: usize,
        dofs: usize,
        parts: impl Iterator<Item = &'s DofMap>,
        argument: impl Fn(usize) -> ProductArgument,
    ) -> Self {
        let labels = program.labels();
        let count = labels.partition_point(|&label| (label as usize) < size);
        let (own, others) = labels.split_at(count);
        let shifted = others.chunks(count.max(1)).zip(1..);
        let alike = |(labels, k): (&[u32], u32)| labels.iter().map(|label| label - k * size as u32).eq(own.iter().copied());
        assert!(shifted.into_iter().all(alike), "products for further functionals have the places of those for the first");
        let arguments: Vec<ProductArgument> = own.iter().map(|&label| argument(label as usize)).collect();
        let is_parameter = |argument: &ProductArgument| matches!(argument, ProductArgument::Parameter(_));
        let first = arguments.iter().position(is_parameter).unwrap_or(count);
        let of_parameters = first..first + arguments[first..].iter().take_while(|own| is_parameter(own)).count();
        assert!(!arguments[of_parameters.end..].iter().any(is_parameter), "parameters stand together");
        let mut places = Vec::new();
        for part in parts {
            let coordinates: SmallVec<[usize; 64]> = part.segments.iter().cloned().flatten().collect();
            places.extend(arguments.iter().map(|argument| match *argument {
                ProductArgument::Coordinate(vector, place) => (vector * dofs + coordinates[place]) as u32,
                ProductArgument::Parameter(place) => (part.parameters.start + place) as u32,
            }));
        }
        ProductProgram { program, count, of_parameters, places }
    }

    /// Adds the results for a part of the selection, times a factor.
    #[inline(always)]
    fn add(&self, part: usize, results: &[f64], factor: f64, bars: &mut [ProductBars]) {
        let places = &self.places[part * self.count..][..self.count];
        let Range { start, end } = self.of_parameters;
        let add = |values: &mut [f64], own: Range<usize>, results: &[f64]| {
            let places = places[own.clone()].iter().zip(&results[own]);
            places.for_each(|(&place, result)| values[place as usize] += factor * result);
        };
        for (bar, results) in bars.iter_mut().zip(results.chunks_exact(self.count.max(1))) {
            add(bar.avq, 0..start, results);
            add(bar.p, start..end, results);
            add(bar.avq, end..self.count, results);
        }
    }
}

/// Products of adjoint variables with the derivatives of elements and constraints.
pub struct Products {
    /// By what elements add.
    elements: [Option<Vec<Selection>>; Force::KINDS],
    constraints: Option<Vec<Selection>>,
    active: Vec<bool>,
    work: BatchWork<f64>,
    /// Places in a selection of the parts whose adjoint variables are not all zero.
    chosen: Vec<usize>,
}

impl Products {
    /// For parameters that depend on a design variable; the others get no derivative.
    pub fn new(active: &[bool]) -> Self {
        Products {
            elements: [const { None }; Force::KINDS],
            constraints: None,
            active: active.to_vec(),
            work: BatchWork::default(),
            chosen: Vec::new(),
        }
    }

    /// Adds `sign` times the gradient of lambda times what elements add to F, for every functional.
    pub fn add_elements(
        &mut self,
        system: &System,
        adjoints: &[Adjoints],
        (force, sign): (Force, f64),
        ProductPoint { at, p, t }: ProductPoint,
        bars: &mut [ProductBars],
    ) {
        let batches = system.element_batches(force);
        let Products { elements, active, work, chosen, .. } = self;
        let selections = elements[force.kind()].get_or_insert_with(|| {
            select(batches.iter().map(|batch| batch.parts.as_slice()), &system.element_parts, active)
        });
        for Selection { batch, asked, parts, programs } in selections {
            let batch = &batches[*batch];
            let (layout, n) = (batch.layout, batch.layout.n);
            for (adjoints, bars) in adjoints.chunks(TOGETHER).zip(bars.chunks_mut(TOGETHER)) {
                let own = programs.entry(adjoints.len() as u32).or_insert_with(|| {
                    let program = element_programs::products(&batch.formula, layout, asked, adjoints.len());
                    let all = parts.iter().map(|&part| &system.element_parts[part]);
                    ProductProgram::new(program, layout.t(), system.model.dofs, all, |place| match place {
                        place if place < 3 * n => ProductArgument::Coordinate(place / n, place % n),
                        place => ProductArgument::Parameter(place - layout.p()),
                    })
                });
                let part = |place: usize| &system.element_parts[parts[place]];
                chosen.clear();
                chosen.extend((0..parts.len()).filter(|&place| adjoints.iter().any(|own| any(part(place), &own.f))));
                run_parts(
                    &own.program,
                    chosen.len(),
                    work,
                    |index, lane| {
                        let part = part(chosen[index]);
                        let mut place = layout.write(lane, part, (at, p, t), force);
                        for adjoint in adjoints {
                            place = lane.copy_segments(place, part, &adjoint.f);
                        }
                    },
                    |index, results| own.add(chosen[index], results, sign, bars),
                );
            }
        }
    }

    /// Adds the gradient of lambda_F . A^T mu - lambda_Y . A^T eta + lambda_G . G of all joints, for every functional.
    pub fn add_constraints(
        &mut self,
        system: &System,
        (equations, which): (&Equations, ConstraintPart),
        adjoints: &[Adjoints],
        unknowns: &Unknowns<f64>,
        ProductPoint { at, p, t }: ProductPoint,
        bars: &mut [ProductBars],
    ) {
        let batches = system.constraint_batches();
        let Products { constraints, active, work, chosen, .. } = self;
        let selections = constraints.get_or_insert_with(|| {
            select(batches.iter().map(|batch| batch.parts.as_slice()), &system.constraint_parts, active)
        });
        for Selection { batch, asked: parameters, parts, programs } in selections {
            let batch = &batches[*batch];
            let (physics, layout) = (system.constraint_of(batch), batch.layout);
            let ((asked, scales), factor) = (Asked::part(which, equations, physics.is_nonholonomic()), which.factor());
            let n = layout.n;
            for (adjoints, bars) in adjoints.chunks(TOGETHER).zip(bars.chunks_mut(TOGETHER)) {
                let count = adjoints.len();
                let code = asked.short_code([false; 3]) * (TOGETHER + 1) as u32 + count as u32;
                let own = programs.entry(code).or_insert_with(|| {
                    let program = constraint_programs::products(physics, asked, parameters, count);
                    let all = parts.iter().map(|&part| &system.constraint_parts[part]);
                    ProductProgram::new(program, layout.mu(), system.model.dofs, all, |place| match place {
                        place if place < 2 * n => ProductArgument::Coordinate(1 + place / n, place % n),
                        place if place < layout.t() => ProductArgument::Parameter(place - layout.p()),
                        place => ProductArgument::Coordinate(0, place - layout.a()),
                    })
                });
                let weighs = |adjoint: &Adjoints, index: usize| {
                    let (part, rows) = (&system.constraint_parts[index], system.equations_of(index));
                    let nonzero = |values: &[f64]| values.iter().any(|&value| value != 0.0);
                    let equations = nonzero(&adjoint.g[rows.clone()]) || adjoint.g_second.get(rows).is_some_and(nonzero);
                    (asked.reactions && (any(part, &adjoint.f) || any(part, &adjoint.y)))
                        || (asked.equations[0].is_some() && equations)
                };
                chosen.clear();
                let places = 0..parts.len();
                chosen.extend(places.filter(|&place| adjoints.iter().any(|adjoint| weighs(adjoint, parts[place]))));
                run_parts(
                    &own.program,
                    chosen.len(),
                    work,
                    |index, lane| {
                        let index = parts[chosen[index]];
                        let (part, rows) = (&system.constraint_parts[index], system.equations_of(index));
                        let multipliers = asked.multipliers(unknowns, rows.clone());
                        let mut place = layout.write(lane, part, (at, p, t), multipliers, scales);
                        for adjoint in adjoints {
                            if asked.reactions {
                                place = lane.copy_segments(place, part, &adjoint.f);
                                if asked.stabilized() {
                                    place = lane.copy_segments(place, part, &adjoint.y);
                                }
                            }
                            if asked.equations[0].is_some() {
                                place = lane.copy(place, &adjoint.g[rows.clone()]);
                            }
                            if asked.equations[1].is_some() {
                                place = lane.copy(place, &adjoint.g_second[rows.clone()]);
                            }
                        }
                    },
                    |index, results| own.add(chosen[index], results, factor, bars),
                );
            }
        }
    }
}

/// Whether any number of a part's coordinates is not zero.
fn any(part: &DofMap, values: &[f64]) -> bool {
    part.segments.iter().any(|dofs| values.get(dofs.clone()).is_some_and(|own| own.iter().any(|&value| value != 0.0)))
}

/// What goes through the constraints inside nodes, for one functional.
pub struct NodeBars<'b> {
    /// Adjoint of the solution x of the system.
    pub x: &'b [f64],
    /// Adjoint of y; empty unless stabilized.
    pub y: &'b [f64],
    /// Adjoint variables; those of the equations inside nodes are set.
    pub adjoints: &'b mut Adjoints,
    /// Products with the derivatives of elements towards a, v and q.
    pub elements: &'b [f64],
    /// The same of constraints, to which those inside nodes are added.
    pub constraints: &'b mut [f64],
    /// Where reactions add, if they act at another point than the equations hold.
    pub reactions: Option<&'b mut [f64]>,
}

impl System<'_> {
    /// Adds the products with the reactions inside nodes, sets the adjoints of the equations there so that the gradient with respect to each
    /// node's unknowns vanishes along the directions that were eliminated, x_bar + J^T lambda + C^T lambda_local = 0, and adds the products
    /// of these equations; in closed form.
    pub fn add_node_products(
        &self,
        equations: &Equations,
        unknowns: &Unknowns<f64>,
        at: &VectorsAvq<f64>,
        functionals: &mut [NodeBars],
    ) {
        let all = self.model.dofs;
        let (scales, outer, inner) = (equations.row_scales(), equations.residual, equations.constraint);
        let mut gradients: SmallVec<[Rates<f64>; 16]> = SmallVec::new();
        let mut unbalanced: LocalVec<f64> = SmallVec::new();
        for local in self.eliminated() {
            let dofs = self.model.nodes[local.node].dofs.clone();
            let (own, n) = (local.equations.clone(), dofs.len());
            if let Some(unit) = local.form.unit_length().filter(|_| equations.level != Level::Stabilized) {
                let four = dofs.start + unit.first..dofs.start + unit.first + 4;
                let node = UnitNode { all, dofs: four, equation: own.start, second: unit.second };
                node.add_products(equations, unknowns.local_mu[own.start], at, functionals);
                continue;
            }
            let state = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
            gradients.clear();
            gradients.resize(own.len() * n, Rates::zero());
            local.form.moving_rows(state, &mut gradients);
            let rows = super::local::rows_of(&gradients, n, equations);
            let places = [0, 1, 2].map(|vector| vector * all + dofs.start..vector * all + dofs.end);
            for NodeBars { x, y, adjoints, elements, constraints, reactions } in &mut *functionals {
                let target = &mut reactions.as_deref_mut().unwrap_or(&mut **constraints)[places[2].clone()];
                local.form.add_curvature(&unknowns.local_mu[own.clone()], &adjoints.f[dofs.clone()], 1.0, target);
                if let (Some(eta), Some(lambda)) = (unknowns.local_eta.get(own.clone()), adjoints.y.get(dofs.clone())) {
                    local.form.add_curvature(eta, lambda, -1.0, target);
                }
                // what is left of x_bar + J^T lambda along the eliminated directions belongs to the equations inside the node
                let part = |values: &[f64], vector: usize, i: usize| values[places[vector].start + i];
                let along_q = |i: usize| outer.alpha * part(elements, 2, i) + inner.alpha * part(constraints, 2, i);
                unbalanced.clear();
                unbalanced.extend((0..n).map(|i| {
                    let rates = outer.gamma * part(elements, 0, i) + outer.beta * part(elements, 1, i);
                    let inner_rates = inner.gamma * part(constraints, 0, i) + inner.beta * part(constraints, 1, i);
                    x[dofs.start + i] + rates + inner_rates + along_q(i)
                }));
                if let Some(y) = y.get(dofs.clone()) {
                    let lambda = &adjoints.y[dofs.clone()];
                    unbalanced.extend(y.iter().zip(lambda).enumerate().map(|(i, (y, lambda))| y + lambda + along_q(i)));
                }
                let count = rows.len() / unbalanced.len();
                let multipliers = super::local::least_squares(&rows, count, &unbalanced);
                adjoints.local[own.clone()].copy_from_slice(&multipliers[..own.len()]);
                if count > own.len() {
                    let start = self.local_equations + own.start;
                    adjoints.local[start..start + own.len()].copy_from_slice(&multipliers[own.len()..]);
                }
                for (row, equation) in gradients.chunks_exact(n).zip(0..) {
                    let second = multipliers.get(equation + own.len()).copied().unwrap_or(0.0);
                    let weights = [multipliers[equation] * scales[0], second * scales[1]];
                    add_row(equations.level, row, weights, &places, constraints);
                }
            }
        }
    }
}

/// Four coordinates of unit length: (x . x) h / 2 + c = 0.
struct UnitNode {
    /// Number of coordinates of the model.
    all: usize,
    dofs: Range<usize>,
    /// Their equation.
    equation: usize,
    /// h.
    second: f64,
}

impl UnitNode {
    /// What [`System::add_node_products`] does, in a few multiplications.
    fn add_products(&self, equations: &Equations, mu: f64, at: &VectorsAvq<f64>, functionals: &mut [NodeBars]) {
        let UnitNode { all, dofs, equation, second } = self;
        let four = |values: &[f64]| -> [f64; 4] { std::array::from_fn(|i| values[dofs.start + i]) };
        let (a, v, q) = (four(&at.a), four(&at.v), four(&at.q));
        let (outer, inner, weights) = (equations.residual, equations.constraint, equations.row_weights());
        let row: [f64; 4] = std::array::from_fn(|i| (weights[0] * q[i] + weights[1] * v[i] + weights[2] * a[i]) * second);
        let along = 1.0 / dot4(&row, &row);
        for NodeBars { x, adjoints, elements, constraints, reactions, .. } in functionals {
            let places = [0, 1, 2].map(|vector| vector * all + dofs.start);
            let target = &mut reactions.as_deref_mut().unwrap_or(&mut **constraints)[places[2]..][..4];
            target.iter_mut().zip(four(&adjoints.f)).for_each(|(target, lambda)| *target += mu * second * lambda);
            let unbalanced: [f64; 4] = std::array::from_fn(|i| {
                let [of_a, of_v, of_q] = places.map(|place| (elements[place + i], constraints[place + i]));
                let rates = outer.gamma * of_a.0 + outer.beta * of_v.0 + (inner.gamma * of_a.1 + inner.beta * of_v.1);
                x[dofs.start + i] + rates + (outer.alpha * of_q.0 + inner.alpha * of_q.1)
            });
            let multiplier = -dot4(&row, &unbalanced) * along;
            adjoints.local[*equation] = multiplier;
            let weight = multiplier * equations.row_scales()[0] * second;
            for i in 0..4 {
                let [in_a, in_v, in_q] = places.map(|place| place + i);
                match equations.level {
                    Level::Position => constraints[in_q] += weight * q[i],
                    Level::Velocity => {
                        constraints[in_v] += weight * q[i];
                        constraints[in_q] += weight * v[i];
                    }
                    _ => {
                        constraints[in_a] += weight * q[i];
                        constraints[in_v] += 2.0 * weight * v[i];
                        constraints[in_q] += weight * a[i];
                    }
                }
            }
        }
    }
}

/// Adds the scaled weights of the one or two equations of a level times their gradients, given the row A along the motion, to the places of
/// the node's a, v and q.
fn add_row(
    level: Level,
    row: &[Rates<f64>],
    [first, second]: [f64; 2],
    [at_a, at_v, at_q]: &[Range<usize>; 3],
    bar: &mut [f64],
) {
    if [first, second] == [0.0; 2] {
        return;
    }
    let places = at_a.clone().zip(at_v.clone().zip(at_q.clone()));
    for (a, (in_a, (in_v, in_q))) in row.iter().zip(places) {
        match level {
            Level::Position => bar[in_q] += first * a.value,
            Level::Velocity => {
                bar[in_v] += first * a.value;
                bar[in_q] += first * a.first;
            }
            Level::Acceleration => {
                bar[in_a] += first * a.value;
                bar[in_v] += 2.0 * first * a.first;
                bar[in_q] += first * a.second;
            }
            Level::Stabilized => {
                bar[in_v] += second * a.value;
                bar[in_q] += first * a.value + second * a.first;
            }
        }
    }
}
