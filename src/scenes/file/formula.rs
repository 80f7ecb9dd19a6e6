//! Formulas: numbers and vectors of named ones. A text is recorded when it is read, and replayed for other numbers of any type.

use super::tables::NamedTable;
use crate::elements::{ForceLaw, Parameter, TimeFormula};
use crate::program::{Recorded, Replay};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::convert::Infallible;
use std::f64::consts::PI;
use std::hash::{Hash, Hasher};
use std::ops::Range;
use std::sync::Arc;

use Quantity::{Number, Vector};

/// A number or a vector of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quantity<S> {
    Number(S),
    Vector(Vector3<S>),
}

impl Hash for Quantity<f64> {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.components().into_iter().map(f64::to_bits).collect::<Vec<_>>().hash(state);
    }
}

impl<S: Scalar> Quantity<S> {
    /// Of its numbers, one or three.
    pub fn of(components: &[S]) -> Self {
        match components {
            [own] => Number(*own),
            own => Vector(Vector3::first_three(own)),
        }
    }
    pub fn is_vector(&self) -> bool {
        matches!(self, Vector(_))
    }
    pub fn components(&self) -> Vec<S> {
        match self {
            Number(own) => vec![*own],
            Vector(own) => own.components().to_vec(),
        }
    }
    /// The number that it is; that of a vector is none.
    pub fn number(&self) -> S {
        match self {
            Number(own) => *own,
            Vector(_) => S::from(f64::NAN),
        }
    }
    /// The vector that it is; that of a number is none.
    pub fn vector(&self) -> Vector3<S> {
        match self {
            Vector(own) => *own,
            Number(_) => Vector3::from_f64([f64::NAN; 3]),
        }
    }
}

/// The numbers that a formula takes while it is recorded, in the order in which it asks for them.
#[derive(Default)]
pub(super) struct Taken(Vec<usize>);

impl Taken {
    /// A number by its place among all that are known.
    pub fn number(&mut self, place: usize) -> Recorded {
        let own = self.0.iter().position(|own| *own == place).unwrap_or(self.0.len());
        if own == self.0.len() {
            self.0.push(place);
        }
        Recorded::argument(own)
    }
}

#[derive(Clone, Debug, Hash)]
pub(super) enum Formula {
    /// Always the same.
    Constant(Quantity<f64>),
    /// Of known numbers, by their places.
    Of { replay: Arc<Replay>, taken: Vec<usize>, is_vector: bool },
}

impl Formula {
    /// Records what is made of known numbers.
    pub fn record<E>(formula: impl FnOnce(&mut Taken) -> Result<Quantity<Recorded>, E>) -> Result<Self, E> {
        let mut taken = Taken::default();
        let (made, replay) = Replay::of(|| {
            let made = formula(&mut taken);
            let components = made.as_ref().map_or_else(|_| Vec::new(), Quantity::components);
            (made.map(|own| own.is_vector()), components)
        });
        let is_vector = made?;
        Ok(match replay.constants() {
            Some(components) => Formula::Constant(Quantity::of(&components)),
            None => Formula::Of { replay: Arc::new(replay), taken: taken.0, is_vector },
        })
    }

    pub fn literal(value: f64) -> Self {
        Formula::Constant(Number(value))
    }

    pub fn number(place: usize) -> Self {
        let Ok(number) = Formula::record(|taken| Ok::<_, Infallible>(Number(taken.number(place))));
        number
    }

    /// A vector of three formulas for its components.
    pub fn vector(components: &[Formula; 3]) -> Self {
        let Ok(vector) = Formula::record(|taken| {
            let numbers = components.each_ref().map(|own| own.value(|place| taken.number(place)).number());
            Ok::<_, Infallible>(Quantity::of(&numbers))
        });
        vector
    }

    /// Its value, if it is always the same.
    pub fn constant(&self) -> Option<Quantity<f64>> {
        match self {
            Formula::Constant(own) => Some(*own),
            Formula::Of { .. } => None,
        }
    }

    /// The number that it always is.
    pub fn constant_number(&self) -> Option<f64> {
        self.constant().filter(|own| !own.is_vector()).map(|own| own.number())
    }

