//! Passes over lists of numbers, for the widest vectors that the processor has. Each number sees the same operations in the same order
//! whatever their width.

// indices carry meaning in loops that become vectors
#![allow(clippy::needless_range_loop)]

use crate::elements::RunScalar;
use crate::linalg::{Kernel, dispatch};

pub(super) const MOST_LISTS: usize = 8;
/// Numbers that stay in registers while all lists pass.
const BLOCK: usize = 8;

#[inline(always)]
fn block<S>(list: &[S], place: usize) -> &[S; BLOCK] {
    list[place..].first_chunk().expect("lists of one length")
}

/// sum += factor list for each of the terms, in their order.
pub(super) fn add_lists<S: RunScalar>(sum: &mut [S], terms: &[(f64, &[S])]) {
    dispatch(AddLists { sum, terms });
}

struct AddLists<'l, S> {
    sum: &'l mut [S],
    terms: &'l [(f64, &'l [S])],
}

impl<S: RunScalar> Kernel for AddLists<'_, S> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let (blocks, last) = self.sum.as_chunks_mut::<BLOCK>();
        let first_left = blocks.len() * BLOCK;
        for (place, sum) in blocks.iter_mut().enumerate() {
            let mut own = *sum;
            for (factor, list) in self.terms {
                let list = block(list, place * BLOCK);
                for i in 0..BLOCK {
                    own[i] += list[i] * *factor;
                }
            }
            *sum = own;
        }
        for (sum, place) in last.iter_mut().zip(first_left..) {
            self.terms.iter().for_each(|(factor, list)| *sum += list[place] * *factor);
        }
    }
}

/// For each of some differences with its factor: puts what is left in its place and takes the difference, times the factor, from what is
/// left. Given scales, writes the largest of what is left then, each number times its scale.
pub(super) fn exchange<S: RunScalar>(
    differences: &mut [(f64, &mut [S])],
    left: &mut [S],
    measured: Option<(&[f64], &mut [f64])>,
) {
    dispatch(Exchange { differences, left, measured });
}

struct Exchange<'l, 'd, S> {
    differences: &'l mut [(f64, &'d mut [S])],
    left: &'l mut [S],
    measured: Option<(&'l [f64], &'l mut [f64])>,
}

impl<S: RunScalar> Kernel for Exchange<'_, '_, S> {
    type Output = ();
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Exchange { differences, left, measured } = self;
        let (scales, largest) = measured.unzip();
        let mut most = [[0.0_f64; BLOCK]; MOST_LISTS];
        let (blocks, last) = left.as_chunks_mut::<BLOCK>();
        let first_left = blocks.len() * BLOCK;
        for (place, left) in blocks.iter_mut().enumerate() {
            let mut own = *left;
            for ((factor, list), most) in differences.iter_mut().zip(&mut most) {
                let list: &mut [S; BLOCK] = list[place * BLOCK..].first_chunk_mut().expect("lists of one length");
                let before = std::mem::replace(list, own);
                for i in 0..BLOCK {
                    own[i] -= before[i] * *factor;
                }
                if let Some(scales) = scales {
                    let scales = block(scales, place * BLOCK);
                    for i in 0..BLOCK {
                        let size = own[i].value().abs() * scales[i];
                        most[i] = if size > most[i] { size } else { most[i] };
                    }
                }
            }
            *left = own;
        }
        for (own, place) in last.iter_mut().zip(first_left..) {
            for ((factor, list), most) in differences.iter_mut().zip(&mut most) {
                let expected = list[place] * *factor;
                list[place] = *own;
                *own -= expected;
                let scale = scales.map_or(0.0, |scales| scales[place]);
                most[0] = most[0].max(own.value().abs() * scale);
            }
        }
        for (largest, most) in largest.into_iter().flatten().zip(most) {
            *largest = most.into_iter().fold(0.0, f64::max);
        }
    }
}

/// The largest `size(value, scale)` of values with their scales, from 0 on; what is no number does not count.
pub(super) fn largest_scaled<S: Copy>(values: &[S], scales: &[f64], size: impl Fn(S, f64) -> f64) -> f64 {
    dispatch(LargestScaled { values, scales, size })
}

struct LargestScaled<'l, S, F> {
    values: &'l [S],
    scales: &'l [f64],
    size: F,
}

impl<S: Copy, F: Fn(S, f64) -> f64> Kernel for LargestScaled<'_, S, F> {
    type Output = f64;
    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let LargestScaled { values, scales, size } = self;
        assert!(values.len() <= scales.len(), "a scale for each number");
        let (groups, last) = values.as_chunks::<BLOCK>();
        let (scales, last_scales) = scales[..values.len()].as_chunks::<BLOCK>();
        let mut largest = [0.0_f64; BLOCK];
        for (values, scales) in groups.iter().zip(scales) {
            for i in 0..BLOCK {
                let own = size(values[i], scales[i]);
                largest[i] = if own > largest[i] { own } else { largest[i] };
            }
        }
        let others = last.iter().zip(last_scales).map(|(&value, &scale)| size(value, scale));
        others.chain(largest).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_counts_and_what_is_no_number_does_not() {
        let scales: Vec<f64> = (1..=21).map(f64::from).collect();
        for place in 0..21 {
            let mut values = [0.0; 21];
            values[place] = -2.0;
            assert_eq!(largest_scaled(&values, &scales, |x: f64, scale| x.abs() * scale), 2.0 * scales[place]);
            values[(place + 1) % 21] = f64::NAN;
            assert_eq!(largest_scaled(&values, &scales, |x: f64, scale| x.abs() * scale), 2.0 * scales[place]);
        }
        assert_eq!(largest_scaled(&[], &scales, |x: f64, scale| x * scale), 0.0);
    }

    #[test]
    fn lists_of_any_length_are_added_and_exchanged_number_by_number() {
        let list = |seed: usize, length: usize| -> Vec<f64> {
            (0..length).map(|i| ((i * 37 + seed * 101) % 89) as f64 / 7.0 - 5.0).collect()
        };
        for length in 0..40 {
            let (given, [first, second]) = (list(1, length), [list(2, length), list(3, length)]);
            let mut sum = given.clone();
            add_lists(&mut sum, &[(0.3, &first), (-1.7, &second)]);
            assert!((0..length).all(|i| sum[i] == given[i] + first[i] * 0.3 + second[i] * -1.7));

            let (scales, mut left, mut largest) = (list(4, length), given.clone(), [0.0; 2]);
            let [mut one, mut other] = [first.clone(), second.clone()];
            exchange(&mut [(0.3, &mut one), (-1.7, &mut other)], &mut left, Some((&scales, &mut largest)));
            let between: Vec<f64> = (0..length).map(|i| given[i] - first[i] * 0.3).collect();
            let last: Vec<f64> = (0..length).map(|i| between[i] - second[i] * -1.7).collect();
            assert!(one == given && other == between && left == last, "{length} numbers");
            let most = |list: &[f64]| list.iter().zip(&scales).fold(0.0, |most: f64, (x, scale)| most.max(x.abs() * scale));
            assert_eq!(largest, [most(&between), most(&last)]);
        }
    }
}
