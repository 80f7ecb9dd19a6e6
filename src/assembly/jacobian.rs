use super::batches::ElementBatch;
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::evaluation::{BatchWork, run_lanes};
use super::gather_map::Starts;
use super::inside_nodes::{CURVATURE, InsideNodes};
use super::lanes::LaneResults;
use super::matrix_values::{MatrixValues, SharedValues};
use super::node_programs;
use super::null_spaces::NullSpaces;
use super::numbering::{ScatterMap, System};
use super::own_parts::{OwnParts, PartsOfRank, PartsOfThreads};
use super::reduction::Columns;
use super::{Adjoints, Equations, Residual, StageCoefficients, TermPoint, Unknowns, VectorsAvq};
use crate::elements::{FormulaWork, RunScalar};
use crate::exchange::digest;
use crate::linalg::{AT_ONCE, Factorization, OwnUnknowns, Owners, Singular, is_shared_by_threads};
use crate::program::Program;
use crate::scalar::larger;
use rayon::prelude::*;
use std::sync::Arc;

/// The matrix of one system at one point, with the bases along which the unknowns of each node move.
///
/// Programs of elements and constraints give N_L^T J N_R of each without J. It takes memory when it is first assembled.
#[derive(Default)]
pub struct Jacobian {
    /// Values in the order of the system's pattern.
    pub values: Vec<f64>,
    bases: NullSpaces,
    point: Point,
    work: BatchWork<f64>,
    /// Elements evaluated so far.
    pub evaluated: usize,
    /// Stresses that a search keeps, less those at its point.
    relief: Relief,
    is_relieved: bool,
    own: Option<PartsOfRank>,
    threads: Option<PartsOfThreads>,
    /// By which ranks that have divided the matrix tell whether it is of the same point.
    mark: f64,
}

/// See [`Jacobian::relieve`].
#[derive(Default)]
struct Relief {
    /// Of all strains, element by element.
    stresses: Vec<f64>,
    /// Where those of an element begin.
    starts: Vec<usize>,
    /// What these stresses add to the multipliers inside nodes.
    local_mu: Vec<f64>,
}

/// Real numbers at which the matrix is assembled.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub at: VectorsAvq<f64>,
    /// Where constraints are evaluated, if that is another point.
    constraint_at: VectorsAvq<f64>,
    has_one_point: bool,
    /// Where reactions act, if that is another one.
    reaction_at: VectorsAvq<f64>,
    pub unknowns: Unknowns<f64>,
}

impl Point {
    /// Where constraints are evaluated.
    pub fn constraint(&self) -> &VectorsAvq<f64> {
        if self.has_one_point { &self.at } else { &self.constraint_at }
    }

    /// Where reactions act.
    pub fn reaction(&self, equations: &Equations) -> &VectorsAvq<f64> {
        if equations.parts_reactions() { &self.reaction_at } else { self.constraint() }
    }

    fn set<S: RunScalar>(&mut self, equations: &Equations, residual: &Residual<S>, unknowns: &Unknowns<S>) {
        let copy = |target: &mut Vec<f64>, values: &[S]| {
            target.clear();
            target.extend(values.iter().map(|value| value.value()));
        };
        // the residual knows where it was evaluated
        self.has_one_point = residual.has_one_point;
        let points = [
            Some((&mut self.at, &residual.at)),
            (!self.has_one_point).then_some((&mut self.constraint_at, residual.constraint_at())),
            equations.parts_reactions().then_some((&mut self.reaction_at, &residual.reaction_at)),
        ];
        for (own, given) in points.into_iter().flatten() {
            copy(&mut own.a, &given.a);
            copy(&mut own.v, &given.v);
            copy(&mut own.q, &given.q);
        }
        // room for systems with two, which may come later
        let VectorsAvq { a, v, q } = &mut self.constraint_at;
        [a, v, q].into_iter().for_each(|list| list.resize(residual.at.q.len(), 0.0));
        copy(&mut self.unknowns.mu, &unknowns.mu);
        copy(&mut self.unknowns.local_mu, &unknowns.local_mu);
    }
}

