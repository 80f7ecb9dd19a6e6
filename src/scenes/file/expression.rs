//! Formulas in texts: numbers and vectors of named numbers and vectors.

use super::tables::NamedTable;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::Arc;

/// A number or a vector of three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quantity<S> {
    Number(S),
    Vector(Vector3<S>),
}

impl<S: Scalar> Quantity<S> {
    /// Its numbers.
    pub fn components(&self) -> Vec<S> {
        match self {
            Quantity::Number(own) => vec![*own],
            Quantity::Vector(own) => own.components().to_vec(),
        }
    }
}

/// What a name stands for where a formula is read.
#[derive(Clone, Debug)]
pub(super) struct Named {
    pub name: String,
    pub is_vector: bool,
    /// The entry and the name of the mesh for whose faces or nodes it has values.
    pub each: Option<(usize, String)>,
    /// Its value, if no design variable changes it.
    constant: Option<Quantity<f64>>,
}

/// The time in formulas that are functions of it \[s\].
pub(super) const TIME: &str = "t";

/// What laws of springs depend on: s, its rate, the time.
pub(super) const OF_LAW: [&str; 3] = ["s", "v", TIME];

/// The function between the numbers of a design variable that has several.
pub(super) const SPLINE: &str = "spline";

/// The share of the length of a beam in formulas of its section, or of a shell's first direction in its thickness, from 0 to 1; the first of
/// all names of a file.
pub(super) const SHARE: &str = "share";
/// Its place among the names.
pub(super) const SHARE_PLACE: usize = 0;

/// Names that formulas may use, in the order of their values; [`TIME`] comes last where it is one.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    pub names: Vec<Named>,
    /// The mesh of whose faces and nodes formulas may use the values.
    pub of_mesh: Option<usize>,
    /// Formulas may use [`SHARE`].
    pub of_section: bool,
    /// Formulas by names that stand in others for what they say.
    definitions: Vec<(String, Expression)>,
    /// Design variables of several numbers, with their places among the names.
    arrays: Vec<(String, Range<usize>)>,
    /// Tables by their names, with the formulas of values that change with the design.
    tables: Vec<(String, Arc<NamedTable>, Arc<[Expression]>)>,
    /// Names that stand in braces for the number or word of a repeated entry.
    pub loops: Vec<String>,
}

