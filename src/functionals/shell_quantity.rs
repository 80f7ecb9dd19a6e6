use super::measured_group::GroupFormula;
use super::point_quantity::record_points;
use super::{AnyPointQuantity, PointParameters, PointValue};
use crate::elements::flexible::faces::{Quad4, Quad9, Triangle6};
use crate::elements::flexible::{Shell, ShellKind};
use crate::elements::{ElementPhysics, Parameter, State};
use crate::program::Digest;
use crate::scalar::Scalar;
use std::hash::Hash;

/// A number at several points of each shell of a group, whatever its face: one formula, and nothing else. [`OfShells`] makes it a quantity.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait ShellQuantity: Hash + Send + Sync + 'static {
    /// What it is, in a message.
    const NAME: &'static str;
    /// Its physical numbers beside those of the shell, in the order of `p.own`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Whether a shell has it, from its options.
    fn is_of(&self, _shell: ShellKind) -> bool {
        true
    }
    /// Values at the points of a shell in the state `s` of its nodes; [`ShellKind::points`] gives strains and curvatures.
    fn at_points<S: Scalar>(&self, shell: ShellKind, s: State<S>, p: PointParameters<S>, t: S) -> Vec<PointValue<S>>;
}

/// A quantity of the shells of a group; other elements are skipped.
#[derive(Hash)]
pub struct OfShells<Q>(pub Q);

/// What tells a shell from others.
fn shell_kind(element: &ElementPhysics) -> Option<ShellKind> {
    let four = element.downcast::<Shell<Quad4>>().map(|shell| shell.0.kind());
    let nine = element.downcast::<Shell<Quad9>>().map(|shell| shell.0.kind());
    let six = element.downcast::<Shell<Triangle6>>().map(|shell| shell.0.kind());
    four.or(nine).or(six)
}

impl<Q: ShellQuantity> AnyPointQuantity for OfShells<Q> {
    fn name(&self) -> &'static str {
        Q::NAME
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn record(&self, element: &ElementPhysics) -> Option<Result<GroupFormula, String>> {
        let shell = shell_kind(element).filter(|shell| self.0.is_of(*shell))?;
        Some(record_points(Digest::of_typed(self), element, self.0.parameters().len(), |s, p, t| {
            self.0.at_points(shell, s, p, t)
        }))
    }
}
