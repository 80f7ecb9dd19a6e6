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

#[cfg(test)]
mod tests {
    use super::independent_rows;

    #[test]
    fn a_sum_of_rows_is_left_out() {
        let rows =
            vec![vec![1.0, 0.0, 2.0], vec![0.0, 3.0, 1.0], vec![1.0, 3.0, 3.0], vec![0.0, 0.0, 0.0], vec![0.0, 0.0, 1e-3]];
        assert_eq!(independent_rows(&rows, None), [0, 1, 4]);
        assert_eq!(independent_rows(&rows, Some(2)), [0, 1]);
    }
}