impl Scope {
    /// The names that every file has.
    pub fn of_file() -> Self {
        let mut scope = Scope::default();
        scope.add_variable(SHARE);
        scope
    }
    /// Whether a name is [`SHARE`] and stands where it has no meaning.
    pub fn is_out_of_section(&self, name: usize) -> bool {
        let is_share = |own: &Named| own.name == SHARE && own.constant.is_none();
        name == SHARE_PLACE && !self.of_section && self.names.first().is_some_and(is_share)
    }
    /// Names that can be used.
    pub fn known(&self) -> impl Iterator<Item = &Named> {
        self.names.iter().skip(usize::from(self.is_out_of_section(SHARE_PLACE)))
    }
    /// A number that changes with the design.
    pub fn add_variable(&mut self, name: &str) {
        self.names.push(Named { name: name.into(), is_vector: false, each: None, constant: None });
    }
    /// Numbers that change with the design, NAME[0] and so on.
    pub fn add_array(&mut self, name: &str, count: usize) {
        let first = self.names.len();
        (0..count).for_each(|number| self.add_variable(&format!("{name}[{number}]")));
        self.arrays.push((name.into(), first..first + count));
    }
    /// Places of its numbers among the names, unless a name of an entry hides it.
    pub fn array(&self, name: &str) -> Option<Range<usize>> {
        let is_hidden = || self.find(name).is_some() || self.definition(name).is_some();
        self.arrays.iter().find(|own| own.0 == name && !is_hidden()).map(|own| own.1.clone())
    }
    /// Whether a name means something already.
    pub fn knows(&self, name: &str) -> bool {
        self.find(name).is_some()
            || self.array(name).is_some()
            || self.definition(name).is_some()
            || self.table(name).is_some()
    }
    /// Whether an entry has given a name a meaning already, which hides that of the file.
    pub fn knows_beside(&self, file: &Scope, name: &str) -> bool {
        let is_own = |place: usize| place >= file.names.len();
        self.find(name).is_some_and(|own| is_own(own.0))
            || self.definition(name).is_some()
            || self.of_node(name).next().is_some()
    }
    /// What is known of a node: a number or vector that changes with the motion.
    pub fn add_of_node(&mut self, name: String, is_vector: bool) {
        self.names.push(Named { name, is_vector, each: None, constant: None });
    }
    /// A number that changes with the design, one for each of some faces or nodes of a mesh.
    pub fn add_each(&mut self, name: &str, mesh: usize, mesh_name: &str) {
        self.add_variable(name);
        if let Some(own) = self.names.last_mut() {
            own.each = Some((mesh, mesh_name.into()));
        }
    }
    /// A number or vector that is always the same.
    pub fn add_constant(&mut self, name: &str, value: Quantity<f64>) {
        let is_vector = matches!(value, Quantity::Vector(_));
        self.names.push(Named { name: name.into(), is_vector, each: None, constant: Some(value) });
    }
    /// What a formula gives.
    pub fn add_formula(&mut self, name: &str, formula: &Expression) {
        let constant = formula.constant(self);
        self.names.push(Named { name: name.into(), is_vector: formula.is_vector, each: None, constant });
    }
    /// A formula that stands where others use its name.
    pub fn add_definition(&mut self, name: &str, formula: Expression) {
        self.definitions.push((name.into(), formula));
    }
    /// Their names.
    pub fn named_formulas(&self) -> impl Iterator<Item = String> {
        self.definitions.iter().map(|own| own.0.clone())
    }
    /// What stands for a name.
    pub fn definition(&self, name: &str) -> Option<&Expression> {
        self.definitions.iter().find(|own| own.0 == name).map(|own| &own.1)
    }
    /// A table that formulas call.
    pub fn add_table(&mut self, name: &str, table: NamedTable, values: Vec<Expression>) {
        self.tables.push((name.into(), Arc::new(table), values.into()));
    }
    /// The table with a name, and the formulas of its values.
    pub fn table(&self, name: &str) -> Option<(Arc<NamedTable>, Arc<[Expression]>)> {
        self.tables.iter().find(|own| own.0 == name).map(|own| (Arc::clone(&own.1), Arc::clone(&own.2)))
    }
    /// Names of tables.
    pub fn table_names(&self) -> impl Iterator<Item = String> {
        self.tables.iter().map(|own| own.0.clone())
    }
    /// The same names, and others behind them on which a formula depends.
    pub fn with(&self, names: &[&str]) -> Scope {
        let mut scope = self.clone();
        names.iter().for_each(|name| scope.add_variable(name));
        scope
    }
    /// What is known of a node, without its name.
    pub fn of_node<'s>(&'s self, node: &'s str) -> impl Iterator<Item = &'s str> {
        // but what outputs bring, as c.arm.position
        let own = self.names.iter().map(|own| &own.name).chain(self.definitions.iter().map(|own| &own.0));
        own.filter_map(move |own| own.strip_prefix(node)?.strip_prefix('.')).filter(|what| !what.contains('.'))
    }
    pub fn find(&self, name: &str) -> Option<(usize, &Named)> {
        // the last one hides those before it
        self.names.iter().enumerate().rfind(|(_, named)| named.name == name)
    }
}

/// Functions with their numbers of arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Log,
    Abs,
    Floor,
    Mod,
    Atan2,
    Min,
    Max,
    Dot,
    Cross,
    Unit,
    Norm,
    IfLess,
}

/// Names of functions, arguments that are vectors, and whether the value is one.
pub(super) const FUNCTIONS: [(&str, Function, &[bool], bool); 23] = [
    ("sqrt", Function::Sqrt, &[false], false),
    ("sin", Function::Sin, &[false], false),
    ("cos", Function::Cos, &[false], false),
    ("tan", Function::Tan, &[false], false),
    ("asin", Function::Asin, &[false], false),
    ("acos", Function::Acos, &[false], false),
    ("atan", Function::Atan, &[false], false),
    ("sinh", Function::Sinh, &[false], false),
    ("cosh", Function::Cosh, &[false], false),
    ("tanh", Function::Tanh, &[false], false),
    ("exp", Function::Exp, &[false], false),
    ("log", Function::Log, &[false], false),
    ("abs", Function::Abs, &[false], false),
    ("floor", Function::Floor, &[false], false),
    ("mod", Function::Mod, &[false, false], false),
    ("atan2", Function::Atan2, &[false, false], false),
    ("min", Function::Min, &[false, false], false),
    ("max", Function::Max, &[false, false], false),
    ("dot", Function::Dot, &[true, true], false),
    ("cross", Function::Cross, &[true, true], true),
    ("unit", Function::Unit, &[true], true),
    ("norm", Function::Norm, &[true], false),
    ("if_less", Function::IfLess, &[false; 4], false),
];

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

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Operation {
    Literal(f64),
    Name(usize),
    Negative,
    Add,
    Subtract,
    Multiply,
    Divide,
    /// By its exponent where that is a constant.
    WholePower(i32),
    RealPower(f64),
    Power,
    Call(Function),
    /// Of three numbers.
    Vector,
    /// Of its values, where they change with the design, and the number behind them.
    Table(Arc<NamedTable>),
    Component(usize),
}

/// A formula: operations on a stack.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Expression {
    pub operations: Vec<Operation>,
    pub is_vector: bool,
}

