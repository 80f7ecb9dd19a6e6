//! The grammar of formulas: sums of products of signed powers of components of operands.

use super::formula::Quantity::{Number, Vector};
use super::formula::{
    CONSTANTS, FUNCTIONS, Formula, Meaning, Quantity, SHARE, SPLINE, Scope, SyntaxError, Taken, continues_name, starts_name,
};
use super::tables::NamedTable;
use crate::program::Recorded;
use crate::scalar::{Scalar, Vector3};
use crate::scenes::unknown;
use std::ops::Range;

const OPERATORS: &str = "formulas know + - * / ^ ( ), functions such as sqrt(x), and vectors [x, y, z]";

/// How deep brackets, signs and exponents may lie in each other.
const MOST_DEPTH: usize = 60;

/// What was read, or where in the text something is wrong.
type Read = Result<Quantity<Recorded>, SyntaxError>;

/// A formula as it is read from its start.
struct FormulaText<'r> {
    text: &'r str,
    /// How far it is read \[bytes\].
    at: usize,
    scope: &'r Scope,
    taken: &'r mut Taken,
    /// Brackets, signs and exponents that are open.
    depth: usize,
}

impl Formula {
    pub fn parse(text: &str, scope: &Scope) -> Result<Self, SyntaxError> {
        Self::record(|taken| {
            let mut own = FormulaText { text, at: 0, scope, taken, depth: 0 };
            let value = own.sum()?;
            own.skip_blanks();
            match own.rest().chars().next() {
                None => Ok(value),
                Some(letter) => Err(own.wrong(format!("'{letter}' does not continue the formula; {OPERATORS}"))),
            }
        })
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
    /// The name that stands here.
    fn word(&mut self) -> &'r str {
        let rest = self.rest();
        let word = &rest[..rest.find(|letter| !continues_name(letter)).unwrap_or(rest.len())];
        self.at += word.len();
        word
    }
    fn mixed(&self, at: usize, operator: char, joined: [Quantity<Recorded>; 2]) -> SyntaxError {
        let [first, second] = joined.map(|own| if own.is_vector() { "a vector" } else { "a number" });
        (at, format!("'{operator}' cannot join {first} and {second}"))
    }

    fn sum(&mut self) -> Read {
        let mut sum = self.product()?;
        loop {
            let at = self.at;
            let Some(operator) = self.next_of("+-") else { return Ok(sum) };
            sum = match (operator, sum, self.product()?) {
                ('+', Number(a), Number(b)) => Number(a + b),
                ('+', Vector(a), Vector(b)) => Vector(a + b),
                (_, Number(a), Number(b)) => Number(a - b),
                (_, Vector(a), Vector(b)) => Vector(a - b),
                (_, a, b) => return Err(self.mixed(at, operator, [a, b])),
            };
        }
    }

    fn product(&mut self) -> Read {
        let mut product = self.signed()?;
        loop {
            let at = self.at;
            let Some(operator) = self.next_of("*/") else { return Ok(product) };
            product = match (operator, product, self.signed()?) {
                ('*', Number(a), Number(b)) => Number(a * b),
                ('*', Vector(a), Number(b)) | ('*', Number(b), Vector(a)) => Vector(a * b),
                ('/', Number(a), Number(b)) => Number(a / b),
                ('/', Vector(a), Number(b)) => Vector(a * b.recip()),
                (_, a, b) => {
                    let (at, what) = self.mixed(at, operator, [a, b]);
                    return Err((at, format!("{what}; there are dot(a, b) and cross(a, b)")));
                }
            };
        }
    }

