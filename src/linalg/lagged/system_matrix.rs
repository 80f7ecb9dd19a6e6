use crate::linalg::SparsePattern;
use crate::linalg::multifrontal::Side;
use crate::linalg::simd::{Kernel, dispatch};
use std::ops::Range;

/// A, or A^T, by the values of A in the order of its pattern.
#[derive(Clone, Copy)]
pub struct SystemMatrix<'a> {
    /// Places of the entries of A.
    pub pattern: &'a SparsePattern,
    /// Entries of A.
    pub values: &'a [f64],
    /// Which of the two.
    pub side: Side,
}

/// Products of a matrix with several vectors, which share each pass over its entries.
#[derive(Default)]
pub struct Products {
    /// A x, vector by vector.
    pub products: Vec<f64>,
    /// |A| |x|, vector by vector.
    pub magnitudes: Vec<f64>,
    /// Largest entry of each row.
    pub row_sizes: Vec<f64>,
    /// The same of a group of vectors, component by component.
    interleaved: [Vec<f64>; 3],
}

/// Vectors of the largest group.
const LANES: usize = 8;

impl Products {
    /// Space for a number of vectors.
    pub fn reserve(&mut self, size: usize, count: usize) {
        self.products.resize(size * count.max(self.products.len() / size.max(1)), 0.0);
        self.magnitudes.resize(self.products.len(), 0.0);
        self.row_sizes.resize(size, 0.0);
        self.interleaved
            .iter_mut()
            .for_each(|own| own.resize(size * LANES.min(count.next_power_of_two()).max(own.len() / size.max(1)), 0.0));
    }

    /// Sets A x, and with `MAGNITUDES` all others.
    pub fn set<const MAGNITUDES: bool>(&mut self, matrix: SystemMatrix, x: &[f64]) {
        let (size, mut done) = (matrix.pattern.size, 0);
        while done < x.len() {
            let count = LANES.min((x.len() - done) / size);
            let place = done..done + size * count;
            let x = &x[place.clone()];
            match count.next_power_of_two() {
                8 => self.set_group::<8, MAGNITUDES>(matrix, x, place.clone()),
                4 => self.set_group::<4, MAGNITUDES>(matrix, x, place.clone()),
                2 => self.set_group::<2, MAGNITUDES>(matrix, x, place.clone()),
                _ => self.set_group::<1, MAGNITUDES>(matrix, x, place.clone()),
            }
            done = place.end;
        }
    }

    /// For at most `N` vectors.
    fn set_group<const N: usize, const MAGNITUDES: bool>(&mut self, matrix: SystemMatrix, x: &[f64], place: Range<usize>) {
        let size = matrix.pattern.size;
        let [own_x, products, magnitudes] = &mut self.interleaved;
        let [own_x, products, magnitudes] =
            [own_x, products, magnitudes].map(|own| &mut own[..size * N].as_chunks_mut::<N>().0[..]);
        for (lane, x) in x.chunks_exact(size).enumerate() {
            own_x.iter_mut().zip(x).for_each(|(own, x)| own[lane] = *x);
        }
        let row_sizes = &mut self.row_sizes;
        dispatch(Group::<N, MAGNITUDES> { matrix, x: own_x, products, magnitudes, row_sizes });
        let results = [(&mut self.products, products), (&mut self.magnitudes, magnitudes)];
        for (all, group) in results.into_iter().take(1 + usize::from(MAGNITUDES)) {
            for (lane, to) in all[place.clone()].chunks_exact_mut(size).enumerate() {
                to.iter_mut().zip(&*group).for_each(|(to, own)| *to = own[lane]);
            }
        }
    }
}

struct Group<'g, const N: usize, const MAGNITUDES: bool> {
    matrix: SystemMatrix<'g>,
    x: &'g [[f64; N]],
    products: &'g mut [[f64; N]],
    magnitudes: &'g mut [[f64; N]],
    row_sizes: &'g mut [f64],
}

impl<const N: usize, const MAGNITUDES: bool> Kernel for Group<'_, N, MAGNITUDES> {
    type Output = ();
    // products and sums stay apart, so that every processor gives the same bits
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Group { matrix: SystemMatrix { pattern, values, side }, x, products, magnitudes, row_sizes } = self;
        let entries = |column: usize| {
            let own = pattern.column_starts[column]..pattern.column_starts[column + 1];
            values[own.clone()].iter().zip(&pattern.rows[own])
        };
        match side {
            Side::Plain => {
                products.fill([0.0; N]);
                if MAGNITUDES {
                    magnitudes.fill([0.0; N]);
                    row_sizes.fill(0.0);
                }
                for (column, x) in x.iter().enumerate() {
                    for (value, &row) in entries(column) {
                        let product = x.map(|x| value * x);
                        (0..N).for_each(|lane| products[row][lane] += product[lane]);
                        if MAGNITUDES {
                            (0..N).for_each(|lane| magnitudes[row][lane] += product[lane].abs());
                            row_sizes[row] = larger(row_sizes[row], value.abs());
                        }
                    }
                }
            }
            Side::Transposed => {
                for column in 0..pattern.size {
                    let (mut sum, mut magnitude, mut most) = ([0.0; N], [0.0; N], 0.0);
                    for (value, &row) in entries(column) {
                        let product = x[row].map(|x| value * x);
                        (0..N).for_each(|lane| sum[lane] += product[lane]);
                        if MAGNITUDES {
                            (0..N).for_each(|lane| magnitude[lane] += product[lane].abs());
                            most = larger(most, value.abs());
                        }
                    }
                    products[column] = sum;
                    if MAGNITUDES {
                        magnitudes[column] = magnitude;
                        row_sizes[column] = most;
                    }
                }
            }
        }
    }
}

/// Of two numbers, in one instruction.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}
