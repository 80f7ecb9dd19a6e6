// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]
// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod symmetric;

pub use symmetric::Signs;

#[cfg(feature = "mumps")]
use super::MumpsLu;
use super::column_groups::{AT_ONCE, is_shared_by_threads};
use super::multifrontal::{MultifrontalLu, largest};
use super::scaling::{Scaling, largest_finite};
use super::simd::multiply_add;
use super::{DenseLu, Kernel, LinearSolver, OwnUnknowns, Owners, Singular, dispatch};
use crate::exchange::digest;
use crate::linalg::SparsePattern;
use crate::scalar::larger;
use crate::tolerances::{NOTHING, ROUND_OFF};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Which solver factors the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Backend {
    /// Dense up to 8 unknowns, multifrontal above.
    #[default]
    Automatic,
    /// Dense LU.
    Dense,
    /// Sparse LU of dense fronts, with pivots searched in each.
    Multifrontal,
    /// MUMPS, which ranks share where they would share the own solver; not the same bits on any number of them.
    #[cfg(feature = "mumps")]
    Mumps,
}

impl Backend {
    /// All, the choice by size first.
    pub const ALL: [Backend; if cfg!(feature = "mumps") { 4 } else { 3 }] = [
        Backend::Automatic,
        Backend::Dense,
        Backend::Multifrontal,
        #[cfg(feature = "mumps")]
        Backend::Mumps,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Backend::Automatic => "automatic",
            Backend::Dense => "dense",
            Backend::Multifrontal => "multifrontal",
            #[cfg(feature = "mumps")]
            Backend::Mumps => "mumps",
        }
    }
}

/// A solver and what its factorizations take, known before the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverPlan {
    /// The solver; never [`Backend::Automatic`].
    pub backend: Backend,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Entries of the matrix.
    pub entries: usize,
    /// Multiplications of a factorization and entries of L and U, where the analysis tells.
    pub work: Option<Work>,
    /// Ranks that share each system.
    pub ranks: usize,
    /// The order of elimination that MUMPS took, where it is the solver.
    pub ordering: Option<&'static str>,
}

/// What a factorization takes by its analysis, as if no pivot had to wait for another front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Multiplications of the elimination.
    pub multiplications: f64,
    /// Entries of L and U, each of which a solution multiplies by once.
    pub fill: usize,
}

/// Of a solver that nobody shares.
fn plan(pattern: &SparsePattern, backend: Backend, work: Work) -> SolverPlan {
    let (unknowns, entries) = (pattern.size, pattern.rows.len());
    SolverPlan { backend, unknowns, entries, work: Some(work), ranks: 1, ordering: None }
}

/// Largest number of unknowns of a small system: above, what the tree of fronts saves is more than it costs.
const SMALL: usize = 8;

/// Right-hand sides that meet an entry of the matrix at a time.
const TOGETHER: usize = 8;

/// Largest change of a transposed solution by its last refinement, as a share of the solution: that of the first is about what round-off makes
/// of the condition of the matrix, and each further one is smaller by as much.
const SETTLED: f64 = 1e-4;

/// Refinements with own factors: one unless it changes too much.
const MOST_REFINEMENTS: usize = 4;

/// Componentwise backward error at which a solution with the factors of other values is as good as one with its own.
///
/// Source: Arioli, Demmel, Duff, SIAM J. Matrix Anal. Appl. 10 (1989), "Solving sparse linear systems with sparse backward error".
const BACKWARD_ERROR: f64 = 2.0 * f64::EPSILON;

/// Share of the largest unknown below which a sum of terms is measured by it.
const NEXT_TO_NOTHING: f64 = 1e-10;

/// Multiplications of a factorization for each entry of L and U that take as long as a refinement.
const MULTIPLICATIONS_PER_ENTRY: f64 = 20.0;

/// What became of transposed right-hand sides.
#[must_use = "right-hand sides are no solutions where kept factors do not serve"]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransposedSolution {
    /// They were replaced by solutions.
    Found,
    /// They are as they were: factors of other values, which were kept, do not serve, and the values are to be factored first.
    NeedsFactors,
}

