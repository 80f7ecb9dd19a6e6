use super::batches::Batch;
use super::constraint_programs::{self, Asked, ConstraintPart};
use super::element_programs::{self, Force};
use super::evaluation::{BatchWork, run_lanes};
use super::gather_map::{GatherMap, Starts};
use super::inside_nodes::PRODUCTS;
use super::jacobian::numbers_of;
use super::lanes::{LaneResults, Run};
use super::node_programs;
use super::numbering::{DofMap, System};
use super::{Equations, Unknowns, VectorsAvq};
use crate::elements::RunScalar;
use crate::program::Program;
use crate::scalar::Scalar;
use std::collections::HashMap;
use std::sync::Arc;

/// Adjoint variables of one system: one number for each row of F and G.
#[derive(Clone, Debug, Default)]
pub struct Adjoints<S = f64> {
    /// Of F.
    pub f: Vec<S>,
    /// Of the scaled G.
    pub g: Vec<S>,
}

impl<S: Scalar> Adjoints<S> {
    /// Zeros for a system.
    pub fn zeros(system: &System) -> Self {
        let (dofs, rows) = (system.model.dofs, system.multipliers());
        let zeros = |count: usize| vec![S::zero(); count];
        Adjoints { f: zeros(dofs), g: zeros(rows) }
    }
}

impl Adjoints {
    /// Adds others.
    pub fn add(&mut self, other: &Self) {
        let Adjoints { f, g } = self;
        for (own, other) in [(f, &other.f), (g, &other.g)] {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += other);
        }
    }
}

/// Where products are taken.
#[derive(Clone, Copy)]
pub struct ProductPoint<'p, S = f64> {
    /// (a, v, q).
    pub at: &'p VectorsAvq<S>,
    /// Parameters.
    pub p: &'p [S],
    /// Time \[s\].
    pub t: f64,
}

/// Where products go, for one functional.
pub struct ProductSeeds<'b, S = f64> {
    /// Adjoint of a, v and q, one behind the other.
    pub avq: &'b mut [S],
    /// Adjoint of the parameters.
    pub p: &'b mut [S],
}

/// Parts of a batch with the same parameters that are asked for.
struct Selection {
    /// Number of the batch.
    batch: usize,
    /// Which parameters.
    asked: Vec<bool>,
    /// Parts.
    parts: Vec<usize>,
    /// Where their numbers stand, unless they are the whole batch.
    own: Option<GatherMap>,
    /// For one pair of functionals after the other.
    chosen: Vec<Chosen>,
    programs: HashMap<u32, ProductProgram>,
}

/// Parts of a selection whose adjoint variables are not all zero.
#[derive(Default)]
struct Chosen {
    /// Those of now.
    now: Vec<usize>,
    /// Some that were chosen before, and where their numbers stand.
    before: Vec<usize>,
    places: GatherMap,
}

impl Chosen {
    /// Chooses among so many parts; returns how many are, and where their numbers stand, given where those of all do.
    fn places<'p>(
        &'p mut self,
        all: &'p GatherMap,
        parts: usize,
        is_chosen: impl Fn(usize) -> bool,
    ) -> (usize, &'p GatherMap) {
        self.now.clear();
        self.now.extend((0..parts).filter(|&part| is_chosen(part)));
        if self.now.len() == parts {
            return (parts, all);
        }
        if self.now != self.before {
            self.places = all.of_chosen(&self.now);
            self.before.clone_from(&self.now);
        }
        (self.now.len(), &self.places)
    }
}

fn select<L>(batches: &[Batch<L>], all: &[DofMap], active: &[bool]) -> Vec<Selection> {
    let mut selections: Vec<Selection> = Vec::new();
    for (batch, of_batch) in batches.iter().enumerate() {
        let mut places: HashMap<&[bool], usize> = HashMap::new();
        // the parts of each selection by their places in the batch
        let mut members: Vec<Vec<usize>> = Vec::new();
        let first = selections.len();
        for (place, &part) in of_batch.parts.iter().enumerate() {
            let asked = &active[all[part].parameters.clone()];
            let selection = *places.entry(asked).or_insert(members.len());
            if selection == members.len() {
                let (own, chosen, programs) = (None, Vec::new(), HashMap::new());
                selections.push(Selection { batch, asked: asked.to_vec(), parts: Vec::new(), own, chosen, programs });
                members.push(Vec::new());
            }
            selections[first + selection].parts.push(part);
            members[selection].push(place);
        }
        if members.len() > 1 {
            let own = selections[first..].iter_mut().zip(&members);
            own.for_each(|(selection, members)| selection.own = Some(of_batch.places.of_chosen(members)));
        }
    }
    selections
}

