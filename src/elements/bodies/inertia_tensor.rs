//! Which tensors of inertia bodies have.

use crate::scalar::{Matrix3, Vector3};

/// A tensor that no distribution of mass has.
pub struct Inadmissible {
    /// Its principal moments, the least first [kg m2].
    pub moments: [f64; 3],
    /// The nearest tensor that a body can have (xx, yy, zz, xy, xz, yz) [kg m2].
    pub nearest: [f64; 6],
}

/// Round-off of the tensor of a body [kg m2], by its largest inertia: of the tensor itself, or of the mass at its centre, m |c|^2 about the origin
/// of the frame.
#[doc(hidden)]
pub fn round_off(mass: f64, centre: Vector3<f64>, tensor: [f64; 6]) -> f64 {
    let largest = tensor.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    crate::tolerances::CONSISTENT * largest.max(mass * centre.dot(&centre))
}

/// Whether a body can have the tensor J about its mass centre (xx, yy, zz, xy, xz, yz) [kg m2].
///
/// Its principal moments keep J1 <= J2 <= J3 <= J1 + J2, which implies J1 >= 0; rods and plates stand at these limits. The
/// nearest tensor, in the norm of its entries, has the same principal axes and the nearest moments of this cone: those on the
/// face J3 = J1 + J2, or, where J1 were negative there, on its edge J1 = 0, J2 = J3.
///
/// Source: Traversaro et al. (2016), Identification of fully physical consistent inertial parameters using optimization on
/// manifolds, section III.
///
/// # Errors
/// The nearest tensor, where it is off by more than round-off.
#[doc(hidden)]
pub fn check(mass: f64, centre: Vector3<f64>, tensor: [f64; 6]) -> Result<(), Inadmissible> {
    let [xx, yy, zz, xy, xz, yz] = tensor;
    let own = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| own.eigenvalues[i].total_cmp(&own.eigenvalues[j]));
    let moments @ [least, middle, largest] = order.map(|k| own.eigenvalues[k]);
    let excess = largest - middle - least;
    if excess <= round_off(mass, centre, tensor) {
        return Ok(());
    }
    let nearest = match [least + excess / 3.0, middle + excess / 3.0, largest - excess / 3.0] {
        [below, ..] if below < 0.0 => [0.0, 1.0, 1.0].map(|share| share * (0.5 * (middle + largest)).max(0.0)),
        face => face,
    };
    let axes = order.map(|k| own.eigenvectors.column(k).into_owned());
    let entry = |[i, j]: [usize; 2]| (0..3).map(|k| nearest[k] * axes[k][i] * axes[k][j]).sum();
    Err(Inadmissible { moments, nearest: [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]].map(entry) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No admissible tensor of a lattice about the nearest one is nearer, and the nearest is admissible itself.
    #[test]
    fn the_nearest_tensor_is_admissible_and_none_is_nearer() {
        let distance = |a: [f64; 6], b: [f64; 6]| -> f64 {
            // products stand twice in the matrix
            (0..6).map(|k| (a[k] - b[k]).powi(2) * if k < 3 { 1.0 } else { 2.0 }).sum()
        };
        for tensor in [
            [1e-3, 1e-3, 1e-2, 0.0, 0.0, 0.0],
            [0.0, 0.0, 3e-6, 0.0, 0.0, 0.0],
            [2.0, -1.0, 0.5, 0.3, -0.2, 0.1],
            [-2.0, -1.0, -3.0, 0.3, -0.2, 0.1],
            [0.0, 0.0, 0.0, 0.0, 1e-3, 0.0],
            [0.1, 0.7, 0.2, 0.01, -0.03, 0.05],
        ] {
            let Err(Inadmissible { nearest, moments }) = check(0.0, Vector3::zeros(), tensor) else { panic!("{tensor:?}") };
            assert!(moments.is_sorted() && check(0.0, Vector3::zeros(), nearest).is_ok(), "{tensor:?}: {nearest:?}");
            let size = tensor.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
            let own = distance(tensor, nearest);
            for place in 0..3_usize.pow(6) {
                let step = |k: usize| ((place / 3_usize.pow(k as u32) % 3) as f64 - 1.0) * 0.01 * size;
                let other: [f64; 6] = std::array::from_fn(|k| nearest[k] + step(k));
                let is_nearer = distance(tensor, other) < own - 1e-7 * size * size;
                assert!(!is_nearer || check(0.0, Vector3::zeros(), other).is_err(), "{tensor:?}: {other:?} is nearer");
            }
        }
    }

    #[test]
    fn round_off_beside_the_mass_at_its_centre_is_no_moment() {
        let (round_off, centre) = ([0.0, 0.0, 0.0, 0.0, 1.35525e-20, 0.0], Vector3::new(0.008, 0.0, 0.0553));
        assert!(check(0.2675, centre, round_off).is_ok());
        assert!(check(0.2675, Vector3::zeros(), round_off).is_err() && check(0.0, centre, round_off).is_err());
        assert!(check(0.2675, centre, [0.0, 0.0, 1e-4, 0.0, 0.0, 0.0]).is_err());
        // rods and plates
        for tensor in [[0.0, 0.1, 0.1, 0.0, 0.0, 0.0], [0.1, 0.2, 0.3, 0.0, 0.0, 0.0], [0.0; 6]] {
            assert!(check(1.0, Vector3::zeros(), tensor).is_ok(), "{tensor:?}");
        }
    }
}
