//! Nodes that follow faces on which they lie.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::carriers::{Carriers, Shares, Sum};
use super::mortar::{EdgePoint, TiedEdge};
use super::surface_search::{Point, length, shown};
use super::{MechanismBuilder, MeshedShell};
use crate::assembly::{ConstraintId, NodeId};
use crate::elements::joints::TiedNode;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::collections::{HashMap, HashSet};

/// A node that follows others.
pub(super) struct Tied {
    /// Name of the tie.
    tie: String,
    carriers: Vec<NodeId>,
}

impl<S: Scalar> MechanismBuilder<S> {
    /// Edges of shells, or other nodes, that follow the faces of shells on which they lie, where their nodes do not meet: a node's place, and
    /// its frame if it is a body, follow what is interpolated between the nodes of the faces.
    ///
    /// Along outer edges of shells whose nodes are all given the edge follows in the mean, with weights from integrals along it: constant stresses
    /// pass exactly from one side to the other, whatever the divisions are. Let the side that is divided more finely follow, or the shorter one. Other
    /// nodes follow the place where they stand.
    ///
    /// Nodes of the edge that never move, that belong to the faces or that, at its ends, are tied already do not follow. Every node must lie on a
    /// face, to a millionth of the diagonal of all of them; see [`tie_within`](Self::tie_within).
    pub fn tie(&mut self, name: &str, nodes: &[NodeId], to: &[&MeshedShell]) -> Vec<ConstraintId> {
        self.tie_to(name, nodes, to, None)
    }

    /// The same for nodes that lie up to so far \[m\] from the faces, as those of curved surfaces and of walls at a distance do: they keep the distance,
    /// which turns with the faces.
    pub fn tie_within(&mut self, name: &str, nodes: &[NodeId], to: &[&MeshedShell], within: f64) -> Vec<ConstraintId> {
        self.tie_to(name, nodes, to, Some(within))
    }

    pub(crate) fn tie_to(
        &mut self,
        name: &str,
        nodes: &[NodeId],
        shells: &[&MeshedShell],
        within: Option<f64>,
    ) -> Vec<ConstraintId> {
        let mistakes = self.mistakes.len();
        let own: HashSet<NodeId> = nodes.iter().copied().collect();
        own.iter().for_each(|&node| _ = self.kind_in_space(name, node));
        if shells.iter().all(|shell| shell.elements.is_empty()) || nodes.is_empty() || self.mistakes.len() > mistakes {
            if nodes.is_empty() {
                self.mistakes.push(format!("tie \"{name}\" has no nodes; give it the nodes of an edge"));
            }
            // a shell without elements was refused
            return Vec::new();
        }
        let tie = match Tie::new(self, (name, nodes, &own), shells, within) {
            Ok(tie) => tie,
            Err(why) => {
                self.mistakes.push(format!("tie \"{name}\": {why}"));
                return Vec::new();
            }
        };
        let rows = tie.rows(self);
        let mut joints = Vec::new();
        for (node, shares) in rows {
            match self.tied_node(name, node, &shares) {
                Ok(joint) => joints.push(joint),
                Err(why) => {
                    self.mistakes.push(format!("tie \"{name}\": {why}"));
                    break;
                }
            }
        }
        joints
    }

    /// Whether a node follows one of some nodes, at once or by others.
    fn follows_one_of(&self, node: NodeId, others: &HashSet<NodeId>) -> bool {
        let (mut open, mut seen) = (vec![node], HashSet::new());
        while let Some(next) = open.pop() {
            for &carrier in self.ties.get(&next).into_iter().flat_map(|tied| &tied.carriers) {
                if others.contains(&carrier) {
                    return true;
                }
                if seen.insert(carrier) {
                    open.push(carrier);
                }
            }
        }
        false
    }

    /// One node carried along by others with their weights.
    fn tied_node(&mut self, name: &str, node: NodeId, shares: &Shares<S>) -> Result<ConstraintId, String> {
        let called = |m: &Self, node: NodeId| format!("\"{}\"", m.model.nodes[node.0].name);
        let follower = HashSet::from([node]);
        if let Some(&(carrier, _)) = shares.iter().find(|own| self.follows_one_of(own.0, &follower)) {
            return Err(format!(
                "{} follows {}, which follows it already: of two sides one follows, not both",
                called(self, node),
                called(self, carrier)
            ));
        }
        let first = shares[0].0;
        let start = self.rotation(first);
        for &(other, _) in shares {
            let apart = start.0.iter().zip(self.rotation(other).0).map(|(a, b)| (a.value() - b.value()).abs());
            if apart.fold(0.0, f64::max) > crate::tolerances::LONG_SUM {
                let [a, b] = [first, other].map(|node| called(self, node));
                return Err(format!(
                    "the frames of {a} and {b} start with different Euler parameters; let them start alike"
                ));
            }
        }
        let b = self.kind_in_space(name, node);
        let mean = shares.iter().fold(Vector3::zeros(), |sum, &(own, weight)| sum + self.position(own) * weight);
        let mut p: Vec<S> = shares.iter().map(|own| own.1).collect();
        p.extend(start.rotate_back(self.position(node) - mean).components());
        if b.has_axes() {
            p.extend(start.conjugate().times(self.rotation(node)).0);
        }
        let nodes: Vec<NodeId> = shares.iter().map(|own| own.0).chain([node]).collect();
        let joint = format!("{name}, {}", self.model.nodes[node.0].name);
        let tied = Tied { tie: name.into(), carriers: nodes[..shares.len()].to_vec() };
        self.ties.insert(node, tied);
        Ok(self.add_constraint(&joint, &nodes, TiedNode { carriers: shares.len(), b }.into(), &p))
    }
}

