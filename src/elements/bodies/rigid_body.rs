use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, tensor_times};

/// A rigid body with position r of its frame and Euler parameters e.
///
/// T = m |v_c|^2 / 2 + omega . J omega / 2 with v_c = dr/dt + d(R(e) c)/dt and omega = 2 G(e) de/dt (body frame).
/// With a_c the acceleration of the mass centre and B = d(R c)/de, exactly and for every e, unit or not:
///
/// R_r = m a_c,   R_e = B^T m a_c + 2 G(e)^T J domega/dt + 4 G(de/dt)^T J omega
///
/// * `mass`  m \[kg\], greater than 0
/// * `centre x, y, z`  c, mass centre in the body frame \[m\]
/// * `inertia xx, yy, zz, xy, xz, yz`  J, about the mass centre, body axes [kg m2]; products with the sign of the tensor entry
///
/// Source: Shabana (2013), Dynamics of Multibody Systems, section 3.
pub struct RigidBody;

const fn new(name: &'static str, unit: &'static str) -> Parameter {
    Parameter::new(name, unit)
}

/// Mass, mass centre and inertia: the parameters of every rigid body.
pub(super) const INERTIA: &[Parameter] = &[
    Parameter::positive("mass", "kg").as_size(),
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
    const PARAMETERS: &'static [Parameter] = INERTIA;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body]
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let velocity = NodeKind::Body.velocity(v, q, Vector3::first_three(&p[1..]));
        let omega = Quaternion::from_slice(&q[3..]).g_times(Quaternion::from_slice(&v[3..])) * S::from(2.0);
        (velocity.dot(&velocity) * p[0] + omega.dot(&tensor_times(&p[4..], omega))) * 0.5
    }

    fn mass<S: Scalar>(&self, p: &[S]) -> S {
        p[0]
    }
}
