//! Stiffness and inertia of layered shells from their plies.

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]
// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::design::shortest;
use crate::scalar::Scalar;

/// A layer of one orthotropic material in plane stress, fibres along its axis 1.
#[derive(Clone, Copy, Debug)]
pub struct Ply<S> {
    /// \[m\]
    pub thickness: S,
    /// From axis 1 of the shell to the fibres, about the normal \[rad\].
    pub angle: S,
    /// E_1 along the fibres and E_2 across [N/m2].
    pub young: [S; 2],
    /// nu_12: strain across by strain along, for a stress along the fibres.
    pub poisson: S,
    /// G_12 in the layer, G_13 and G_23 across it [N/m2].
    pub shear: [S; 3],
    /// [kg/m3]
    pub density: S,
}

/// Stresses at which a ply fails, each of them alone; all greater than 0 [N/m2].
#[derive(Clone, Copy, Debug)]
pub struct PlyStrength<S> {
    /// X_t along the fibres and Y_t across.
    pub tension: [S; 2],
    /// X_c along the fibres and Y_c across.
    pub compression: [S; 2],
    /// S between them.
    pub shear: S,
}

impl<S: Scalar> PlyStrength<S> {
    /// The failure ratio y of Tsai and Wu, by which all strengths divided are just reached, for stresses in the axes of the ply: 1 where
    /// it fails, and proportional to the stresses,
    ///
    /// y = (L + sqrt(L^2 + 4 Q)) / 2,   L = F_1 s_1 + F_2 s_2,   Q = F_11 s_1^2 + F_22 s_2^2 + F_66 s_12^2 + 2 F_12 s_1 s_2
    ///
    /// with F_1 = 1/X_t - 1/X_c, F_11 = 1/(X_t X_c), the same of Y for F_2 and F_22, F_66 = 1/S^2, F_12 = -sqrt(F_11 F_22) / 2: L / y + Q /
    /// y^2 = 1.
    ///
    /// Source: Tsai & Wu (1971).
    pub fn failure_ratio(&self, [along, across, between]: [S; 3]) -> S {
        let (tension, compression) = (self.tension.map(S::recip), self.compression.map(S::recip));
        let [first, second] = [0, 1].map(|i| tension[i] - compression[i]);
        let [first_square, second_square] = [0, 1].map(|i| tension[i] * compression[i]);
        let linear = first * along + second * across;
        let sheared = between / self.shear;
        let both = (first_square * second_square).sqrt() * along * across;
        let square = first_square * along * along + second_square * across * across + sheared * sheared - both;
        (linear + (linear * linear + square * 4.0).sqrt()) * 0.5
    }
}

/// Plies from the lowest place along the normal to the highest.
#[derive(Clone, Debug)]
pub struct Laminate<S> {
    /// From below.
    pub plies: Vec<Ply<S>>,
    /// Place of the middle of all plies along the normal, from the reference surface \[m\]: 0 unless the shell is eccentric.
    pub offset: S,
    /// Share of the shear stiffness that acts, 5/6 for one layer.
    pub shear_factor: f64,
}

/// Upper triangle of a symmetric matrix of three rows, by rows.
type Symmetric<S> = [S; 6];

impl<S: Scalar> Ply<S> {
    /// A layer of an isotropic material.
    pub fn isotropic(material: &super::Material<S>, thickness: S) -> Self {
        let shear = material.shear();
        Ply {
            thickness,
            angle: S::zero(),
            young: [material.young; 2],
            poisson: material.poisson,
            shear: [shear; 3],
            density: material.density,
        }
    }

    /// Stiffness against (E_11, E_22, 2 E_12) in the axes of the ply [N/m2].
    fn along_fibres(&self) -> [[S; 3]; 3] {
        let (zero, [along, across]) = (S::zero(), self.young);
        let other = self.poisson * across / along;
        let inverse = (-(self.poisson * other) + 1.0).recip();
        [
            [along * inverse, other * along * inverse, zero],
            [other * along * inverse, across * inverse, zero],
            [zero, zero, self.shear[0]],
        ]
    }

