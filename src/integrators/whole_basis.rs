//! Bases of all motions of a small model, of which every mode is found: how many there are is a rank, and none can be missing.
//!
//! Of the motions Z y that obey the constraints, A Z = 0, those with inertia are what Z^T M Z does not take to zero. Of the others those count that
//! dampers see, or that are states of first order: what Z^T C Z does not take to zero. What is left follows without a value of its own.

use super::amplitudes::entries;
use super::krylov::WholeBasis;
use super::vibrations::Operator;
use crate::assembly::Jacobian;
use nalgebra::{DMatrix, DVector, QR, SVD};

/// Unknowns of an eigenproblem that is solved as a whole.
const SMALL: usize = 240;
/// Unknowns of nodes, of which constraints take some.
const SMALL_MODEL: usize = 480;

/// Directions with inertia, and directions without it that have a rate.
pub(super) struct Motions {
    pub inertial: WholeBasis,
    pub following: WholeBasis,
}

impl Operator<'_> {
    /// The directions in which a small model moves; of a larger one none. `orders`: how many values each has.
    pub fn motions(&self, damping: Option<&Jacobian>, orders: usize) -> Option<Motions> {
        let (nodes, size) = (self.nodes, self.newton.system.size());
        let free = nodes.saturating_sub(size - nodes);
        if nodes > SMALL_MODEL || orders * free > SMALL {
            return None;
        }
        let allowed = self.allowed_directions();
        let project = |matrix: &Jacobian| {
            let image = |own: DVector<f64>| DVector::from_vec(self.times(matrix, own.as_slice()));
            let images: Vec<_> = allowed.column_iter().map(|own| image(own.into_owned())).collect();
            if images.is_empty() { DMatrix::zeros(0, 0) } else { allowed.tr_mul(&DMatrix::from_columns(&images)) }
        };
        let mut mass = project(&self.mass);
        // each direction by the root of its inertia; what is left of none by the round-off of others has none
        let largest = mass.diagonal().amax();
        let round_off = free as f64 * f64::EPSILON;
        let is_massless = |inertia: f64| inertia <= round_off * round_off * largest;
        let scale = |inertia: f64| if is_massless(inertia) { largest.max(f64::MIN_POSITIVE) } else { inertia }.sqrt();
        let scales = mass.diagonal().map(scale);
        for (i, j) in (0..free).flat_map(|i| (0..free).map(move |j| (i, j))) {
            mass[(i, j)] /= scales[i] * scales[j];
        }
        let (sizes, directions) = ordered(mass);
        let rank = sizes.iter().filter(|own| **own > round_off).count();
        let (basis, dual) = (divided(&allowed, &scales, -1), divided(&allowed, &scales, 1));
        let whole = |of: &DMatrix<f64>, directions: &DMatrix<f64>| -> Vec<Vec<f64>> {
            (of * directions).column_iter().map(|own| own.iter().copied().collect()).collect()
        };
        let weighted = |power: i32| {
            let mut own = directions.columns(0, rank).into_owned();
            own.column_iter_mut().zip(&sizes).for_each(|(mut own, size)| own *= size.sqrt().powi(power));
            own
        };
        let inertial = WholeBasis { basis: whole(&basis, &weighted(-1)), dual: whole(&dual, &weighted(1)) };
        let massless = directions.columns(rank, free - rank).into_owned();
        let following = damping.map_or_else(
            || DMatrix::zeros(free, 0),
            |damping| {
                let damping = project(damping);
                let seen = &damping * divided(&DMatrix::identity(free, free), &scales, -1) * &massless;
                let least = round_off * damping.amax() / scales.iter().copied().fold(f64::INFINITY, f64::min);
                let (sizes, own) = ordered(seen);
                massless * own.columns(0, sizes.iter().filter(|own| **own > least).count())
            },
        );
        let following = WholeBasis { basis: whole(&basis, &following), dual: whole(&dual, &following) };
        Some(Motions { inertial, following })
    }

    /// Orthonormal directions that obey the constraints, A x = 0.
    fn allowed_directions(&self) -> DMatrix<f64> {
        let (pattern, nodes) = (&self.newton.system.pattern, self.nodes);
        let constraints = pattern.size - nodes;
        let mut both = DMatrix::zeros(nodes, constraints + nodes);
        for (row, column, value) in entries(pattern, &self.mass.values).filter(|own| own.0 >= nodes && own.1 < nodes) {
            both[(column, row - nodes)] = value;
        }
        (0..nodes).for_each(|column| both[(column, constraints + column)] = 1.0);
        for mut row in both.columns_mut(0, constraints).column_iter_mut() {
            let size = row.norm();
            if size > 0.0 {
                row /= size;
            }
        }
        if nodes == 0 {
            return both;
        }
        // the first columns of Q span A^T, the others what is at right angles to it
        QR::new(both).q().columns(constraints, nodes - constraints).into_owned()
    }
}

/// A matrix with its columns multiplied by powers of their scales.
fn divided(matrix: &DMatrix<f64>, scales: &DVector<f64>, power: i32) -> DMatrix<f64> {
    let mut own = matrix.clone();
    own.column_iter_mut().zip(scales.iter()).for_each(|(mut own, scale)| own *= scale.powi(power));
    own
}

/// Singular values, the largest first, with all right vectors, of a matrix that has as many rows as columns or more.
fn ordered(matrix: DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let count = matrix.ncols();
    if count == 0 {
        return (Vec::new(), DMatrix::zeros(0, 0));
    }
    let found = SVD::new(matrix, false, true);
    let vectors = found.v_t.map_or_else(|| DMatrix::zeros(count, count), |own| own.transpose());
    (found.singular_values.iter().copied().collect(), vectors)
}
