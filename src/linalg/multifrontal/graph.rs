use crate::assembly::SparsePattern;
use std::collections::HashMap;

/// What the order of elimination has to know of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Brings its own pivot.
    Primal,
    /// Gets its pivot from the elimination of its neighbours.
    Multiplier,
    /// Is not eliminated: it stays in the Schur complement.
    Kept,
}

/// The graph of A + A^T, in which unknowns of equal pattern (as those of a node) are one vertex.
pub struct Graph {
    /// First neighbour of each vertex, and the end.
    pub starts: Vec<usize>,
    /// Neighbours of the vertices, without themselves.
    pub neighbours: Vec<u32>,
    /// Role of the unknowns of each vertex.
    pub roles: Vec<Role>,
    member_starts: Vec<usize>,
    members: Vec<u32>,
}

impl Graph {
    /// Of a pattern; `roles` of its unknowns.
    pub fn new(pattern: &SparsePattern, roles: &[Role]) -> Self {
        let vertex_of = equal_patterns(pattern, roles);
        let vertices = vertex_of.iter().map(|&vertex| vertex as usize + 1).max().unwrap_or(0);
        let (member_starts, members) = by_key(vertices, &vertex_of, |unknown| unknown as u32);
        let edges = || {
            let entries = (0..pattern.size).flat_map(|column| {
                let own = pattern.column_starts[column]..pattern.column_starts[column + 1];
                pattern.rows[own].iter().map(move |&row| (column, row))
            });
            entries.filter_map(|(column, row)| {
                let edge = (vertex_of[column], vertex_of[row]);
                (edge.0 != edge.1).then_some(edge)
            })
        };
        // each vertex is seen from one member's column first, so that repeated edges are few
        let (mut sources, mut targets) = (Vec::new(), Vec::new());
        let mut last_seen = vec![u32::MAX; vertices];
        for (from, to) in edges() {
            if last_seen[to as usize] != from {
                last_seen[to as usize] = from;
                sources.extend([from, to]);
                targets.extend([to, from]);
            }
        }
        let (all_starts, all) = by_key(vertices, &sources, |edge| targets[edge]);
        let (mut starts, mut neighbours) = (vec![0], Vec::with_capacity(all.len() / 2));
        for vertex in 0..vertices {
            let first = neighbours.len();
            neighbours.extend_from_slice(&all[all_starts[vertex]..all_starts[vertex + 1]]);
            neighbours[first..].sort_unstable();
            let mut kept = first;
            for place in first..neighbours.len() {
                if kept == first || neighbours[place] != neighbours[kept - 1] {
                    neighbours[kept] = neighbours[place];
                    kept += 1;
                }
            }
            neighbours.truncate(kept);
            starts.push(kept);
        }
        let roles = (0..vertices).map(|vertex| roles[members[member_starts[vertex]] as usize]).collect();
        Graph { starts, neighbours, roles, member_starts, members }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.roles.len()
    }

    /// Vertices beside a vertex.
    pub fn neighbours(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// Unknowns of a vertex, increasing.
    pub fn members(&self, vertex: usize) -> &[u32] {
        &self.members[self.member_starts[vertex]..self.member_starts[vertex + 1]]
    }

    /// Number of unknowns of a vertex.
    pub fn weight(&self, vertex: usize) -> usize {
        self.members(vertex).len()
    }
}

/// Values 0.. sorted by key, and where each key starts.
fn by_key(keys: usize, key_of: &[u32], value: impl Fn(usize) -> u32) -> (Vec<usize>, Vec<u32>) {
    let mut starts = vec![0; keys + 1];
    key_of.iter().for_each(|&key| starts[key as usize + 1] += 1);
    (0..keys).for_each(|key| starts[key + 1] += starts[key]);
    let (mut next, mut sorted) = (starts.clone(), vec![0; key_of.len()]);
    for (item, &key) in key_of.iter().enumerate() {
        sorted[next[key as usize]] = value(item);
        next[key as usize] += 1;
    }
    (starts, sorted)
}

/// The vertex of each unknown: one for unknowns of the same role whose columns and rows have the same pattern, where the diagonal counts as
/// an entry of a primal unknown and as none of a multiplier.
///
/// Patterns are compared by sums of random numbers; two that only seem equal would cost fill and nothing else, for all their edges
/// are in the graph.
fn equal_patterns(pattern: &SparsePattern, roles: &[Role]) -> Vec<u32> {
    let number: Vec<u64> = (0..pattern.size as u64).map(scrambled).collect();
    let own = |unknown: usize| {
        if roles[unknown] == Role::Multiplier { 0 } else { number[unknown] }
    };
    let mut in_column: Vec<u64> = (0..pattern.size).map(own).collect();
    let mut in_row = in_column.clone();
    for column in 0..pattern.size {
        for &row in &pattern.rows[pattern.column_starts[column]..pattern.column_starts[column + 1]] {
            if row != column {
                in_column[column] = in_column[column].wrapping_add(number[row]);
                in_row[row] = in_row[row].wrapping_add(number[column]);
            }
        }
    }
    let mut vertices = HashMap::new();
    let mut vertex = |unknown: usize| {
        let next = vertices.len() as u32;
        *vertices.entry((in_column[unknown], in_row[unknown], roles[unknown])).or_insert(next)
    };
    (0..pattern.size).map(&mut vertex).collect()
}

/// A number without a visible relation to another (the finalizer of splitmix64; Steele, Lea & Flood 2014).
fn scrambled(number: u64) -> u64 {
    let mut bits = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}
