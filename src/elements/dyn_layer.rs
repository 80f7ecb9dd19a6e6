//! Elements and constraints with their types erased: what the framework sees of them are recorded formulas.

use super::at_rest::AtRest;
use super::joints::Surfaces;
use super::lagrangian::{
    self, ElementFormulas, Energies, impulse, is_linear_in, is_steady_in, power, residual, shorter_power_serves, sizes,
    strain_course, stress_deviation, stress_force, stresses, told,
};
use super::{Constraint, Element, Nonholonomic, NonholonomicConstraint, Output, Parameter, State};
use crate::elements::NodeKind;
use crate::program::ArgumentKind::{
    Acceleration, Coordinate, MeasureParameter, Parameter as OfPart, Strain, Time, Unread, Velocity, Weight,
};
use crate::program::{
    ArgumentKind, Codes, Digest, Formula, Graph, Node, Program, ProgramWork, Recorded, Stages, continued, gradient_of,
};
use crate::scalar::{Complex64, Scalar, SpatialVector, Tangents, Vector3};
use crate::tolerances::LONG_SUM;
use nalgebra::{DMatrix, DVector};
use num_dual::Derivative;
use std::any::Any;
use std::cell::RefCell;
use std::hash::{Hash, Hasher};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// A scalar in which whole simulations run.
pub trait RunScalar: Scalar {
    /// Number of derivative parts.
    const PARTS: usize;
    /// Derivative part `index`.
    fn part(&self, index: usize) -> f64;
    /// Adds to derivative part `index`.
    fn add_to_part(&mut self, index: usize, increment: f64);
    /// Adds to the value.
    fn add_to_value(&mut self, increment: f64);
    /// Calls `f` with lists of this thread for arguments and results, and a program's workspace; not inside itself.
    fn with_work<T>(f: impl FnOnce(&mut [Vec<Self>; 2], &mut ProgramWork<Self>) -> T) -> T;
    /// Elements that a program handles side by side.
    fn lanes() -> usize {
        1
    }
    /// Executes a program for one element.
    fn run(program: &Program, inputs: &[Self], outputs: &mut [Self], work: &mut ProgramWork<Self>) {
        program.run_in(inputs, outputs, work);
    }
    /// Number of sections in which a program is executed for several elements side by side.
    fn sections(_program: &Program) -> usize {
        1
    }
    /// Executes a section of it for as many as there are lanes, whose numbers lie side by side.
    fn run_section(program: &Program, _section: usize, inputs: &[Self], outputs: &mut [Self], work: &mut ProgramWork<Self>) {
        Self::run(program, inputs, outputs, work);
    }
}

/// A program's arguments, results and workspace, kept from one run to the next.
#[derive(Clone, Debug)]
pub struct FormulaWork<S> {
    inputs: Vec<S>,
    outputs: Vec<S>,
    program: ProgramWork<S>,
}

impl<S> Default for FormulaWork<S> {
    fn default() -> Self {
        FormulaWork { inputs: Vec::new(), outputs: Vec::new(), program: ProgramWork::default() }
    }
}

impl<S: RunScalar> FormulaWork<S> {
    /// Results of a program for its arguments.
    pub fn run(&mut self, program: &Program, inputs: impl Iterator<Item = S>) -> &[S] {
        self.inputs.clear();
        self.inputs.extend(inputs);
        self.outputs.clear();
        self.outputs.resize(program.outputs(), S::zero());
        S::run(program, &self.inputs, &mut self.outputs, &mut self.program);
        &self.outputs
    }
}

/// Lists and a workspace for each thread.
macro_rules! work_of_thread {
    ($scalar:ty) => {
        fn with_work<T>(f: impl FnOnce(&mut [Vec<Self>; 2], &mut ProgramWork<Self>) -> T) -> T {
            thread_local! {
                static WORK: RefCell<([Vec<$scalar>; 2], ProgramWork<$scalar>)> = RefCell::default();
            }
            WORK.with_borrow_mut(|(numbers, work)| f(numbers, work))
        }
    };
}

impl RunScalar for f64 {
    work_of_thread!(f64);
    const PARTS: usize = 0;
    fn part(&self, _index: usize) -> f64 {
        0.0
    }
    fn add_to_part(&mut self, _index: usize, _increment: f64) {}
    fn add_to_value(&mut self, increment: f64) {
        *self += increment;
    }
    fn lanes() -> usize {
        crate::program::lanes()
    }
    fn run(program: &Program, inputs: &[f64], outputs: &mut [f64], work: &mut ProgramWork<f64>) {
        program.run(inputs, outputs, work);
    }
    fn sections(program: &Program) -> usize {
        program.sections()
    }
    fn run_section(program: &Program, section: usize, inputs: &[f64], outputs: &mut [f64], work: &mut ProgramWork<f64>) {
        program.run_section(section, inputs, outputs, work);
    }
}

impl RunScalar for Complex64 {
    work_of_thread!(Complex64);
    const PARTS: usize = 1;
    fn part(&self, _index: usize) -> f64 {
        self.im
    }
    fn add_to_part(&mut self, _index: usize, increment: f64) {
        self.im += increment;
    }
    fn add_to_value(&mut self, increment: f64) {
        self.re += increment;
    }
}

impl RunScalar for Tangents {
    work_of_thread!(Tangents);
    const PARTS: usize = crate::scalar::TANGENTS;
    fn part(&self, index: usize) -> f64 {
        self.eps.0.map_or(0.0, |eps| eps[index])
    }
    fn add_to_part(&mut self, index: usize, increment: f64) {
        if increment != 0.0 {
            let mut eps = self.eps.0.unwrap_or_else(nalgebra::SVector::zeros);
            eps[index] += increment;
            self.eps = Derivative::some(eps);
        }
    }
    fn add_to_value(&mut self, increment: f64) {
        self.re += increment;
    }
}