impl Jacobian {
    /// From now on the stresses in the matrix at the point of `residual` are those that a linear course of all strains along `change` from
    /// the coordinates `before` gives: a bent beam of great axial stiffness is stretched by the correction that bends it, which the next one
    /// takes back without fighting the stress that it makes. Once corrections vanish, so does the difference.
    ///
    /// Source: Magisano, Leonetti, Garcea, Comput. Methods Appl. Mech. Engrg. 313 (2017), "mixed integration points".
    pub fn relieve<S: RunScalar>(
        &mut self,
        system: &System,
        residual: &Residual<S>,
        [before, change]: [&[f64]; 2],
        p: &[f64],
        t: f64,
    ) {
        self.is_relieved = true;
        let relief = &mut self.relief;
        relief.stresses.clear();
        relief.starts.clear();
        let (mut work, mut course) = (FormulaWork::default(), Vec::new());
        let mut forces = vec![0.0; system.model.dofs];
        let mut still = Vec::new();
        for (element, part) in system.model.elements.iter().zip(&system.element_parts) {
            relief.starts.push(relief.stresses.len());
            let Some(formulas) = element.physics.stresses() else { continue };
            let own = || part.segments.iter().flat_map(|dofs| dofs.clone());
            let after = || own().map(|dof| residual.at.q[dof].value());
            let numbers = || p[part.parameters.clone()].iter().copied();
            let places = own().map(|dof| before[dof]).chain(own().map(|dof| change[dof])).chain(after());
            course.clear();
            course.extend_from_slice(work.run(formulas.course.values(), places.chain(numbers()).chain([t])));
            let first = relief.stresses.len();
            relief
                .stresses
                .extend_from_slice(work.run(formulas.deviation.values(), course.iter().copied().chain(numbers())));
            still.clear();
            still.resize(2 * own().count(), 0.0);
            let state = still.iter().copied().chain(after()).chain(numbers()).chain([t]);
            let force = work.run(formulas.force.values(), state.chain(relief.stresses[first..].iter().copied()));
            own().zip(force).for_each(|(dof, force)| forces[dof] += force);
        }
        relief.local_mu.clear();
        relief.local_mu.resize(system.local_equations, 0.0);
        let q: Vec<f64> = residual.constraint_at().q.iter().map(|q| q.value()).collect();
        InsideNodes::default().eliminate(system, &q, &mut forces, &mut relief.local_mu);
    }

    /// Stresses in the matrix are those at its point again.
    pub fn end_relief(&mut self) {
        self.is_relieved = false;
    }

    /// Whether any element has stresses to be relieved.
    pub fn can_relieve(system: &System) -> bool {
        system.model.elements.iter().any(|element| element.physics.has_strains())
    }

    /// From now on only what the rows and columns of this rank's unknowns take is evaluated, or all again. It is for one system.
    pub fn divide(&mut self, unknowns: Option<&Arc<OwnUnknowns>>) {
        if self.own.as_ref().map(|own| Arc::as_ptr(&own.unknowns)) != unknowns.map(Arc::as_ptr) {
            self.own = unknowns.map(PartsOfRank::new);
        }
    }

    /// From now on each thread evaluates what the columns of its unknowns take, or all share every element again. It is for one system.
    pub fn divide_by_threads(&mut self, owners: Option<&Arc<Owners>>) {
        if self.threads.as_ref().map(|own| Arc::as_ptr(&own.owners)) != owners.map(Arc::as_ptr) {
            self.threads = owners.map(PartsOfThreads::new);
        }
    }

    /// Brings the entries of all ranks together, where the matrix is divided.
    pub fn complete(&mut self, system: &System) {
        if let Some(own) = &self.own {
            own.unknowns.complete_all(&mut self.values, &system.pattern);
        }
    }

    /// How many elements this rank evaluates for its rows and columns, where the matrix is divided.
    pub fn own_elements(&self) -> Option<usize> {
        self.own.as_ref()?.elements()
    }

    /// Factors the matrix, all of it or what this rank has.
    ///
    /// # Errors
    /// As for [`Factorization::factor`].
    pub fn factor_in(&mut self, factorization: &mut Factorization) -> Result<(), Singular> {
        match &self.own {
            Some(_) => factorization.factor_own(&mut self.values, self.mark),
            None => factorization.factor(&self.values),
        }
    }

