use super::batches::{Batch, BatchWork, LaneResults, Run, run_lanes};
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::local::dot4;
use super::numbering::{DofMap, System};
use super::places::{Places, Starts};
use super::residual::LocalVec;
use super::{Equations, Level, Rates, Unknowns, VectorsAvq};
use crate::elements::State;
use crate::program::Program;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Adjoint variables of one system: one number for each row of F, Y and G.
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
}

impl Adjoints {
    /// Zeros for a system.
    pub fn zeros(system: &System) -> Self {
        let (dofs, rows) = (system.model.dofs, system.multipliers());
        let second = |count: usize| vec![0.0; if system.options.stabilized { count } else { 0 }];
        Adjoints { f: vec![0.0; dofs], y: second(dofs), g: vec![0.0; rows], g_second: second(rows) }
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
    /// Where their numbers stand, unless they are the whole batch.
    own: Option<Places>,
    /// For one pair of functionals after the other.
    chosen: Vec<Chosen>,
    programs: HashMap<u32, ProductProgram>,
}

/// Parts of a selection whose adjoint variables are not all zero.
#[derive(Default)]
struct Chosen {
    /// Those of now.
    now: Vec<usize>,
    /// Some that were chosen before, and where their numbers stand.
    before: Vec<usize>,
    places: Places,
}

impl Chosen {
    /// Chooses among so many parts; returns how many are, and where their numbers stand, given where those of all do.
    fn places<'p>(&'p mut self, all: &'p Places, parts: usize, is_chosen: impl Fn(usize) -> bool) -> (usize, &'p Places) {
        self.now.clear();
        self.now.extend((0..parts).filter(|&part| is_chosen(part)));
        if self.now.len() == parts {
            return (parts, all);
        }
        if self.now != self.before {
            self.places = all.of_chosen(&self.now);
            self.before.clone_from(&self.now);
        }
        (self.now.len(), &self.places)
    }
}

