//! Kinematic loops: which joints can share the loads of redundant equations.
//!
//! Nodes and joints are a graph, with the ground as one node. Forces that joints bear without any load are in balance at each node. Where a node
//! alone holds a part of the mechanism, the forces of all joints in that part have no resultant, as each joint's are in balance: so they are in
//! balance without those of the rest. What is not determined in one part that hangs together by more than a node has nothing to do with others.
//!
//! Source: Hopcroft & Tarjan, Communications of the ACM 16 (1973), "Algorithm 447", for the parts of a graph.

use crate::assembly::Model;
use crate::elements::NodeKind;
use crate::program::Formula;
use std::collections::HashMap;
use std::sync::Arc;

/// For each joint the number of its part: joints of different parts share no loads.
pub fn parts_of_joints(model: &Model, p: &[f64]) -> Vec<usize> {
    Graph::of(model, p).parts()
}

/// Vertices are the ground, then nodes, then joints.
struct Graph {
    neighbours: Vec<Vec<usize>>,
    /// Whether a vertex divides what hangs together by it alone.
    divides: Vec<bool>,
    first_joint: usize,
}

/// A vertex on the way from the root to where the search is.
struct Visited {
    vertex: usize,
    /// How many of its neighbours have been looked at.
    looked_at: usize,
    /// The earliest vertex with an edge from here or from what was found behind.
    earliest: usize,
    /// Number of open joints when it was found.
    open: usize,
}

impl Graph {
    fn of(model: &Model, p: &[f64]) -> Self {
        let first_joint = 1 + model.nodes.len();
        let mut known: HashMap<*const Formula, bool> = HashMap::new();
        let mut neighbours = vec![Vec::new(); first_joint + model.constraints.len()];
        for (joint, own) in (first_joint..).zip(&model.constraints) {
            let nodes = own.nodes.iter().map(|node| if model.nodes[node.0].fixed { 0 } else { 1 + node.0 });
            let is_balanced = known.entry(Arc::as_ptr(own.physics.formula()));
            let is_balanced = *is_balanced.or_insert_with(|| own.physics.is_balanced(&p[own.parameters.clone()]));
            let ground = (!is_balanced).then_some(0);
            neighbours[joint] = nodes.chain(ground).collect();
            neighbours[joint].sort_unstable();
            neighbours[joint].dedup();
            for vertex in neighbours[joint].clone() {
                neighbours[vertex].push(joint);
            }
        }
        // a resultant is all that acts on a body or a point
        let is_rigid = |kind: NodeKind| kind.has_axes() || kind == NodeKind::Point;
        let nodes = model.nodes.iter().map(|node| is_rigid(node.kind));
        let divides = std::iter::once(true).chain(nodes).chain(model.constraints.iter().map(|_| false)).collect();
        Graph { neighbours, divides, first_joint }
    }

    fn parts(&self) -> Vec<usize> {
        let mut part_of = vec![0; self.neighbours.len() - self.first_joint];
        let mut found: Vec<Option<usize>> = vec![None; self.neighbours.len()];
        let (mut parts, mut count, mut open): (usize, usize, Vec<usize>) = (0, 0, Vec::new());
        for root in 0..self.neighbours.len() {
            let mut way = Vec::new();
            let mut next = found[root].is_none().then_some(root);
            loop {
                if let Some(vertex) = next.take() {
                    found[vertex] = Some(count);
                    way.push(Visited { vertex, looked_at: 0, earliest: count, open: open.len() });
                    open.extend(vertex.checked_sub(self.first_joint));
                    count += 1;
                }
                let Some(last) = way.last_mut() else { break };
                if let Some(&other) = self.neighbours[last.vertex].get(last.looked_at) {
                    last.looked_at += 1;
                    match found[other] {
                        Some(number) => last.earliest = last.earliest.min(number),
                        None => next = Some(other),
                    }
                    continue;
                }
                let Some(done) = way.pop() else { break };
                let before = way.last_mut().map(|before| {
                    before.earliest = before.earliest.min(done.earliest);
                    before.vertex
                });
                // nothing behind `done` leads past the vertex before it
                let ends = before.is_none_or(|before| self.divides[before] && Some(done.earliest) >= found[before]);
                if ends && open.len() > done.open {
                    open.drain(done.open..).for_each(|joint| part_of[joint] = parts);
                    parts += 1;
                }
            }
        }
        part_of
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joints between vertices, the ground 0 among them, of which some do not divide.
    fn parts(joints: &[&[usize]], undividing: &[usize]) -> Vec<usize> {
        let first_joint = 1 + joints.iter().flat_map(|joint| joint.iter()).max().unwrap();
        let mut neighbours = vec![Vec::new(); first_joint];
        neighbours.extend(joints.iter().map(|nodes| nodes.to_vec()));
        for (joint, nodes) in (first_joint..).zip(joints) {
            nodes.iter().for_each(|&node| neighbours[node].push(joint));
        }
        let divides = (0..neighbours.len()).map(|vertex| vertex < first_joint && !undividing.contains(&vertex)).collect();
        let own = Graph { neighbours, divides, first_joint }.parts();
        // by the first joint of each
        own.iter().map(|part| own.iter().position(|other| other == part).unwrap()).collect()
    }

    #[test]
    fn joints_are_of_one_part_where_they_are_of_one_loop() {
        // a chain, one of whose joints is there twice
        assert_eq!(parts(&[&[0, 1], &[1, 2], &[2, 3], &[1, 2]], &[]), [0, 1, 2, 1]);
        // two loops that meet at a body, then at one that passes on more than a resultant
        let loops: [&[usize]; 6] = [&[1, 2], &[2, 3], &[3, 1], &[3, 4], &[4, 5], &[5, 3]];
        assert_eq!(parts(&loops, &[]), [0, 0, 0, 3, 3, 3]);
        assert_eq!(parts(&loops, &[3]), [0; 6]);
        // they meet at two bodies
        assert_eq!(parts(&[&[1, 2], &[2, 3], &[3, 1], &[3, 4], &[4, 1]], &[]), [0; 5]);
        // one loop through the ground, one beside it, one joint of three bodies
        assert_eq!(parts(&[&[0, 1], &[1, 2], &[0, 2], &[0, 3], &[3, 0], &[2, 4, 5]], &[]), [0, 0, 0, 3, 3, 5]);
        assert_eq!(parts(&[&[2, 4, 5], &[4, 6], &[6, 5], &[6]], &[]), [0, 0, 0, 3]);
    }

    #[test]
    fn a_long_chain_that_is_closed_is_one_part() {
        let count = 100_000;
        let chain: Vec<[usize; 2]> = (0..count).map(|joint| [joint, joint + 1]).chain([[count, 0]]).collect();
        let joints: Vec<&[usize]> = chain.iter().map(|joint| &joint[..]).collect();
        assert_eq!(parts(&joints, &[]), vec![0; count + 1]);
        let open = parts(&joints[..1000], &[]);
        assert!(open.iter().enumerate().all(|(joint, &part)| part == joint));
    }
}