    pub fn is_vector(&self) -> bool {
        match self {
            Formula::Constant(own) => own.is_vector(),
            Formula::Of { is_vector, .. } => *is_vector,
        }
    }

    /// Places of the numbers of which it is made.
    pub fn taken(&self) -> &[usize] {
        match self {
            Formula::Constant(_) => &[],
            Formula::Of { taken, .. } => taken,
        }
    }

    /// Whether it is made of a number with this place or a larger one.
    pub fn uses_from(&self, first: usize) -> bool {
        self.taken().iter().any(|&place| place >= first)
    }

    /// The same formula of numbers that have other places.
    pub fn moved(mut self, to: impl Fn(usize) -> usize) -> Self {
        if let Formula::Of { taken, .. } = &mut self {
            taken.iter_mut().for_each(|place| *place = to(*place));
        }
        self
    }

    /// Its value for the known numbers.
    pub fn value<S: Scalar>(&self, known: impl FnMut(usize) -> S) -> Quantity<S> {
        match self {
            Formula::Constant(own) => Quantity::of(&own.components().into_iter().map(S::from).collect::<Vec<_>>()),
            Formula::Of { replay, taken, .. } => {
                Quantity::of(&replay.values(&taken.iter().copied().map(known).collect::<Vec<_>>()))
            }
        }
    }

    /// The formula as a function of the numbers behind the known ones; those of the known ones that it takes are its parameters.
    pub fn law<S: Scalar>(&self, known: &[S]) -> (Law, Vec<S>) {
        let mut used: Vec<usize> = self.taken().iter().copied().filter(|&place| place < known.len()).collect();
        used.sort_unstable();
        let place =
            |place: usize| used.binary_search(&place).unwrap_or_else(|_| used.len() + place.saturating_sub(known.len()));
        let law = Law { formula: self.clone().moved(place), count: used.len() };
        (law, used.iter().map(|&place| known[place]).collect())
    }
}

/// A formula of some arguments, such as the time, with parameters before them: a function of time, a law of a spring, a part of an element.
#[derive(Hash)]
pub(super) struct Law {
    formula: Formula,
    /// Number of its parameters.
    pub count: usize,
}

impl Law {
    /// Its parameters, as part of what is called so.
    pub fn numbers(&self, of: &str) -> Vec<Parameter> {
        (1..=self.count).map(|i| Parameter::named(format!("number {i} of {of}"), "-")).collect()
    }

    pub fn at<S: Scalar>(&self, arguments: &[S], p: &[S]) -> Quantity<S> {
        self.formula.value(|place| if place < self.count { p[place] } else { arguments[place - self.count] })
    }
}

impl TimeFormula for Law {
    fn parameters(&self) -> Vec<Parameter> {
        self.numbers("the formula")
    }
    fn value<S: Scalar>(&self, t: S, p: &[S]) -> S {
        self.at(&[t], p).number()
    }
}

impl ForceLaw for Law {
    fn parameters(&self) -> Vec<Parameter> {
        self.numbers("the formula")
    }
    fn value<S: Scalar>(&self, arguments: [S; 3], p: &[S]) -> S {
        self.at(&arguments, p).number()
    }
}

/// What a name stands for where a formula is read.
#[derive(Clone, Debug)]
pub(super) enum Meaning {
    /// A number or vector that changes: the place of its first number among those that are known.
    Known { first: usize, is_vector: bool },
    /// A number for each face or node of a mesh: its place, the entry of the mesh and its name.
    Each(usize, usize, String),
    /// Numbers NAME\[0\] and so on, by their places.
    Array(Range<usize>),
    /// What a formula gives, in its place.
    Formula(Formula),
    /// A function by values at points, with the formulas of values that change with the design.
    Table(Arc<NamedTable>, Arc<[Formula]>),
}

/// The time in formulas that are functions of it \[s\].
pub(super) const TIME: &str = "t";

/// What laws of springs depend on: s, its rate, the time.
pub(super) const OF_LAW: [&str; 3] = ["s", "v", TIME];

/// The function between the numbers of a design variable that has several.
pub(super) const SPLINE: &str = "spline";

/// The share of the length of a beam in formulas of its section, or of a shell's first direction in its thickness, from 0 to 1; the first of
/// all numbers of a file.
pub(super) const SHARE: &str = "share";
/// Its place among them.
pub(super) const SHARE_PLACE: usize = 0;

