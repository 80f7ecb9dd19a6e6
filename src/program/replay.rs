use super::graph::Graph;
use super::operation::Node;
use super::recorded::{Recorded, Recording, record};
use crate::scalar::Scalar;

/// A formula that was recorded once, to be done again for other numbers of any type, inside of other recordings too.
#[derive(Clone, Debug, Hash)]
pub struct Replay {
    graph: Graph,
    results: Vec<Node>,
}

impl Replay {
    /// Records the numbers that a formula makes of arguments, which it takes by [`Recorded::argument`]; with what it returns beside them.
    pub fn of<T>(formula: impl FnOnce() -> (T, Vec<Recorded>)) -> (T, Self) {
        let ((beside, results), Recording { mut graph, undefined, looked, .. }) = record(&[], |_| formula());
        assert!(!looked, "what is done again for other numbers cannot have looked at their values");
        let mut results: Vec<Node> = results.into_iter().map(|result| result.node(&mut graph)).collect();
        undefined.show(&mut graph, &mut results, &mut []);
        (beside, Replay { graph, results })
    }

    /// The numbers that it makes of these arguments.
    pub fn values<S: Scalar>(&self, arguments: &[S]) -> Vec<S> {
        self.graph.values_of(&self.results, arguments)
    }

    /// The numbers, if they are the same for all arguments.
    pub fn constants(&self) -> Option<Vec<f64>> {
        self.results.iter().map(|&result| self.graph.constant_of(result)).collect()
    }
}
