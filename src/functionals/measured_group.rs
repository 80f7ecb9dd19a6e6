use super::aggregate::SUMS;
use super::{AggregateKind, AnyPointQuantity, Over, PointWeights, Sample};
use crate::assembly::{BatchWork, ElementId, LaneResults, Lanes, Model, ModelIdentity, Run, Starts, VectorsAvq, run_lanes};
use crate::elements::{ElementPhysics, RunScalar};
use crate::integrators::Place;
use crate::program::{Codes, Digest, Formula, Program, Recorded, continued};
use crate::scalar::larger;
use smallvec::SmallVec;
use std::collections::HashMap;
use std::hash::Hash;
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
    /// Parameter of the quantity that each element has for itself.
    OfElement(usize),
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

/// Elements of a group with what is measured in them.
pub struct GroupPart {
    /// The elements; all of the model where there is no list.
    pub elements: Option<Vec<ElementId>>,
    /// What is measured.
    pub quantity: Box<dyn AnyPointQuantity>,
    /// Place in p of those of its parameters that each element has for itself, behind those that all share, element by element.
    pub of_elements: Range<usize>,
}

/// A quantity of the elements of a group: values at points, with weights.
pub struct MeasuredGroup {
    parts: Vec<GroupPart>,
    /// Place in p of the parameters that all elements share.
    parameters: Range<usize>,
    /// With the model in which they were recorded.
    batches: OnceLock<(ModelIdentity, Result<Vec<GroupBatch>, String>)>,
}

/// Elements with the same formula.
struct GroupBatch {
    own: GroupFormula,
    members: Vec<GroupMember>,
    places: MemberPlaces,
    /// Its values without their weights, and with them.
    programs: [OnceLock<ValueProgram>; 2],
}

/// Gives the values of an element.
struct ValueProgram {
    program: Arc<Program>,
    arguments: Numbers,
}

/// Where the numbers of one element stand.
#[derive(Clone, Debug)]
struct GroupMember {
    element: ElementId,
    /// In the vectors of the model, the coordinates of its nodes.
    nodes: SmallVec<[Range<usize>; 3]>,
    /// Its parameters.
    parameters: Range<usize>,
    /// The quantity's parameters of this element.
    own: Range<usize>,
}

/// Where the numbers of the members of a batch begin.
#[derive(Debug, Default)]
struct MemberPlaces {
    /// Coordinates of each node, parameters, and those of the quantity: the same for all, and of each element.
    lists: Vec<Starts>,
}

impl MemberPlaces {
    fn of(members: &[GroupMember], quantity: &Range<usize>) -> Self {
        let nodes = members.first().map_or(0, |member| member.nodes.len());
        let of_node = |node: usize| Starts::of_parts(members.iter().map(|member| member.nodes[node].clone()));
        let of_parameters = Starts::of_parts(members.iter().map(|member| member.parameters.clone()));
        let of_quantity = Starts::of_parts(members.iter().map(|_| quantity.clone()));
        let own = Starts::of_parts(members.iter().map(|member| member.own.clone()));
        MemberPlaces { lists: (0..nodes).map(of_node).chain([of_parameters, of_quantity, own]).collect() }
    }

    /// The node with a coordinate of the element, and which of its own that is.
    fn coordinate(&self, mut dof: usize) -> (usize, usize) {
        let mut node = 0;
        while dof >= self.lists[node].length {
            dof -= self.lists[node].length;
            node += 1;
        }
        (node, dof)
    }
}

/// Which numbers of a sample the arguments or the results of a program belong to.
#[derive(Debug, Default)]
struct Numbers {
    a: Vec<Run>,
    v: Vec<Run>,
    q: Vec<Run>,
    /// Parameters of the element, and of the quantity.
    p: Vec<Run>,
    time: Option<usize>,
}

impl Numbers {
    fn of(arguments: impl Iterator<Item = (usize, Argument)>, places: &MemberPlaces) -> Self {
        let [parameters, quantity, own] = [3, 2, 1].map(|last| places.lists.len() - last);
        let mut numbers = Numbers::default();
        for (number, argument) in arguments {
            let (runs, (list, offset)) = match argument {
                Argument::A(dof) => (&mut numbers.a, places.coordinate(dof)),
                Argument::V(dof) => (&mut numbers.v, places.coordinate(dof)),
                Argument::Q(dof) => (&mut numbers.q, places.coordinate(dof)),
                Argument::Parameter(place) => (&mut numbers.p, (parameters, place)),
                Argument::Own(place) => (&mut numbers.p, (quantity, place)),
                Argument::OfElement(place) => (&mut numbers.p, (own, place)),
                Argument::Time => {
                    numbers.time = Some(number);
                    continue;
                }
            };
            Run::extend(runs, number, list, offset);
        }
        numbers
    }

