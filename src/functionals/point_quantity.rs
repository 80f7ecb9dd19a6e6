use super::measured_group::{Argument, GroupFormula};
use crate::elements::{Element, ElementPhysics, Parameter, State, split_arguments};
use crate::program::ArgumentKind::{Acceleration, Coordinate, MeasureParameter, Parameter as OfPart, Time, Velocity};
use crate::program::{Digest, Formula, Recorded};
use crate::scalar::Scalar;
use std::hash::Hash;

/// A number at several points of each element of a group, as a stress: one formula, and nothing else.
///
/// It is written for elements of one type; a group may hold others, which are skipped.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait PointQuantity: Hash + Send + Sync + 'static {
    /// The elements that have it.
    type Element: Element;
    /// What it is, in a message: "the bending moment of a plate".
    const NAME: &'static str;
    /// Its physical numbers beside those of the element, in the order of `p.own`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Whether an element of the type has it, from its options.
    fn is_of(&self, _element: &Self::Element) -> bool {
        true
    }
    /// Values at the points of an element in the state `s` of its nodes.
    fn at_points<S: Scalar>(&self, element: &Self::Element, s: State<S>, p: PointParameters<S>, t: S) -> Vec<PointValue<S>>;
}

/// Parameters that a [`PointQuantity`] sees.
#[derive(Clone, Copy, Debug)]
pub struct PointParameters<'p, S> {
    /// Those of the element.
    pub element: &'p [S],
    /// Its own, the same for all elements.
    pub own: &'p [S],
}

/// A value at a point of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointValue<S> {
    /// The value.
    pub value: S,
    /// What the point stands for in an integral over the group: an area \[m2\], a length \[m\], a mass \[kg\].
    pub weight: S,
}

/// A quantity of the elements of a group with its type erased; every [`PointQuantity`] is one.
pub trait AnyPointQuantity: Send + Sync {
    /// What it is, in a message.
    fn name(&self) -> &'static str;
    /// Its own parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Its formula for an element, if that has it.
    ///
    /// # Errors
    /// In words, if the formula branches on a value.
    fn record(&self, element: &ElementPhysics) -> Option<Result<GroupFormula, String>>;
}

impl<Q: PointQuantity> AnyPointQuantity for Q {
    fn name(&self) -> &'static str {
        Q::NAME
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn record(&self, physics: &ElementPhysics) -> Option<Result<GroupFormula, String>> {
        let element = physics.downcast::<Q::Element>().filter(|element| self.is_of(element))?;
        Some(record_points(Digest::of_typed(self), physics, self.parameters().len(), |s, p, t| {
            self.at_points(element, s, p, t)
        }))
    }
}

/// The formula of a quantity with some parameters of its own, in the elements of a type.
pub(super) fn record_points(
    origin: Digest,
    physics: &ElementPhysics,
    own: usize,
    at_points: impl Fn(State<Recorded>, PointParameters<Recorded>, Recorded) -> Vec<PointValue<Recorded>>,
) -> Result<GroupFormula, String> {
    let (n, m) = (physics.dof_count(), physics.parameter_count());
    let state = [Acceleration, Velocity, Coordinate].map(|kind| (kind, n));
    let rest = [(OfPart, m), (MeasureParameter, own), (Time, 1)];
    let formula = Formula::once(&(origin, physics.origin()), || {
        Formula::record([state, rest].concat(), |x| {
            let [a, v, q, element, own, t] = split_arguments(x, [n, n, n, m, own, 1]);
            let all = at_points(State { a, v, q }, PointParameters { element, own }, t[0]);
            all.iter().map(|point| point.value).chain(all.iter().map(|point| point.weight)).collect()
        })
    })?;
    let points = formula.outputs.len() / 2;
    let arguments = (0..n)
        .map(Argument::A)
        .chain((0..n).map(Argument::V))
        .chain((0..n).map(Argument::Q))
        .chain((0..m).map(Argument::Parameter))
        .chain((0..own).map(Argument::Own))
        .chain([Argument::Time]);
    Ok(GroupFormula {
        formula,
        arguments: arguments.collect(),
        values: (0..points).collect(),
        weights: (points..2 * points).collect(),
    })
}
