use super::shape::{AT_GAUSS_POINTS, AT_TYING_POINTS, NODES};
use crate::elements::{Field, Flexible, Interpolation, NodeKind, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, tensor_times};
use std::ops::Range;

/// Geometrically exact Timoshenko beam of three nodes with position r and Euler parameters e.
///
/// All nodes start with the same e, and the section axes (t, n2, n3) of the reference are parameters in the frame of the nodes: an
/// element may be curved and twisted, and joins others or rigid bodies at any angle. Between nodes, r and e are quadratic and R is the
/// rotation of e / |e|, so that strains do not change under a rigid motion of the nodes and do not depend on the path.
/// With dS = J dxi along the reference,
///
/// gamma = Lambda^T R^T dr/dS - (1, 0, 0),   kappa = Lambda^T 2 G(e) de/dS / |e|^2,   Lambda = [t n2 n3],
///
/// V = sum over two tying points of J/2 strain . C strain. Strains are taken at xi = -+ 1/sqrt(3) and linear between (MITC), where the
/// two points integrate their energy exactly: no locking, no mode without energy beside rigid motions. Shares of kinetic energy at
/// three Gauss points: m/2 |dr/dt|^2 + dr/dt . R (omega x s) + omega . J omega / 2. Damping proportional to stiffness adds the stress
/// eta C dstrain/dt.
///
/// Parameters of each tying point:
/// * `metric`  J \[m\]
/// * `tangent`, `second axis`  t and n2, unit vectors at right angles in the frame of the nodes; n3 = t x n2
/// * `stiffness 11..66`  EA, GA2, GA3 \[N\], GJ, EI2, EI3 [N m2], and with [`coupled`](BeamField::coupled) the other entries of C above the
///   diagonal, by rows
/// * `damping`  eta \[s\], with [`damped`](BeamField::damped)
///
/// of each Gauss point: `mass` \[kg\], first moment s [kg m] and inertia [kg m2] about the reference line, in the frame of the nodes,
/// each for its share of the length.
///
/// Source: Simo & Vu-Quoc (1986); Boopathy & Kennedy, section 3, with Euler parameters interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BeamField {
    /// C has entries off its diagonal.
    pub coupled: bool,
    /// With damping proportional to stiffness.
    pub damped: bool,
    /// The mass centre of the sections lies beside the reference line.
    pub eccentric: bool,
}

/// The beam as an element.
pub type Beam = Flexible<BeamField>;

/// Number of tying points.
pub const TYING_POINTS: usize = 2;
/// Number of strains.
pub const STRAINS: usize = 6;
/// Metric and two axes.
pub(super) const GEOMETRY: usize = 7;
/// Mass, first moment, inertia.
pub(super) const INERTIA: usize = 10;

/// What a tying point knows of the reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference<S> {
    pub metric: S,
    /// Columns of Lambda.
    pub axes: [Vector3<S>; 3],
}

impl<S: Scalar> Reference<S> {
    #[inline(always)]
    pub fn of(p: &[S]) -> Self {
        let (tangent, second) = (Vector3::first_three(&p[1..]), Vector3::first_three(&p[4..]));
        Reference { metric: p[0], axes: [tangent, second, tangent.cross(&second)] }
    }
    /// Lambda^T x.
    #[inline(always)]
    pub fn components(&self, x: Vector3<S>) -> [S; 3] {
        [self.axes[0].dot(&x), self.axes[1].dot(&x), self.axes[2].dot(&x)]
    }
    /// Strains from h = (dr/dxi, e, de/dxi).
    #[inline(always)]
    fn strains(&self, h: &[S]) -> [S; STRAINS] {
        let (slope, e, turn) = (Vector3::first_three(h), Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&h[7..]));
        let scale = (e.norm_squared() * self.metric).recip();
        let gamma = self.components(e.rotate_back(slope) * scale);
        let kappa = self.components(e.g_times(turn) * (scale + scale));
        [gamma[0] - 1.0, gamma[1], gamma[2], kappa[0], kappa[1], kappa[2]]
    }
}

impl BeamField {
    /// Number of stiffnesses.
    #[inline(always)]
    fn stiffnesses(&self) -> usize {
        if self.coupled { 21 } else { STRAINS }
    }
    /// Number of parameters of a tying point.
    #[inline(always)]
    pub(crate) fn tying_parameters(&self) -> usize {
        GEOMETRY + self.stiffnesses() + usize::from(self.damped)
    }

    /// C strain.
    #[inline(always)]
    pub(super) fn stiffness_times<S: Scalar>(&self, stiffness: &[S], strain: [S; STRAINS]) -> [S; STRAINS] {
        let mut stress = strain;
        for i in 0..STRAINS {
            stress[i] *= stiffness[i];
        }
        if self.coupled {
            let mut entry = STRAINS;
            for i in 0..STRAINS {
                for j in i + 1..STRAINS {
                    stress[i] += stiffness[entry] * strain[j];
                    stress[j] += stiffness[entry] * strain[i];
                    entry += 1;
                }
            }
        }
        stress
    }

