//! Andrews' squeezer of the example, as it is and with the derivatives of its energies and of its constraint written out for speed.

// its `main` is not called here
#[allow(dead_code)]
#[path = "../examples/06_andrews.rs"]
mod example;

use costate::prelude::*;
pub use example::{Andrews, PUBLISHED, START};
use example::{Closure, SevenBodies, arm, inertia_and_spring};

/// [`SevenBodies`] with its residual written out.
pub struct WrittenBodies;

impl Element for WrittenBodies {
    const DOFS: usize = 7;
    const ENERGIES: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        SevenBodies.parameters()
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        SevenBodies.kinetic(v, q, p)
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        SevenBodies.potential(q, p)
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        SevenBodies.add_force(v, q, p, t, force);
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let of_bodies = |x: &[S]| [x[0], x[0] + x[1], x[2], x[4] + x[3], x[4], x[6] + x[5], x[6]];
        let (rates, accelerations) = (of_bodies(s.v), of_bodies(s.a));
        // moments on the seven bodies
        let mut moments: [S; 7] = std::array::from_fn(|i| p[i] * accelerations[i]);
        let [theta, phi, omega] = [s.q[1], s.q[3], s.q[5]].map(S::sin_cos);
        // T = c f w_i w_j with f a function of angle j - angle i
        for (i, j, c, f, slope) in
            [(0, 1, p[7], theta.1, -theta.0), (4, 3, p[8], phi.0, phi.1), (6, 5, p[9], omega.0, omega.1)]
        {
            let (f, slope) = (c * f, c * slope);
            moments[i] += f * accelerations[j] + slope * rates[j] * rates[j];
            moments[j] += f * accelerations[i] - slope * rates[i] * rates[i];
        }
        let [x, y] = arm(s.q[2], p[13], -p[12]);
        let (dx, dy) = (p[10] + x, p[11] + y);
        let length = (dx * dx + dy * dy).sqrt();
        moments[2] += p[14] * (length - p[15]) / length * (x * dy - y * dx);
        moments[0] -= p[16];
        let [one, two, three, four, five, six, seven] = moments;
        for (r, moment) in r.iter_mut().zip([one + two, two, three, four, five + four, six, seven + six]) {
            *r += moment;
        }
    }
}

/// [`Closure`] with its reaction written out.
pub struct WrittenClosure;

impl Constraint for WrittenClosure {
    const DOFS: usize = 7;
    const EQUATIONS: usize = 6;
    const REACTION: bool = true;

    fn parameters(&self) -> Vec<Parameter> {
        Closure.parameters()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        Closure.g(q, p, t, g);
    }
    #[inline(always)]
    fn reaction<S: Scalar>(&self, q: &[S], mu: &[S], p: &[S], _t: S, r: &mut [S]) {
        let [rr, d, ss, e, zt, zf, u, ..] = *p else { unreachable!() };
        // moment of a force at the end of an arm along the angle, (fx, fy) . d(arm)/d(angle)
        let along = |angle: S, length: S, [fx, fy]: [S; 2]| {
            let (sine, cosine) = angle.sin_cos();
            length * (cosine * fy - sine * fx)
        };
        let across = |angle: S, length: S, [fx, fy]: [S; 2]| {
            let (sine, cosine) = angle.sin_cos();
            -length * (cosine * fx + sine * fy)
        };
        let [three, five, seven] = [[mu[0], mu[1]], [mu[2], mu[3]], [mu[4], mu[5]]];
        let pin = [mu[0] + mu[2] + mu[4], mu[1] + mu[3] + mu[5]];
        let two = along(q[0] + q[1], -d, pin);
        let (four, six) = (across(q[3] + q[4], -e, five), along(q[5] + q[6], zf, seven));
        r[0] += along(q[0], rr, pin) + two;
        r[1] += two;
        r[2] -= across(q[2], -ss, three);
        r[3] -= four;
        r[4] -= four + along(q[4], zt, five);
        r[5] -= six;
        r[6] -= six + across(q[6], -u, seven);
    }
}

/// [`Andrews`] of these two.
pub struct WrittenAndrews;

impl Scene for WrittenAndrews {
    fn name(&self) -> String {
        "andrews-angles-written-out".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        Andrews.variables()
    }
    fn settings(&self) -> Settings {
        Andrews.settings()
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let angles = m.coordinates("angles", &START.map(S::from), &[S::zero(); 7]);
        m.element("seven bodies", &[angles], WrittenBodies, &inertia_and_spring(x));
        m.constraint("closure", &[angles], WrittenClosure, &x[14..25]);
        Ok(())
    }
}