/// What a result of a program is the derivative towards.
enum ProductArgument {
    /// A coordinate of the part, of a (0), v (1) or q (2).
    Coordinate(usize, usize),
    /// A parameter of the part.
    Parameter(usize),
}

/// Functionals whose products share what depends on the state alone.
const TOGETHER: usize = 2;

/// A program for some functionals, and where its results go.
struct ProductProgram {
    program: Arc<Program>,
    /// Results for one functional.
    count: usize,
    /// Those of them that belong to coordinates of (a, v, q).
    coordinates: Vec<Run>,
    /// Those that belong to parameters.
    parameters: Vec<Run>,
}

impl ProductProgram {
    /// For parts with such nodes, of a model with so many coordinates. Results are labelled by `size` times the number of the functional, and
    /// the number of an argument, of which `argument` tells what it is.
    fn new(
        program: Arc<Program>,
        size: usize,
        (dofs, nodes): (usize, &[Starts]),
        argument: impl Fn(usize) -> ProductArgument,
    ) -> Self {
        let labels = program.labels();
        let count = labels.partition_point(|&label| (label as usize) < size);
        let (own, others) = labels.split_at(count);
        let shifted = others.chunks(count.max(1)).zip(1..);
        let alike = |(labels, k): (&[u32], u32)| labels.iter().map(|label| label - k * size as u32).eq(own.iter().copied());
        assert!(shifted.into_iter().all(alike), "products for further functionals have the places of those for the first");
        let coordinates: Vec<(usize, usize)> =
            nodes.iter().enumerate().flat_map(|(node, starts)| (0..starts.length).map(move |place| (node, place))).collect();
        let (mut runs, mut parameters) = (Vec::new(), Vec::new());
        for (result, &label) in own.iter().enumerate() {
            match argument(label as usize) {
                ProductArgument::Coordinate(vector, place) => {
                    let (node, place) = coordinates[place];
                    Run::extend(&mut runs, result, node, vector * dofs + place);
                }
                ProductArgument::Parameter(place) => Run::extend(&mut parameters, result, 0, place),
            }
        }
        ProductProgram { program, count, coordinates: runs, parameters }
    }

    /// Adds the results for some parts, times a factor.
    #[inline(always)]
    fn add<S: RunScalar>(&self, results: &LaneResults<S>, places: &GatherMap, factor: f64, seeds: &mut [ProductSeeds<S>]) {
        for (k, bar) in seeds.iter_mut().enumerate() {
            let first = k * self.count;
            results.add_runs(first, &self.coordinates, &places.nodes, factor, bar.avq);
            results.add_runs(first, &self.parameters, std::slice::from_ref(&places.parameters), factor, bar.p);
        }
    }
}

/// Products of adjoint variables with the derivatives of elements and constraints.
pub struct Products<S = f64> {
    /// By what elements add.
    elements: [Option<Vec<Selection>>; Force::KINDS],
    constraints: Option<Vec<Selection>>,
    active: Vec<bool>,
    work: BatchWork<S>,
    /// What constraints inside nodes add to (a, v, q), and to q where reactions act.
    inside_nodes: Vec<f64>,
}

impl<S: RunScalar> Products<S> {
    /// For parameters that depend on a design variable; the others get no derivative.
    pub fn new(active: &[bool]) -> Self {
        Products {
            elements: [const { None }; Force::KINDS],
            constraints: None,
            active: active.to_vec(),
            work: BatchWork::shared(),
            inside_nodes: Vec::new(),
        }
    }

