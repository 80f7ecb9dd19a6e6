use std::fmt::Write;

/// Something wrong at a place of a scene file, in bytes from its start.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mistake {
    pub at: usize,
    pub what: String,
}

impl Mistake {
    pub fn new(at: usize, what: impl Into<String>) -> Self {
        Mistake { at, what: what.into() }
    }

    /// What it says but for numbers.
    fn kind(&self) -> String {
        self.what.chars().filter(|own| !own.is_ascii_digit()).collect()
    }
}

/// Most mistakes of one file that are told.
const MOST_TOLD: usize = 20;

/// A scene file: its name and its text.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub name: String,
    pub text: String,
}

impl Source {
    /// `pendulum.toml:12:8`: line and column, counted from 1 in characters.
    pub fn place(&self, at: usize) -> String {
        let end = (0..=at.min(self.text.len())).rev().find(|&end| self.text.is_char_boundary(end)).unwrap_or(0);
        let before = &self.text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |own| own.chars().count()) + 1;
        format!("{}:{line}:{column}", self.name)
    }

    /// One line for a mistake.
    pub fn told(&self, mistake: &Mistake) -> String {
        format!("{}: {}", self.place(mistake.at), mistake.what)
    }

    /// All mistakes in the order of the file, a line each; one for those at one place that differ by numbers alone, as copies of an entry do.
    pub fn all_told(&self, mut mistakes: Vec<Mistake>) -> String {
        mistakes.sort_by_key(|mistake| mistake.at);
        mistakes.dedup();
        let mut told: Vec<(Mistake, usize)> = Vec::new();
        for own in mistakes {
            let kind = own.kind();
            match told.iter_mut().rev().take_while(|(known, _)| known.at == own.at).find(|(known, _)| known.kind() == kind) {
                Some((_, copies)) => *copies += 1,
                None => told.push((own, 0)),
            }
        }
        let line = |(own, copies): &(Mistake, usize)| match copies {
            0 => self.told(own),
            copies => format!("{} (and {copies} more like it here)", self.told(own)),
        };
        let mut text = told.iter().take(MOST_TOLD).map(line).collect::<Vec<_>>().join("\n");
        if let Some(more) = told.len().checked_sub(MOST_TOLD + 1) {
            let _ = write!(text, "\nand {} more", more + 1);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mistakes_of_copies_are_told_once() {
        let source = Source { name: "a.toml".into(), text: "x = 1\ny = 2\n".into() };
        let all = ["\"bar 0\": no i", "\"bar 0\": no k", "\"bar 1\": no i", "\"bar 12\": no i"];
        let mistakes = all.iter().map(|what| Mistake::new(4, *what)).chain([Mistake::new(10, "\"bar 3\": no i")]);
        let told = source.all_told(mistakes.collect());
        let expected = "a.toml:1:5: \"bar 0\": no i (and 2 more like it here)\na.toml:1:5: \"bar 0\": no k\na.toml:2:5: \"bar 3\": no i";
        assert_eq!(told, expected);
    }

    #[test]
    fn places_are_lines_and_columns_of_characters() {
        let source = Source { name: "a.toml".into(), text: "x = 1\nü = 2\n".into() };
        let places = [0, 4, 6, 9, 100].map(|at| source.place(at));
        assert_eq!(places, ["a.toml:1:1", "a.toml:1:5", "a.toml:2:1", "a.toml:2:3", "a.toml:3:1"]);
    }
}