fn select<L>(batches: &[Batch<L>], all: &[DofMap], active: &[bool]) -> Vec<Selection> {
    let mut selections: Vec<Selection> = Vec::new();
    for (batch, of_batch) in batches.iter().enumerate() {
        let mut places: HashMap<&[bool], usize> = HashMap::new();
        // the parts of each selection by their places in the batch
        let mut members: Vec<Vec<usize>> = Vec::new();
        let first = selections.len();
        for (place, &part) in of_batch.parts.iter().enumerate() {
            let asked = &active[all[part].parameters.clone()];
            let selection = *places.entry(asked).or_insert(members.len());
            if selection == members.len() {
                let (own, chosen, programs) = (None, Vec::new(), HashMap::new());
                selections.push(Selection { batch, asked: asked.to_vec(), parts: Vec::new(), own, chosen, programs });
                members.push(Vec::new());
            }
            selections[first + selection].parts.push(part);
            members[selection].push(place);
        }
        if members.len() > 1 {
            let own = selections[first..].iter_mut().zip(&members);
            own.for_each(|(selection, members)| selection.own = Some(of_batch.places.of_chosen(members)));
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
    /// Those of them that belong to coordinates of (a, v, q).
    coordinates: Vec<Run>,
    /// Those that belong to parameters, and to which ones of the part.
    parameters: (Range<usize>, Vec<u32>),
}

impl ProductProgram {
    /// For parts with such nodes, of a model with so many coordinates. Results are labelled by `size` times the number of the functional, and
    /// the number of an argument, of which `argument` tells what it is.
    fn new(
        program: Arc<Program>,
        size: usize,
        (dofs, nodes): (usize, &[Starts]),
        argument: impl Fn(usize) -> ProductArgument,
    ) -> Self {
        let labels = program.labels();
        let count = labels.partition_point(|&label| (label as usize) < size);
        let (own, others) = labels.split_at(count);
        let shifted = others.chunks(count.max(1)).zip(1..);
        let alike = |(labels, k): (&[u32], u32)| labels.iter().map(|label| label - k * size as u32).eq(own.iter().copied());
        assert!(shifted.into_iter().all(alike), "products for further functionals have the places of those for the first");
        let coordinates: Vec<(usize, usize)> =
            nodes.iter().enumerate().flat_map(|(node, starts)| (0..starts.length).map(move |place| (node, place))).collect();
        let (mut runs, mut results, mut offsets) = (Vec::new(), 0..0, Vec::new());
        for (result, &label) in own.iter().enumerate() {
            match argument(label as usize) {
                ProductArgument::Coordinate(vector, place) => {
                    let (node, place) = coordinates[place];
                    Run::extend(&mut runs, result, node, vector * dofs + place);
                }
                ProductArgument::Parameter(place) => {
                    results = if offsets.is_empty() { result..result + 1 } else { results.start..result + 1 };
                    offsets.push(place as u32);
                }
            }
        }
        assert_eq!(results.len(), offsets.len(), "results of parameters stand together");
        ProductProgram { program, count, coordinates: runs, parameters: (results, offsets) }
    }

    /// Adds the results for some parts, times a factor.
    #[inline(always)]
    fn add(&self, results: &LaneResults<f64>, places: &Places, factor: f64, bars: &mut [ProductBars]) {
        for (k, bar) in bars.iter_mut().enumerate() {
            let first = k * self.count;
            results.add_runs(first, &self.coordinates, &places.nodes, factor, bar.avq);
            let (own, offsets) = &self.parameters;
            results.add_numbers(first + own.start, offsets, &places.parameters, factor, bar.p);
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
}

impl Products {
    /// For parameters that depend on a design variable; the others get no derivative.
    pub fn new(active: &[bool]) -> Self {
        Products {
            elements: [const { None }; Force::KINDS],
            constraints: None,
            active: active.to_vec(),
            work: BatchWork::default(),
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
        let Products { elements, active, work, .. } = self;
        let selections = elements[force.kind()].get_or_insert_with(|| select(batches, &system.element_parts, active));
        for Selection { batch, asked, parts, own, chosen, programs } in selections {
            let batch = &batches[*batch];
            let (layout, n) = (batch.layout, batch.layout.n);
            let all = own.as_ref().unwrap_or(&batch.places);
            chosen.resize_with(chosen.len().max(adjoints.len().div_ceil(TOGETHER)), Chosen::default);
            let pairs = adjoints.chunks(TOGETHER).zip(bars.chunks_mut(TOGETHER));
            for ((adjoints, bars), chosen) in pairs.zip(chosen) {
                let own = programs.entry(adjoints.len() as u32).or_insert_with(|| {
                    let program = element_programs::products(&batch.formula, layout, asked, adjoints.len());
                    ProductProgram::new(program, layout.t(), (system.model.dofs, &all.nodes), |place| match place {
                        place if place < 3 * n => ProductArgument::Coordinate(place / n, place % n),
                        place => ProductArgument::Parameter(place - layout.p()),
                    })
                });
                let weighs = |place: usize| adjoints.iter().any(|own| any(&system.element_parts[parts[place]], &own.f));
                let (count, places) = chosen.places(all, parts.len(), weighs);
                run_lanes(
                    &own.program,
                    count,
                    work,
                    |mut lanes, _| {
                        places.write_elements(&mut lanes, (at, p, t), (force, 1.0));
                        adjoints.iter().for_each(|adjoint| lanes.gather_nodes(&places.nodes, [&adjoint.f]));
                    },
                    |results| own.add(&results, places, sign, bars),
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
        let Products { constraints, active, work, .. } = self;
        let selections = constraints.get_or_insert_with(|| select(batches, &system.constraint_parts, active));
        for Selection { batch, asked: parameters, parts, own, chosen, programs } in selections {
            let batch = &batches[*batch];
            let (physics, layout) = (system.constraint_of(batch), batch.layout);
            let ((asked, scales), factor) = (Asked::part(which, equations, physics.is_nonholonomic()), which.factor());
            let n = layout.n;
            let all = own.as_ref().unwrap_or(&batch.places);
            chosen.resize_with(chosen.len().max(adjoints.len().div_ceil(TOGETHER)), Chosen::default);
            let pairs = adjoints.chunks(TOGETHER).zip(bars.chunks_mut(TOGETHER));
            for ((adjoints, bars), chosen) in pairs.zip(chosen) {
                let code = asked.short_code([false; 3]) * (TOGETHER + 1) as u32 + adjoints.len() as u32;
                let own = programs.entry(code).or_insert_with(|| {
                    let program = constraint_programs::products(physics, asked, parameters, adjoints.len());
                    ProductProgram::new(program, layout.mu(), (system.model.dofs, &all.nodes), |place| match place {
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
                let is_chosen = |place: usize| adjoints.iter().any(|adjoint| weighs(adjoint, parts[place]));
                let (count, places) = chosen.places(all, parts.len(), is_chosen);
                let stabilized = asked.stabilized();
                run_lanes(
                    &own.program,
                    count,
                    work,
                    |mut lanes, _| {
                        places.write_constraints(&mut lanes, (at, p, t), (unknowns, stabilized), scales);
                        for adjoint in adjoints {
                            let reactions = [(&adjoint.f, asked.reactions), (&adjoint.y, asked.reactions && stabilized)];
                            let read = reactions.into_iter().filter(|(_, is_read)| *is_read);
                            read.for_each(|(values, _)| lanes.gather_nodes(&places.nodes, [values]));
                            let equations = [&adjoint.g, &adjoint.g_second].into_iter().zip(asked.equations);
                            let read = equations.filter(|(_, order)| order.is_some());
                            read.for_each(|(values, _)| lanes.gather(&places.multipliers, values));
                        }
                    },
                    |results| own.add(&results, places, factor, bars),
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
    /// Adjoint variables.
    pub adjoints: &'b Adjoints,
    /// Products with the derivatives of elements towards a, v and q.
    pub elements: &'b [f64],
    /// The same of constraints, to which those inside nodes are added.
    pub constraints: &'b mut [f64],
    /// Where reactions add, if they act at another point than the equations hold.
    pub reactions: Option<&'b mut [f64]>,
}

impl System<'_> {
    /// Adds the products with the reactions inside nodes, and those of the equations there, whose adjoints are such that the gradient with
    /// respect to each node's unknowns vanishes along the directions that were eliminated, x_bar + J^T lambda + C^T lambda_local = 0; in
    /// closed form.
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
                let node = UnitNode { all, dofs: four, second: unit.second };
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
    /// h.
    second: f64,
}

impl UnitNode {
    /// What [`System::add_node_products`] does, in a few multiplications.
    fn add_products(&self, equations: &Equations, mu: f64, at: &VectorsAvq<f64>, functionals: &mut [NodeBars]) {
        let UnitNode { all, dofs, second } = self;
        let four = |values: &[f64]| -> [f64; 4] { *values[dofs.start..].first_chunk().expect("four coordinates") };
        let (a, v, q) = (four(&at.a), four(&at.v), four(&at.q));
        let (outer, inner, weights) = (equations.residual, equations.constraint, equations.row_weights());
        let mut row = [0.0; 4];
        for i in 0..4 {
            row[i] = (weights[0] * q[i] + weights[1] * v[i] + weights[2] * a[i]) * second;
        }
        let along = equations.row_scales()[0] * second / dot4(&row, &row);
        for NodeBars { x, adjoints, elements, constraints, reactions, .. } in functionals {
            let places = [dofs.start, all + dofs.start, 2 * all + dofs.start];
            let target = &mut reactions.as_deref_mut().unwrap_or(&mut **constraints)[places[2]..][..4];
            let (x, f) = (four(x), four(&adjoints.f));
            for i in 0..4 {
                target[i] += mu * second * f[i];
            }
            let mut sum = 0.0;
            for i in 0..4 {
                let of = |vector: usize| (elements[places[vector] + i], constraints[places[vector] + i]);
                let (of_a, of_v, of_q) = (of(0), of(1), of(2));
                let rates = outer.gamma * of_a.0 + outer.beta * of_v.0 + (inner.gamma * of_a.1 + inner.beta * of_v.1);
                sum += row[i] * (x[i] + rates + (outer.alpha * of_q.0 + inner.alpha * of_q.1));
            }
            let weight = -sum * along;
            for i in 0..4 {
                let (in_a, in_v, in_q) = (places[0] + i, places[1] + i, places[2] + i);
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
