use super::Jacobian;
use super::batches::{ConstraintBatch, ElementBatch};
use super::element_programs::Force;
use super::lanes::Strided;
use super::matrix_values::MatrixValues;
use super::model::{Model, NodeId};
use super::node_runs::NodeRun;
use super::reduction::RotationCoordinates;
use crate::elements::{ConstraintPhysics, NodeKind};
use crate::linalg::SparsePattern;
use crate::program::Formula;
use smallvec::{SmallVec, smallvec};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Choices that fix the unknowns of a [`System`].
#[derive(Clone, Debug, Default)]
pub struct SystemOptions {
    /// Constraint equations that are left out because they depend on others.
    pub dropped: Vec<usize>,
    /// Keep node-local constraints as global ones instead of eliminating them: for tests of the elimination.
    pub unreduced: bool,
}

/// A constraint inside a node, with the place of its multipliers in `local_mu`.
pub(super) struct NodeConstraint {
    pub node: usize,
    pub equations: Range<usize>,
    /// One for all nodes of a kind.
    pub physics: Arc<ConstraintPhysics>,
    /// The coordinates that it is about: those behind the position.
    pub part: DofMap,
    /// Its place among the blocks of nodes, if it is eliminated.
    pub block: usize,
}

impl NodeConstraint {
    /// Its equations behind those of joints and drivers, where it is not eliminated.
    fn global_equations(&self, model: &Model) -> Range<usize> {
        self.equations.start + model.equations..self.equations.end + model.equations
    }
}

/// Constraint equations that follow each other, and so do their multipliers in the matrix.
pub(super) struct MultiplierRun {
    pub equations: Range<usize>,
    pub first_column: usize,
}

impl MultiplierRun {
    /// All equations that have a column.
    fn all(columns: &[Option<usize>]) -> Vec<MultiplierRun> {
        let mut runs: Vec<MultiplierRun> = Vec::new();
        for (equation, column) in columns.iter().enumerate() {
            let Some(column) = *column else { continue };
            match runs.last_mut() {
                Some(last) if last.equations.end == equation && last.unknowns().end == column => last.equations.end += 1,
                _ => runs.push(MultiplierRun { equations: equation..equation + 1, first_column: column }),
            }
        }
        runs
    }

    /// Their numbers in the matrix.
    pub fn unknowns(&self) -> Range<usize> {
        self.first_column..self.first_column + self.equations.len()
    }
}

/// Unknowns of one node that reach the matrix.
#[derive(Clone, Debug)]
pub(super) struct NodeUnknowns {
    /// Global numbers.
    pub columns: Range<usize>,
    /// Index into the list of node-local constraints, if one is eliminated here.
    pub local: Option<usize>,
}

/// Where the numbers of one element or constraint stand in the vectors of the model.
pub(super) struct DofMap {
    /// Coordinates, one range for each node.
    pub segments: SmallVec<[Range<usize>; 3]>,
    /// Nodes of the model.
    pub nodes: SmallVec<[usize; 3]>,
    /// Parameters.
    pub parameters: Range<usize>,
}

impl DofMap {
    fn new(model: &Model, ids: &[NodeId], parameters: Range<usize>) -> Self {
        let segments: SmallVec<[Range<usize>; 3]> = ids.iter().map(|id| model.nodes[id.0].dofs.clone()).collect();
        DofMap { nodes: ids.iter().map(|id| id.0).collect(), segments, parameters }
    }
}

/// A part that adds a block to the matrix; entries of the block are numbered column by column.
pub(super) enum ScatterMap {
    /// Place in the matrix values of each entry; `NOWHERE` where nothing is added.
    Entries(Vec<u32>),
    /// Of a large block without gaps.
    Columns(Box<ScatterColumns>),
}

/// Where the columns of a block stand, by runs of rows that follow each other in the block and in the matrix, the same in all columns.
pub(super) struct ScatterColumns {
    /// Rows and columns of the block.
    size: usize,
    /// First row of each run, and the number of rows at last.
    rows: SmallVec<[usize; 12]>,
    /// Place of each run's first entry, column by column.
    places: Vec<u32>,
}

