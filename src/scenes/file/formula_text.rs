//! The grammar of formulas: sums of products of signed powers of components of operands.

use super::expression::{
    CONSTANTS, Expression, FUNCTIONS, Operation, Quantity, SPLINE, Scope, SyntaxError, constant, continues_name, starts_name,
};
use super::tables::NamedTable;
use crate::scenes::unknown;
use std::ops::Range;
use std::sync::Arc;

const OPERATORS: &str = "formulas know + - * / ^ ( ), functions such as sqrt(x), and vectors [x, y, z]";

/// How deep brackets, signs and exponents may lie in each other.
const MOST_DEPTH: usize = 60;

/// How many operations a formula may have with what its names stand for.
const MOST_OPERATIONS: usize = 10_000;

/// A formula as it is read from its start.
struct FormulaText<'r> {
    text: &'r str,
    at: usize,
    scope: &'r Scope,
    operations: Vec<Operation>,
    depth: usize,
}

impl Expression {
    /// Reads a formula.
    pub fn parse(text: &str, scope: &Scope) -> Result<Self, SyntaxError> {
        let mut own = FormulaText { text, at: 0, scope, operations: Vec::new(), depth: 0 };
        let is_vector = own.sum()?;
        own.skip_blanks();
        match own.rest().chars().next() {
            None => Ok(Expression { operations: own.operations, is_vector }),
            Some(letter) => Err(own.wrong(format!("'{letter}' does not continue the formula; {OPERATORS}"))),
        }
    }
}

