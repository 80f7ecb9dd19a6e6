//! Elements, joints and functionals that a file gives as formulas of its nodes.

use super::build_parts::rates;
use super::expression::{Expression, Quantity};
use super::fields::{Fields, NamedNode, Value};
use super::formula_of::FormulaOf;
use super::known::{Builder, Found, Known, Made, fixed_list, kept, list, over, text};
use super::mistake::Mistake;
use super::state_entries::{MADE, keys_of};
use crate::assembly::NodeId;
use crate::elements::entries::Type;
use crate::elements::forces::Soft;
use crate::elements::{Constraint, Element, Frame, NodeKind, Parameter, State};
use crate::functionals;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::ops::Range;

/// What formulas know of a node: a name, whether it is a vector, whether it is a rate.
type OfNode = (&'static str, bool, bool);

const OF_POINT: &[OfNode] = &[("position", true, false), ("velocity", true, true)];
const OF_BODY: &[OfNode] = &[
    OF_POINT[0],
    OF_POINT[1],
    ("x_axis", true, false),
    ("y_axis", true, false),
    ("z_axis", true, false),
    ("angular_velocity", true, true),
];
const OF_COORDINATE: &[OfNode] = &[("value", false, false), ("rate", false, true)];

/// What formulas know of the nodes of a section.
pub(super) fn of_section(section: &str) -> &'static [OfNode] {
    match section {
        "point" | "cable" => OF_POINT,
        "coordinate" | "joint_angle" => OF_COORDINATE,
        // by the names of its values
        "state" => &[],
        _ => OF_BODY,
    }
}

/// A node as formulas know it.
#[derive(Clone, Copy)]
struct KnownNode {
    kind: NodeKind,
    /// Its rates are states.
    is_state: bool,
    /// Place, velocity and force are those of a point of it.
    has_point: bool,
}

impl KnownNode {
    /// Words of what formulas know of it, and whether that is a rate.
    fn known(self) -> Vec<(&'static str, bool)> {
        let of_node = match self.kind {
            NodeKind::Coordinates(count) if self.is_state => return vec![("state", true); count],
            NodeKind::Body | NodeKind::Natural => OF_BODY,
            NodeKind::Point | NodeKind::Slope => OF_POINT,
            NodeKind::Coordinates(_) => OF_COORDINATE,
        };
        of_node.iter().map(|(what, _, is_rate)| (*what, *is_rate)).collect()
    }
}

/// Formulas of nodes. Parameters: the points of nodes in their frames, where they have one, then those of each formula.
struct Formulas {
    nodes: Vec<KnownNode>,
    all: Vec<FormulaOf>,
    breakpoints: Vec<f64>,
}

impl Formulas {
    fn parameters(&self) -> Vec<Parameter> {
        let axes = ["x", "y", "z"];
        let points = (1..=self.points()).flat_map(|i| axes.map(|axis| Parameter::named(format!("point {i} {axis}"), "m")));
        let numbered = (1..).zip(&self.all);
        points.chain(numbered.flat_map(|(number, own)| own.numbers(&format!("formula {number}")))).collect()
    }
    /// How many nodes have a point.
    fn points(&self) -> usize {
        self.nodes.iter().filter(|node| node.has_point).count()
    }
    /// The point of a node in its frame.
    fn point<S: Scalar>(&self, node: usize, p: &[S]) -> Vector3<S> {
        match self.nodes[node].has_point {
            true => Vector3::first_three(&p[3 * self.nodes[..node].iter().filter(|node| node.has_point).count()..]),
            false => Vector3::zeros(),
        }
    }
    /// What formulas know of all nodes, and the time behind it.
    fn arguments<S: Scalar>(&self, [v, q]: [&[S]; 2], t: S, p: &[S]) -> Vec<Quantity<S>> {
        let mut all = Vec::new();
        for (node, &KnownNode { kind, is_state, .. }) in self.nodes.iter().enumerate() {
            let (v, q) = (&v[self.place(node)], &q[self.place(node)]);
            if let NodeKind::Coordinates(_) = kind {
                match is_state {
                    true => all.extend(v.iter().map(|&state| Quantity::Number(state))),
                    false => all.extend([Quantity::Number(q[0]), Quantity::Number(v[0])]),
                }
                continue;
            }
            let point = self.point(node, p);
            all.extend([kind.position(q, point), kind.velocity(v, q, point)].map(Quantity::Vector));
            if kind.has_axes() {
                all.extend(Frame::of(kind, q).axes.map(Quantity::Vector));
                all.push(Quantity::Vector(kind.angular_velocity(v, q)));
            }
        }
        all.push(Quantity::Number(t));
        all
    }
    fn kinds(&self) -> Vec<NodeKind> {
        self.nodes.iter().map(|node| node.kind).collect()
    }
    fn dofs(&self) -> usize {
        self.nodes.iter().map(|node| node.kind.dofs()).sum()
    }
    fn value<S: Scalar>(&self, which: usize, arguments: &[Quantity<S>], p: &[S]) -> Quantity<S> {
        let before: usize = self.all[..which].iter().map(FormulaOf::count).sum();
        self.all[which].at(arguments, &p[3 * self.points() + before..])
    }
    fn number<S: Scalar>(&self, which: usize, arguments: &[Quantity<S>], p: &[S]) -> S {
        match self.value(which, arguments, p) {
            Quantity::Number(own) => own,
            Quantity::Vector(_) => S::from(f64::NAN),
        }
    }
    /// Places of the coordinates of a node.
    fn place(&self, node: usize) -> Range<usize> {
        let first: usize = self.nodes[..node].iter().map(|node| node.kind.dofs()).sum();
        first..first + self.nodes[node].kind.dofs()
    }
    fn breakpoints<S: Scalar>(&self) -> Vec<S> {
        self.breakpoints.iter().map(|&time| S::from(time)).collect()
    }
}