/// A formula, or why there is none.
pub(super) type Recording = Result<Arc<Formula>, String>;

/// An element with its type erased; every [`Element`] is one.
pub trait AnyElement: ElementFormulas + Send + Sync {
    /// Path of its type, for checks that no type is forgotten.
    fn type_name(&self) -> &'static str;
    /// What its formulas are recorded of.
    fn origin(&self) -> Digest;
    /// Itself, for quantities of elements of one type.
    fn as_any(&self) -> &dyn Any;
}

impl<E: Element> AnyElement for E {
    fn type_name(&self) -> &'static str {
        std::any::type_name::<Self>()
    }
    fn origin(&self) -> Digest {
        Digest::of_typed(self)
    }
    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// A formula that is recorded of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum ElementFormula {
    /// R(a, v, q, p, t).
    Residual,
    /// w_P P + w_F F of (a, v, q, p, t, w_P, w_F), with the momentum P = dL/dv and the force F = dL/dq + Q.
    Impulse,
    /// Kinetic energy, potential energy with what is stored in strains, mass, and what is stored in strains, of (v, q, p).
    Energies,
    /// d(T + V)/dt - R . v of (a, v, q, p, t): the power of all that is not in its energies.
    Power,
    /// The moment of inertia about an axis through a point, of (q, p, point, axis).
    InertiaMoment,
    /// Strains, their rates and the outputs behind those of strains, of (v, q, p, t).
    Outputs,
    /// Stresses of (e, de/dt, p, t).
    Stresses,
    /// e(q_0), its change along d there, and e(q_1), of (q_0, d, q_1, p, t).
    StrainCourse,
    /// Stresses foreseen less stresses, s(e_0) + ds/de e' - s(e_1), of (e_0, e', e_1, p).
    StressDeviation,
    /// (de/dq)^T w of (a, v, q, p, t, w).
    StressForce,
}

/// Number of them.
const FORMULAS: usize = ElementFormula::StressForce as usize + 1;

/// Stresses apart from the coordinates that they follow from: a search keeps those that its last correction foresaw, until the strains
/// have come to them.
#[derive(Clone, Copy)]
pub struct StressFormulas<'e> {
    /// Number of strains.
    pub count: usize,
    /// e(q_0), its change along d there, and e(q_1), of (q_0, d, q_1, p, t).
    pub course: &'e Arc<Formula>,
    /// Stresses foreseen less stresses, s(e_0) + ds/de e' - s(e_1), of (e_0, e', e_1, p).
    pub deviation: &'e Arc<Formula>,
    /// (de/dq)^T w of (a, v, q, p, t, w).
    pub force: &'e Arc<Formula>,
}

/// The arguments of a formula, by how many there are of each kind, one behind the other.
pub(crate) fn split_arguments<const N: usize>(all: &[Recorded], counts: [usize; N]) -> [&[Recorded]; N] {
    let mut first = 0;
    counts.map(|count| {
        first += count;
        &all[first - count..first]
    })
}

/// Arguments of a residual: (a, v, q), parameters, time.
fn of_residual(n: usize, m: usize) -> [(ArgumentKind, usize); 5] {
    [(Acceleration, n), (Velocity, n), (Coordinate, n), (OfPart, m), (Time, 1)]
}

impl ElementFormula {
    /// Records it.
    fn record(self, element: &dyn ElementFormulas) -> Recording {
        let ((n, m), count) = (sizes(element), element.strain_count());
        match self {
            ElementFormula::Residual => Formula::record_in_stages(of_residual(n, m), |x| {
                let [a, v, q, p, t] = split_arguments(x, [n, n, n, m, 1]);
                residual(element, State { a, v, q }, p, t[0])
            }),
            ElementFormula::Impulse => record_impulse(element),
            ElementFormula::Energies => Formula::record([(Velocity, n), (Coordinate, n), (OfPart, m)], |x| {
                let [v, q, p] = split_arguments(x, [n, n, m]);
                let Energies { kinetic, potential, strain } = Energies::of(element, [v, q, p], Recorded::from(0.0));
                vec![kinetic, potential, element.mass(p), strain]
            }),
            ElementFormula::Power => {
                let is_short = shorter_power_serves(element);
                Formula::record(of_residual(n, m), |x| {
                    let [a, v, q, p, t] = split_arguments(x, [n, n, n, m, 1]);
                    let (short, whole) = power(element, State { a, v, q }, p, t[0]);
                    vec![if is_short { short } else { whole }]
                })
            }
            ElementFormula::InertiaMoment => record_inertia_moment(element),
            ElementFormula::Outputs => Formula::record([(Velocity, n), (Coordinate, n), (OfPart, m), (Time, 1)], |x| {
                let [v, q, p, t] = split_arguments(x, [n, n, m, 1]);
                told(element, [v, q, p], t[0])
            }),
            ElementFormula::Stresses => Formula::record([(Strain, 2 * count), (OfPart, m), (Time, 1)], |x| {
                let [e, rate, p, t] = split_arguments(x, [count, count, m, 1]);
                stresses(element, [e, rate, p], t[0])
            }),
            ElementFormula::StrainCourse => Formula::record([(Coordinate, 3 * n), (OfPart, m), (Time, 1)], |x| {
                let [from, d, to, p, t] = split_arguments(x, [n, n, n, m, 1]);
                strain_course(element, [from, d, to, p], t[0])
            }),
            ElementFormula::StressDeviation => Formula::record([(Strain, 3 * count), (OfPart, m)], |x| {
                let [start, change, end, p] = split_arguments(x, [count, count, count, m]);
                stress_deviation(element, [start, change, end], p)
            }),
            ElementFormula::StressForce => {
                let weights = [(Weight, count)];
                Formula::record([&of_residual(n, m)[..], &weights].concat(), |x| {
                    let [_, _, q, p, t, w] = split_arguments(x, [n, n, n, m, 1, count]);
                    stress_force(element, [q, p, w], t[0])
                })
            }
        }
    }
}

