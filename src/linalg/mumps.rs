//! MUMPS instead of the own solver: of one process, or of all ranks that share a system, each of which gives it the entries of its own columns.
//!
//! Which ranks share a system, and which columns are whose, is decided as for the own solver. Solutions are those of the first rank. Their
//! last digits are not the same from one number of ranks to another, and on several not from one run to another either.
//!
//! Source: Amestoy, Duff, Koster & L'Excellent, SIAM J. Matrix Anal. Appl. 23 (2001), "A fully asynchronous multifrontal solver using distributed
//! dynamic scheduling".

use super::multifrontal::{Inertia, MultifrontalLu};
use super::{LinearSolver, Singular, SparsePattern};
use crate::exchange::{self, Exchange};
use std::ffi::{c_double, c_int, c_longlong, c_void};
use std::sync::{Mutex, PoisonError};

unsafe extern "C" {
    fn mumps_begin(
        communicator: c_int,
        unknowns: c_int,
        entries: c_longlong,
        rows: *mut c_int,
        columns: *mut c_int,
    ) -> *mut c_void;
    fn mumps_code(mumps: *const c_void) -> c_int;
    fn mumps_ordering(mumps: *const c_void) -> c_int;
    fn mumps_megabytes(mumps: *const c_void) -> c_int;
    fn mumps_operations(mumps: *const c_void) -> c_double;
    fn mumps_entries(mumps: *const c_void) -> c_double;
    fn mumps_factor(mumps: *mut c_void, values: *mut c_double);
    fn mumps_unknown_without_pivot(mumps: *const c_void) -> c_int;
    fn mumps_solve(mumps: *mut c_void, transposed: c_int, count: c_int, rhs: *mut c_double);
    fn mumps_end(mumps: *mut c_void);
}

/// Its functions share variables: one thread at a time.
static CALLS: Mutex<()> = Mutex::new(());

/// Code for a pattern or a matrix that is singular.
const SINGULAR: [c_int; 2] = [-6, -10];

/// What its codes of orderings mean, from zero on.
const ORDERINGS: [&str; 7] = ["AMD", "given", "AMF", "Scotch", "PORD", "METIS", "QAMD"];

/// LU of MUMPS for matrices of one pattern.
pub struct MumpsLu {
    handle: *mut c_void,
    /// The own solver of the pattern, which says whose columns are whose, and counts signs.
    own: MultifrontalLu,
    /// Ranks that share it; none where this process has it alone.
    ranks: Option<&'static dyn Exchange>,
    size: usize,
    /// Where the entries that are given here stand among all, and their rows and columns, which MUMPS reads as long as it is there.
    places: Vec<u32>,
    _entries: [Vec<c_int>; 2],
    values: Vec<f64>,
}

// SAFETY: whatever thread calls it, one at a time does.
unsafe impl Send for MumpsLu {}

fn number(place: usize) -> c_int {
    c_int::try_from(place).unwrap_or_else(|_| panic!("{place} unknowns are too many for MUMPS"))
}