    /// Differentiates the system at the point where `residual` was evaluated last.
    pub fn assemble<S: RunScalar>(
        &mut self,
        system: &System,
        equations: &Equations,
        residual: &Residual<S>,
        unknowns: &Unknowns<S>,
        p: &[f64],
        t: f64,
    ) {
        let mut point = std::mem::take(&mut self.point);
        point.set(equations, residual, unknowns);
        self.bases.set(system, equations, &point);
        if self.own.is_some() {
            let of_constraints: &[f64] = if point.has_one_point { &[] } else { &point.constraint_at.q };
            let lists = [&point.at.a[..], &point.at.v, &point.at.q, of_constraints, &point.unknowns.mu, p, &[t]];
            self.mark = digest(&lists.map(digest));
        }
        self.clear(system);
        let relief = self.is_relieved.then_some(&self.relief);
        for force in [Some(Force::of(equations)), relief.map(|_| Force::Stresses)].into_iter().flatten() {
            self.evaluated += system.element_batches(force).iter().map(|batch| batch.parts.len()).sum::<usize>();
        }
        if let Some(relief) = relief {
            point.unknowns.local_mu.iter_mut().zip(&relief.local_mu).for_each(|(mu, own)| *mu += own);
        }
        let Jacobian { values, bases, work, own, threads, .. } = self;
        let parts = PartsAt { system, equations, point: &point, p, t, bases, relief };
        match (own, threads) {
            (None, Some(threads)) => {
                // SAFETY: each thread adds to the columns of its own unknowns, and each unknown is one thread's.
                let target = unsafe { SharedValues::new(values) };
                threads.threads.par_iter_mut().for_each(|(own, work)| parts.add(Some(own), work, &mut { target }));
            }
            (own, _) => parts.add(own.as_ref().map(|own| &own.parts), work, &mut &mut values[..]),
        }
        self.point = point;
    }

    /// Sets the values to zero; on ranks those that this one has, while others stay any numbers.
    fn clear(&mut self, system: &System) {
        let entries = system.pattern.rows.len();
        if self.values.len() != entries {
            self.values = vec![0.0; entries];
        } else if let Some(own) = &self.own {
            own.entries(&system.pattern).iter().for_each(|own| self.values[own.clone()].fill(0.0));
        } else if is_shared_by_threads(entries) {
            self.values.par_chunks_mut(AT_ONCE).for_each(|values| values.fill(0.0));
        } else {
            self.values.fill(0.0);
        }
    }

    /// Whether the matrix is the same at all states and times, as its programs show: a linear system without constraints.
    pub fn is_constant(system: &System, equations: &Equations) -> bool {
        Self::is_linear(system, Force::of(equations), numbers_of(equations.residual).1)
    }

    /// The same for stages of a motion.
    pub fn is_constant_in_stages(system: &System) -> bool {
        Self::is_linear(system, Force::Residual, [true; 3])
    }

    fn is_linear(system: &System, force: Force, moves: [bool; 3]) -> bool {
        system.constraint_batches().is_empty()
            && system.node_blocks.is_empty()
            && system.element_batches(force).iter().all(|batch| {
                let reads = element_matrix(batch, moves).reads();
                let moving = reads[..batch.layout.p()].contains(&true) || reads[batch.layout.t()];
                !moving && Columns::numbers(&batch.nodes) == 0
            })
    }

    /// The coordinate that moves most with an unknown of a node.
    pub(super) fn leading_dof(&self, system: &System, node: usize, column: usize) -> usize {
        let dofs = system.model.nodes[node].dofs.clone();
        let bases = self.bases.of_node(system, node);
        let size = |i: &usize| bases.direction(*i, column).abs();
        dofs.start + (0..dofs.len()).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(0)
    }

    /// Right-hand side of the matrix: minus the reduced rows of (F, G), derivative part `part` or the value.
    pub fn reduce<S: RunScalar>(&self, system: &System, residual: &Residual<S>, part: Option<usize>, rhs: &mut [f64]) {
        match part {
            None => self.reduce_with(system, residual, |s| s.value(), rhs),
            Some(part) => self.reduce_with(system, residual, |s| s.part(part), rhs),
        }
    }

    #[inline(always)]
    fn reduce_with<S: RunScalar>(&self, system: &System, residual: &Residual<S>, value: impl Fn(S) -> f64, rhs: &mut [f64]) {
        let Residual { f, g, .. } = residual;
        self.bases.restrict_left(system, f, (&value, -1.0), rhs);
        for run in &system.multiplier_runs {
            let own = rhs[run.unknowns()].iter_mut();
            own.zip(&g[run.equations.clone()]).for_each(|(own, &g)| *own = -value(g));
        }
    }

    /// N_L^T f for every node.
    pub fn restrict_left(&self, system: &System, f: &[f64], reduced: &mut [f64]) {
        self.bases.restrict_left(system, f, (|own| own, 1.0), reduced);
    }

    /// N_R^T x for every node.
    pub fn restrict_right(&self, system: &System, x: &[f64], reduced: &mut [f64]) {
        self.bases.restrict_right(system, x, 1.0, reduced);
    }