fn record_impulse(element: &dyn ElementFormulas) -> Recording {
    let (n, m) = sizes(element);
    let mut depends = false;
    let formula = Formula::record([&of_residual(n, m)[..], &[(Weight, 2)]].concat(), |x| {
        let [a, v, q, p, t, weights] = split_arguments(x, [n, n, n, m, 1, 2]);
        let own = impulse(element, State { a, v, q }, p, t[0], [weights[0], weights[1]]);
        depends = own.is_none();
        own.unwrap_or_default()
    });
    if depends {
        return Err(
            "it states no kinetic energy, and its mass matrix depends on its state: its momentum is not known".into()
        );
    }
    formula
}

fn record_inertia_moment(element: &dyn ElementFormulas) -> Recording {
    let (n, m) = sizes(element);
    Formula::record([(Coordinate, n), (OfPart, m), (MeasureParameter, 6)], |x| {
        let [q, p, point, axis] = split_arguments(x, [n, m, 3, 3]);
        let mut v = vec![Recorded::from(0.0); n];
        for (kind, dofs) in dofs_of_each(&element.node_kinds()) {
            kind.turn(&q[dofs.clone()], Vector3::first_three(point), Vector3::first_three(axis), &mut v[dofs]);
        }
        vec![element.kinetic(&v, q, p) * 2.0]
    })
}

/// Number of coordinates of some nodes.
pub(crate) fn dofs_of(nodes: &[NodeKind]) -> usize {
    nodes.iter().map(|kind| kind.dofs()).sum()
}

/// Each of some nodes with the places of its coordinates among those of all.
pub(crate) fn dofs_of_each(nodes: &[NodeKind]) -> impl Iterator<Item = (NodeKind, Range<usize>)> {
    nodes.iter().scan(0, |end, &kind| {
        *end += kind.dofs();
        Some((kind, *end - kind.dofs()..*end))
    })
}

/// An element of a model with its recordings, each made when it is first asked for, and once for all clones.
#[derive(Clone)]
pub struct ElementPhysics(Arc<ElementRecordings>);

/// An element and what was recorded of it.
struct ElementRecordings {
    own: Arc<dyn AnyElement>,
    origin: Digest,
    /// As an equilibrium and small motions about it see it, if it is that.
    at_rest: Option<AtRest>,
    dofs: usize,
    parameters: Vec<Parameter>,
    formulas: [OnceLock<Recording>; FORMULAS],
    inertia: OnceLock<Arc<Formula>>,
    has_energies: OnceLock<bool>,
    conservative: OnceLock<bool>,
}

impl Hash for ElementPhysics {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.origin().hash(state);
    }
}

/// The recording, which was checked before a run.
fn checked(recording: &Recording) -> &Arc<Formula> {
    recording.as_ref().unwrap_or_else(|why| panic!("an element or constraint that was not checked before a run: {why}"))
}

impl ElementPhysics {
    /// An element, recorded when that is first asked for.
    pub fn new(own: Arc<dyn AnyElement>) -> Self {
        let parameters = own.parameter_list();
        Self::of(own, None, parameters)
    }
    fn of(own: Arc<dyn AnyElement>, at_rest: Option<AtRest>, parameters: Vec<Parameter>) -> Self {
        ElementPhysics(Arc::new(ElementRecordings {
            dofs: dofs_of(&own.node_kinds()),
            origin: Digest::of(&(own.origin(), &at_rest)),
            own,
            at_rest,
            parameters,
            formulas: [const { OnceLock::new() }; FORMULAS],
            inertia: OnceLock::new(),
            has_energies: OnceLock::new(),
            conservative: OnceLock::new(),
        }))
    }
    /// An element as it is at rest, with these parameters behind its own.
    pub(super) fn at_rest(at_rest: AtRest, further: Vec<Parameter>) -> Self {
        let own = &at_rest.own.0;
        Self::of(Arc::clone(&own.own), Some(at_rest.clone()), [&own.parameters[..], &further].concat())
    }
    /// A formula, recorded when it is first asked for: all have the sides of the residual's switches among their arguments.
    pub(super) fn recorded(&self, what: ElementFormula) -> &Recording {
        self.0.formulas[what as usize].get_or_init(|| {
            Formula::once(&(self.origin(), what), || match &self.0.at_rest {
                Some(own) => own.record(what),
                None if what == ElementFormula::Residual => what.record(&*self.0.own)?.with_sides(),
                None => what.record(&*self.0.own)?.with_sides_unread(self.sides()),
            })
        })
    }

    /// What its formulas are recorded of.
    pub(crate) fn origin(&self) -> Digest {
        self.0.origin
    }

    /// Number of switches of its residual whose sides are told from outside, as numbers behind its parameters.
    pub(crate) fn sides(&self) -> usize {
        match &self.0.at_rest {
            Some(at_rest) => at_rest.own.sides(),
            None => self.recorded(ElementFormula::Residual).as_ref().map_or(0, |residual| residual.sides()),
        }
    }