impl MumpsLu {
    /// Analyses a pattern, for the ranks that share the own solver of it.
    ///
    /// # Errors
    /// [`Singular`] if no values could make the pattern regular.
    pub fn new(pattern: &SparsePattern, own: MultifrontalLu) -> Result<Self, Singular> {
        let ranks = (own.ranks() > 1).then(exchange::world);
        let columns: Vec<u32> = match own.own_unknowns() {
            Some(unknowns) => unknowns.own().to_vec(),
            None => (0..pattern.size as u32).collect(),
        };
        let (mut places, mut entries) = (Vec::new(), [Vec::new(), Vec::new()]);
        for column in columns.into_iter().map(|column| column as usize) {
            for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                places.push(place as u32);
                entries[0].push(number(pattern.rows[place] as usize + 1));
                entries[1].push(number(column + 1));
            }
        }
        let [rows, columns] = &mut entries;
        let (size, count) = (number(pattern.size), places.len() as c_longlong);
        let communicator = ranks.and_then(|ranks| ranks.communicator(0..ranks.ranks())).unwrap_or(-1);
        let handle = {
            let _only = CALLS.lock().unwrap_or_else(PoisonError::into_inner);
            // SAFETY: both lists have `count` numbers and live as long as the handle; all ranks of the communicator do this.
            unsafe { mumps_begin(communicator, size, count, rows.as_mut_ptr(), columns.as_mut_ptr()) }
        };
        assert!(!handle.is_null(), "no memory for MUMPS");
        let values = vec![0.0; places.len()];
        let new = MumpsLu { handle, own, ranks, size: pattern.size, places, _entries: entries, values };
        match new.is_singular() {
            true => Err(Singular { unknown: 0 }),
            false => Ok(new),
        }
    }

    /// Whether the last call found a singular matrix; any other error is the end.
    fn is_singular(&self) -> bool {
        // SAFETY: the handle is that of `mumps_begin`.
        let code = unsafe { mumps_code(self.handle) };
        let is_singular = SINGULAR.contains(&code);
        assert!(code >= 0 || is_singular, "MUMPS ended with code {code}, which its manual explains");
        is_singular
    }

    /// The own solver of the pattern.
    pub fn own(&self) -> &MultifrontalLu {
        &self.own
    }

    /// The ordering that it took.
    pub fn ordering(&self) -> &'static str {
        // SAFETY: the handle is that of `mumps_begin`.
        let code = unsafe { mumps_ordering(self.handle) };
        usize::try_from(code).ok().and_then(|code| ORDERINGS.get(code).copied()).unwrap_or("unknown")
    }

    /// Operations of the elimination, by the analysis.
    pub fn operations(&self) -> f64 {
        // SAFETY: as above.
        unsafe { mumps_operations(self.handle) }
    }

    /// Entries of L and U, by the analysis.
    pub fn entries(&self) -> f64 {
        // SAFETY: as above.
        unsafe { mumps_entries(self.handle) }
    }

    /// Memory of the factorization, of all ranks together \[MB\].
    pub fn megabytes(&self) -> f64 {
        // SAFETY: as above.
        f64::from(unsafe { mumps_megabytes(self.handle) })
    }

    fn solve_side(&mut self, transposed: bool, rhs: &mut [f64]) {
        assert_eq!(rhs.len() % self.size.max(1), 0, "numbers and unknowns");
        let count = number(rhs.len() / self.size.max(1));
        {
            let _only = CALLS.lock().unwrap_or_else(PoisonError::into_inner);
            // SAFETY: so many numbers for each unknown; all ranks that share the system do this.
            unsafe { mumps_solve(self.handle, c_int::from(transposed), count, rhs.as_mut_ptr()) };
        }
        assert!(!self.is_singular(), "factors that were there");
        if let Some(ranks) = self.ranks {
            let is_first = ranks.rank() == 0;
            let counts: Vec<usize> = (0..ranks.ranks()).map(|rank| if rank == 0 { rhs.len() } else { 0 }).collect();
            let of_first = ranks.gather(if is_first { rhs } else { &[] }, &counts);
            rhs.copy_from_slice(&of_first);
        }
    }
}

impl LinearSolver for MumpsLu {
    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.values.iter_mut().zip(&self.places).for_each(|(own, &place)| *own = values[place as usize]);
        let mut unknown = {
            let _only = CALLS.lock().unwrap_or_else(PoisonError::into_inner);
            // SAFETY: as many values as the analysis was given entries, which live as long as the handle; all ranks that share the system do this.
            unsafe {
                mumps_factor(self.handle, self.values.as_mut_ptr());
                f64::from(mumps_unknown_without_pivot(self.handle))
            }
        };
        let is_singular = self.is_singular();
        if let Some(ranks) = self.ranks {
            unknown = ranks.gather(&[unknown], &vec![1; ranks.ranks()])[0];
        }
        match unknown as usize {
            0 if is_singular => Err(Singular { unknown: 0 }),
            0 => Ok(()),
            unknown => Err(Singular { unknown: unknown - 1 }),
        }
    }

    fn inertia(&self, values: &[f64], known: usize) -> Inertia {
        self.own.inertia(values, known)
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_side(false, rhs);
    }

    fn solve_transposed(&mut self, rhs: &mut [f64]) {
        self.solve_side(true, rhs);
    }
}

impl Drop for MumpsLu {
    fn drop(&mut self) {
        let _only = CALLS.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: nothing uses the handle after this.
        unsafe { mumps_end(self.handle) };
    }
}
