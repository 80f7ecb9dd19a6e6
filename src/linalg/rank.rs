//! Which rows of a sparse matrix depend on the others, and the sign of a determinant.
//!
//! Rows of unit length become columns of A^T = Q R, which reflections eliminate in dense fronts: a row is eliminated with all those whose
//! coordinates are then known, and what is left of its coordinates goes to the rows that are left. A row of which next to nothing is left
//! depends on those before it; one of which little is left waits for a later front, so that R stays well conditioned.
//!
//! Source: Davis, ACM Trans. Math. Softw. 38 (2011), "Algorithm 915, SuiteSparseQR", with rows that depend on others as by Heath (1982).

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Rows whose remaining part is below this share of a unit row depend on the chosen ones.
const DEPENDENT: f64 = 1e-9;
/// Rows of which less than this share is left wait for later fronts: by its inverse grows what round-off does to those that come after, which
/// stays far below [`DEPENDENT`].
const WAITS: f64 = 1e-4;
/// Share of the largest of several rows, or of their coefficients, from which on one is as good as the largest.
const AS_GOOD: f64 = 0.1;

/// A row of a sparse matrix: columns and values, a column that comes again adding up.
pub type SparseRow = Vec<(usize, f64)>;

/// An independent subset of the rows of a matrix, as indices in increasing order.
///
/// Among rows that may be left out almost equally well the latest are, so that the result follows the order in which joints were given: one
/// may be if it follows from the rows that are kept with coefficients that are not much larger than 1, rows being scaled to unit length. Zero
/// rows are dependent. With `rank` so many rows are chosen, however small what is left of them.
pub fn independent_rows(rows: &[SparseRow], rank: Option<usize>) -> Vec<usize> {
    let mut is_kept = vec![true; rows.len()];
    Elimination::of(rows, DEPENDENT).left_out(rank).into_iter().for_each(|row| is_kept[row] = false);
    (0..rows.len()).filter(|&row| is_kept[row]).collect()
}

/// Sign of the determinant of a square matrix: 1, -1, or 0 where it is singular but for round-off.
pub fn sign_of_determinant(rows: &[SparseRow]) -> f64 {
    let Elimination { pivots, reflections, .. } = Elimination::of(rows, crate::tolerances::ROUND_OFF);
    if pivots.len() < rows.len() {
        return 0.0;
    }
    // Q^T A^T has the pivots where their rows and coordinates meet
    let mut coordinate_of = vec![0; rows.len()];
    pivots.iter().for_each(|pivot| coordinate_of[pivot.row] = pivot.coordinate);
    let mut exchanges = 0;
    for row in 0..rows.len() {
        while coordinate_of[row] != row {
            let other = coordinate_of[row];
            coordinate_of.swap(row, other);
            exchanges += 1;
        }
    }
    let negative = pivots.iter().filter(|pivot| pivot.diagonal < 0.0).count();
    if (negative + reflections + exchanges) % 2 == 0 { 1.0 } else { -1.0 }
}

/// A row that was eliminated, with the coordinate that it took and what was left of it.
struct Pivot {
    row: usize,
    coordinate: usize,
    diagonal: f64,
}

/// R of A^T = Q R, with rows in the order of their elimination.
#[derive(Default)]
struct Elimination {
    pivots: Vec<Pivot>,
    /// Rows that depend on pivots, and what was left of them.
    dependent: Vec<(usize, f64)>,
    /// The entries of each row in R above its own pivot: number of the pivot, and value.
    above: Vec<SparseRow>,
    /// Reflections of which Q is made.
    reflections: usize,
    /// Numbers that they changed.
    work: usize,
}

/// Rows and coordinates that have yet to be eliminated together, as a dense matrix, row by row.
#[derive(Default)]
struct Front {
    rows: Vec<usize>,
    coordinates: Vec<usize>,
    values: Vec<f64>,
}

