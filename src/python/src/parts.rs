//! Elements, joints and quantities that Python describes: their keys, and tapes of their formulas.

use crate::errors::scene_error;
use crate::tape::Tape;
use costate::elements::entries::{Example, Form, Given, Key, MadeEntry, Range, Type, need};
use costate::internals::Replay;
use costate::prelude::*;
use costate::scenes::file::OwnParts;
use pyo3::PyResult;
use serde::Deserialize;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::{Arc, Mutex, PoisonError};

/// A part as `costate.parts` describes it.
#[derive(Clone, Debug, Deserialize)]
pub struct Description {
    pub kind: Kind,
    name: String,
    doc: String,
    nodes: Vec<String>,
    parameters: Vec<Number>,
    /// Number of equations of a joint.
    #[serde(default)]
    equations: usize,
    /// Number of strains of an element.
    #[serde(default)]
    strains: usize,
    /// Unit of a quantity.
    #[serde(default)]
    unit: String,
    #[serde(default)]
    formulas: HashMap<String, Tape>,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Element,
    Constraint,
    Quantity,
}

/// A parameter.
#[derive(Clone, Debug, Deserialize)]
struct Number {
    name: String,
    unit: String,
    doc: String,
    range: Allowed,
    #[serde(default)]
    is_size: bool,
    /// Of a point, which is three numbers in the frame of a node: which node.
    #[serde(default)]
    point_of: Option<usize>,
}

impl Number {
    fn parameters(&self) -> Vec<Parameter> {
        if self.point_of.is_some() {
            return ["x", "y", "z"].map(|axis| Parameter::new(kept(&format!("{} {axis}", self.name)), "m")).to_vec();
        }
        let (name, unit) = (kept(&self.name), kept(&self.unit));
        let parameter = match self.range {
            Allowed::Any => Parameter::new(name, unit),
            Allowed::Positive => Parameter::positive(name, unit),
            Allowed::AtLeastZero => Parameter::non_negative(name, unit),
        };
        vec![if self.is_size { parameter.as_size() } else { parameter }]
    }

    fn key(&self) -> Key {
        let range = match self.range {
            Allowed::Any => Range::Any,
            Allowed::Positive => Range::Positive,
            Allowed::AtLeastZero => Range::AtLeastZero,
        };
        let kind = if self.point_of.is_some() { Type::Vector("m") } else { Type::Number(kept(&self.unit), range) };
        need(kept(&self.name), kind, kept(&self.doc))
    }

    fn values<S: Scalar>(&self, key: &'static str, given: &mut Given<S>) -> Vec<S> {
        let Some(node) = self.point_of else { return vec![given.number(key)] };
        let place = given.point(key, node);
        given.node(node).local_point(place).components().to_vec()
    }
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Allowed {
    Any,
    Positive,
    AtLeastZero,
}

/// A part that is ready for scene files: its texts stay for the life of the program, each description once.
pub struct Part {
    description: Description,
    formulas: HashMap<String, Replay>,
    kinds: &'static [NodeKind],
    parameters: Vec<Parameter>,
    form: Form,
    unit: &'static str,
}

/// An element, joint or quantity of a scene, and the entry that makes it.
#[derive(Clone)]
pub struct Law(Arc<Part>);

impl Law {
    /// Kinds of its nodes.
    pub fn kinds(&self) -> &[NodeKind] {
        self.0.kinds
    }

    /// What it is.
    pub fn kind(&self) -> Kind {
        self.0.description.kind
    }
}

// no part is dropped, so that none has the place of another one
impl Hash for Law {
    fn hash<H: Hasher>(&self, state: &mut H) {
        Arc::as_ptr(&self.0).hash(state);
    }
}

/// A text that stays.
fn kept(text: &str) -> &'static str {
    Box::leak(text.into())
}

