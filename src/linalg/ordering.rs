use crate::linalg::SparsePattern;
use std::collections::{BTreeSet, HashMap};

/// An order of elimination with what it costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordering {
    /// Columns in the order of their elimination.
    pub columns: Vec<usize>,
    /// Multiplications of one factorization with pivots on the diagonal.
    pub multiplications: f64,
    /// Entries of L and U.
    pub fill: usize,
}

/// Minimum-degree ordering of A + A^T for systems with multipliers; `None` where it would cost more than `limit` multiplications.
///
/// Unknowns with the same neighbours (those of one node, the multipliers of one joint) are eliminated together. An unknown
/// without an entry on the diagonal, a multiplier, follows its last neighbour: then its pivot, a part of -A M^-1 A^T, is there. A
/// chain of bodies falls apart into single bodies and one block-tridiagonal matrix of joints.
///
/// Source: George & Liu (1989), The evolution of the minimum degree ordering algorithm.
pub fn minimum_degree(pattern: &SparsePattern, limit: f64) -> Option<Ordering> {
    let n = pattern.size;
    let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut pivoted = vec![false; n];
    for column in 0..n {
        for &row in &pattern.rows[pattern.column_starts[column]..pattern.column_starts[column + 1]] {
            if row == column {
                pivoted[column] = true;
            } else {
                neighbours[column].push(row);
                neighbours[row].push(column);
            }
        }
    }
    let mut keys: HashMap<(bool, Vec<usize>), usize> = HashMap::new();
    let mut members: Vec<Vec<usize>> = Vec::new();
    let mut group_of = vec![0; n];
    for unknown in 0..n {
        let mut key = neighbours[unknown].clone();
        if pivoted[unknown] {
            key.push(unknown);
        }
        key.sort_unstable();
        key.dedup();
        let group = *keys.entry((pivoted[unknown], key)).or_insert_with(|| {
            members.push(Vec::new());
            members.len() - 1
        });
        members[group].push(unknown);
        group_of[unknown] = group;
    }
    drop(keys);

    let mut graph: Vec<BTreeSet<usize>> = members
        .iter()
        .enumerate()
        .map(|(own, members)| neighbours[members[0]].iter().map(|&u| group_of[u]).filter(|&group| group != own).collect())
        .collect();
    let original = graph.clone();
    let mut waiting: Vec<usize> =
        members.iter().zip(&graph).map(|(members, around)| if pivoted[members[0]] { 0 } else { around.len() }).collect();
    let degree = |graph: &[BTreeSet<usize>], group: usize| graph[group].iter().map(|&g| members[g].len()).sum::<usize>();
    let mut queued: Vec<Option<usize>> =
        (0..members.len()).map(|group| (waiting[group] == 0).then(|| degree(&graph, group))).collect();
    let mut queue: BTreeSet<(usize, usize)> =
        queued.iter().enumerate().filter_map(|(group, degree)| degree.map(|degree| (degree, group))).collect();
    let mut columns = Vec::with_capacity(n);
    let (mut multiplications, mut fill) = (0.0, 0);
    while let Some((degree_of_group, group)) = queue.pop_first() {
        for step in 0..members[group].len() {
            let below = members[group].len() - 1 - step + degree_of_group;
            multiplications += (below * (below + 1)) as f64;
            fill += 1 + 2 * below;
        }
        if multiplications > limit {
            return None;
        }
        columns.extend_from_slice(&members[group]);
        let around = std::mem::take(&mut graph[group]);
        for &other in &around {
            graph[other].remove(&group);
            let met: Vec<usize> = around.iter().copied().filter(|&third| third != other).collect();
            graph[other].extend(met);
        }
        for &other in &original[group] {
            if waiting[other] > 0 {
                waiting[other] -= 1;
            }
        }
        for &other in &around {
            if let Some(old) = queued[other] {
                queue.remove(&(old, other));
            }
            if waiting[other] == 0 {
                let new = degree(&graph, other);
                queue.insert((new, other));
                queued[other] = Some(new);
            }
        }
    }
    // a multiplier that nothing holds stays behind: its column is empty
    let mut placed = vec![false; n];
    columns.iter().for_each(|&column| placed[column] = true);
    columns.extend((0..n).filter(|&column| !placed[column]));
    Some(Ordering { columns, multiplications, fill })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies of six unknowns in a row, joints of three multipliers between them and to the ground.
    fn chain(bodies: usize) -> SparsePattern {
        let mut entries = Vec::new();
        for body in 0..bodies {
            let own: Vec<usize> = (6 * body..6 * body + 6).collect();
            let joint: Vec<usize> = (6 * bodies + 3 * body..6 * bodies + 3 * body + 3).collect();
            let before: Vec<usize> = if body > 0 { (6 * body - 6..6 * body).collect() } else { Vec::new() };
            entries.extend(own.iter().flat_map(|&i| own.iter().map(move |&j| (i, j))));
            for &node in own.iter().chain(&before) {
                entries.extend(joint.iter().flat_map(|&m| [(node, m), (m, node)]));
            }
        }
        SparsePattern::from_entries(9 * bodies, entries)
    }

    #[test]
    fn work_on_a_chain_grows_linearly() {
        let [short, long] = [50, 100].map(|n| minimum_degree(&chain(n), f64::INFINITY).expect("no limit").multiplications);
        assert!(long < 2.05 * short, "{short} and {long}");
        // a body with two joints and the block of its joint: some 900 multiplications
        assert!(long / 100.0 < 1000.0, "{}", long / 100.0);
    }

    #[test]
    fn multipliers_follow_all_their_neighbours() {
        let pattern = chain(7);
        let ordering = minimum_degree(&pattern, f64::INFINITY).expect("no limit");
        let mut place = vec![usize::MAX; pattern.size];
        ordering.columns.iter().enumerate().for_each(|(at, &column)| place[column] = at);
        assert!(place.iter().all(|&at| at < pattern.size), "every column once");
        for multiplier in 42..pattern.size {
            let rows = &pattern.rows[pattern.column_starts[multiplier]..pattern.column_starts[multiplier + 1]];
            assert!(rows.iter().all(|&row| place[row] < place[multiplier]));
        }
    }

    #[test]
    fn expensive_patterns_are_given_up() {
        let full = SparsePattern::from_entries(60, (0..60).flat_map(|i| (0..60).map(move |j| (i, j))).collect());
        let all = minimum_degree(&full, f64::INFINITY).expect("no limit").multiplications;
        assert!((70_000.0..72_000.0).contains(&all), "{all}: n^3 / 3");
        assert!(minimum_degree(&full, 1e4).is_none());
    }
}