impl Front {
    fn row(&self, place: usize) -> &[f64] {
        let size = self.coordinates.len();
        &self.values[place * size..][..size]
    }

    fn left(&self, place: usize, first: usize) -> f64 {
        self.row(place)[first..].iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    fn exchange(&mut self, a: usize, b: usize) {
        let size = self.coordinates.len();
        if a != b {
            self.rows.swap(a, b);
            let (low, high) = self.values.split_at_mut(a.max(b) * size);
            low[a.min(b) * size..][..size].swap_with_slice(&mut high[..size]);
        }
    }

    /// Reflects coordinates from `first` on, so that the row of this number has only this one of them; returns whether it had others.
    fn reflect(&mut self, first: usize) -> bool {
        let size = self.coordinates.len();
        let mut normal = self.row(first)[first..].to_vec();
        if normal[1..].iter().all(|&x| x == 0.0) {
            return false;
        }
        normal[0] += self.left(first, first).copysign(normal[0]);
        let square: f64 = normal.iter().map(|x| x * x).sum();
        for row in self.values.chunks_exact_mut(size).skip(first) {
            let share = 2.0 * row[first..].iter().zip(&normal).map(|(x, n)| x * n).sum::<f64>() / square;
            row[first..].iter_mut().zip(&normal).for_each(|(x, n)| *x -= share * n);
        }
        self.values[first * size + first + 1..(first + 1) * size].fill(0.0);
        true
    }
}

impl Elimination {
    /// Of rows scaled to unit length; those with less left than a share depend on others.
    fn of(rows: &[SparseRow], negligible: f64) -> Self {
        let mut fronts = coordinates(rows);
        let mut own = Elimination { above: vec![SparseRow::new(); rows.len()], ..Elimination::default() };
        // the fronts of each row
        let mut using: Vec<Vec<usize>> = vec![Vec::new(); rows.len()];
        for (number, front) in fronts.iter().enumerate() {
            front.rows.iter().for_each(|&row| using[row].push(number));
        }
        // what a row's front is at most
        let bound = |row: usize, using: &[Vec<usize>], fronts: &[Front]| -> usize {
            let own = || using[row].iter().map(|&front| &fronts[front]);
            own().map(|front| front.rows.len()).sum::<usize>() * own().map(|front| front.coordinates.len()).sum::<usize>()
        };
        let mut is_waiting = vec![true; rows.len()];
        let mut next: BinaryHeap<_> = (0..rows.len()).map(|row| Reverse((bound(row, &using, &fronts), row))).collect();
        while let Some(Reverse((size, row))) = next.pop() {
            if !is_waiting[row] || size != bound(row, &using, &fronts) {
                continue;
            }
            let merged = std::mem::take(&mut using[row]);
            let (mut front, known) = merge(&merged, row, &mut fronts, &using);
            front.rows[..known].iter().for_each(|&row| is_waiting[row] = false);
            own.eliminate(&mut front, known, negligible);
            for &row in &front.rows {
                using[row].retain(|number| !merged.contains(number));
                using[row].extend((!front.coordinates.is_empty()).then_some(fronts.len()));
            }
            fronts.push(front);
            let rest = &fronts[fronts.len() - 1].rows;
            let waiting = rest.iter().filter(|&&row| is_waiting[row]);
            next.extend(waiting.map(|&row| Reverse((bound(row, &using, &fronts), row))));
        }
        own
    }

