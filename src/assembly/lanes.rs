//! Arguments and results of parts that are evaluated side by side.

use super::batches::Batch;
use super::gather_map::Starts;
use super::null_spaces::{LEFT, NullSpaces, RIGHT};
use crate::elements::RunScalar;
use std::ops::Range;

/// What is done with as many lanes as a program has, for a constant `$width`.
macro_rules! by_width {
    ($lanes:expr, $width:ident => $done:expr) => {
        match $lanes {
            1 => {
                const $width: usize = 1;
                $done
            }
            2 => {
                const $width: usize = 2;
                $done
            }
            4 => {
                const $width: usize = 4;
                $done
            }
            8 => {
                const $width: usize = 8;
                $done
            }
            _ => unreachable!("programs have 2, 4 or 8 lanes"),
        }
    };
}

/// Arguments of parts that are evaluated side by side, written one after the other: number i of lane l stands at i times their width + l.
pub(crate) struct Lanes<'i, S> {
    pub(super) numbers: &'i mut [S],
    pub(super) width: usize,
    /// The parts, one for each lane; further lanes have the numbers of the last one.
    pub parts: Range<usize>,
    pub(super) place: usize,
}

impl<S: RunScalar> Lanes<'_, S> {
    /// The next numbers of each part come from a list.
    #[inline(always)]
    pub fn gather(&mut self, starts: &Starts, values: &[S]) {
        let end = self.place + starts.length;
        self.gather_range(self.place..end, starts, values);
        self.place = end;
    }

    /// Arguments are the first so many numbers of each part.
    #[inline(always)]
    fn gather_range(&mut self, arguments: Range<usize>, starts: &Starts, values: &[S]) {
        let target = &mut self.numbers[arguments.start * self.width..arguments.end * self.width];
        let (places, length) = (starts.places_from(self.parts.start), arguments.len());
        by_width!(self.width, WIDTH => match WIDTH {
            1 => target.copy_from_slice(&values[places[0] as usize..][..length]),
            _ => gather::<S, WIDTH>(length, places, values, target),
        })
    }

    /// Runs of arguments come from a list, wherever they stand among the arguments.
    pub fn gather_runs(&mut self, runs: &[Run], lists: &[Starts], values: &[S]) {
        for Run { numbers, list, offset } in runs {
            self.gather_range(numbers.clone(), &lists[*list], &values[*offset..]);
        }
    }

    /// The argument at a place, and those behind it, are the same for all parts.
    pub fn spread_at(&mut self, place: usize, values: &[S]) {
        let rows = self.numbers[place * self.width..].chunks_exact_mut(self.width);
        rows.zip(values).for_each(|(row, &value)| row.fill(value));
    }

    /// The next numbers of each part are those of its nodes in one list after the other.
    #[inline(always)]
    pub fn gather_nodes<const LISTS: usize>(&mut self, segments: &[Starts], lists: [&[S]; LISTS]) {
        let count: usize = segments.iter().map(|starts| starts.length).sum();
        let mut first = self.place;
        for starts in segments {
            for (list, values) in lists.iter().enumerate() {
                let place = first + list * count;
                self.gather_range(place..place + starts.length, starts, values);
            }
            first += starts.length;
        }
        self.place += LISTS * count;
    }
    /// The next number is the same for all parts.
    #[inline(always)]
    pub fn spread(&mut self, value: S) {
        self.numbers[self.place * self.width..(self.place + 1) * self.width].fill(value);
        self.place += 1;
    }
    /// Leaves so many numbers what they are.
    pub fn skip(&mut self, count: usize) {
        self.place += count;
    }
}

impl Lanes<'_, f64> {
    /// The next numbers of each part are those that the bases of its nodes are made of.
    #[inline(always)]
    pub(super) fn gather_bases<L>(&mut self, batch: &Batch<L>, bases: &NullSpaces) {
        for starts in &batch.bases {
            for side in [LEFT, RIGHT] {
                self.gather(starts, bases.numbers(side));
            }
        }
    }
}

/// Numbers of parts, one after the other in a list, moved to lie side by side.
#[inline(always)]
fn gather<S: Copy, const WIDTH: usize>(length: usize, starts: &[u32], values: &[S], target: &mut [S]) {
    #[inline(always)]
    fn block<S: Copy, const WIDTH: usize, const LENGTH: usize>(
        starts: &[u32; WIDTH],
        first: usize,
        values: &[S],
        rows: &mut [[S; WIDTH]],
    ) {
        let rows: &mut [[S; WIDTH]; LENGTH] = (&mut rows[first..first + LENGTH]).try_into().expect("its own length");
        for lane in 0..WIDTH {
            let start = starts[lane] as usize + first;
            let own: &[S; LENGTH] = values[start..start + LENGTH].try_into().expect("its own length");
            (0..LENGTH).for_each(|place| rows[place][lane] = own[place]);
        }
    }
    let starts: &[u32; WIDTH] = starts.first_chunk().expect("one for each lane");
    let rows = target.as_chunks_mut::<WIDTH>().0;
    if length == 7 {
        return block::<S, WIDTH, 7>(starts, 0, values, rows);
    }
    let mut first = 0;
    while first + 8 <= length {
        block::<S, WIDTH, 8>(starts, first, values, rows);
        first += 8;
    }
    if first + 4 <= length {
        block::<S, WIDTH, 4>(starts, first, values, rows);
        first += 4;
    }
    if first + 2 <= length {
        block::<S, WIDTH, 2>(starts, first, values, rows);
        first += 2;
    }
    if first < length {
        block::<S, WIDTH, 1>(starts, first, values, rows);
    }
}