    /// Whether they change in a run.
    fn are_moving(&self) -> bool {
        let are_there = [&self.a, &self.v, &self.q].iter().any(|runs| !runs.is_empty());
        are_there || self.time.is_some()
    }

    /// Writes arguments.
    fn gather<S: RunScalar>(&self, places: &MemberPlaces, sample: &Sample<S>, p: &[S], lanes: &mut Lanes<S>) {
        let at = &sample.at;
        for (runs, values) in [(&self.a, &at.a[..]), (&self.v, &at.v), (&self.q, &at.q), (&self.p, p)] {
            lanes.gather_runs(runs, &places.lists, values);
        }
        if let Some(place) = self.time {
            lanes.spread_at(place, &[sample.t]);
        }
    }

    /// Adds derivatives towards these numbers.
    fn add(&self, places: &MemberPlaces, results: &LaneResults<f64>, at_bar: &mut VectorsAvq<f64>, p_bar: &mut [f64]) {
        let VectorsAvq { a, v, q } = at_bar;
        for (runs, values) in [(&self.a, &mut a[..]), (&self.v, v), (&self.q, q), (&self.p, p_bar)] {
            results.add_runs(0, runs, &places.lists, 1.0, values);
        }
    }
}

/// Workspace of a group's values.
pub struct GroupWork<S> {
    batch: BatchWork<S>,
    /// Values with their weights.
    pub(super) values: Vec<[S; 2]>,
}

impl<S> GroupWork<S> {
    /// For values that all ranks ask for in the same order: they share long evaluations.
    pub fn shared() -> Self {
        GroupWork { batch: BatchWork::shared(), values: Vec::new() }
    }
}

crate::assembly::empty_fields!(GroupWork { batch, values });

impl GroupPart {
    /// How many parameters each element has for itself.
    fn own_count(&self) -> usize {
        self.of_elements.len() / self.elements.as_ref().map_or(1, |elements| elements.len().max(1))
    }
    /// Those of an element by its number in the list.
    fn of_element(&self, number: usize) -> Range<usize> {
        let (first, count) = (self.of_elements.start, self.own_count());
        first + number * count..first + (number + 1) * count
    }
}

impl GroupFormula {
    /// Only the first parameters of the quantity are shared, the others are those of each element.
    fn share_arguments(&mut self, shared: usize) {
        for argument in &mut self.arguments {
            if let Argument::Own(place) = *argument
                && place >= shared
            {
                *argument = Argument::OfElement(place - shared);
            }
        }
    }
}

impl MeasuredGroup {
    /// Whether what it measures depends on parameters alone.
    pub fn is_still(&self, model: &Model) -> bool {
        let is_still = |batch: &GroupBatch| {
            let GroupFormula { formula, arguments, values, weights } = &batch.own;
            formula.inspect(|graph, outputs| {
                let read: Vec<_> = values.iter().chain(weights).map(|&place| outputs[place]).collect();
                let reads = graph.reads(&read, arguments.len());
                arguments.iter().zip(reads).all(|(argument, read)| {
                    use Argument::{OfElement, Own, Parameter, Time};
                    !read || matches!(argument, Parameter(_) | Own(_) | OfElement(_) | Time)
                })
            })
        };
        self.batches(model).iter().all(is_still)
    }

    /// A quantity of some elements, or of all that the model has in the end.
    pub fn new(elements: Option<Vec<ElementId>>, quantity: Box<dyn AnyPointQuantity>, parameters: Range<usize>) -> Self {
        Self::of_parts(vec![GroupPart { elements, quantity, of_elements: 0..0 }], parameters)
    }

    /// Quantities of several lists of elements, with the parameters that all of them share.
    pub fn of_parts(parts: Vec<GroupPart>, parameters: Range<usize>) -> Self {
        MeasuredGroup { parts, parameters, batches: OnceLock::new() }
    }

    /// Gives the formula of each element to `add`, with the places of its arguments.
    pub(super) fn each_formula(&self, model: &Model, mut see: impl FnMut(&Arc<Formula>, &dyn Fn() -> Vec<Place>)) {
        for batch in self.batches(model) {
            for member in &batch.members {
                let dofs: Vec<usize> = member.nodes.iter().cloned().flatten().collect();
                let place = |argument: &Argument| match *argument {
                    Argument::A(dof) => Place::A(dofs[dof]),
                    Argument::V(dof) => Place::V(dofs[dof]),
                    Argument::Q(dof) => Place::Q(dofs[dof]),
                    Argument::Parameter(place) => Place::P(member.parameters.start + place),
                    Argument::Own(place) => Place::P(self.parameters.start + place),
                    Argument::OfElement(place) => Place::P(member.own.start + place),
                    Argument::Time => Place::Time,
                };
                see(&batch.own.formula, &|| batch.own.arguments.iter().map(place).collect());
            }
        }
    }