/// Names that formulas may use.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    /// The last of a name hides those before it.
    pub names: Vec<(String, Meaning)>,
    /// How many numbers are known.
    pub count: usize,
    /// The mesh of whose faces and nodes formulas may use the values.
    pub of_mesh: Option<usize>,
    /// Formulas may use [`SHARE`].
    pub of_section: bool,
    /// Names that stand in braces for the number or word of a repeated entry.
    pub loops: Vec<String>,
}

impl Scope {
    /// The names that every file has.
    pub fn of_file() -> Self {
        Scope::default().with(&[SHARE])
    }
    /// Places of so many numbers more.
    fn next(&mut self, count: usize) -> Range<usize> {
        self.count += count;
        self.count - count..self.count
    }
    pub fn add(&mut self, name: &str, meaning: Meaning) {
        self.names.push((name.into(), meaning));
    }
    /// A number or vector that changes with the design or the motion.
    pub fn add_known(&mut self, name: &str, is_vector: bool) {
        let first = self.next(if is_vector { 3 } else { 1 }).start;
        self.add(name, Meaning::Known { first, is_vector });
    }
    /// Numbers that change with the design, NAME\[0\] and so on.
    pub fn add_array(&mut self, name: &str, count: usize) {
        let places = self.next(count);
        self.add(name, Meaning::Array(places));
    }
    /// A number that changes with the design, one for each of some faces or nodes of a mesh.
    pub fn add_each(&mut self, name: &str, mesh: usize, mesh_name: &str) {
        let place = self.next(1).start;
        self.add(name, Meaning::Each(place, mesh, mesh_name.into()));
    }
    /// What a formula gives, which is known from here on.
    pub fn add_value(&mut self, name: &str, formula: &Formula) {
        match formula {
            Formula::Constant(_) => self.add(name, Meaning::Formula(formula.clone())),
            Formula::Of { is_vector, .. } => self.add_known(name, *is_vector),
        }
    }
    /// The same names, and numbers behind them on which a formula depends.
    pub fn with(&self, names: &[&str]) -> Scope {
        let mut scope = self.clone();
        names.iter().for_each(|name| scope.add_known(name, false));
        scope
    }
    pub fn find(&self, name: &str) -> Option<&Meaning> {
        self.names.iter().rfind(|own| own.0 == name).map(|own| &own.1)
    }
    pub fn array(&self, name: &str) -> Option<Range<usize>> {
        match self.find(name)? {
            Meaning::Array(places) => Some(places.clone()),
            _ => None,
        }
    }
    /// The place of a number or of the first one of a vector.
    pub fn place(&self, name: &str) -> Option<usize> {
        match self.find(name)? {
            Meaning::Known { first, .. } => Some(*first),
            _ => None,
        }
    }
    /// The name of what has a place, and which of its numbers this is.
    pub fn name_at(&self, place: usize) -> Option<(&str, usize)> {
        self.names.iter().find_map(|(name, own)| match own {
            Meaning::Known { first, is_vector } => {
                (*first..first + if *is_vector { 3 } else { 1 }).position(|own| own == place).map(|own| (&**name, own))
            }
            _ => None,
        })
    }
    /// Whether an entry has given a name a meaning already, which hides that of the file.
    pub fn knows_beside(&self, file: &Scope, name: &str) -> bool {
        self.names[file.names.len()..].iter().any(|own| own.0 == name) || self.of_node(name).next().is_some()
    }
    /// What is known of a node, without its name.
    pub fn of_node<'s>(&'s self, node: &'s str) -> impl Iterator<Item = &'s str> {
        // but what outputs bring, as c.arm.position
        let own = self.names.iter().filter_map(move |own| own.0.strip_prefix(node)?.strip_prefix('.'));
        own.filter(|what| !what.contains('.'))
    }
}

/// A function of formulas: its name, which arguments are vectors, and what it makes of them.
type NamedFunction = (&'static str, &'static [bool], fn(&[Quantity<Recorded>]) -> Quantity<Recorded>);

const NUMBER: &[bool] = &[false];
const NUMBERS: &[bool] = &[false; 2];
const VECTOR: &[bool] = &[true];
const VECTORS: &[bool] = &[true; 2];

