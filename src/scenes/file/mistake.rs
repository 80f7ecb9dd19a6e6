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

#[derive(Clone, Debug)]
pub(super) struct Text {
    pub name: String,
    pub text: String,
}

/// Where entries come from.
#[derive(Clone, Debug)]
pub(super) struct Source {
    /// The text of a scene file, behind those of the files which it extends; places are counted through all of them.
    texts: Vec<Text>,
    /// Of entries that no text says: the places of a program, by their numbers.
    places: Vec<String>,
}

impl Source {
    pub fn new(name: String, text: String) -> Self {
        Source { texts: vec![Text { name, text }], places: Vec::new() }
    }

    pub fn of_program(name: String, places: Vec<String>) -> Self {
        Source { places, ..Source::new(name, String::new()) }
    }

    /// Takes what the first file extends.
    pub fn extend(&mut self, name: String, text: String) {
        self.texts.insert(0, Text { name, text });
    }

    /// What all others build on.
    pub fn first(&self) -> &Text {
        &self.texts[0]
    }

    /// The name of the file itself.
    pub fn name(&self) -> &str {
        self.texts.last().map_or("", |own| &own.name)
    }

    pub fn has(&self, name: &str) -> bool {
        self.texts.iter().any(|own| own.name == name)
    }

    /// The numbers of the first places of all texts.
    pub fn starts(&self) -> impl Iterator<Item = usize> {
        self.texts.iter().scan(0, |next, own| Some(std::mem::replace(next, *next + own.text.len() + 1)))
    }

    /// `pendulum.toml:12:8`: line and column, counted from 1 in characters; of a program as it says.
    pub fn place(&self, at: usize) -> String {
        if let Some(own) = self.places.get(at) {
            return own.clone();
        }
        let known = self.starts().zip(&self.texts).take_while(|(from, _)| *from <= at).last();
        let Some((from, Text { name, text })) = known else { return String::new() };
        let end = (0..=(at - from).min(text.len())).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
        let before = &text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |own| own.chars().count()) + 1;
        format!("{name}:{line}:{column}")
    }

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
        let source = Source::new("a.toml".into(), "x = 1\ny = 2\n".into());
        let all = ["\"bar 0\": no i", "\"bar 0\": no k", "\"bar 1\": no i", "\"bar 12\": no i"];
        let mistakes = all.iter().map(|what| Mistake::new(4, *what)).chain([Mistake::new(10, "\"bar 3\": no i")]);
        let told = source.all_told(mistakes.collect());
        let expected = "a.toml:1:5: \"bar 0\": no i (and 2 more like it here)\na.toml:1:5: \"bar 0\": no k\na.toml:2:5: \"bar 3\": no i";
        assert_eq!(told, expected);
    }

    #[test]
    fn places_are_lines_and_columns_of_characters() {
        let source = Source::new("a.toml".into(), "x = 1\nü = 2\n".into());
        let places = [0, 4, 6, 9, 100].map(|at| source.place(at));
        assert_eq!(places, ["a.toml:1:1", "a.toml:1:5", "a.toml:2:1", "a.toml:2:3", "a.toml:3:1"]);
    }
}
