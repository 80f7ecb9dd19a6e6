//! Systems of complex amplitudes: (lambda^2 M + lambda C + K) x + A^T nu = r, A x = s.
//!
//! With P = A + i B for all of it the complex system is a real one of twice its size for the parts of x and nu, sparse as they are:
//!
//! ```text
//! [ A  -B ] [ re ]   [ re r ]
//! [ B   A ] [ im ] = [ im r ]
//! ```

use crate::assembly::{Jacobian, System};
use crate::linalg::{Backend, Factorization, Singular, SparsePattern};
use crate::scalar::Complex64;
use std::sync::Arc;

/// Corrections of each solution against the matrix.
const REFINEMENTS: usize = 1;

type Entries = Vec<(usize, usize, f64)>;

/// K with the constraints, and M and C among nodes.
pub(super) struct Pencil {
    pub size: usize,
    stiffness: Entries,
    mass: Entries,
    damping: Entries,
}

pub(super) fn entries(pattern: &SparsePattern, values: &[f64]) -> impl Iterator<Item = (usize, usize, f64)> {
    (0..pattern.size).flat_map(move |column| {
        let places = pattern.column_starts[column]..pattern.column_starts[column + 1];
        places.map(move |place| (pattern.rows[place] as usize, column, values[place]))
    })
}

impl Pencil {
    /// From the matrices of a system with so many unknowns of nodes; without damping there is no C.
    pub fn new(system: &System, nodes: usize, [stiffness, mass]: [&Jacobian; 2], damping: Option<&Jacobian>) -> Self {
        let all =
            |matrix: &Jacobian| entries(&system.pattern, &matrix.values).filter(|own| own.2 != 0.0).collect::<Entries>();
        let among_nodes = |matrix| {
            let mut own = all(matrix);
            own.retain(|own| own.0 < nodes && own.1 < nodes);
            own
        };
        let damping = damping.map_or_else(Vec::new, among_nodes);
        Pencil { size: system.size(), stiffness: all(stiffness), mass: among_nodes(mass), damping }
    }

    /// Hands out the terms of P(lambda) x, or of P(lambda)^T x, with their rows.
    pub fn for_each_term(
        &self,
        lambda: Complex64,
        x: &[Complex64],
        transposed: bool,
        mut see: impl FnMut(usize, Complex64),
    ) {
        let lists = [(&self.stiffness, Complex64::ONE), (&self.mass, lambda * lambda), (&self.damping, lambda)];
        for (list, factor) in lists {
            for &(row, column, value) in list {
                let (row, column) = if transposed { (column, row) } else { (row, column) };
                see(row, x[column] * factor * value);
            }
        }
    }

    /// dP/dlambda x = (2 lambda M + C) x, or its transposed.
    pub fn slope(&self, lambda: Complex64, x: &[Complex64], transposed: bool) -> Vec<Complex64> {
        let mut product = vec![Complex64::ZERO; self.size];
        for (list, factor) in [(&self.mass, lambda * 2.0), (&self.damping, Complex64::ONE)] {
            for &(row, column, value) in list {
                let (row, column) = if transposed { (column, row) } else { (row, column) };
                product[row] += x[column] * factor * value;
            }
        }
        product
    }
}

/// A pencil with factors at one lambda.
pub(super) struct Amplitudes<'p> {
    pencil: &'p Pencil,
    /// Where each entry stands in the diagonal blocks, and in the lower and the upper block beside them; of K in the first alone.
    places: [Vec<[usize; 4]>; 3],
    pattern: Arc<SparsePattern>,
    factors: Factorization,
    values: Vec<f64>,
}