/// Where in the text, and what is wrong there.
pub(super) type SyntaxError = (usize, String);

impl Expression {
    /// A number as it stands.
    pub fn literal(value: f64) -> Self {
        Expression { operations: vec![Operation::Literal(value)], is_vector: false }
    }

    /// A name as it stands.
    pub fn name(place: usize) -> Self {
        Expression { operations: vec![Operation::Name(place)], is_vector: false }
    }

    /// The number that it is, if it was made as one.
    pub fn as_literal(&self) -> Option<f64> {
        match self.operations[..] {
            [Operation::Literal(value)] => Some(value),
            _ => None,
        }
    }

    /// A vector of three formulas for its components.
    pub fn vector(components: [Expression; 3]) -> Self {
        let operations = components.into_iter().flat_map(|own| own.operations).chain([Operation::Vector]).collect();
        Expression { operations, is_vector: true }
    }

    /// Whether it uses the name with a number.
    pub fn uses(&self, name: usize) -> bool {
        self.operations.contains(&Operation::Name(name))
    }

    /// Whether it uses a name with this number or a larger one.
    pub fn uses_from(&self, first: usize) -> bool {
        self.operations.iter().any(|own| matches!(own, Operation::Name(name) if *name >= first))
    }

    /// The same formula of names that have other numbers.
    pub fn renamed(&self, number: impl Fn(usize) -> usize) -> Self {
        let renamed = |operation: &Operation| match operation {
            Operation::Name(name) => Operation::Name(number(*name)),
            other => other.clone(),
        };
        Expression { operations: self.operations.iter().map(renamed).collect(), is_vector: self.is_vector }
    }

    /// Its value, if no design variable changes it.
    pub fn constant(&self, scope: &Scope) -> Option<Quantity<f64>> {
        constant(&self.operations, scope)
    }

    /// Its value, for the values of the names.
    pub fn value<S: Scalar>(&self, names: &[Quantity<S>]) -> Quantity<S> {
        evaluate(&self.operations, names)
    }
}

pub(super) fn constant(operations: &[Operation], scope: &Scope) -> Option<Quantity<f64>> {
    let zero = Quantity::Number(0.0);
    let values = scope.names.iter().map(|named| named.constant.unwrap_or(zero)).collect::<Vec<_>>();
    let is_fixed = |operation: &Operation| match operation {
        Operation::Name(index) => scope.names[*index].constant.is_some(),
        _ => true,
    };
    operations.iter().all(is_fixed).then(|| evaluate(operations, &values))
}

/// The operations as read: their types have been checked, so that other combinations do not occur.
fn evaluate<S: Scalar>(operations: &[Operation], names: &[Quantity<S>]) -> Quantity<S> {
    use Quantity::{Number, Vector};
    let mut stack: Vec<Quantity<S>> = Vec::new();
    for operation in operations {
        let mut pop = || stack.pop().unwrap_or(Number(S::from(f64::NAN)));
        let value = match operation {
            Operation::Literal(value) => Number(S::from(*value)),
            Operation::Name(index) => names[*index],
            Operation::Negative => match pop() {
                Number(own) => Number(-own),
                Vector(own) => Vector(-own),
            },
            Operation::WholePower(exponent) => Number(number(pop()).powi(*exponent)),
            Operation::RealPower(exponent) => Number(number(pop()).powf(*exponent)),
            Operation::Component(index) => match pop() {
                Vector(own) => Number(own[*index]),
                own => own,
            },
            Operation::Table(table) => {
                let x = number(pop());
                let mut values: Vec<S> = (0..table.values()).map(|_| number(pop())).collect();
                values.reverse();
                Number(table.value(x, &values))
            }
            Operation::Vector => {
                let [z, y, x] = std::array::from_fn(|_| number(pop()));
                Vector(Vector3::new(x, y, z))
            }
            Operation::Call(Function::IfLess) => {
                let [otherwise, then, limit, own] = std::array::from_fn(|_| number(pop()));
                Number(own.less(limit).select(then, otherwise))
            }
            Operation::Call(function) => {
                let wanted = FUNCTIONS.iter().find(|own| own.1 == *function).map_or(1, |own| own.2.len());
                let second = (wanted == 2).then(&mut pop);
                call(*function, pop(), second)
            }
            binary => {
                let second = pop();
                match (binary, pop(), second) {
                    (Operation::Add, Number(a), Number(b)) => Number(a + b),
                    (Operation::Add, Vector(a), Vector(b)) => Vector(a + b),
                    (Operation::Subtract, Number(a), Number(b)) => Number(a - b),
                    (Operation::Subtract, Vector(a), Vector(b)) => Vector(a - b),
                    (Operation::Multiply, Number(a), Number(b)) => Number(a * b),
                    (Operation::Multiply, Vector(a), Number(b)) | (Operation::Multiply, Number(b), Vector(a)) => {
                        Vector(a * b)
                    }
                    (Operation::Divide, Number(a), Number(b)) => Number(a / b),
                    (Operation::Divide, Vector(a), Number(b)) => Vector(a * b.recip()),
                    (Operation::Power, Number(a), Number(b)) => Number((b * a.ln()).exp()),
                    _ => Number(S::from(f64::NAN)),
                }
            }
        };
        stack.push(value);
    }
    stack.pop().unwrap_or(Number(S::from(f64::NAN)))
}

