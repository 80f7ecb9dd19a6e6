/// A value of what a functional measures, and when and where it was.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme {
    /// The value, in the unit of what is measured.
    pub value: f64,
    /// Time \[s\].
    pub t: f64,
    /// Name of the element, where elements are measured.
    pub element: Option<String>,
}

/// The smallest and the largest value of all that an aggregate is made of: stages of steps, and points.
#[derive(Clone, Debug, PartialEq)]
pub struct Extremes {
    /// The smallest.
    pub smallest: Extreme,
    /// The largest.
    pub largest: Extreme,
}

/// A value, its time, and its place among the values of a sample.
pub(super) type Seen = (f64, f64, usize);

/// Smallest and largest so far, `None` before the first value.
pub(super) fn follow(seen: &mut Option<[Seen; 2]>, t: f64, values: impl Iterator<Item = f64>) {
    for (place, value) in values.enumerate() {
        let [smallest, largest] = seen.get_or_insert([(value, t, place); 2]);
        if value < smallest.0 {
            *smallest = (value, t, place);
        }
        if value > largest.0 {
            *largest = (value, t, place);
        }
    }
}
