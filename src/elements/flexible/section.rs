//! Stiffness and inertia of beam sections, from numbers or from a material and a shape.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::{Outline, OutlineStress, STRAINS};
use crate::design::shortest;
use crate::elements::entries::Range::{Any, AtLeastZero, Positive};
use crate::elements::entries::Type::{Item, Number, Numbers};
use crate::elements::entries::{Forms, Given, Key, forms, may, need};
use crate::scalar::Scalar;
use crate::tolerances::{CONSISTENT, LONG_SUM};
use nalgebra::SMatrix;
use std::f64::consts::PI;
use std::fmt;

/// A material by its name.
pub(crate) const MATERIAL: Key = need("material", Item(&["material"]), "name of a material");

/// Keys of a material.
pub(crate) const MATERIAL_KEYS: Forms = forms!([
    need("young", Number("N/m2", Positive), "Young's modulus E"),
    need("poisson", Number("-", Any), "Poisson's ratio"),
    need("density", Number("kg/m3", AtLeastZero), "density"),
] "" "" []);

/// Sections of beams and cables: of a material and a shape, or by numbers.
pub(crate) const SECTION: Forms = forms!([
    may("damping", Number("s", AtLeastZero), "damping proportional to stiffness; none"),
    may("offset", Numbers(&[2], "m", Any), "of beams: the section moved away from the line along axes 2 and 3; not"),
]
"rectangle" "solid rectangle" [
    MATERIAL,
    need("width", Number("m", Positive), "along axis 2"),
    need("height", Number("m", Positive), "along axis 3"),
]
"box" "hollow rectangle" [
    MATERIAL,
    need("width", Number("m", Positive), "outer size along axis 2"),
    need("height", Number("m", Positive), "outer size along axis 3"),
    need("wall", Number("m", Positive), "thickness of the wall"),
]
"circle" "solid circle" [MATERIAL, need("diameter", Number("m", Positive), "diameter")]
"tube" "circular tube" [
    MATERIAL,
    need("diameter", Number("m", Positive), "outer diameter"),
    need("wall", Number("m", Positive), "thickness of the wall"),
]
"beam" "by stiffness and inertia, for beams" [
    may("axial", Number("N", Positive), "EA; required unless `stiffness` is given, as the next three"),
    may("shear", Numbers(&[2], "N", Positive), "GA along axes 2 and 3, shear factors included"),
    may("torsion", Number("N m2", Positive), "GJ"),
    may("bending", Numbers(&[2], "N m2", Positive), "EI about axes 2 and 3"),
    may("mass", Number("kg/m", AtLeastZero), "mass for each length; 0"),
    may("inertia", Numbers(&[2], "kg m", AtLeastZero), "second moments of mass about axes 2 and 3; 0"),
    may("centre", Numbers(&[2], "m", Any), "mass centre along axes 2 and 3; on the line"),
    may("stiffness", Numbers(&[21], "N, N m, N m2", Any),
        "upper triangle by rows of the symmetric stiffness against axial strain, shear 2 and 3, torsion, bending 2 and 3, \
         instead of the numbers above; diagonal"),
]
"cable" "by stiffness and mass, for cables" [
    need("axial", Number("N", Positive), "EA"),
    need("bending", Number("N m2", Positive), "EI about every axis"),
    need("mass", Number("kg/m", AtLeastZero), "mass for each length"),
]);

/// The material and the shape of a section that is made of these.
pub(crate) type OfShape<S> = Option<(Material<S>, Shape<S>)>;

/// An isotropic elastic material.
#[derive(Clone, Copy, Debug)]
pub struct Material<S> {
    /// Young's modulus E [N/m2].
    pub young: S,
    /// Poisson's ratio [-].
    pub poisson: S,
    /// Density [kg/m3].
    pub density: S,
}

impl<S: Scalar> Material<S> {
    /// Shear modulus G = E / (2 (1 + nu)) [N/m2].
    pub fn shear(&self) -> S {
        self.young / ((self.poisson + 1.0) * 2.0)
    }

    /// What its keys say.
    pub(crate) fn given(given: &mut Given<S>) -> Self {
        let [young, poisson, density] = ["young", "poisson", "density"].map(|key| given.number(key));
        Material { young, poisson, density }
    }
}

