use crate::design::DesignVariable;
use crate::elements::{Constraint, Element, NodeKind, Parameter};
use crate::functionals::Over;
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::{MechanismBuilder, Scene, Settings};

/// The car axis of the Test Set for IVP Solvers: a rigid axis on two springs, its right wheel on a bumpy road.
///
/// Point masses k = M eps^2 / 2 at (xl, yl) and (xr, yr), springs of stiffness 1 and rest length L0 from the origin to the left
/// and from the road point (xb, yb) to the right end, with
///
/// 0 = xb xl + yb yl,  0 = |left - right|^2 - L^2,  yb = r sin(w t),  xb = sqrt(L^2 - yb^2).
///
/// Source: Test Set for Initial Value Problem Solvers, Bari, problem "Car axis"; dimensionless.
pub struct CarAxis;

impl Scene for CarAxis {
    fn name(&self) -> String {
        "car-axis".into()
    }
    fn summary(&self) -> String {
        "car axis on a bumpy road (Test Set for IVP Solvers)".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![
            DesignVariable::new("mass M", 10.0, (1.0, 100.0), "-"),
            DesignVariable::new("length L", 1.0, (0.5, 2.0), "-"),
            DesignVariable::new("rest length L0", 0.5, (0.1, 2.0), "-"),
            DesignVariable::new("bump height r", 0.1, (0.0, 0.3), "-"),
            DesignVariable::new("road frequency", 10.0, (0.1, 50.0), "-"),
        ]
    }
    fn settings(&self) -> Settings {
        Settings::new(3.0, 3000)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let [mass, length, rest_length, bump, frequency] = x else {
            return Err(format!("5 variables expected, {} given", x.len()));
        };
        let eps = S::from(0.01);
        let mass = *mass * eps * eps * 0.5;
        let height = S::from(0.5);
        let at = |x: S, y: S| Vector3::new(x, y, S::zero());
        let (start_left, start_right) = (at(S::zero(), height), at(*length, height));
        let ground = m.ground();
        let left = m.point("left", start_left);
        let right = m.point("right", start_right);
        // dg/dt = 0 at t = 0: L xl' + r w yl = 0, and the axis is level
        let velocity = at(-*bump * *frequency * height / *length, S::zero());
        for (name, node) in [("left", left), ("right", right)] {
            m.set_velocity(node, velocity, Vector3::zeros());
            m.point_mass(name, node, mass);
        }
        m.gravity(Vector3::from_f64([0.0, -1.0, 0.0]));
        m.line_spring("left spring", [ground, left], [Vector3::zeros(), start_left], S::one(), *rest_length);
        let road = [*bump, *frequency, *length];
        m.element("right spring", &[right], RoadSpring, &[&[S::one(), *rest_length], &road[..]].concat());
        m.constraint("upright", &[left], AcrossRoad, &road);
        let axis = m.distance("axis", [left, right], [start_left, start_right]);

        let y = Vector3::from_f64([0.0, 1.0, 0.0]);
        m.target_functional("travel of the left end, integral", Over::Integral, left, start_left, start_left);
        m.position_functional("height of the right end, integral", Over::Integral, right, start_right, y);
        m.position_functional("height of the right end at the end", Over::Terminal, right, start_right, y);
        m.reaction_functional("axis force, integral", Over::Integral, axis, &[S::one()]);
        m.draw(ground, &[Vector3::zeros(), at(*length, S::zero())]);
        Ok(())
    }
}

/// Parameters of the road: r, w, L.
const ROAD: [Parameter; 3] =
    [Parameter::non_negative("bump height", "m"), Parameter::new("frequency", "rad/s"), Parameter::positive("length", "m")];

/// (xb, yb): y = r sin(w t), x = sqrt(L^2 - y^2) \[m\].
fn road_point<S: Scalar>(road: &[S], t: S) -> Vector3<S> {
    let y = road[0] * (road[1] * t).sin();
    Vector3::new((road[2] * road[2] - y * y).sqrt(), y, S::zero())
}

/// A spring from the road point to a point node: F = -k (l - l0) d / l \[N\], d = x - x_b(t), l = |d|.
///
/// * `stiffness`  k [N/m]
/// * `rest length`  l0 \[m\]
/// * parameters of the road
struct RoadSpring;

impl Element for RoadSpring {
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point]
    }
    fn parameters(&self) -> Vec<Parameter> {
        let own = [Parameter::non_negative("stiffness", "N/m"), Parameter::non_negative("rest length", "m")];
        own.into_iter().chain(ROAD).collect()
    }
    fn add_force<S: Scalar>(&self, _v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        let along = Vector3::first_three(q) - road_point(&p[2..], t);
        let length = along.length();
        let pull = along * (p[0] * (p[1] - length) / length);
        for (force, pull) in force.iter_mut().zip(pull.components()) {
            *force += pull;
        }
    }
}

/// Holds a point at right angles to the road: g = (x_b(t) . x) / L \[m\].
struct AcrossRoad;

impl Constraint for AcrossRoad {
    const EQUATIONS: usize = 1;
    const PARAMETERS: &'static [Parameter] = &ROAD;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Point]
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        g[0] = road_point(p, t).dot(&Vector3::first_three(q)) / p[2];
    }
}
