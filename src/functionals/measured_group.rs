use super::aggregate::SUMS;
use super::{AnyPointQuantity, Over, PointWeights, Sample};
use crate::assembly::{BatchWork, ElementId, Model, VectorsAvq, run_parts};
use crate::elements::{ElementPhysics, RunScalar};
use crate::program::{Codes, Formula, Program, Recorded, continued};
use crate::scalar::larger;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// An argument of a group's formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Argument {
    /// Acceleration of a coordinate of the element.
    A(usize),
    /// Its velocity.
    V(usize),
    /// The coordinate.
    Q(usize),
    /// Parameter of the element.
    Parameter(usize),
    /// Parameter of the quantity.
    Own(usize),
    /// Time.
    Time,
}

/// What is measured in one element, as a formula.
#[derive(Clone, Debug)]
pub struct GroupFormula {
    /// The formula.
    pub formula: Arc<Formula>,
    /// Its arguments.
    pub arguments: Vec<Argument>,
    /// Which results are values.
    pub values: Vec<usize>,
    /// Which are their weights; none of them where all are 1.
    pub weights: Vec<usize>,
}

/// A quantity of the elements of a group: values at points, with weights.
pub struct MeasuredGroup {
    /// The elements; all of the model where there is no list.
    elements: Option<Vec<ElementId>>,
    quantity: Box<dyn AnyPointQuantity>,
    /// Place in p of the quantity's own parameters.
    parameters: Range<usize>,
    batches: OnceLock<Result<Vec<GroupBatch>, String>>,
}

/// Elements with the same formula.
struct GroupBatch {
    own: GroupFormula,
    members: Vec<GroupMember>,
    /// Its values without their weights, and with them.
    programs: [OnceLock<ValueProgram>; 2],
}

/// Gives the values of an element.
struct ValueProgram {
    program: Arc<Program>,
    /// Arguments that it reads, with their places.
    arguments: Vec<(usize, Argument)>,
}

/// Where the numbers of one element stand.
#[derive(Clone, Debug)]
struct GroupMember {
    element: ElementId,
    /// In the vectors of the model, those of its coordinates.
    dofs: Vec<usize>,
    /// First of its parameters.
    parameters: Range<usize>,
}

impl GroupMember {
    fn argument<S: RunScalar>(&self, argument: Argument, sample: &Sample<S>, p: &[S], own: &[S]) -> S {
        match argument {
            Argument::A(dof) => sample.at.a[self.dofs[dof]],
            Argument::V(dof) => sample.at.v[self.dofs[dof]],
            Argument::Q(dof) => sample.at.q[self.dofs[dof]],
            Argument::Parameter(place) => p[self.parameters.start + place],
            Argument::Own(place) => own[place],
            Argument::Time => S::from(sample.t),
        }
    }
}

/// Workspace of a group's values.
pub struct GroupWork<S> {
    batch: BatchWork<S>,
    /// Values with their weights.
    pub(super) values: Vec<[S; 2]>,
}

impl<S> Default for GroupWork<S> {
    fn default() -> Self {
        GroupWork { batch: BatchWork::default(), values: Vec::new() }
    }
}

impl MeasuredGroup {
    /// A quantity of some elements, or of all that the model has in the end.
    pub fn new(elements: Option<Vec<ElementId>>, quantity: Box<dyn AnyPointQuantity>, parameters: Range<usize>) -> Self {
        MeasuredGroup { elements, quantity, parameters, batches: OnceLock::new() }
    }

    /// Why it cannot be measured in a model, if so.
    pub fn refused(&self, model: &Model) -> Option<&str> {
        self.recorded(model).as_ref().err().map(String::as_str)
    }

    /// Whether it changes with the state.
    pub fn is_moving(&self, model: &Model) -> bool {
        let is_of_state = |(_, argument): &(usize, Argument)| !matches!(argument, Argument::Parameter(_) | Argument::Own(_));
        let reads_state = |batch: &GroupBatch| batch.program(true).arguments.iter().any(is_of_state);
        self.batches(model).iter().any(reads_state)
    }