/// An element by formulas: numbers of its energies among them, and of the loads on each node.
struct FormulaElement {
    formulas: Formulas,
    kinetic: Option<usize>,
    potential: Option<usize>,
    /// Node, whether it is a moment, number of the formula.
    loads: Vec<(usize, bool, usize)>,
}

impl Element for FormulaElement {
    fn nodes(&self) -> Vec<NodeKind> {
        self.formulas.kinds()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.formulas.parameters()
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let Some(which) = self.kinetic else { return S::zero() };
        self.formulas.number(which, &self.formulas.arguments([v, q], S::zero(), p), p)
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let Some(which) = self.potential else { return S::zero() };
        let still = vec![S::zero(); q.len()];
        self.formulas.number(which, &self.formulas.arguments([&still, q], S::zero(), p), p)
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        if self.loads.is_empty() {
            return;
        }
        let known = self.formulas.arguments([v, q], t, p);
        for &(node, is_moment, which) in &self.loads {
            let (kind, place) = (self.formulas.nodes[node].kind, self.formulas.place(node));
            let (q, force) = (&q[place.clone()], &mut force[place]);
            match self.formulas.value(which, &known, p) {
                Quantity::Number(own) => force[0] += own,
                Quantity::Vector(own) if is_moment => kind.add_moment(q, own, force),
                Quantity::Vector(own) => kind.add_force(q, self.formulas.point(node, p), own, force),
            }
        }
    }
    fn breakpoints<S: Scalar>(&self, _p: &[S]) -> Vec<S> {
        self.formulas.breakpoints()
    }
}

/// States of first order by formulas of their rates: R = dz/dt - f(z, nodes, t) on the last node, whose rates they are.
struct FormulaState(Formulas);

impl Element for FormulaState {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.kinds()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        let known = self.0.arguments([s.v, s.q], t, p);
        for (which, place) in self.0.place(self.0.nodes.len() - 1).enumerate() {
            r[place] += s.a[place] - self.0.number(which, &known, p);
        }
    }
    fn breakpoints<S: Scalar>(&self, _p: &[S]) -> Vec<S> {
        self.0.breakpoints()
    }
}

/// A joint by formulas that are zero.
struct FormulaJoint(Formulas);

/// Most equations of a joint by formulas.
const MOST_EQUATIONS: usize = 12;

impl Constraint for FormulaJoint {
    const EQUATIONS: usize = MOST_EQUATIONS;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.kinds()
    }
    fn equations(&self) -> usize {
        self.0.all.len()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        let still = vec![S::zero(); q.len()];
        let known = self.0.arguments([&still, q], t, p);
        g.iter_mut().enumerate().for_each(|(which, own)| *own = self.0.number(which, &known, p));
    }
    fn breakpoints<S: Scalar>(&self, _p: &[S]) -> Vec<S> {
        self.0.breakpoints()
    }
}

/// What is measured by a formula.
struct FormulaQuantity(Formulas, &'static str);

impl functionals::Quantity for FormulaQuantity {
    fn dofs(&self) -> usize {
        self.0.dofs()
    }
    fn unit(&self) -> &'static str {
        self.1
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], t: S) -> S {
        self.0.number(0, &self.0.arguments([s.v, s.q], t, p), p)
    }
}

/// The nodes of formulas, and the formulas as they are read.
struct Reading<'f, S> {
    known: &'f Known<'f, S>,
    names: Vec<&'f str>,
    nodes: Vec<NodeId>,
    formulas: Formulas,
    /// Breakpoints are given, and be it none.
    tells_breakpoints: bool,
    /// Parameters of points and formulas.
    p: Vec<S>,
}

