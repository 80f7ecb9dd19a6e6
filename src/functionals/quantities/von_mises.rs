use crate::elements::flexible::{ShellKind, ShellSection};
use crate::elements::{Parameter, State};
use crate::functionals::{PointParameters, PointValue, ShellQuantity};
use crate::scalar::Scalar;

/// The von Mises stress by the yield stress [-] on the lower and upper surface of shells
/// of one material, at their Gauss points. Each point stands for its area, of either surface.
#[derive(Hash)]
pub struct VonMises;

impl ShellQuantity for VonMises {
    const NAME: &'static str = "the von Mises stress of a shell of one material";
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("yield stress", "N/m2")];

    fn is_of(&self, shell: ShellKind) -> bool {
        shell.section == ShellSection::Isotropic
    }
    fn at_points<S: Scalar>(&self, shell: ShellKind, s: State<S>, p: PointParameters<S>, _t: S) -> Vec<PointValue<S>> {
        let shape = shell.face.shape();
        let (young, poisson, yielding) = (p.element[shape.young()], p.element[shape.poisson()], p.own[0]);
        let points = shell.points(s.q, p.element);
        let surfaces = points.iter().flat_map(|point| point.von_mises(young, poisson).map(|stress| (stress, point.area)));
        surfaces.map(|(stress, weight)| PointValue { value: stress / yielding, weight }).collect()
    }
}
