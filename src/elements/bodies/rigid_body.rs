use crate::elements::{Element, NodeKind, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3, tensor_times};

/// A rigid body with position r of its frame and Euler parameters e.
///
/// T = m |v_c|^2 / 2 + omega . J omega / 2 with v_c = dr/dt + d(R(e) c)/dt and omega = 2 G(e) de/dt (body frame).
/// With a_c the acceleration of the mass centre and B = d(R c)/de, exactly and for every e, unit or not:
///
/// R_r = m a_c,   R_e = B^T m a_c + 2 G(e)^T J domega/dt + 4 G(de/dt)^T J omega
///
/// * `mass`  m \[kg\], 0 or greater: what only turns, as the rotor of a motor, may have inertia without mass
/// * `centre x, y, z`  c, mass centre in the body frame \[m\]
/// * `inertia xx, yy, zz, xy, xz, yz`  J, about the mass centre, body axes [kg m2]; products with the sign of the tensor entry
///
/// Source: Shabana (2013), Dynamics of Multibody Systems, section 3.
#[derive(Hash)]
pub struct RigidBody;

/// Mass, mass centre and inertia: the parameters of every rigid body.
pub(super) fn inertia_parameters() -> Vec<Parameter> {
    let mass = Parameter::non_negative("mass", "kg").as_size();
    let moments = ["inertia xx", "inertia yy", "inertia zz"].map(|name| Parameter::non_negative(name, "kg m2"));
    let products = ["inertia xy", "inertia xz", "inertia yz"].map(|name| Parameter::new(name, "kg m2"));
    [mass].into_iter().chain(Parameter::vectors(&["centre"], "m")).chain(moments).chain(products).collect()
}

impl Element for RigidBody {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Body]
    }
    fn parameters(&self) -> Vec<Parameter> {
        inertia_parameters()
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
