use super::model::{Model, NodeId};
use super::{Jacobian, SparsePattern};
use crate::elements::AnyConstraint;
use std::ops::Range;

/// Choices that fix the unknowns of a [`System`].
#[derive(Clone, Debug, Default)]
pub struct SystemOptions {
    /// Constraint equations that are left out because they depend on others.
    pub dropped: Vec<usize>,
    /// Keep node-local constraints as global ones instead of eliminating them: for tests of the elimination.
    pub unreduced: bool,
    /// With the unknowns y and eta of the stabilized level.
    pub stabilized: bool,
}

/// A constraint inside a node, with the place of its multipliers in `local_mu`.
pub(super) struct Local {
    pub node: usize,
    pub equations: Range<usize>,
    pub physics: Box<dyn AnyConstraint>,
}

/// A constraint whose multipliers are unknowns of the matrix.
pub(super) struct GlobalConstraint<'s> {
    pub physics: &'s dyn AnyConstraint,
    pub nodes: Nodes<'s>,
    pub parameters: Range<usize>,
    pub equations: Range<usize>,
}

/// Nodes of a global constraint.
pub(super) enum Nodes<'s> {
    Listed(&'s [NodeId]),
    Single([NodeId; 1]),
}

impl std::ops::Deref for Nodes<'_> {
    type Target = [NodeId];
    fn deref(&self) -> &[NodeId] {
        match self {
            Nodes::Listed(nodes) => nodes,
            Nodes::Single(node) => node,
        }
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

/// A part that adds a dense block to the matrix.
pub(super) struct Contributor {
    /// Place in the matrix values of each entry of the column-major block; `NOWHERE` where nothing is added.
    pub positions: Vec<usize>,
}
pub(super) const NOWHERE: usize = usize::MAX;

/// The numbered equations of a model: which unknowns reach the matrix, and where each part adds to it.
pub struct System<'m> {
    /// The topology.
    pub model: &'m Model,
    /// The choices.
    pub options: SystemOptions,
    /// Places of the matrix entries.
    pub pattern: SparsePattern,
    pub(super) nodes: Vec<NodeUnknowns>,
    pub(super) locals: Vec<Local>,
    pub(super) local_equations: usize,
    /// Column of each multiplier; `None` where dropped.
    pub(super) multiplier_columns: Vec<Option<usize>>,
    pub(super) stabilizer_columns: Vec<Option<usize>>,
    pub(super) element_blocks: Vec<Contributor>,
    pub(super) constraint_blocks: Vec<Contributor>,
    /// Nodes with an eliminated constraint, or all of them at the stabilized level.
    pub(super) node_blocks: Vec<(usize, Contributor)>,
}

