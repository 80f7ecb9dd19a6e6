//! Masses under laws of pieces, drawn by lot: each run tells that it passes from one to another, or its gradient is that of its quotients.

use crate::verification::{Noise, Report};
use costate::integrators::SwitchKind;
use costate::prelude::*;
use costate::scalar::Curve;
use std::sync::Arc;

/// Kinds of laws.
const KINDS: usize = 10;
/// Difference of an adjoint gradient and the quotient of whole runs, as a share of the larger one and of 1.
const APART: f64 = 1e-5;

/// A force on a mass at a place: pieces that meet at a place.
#[derive(Clone, Debug)]
struct Law {
    kind: usize,
    at: f64,
    size: f64,
    curve: [Arc<Curve>; 2],
}

impl Law {
    /// What the law does where its pieces meet.
    fn switch(&self) -> Option<SwitchKind> {
        match self.kind {
            0..=3 => Some(SwitchKind::Jump),
            4..=6 => Some(SwitchKind::Kink),
            _ => None,
        }
    }
    fn force<S: Scalar>(&self, place: S) -> S {
        let x = place - self.at;
        let turned = (x + std::f64::consts::PI).sin().atan2((x + std::f64::consts::PI).cos());
        let force = match self.kind {
            0 => x.sign(),
            1 => (x + 4.0).floor() - 3.5,
            2 => turned,
            3 => S::zero().less(x).select(S::one() - x * 0.1, x),
            4 => x.max(S::zero()) * 3.0,
            5 => x.abs(),
            6 => place.on_curve(&self.curve[0], 0),
            7 => place.on_curve(&self.curve[1], 0),
            8 => turned.sin(),
            // one series takes over from the function that it is of
            _ => x.abs().less(S::from(1e-3)).select(x - x * x * x / 6.0, x.sin()),
        };
        force * self.size
    }
}

impl Element for Law {
    const PARAMETERS: &'static [Parameter] = &[Parameter::positive("mass", "kg")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        r[0] += p[0] * s.a[0] + self.force(s.q[0]);
    }
}

/// A mass that moves from a place with a velocity, and its place at the end.
struct Mass {
    law: Law,
    from: f64,
    velocity: f64,
}

impl Scene for Mass {
    fn name(&self) -> String {
        "mass".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("velocity", self.velocity, (-100.0, 100.0), "m/s")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 60)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let node = m.coordinates("mass", &[S::from(self.from)], &[x[0]]);
        m.element("law", &[node], self.law.clone(), &[S::one()]);
        m.coordinate_functional("end", Over::Terminal, node, 0);
        Ok(())
    }
}

/// What one run does.
enum Outcome {
    /// It stays on one side, or what meets is smooth, and its gradient is right.
    Right,
    /// It tells the switch that it passes.
    Told,
    /// It passes one without a word, tells another kind, or one that it does not pass; or its gradient is wrong and nothing is told.
    Wrong(String),
}

fn outcome(mass: &Mass) -> Result<Outcome, RunError> {
    let prepared = Prepared::new(mass)?;
    let (analysis, x) = (prepared.analysis(), &prepared.x);
    let forward = analysis.forward(x)?;
    let mut passes = false;
    let side = |place: f64| place > mass.law.at;
    analysis.for_each_sample(&forward, |sample| passes |= side(sample.at.q[0]) != side(mass.from))?;
    let told = forward.crossings.first().map(|crossing| crossing.kind);
    if passes && told != mass.law.switch() {
        return Ok(Outcome::Wrong(format!("passes {:?} at {}, tells {told:?}", mass.law.kind, mass.law.at)));
    }
    if told.is_some() {
        // a stage may be behind where no step ends
        let is_own = told == mass.law.switch();
        return Ok(if is_own { Outcome::Told } else { Outcome::Wrong(format!("tells {told:?} of law {}", mass.law.kind)) });
    }
    let gradient = analysis.adjoint(x, &forward)?.rows[0][0];
    let quotient = analysis.quotients(x, &[1.0])?[0];
    let apart = (gradient - quotient.value).abs() / gradient.abs().max(1.0);
    Ok(match apart <= APART {
        true => Outcome::Right,
        false => Outcome::Wrong(format!("law {}: {gradient} for {}", mass.law.kind, quotient.value)),
    })
}

/// Share of errors: where a force jumps against the motion, the equation of a stage may have no solution.
const ERRORS: f64 = 0.01;

/// Counts them.
pub fn count(report: &mut Report, cases: usize) -> Result<(), String> {
    let mut noise = Noise::new(5);
    let mut between = |from: f64, to: f64| from + 0.5 * (to - from) * (noise.next() + 1.0);
    let [mut right, mut told, mut wrong, mut errors] = [0; 4];
    for case in 0..cases {
        let (at, size) = (between(-1.0, 1.0), between(0.5, 6.0));
        let knots = [at - 2.5, at, at + 2.5];
        let curve = [Interpolant::Lines, Interpolant::Smooth].map(|way| Curve::new(&knots, &[-3.0, 0.1, 1.0], way));
        let [Ok(lines), Ok(cubic)] = curve else { return Err("knots that increase make a curve".into()) };
        let law = Law { kind: case % KINDS, at, size, curve: [lines, cubic] };
        let mass = Mass { law, from: between(-1.0, 1.0), velocity: between(-2.0, 2.0) };
        match outcome(&mass) {
            Ok(Outcome::Right) => right += 1,
            Ok(Outcome::Told) => told += 1,
            Ok(Outcome::Wrong(why)) => {
                wrong += 1;
                report.note(format!("switches, case {case}: {why}"));
            }
            Err(error) => {
                errors += 1;
                report.note(format!("switches, case {case}: {error}"));
            }
        }
    }
    report.inform("switches/right", f64::from(right));
    report.inform("switches/told", f64::from(told));
    report.at_most("switches/wrong", f64::from(wrong), 0.0);
    report.at_most("switches/errors, share", f64::from(errors) / cases as f64, ERRORS);
    Ok(())
}
