use crate::elements::flexible::{Laminate, Ply, PlyStrength, ShellKind, ShellSection};
use crate::elements::{Parameter, State};
use crate::functionals::{PointParameters, PointValue, ShellQuantity};
use crate::scalar::Scalar;

/// The failure ratio of Tsai and Wu [-] of every ply of layered shells, at its lower and upper face and at the Gauss points:
/// [`PlyStrength::failure_ratio`] of the stresses in the axes of the ply, for small strains. Each point stands for its area.
///
/// Parameters: the offset of the plies' middle from the reference surface \[m\], and of each ply its thickness, angle, E_1, E_2, nu_12, G_12,
/// X_t, Y_t, X_c, Y_c and S.
#[derive(Hash)]
pub struct TsaiWu {
    /// Number of plies.
    pub plies: usize,
}

/// Parameters of a ply.
const OF_PLY: [Parameter; 11] = [
    Parameter::positive("thickness", "m"),
    Parameter::new("angle", "rad"),
    Parameter::positive("young along", "N/m2"),
    Parameter::positive("young across", "N/m2"),
    Parameter::new("poisson", "-"),
    Parameter::positive("shear modulus", "N/m2"),
    Parameter::positive("tension along", "N/m2"),
    Parameter::positive("tension across", "N/m2"),
    Parameter::positive("compression along", "N/m2"),
    Parameter::positive("compression across", "N/m2"),
    Parameter::positive("shear strength", "N/m2"),
];

impl TsaiWu {
    /// The parameters of plies with their strengths.
    pub fn numbers<S: Scalar>(laminate: &Laminate<S>, strengths: &[PlyStrength<S>]) -> Vec<S> {
        let of_ply = |(ply, strength): (&Ply<S>, &PlyStrength<S>)| {
            let PlyStrength { tension, compression, shear } = *strength;
            let stiffness = [ply.thickness, ply.angle, ply.young[0], ply.young[1], ply.poisson, ply.shear[0]];
            stiffness.into_iter().chain(tension).chain(compression).chain([shear])
        };
        [laminate.offset].into_iter().chain(laminate.plies.iter().zip(strengths).flat_map(of_ply)).collect()
    }
}

impl ShellQuantity for TsaiWu {
    const NAME: &'static str = "the failure ratio of Tsai and Wu of a layered shell";

    fn parameters(&self) -> Vec<Parameter> {
        let of_ply = |ply: usize| {
            OF_PLY.into_iter().map(move |own| {
                let name = format!("ply {ply}, {}", own.name);
                Parameter { admissible: own.admissible, ..Parameter::named(name, own.unit) }
            })
        };
        [Parameter::new("offset", "m")].into_iter().chain((1..=self.plies).flat_map(of_ply)).collect()
    }
    fn is_of(&self, shell: ShellKind) -> bool {
        shell.section == ShellSection::Laminate
    }
    fn at_points<S: Scalar>(&self, shell: ShellKind, s: State<S>, p: PointParameters<S>, _t: S) -> Vec<PointValue<S>> {
        let plies: Vec<(Ply<S>, PlyStrength<S>)> = p.own[1..]
            .chunks_exact(OF_PLY.len())
            .map(|own| {
                // what acts across the ply has no stress here
                let (shear, density) = ([own[5], S::zero(), S::zero()], S::zero());
                let ply = Ply { thickness: own[0], angle: own[1], young: [own[2], own[3]], poisson: own[4], shear, density };
                let (tension, compression) = ([own[6], own[7]], [own[8], own[9]]);
                (ply, PlyStrength { tension, compression, shear: own[10] })
            })
            .collect();
        let thickness: S = plies.iter().map(|(ply, _)| ply.thickness).sum();
        let mut values = Vec::new();
        for point in shell.points(s.q, p.element) {
            let mut z = p.own[0] - thickness * 0.5;
            for (ply, strength) in &plies {
                for place in [z, z + ply.thickness] {
                    let value = strength.failure_ratio(ply.stresses(point.strain_at(place)));
                    values.push(PointValue { value, weight: point.area });
                }
                z += ply.thickness;
            }
        }
        values
    }
}