    /// Strains at a tying point, from h and the point's parameters.
    pub fn strains<S: Scalar>(h: &[S], p: &[S]) -> [S; STRAINS] {
        Reference::of(p).strains(h)
    }

    /// Section forces N1, N2, N3 \[N\] and moments M1, M2, M3 [N m] at a tying point, from strains and their rates.
    pub fn section_forces<S: Scalar>(&self, strain: [S; STRAINS], rate: [S; STRAINS], p: &[S]) -> [S; STRAINS] {
        let mut together = strain;
        if self.damped {
            let damping = p[GEOMETRY + self.stiffnesses()];
            for i in 0..STRAINS {
                together[i] += damping * rate[i];
            }
        }
        self.stiffness_times(&p[GEOMETRY..], together)
    }
}

impl Field for BeamField {
    const NODES: usize = NODES;
    const NODE: NodeKind = NodeKind::Body;
    const POINTS: &'static [&'static [Interpolation]] =
        &[&AT_TYING_POINTS[0], &AT_TYING_POINTS[1], &AT_GAUSS_POINTS[0], &AT_GAUSS_POINTS[1], &AT_GAUSS_POINTS[2]];

    fn parameters(&self) -> Vec<Parameter> {
        let mut list = Vec::new();
        for point in 1..=TYING_POINTS {
            let own = |name: &str, unit| Parameter::named(format!("tying point {point}: {name}"), unit);
            let mut add = |name: &str, unit| list.push(own(name, unit));
            add("metric", "m");
            for axis in ["tangent x", "tangent y", "tangent z", "second axis x", "second axis y", "second axis z"] {
                add(axis, "-");
            }
            let unit = |i: usize, j: usize| match (i < 3, j < 3) {
                (true, true) => "N",
                (false, false) => "N m2",
                _ => "N m",
            };
            list.extend((0..STRAINS).map(|i| own(&format!("stiffness {0}{0}", i + 1), unit(i, i)).as_size()));
            if self.coupled {
                for i in 0..STRAINS {
                    let pair = |j| own(&format!("stiffness {}{}", i + 1, j + 1), unit(i, j)).as_size();
                    list.extend((i + 1..STRAINS).map(pair));
                }
            }
            if self.damped {
                list.push(own("damping", "s"));
            }
        }
        for point in 1..=3 {
            let mut add = |name: &str, unit| list.push(Parameter::named(format!("Gauss point {point}: {name}"), unit));
            add("mass", "kg");
            ["first moment x", "first moment y", "first moment z"].into_iter().for_each(|name| add(name, "kg m"));
            ["inertia xx", "inertia yy", "inertia zz", "inertia xy", "inertia xz", "inertia yz"]
                .into_iter()
                .for_each(|name| add(name, "kg m2"));
        }
        list
    }

    #[inline(always)]
    fn parameters_of(&self, point: usize) -> Range<usize> {
        let own = self.tying_parameters();
        if point < TYING_POINTS {
            return point * own..(point + 1) * own;
        }
        let first = TYING_POINTS * own + (point - TYING_POINTS) * INERTIA;
        first..first + INERTIA
    }

    fn kinetic<S: Scalar>(&self, point: usize, v: &[S], h: &[S], p: &[S]) -> S {
        if point < TYING_POINTS {
            return S::zero();
        }
        let (velocity, e, rate) =
            (Vector3::first_three(v), Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&v[3..]));
        let inverse = e.norm_squared().recip();
        let omega = e.g_times(rate) * (inverse + inverse);
        let mut twice = velocity.dot(&velocity) * p[0] + omega.dot(&tensor_times(&p[4..], omega));
        if self.eccentric {
            let swing = e.rotate(omega.cross(&Vector3::first_three(&p[1..]))) * inverse;
            twice += velocity.dot(&swing) * 2.0;
        }
        twice * 0.5
    }

    fn strain_count(&self, point: usize) -> usize {
        if point < TYING_POINTS { STRAINS } else { 0 }
    }

    fn strains<S: Scalar>(&self, _point: usize, h: &[S], p: &[S], e: &mut [S]) {
        e.copy_from_slice(&Reference::of(p).strains(h));
    }

    fn stored<S: Scalar>(&self, _point: usize, e: &[S], p: &[S]) -> S {
        let Some(&strain) = e.first_chunk::<STRAINS>() else { return S::zero() };
        let stress = self.stiffness_times(&p[GEOMETRY..], strain);
        let mut twice = S::zero();
        for i in 0..STRAINS {
            twice += strain[i] * stress[i];
        }
        twice * p[0] * 0.5
    }

    fn damping<S: Scalar>(&self, _point: usize, _e: &[S], rate: &[S], p: &[S], s: &mut [S]) {
        if let Some(&rate) = rate.first_chunk::<STRAINS>().filter(|_| self.damped) {
            let stress = self.stiffness_times(&p[GEOMETRY..], rate);
            let share = p[GEOMETRY + self.stiffnesses()] * p[0];
            for i in 0..STRAINS {
                s[i] = stress[i] * share;
            }
        }
    }

    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        (TYING_POINTS..Self::POINTS.len()).map(|point| p[self.parameters_of(point).start]).sum()
    }
}