    fn recorded(&self, model: &Model) -> &Result<Vec<GroupBatch>, String> {
        self.batches.get_or_init(|| {
            let mut batches: Vec<GroupBatch> = Vec::new();
            // elements of one type and options share their recordings
            let mut places: Vec<(&ElementPhysics, Option<usize>)> = Vec::new();
            let all = self.elements.is_none().then(|| model.element_ids());
            let listed = self.elements.iter().flatten().copied();
            for (id, element) in all.into_iter().flatten().chain(listed).filter_map(|id| Some((id, model.find_element(id)?)))
            {
                let known = places.iter().rev().find(|(physics, _)| physics.is_same(&element.physics));
                let place = match known {
                    Some(&(_, place)) => place,
                    None => {
                        let mut place = None;
                        if self.quantity.is_on(&element.physics) {
                            let own = self.quantity.record(&element.physics)?;
                            let like = batches.iter().position(|batch| Arc::ptr_eq(&batch.own.formula, &own.formula));
                            place = Some(like.unwrap_or(batches.len()));
                            if like.is_none() {
                                batches.push(GroupBatch { own, members: Vec::new(), programs: Default::default() });
                            }
                        }
                        places.push((&element.physics, place));
                        place
                    }
                };
                if let Some(place) = place {
                    let dofs = element.nodes.iter().flat_map(|&node| model.node(node).dofs.clone()).collect();
                    batches[place].members.push(GroupMember { element: id, dofs, parameters: element.parameters.clone() });
                }
            }
            Ok(batches)
        })
    }

    fn batches(&self, model: &Model) -> &[GroupBatch] {
        let batches = self.recorded(model).as_ref();
        let batches = batches.unwrap_or_else(|why| panic!("a quantity that was not checked before a run: {why}"));
        let first = batches.first().map(|batch| batch.members[0].element);
        let is_own = first.is_none_or(|element| model.find_element(element).is_some());
        assert!(is_own, "a quantity that was measured in one model is measured in another one: make it anew");
        batches
    }

    /// Writes all values at a sample, with their weights where these are asked for and otherwise 1.
    pub(super) fn write_values<S: RunScalar>(
        &self,
        model: &Model,
        sample: &Sample<S>,
        p: &[S],
        points: PointWeights,
        work: &mut GroupWork<S>,
    ) {
        let own = &p[self.parameters.clone()];
        let GroupWork { batch: work, values } = work;
        values.clear();
        for batch in self.batches(model) {
            let weighted = points == PointWeights::Own && !batch.own.weights.is_empty();
            let ValueProgram { program, arguments } = batch.program(weighted);
            let count = batch.own.values.len();
            run_parts(
                program,
                batch.members.len(),
                work,
                |index, lane| {
                    let member = &batch.members[index];
                    for &(place, argument) in arguments {
                        lane.set(place, member.argument(argument, sample, p, own));
                    }
                },
                |_, results| {
                    let first = values.len();
                    values.extend(results.iter().copied().take(count).map(|value| [value, S::one()]));
                    if weighted {
                        let weights = results.iter().copied().skip(count);
                        values[first..].iter_mut().zip(weights).for_each(|(point, weight)| point[1] = weight);
                    }
                },
            );
        }
    }

    /// The sum of all values by their weights.
    pub(super) fn sum<S: RunScalar>(&self, model: &Model, sample: &Sample<S>, p: &[S], work: &mut GroupWork<S>) -> S {
        self.write_values(model, sample, p, PointWeights::Own, work);
        work.values.iter().map(|&[value, weight]| value * weight).sum()
    }

