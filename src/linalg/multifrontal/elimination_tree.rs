use super::graph::Graph;

/// No parent: the vertex is a root.
pub const NONE: u32 = u32::MAX;

/// Which elimination first uses the result of which, and how many unknowns each vertex couples when its turn comes.
///
/// Source: Liu (1990), The role of elimination trees in sparse factorization.
pub struct EliminationTree {
    /// Vertices of the graph in an order equivalent to the given one, in which the descendants of a vertex stand just before it.
    pub order: Vec<u32>,
    /// Place of the parent of the vertex at each place.
    pub parents: Vec<u32>,
    /// Unknowns of the vertex at each place and of those after it that it couples.
    pub counts: Vec<usize>,
}

impl EliminationTree {
    /// Of a graph whose vertices are eliminated in a given order.
    pub fn new(graph: &Graph, order: &[u32]) -> Self {
        let count = graph.len();
        let mut place = vec![0; count];
        order.iter().zip(0..).for_each(|(&vertex, own)| place[vertex as usize] = own);
        let parents = parents(graph, order, &place);
        let counts = counts(graph, order, &place, &parents);
        let sequence = postorder(&parents);
        let mut new_place = vec![0; count];
        sequence.iter().zip(0..).for_each(|(&old, new)| new_place[old as usize] = new);
        let parent = |&old: &u32| if old == NONE { NONE } else { new_place[old as usize] };
        EliminationTree {
            order: sequence.iter().map(|&old| order[old as usize]).collect(),
            parents: sequence.iter().map(|&old| parent(&parents[old as usize])).collect(),
            counts: sequence.iter().map(|&old| counts[old as usize]).collect(),
        }
    }
}

fn parents(graph: &Graph, order: &[u32], place: &[u32]) -> Vec<u32> {
    let (mut parents, mut ancestors) = (vec![NONE; order.len()], vec![NONE; order.len()]);
    for (own, &vertex) in (0u32..).zip(order) {
        for &neighbour in graph.neighbours(vertex as usize) {
            let mut below = place[neighbour as usize];
            while below < own {
                let next = std::mem::replace(&mut ancestors[below as usize], own);
                if next == NONE {
                    parents[below as usize] = own;
                }
                below = next;
            }
        }
    }
    parents
}

fn counts(graph: &Graph, order: &[u32], place: &[u32], parents: &[u32]) -> Vec<usize> {
    let mut counts: Vec<usize> = order.iter().map(|&vertex| graph.weight(vertex as usize)).collect();
    let mut seen_from = vec![NONE; order.len()];
    for (own, &vertex) in (0u32..).zip(order) {
        seen_from[own as usize] = own;
        for &neighbour in graph.neighbours(vertex as usize) {
            let mut below = place[neighbour as usize];
            while below < own && seen_from[below as usize] != own {
                seen_from[below as usize] = own;
                counts[below as usize] += graph.weight(vertex as usize);
                below = parents[below as usize];
            }
        }
    }
    counts
}

/// Nodes of a forest, children before their parents and without gaps, in the order of their numbers where that leaves a choice.
fn postorder(parents: &[u32]) -> Vec<u32> {
    let (mut first_child, mut next_sibling) = (vec![NONE; parents.len()], vec![NONE; parents.len()]);
    let mut first_root = NONE;
    for node in (0..parents.len()).rev() {
        let head = if parents[node] == NONE { &mut first_root } else { &mut first_child[parents[node] as usize] };
        next_sibling[node] = std::mem::replace(head, node as u32);
    }
    let (mut sequence, mut path) = (Vec::with_capacity(parents.len()), Vec::new());
    let mut root = first_root;
    while root != NONE {
        path.push(root);
        while let Some(&node) = path.last() {
            let child = std::mem::replace(&mut first_child[node as usize], NONE);
            if child == NONE {
                sequence.push(node);
                path.pop();
                if next_sibling[node as usize] != NONE && !path.is_empty() {
                    path.push(next_sibling[node as usize]);
                }
            } else {
                path.push(child);
            }
        }
        root = next_sibling[root as usize];
    }
    sequence
}
