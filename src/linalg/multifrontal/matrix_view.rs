//! Views of matrices that stand column by column in memory, and of blocks of them.

use std::marker::PhantomData;
use std::ops::Range;

/// A matrix or a block of one: contiguous columns at equal distances.
#[derive(Clone, Copy)]
pub struct MatrixView<'m> {
    first: *const f64,
    rows: usize,
    columns: usize,
    stride: usize,
    values: PhantomData<&'m [f64]>,
}

/// The same to write to; no other view of its entries is alive.
pub struct MatrixViewMut<'m>(MatrixView<'m>, PhantomData<&'m mut [f64]>);

// SAFETY: it is used as a shared reference to its entries.
unsafe impl Send for MatrixView<'_> {}
// SAFETY: as above.
unsafe impl Sync for MatrixView<'_> {}

impl<'m> MatrixView<'m> {
    /// All entries, column by column.
    #[inline(always)]
    pub fn new(values: &'m [f64], rows: usize, columns: usize) -> Self {
        assert_eq!(Some(values.len()), rows.checked_mul(columns), "entries of a matrix of {rows} x {columns}");
        MatrixView { first: values.as_ptr(), rows, columns, stride: rows, values: PhantomData }
    }

    /// Number of rows.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Entries from one column to the next.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The place of the first entry.
    #[inline(always)]
    pub fn as_ptr(&self) -> *const f64 {
        self.first
    }

    /// The place of an entry.
    ///
    /// # Safety
    /// It is one of the matrix.
    #[inline(always)]
    pub unsafe fn at(self, row: usize, column: usize) -> *const f64 {
        // SAFETY: promised by the caller.
        unsafe { self.first.add(row + column * self.stride) }
    }

    /// Some of the rows and columns.
    #[inline(always)]
    pub fn block(self, rows: Range<usize>, columns: Range<usize>) -> Self {
        check(&rows, self.rows, "rows");
        check(&columns, self.columns, "columns");
        // an empty block may begin behind the last entry
        let first = self.first.wrapping_add(rows.start + columns.start * self.stride);
        MatrixView { first, rows: rows.len(), columns: columns.len(), ..self }
    }

    /// One column.
    #[inline(always)]
    pub fn column(self, column: usize) -> &'m [f64] {
        assert!(column < self.columns, "column {column} of {}", self.columns);
        // SAFETY: a column of the matrix is contiguous, and shared for 'm.
        unsafe { std::slice::from_raw_parts(self.first.add(column * self.stride), self.rows) }
    }

    /// The entries of a matrix without gaps between its columns.
    #[inline(always)]
    pub fn entries(self) -> &'m [f64] {
        assert!(self.rows == self.stride || self.columns <= 1, "gaps between the columns of a matrix");
        // SAFETY: the columns follow each other, and are shared for 'm.
        unsafe { std::slice::from_raw_parts(self.first, self.rows * self.columns) }
    }
}

impl<'m> MatrixViewMut<'m> {
    /// All entries, column by column.
    #[inline(always)]
    pub fn new(values: &'m mut [f64], rows: usize, columns: usize) -> Self {
        let first = values.as_mut_ptr().cast_const();
        // to be written to by this pointer
        MatrixViewMut(MatrixView { first, ..MatrixView::new(values, rows, columns) }, PhantomData)
    }

    /// Number of rows.
    #[inline(always)]
    pub fn rows(&self) -> usize {
        self.0.rows
    }

    /// Number of columns.
    #[inline(always)]
    pub fn columns(&self) -> usize {
        self.0.columns
    }

    /// The same to read.
    #[inline(always)]
    pub fn as_view(&self) -> MatrixView<'_> {
        self.0
    }

    /// The place of an entry.
    ///
    /// # Safety
    /// It is one of the matrix.
    #[inline(always)]
    pub unsafe fn at(&mut self, row: usize, column: usize) -> *mut f64 {
        // SAFETY: promised by the caller.
        unsafe { self.0.at(row, column).cast_mut() }
    }

    /// The same for a shorter time.
    #[inline(always)]
    pub fn reborrow(&mut self) -> MatrixViewMut<'_> {
        MatrixViewMut(self.0, PhantomData)
    }

    /// Some of the rows and columns.
    #[inline(always)]
    pub fn block(self, rows: Range<usize>, columns: Range<usize>) -> Self {
        MatrixViewMut(self.0.block(rows, columns), PhantomData)
    }

    /// The first rows, and the others.
    pub fn split_rows(self, rows: usize) -> (Self, Self) {
        let MatrixView { rows: all_rows, columns, .. } = self.0;
        // two views of different entries
        let other = MatrixViewMut(self.0, PhantomData);
        (self.block(0..rows, 0..columns), other.block(rows..all_rows, 0..columns))
    }

    /// The first columns, and the others.
    pub fn split_columns(self, columns: usize) -> (Self, Self) {
        let MatrixView { rows, columns: all_columns, .. } = self.0;
        // two views of different entries
        let other = MatrixViewMut(self.0, PhantomData);
        (self.block(0..rows, 0..columns), other.block(0..rows, columns..all_columns))
    }

    /// One column.
    #[inline(always)]
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        assert!(column < self.columns(), "column {column} of {}", self.columns());
        // SAFETY: a column of the matrix is contiguous, and this view the only one of it.
        unsafe { std::slice::from_raw_parts_mut(self.at(0, column), self.rows()) }
    }

    /// The first `H` of some rows in the first `W` of some columns, if there are as many.
    #[inline(always)]
    pub fn tile_mut<const H: usize, const W: usize>(
        &mut self,
        rows: Range<usize>,
        columns: Range<usize>,
    ) -> Option<[&mut [f64; H]; W]> {
        let MatrixView { first, rows: height, columns: width, stride, .. } = self.0.block(rows, columns);
        // SAFETY: these entries are in the matrix, those of one column are contiguous and not in another one.
        let column = |w: usize| unsafe { &mut *first.cast_mut().add(w * stride).cast::<[f64; H]>() };
        (height >= H && width >= W).then(|| std::array::from_fn(column))
    }

    /// Takes over the entries of a matrix of the same size.
    pub fn copy_from(&mut self, source: MatrixView<'_>) {
        let size = (self.rows(), self.columns());
        assert_eq!(size, (source.rows, source.columns), "sizes of a matrix and its copy");
        (0..self.columns()).for_each(|column| self.column_mut(column).copy_from_slice(source.column(column)));
    }
}

#[inline(always)]
fn check(part: &Range<usize>, all: usize, what: &str) {
    assert!(part.start <= part.end && part.end <= all, "{what} {part:?} of {all}");
}

#[cfg(test)]
mod tests {
    use super::MatrixView;

    #[test]
    #[should_panic(expected = "rows 1..4 of 3")]
    fn a_block_beyond_the_matrix_is_refused() {
        let _ = MatrixView::new(&[0.0; 12], 3, 4).block(1..4, 0..1);
    }
}
