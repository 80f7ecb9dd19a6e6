//! Conditions that select nodes and faces by their place, as in `"0.2 < x <= 0.4 and norm([x, y, 0]) > 0.99 or z > 1"`.

use super::formula::{Formula, Scope, SyntaxError, continues_name};

/// A condition on x, y and z: alternatives, of each of which all comparisons hold.
pub(super) struct Condition {
    alternatives: Vec<Vec<Chain>>,
}

/// `a < b <= c`: formulas, and what compares each with the next.
struct Chain {
    formulas: Vec<Formula>,
    comparisons: Vec<fn(&f64, &f64) -> bool>,
}

impl Condition {
    /// Reads a condition: comparisons by < <= > >= of formulas of x, y and z, joined by `and` and, less closely, by `or`.
    pub fn parse(text: &str) -> Result<Self, SyntaxError> {
        let scope = Scope::default().with(&["x", "y", "z"]);
        let chain = |(at, piece): (usize, &str)| {
            let own = Chain::parse(piece, &scope);
            own.map_err(|(inside, why)| (at + inside, why))
        };
        let all_of = |(at, piece): (usize, &str)| {
            let chains = split(piece, "and").into_iter().map(|(inside, own)| (at + inside, own));
            chains.map(chain).collect::<Result<Vec<Chain>, SyntaxError>>()
        };
        Ok(Condition { alternatives: split(text, "or").into_iter().map(all_of).collect::<Result<_, _>>()? })
    }

    pub fn holds(&self, place: [f64; 3]) -> bool {
        self.alternatives.iter().any(|chains| chains.iter().all(|own| own.holds(place)))
    }
}

impl Chain {
    fn parse(text: &str, scope: &Scope) -> Result<Self, SyntaxError> {
        let (mut formulas, mut comparisons, mut from) = (Vec::new(), Vec::new(), 0);
        loop {
            let end = text[from..].find(['<', '>']).map(|length| from + length);
            let piece = &text[from..end.unwrap_or(text.len())];
            if let Some(inside) = piece.find('=') {
                let why =
                    "a condition compares by <, <=, > and >=; equal numbers are few: abs(x) < 1e-6 allows for round-off";
                return Err((from + inside, why.into()));
            }
            let formula = Formula::parse(piece, scope).map_err(|(inside, why)| (from + inside, why))?;
            if formula.is_vector() {
                return Err((from, "a condition compares numbers, and this is a vector".into()));
            }
            formulas.push(formula);
            let Some(end) = end else { break };
            let (comparison, length): (fn(&f64, &f64) -> bool, usize) =
                match (&text[end..=end], text[end + 1..].starts_with('=')) {
                    ("<", false) => (f64::lt, 1),
                    ("<", true) => (f64::le, 2),
                    (_, false) => (f64::gt, 1),
                    (_, true) => (f64::ge, 2),
                };
            comparisons.push(comparison);
            from = end + length;
        }
        match comparisons.len() {
            0 => Err((0, "a condition compares, as in x < 1e-6".into())),
            _ => Ok(Chain { formulas, comparisons }),
        }
    }

    fn holds(&self, place: [f64; 3]) -> bool {
        let values: Vec<f64> = self.formulas.iter().map(|own| own.value(|axis| place[axis]).number()).collect();
        values.windows(2).zip(&self.comparisons).all(|(pair, holds)| holds(&pair[0], &pair[1]))
    }
}

/// What stands between the occurrences of a word, with its place.
fn split<'t>(text: &'t str, word: &str) -> Vec<(usize, &'t str)> {
    let (mut pieces, mut from) = (Vec::new(), 0);
    for (at, _) in text.match_indices(word) {
        let end = at + word.len();
        if !text[..at].ends_with(continues_name) && !text[end..].starts_with(continues_name) {
            pieces.push((from, &text[from..at]));
            from = end;
        }
    }
    pieces.push((from, &text[from..]));
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditions_are_read_as_they_are_written() {
        let place = [0.25, 0.5, -1.0];
        for (text, expected) in [
            ("x < 0.25", false),
            ("x <= 0.25", true),
            ("x > 0.25", false),
            ("x >= 0.25", true),
            ("0.2 < x < 0.3", true),
            ("0.2 < x < 0.24", false),
            ("1 > y > x > z", true),
            ("x < 1 and y < 0", false),
            ("x < 0 or y > 0 and z < 0", true),
            ("x > 0 and y < 0 or z > 0", false),
            ("norm([x, y, 0]) * 2 >= sqrt(x^2 + y^2)", true),
            ("sqrt(z) < 1 or sqrt(z) >= 1", false),
        ] {
            assert_eq!(Condition::parse(text).map(|own| own.holds(place)), Ok(expected), "{text}");
        }
    }

    #[test]
    fn wrong_conditions_say_where_and_why() {
        for (text, at, part) in [
            ("x", 0, "compares, as in x < 1e-6"),
            ("x < 1 and y", 9, "compares"),
            ("x < 1 or r > 2", 9, "name \"r\""),
            ("x = 0", 2, "abs(x) < 1e-6"),
            ("x < 1 and y == 0", 12, "abs(x) < 1e-6"),
            ("x <", 3, "ends"),
            ("x < 1 and", 9, "ends"),
            ("[x, y, z] < 1", 0, "vector"),
            ("x <> 1", 3, "ends"),
            ("x < 1and y < 1", 5, "does not continue"),
            ("", 0, "ends"),
        ] {
            let Err((place, why)) = Condition::parse(text) else { panic!("{text} is taken") };
            assert!(place == at && why.contains(part), "{text}: {place} {why}");
        }
    }
}