    fn signed(&mut self) -> Read {
        match self.next_of("+-") {
            Some('-') => Ok(match self.deeper(Self::signed)? {
                Number(own) => Number(-own),
                Vector(own) => Vector(-own),
            }),
            Some(_) => self.deeper(Self::signed),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Read {
        let base = self.component()?;
        let at = self.at;
        if self.next_of("^").is_none() {
            return Ok(base);
        }
        let exponent = self.deeper(Self::signed)?;
        let (Number(a), Number(b)) = (base, exponent) else { return Err(self.mixed(at, '^', [base, exponent])) };
        Ok(Number(match b.known() {
            Some(value) if value.fract() == 0.0 && value.abs() <= 1000.0 => a.powi(value as i32),
            Some(value) => a.powf(value),
            None => (b * a.ln()).exp(),
        }))
    }

    fn component(&mut self) -> Read {
        let value = self.operand()?;
        self.skip_blanks();
        if !self.rest().starts_with('.') {
            return Ok(value);
        }
        let at = self.at;
        self.at += 1;
        let Some(letter) = self.next_of("xyz") else {
            return Err((at, "a component of a vector is .x, .y or .z".into()));
        };
        match value {
            Vector(own) => Ok(Number(own["xyz".find(letter).unwrap_or(0)])),
            Number(_) => Err((at, "a number has no components: .x, .y and .z are those of vectors".into())),
        }
    }

    fn operand(&mut self) -> Read {
        self.skip_blanks();
        let at = self.at;
        let Some(letter) = self.rest().chars().next() else {
            return Err(self.wrong(format!("the formula ends where a number is wanted; {OPERATORS}")));
        };
        match letter {
            '(' => {
                self.at += 1;
                let value = self.deeper(Self::sum)?;
                self.expect(')')?;
                Ok(value)
            }
            '[' => {
                let components = self.listed("component", "a vector", ['[', ']'], &[false; 3])?;
                Ok(Vector(Vector3::from([0, 1, 2].map(|k| components[k].number()))))
            }
            _ if letter.is_ascii_digit() || letter == '.' => self.literal(),
            _ if starts_name(letter) => self.name(),
            _ => Err((at, format!("'{letter}' stands where a number is wanted; {OPERATORS}"))),
        }
    }

    fn literal(&mut self) -> Read {
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
                Ok(Number(value.into()))
            }
            _ => Err(self.wrong(format!("\"{}\" is no finite number", &rest[..end]))),
        }
    }

    fn value_of(&mut self, own: &Formula) -> Quantity<Recorded> {
        own.value(|place| self.taken.number(place))
    }

    /// What a name stands for that is a number or a vector.
    fn known(&mut self, meaning: &Meaning) -> Option<Quantity<Recorded>> {
        match meaning {
            Meaning::Formula(own) => Some(self.value_of(own)),
            Meaning::Known { first, is_vector: false } | Meaning::Each(first, ..) => Some(Number(self.taken.number(*first))),
            Meaning::Known { first, .. } => Some(Vector(Vector3::from([0, 1, 2].map(|k| self.taken.number(first + k))))),
            Meaning::Array(_) | Meaning::Table(..) => None,
        }
    }

    /// What is known of a node whose name was read: `arm.position`.
    fn of_node(&mut self, node: &str) -> Result<Option<Quantity<Recorded>>, SyntaxError> {
        let names: Vec<&str> = self.scope.of_node(node).collect();
        if names.is_empty() {
            return Ok(None);
        }
        let at = self.at;
        self.at += usize::from(self.rest().starts_with('.'));
        let name = format!("{node}.{}", self.word());
        let Some(meaning) = self.scope.find(&name) else {
            let ways: Vec<String> = names.iter().map(|what| format!("{node}.{what}")).collect();
            return Err((at, format!("\"{node}\" is a node, of which formulas know {}", ways.join(", "))));
        };
        Ok(self.known(meaning))
    }

    /// One of the numbers of a design variable whose name was read: `thickness[3]`.
    fn of_array(&mut self, at: usize, name: &str, places: &Range<usize>) -> Read {
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
        Ok(Number(self.taken.number(places.start + index)))
    }

    /// `spline(NAME, s)`, its name read.
    fn spline(&mut self) -> Read {
        self.expect('(')?;
        self.skip_blanks();
        let (at, name) = (self.at, self.word());
        let Some(places) = self.scope.array(name) else {
            return Err((at, format!("{SPLINE} wants the name of a design variable with count, and \"{name}\" is none")));
        };
        self.expect(',')?;
        self.skip_blanks();
        let table = NamedTable::spline(places.len()).map_err(|why| (at, why))?;
        let values: Vec<Recorded> = places.map(|place| self.taken.number(place)).collect();
        self.at_of(SPLINE, &table, &values)
    }

