use super::beam_matrix::{add_inertia_matrix, add_strain_matrix};
use super::beam_products::{add_inertia_products, add_strain_products};
use super::shape::{AT_GAUSS_POINTS, AT_TYING_POINTS, NODES};
use crate::elements::{Field, Flexible, Interpolation, Parameter, PointGradient, State, Wide, point_momentum_rate};
use crate::scalar::{Dual, Quaternion, Scalar, SpatialVector, Vector3, rotation_gradient_transposed, tensor_times};
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
/// * `metric`  J [m]
/// * `tangent`, `second axis`  t and n2, unit vectors at right angles in the frame of the nodes; n3 = t x n2
/// * `stiffness 11..66`  EA, GA2, GA3 [N], GJ, EI2, EI3 [N m2], and with [`coupled`](BeamField::coupled) the other entries of C above the
///   diagonal, by rows
/// * `damping`  eta [s], with [`damped`](BeamField::damped)
///
/// of each Gauss point: `mass` [kg], first moment s [kg m] and inertia [kg m2] about the reference line, in the frame of the nodes,
/// each for its share of the length.
///
/// Source: Simo & Vu-Quoc (1986); Boopathy & Kennedy, section 3, with Euler parameters interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// Lambda x.
    #[inline(always)]
    pub fn combine(&self, x: [S; 3]) -> Vector3<S> {
        self.axes[0] * x[0] + self.axes[1] * x[1] + self.axes[2] * x[2]
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

    /// Stiffnesses among the parameters of a tying point, and damping, which may be zero.
    #[inline(always)]
    pub(super) fn stiffness_and_damping<'p>(&self, p: &'p [f64]) -> (&'p [f64], f64) {
        let (stiffness, rest) = p[GEOMETRY..].split_at(self.stiffnesses());
        (stiffness, if self.damped { rest[0] } else { 0.0 })
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
    pub fn strains<S: Scalar>(&self, h: &[S], p: &[S]) -> [S; STRAINS] {
        Reference::of(p).strains(h)
    }

    /// Section forces N1, N2, N3 [N] and moments M1, M2, M3 [N m] at a tying point.
    #[inline(always)]
    pub fn section_forces<S: Scalar>(&self, v: &[S], h: &[S], p: &[S]) -> [S; STRAINS] {
        let strain = Reference::of(p).strains(h);
        let stiffness = &p[GEOMETRY..];
        if !self.damped {
            return self.stiffness_times(stiffness, strain);
        }
        let damping = p[GEOMETRY + self.stiffnesses()];
        let rate = self.strain_rates(v, h, p);
        let mut together = strain;
        for i in 0..STRAINS {
            together[i] += damping * rate[i];
        }
        self.stiffness_times(stiffness, together)
    }

    /// Along the motion of h.
    fn strain_rates<S: Scalar>(&self, v: &[S], h: &[S], p: &[S]) -> [S; STRAINS] {
        let mut moving = [Dual::<S, 1>::default(); 11];
        for i in 0..moving.len() {
            moving[i] = Dual { re: h[i], eps: [v[i]] };
        }
        let mut numbers = [Dual::<S, 1>::default(); GEOMETRY];
        for i in 0..GEOMETRY {
            numbers[i].re = p[i];
        }
        let strain = Reference::of(&numbers).strains(&moving);
        let mut rate = [S::zero(); STRAINS];
        for i in 0..STRAINS {
            rate[i] = strain[i].eps[0];
        }
        rate
    }

    /// Adds J B^T stress, B = d strain / dh.
    #[inline(always)]
    fn add_internal<S: Scalar>(&self, h: &[S], p: &[S], stress: [S; STRAINS], r: &mut [S]) {
        let reference = Reference::of(p);
        let (slope, e, turn) = (Vector3::first_three(h), Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&h[7..]));
        let inverse = e.norm_squared().recip();
        let [n1, n2, n3, m1, m2, m3] = stress;
        let force = reference.combine([n1, n2, n3]) * inverse;
        let moment = reference.combine([m1, m2, m3]) * (inverse + inverse);
        let along_slope = e.rotate(force);
        let along_turn = e.g_transposed_times(moment);
        let by_force = rotation_gradient_transposed(e, force, slope);
        let by_moment = turn.g_transposed_times(moment);
        // the factor 1 / |e|^2 of both strains
        let share = along_slope.dot(&slope) + e.g_times(turn).dot(&moment);
        let shrink = share * (inverse + inverse);
        for i in 0..3 {
            r[i] += along_slope[i];
        }
        for i in 0..4 {
            r[3 + i] += by_force[i] - by_moment[i] - shrink * e.0[i];
            r[7 + i] += along_turn[i];
        }
    }
}

