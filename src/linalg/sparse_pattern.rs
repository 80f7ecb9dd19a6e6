use std::ops::Range;

/// Places of the entries of a square sparse matrix, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparsePattern {
    /// Number of rows and columns.
    pub size: usize,
    /// Where each column starts in `rows`; length `size + 1`.
    pub column_starts: Vec<usize>,
    /// Row of each entry, increasing within a column.
    pub rows: Vec<usize>,
}

impl SparsePattern {
    /// From (column, row) pairs in any order, repeated or not.
    pub fn from_entries(size: usize, mut entries: Vec<(usize, usize)>) -> Self {
        entries.sort_unstable();
        entries.dedup();
        let mut column_starts = vec![0; size + 1];
        for &(column, _) in &entries {
            column_starts[column + 1] += 1;
        }
        for column in 0..size {
            column_starts[column + 1] += column_starts[column];
        }
        SparsePattern { size, column_starts, rows: entries.into_iter().map(|(_, row)| row).collect() }
    }

    /// From runs of rows in columns, in any order, overlapping or not.
    pub fn from_runs(size: usize, runs: &[(usize, Range<usize>)]) -> Self {
        // by columns
        let mut starts = vec![0; size + 1];
        runs.iter().for_each(|(column, _)| starts[column + 1] += 1);
        (0..size).for_each(|column| starts[column + 1] += starts[column]);
        let (mut sorted, mut next) = (vec![0; runs.len()], starts.clone());
        for (place, (column, _)) in runs.iter().enumerate() {
            sorted[next[*column]] = place;
            next[*column] += 1;
        }
        let (mut rows, mut column_starts, mut own) = (Vec::new(), vec![0], Vec::new());
        for column in 0..size {
            own.clear();
            own.extend(sorted[starts[column]..starts[column + 1]].iter().flat_map(|&place| runs[place].1.clone()));
            own.sort();
            own.dedup();
            rows.extend_from_slice(&own);
            column_starts.push(rows.len());
        }
        rows.shrink_to_fit();
        SparsePattern { size, column_starts, rows }
    }

    /// Place of an entry that is in the pattern.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let start = self.column_starts[column];
        let rows = &self.rows[start..self.column_starts[column + 1]];
        rows.binary_search(&row).ok().map(|place| start + place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_make_the_pattern_of_their_entries() {
        let runs = [(2, 1..4), (0, 3..4), (2, 3..5), (4, 0..5), (2, 0..1), (0, 0..1)];
        let entries = runs.iter().flat_map(|(column, rows)| rows.clone().map(move |row| (*column, row))).collect();
        assert_eq!(SparsePattern::from_runs(5, &runs), SparsePattern::from_entries(5, entries));
    }
}
