// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]

use super::elimination_tree::{EliminationTree, NONE};
use super::graph::Graph;

/// Vertices that are eliminated together, in one dense front.
#[derive(Clone, Default)]
pub struct Supernode {
    /// Places in the order of the elimination tree, increasing.
    pub vertices: Vec<u32>,
    /// Number of unknowns eliminated.
    pub pivots: usize,
    /// Number of unknowns eliminated or coupled.
    pub size: usize,
    /// Number of the supernode that takes up what is left.
    pub parent: Option<usize>,
}

/// Multiplications and additions of the elimination of `pivots` unknowns from a dense matrix.
pub fn elimination_flops(pivots: usize, size: usize) -> f64 {
    // sum over the remaining sizes s of s divisions and 2 s^2 operations of the update
    let sums = |s: f64| s * (s - 1.0) / 2.0 + 2.0 * (s - 1.0) * s * (2.0 * s - 1.0) / 6.0;
    sums(size as f64) - sums((size - pivots) as f64)
}

/// Numbers of the factors of a front.
pub fn factor_entries(pivots: usize, size: usize) -> usize {
    pivots * (2 * size - pivots)
}

/// Time of a front [ns], as measured on one core of 2023: calls and indices, assembly of the entries, arithmetic.
fn front_time(pivots: usize, size: usize) -> f64 {
    const FRONT: f64 = 200.0;
    const ENTRY: f64 = 0.6;
    const FLOP: f64 = 0.06;
    FRONT + ENTRY * (size * size) as f64 + FLOP * elimination_flops(pivots, size)
}

/// Supernodes in the order of elimination: vertices of equal structure, then with their parents where one front takes less time than two.
///
/// Children of one parent are ordered so that few contributions wait at the same time.
///
/// Source: Ashcraft & Grimes (1989) for relaxed supernodes; Liu (1986) for the order of the children.
pub fn supernodes(graph: &Graph, tree: &EliminationTree) -> Vec<Supernode> {
    let mut supernodes = fundamental(graph, tree);
    let merged_into = amalgamate(&mut supernodes);
    let alive: Vec<usize> = (0..supernodes.len()).filter(|&s| merged_into[s] == s).collect();
    let mut number = vec![0; supernodes.len()];
    alive.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    let representative = |mut s: usize| {
        while merged_into[s] != s {
            s = merged_into[s];
        }
        s
    };
    let kept: Vec<Supernode> = alive
        .iter()
        .map(|&old| {
            let mut supernode = std::mem::take(&mut supernodes[old]);
            supernode.vertices.sort_unstable();
            supernode.parent = supernode.parent.map(|parent| number[representative(parent)]);
            supernode
        })
        .collect();
    in_order_of_memory(kept)
}

fn fundamental(graph: &Graph, tree: &EliminationTree) -> Vec<Supernode> {
    let mut supernodes: Vec<Supernode> = Vec::new();
    let mut supernode_of = vec![0; tree.order.len()];
    for place in 0..tree.order.len() {
        let weight = graph.weight(tree.order[place] as usize);
        let continues = place > 0 && {
            let before = graph.weight(tree.order[place - 1] as usize);
            tree.parents[place - 1] == place as u32 && tree.counts[place - 1] == tree.counts[place] + before
        };
        if !continues {
            supernodes.push(Supernode { size: tree.counts[place], ..Supernode::default() });
        }
        supernode_of[place] = supernodes.len() - 1;
        if let Some(supernode) = supernodes.last_mut() {
            supernode.vertices.push(place as u32);
            supernode.pivots += weight;
        }
    }
    for supernode in &mut supernodes {
        let parent = supernode.vertices.last().map_or(NONE, |&last| tree.parents[last as usize]);
        supernode.parent = (parent != NONE).then(|| supernode_of[parent as usize]);
    }
    supernodes
}

/// Merges children into parents; returns for each supernode the one it was merged into, itself if none.
fn amalgamate(supernodes: &mut [Supernode]) -> Vec<usize> {
    let mut merged_into: Vec<usize> = (0..supernodes.len()).collect();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); supernodes.len()];
    for s in 0..supernodes.len() {
        let mut candidates = std::mem::take(&mut children[s]);
        candidates.sort_by_key(|&child| std::cmp::Reverse(supernodes[child].size));
        if supernodes[s].pivots > 0 {
            for child in candidates {
                let (below, above) = supernodes.split_at_mut(s);
                let (child_node, own) = (&mut below[child], &mut above[0]);
                let (pivots, size) = (own.pivots + child_node.pivots, own.size + child_node.pivots);
                let apart = front_time(own.pivots, own.size) + front_time(child_node.pivots, child_node.size);
                if front_time(pivots, size) < apart {
                    own.vertices.append(&mut child_node.vertices);
                    (own.pivots, own.size) = (pivots, size);
                    merged_into[child] = s;
                }
            }
        }
        if let Some(parent) = supernodes[s].parent {
            children[parent].push(s);
        }
    }
    merged_into
}

/// Renumbers supernodes, children before parents, and the child that leaves the most memory free while it is worked on first.
fn in_order_of_memory(supernodes: Vec<Supernode>) -> Vec<Supernode> {
    let count = supernodes.len();
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut peak = vec![0; count];
    // merged supernodes keep the number of the parent, so parents still come last
    for s in 0..count {
        let left = |s: usize| (supernodes[s].size - supernodes[s].pivots).pow(2);
        children[s].sort_by_key(|&child| std::cmp::Reverse(peak[child] - left(child)));
        let mut waiting = 0;
        for &child in &children[s] {
            peak[s] = peak[s].max(waiting + peak[child]);
            waiting += left(child);
        }
        peak[s] = peak[s].max(waiting + left(s));
        if let Some(parent) = supernodes[s].parent {
            children[parent].push(s);
        }
    }
    // a forest whose numbers carry the order of the siblings: parents before children, the last child first
    let mut sequence = Vec::with_capacity(count);
    let mut waiting: Vec<usize> = (0..count).filter(|&s| supernodes[s].parent.is_none()).collect();
    while let Some(s) = waiting.pop() {
        sequence.push(s);
        waiting.extend(&children[s]);
    }
    sequence.reverse();
    let mut number = vec![0; count];
    sequence.iter().enumerate().for_each(|(new, &old)| number[old] = new);
    let renumbered = |&old: &usize| {
        let Supernode { vertices, pivots, size, parent } = supernodes[old].clone();
        Supernode { vertices, pivots, size, parent: parent.map(|parent| number[parent]) }
    };
    sequence.iter().map(renumbered).collect()
}
