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

    /// Place of an entry that is in the pattern.
    pub fn position(&self, row: usize, column: usize) -> Option<usize> {
        let start = self.column_starts[column];
        let rows = &self.rows[start..self.column_starts[column + 1]];
        rows.binary_search(&row).ok().map(|place| start + place)
    }
}