/// Behind every place.
const NOWHERE: u32 = u32::MAX;
/// Unknowns beyond which a block without gaps is kept by runs of rows.
const LARGE: usize = 24;

impl ScatterMap {
    /// Adds some entries, times a factor, to their places in a matrix.
    #[inline(always)]
    pub fn add(&self, labels: &[u32], entries: Strided<f64>, factor: f64, target: &mut impl MatrixValues) {
        match self {
            // equations that are left out have none
            ScatterMap::Entries(places) => {
                labels.iter().zip(entries).for_each(|(&label, entry)| target.add(places[label as usize], entry * factor));
            }
            ScatterMap::Columns(columns) if labels.len() == columns.size * columns.size && factor == 1.0 => {
                columns.for_each_run(|entry, places| entries.add_to(entry, target.run(places)));
            }
            ScatterMap::Columns(columns) => {
                columns.for_each_place(labels, entries, |place, entry| target.add(place, entry * factor));
            }
        }
    }

    /// The same block where only some places are added to.
    pub fn at_some(&self, is_wanted: impl Fn(usize) -> bool) -> Self {
        let all = match self {
            ScatterMap::Entries(places) => places.clone(),
            ScatterMap::Columns(columns) => {
                let mut places = vec![NOWHERE; columns.size * columns.size];
                columns.for_each_run(|entry, run| {
                    places[entry..entry + run.len()].iter_mut().zip(run).for_each(|(own, place)| *own = place as u32);
                });
                places
            }
        };
        let wanted = |place: u32| if place != NOWHERE && is_wanted(place as usize) { place } else { NOWHERE };
        ScatterMap::Entries(all.into_iter().map(wanted).collect())
    }
}

impl ScatterColumns {
    /// Calls `f(number of the first entry, where the run stands in the matrix)` for each run of each column.
    #[inline(always)]
    pub fn for_each_run(&self, mut f: impl FnMut(usize, Range<usize>)) {
        for (column, places) in self.places.chunks_exact(self.rows.len() - 1).enumerate() {
            for ((&first, &end), &place) in self.rows.iter().zip(&self.rows[1..]).zip(places) {
                f(column * self.size + first, place as usize..place as usize + end - first);
            }
        }
    }

    /// Calls `f(place, number)` for some entries, in increasing order.
    pub fn for_each_place(&self, labels: &[u32], entries: impl Iterator<Item = f64>, mut f: impl FnMut(u32, f64)) {
        let (mut column, mut run) = (0, 0);
        for (&label, entry) in labels.iter().zip(entries) {
            while label as usize >= (column + 1) * self.size {
                (column, run) = (column + 1, 0);
            }
            let row = label as usize - column * self.size;
            while self.rows[run + 1] <= row {
                run += 1;
            }
            let place = self.places[column * (self.rows.len() - 1) + run];
            f(place + (row - self.rows[run]) as u32, entry);
        }
    }
}

/// The unknowns of a model with their columns: those of the nodes, then the multipliers.
#[derive(Default)]
struct Numbering {
    columns: usize,
    nodes: Vec<NodeUnknowns>,
    locals: Vec<NodeConstraint>,
    local_equations: usize,
    multiplier_columns: Vec<Option<usize>>,
}