impl<'f, S: Scalar> Reading<'f, S> {
    fn new(known: &'f Known<'f, S>, fields: &'f Fields, m: &mut Builder<S>) -> Found<Self> {
        let given: &[_] = match fields.get("nodes") {
            Some((_, Value::NamedNodes(given))) => given,
            _ => &[],
        };
        let _names_of_formulas = fields.get("define");
        let formulas = Formulas { nodes: Vec::new(), all: Vec::new(), breakpoints: fixed_list(fields, "breakpoints") };
        let tells_breakpoints = fields.get("breakpoints").is_some();
        let mut own = Reading { known, names: Vec::new(), nodes: Vec::new(), formulas, tells_breakpoints, p: Vec::new() };
        for NamedNode { name, at, place, point } in given {
            let [node] = known.nodes_at(*at, place, m)?[..] else {
                return Err(Mistake::new(*at, "one node is wanted"));
            };
            let kind = m.model.find_node(node).map(|own| own.kind);
            own.add(name, node, kind.ok_or_else(|| Mistake::new(*at, "this is no node"))?, m);
            if let Some(point) = point {
                own.add_point(*at, point, m)?;
            }
        }
        Ok(own)
    }

    fn add(&mut self, name: &'f str, node: NodeId, kind: NodeKind, m: &Builder<S>) {
        self.names.push(name);
        self.nodes.push(node);
        self.formulas.nodes.push(KnownNode { kind, is_state: m.model.states.contains(&node), has_point: false });
    }

    /// Takes a point of the last node.
    fn add_point(&mut self, at: usize, point: &Expression, m: &Builder<S>) -> Found<()> {
        if point.uses_from(self.known.names.len()) {
            return Err(Mistake::new(at, "a point is one of the start, which depends on the design alone"));
        }
        let (Some(node), Some(&id), Quantity::Vector(place)) =
            (self.formulas.nodes.last_mut(), self.nodes.last(), point.value(&self.known.names))
        else {
            return Ok(());
        };
        if !node.kind.has_axes() {
            return Err(Mistake::new(at, format!("this is {}, which has no points but itself", node.kind.words())));
        }
        node.has_point = true;
        self.p.extend(m.local_point(id, place).components());
        Ok(())
    }

    /// Takes a formula, which may depend on rates and on the time or not, and returns its number.
    fn take(&mut self, at: usize, formula: &Expression, [rates, time]: [bool; 2]) -> Found<usize> {
        let mut place = self.known.names.len();
        for (name, node) in self.names.iter().zip(&self.formulas.nodes) {
            for (what, is_rate) in node.known() {
                if is_rate && !rates && formula.uses(place) {
                    return Err(Mistake::new(at, format!("this depends on places alone: {name}.{what} cannot stand here")));
                }
                place += 1;
            }
        }
        if !time && formula.uses(place) {
            return Err(Mistake::new(at, "this cannot depend on the time t; a force can"));
        }
        if time && formula.chooses_by(place) && !self.tells_breakpoints {
            let text = "this chooses by abs, min, max or if_less and depends on t; give breakpoints, the times at which it jumps or bends, or [] if there are none";
            return Err(Mistake::new(at, text));
        }
        let (own, numbers) = FormulaOf::of(formula, &self.known.names, Vec::new());
        self.formulas.all.push(own);
        self.p.extend(numbers);
        Ok(self.formulas.all.len() - 1)
    }

    /// Takes the formula of a key, if it is given.
    fn take_key(&mut self, fields: &Fields, key: &str, may: [bool; 2]) -> Found<Option<usize>> {
        match fields.get(key) {
            Some((at, Value::Formula(formula, _))) => self.take(at, formula, may).map(Some),
            _ => Ok(None),
        }
    }
}

