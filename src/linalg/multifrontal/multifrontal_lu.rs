// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::balance::balanced;
use super::factors::Factors;
use super::inertia::{Inertia, shifted_inertia};
use super::known_signs::known_signs;
use super::rank_share::RankShare;
use super::stretches::Stretches;
use super::substitution::{BLOCK, Side, Substitution};
use super::symbolic::{Analysis, SMALL_FILL, Symbolic};
use super::thread_solution::ThreadSolution;
use super::traversal::Traversal;
use crate::exchange::{self, Exchange};
use crate::linalg::SparsePattern;
use crate::linalg::{LinearSolver, OwnUnknowns, Owners, Singular};
use std::sync::Arc;

/// Multifrontal LU of matrices of one pattern, whose rows and columns should have the size 1.
///
/// Orders and plans once; later factorizations of new values use the same memory.
pub struct MultifrontalLu {
    symbolic: Arc<Symbolic>,
    threads: usize,
    work: Work,
    factors: Factors,
    substitution: Substitution,
}

/// Who factors which fronts.
enum Work {
    /// This process all of them, on threads that share solutions, too, where these are long.
    Alone(Traversal, Option<ThreadSolution>),
    /// Each rank a stretch of them.
    Shared(Box<RankShare>),
}

impl MultifrontalLu {
    /// Analyses a pattern, in which unknowns without a diagonal entry are multipliers.
    ///
    /// * `threads` at least 1; with more, in the current pool of rayon
    pub fn new(pattern: &SparsePattern, threads: usize) -> Self {
        assert!(pattern.rows.len() < u32::MAX as usize, "{} entries are more than 2^32", pattern.rows.len());
        Self::of(Arc::new(Symbolic::new(pattern)), threads)
    }

    fn of(symbolic: Arc<Symbolic>, threads: usize) -> Self {
        let world = exchange::world();
        if world.ranks() > 1 && symbolic.analysis(0).entries > SMALL_FILL {
            let stretches = balanced(&symbolic, world.ranks());
            return Self::shared(symbolic, stretches, threads, world);
        }
        let work = Work::Alone(Traversal::new(&symbolic, threads), ThreadSolution::new(&symbolic, threads));
        MultifrontalLu { symbolic, threads, work, factors: Factors::default(), substitution: Substitution::default() }
    }

    fn shared(symbolic: Arc<Symbolic>, stretches: Stretches, threads: usize, world: &'static dyn Exchange) -> Self {
        let work = Work::Shared(Box::new(RankShare::new(&symbolic, stretches, threads, world)));
        MultifrontalLu { symbolic, threads, work, factors: Factors::default(), substitution: Substitution::default() }
    }

    /// Shared by ranks, whatever its size.
    #[cfg(test)]
    pub fn on(pattern: &SparsePattern, world: &'static dyn Exchange) -> Self {
        let symbolic = Arc::new(Symbolic::new(pattern));
        let stretches = balanced(&symbolic, world.ranks());
        Self::shared(symbolic, stretches, 1, world)
    }

    /// Solutions by threads with stretches that end at given fronts, or are as long as theirs would be, whatever the size.
    #[cfg(test)]
    fn cut_solutions(&mut self, threads: usize, cuts: &[usize]) {
        let stretches = match cuts {
            [] => Stretches::new(&self.symbolic, threads),
            cuts => Stretches::at(&self.symbolic, cuts),
        };
        self.work = Work::Alone(Traversal::new(&self.symbolic, 1), Some(ThreadSolution::of(&self.symbolic, stretches)));
    }

    /// Ranks that share a factorization.
    pub fn ranks(&self) -> usize {
        match &self.work {
            Work::Alone(..) => 1,
            Work::Shared(share) => share.ranks(),
        }
    }

    /// Unknowns of each rank, where some share a factorization: the rows and columns of its own are all that it needs of a matrix.
    pub fn own_unknowns(&self) -> Option<OwnUnknowns> {
        match &self.work {
            Work::Alone(..) => None,
            Work::Shared(share) => Some(share.own_unknowns(&self.symbolic)),
        }
    }