    /// Eliminates what can be of the first `known` rows of a front, and leaves in it what is left.
    fn eliminate(&mut self, front: &mut Front, known: usize, negligible: f64) {
        let (mut done, mut end, is_last) = (0, known, known == front.rows.len());
        while done < end {
            let left: Vec<f64> = (done..end).map(|place| front.left(place, done.min(front.coordinates.len()))).collect();
            let largest = left.iter().fold(0.0, |largest: f64, left| largest.max(*left));
            let depends = |place: &usize| left[*place] < negligible;
            if let Some(place) = (0..left.len()).find(depends) {
                self.dependent.push((front.rows[done + place], left[place]));
                front.rows.remove(done + place);
                let size = front.coordinates.len();
                front.values.drain((done + place) * size..(done + place + 1) * size);
                end -= 1;
                continue;
            }
            let least = (AS_GOOD * largest).max(if is_last { 0.0 } else { WAITS });
            let Some(place) = (0..left.len()).find(|&place| left[place] >= least) else { break };
            // the others stay in their order
            (done..done + place).rev().for_each(|before| front.exchange(before, before + 1));
            self.reflections += usize::from(front.reflect(done));
            self.work += front.rows.len() * (front.coordinates.len() - done);
            let number = self.pivots.len();
            for place in done + 1..front.rows.len() {
                let value = front.row(place)[done];
                if value != 0.0 {
                    self.above[front.rows[place]].push((number, value));
                }
            }
            let (row, coordinate, diagonal) = (front.rows[done], front.coordinates[done], front.row(done)[done]);
            self.pivots.push(Pivot { row, coordinate, diagonal });
            done += 1;
        }
        let size = front.coordinates.len();
        front.rows.drain(..done);
        front.values = front.values.chunks_exact(size.max(1)).skip(done).flat_map(|row| &row[done..]).copied().collect();
        front.coordinates.drain(..done);
        self.shorten(front);
    }

    /// Reflects coordinates of a front so that there are no more of them than rows.
    fn shorten(&mut self, front: &mut Front) {
        let (count, size) = (front.rows.len(), front.coordinates.len());
        if size > count {
            for place in 0..count {
                self.reflections += usize::from(front.reflect(place));
                self.work += count * (size - place);
            }
            front.values = front.values.chunks_exact(size).flat_map(|row| &row[..count]).copied().collect();
            front.coordinates.truncate(count);
        }
    }

    /// Rows to leave out, so that `rank` are kept.
    fn left_out(&mut self, rank: Option<usize>) -> Vec<usize> {
        let rank = rank.unwrap_or(self.pivots.len());
        let mut is_left_out = vec![false; self.above.len()];
        // the largest of those that depend on others are kept
        self.dependent.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        self.dependent.drain(..rank.saturating_sub(self.pivots.len()).min(self.dependent.len()));
        let mut pivots: Vec<&Pivot> = self.pivots.iter().collect();
        pivots.sort_by(|a, b| a.diagonal.abs().total_cmp(&b.diagonal.abs()).then(b.row.cmp(&a.row)));
        let weakest = pivots.iter().take(self.pivots.len().saturating_sub(rank)).map(|pivot| pivot.row);
        let all: Vec<usize> = self.dependent.iter().map(|(row, _)| *row).chain(weakest).collect();
        all.iter().for_each(|&row| is_left_out[row] = true);
        let dependences = all.iter().map(|&row| self.dependence(row, &is_left_out)).collect();
        latest(dependences, self.above.len()).unwrap_or(all)
    }

