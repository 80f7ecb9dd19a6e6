use crate::linalg::SparsePattern;
use std::collections::HashMap;

/// What the order of elimination has to know of an unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Brings its own pivot.
    Primal,
    /// Gets its pivot from the elimination of its neighbours.
    Multiplier,
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
    /// Of a pattern, in which unknowns without a diagonal entry are multipliers.
    pub fn new(pattern: &SparsePattern) -> Self {
        let role = |own: usize| if pattern.position(own, own).is_some() { Role::Primal } else { Role::Multiplier };
        let roles: Vec<Role> = (0..pattern.size).map(role).collect();
        let vertex_of = equal_patterns(pattern, &roles);
        let vertices = vertex_of.iter().map(|&vertex| vertex as usize + 1).max().unwrap_or(0);
        let all: Vec<usize> = (0..=pattern.size).collect();
        let (member_starts, members) = transposed(&all, &vertex_of, vertices);
        // the columns of all members have the same rows
        let (mut first_rows, mut rows) = (vec![0], Vec::new());
        let mut last_seen = vec![u32::MAX; vertices];
        for vertex in 0..vertices {
            last_seen[vertex] = vertex as u32;
            for &row in rows_of(pattern, members[member_starts[vertex]] as usize) {
                let other = vertex_of[row as usize] as usize;
                if last_seen[other] != vertex as u32 {
                    last_seen[other] = vertex as u32;
                    rows.push(other as u32);
                }
            }
            first_rows.push(rows.len());
        }
        let (first_columns, columns) = transposed(&first_rows, &rows, vertices);
        // transposed twice: increasing
        let (first_rows, rows) = transposed(&first_columns, &columns, vertices);
        let (mut starts, mut neighbours) = (vec![0], Vec::with_capacity(rows.len()));
        for vertex in 0..vertices {
            let rows = &rows[first_rows[vertex]..first_rows[vertex + 1]];
            let columns = &columns[first_columns[vertex]..first_columns[vertex + 1]];
            unite(rows, columns, &mut neighbours);
            starts.push(neighbours.len());
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

/// Rows of the entries of a column.
pub fn rows_of(pattern: &SparsePattern, column: usize) -> &[u32] {
    &pattern.rows[pattern.column_starts[column]..pattern.column_starts[column + 1]]
}

/// Lists of the numbers of the lists, one after the other in `items`, in which each item stands: increasing.
fn transposed(starts: &[usize], items: &[u32], count: usize) -> (Vec<usize>, Vec<u32>) {
    let mut new_starts = vec![0; count + 1];
    items.iter().for_each(|&item| new_starts[item as usize + 1] += 1);
    (0..count).for_each(|item| new_starts[item + 1] += new_starts[item]);
    let (mut next, mut lists) = (new_starts.clone(), vec![0; items.len()]);
    for (list, bounds) in (0u32..).zip(starts.windows(2)) {
        for &item in &items[bounds[0]..bounds[1]] {
            lists[next[item as usize]] = list;
            next[item as usize] += 1;
        }
    }
    (new_starts, lists)
}

/// Appends the numbers of two increasing lists, each once and increasing.
fn unite(mut a: &[u32], mut b: &[u32], united: &mut Vec<u32>) {
    if a == b {
        united.extend_from_slice(a);
        return;
    }
    while let (Some((&first, rest)), Some((&other, other_rest))) = (a.split_first(), b.split_first()) {
        united.push(first.min(other));
        a = if first <= other { rest } else { a };
        b = if other <= first { other_rest } else { b };
    }
    united.extend_from_slice(a);
    united.extend_from_slice(b);
}

/// The vertex of each unknown: one for unknowns of the same role whose columns and rows have the same pattern, where the diagonal counts as
/// an entry of a primal unknown and as none of a multiplier.
///
/// Patterns are compared by sums of random numbers, one of 64 bits for the column and an independent one for the row: among a million
/// unknowns two that only seem equal have a probability of 1e-27.
fn equal_patterns(pattern: &SparsePattern, roles: &[Role]) -> Vec<u32> {
    let number: Vec<u64> = (0..pattern.size as u64).map(scrambled).collect();
    let other_number: Vec<u64> = number.iter().map(|&number| scrambled(number)).collect();
    let own = |numbers: &[u64]| -> Vec<u64> {
        let own = |(&number, &role): (&u64, &Role)| if role == Role::Multiplier { 0 } else { number };
        numbers.iter().zip(roles).map(own).collect()
    };
    let (mut in_column, mut in_row) = (own(&number), own(&other_number));
    let mut first = 0;
    while first < pattern.size {
        let rows = rows_of(pattern, first);
        let equal = (first + 1..pattern.size).take_while(|&column| rows_of(pattern, column) == rows).count();
        let columns = first..first + 1 + equal;
        first = columns.end;
        let of_rows = rows.iter().fold(0, |sum: u64, &row| sum.wrapping_add(number[row as usize]));
        let of_columns = other_number[columns.clone()].iter().fold(0, |sum: u64, &number| sum.wrapping_add(number));
        columns.clone().for_each(|column| in_column[column] = in_column[column].wrapping_add(of_rows));
        for row in rows.iter().map(|&row| row as usize) {
            in_row[row] = in_row[row].wrapping_add(of_columns);
            // without the diagonal
            if columns.contains(&row) {
                in_row[row] = in_row[row].wrapping_sub(other_number[row]);
                in_column[row] = in_column[row].wrapping_sub(number[row]);
            }
        }
    }
    let mut vertices = HashMap::new();
    let mut last = None;
    let mut vertex = |unknown: usize| {
        let key = (in_column[unknown], in_row[unknown], roles[unknown]);
        match last {
            Some((known, vertex)) if known == key => vertex,
            _ => {
                let next = vertices.len() as u32;
                let vertex = *vertices.entry(key).or_insert(next);
                last = Some((key, vertex));
                vertex
            }
        }
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