fn number<S: Scalar>(quantity: Quantity<S>) -> S {
    match quantity {
        Quantity::Number(own) => own,
        Quantity::Vector(_) => S::from(f64::NAN),
    }
}

fn call<S: Scalar>(function: Function, first: Quantity<S>, second: Option<Quantity<S>>) -> Quantity<S> {
    use Quantity::{Number, Vector};
    match (function, first, second) {
        (Function::Dot, Vector(a), Some(Vector(b))) => Number(a.dot(&b)),
        (Function::Cross, Vector(a), Some(Vector(b))) => Vector(a.cross(&b)),
        (Function::Unit, Vector(a), _) => Vector(a.unit()),
        (Function::Norm, Vector(a), _) => Number(a.length()),
        (Function::Atan2, Number(a), Some(Number(b))) => Number(a.atan2(b)),
        // a - b floor(a / b): from 0 up to b, whatever the sign of a
        (Function::Mod, Number(a), Some(Number(b))) => Number(a - b * (a / b).floor()),
        (Function::Min, Number(a), Some(Number(b))) => Number(a.min(b)),
        (Function::Max, Number(a), Some(Number(b))) => Number(a.max(b)),
        (_, own, _) => {
            let x = number(own);
            Number(match function {
                Function::Sqrt => x.sqrt(),
                Function::Sin => x.sin(),
                Function::Cos => x.cos(),
                Function::Tan => x.tan(),
                Function::Asin => x.asin(),
                Function::Acos => x.acos(),
                Function::Atan => x.atan(),
                Function::Sinh => x.sinh(),
                Function::Cosh => x.cosh(),
                Function::Tanh => x.tanh(),
                Function::Exp => x.exp(),
                Function::Log => x.ln(),
                Function::Abs => x.abs(),
                Function::Floor => x.floor(),
                _ => S::from(f64::NAN),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{COMPLEX_STEP, Complex64};

    fn scope() -> Scope {
        let mut scope = Scope::default();
        scope.add_variable("a");
        scope.add_variable("b");
        scope.add_constant("two", Quantity::Number(2.0));
        scope.add_constant("v", Quantity::Vector(Vector3::new(1.0, 2.0, 3.0)));
        scope
    }

    fn value(text: &str) -> Vec<f64> {
        let names = [
            Quantity::Number(0.7),
            Quantity::Number(1.3),
            Quantity::Number(2.0),
            Quantity::Vector(Vector3::new(1.0, 2.0, 3.0)),
        ];
        Expression::parse(text, &scope()).unwrap().value(&names).components()
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
            let names = [Quantity::Number(x), Quantity::Number(1.3.into()), Quantity::Number(2.0.into())];
            let v = Quantity::Vector(Vector3::from_f64([1.0, 2.0, 3.0]));
            let text = "b^a + sqrt(a) / a^1.5 + dot(v, cross(unit([a, 1, 2]), v + [a, a, 1])) * atan2(a, b)";
            number(Expression::parse(text, &scope()).unwrap().value(&[&names[..], &[v]].concat()))
        };
        let by_step = at(Complex64::new(0.7, COMPLEX_STEP)).im / COMPLEX_STEP;
        let difference = (at(Complex64::new(0.7 + 1e-5, 0.0)) - at(Complex64::new(0.7 - 1e-5, 0.0))).re / 2e-5;
        assert!((by_step - difference).abs() < 1e-8 * by_step.abs(), "{by_step} {difference}");
    }

    #[test]
    fn constants_are_known_without_a_design() {
        let constant = |text: &str| Expression::parse(text, &scope()).unwrap().constant(&scope());
        assert_eq!(constant("two * 3"), Some(Quantity::Number(6.0)));
        assert_eq!(constant("two * a"), None);
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
            let (place, what) = Expression::parse(text, &scope()).unwrap_err();
            assert!(place == at && what.contains(part), "{text}: {place} {what}");
        }
        let deep = "(".repeat(100_000);
        assert!(Expression::parse(&deep, &scope()).unwrap_err().1.contains("deep"));
    }

    #[test]
    fn every_name_in_a_text_is_found() {
        assert_eq!(names_in("2*sin(crank) + v.x - 1e3*pi"), ["crank", "v"]);
    }
}