    /// Why it cannot be measured in a model, if so.
    pub(super) fn refused(&self, model: &Model) -> Option<String> {
        let mut elements = self.parts.iter().flat_map(|part| part.elements.iter().flatten());
        if elements.any(|&element| model.find_element(element).is_none()) {
            return Some("it measures elements of another model; make it anew for this one".into());
        }
        match self.recorded(model) {
            (identity, _) if *identity != model.identity() => {
                Some("it was measured in another model before; make it anew for this one".into())
            }
            (_, batches) => batches.as_ref().err().cloned(),
        }
    }

    /// Why its numbers of parameters cannot be those of a model, if so.
    pub(super) fn parameters_refused(&self, model: &Model) -> Option<String> {
        self.parts.iter().find_map(|part| {
            let (shared, own) = (self.parameters.len(), part.own_count());
            let (wanted, all) = (part.quantity.parameter_list().len(), model.parameters);
            let fits = shared + own == wanted && part.of_elements.len() == own * part.elements.as_ref().map_or(0, Vec::len);
            let last = part.of_elements.end.max(self.parameters.end);
            (!fits || last > all).then(|| {
                let Range { start, end } = self.parameters;
                format!("its {wanted} parameters cannot be numbers {start}..{end} of a model with {all} parameters; make it anew for this one")
            })
        })
    }

    /// Whether it changes with the state.
    pub fn is_moving(&self, model: &Model) -> bool {
        self.batches(model).iter().any(|batch| batch.program(true).arguments.are_moving())
    }

    fn recorded(&self, model: &Model) -> &(ModelIdentity, Result<Vec<GroupBatch>, String>) {
        self.batches.get_or_init(|| (model.identity(), self.record(model)))
    }

    fn record(&self, model: &Model) -> Result<Vec<GroupBatch>, String> {
        let mut batches = Vec::new();
        for part in &self.parts {
            self.record_part(part, model, &mut batches)?;
        }
        batches.iter_mut().for_each(|batch| batch.places = MemberPlaces::of(&batch.members, &self.parameters));
        Ok(batches)
    }

    fn record_part(&self, part: &GroupPart, model: &Model, batches: &mut Vec<GroupBatch>) -> Result<(), String> {
        // elements of one type and options share their recordings
        let mut places: Vec<(&ElementPhysics, Option<usize>)> = Vec::new();
        let all = part.elements.is_none().then(|| model.element_ids());
        let listed = part.elements.iter().flatten().copied();
        let known = |(number, id)| Some((number, id, model.find_element(id)?));
        for (number, id, element) in all.into_iter().flatten().chain(listed).enumerate().filter_map(known) {
            let known = places.iter().rev().find(|(physics, _)| physics.is_same(&element.physics));
            let place = match known {
                Some(&(_, place)) => place,
                None => {
                    let mut place = None;
                    if let Some(own) = part.quantity.record(&element.physics) {
                        let mut own = own?;
                        own.share_arguments(self.parameters.len());
                        let nodes = element.nodes.iter().map(|&node| model.node(node).dofs.len());
                        // equal recordings of unlike elements are one formula
                        let is_like = |batch: &GroupBatch| {
                            let as_long = batch.members[0].nodes.iter().map(Range::len).eq(nodes.clone());
                            Arc::ptr_eq(&batch.own.formula, &own.formula) && batch.own.arguments == own.arguments && as_long
                        };
                        let like = batches.iter().position(is_like);
                        place = Some(like.unwrap_or(batches.len()));
                        if like.is_none() {
                            let (members, places) = (Vec::new(), MemberPlaces::default());
                            batches.push(GroupBatch { own, members, places, programs: Default::default() });
                        }
                    }
                    places.push((&element.physics, place));
                    place
                }
            };
            if let Some(place) = place {
                let nodes = element.nodes.iter().map(|&node| model.node(node).dofs.clone()).collect();
                let (parameters, own) = (element.parameters.clone(), part.of_element(number));
                batches[place].members.push(GroupMember { element: id, nodes, parameters, own });
            }
        }
        Ok(())
    }

    fn batches(&self, model: &Model) -> &[GroupBatch] {
        let (identity, batches) = self.recorded(model);
        assert!(
            *identity == model.identity(),
            "a quantity that was measured in one model is measured in another one: make it anew"
        );
        batches.as_ref().unwrap_or_else(|why| panic!("a quantity that was not checked before a run: {why}"))
    }

