use crate::elements::{Anchor, ByPoints, Element, Parameter, State};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, rotation_gradient_transposed, tensor_times};

/// A rigid body with position r of its frame and Euler parameters e.
///
/// T = m |v_c|^2 / 2 + omega . J omega / 2 with v_c = dr/dt + d(R(e) c)/dt and omega = 2 G(e) de/dt (body frame).
/// With a_c the acceleration of the mass centre and B = d(R c)/de, exactly and for every e, unit or not:
///
/// R_r = m a_c,   R_e = B^T m a_c + 2 G(e)^T J domega/dt + 4 G(de/dt)^T J omega
///
/// * `mass`  m [kg], greater than 0
/// * `centre x, y, z`  c, mass centre in the body frame [m]
/// * `inertia xx, yy, zz, xy, xz, yz`  J, about the mass centre, body axes [kg m2]; products with the sign of the tensor entry
///
/// Source: Shabana (2013), Dynamics of Multibody Systems, section 3.
pub struct RigidBody;

const fn new(name: &'static str, unit: &'static str) -> Parameter {
    Parameter::new(name, unit)
}

/// Mass, mass centre and inertia: the parameters of every rigid body.
pub(super) const INERTIA: &[Parameter] = &[
    Parameter::positive("mass", "kg"),
    new("centre x", "m"),
    new("centre y", "m"),
    new("centre z", "m"),
    Parameter::non_negative("inertia xx", "kg m2"),
    Parameter::non_negative("inertia yy", "kg m2"),
    Parameter::non_negative("inertia zz", "kg m2"),
    new("inertia xy", "kg m2"),
    new("inertia xz", "kg m2"),
    new("inertia yz", "kg m2"),
];

impl Element for RigidBody {
    const DOFS: usize = 7;
    const PARAMETERS: &'static [Parameter] = INERTIA;
    const ENERGIES: bool = true;

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let velocity = Anchor::Body.velocity(v, q, Vector3::first_three(&p[1..]));
        let omega = Quaternion::from_slice(&q[3..]).g_times(Quaternion::from_slice(&v[3..])) * S::from(2.0);
        (velocity.dot(&velocity) * p[0] + omega.dot(&tensor_times(&p[4..], omega))) * 0.5
    }

    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let centre = Vector3::first_three(&p[1..]);
        let (e, rate) = (Quaternion::from_slice(&s.q[3..]), Quaternion::from_slice(&s.v[3..]));
        let second = Quaternion::from_slice(&s.a[3..]);
        Anchor::Body.add_force(s.q, centre, Anchor::Body.acceleration(s, centre) * p[0], r);

        // omega = 2 G(e) e', domega/dt = 2 G(e) e'' because G(e') e' = 0
        let two = S::from(2.0);
        let momentum = tensor_times(&p[4..], e.g_times(rate) * two);
        let momentum_rate = tensor_times(&p[4..], e.g_times(second) * two);
        let inertial = e.g_transposed_times(momentum_rate * two);
        let gyroscopic = rate.g_transposed_times(momentum * S::from(4.0));
        for i in 0..4 {
            r[3 + i] += inertial[i] + gyroscopic[i];
        }
    }

    /// With v_c = r' + B e': (0, B'^T m v_c + B^T m B' e' + 4 G(e')^T J G(e) e'), and m B' e' for r.
    fn momentum_rate<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], r: &mut [S]) {
        let centre = Vector3::first_three(&p[1..]);
        let (e, rate) = (Quaternion::from_slice(&q[3..]), Quaternion::from_slice(&v[3..]));
        Anchor::Body.add_force(q, centre, rate.rotate_rate(rate, centre) * p[0], r);
        let momentum = tensor_times(&p[4..], e.g_times(rate) * S::from(4.0));
        let turned = rotation_gradient_transposed(rate, centre, Anchor::Body.velocity(v, q, centre) * p[0]);
        let gyroscopic = rate.g_transposed_times(momentum);
        for i in 0..4 {
            r[3 + i] += turned[i] + gyroscopic[i];
        }
    }

    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0]
    }

    fn by_points(&self) -> Option<&dyn ByPoints> {
        Some(self)
    }
}