    /// What it is in each element that has it, at a sample: of several points the largest, or what is no number.
    pub fn element_values(&self, model: &Model, sample: &Sample<f64>, p: &[f64]) -> Vec<(ElementId, f64)> {
        let mut work = GroupWork::default();
        self.write_values(model, sample, p, PointWeights::Equal, &mut work);
        let mut values = work.values.iter().map(|&[value, _]| value);
        let mut all = Vec::new();
        for batch in self.batches(model) {
            for member in &batch.members {
                let own = values.by_ref().take(batch.own.values.len());
                all.push((member.element, own.reduce(larger).unwrap_or(f64::NAN)));
            }
        }
        all
    }

    /// What gives the gradient of what these values add to the sums of a functional, towards the state and some parameters.
    pub(super) fn gradient(&self, model: &Model, over: &Over, active: &[bool]) -> GroupGradient {
        let mut selections: Vec<Selection> = Vec::new();
        let of_quantity = &active[self.parameters.clone()];
        for batch in self.batches(model) {
            let mut places: HashMap<&[bool], usize> = HashMap::new();
            for member in &batch.members {
                let asked = &active[member.parameters.clone()];
                let place = *places.entry(asked).or_insert_with(|| {
                    let program = batch.gradient(over, asked, of_quantity);
                    let arguments = read_arguments(&program, &batch.own.arguments);
                    let labels = program.labels().iter().map(|&label| batch.own.arguments[label as usize]).collect();
                    let extra = batch.own.arguments.len();
                    selections.push(Selection { program, arguments, labels, extra, members: Vec::new() });
                    selections.len() - 1
                });
                selections[place].members.push(member.clone());
            }
        }
        GroupGradient { own: self.parameters.clone(), selections, work: BatchWork::default() }
    }
}

impl GroupBatch {
    /// The values, and then their weights if these are asked for.
    fn program(&self, weighted: bool) -> &ValueProgram {
        self.programs[usize::from(weighted)].get_or_init(|| {
            let GroupFormula { formula, arguments, values, weights } = &self.own;
            let weights = if weighted { &weights[..] } else { &[] };
            let chosen: Codes = values.iter().chain(weights).map(|&result| result as u32).collect();
            let key = ("values at points", chosen.clone());
            let program = formula
                .dense_program(key, 0, |_, _, outputs| chosen.iter().map(|&result| outputs[result as usize]).collect());
            ValueProgram { arguments: read_arguments(&program, arguments), program }
        })
    }