impl Numbering {
    fn new(model: &Model, options: &SystemOptions) -> Self {
        let mut own = Numbering { nodes: Vec::with_capacity(model.nodes.len()), ..Numbering::default() };
        let mut known: Vec<(NodeKind, Arc<ConstraintPhysics>)> = Vec::new();
        for (index, node) in model.nodes.iter().enumerate() {
            let mut unknowns = NodeUnknowns { columns: own.columns..own.columns, local: None };
            if !node.fixed {
                let mut free = node.dofs.len();
                let same = known.iter().find(|(kind, _)| *kind == node.kind).map(|(_, physics)| Arc::clone(physics));
                if let Some(physics) = same.or_else(|| node.kind.local_constraint().map(Arc::new)) {
                    known.push((node.kind, Arc::clone(&physics)));
                    let equations = own.local_equations..own.local_equations + physics.equation_count();
                    own.local_equations = equations.end;
                    if !options.unreduced {
                        free -= equations.len();
                        unknowns.local = Some(own.locals.len());
                    }
                    let turning = RotationCoordinates::of(node.kind).map_or(0, RotationCoordinates::coordinates);
                    let segment = node.dofs.end - turning..node.dofs.end;
                    let part = DofMap { segments: smallvec![segment], nodes: smallvec![index], parameters: 0..0 };
                    own.locals.push(NodeConstraint { node: index, equations, physics, part, block: 0 });
                }
                own.columns += free;
                unknowns.columns.end = own.columns;
            }
            own.nodes.push(unknowns);
        }
        // unreduced: local equations are numbered behind the joints' own
        let visible = model.equations + if options.unreduced { own.local_equations } else { 0 };
        own.multiplier_columns = own.multipliers(visible, &options.dropped);
        own
    }

    /// The next columns, for all equations but those that are dropped.
    fn multipliers(&mut self, equations: usize, dropped: &[usize]) -> Vec<Option<usize>> {
        let mut next = || {
            self.columns += 1;
            self.columns - 1
        };
        (0..equations).map(|equation| dropped.binary_search(&equation).is_err().then(&mut next)).collect()
    }

    fn of_nodes(&self, ids: &[NodeId]) -> Vec<Option<usize>> {
        ids.iter().flat_map(|id| self.nodes[id.0].columns.clone().map(Some)).collect()
    }

    /// Numbers the blocks of nodes with an eliminated constraint.
    fn number_blocks(&mut self) -> Vec<usize> {
        let with_block = |node: &NodeUnknowns| !node.columns.is_empty() && node.local.is_some();
        let block_nodes: Vec<usize> = (0..self.nodes.len()).filter(|&node| with_block(&self.nodes[node])).collect();
        for (block, &node) in block_nodes.iter().enumerate() {
            self.nodes[node].local.into_iter().for_each(|local| self.locals[local].block = block);
        }
        block_nodes
    }

    /// What joints and drivers couple, then what the constraints inside nodes do where these are not eliminated.
    fn constraints(&self, model: &Model, options: &SystemOptions) -> Vec<Coupled> {
        let with_multipliers = |mut unknowns: Vec<Option<usize>>, equations: Range<usize>| {
            unknowns.extend_from_slice(&self.multiplier_columns[equations]);
            unknowns
        };
        // the same for all with one formula and nodes of the same kinds
        let mut separable: HashMap<(*const Formula, bool, Vec<usize>), bool> = HashMap::new();
        let joints = model.constraints.iter().map(|constraint| {
            let (ids, physics) = (&constraint.nodes, &constraint.physics);
            let own = self.of_nodes(ids);
            let sizes = ids.iter().map(|id| model.nodes[id.0].dofs.len()).collect();
            let kind = (Arc::as_ptr(physics.formula()), physics.is_nonholonomic(), sizes);
            let is_separable = *separable.entry(kind).or_insert_with_key(|(_, _, sizes)| physics.is_separable(sizes));
            let nodes = match is_separable {
                true => ids.iter().flat_map(|id| self.nodes[id.0].columns.clone().map(|_| Some(id.0))).collect(),
                false => vec![None; own.len()],
            };
            let unknowns = with_multipliers(own, constraint.equations.clone());
            Coupled { unknowns, nodes, diagonal: physics.is_nonholonomic() }
        });
        let inside = self.locals.iter().filter(|_| options.unreduced).map(|local| {
            let own = self.of_nodes(&[model.node_id(local.node)]);
            let nodes = vec![None; own.len()];
            Coupled { unknowns: with_multipliers(own, local.global_equations(model)), nodes, diagonal: false }
        });
        joints.chain(inside).collect()
    }
}

