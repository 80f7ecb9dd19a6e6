use std::ops::Range;

/// Places of the entries of a square sparse matrix, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparsePattern {
    /// Number of rows and columns.
    pub size: usize,
    /// Where each column starts in `rows`; length `size + 1`.
    pub column_starts: Vec<usize>,
    /// Row of each entry, increasing within a column.
    pub rows: Vec<u32>,
}

impl SparsePattern {
    /// From (column, row) pairs in any order, repeated or not.
    pub fn from_entries(size: usize, mut entries: Vec<(usize, usize)>) -> Self {
        assert!(size < u32::MAX as usize, "{size} unknowns, more than 2^32 - 2");
        entries.sort_unstable();
        entries.dedup();
        let mut column_starts = vec![0; size + 1];
        for &(column, _) in &entries {
            column_starts[column + 1] += 1;
        }
        for column in 0..size {
            column_starts[column + 1] += column_starts[column];
        }
        SparsePattern { size, column_starts, rows: entries.into_iter().map(|(_, row)| row as u32).collect() }
    }

    /// Writes values where they stand in a dense matrix of zeros, column by column.
    pub fn spread(&self, values: &[f64], dense: &mut [f64]) {
        for column in 0..self.size {
            for place in self.column_starts[column]..self.column_starts[column + 1] {
                dense[self.rows[place] as usize + column * self.size] = values[place];
            }
        }
    }

    /// From runs of rows in columns, in any order, overlapping or not; returns the place of each run's first entry, too.
    pub fn from_runs(size: usize, runs: &[(u32, Range<u32>)]) -> (Self, Vec<u32>) {
        assert!(size.max(runs.len()) < u32::MAX as usize, "{size} unknowns in {} runs, more than 2^32 - 2", runs.len());
        // by columns
        let mut starts = vec![0; size + 1];
        runs.iter().for_each(|(column, _)| starts[*column as usize + 1] += 1);
        (0..size).for_each(|column| starts[column + 1] += starts[column]);
        let (mut sorted, mut next) = (vec![0_u32; runs.len()], starts.clone());
        for ((column, _), number) in runs.iter().zip(0..) {
            let next = &mut next[*column as usize];
            sorted[*next] = number;
            *next += 1;
        }
        let run = |number: u32| runs[number as usize].1.clone();
        let (mut rows, mut column_starts, mut places) = (Vec::new(), vec![0], vec![0_u32; runs.len()]);
        let (mut before, mut ascending) = (0..0, Vec::new());
        for column in 0..size {
            let own = starts[column]..starts[column + 1];
            let start = rows.len();
            let mut pairs = sorted[own.clone()].iter().zip(&sorted[before.clone()]);
            if own.len() == before.len() && pairs.all(|(&own, &other)| run(own) == run(other)) {
                // unknowns of one node meet the same others
                let same = column_starts[column.saturating_sub(1)];
                rows.extend_from_within(same..);
                for (&own, &other) in sorted[own.clone()].iter().zip(&sorted[before]) {
                    places[own as usize] = places[other as usize] + (start - same) as u32;
                }
            } else {
                ascending.clear();
                ascending.extend_from_slice(&sorted[own.clone()]);
                ascending.sort_unstable_by_key(|&number| run(number).start);
                // rows up to here are there
                let mut end = 0_u32;
                for &number in &ascending {
                    let run = run(number);
                    // of rows that are there, all from the start of the run on follow each other
                    places[number as usize] = rows.len() as u32 - end.saturating_sub(run.start);
                    rows.extend(run.start.max(end)..run.end);
                    end = end.max(run.end);
                }
            }
            assert!(rows.len() < u32::MAX as usize, "a matrix of more than 2^32 - 2 entries");
            before = own;
            column_starts.push(rows.len());
        }
        rows.shrink_to_fit();
        (SparsePattern { size, column_starts, rows }, places)
    }

    /// Place of an entry that is in the pattern.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let start = self.column_starts[column];
        let rows = &self.rows[start..self.column_starts[column + 1]];
        rows.binary_search(&(row as u32)).ok().map(|place| start + place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_make_the_pattern_of_their_entries() {
        // the fourth column has the runs of the third
        let runs =
            [(2, 1..4), (0, 3..4), (3, 1..4), (2, 3..5), (4, 0..5), (3, 3..5), (2, 0..1), (0, 0..1), (3, 0..1), (4, 1..3)];
        let entries =
            runs.iter().flat_map(|(column, rows)| rows.clone().map(move |row| (*column as usize, row as usize))).collect();
        let (pattern, places) = SparsePattern::from_runs(5, &runs);
        assert_eq!(pattern, SparsePattern::from_entries(5, entries));
        for ((column, rows), place) in runs.iter().zip(places) {
            assert_eq!(pattern.position(rows.start as usize, *column as usize), Some(place as usize));
        }
    }
}
