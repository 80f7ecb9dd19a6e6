use crate::scenes::mesh_data::FilePlace;

/// What is wrong in a mesh file, and where.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Wrong {
    pub place: Option<FilePlace>,
    pub what: String,
}

/// What is read of a mesh file, or what is wrong in it.
pub(super) type Result<T, E = Wrong> = std::result::Result<T, E>;

/// A piece of a file for messages: its first letters.
pub(super) fn shown(text: &str) -> String {
    text.chars().take(40).flat_map(char::escape_debug).collect()
}

/// A mesh file while it is read: numbers as words of a text, or as they stand in memory.
pub(super) struct Input<'b> {
    bytes: &'b [u8],
    at: usize,
    /// Lines that end before `at`, known while numbers are words.
    line: usize,
    pub binary: bool,
    /// Numbers in memory have their most significant byte first.
    pub big_endian: bool,
    /// Numbers of nodes and elements have eight bytes in memory, or four.
    pub long_numbers: bool,
}

impl<'b> Input<'b> {
    pub fn new(bytes: &'b [u8]) -> Self {
        Input { bytes, at: 0, line: 0, binary: false, big_endian: false, long_numbers: true }
    }
    /// Where the next word or number stands.
    pub fn place(&mut self) -> FilePlace {
        if self.binary {
            return FilePlace::Byte(self.at);
        }
        self.skip_blanks();
        FilePlace::Line(self.line + 1)
    }
    pub fn wrong<T>(&mut self, what: impl Into<String>) -> Result<T> {
        let place = Some(self.place());
        Err(Wrong { place, what: what.into() })
    }
    pub fn is_at_end(&mut self) -> bool {
        self.skip_blanks();
        self.at == self.bytes.len()
    }
    fn step(&mut self) {
        self.line += usize::from(self.bytes[self.at] == b'\n');
        self.at += 1;
    }
    fn skip_blanks(&mut self) {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.step();
        }
    }

    /// The rest of the line, without blanks around it.
    pub fn line(&mut self) -> String {
        let from = self.at;
        while self.bytes.get(self.at).is_some_and(|byte| *byte != b'\n') {
            self.at += 1;
        }
        let own = String::from_utf8_lossy(&self.bytes[from..self.at]).trim().to_string();
        if self.at < self.bytes.len() {
            self.step();
        }
        own
    }
    /// The next line that is not empty, of the text around numbers.
    pub fn next_line(&mut self) -> String {
        self.skip_blanks();
        self.line()
    }
    /// The next word.
    pub fn word(&mut self, what: &str) -> Result<&'b str> {
        self.skip_blanks();
        let from = self.at;
        let length = self.bytes[from..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        match std::str::from_utf8(&self.bytes[from..from + length]) {
            Ok("") => self.wrong(format!("the file ends where {what} is wanted: it is cut off")),
            Ok(word) if word.starts_with('$') => self.wrong(format!("there is {} where {what} is wanted", shown(word))),
            Ok(word) => {
                self.at += length;
                Ok(word)
            }
            Err(_) => self.wrong(format!("there is no text where {what} is wanted")),
        }
    }
    fn parsed<T: std::str::FromStr>(&mut self, what: &str, wanted: &str, is_right: fn(&T) -> bool) -> Result<T> {
        self.skip_blanks();
        let (at, line) = (self.at, self.line);
        let word = self.word(what)?;
        let Some(own) = word.parse().ok().filter(is_right) else {
            // the place of the word, not of what follows
            (self.at, self.line) = (at, line);
            return self.wrong(format!("{what} must be {wanted}; it is \"{}\"", shown(word)));
        };
        Ok(own)
    }
    fn raw<const N: usize>(&mut self, what: &str) -> Result<[u8; N]> {
        match self.bytes[self.at..].first_chunk::<N>() {
            Some(&(mut own)) => {
                self.at += N;
                if self.big_endian {
                    own.reverse();
                }
                Ok(own)
            }
            None => self.wrong(format!("the file ends where {what} is wanted: it is cut off")),
        }
    }

    /// A number that is at least 0, and that a list may have as its length.
    pub fn size(&mut self, what: &str) -> Result<usize> {
        let own: u64 = match self.binary {
            true => u64::from_le_bytes(self.raw(what)?),
            false => self.parsed(what, "a whole number, at least 0", |_| true)?,
        };
        usize::try_from(own).or_else(|_| self.wrong(format!("{what} is {own}, which is too large for this machine")))
    }
    /// The number of a node or an element.
    pub fn number(&mut self, what: &str) -> Result<usize> {
        if self.long_numbers || !self.binary {
            return self.size(what);
        }
        let own = self.int(what)?;
        usize::try_from(own).or_else(|_| self.wrong(format!("{what} must be at least 0; it is {own}")))
    }
    /// A length that stands as a text on a line of its own, in binary files, too.
    pub fn size_on_line(&mut self, what: &str) -> Result<usize> {
        let place = Some(self.place());
        let binary = std::mem::take(&mut self.binary);
        let own = self.size(what).map_err(|wrong| Wrong { place, ..wrong })?;
        self.line();
        self.binary = binary;
        Ok(own)
    }
    pub fn int(&mut self, what: &str) -> Result<i32> {
        match self.binary {
            true => Ok(i32::from_le_bytes(self.raw(what)?)),
            false => self.parsed(what, "a whole number", |_| true),
        }
    }
    pub fn double(&mut self, what: &str) -> Result<f64> {
        if !self.binary {
            return self.parsed(what, "a finite number", |own: &f64| own.is_finite());
        }
        let own = f64::from_le_bytes(self.raw(what)?);
        if own.is_finite() { Ok(own) } else { self.wrong(format!("{what} is {own}; it must be finite")) }
    }
    /// Refuses counts for which the rest of the file is too short; `least` bytes that each takes as words, and in memory.
    pub fn check_count(&mut self, count: usize, what: &str, least: [usize; 2]) -> Result<()> {
        let (each, left) = (least[usize::from(self.binary)], self.bytes.len() - self.at);
        match count.checked_mul(each).is_some_and(|bytes| bytes <= left) {
            true => Ok(()),
            false => self.wrong(format!(
                "{count} {what} are announced, of at least {each} bytes each, but the file ends after {left} bytes: it is cut off, or the number \
                 is wrong"
            )),
        }
    }
    /// The end of a section.
    pub fn end(&mut self, section: &str) -> Result<()> {
        let wanted = format!("$End{section}");
        self.skip_blanks();
        let (at, line) = (self.at, self.line);
        let found = self.line();
        if found == wanted {
            return Ok(());
        }
        (self.at, self.line) = (at, line);
        match shown(&found).as_str() {
            "" => self.wrong(format!("the file ends where {wanted} is wanted: it is cut off")),
            _ => {
                self.wrong(format!("{wanted} is wanted here, after as much as the section announces; there is \"{found}\""))
            }
        }
    }
    /// Passes over a section.
    pub fn skip(&mut self, section: &str) -> Result<()> {
        let wanted = format!("$End{section}");
        let place = self.bytes[self.at..].windows(wanted.len()).position(|own| own == wanted.as_bytes());
        match place {
            Some(length) => {
                let end = self.at + length;
                self.line += self.bytes[self.at..end].iter().filter(|byte| **byte == b'\n').count();
                self.at = end;
                self.end(section)
            }
            None => self.wrong(format!("the section ${section} has no end {wanted}: the file is cut off")),
        }
    }
}
