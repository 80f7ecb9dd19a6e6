use super::VectorsAvq;
use crate::elements::RunScalar;

/// How time goes in a stretch between breakpoints whose ends have derivative parts: t + offset + slope t for the time t at which the steps were
/// laid, both parts without a value.
///
/// Steps keep their relative places, so that along the laid time they have their real size. Velocities and accelerations of a run with such parts
/// are derivatives by the laid time; formulas get those by the time itself, `pace` and `pace`^2 times as large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock<S> {
    offset: S,
    slope: S,
}

impl<S: RunScalar> Clock<S> {
    /// Of a stretch from one laid time to another, whose ends move by these parts.
    pub fn new([start, end]: [f64; 2], [of_start, of_end]: [S; 2]) -> Self {
        let slope = (of_end - of_start) / (end - start);
        Clock { offset: of_start - slope * start, slope }
    }

    /// Where all times move by the same part.
    pub fn shifted(part: S) -> Self {
        Clock { offset: part, slope: S::zero() }
    }

    /// The time of a laid time \[s\].
    pub fn time(&self, t: f64) -> S {
        self.offset + self.slope * t + t
    }

    /// Laid time by time.
    pub fn pace(&self) -> S {
        S::one() - self.slope
    }

    /// Time by laid time.
    pub fn length(&self) -> S {
        S::one() + self.slope
    }

    /// From derivatives by the laid time to those by the time.
    pub fn set_pace(&self, at: &mut VectorsAvq<S>) {
        let pace = self.pace();
        at.v.iter_mut().for_each(|v| *v *= pace);
        at.a.iter_mut().for_each(|a| *a *= pace * pace);
    }
}