/// Stiffness and inertia of a beam section for each length, in section axes (1 along the beam, 2, 3 across).
#[derive(Clone, Copy, Debug)]
pub struct Section<S> {
    /// C: (N1, N2, N3, M1, M2, M3) = C (gamma1 - 1, gamma2, gamma3, kappa1, kappa2, kappa3), symmetric.
    pub stiffness: [[S; STRAINS]; STRAINS],
    /// Mass for each length [kg/m].
    pub mass: S,
    /// Place of the mass centre along axes 2 and 3 \[m\].
    pub centre: [S; 2],
    /// Second moments of mass about axes 2 and 3 through the reference line, and the product integral of x2 x3 [kg m]; the polar one
    /// is the sum of the first two.
    pub inertia: [S; 3],
    /// Damping proportional to stiffness: stress eta C dstrain/dt \[s\].
    pub damping: S,
    /// Whether stiffness has entries off the diagonal, the mass centre lies beside the line, and damping is asked for: topology, so that
    /// a design variable that is zero now can still be differentiated.
    pub(crate) kind: SectionKind,
    /// What it looks like, where it is made of a shape.
    pub(crate) shown: Option<Outline>,
    /// Stresses on its outline, where it is made of a shape that tells them.
    pub stress: Option<OutlineStress<S>>,
    /// A size that its shape cannot have.
    pub(crate) impossible: Option<ImpossibleSize>,
}

/// What the beam's formulas take into account.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SectionKind {
    /// Stiffness off the diagonal.
    pub coupled: bool,
    /// Mass centre beside the line.
    pub eccentric: bool,
    /// Damping.
    pub damped: bool,
}

/// Area, second moments, torsion constant and shear factors of a shape.
#[derive(Clone, Copy, Debug)]
pub struct Shape<S> {
    /// Area \[m2\].
    pub area: S,
    /// Second moments of area: integral of x3^2 and of x2^2 \[m4\], for bending about axes 2 and 3.
    pub(crate) second_moments: [S; 2],
    /// Torsion constant \[m4\].
    pub torsion: S,
    /// Shear factors along axes 2 and 3 [-].
    pub shear: [S; 2],
    /// Outer sizes along axes 2 and 3 \[m\], and whether it is round.
    pub outer: ([S; 2], bool),
    /// Stresses on its outline, if it is known.
    pub stress: Option<OutlineStress<S>>,
    /// A size that no shape has, told when a beam or a cable is made of it.
    pub(crate) impossible: Option<ImpossibleSize>,
}

/// A size of a shape that is not greater than 0, or a wall without room \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpossibleSize {
    name: &'static str,
    value: f64,
    /// The name and half the value of the size that a wall must fit in.
    within: Option<(&'static str, f64)>,
}

