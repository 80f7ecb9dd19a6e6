use super::STRAINS;
use crate::elements::Parameter;
use crate::scalar::Scalar;
use smallvec::SmallVec;
use std::f64::consts::{PI, TAU};

/// How section forces become stresses at points on the outline of a section, about axes of symmetry:
///
/// sigma = N1 / A + x3 M2 / I2 - x2 M3 / I3,   tau = t M1 + s2 k3 N3 - s3 k2 N2,
///
/// sigma_vm = sqrt(sigma^2 + 3 tau^2),
///
/// (x2, x3) = (s2 a2, s3 a3) for outer half sizes a, and tau along the outline, counterclockwise seen against axis 1.
/// Forces and moments are those about the centroid, moments M1 + o3 N2 - o2 N3, M2 - o3 N1, M3 + o2 N1 of a section
/// that lies at (o2, o3) beside the line.
///
/// * rectangle and box: (s2, s3) are the four corners and the four middles of the edges; circle and tube: 16 points all
///   around, between which a bending stress is at most 1.9 % above those of the points
/// * torsion: t of a circle and a tube is exact; of a rectangle by the series of Saint-Venant, 0 in the corners; of a
///   box Bredt's for thin walls
/// * shear, Jourawski's: k = 3/2 / A of a rectangle in the middles, 0 in the corners; of thin walls by their shear
///   flow; of a tube 4/3 (R^2 + R r + r^2) / (R^2 + r^2) / A, of a circle 4/3 / A
///
/// Shear by Jourawski is constant across a section; at the edges of a rectangle the exact one is larger, 1.13 times in a
/// square, 1.4 times in one that is twice as wide as it is high along the force. There are no stresses of restrained
/// warping, nor concentrations where loads enter.
///
/// Source: Timoshenko & Goodier, Theory of Elasticity, sections 109 (torsion of a rectangle), 116 (of thin tubes), 124
/// (shear of a rectangle).
#[derive(Clone, Copy, Debug)]
pub struct OutlineStress<S> {
    /// Points all around instead of corners and middles of edges.
    pub round: bool,
    /// A \[m2\].
    pub area: S,
    /// I2, I3 \[m4\].
    pub second_moments: [S; 2],
    /// a2, a3 \[m\].
    pub half_sizes: [S; 2],
    /// t in the corners (or all around), in the middles at s2 = -+1, and at s3 = -+1 [1/m3].
    pub torsion: [S; 3],
    /// k2 and k3 in the corners (or all around) [1/m2].
    pub shear_in_corners: [S; 2],
    /// k2 and k3 in the middles of the edges along axes 2 and 3 [1/m2].
    pub shear_in_middles: [S; 2],
    /// (o2, o3) \[m\].
    pub offset: [S; 2],
}

/// Points around a circle.
const AROUND: usize = 16;
/// How many numbers it has.
const NUMBERS: usize = 14;

impl<S: Scalar> OutlineStress<S> {
    /// Of a solid rectangle with this torsion constant \[m4\].
    pub(super) fn rectangle([width, height]: [S; 2], area: S, second_moments: [S; 2], constant: S) -> Self {
        let middle = area.recip() * 1.5;
        OutlineStress {
            round: false,
            area,
            second_moments,
            half_sizes: [width * 0.5, height * 0.5],
            torsion: [S::zero(), edge_torsion(width, height) / constant, edge_torsion(height, width) / constant],
            shear_in_corners: [S::zero(); 2],
            shear_in_middles: [middle; 2],
            offset: [S::zero(); 2],
        }
    }

    /// Of a hollow rectangle with a thin wall.
    pub(super) fn hollow([width, height]: [S; 2], wall: S, area: S, second_moments: [S; 2]) -> Self {
        // middle lines: the flow starts from 0 in the middles of the walls across the force
        let [b, h] = [width - wall, height - wall];
        let [i2, i3] = second_moments;
        let corners = b * h * 0.25;
        OutlineStress {
            round: false,
            area,
            second_moments,
            half_sizes: [width * 0.5, height * 0.5],
            torsion: [(b * h * wall * 2.0).recip(); 3],
            shear_in_corners: [corners / i3, corners / i2],
            shear_in_middles: [(corners + b * b * 0.125) / i3, (corners + h * h * 0.125) / i2],
            offset: [S::zero(); 2],
        }
    }

    /// Of a circular tube, or without a hole of a circle.
    pub(super) fn round([outer, inner]: [S; 2], area: S, second_moment: S) -> Self {
        let [big, small] = [outer * 0.5, inner * 0.5];
        let (sum, squares) = (big * big + big * small + small * small, big * big + small * small);
        let shear = sum / (squares * area) * (4.0 / 3.0);
        OutlineStress {
            round: true,
            area,
            second_moments: [second_moment; 2],
            half_sizes: [big; 2],
            torsion: [big / (second_moment * 2.0); 3],
            shear_in_corners: [shear; 2],
            shear_in_middles: [shear; 2],
            offset: [S::zero(); 2],
        }
    }

