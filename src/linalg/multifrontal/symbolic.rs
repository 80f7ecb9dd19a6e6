use super::dissection::dissect;
use super::elimination_tree::EliminationTree;
use super::entries::{EntryBlock, entry_blocks};
use super::graph::Graph;
use super::small_front::{SMALL_FRONT, Shape, SmallPlan};
use super::supernodes::{Supernode, elimination_flops, factor_entries, supernodes};
use crate::linalg::SparsePattern;
use std::ops::Range;

/// Entries of L and U up to which factors count as small: a few megabytes, of which ranks do all by themselves. A solution takes a millisecond
/// there, and messages a tenth of that.
pub const SMALL_FILL: usize = 1_000_000;

/// What a factorization will take, known before it is done; delayed pivots come on top.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Analysis {
    /// Operations of the elimination.
    pub flops: f64,
    /// Numbers in L and U.
    pub entries: usize,
    /// Memory of the factorization at its peak \[bytes\]: factors, waiting contributions and indices.
    pub bytes: usize,
    /// Number of dense fronts.
    pub fronts: usize,
    /// Rows of the largest front.
    pub largest_front: usize,
}

/// A dense matrix of the elimination: its pivots, and the rows (and columns) that the elimination changes.
#[derive(Clone, Debug)]
pub struct Front {
    /// Place of the first pivot; the others follow.
    pub first: usize,
    /// Number of pivots.
    pub pivots: usize,
    /// Where the places of the other rows stand in [`Symbolic::rows`].
    pub rows: Range<usize>,
    /// Fronts whose contributions this one takes up, in [`Symbolic::children`].
    pub children: Range<usize>,
    /// The front that takes up the contribution of this one.
    pub parent: Option<usize>,
    /// First front of the subtree below; the subtree is all from there to this one.
    pub subtree: usize,
    /// Where its factors start among those of all small fronts.
    pub small: usize,
    /// Entries of the matrix that it is the first to use, in [`Symbolic::entries`].
    pub entries: Range<usize>,
    /// Where its rows stand in the parent, in [`Symbolic::extensions`].
    pub extensions: Range<usize>,
    /// Distance from the root.
    pub depth: usize,
}

impl Front {
    /// Number of rows that are not pivots.
    pub fn others(&self) -> usize {
        self.rows.len()
    }
    /// Number of rows.
    pub fn size(&self) -> usize {
        self.pivots + self.others()
    }
    /// Whether it is factored as a small front.
    #[inline(always)]
    pub fn is_small(&self) -> bool {
        self.size() <= SMALL_FRONT
    }
    /// Numbers stored of the factors of a large front: L with all rows of the pivots' columns, U with the other columns.
    pub fn storage(&self) -> usize {
        if self.is_small() { 0 } else { self.pivots * (self.size() + self.others()) }
    }
    /// Numbers stored of the factors of a small front.
    pub fn small_storage(&self) -> usize {
        if self.is_small() { Shape::of(self).storage() } else { 0 }
    }
    /// Whether all of its pivots have to be found here.
    pub fn is_last(&self) -> bool {
        self.parent.is_none()
    }
}

/// Rows that follow each other both in a contribution and in the front that takes it up.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// First row in the contribution.
    pub from: u32,
    /// First row in the front.
    pub to: u32,
    /// Number of rows.
    pub length: u32,
}

/// All of the elimination that does not depend on values.
pub struct Symbolic {
    /// Number of unknowns.
    pub size: usize,
    /// Number of entries of the pattern.
    pub pattern_entries: usize,
    /// Unknown at each place of the elimination.
    pub order: Vec<u32>,
    /// Fronts, each after those that contribute to it.
    pub fronts: Vec<Front>,
    /// The same of small fronts, each at the number of its front.
    pub small_plans: Vec<SmallPlan>,
    /// Places of the rows of fronts.
    pub rows: Vec<u32>,
    /// Children of fronts.
    pub children: Vec<u32>,
    /// Rows of contributions in the fronts that take them up.
    pub extensions: Vec<Run>,
    /// Entries of the matrix in fronts.
    pub entries: Vec<EntryBlock>,
}

