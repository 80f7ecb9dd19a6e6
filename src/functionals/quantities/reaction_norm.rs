use crate::elements::State;
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// Length of some multipliers of one constraint: for a joint that holds points together the force between them \[N\].
///
/// It has no derivative where it is zero: there, and where its square is below all that matters, it counts as a constant.
#[derive(Hash)]
pub struct ReactionNorm {
    /// Numbers of the equations whose multipliers are meant, counted from 0: all are forces, or all are moments.
    pub equations: Vec<usize>,
    /// "N" of forces, "N m" of moments.
    pub unit: &'static str,
}

/// Square of a reaction that is none: a motion that dies away leaves squares that are rounded to a few bits, whose roots have any slope.
const NONE: f64 = 1e-280;

impl Quantity for ReactionNorm {
    fn dofs(&self) -> usize {
        0
    }
    fn unit(&self) -> &'static str {
        self.unit
    }
    fn value<S: Scalar>(&self, _s: State<S>, mu: &[S], _p: &[S], _t: S) -> S {
        let square = self.equations.iter().map(|&equation| mu[equation] * mu[equation]).sum::<S>();
        square.less(S::from(NONE)).select(S::zero(), square.sqrt())
    }
}