/// The numbered equations of a model: which unknowns reach the matrix, and where each part adds to it.
pub struct System<'m> {
    /// The topology.
    pub model: &'m Model,
    /// The choices.
    pub options: SystemOptions,
    /// GatherMap of the matrix entries.
    pub pattern: Arc<SparsePattern>,
    pub(super) nodes: Vec<NodeUnknowns>,
    /// The same, by nodes of a kind that follow each other.
    pub(super) node_runs: Vec<NodeRun>,
    pub(super) locals: Vec<NodeConstraint>,
    pub(super) local_equations: usize,
    /// Column of each multiplier; `None` where dropped.
    pub(super) multiplier_columns: Vec<Option<usize>>,
    /// The same, by equations that follow each other.
    pub(super) multiplier_runs: Vec<MultiplierRun>,
    pub(super) element_parts: Vec<DofMap>,
    /// Joints and drivers, then the constraints inside nodes where these are not eliminated.
    pub(super) constraint_parts: Vec<DofMap>,
    pub(super) element_blocks: Vec<ScatterMap>,
    pub(super) constraint_blocks: Vec<ScatterMap>,
    /// Nodes with an eliminated constraint.
    pub(super) node_blocks: Vec<(usize, ScatterMap)>,
    /// Elements and constraints that are evaluated side by side: residuals, impulses, constraints.
    batches: [OnceLock<Vec<ElementBatch>>; Force::KINDS],
    constraint_batches: OnceLock<Vec<ConstraintBatch>>,
    node_batches: OnceLock<Vec<ConstraintBatch>>,
}

impl<'m> System<'m> {
    /// Numbers the unknowns and lays out the matrix.
    pub fn new(model: &'m Model, options: SystemOptions) -> Self {
        let mut numbering = Numbering::new(model, &options);
        let elements: Vec<_> = model.elements.iter().map(|e| Coupled::all(numbering.of_nodes(&e.nodes))).collect();
        let constraints = numbering.constraints(model, &options);
        let block_nodes = numbering.number_blocks();
        let of_node = |&node: &usize| Coupled::all(numbering.of_nodes(&[model.node_id(node)]));
        let node_blocks: Vec<_> = block_nodes.iter().map(of_node).collect();

        let columns = numbering.columns;
        assert!(columns < NOWHERE as usize, "{columns} unknowns, more than 2^32 - 2");
        let mut runs = Vec::new();
        for coupled in elements.iter().chain(&constraints).chain(&node_blocks) {
            coupled.for_each_run(|_, rows, column| runs.push((column as u32, rows.start as u32..rows.end as u32)));
        }
        let (pattern, places) = SparsePattern::from_runs(columns, &runs);
        drop(runs);
        // in the order in which the runs were noted
        let mut places = places.into_iter();
        let mut scatter = |list: Vec<Coupled>| -> Vec<ScatterMap> {
            list.into_iter().map(|coupled| coupled.scatter(&mut places)).collect()
        };
        let (element_blocks, constraint_blocks) = (scatter(elements), scatter(constraints));
        let node_blocks = block_nodes.into_iter().zip(scatter(node_blocks)).collect();
        let part = |ids: &[NodeId], parameters: &Range<usize>| DofMap::new(model, ids, parameters.clone());
        let element_parts = model.elements.iter().map(|e| part(&e.nodes, &e.parameters)).collect();
        let Numbering { nodes, locals, local_equations, multiplier_columns, .. } = numbering;
        let inside = locals.iter().filter(|_| options.unreduced).map(|local| part(&[model.node_id(local.node)], &(0..0)));
        let constraint_parts = model.constraints.iter().map(|c| part(&c.nodes, &c.parameters)).chain(inside).collect();
        let mut system = System {
            model,
            element_parts,
            constraint_parts,
            nodes,
            node_runs: Vec::new(),
            locals,
            local_equations,
            multiplier_runs: MultiplierRun::all(&multiplier_columns),
            multiplier_columns,
            element_blocks,
            constraint_blocks,
            node_blocks,
            pattern: Arc::new(pattern),
            options,
            batches: [const { OnceLock::new() }; Force::KINDS],
            constraint_batches: OnceLock::new(),
            node_batches: OnceLock::new(),
        };
        system.node_runs = NodeRun::all(&system);
        system
    }