    /// Adds `sign` times the gradient of lambda times what elements add to F, for every functional.
    pub fn add_elements(
        &mut self,
        system: &System,
        adjoints: &[Adjoints<S>],
        (force, sign): (Force, f64),
        ProductPoint { at, p, t }: ProductPoint<S>,
        seeds: &mut [ProductSeeds<S>],
    ) {
        let batches = system.element_batches(force);
        let Products { elements, active, work, .. } = self;
        let selections = elements[force.kind()].get_or_insert_with(|| select(batches, &system.element_parts, active));
        for Selection { batch, asked, parts, own, chosen, programs } in selections {
            let batch = &batches[*batch];
            let (layout, n) = (batch.layout, batch.layout.n);
            let all = own.as_ref().unwrap_or(&batch.places);
            chosen.resize_with(chosen.len().max(adjoints.len().div_ceil(TOGETHER)), Chosen::default);
            let pairs = adjoints.chunks(TOGETHER).zip(seeds.chunks_mut(TOGETHER));
            for ((adjoints, seeds), chosen) in pairs.zip(chosen) {
                let own = programs.entry(adjoints.len() as u32).or_insert_with(|| {
                    let program = element_programs::products(&batch.formula, layout, asked, adjoints.len());
                    ProductProgram::new(program, layout.t(), (system.model.dofs, &all.nodes), |place| match place {
                        place if place < 3 * n => ProductArgument::Coordinate(place / n, place % n),
                        place => ProductArgument::Parameter(place - layout.p()),
                    })
                });
                let weighs = |place: usize| adjoints.iter().any(|own| any(&system.element_parts[parts[place]], &own.f));
                let (count, places) = chosen.places(all, parts.len(), weighs);
                run_lanes(
                    &own.program,
                    count,
                    work,
                    |mut lanes| {
                        places.write_elements(&mut lanes, (at, p, t.into()), (force, S::one()));
                        adjoints.iter().for_each(|adjoint| lanes.gather_nodes(&places.nodes, [&adjoint.f]));
                    },
                    |results| own.add(&results, places, sign, seeds),
                );
            }
        }
    }

    /// Adds the gradient of lambda_F . A^T mu + lambda_G . G of all joints, for every functional.
    pub fn add_constraints(
        &mut self,
        system: &System,
        (equations, which): (&Equations, ConstraintPart),
        adjoints: &[Adjoints<S>],
        unknowns: &Unknowns<S>,
        ProductPoint { at, p, t }: ProductPoint<S>,
        seeds: &mut [ProductSeeds<S>],
    ) {
        let batches = system.constraint_batches();
        let Products { constraints, active, work, .. } = self;
        let selections = constraints.get_or_insert_with(|| select(batches, &system.constraint_parts, active));
        for Selection { batch, asked: parameters, parts, own, chosen, programs } in selections {
            let batch = &batches[*batch];
            let (physics, layout) = (system.constraint_of(batch), batch.layout);
            let ((asked, scale), factor) = (Asked::of(which, equations, physics), which.factor());
            let n = layout.n;
            let all = own.as_ref().unwrap_or(&batch.places);
            chosen.resize_with(chosen.len().max(adjoints.len().div_ceil(TOGETHER)), Chosen::default);
            let pairs = adjoints.chunks(TOGETHER).zip(seeds.chunks_mut(TOGETHER));
            for ((adjoints, seeds), chosen) in pairs.zip(chosen) {
                let code = asked.short_code([false; 3]) * (TOGETHER + 1) as u32 + adjoints.len() as u32;
                let own = programs.entry(code).or_insert_with(|| {
                    let program = constraint_programs::products(physics, asked, parameters, adjoints.len());
                    ProductProgram::new(program, layout.mu(), (system.model.dofs, &all.nodes), |place| match place {
                        place if place < 2 * n => ProductArgument::Coordinate(1 + place / n, place % n),
                        place if place < layout.t() => ProductArgument::Parameter(place - layout.p()),
                        place => ProductArgument::Coordinate(0, place - layout.a()),
                    })
                });
                let weighs = |adjoint: &Adjoints<S>, index: usize| {
                    let (part, rows) = (&system.constraint_parts[index], system.equations_of(index));
                    let equations = adjoint.g[rows].iter().any(|&value| value != S::zero());
                    (asked.reactions && any(part, &adjoint.f)) || (asked.equations.is_some() && equations)
                };
                let is_chosen = |place: usize| adjoints.iter().any(|adjoint| weighs(adjoint, parts[place]));
                let (count, places) = chosen.places(all, parts.len(), is_chosen);
                run_lanes(
                    &own.program,
                    count,
                    work,
                    |mut lanes| {
                        places.write_constraints(&mut lanes, (at, p, t.into()), &unknowns.mu, scale);
                        for adjoint in adjoints {
                            if asked.reactions {
                                lanes.gather_nodes(&places.nodes, [&adjoint.f]);
                            }
                            if asked.equations.is_some() {
                                lanes.gather(&places.multipliers, &adjoint.g);
                            }
                        }
                    },
                    |results| own.add(&results, places, factor, seeds),
                );
            }
        }
    }
}