    /// Path of its type.
    pub fn type_name(&self) -> &'static str {
        self.0.own.type_name()
    }
    /// Kinds of its nodes.
    pub(crate) fn node_kinds(&self) -> Vec<NodeKind> {
        self.0.own.node_kinds()
    }
    /// The element itself, if it is one of type `E`.
    pub fn downcast<E: 'static>(&self) -> Option<&E> {
        self.0.own.as_any().downcast_ref().filter(|_| self.0.at_rest.is_none())
    }
    /// Whether another one has the same recordings.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
    /// Number of coordinates.
    pub fn dof_count(&self) -> usize {
        self.0.dofs
    }
    /// Parameters with sides of switches behind them, which numbers decide where they are not told.
    pub(crate) fn with_sides<S: RunScalar>(&self, p: &[S]) -> Vec<S> {
        let mut all = p.to_vec();
        all.resize(self.parameter_count(), S::zero());
        all
    }
    /// Number of parameters, and of sides of switches behind them.
    pub fn parameter_count(&self) -> usize {
        self.0.parameters.len() + self.sides()
    }
    /// Its parameters.
    pub fn parameter_list(&self) -> Vec<Parameter> {
        self.0.parameters.clone()
    }
    /// Whether its energies are all that it has: whether its residual follows from them and from losses.
    pub fn has_energies(&self) -> bool {
        *self.0.has_energies.get_or_init(|| match &self.0.at_rest {
            None => lagrangian::has_energies(&*self.0.own),
            Some(at_rest) => !at_rest.turns() && at_rest.own.has_energies(),
        })
    }
    /// Whether nothing changes its energy but the motion: no force beside its energies, no losses, no time.
    pub fn is_conservative(&self) -> bool {
        *self.0.conservative.get_or_init(|| lagrangian::is_conservative(&*self.0.own))
    }
    /// Why its residual cannot be used, if so.
    pub fn residual_refused(&self) -> Option<&str> {
        self.recorded(ElementFormula::Residual).as_ref().err().map(String::as_str)
    }
    /// Why it has no momentum, if so.
    pub fn impulse_refused(&self) -> Option<&str> {
        self.recorded(ElementFormula::Impulse).as_ref().err().map(String::as_str)
    }
    /// What it does: its residual, or why it has none.
    pub(crate) fn law(&self) -> Digest {
        self.residual_refused().map_or_else(|| self.residual().digest(), Digest::of)
    }
    /// R(a, v, q, p, t).
    pub fn residual(&self) -> &Arc<Formula> {
        checked(self.recorded(ElementFormula::Residual))
    }
    /// dR/da a of (a, v, q, p, t): inertia forces alone, where R is linear in a.
    pub fn inertia(&self) -> &Arc<Formula> {
        self.0.inertia.get_or_init(|| {
            let residual = self.residual();
            let inertia = Formula::once(&("inertia", residual.digest()), || {
                Ok(residual.derived(|graph, x, outputs| {
                    let seeds: Vec<_> = x[..self.0.dofs].iter().map(|&a| (a, a)).collect();
                    graph.forward(outputs, &seeds)
                }))
            });
            inertia.unwrap_or_else(|why| unreachable!("what is derived of a residual is not refused: {why}"))
        })
    }
    /// Whether it has strains, whose stresses a search can relieve.
    pub fn has_strains(&self) -> bool {
        self.0.own.strain_count() > 0
    }
    /// Formulas of its stresses, if it has strains that can be recorded apart.
    pub fn stresses(&self) -> Option<StressFormulas<'_>> {
        let count = Some(self.0.own.strain_count()).filter(|count| *count > 0)?;
        let formula = |what| self.recorded(what).as_ref().ok();
        let (course, deviation) = (formula(ElementFormula::StrainCourse)?, formula(ElementFormula::StressDeviation)?);
        Some(StressFormulas { count, course, deviation, force: formula(ElementFormula::StressForce)? })
    }
    /// What histories tell of it; nothing where that cannot be recorded.
    pub fn outputs(&self) -> Vec<Output> {
        let own = self.0.own.output_list();
        if own.is_empty() || self.output_formulas().is_some() { own } else { Vec::new() }
    }
    fn output_formulas(&self) -> Option<[&Arc<Formula>; 2]> {
        let [told, stresses] =
            [ElementFormula::Outputs, ElementFormula::Stresses].map(|what| self.recorded(what).as_ref().ok());
        Some([told?, stresses?])
    }
    /// Its outputs at a state, in the order of their list.
    pub fn outputs_at(&self, [v, q]: [&[f64]; 2], p: &[f64], t: f64) -> Vec<f64> {
        let Some([told, stresses]) = self.output_formulas() else { return Vec::new() };
        let (mut work, p) = (FormulaWork::default(), &self.with_sides(p));
        let inputs = v.iter().chain(q).chain(p).chain([&t]).copied();
        let told = work.run(told.values(), inputs).to_vec();
        let count = stresses.outputs.len();
        let (of_strains, own) = told.split_at(2 * count);
        let stresses = work.run(stresses.values(), of_strains.iter().chain(p).chain([&t]).copied());
        let (e, rates) = of_strains.split_at(count);
        let of_strain = e.iter().zip(rates).zip(stresses).flat_map(|((e, rate), stress)| [*e, *rate, *stress]);
        of_strain.chain(own.iter().copied()).collect()
    }
    /// w_P P + w_F F of (a, v, q, p, t, w_P, w_F).
    pub fn impulse(&self) -> &Arc<Formula> {
        checked(self.recorded(ElementFormula::Impulse))
    }
    /// R(a, v, q, p, t).
    pub fn residual_at<S: RunScalar>(&self, s: State<S>, p: &[S], t: S) -> Vec<S> {
        self.evaluated(self.residual().values(), s, p, t)
    }
    /// dR/dt at a fixed state.
    pub fn time_rate(&self, s: State<f64>, p: &[f64], t: f64) -> Vec<f64> {
        let place = 3 * self.0.dofs + self.parameter_count();
        let program = self.residual().dense_program(("time rate", Codes::new()), 0, |graph, x, outputs| {
            let one = graph.constant(1.0);
            graph.forward(outputs, &[(x[place], one)])
        });
        self.evaluated(&program, s, p, t)
    }
    /// w_P P + w_F F.
    pub fn impulse_at<S: RunScalar>(&self, s: State<S>, p: &[S], t: S, [of_momentum, of_force]: [f64; 2]) -> Vec<S> {
        let weights = [S::from(of_momentum), S::from(of_force)];
        let p = &self.with_sides(p);
        let inputs = s.a.iter().chain(s.v).chain(s.q).chain(p).chain([&t]).chain(&weights).copied();
        FormulaWork::default().run(self.impulse().values(), inputs).to_vec()
    }
    fn evaluated<S: RunScalar>(&self, program: &Program, s: State<S>, p: &[S], t: S) -> Vec<S> {
        let p = &self.with_sides(p);
        let inputs = s.a.iter().chain(s.v).chain(s.q).chain(p).chain([&t]).copied();
        FormulaWork::default().run(program, inputs).to_vec()
    }
    /// Kinetic energy, potential energy, mass, and the part of the potential energy that is stored in strains.
    pub fn energies_at<S: RunScalar>(&self, v: &[S], q: &[S], p: &[S]) -> [S; 4] {
        let mut work = FormulaWork::default();
        let p = &self.with_sides(p);
        let energies = work.run(self.energies().values(), v.iter().chain(q).chain(p).copied());
        std::array::from_fn(|place| energies[place])
    }
    /// The same as a formula of (v, q, p).
    pub fn energies(&self) -> &Arc<Formula> {
        checked(self.recorded(ElementFormula::Energies))
    }
    /// d(T + V)/dt - R . v as a formula of (a, v, q, p, t) \[W\].
    pub fn power(&self) -> &Arc<Formula> {
        checked(self.recorded(ElementFormula::Power))
    }
    /// Twice the kinetic energy of a turn at 1 rad/s, as a formula of (q, p, point, axis): the moment of inertia about the axis [kg m2].
    pub fn inertia_moment(&self) -> &Arc<Formula> {
        checked(self.recorded(ElementFormula::InertiaMoment))
    }
}

