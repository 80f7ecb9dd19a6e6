/// Rows whose remaining part is below this share of a unit row depend on the chosen ones.
const DEPENDENT: f64 = 1e-9;

/// An independent subset of the rows of a matrix, as indices in increasing order, by orthogonalization with row pivoting.
///
/// Among rows that are almost equally independent of those already chosen the earliest is taken, so that the result follows
/// the order in which joints were given. Rows are scaled to unit length first; zero rows are dependent. With `rank` so many rows are
/// chosen, however small what is left of them.
pub fn independent_rows(rows: &[Vec<f64>], rank: Option<usize>) -> Vec<usize> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut remaining: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| {
            let norm = dot(row, row).sqrt();
            if norm > 0.0 { row.iter().map(|x| x / norm).collect() } else { row.clone() }
        })
        .collect();
    let mut chosen = Vec::new();
    loop {
        let norms: Vec<f64> = remaining.iter().map(|row| dot(row, row).sqrt()).collect();
        let largest = norms.iter().fold(0.0, |a: f64, &b| a.max(b));
        let enough = rank.map_or(largest < DEPENDENT, |rank| chosen.len() >= rank || largest == 0.0);
        if enough {
            break;
        }
        let Some(pivot) = norms.iter().position(|&norm| norm >= 0.1 * largest) else { break };
        let unit: Vec<f64> = remaining[pivot].iter().map(|x| x / norms[pivot]).collect();
        // twice: once leaves parts of the size of round-off times the growth
        for row in &mut remaining {
            for _ in 0..2 {
                let share = dot(row, &unit);
                row.iter_mut().zip(&unit).for_each(|(x, u)| *x -= share * u);
            }
        }
        remaining[pivot].fill(0.0);
        chosen.push(pivot);
    }
    chosen.sort_unstable();
    chosen
}

/// Sign of the determinant of a square matrix given by rows, which are eliminated: 1, -1, or 0 where a pivot vanishes.
pub fn sign_of_determinant(rows: &mut [f64], size: usize) -> f64 {
    let mut sign = 1.0;
    for k in 0..size {
        let pivot = (k..size).max_by(|&i, &j| rows[i * size + k].abs().total_cmp(&rows[j * size + k].abs())).unwrap_or(k);
        if pivot != k {
            (0..size).for_each(|column| rows.swap(k * size + column, pivot * size + column));
            sign = -sign;
        }
        let (above, below) = rows.split_at_mut((k + 1) * size);
        let own = &above[k * size..];
        if own[k] == 0.0 {
            return 0.0;
        }
        sign *= own[k].signum();
        for row in below.chunks_mut(size).filter(|row| row[k] != 0.0) {
            let factor = row[k] / own[k];
            row.iter_mut().zip(own).skip(k).for_each(|(entry, own)| *entry -= factor * own);
        }
    }
    sign
}

#[cfg(test)]
mod tests {
    use super::{independent_rows, sign_of_determinant};

    #[test]
    fn determinants_have_their_signs() {
        let cyclic = vec![0.0, 2.0, 0.0, 0.0, 0.0, 3.0, 0.5, 0.0, 0.0];
        assert_eq!(sign_of_determinant(&mut cyclic.clone(), 3), 1.0);
        let mut exchanged: Vec<f64> = [3..6, 0..3, 6..9].into_iter().flat_map(|row| cyclic[row].to_vec()).collect();
        assert_eq!(sign_of_determinant(&mut exchanged, 3), -1.0);
        assert_eq!(sign_of_determinant(&mut [1.0, 2.0, 2.0, 4.0], 2), 0.0);
        // 1 2 / 3 4 has -2, and 4 with a negative first row 2
        assert_eq!(sign_of_determinant(&mut [1.0, 2.0, 3.0, 4.0], 2), -1.0);
        assert_eq!(sign_of_determinant(&mut [-1.0, -2.0, 3.0, 4.0], 2), 1.0);
    }

    #[test]
    fn a_sum_of_rows_is_left_out() {
        let rows =
            vec![vec![1.0, 0.0, 2.0], vec![0.0, 3.0, 1.0], vec![1.0, 3.0, 3.0], vec![0.0, 0.0, 0.0], vec![0.0, 0.0, 1e-3]];
        assert_eq!(independent_rows(&rows, None), [0, 1, 4]);
        assert_eq!(independent_rows(&rows, Some(2)), [0, 1]);
    }
}
