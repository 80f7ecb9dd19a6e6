use super::batches::{BatchWork, run_parts};
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::numbering::{DofMap, System};
use super::residual::LocalVec;
use super::{Equations, Level, Rates, Unknowns, VectorsAvq};
use crate::elements::State;
use crate::program::ProgramCache;
use std::collections::HashMap;
use std::ops::Range;

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
        let second = |n: usize| vec![0.0; if system.options.stabilized { n } else { 0 }];
        Adjoints {
            f: vec![0.0; system.model.dofs],
            y: second(system.model.dofs),
            g: vec![0.0; system.multipliers()],
            g_second: second(system.multipliers()),
            local: vec![0.0; system.local_equations * if system.options.stabilized { 2 } else { 1 }],
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
    /// Adjoint of (a, v, q).
    pub at: &'b mut VectorsAvq<f64>,
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
    programs: ProgramCache,
}

fn select<'p>(parts: impl Iterator<Item = &'p [usize]>, all: &[DofMap], active: &[bool]) -> Vec<Selection> {
    let mut selections: Vec<Selection> = Vec::new();
    for (batch, parts) in parts.enumerate() {
        let mut places: HashMap<&[bool], usize> = HashMap::new();
        for &part in parts {
            let asked = &active[all[part].parameters.clone()];
            let place = *places.entry(asked).or_insert_with(|| {
                selections.push(Selection {
                    batch,
                    asked: asked.to_vec(),
                    parts: Vec::new(),
                    programs: ProgramCache::default(),
                });
                selections.len() - 1
            });
            selections[place].parts.push(part);
        }
    }
    selections
}

/// Where a result of a program goes: the vector (a, v, q or p), the node (behind the last one: the parameters), and the place there.
#[derive(Clone, Copy)]
struct Target {
    vector: usize,
    node: usize,
    place: usize,
}

impl Target {
    /// Of a coordinate of parts whose nodes are like those of this one.
    fn coordinate(vector: usize, like: &DofMap, mut place: usize) -> Self {
        let mut node = 0;
        while place >= like.segments[node].len() {
            place -= like.segments[node].len();
            node += 1;
        }
        Target { vector, node, place }
    }

    fn parameter(like: &DofMap, place: usize) -> Self {
        Target { vector: 3, node: like.segments.len(), place }
    }
}

impl ProductBars<'_> {
    /// Adds the results for one part, times a factor.
    #[inline(always)]
    fn add(&mut self, part: &DofMap, targets: &[Target], results: &[f64], factor: f64) {
        let vectors: [&mut [f64]; 4] = [&mut self.at.a, &mut self.at.v, &mut self.at.q, self.p];
        for (target, &own) in targets.iter().zip(results) {
            let start = part.segments.get(target.node).map_or(part.parameters.start, |dofs| dofs.start);
            vectors[target.vector][start + target.place] += factor * own;
        }
    }
}

/// Functionals whose products share what depends on the state alone.
const TOGETHER: usize = 2;

/// Where the results of a program go, for one functional after the other.
#[derive(Default)]
struct Targets {
    all: Vec<Target>,
    /// Where those of each functional begin, and their end.
    starts: [usize; TOGETHER + 1],
}

impl Targets {
    /// Of the labels of a program: `size` times the number of the functional, and the place of an argument, which `target` finds.
    fn set(&mut self, labels: &[u32], size: usize, target: impl Fn(usize) -> Target) {
        self.all.clear();
        self.all.extend(labels.iter().map(|&label| target(label as usize % size)));
        self.starts = std::array::from_fn(|k| labels.partition_point(|&label| (label as usize) < k * size));
    }