impl ImpossibleSize {
    /// The first of some sizes that is not greater than 0.
    fn among<S: Scalar>(sizes: &[(&'static str, S)]) -> Option<Self> {
        let named = sizes.iter().map(|&(name, size)| ImpossibleSize { name, value: size.value(), within: None });
        named.into_iter().find(|size| !(size.value > 0.0 && size.value.is_finite()))
    }

    /// The same for outer sizes and a wall, which is at most half of each of them.
    fn of_hollow<S: Scalar>(outer: &[(&'static str, S)], wall: S) -> Option<Self> {
        let thick = |&(name, size): &(&'static str, S)| {
            let half = 0.5 * size.value();
            let own = ImpossibleSize { name: "wall", value: wall.value(), within: Some((name, half)) };
            (own.value > half * (1.0 + LONG_SUM)).then_some(own)
        };
        Self::among(outer).or(Self::among(&[("wall", wall)])).or_else(|| outer.iter().find_map(thick))
    }
}

impl fmt::Display for ImpossibleSize {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let ImpossibleSize { name, value, within } = self;
        write!(f, "its {name} is {} m; it must be greater than 0", shortest(*value))?;
        within.map_or(Ok(()), |(outer, half)| write!(f, " and at most half of its {outer}, {} m", shortest(half)))
    }
}

impl<S: Scalar> Shape<S> {
    /// The shape of a form of [`SECTION`], from its sizes in the order of its keys; none of a form by numbers.
    pub(crate) fn of_form(form: &str, sizes: &[S], poisson: S) -> Option<Self> {
        Some(match (form, sizes) {
            ("rectangle", &[width, height]) => Self::rectangle(width, height, poisson),
            ("box", &[width, height, wall]) => Self::box_section(width, height, wall, poisson),
            ("circle", &[diameter]) => Self::circle(diameter, poisson),
            ("tube", &[diameter, wall]) => Self::tube(diameter, wall, poisson),
            _ => return None,
        })
    }

    /// Solid rectangle, `width` along axis 2 and `height` along axis 3 \[m\].
    ///
    /// Shear factors 10 (1 + nu) / (12 + 11 nu): Cowper (1966). Torsion: series of Saint-Venant, Timoshenko & Goodier, section 109.
    pub fn rectangle(width: S, height: S, poisson: S) -> Self {
        let factor = (poisson + 1.0) * 10.0 / (poisson * 11.0 + 12.0);
        let (area, torsion) = (width * height, rectangle_torsion(width, height));
        let second_moments = [width * height.powi(3) / 12.0, height * width.powi(3) / 12.0];
        Shape {
            area,
            second_moments,
            torsion,
            shear: [factor; 2],
            outer: ([width, height], false),
            stress: Some(OutlineStress::rectangle([width, height], area, second_moments, torsion)),
            impossible: ImpossibleSize::among(&[("width", width), ("height", height)]),
        }
    }

    /// Hollow rectangle of outer `width` and `height` with a thin `wall` \[m\].
    ///
    /// Shear factors: Cowper (1966), thin-walled box. Torsion: Bredt's formula on the middle line.
    pub fn box_section(width: S, height: S, wall: S, poisson: S) -> Self {
        let (inner_width, inner_height) = (width - wall * 2.0, height - wall * 2.0);
        let moment = |b: S, h: S| b * h.powi(3) / 12.0;
        let (b, h) = (width - wall, height - wall);
        let area = width * height - inner_width * inner_height;
        let second_moments = [
            moment(width, height) - moment(inner_width, inner_height),
            moment(height, width) - moment(inner_height, inner_width),
        ];
        Shape {
            area,
            second_moments,
            torsion: b * b * h * h * wall * 2.0 / (b + h),
            shear: [box_shear_factor(h, b, poisson), box_shear_factor(b, h, poisson)],
            outer: ([width, height], false),
            stress: Some(OutlineStress::hollow([width, height], wall, area, second_moments)),
            impossible: ImpossibleSize::of_hollow(&[("width", width), ("height", height)], wall),
        }
    }

    /// Solid circle of `diameter` \[m\]. Shear factor 6 (1 + nu) / (7 + 6 nu): Cowper (1966).
    pub fn circle(diameter: S, poisson: S) -> Self {
        let fourth = diameter.powi(4) * (PI / 64.0);
        let factor = (poisson + 1.0) * 6.0 / (poisson * 6.0 + 7.0);
        let area = diameter * diameter * (PI / 4.0);
        Shape {
            area,
            second_moments: [fourth; 2],
            torsion: fourth * 2.0,
            shear: [factor; 2],
            outer: ([diameter; 2], true),
            stress: Some(OutlineStress::round([diameter, S::zero()], area, fourth)),
            impossible: ImpossibleSize::among(&[("diameter", diameter)]),
        }
    }

    /// Circular tube of outer `diameter` and `wall` \[m\]. Shear factor: Cowper (1966), hollow circle.
    pub fn tube(diameter: S, wall: S, poisson: S) -> Self {
        let inner = diameter - wall * 2.0;
        let fourth = (diameter.powi(4) - inner.powi(4)) * (PI / 64.0);
        let ratio = inner / diameter;
        let square = ratio * ratio;
        let sum = (square + 1.0) * (square + 1.0);
        let factor = (poisson + 1.0) * sum * 6.0 / ((poisson * 6.0 + 7.0) * sum + (poisson * 12.0 + 20.0) * square);
        let area = (diameter * diameter - inner * inner) * (PI / 4.0);
        Shape {
            area,
            second_moments: [fourth; 2],
            torsion: fourth * 2.0,
            shear: [factor; 2],
            outer: ([diameter; 2], true),
            stress: Some(OutlineStress::round([diameter, inner], area, fourth)),
            impossible: ImpossibleSize::of_hollow(&[("diameter", diameter)], wall),
        }
    }
}

impl<S: Scalar> Shape<S> {
    /// What it looks like, of a material with this Young's modulus [N/m2].
    pub(crate) fn outline(&self, young: S) -> Outline {
        let (sizes, round) = self.outer;
        Outline { sizes: sizes.map(Scalar::value), middle: [0.0; 2], round, young: Some(young.value()) }
    }
}

/// Torsion constant of a rectangle: a b^3 / 3 (1 - 192 b / (pi^5 a) sum tanh(n pi a / (2 b)) / n^5), n odd, b the shorter side.
fn rectangle_torsion<S: Scalar>(width: S, height: S) -> S {
    let taller = width.less(height);
    let (long, short) = (taller.select(height, width), taller.select(width, height));
    let ratio = long / short;
    // the sum with tanh = 1, which it is to the last digit after a few terms, and what these few miss
    let mut sum = S::from(31.0 / 32.0 * ZETA_OF_FIVE);
    for n in (1..=25).step_by(2) {
        let n = f64::from(n);
        sum += ((ratio * (n * PI / 2.0)).tanh() - 1.0) / n.powi(5);
    }
    long * short.powi(3) / 3.0 * (S::one() - sum / ratio * (192.0 / PI.powi(5)))
}

/// Riemann's zeta(5); the sum of 1 / n^5 over odd n is 31/32 of it.
const ZETA_OF_FIVE: f64 = 1.036_927_755_143_37;

/// Shear factor of a thin-walled box for shear along its `depth`, with flanges of `breadth`, all walls alike.
fn box_shear_factor<S: Scalar>(breadth: S, depth: S, poisson: S) -> S {
    // m = b t1 / (h t), n = b / h
    let m = breadth / depth;
    let square = m * m;
    let numerator = (poisson + 1.0) * (m * 3.0 + 1.0) * (m * 3.0 + 1.0) * 10.0;
    let cube = square * m;
    let bending = m * 72.0 + square * 150.0 + cube * 90.0 + 12.0;
    let lateral = (m * 66.0 + square * 135.0 + cube * 90.0 + 11.0) * poisson;
    let flanges = square * ((poisson + 3.0) * m + square * 3.0) * 10.0;
    numerator / (bending + lateral + flanges)
}

impl<S: Scalar> Section<S> {
    /// What the keys of [`SECTION`] say.
    pub(crate) fn given(given: &mut Given<S>, of: OfShape<S>) -> Self {
        let mut section = match of {
            Some((material, shape)) => Section::of(material, shape),
            None if given.has("stiffness") => Section::new([S::one(); STRAINS]),
            None => {
                let [[shear_2, shear_3], [bending_2, bending_3]] = ["shear", "bending"].map(|key| given.numbers(key));
                let [axial, torsion] = ["axial", "torsion"].map(|key| given.number(key));
                Section::new([axial, shear_2, shear_3, torsion, bending_2, bending_3])
            }
        };
        if of.is_none() {
            section = section.with_inertia(given.number_or("mass", S::zero()), given.numbers_or_zero("inertia"));
        }
        if given.has("centre") {
            section = section.with_centre(given.numbers("centre"));
        }
        if given.has("stiffness") {
            for key in ["axial", "shear", "torsion", "bending"].into_iter().filter(|key| given.has(key)).collect::<Vec<_>>()
            {
                let text = format!("{key} has no effect beside stiffness, which holds all of them: leave one out");
                given.wrong_key(key, text);
            }
            let (upper, mut stiffness): ([S; 21], _) = (given.numbers("stiffness"), [[S::zero(); STRAINS]; STRAINS]);
            let places = (0..STRAINS).flat_map(|i| (i..STRAINS).map(move |j| (i, j)));
            for ((i, j), own) in places.zip(upper) {
                stiffness[i][j] = own;
                stiffness[j][i] = own;
            }
            section = section.with_stiffness(stiffness);
        }
        if given.has("damping") {
            section = section.damped(given.number("damping"));
        }
        if given.has("offset") { section.offset(given.numbers("offset")) } else { section }
    }

    /// A section by its stiffnesses EA, GA2, GA3 \[N\], GJ, EI2, EI3 [N m2], without inertia.
    pub fn new(stiffnesses: [S; STRAINS]) -> Self {
        let mut stiffness = [[S::zero(); STRAINS]; STRAINS];
        (0..STRAINS).for_each(|i| stiffness[i][i] = stiffnesses[i]);
        let (mass, damping) = (S::zero(), S::zero());
        let (centre, inertia) = ([S::zero(); 2], [S::zero(); 3]);
        let kind = SectionKind::default();
        Section { stiffness, mass, centre, inertia, damping, kind, shown: None, stress: None, impossible: None }
    }

    /// A section of a material and a shape.
    pub fn of(material: Material<S>, shape: Shape<S>) -> Self {
        let Material { young, density, .. } = material;
        let (shear, area) = (material.shear(), shape.area);
        let [second, third] = shape.second_moments;
        let [k2, k3] = shape.shear;
        let section = Section::new([
            young * area,
            shear * area * k2,
            shear * area * k3,
            shear * shape.torsion,
            young * second,
            young * third,
        ])
        .with_inertia(density * area, [density * second, density * third]);
        Section { shown: Some(shape.outline(young)), stress: shape.stress, impossible: shape.impossible, ..section }
    }

    /// What it looks like: the shape it is made of, or a rectangle as stiff.
    pub(crate) fn outline(&self) -> Outline {
        let own = &self.stiffness;
        self.shown.unwrap_or_else(|| Outline::of_stiffness(own[0][0], [own[4][4], own[5][5]]))
    }

    /// Why no beam can have this section, in words: a size of its shape, or a stiffness that is not symmetric and positive definite.
    pub fn mistake(&self) -> Option<String> {
        if let Some(size) = self.impossible {
            return Some(size.to_string());
        }
        let stiffness = self.stiffness.map(|row| row.map(Scalar::value));
        if let Some(i) = (0..STRAINS).find(|&i| !(stiffness[i][i] > 0.0 && stiffness[i][i].is_finite())) {
            let (row, entry) = (i + 1, shortest(stiffness[i][i]));
            return Some(format!("its stiffness in row {row}, column {row} is {entry}; it must be greater than 0"));
        }
        // strains have different units: each is measured by its own energy
        let scaled = |i: usize, j: usize| stiffness[i][j] / (stiffness[i][i].sqrt() * stiffness[j][j].sqrt());
        let pairs = (0..STRAINS).flat_map(|i| (0..i).map(move |j| (j, i)));
        if let Some((i, j)) = pairs.into_iter().find(|&(i, j)| !((scaled(i, j) - scaled(j, i)).abs() <= CONSISTENT)) {
            let (row, column, own, other) = (i + 1, j + 1, shortest(stiffness[i][j]), shortest(stiffness[j][i]));
            return Some(format!(
                "its stiffness in row {row}, column {column} is {own}, but {other} in row {column}, column {row}; it must be symmetric"
            ));
        }
        let least = SMatrix::<f64, STRAINS, STRAINS>::from_fn(scaled).symmetric_eigenvalues().min();
        (!(least > 0.0)).then(|| {
            format!(
                "its stiffness is not positive definite: scaled to a diagonal of 1, its smallest eigenvalue is {least:.3e}"
            )
        })
    }

    /// With mass [kg/m] and second moments of mass about axes 2 and 3 [kg m].
    #[must_use]
    pub fn with_inertia(mut self, mass: S, [second, third]: [S; 2]) -> Self {
        self.mass = mass;
        self.inertia = [second, third, S::zero()];
        self
    }

    /// With the mass centre at (x2, x3) \[m\] beside the reference line, about which the second moments of mass are already.
    #[must_use]
    pub fn with_centre(mut self, centre: [S; 2]) -> Self {
        self.centre = centre;
        self.kind.eccentric = true;
        self
    }

    /// With stiffness off the diagonal: any symmetric matrix, which is that of no shape any more.
    #[must_use]
    pub fn with_stiffness(mut self, stiffness: [[S; STRAINS]; STRAINS]) -> Self {
        self.stiffness = stiffness;
        self.stress = None;
        self.kind.coupled = true;
        self
    }

    /// With damping proportional to stiffness, eta \[s\].
    #[must_use]
    pub fn damped(mut self, damping: S) -> Self {
        self.damping = damping;
        self.kind.damped = true;
        self
    }

    /// The same section moved by (x2, x3) \[m\] away from the reference line: stiffness and inertia about the line.
    #[must_use]
    pub fn offset(mut self, [x2, x3]: [S; 2]) -> Self {
        let mut moved_outline = self.outline();
        moved_outline.middle = [moved_outline.middle[0] + x2.value(), moved_outline.middle[1] + x3.value()];
        // strains at the section's own origin: gamma + kappa x (0, x2, x3)
        let mut moved = [[S::zero(); STRAINS]; STRAINS];
        (0..STRAINS).for_each(|i| moved[i][i] = S::one());
        moved[0][4] = x3;
        moved[0][5] = -x2;
        moved[1][3] = -x3;
        moved[2][3] = x2;
        let own = self.stiffness;
        self.stiffness = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let terms = (0..STRAINS).flat_map(|k| (0..STRAINS).map(move |l| (k, l)));
                terms.fold(S::zero(), |sum, (k, l)| sum + moved[k][i] * own[k][l] * moved[l][j])
            })
        });
        let [c2, c3] = self.centre;
        let [i2, i3, i23] = self.inertia;
        self.inertia = [
            i2 + self.mass * (c3 * x3 * 2.0 + x3 * x3),
            i3 + self.mass * (c2 * x2 * 2.0 + x2 * x2),
            i23 + self.mass * (c2 * x3 + c3 * x2 + x2 * x3),
        ];
        self.centre = [c2 + x2, c3 + x3];
        self.shown = Some(moved_outline);
        if let Some(OutlineStress { offset: [o2, o3], .. }) = &mut self.stress {
            (*o2, *o3) = (*o2 + x2, *o3 + x3);
        }
        self.kind.coupled = true;
        self.kind.eccentric = true;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangle_torsion_matches_the_tables_of_timoshenko_and_goodier() {
        // J = k a b^3 with a / b = 1, 2, 10: section 109, table of k1, three digits
        for (ratio, factor) in [(1.0, 0.1406), (2.0, 0.229), (10.0, 0.312)] {
            assert!((rectangle_torsion(ratio, 1.0) / ratio - factor).abs() < 6e-4);
            assert!((rectangle_torsion(1.0, ratio) - rectangle_torsion(ratio, 1.0)).abs() < 1e-15);
        }
        // the square: 0.1405770149...
        assert!((rectangle_torsion(1.0, 1.0) - 0.140_577_014_9).abs() < 1e-9);
    }