    /// Gradient of bar . (N, D, M) of one element, towards its state, those of its parameters that are `asked` for, and those `of_quantity`.
    /// Behind the arguments: bar, and the offset.
    fn gradient(&self, over: &Over, asked: &[bool], of_quantity: &[bool]) -> Arc<Program> {
        let GroupFormula { formula, arguments, values, weights } = &self.own;
        let flags = |flags: &[bool]| -> Vec<u32> {
            let word = |own: &[bool]| own.iter().fold(1, |word: u32, &flag| 2 * word + u32::from(flag));
            flags.chunks(31).map(word).collect()
        };
        let aggregate = over.aggregate().map_or([0; 4], |aggregate| {
            let bits = aggregate.sharpness.to_bits();
            let squared = u32::from(aggregate.kind.is_squared());
            let smooth = u32::from(matches!(aggregate.kind, super::AggregateKind::SmoothMaximum { .. }));
            let kind = 1 + u32::from(aggregate.kind.is_power()) + 2 * squared + 4 * smooth;
            [kind, u32::from(aggregate.points == PointWeights::Own), bits as u32, (bits >> 32) as u32]
        });
        let results = values.iter().chain(weights).map(|&result| result as u32);
        let code: Codes = flags(asked).into_iter().chain(flags(of_quantity)).chain(aggregate).chain(results).collect();
        let weights = if over.points() == PointWeights::Own { &weights[..] } else { &[] };
        formula.sparse_program(("gradient at points", code), SUMS + 1, |graph, inputs, outputs| {
            let chosen = values.iter().chain(weights).map(|&result| outputs[result]);
            let all: Vec<_> = chosen.chain(inputs[arguments.len()..].iter().copied()).collect();
            let sum = continued(graph, &all, |x| {
                let (points, rest) = x.split_at(values.len() + weights.len());
                let (y, w) = points.split_at(values.len());
                let (bars, offset) = rest.split_at(SUMS);
                let mut sum = Recorded::from(0.0);
                for (place, &y) in y.iter().enumerate() {
                    let weight = w.get(place).copied().unwrap_or(Recorded::from(1.0));
                    let terms = over.terms(y, weight, offset[0]);
                    sum = terms.into_iter().zip(bars).fold(sum, |sum, (term, &bar)| sum + term * bar);
                }
                vec![sum]
            });
            let is_asked = |argument: &Argument| match *argument {
                Argument::A(_) | Argument::V(_) | Argument::Q(_) => true,
                Argument::Parameter(place) => asked[place],
                Argument::Own(place) => of_quantity[place],
                Argument::Time => false,
            };
            let (one, zero) = (graph.constant(1.0), graph.zero());
            let places: SmallVec<[usize; 64]> = (0..arguments.len()).filter(|&place| is_asked(&arguments[place])).collect();
            let towards: Vec<_> = places.iter().map(|&place| inputs[place]).collect();
            let gradient = graph.reverse(&sum, &[one], &towards);
            let mut all = vec![zero; arguments.len()];
            places.iter().zip(gradient).for_each(|(&place, own)| all[place] = own);
            all
        })
    }
}

/// Arguments that a program reads, with their places.
fn read_arguments(program: &Program, arguments: &[Argument]) -> Vec<(usize, Argument)> {
    let reads = program.reads();
    arguments.iter().copied().enumerate().filter(|&(place, _)| reads[place]).collect()
}

/// Elements with the same formula and the same parameters asked for.
struct Selection {
    program: Arc<Program>,
    arguments: Vec<(usize, Argument)>,
    /// What each result is the derivative towards.
    labels: Vec<Argument>,
    /// Place of what the program takes beside the formula's arguments.
    extra: usize,
    members: Vec<GroupMember>,
}

/// Gives gradients of the sums of a functional over a group.
pub(super) struct GroupGradient {
    own: Range<usize>,
    selections: Vec<Selection>,
    work: BatchWork<f64>,
}

impl GroupGradient {
    /// Adds the gradient of bars . (N, D, M) at a sample, with the offset of these sums.
    pub fn add(
        &mut self,
        sample: &Sample<f64>,
        p: &[f64],
        (bars, offset): ([f64; SUMS], f64),
        at_bar: &mut VectorsAvq<f64>,
        p_bar: &mut [f64],
    ) {
        let GroupGradient { own: place_of_own, selections, work } = self;
        let own = &p[place_of_own.clone()];
        for Selection { program, arguments, labels, extra, members } in selections {
            run_parts(
                program,
                members.len(),
                work,
                |index, lane| {
                    let member = &members[index];
                    for &(place, argument) in &*arguments {
                        lane.set(place, member.argument(argument, sample, p, own));
                    }
                    let next = lane.copy(*extra, &bars);
                    lane.set(next, offset);
                },
                |index, results| {
                    let member = &members[index];
                    for (&label, &result) in labels.iter().zip(results) {
                        match label {
                            Argument::A(dof) => at_bar.a[member.dofs[dof]] += result,
                            Argument::V(dof) => at_bar.v[member.dofs[dof]] += result,
                            Argument::Q(dof) => at_bar.q[member.dofs[dof]] += result,
                            Argument::Parameter(place) => p_bar[member.parameters.start + place] += result,
                            Argument::Own(place) => p_bar[place_of_own.start + place] += result,
                            Argument::Time => {}
                        }
                    }
                },
            );
        }
    }
}
