use crate::elements::flexible::{POISSON, Shell, ShellSection, YOUNG};
use crate::elements::{Parameter, State};
use crate::functionals::{PointParameters, PointQuantity, PointValue};
use crate::scalar::Scalar;

/// The [von Mises stress](crate::elements::flexible::ShellPoint::von_mises) by the yield stress [-] on the lower and upper surface of shells
/// of one material, at their Gauss points. Each point stands for its area, of either surface.
pub struct VonMises;

impl PointQuantity for VonMises {
    type Element = Shell;
    const NAME: &'static str = "the von Mises stress of a shell of one material";
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("yield stress", "N/m2")];

    fn is_of(&self, shell: &Shell) -> bool {
        shell.0.section == ShellSection::Isotropic
    }
    fn at_points<S: Scalar>(&self, shell: &Shell, s: State<S>, p: PointParameters<S>, _t: S) -> Vec<PointValue<S>> {
        let (young, poisson, yielding) = (p.element[YOUNG], p.element[POISSON], p.own[0]);
        let points = shell.points(s.q, p.element);
        let surfaces = points.iter().flat_map(|point| point.von_mises(young, poisson).map(|stress| (stress, point.area)));
        surfaces.map(|(stress, weight)| PointValue { value: stress / yielding, weight }).collect()
    }
}
