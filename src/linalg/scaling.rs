//! Scales of rows and columns, by powers of two.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::column_groups::ColumnGroups;
use super::multifrontal::largest;
use super::{Kernel, OwnUnknowns, SparsePattern, dispatch};
use std::ops::Range;
use std::sync::Arc;

/// Smallest entry, as a share of its column, by which an unknown is scaled or tied: rows and columns of our matrices have like sizes, and what is smaller
/// is round-off of an entry that vanishes.
const SMALL: f64 = 1e-10;

/// Scaled entry of a stiff unknown in the equation of a multiplier, as a share of that of one to be called soft.
const SOFT: f64 = 1e-5;

/// Share of the largest entry of its row and of its column by which a weak unknown is tied to scaled ones: the strongest ties are taken first,
/// each next kind is so much weaker, down to [`SMALL`].
const WEAKER: f64 = 0.1;

/// Place of a diagonal entry that is not in the pattern.
const NO_PLACE: u32 = u32::MAX;

/// Powers of two that bring the diagonal near 1 where there is one, and the rows and columns of multipliers to its
/// scale.
///
/// A light body then has pivots as good as those of a heavy one, and none has to be looked for among the constraints.
pub struct Scaling {
    pattern: Arc<SparsePattern>,
    /// Scales of rows.
    pub rows: Vec<f64>,
    /// Scales of columns.
    pub columns: Vec<f64>,
    layout: Arc<Layout>,
    /// Unknowns without a diagonal entry to be scaled by, as multipliers.
    weak: Vec<u32>,
    /// Places and columns of the entries in their rows, and where those of each begin.
    weak_entries: Vec<(u32, u32)>,
    weak_starts: Vec<u32>,
    /// Workspace: rows, places and columns while they are sorted, and strengths of ties with the numbers of weak
    /// unknowns.
    listed: Vec<(u32, u32, u32)>,
    order: Vec<(f64, usize)>,
    /// Whether some of them are tied to each other.
    is_mixed: bool,
}

/// What all scalings of a pattern share.
struct Layout {
    groups: ColumnGroups,
    /// Groups of columns that are own ones or have own rows; all where no ranks share the matrix.
    own: Vec<Range<usize>>,
    /// Place of each diagonal entry.
    diagonal: Vec<u32>,
}

impl Scaling {
    /// Of a pattern; there are no scales before values are given.
    pub fn new(pattern: Arc<SparsePattern>, own: Option<&OwnUnknowns>) -> Self {
        assert!(pattern.rows.len() < NO_PLACE as usize, "{} entries are more than 2^32", pattern.rows.len());
        let place = |i: usize| pattern.position(i, i).map_or(NO_PLACE, |place| place as u32);
        let diagonal = (0..pattern.size).map(place).collect();
        let groups = ColumnGroups::new(pattern.clone());
        let own = own.map_or(vec![groups.all()], |own| groups.chosen(|columns, rows| own.touches(columns, rows)));
        let layout = Arc::new(Layout { groups, own, diagonal });
        Self::of(pattern, layout)
    }

    /// Another one of the pattern.
    pub fn clone_analysis(&self) -> Self {
        Self::of(self.pattern.clone(), self.layout.clone())
    }

    fn of(pattern: Arc<SparsePattern>, layout: Arc<Layout>) -> Self {
        Scaling {
            rows: Vec::new(),
            columns: Vec::new(),
            layout,
            weak: Vec::new(),
            weak_entries: Vec::new(),
            weak_starts: vec![0],
            listed: Vec::new(),
            order: Vec::new(),
            is_mixed: false,
            pattern,
        }
    }

    fn entries(&self, column: usize) -> Range<usize> {
        self.pattern.column_starts[column]..self.pattern.column_starts[column + 1]
    }