/// An element by its energies and loads.
pub(super) fn element<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let mut reading = Reading::new(known, fields, m)?;
    let kinetic = reading.take_key(fields, "kinetic", [true, false])?;
    let potential = reading.take_key(fields, "potential", [false, false])?;
    let mut loads = Vec::new();
    for (key, is_moment) in [("force", false), ("moment", true)] {
        let Some((_, Value::Formulas(given))) = fields.get(key) else { continue };
        for (of, at, formula) in given {
            let Some(node) = reading.names.iter().position(|name| name == of) else {
                return Err(Mistake::new(*at, format!("there is no \"{of}\" among the nodes")));
            };
            let KnownNode { kind, is_state, .. } = reading.formulas.nodes[node];
            if is_state {
                return Err(Mistake::new(*at, format!("\"{of}\" is a state: its own section says how it changes")));
            }
            let wants_vector = kind.in_space().is_some();
            if wants_vector != formula.is_vector || (is_moment && !kind.has_axes()) {
                let wanted = match (is_moment, wants_vector) {
                    (true, _) if !kind.has_axes() => "no moment",
                    (_, true) => "a vector",
                    _ => "a number",
                };
                return Err(Mistake::new(*at, format!("\"{of}\" is {}, which takes {wanted} here", kind.words())));
            }
            loads.push((node, is_moment, reading.take(*at, formula, [true, true])?));
        }
    }
    if kinetic.is_none() && potential.is_none() && loads.is_empty() {
        return Err(Mistake::new(fields.at, "an element needs kinetic, potential, force or moment"));
    }
    let Reading { nodes, formulas, p, .. } = reading;
    m.element(name, &nodes, FormulaElement { formulas, kinetic, potential, loads }, &p);
    Ok(Made::Nothing)
}

/// States by their start and their rates.
pub(super) fn state<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let named = |key: &str| match fields.get(key) {
        Some((_, Value::Formulas(given))) => given.as_slice(),
        _ => &[],
    };
    let [initial, rates] = if fields.form == "formula" { ["initial", "rate"] } else { MADE }.map(named);
    for key in keys_of(fields.form) {
        if let (Type::Number(..), Some((at, Value::Formula(formula, _)))) = (key.takes, fields.get(key.name)) {
            if formula.uses_from(known.names.len()) {
                return Err(Mistake::new(at, format!("{} must be a number of the design alone", key.name)));
            }
            known.number(fields, key.name)?;
        }
    }
    let mut start = Vec::new();
    for (value, at, formula) in initial {
        if formula.is_vector || formula.uses_from(known.names.len()) {
            return Err(Mistake::new(*at, format!("the start of {value} must be a number of the design alone")));
        }
        start.extend(formula.value(&known.names).components());
    }
    let mut reading = Reading::new(known, fields, m)?;
    let node = m.states(name, &start);
    reading.add("", node, NodeKind::Coordinates(start.len()), m);
    for (value, at, _) in initial {
        let Some((_, at, formula)) = rates.iter().find(|own| own.0 == *value) else {
            return Err(Mistake::new(*at, format!("{value} has a start, but no rate")));
        };
        if formula.is_vector {
            return Err(Mistake::new(*at, format!("the rate of {value} must be a number")));
        }
        reading.take(*at, formula, [true, true])?;
    }
    if let Some((other, at, _)) = rates.iter().find(|own| initial.iter().all(|value| value.0 != own.0)) {
        return Err(Mistake::new(*at, format!("{other} has a rate, but no start: give it one in initial")));
    }
    let Reading { nodes, formulas, p, .. } = reading;
    m.element(&format!("rates of {name}"), &nodes, FormulaState(formulas), &p);
    Ok(Made::Node(node))
}

/// A joint by its equations.
pub(super) fn joint<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let mut reading = Reading::new(known, fields, m)?;
    for (at, own) in list(fields, "equations") {
        let Value::Formula(formula, _) = own else { continue };
        reading.take(at, formula, [false, true])?;
    }
    let Reading { nodes, formulas, p, .. } = reading;
    let count = formulas.all.len();
    if count > MOST_EQUATIONS {
        return Err(Mistake::new(
            fields.at,
            format!("a joint has at most {MOST_EQUATIONS} equations, and these are {count}"),
        ));
    }
    Ok(match rates(known, fields)? {
        None => Made::Joint(m.constraint(name, &nodes, FormulaJoint(formulas), &p)),
        Some(own) if own.iter().any(|list| list.len() != count) => {
            let text = format!("there are {count} equations: give as many numbers for stiffness, and for damping or none");
            return Err(Mistake::new(fields.at, text));
        }
        Some([stiffness, damping]) => {
            m.element(name, &nodes, Soft(FormulaJoint(formulas)), &[stiffness, damping, p].concat());
            Made::SoftJoint
        }
    })
}

/// A functional by the formula of its quantity.
pub(super) fn functional<S: Scalar>(known: &Known<S>, name: &str, fields: &Fields, m: &mut Builder<S>) -> Found<Made<S>> {
    let mut reading = Reading::new(known, fields, m)?;
    reading.take_key(fields, "value", [true, true])?;
    let Reading { nodes, formulas, p, .. } = reading;
    let unit = kept(text(fields, "unit").unwrap_or("-"));
    m.functional(name, over(fields), (&nodes, &[]), FormulaQuantity(formulas, unit), &p);
    Ok(Made::Nothing)
}
