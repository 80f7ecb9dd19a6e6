use std::borrow::Cow;

/// Which values a parameter may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Admissible {
    /// Any finite number.
    Any,
    /// Greater than zero.
    Positive,
    /// Zero or greater.
    NonNegative,
    /// Any finite number but zero.
    NonZero,
}

impl Admissible {
    /// True if the value is finite and in the range.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Admissible::Any => true,
                Admissible::Positive => value > 0.0,
                Admissible::NonNegative => value >= 0.0,
                Admissible::NonZero => value != 0.0,
            }
    }

    /// The range in words, for messages.
    pub fn describe(self) -> &'static str {
        match self {
            Admissible::Any => "a finite number",
            Admissible::Positive => "greater than 0",
            Admissible::NonNegative => "0 or greater",
            Admissible::NonZero => "a finite number other than 0",
        }
    }
}

/// One physical number of an element, constraint or functional: a place in the flat parameter vector p.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// What it is, in the field's word.
    pub name: Cow<'static, str>,
    /// SI unit (or the scene's consistent one).
    pub unit: &'static str,
    /// Values that make sense.
    pub admissible: Admissible,
    /// One of those by which an element is made stronger or heavier: thickness of a shell, stiffness of a spring or a section, mass of a
    /// body. Reports colour a part by what a relative change of these does.
    pub is_size: bool,
}

impl Parameter {
    /// Any finite number.
    pub const fn new(name: &'static str, unit: &'static str) -> Self {
        Parameter { name: Cow::Borrowed(name), unit, admissible: Admissible::Any, is_size: false }
    }
    /// A number greater than zero.
    pub const fn positive(name: &'static str, unit: &'static str) -> Self {
        Parameter { name: Cow::Borrowed(name), unit, admissible: Admissible::Positive, is_size: false }
    }
    /// A number other than zero.
    pub const fn non_zero(name: &'static str, unit: &'static str) -> Self {
        Parameter { name: Cow::Borrowed(name), unit, admissible: Admissible::NonZero, is_size: false }
    }
    /// A number that is zero or greater.
    pub const fn non_negative(name: &'static str, unit: &'static str) -> Self {
        Parameter { name: Cow::Borrowed(name), unit, admissible: Admissible::NonNegative, is_size: false }
    }
    /// A parameter whose name is made at run time.
    pub fn named(name: String, unit: &'static str) -> Self {
        Parameter { name: Cow::Owned(name), unit, admissible: Admissible::Any, is_size: false }
    }
    /// The components of vectors, by the names of the vectors.
    pub fn vectors(names: &[&str], unit: &'static str) -> Vec<Self> {
        let components = |name| ["x", "y", "z"].map(|axis| Parameter::named(format!("{name} {axis}"), unit));
        names.iter().flat_map(components).collect()
    }
    /// The same, by which an element is made stronger or heavier: see [`Parameter::is_size`].
    #[must_use]
    pub const fn as_size(mut self) -> Self {
        self.is_size = true;
        self
    }
}