/// Functions that every formula may use.
pub(super) const FUNCTIONS: [NamedFunction; 23] = [
    ("sqrt", NUMBER, |x| Number(x[0].number().sqrt())),
    ("sin", NUMBER, |x| Number(x[0].number().sin())),
    ("cos", NUMBER, |x| Number(x[0].number().cos())),
    ("tan", NUMBER, |x| Number(x[0].number().tan())),
    ("asin", NUMBER, |x| Number(x[0].number().asin())),
    ("acos", NUMBER, |x| Number(x[0].number().acos())),
    ("atan", NUMBER, |x| Number(x[0].number().atan())),
    ("sinh", NUMBER, |x| Number(x[0].number().sinh())),
    ("cosh", NUMBER, |x| Number(x[0].number().cosh())),
    ("tanh", NUMBER, |x| Number(x[0].number().tanh())),
    ("exp", NUMBER, |x| Number(x[0].number().exp())),
    ("log", NUMBER, |x| Number(x[0].number().ln())),
    ("abs", NUMBER, |x| Number(x[0].number().abs())),
    ("floor", NUMBER, |x| Number(x[0].number().floor())),
    ("mod", NUMBERS, |x| Number(modulo(x[0].number(), x[1].number()))),
    ("atan2", NUMBERS, |x| Number(x[0].number().atan2(x[1].number()))),
    ("min", NUMBERS, |x| Number(x[0].number().min(x[1].number()))),
    ("max", NUMBERS, |x| Number(x[0].number().max(x[1].number()))),
    ("dot", VECTORS, |x| Number(x[0].vector().dot(&x[1].vector()))),
    ("cross", VECTORS, |x| Vector(x[0].vector().cross(&x[1].vector()))),
    ("unit", VECTOR, |x| Vector(x[0].vector().unit())),
    ("norm", VECTOR, |x| Number(x[0].vector().length())),
    ("if_less", &[false; 4], |x| Number(x[0].number().less(x[1].number()).select(x[2].number(), x[3].number()))),
];

/// From 0 up to b, whatever the sign of a.
fn modulo<S: Scalar>(a: S, b: S) -> S {
    a - b * (a / b).floor()
}

/// Constants that every formula may use.
pub(super) const CONSTANTS: [(&str, f64); 2] = [("pi", PI), ("deg", PI / 180.0)];

/// What a name means in formulas of every file, in words; `None` for one that is free.
pub(super) fn meaning(name: &str) -> Option<&'static str> {
    match name {
        TIME => Some("the time in formulas of type \"formula\" and in laws of springs"),
        SHARE => Some("the place along a beam in formulas of a [section], or along a shell in its thickness"),
        SPLINE => Some("a function in formulas"),
        _ if CONSTANTS.iter().any(|own| own.0 == name) => Some("a constant in formulas"),
        _ => FUNCTIONS.iter().any(|own| own.0 == name).then_some("a function in formulas"),
    }
}

/// True for a name that a file can give what its formulas use.
pub fn is_free_name(text: &str) -> bool {
    is_name(text) && meaning(text).is_none()
}

/// True for what can stand in a formula as a name.
pub(super) fn is_name(text: &str) -> bool {
    text.chars().next().is_some_and(starts_name) && text.chars().all(continues_name)
}

pub(super) fn starts_name(letter: char) -> bool {
    letter.is_alphabetic() || letter == '_'
}

pub(super) fn continues_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// Names that a text mentions with what is asked of them, as `arm.position.x`, and numbers.
pub(super) fn words_of(text: &str) -> impl Iterator<Item = &str> {
    text.split(|letter| !continues_name(letter) && letter != '.')
}

/// Names that a text mentions, those of functions and constants left out.
pub(super) fn names_in(text: &str) -> Vec<String> {
    let words = words_of(text).map(|word| word.split('.').next().unwrap_or_default());
    words.filter(|word| is_name(word) && meaning(word).is_none()).map(String::from).collect()
}