/// Vertices and their unknowns in the order of the supernodes.
struct Vertices {
    /// Of each vertex of the graph.
    numbers: Vec<u32>,
    list: Vec<u32>,
    /// Where the unknowns of each stand in the order, and the end.
    places: Vec<usize>,
    order: Vec<u32>,
}

impl Vertices {
    fn new(graph: &Graph, tree: &EliminationTree, supernodes: &[Supernode]) -> Self {
        let mut own = Vertices { numbers: vec![0; graph.len()], list: Vec::new(), places: vec![0], order: Vec::new() };
        for &place in supernodes.iter().flat_map(|supernode| &supernode.vertices) {
            let vertex = tree.order[place as usize];
            own.numbers[vertex as usize] = own.list.len() as u32;
            own.list.push(vertex);
            own.order.extend_from_slice(graph.members(vertex as usize));
            own.places.push(own.order.len());
        }
        own
    }

    /// The vertices behind those of a supernode that meet these, or are among those of the supernodes below, in order.
    ///
    /// * `seen_by` notes of each vertex the last supernode for which it was found
    fn structure<'s>(
        &self,
        graph: &Graph,
        own: &Range<usize>,
        below: impl Iterator<Item = &'s u32>,
        seen_by: &mut [usize],
    ) -> Vec<u32> {
        let mut structure: Vec<u32> = Vec::new();
        let mut add = |vertex: u32| {
            if vertex as usize >= own.end && seen_by[vertex as usize] != own.start {
                seen_by[vertex as usize] = own.start;
                structure.push(vertex);
            }
        };
        for &vertex in &self.list[own.clone()] {
            graph.neighbours(vertex as usize).iter().for_each(|&other| add(self.numbers[other as usize]));
        }
        below.for_each(|&vertex| add(vertex));
        structure.sort_unstable();
        structure
    }
}

impl Symbolic {
    /// Orders and analyses a pattern.
    pub fn new(pattern: &SparsePattern) -> Self {
        let graph = Graph::new(pattern);
        let tree = EliminationTree::new(&graph, &dissect(&graph));
        let supernodes = supernodes(&graph, &tree);

        let mut vertices = Vertices::new(&graph, &tree, &supernodes);
        let mut symbolic = Symbolic {
            size: pattern.size,
            pattern_entries: pattern.rows.len(),
            order: std::mem::take(&mut vertices.order),
            fronts: Vec::with_capacity(supernodes.len()),
            small_plans: Vec::new(),
            rows: Vec::new(),
            children: Vec::new(),
            extensions: Vec::new(),
            entries: Vec::new(),
        };
        let mut structures: Vec<Vec<u32>> = Vec::with_capacity(supernodes.len());
        let mut child_lists = vec![Vec::new(); supernodes.len()];
        let mut seen_by = vec![usize::MAX; graph.len()];
        let (mut next_vertex, mut small) = (0, 0);
        for (s, supernode) in supernodes.iter().enumerate() {
            let own = next_vertex..next_vertex + supernode.vertices.len();
            next_vertex = own.end;
            let below = child_lists[s].iter().flat_map(|&child: &u32| &structures[child as usize]);
            let structure = vertices.structure(&graph, &own, below, &mut seen_by);
            let (first_row, first_child) = (symbolic.rows.len(), symbolic.children.len());
            for &vertex in &structure {
                let places = vertices.places[vertex as usize]..vertices.places[vertex as usize + 1];
                symbolic.rows.extend(places.map(|place| place as u32));
            }
            let subtree = child_lists[s].first().map_or(s, |&child: &u32| symbolic.fronts[child as usize].subtree);
            symbolic.children.append(&mut child_lists[s]);
            let front = Front {
                first: vertices.places[own.start],
                pivots: supernode.pivots,
                rows: first_row..symbolic.rows.len(),
                children: first_child..symbolic.children.len(),
                parent: supernode.parent,
                subtree,
                small,
                entries: 0..0,
                extensions: 0..0,
                depth: 0,
            };
            small += front.small_storage();
            structures.push(structure);
            symbolic.fronts.push(front);
            if let Some(parent) = supernode.parent {
                child_lists[parent].push(s as u32);
            }
        }
        for s in (0..symbolic.fronts.len()).rev() {
            symbolic.fronts[s].depth = symbolic.fronts[s].parent.map_or(0, |parent| symbolic.fronts[parent].depth + 1);
        }
        symbolic.small_plans = symbolic.fronts.iter().map(SmallPlan::of).collect();
        symbolic.find_extensions();
        symbolic.entries = entry_blocks(pattern, &mut symbolic);
        symbolic
    }