    /// Sets the scales for values.
    ///
    /// * `largest`    of the values
    /// * `refined_scaling` whether unknowns that multipliers tie to far stiffer ones count as weak
    pub fn set(&mut self, values: &[f64], largest: f64, refined_scaling: bool) {
        if !self.scale_by_diagonals(values, largest) {
            self.find_weak();
        }
        if refined_scaling && self.release(values) {
            self.find_weak();
        }
        self.scale_weak(values, refined_scaling);
    }

    /// The same for values of which each rank has the rows and columns of its own unknowns: those of weak ones are brought together.
    pub fn set_own(&mut self, values: &mut [f64], largest: f64, refined_scaling: bool, own: &OwnUnknowns) {
        self.scale_by_diagonals(values, largest);
        own.gather(&mut self.rows);
        self.columns.copy_from_slice(&self.rows);
        let weak = (0..self.pattern.size as u32).filter(|&unknown| self.columns[unknown as usize] == 0.0);
        if !weak.eq(self.weak.iter().copied()) {
            self.find_weak();
        }
        own.complete(values, &self.pattern, &self.weak_entries, &self.weak);
        if refined_scaling && self.release(values) {
            self.find_weak();
            own.complete(values, &self.pattern, &self.weak_entries, &self.weak);
        }
        self.scale_weak(values, refined_scaling);
    }

    /// Scales unknowns by their diagonal entries, those without with zero; returns whether these are the ones that are listed.
    fn scale_by_diagonals(&mut self, values: &[f64], largest_value: f64) -> bool {
        let Scaling { pattern, rows, columns, layout, weak, .. } = self;
        assert_eq!(values.len(), pattern.rows.len(), "values and entries of the pattern");
        [&mut *rows, &mut *columns].into_iter().for_each(|scales| scales.resize(pattern.size, 1.0));
        // what is large enough beside all values is so beside those of its column
        let surely_large = SMALL * largest_value;
        let (mut next, mut same) = (0, true);
        for (unknown, (&place, (row, column))) in layout.diagonal.iter().zip(rows.iter_mut().zip(columns)).enumerate() {
            let diagonal = if let Some(value) = values.get(place as usize) { value.abs() } else { 0.0 };
            let own = || &values[pattern.column_starts[unknown]..pattern.column_starts[unknown + 1]];
            let scale = if diagonal > surely_large || diagonal > 0.0 && diagonal > SMALL * largest(own()) {
                inverse_power_of_root(diagonal)
            } else {
                same &= weak.get(next) == Some(&(unknown as u32));
                next += 1;
                0.0
            };
            (*row, *column) = (scale, scale);
        }
        same && next == weak.len()
    }

    /// Scales the rows of weak unknowns against the unknowns that are scaled, then their columns.
    fn scale_weak(&mut self, values: &[f64], refined_scaling: bool) {
        if !refined_scaling {
            // listed once as a rule
            self.listed = Vec::new();
        }
        if self.is_mixed {
            return self.scale_mixed(values);
        }
        for number in 0..self.weak.len() {
            self.rows[self.weak[number] as usize] = inverse_power(self.row_size(number, values));
        }
        for number in 0..self.weak.len() {
            let unknown = self.weak[number] as usize;
            self.columns[unknown] = inverse_power(self.column_size(unknown, values));
        }
    }

    /// The values in the scales of now.
    pub fn apply(&self, values: &[f64], scaled: &mut [f64]) {
        self.layout.groups.scale(&[self.layout.groups.all()], values, &self.rows, &self.columns, scaled);
    }

    /// The same of columns that are own ones or have own rows, where ranks share the matrix.
    pub fn apply_to_own(&self, values: &[f64], scaled: &mut [f64]) {
        self.layout.groups.scale(&self.layout.own, values, &self.rows, &self.columns, scaled);
    }