/// values += factor times the numbers of a lane.
#[inline(always)]
fn add_lane<S: RunScalar, const WIDTH: usize>(own: &[[S; WIDTH]], lane: usize, factor: f64, values: &mut [S]) {
    #[inline(always)]
    fn add<S: RunScalar, const WIDTH: usize>(own: &[[S; WIDTH]], lane: usize, factor: f64, values: &mut [S]) {
        if factor == 1.0 {
            values.iter_mut().zip(own).for_each(|(value, row)| *value += row[lane]);
        } else {
            values.iter_mut().zip(own).for_each(|(value, row)| *value += row[lane] * factor);
        }
    }
    // a body, Euler parameters alone: without a loop
    if let (Ok(own), Ok(values)) = (<&[[S; WIDTH]; 7]>::try_from(own), <&mut [S; 7]>::try_from(&mut *values)) {
        add(own, lane, factor, values);
    } else if let (Ok(own), Ok(values)) = (<&[[S; WIDTH]; 4]>::try_from(own), <&mut [S; 4]>::try_from(&mut *values)) {
        add(own, lane, factor, values);
    } else {
        add(own, lane, factor, values);
    }
}

/// Arguments or results that follow each other and belong to numbers of a part that do so, too.
#[derive(Debug)]
pub(crate) struct Run {
    /// The arguments or results.
    numbers: Range<usize>,
    /// In which list of starts the part's numbers begin.
    list: usize,
    /// How far behind their begin.
    offset: usize,
}

impl Run {
    /// Adds an argument or result, behind those of the last run if it goes on there.
    pub fn extend(runs: &mut Vec<Run>, number: usize, list: usize, offset: usize) {
        match runs.last_mut() {
            Some(last) if last.list == list && last.numbers.end == number && last.offset + last.numbers.len() == offset => {
                last.numbers.end += 1;
            }
            _ => runs.push(Run { numbers: number..number + 1, list, offset }),
        }
    }
}

/// Results of parts that were evaluated side by side.
pub(crate) struct LaneResults<'r, S> {
    pub(super) numbers: &'r [S],
    pub(super) width: usize,
    /// The parts, one for each lane.
    pub parts: Range<usize>,
}

/// A rounding of a number of order one, up or down by its place in a list: in no pattern that numbers could follow.
pub fn last_bit(place: usize) -> f64 {
    let up = (place as u32).wrapping_mul(0x9e37_79b9).wrapping_add(0x7f4a_7c15) >> 31 == 0;
    if up { f64::EPSILON } else { -f64::EPSILON }
}

