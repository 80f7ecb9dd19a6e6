//! Matrices of which each rank knows the rows and columns of its own unknowns alone, and numbers of all unknowns.

use super::{Owners, SparsePattern};
use crate::exchange::Exchange;
use crate::scalar::larger;
use std::ops::Range;
use std::sync::Arc;

/// Which unknowns belong to which rank.
pub struct OwnUnknowns {
    exchange: &'static dyn Exchange,
    /// Those of each rank.
    of_rank: Vec<Vec<u32>>,
    /// The rank of each.
    owners: Arc<Owners>,
}

impl OwnUnknowns {
    /// Of ranks that have all unknowns together, each once.
    pub fn new(exchange: &'static dyn Exchange, mut of_rank: Vec<Vec<u32>>) -> Self {
        of_rank.iter_mut().for_each(|own| own.sort_unstable());
        let owners = Arc::new(Owners::new(&of_rank));
        OwnUnknowns { exchange, of_rank, owners }
    }

    /// The rank of each.
    pub fn owners(&self) -> &Arc<Owners> {
        &self.owners
    }

    /// This rank.
    pub fn rank(&self) -> usize {
        self.exchange.rank()
    }

    /// Those of this rank, in increasing order.
    pub fn own(&self) -> &[u32] {
        &self.of_rank[self.exchange.rank()]
    }

    /// Whether this rank has any of some unknowns.
    pub fn has_any(&self, unknowns: Range<usize>) -> bool {
        self.owners.has_any(self.exchange.rank(), unknowns)
    }

    /// Whether this rank needs some columns with the same rows: they are own ones, or have own rows.
    pub fn touches(&self, columns: Range<usize>, rows: &[u32]) -> bool {
        self.has_any(columns) || rows.iter().any(|&row| self.has_any(row as usize..row as usize + 1))
    }

    /// Lists of all ranks, one after the other, in one: those of other ranks are written to places that `places` gives for each.
    fn exchange_at(&self, values: &mut [f64], places: &[Vec<u32>], further: &mut [f64]) {
        let own = places[self.exchange.rank()].iter().map(|&place| values[place as usize]);
        let own: Vec<f64> = own.chain(further.iter().copied()).collect();
        let counts: Vec<usize> = places.iter().map(|own| own.len() + further.len()).collect();
        let all = self.exchange.gather(&own, &counts);
        let mut rest = &all[..];
        for (rank, places) in places.iter().enumerate() {
            let (numbers, behind) = rest.split_at(places.len());
            let (others, behind) = behind.split_at(further.len());
            if rank != self.exchange.rank() {
                places.iter().zip(numbers).for_each(|(&place, &number)| values[place as usize] = number);
                further.iter_mut().zip(others).for_each(|(own, &other)| *own = larger(*own, other));
            }
            rest = behind;
        }
    }

    /// Brings numbers of all unknowns together, of which each rank has those of its own.
    pub fn gather(&self, numbers: &mut [f64]) {
        self.exchange_at(numbers, &self.of_rank, &mut []);
    }

    /// The same for several columns of numbers, with the largest of others.
    pub fn gather_columns(&self, columns: &mut [f64], largest: &mut [f64]) {
        let size = self.owners.unknowns() as u32;
        let count = columns.len() / self.owners.unknowns();
        let shifted =
            |own: &Vec<u32>| (0..count as u32).flat_map(|k| own.iter().map(move |&place| place + k * size)).collect();
        let places: Vec<Vec<u32>> = self.of_rank.iter().map(shifted).collect();
        self.exchange_at(columns, &places, largest);
    }

    /// Brings entries of a matrix together, given by their places and columns, and all of some columns.
    pub fn complete(&self, values: &mut [f64], pattern: &SparsePattern, entries: &[(u32, u32)], columns: &[u32]) {
        if columns.is_empty() {
            return;
        }
        let mut places = vec![Vec::new(); self.of_rank.len()];
        entries.iter().for_each(|&(place, column)| places[self.owners.of(column as usize)].push(place));
        for &column in columns {
            let all = pattern.column_starts[column as usize] as u32..pattern.column_starts[column as usize + 1] as u32;
            places[self.owners.of(column as usize)].extend(all);
        }
        self.exchange_at(values, &places, &mut []);
    }

    /// Brings all entries of a matrix together.
    pub fn complete_all(&self, values: &mut [f64], pattern: &SparsePattern) {
        let columns: Vec<u32> = (0..pattern.size as u32).collect();
        self.complete(values, pattern, &[], &columns);
    }