    /// Largest entry of a row of a weak unknown in the columns scaled by now.
    #[inline(always)]
    fn row_size(&self, number: usize, values: &[f64]) -> f64 {
        let own = &self.weak_entries[self.weak_starts[number] as usize..self.weak_starts[number + 1] as usize];
        let mut most = 0.0;
        for &(place, column) in own {
            let size = values[place as usize].abs() * self.columns[column as usize];
            most = if size > most { size } else { most };
        }
        most
    }

    /// Largest entry of a column in the rows scaled by now.
    #[inline(always)]
    fn column_size(&self, column: usize, values: &[f64]) -> f64 {
        let own = self.entries(column);
        let mut most = 0.0;
        for (value, &row) in values[own.clone()].iter().zip(&self.pattern.rows[own]) {
            let size = value.abs() * self.rows[row as usize];
            most = if size > most { size } else { most };
        }
        most
    }

    /// Share of the largest entries of a weak unknown's row and column that ties it to unknowns scaled by now.
    fn tie(&self, number: usize, values: &[f64]) -> f64 {
        let of_row = &self.weak_entries[self.weak_starts[number] as usize..self.weak_starts[number + 1] as usize];
        let of_row = of_row.iter().map(|&(place, column)| (values[place as usize].abs(), self.columns[column as usize]));
        let own = self.entries(self.weak[number] as usize);
        let of_column = values[own.clone()].iter().zip(&self.pattern.rows[own]);
        let of_column = of_column.map(|(value, &row)| (value.abs(), self.rows[row as usize]));
        let larger = |[all, scaled]: [f64; 2], (size, scale): (f64, f64)| {
            [all.max(size), if scale > 0.0 { scaled.max(size) } else { scaled }]
        };
        let share = |[all, scaled]: [f64; 2]| if scaled > 0.0 { scaled / all } else { 0.0 };
        share(of_row.fold([0.0; 2], larger)).min(share(of_column.fold([0.0; 2], larger)))
    }

    /// Scales weak unknowns that are tied to each other, as multipliers to a body that nothing else holds or that has no inertia: those first
    /// that are tied most to scaled ones, each against all that are scaled by then. By its unscaled entries such a body would hide those of
    /// the soft or light neighbours of its links; by an entry that nearly vanishes, as that of a turn about an axis that passes through the
    /// one of its link, it would hide all others.
    fn scale_mixed(&mut self, values: &[f64]) {
        let mut order = std::mem::take(&mut self.order);
        let strength = |number: usize| self.row_size(number, values) * self.column_size(self.weak[number] as usize, values);
        order.clear();
        order.extend((0..self.weak.len()).map(|number| (strength(number), number)));
        order.sort_unstable_by(|(a, first), (b, second)| b.total_cmp(a).then(first.cmp(second)));
        let mut least = WEAKER;
        while least > SMALL && !order.is_empty() {
            let left = order.len();
            order.retain(|&(_, number)| {
                let is_tied = self.tie(number, values) >= least;
                if is_tied {
                    self.scale_by_ties(number, values);
                }
                !is_tied
            });
            least = if order.len() < left { WEAKER } else { least * WEAKER };
        }
        for &(_, number) in &order {
            let unknown = self.weak[number] as usize;
            (self.rows[unknown], self.columns[unknown]) = (1.0, 1.0);
        }
        self.order = order;
    }

    /// Scales the row and the column of a weak unknown against the scaled ones.
    fn scale_by_ties(&mut self, number: usize, values: &[f64]) {
        let unknown = self.weak[number] as usize;
        let row = inverse_power(self.row_size(number, values));
        let column = inverse_power(self.column_size(unknown, values));
        let diagonal = values.get(self.layout.diagonal[unknown] as usize).map_or(0.0, |value| value.abs());
        let own = diagonal * row * column;
        // what is left of a diagonal does not outgrow the rest
        let shrunk = if own > 1.0 { inverse_power(own.sqrt()) } else { 1.0 };
        (self.rows[unknown], self.columns[unknown]) = (row * shrunk, column * shrunk);
    }