impl<S: RunScalar> LaneResults<'_, S> {
    /// Adds the last bits of the first results, some up and some down, to the coordinates of the parts' nodes: what adding them up may lose.
    pub fn add_last_bits(&self, segments: &[Starts], values: &mut [S]) {
        for (lane, part) in self.parts.clone().enumerate() {
            let mut numbers = Strided { numbers: self.numbers.get(lane..).unwrap_or_default(), width: self.width };
            for place in segments.iter().flat_map(|starts| starts.of(part)) {
                let Some(own) = numbers.next() else { return };
                values[place] += own * last_bit(part.wrapping_mul(31).wrapping_add(place));
            }
        }
    }

    /// Adds results from a place on, times a factor, to the coordinates of the parts' nodes, part by part; returns the place behind them.
    #[inline(always)]
    pub fn add_to_nodes(&self, first: usize, segments: &[Starts], factor: f64, values: &mut [S]) -> usize {
        by_width!(self.width, WIDTH => self.add_rows::<WIDTH>(first, segments, factor, values))
    }

    #[inline(always)]
    fn add_rows<const WIDTH: usize>(&self, first: usize, segments: &[Starts], factor: f64, values: &mut [S]) -> usize {
        let rows = self.numbers.as_chunks::<WIDTH>().0;
        let mut behind = first;
        for lane in 0..self.parts.len().min(WIDTH) {
            behind = first;
            for starts in segments {
                let own = &rows[behind..behind + starts.length];
                behind += starts.length;
                add_lane(own, lane, factor, &mut values[starts.of(self.parts.start + lane)]);
            }
        }
        behind
    }

    /// Adds runs of results, the first of which stands at a place, times a factor, to the numbers of the parts, part by part.
    #[inline(always)]
    pub fn add_runs(&self, first: usize, runs: &[Run], lists: &[Starts], factor: f64, values: &mut [S]) {
        by_width!(self.width, WIDTH => self.add_runs_of::<WIDTH>(first, runs, lists, factor, values))
    }

    fn add_runs_of<const WIDTH: usize>(&self, first: usize, runs: &[Run], lists: &[Starts], factor: f64, values: &mut [S]) {
        let rows = &self.numbers.as_chunks::<WIDTH>().0[first..];
        for lane in 0..self.parts.len().min(WIDTH) {
            for run in runs {
                let start = lists[run.list].of(self.parts.start + lane).start + run.offset;
                let own = &rows[run.numbers.clone()];
                add_lane(own, lane, factor, &mut values[start..start + own.len()]);
            }
        }
    }

    /// Writes results from a place on to a list where `wanted` says so; returns the place behind them.
    #[inline(always)]
    pub fn write(&self, first: usize, starts: &Starts, wanted: &[Option<usize>], values: &mut [S]) -> usize {
        let behind = first + starts.length;
        for (lane, part) in self.parts.clone().enumerate() {
            let own = starts.of(part);
            let rows = self.numbers[first * self.width..behind * self.width].chunks_exact(self.width);
            for ((value, wanted), row) in values[own.clone()].iter_mut().zip(&wanted[own]).zip(rows) {
                if wanted.is_some() {
                    *value = row[lane];
                }
            }
        }
        behind
    }

    /// Results of each part, one part after the other.
    #[inline(always)]
    pub fn for_each_part(&self, mut f: impl FnMut(usize, Strided<S>)) {
        for (lane, part) in self.parts.clone().enumerate() {
            f(part, Strided { numbers: self.numbers.get(lane..).unwrap_or_default(), width: self.width });
        }
    }
}

/// Numbers that stand some places apart.
#[derive(Clone)]
pub(crate) struct Strided<'r, S> {
    numbers: &'r [S],
    width: usize,
}

impl Strided<'_, f64> {
    /// values += the numbers from one on.
    #[inline(always)]
    pub fn add_to(&self, first: usize, values: &mut [f64]) {
        by_width!(self.width, WIDTH => self.add_strided::<WIDTH>(first, values))
    }

    #[inline(always)]
    fn add_strided<const WIDTH: usize>(&self, first: usize, values: &mut [f64]) {
        let own = self.numbers[first * WIDTH..].iter().step_by(WIDTH);
        values.iter_mut().zip(own).for_each(|(value, own)| *value += own);
    }
}

impl<S: Copy> Iterator for Strided<'_, S> {
    type Item = S;
    #[inline(always)]
    fn next(&mut self) -> Option<S> {
        let own = *self.numbers.first()?;
        self.numbers = self.numbers.get(self.width..).unwrap_or_default();
        Some(own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_gathered_into_lanes_and_results_added_from_them() {
        let values: Vec<f64> = (0..400).map(f64::from).collect();
        for width in [1, 4, 8] {
            for length in 1..24 {
                // three parts, the last of which fills the lanes that are left
                let starts = Starts::of_parts([7, 100, 250].into_iter().map(|start| start..start + length));
                let parts = 0..width.min(3);
                let mut numbers = vec![-1.0; width * (length + 1)];
                let mut lanes = Lanes { numbers: &mut numbers, width, parts: parts.clone(), place: 0 };
                lanes.gather(&starts, &values);
                lanes.spread(0.5);
                for lane in 0..width {
                    let own = starts.of(lane.min(2));
                    assert!((0..length).all(|place| numbers[place * width + lane] == values[own.start + place]));
                    assert_eq!(numbers[length * width + lane], 0.5);
                }
                for factor in [1.0, -2.0] {
                    let mut sums = vec![1.0; 400];
                    let results = LaneResults { numbers: &numbers, width, parts: parts.clone() };
                    let segments = std::slice::from_ref(&starts);
                    assert_eq!(results.add_to_nodes(0, segments, factor, &mut sums), length);
                    let added: Vec<usize> = parts.clone().flat_map(|part| starts.of(part)).collect();
                    let expected = |place| if added.contains(&place) { 1.0 + factor * values[place] } else { 1.0 };
                    assert!(sums.iter().enumerate().all(|(place, &sum)| sum == expected(place)), "{width} {length}");
                }
            }
        }
    }

    #[test]
    fn parts_of_a_program_without_results_have_none() {
        for width in [1, 4, 8] {
            let results = LaneResults::<f64> { numbers: &[], width, parts: 0..width };
            let mut count = 0;
            results.for_each_part(|_, mut own| count += usize::from(own.next().is_none()));
            assert_eq!(count, width);
        }
    }
}
