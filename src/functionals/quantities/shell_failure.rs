use crate::elements::flexible::{SECTION, ShellField, ShellSection};
use crate::elements::{Element, Field, Flexible, Parameter, State};
use crate::functionals::Quantity;
use crate::scalar::Scalar;

/// The largest von Mises stress of a shell element by the yield stress [-], at nine Gauss points on the lower and upper surface:
///
/// (1 / rho) ln sum exp(rho s / s_y),   s^2 = s_11^2 - s_11 s_22 + s_22^2 + 3 s_12^2,
///
/// with the stresses of plane stress, (s_11, s_22, s_12) = C (E +- h/2 K), for small strains. With the same rho, smooth maxima over elements
/// and over time of it are smooth maxima over all points and times together.
///
/// Parameters: those of an [isotropic](ShellSection::Isotropic) shell, then `yield stress` s_y [N/m2].
///
/// Source: the aggregate of Kreisselmeier & Steinhauser (1979).
pub struct ShellFailure {
    /// rho [-].
    pub sharpness: f64,
}

/// The formulas of the shell.
const SHELL: ShellField = ShellField { section: ShellSection::Isotropic };

impl Quantity for ShellFailure {
    fn dofs(&self) -> usize {
        ShellField::NODES * ShellField::NODE.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let mut list = Field::parameters(&SHELL);
        list.push(Parameter::positive("yield stress", "N/m2"));
        list
    }
    fn value<S: Scalar>(&self, s: State<S>, _mu: &[S], p: &[S], t: S) -> S {
        let shell = Flexible(SHELL);
        let mut e = vec![S::zero(); shell.strain_count()];
        shell.strains(s.q, p, t, &mut e);
        let (young, poisson, yielding) = (p[SECTION + 9], p[SECTION + 10], p[p.len() - 1]);
        let plane = young / (-(poisson * poisson) + 1.0);
        let shear = young / ((poisson + 1.0) * 2.0);
        let mut ratios = Vec::new();
        for (strain, curvature, half) in SHELL.surface_strains(&e, p) {
            for side in [-half, half] {
                let [along, across, between] = std::array::from_fn(|i| strain[i] + curvature[i] * side);
                let (first, second) = (plane * (along + poisson * across), plane * (across + poisson * along));
                let mixed = shear * between;
                let square = first * first - first * second + second * second + mixed * mixed * 3.0;
                ratios.push(square.sqrt() / yielding);
            }
        }
        let largest = ratios.iter().skip(1).fold(ratios[0], |largest, &ratio| largest.max(ratio));
        let sum = ratios.iter().fold(S::zero(), |sum, &ratio| sum + ((ratio - largest) * self.sharpness).exp());
        sum.ln() / self.sharpness + largest
    }
}