    /// Elements that are evaluated side by side.
    pub(super) fn element_batches(&self, force: Force) -> &[ElementBatch] {
        self.batches[force.kind()].get_or_init(|| self.sort_elements(force))
    }

    /// Constraints that are evaluated side by side.
    pub(super) fn constraint_batches(&self) -> &[ConstraintBatch] {
        self.constraint_batches.get_or_init(|| self.sort_constraints())
    }

    /// Constraints inside nodes that are eliminated, evaluated side by side.
    pub(super) fn node_batches(&self) -> &[ConstraintBatch] {
        self.node_batches.get_or_init(|| self.sort_nodes())
    }

    /// The constraint of a batch of them.
    pub(super) fn constraint_inside(&self, batch: &ConstraintBatch) -> &ConstraintPhysics {
        &self.locals[batch.parts[0]].physics
    }

    /// Where a constraint inside a node stands.
    pub(super) fn block_inside(&self, local: usize) -> &ScatterMap {
        &self.node_blocks[self.locals[local].block].1
    }

    /// GatherMap of the multipliers of a constraint.
    pub(super) fn equations_of(&self, part: usize) -> Range<usize> {
        match self.model.constraints.get(part) {
            Some(joint) => joint.equations.clone(),
            None => self.locals[part - self.model.constraints.len()].global_equations(self.model),
        }
    }

    /// A constraint whose multipliers are unknowns: a joint or driver, or one inside a node where these are not eliminated.
    pub(super) fn global_constraint(&self, part: usize) -> &ConstraintPhysics {
        match self.model.constraints.get(part) {
            Some(joint) => &joint.physics,
            None => &self.locals[part - self.model.constraints.len()].physics,
        }
    }

    /// Number of unknowns in the matrix.
    pub fn size(&self) -> usize {
        self.pattern.size
    }

    /// Number of constraint equations that appear as multipliers (node-local ones only if they are not eliminated).
    pub fn multipliers(&self) -> usize {
        self.multiplier_columns.len()
    }

    /// Number in the matrix of each constraint equation; `None` where it is dropped.
    pub fn multiplier_places(&self) -> &[Option<usize>] {
        &self.multiplier_columns
    }

    /// True if there is any constraint, inside a node or between nodes.
    pub fn is_constrained(&self) -> bool {
        self.local_equations > 0 || self.multiplier_columns.iter().any(Option::is_some) || !self.model.presence.is_empty()
    }

    /// Name of an unknown of the matrix.
    pub fn unknown_name(&self, column: usize, jacobian: &Jacobian) -> String {
        for (index, node) in self.nodes.iter().enumerate() {
            if node.columns.contains(&column) {
                return self.model.dof_name(jacobian.leading_dof(self, index, column - node.columns.start));
            }
        }
        match self.multiplier_columns.iter().position(|&c| c == Some(column)) {
            Some(equation) if equation < self.model.equations => self.model.equation_name(equation),
            _ => "a constraint inside a node".to_string(),
        }
    }
}

/// The unknowns of one part, and which of them meet in the matrix.
struct Coupled {
    unknowns: Vec<Option<usize>>,
    /// For a constraint: one entry for each unknown of its nodes, naming the node where it is coupled with no other; multipliers
    /// follow. Empty for a part whose unknowns all meet.
    nodes: Vec<Option<usize>>,
    /// Multipliers meet themselves: in some systems the equation is that they are zero.
    diagonal: bool,
}

impl Coupled {
    /// All unknowns of a part meet.
    fn all(unknowns: Vec<Option<usize>>) -> Self {
        Coupled { unknowns, nodes: Vec::new(), diagonal: false }
    }

