//! Studies of `verify`: published or closed-form problems that are measured against their references.

use crate::io::Chart;

/// A study: a published or closed-form problem, measured.
pub trait Study {
    /// Name on the command line and of its folder.
    fn name(&self) -> &'static str;
    /// One sentence: what it shows.
    fn summary(&self) -> &'static str;
    /// Forms it has beside the whole one.
    fn forms(&self) -> &'static [Form] {
        &[]
    }
    /// Whether ranks that `mpirun` starts carry it out together.
    fn is_for_ranks(&self) -> bool {
        false
    }
    /// Measures, and writes every figure to the report.
    ///
    /// # Errors
    /// In words, if the study could not be carried out; a figure out of tolerance is no error but a failed figure.
    fn run(&self, report: &mut Report) -> Result<(), String>;
}

/// One measured number with what it is compared to.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Path-like name, from general to particular.
    pub name: String,
    /// Measured.
    pub value: f64,
    /// What it should be; `None` if it only informs.
    pub reference: Option<f64>,
    /// How far it may be away.
    pub tolerance: Option<f64>,
    /// Within tolerance, or informing only.
    pub pass: bool,
}

/// The figures of a study, in the order in which they were measured.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// All of them.
    pub figures: Vec<Figure>,
    /// Lines for people: explanations that belong to the result.
    pub notes: Vec<String>,
    /// Stacked charts with the name of their file; drawn where the result is recorded.
    pub pictures: Vec<(String, Vec<Chart>)>,
    form: Form,
    seed: u64,
}

/// How much of a study is carried out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Seconds, and nothing that depends on the clock.
    Short,
    /// What its record shows.
    #[default]
    Whole,
    /// More of the same.
    Long,
}

impl Report {
    /// An empty report of a form, and where the numbers of drawn cases begin.
    pub fn new(form: Form, seed: u64) -> Self {
        Report { form, seed, ..Report::default() }
    }

    /// Where the numbers begin from which a study draws its cases: 0 unless others are asked for.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Whether the short form of a study is asked for.
    pub fn is_short(&self) -> bool {
        self.form == Form::Short
    }

    /// Whether the long form of a study is asked for.
    pub fn is_long(&self) -> bool {
        self.form == Form::Long
    }

    /// A number that must be within `tolerance` of `reference`.
    pub fn compare(&mut self, name: impl Into<String>, value: f64, reference: f64, tolerance: f64) {
        // written so that a NaN fails
        let pass = (value - reference).abs() <= tolerance;
        let (reference, tolerance) = (Some(reference), Some(tolerance));
        self.figures.push(Figure { name: name.into(), value, reference, tolerance, pass });
    }

    /// An error or other number of no less than zero that must not exceed `limit`.
    pub fn at_most(&mut self, name: impl Into<String>, value: f64, limit: f64) {
        self.compare(name, value, 0.0, limit);
    }

    /// A number that only informs.
    pub fn inform(&mut self, name: impl Into<String>, value: f64) {
        self.figures.push(Figure { name: name.into(), value, reference: None, tolerance: None, pass: true });
    }

    /// A line of explanation.
    pub fn note(&mut self, line: impl Into<String>) {
        self.notes.push(line.into());
    }

    /// Charts above each other.
    pub fn picture(&mut self, name: impl Into<String>, charts: Vec<Chart>) {
        self.pictures.push((name.into(), charts));
    }

    /// True if every figure is within its tolerance and there is at least one that could fail.
    pub fn pass(&self) -> bool {
        self.figures.iter().all(|figure| figure.pass) && self.figures.iter().any(|figure| figure.tolerance.is_some())
    }
}