    /// What is measured, and in which elements.
    pub(super) fn law(&self, model: &Model) -> Digest {
        let mut digest = Digest::of(&self.parameters);
        for batch in self.batches(model) {
            let members: Vec<usize> = batch.members.iter().map(|member| member.element.0).collect();
            let GroupFormula { formula, values, weights, .. } = &batch.own;
            (members, formula.digest(), values, weights).hash(&mut digest);
            batch.members.iter().filter(|member| !member.own.is_empty()).for_each(|member| member.own.hash(&mut digest));
        }
        digest
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
        let GroupWork { batch: work, values } = work;
        values.clear();
        for batch in self.batches(model) {
            let weighted = points == PointWeights::Own && !batch.own.weights.is_empty();
            let ValueProgram { program, arguments } = batch.program(weighted);
            let count = batch.own.values.len();
            run_lanes(
                program,
                batch.members.len(),
                work,
                |mut lanes| arguments.gather(&batch.places, sample, p, &mut lanes),
                |results| {
                    results.for_each_part(|_, own| {
                        let first = values.len();
                        values.extend(own.clone().take(count).map(|value| [value, S::one()]));
                        if weighted {
                            values[first..].iter_mut().zip(own.skip(count)).for_each(|(point, weight)| point[1] = weight);
                        }
                    });
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
        let all = self.point_values(model, sample, p).into_iter();
        all.map(|(element, values)| (element, values.into_iter().reduce(larger).unwrap_or(f64::NAN))).collect()
    }

    /// What it is at all points of each element that has it, at a sample.
    pub fn point_values(&self, model: &Model, sample: &Sample<f64>, p: &[f64]) -> Vec<(ElementId, Vec<f64>)> {
        let mut work = GroupWork::default();
        self.write_values(model, sample, p, PointWeights::Equal, &mut work);
        let mut values = work.values.iter().map(|&[value, _]| value);
        let mut all = Vec::new();
        for batch in self.batches(model) {
            for member in &batch.members {
                all.push((member.element, values.by_ref().take(batch.own.values.len()).collect()));
            }
        }
        all
    }

    /// The element to which the value at a place of [`GroupWork::values`] belongs.
    pub(super) fn element_of(&self, model: &Model, mut place: usize) -> Option<ElementId> {
        for batch in self.batches(model) {
            let own = batch.own.values.len();
            match batch.members.get(place / own.max(1)) {
                Some(member) => return Some(member.element),
                None => place -= batch.members.len() * own,
            }
        }
        None
    }

    /// What gives the gradient of what these values add to the sums of a functional, towards the state and some parameters.
    pub(super) fn gradient(&self, model: &Model, over: &Over, active: &[bool]) -> GroupGradient {
        let (mut selections, mut chosen): (Vec<Selection>, Vec<Vec<GroupMember>>) = Default::default();
        let of_quantity = &active[self.parameters.clone()];
        for batch in self.batches(model) {
            let mut places: HashMap<[&[bool]; 2], usize> = HashMap::new();
            for member in &batch.members {
                let asked = [&active[member.parameters.clone()], &active[member.own.clone()]];
                let place = *places.entry(asked).or_insert_with(|| {
                    let program = batch.gradient(over, asked, of_quantity);
                    let arguments = read_arguments(&program, &batch.own.arguments, &batch.places);
                    let labels = program.labels().iter().map(|&label| batch.own.arguments[label as usize]);
                    let results = Numbers::of(labels.enumerate(), &batch.places);
                    chosen.push(Vec::new());
                    let (extra, places) = (batch.own.arguments.len(), MemberPlaces::default());
                    selections.push(Selection { program, arguments, results, extra, count: 0, places });
                    selections.len() - 1
                });
                chosen[place].push(member.clone());
            }
        }
        for (selection, members) in selections.iter_mut().zip(&chosen) {
            selection.count = members.len();
            selection.places = MemberPlaces::of(members, &self.parameters);
        }
        GroupGradient { selections, work: BatchWork::shared() }
    }
}

impl GroupBatch {
    /// The values, and then their weights if these are asked for.
    fn program(&self, weighted: bool) -> &ValueProgram {
        self.programs[usize::from(weighted)].get_or_init(|| {
            let GroupFormula { formula, arguments, values, weights } = &self.own;
            let weights = if weighted { &weights[..] } else { &[] };
            let chosen: Codes = values.iter().chain(weights).map(|&result| result as u32).collect();
            let key = ("point values", chosen.clone());
            let program = formula
                .dense_program(key, 0, |_, _, outputs| chosen.iter().map(|&result| outputs[result as usize]).collect());
            ValueProgram { arguments: read_arguments(&program, arguments, &self.places), program }
        })
    }

    /// Gradient of bar . (N, D, M) of one element, towards its state, those of its parameters and of the quantity's for it that are `asked`
    /// for, and those `of_quantity`. Behind the arguments: bar, and the offset.
    fn gradient(&self, over: &Over, [asked, of_element]: [&[bool]; 2], of_quantity: &[bool]) -> Arc<Program> {
        let GroupFormula { formula, arguments, values, weights } = &self.own;
        let flags = |flags: &[bool]| -> Vec<u32> {
            let word = |own: &[bool]| own.iter().fold(1, |word: u32, &flag| 2 * word + u32::from(flag));
            flags.chunks(31).map(word).collect()
        };
        let aggregate = over.aggregate().map_or([0; 4], |aggregate| {
            let bits = aggregate.sharpness.to_bits();
            let squared = u32::from(aggregate.kind.is_squared());
            let induced = [AggregateKind::Exponential, AggregateKind::SquaredExponential];
            let smooth = u32::from(!aggregate.kind.is_power() && !induced.contains(&aggregate.kind));
            let kind = 1 + u32::from(aggregate.kind.is_power()) + 2 * squared + 4 * smooth;
            [kind, u32::from(aggregate.points == PointWeights::Own), bits as u32, (bits >> 32) as u32]
        });
        let results = values.iter().chain(weights).map(|&result| result as u32);
        let all_flags = [asked, of_quantity, of_element].into_iter().flat_map(flags);
        let code: Codes = all_flags.chain(aggregate).chain(results).collect();
        let weights = if over.points() == PointWeights::Own { &weights[..] } else { &[] };
        formula.sparse_program(("point gradient", code), SUMS + 1, |graph, inputs, outputs| {
            let chosen = values.iter().chain(weights).map(|&result| outputs[result]);
            let all: Vec<_> = chosen.chain(inputs[arguments.len()..].iter().copied()).collect();
            let sum = continued(graph, &all, |x| {
                let (points, rest) = x.split_at(values.len() + weights.len());
                let (y, w) = points.split_at(values.len());
                let (seeds, offset) = rest.split_at(SUMS);
                let mut sum = Recorded::from(0.0);
                for (place, &y) in y.iter().enumerate() {
                    let weight = w.get(place).copied().unwrap_or(Recorded::from(1.0));
                    let terms = over.terms(y, weight, offset[0]);
                    sum = terms.into_iter().zip(seeds).fold(sum, |sum, (term, &bar)| sum + term * bar);
                }
                vec![sum]
            });
            let is_asked = |argument: &Argument| match *argument {
                Argument::A(_) | Argument::V(_) | Argument::Q(_) => true,
                Argument::Parameter(place) => asked[place],
                Argument::Own(place) => of_quantity[place],
                Argument::OfElement(place) => of_element[place],
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

/// The arguments that a program reads.
fn read_arguments(program: &Program, arguments: &[Argument], places: &MemberPlaces) -> Numbers {
    let reads = program.reads();
    Numbers::of(arguments.iter().copied().enumerate().filter(|&(place, _)| reads[place]), places)
}

/// Elements with the same formula and the same parameters asked for.
struct Selection {
    program: Arc<Program>,
    arguments: Numbers,
    /// What the results are derivatives towards.
    results: Numbers,
    /// Place of what the program takes beside the formula's arguments.
    extra: usize,
    /// How many they are.
    count: usize,
    places: MemberPlaces,
}

/// Gives gradients of the sums of a functional over a group.
pub(super) struct GroupGradient {
    selections: Vec<Selection>,
    work: BatchWork<f64>,
}

impl GroupGradient {
    /// Adds the gradient of seeds . (N, D, M) at a sample, with the offset of these sums.
    pub fn add(
        &mut self,
        sample: &Sample<f64>,
        p: &[f64],
        (seeds, offset): ([f64; SUMS], f64),
        at_bar: &mut VectorsAvq<f64>,
        p_bar: &mut [f64],
    ) {
        let GroupGradient { selections, work } = self;
        for Selection { program, arguments, results, extra, count, places } in selections {
            run_lanes(
                program,
                *count,
                work,
                |mut lanes| {
                    arguments.gather(places, sample, p, &mut lanes);
                    lanes.spread_at(*extra, &seeds);
                    lanes.spread_at(*extra + SUMS, &[offset]);
                },
                |lanes| results.add(places, &lanes, at_bar, p_bar),
            );
        }
    }
}