    /// The largest of numbers of all ranks and the first of unknowns, if there is one; all ranks have the same mark.
    pub fn agree(&self, largest: f64, first: Option<usize>, mark: f64) -> (f64, Option<usize>) {
        let own = [largest, first.map_or(f64::INFINITY, |unknown| unknown as f64), mark];
        let all = self.exchange.gather(&own, &vec![own.len(); self.of_rank.len()]);
        let (all, _) = all.as_chunks::<3>();
        if all.iter().any(|other| other[2].to_bits() != mark.to_bits()) {
            self.exchange.end("ranks have different matrices: are all processors, and all programs, the same?");
        }
        let first = all.iter().fold(f64::INFINITY, |least, other| least.min(other[1]));
        let largest = all.iter().fold(0.0, |most, other| larger(most, other[0]));
        (largest, first.is_finite().then_some(first as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::super::multifrontal::test_matrices::{Noise, chain, dominant, random_pattern, shell};
    use super::super::{Factorization, MultifrontalLu, Singular};
    use super::*;
    use crate::exchange::on_ranks;
    use std::sync::Arc;

    /// What a factorization gives for right-hand sides, plain and transposed, with its own factors and with kept ones.
    fn bits(
        factorization: &mut Factorization,
        (values, other, b): (&[f64], &[f64], &[f64]),
        factor: impl Fn(&mut Factorization, &[f64]) -> Result<(), Singular>,
    ) -> Result<Vec<u64>, Singular> {
        factor(factorization, values)?;
        let mut all = factorization.scales().to_vec();
        let mut x = b[..factorization.plan().unknowns].to_vec();
        factorization.solve(&mut x);
        all.extend(&x);
        for values in [values, other] {
            let mut x = b.to_vec();
            all.push(f64::from(u8::from(factorization.keep_factors(values)?)));
            all.push(if factorization.solve_transposed(&mut x).is_ok() { 1.0 } else { 2.0 });
            all.extend(&x);
        }
        factor(factorization, values)?;
        let mut x = b.to_vec();
        all.push(if factorization.solve_transposed(&mut x).is_ok() { 1.0 } else { 2.0 });
        Ok(all.iter().chain(&x).map(|x| x.to_bits()).collect())
    }

    /// Values as a rank has them: what stands in rows and columns of others is anything.
    fn of_rank(rank: usize, own: &OwnUnknowns, pattern: &SparsePattern, values: &[f64]) -> Vec<f64> {
        let mut noise = Noise(100 + rank as u64);
        let mut values = values.to_vec();
        for column in 0..pattern.size {
            let places = pattern.column_starts[column]..pattern.column_starts[column + 1];
            for (value, &row) in values[places.clone()].iter_mut().zip(&pattern.rows[places]) {
                let row = row as usize;
                if !own.has_any(column..column + 1) && !own.has_any(row..row + 1) {
                    *value = 1e9 * noise.vector(1)[0];
                }
            }
        }
        values
    }

    #[test]
    fn rows_and_columns_of_its_own_unknowns_are_all_that_a_rank_needs() {
        let (mut noise, mut failed, mut cases) = (Noise(5), 0, 0);
        for case in 0..40 {
            let pattern = match case % 4 {
                0 => chain(12 + case),
                1 => shell(9 + case / 10 * 2, 10),
                kind => random_pattern(&mut noise, 10 + case, kind),
            };
            let (mut values, b) = (dominant(&mut noise, &pattern), noise.vector(3 * pattern.size));
            match case % 8 {
                // weak unknowns, and what is no number
                5 => (0..pattern.size).step_by(3).filter_map(|i| pattern.position(i, i)).for_each(|at| values[at] = 0.0),
                7 => values[pattern.column_starts[pattern.size / 2]] = f64::NAN,
                _ => {}
            }
            let other: Vec<f64> = values.iter().map(|value| value * 1.000_000_1).collect();
            let pattern = Arc::new(pattern);
            let on = |world| Factorization::of_multifrontal(MultifrontalLu::on(&pattern, world), &pattern);
            let alone = |world| bits(&mut on(world), (&values, &other, &b), Factorization::factor);
            let expected = on_ranks(1, alone).remove(0);
            failed += usize::from(expected.is_err());
            for ranks in 2..=4 {
                let given = on_ranks(ranks, |world| {
                    let mut shared = on(world);
                    let own = shared.own_unknowns().cloned().expect("ranks");
                    let [values, other] = [&values, &other].map(|all| of_rank(world.rank(), &own, &pattern, all));
                    let factor = |shared: &mut Factorization, values: &[f64]| shared.factor_own(&mut values.to_vec(), 1.0);
                    bits(&mut shared, (&values, &other, &b), factor)
                });
                assert!(given.iter().all(|given| *given == expected), "case {case}, {ranks} ranks");
                cases += 1;
            }
        }
        assert!((5..20).contains(&failed), "{failed} of {cases} cases failed");
    }
}