/// Values of a matrix.
enum Values<'v> {
    /// All of them.
    Whole(&'v [f64]),
    /// The rows and columns of this rank's own unknowns.
    Own(&'v mut [f64], Arc<OwnUnknowns>),
}

/// A factored matrix: scaled to a diagonal of size 1 by powers of two, with refinement against the matrix itself.
pub struct Factorization {
    pattern: Arc<SparsePattern>,
    plan: SolverPlan,
    solver: Box<dyn LinearSolver>,
    scaled: Vec<f64>,
    scaling: Scaling,
    /// Unknowns of each rank, where some share each system.
    own: Option<Arc<OwnUnknowns>>,
    /// To which thread each unknown belongs, where several share the work.
    threads: Option<Arc<Owners>>,
    /// Largest of the values given last.
    largest: f64,
    /// Whether unknowns that multipliers tie to far stiffer ones count as weak.
    refined_scaling: bool,
    /// Right-hand sides of a transposed solution, and corrections of it.
    given: Vec<f64>,
    correction: Vec<f64>,
    checked: bool,
    /// Whether a matrix that is nearly singular is refused.
    examines: bool,
    /// Backward errors of solutions, and their numbers side by side.
    errors: Vec<f64>,
    beside: Vec<f64>,
    /// Whether there are factors.
    has_factors: bool,
    /// Whether the factors are those of other values than the scaled ones.
    is_stale: bool,
}

impl Factorization {
    /// Analyses a pattern.
    ///
    /// # Errors
    /// [`Singular`] if no values could make the pattern regular.
    pub fn new(pattern: &Arc<SparsePattern>, backend: Backend) -> Result<Self, Singular> {
        let n = pattern.size;
        Ok(match backend {
            #[cfg(feature = "mumps")]
            Backend::Mumps => {
                let solver = MumpsLu::new(pattern, MultifrontalLu::new(pattern, 1))?;
                let work = Work { multiplications: 0.5 * solver.operations(), fill: solver.entries() as usize };
                let (ranks, own) = (solver.own().ranks(), solver.own().own_unknowns().map(Arc::new));
                let plan = SolverPlan { ranks, ordering: Some(solver.ordering()), ..plan(pattern, backend, work) };
                let scaling = Scaling::new(pattern.clone(), own.as_deref());
                Self::of(Box::new(solver), plan, pattern.clone(), scaling, (own, None))
            }
            Backend::Multifrontal | Backend::Automatic if n > SMALL || backend == Backend::Multifrontal => {
                Self::of_multifrontal(MultifrontalLu::new(pattern, rayon::current_num_threads()), pattern)
            }
            _ => {
                let work = Work { multiplications: (n as f64).powi(3) / 3.0, fill: n * n };
                let (solver, scaling) = (Box::new(DenseLu::new(pattern)), Scaling::new(pattern.clone(), None));
                Self::of(solver, plan(pattern, Backend::Dense, work), pattern.clone(), scaling, (None, None))
            }
        })
    }

    /// The same for matrices that may be nearly singular: inverse iterations want them so.
    pub fn unexamined(self) -> Self {
        Factorization { examines: false, ..self }
    }

    pub(super) fn of_multifrontal(solver: MultifrontalLu, pattern: &Arc<SparsePattern>) -> Self {
        let analysis = solver.analysis();
        let work = Work { multiplications: 0.5 * analysis.flops, fill: analysis.entries };
        let plan = SolverPlan { ranks: solver.ranks(), ..plan(pattern, Backend::Multifrontal, work) };
        let (own, threads) = (solver.own_unknowns().map(Arc::new), solver.thread_owners().map(Arc::new));
        let scaling = Scaling::new(pattern.clone(), own.as_deref());
        Self::of(Box::new(solver), plan, pattern.clone(), scaling, (own, threads))
    }

    fn of(
        solver: Box<dyn LinearSolver>,
        plan: SolverPlan,
        pattern: Arc<SparsePattern>,
        scaling: Scaling,
        (own, threads): (Option<Arc<OwnUnknowns>>, Option<Arc<Owners>>),
    ) -> Self {
        Factorization {
            own,
            threads,
            plan,
            solver,
            scaled: Vec::new(),
            scaling,
            largest: 0.0,
            refined_scaling: false,
            pattern,
            given: Vec::new(),
            correction: Vec::new(),
            checked: false,
            examines: true,
            errors: Vec::new(),
            beside: Vec::new(),
            has_factors: false,
            is_stale: false,
        }
    }

    /// Another one for the same pattern that has factored nothing yet.
    ///
    /// # Errors
    /// As for [`Factorization::new`].
    pub fn clone_analysis(&self) -> Result<Self, Singular> {
        let Some(solver) = self.solver.clone_analysis() else { return Factorization::new(&self.pattern, self.plan.backend) };
        let owners = (self.own.clone(), self.threads.clone());
        Ok(Self::of(solver, self.plan, self.pattern.clone(), self.scaling.clone_analysis(), owners))
    }

    /// Factors values given in the order of the pattern; the first ones are examined for singularity.
    ///
    /// # Errors
    /// [`Singular`] with the unknown that the matrix does not determine.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.check_finite(values, || digest(values))?;
        self.factor_finite(&mut Values::Whole(values))
    }

    /// The same for values of which each rank has the rows and columns of its own unknowns, and any numbers besides; all have the same mark. Some
    /// rows and columns of others are added.
    ///
    /// # Errors
    /// As for [`Factorization::factor`], on all ranks.
    pub fn factor_own(&mut self, values: &mut [f64], mark: f64) -> Result<(), Singular> {
        self.check_finite(values, || mark)?;
        match self.own.clone() {
            Some(own) => self.factor_finite(&mut Values::Own(values, own)),
            None => self.factor_finite(&mut Values::Whole(values)),
        }
    }

    /// Unknowns of each rank, where some share each system.
    pub fn own_unknowns(&self) -> Option<&Arc<OwnUnknowns>> {
        self.own.as_ref()
    }

    /// To which thread each unknown belongs, where several share the work.
    pub fn thread_owners(&self) -> Option<&Arc<Owners>> {
        self.threads.as_ref()
    }

    fn factor_finite(&mut self, values: &mut Values) -> Result<(), Singular> {
        (self.is_stale, self.has_factors) = (false, false);
        let factored = self.factor_scaled(values);
        if factored.is_ok() || self.refined_scaling {
            self.has_factors = factored.is_ok();
            return factored;
        }
        self.refined_scaling = true;
        let again = self.factor_scaled(values);
        self.refined_scaling = again.is_ok();
        self.has_factors = again.is_ok();
        again.or(factored)
    }

    fn factor_scaled(&mut self, values: &mut Values) -> Result<(), Singular> {
        let values = match values {
            Values::Whole(values) => {
                self.scaling.set(values, self.largest, self.refined_scaling);
                *values
            }
            Values::Own(values, own) => {
                self.scaling.set_own(values, self.largest, self.refined_scaling, own);
                &**values
            }
        };
        self.scaled.resize(values.len(), 0.0);
        self.scaling.apply_to_own(values, &mut self.scaled);
        self.solver.factor(&self.scaled)?;
        if self.examines && !self.checked {
            self.examine()?;
            self.checked = true;
        }
        Ok(())
    }

    /// Scales the next values with such care, whatever came before them.
    pub fn reset_scaling(&mut self, refined_scaling: bool) {
        self.checked &= refined_scaling || !self.refined_scaling;
        self.refined_scaling = refined_scaling;
    }

    /// Whether the values factored last needed care: unknowns that multipliers tie to far stiffer ones count as weak.
    pub fn refined_scaling(&self) -> bool {
        self.refined_scaling
    }

    /// Keeps the factors of other values for those given now, if there are any: [`Factorization::solve_transposed`] refines solutions by these
    /// values, and tells where that would take too many refinements. Returns whether there are.
    ///
    /// # Errors
    /// [`Singular`] with the column of a value that is not a number.
    pub fn keep_factors(&mut self, values: &[f64]) -> Result<bool, Singular> {
        self.check_finite(values, || 0.0)?;
        if self.has_factors {
            self.is_stale = true;
            self.scaling.apply_to_own(values, &mut self.scaled);
        }
        Ok(self.has_factors)
    }

    /// # Errors
    /// [`Singular`] with the column of a value that is not a number.
    fn check_finite(&mut self, values: &[f64], mark: impl FnOnce() -> f64) -> Result<(), Singular> {
        if let Some(own) = &self.own {
            let (mut largest, mut first) = (0.0, None);
            for &column in own.own() {
                match largest_finite(&values[self.entries(column as usize)]) {
                    Some(size) => largest = larger(largest, size),
                    None => first = first.or(Some(column as usize)),
                }
            }
            let (largest, first) = own.agree(largest, first, mark());
            self.largest = largest;
            return first.map_or(Ok(()), |unknown| Err(Singular { unknown }));
        }
        let all = match is_shared_by_threads(values.len()) {
            true => values.par_chunks(AT_ONCE).map(largest_finite).try_reduce(|| 0.0, |a, b| Some(larger(a, b))),
            false => largest_finite(values),
        };
        if let Some(largest) = all {
            self.largest = largest;
            return Ok(());
        }
        let finite = |column: &usize| values[self.entries(*column)].iter().all(|value| value.is_finite());
        Err(Singular { unknown: (0..self.pattern.size).take_while(finite).count() })
    }

    /// The solver and what a factorization takes.
    pub fn plan(&self) -> SolverPlan {
        self.plan
    }

    /// Looks for a vector that A^-1 enlarges beyond all measure.
    ///
    /// # Errors
    /// [`Singular`] with the largest entry of that vector: the unknown that the matrix leaves free.
    pub fn examine(&mut self) -> Result<(), Singular> {
        // two steps of inverse iteration from a vector without symmetry
        let mut x: Vec<f64> = (0..self.pattern.size).map(|i| 1.0 + 0.3 * ((i * 7919 % 101) as f64 / 101.0)).collect();
        for _ in 0..2 {
            let norm = x.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            x.iter_mut().for_each(|x| *x /= norm);
            self.solver.solve(&mut x);
            let largest = (0..x.len()).max_by(|&i, &j| x[i].abs().total_cmp(&x[j].abs()));
            if let Some(unknown) = largest
                && !(x[unknown].abs() < 1.0 / ROUND_OFF)
            {
                return Err(Singular { unknown });
            }
        }
        Ok(())
    }

    /// Replaces b by A^-1 b.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        for (b, scale) in rhs.iter_mut().zip(&self.scaling.rows) {
            *b *= scale;
        }
        self.solver.solve(rhs);
        for (x, scale) in rhs.iter_mut().zip(&self.scaling.columns) {
            *x *= scale;
        }
    }

    /// Replaces right-hand sides, one after the other, by the columns of A^-T B, where A has the values given last, to the factorization or to
    /// [`Factorization::keep_factors`]: adjoint variables are not corrected by a later iteration, so they are refined against the matrix.
    ///
    /// # Errors
    /// [`Singular`] where refinement still changes leading digits; the solutions are there all the same.
    pub fn solve_transposed(&mut self, rhs: &mut [f64]) -> Result<TransposedSolution, Singular> {
        let n = self.pattern.size.max(1);
        let (mut given, mut correction) = (std::mem::take(&mut self.given), std::mem::take(&mut self.correction));
        given.clear();
        given.extend_from_slice(rhs);
        correction.resize(rhs.len(), 0.0);
        let mut outcome = Ok(TransposedSolution::Found);
        if self.is_stale {
            if !self.refine_stale(&given, rhs, &mut correction) {
                rhs.copy_from_slice(&given);
                outcome = Ok(TransposedSolution::NeedsFactors);
            }
        } else {
            let unsettled = self.refine_own(&given, rhs, &mut correction);
            outcome = unsettled.map_or(outcome, |unknown| Err(Singular { unknown }));
        }
        (self.given, self.correction) = (given, correction);
        if outcome != Ok(TransposedSolution::NeedsFactors) {
            for rhs in rhs.chunks_exact_mut(n) {
                rhs.iter_mut().zip(&self.scaling.rows).for_each(|(x, scale)| *x *= scale);
            }
        }
        outcome
    }

    /// Solves with the factors of the values themselves, and refines; returns an unknown whose leading digits still change, if there is one.
    fn refine_own(&mut self, given: &[f64], x: &mut [f64], correction: &mut [f64]) -> Option<usize> {
        let n = self.pattern.size.max(1);
        self.set_scaled_rhs(given, x);
        self.solver.solve_transposed(x);
        let mut unsettled = None;
        for _ in 0..MOST_REFINEMENTS {
            self.set_residual::<false>(given, x, correction);
            self.solver.solve_transposed(correction);
            unsettled = None;
            for (x, change) in x.chunks_exact_mut(n).zip(correction.chunks_exact(n)) {
                let [size, moved] = dispatch(Correction { x, change });
                let most = (SETTLED * size).max(NOTHING);
                // what is no number comes with the right-hand side
                if moved > most {
                    unsettled = unsettled.or(change.iter().position(|change| change.abs() > most));
                }
            }
            if unsettled.is_none() {
                break;
            }
        }
        unsettled
    }

    /// Writes right-hand sides of transposed solutions in the scales of now.
    fn set_scaled_rhs(&self, given: &[f64], scaled: &mut [f64]) {
        let n = self.pattern.size.max(1);
        for (given, scaled) in given.chunks_exact(n).zip(scaled.chunks_exact_mut(n)) {
            let all = scaled.iter_mut().zip(given.iter().zip(&self.scaling.columns));
            all.for_each(|(scaled, (b, scale))| *scaled = b * scale);
        }
    }

    /// Solves with the factors of other values and refines until the backward error is that of own factors; false where that is not near.
    fn refine_stale(&mut self, given: &[f64], x: &mut [f64], correction: &mut [f64]) -> bool {
        let n = self.pattern.size.max(1);
        // right-hand sides are refined each, and factored for once
        let count = (given.len() / n).max(1) as f64;
        let by_work = |work: Work| work.multiplications / work.fill.max(1) as f64 / MULTIPLICATIONS_PER_ENTRY;
        let most = 2.0 + self.plan.work.map_or(0.0, by_work) / count;
        self.set_scaled_rhs(given, x);
        self.solver.solve_transposed(x);
        let (mut refinements, mut previous) = (0.0, 1.0);
        loop {
            self.set_residual::<true>(given, x, correction);
            let error = self.errors.iter().copied().fold(0.0, larger);
            if error <= BACKWARD_ERROR {
                return true;
            }
            let rate: f64 = error / previous;
            let further = if rate < 1.0 { (BACKWARD_ERROR / error).ln() / rate.ln() } else { f64::INFINITY };
            if !(refinements + further <= most) {
                return false;
            }
            self.solver.solve_transposed(correction);
            x.iter_mut().zip(&*correction).for_each(|(x, correction)| *x += correction);
            (refinements, previous) = (refinements + 1.0, error);
        }
    }

    /// R = B - A^T X with the scaled matrix, for right-hand sides that are given unscaled; if they are `MEASURED` sets the errors, the largest
    /// componentwise backward error |r| / (|A^T| |x| + |b|) of each column, where what is next to nothing beside the largest unknown counts
    /// by that one: in a motion in a plane, all that leaves it is round-off.
    fn set_residual<const MEASURED: bool>(&mut self, given: &[f64], x: &[f64], r: &mut [f64]) {
        let n = self.pattern.size.max(1);
        self.errors.clear();
        let all = given.chunks(TOGETHER * n).zip(x.chunks(TOGETHER * n)).zip(r.chunks_mut(TOGETHER * n));
        for ((given, x), r) in all {
            match x.len() / n {
                1 => self.set_residual_columns::<MEASURED, 1>(given, x, r),
                2 => self.set_residual_columns::<MEASURED, 2>(given, x, r),
                3 | 4 => self.set_residual_columns::<MEASURED, 4>(given, x, r),
                _ => self.set_residual_columns::<MEASURED, TOGETHER>(given, x, r),
            }
        }
    }

    /// The same for `W` columns or fewer, whose numbers are laid side by side.
    fn set_residual_columns<const MEASURED: bool, const W: usize>(&mut self, given: &[f64], x: &[f64], r: &mut [f64]) {
        let Factorization { pattern, scaled, scaling, beside, errors, own, threads, .. } = self;
        let (n, columns) = (pattern.size, x.len() / pattern.size);
        beside.resize(n * W, 0.0);
        let (rows, _) = beside.as_chunks_mut::<W>();
        let mut least = [0.0; W];
        for (w, (x, least)) in x.chunks_exact(n).zip(&mut least).enumerate() {
            rows.iter_mut().zip(x).for_each(|(row, &x)| row[w] = x);
            *least = if MEASURED { NEXT_TO_NOTHING * largest(x) } else { 0.0 };
        }
        if columns < W {
            rows.iter_mut().for_each(|row| row[columns..].fill(0.0));
        }
        let scales = &scaling.columns;
        let (own, beside) = (own.as_deref(), &*rows);
        let of = |numbers: Range<usize>, r: &mut [f64]| {
            dispatch(Residuals::<MEASURED, W> { pattern, scaled, scales, beside, least, given, numbers, r, own })
        };
        let worst = match (own, threads) {
            (Some(own), _) => {
                let mut worst = of(0..n, r);
                own.gather_columns(r, &mut worst);
                worst
            }
            (None, None) => of(0..n, r),
            (None, Some(threads)) => {
                let length = n.div_ceil(threads.count());
                let begins = (0..n).step_by(length);
                let ranges: Vec<Range<usize>> = begins.map(|begin| begin..n.min(begin + length)).collect();
                let mut apart: Vec<Vec<f64>> = ranges.iter().map(|own| vec![0.0; columns * own.len()]).collect();
                let all = ranges.par_iter().zip(&mut apart).map(|(own, r)| of(own.clone(), r));
                let worst = all.reduce(|| [0.0; W], |a, b| std::array::from_fn(|w| larger(a[w], b[w])));
                for (own, apart) in ranges.iter().zip(&apart) {
                    let columns = r.chunks_exact_mut(n).zip(apart.chunks_exact(own.len()));
                    columns.for_each(|(r, apart)| r[own.clone()].copy_from_slice(apart));
                }
                worst
            }
        };
        errors.extend(&worst[..columns]);
    }

    /// What unknowns are divided by to be in the scale of the matrix factored last: powers of two.
    pub fn scales(&self) -> &[f64] {
        &self.scaling.columns
    }

    fn entries(&self, column: usize) -> std::ops::Range<usize> {
        self.pattern.column_starts[column]..self.pattern.column_starts[column + 1]
    }
}

