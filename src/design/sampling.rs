//! Points that fill the unit cube evenly, the same in every run: designs to start from, designs of a parameter study.

/// Numbers that are the same in every run (a linear congruential generator; Knuth, MMIX).
struct Numbers(u64);

impl Numbers {
    /// Below 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn below(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }
}

/// A Latin hypercube: of `count` points each has, in each dimension, one of `count` equal strata of [0, 1) for itself,
/// and a random place in it.
///
/// Source: McKay, Beckman & Conover (1979).
pub fn latin_hypercube(count: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut numbers = Numbers(seed);
    let mut points = vec![Vec::with_capacity(dimensions); count];
    for _ in 0..dimensions {
        let mut strata: Vec<usize> = (0..count).collect();
        for last in (1..count).rev() {
            strata.swap(last, numbers.below(last + 1));
        }
        for (point, stratum) in points.iter_mut().zip(strata) {
            point.push((stratum as f64 + numbers.next()) / count as f64);
        }
    }
    points
}

/// Bits of a coordinate of a Sobol' point.
const BITS: usize = 32;

/// Most dimensions of [`sobol`].
pub const SOBOL_DIMENSIONS: usize = POLYNOMIALS.len() + 1;

/// Inner coefficients of a primitive polynomial and initial direction numbers, for each dimension from the second on.
///
/// Source: Joe & Kuo (2008), "Constructing Sobol sequences with better two-dimensional projections", table
/// new-joe-kuo-6.21201.
const POLYNOMIALS: [(u32, &[u32]); 20] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
    (19, &[1, 1, 1, 15, 7, 5]),
    (22, &[1, 3, 1, 15, 13, 25]),
    (25, &[1, 1, 5, 5, 19, 61]),
    (1, &[1, 3, 7, 11, 23, 15, 103]),
    (4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// Direction numbers v_k of a dimension, k from 0 on, by its polynomial of degree s with inner coefficients a_1 ... a_(s-1):
///
/// v_k = v_(k-s) xor (v_(k-s) / 2^s) xor a_1 v_(k-1) xor ... xor a_(s-1) v_(k-s+1)
fn directions(dimension: usize) -> [u32; BITS] {
    let mut v = std::array::from_fn(|k| 1 << (BITS - 1 - k));
    let Some((coefficients, initial)) = dimension.checked_sub(1).map(|row| POLYNOMIALS[row]) else { return v };
    let degree = initial.len();
    for k in 0..BITS {
        v[k] = match initial.get(k) {
            Some(m) => m << (BITS - 1 - k),
            None => {
                let inner = (1..degree).filter(|i| coefficients >> (degree - 1 - i) & 1 == 1);
                inner.fold(v[k - degree] ^ (v[k - degree] >> degree), |sum, i| sum ^ v[k - i])
            }
        };
    }
    v
}

/// The first points of Sobol's sequence in [0, 1), in the order of Antonov & Saleev; with a seed each coordinate is
/// shifted by random binary digits of its own, which keeps how evenly the points lie. Counts that are powers of two are the
/// evenest.
///
/// Source: Sobol' (1967); Joe & Kuo (2008).
///
/// # Errors
/// More than `SOBOL_DIMENSIONS`, or than 2^32 points.
pub fn sobol(count: usize, dimensions: usize, seed: Option<u64>) -> Result<Vec<Vec<f64>>, String> {
    if dimensions > SOBOL_DIMENSIONS || count as u64 > 1 << BITS {
        return Err(format!(
            "{count} points in {dimensions} dimensions are asked for; Sobol's sequence has at most 2^{BITS} points in \
             {SOBOL_DIMENSIONS} dimensions here"
        ));
    }
    let mut numbers = seed.map(Numbers);
    let scale = (1_u64 << BITS) as f64;
    let shifts: Vec<u32> =
        (0..dimensions).map(|_| numbers.as_mut().map_or(0, |numbers| (numbers.next() * scale) as u32)).collect();
    let directions: Vec<[u32; BITS]> = (0..dimensions).map(directions).collect();
    let coordinate = |k: usize, dimension: usize| {
        let gray = k ^ (k >> 1);
        let set = (0..BITS).filter(|bit| gray >> bit & 1 == 1);
        let digits = set.fold(shifts[dimension], |sum, bit| sum ^ directions[dimension][bit]);
        f64::from(digits) / scale
    };
    Ok((0..count).map(|k| (0..dimensions).map(|dimension| coordinate(k, dimension)).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Numbers of the strata of [0, 1) in which the coordinates of points lie.
    fn strata(points: &[Vec<f64>], dimension: usize) -> Vec<usize> {
        let mut strata: Vec<usize> =
            points.iter().map(|point| (point[dimension] * points.len() as f64).floor() as usize).collect();
        strata.sort_unstable();
        strata
    }

    #[test]
    fn each_stratum_has_one_point_in_every_dimension() {
        let cases = [
            latin_hypercube(37, 5, 8),
            sobol(256, SOBOL_DIMENSIONS, None).expect("few"),
            sobol(64, SOBOL_DIMENSIONS, Some(3)).expect("few"),
        ];
        for points in cases {
            for dimension in 0..points[0].len() {
                assert_eq!(strata(&points, dimension), (0..points.len()).collect::<Vec<_>>(), "dimension {dimension}");
            }
        }
        assert_ne!(latin_hypercube(37, 5, 8), latin_hypercube(37, 5, 9));
        assert_ne!(sobol(64, 2, Some(3)), sobol(64, 2, Some(4)));
        assert!(sobol(4, SOBOL_DIMENSIONS + 1, None).is_err_and(|message| message.contains("21 dimensions")));
    }

    /// Point 299 of SciPy, `qmc.Sobol(21, scramble=False)`, times 512; and each square of side 1/16 has one of 256 points in
    /// the first two dimensions.
    #[test]
    fn points_of_sobol_are_those_of_another_program() {
        let point = &sobol(300, SOBOL_DIMENSIONS, None).expect("few")[299];
        let other = [251, 343, 83, 239, 103, 463, 67, 143, 11, 233, 449, 183, 241, 317, 479, 25, 169, 97, 257, 233, 185];
        assert_eq!(*point, other.map(|share| f64::from(share) / 512.0));
        let points = sobol(256, 2, None).expect("few");
        let squares: HashSet<[usize; 2]> = points.iter().map(|point| [0, 1].map(|i| (point[i] * 16.0) as usize)).collect();
        assert_eq!(squares.len(), 256);
    }
}