/// Where in the text, and what is wrong there.
pub(super) type SyntaxError = (usize, String);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{COMPLEX_STEP, Complex64};

    fn scope() -> Scope {
        let mut scope = Scope::default();
        scope.add_known("a", false);
        scope.add_known("b", false);
        scope.add_value("two", &Formula::literal(2.0));
        scope.add_value("v", &Formula::Constant(Vector(Vector3::new(1.0, 2.0, 3.0))));
        scope
    }

    fn value(text: &str) -> Vec<f64> {
        Formula::parse(text, &scope()).unwrap().value(|place| [0.7, 1.3][place]).components()
    }

    #[test]
    fn formulas_are_read_as_they_are_written_in_mechanics() {
        let (a, b) = (0.7_f64, 1.3_f64);
        let v = Vector3::new(1.0, 2.0, 3.0);
        for (text, expected) in [
            ("1 - 2 - 3", -4.0),
            ("2 / 4 / 2", 0.25),
            ("-a^2", -(a * a)),
            ("2^-1", 0.5),
            ("2^3^two", 512.0),
            ("2 * -a", -1.4),
            ("a^2.5", a.powf(2.5)),
            ("b^a", (a * b.ln()).exp()),
            ("(-a)^3", -(a.powi(3))),
            ("1.5e-3 + .5 + 2.", 2.5015),
            ("sqrt(a*a + b*b) * sin(pi/6)", (a * a + b * b).sqrt() * (PI / 6.0).sin()),
            ("atan2(a, -b) + log(exp(a)) - abs(-tan(a))", a.atan2(-b) + a.exp().ln() - a.tan().abs()),
            ("dot(v, [a, 0, b]) + v.y", a + 3.0 * b + 2.0),
            ("norm(cross(v, unit(v)))", 0.0),
            ("(a * v + v * b).z", (v * a + v * b).z),
            ("max(a, b) - min(a, b)", b - a),
            ("floor(-a) + floor(2 * b)", 1.0),
            ("mod(-a, b) + mod(5 * a, -b)", (b - a) + (3.5 - 3.0 * b)),
            ("if_less(a, b, a * 2, sqrt(-a)) + if_less(b, a, log(-b), 1)", 2.0 * a + 1.0),
        ] {
            assert!((value(text)[0] - expected).abs() <= 1e-15, "{text}: {:?} {expected}", value(text));
        }
        assert_eq!(value("[1, two, 3] / 2"), [0.5, 1.0, 1.5]);
    }

    #[test]
    fn derivatives_are_those_of_what_is_written() {
        let at = |x: Complex64| {
            let text = "b^a + sqrt(a) / a^1.5 + dot(v, cross(unit([a, 1, 2]), v + [a, a, 1])) * atan2(a, b)";
            Formula::parse(text, &scope()).unwrap().value(|place| [x, 1.3.into()][place]).number()
        };
        let by_step = at(Complex64::new(0.7, COMPLEX_STEP)).im / COMPLEX_STEP;
        let difference = (at(Complex64::new(0.7 + 1e-5, 0.0)) - at(Complex64::new(0.7 - 1e-5, 0.0))).re / 2e-5;
        assert!((by_step - difference).abs() < 1e-8 * by_step.abs(), "{by_step} {difference}");
    }

    #[test]
    fn wrong_formulas_say_where_and_why() {
        for (text, at, part) in [
            ("", 0, "ends"),
            ("2 *", 3, "ends"),
            ("2 $ 3", 2, "'$' does not continue"),
            ("(a", 2, "')' is missing"),
            ("a + v", 2, "cannot join a number and a vector"),
            ("v * v", 2, "dot(a, b)"),
            ("sin(v)", 4, "argument 1 of sin is a vector"),
            ("sine(a)", 0, "did you mean \"sin\""),
            ("a + tow", 4, "did you mean \"two\""),
            ("a.x", 1, "no components"),
            ("v.w", 1, ".x, .y or .z"),
            ("[1, 2]", 5, "',' is missing"),
            ("1e999", 0, "no finite number"),
            ("a b", 2, "does not continue"),
            ("atan2(a)", 7, "',' is missing"),
        ] {
            let (place, what) = Formula::parse(text, &scope()).unwrap_err();
            assert!(place == at && what.contains(part), "{text}: {place} {what}");
        }
        let deep = "(".repeat(100_000);
        assert!(Formula::parse(&deep, &scope()).unwrap_err().1.contains("deep"));
    }
}
