use super::Foreign;
use super::patterns::Matrix;
use std::ffi::{c_double, c_int, c_longlong, c_void};

unsafe extern "C" {
    fn mumps_begin(unknowns: c_int, entries: c_longlong, rows: *mut c_int, columns: *mut c_int) -> *mut c_void;
    fn mumps_code(mumps: *const c_void) -> c_int;
    fn mumps_megabytes(mumps: *const c_void) -> c_int;
    fn mumps_operations(mumps: *const c_void) -> c_double;
    fn mumps_factor(mumps: *mut c_void, values: *mut c_double);
    fn mumps_solve(mumps: *mut c_void, transposed: c_int, rhs: *mut c_double);
    fn mumps_end(mumps: *mut c_void);
}

/// MUMPS on one thread, with METIS where its library has that: what others are measured by.
pub struct Mumps {
    handle: *mut c_void,
    size: usize,
    /// MUMPS keeps the places of these two.
    rows: Vec<c_int>,
    _columns: Vec<c_int>,
    values: Vec<f64>,
}

impl Mumps {
    /// Analyses the pattern of a matrix.
    ///
    /// # Errors
    /// In words, with the code of MUMPS.
    pub fn new(matrix: &Matrix) -> Result<Self, String> {
        let pattern = &matrix.pattern;
        let number =
            |place: usize| c_int::try_from(place + 1).map_err(|_| format!("{place} unknowns are too many for MUMPS"));
        let mut rows = pattern.rows.iter().map(|&row| number(row as usize)).collect::<Result<Vec<_>, _>>()?;
        let mut columns = Vec::with_capacity(rows.len());
        for column in 0..pattern.size {
            let count = pattern.column_starts[column + 1] - pattern.column_starts[column];
            columns.extend(std::iter::repeat_n(number(column)?, count));
        }
        let size = number(pattern.size)? - 1;
        // SAFETY: both lists have `rows.len()` numbers and live as long as the handle.
        let handle = unsafe { mumps_begin(size, rows.len() as c_longlong, rows.as_mut_ptr(), columns.as_mut_ptr()) };
        if handle.is_null() {
            return Err("no memory for MUMPS".into());
        }
        Mumps { handle, size: pattern.size, rows, _columns: columns, values: matrix.values.clone() }.checked()
    }

    /// Itself, unless its last call failed.
    fn checked(self) -> Result<Self, String> {
        self.check()?;
        Ok(self)
    }

    fn check(&self) -> Result<(), String> {
        // SAFETY: the handle is that of `mumps_begin`.
        match unsafe { mumps_code(self.handle) } {
            code if code < 0 => Err(format!("MUMPS ended with code {code}")),
            _ => Ok(()),
        }
    }

    /// Operations of the elimination, by the analysis.
    pub fn operations(&self) -> f64 {
        // SAFETY: the handle is that of `mumps_begin`.
        unsafe { mumps_operations(self.handle) }
    }

    /// Memory of the factorization [MB].
    pub fn megabytes(&self) -> f64 {
        // SAFETY: as above.
        f64::from(unsafe { mumps_megabytes(self.handle) })
    }
}

impl Foreign for Mumps {
    fn factor(&mut self) -> Result<(), String> {
        assert_eq!(self.values.len(), self.rows.len(), "values and places of the entries");
        // SAFETY: as many values as the analysis was given entries; they live as long as the handle.
        unsafe { mumps_factor(self.handle, self.values.as_mut_ptr()) };
        self.check()
    }

    fn solve(&mut self, transposed: bool, rhs: &mut [f64]) -> Result<(), String> {
        assert_eq!(rhs.len(), self.size, "numbers and unknowns");
        // SAFETY: one number for each unknown.
        unsafe { mumps_solve(self.handle, c_int::from(transposed), rhs.as_mut_ptr()) };
        self.check()
    }
}

impl Drop for Mumps {
    fn drop(&mut self) {
        // SAFETY: nothing uses the handle after this.
        unsafe { mumps_end(self.handle) };
    }
}