    /// Rows that take strains in the axes of the shell to those in the axes of the ply.
    fn turned(&self) -> [[S; 3]; 3] {
        let (s, c) = self.angle.sin_cos();
        [[c * c, s * s, s * c], [s * s, c * c, -(s * c)], [-(s * c) * 2.0, s * c * 2.0, c * c - s * s]]
    }

    /// Stiffness against (E_11, E_22, 2 E_12) in the axes of the shell [N/m2].
    fn in_plane(&self) -> Symmetric<S> {
        let (q, turned) = (self.along_fibres(), self.turned());
        let entry = |i: usize, j: usize| {
            let terms = (0..3).flat_map(|k| (0..3).map(move |l| (k, l)));
            terms.fold(S::zero(), |sum, (k, l)| sum + turned[k][i] * q[k][l] * turned[l][j])
        };
        [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| entry(i, j))
    }

    /// Stresses along and across the fibres and between them, from strains (E_11, E_22, 2 E_12) in the axes of the shell [N/m2].
    pub fn stresses(&self, strain: [S; 3]) -> [S; 3] {
        let times = |rows: [[S; 3]; 3], x: [S; 3]| rows.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        times(self.along_fibres(), times(self.turned(), strain))
    }

    /// Stiffness against transverse shear along axes 1 and 2, upper triangle [N/m2].
    fn transverse(&self) -> [S; 3] {
        let (s, c) = self.angle.sin_cos();
        let [_, along, across] = self.shear;
        [c * c * along + s * s * across, s * c * (along - across), s * s * along + c * c * across]
    }
}

impl<S: Scalar> Laminate<S> {
    /// Plies with their middle in the reference surface and the shear factor 5/6.
    pub fn new(plies: Vec<Ply<S>>) -> Self {
        Laminate { plies, offset: S::zero(), shear_factor: 5.0 / 6.0 }
    }

    /// The plies moved along the normal, away from the reference surface \[m\].
    #[must_use]
    pub fn offset(mut self, offset: S) -> Self {
        self.offset = offset;
        self
    }

    /// Thickness of all plies \[m\].
    pub fn thickness(&self) -> S {
        self.plies.iter().map(|ply| ply.thickness).sum()
    }

    /// A, B, D by upper triangles, S by its upper triangle, and m, m_1, m_2, in this order: the parameters of a
    /// [laminate](super::ShellSection::Laminate).
    ///
    /// A = sum of Q (z_k - z_k-1), B of Q (z_k^2 - z_k-1^2) / 2, D of Q (z_k^3 - z_k-1^3) / 3, and the same of the density for m, m_1 and m_2.
    pub fn numbers(&self) -> Vec<S> {
        let mut sums = vec![S::zero(); 24];
        let mut below = self.offset - self.thickness() * 0.5;
        for ply in &self.plies {
            let above = below + ply.thickness;
            let moments = [
                above - below,
                (above * above - below * below) * 0.5,
                (above * above * above - below * below * below) / 3.0,
            ];
            let (plane, transverse) = (ply.in_plane(), ply.transverse());
            for (order, &moment) in moments.iter().enumerate() {
                (0..6).for_each(|entry| sums[6 * order + entry] += plane[entry] * moment);
                sums[21 + order] += ply.density * moment;
            }
            (0..3).for_each(|entry| sums[18 + entry] += transverse[entry] * moments[0] * self.shear_factor);
            below = above;
        }
        sums
    }