/// A constraint with its type erased; every [`Constraint`] is one, and every [`Nonholonomic`].
pub trait AnyConstraint: Send + Sync {
    /// Path of its type, for checks that no type is forgotten.
    fn type_name(&self) -> &'static str {
        std::any::type_name::<Self>()
    }
    /// What its formula is recorded of.
    fn origin(&self) -> Digest;
    /// Kinds of its nodes.
    fn node_kinds(&self) -> Vec<NodeKind>;
    /// Number of equations.
    fn equation_count(&self) -> usize;
    /// Whether it restricts velocities only.
    fn is_nonholonomic(&self) -> bool;
    /// Whether it drives a motion.
    fn is_driver(&self) -> bool {
        false
    }
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// g or h of recorded numbers (v, q, p) and t.
    fn evaluate(&self, numbers: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded>;
    /// How its surfaces slip.
    fn surfaces(&self) -> Option<Surfaces> {
        None
    }
    /// Whether it has friction.
    fn has_friction(&self) -> bool {
        false
    }
    /// Forces of friction that follow its multipliers, of recorded numbers (v, q, mu, p) and t: one for each coordinate; none without friction.
    fn friction_forces(&self, _numbers: [&[Recorded]; 4], _t: Recorded) -> Vec<Recorded> {
        Vec::new()
    }
}

/// Arguments of g or h: (v, q), of which g reads no velocity, parameters, time.
fn of_constraint(constraint: &dyn AnyConstraint, has_friction: bool) -> [(ArgumentKind, usize); 4] {
    let (n, m) = (dofs_of(&constraint.node_kinds()), constraint.parameter_list().len());
    let rates = if constraint.is_nonholonomic() || has_friction { Velocity } else { Unread };
    [(rates, n), (Coordinate, n), (OfPart, m), (Time, 1)]
}

/// Records g or h as a function of (v, q, p, t), beside it forces of friction, which read multipliers where programs of constraints have them.
fn record(constraint: &dyn AnyConstraint, has_friction: bool) -> Recording {
    let (n, m) = (dofs_of(&constraint.node_kinds()), constraint.parameter_list().len());
    let mut linear = true;
    let formula = Formula::record_in_stages(of_constraint(constraint, has_friction), |x| {
        let [v, q, p, t] = split_arguments(x, [n, n, m, 1]);
        let equations = constraint.evaluate([v, q, p], t[0]);
        linear = !constraint.is_nonholonomic() || is_linear_in(&equations, v);
        let first = multipliers_behind(n, m);
        let mu: Vec<Recorded> = (first..first + equations.len()).map(Recorded::argument).collect();
        let friction = has_friction.then(|| constraint.friction_forces([v, q, &mu, p], t[0]));
        (equations, friction.map(|forces| Stages { numbers: Default::default(), forces }))
    })?;
    if linear { Ok(formula) } else { Err("its equations are not linear in the velocities".into()) }
}