impl<'r> FormulaText<'r> {
    fn rest(&self) -> &'r str {
        &self.text[self.at..]
    }
    fn wrong(&self, what: impl Into<String>) -> SyntaxError {
        (self.at, what.into())
    }
    fn skip_blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }
    /// The next letter, if it is one of some.
    fn next_of(&mut self, letters: &str) -> Option<char> {
        self.skip_blanks();
        let letter = self.rest().chars().next().filter(|letter| letters.contains(*letter))?;
        self.at += letter.len_utf8();
        Some(letter)
    }
    fn expect(&mut self, wanted: char) -> Result<(), SyntaxError> {
        match self.next_of(&wanted.to_string()) {
            Some(_) => Ok(()),
            None => {
                let found = self.rest().chars().next().map_or("the formula ends".into(), |own| format!("there is '{own}'"));
                Err(self.wrong(format!("'{wanted}' is missing; {found}")))
            }
        }
    }
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, SyntaxError>) -> Result<T, SyntaxError> {
        if self.depth == MOST_DEPTH {
            return Err(self.wrong(format!("brackets, signs and exponents lie more than {MOST_DEPTH} deep in each other")));
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }
    fn mixed(&self, at: usize, operator: char, [first, second]: [bool; 2]) -> SyntaxError {
        let word = |is_vector| if is_vector { "a vector" } else { "a number" };
        (at, format!("'{operator}' cannot join {} and {}", word(first), word(second)))
    }

    fn sum(&mut self) -> Result<bool, SyntaxError> {
        let first = self.product()?;
        loop {
            let at = self.at;
            let Some(operator) = self.next_of("+-") else { return Ok(first) };
            let second = self.product()?;
            if first != second {
                return Err(self.mixed(at, operator, [first, second]));
            }
            self.operations.push(if operator == '+' { Operation::Add } else { Operation::Subtract });
        }
    }

    fn product(&mut self) -> Result<bool, SyntaxError> {
        let mut first = self.signed()?;
        loop {
            let at = self.at;
            let Some(operator) = self.next_of("*/") else { return Ok(first) };
            let second = self.signed()?;
            if second && (first || operator == '/') {
                let (at, what) = self.mixed(at, operator, [first, second]);
                return Err((at, format!("{what}; there are dot(a, b) and cross(a, b)")));
            }
            self.operations.push(if operator == '*' { Operation::Multiply } else { Operation::Divide });
            first = first || second;
        }
    }

    fn signed(&mut self) -> Result<bool, SyntaxError> {
        match self.next_of("+-") {
            Some('-') => {
                let is_vector = self.deeper(Self::signed)?;
                self.operations.push(Operation::Negative);
                Ok(is_vector)
            }
            Some(_) => self.deeper(Self::signed),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Result<bool, SyntaxError> {
        let base = self.component()?;
        let at = self.at;
        if self.next_of("^").is_none() {
            return Ok(base);
        }
        let before = self.operations.len();
        let exponent = self.deeper(Self::signed)?;
        if base || exponent {
            return Err(self.mixed(at, '^', [base, exponent]));
        }
        match constant(&self.operations[before..], self.scope) {
            Some(Quantity::Number(value)) => {
                self.operations.truncate(before);
                let is_whole = value.fract() == 0.0 && value.abs() <= 1000.0;
                self.operations.push(if is_whole {
                    Operation::WholePower(value as i32)
                } else {
                    Operation::RealPower(value)
                });
            }
            _ => self.operations.push(Operation::Power),
        }
        Ok(false)
    }

    fn component(&mut self) -> Result<bool, SyntaxError> {
        let is_vector = self.operand()?;
        self.skip_blanks();
        if !self.rest().starts_with('.') {
            return Ok(is_vector);
        }
        let at = self.at;
        self.at += 1;
        let Some(letter) = self.next_of("xyz") else {
            return Err((at, "a component of a vector is .x, .y or .z".into()));
        };
        if !is_vector {
            return Err((at, "a number has no components: .x, .y and .z are those of vectors".into()));
        }
        self.operations.push(Operation::Component("xyz".find(letter).unwrap_or(0)));
        Ok(false)
    }

    fn operand(&mut self) -> Result<bool, SyntaxError> {
        self.skip_blanks();
        let at = self.at;
        let Some(letter) = self.rest().chars().next() else {
            return Err(self.wrong(format!("the formula ends where a number is wanted; {OPERATORS}")));
        };
        match letter {
            '(' => {
                self.at += 1;
                let is_vector = self.deeper(Self::sum)?;
                self.expect(')')?;
                Ok(is_vector)
            }
            '[' => {
                self.at += 1;
                for place in 0..3 {
                    if place > 0 {
                        self.expect(',')?;
                    }
                    let at = self.at;
                    if self.deeper(Self::sum)? {
                        return Err((at, "a component of a vector is a number, and this is a vector".into()));
                    }
                }
                self.expect(']')?;
                self.operations.push(Operation::Vector);
                Ok(true)
            }
            _ if letter.is_ascii_digit() || letter == '.' => self.literal(),
            _ if starts_name(letter) => self.name(),
            _ => Err((at, format!("'{letter}' stands where a number is wanted; {OPERATORS}"))),
        }
    }

    fn literal(&mut self) -> Result<bool, SyntaxError> {
        let rest = self.rest();
        let bytes = rest.as_bytes();
        let digits = |from: usize| from + bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let mut end = digits(0);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let last = digits(end + 1 + sign);
            if last > end + 1 + sign {
                end = last;
            }
        }
        match rest[..end].parse::<f64>() {
            Ok(value) if value.is_finite() => {
                self.at += end;
                self.operations.push(Operation::Literal(value));
                Ok(false)
            }
            _ => Err(self.wrong(format!("\"{}\" is no finite number", &rest[..end]))),
        }
    }

    /// What is known of a node whose name was read: `arm.position`.
    fn of_node(&mut self, node: &str) -> Result<Option<bool>, SyntaxError> {
        let names: Vec<&str> = self.scope.of_node(node).collect();
        if names.is_empty() {
            return Ok(None);
        }
        let (at, rest) = (self.at, self.rest());
        let what = rest.strip_prefix('.').unwrap_or_default();
        let what = &what[..what.find(|letter| !continues_name(letter)).unwrap_or(what.len())];
        let name = format!("{node}.{what}");
        if let Some(own) = self.scope.definition(&name) {
            self.at += 1 + what.len();
            return self.defined(at, own).map(Some);
        }
        let Some((index, named)) = self.scope.find(&name) else {
            let ways: Vec<String> = names.iter().map(|what| format!("{node}.{what}")).collect();
            return Err((at, format!("\"{node}\" is a node, of which formulas know {}", ways.join(", "))));
        };
        self.at += 1 + what.len();
        self.operations.push(Operation::Name(index));
        Ok(Some(named.is_vector))
    }

    /// What stands for a name that was read.
    fn defined(&mut self, at: usize, own: &Expression) -> Result<bool, SyntaxError> {
        self.operations.extend_from_slice(&own.operations);
        match self.operations.len() {
            0..=MOST_OPERATIONS => Ok(own.is_vector),
            _ => Err((at, format!("with what its names stand for the formula is longer than {MOST_OPERATIONS} operations"))),
        }
    }

    /// One of the numbers of a design variable whose name was read: `thickness[3]`.
    fn of_array(&mut self, at: usize, name: &str, places: &Range<usize>) -> Result<bool, SyntaxError> {
        let inside = self.rest().strip_prefix('[').and_then(|rest| Some(rest.split_once(']')?.0));
        let last = places.len() - 1;
        let Some((inside, index)) = inside.and_then(|inside| Some((inside, inside.trim().parse::<usize>().ok()?))) else {
            let text = format!(
                "\"{name}\" has {} values, {name}[0] to {name}[{last}]; spline({name}, s) is one between them, s from 0 to 1",
                places.len()
            );
            return Err((at, text));
        };
        if index > last {
            return Err((at, format!("there is no {name}[{index}]: the last one is {name}[{last}]")));
        }
        self.at += inside.len() + 2;
        self.operations.push(Operation::Name(places.start + index));
        Ok(false)
    }

    /// `spline(NAME, s)`, its name read.
    fn spline(&mut self) -> Result<bool, SyntaxError> {
        self.expect('(')?;
        self.skip_blanks();
        let (at, rest) = (self.at, self.rest());
        let name = &rest[..rest.find(|letter| !continues_name(letter)).unwrap_or(rest.len())];
        let Some(places) = self.scope.array(name) else {
            return Err((at, format!("{SPLINE} wants the name of a design variable with count, and \"{name}\" is none")));
        };
        self.at += name.len();
        self.expect(',')?;
        self.skip_blanks();
        let table = NamedTable::spline(places.len()).map_err(|why| (at, why))?;
        self.operations.extend(places.map(Operation::Name));
        self.at_of(SPLINE, Arc::new(table))
    }

    /// The number at which a table is taken whose values stand before it, and the bracket behind.
    fn at_of(&mut self, name: &str, table: Arc<NamedTable>) -> Result<bool, SyntaxError> {
        let at = self.at;
        if self.deeper(Self::sum)? {
            return Err((at, format!("the place of {name} is a number, and this is a vector")));
        }
        self.expect(')')?;
        self.operations.push(Operation::Table(table));
        Ok(false)
    }

    /// What stands in the brackets behind the name of a function; whether each is to be a vector.
    fn arguments(&mut self, name: &str, are_vectors: &[bool]) -> Result<(), SyntaxError> {
        self.expect('(')?;
        for (place, &wanted) in are_vectors.iter().enumerate() {
            if place > 0 {
                self.expect(',')?;
            }
            self.skip_blanks();
            let at = self.at;
            if self.deeper(Self::sum)? != wanted {
                let [is, must] = if wanted { ["a number", "a vector"] } else { ["a vector", "a number"] };
                return Err((at, format!("argument {} of {name} is {is}; it must be {must}", place + 1)));
            }
        }
        self.expect(')')
    }

    fn name(&mut self) -> Result<bool, SyntaxError> {
        let (at, rest) = (self.at, self.rest());
        let name = &rest[..rest.find(|letter| !continues_name(letter)).unwrap_or(rest.len())];
        self.at += name.len();
        if let Some(of_node) = self.of_node(name)? {
            return Ok(of_node);
        }
        if name == SPLINE {
            return self.spline();
        }
        if let Some(places) = self.scope.array(name) {
            return self.of_array(at, name, &places);
        }
        if let Some(own) = self.scope.definition(name) {
            return self.defined(at, own);
        }
        if let Some((table, values)) = self.scope.table(name) {
            if self.next_of("(").is_none() {
                return Err((at, format!("\"{name}\" is a table: {name}(x) is its value at x")));
            }
            values.iter().try_for_each(|own| self.defined(at, own).map(drop))?;
            self.skip_blanks();
            return self.at_of(name, table);
        }
        if let Some((_, function, arguments, is_vector)) = FUNCTIONS.iter().find(|own| own.0 == name) {
            self.arguments(name, arguments)?;
            self.operations.push(Operation::Call(*function));
            return Ok(*is_vector);
        }
        if self.next_of("(").is_some() {
            let known: Vec<String> = FUNCTIONS.iter().map(|own| own.0.into()).chain(self.scope.table_names()).collect();
            return Err((at, unknown("function", name, &known)));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|own| own.0 == name) {
            self.operations.push(Operation::Literal(*value));
            return Ok(false);
        }
        let Some((index, named)) = self.scope.find(name) else {
            if self.scope.loops.iter().any(|own| own == name) {
                return Err((
                    at,
                    format!("name \"{name}\" is not known; what a for counts by {name} is written {{{name}}}"),
                ));
            }
            let known = self.scope.known().map(|own| own.name.clone()).chain(self.scope.named_formulas());
            let known: Vec<String> = known.chain(CONSTANTS.map(|own| own.0.into())).collect();
            return Err((at, unknown("name", name, &known)));
        };
        if self.scope.is_out_of_section(index) {
            let text = "\"share\" is the place along a beam, from 0 to 1: only numbers of a [section] can use it";
            return Err((at, text.into()));
        }
        if let Some((mesh, of)) = &named.each
            && self.scope.of_mesh != Some(*mesh)
        {
            let text = format!(
                "\"{name}\" has a value for each face or node of \"{of}\"; only the thickness of this mesh, and of its parts, can use it"
            );
            return Err((at, text));
        }
        self.operations.push(Operation::Name(index));
        Ok(named.is_vector)
    }
}