impl<'m> System<'m> {
    /// Numbers the unknowns and lays out the matrix.
    pub fn new(model: &'m Model, options: SystemOptions) -> Self {
        let copies = if options.stabilized { 2 } else { 1 };
        let mut locals = Vec::new();
        let (mut local_equations, mut columns) = (0, 0);
        let mut nodes = Vec::with_capacity(model.nodes.len());
        for (index, node) in model.nodes.iter().enumerate() {
            let mut unknowns = NodeUnknowns { columns: columns..columns, local: None };
            if !node.fixed {
                let mut free = node.dofs.len();
                if let Some(physics) = node.kind.local_constraint() {
                    let equations = local_equations..local_equations + physics.equation_count();
                    local_equations = equations.end;
                    if !options.unreduced {
                        free -= equations.len();
                        unknowns.local = Some(locals.len());
                    }
                    locals.push(Local { node: index, equations, physics });
                }
                columns += copies * free;
                unknowns.columns.end = columns;
            }
            nodes.push(unknowns);
        }
        let mut multipliers = |count: usize, dropped: &[usize]| -> Vec<Option<usize>> {
            (0..count)
                .map(|equation| {
                    (!dropped.contains(&equation)).then(|| {
                        columns += 1;
                        columns - 1
                    })
                })
                .collect()
        };
        // unreduced: local equations are numbered behind the joints' own
        let visible = model.equations + if options.unreduced { local_equations } else { 0 };
        let multiplier_columns = multipliers(visible, &options.dropped);
        let stabilizer_columns = multipliers(if options.stabilized { visible } else { 0 }, &options.dropped);

        let node_columns = |ids: &[NodeId]| -> Vec<Option<usize>> {
            ids.iter().flat_map(|id| nodes[id.0].columns.clone().map(Some)).collect()
        };
        let with_multipliers = |mut unknowns: Vec<Option<usize>>, equations: Range<usize>| {
            unknowns.extend_from_slice(&multiplier_columns[equations.clone()]);
            if options.stabilized {
                unknowns.extend_from_slice(&stabilizer_columns[equations]);
            }
            unknowns
        };
        // (unknowns, number of those that belong to nodes)
        let elements: Vec<_> = model.elements.iter().map(|e| (node_columns(&e.nodes), usize::MAX)).collect();
        let mut constraints = Vec::new();
        for constraint in &model.constraints {
            let own = node_columns(&constraint.nodes);
            let count = own.len();
            constraints.push((with_multipliers(own, constraint.equations.clone()), count));
        }
        for local in locals.iter().filter(|_| options.unreduced) {
            let own = node_columns(&[NodeId(local.node)]);
            let count = own.len();
            let equations = local.equations.start + model.equations..local.equations.end + model.equations;
            constraints.push((with_multipliers(own, equations), count));
        }
        let with_block = |node: &NodeUnknowns| !node.columns.is_empty() && (node.local.is_some() || options.stabilized);
        let block_nodes: Vec<usize> = (0..nodes.len()).filter(|&node| with_block(&nodes[node])).collect();
        let node_blocks: Vec<_> = block_nodes.iter().map(|&node| (node_columns(&[NodeId(node)]), usize::MAX)).collect();

        let mut entries = Vec::new();
        for (unknowns, own) in elements.iter().chain(&constraints).chain(&node_blocks) {
            for_each_entry(unknowns, *own, |_, row, column| entries.push((column, row)));
        }
        let pattern = SparsePattern::from_entries(columns, entries);
        let place = |list: Vec<(Vec<Option<usize>>, usize)>| -> Vec<Contributor> {
            list.into_iter()
                .map(|(unknowns, own)| {
                    let mut positions = vec![NOWHERE; unknowns.len() * unknowns.len()];
                    for_each_entry(&unknowns, own, |local, row, column| {
                        positions[local] = pattern.position(row, column).unwrap_or(NOWHERE);
                    });
                    Contributor { positions }
                })
                .collect()
        };
        let (element_blocks, constraint_blocks) = (place(elements), place(constraints));
        let node_blocks = block_nodes.into_iter().zip(place(node_blocks)).collect();
        System {
            model,
            nodes,
            locals,
            local_equations,
            multiplier_columns,
            stabilizer_columns,
            element_blocks,
            constraint_blocks,
            node_blocks,
            pattern,
            options,
        }
    }

    /// Joints and drivers, followed by the node-local constraints where these are not eliminated.
    pub(super) fn global_constraints(&self) -> impl Iterator<Item = GlobalConstraint<'_>> {
        let joints = self.model.constraints.iter().map(|joint| GlobalConstraint {
            physics: &*joint.physics,
            nodes: Nodes::Listed(&joint.nodes),
            parameters: joint.parameters.clone(),
            equations: joint.equations.clone(),
        });
        let shift = self.model.equations;
        let inside = self.locals.iter().filter(|_| self.options.unreduced).map(move |local| GlobalConstraint {
            physics: &*local.physics,
            nodes: Nodes::Single([NodeId(local.node)]),
            parameters: 0..0,
            equations: local.equations.start + shift..local.equations.end + shift,
        });
        joints.chain(inside)
    }

    /// Node-local constraints that are eliminated.
    pub(super) fn eliminated(&self) -> impl Iterator<Item = &Local> {
        self.locals.iter().filter(|_| !self.options.unreduced)
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

    /// Number in the matrix of each multiplier of the rate corrections; empty unless stabilized.
    pub fn stabilizer_places(&self) -> &[Option<usize>] {
        &self.stabilizer_columns
    }

    /// True if there is any constraint, inside a node or between nodes.
    pub fn is_constrained(&self) -> bool {
        self.local_equations > 0 || self.multiplier_columns.iter().any(Option::is_some)
    }

    /// Name of an unknown of the matrix.
    pub fn unknown_name(&self, column: usize, jacobian: &Jacobian) -> String {
        for (index, node) in self.nodes.iter().enumerate() {
            if node.columns.contains(&column) {
                return self.model.dof_name(jacobian.leading_dof(self, index, column - node.columns.start));
            }
        }
        let equation = self.multiplier_columns.iter().chain(&self.stabilizer_columns).position(|&c| c == Some(column));
        match equation.map(|e| e % self.multiplier_columns.len()) {
            Some(equation) if equation < self.model.equations => self.model.equation_name(equation),
            _ => "a constraint inside a node".to_string(),
        }
    }
}

/// Calls `f(local index, row, column)` for each entry of a contributor; multipliers do not meet multipliers.
fn for_each_entry(unknowns: &[Option<usize>], own: usize, mut f: impl FnMut(usize, usize, usize)) {
    for (j, column) in unknowns.iter().enumerate() {
        for (i, row) in unknowns.iter().enumerate() {
            if let (Some(row), Some(column)) = (row, column)
                && (i < own || j < own)
            {
                f(i + j * unknowns.len(), *row, *column);
            }
        }
    }
}