fn node_kind(word: &str) -> Result<NodeKind, String> {
    match word {
        "point" => Ok(NodeKind::Point),
        "body" => Ok(NodeKind::Body),
        "natural" => Ok(NodeKind::Natural),
        "cable" => Ok(NodeKind::Slope),
        "coordinate" => Ok(NodeKind::Coordinates(1)),
        "state" => Ok(NodeKind::States(1)),
        _ => Err(format!(
            "there are no nodes \"{word}\"; take \"point\", \"body\", \"natural\", \"cable\", \"coordinate\" or \"state\""
        )),
    }
}

impl Description {
    fn made(self) -> Result<Part, String> {
        let kinds = self.nodes.iter().map(|word| node_kind(word)).collect::<Result<Vec<_>, _>>()?;
        let formulas = self.recorded(kinds.iter().map(|kind| kind.dofs()).sum())?;
        let nodes = match kinds.len() {
            1 => need("on", Type::Node, "node"),
            count => need("between", Type::List(&Type::Node, count, count), "its nodes"),
        };
        let keys: Vec<Key> = [nodes].into_iter().chain(self.parameters.iter().map(Number::key)).collect();
        let form = Form { name: kept(&self.name), doc: kept(&self.doc), keys: Box::leak(keys.into()) };
        let parameters = self.parameters.iter().flat_map(Number::parameters).collect();
        let unit = kept(&self.unit);
        Ok(Part { kinds: Box::leak(kinds.into()), formulas, parameters, form, unit, description: self })
    }

    /// All formulas, each with the arguments and results that its name says.
    fn recorded(&self, n: usize) -> Result<HashMap<String, Replay>, String> {
        let (strains, m) =
            (self.strains, self.parameters.iter().map(|own| if own.point_of.is_some() { 3 } else { 1 }).sum::<usize>());
        if let Some(own) = self.parameters.iter().find(|own| own.point_of.is_some_and(|node| node >= self.nodes.len())) {
            return Err(format!("{} of \"{}\" is a point of a node that it has not", own.name, self.name));
        }
        let recorded = |(name, tape): (&String, &Tape)| {
            let (arguments, results) = match (self.kind, name.as_str()) {
                (Kind::Element, "residual") => (3 * n + m + 1, n),
                (Kind::Element, "interpolated") => (3 * n, tape.count()),
                (Kind::Element, "kinetic") => (2 * n + m, 1),
                (Kind::Element, "potential" | "strain_energy") => (n + m, 1),
                (Kind::Element, "force") => (2 * n + m + 1, n),
                (Kind::Element, "strains") => (n + m + 1, strains),
                (Kind::Element, "stored") => (strains + m, 1),
                (Kind::Element, "damping") => (2 * strains + m + 1, strains),
                (Kind::Element, "dissipation") => (2 * strains + m, 1),
                (Kind::Element, "mass") => (m, 1),
                (Kind::Constraint, "g") => (n + m + 1, self.equations),
                (Kind::Quantity, "value") => (3 * n + m + 1, 1),
                _ => return Err(format!("\"{}\" has no formula {name}", self.name)),
            };
            let own = tape.recorded(arguments, results).map_err(|why| format!("{name} of \"{}\": {why}", self.name))?;
            Ok((name.clone(), own))
        };
        self.formulas.iter().map(recorded).collect()
    }
}

impl Part {
    fn replay<S: Scalar>(&self, name: &str, arguments: &[&[S]]) -> Option<Vec<S>> {
        Some(self.formulas.get(name)?.values(&arguments.concat()))
    }

    fn number<S: Scalar>(&self, name: &str, arguments: &[&[S]]) -> S {
        self.replay(name, arguments).map_or_else(S::zero, |results| results[0])
    }

    fn write<S: Scalar>(&self, name: &str, arguments: &[&[S]], into: &mut [S]) {
        if let Some(results) = self.replay(name, arguments) {
            into.copy_from_slice(&results);
        }
    }