    /// Takes their scales from unknowns whose diagonal is nothing beside that of others in the equation of a
    /// multiplier: of a body without stiffness it is what its reactions turn it by, and pivots of that size would take
    /// the digits of all its links.
    fn release(&mut self, values: &[f64]) -> bool {
        let mut released = false;
        for rows in self.weak_starts.windows(2) {
            let own = &self.weak_entries[rows[0] as usize..rows[1] as usize];
            let value = |place: u32| values[place as usize].abs();
            let largest = own.iter().fold(0.0, |most: f64, &(place, _)| most.max(value(place)));
            let is_large = |&&(place, _): &&(u32, u32)| value(place) > SMALL * largest;
            let sizes = own.iter().filter(is_large).map(|&(place, column)| value(place) * self.columns[column as usize]);
            let stiffest = sizes.filter(|&size| size > 0.0).fold(f64::INFINITY, f64::min);
            for &(place, column) in own {
                let column = column as usize;
                if value(place) * self.columns[column] * SOFT > stiffest {
                    (self.rows[column], self.columns[column]) = (0.0, 0.0);
                    released = true;
                }
            }
        }
        released
    }

    /// Lists the unknowns whose scale is still zero, and the entries in their rows.
    fn find_weak(&mut self) {
        self.weak.clear();
        self.weak.extend((0..self.pattern.size as u32).filter(|&unknown| self.columns[unknown as usize] == 0.0));
        let mut entries = std::mem::take(&mut self.listed);
        entries.clear();
        for column in 0..self.pattern.size {
            let own = self.entries(column).map(|place| (self.pattern.rows[place], place as u32, column as u32));
            entries.extend(own.filter(|&(row, ..)| self.columns[row as usize] == 0.0));
        }
        entries.sort_unstable();
        self.weak_entries.clear();
        self.weak_entries.extend(entries.iter().map(|&(_, place, column)| (place, column)));
        let start = |&row: &u32| entries.partition_point(|entry| entry.0 < row) as u32;
        self.weak_starts.clear();
        self.weak_starts.extend(self.weak.iter().map(start).chain([entries.len() as u32]));
        self.listed = entries;
        self.is_mixed = self.weak_entries.iter().any(|&(_, column)| self.columns[column as usize] == 0.0);
    }
}

/// The largest absolute value, if all are numbers.
pub fn largest_finite(values: &[f64]) -> Option<f64> {
    dispatch(LargestFinite(values))
}

struct LargestFinite<'v>(&'v [f64]);

impl Kernel for LargestFinite<'_> {
    type Output = Option<f64>;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Option<f64> {
        // bits of positive numbers are in their order, before those of what is none
        let mut most = 0;
        for value in self.0 {
            most = most.max(value.abs().to_bits());
        }
        Some(f64::from_bits(most)).filter(|most| most.is_finite())
    }
}

/// The inverse of the power of two near a normal number, by its exponent; 1 for zero.
#[inline(always)]
fn inverse_power(size: f64) -> f64 {
    let exponent = size.to_bits() >> 52;
    if (1..2046).contains(&exponent) { f64::from_bits((2046 - exponent) << 52) } else { 1.0 }
}

/// The same for the root of a number.
#[inline(always)]
fn inverse_power_of_root(size: f64) -> f64 {
    let exponent = size.to_bits() >> 52;
    // half of it, counted from the exponent of 1
    let exponent = (exponent + 1023) >> 1;
    f64::from_bits((2046 - exponent) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_below_a_number_and_below_its_root() {
        for size in [1.0, 2.0, 3.9, 4.0, 0.5, 0.26, 0.25, 1e-300, 7e300] {
            let (power, root) = (1.0 / inverse_power(size), 1.0 / inverse_power_of_root(size));
            assert!(power <= size && size < 2.0 * power, "{size:e}: {power:e}");
            assert!(root * root <= size && size < 4.0 * root * root, "{size:e}: {root:e}");
        }
    }
}