impl<'p> Amplitudes<'p> {
    /// `turns`: whether lambda^2 M has an imaginary part for any lambda that is asked for.
    pub fn new(pencil: &'p Pencil, turns: bool) -> Result<Self, Singular> {
        let size = pencil.size;
        let own = |(row, column)| [(column, row), (column + size, row + size)];
        let beside = |(row, column)| [(column, row + size), (column + size, row)];
        let of = |list: &'p Entries| list.iter().map(|own| (own.0, own.1));
        let diagonal =
            (0..size).map(|k| (k, k)).chain(of(&pencil.stiffness)).chain(of(&pencil.mass)).chain(of(&pencil.damping));
        let turning = of(&pencil.mass).filter(|_| turns).chain(of(&pencil.damping));
        let all = diagonal.flat_map(own).chain(turning.flat_map(beside)).collect();
        let pattern = Arc::new(SparsePattern::from_entries(2 * size, all));
        let factors = Factorization::new(&pattern, Backend::Multifrontal)?;
        let placed = |list: &'p Entries, is_beside: bool| -> Vec<[usize; 4]> {
            let place = |(column, row): (usize, usize)| pattern.position(row, column).unwrap_or(usize::MAX);
            let one = |at: (usize, usize)| {
                let [first, second] = own(at).map(place);
                let [below, above] = if is_beside { beside(at).map(place) } else { [usize::MAX; 2] };
                [first, second, below, above]
            };
            of(list).map(one).collect()
        };
        let places = [placed(&pencil.stiffness, false), placed(&pencil.mass, turns), placed(&pencil.damping, true)];
        let values = vec![0.0; pattern.rows.len()];
        Ok(Amplitudes { pencil, places, pattern, factors, values })
    }

    /// The same for values of modes, where P is nearly singular.
    pub fn beside_modes(self) -> Self {
        Amplitudes { factors: self.factors.unexamined(), ..self }
    }

    pub fn set(&mut self, lambda: Complex64) -> Result<(), Singular> {
        self.values.fill(0.0);
        let Pencil { stiffness, mass, damping, .. } = self.pencil;
        let lists = [(stiffness, Complex64::ONE), (mass, lambda * lambda), (damping, lambda)];
        for ((list, factor), places) in lists.into_iter().zip(&self.places) {
            for (&(_, _, value), &[first, second, below, above]) in list.iter().zip(places) {
                self.values[first] += value * factor.re;
                self.values[second] += value * factor.re;
                if below != usize::MAX {
                    self.values[below] += value * factor.im;
                    self.values[above] -= value * factor.im;
                }
            }
        }
        self.factors.reset_scaling(false);
        self.factors.factor(&self.values)
    }

    /// P^-1 r, refined against the matrix.
    pub fn solve(&mut self, rhs: &[Complex64]) -> Vec<Complex64> {
        let whole = parts(rhs);
        let (mut x, mut left) = (vec![0.0; whole.len()], whole.clone());
        for refinement in 0..=REFINEMENTS {
            self.factors.solve(&mut left);
            x.iter_mut().zip(&left).for_each(|(x, own)| *x += own);
            if refinement < REFINEMENTS {
                left.copy_from_slice(&whole);
                entries(&self.pattern, &self.values).for_each(|(row, column, value)| left[row] -= value * x[column]);
            }
        }
        joined(&x)
    }

    /// P^-T r: where P is nearly singular its last digits are those of the null space alone.
    pub fn solve_transposed(&mut self, rhs: &[Complex64]) -> Vec<Complex64> {
        // the transposed real system is that of the conjugate
        let conjugate: Vec<Complex64> = rhs.iter().map(Complex64::conj).collect();
        let mut x = parts(&conjugate);
        // refinement of what is nearly singular does not settle, and need not
        let _ = self.factors.solve_transposed(&mut x);
        joined(&x).iter().map(Complex64::conj).collect()
    }
}

fn parts(numbers: &[Complex64]) -> Vec<f64> {
    numbers.iter().map(|own| own.re).chain(numbers.iter().map(|own| own.im)).collect()
}

fn joined(parts: &[f64]) -> Vec<Complex64> {
    let (re, im) = parts.split_at(parts.len() / 2);
    re.iter().zip(im).map(|(&re, &im)| Complex64::new(re, im)).collect()
}

/// What is left of P(lambda) x = r, or of its transposed, as a share of its largest term.
pub(super) fn left_over(
    pencil: &Pencil,
    lambda: Complex64,
    (x, rhs): (&[Complex64], &[Complex64]),
    transposed: bool,
) -> f64 {
    let mut left = rhs.to_vec();
    let mut sizes: Vec<f64> = rhs.iter().map(|own| own.norm()).collect();
    pencil.for_each_term(lambda, x, transposed, |row, term| {
        left[row] -= term;
        sizes[row] += term.norm();
    });
    let largest = |list: &mut dyn Iterator<Item = f64>| {
        list.fold(0.0, |most: f64, own| if own > most || own.is_nan() { own } else { most })
    };
    let size = largest(&mut sizes.into_iter());
    if size == 0.0 { 0.0 } else { largest(&mut left.iter().map(|own| own.norm())) / size }
}