    /// The value of a table at the number that stands here, and the bracket behind.
    fn at_of(&mut self, name: &str, table: &NamedTable, values: &[Recorded]) -> Read {
        let at = self.at;
        let Number(x) = self.deeper(Self::sum)? else {
            return Err((at, format!("the place of {name} is a number, and this is a vector")));
        };
        self.expect(')')?;
        Ok(Number(table.value(x, values)))
    }

    /// What stands in brackets, as the arguments of a function; whether each is to be a vector.
    fn listed(
        &mut self,
        each: &str,
        of: &str,
        [opening, closing]: [char; 2],
        are_vectors: &[bool],
    ) -> Result<Vec<Quantity<Recorded>>, SyntaxError> {
        self.expect(opening)?;
        let mut arguments = Vec::new();
        for (place, &wanted) in are_vectors.iter().enumerate() {
            if place > 0 {
                self.expect(',')?;
            }
            self.skip_blanks();
            let at = self.at;
            let own = self.deeper(Self::sum)?;
            if own.is_vector() != wanted {
                let [is, must] = if wanted { ["a number", "a vector"] } else { ["a vector", "a number"] };
                return Err((at, format!("{each} {} of {of} is {is}; it must be {must}", place + 1)));
            }
            arguments.push(own);
        }
        self.expect(closing)?;
        Ok(arguments)
    }

    fn name(&mut self) -> Read {
        let (at, name) = (self.at, self.word());
        if let Some(of_node) = self.of_node(name)? {
            return Ok(of_node);
        }
        if name == SPLINE {
            return self.spline();
        }
        let meaning = self.scope.find(name);
        match meaning {
            Some(Meaning::Array(places)) => return self.of_array(at, name, places),
            Some(Meaning::Table(table, values)) => {
                if self.next_of("(").is_none() {
                    return Err((at, format!("\"{name}\" is a table: {name}(x) is its value at x")));
                }
                let values: Vec<Recorded> = values.iter().map(|own| self.value_of(own).number()).collect();
                self.skip_blanks();
                return self.at_of(name, table, &values);
            }
            _ => {}
        }
        if let Some((_, arguments, function)) = FUNCTIONS.iter().find(|own| own.0 == name) {
            return Ok(function(&self.listed("argument", name, ['(', ')'], arguments)?));
        }
        let names = |is_table: bool| {
            let own = self.scope.names.iter().filter(move |own| matches!(own.1, Meaning::Table(..)) == is_table);
            own.map(|own| own.0.clone()).filter(|own| own != SHARE || self.scope.of_section)
        };
        if self.rest().trim_start().starts_with('(') {
            let known: Vec<String> = FUNCTIONS.iter().map(|own| own.0.into()).chain(names(true)).collect();
            return Err((at, unknown("function", name, &known)));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|own| own.0 == name) {
            return Ok(Number((*value).into()));
        }
        if meaning.is_none() && self.scope.loops.iter().any(|own| own == name) {
            let text = format!("name \"{name}\" is not known; what a for counts by {name} is written {{{name}}}");
            return Err((at, text));
        }
        let Some(meaning) = meaning else {
            let known: Vec<String> = names(false).chain(CONSTANTS.map(|own| own.0.into())).collect();
            return Err((at, unknown("name", name, &known)));
        };
        if name == SHARE && !self.scope.of_section {
            let text = "\"share\" is the place along a beam, from 0 to 1: only numbers of a [section] can use it";
            return Err((at, text.into()));
        }
        if let Meaning::Each(_, mesh, of) = meaning
            && self.scope.of_mesh != Some(*mesh)
        {
            let text = format!(
                "\"{name}\" has a value for each face or node of \"{of}\"; only the thickness of this mesh, and of its parts, can use it"
            );
            return Err((at, text));
        }
        self.known(meaning).ok_or_else(|| (at, format!("\"{name}\" is no number")))
    }
}
