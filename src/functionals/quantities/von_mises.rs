use crate::elements::flexible::{SECTION, Shell, ShellSection};
use crate::elements::{Parameter, State};
use crate::functionals::{PointParameters, PointQuantity, PointValue};
use crate::scalar::Scalar;

/// The von Mises stress by the yield stress [-] on the lower and upper surface of shells of one material, at their Gauss points:
///
/// y = s / s_y,   s^2 = s_11^2 - s_11 s_22 + s_22^2 + 3 s_12^2,
///
/// with the stresses of plane stress, (s_11, s_22, s_12) = C (E +- h/2 K), for small strains. Each point stands for its area, of either
/// surface.
pub struct VonMises;

/// Places of Young's modulus and Poisson's ratio, behind the thicknesses of the nodes.
const YOUNG: usize = SECTION + 9;
const POISSON: usize = SECTION + 10;

impl PointQuantity for VonMises {
    type Element = Shell;
    const NAME: &'static str = "the von Mises stress of a shell of one material";
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("yield stress", "N/m2")];

    fn is_of(&self, shell: &Shell) -> bool {
        shell.0.section == ShellSection::Isotropic
    }
    fn at_points<S: Scalar>(&self, shell: &Shell, s: State<S>, p: PointParameters<S>, _t: S) -> Vec<PointValue<S>> {
        let (young, poisson, yielding) = (p.element[YOUNG], p.element[POISSON], p.own[0]);
        let plane = young / (-(poisson * poisson) + 1.0);
        let shear = young / ((poisson + 1.0) * 2.0);
        let mut values = Vec::new();
        for point in shell.points(s.q, p.element) {
            let half = point.thickness * 0.5;
            for z in [-half, half] {
                let [along, across, between] = point.strain_at(z);
                let (first, second) = (plane * (along + poisson * across), plane * (across + poisson * along));
                let mixed = shear * between;
                let square = first * first - first * second + second * second + mixed * mixed * 3.0;
                values.push(PointValue { value: square.sqrt() / yielding, weight: point.area });
            }
        }
        values
    }
}
