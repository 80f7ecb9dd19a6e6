//! Parts with the same program, which are evaluated side by side.

use super::constraint_programs::ConstraintLayout;
use super::element_programs::{ElementLayout, Force};
use super::gather_map::{GatherMap, Starts};
use super::null_spaces::places_of_numbers;
use super::numbering::{DofMap, System};
use super::reduction::{NodeReduction, RotationCoordinates};
use crate::elements::ConstraintPhysics;
use crate::program::{Formula, ProgramCache};
use smallvec::SmallVec;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Parts whose formulas are the same and whose nodes are of the same kinds.
pub(super) struct Batch<L> {
    /// GatherMap of the parts in their list.
    pub parts: Vec<usize>,
    /// Kinds of their nodes.
    pub nodes: Box<[NodeReduction]>,
    /// The formula.
    pub formula: Arc<Formula>,
    /// GatherMap of arguments.
    pub layout: L,
    /// Where the numbers of the parts stand.
    pub places: GatherMap,
    /// Where the numbers of the bases of each node begin, those of N_L and of N_R alike.
    pub bases: SmallVec<[Starts; 3]>,
    /// Its programs.
    pub programs: ProgramCache,
}

/// Elements.
pub(super) type ElementBatch = Batch<ElementLayout>;
impl<L: Copy> Batch<L> {
    /// Some of its parts, by their places in it, whose programs are those of the whole.
    pub fn of_chosen(&self, chosen: &[usize]) -> Self {
        Batch {
            parts: chosen.iter().map(|&place| self.parts[place]).collect(),
            nodes: self.nodes.clone(),
            formula: self.formula.clone(),
            layout: self.layout,
            places: self.places.of_chosen(chosen),
            bases: self.bases.iter().map(|starts| starts.of_chosen(chosen)).collect(),
            programs: ProgramCache::default(),
        }
    }
}

/// Constraints.
pub(super) type ConstraintBatch = Batch<ConstraintLayout>;

/// Sorts parts that have a formula into batches, in the order in which their kinds first come.
fn sorted<'p, L>(
    count: usize,
    kind: impl Fn(usize) -> Option<(Arc<Formula>, Box<[NodeReduction]>, bool)>,
    layout: impl Fn(usize) -> L,
    numbers: impl Fn(usize) -> (&'p DofMap, Range<usize>),
    bases: &[Range<usize>],
) -> Vec<Batch<L>> {
    let mut batches: Vec<Batch<L>> = Vec::new();
    let mut places: HashMap<(*const Formula, Box<[NodeReduction]>, bool), usize> = HashMap::new();
    for part in 0..count {
        let Some((formula, nodes, flag)) = kind(part) else { continue };
        let place = *places.entry((Arc::as_ptr(&formula), nodes.clone(), flag)).or_insert_with(|| {
            batches.push(Batch {
                parts: Vec::new(),
                nodes,
                formula,
                layout: layout(part),
                places: GatherMap::default(),
                bases: SmallVec::new(),
                programs: ProgramCache::default(),
            });
            batches.len() - 1
        });
        batches[place].parts.push(part);
    }
    for batch in &mut batches {
        batch.places = GatherMap::of(batch.parts.iter().map(|&part| numbers(part)));
        let of_node =
            |node: usize| Starts::of_parts(batch.parts.iter().map(|&part| bases[numbers(part).0.nodes[node]].clone()));
        batch.bases = (0..batch.places.nodes.len()).map(of_node).collect();
    }
    batches
}

impl System<'_> {
    fn reductions(&self, part: &DofMap) -> Box<[NodeReduction]> {
        part.nodes.iter().map(|&node| self.reduction(node)).collect()
    }

    /// How the coordinates of a node follow from its unknowns.
    pub(super) fn reduction(&self, node: usize) -> NodeReduction {
        let (dofs, unknowns) = (self.model.nodes[node].dofs.len(), &self.nodes[node]);
        if unknowns.columns.is_empty() {
            return NodeReduction::Fixed { dofs };
        }
        match unknowns.local.and(RotationCoordinates::of(self.model.nodes[node].kind)) {
            None => NodeReduction::Free { dofs },
            Some(turning) => NodeReduction::RotationCoordinates { free: dofs - turning.coordinates(), turning },
        }
    }

    /// Elements by what they add to F.
    pub(super) fn sort_elements(&self, force: Force) -> Vec<ElementBatch> {
        let kind = |part: usize| {
            let formula = Arc::clone(force.formula(&self.model.elements[part].physics)?);
            Some((formula, self.reductions(&self.element_parts[part]), false))
        };
        let layout = |part: usize| ElementLayout::new(&self.model.elements[part].physics, force);
        let numbers = |part: usize| (&self.element_parts[part], 0..0);
        sorted(self.model.elements.len(), kind, layout, numbers, &places_of_numbers(self))
    }

    /// Constraints whose multipliers are unknowns; one without any, as a contact that is open, has neither equations nor reactions.
    pub(super) fn sort_constraints(&self) -> Vec<ConstraintBatch> {
        let kind = |part: usize| {
            let own = self.global_constraint(part);
            let mut rows = self.equations_of(part);
            let is_left_out = !rows.is_empty() && rows.all(|row| self.multiplier_columns[row].is_none());
            if is_left_out && !own.has_friction() {
                return None;
            }
            Some((Arc::clone(own.formula()), self.reductions(&self.constraint_parts[part]), own.is_nonholonomic()))
        };
        let layout = |part: usize| ConstraintLayout::of(self.global_constraint(part));
        let numbers = |part: usize| (&self.constraint_parts[part], self.equations_of(part));
        sorted(self.constraint_parts.len(), kind, layout, numbers, &places_of_numbers(self))
    }

    /// Constraints inside nodes that are eliminated.
    pub(super) fn sort_nodes(&self) -> Vec<ConstraintBatch> {
        let own = if self.options.unreduced { &[] } else { &self.locals[..] };
        let kind = |part: usize| Some((Arc::clone(own[part].physics.formula()), self.reductions(&own[part].part), false));
        let layout = |part: usize| ConstraintLayout {
            n: own[part].part.segments[0].len(),
            ..ConstraintLayout::of(&own[part].physics)
        };
        let numbers = |part: usize| (&own[part].part, own[part].equations.clone());
        sorted(own.len(), kind, layout, numbers, &places_of_numbers(self))
    }

    /// The constraint of a batch: its first one stands for all.
    pub(super) fn constraint_of(&self, batch: &ConstraintBatch) -> &ConstraintPhysics {
        self.global_constraint(batch.parts[0])
    }
}