    /// Values of the parameters; nodes must be of the kinds that the formulas were recorded for.
    fn numbers<S: Scalar>(&self, given: &mut Given<S>) -> Vec<S> {
        for (place, kind) in self.kinds.iter().enumerate() {
            let own = given.node(place).kind;
            if own != *kind {
                let text = format!(
                    "\"{}\" needs {} as its node {}, and \"{}\" is {}",
                    given.owner(),
                    kind.words(),
                    place + 1,
                    given.name(place),
                    own.words()
                );
                given.wrong(text);
            }
        }
        let own = self.description.parameters.iter().zip(&self.form.keys[1..]);
        own.flat_map(|(own, key)| own.values(key.name, given)).collect()
    }
}

impl Element for Law {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.kinds.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters.clone()
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        match self.0.replay("residual", &[s.a, s.v, s.q, p, &[t]]) {
            Some(results) => r.copy_from_slice(&results),
            None => {
                // in the order in which elements of the library record them: sums of derivatives follow it
                self.0.replay("interpolated", &[s.a, s.v, s.q]);
                S::from_energies();
            }
        }
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        self.0.number("kinetic", &[v, q, p])
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        self.0.number("potential", &[q, p])
    }
    fn strain_energy<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        self.0.number("strain_energy", &[q, p])
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        self.0.write("force", &[v, q, p, &[t]], force);
    }
    fn strain_count(&self) -> usize {
        self.0.description.strains
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], t: S, e: &mut [S]) {
        self.0.write("strains", &[q, p, &[t]], e);
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        self.0.number("stored", &[e, p])
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], t: S, s: &mut [S]) {
        self.0.write("damping", &[e, rate, p, &[t]], s);
    }
    fn dissipation<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S]) -> S {
        self.0.number("dissipation", &[e, rate, p])
    }
    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        self.0.number("mass", &[p])
    }
}

impl Constraint for Law {
    // of this instance there are as many as it says
    const EQUATIONS: usize = 0;
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.kinds.to_vec()
    }
    fn equations(&self) -> usize {
        self.0.description.equations
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters.clone()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        self.0.write("g", &[q, p, &[t]], g);
    }
}

impl Quantity for Law {
    fn dofs(&self) -> usize {
        self.0.kinds.iter().map(|kind| kind.dofs()).sum()
    }
    fn unit(&self) -> &'static str {
        self.0.unit
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters.clone()
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], t: S) -> S {
        self.0.number("value", &[s.a, s.v, s.q, p, &[t]])
    }
}

impl MadeEntry for Law {
    type Law = Self;
    fn form(&self) -> Form {
        self.0.form
    }
    fn example(&self) -> Example {
        (self.0.kinds, &[])
    }
    fn make<S: Scalar>(&self, given: &mut Given<S>) -> (Self, Vec<S>) {
        (self.clone(), self.0.numbers(given))
    }
}

/// The part of a description in JSON.
pub fn part(text: &str) -> PyResult<&'static Law> {
    static PARTS: Mutex<Option<HashMap<String, &'static Law>>> = Mutex::new(None);
    let mut parts = PARTS.lock().unwrap_or_else(PoisonError::into_inner);
    let parts = parts.get_or_insert_default();
    if let Some(own) = parts.get(text) {
        return Ok(own);
    }
    let description: Description = serde_json::from_str(text).map_err(|why| scene_error(format!("a part: {why}")))?;
    let own: &'static Law = Box::leak(Box::new(Law(Arc::new(description.made().map_err(scene_error)?))));
    parts.insert(text.into(), own);
    Ok(own)
}

/// Parts for the reader of scene files.
pub fn own_parts(texts: &[String]) -> PyResult<OwnParts> {
    texts.iter().try_fold(OwnParts::default(), |parts, text| {
        let own = part(text)?;
        Ok(match own.kind() {
            Kind::Element => parts.spring_by(own),
            Kind::Constraint => parts.joint_by(own),
            Kind::Quantity => parts.functional_by(own),
        })
    })
}