/// Whether any number of a part's coordinates is not zero.
fn any<S: Scalar>(part: &DofMap, values: &[S]) -> bool {
    let nonzero = |own: &[S]| own.iter().any(|&value| value != S::zero());
    part.segments.iter().any(|dofs| values.get(dofs.clone()).is_some_and(nonzero))
}

/// What goes through the constraints inside nodes, for one functional.
pub struct NodeSeeds<'b> {
    /// Adjoint of the solution x of the system.
    pub x: &'b [f64],
    /// Adjoint variables.
    pub adjoints: &'b Adjoints,
    /// Products with the derivatives of elements towards a, v and q.
    pub elements: &'b [f64],
    /// The same of constraints, to which those inside nodes are added.
    pub constraints: &'b mut [f64],
    /// Where reactions add, if they act at another point than the equations hold.
    pub reactions: Option<&'b mut [f64]>,
}

impl Products {
    /// Adds the products with the reactions inside nodes, and those of the equations there, whose adjoints follow from what is left of the
    /// gradient with respect to each node's unknowns.
    pub fn add_inside_nodes(
        &mut self,
        system: &System,
        equations: &Equations,
        unknowns: &Unknowns<f64>,
        at: &VectorsAvq<f64>,
        functionals: &mut [NodeSeeds],
    ) {
        let (asked, scale) = Asked::inside(ConstraintPart::Both, equations);
        let parts_reactions = equations.parts_reactions();
        let code = PRODUCTS | asked.short_code([parts_reactions, false, false]);
        let rates = [equations.residual, equations.constraint].map(|shift| numbers_of(shift).0).concat();
        let all = system.model.dofs;
        let Products { work, inside_nodes, .. } = self;
        for batch in system.node_batches() {
            let (places, physics) = (&batch.places, system.constraint_inside(batch));
            let program =
                batch.programs.get(code, || node_programs::products(physics, batch.layout, asked, parts_reactions));
            for NodeSeeds { x, adjoints, elements, constraints, reactions } in &mut *functionals {
                inside_nodes.clear();
                inside_nodes.resize(4 * all, 0.0);
                run_lanes(
                    program,
                    batch.parts.len(),
                    work,
                    |mut lanes| {
                        lanes.skip(batch.formula.inputs);
                        places.write_constraints(&mut lanes, (at, &[], 0.0), &unknowns.local_mu, scale);
                        rates.iter().for_each(|&rate| lanes.spread(rate));
                        lanes.gather_nodes(&places.nodes, [&adjoints.f[..], x]);
                        for seeds in [elements, &**constraints] {
                            lanes.gather_nodes(&places.nodes, [&seeds[..all], &seeds[all..2 * all], &seeds[2 * all..]]);
                        }
                    },
                    |results| {
                        let mut place = 0;
                        for own in inside_nodes.chunks_exact_mut(all).take(if parts_reactions { 4 } else { 3 }) {
                            place = results.add_to_nodes(place, &places.nodes, 1.0, own);
                        }
                    },
                );
                let (own, of_reactions) = inside_nodes.split_at(3 * all);
                constraints.iter_mut().zip(own).for_each(|(bar, own)| *bar += own);
                let reactions = reactions.iter_mut().flat_map(|seeds| &mut seeds[2 * all..]);
                reactions.zip(of_reactions).for_each(|(bar, own)| *bar += own);
            }
        }
    }
}