/// What follows, and what it follows.
struct Tie<'n, S> {
    nodes: &'n [NodeId],
    carriers: Carriers<S>,
    /// Outer edges that follow, and where their points lie on the carriers.
    edges: Vec<(TiedEdge<S>, Vec<EdgePoint>)>,
    /// Nodes of edges that do not follow.
    left_out: HashSet<NodeId>,
}

impl<'n, S: Scalar> Tie<'n, S> {
    fn new(
        m: &MechanismBuilder<S>,
        (name, nodes, own): (&str, &'n [NodeId], &HashSet<NodeId>),
        shells: &[&MeshedShell],
        within: Option<f64>,
    ) -> Result<Self, String> {
        let carriers = Carriers::new(m, shells, 0.0);
        let places = carriers.nodes().chain(nodes.iter().copied()).map(|node| place_of(m, node));
        let reach = within.unwrap_or(crate::tolerances::SAME_VERTEX * diagonal(places));
        if !(reach >= 0.0 && reach.is_finite()) {
            return Err(format!("nodes cannot lie within {reach} m of faces; give a distance that is not negative"));
        }
        let carriers = Carriers::new(m, shells, reach);
        let mut tie = Tie { nodes, carriers, edges: Vec::new(), left_out: HashSet::new() };
        let edges = outer_edges(m, own);
        let mut of_edges: HashMap<NodeId, usize> = HashMap::new();
        for edge in &edges {
            edge.nodes.iter().for_each(|node| *of_edges.entry(*node).or_default() += 1);
        }
        for &node in nodes {
            tie.check_node(m, node, edges.iter().filter(|edge| edge.nodes.contains(&node)))?;
        }
        for edge in edges {
            let points = edge.points(&tie.carriers).map_err(|at| {
                let [first, last] =
                    [edge.nodes[0], edge.nodes[edge.nodes.len() - 1]].map(|node| &m.model.nodes[node.0].name);
                tie.off_faces(at, &format!("the edge from \"{first}\" to \"{last}\""), &edge.nodes)
            })?;
            tie.edges.push((edge, points));
        }
        let carrying = tie.keep_following_edges();
        for &node in nodes {
            let own = &m.model.nodes[node.0];
            let before = m.ties.get(&node);
            let inside = of_edges.get(&node).is_none_or(|&count| count > 1 || tie.is_middle(node));
            if let Some(before) = before.filter(|_| inside) {
                return Err(format!("\"{}\" is tied by \"{}\" already: a node follows once", own.name, before.tie));
            }
            if own.fixed || carrying.contains(&node) || before.is_some() {
                tie.left_out.insert(node);
            }
        }
        if nodes.iter().all(|node| tie.left_out.contains(node)) {
            return Err(format!(
                "none of the nodes can follow: they never move, belong to what \"{name}\" ties them to, or are tied already; let the other side follow"
            ));
        }
        Ok(tie)
    }

    /// Leaves out edges whose nodes all carry others, as that of a large face beside small ones of the same mesh does; the nodes that carry.
    fn keep_following_edges(&mut self) -> HashSet<NodeId> {
        let carriers = |(edge, points): &(TiedEdge<S>, Vec<EdgePoint>)| -> HashSet<NodeId> {
            let shares = points.iter().flat_map(|point| self.carriers.shares(point.foot(), edge.place(point)));
            shares.map(|own| own.0).collect()
        };
        let carrying: Vec<HashSet<NodeId>> = self.edges.iter().map(carriers).collect();
        let mut order: Vec<usize> = (0..self.edges.len()).collect();
        order.sort_by(|&a, &b| self.edges[b].0.span().total_cmp(&self.edges[a].0.span()));
        let mut kept = vec![true; order.len()];
        for &edge in &order {
            let carries =
                |node: &NodeId| (0..kept.len()).any(|own| own != edge && kept[own] && carrying[own].contains(node));
            kept[edge] = !self.edges[edge].0.nodes.iter().all(carries);
        }
        let mut flags = kept.iter();
        self.edges.retain(|_| flags.next() == Some(&true));
        carrying.into_iter().zip(kept).filter(|own| own.1).flat_map(|own| own.0).collect()
    }

    /// Whether a node is the middle one of an edge.
    fn is_middle(&self, node: NodeId) -> bool {
        self.edges.iter().any(|(edge, _)| edge.nodes.len() == 3 && edge.nodes[1] == node)
    }

    fn check_node<'e>(
        &self,
        m: &MechanismBuilder<S>,
        node: NodeId,
        mut edges: impl Iterator<Item = &'e TiedEdge<S>>,
    ) -> Result<(), String>
    where
        S: 'e,
    {
        let at = place_of(m, node);
        if self.carriers.surfaces.nearest(at, |face| !self.carriers.has(face, &[node])).is_some() {
            return Ok(());
        }
        // a node of the faces that an edge of theirs begins with is where it belongs
        if edges.next().is_some() && self.carriers.nodes().any(|own| own == node) {
            return Ok(());
        }
        Err(self.off_faces(at, &format!("node \"{}\"", m.model.nodes[node.0].name), &[node]))
    }

