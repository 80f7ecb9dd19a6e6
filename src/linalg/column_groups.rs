//! Passes over a matrix whose columns come in groups with the same rows, as those of a node's unknowns: what belongs to
//! the rows is fetched once for a group.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::{Kernel, SparsePattern, dispatch};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Entries that a thread takes at once.
pub const AT_ONCE: usize = 1 << 16;
/// Entries of a matrix from which on threads share a pass over it: waking them takes as long as less.
const MANY: usize = 1 << 20;

/// Whether threads share a pass over some entries.
pub fn is_shared_by_threads(entries: usize) -> bool {
    entries > MANY && rayon::current_num_threads() > 1
}

/// Most rows whose numbers are fetched for a group.
const FETCHED: usize = 64;

/// The columns of a pattern in groups that follow each other and have the same rows.
pub struct ColumnGroups {
    pattern: Arc<SparsePattern>,
    /// First column of each, and the end.
    starts: Vec<u32>,
}

impl ColumnGroups {
    /// Of a pattern.
    pub fn new(pattern: Arc<SparsePattern>) -> Self {
        let n = pattern.size;
        let rows_of = |column: usize| &pattern.rows[pattern.column_starts[column]..pattern.column_starts[column + 1]];
        let begins = |&column: &usize| column == 0 || rows_of(column) != rows_of(column - 1);
        let starts = (0..n).filter(begins).chain([n]).map(|column| column as u32).collect();
        ColumnGroups { pattern, starts }
    }

    /// Groups of which something holds that depends on their columns and rows, in ranges.
    pub fn chosen(&self, holds: impl Fn(Range<usize>, &[u32]) -> bool) -> Vec<Range<usize>> {
        ranges_where(self.all().end, |number| {
            let columns = self.starts[number] as usize..self.starts[number + 1] as usize;
            holds(columns, &self.pattern.rows[self.entries(number)..][..self.rows_of(number)])
        })
    }

    /// All groups.
    pub fn all(&self) -> Range<usize> {
        0..self.starts.len() - 1
    }

    /// Place of the first entry of a group.
    fn entries(&self, group: usize) -> usize {
        self.pattern.column_starts[self.starts[group] as usize]
    }

    /// Rows of a group.
    fn rows_of(&self, group: usize) -> usize {
        self.pattern.column_starts[self.starts[group] as usize + 1] - self.entries(group)
    }

    /// Multiplies values of some groups by scales of their rows and columns, on all threads where they are many.
    pub fn scale(&self, groups: &[Range<usize>], values: &[f64], rows: &[f64], columns: &[f64], scaled: &mut [f64]) {
        let scale = |(numbers, scaled): (Range<usize>, &mut [f64])| {
            dispatch(Scale { groups: self, numbers, values, rows, columns, scaled });
        };
        if !is_shared_by_threads(values.len()) {
            let places = |groups: &Range<usize>| self.entries(groups.start)..self.entries(groups.end);
            return groups.iter().for_each(|groups| scale((groups.clone(), &mut scaled[places(groups)])));
        }
        let (mut parts, mut rest, mut at) = (Vec::new(), scaled, 0);
        for groups in groups {
            let mut first = groups.start;
            while first < groups.end {
                let begin = self.entries(first);
                let behind = self.starts[first..=groups.end]
                    .partition_point(|&start| self.pattern.column_starts[start as usize] <= begin + AT_ONCE);
                let end = (first + behind.max(2) - 1).min(groups.end);
                let (_, from) = rest.split_at_mut(begin - at);
                let (own, after) = from.split_at_mut(self.entries(end) - begin);
                parts.push((first..end, own));
                (rest, at, first) = (after, self.entries(end), end);
            }
        }
        parts.into_par_iter().for_each(scale);
    }
}

/// Numbers below a count of which something holds, in ranges.
pub fn ranges_where(count: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    for number in (0..count).filter(|&number| holds(number)) {
        match ranges.last_mut() {
            Some(last) if last.end == number => last.end += 1,
            _ => ranges.push(number..number + 1),
        }
    }
    ranges
}

/// Scales values.
struct Scale<'s> {
    groups: &'s ColumnGroups,
    /// Which groups; `scaled` has their entries.
    numbers: Range<usize>,
    values: &'s [f64],
    rows: &'s [f64],
    columns: &'s [f64],
    scaled: &'s mut [f64],
}

impl Kernel for Scale<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Scale { groups, numbers, values, rows: row_scales, columns, scaled } = self;
        let ColumnGroups { pattern, starts } = groups;
        let origin = groups.entries(numbers.start);
        let mut fetched = [0.0; FETCHED];
        for bounds in starts[numbers.start..=numbers.end].windows(2) {
            let (first, end) = (bounds[0] as usize, bounds[1] as usize);
            let mut place = pattern.column_starts[first];
            let rows = &pattern.rows[place..pattern.column_starts[first + 1]];
            if rows.len() <= FETCHED {
                fetched.iter_mut().zip(rows).for_each(|(fetched, &row)| *fetched = row_scales[row as usize]);
            }
            for &column in &columns[first..end] {
                let values = &values[place..][..rows.len()];
                let scaled = &mut scaled[place - origin..][..rows.len()];
                if rows.len() <= FETCHED {
                    for row in 0..rows.len() {
                        scaled[row] = values[row] * (fetched[row] * column);
                    }
                } else {
                    for (row, &unknown) in rows.iter().enumerate() {
                        scaled[row] = values[row] * (row_scales[unknown as usize] * column);
                    }
                }
                place += rows.len();
            }
        }
    }
}