    /// Right-hand side of the transposed matrix: minus the reduced adjoints (x, mu) of a solution.
    pub fn reduce_adjoint(&self, system: &System, [x, mu]: [&[f64]; 2], rhs: &mut [f64]) {
        self.bases.restrict_right(system, x, -1.0, rhs);
        for run in &system.multiplier_runs {
            rhs[run.unknowns()].iter_mut().zip(&mu[run.equations.clone()]).for_each(|(own, mu)| *own = -mu);
        }
    }

    /// Adjoint variables of the rows of (F, G) from a transposed solution.
    pub fn set_adjoints(&self, system: &System, solution: &[f64], adjoints: &mut Adjoints) {
        let Adjoints { f, g } = adjoints;
        self.bases.prolong_left(system, solution, f);
        // those of equations that are left out stay zero
        let runs = system.multiplier_runs.iter();
        runs.for_each(|run| g[run.equations.clone()].copy_from_slice(&solution[run.unknowns()]));
    }

    /// Adds the step `reduced` to the unknowns: x += N_R z, multipliers directly. Returns the largest |d x|, each times the scale of its
    /// coordinate.
    pub fn add_step<S: RunScalar>(
        &self,
        system: &System,
        reduced: &[f64],
        part: Option<usize>,
        unknowns: &mut Unknowns<S>,
        coordinate_scales: &[f64],
    ) -> f64 {
        match part {
            None => self.add_step_with(system, reduced, S::add_to_value, unknowns, coordinate_scales),
            Some(part) => {
                let add = |target: &mut S, increment: f64| target.add_to_part(part, increment);
                self.add_step_with(system, reduced, add, unknowns, coordinate_scales)
            }
        }
    }

    #[inline(always)]
    fn add_step_with<S: RunScalar>(
        &self,
        system: &System,
        reduced: &[f64],
        add: impl Fn(&mut S, f64),
        unknowns: &mut Unknowns<S>,
        coordinate_scales: &[f64],
    ) -> f64 {
        // maxima that keep NaN, in lanes: in one each would wait for that before
        let mut most = [0.0; LANES];
        let Unknowns { x, mu, .. } = unknowns;
        self.bases.prolong_right(system, reduced, |first, changes| {
            let places = first..first + changes.len();
            let scales = &coordinate_scales[places.clone()];
            for ((place, x), (&dx, scale)) in x[places].iter_mut().enumerate().zip(changes.iter().zip(scales)) {
                add(x, dx);
                most[place % LANES] = larger(most[place % LANES], dx.abs() * scale);
            }
        });
        for run in &system.multiplier_runs {
            let own = mu[run.equations.clone()].iter_mut();
            own.zip(&reduced[run.unknowns()]).for_each(|(own, &step)| add(own, step));
        }
        most.into_iter().fold(0.0, larger)
    }
}

/// Matrices of parts at one point.
struct PartsAt<'j> {
    system: &'j System<'j>,
    equations: &'j Equations,
    point: &'j Point,
    p: &'j [f64],
    t: f64,
    bases: &'j NullSpaces,
    relief: Option<&'j Relief>,
}