    /// Where the block stands, by the places of the runs.
    fn scatter(&self, places: &mut impl Iterator<Item = u32>) -> ScatterMap {
        let size = self.unknowns.len();
        if size <= LARGE || !self.nodes.is_empty() || self.unknowns.iter().any(Option::is_none) {
            return ScatterMap::Entries(self.positions(places));
        }
        let (mut rows, mut own) = (SmallVec::new(), Vec::new());
        self.for_each_run(|local, _, _| {
            if local < size {
                rows.push(local);
            }
            own.extend(places.next());
        });
        rows.push(size);
        ScatterMap::Columns(Box::new(ScatterColumns { size, rows, places: own }))
    }

    /// Place of each entry of the block, `NOWHERE` where there is none.
    fn positions(&self, places: &mut impl Iterator<Item = u32>) -> Vec<u32> {
        let mut positions = vec![NOWHERE; self.unknowns.len().pow(2)];
        self.for_each_run(|local, rows, _| {
            for (place, position) in
                places.next().into_iter().flat_map(|first| first..).zip(&mut positions[local..local + rows.len()])
            {
                *position = place;
            }
        });
        positions
    }

    /// Calls `f(local index of the first, rows, column)` for entries one below the other in block and matrix; multipliers do not meet other
    /// multipliers.
    fn for_each_run(&self, mut f: impl FnMut(usize, Range<usize>, usize)) {
        let all = self.nodes.is_empty();
        let meet = |i: usize, j: usize| match (self.nodes.get(i), self.nodes.get(j)) {
            (Some(a), Some(b)) => a == b,
            (None, None) => all || (self.diagonal && i == j),
            _ => true,
        };
        let count = self.unknowns.len();
        let mut runs: SmallVec<[(usize, Range<usize>); 8]> = SmallVec::new();
        for (j, column) in self.unknowns.iter().enumerate() {
            let Some(column) = *column else { continue };
            // where all meet, every column has the same
            if !all || runs.is_empty() {
                runs.clear();
                for (i, row) in self.unknowns.iter().enumerate() {
                    let Some(row) = row.filter(|_| meet(i, j)) else { continue };
                    match runs.last_mut() {
                        Some((first, rows)) if *first + rows.len() == i && rows.end == row => rows.end += 1,
                        _ => runs.push((i, row..row + 1)),
                    }
                }
            }
            for (first, rows) in &runs {
                f(first + j * count, rows.clone(), column);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_blocks_stand_where_their_entries_do() {
        // nodes whose unknowns do not follow each other, two of which do
        let unknowns = (40..52).chain(3..12).chain(12..19).map(Some).collect();
        let coupled = Coupled { unknowns, nodes: Vec::new(), diagonal: false };
        let (mut runs, size) = (vec![(3, 0..5), (41, 20..60)], coupled.unknowns.len());
        let before = runs.len();
        coupled.for_each_run(|_, rows, column| runs.push((column as u32, rows.start as u32..rows.end as u32)));
        let (pattern, places) = SparsePattern::from_runs(60, &runs);
        let positions = coupled.positions(&mut places[before..].iter().copied());
        let ScatterMap::Columns(columns) = coupled.scatter(&mut places[before..].iter().copied()) else {
            panic!("a block of {size} unknowns is large");
        };
        for (label, &place) in positions.iter().enumerate() {
            let [row, column] = [label % size, label / size].map(|own| coupled.unknowns[own].unwrap());
            assert_eq!(pattern.position(row, column), Some(place as usize));
        }
        let mut by_runs = vec![NOWHERE; size * size];
        columns.for_each_run(|first, places| {
            places.zip(&mut by_runs[first..]).for_each(|(place, own)| *own = place as u32);
        });
        assert_eq!(by_runs, positions);
        // some of them, with numbers
        let labels: Vec<u32> = (0..(size * size) as u32).filter(|label| label % 7 < 2).collect();
        let mut some = Vec::new();
        columns.for_each_place(&labels, labels.iter().map(|&label| f64::from(label)), |place, own| some.push((place, own)));
        let expected: Vec<_> = labels.iter().map(|&label| (positions[label as usize], f64::from(label))).collect();
        assert_eq!(some, expected);
    }
}