    /// Coefficients of a sum of rows that vanishes: of a row that is left out, and of the kept ones on which it depends.
    fn dependence(&self, row: usize, is_left_out: &[bool]) -> BTreeMap<usize, f64> {
        let mut known: BTreeMap<usize, f64> = self.above[row].iter().copied().collect();
        let mut coefficients = BTreeMap::from([(row, -1.0)]);
        while let Some((number, value)) = known.pop_last() {
            let Pivot { row, diagonal, .. } = self.pivots[number];
            let coefficient = value / diagonal;
            if is_left_out.get(row) != Some(&true) && coefficient.abs() > DEPENDENT {
                coefficients.insert(row, coefficient);
                for &(number, value) in &self.above[row] {
                    *known.entry(number).or_insert(0.0) -= coefficient * value;
                }
            }
        }
        coefficients
    }
}

/// The front of each coordinate, with rows scaled to unit length.
fn coordinates(rows: &[SparseRow]) -> Vec<Front> {
    let count = rows.iter().flatten().map(|(column, _)| column + 1).max().unwrap_or(0);
    let mut fronts: Vec<Front> = (0..count).map(|own| Front { coordinates: vec![own], ..Front::default() }).collect();
    for (number, row) in rows.iter().enumerate() {
        for &(column, value) in row.iter().filter(|(_, value)| *value != 0.0) {
            let Front { rows, values, .. } = &mut fronts[column];
            match values.last_mut() {
                Some(last) if rows.last() == Some(&number) => *last += value,
                _ => {
                    rows.push(number);
                    values.push(value);
                }
            }
        }
    }
    let mut sizes = vec![0.0_f64; rows.len()];
    for (&row, &value) in fronts.iter().flat_map(|front| front.rows.iter().zip(&front.values)) {
        sizes[row] = sizes[row].hypot(value);
    }
    for Front { rows, values, .. } in &mut fronts {
        values.iter_mut().zip(rows).for_each(|(value, row)| *value /= sizes[*row]);
    }
    fronts
}

/// Takes fronts together: rows that stand in no other one come first, each part in its order. Returns how many these are.
fn merge(numbers: &[usize], row: usize, fronts: &mut [Front], using: &[Vec<usize>]) -> (Front, usize) {
    let parts: Vec<Front> = numbers.iter().map(|&number| std::mem::take(&mut fronts[number])).collect();
    let mut rows: Vec<usize> = parts.iter().flat_map(|part| &part.rows).copied().chain([row]).collect();
    rows.sort_unstable();
    rows.dedup();
    let is_known = |row: &usize| using[*row].iter().all(|number| numbers.contains(number));
    let (known, others): (Vec<usize>, Vec<usize>) = rows.into_iter().partition(is_known);
    let rows = [&known[..], &others].concat();
    let place_of = |row: &usize| {
        known.binary_search(row).unwrap_or_else(|_| known.len() + others.binary_search(row).expect("a row of a part"))
    };
    let coordinates: Vec<usize> = parts.iter().flat_map(|part| &part.coordinates).copied().collect();
    let size = coordinates.len();
    let mut values = vec![0.0; rows.len() * size];
    let mut first = 0;
    for part in &parts {
        let width = part.coordinates.len();
        for (row, own) in part.rows.iter().zip(part.values.chunks_exact(width.max(1))) {
            values[place_of(row) * size + first..][..width].copy_from_slice(own);
        }
        first += width;
    }
    (Front { rows, coordinates, values }, known.len())
}

/// One row of each of some sums of rows that vanish, as late as it may be, such that no sum without these vanishes; `None` if these sums depend
/// on each other but for round-off.
fn latest(mut sums: Vec<BTreeMap<usize, f64>>, count: usize) -> Option<Vec<usize>> {
    let mut using: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut left_out = Vec::new();
    let mut is_open = vec![true; sums.len()];
    for (number, sum) in sums.iter_mut().enumerate() {
        normalize(sum);
        sum.keys().for_each(|&row| using[row].push(number));
    }
    while left_out.len() < sums.len() {
        let before = left_out.len();
        for row in (0..count).rev() {
            let open = using[row].iter().filter(|&&number| is_open[number]);
            let sizes = open.filter_map(|&number| Some((number, sums[number].get(&row)?.abs())));
            let best = sizes.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            let Some((own, _)) = best.filter(|(_, size)| *size >= AS_GOOD) else { continue };
            is_open[own] = false;
            left_out.push(row);
            let taken = std::mem::take(&mut sums[own]);
            for number in std::mem::take(&mut using[row]) {
                let Some(entry) = sums[number].remove(&row).filter(|_| is_open[number]) else { continue };
                let factor = entry / taken[&row];
                for (&other, value) in taken.iter().filter(|(other, _)| **other != row) {
                    *sums[number].entry(other).or_insert_with(|| {
                        using[other].push(number);
                        0.0
                    }) -= factor * value;
                }
                normalize(&mut sums[number]);
            }
        }
        if left_out.len() == before {
            return None;
        }
    }
    Some(left_out)
}

/// Scales coefficients to a largest one of 1; those that are next to nothing are left out.
fn normalize(sum: &mut BTreeMap<usize, f64>) {
    let largest = sum.values().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    sum.values_mut().for_each(|x| *x /= largest);
    sum.retain(|_, x| x.abs() > DEPENDENT);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::multifrontal::test_matrices::Noise;
    use crate::scalar::{SpatialVector, Vector3};
    use nalgebra::DMatrix;

    fn sparse(rows: &[&[f64]]) -> Vec<SparseRow> {
        rows.iter().map(|row| row.iter().copied().enumerate().filter(|(_, x)| *x != 0.0).collect()).collect()
    }

    #[test]
    fn determinants_have_their_signs() {
        assert_eq!(sign_of_determinant(&[]), 1.0);
        assert_eq!(sign_of_determinant(&sparse(&[&[0.0, 2.0, 0.0], &[0.0, 0.0, 3.0], &[0.5, 0.0, 0.0]])), 1.0);
        assert_eq!(sign_of_determinant(&sparse(&[&[0.0, 0.0, 3.0], &[0.0, 2.0, 0.0], &[0.5, 0.0, 0.0]])), -1.0);
        assert_eq!(sign_of_determinant(&sparse(&[&[1.0, 2.0], &[2.0, 4.0]])), 0.0);
        assert_eq!(sign_of_determinant(&sparse(&[&[1.0, 2.0], &[3.0, 4.0]])), -1.0);
        assert_eq!(sign_of_determinant(&sparse(&[&[-1.0, -2.0], &[3.0, 4.0]])), 1.0);
        let mut noise = Noise(5);
        let mut negative = 0;
        for case in 0..300 {
            let size = 1 + noise.below(30);
            let mut dense = DMatrix::zeros(size, size);
            for place in 0..size {
                let other = noise.below(size);
                for (row, column) in [(place, (place + case) % size), (place, other), (other, place)] {
                    dense[(row, column)] = noise.vector(1)[0];
                }
            }
            let singular = dense.clone().svd(false, false).singular_values;
            if singular.min() < 1e-10 * singular.max() {
                continue;
            }
            let own = sign_of_determinant(&all_rows(&dense));
            assert_eq!(own, dense.determinant().signum(), "case {case}");
            negative += usize::from(own < 0.0);
        }
        assert!((80..220).contains(&negative), "{negative}");
    }

    fn all_rows(dense: &DMatrix<f64>) -> Vec<SparseRow> {
        dense.row_iter().map(|row| row.iter().copied().enumerate().filter(|(_, x)| *x != 0.0).collect()).collect()
    }

    #[test]
    fn a_sum_of_rows_is_left_out() {
        let rows = sparse(&[&[1.0, 0.0, 2.0], &[0.0, 3.0, 1.0], &[1.0, 3.0, 3.0], &[0.0, 0.0, 0.0], &[0.0, 0.0, 1e-3]]);
        assert_eq!(independent_rows(&rows, None), [0, 1, 4]);
        assert_eq!(independent_rows(&rows, Some(2)).len(), 2);
        assert_eq!(independent_rows(&rows, Some(4)).len(), 4);
        assert!(independent_rows(&[], None).is_empty());
    }

    /// Rows of joints between bodies, whose translations and turns are the coordinates: of each joint the point, how many of the displacements
    /// along the axes of the world and of the turns about them are held, and the two bodies, 0 of which is the ground.
    fn joints(list: &[(Vector3<f64>, [usize; 2], [usize; 2])], place: impl Fn(usize) -> Vector3<f64>) -> Vec<SparseRow> {
        let mut rows = Vec::new();
        for &(point, [points, turns], bodies) in list {
            for held in 0..points + turns {
                let (is_point, axis) = (held < points, if held < points { held } else { 2 + points - held });
                let mut unit = [0.0; 3];
                unit[axis] = 1.0;
                let mut row = SparseRow::new();
                for (body, sign) in bodies.into_iter().zip([-1.0, 1.0]).filter(|(body, _)| *body > 0) {
                    let first = 6 * (body - 1);
                    if is_point {
                        let arm = (point - place(body)).cross(&Vector3::from_f64(unit)).components();
                        row.push((first + axis, sign));
                        row.extend((0..3).map(|i| (first + 3 + i, sign * arm[i])));
                    } else {
                        row.push((first + 3 + axis, sign));
                    }
                }
                rows.push(row);
            }
        }
        rows
    }

    /// A mechanism of bodies at drawn places, in a chain of which members are tied to others, too, in one of three units of length; in
    /// every second case one joint is off by a little.
    fn drawn(noise: &mut Noise, case: usize) -> Vec<SparseRow> {
        let unit = [1e-3, 1.0, 1e3][case % 3];
        let bodies = 2 + noise.below(14);
        let places: Vec<Vector3<f64>> =
            (0..=bodies).map(|body| (Vector3::from_f64([body as f64, 0.0, 0.0]) + drawn_vector(noise)) * unit).collect();
        // welds, balls, hinges about x, sliders of one direction
        let kinds = [[3, 3], [3, 0], [3, 2], [2, 3]];
        let mut list = Vec::new();
        for (body, &place) in places.iter().enumerate().skip(1) {
            let tie = (noise.below(3) == 0).then_some(noise.below(body));
            for other in [body - 1].into_iter().chain(tie) {
                let kind = kinds[if case.is_multiple_of(5) { 2 } else { noise.below(4) }];
                // hinges on one line, or anywhere
                let point = if case.is_multiple_of(4) { Vector3::zeros() } else { place + drawn_vector(noise) * unit };
                list.push((point, kind, [other, body]));
            }
        }
        let mut rows = joints(&list, |body| places[body]);
        let off = noise.below(rows.len());
        let share = [0.0, 1e-6, 0.0, 1e-12][case % 4];
        rows[off].iter_mut().for_each(|(_, value)| *value *= 1.0 + share * noise.vector(1)[0]);
        rows
    }

    fn drawn_vector(noise: &mut Noise) -> Vector3<f64> {
        let own = noise.vector(3);
        Vector3::from_f64([own[0], own[1], own[2]])
    }

    fn unit_rows(rows: &[SparseRow], chosen: &[usize]) -> DMatrix<f64> {
        let columns = rows.iter().flatten().map(|(column, _)| column + 1).max().unwrap_or(0);
        let mut dense = DMatrix::zeros(chosen.len(), columns);
        for (place, &row) in chosen.iter().enumerate() {
            rows[row].iter().for_each(|&(column, value)| dense[(place, column)] += value);
            let norm = dense.row(place).norm();
            dense.row_mut(place).scale_mut(if norm > 0.0 { 1.0 / norm } else { 0.0 });
        }
        dense
    }

    /// Orthogonalization of all rows by the first of those that are as good as the largest.
    fn by_orthogonalization(mut left: DMatrix<f64>) -> Vec<usize> {
        let mut chosen = Vec::new();
        loop {
            let norms: Vec<f64> = left.row_iter().map(|row| row.norm()).collect();
            let largest = norms.iter().fold(0.0, |a: f64, &b| a.max(b));
            if largest < DEPENDENT {
                chosen.sort_unstable();
                return chosen;
            }
            let pivot = norms.iter().position(|&norm| norm >= AS_GOOD * largest).expect("the largest");
            let unit = left.row(pivot) / norms[pivot];
            for mut row in left.row_iter_mut() {
                for _ in 0..2 {
                    let share = row.dot(&unit);
                    row -= &unit * share;
                }
            }
            left.row_mut(pivot).fill(0.0);
            chosen.push(pivot);
        }
    }

    #[test]
    fn as_many_rows_are_kept_as_singular_values_say_and_those_that_orthogonalization_keeps() {
        let mut noise = Noise(7);
        const CASES: usize = 400;
        let (mut redundant, mut same, mut weakest, mut unclear) = (0, 0, f64::INFINITY, 0);
        for case in 0..CASES {
            let rows = drawn(&mut noise, case);
            let all = unit_rows(&rows, &(0..rows.len()).collect::<Vec<_>>());
            let singular = all.clone().svd(false, false).singular_values;
            if singular.iter().any(|&value| value > 0.01 * DEPENDENT && value < 100.0 * DEPENDENT) {
                unclear += 1;
                continue;
            }
            let rank = singular.iter().filter(|&&value| value > DEPENDENT).count();
            let kept = independent_rows(&rows, None);
            assert_eq!(kept.len(), rank, "case {case}: {singular}");
            let reference = by_orthogonalization(all);
            let smallest = |chosen: &[usize]| unit_rows(&rows, chosen).svd(false, false).singular_values.min();
            weakest = weakest.min(smallest(&kept) / smallest(&reference));
            redundant += usize::from(rank < rows.len());
            same += usize::from(rank < rows.len() && kept == reference);
            // one more and one less than there are
            for other in [rank - 1, (rank + 1).min(rows.len())] {
                assert_eq!(independent_rows(&rows, Some(other)).len(), other, "case {case}");
            }
        }
        println!(
            "{redundant} redundant, {same} the same, {unclear} unclear, smallest singular value {weakest:.1e} of theirs"
        );
        assert!(redundant > CASES / 2 && unclear < CASES / 20);
        // of rows that may be left out almost equally well others may be
        assert!(same > redundant * 3 / 4 && weakest > 0.1);
    }

    /// Ladders of parallelograms in a plane, whose hinges leave each other's moments undetermined.
    fn ladder(count: usize) -> Vec<SparseRow> {
        let hinge = [3, 2];
        let at = |x: f64, y: f64| Vector3::from_f64([0.0, x, y]);
        let (upright, level) = (|i: usize| 1 + 2 * i, |i: usize| 2 + 2 * i);
        let mut list: Vec<_> = (0..=count).map(|i| (at(i as f64, 0.0), hinge, [0, upright(i)])).collect();
        for i in 0..count {
            list.push((at(i as f64, 1.0), hinge, [upright(i), level(i)]));
            list.push((at(i as f64 + 1.0, 1.0), hinge, [level(i), upright(i + 1)]));
        }
        joints(&list, |body| at(0.5 * (body - 1) as f64, if body % 2 == 1 { 0.5 } else { 1.0 }))
    }

    #[test]
    fn work_for_each_member_of_a_ladder_or_chain_is_the_same() {
        let chain = |count: usize| {
            let at = |x: f64| Vector3::from_f64([x, 0.1 * x.sin(), 0.2]);
            let list: Vec<_> = (0..count).map(|i| (at(i as f64), [3, 3], [i, (i + 1) % count])).collect();
            joints(&list, |body| at(body as f64 - 0.5))
        };
        for (rows, dependent) in [(ladder as fn(usize) -> Vec<SparseRow>, 3), (chain, 0)] {
            let per_member = |count: usize| {
                let rows = rows(count);
                let mut own = Elimination::of(&rows, DEPENDENT);
                let left_out = own.left_out(None);
                assert_eq!(left_out.len(), if dependent > 0 { dependent * count } else { 6 });
                own.work as f64 / count as f64
            };
            let [few, many] = [50, 2000].map(per_member);
            println!("{few} {many}");
            assert!(many < 1.5 * few, "{few} and {many}");
        }
    }
}