    /// To which thread each unknown belongs, where several share solutions.
    pub fn thread_owners(&self) -> Option<Owners> {
        match &self.work {
            Work::Alone(_, Some(threads)) => threads.owners(&self.symbolic),
            _ => None,
        }
    }

    fn solve_side(&mut self, side: Side, rhs: &mut [f64]) {
        let MultifrontalLu { symbolic, work, factors, substitution, .. } = self;
        if side == Side::Transposed {
            factors.transpose(symbolic);
        }
        for rhs in rhs.chunks_mut(BLOCK * symbolic.size.max(1)) {
            match work {
                Work::Alone(_, Some(threads)) => threads.solve(symbolic, factors, side, rhs),
                Work::Alone(_, None) => substitution.solve(symbolic, factors, side, rhs),
                Work::Shared(share) => share.solve(symbolic, factors, substitution, side, rhs),
            }
        }
    }

    /// What a factorization takes without delayed pivots.
    pub fn analysis(&self) -> Analysis {
        self.symbolic.analysis(match &self.work {
            Work::Alone(traversal, _) => traversal.bytes(),
            Work::Shared(share) => share.bytes(),
        })
    }

    /// How often in the last factorization a pivot had to wait for a front above.
    #[cfg(test)]
    pub fn delayed_pivots(&mut self) -> usize {
        self.factors.delayed(&self.symbolic)
    }
}