    /// Its numbers, in the order of [`OutlineStress::parameters`].
    pub fn numbers(&self) -> [S; NUMBERS] {
        let ([i2, i3], [a2, a3], [t, t2, t3]) = (self.second_moments, self.half_sizes, self.torsion);
        let ([c2, c3], [m2, m3], [o2, o3]) = (self.shear_in_corners, self.shear_in_middles, self.offset);
        [self.area, i2, i3, a2, a3, t, t2, t3, c2, c3, m2, m3, o2, o3]
    }

    /// From its numbers.
    pub fn from_numbers(round: bool, numbers: &[S]) -> Self {
        let &[area, i2, i3, a2, a3, t, t2, t3, c2, c3, m2, m3, o2, o3] = numbers else {
            unreachable!("an outline has {NUMBERS} numbers, not {}", numbers.len())
        };
        OutlineStress {
            round,
            area,
            second_moments: [i2, i3],
            half_sizes: [a2, a3],
            torsion: [t, t2, t3],
            shear_in_corners: [c2, c3],
            shear_in_middles: [m2, m3],
            offset: [o2, o3],
        }
    }

    /// Names and units of its numbers.
    pub fn parameters() -> [Parameter; NUMBERS] {
        [
            ("area", "m2"),
            ("second moment 2", "m4"),
            ("second moment 3", "m4"),
            ("half size 2", "m"),
            ("half size 3", "m"),
            ("torsion in corners", "1/m3"),
            ("torsion in middles 2", "1/m3"),
            ("torsion in middles 3", "1/m3"),
            ("shear 2 in corners", "1/m2"),
            ("shear 3 in corners", "1/m2"),
            ("shear 2 in middles", "1/m2"),
            ("shear 3 in middles", "1/m2"),
            ("offset 2", "m"),
            ("offset 3", "m"),
        ]
        .map(|(name, unit)| Parameter::new(name, unit))
    }

    /// Von Mises stress [N/m2] at all points, from N1, N2, N3 \[N\], M1, M2, M3 [N m] about the line.
    pub fn von_mises(&self, [n1, n2, n3, m1, m2, m3]: [S; STRAINS]) -> SmallVec<[S; AROUND]> {
        let ([o2, o3], [a2, a3], [i2, i3]) = (self.offset, self.half_sizes, self.second_moments);
        let moments = [m1 + o3 * n2 - o2 * n3, m2 - o3 * n1, m3 + o2 * n1];
        let (normal, about_2, about_3) = (n1 / self.area, a3 * moments[1] / i2, a2 * moments[2] / i3);
        let at = |([s2, s3], torsion, [k2, k3]): ([f64; 2], S, [S; 2])| {
            let stress = normal + about_2 * s3 - about_3 * s2;
            let shear = moments[0] * torsion + k3 * n3 * s2 - k2 * n2 * s3;
            (stress * stress + shear * shear * 3.0).sqrt()
        };
        let [t, t2, t3] = self.torsion;
        let (corner, middle) = (self.shear_in_corners, self.shear_in_middles);
        if self.round {
            let around = (0..AROUND).map(|k| TAU * k as f64 / AROUND as f64);
            return around.map(|angle| at(([angle.cos(), angle.sin()], t, corner))).collect();
        }
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|place| (place, t, corner));
        let middles = [-1.0, 1.0].into_iter().flat_map(|s| [([s, 0.0], t2, middle), ([0.0, s], t3, middle)]);
        corners.into_iter().chain(middles).map(at).collect()
    }
}

/// Shear stress in the middle of an edge of a rectangle for each G dtheta/dx \[m\]: `across` from edge to edge, `along`
/// it.
///
/// With the longer side a, the shorter b and x_n = n pi a / (2 b): b (1 - 8/pi^2 sum 1 / (n^2 cosh x_n)) in the middle
/// of the longer side, b 8/pi^2 sum +-tanh x_n / n^2 in that of the shorter one, n odd with alternating signs.
fn edge_torsion<S: Scalar>(across: S, along: S) -> S {
    let is_short = along.less(across);
    let (long, short) = (is_short.select(across, along), is_short.select(along, across));
    let (mut longer, mut shorter) = (S::zero(), S::from(CATALAN));
    for n in (1..=23).step_by(2) {
        let square = f64::from(n * n);
        // what decays is finite for any ratio
        let decay = (-(long / short) * (f64::from(n) * 0.5 * PI)).exp();
        let share = decay / (decay * decay + 1.0) * 2.0;
        longer += share / square;
        shorter -= share * decay * (if n % 4 == 1 { 1.0 } else { -1.0 } / square);
    }
    let factor = 8.0 / (PI * PI);
    short * is_short.select(shorter * factor, -(longer * factor) + 1.0)
}

/// Catalan's constant: the sum of +-1 / n^2 over odd n.
const CATALAN: f64 = 0.915_965_594_177_219;