impl<C: Constraint> AnyConstraint for C {
    fn origin(&self) -> Digest {
        Digest::of_typed(self)
    }
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.nodes()
    }
    fn equation_count(&self) -> usize {
        self.equations()
    }
    fn is_nonholonomic(&self) -> bool {
        false
    }
    fn is_driver(&self) -> bool {
        Constraint::is_driver(self)
    }
    fn surfaces(&self) -> Option<Surfaces> {
        Constraint::surfaces(self)
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn evaluate(&self, [_, q, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
        let mut g = vec![Recorded::from(0.0); self.equations()];
        self.g(q, p, t, &mut g);
        g
    }
}

impl<C: NonholonomicConstraint> AnyConstraint for Nonholonomic<C> {
    fn origin(&self) -> Digest {
        Digest::of_typed(self)
    }
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.0.nodes()
    }
    fn equation_count(&self) -> usize {
        C::EQUATIONS
    }
    fn is_nonholonomic(&self) -> bool {
        true
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn evaluate(&self, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
        let mut h = vec![Recorded::from(0.0); C::EQUATIONS];
        self.0.h(v, q, p, t, &mut h);
        h
    }
}

/// Place of the multipliers among the arguments of programs of a constraint with `n` coordinates and `m` parameters: behind (v, q, p, t, a).
pub fn multipliers_behind(n: usize, m: usize) -> usize {
    3 * n + m + 1
}

/// Derivatives of order 0, 1, 2 of some results along (q, v)' = (v, a), t' = 1.
pub fn motion_derivatives(graph: &mut Graph, outputs: &[Node], [a, v, q]: [&[Node]; 3], t: Node) -> [Vec<Node>; 3] {
    let one = graph.constant(1.0);
    let seeds: Vec<(Node, Node)> =
        q.iter().zip(v).chain(v.iter().zip(a)).map(|(&x, &rate)| (x, rate)).chain([(t, one)]).collect();
    let first = graph.forward(outputs, &seeds);
    let second = graph.forward(&first, &seeds);
    [outputs.to_vec(), first, second]
}

/// Corrections after which no place is found where a constraint holds.
const PLACING: usize = 50;

/// Numbers without a relation to each other, from 1/2 to 3/2: multiples of the golden section.
pub(crate) fn unrelated_numbers() -> impl Iterator<Item = f64> {
    (1..).map(|k: usize| 0.5 + (k as f64 * 0.618_033_988_749_894_9).fract())
}

/// A constraint of a model with its recording, made when it is first asked for, and once for all clones.
#[derive(Clone)]
pub struct ConstraintPhysics(Arc<ConstraintRecording>);

/// A constraint and what was recorded of it.
struct ConstraintRecording {
    own: Arc<dyn AnyConstraint>,
    dofs: usize,
    equations: usize,
    parameters: usize,
    /// Which parameters are lengths.
    lengths: Vec<usize>,
    has_friction: bool,
    formula: OnceLock<Recording>,
    is_balanced: OnceLock<bool>,
}

impl ConstraintPhysics {
    /// Whether it drives a motion.
    pub fn is_driver(&self) -> bool {
        self.0.own.is_driver()
    }

    /// A constraint, recorded when that is first asked for.
    pub fn new(own: Arc<dyn AnyConstraint>) -> Self {
        let (dofs, equations, list) = (dofs_of(&own.node_kinds()), own.equation_count(), own.parameter_list());
        let lengths = (0..list.len()).filter(|&place| list[place].unit == "m").collect();
        let (parameters, formula, is_balanced) = (list.len(), OnceLock::new(), OnceLock::new());
        let has_friction = own.has_friction();
        let recording =
            ConstraintRecording { own, dofs, equations, parameters, lengths, has_friction, formula, is_balanced };
        ConstraintPhysics(Arc::new(recording))
    }

    /// What it was made of.
    pub(crate) fn part(&self) -> Arc<dyn AnyConstraint> {
        Arc::clone(&self.0.own)
    }
    /// Path of its type.
    pub fn type_name(&self) -> &'static str {
        self.0.own.type_name()
    }
    /// Number of coordinates.
    pub fn dof_count(&self) -> usize {
        self.0.dofs
    }
    /// Number of equations.
    pub fn equation_count(&self) -> usize {
        self.0.equations
    }
    /// Number of parameters.
    pub fn parameter_count(&self) -> usize {
        self.0.parameters
    }
    /// Which of its parameters are lengths \[m\].
    pub(crate) fn lengths(&self) -> &[usize] {
        &self.0.lengths
    }
    /// Whether it restricts velocities only.
    pub fn is_nonholonomic(&self) -> bool {
        self.0.own.is_nonholonomic()
    }
    /// Its parameters.
    pub fn parameter_list(&self) -> Vec<Parameter> {
        self.0.own.parameter_list()
    }
    /// Why its formula cannot be used, if so.
    pub fn refused(&self) -> Option<&str> {
        self.recorded().as_ref().err().map(String::as_str)
    }
    /// What it does: its formula, or why it has none.
    pub(crate) fn law(&self) -> Digest {
        self.refused().map_or_else(|| self.formula().digest(), Digest::of)
    }
    /// g or h of (v, q, p, t).
    pub fn formula(&self) -> &Arc<Formula> {
        checked(self.recorded())
    }
    fn recorded(&self) -> &Recording {
        self.0.formula.get_or_init(|| Formula::once(&self.origin(), || record(&*self.0.own, self.0.has_friction)))
    }
    /// What its formula is recorded of.
    pub(crate) fn origin(&self) -> Digest {
        self.0.own.origin()
    }

    /// g with its first and second derivative along the motion; (0, h, dh/dt) for a nonholonomic constraint.
    pub fn motion<S: RunScalar>(&self, s: State<S>, p: &[S], t: S) -> Vec<[S; 3]> {
        let (n, m) = (self.0.dofs, self.0.parameters);
        let program = self.formula().dense_program(("motion", Codes::new()), n, |graph, x, outputs| {
            let (v, q, t, a) = (&x[..n], &x[n..2 * n], x[2 * n + m], &x[2 * n + m + 1..]);
            motion_derivatives(graph, outputs, [a, v, q], t).into_iter().flatten().collect()
        });
        let count = self.0.equations;
        let mut work = FormulaWork::default();
        let outputs = work.run(&program, s.v.iter().chain(s.q).chain(p).chain([&t]).chain(s.a).copied());
        let own = |row: usize| match self.is_nonholonomic() {
            false => [outputs[row], outputs[count + row], outputs[2 * count + row]],
            true => [S::zero(), outputs[row], outputs[count + row]],
        };
        (0..count).map(own).collect()
    }

    /// g, or h at no velocity.
    pub fn value<S: RunScalar>(&self, q: &[S], p: &[S], t: S) -> Vec<S> {
        self.value_in(q, p, t, &mut FormulaWork::default()).to_vec()
    }

    /// [`Self::value`] in a workspace.
    pub fn value_in<'w, S: RunScalar>(&self, q: &[S], p: &[S], t: S, work: &'w mut FormulaWork<S>) -> &'w [S] {
        let zeros = std::iter::repeat_n(S::zero(), self.0.dofs);
        work.run(self.formula().values(), zeros.chain(q.iter().chain(p).copied()).chain([t]))
    }

    /// Whether it has friction.
    pub fn has_friction(&self) -> bool {
        self.0.has_friction
    }

    /// Whether its reactions do no work on any motion that it allows: g(q, p) without time or friction.
    pub fn is_scleronomic(&self) -> bool {
        let mut is_steady = !self.is_nonholonomic() && !self.0.has_friction;
        let (n, m) = (self.0.dofs, self.0.parameters);
        let recorded = Formula::record(of_constraint(&*self.0.own, false), |x| {
            let [v, q, p, t] = split_arguments(x, [n, n, m, 1]);
            let equations = self.0.own.evaluate([v, q, p], t[0]);
            is_steady &= is_steady_in(&equations, t[0]);
            equations
        });
        is_steady && recorded.is_ok()
    }

    /// d(A^T mu)/dt and dg/dt at a fixed state.
    pub fn time_rates(&self, q: &[f64], mu: &[f64], p: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
        let (n, m) = (self.0.dofs, self.0.parameters);
        let towards = self.towards();
        let program = self.formula().dense_program(("time rates", Codes::new()), self.0.equations, |graph, x, outputs| {
            let one = graph.constant(1.0);
            let reaction = graph.reverse(outputs, &x[2 * n + m + 1..], &x[towards.clone()]);
            let all: Vec<Node> = reaction.iter().chain(outputs).copied().collect();
            graph.forward(&all, &[(x[2 * n + m], one)])
        });
        let zeros = std::iter::repeat_n(&0.0, n);
        let inputs = zeros.chain(q).chain(p).chain([&t]).chain(mu).copied();
        let mut outputs = FormulaWork::default().run(&program, inputs).to_vec();
        let gaps = outputs.split_off(n);
        (outputs, gaps)
    }

    /// A^T mu, or B^T mu for a nonholonomic constraint.
    pub fn reaction<S: RunScalar>(&self, q: &[S], mu: &[S], p: &[S], t: S) -> Vec<S> {
        self.reaction_in((q, p, t), mu, &mut FormulaWork::default()).to_vec()
    }

    /// [`Self::reaction`] in a workspace.
    pub fn reaction_in<'w, S: RunScalar>(
        &self,
        (q, p, t): (&[S], &[S], S),
        mu: &[S],
        work: &'w mut FormulaWork<S>,
    ) -> &'w [S] {
        let (towards, first) = (self.towards(), 2 * self.0.dofs + self.0.parameters + 1);
        let key = ("reaction", Codes::new());
        let program = self
            .formula()
            .dense_program(key, self.0.equations, |graph, x, outputs| graph.reverse(outputs, &x[first..], &x[towards]));
        let zeros = std::iter::repeat_n(S::zero(), self.0.dofs);
        work.run(&program, zeros.chain(q.iter().chain(p).copied()).chain([t]).chain(mu.iter().copied()))
    }

    /// Arguments by which the formula is differentiated for its reaction: coordinates, or velocities.
    fn towards(&self) -> Range<usize> {
        if self.is_nonholonomic() { 0..self.0.dofs } else { self.0.dofs..2 * self.0.dofs }
    }

    /// Rows A (or B), equations by coordinates.
    pub fn rows<S: RunScalar>(&self, q: &[S], p: &[S], t: S) -> Vec<S> {
        self.rows_in(q, p, t, &mut FormulaWork::default()).to_vec()
    }

    /// [`Self::rows`] in a workspace.
    pub fn rows_in<'w, S: RunScalar>(&self, q: &[S], p: &[S], t: S, work: &'w mut FormulaWork<S>) -> &'w [S] {
        let (n, towards) = (self.0.dofs, self.towards());
        let program = self.formula().dense_program(("rows", Codes::new()), 0, |graph, x, outputs| {
            let one = graph.constant(1.0);
            outputs.iter().flat_map(|&output| graph.reverse(&[output], &[one], &x[towards.clone()])).collect()
        });
        let zeros = std::iter::repeat_n(S::zero(), n);
        work.run(&program, zeros.chain(q.iter().chain(p).copied()).chain([t]))
    }

    /// Whether its reactions on all its nodes have no resultant: where it holds, no motion of these together, as of one rigid body, changes what
    /// it constrains. That is so of a formula or not, and looked at once in some place where it holds with parameters `p`. It counts as not
    /// so where none is found, and of nodes without a place in space.
    pub fn is_balanced(&self, p: &[f64]) -> bool {
        *self
            .0
            .is_balanced
            .get_or_init(|| self.is_in_space() && self.held_place(p).is_some_and(|q| self.is_free_to_move_at(&q, p)))
    }

    fn is_in_space(&self) -> bool {
        self.0.own.node_kinds().iter().all(|kind| kind.in_space().is_some())
    }

    /// Any coordinates at which it holds: corrected by Newton's method from numbers without a relation to each other.
    fn held_place(&self, p: &[f64]) -> Option<Vec<f64>> {
        let (kinds, mut q) = (self.0.own.node_kinds(), unrelated_numbers().take(self.0.dofs).collect::<Vec<f64>>());
        for _ in 0..PLACING {
            let mut rows = Vec::new();
            for (_, dofs) in dofs_of_each(&kinds).filter(|(kind, _)| *kind == NodeKind::Body) {
                // corrections turn: they do not change the length of Euler parameters
                let e = &mut q[dofs.clone()][3..];
                let length = e.iter().map(|e| e * e).sum::<f64>().sqrt();
                e.iter_mut().for_each(|e| *e /= length);
                let mut row = vec![0.0; self.0.dofs];
                row[dofs][3..].copy_from_slice(e);
                rows.extend(row);
            }
            let mut g = self.value(&q, p, 0.0);
            if g.iter().all(|g| g.abs() < LONG_SUM) {
                return Some(q);
            }
            g.splice(0..0, vec![0.0; rows.len() / self.0.dofs]);
            rows.extend(self.rows(&q, p, 0.0));
            if !rows.iter().chain(&g).all(|x| x.is_finite()) {
                return None;
            }
            let rows = DMatrix::from_row_slice(g.len(), self.0.dofs, &rows);
            let step = rows.svd(true, true).solve(&DVector::from_vec(g), LONG_SUM).ok()?;
            q.iter_mut().zip(&step).for_each(|(q, step)| *q -= step);
        }
        None
    }

    /// Whether all motions of its nodes together keep it, where it holds.
    fn is_free_to_move_at(&self, q: &[f64], p: &[f64]) -> bool {
        let rows = self.rows(q, p, 0.0);
        (0..6).all(|motion| {
            let along = Vector3::from([0, 1, 2].map(|k| f64::from(u8::from(k == motion % 3))));
            let mut v = vec![0.0; q.len()];
            for (kind, dofs) in dofs_of_each(&self.0.own.node_kinds()) {
                match motion {
                    0..3 => v[dofs][..3].copy_from_slice(&along.components()),
                    _ => kind.turn(&q[dofs.clone()], Vector3::zeros(), along, &mut v[dofs]),
                }
            }
            rows.chunks_exact(q.len().max(1)).all(|row| {
                let terms = || row.iter().zip(&v).map(|(row, v)| row * v);
                terms().sum::<f64>().abs() <= LONG_SUM.sqrt() * terms().map(f64::abs).sum::<f64>()
            })
        })
    }

    /// Gradient of (A^T mu) . x' towards q and towards all parameters, where the coordinates x of nodes of these kinds move along such
    /// numbers ([`NodeKind::movement`]).
    pub(crate) fn along_rows(
        &self,
        (q, p, t): (&[f64], &[f64], f64),
        mu: &[f64],
        (kinds, along): (&[NodeKind], &[f64]),
    ) -> (Vec<f64>, Vec<f64>) {
        let (n, m, count) = (self.0.dofs, self.0.parameters, self.0.equations);
        let first = 2 * n + m + 1;
        let (towards, extra) = (self.towards(), count + along.len());
        let codes: Codes = kinds
            .iter()
            .map(|kind| match kind {
                NodeKind::Body => 0,
                NodeKind::Natural => 1,
                other => 2 + other.dofs() as u32,
            })
            .collect();
        let program = self.formula().dense_program(("along rows", codes), extra, |graph, x, outputs| {
            let reaction = graph.reverse(outputs, &x[first..first + count], &x[towards.clone()]);
            let arguments = [&x[n..2 * n], &x[first + count..]].concat();
            let movement = continued(graph, &arguments, |arguments| {
                let (mut q, mut along) = arguments.split_at(n);
                let of_node = |kind: &NodeKind| {
                    let (own, rest) = (q.split_at(kind.dofs()), along.split_at(kind.forces()));
                    (q, along) = (own.1, rest.1);
                    kind.movement(own.0, rest.0)
                };
                kinds.iter().flat_map(of_node).collect()
            });
            let work = reaction.into_iter().zip(movement).fold(graph.zero(), |sum, (force, moved)| {
                let term = graph.mul(force, moved);
                graph.add(sum, term)
            });
            let one = graph.constant(1.0);
            graph.reverse(&[work], &[one], &x[n..2 * n + m])
        });
        let zeros = std::iter::repeat_n(&0.0, n);
        let inputs = zeros.chain(q).chain(p).chain([&t]).chain(mu).chain(along).copied();
        let mut outputs = FormulaWork::default().run(&program, inputs).to_vec();
        let of_p = outputs.split_off(n);
        (outputs, of_p)
    }

    /// Whether the reaction on one node depends on the coordinates of no other, for the numbers of coordinates of its nodes: read off the
    /// recording.
    pub fn is_separable(&self, nodes: &[usize]) -> bool {
        let (n, first) = (self.0.dofs, 2 * self.0.dofs + self.0.parameters + 1);
        if self.is_nonholonomic() || self.0.has_friction {
            return false;
        }
        self.formula().inspect(|graph, outputs| {
            let [q, mu] = [n..2 * n, first..first + outputs.len()]
                .map(|places| places.map(|place| graph.input(place)).collect::<Vec<Node>>());
            let reaction = graph.reverse(outputs, &mu, &q);
            let mut start = 0;
            nodes.iter().all(|&count| {
                let own = start..start + count;
                start += count;
                let reads = graph.reads(&reaction[own.clone()], 2 * n);
                (0..n).all(|dof| own.contains(&dof) || !reads[n + dof])
            })
        })
    }

    /// A^T mu, with what friction adds or without, in recorded numbers (v, q, mu, p) and t.
    pub(crate) fn recorded_reaction(
        &self,
        [v, q, mu, p]: [&[Recorded]; 4],
        t: Recorded,
        with_friction: bool,
    ) -> Vec<Recorded> {
        let equations = self.0.own.evaluate([v, q, p], t);
        let mut reaction = gradient_of(&equations, mu, if self.is_nonholonomic() { v } else { q });
        if with_friction && self.0.has_friction {
            let friction = self.0.own.friction_forces([v, q, mu, p], t);
            reaction.iter_mut().zip(friction).for_each(|(own, friction)| *own += friction);
        }
        reaction
    }
}

/// Erases types of this crate by functions that are compiled in it: scenes of other crates, generic over the scalar, then compile none
/// of their formulas again.
macro_rules! instantiate_here {
    (dyn $erased:path: $($type:ty),* $(,)?) => {$(
        impl From<$type> for Box<dyn $erased> {
            #[inline(never)]
            fn from(own: $type) -> Self {
                Box::new(own)
            }
        }
    )*};
}
pub(crate) use instantiate_here;