    /// Adds the results for one part, times a factor.
    #[inline(always)]
    fn add(&self, bars: &mut [ProductBars], part: &DofMap, results: &[f64], factor: f64) {
        for (bar, range) in bars.iter_mut().zip(self.starts.windows(2)) {
            let own = range[0]..range[1];
            bar.add(part, &self.all[own.clone()], &results[own], factor);
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
    chosen: Vec<usize>,
    targets: Targets,
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
            targets: Targets::default(),
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
        let Products { elements, active, work, chosen, targets, .. } = self;
        let selections = elements[force.kind()].get_or_insert_with(|| {
            select(batches.iter().map(|batch| batch.parts.as_slice()), &system.element_parts, active)
        });
        for Selection { batch, asked, parts, programs } in selections {
            let (batch, n) = (&batches[*batch], batches[*batch].layout.n);
            let layout = batch.layout;
            let like = &system.element_parts[parts[0]];
            for (adjoints, bars) in adjoints.chunks(TOGETHER).zip(bars.chunks_mut(TOGETHER)) {
                let count = adjoints.len();
                let program =
                    programs.get(count as u32, || element_programs::products(&batch.formula, layout, asked, count));
                targets.set(program.labels(), layout.t(), |place| match place {
                    place if place < 3 * n => Target::coordinate(place / n, like, place % n),
                    place => Target::parameter(like, place - layout.p()),
                });
                chosen.clear();
                let weighs = |part: &&usize| adjoints.iter().any(|own| any(&system.element_parts[**part], &own.f));
                chosen.extend(parts.iter().filter(weighs));
                let part = |index: usize| &system.element_parts[chosen[index]];
                run_parts(
                    &program,
                    chosen.len(),
                    work,
                    |index, lane| {
                        let mut place = layout.write(lane, part(index), (at, p, t), force);
                        for adjoint in adjoints {
                            place = lane.copy_segments(place, part(index), &adjoint.f);
                        }
                    },
                    |index, results| targets.add(bars, part(index), results, sign),
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
        let Products { constraints, active, work, chosen, targets, .. } = self;
        let selections = constraints.get_or_insert_with(|| {
            select(batches.iter().map(|batch| batch.parts.as_slice()), &system.constraint_parts, active)
        });
        for Selection { batch, asked: parameters, parts, programs } in selections {
            let batch = &batches[*batch];
            let (physics, layout) = (system.constraint_of(batch), batch.layout);
            let ((asked, scales), factor) = (Asked::part(which, equations, physics.is_nonholonomic()), which.factor());
            let (like, n) = (&system.constraint_parts[parts[0]], layout.n);
            for (adjoints, bars) in adjoints.chunks(TOGETHER).zip(bars.chunks_mut(TOGETHER)) {
                let count = adjoints.len();
                let code = asked.short_code([false; 3]) * (TOGETHER + 1) as u32 + count as u32;
                let program = programs.get(code, || constraint_programs::products(physics, asked, parameters, count));
                targets.set(program.labels(), layout.mu(), |place| match place {
                    place if place < 2 * n => Target::coordinate(1 + place / n, like, place % n),
                    place if place < layout.t() => Target::parameter(like, place - layout.p()),
                    place => Target::coordinate(0, like, place - layout.a()),
                });
                chosen.clear();
                let weighs = |adjoint: &Adjoints, index: usize| {
                    let (part, rows) = (&system.constraint_parts[index], system.equations_of(index));
                    let nonzero = |values: &[f64]| values.iter().any(|&value| value != 0.0);
                    let equations = nonzero(&adjoint.g[rows.clone()]) || adjoint.g_second.get(rows).is_some_and(nonzero);
                    (asked.reactions && (any(part, &adjoint.f) || any(part, &adjoint.y)))
                        || (asked.equations[0].is_some() && equations)
                };
                chosen.extend(parts.iter().filter(|&&index| adjoints.iter().any(|adjoint| weighs(adjoint, index))));
                let part = |index: usize| &system.constraint_parts[chosen[index]];
                run_parts(
                    &program,
                    chosen.len(),
                    work,
                    |index, lane| {
                        let part = part(index);
                        let rows = system.equations_of(chosen[index]);
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
                    |index, results| targets.add(bars, part(index), results, factor),
                );
            }
        }
    }
}

/// Whether any number of a part's coordinates is not zero.
fn any(part: &DofMap, values: &[f64]) -> bool {
    part.segments.iter().any(|dofs| values.get(dofs.clone()).is_some_and(|own| own.iter().any(|&value| value != 0.0)))
}

impl System<'_> {
    /// Adds the gradient of what the adjoints of constraints inside nodes weigh, in closed form: reactions, or with `with_equations` their
    /// equations.
    pub fn add_local_products(
        &self,
        with_equations: bool,
        equations: &Equations,
        adjoint: &Adjoints,
        unknowns: &Unknowns<f64>,
        at: &VectorsAvq<f64>,
        bar: &mut VectorsAvq<f64>,
    ) {
        let (scales, mut rows) = (equations.row_scales(), Vec::new());
        for local in self.eliminated() {
            let dofs = self.model.nodes[local.node].dofs.clone();
            let own = local.equations.clone();
            if !with_equations {
                let target = &mut bar.q[dofs.clone()];
                local.form.add_curvature(&unknowns.local_mu[own.clone()], &adjoint.f[dofs.clone()], 1.0, target);
                if let (Some(eta), Some(lambda)) = (unknowns.local_eta.get(own), adjoint.y.get(dofs)) {
                    local.form.add_curvature(eta, lambda, -1.0, target);
                }
                continue;
            }
            rows.clear();
            rows.resize(own.len() * dofs.len(), Rates::zero());
            let state = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
            local.form.moving_rows(state, &mut rows);
            for (row, equation) in rows.chunks_exact(dofs.len()).zip(own) {
                let second = adjoint.local.get(equation + self.local_equations).copied().unwrap_or(0.0);
                let weights = [adjoint.local[equation] * scales[0], second * scales[1]];
                add_row(equations.level, row, weights, std::slice::from_ref(&dofs), bar);
            }
        }
    }

    /// Sets the adjoints of the equations inside nodes so that the gradient with respect to each node's unknowns vanishes along
    /// the directions that were eliminated: x_bar + (J^T lambda) + C^T lambda_local = 0, given the left part in (x, y).
    pub fn set_local_adjoints(
        &self,
        equations: &Equations,
        at: &VectorsAvq<f64>,
        unbalanced_x: &[f64],
        unbalanced_y: &[f64],
        adjoints: &mut Adjoints,
    ) {
        for local in self.eliminated() {
            let dofs = self.model.nodes[local.node].dofs.clone();
            let state = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
            let rows = super::local::equation_rows(local, equations, state);
            let mut unbalanced: LocalVec<f64> = unbalanced_x[dofs.clone()].into();
            if let Some(y) = unbalanced_y.get(dofs) {
                unbalanced.extend_from_slice(y);
            }
            let count = rows.len() / unbalanced.len();
            let multipliers = super::local::least_squares(&rows, count, &unbalanced);
            let own = local.equations.len();
            adjoints.local[local.equations.clone()].copy_from_slice(&multipliers[..own]);
            if count > own {
                let start = self.local_equations + local.equations.start;
                adjoints.local[start..start + own].copy_from_slice(&multipliers[own..]);
            }
        }
    }
}

/// Adds the scaled weights of the one or two equations of a level times their gradients, given the row A along the motion.
fn add_row(
    level: Level,
    row: &[Rates<f64>],
    [first, second]: [f64; 2],
    segments: &[Range<usize>],
    bar: &mut VectorsAvq<f64>,
) {
    if [first, second] == [0.0; 2] {
        return;
    }
    for (dof, a) in segments.iter().cloned().flatten().zip(row) {
        match level {
            Level::Position => bar.q[dof] += first * a.value,
            Level::Velocity => {
                bar.v[dof] += first * a.value;
                bar.q[dof] += first * a.first;
            }
            Level::Acceleration => {
                bar.a[dof] += first * a.value;
                bar.v[dof] += 2.0 * first * a.first;
                bar.q[dof] += first * a.second;
            }
            Level::Stabilized => {
                bar.v[dof] += second * a.value;
                bar.q[dof] += first * a.value + second * a.first;
            }
        }
    }
}
