use smallvec::SmallVec;

/// What an argument of a formula is: equal operations on unlike arguments are different laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ArgumentKind {
    /// Second time derivative of a coordinate.
    Acceleration,
    /// Time derivative of a coordinate.
    Velocity,
    /// A coordinate.
    Coordinate,
    /// A multiplier of a constraint.
    Multiplier,
    /// A parameter of the part itself.
    Parameter,
    /// On which side a switch is.
    Side,
    /// A parameter of what is measured in the part.
    MeasureParameter,
    /// Time.
    Time,
    /// A strain or its change.
    Strain,
    /// A factor of results.
    Weight,
    /// A place that is kept free: nothing reads it.
    Unread,
    /// A number of no special kind.
    Number,
}

/// Numbers of arguments of each kind, in the order in which they stand.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Arguments(SmallVec<[(ArgumentKind, usize); 8]>);

impl Arguments {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.iter().map(|(_, count)| count).sum()
    }
    /// Which of them are of the state of a mechanism: coordinates, their derivatives, multipliers.
    pub fn of_state(&self) -> Vec<bool> {
        use ArgumentKind::{Acceleration, Coordinate, Multiplier, Velocity};
        self.are(|kind| matches!(kind, Acceleration | Velocity | Coordinate | Multiplier))
    }
    /// Which of them are the time.
    pub fn of_time(&self) -> Vec<bool> {
        self.are(|kind| kind == ArgumentKind::Time)
    }
    /// Which of them are of some kinds.
    pub fn of_kinds(&self, kinds: &[ArgumentKind]) -> Vec<bool> {
        self.are(|kind| kinds.contains(&kind))
    }
    fn are(&self, of_kind: impl Fn(ArgumentKind) -> bool) -> Vec<bool> {
        self.0.iter().flat_map(|&(kind, count)| std::iter::repeat_n(of_kind(kind), count)).collect()
    }
    /// Kinds and numbers.
    pub fn kinds(&self) -> &[(ArgumentKind, usize)] {
        &self.0
    }
}

impl From<usize> for Arguments {
    /// So many of no special kind.
    fn from(count: usize) -> Self {
        Arguments(SmallVec::from_slice(&[(ArgumentKind::Number, count)]))
    }
}

impl<const N: usize> From<[(ArgumentKind, usize); N]> for Arguments {
    fn from(kinds: [(ArgumentKind, usize); N]) -> Self {
        Arguments(kinds.into_iter().collect())
    }
}

impl From<Vec<(ArgumentKind, usize)>> for Arguments {
    fn from(kinds: Vec<(ArgumentKind, usize)>) -> Self {
        Arguments(kinds.into())
    }
}