    #[test]
    fn tubes_become_circles_and_thin_tubes_have_half_their_shear_stiffness() {
        let (solid, full) = (Shape::<f64>::circle(0.2, 0.3), Shape::tube(0.2, 0.1, 0.3));
        assert!((solid.shear[0] - full.shear[0]).abs() < 1e-15 && (solid.torsion - full.torsion).abs() < 1e-18);
        // Cowper: 2 (1 + nu) / (4 + 3 nu)
        let thin = Shape::<f64>::tube(1.0, 1e-6, 0.3);
        assert!((thin.shear[0] - 2.6 / 4.9).abs() < 1e-6);
    }

    #[test]
    fn moving_a_section_there_and_back_changes_nothing() {
        let material = Material { young: 2e11, poisson: 0.3, density: 7800.0 };
        let own = Section::of(material, Shape::<f64>::box_section(0.1, 0.2, 0.01, 0.3));
        let back = own.offset([0.3, -0.2]).offset([-0.3, 0.2]);
        for i in 0..STRAINS {
            for j in 0..STRAINS {
                let scale = (own.stiffness[i][i] * own.stiffness[j][j]).sqrt();
                assert!((own.stiffness[i][j] - back.stiffness[i][j]).abs() < 1e-12 * scale.max(2e9));
            }
        }
        assert!((0..3).all(|i| (own.inertia[i] - back.inertia[i]).abs() < 1e-12));
    }
}