    /// Why no shell can have this section, in words.
    pub fn mistake(&self) -> Option<String> {
        if self.plies.is_empty() {
            return Some("it has no plies".into());
        }
        self.plies.iter().enumerate().find_map(|(place, ply)| {
            let [e1, e2] = ply.young;
            let sizes = [("thickness", ply.thickness), ("E_1", e1), ("E_2", e2)];
            let shear = ["G_12", "G_13", "G_23"].into_iter().zip(ply.shear);
            let wrong = sizes.into_iter().chain(shear).find(|(_, size)| !(size.value() > 0.0 && size.value().is_finite()));
            if let Some((name, size)) = wrong {
                return Some(format!(
                    "{name} of ply {} is {}; it must be greater than 0",
                    place + 1,
                    shortest(size.value())
                ));
            }
            let square = ply.poisson.value().powi(2) * e2.value() / e1.value();
            let name = place + 1;
            (!(square < 1.0)).then(|| format!("nu_12^2 E_2 / E_1 of ply {name} is {}; it must be below 1", shortest(square)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::flexible::Material;
    use std::f64::consts::PI;

    fn carbon(angle: f64) -> Ply<f64> {
        let (young, shear) = ([140e9, 10e9], [5e9, 5e9, 3e9]);
        Ply { thickness: 1e-3, angle, young, poisson: 0.3, shear, density: 1600.0 }
    }

    fn assert_close(own: &[f64], expected: &[f64]) {
        let scale = expected.iter().fold(0.0, |scale: f64, x| scale.max(x.abs()));
        assert!(own.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-13 * scale), "{own:?} {expected:?}");
    }

    #[test]
    fn isotropic_plies_make_an_isotropic_plate_wherever_they_are_cut_and_turned() {
        let material = Material { young: 70e9, poisson: 0.3, density: 2700.0 };
        let (h, plane) = (4e-3, 70e9 / 0.91);
        for shares in [vec![1.0], vec![0.3, 0.7], vec![0.2, 0.5, 0.3]] {
            let ply = |(place, &share): (usize, &f64)| Ply { angle: place as f64, ..Ply::isotropic(&material, h * share) };
            let numbers = Laminate::new(shares.iter().enumerate().map(ply).collect()).numbers();
            let c = [plane, 0.3 * plane, 0.0, plane, 0.0, 0.35 * plane];
            assert_close(&numbers[..6], &c.map(|c| c * h));
            assert!(numbers[6..12].iter().all(|b| b.abs() < 1e-9 * plane * h * h));
            assert_close(&numbers[12..18], &c.map(|c| c * h.powi(3) / 12.0));
            assert_close(&numbers[18..21], &[1.0, 0.0, 1.0].map(|s| s * 5.0 / 6.0 * 0.35 * plane * h));
            assert_close(&numbers[21..], &[2700.0 * h, 0.0, 2700.0 * h.powi(3) / 12.0]);
        }
    }

    #[test]
    fn turned_by_a_right_angle_along_and_across_change_places() {
        let (straight, turned) =
            (Laminate::new(vec![carbon(0.0)]).numbers(), Laminate::new(vec![carbon(0.5 * PI)]).numbers());
        for first in [0, 12] {
            let [a, b, _, d, _, f] = straight[first..first + 6] else { unreachable!() };
            assert_close(&turned[first..first + 6], &[d, b, 0.0, a, 0.0, f]);
        }
        assert_close(&turned[18..21], &[straight[20], 0.0, straight[18]]);
    }

    #[test]
    fn an_offset_moves_all_moments_to_another_surface() {
        let plies = || vec![carbon(0.3), carbon(-0.8), carbon(1.2)];
        let (own, moved, z) = (Laminate::new(plies()).numbers(), Laminate::new(plies()).offset(2e-3).numbers(), 2e-3);
        for entry in 0..6 {
            let [a, b, d] = [own[entry], own[6 + entry], own[12 + entry]];
            assert_close(&[moved[6 + entry], moved[12 + entry]], &[b + z * a, d + 2.0 * z * b + z * z * a]);
        }
        let [m, m1, m2] = own[21..] else { unreachable!() };
        assert_close(&moved[21..], &[m, m1 + z * m, m2 + 2.0 * z * m1 + z * z * m]);
    }
}
