//! Small steady vibrations where a design variable varies harmonically: (K + i omega C - omega^2 M) x + A^T nu = -dR/dd, A x = -dg/dd.
//!
//! With R and A at (0, 0, q): M = dR/da, C = dR/dv, K = d(R + A^T mu)/dq.

use super::RunError;
use super::amplitudes::{Amplitudes, Pencil, left_over};
use super::vibrations::{Operator, RestingProblem};
use crate::assembly::{Equations, Jacobian, Level, Residual, StageCoefficients, StageSystem, Unknowns, VectorsAvq};
use crate::scalar::{COMPLEX_STEP, Complex64};

const PLACE: &str = "frequency response";
/// What a solution may leave of its equations, by their largest terms.
const LEFT: f64 = 1e-10;

pub(crate) struct Response {
    pub q: Vec<f64>,
    pub mu: Vec<f64>,
    pub vibrations: Vec<Vibration>,
}

/// Coordinates and multipliers vary with the real part of (re + i im) exp(i omega t).
pub(crate) struct Vibration {
    /// Parts of the coordinates, for a change of the design variable by 1.
    pub x: [Vec<f64>; 2],
    pub mu: [Vec<f64>; 2],
}

/// The response about an equilibrium to a harmonic change of its parameters at some rates [rad/s]: `varied` has them with a complex step along what
/// changes.
pub(crate) fn harmonic_response(resting: RestingProblem, varied: &[Complex64], rates: &[f64]) -> Result<Response, RunError> {
    let mut operator = Operator::at_equilibrium(resting)?;
    let stiffness = operator.stiffness();
    let damping = operator.assembled(&Equations::stage(StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity));
    let system = operator.newton.system.clone();
    let rhs = change(&operator, &stiffness, varied, resting.t);
    let pencil = Pencil::new(&system, operator.nodes, [&stiffness, &operator.mass], Some(&damping));
    let mut amplitudes = Amplitudes::new(&pencil, false).map_err(|singular| RunError::of_pattern(PLACE, singular))?;
    let mut vibrations = Vec::new();
    for &omega in rates {
        let parts = solve(&mut amplitudes, &pencil, omega, &rhs)?.map(|reduced| {
            let mut unknowns = Residual::<f64>::unknowns(&system);
            stiffness.add_step(&system, &reduced, None, &mut unknowns, &operator.newton.coordinate_scales);
            (unknowns.x, unknowns.mu)
        });
        let [(re, mu_re), (im, mu_im)] = parts;
        vibrations.push(Vibration { x: [re, im], mu: [mu_re, mu_im] });
    }
    Ok(Response { q: operator.base.q, mu: operator.reactions.mu, vibrations })
}

fn solve(amplitudes: &mut Amplitudes, pencil: &Pencil, omega: f64, rhs: &[f64]) -> Result<[Vec<f64>; 2], RunError> {
    let undetermined = || {
        RunError::Input(format!(
            "{PLACE}: at {omega} rad/s the response is not determined: that is the rate of a mode without damping, or something moves freely; \
             take another rate, or give it damping or a spring"
        ))
    };
    let (lambda, rhs) = (Complex64::new(0.0, omega), rhs.iter().map(|&own| own.into()).collect::<Vec<Complex64>>());
    amplitudes.set(lambda).map_err(|_| undetermined())?;
    let x = amplitudes.solve(&rhs);
    let is_solved = left_over(pencil, lambda, (&x, &rhs), false) <= LEFT;
    let parts = || [x.iter().map(|own| own.re).collect(), x.iter().map(|own| own.im).collect()];
    is_solved.then(parts).ok_or_else(undetermined)
}

/// Minus the change of the equations with the parameters, at the equilibrium.
fn change(operator: &Operator, stiffness: &Jacobian, varied: &[Complex64], t: f64) -> Vec<f64> {
    let (system, equations) = (&operator.newton.system, Equations::EQUILIBRIUM);
    let lift = |list: &[f64]| list.iter().map(|&own| Complex64::from(own)).collect::<Vec<_>>();
    let base = VectorsAvq { a: lift(&operator.base.a), v: lift(&operator.base.v), q: lift(&operator.base.q) };
    let own = &operator.reactions;
    let mut unknowns = Unknowns { x: lift(&own.x), mu: lift(&own.mu), local_mu: lift(&own.local_mu) };
    let mut residual = Residual::<Complex64>::default();
    let stage = StageSystem { equations: &equations, base: &base, p: varied, t };
    residual.start(system, stage);
    residual.evaluate(system, stage, &mut unknowns);
    let mut rhs = vec![0.0; system.size()];
    stiffness.reduce(system, &residual, Some(0), &mut rhs);
    rhs.iter_mut().for_each(|own| *own /= COMPLEX_STEP);
    rhs
}