    /// The place of each row in the front's own numbering, written where the front has rows.
    pub fn number_rows(&self, front: &Front, local: &mut [u32]) {
        for pivot in 0..front.pivots {
            local[front.first + pivot] = pivot as u32;
        }
        for (row, own) in self.rows[front.rows.clone()].iter().zip(front.pivots as u32..) {
            local[*row as usize] = own;
        }
    }

    fn find_extensions(&mut self) {
        let mut local = vec![0; self.size];
        for parent in 0..self.fronts.len() {
            let front = self.fronts[parent].clone();
            self.number_rows(&front, &mut local);
            for child in front.children {
                let child = self.children[child] as usize;
                let first = self.extensions.len();
                for (from, row) in self.rows[self.fronts[child].rows.clone()].iter().enumerate() {
                    let to = local[*row as usize];
                    match self.extensions[first..].last_mut() {
                        Some(run) if run.to + run.length == to && to != front.pivots as u32 => run.length += 1,
                        _ => self.extensions.push(Run { from: from as u32, to, length: 1 }),
                    }
                }
                self.fronts[child].extensions = first..self.extensions.len();
            }
        }
    }

    /// Operations in the subtree below each front, itself included.
    pub fn subtree_flops(&self) -> Vec<f64> {
        let mut flops: Vec<f64> = self.fronts.iter().map(|front| elimination_flops(front.pivots, front.size())).collect();
        for front in 0..self.fronts.len() {
            if let Some(parent) = self.fronts[front].parent {
                flops[parent] += flops[front];
            }
        }
        flops
    }

    /// Numbers of the factors of all small fronts as they are stored.
    pub fn small_storage(&self) -> usize {
        self.fronts.iter().map(Front::small_storage).sum()
    }

    /// The most numbers that wait on each of the two stacks, contributions of even and of odd depth, while a subtree is factored.
    pub fn stack_peaks(&self, fronts: Range<usize>) -> [usize; 2] {
        let (mut height, mut peak) = ([0; 2], [0; 2]);
        for front in &self.fronts[fronts] {
            let own = front.depth % 2;
            height[own] += front.others().pow(2);
            peak[own] = peak[own].max(height[own]);
            for &child in &self.children[front.children.clone()] {
                height[1 - own] -= self.fronts[child as usize].others().pow(2);
            }
        }
        peak
    }

    /// What the factorization takes, with a number of bytes for waiting contributions.
    pub fn analysis(&self, waiting: usize) -> Analysis {
        let fronts = || self.fronts.iter();
        let indices = size_of_val(&self.order[..])
            + size_of_val(&self.fronts[..])
            + size_of_val(&self.small_plans[..])
            + size_of_val(&self.rows[..])
            + size_of_val(&self.children[..])
            + size_of_val(&self.extensions[..])
            + size_of_val(&self.entries[..])
            + 2 * size_of::<u32>() * self.size;
        Analysis {
            flops: fronts().map(|front| elimination_flops(front.pivots, front.size())).sum(),
            entries: fronts().map(|front| factor_entries(front.pivots, front.size())).sum(),
            bytes: size_of::<f64>() * (fronts().map(Front::storage).sum::<usize>() + self.small_storage())
                + waiting
                + indices,
            fronts: self.fronts.len(),
            largest_front: fronts().map(Front::size).max().unwrap_or(0),
        }
    }
}