impl Field for BeamField {
    const NODES: usize = NODES;
    const COMPONENTS: usize = 7;
    const POINTS: &'static [&'static [Interpolation]] =
        &[&AT_TYING_POINTS[0], &AT_TYING_POINTS[1], &AT_GAUSS_POINTS[0], &AT_GAUSS_POINTS[1], &AT_GAUSS_POINTS[2]];
    const ENERGIES: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        let mut list = Vec::new();
        for point in 1..=TYING_POINTS {
            let mut add = |name: &str, unit| list.push(Parameter::named(format!("tying point {point}: {name}"), unit));
            add("metric", "m");
            for axis in ["tangent x", "tangent y", "tangent z", "second axis x", "second axis y", "second axis z"] {
                add(axis, "-");
            }
            let unit = |i: usize, j: usize| match (i < 3, j < 3) {
                (true, true) => "N",
                (false, false) => "N m2",
                _ => "N m",
            };
            (0..STRAINS).for_each(|i| add(&format!("stiffness {0}{0}", i + 1), unit(i, i)));
            if self.coupled {
                for i in 0..STRAINS {
                    (i + 1..STRAINS).for_each(|j| add(&format!("stiffness {}{}", i + 1, j + 1), unit(i, j)));
                }
            }
            if self.damped {
                add("damping", "s");
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

    #[inline(always)]
    fn reads(&self, point: usize, number: usize) -> [bool; 3] {
        if point < TYING_POINTS {
            return [false, self.damped, true];
        }
        if number < 3 { [true, false, false] } else { [true; 3] }
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

    fn potential<S: Scalar>(&self, point: usize, h: &[S], p: &[S]) -> S {
        if point >= TYING_POINTS {
            return S::zero();
        }
        let strain = Reference::of(p).strains(h);
        let stress = self.stiffness_times(&p[GEOMETRY..], strain);
        let mut twice = S::zero();
        for i in 0..STRAINS {
            twice += strain[i] * stress[i];
        }
        twice * p[0] * 0.5
    }

    fn add_force<S: Scalar>(&self, point: usize, v: &[S], h: &[S], p: &[S], _t: S, force: &mut [S]) {
        if point < TYING_POINTS && self.damped {
            let damping = p[GEOMETRY + self.stiffnesses()];
            let stress = self.stiffness_times(&p[GEOMETRY..], self.strain_rates(v, h, p)).map(|stress| -(stress * damping));
            self.add_internal(h, p, stress, force);
        }
    }

    #[inline(always)]
    fn residual<S: Scalar>(&self, point: usize, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        if point < TYING_POINTS {
            let stress = self.section_forces(s.v, s.q, p);
            self.add_internal(s.q, p, stress, r);
            return;
        }
        let (e, rate) = (Quaternion::from_slice(&s.q[3..]), Quaternion::from_slice(&s.v[3..]));
        let second = Quaternion::from_slice(&s.a[3..]);
        let acceleration = Vector3::first_three(s.a);
        let inverse = e.norm_squared().recip();
        let twice = inverse + inverse;
        let omega = e.g_times(rate) * twice;
        // |e| changes between nodes: d(1 / |e|^2)/dt
        let alpha = e.g_times(second) * twice - omega * (e.dot(rate) * twice);
        let mut force = acceleration * p[0];
        let mut moment = tensor_times(&p[4..], alpha) + omega.cross(&tensor_times(&p[4..], omega));
        if self.eccentric {
            let arm = Vector3::first_three(&p[1..]);
            force += e.rotate(alpha.cross(&arm) + omega.cross(&omega.cross(&arm))) * inverse;
            moment += arm.cross(&(e.rotate_back(acceleration) * inverse));
        }
        let turning = e.g_transposed_times(moment * twice);
        for i in 0..3 {
            r[i] += force[i];
        }
        for i in 0..4 {
            r[3 + i] += turning[i];
        }
    }

    /// With omega = 2 G(e) e' / |e|^2 and a mass centre on the line: 2 / |e|^2 (G(e') - 4 e . e' / |e|^2 G(e))^T J omega.
    fn momentum_rate<S: Scalar>(&self, point: usize, v: &[S], h: &[S], p: &[S], r: &mut [S]) {
        if point < TYING_POINTS {
            return;
        }
        if self.eccentric {
            return point_momentum_rate(self, point, v, h, p, r);
        }
        let (e, rate) = (Quaternion::from_slice(&h[3..]), Quaternion::from_slice(&v[3..]));
        let inverse = e.norm_squared().recip();
        let twice = inverse + inverse;
        let momentum = tensor_times(&p[4..], e.g_times(rate) * twice) * twice;
        let (turned, own) = (rate.g_transposed_times(momentum), e.g_transposed_times(momentum));
        let along = e.dot(rate) * (twice + twice);
        for i in 0..4 {
            r[3 + i] += turned[i] - own[i] * along;
        }
    }

    #[inline(always)]
    fn add_matrix(&self, point: usize, s: State<f64>, shift: [f64; 3], p: &[f64], matrix: &mut [Wide]) -> bool {
        if point < TYING_POINTS {
            add_strain_matrix(self, [s.v, s.q], p, shift, matrix);
        } else {
            add_inertia_matrix(self, [s.a, s.v, s.q], shift, p, matrix);
        }
        true
    }

    #[inline(always)]
    fn add_products(&self, point: usize, s: State<f64>, p: &[f64], lambda: &[f64], into: &mut PointGradient) -> bool {
        if point < TYING_POINTS {
            add_strain_products(self, [s.v, s.q], p, lambda, into);
        } else {
            add_inertia_products(self, [s.a, s.v, s.q], p, lambda, into);
        }
        true
    }

    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        (TYING_POINTS..Self::POINTS.len()).map(|point| p[self.parameters_of(point).start]).sum()
    }
}