/// r = b - A^T x for some columns, at most `W`; gives their backward errors where these are `MEASURED`.
struct Residuals<'f, const MEASURED: bool, const W: usize> {
    pattern: &'f SparsePattern,
    scaled: &'f [f64],
    /// By which b is the given one.
    scales: &'f [f64],
    /// Numbers of x, side by side; zero where there are fewer columns.
    beside: &'f [[f64; W]],
    /// What terms of each column count for at least.
    least: [f64; W],
    given: &'f [f64],
    /// Which numbers of each column, and r of them.
    numbers: Range<usize>,
    r: &'f mut [f64],
    /// Where ranks share the columns of the matrix, each computes the numbers of its own.
    own: Option<&'f OwnUnknowns>,
}

impl<const MEASURED: bool, const W: usize> Kernel for Residuals<'_, MEASURED, W> {
    type Output = [f64; W];
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [f64; W] {
        let Residuals { pattern, scaled, scales, beside, least, given, numbers, r, own } = self;
        let (n, length) = (pattern.size, numbers.len());
        let columns = r.len() / length;
        let mut worst = [0.0_f64; W];
        let own = own.map(OwnUnknowns::own);
        for number in 0..own.map_or(length, <[u32]>::len) {
            let column = own.map_or(numbers.start + number, |own| own[number] as usize);
            let own = pattern.column_starts[column]..pattern.column_starts[column + 1];
            // sums of every other entry do not wait for each other
            let [mut sums, mut sizes] = [[[0.0_f64; W]; 2]; 2];
            let (pairs, last) = scaled[own.clone()].as_chunks::<2>();
            let (rows, last_row) = pattern.rows[own].as_chunks::<2>();
            for (entries, rows) in pairs.iter().zip(rows) {
                for which in 0..2 {
                    let x = &beside[rows[which] as usize];
                    add_terms::<MEASURED, FUSED, W>(&mut sums[which], &mut sizes[which], entries[which], x);
                }
            }
            if let ([entry], [row]) = (last, last_row) {
                add_terms::<MEASURED, FUSED, W>(&mut sums[0], &mut sizes[0], *entry, &beside[*row as usize]);
            }
            for w in 0..columns.min(W) {
                let (place, sum) = (column - numbers.start + w * length, sums[0][w] + sums[1][w]);
                let b = given[column + w * n] * scales[column];
                r[place] = b - sum;
                if MEASURED && r[place] != 0.0 {
                    let size = sizes[0][w] + sizes[1][w] + b.abs();
                    worst[w] = larger(worst[w], r[place].abs() / size.max(least[w]).max(NOTHING));
                }
            }
        }
        worst
    }
}