impl LinearSolver for MultifrontalLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        assert_eq!(values.len(), self.symbolic.pattern_entries, "values and entries of the pattern");
        match &mut self.work {
            Work::Alone(traversal, threads) => {
                traversal.factor(&self.symbolic, values, self.factors.part(&self.symbolic))?;
                threads.iter_mut().for_each(|threads| threads.set_delayed(&self.symbolic, &mut self.factors));
                Ok(())
            }
            Work::Shared(share) => share.factor(&self.symbolic, values, &mut self.factors),
        }
    }

    fn clone_analysis(&self) -> Option<Box<dyn LinearSolver>> {
        Some(Box::new(Self::of(self.symbolic.clone(), self.threads)))
    }

    fn inertia(&self, values: &[f64], known: usize) -> Inertia {
        let count = |shift| shifted_inertia(&self.symbolic, values, shift, self.threads);
        known_signs(self.symbolic.size, known, count)
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_side(Side::Plain, rhs);
    }

    fn solve_transposed(&mut self, rhs: &mut [f64]) {
        self.solve_side(Side::Transposed, rhs);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::multifrontal::small_front::SMALL_FRONT;
    use crate::linalg::multifrontal::test_matrices::*;

    #[test]
    fn solutions_equal_those_of_dense_lu_plain_and_transposed() {
        let mut noise = Noise(1);
        let (mut delayed, mut compared) = (0, 0);
        for case in 0..400 {
            let nodes = 1 + noise.below(40);
            let pattern = random_pattern(&mut noise, nodes, case % 5);
            let mut lu = MultifrontalLu::new(&pattern, 1);
            if case % 3 > 0 {
                lu.cut_solutions(case % 3, &[]);
            }
            for _ in 0..2 {
                let values = if case % 2 == 1 { weak(&mut noise, &pattern) } else { noise.vector(pattern.rows.len()) };
                let condition = condition(&pattern, &values);
                if condition > 1e7 {
                    continue;
                }
                compared += 1;
                lu.factor(&values).unwrap_or_else(|error| panic!("case {case}, condition {condition:e}: {error:?}"));
                delayed += lu.delayed_pivots();
                // threshold pivoting may let entries grow
                let error = errors(&mut noise, &mut lu, &pattern, &values);
                assert!(error < 1e-11, "case {case}: {error:e}, condition {condition:e}");
            }
        }
        assert!(compared > 300, "only {compared} regular matrices");
        assert!(delayed > 100, "only {delayed} delayed pivots");
    }

    #[test]
    fn many_right_hand_sides_are_solved_as_one_after_the_other() {
        let mut noise = Noise(2);
        for case in 0..30 {
            let pattern = random_pattern(&mut noise, 30, 3);
            let values = noise.vector(pattern.rows.len());
            let mut lu = MultifrontalLu::new(&pattern, 1);
            if lu.factor(&values).is_err() {
                continue;
            }
            let condition = condition(&pattern, &values);
            // a few, as many as a gradient of some functionals takes, and more than one block of them
            for (side, count) in [(Side::Plain, 3), (Side::Transposed, 3), (Side::Plain, 37), (Side::Transposed, 37)] {
                let b = noise.vector(pattern.size * count);
                let (mut together, mut apart) = (b.clone(), b.clone());
                match side {
                    Side::Plain => lu.solve(&mut together),
                    Side::Transposed => lu.solve_transposed(&mut together),
                }
                for column in apart.chunks_exact_mut(pattern.size) {
                    match side {
                        Side::Plain => lu.solve(column),
                        Side::Transposed => lu.solve_transposed(column),
                    }
                }
                let (error, allowed) = (difference(&together, &apart), if count == 3 { 0.0 } else { 1e-13 * condition });
                assert!(error <= allowed, "case {case}, {side:?}, {count}: {error:e}, condition {condition:e}");
            }
        }
    }

    /// Values of a chain: bodies of size 2, unsymmetric, and multipliers whose forces act along the rows of their equations.
    fn chain_values(noise: &mut Noise, pattern: &SparsePattern) -> Vec<f64> {
        let mut values = noise.vector(pattern.rows.len());
        for column in 0..pattern.size {
            for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                let row = pattern.rows[place] as usize;
                if row.max(column) < 6 * pattern.size / 9 {
                    values[place] = if row == column { 2.0 } else { 0.1 * values[place] };
                } else if row < column {
                    values[place] = values[pattern.position(column, row).expect("an entry on each side")];
                }
            }
        }
        values
    }

    fn condition(pattern: &SparsePattern, values: &[f64]) -> f64 {
        1.0 / Reference::both(pattern, values)[0].distance_from_singular()
    }

    /// Largest errors of solutions of a few right-hand sides, plain and transposed, as shares of the condition.
    fn errors(noise: &mut Noise, lu: &mut MultifrontalLu, pattern: &SparsePattern, values: &[f64]) -> f64 {
        let b = noise.vector(pattern.size * 5);
        let mut most: f64 = 0.0;
        for (reference, is_transposed) in Reference::both(pattern, values).iter().zip([false, true]) {
            let mut x = b.clone();
            if is_transposed {
                lu.solve_transposed(&mut x)
            } else {
                lu.solve(&mut x)
            }
            for (x, b) in x.chunks_exact(pattern.size).zip(b.chunks_exact(pattern.size)) {
                most = most.max(difference(x, &reference.solve(b)) * reference.distance_from_singular());
            }
        }
        most
    }

    #[test]
    fn small_fronts_exchange_rows_and_leave_columns_without_a_pivot_to_others() {
        let mut noise = Noise(12);
        let pattern = chain(12);
        let mut lu = MultifrontalLu::new(&pattern, 1);
        let mut values = chain_values(&mut noise, &pattern);
        lu.factor(&values).expect("regular");
        assert_eq!(lu.factors.forms(&lu.symbolic)[0], lu.analysis().fronts);
        assert!(errors(&mut noise, &mut lu, &pattern, &values) < 1e-15);
        // the diagonals of bodies vanish: other rows have their pivots
        for unknown in 0..72 {
            values[pattern.position(unknown, unknown).expect("a diagonal")] = 1e-5;
        }
        lu.factor(&values).expect("regular");
        let [small, exchanged, _] = lu.factors.forms(&lu.symbolic);
        assert!(small > 0 && exchanged > 3, "{:?}", lu.factors.forms(&lu.symbolic));
        assert!(errors(&mut noise, &mut lu, &pattern, &values) < 1e-14);
        // some bodies have nothing but their multipliers: their pivots are those of fronts above
        for body in (0..12).step_by(3) {
            for (row, column) in (0..36).map(|k| (6 * body + k / 6, 6 * body + k % 6)) {
                values[pattern.position(row, column).expect("a block of a body")] = 0.0;
            }
        }
        match lu.factor(&values) {
            Ok(()) => {
                let [small, _, refused] = lu.factors.forms(&lu.symbolic);
                assert!(small > 0 && refused > 0, "{:?}", lu.factors.forms(&lu.symbolic));
                assert!(errors(&mut noise, &mut lu, &pattern, &values) < 1e-13);
            }
            Err(singular) => panic!("{singular:?}"),
        }
    }

    #[test]
    fn processors_without_wide_vectors_choose_the_same_pivots_and_solve_the_same_systems() {
        let mut noise = Noise(13);
        let pattern = chain(30);
        // every second one without pivots on the diagonals of bodies
        for case in 0..20 {
            let mut values = chain_values(&mut noise, &pattern);
            for unknown in (0..180).filter(|unknown| unknown * case % 2 == 1) {
                values[pattern.position(unknown, unknown).expect("a diagonal")] = 1e-5;
            }
            let [wide, portable] = [false, true].map(|is_portable| {
                crate::linalg::vectors::ONLY_PORTABLE.set(is_portable);
                let mut lu = MultifrontalLu::new(&pattern, 1);
                lu.factor(&values).expect("regular");
                let error = errors(&mut noise, &mut lu, &pattern, &values);
                crate::linalg::vectors::ONLY_PORTABLE.set(false);
                assert!(error < 1e-14, "{error:e}");
                lu.factors.forms(&lu.symbolic)
            });
            assert!(wide == portable && wide[0] > 10 && (wide[1] > 0 || case % 2 == 0), "{wide:?} {portable:?}");
        }
    }

    /// Numbers that do not depend on clocks: of a longer chain as many for each body.
    #[test]
    fn a_chain_takes_the_same_work_for_each_body() {
        let mut noise = Noise(14);
        for bodies in [10, 100, 1000] {
            let pattern = chain(bodies);
            let mut lu = MultifrontalLu::new(&pattern, 1);
            let analysis = lu.analysis();
            let per_body = |count: f64| count / bodies as f64;
            assert!(per_body(0.5 * analysis.flops) < 1_300.0, "{analysis:?}");
            assert!(per_body(analysis.entries as f64) < 210.0, "{analysis:?}");
            assert!(per_body(analysis.bytes as f64) < 3_200.0, "{analysis:?}");
            assert!(analysis.largest_front <= SMALL_FRONT, "{analysis:?}");
            lu.factor(&chain_values(&mut noise, &pattern)).expect("regular");
            let [small, exchanged, refused] = lu.factors.forms(&lu.symbolic);
            assert!(small == analysis.fronts && exchanged < bodies / 10 + 1 && refused == 0, "{exchanged}, {refused}");
        }
    }

    #[test]
    fn the_smallest_systems() {
        let empty = SparsePattern::from_entries(0, vec![]);
        let mut lu = MultifrontalLu::new(&empty, 1);
        lu.factor(&[]).expect("nothing to fail");
        lu.solve(&mut []);
        let one = SparsePattern::from_entries(1, vec![(0, 0)]);
        let mut lu = MultifrontalLu::new(&one, 1);
        lu.factor(&[4.0]).expect("regular");
        let mut x = [2.0];
        lu.solve(&mut x);
        lu.solve_transposed(&mut x);
        assert_eq!(x, [0.125]);
        for singular in [0.0, 1e-15, f64::NAN, f64::INFINITY] {
            assert_eq!(lu.factor(&[singular]), Err(Singular { unknown: 0 }), "{singular}");
        }
        let hollow = SparsePattern::from_entries(2, vec![(0, 0)]);
        assert_eq!(MultifrontalLu::new(&hollow, 1).factor(&[1.0]), Err(Singular { unknown: 1 }));
    }

    #[test]
    fn a_singular_matrix_is_an_error_and_leaves_the_solver_usable() {
        let mut noise = Noise(3);
        for case in 0..200 {
            let nodes = 2 + noise.below(30);
            let pattern = random_pattern(&mut noise, nodes, 0);
            let values = dominant(&mut noise, &pattern);
            let mut lu = MultifrontalLu::new(&pattern, 1);
            // a column of zeros, or a value that is not a number
            let column = noise.below(pattern.size);
            let own = pattern.column_starts[column]..pattern.column_starts[column + 1];
            let mut singular = values.clone();
            if case % 2 == 0 {
                singular[own].fill(0.0);
                assert_eq!(lu.factor(&singular), Err(Singular { unknown: column }), "case {case}");
            } else {
                singular[own.start] = f64::NAN;
                assert!(lu.factor(&singular).is_err(), "case {case}");
            }
            lu.factor(&values).expect("regular");
            assert!(errors(&mut noise, &mut lu, &pattern, &values) < 1e-12, "case {case}");
        }
    }

    #[test]
    fn dependent_rows_are_singular_but_for_round_off() {
        let mut noise = Noise(4);
        let (mut seen, mut refused) = (0, 0);
        for _ in 0..100 {
            let nodes = 3 + noise.below(10);
            let pattern = random_pattern(&mut noise, nodes, 0);
            let mut values = dominant(&mut noise, &pattern);
            values.iter_mut().for_each(|value| *value /= 16.0);
            // the first two unknowns of a node have the same column pattern: make the columns equal
            let Some(column) = (1..pattern.size).find(|&column| {
                let rows = |column: usize| &pattern.rows[pattern.column_starts[column]..pattern.column_starts[column + 1]];
                rows(column) == rows(column - 1)
            }) else {
                continue;
            };
            seen += 1;
            let own = pattern.column_starts[column]..pattern.column_starts[column + 1];
            values.copy_within(own, pattern.column_starts[column - 1]);
            refused += usize::from(MultifrontalLu::new(&pattern, 1).factor(&values).is_err());
        }
        assert!(seen > 50, "{seen}");
        // the vanishing pivot is round-off of a few units in the last place of 1, below the limit of 1e-14
        assert!(refused * 10 >= seen * 9, "{refused} of {seen} refused");
    }

    #[test]
    fn pivots_of_a_shell_wait_for_fronts_above_where_they_have_to_and_those_of_its_multipliers_do_not() {
        let mut noise = Noise(5);
        let pattern = shell(13, 30);
        let mut values = dominant(&mut noise, &pattern);
        for is_hollow in [false, true] {
            // unknowns that nothing but far neighbours determine: their node's own block vanishes
            for node in (0..169).step_by(3).filter(|_| is_hollow) {
                for (row, column) in (0..36).map(|k| (6 * node + k / 6, 6 * node + k % 6)) {
                    values[pattern.position(row, column).expect("a block of a node")] = 0.0;
                }
            }
            let mut lu = MultifrontalLu::new(&pattern, 1);
            lu.factor(&values).expect("regular");
            assert_eq!(lu.delayed_pivots() > 0, is_hollow);
            let error = errors(&mut noise, &mut lu, &pattern, &values);
            assert!(error < 1e-12, "{error:e}");
        }
    }

    #[test]
    fn the_analysis_predicts_what_is_stored() {
        let pattern = shell(21, 10);
        let lu = MultifrontalLu::new(&pattern, 1);
        let analysis = lu.analysis();
        // every entry of the matrix is in the factors, and L and U have fewer than all entries
        assert!(
            analysis.entries >= pattern.rows.len() && analysis.entries < pattern.size * pattern.size / 2,
            "{analysis:?}"
        );
        assert!(analysis.bytes > 8 * analysis.entries, "{analysis:?}");
        // dense: 2/3 n^3
        let dense = SparsePattern::from_entries(60, (0..3600).map(|k| (k / 60, k % 60)).collect());
        let analysis = MultifrontalLu::new(&dense, 1).analysis();
        assert_eq!((analysis.fronts, analysis.entries, analysis.largest_front), (1, 3600, 60));
        assert!((analysis.flops / (2.0 / 3.0 * 60f64.powi(3)) - 1.0).abs() < 0.02, "{analysis:?}");
    }

    /// Bits of solutions, plain and transposed, of few and of many right-hand sides; or that the matrix is singular.
    fn bits(lu: &mut MultifrontalLu, values: &[f64], b: &[f64]) -> Result<Vec<u64>, Singular> {
        lu.factor(values)?;
        let size = lu.symbolic.size;
        let mut all = Vec::new();
        for (side, columns) in
            [Side::Plain, Side::Transposed].into_iter().flat_map(|side| [1, 3, 7].map(|count| (side, count)))
        {
            let mut x = b[..columns * size].to_vec();
            lu.solve_side(side, &mut x);
            all.extend(x.iter().map(|x| x.to_bits()));
        }
        Ok(all)
    }

    type Bits = Result<Vec<u64>, Singular>;

    /// The same on ranks, whose stretches begin at given fronts or, without any, where they should, and which share all fronts or those that take
    /// long; how many pivots waited for another rank, how many shared fronts had several panels, and how many of their pivots waited.
    fn bits_on_ranks(
        pattern: &SparsePattern,
        all: &[Vec<f64>],
        b: &[f64],
        (ranks, cuts): (usize, &[usize]),
        shares_all: bool,
    ) -> (Vec<Bits>, [usize; 3]) {
        let per_rank = crate::exchange::on_ranks(ranks, |world| {
            let symbolic = Arc::new(Symbolic::new(pattern));
            let stretches = match cuts {
                [] => balanced(&symbolic, ranks),
                cuts => Stretches::at(&symbolic, cuts),
            };
            let stretches = if shares_all { stretches.sharing_all() } else { stretches };
            let mut lu = MultifrontalLu::shared(symbolic, stretches, 1, world);
            let mut counts = [0; 3];
            let mut one = |values: &Vec<f64>| {
                let bits = bits(&mut lu, values, b);
                if let (Ok(_), Work::Shared(share)) = (&bits, &lu.work) {
                    let [with_panels, waiting] = share.shared_fronts(&lu.symbolic);
                    let own = [share.delayed_across_ranks(), with_panels, waiting];
                    counts.iter_mut().zip(own).for_each(|(all, own)| *all += own);
                }
                bits
            };
            (all.iter().map(&mut one).collect::<Vec<Bits>>(), counts)
        });
        assert!(per_rank.iter().all(|other| *other == per_rank[0]), "ranks differ");
        per_rank.into_iter().next().expect("a rank")
    }

    /// Matrices of a pattern: with large and with small diagonals, without the numbers of one and of several columns, and the first one again.
    fn matrices_of(noise: &mut Noise, pattern: &SparsePattern) -> Vec<Vec<f64>> {
        let regular = dominant(noise, pattern);
        let weak = weak(noise, pattern);
        let mut hollow = |columns: usize| {
            let mut values = regular.clone();
            for column in (0..columns).map(|_| noise.below(pattern.size)) {
                values[pattern.column_starts[column]..pattern.column_starts[column + 1]].fill(0.0);
            }
            values
        };
        let (once, often) = (hollow(1), hollow(4));
        vec![regular.clone(), weak, once, often, regular]
    }

    /// Values without those of some columns in rows up to the front of each: their pivots wait for the front above.
    fn with_late_columns(noise: &mut Noise, pattern: &SparsePattern, symbolic: &Symbolic) -> Vec<f64> {
        let mut values = dominant(noise, pattern);
        let mut place = vec![0; symbolic.size];
        symbolic.order.iter().enumerate().for_each(|(own, &unknown)| place[unknown as usize] = own);
        let above = symbolic.fronts.iter().filter(|front| !front.is_small() && !front.is_last());
        for front in above {
            let end = front.first + front.pivots;
            let column = symbolic.order[front.first + noise.below(front.pivots)] as usize;
            for at in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                if place[pattern.rows[at] as usize] < end {
                    values[at] = 0.0;
                }
            }
        }
        values
    }

    #[test]
    fn ranks_and_threads_have_the_bits_of_one() {
        let mut noise = Noise(21);
        let (mut delayed, mut singular, mut shared) = (0, 0, [0; 3]);
        for case in 0..60 {
            let nodes = 4 + noise.below(40);
            let pattern = if case % 10 == 0 {
                shell([9, 11, 33][case / 10 % 3], 10)
            } else {
                random_pattern(&mut noise, nodes, case % 5)
            };
            let mut alone = MultifrontalLu::new(&pattern, 1);
            let mut matrices = matrices_of(&mut noise, &pattern);
            matrices.insert(1, with_late_columns(&mut noise, &pattern, &alone.symbolic));
            let b = noise.vector(7 * pattern.size);
            alone.cut_solutions(1, &[]);
            let mut one = |values: &Vec<f64>| {
                let bits = bits(&mut alone, values, &b);
                delayed += if bits.is_ok() { alone.delayed_pivots() } else { 0 };
                singular += usize::from(bits.is_err());
                bits
            };
            let expected: Vec<Bits> = matrices.iter().map(&mut one).collect();
            // that of the first one again, after all others
            assert!(expected.first() == expected.last(), "case {case}: a repeated factorization");
            for ranks in 2..=4 {
                let fronts = alone.symbolic.fronts.len();
                let mut cuts: Vec<usize> = (1..ranks).map(|_| noise.below(fronts + 1)).collect();
                cuts.sort_unstable();
                for cuts in [&[], &cuts[..]] {
                    for shares_all in [false, true] {
                        let (given, counts) = bits_on_ranks(&pattern, &matrices, &b, (ranks, cuts), shares_all);
                        assert!(
                            given == expected,
                            "case {case}, {ranks} ranks, cuts {cuts:?}, {shares_all}, {fronts} fronts"
                        );
                        shared.iter_mut().zip(counts).for_each(|(all, own)| *all += own);
                    }
                    let mut on_threads = MultifrontalLu::new(&pattern, 1);
                    on_threads.cut_solutions(ranks, cuts);
                    let given: Vec<Bits> = matrices.iter().map(|values| bits(&mut on_threads, values, &b)).collect();
                    assert!(given == expected, "case {case}, {ranks} threads, cuts {cuts:?} of {fronts} fronts");
                }
            }
        }
        let [across, with_panels, waiting] = shared;
        let counts = format!("{delayed} delayed pivots, {across} across ranks, {singular} singular matrices");
        let of_shared = format!("{with_panels} shared fronts of several panels, {waiting} pivots of shared ones delayed");
        println!("{counts}, {of_shared}");
        assert!(delayed > 300 && across > 100 && singular > 50 && with_panels > 50 && waiting > 50, "{counts}, {of_shared}");
    }

    #[test]
    fn where_the_system_refuses_threads_one_has_the_same_bits() {
        let mut noise = Noise(22);
        let pattern = shell(17, 10);
        let (values, b) = (noise.vector(pattern.rows.len()), noise.vector(7 * pattern.size));
        let solve = |at_most: usize| {
            let mut lu = MultifrontalLu::new(&pattern, 1);
            lu.cut_solutions(4, &[]);
            exchange::STARTED_AT_MOST.set(at_most);
            let bits = bits(&mut lu, &values, &b);
            exchange::STARTED_AT_MOST.set(usize::MAX);
            bits
        };
        let expected = solve(usize::MAX);
        assert!(expected.is_ok());
        // none, some of those that one solution takes, and those of some solutions
        for at_most in [0, 1, 2, 3, 5, 10] {
            assert!(solve(at_most) == expected, "{at_most} threads");
        }
    }

    #[test]
    fn factorizations_on_two_threads_have_the_bits_of_one() {
        let mut noise = Noise(11);
        let pattern = shell(41, 20);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
        let b = noise.vector(7 * pattern.size);
        for values in [dominant(&mut noise, &pattern), noise.vector(pattern.rows.len())] {
            let bits = |threads: usize| bits(&mut MultifrontalLu::new(&pattern, threads), &values, &b);
            let one = bits(1);
            assert!(one.is_ok() && (0..2).all(|_| pool.install(|| bits(2)) == one));
        }
    }
}