    fn off_faces(&self, at: Point, what: &str, own: &[NodeId]) -> String {
        let Carriers { surfaces, .. } = &self.carriers;
        let place = shown(at);
        let Some(foot) = surfaces.nearest_of_all(at, |face| !self.carriers.has(face, own)) else {
            return format!("{what} at {place} lies on no face but its own");
        };
        let (shell, reach) = (self.carriers.shell_of(foot.face), surfaces.reach());
        format!(
            "{what} lies on no face at {place}: the nearest, of \"{shell}\", is {:.3e} m away, and up to {reach:.1e} m are on it; let the other side \
             follow if that is the shorter one, or give the distance that is meant (within)",
            foot.distance
        )
    }

    /// What carries each node that follows, in the order in which the nodes were given.
    fn rows(&self, m: &MechanismBuilder<S>) -> Vec<(NodeId, Shares<S>)> {
        let follows = |node: NodeId| !self.left_out.contains(&node);
        let mut of_edges: HashMap<NodeId, (S, Sum<S>)> = HashMap::new();
        for (edge, points) in &self.edges {
            edge.add_to(points, &self.carriers, follows, &mut of_edges);
        }
        let mut rows = Vec::new();
        let mut done = HashSet::new();
        for &node in self.nodes.iter().filter(|&&node| follows(node)) {
            if !done.insert(node) {
                continue;
            }
            let shares = match of_edges.remove(&node) {
                Some((diagonal, sum)) => sum.scaled(diagonal.recip()),
                None => {
                    let foot = self.carriers.surfaces.nearest(place_of(m, node), |face| !self.carriers.has(face, &[node]));
                    let Some(foot) = foot else { continue };
                    self.carriers.shares(foot, m.position(node))
                }
            };
            rows.push((node, shares));
        }
        rows
    }
}

fn place_of<S: Scalar>(m: &MechanismBuilder<S>, node: NodeId) -> Point {
    m.position(node).map(Scalar::value)
}

/// Diagonal of the box around some places \[m\].
fn diagonal(places: impl Iterator<Item = Point>) -> f64 {
    let around = places.map(|place| (place, place)).reduce(|(least, most), (own, _)| (least.inf(&own), most.sup(&own)));
    around.map_or(0.0, |(least, most)| length(most - least))
}

/// Edges of shells with one face whose nodes are all among some nodes.
fn outer_edges<S: Scalar>(m: &MechanismBuilder<S>, own: &HashSet<NodeId>) -> Vec<TiedEdge<S>> {
    let mut edges = Vec::new();
    for shell in &m.shells {
        let mut found: Vec<Vec<NodeId>> = Vec::new();
        let mut counts: HashMap<[usize; 2], usize> = HashMap::new();
        for (kind, nodes) in shell.faces() {
            for edge in kind.face.shape().edges {
                let line: Vec<NodeId> = edge.iter().map(|&place| nodes[place]).collect();
                if line.iter().all(|node| own.contains(node)) {
                    *counts.entry(ends_of(&line)).or_default() += 1;
                    found.push(line);
                }
            }
        }
        for nodes in found.into_iter().filter(|line| counts[&ends_of(line)] == 1) {
            edges.push(TiedEdge { places: nodes.iter().map(|&node| m.position(node)).collect(), nodes });
        }
    }
    edges
}

fn ends_of(line: &[NodeId]) -> [usize; 2] {
    let [a, b] = [line[0].0, line[line.len() - 1].0];
    [a.min(b), a.max(b)]
}
