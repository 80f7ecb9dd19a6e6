//! States at single times, as pages show them.

pub const MOST_POINTS: usize = 4000;
/// The state at one time, as pages show it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Time \[s\].
    pub t: f64,
    pub q: Vec<f64>,
    /// `None` if an element does not state its energy [J].
    pub energy: Option<f64>,
    /// What functionals measure, in their order.
    pub measured: Vec<f64>,
    /// What springs, dampers, elements and states tell, in the order of their columns.
    pub outputs: Vec<f64>,
    /// Sizes of forces [N] and moments [N m] of joints.
    pub loads: Vec<[f64; 2]>,
}

/// Every so many moments that a curve has no more points than a page can show; the last one included.
pub fn thinned(moments: &[Snapshot]) -> impl Iterator<Item = (usize, &Snapshot)> {
    let stride = moments.len().div_ceil(MOST_POINTS).max(1);
    moments.iter().enumerate().filter(move |(index, _)| index % stride == 0 || index + 1 == moments.len())
}