impl PartsAt<'_> {
    /// Adds those of all parts, or of some.
    fn add(&self, own: Option<&OwnParts>, work: &mut BatchWork<f64>, target: &mut (impl MatrixValues + Send)) {
        self.add_elements(Force::of(self.equations), own, work, target);
        if self.relief.is_some() {
            self.add_elements(Force::Stresses, own, work, target);
        }
        for (which, place) in self.equations.constraint_terms() {
            self.add_constraints((which, place), own, work, target);
        }
        // a reaction at the start of a step does not move
        if !self.equations.parts_reactions() {
            self.add_curvature(own, work, target);
        }
    }

    fn add_elements(
        &self,
        force: Force,
        own: Option<&OwnParts>,
        work: &mut BatchWork<f64>,
        target: &mut (impl MatrixValues + Send),
    ) {
        let PartsAt { system, point, p, t, .. } = *self;
        let (shift, moves) = numbers_of(self.equations.residual);
        for taken in system.taken_elements(force, own) {
            let (batch, layout) = (taken.parts, taken.whole.layout);
            let program = element_matrix(taken.whole, moves);
            if program.outputs() == 0 {
                continue;
            }
            let weights = layout.extra() - layout.weights();
            let stresses = self.relief.filter(|_| force == Force::Stresses).map(|relief| {
                let places = |&part: &usize| relief.starts[part]..relief.starts[part] + weights;
                (Starts::of_parts(batch.parts.iter().map(places)), &relief.stresses)
            });
            run_lanes(
                program,
                batch.parts.len(),
                work,
                |mut lanes| {
                    batch.places.write_elements(&mut lanes, (&point.at, p, t), (force, 1.0));
                    if let Some((starts, stresses)) = &stresses {
                        lanes.gather(starts, stresses);
                    }
                    shift.into_iter().for_each(|coefficient| lanes.spread(coefficient));
                    lanes.gather_bases(batch, self.bases);
                },
                |results| {
                    let block = |place: usize| taken.block(place, |part| &system.element_blocks[part]);
                    add_entries(&results, block, program.labels(), 1.0, target);
                },
            );
        }
    }

    /// Adds equations, reactions or both of constraints between nodes.
    fn add_constraints(
        &self,
        (which, place): (ConstraintPart, TermPoint),
        own: Option<&OwnParts>,
        work: &mut BatchWork<f64>,
        target: &mut (impl MatrixValues + Send),
    ) {
        let PartsAt { system, equations, point, p, .. } = *self;
        let t = equations.time_at(place, self.t);
        let (shift, mut moves) = numbers_of(equations.constraint);
        let mut at = point.constraint();
        if place == TermPoint::Reactions {
            // a reaction at the start of a step does not move
            (moves, at) = ([false; 3], &point.reaction_at);
        }
        for taken in system.taken_constraints(own) {
            let (batch, physics) = (taken.parts, system.constraint_of(taken.whole));
            let ((asked, scale), factor) = (Asked::of(which, equations, physics), which.factor());
            // behind those of residuals
            let code = asked.short_code(moves) | 1 << 31;
            let make = || constraint_programs::matrix(physics, asked, &batch.nodes, moves);
            let program = taken.whole.programs.get(code, make);
            if program.outputs() == 0 {
                continue;
            }
            run_lanes(
                program,
                batch.parts.len(),
                work,
                |mut lanes| {
                    batch.places.write_constraints(&mut lanes, (at, p, t), &point.unknowns.mu, scale);
                    shift.into_iter().for_each(|coefficient| lanes.spread(coefficient));
                    lanes.gather_bases(batch, self.bases);
                },
                |results| {
                    let block = |place: usize| taken.block(place, |part| &system.constraint_blocks[part]);
                    add_entries(&results, block, program.labels(), factor, target);
                },
            );
        }
    }

    /// Adds the curvature of the reactions inside nodes.
    fn add_curvature(&self, own: Option<&OwnParts>, work: &mut BatchWork<f64>, target: &mut (impl MatrixValues + Send)) {
        let PartsAt { system, equations, point, .. } = *self;
        for taken in system.taken_nodes(own) {
            let batch = taken.parts;
            let make = || node_programs::matrix(system.constraint_inside(taken.whole), &batch.nodes);
            let program = taken.whole.programs.get(CURVATURE, make);
            run_lanes(
                program,
                batch.parts.len(),
                work,
                |mut lanes| {
                    // equations inside nodes are quadratic: their curvature is the same everywhere
                    lanes.skip(batch.formula.inputs + batch.nodes[0].dofs());
                    lanes.gather(&batch.places.multipliers, &point.unknowns.local_mu);
                    lanes.skip(1);
                    lanes.spread(equations.constraint.alpha);
                    lanes.gather_bases(batch, self.bases);
                },
                |results| {
                    let block = |place: usize| taken.block(place, |part| system.block_inside(part));
                    add_entries(&results, block, program.labels(), 1.0, target);
                },
            );
        }
    }
}

/// Maxima that are looked for side by side.
const LANES: usize = 8;

/// The program of the matrices of a batch.
fn element_matrix(batch: &ElementBatch, moves: [bool; 3]) -> &Arc<Program> {
    let code = moves.iter().fold(0, |code, &moves| 2 * code + u32::from(moves));
    batch.programs.get(code, || element_programs::matrix(&batch.formula, batch.layout, &batch.nodes, moves))
}

/// Coefficients of a shift, and which of them are not zero.
pub(super) fn numbers_of(StageCoefficients { gamma, beta, alpha }: StageCoefficients) -> ([f64; 3], [bool; 3]) {
    let all = [gamma, beta, alpha];
    (all, all.map(|coefficient| coefficient != 0.0))
}

/// Adds the entries of blocks, times a factor, to their places in the matrix.
#[inline(always)]
fn add_entries<'b>(
    results: &LaneResults<f64>,
    blocks: impl Fn(usize) -> &'b ScatterMap,
    labels: &[u32],
    factor: f64,
    target: &mut impl MatrixValues,
) {
    // part by part, so that sums have the same order whatever number of parts was evaluated side by side
    results.for_each_part(|part, entries| blocks(part).add(labels, entries, factor, target));
}