/// x += change; gives the largest absolute values of both, not counting what is no number.
struct Correction<'f> {
    x: &'f mut [f64],
    change: &'f [f64],
}

impl Kernel for Correction<'_> {
    type Output = [f64; 2];
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> [f64; 2] {
        self.x.iter_mut().zip(self.change).for_each(|(x, change)| *x += change);
        [largest(self.x), largest(self.change)]
    }
}

/// sums += entry x, and sizes += |entry x|.
#[inline(always)]
fn add_terms<const MEASURED: bool, const FUSED: bool, const W: usize>(
    sums: &mut [f64; W],
    sizes: &mut [f64; W],
    entry: f64,
    x: &[f64; W],
) {
    for w in 0..W {
        sums[w] = multiply_add::<FUSED>(entry, x[w], sums[w]);
        if MEASURED {
            sizes[w] += (entry * x[w]).abs();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::multifrontal::test_matrices::{Noise, chain, difference, dominant};
    use super::*;

    /// A factored chain, its values, right-hand sides of two columns.
    fn factored() -> (Factorization, Vec<f64>, Vec<f64>) {
        let (mut noise, pattern) = (Noise(7), Arc::new(chain(12)));
        let values = dominant(&mut noise, &pattern);
        let rhs = noise.vector(2 * pattern.size);
        let mut factorization = Factorization::new(&pattern, Backend::Multifrontal).unwrap();
        factorization.factor(&values).unwrap();
        (factorization, values, rhs)
    }

    /// Solutions with factors of its own.
    fn solved(like: &Factorization, values: &[f64], rhs: &[f64]) -> Vec<f64> {
        let mut own = like.clone_analysis().unwrap();
        own.factor(values).unwrap();
        let mut x = rhs.to_vec();
        assert_eq!(own.solve_transposed(&mut x), Ok(TransposedSolution::Found));
        x
    }

    #[test]
    fn factors_of_a_matrix_beside_serve_and_those_of_another_one_do_not() {
        let (mut factorization, values, rhs) = factored();
        for (change, serve) in [(1e-9, true), (1e-6, true), (1e-2, false), (5.0, false)] {
            let other: Vec<f64> = values.iter().enumerate().map(|(i, v)| v * (1.0 + change * (i as f64).sin())).collect();
            let mut x = rhs.clone();
            factorization.factor(&values).unwrap();
            assert_eq!(factorization.keep_factors(&other), Ok(true));
            let expected = if serve { TransposedSolution::Found } else { TransposedSolution::NeedsFactors };
            assert_eq!(factorization.solve_transposed(&mut x), Ok(expected), "a change by {change}");
            if !serve {
                assert_eq!(x, rhs);
                factorization.factor(&other).unwrap();
                assert_eq!(factorization.solve_transposed(&mut x), Ok(TransposedSolution::Found));
            }
            let away = difference(&x, &solved(&factorization, &other, &rhs));
            assert!(away <= 1e-14, "a change by {change}: {away:e}");
        }
    }

    #[test]
    fn entries_that_are_round_off_make_no_scales() {
        // stiffness of the first unknown alone; multipliers tie it to the third, and the third to the second, which has an entry in the
        // first equation, too, of the size of the cosine of a right angle
        let entries = [(0, 0, 1.0), (3, 0, 1.0), (3, 1, 6e-17), (3, 2, 1.0), (4, 1, 1.0), (4, 2, 1.0)];
        let both = entries.iter().flat_map(|&(i, j, _)| [(i, j), (j, i)]).collect();
        let pattern = Arc::new(SparsePattern::from_entries(5, both));
        let mut values = vec![0.0; pattern.rows.len()];
        for (i, j, value) in entries {
            for (i, j) in [(i, j), (j, i)] {
                values[pattern.position(i, j).unwrap()] = value;
            }
        }
        for backend in [Backend::Dense, Backend::Multifrontal] {
            let mut factorization = Factorization::new(&pattern, backend).unwrap();
            factorization.factor(&values).unwrap();
            // x0 = 1 under a unit force, x2 = -1, x1 = 1, with the reactions that this takes
            let mut x = [1.0, 0.0, 0.0, 0.0, 0.0];
            factorization.solve(&mut x);
            assert!(x.iter().zip([1.0, 1.0, -1.0, 0.0, 0.0]).all(|(x, right)| (x - right).abs() < 1e-14), "{x:?}");
            assert!(factorization.scales().iter().all(|scale| (1e-3..1e3).contains(scale)), "{:?}", factorization.scales());
        }
    }

    #[test]
    fn right_hand_sides_that_underflow_are_solved_like_zeros() {
        let (mut factorization, values, rhs) = factored();
        for size in [1e-290, 1e-300, 1e-308, 1e-312, 1e-320] {
            let tiny: Vec<f64> = rhs.iter().map(|b| b * size).collect();
            for keeps in [false, true] {
                factorization.factor(&values).unwrap();
                assert!(!keeps || factorization.keep_factors(&values) == Ok(true));
                let mut x = tiny.clone();
                assert_eq!(factorization.solve_transposed(&mut x), Ok(TransposedSolution::Found), "{size:e}");
            }
        }
    }

    #[test]
    fn a_matrix_that_refinement_cannot_settle_is_told() {
        // two columns nearly in one direction, beside others
        let pattern = Arc::new(SparsePattern::from_entries(10, (0..10).flat_map(|i| [(i, i), (i, i ^ 1)]).collect()));
        let values = |distance: f64| {
            let entry = |column: usize, row: usize| match (column, row) {
                (0, 0) => 0.3,
                (0, 1) => 0.7,
                (1, 0) => 0.1,
                (1, 1) => 0.7 * 0.1 / 0.3 * (1.0 + distance),
                _ if column == row => 2.0,
                _ => 1.0,
            };
            let columns =
                (0..10).flat_map(|column| [column.min(column ^ 1), column.max(column ^ 1)].map(|row| (column, row)));
            columns.map(|(column, row)| entry(column, row)).collect::<Vec<f64>>()
        };
        let mut factorization = Factorization::new(&pattern, Backend::Dense).unwrap();
        let mut solve = |distance: f64| {
            let values = values(distance);
            factorization.factor(&values).unwrap();
            factorization.solve_transposed(&mut [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 0.3])
        };
        assert_eq!(solve(1e-3), Ok(TransposedSolution::Found));
        assert_eq!(solve(1e-8), Ok(TransposedSolution::Found));
        let unknown = solve(1e-13).unwrap_err().unknown;
        assert!(unknown < 2, "unknown {unknown}");
    }
}
