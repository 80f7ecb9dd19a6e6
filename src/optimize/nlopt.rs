//! Optimizers of NLopt: Johnson, S. G. (2014), The NLopt nonlinear-optimization package.

use super::{ConstraintKind, Evaluations, NoValue, Optimizer, Reason};
use ::nlopt::{Algorithm, FailState, Nlopt, SuccessState, Target};
use std::cell::RefCell;

/// A method of NLopt. Every point at which it asks for a gradient counts as an iteration.
struct NloptMethod {
    name: &'static str,
    algorithm: Algorithm,
    /// What minimizes the augmented Lagrangian.
    inner: Option<Algorithm>,
    /// Whether it treats equalities.
    equalities: bool,
}

/// All of them.
pub(super) fn all() -> Vec<Box<dyn Optimizer>> {
    let method = |name, algorithm, inner, equalities| -> Box<dyn Optimizer> {
        Box::new(NloptMethod { name, algorithm, inner, equalities })
    };
    vec![
        method("nlopt-slsqp", Algorithm::Slsqp, None, true),
        method("nlopt-mma", Algorithm::Mma, None, false),
        method("nlopt-ccsaq", Algorithm::Ccsaq, None, false),
        method("nlopt-auglag", Algorithm::LdAuglag, Some(Algorithm::Slsqp), true),
    ]
}

/// Relative changes of the variables at which NLopt itself ends.
const SMALLEST_STEP: f64 = 1e-12;
/// The same for each minimization of an augmented Lagrangian.
const INNER_STEP: f64 = 1e-6;
/// An objective that says to NLopt: enough. It cannot be asked to stop from within.
const ENOUGH: f64 = -1e100;
/// Most points for each iteration, trials of line searches included.
const TRIALS: usize = 20;

/// The evaluations between the calls of NLopt.
struct Session<'c, 'p> {
    evaluations: &'c mut Evaluations<'p>,
    end: Option<Reason>,
    reached: Vec<f64>,
}

impl Session<'_, '_> {
    /// The objective at a point; infinite where there is none.
    fn objective(&mut self, x: &[f64], gradient: Option<&mut [f64]>) -> f64 {
        let wanted = gradient.is_some();
        let found = self.evaluations.values(x).and_then(|values| {
            if let Some(own) = gradient {
                own.copy_from_slice(&self.evaluations.gradients(x)?.objective);
            }
            Ok(values.objective)
        });
        match found {
            Ok(objective) => {
                if wanted && self.reached != x {
                    self.reached = x.to_vec();
                    self.end = self.evaluations.accept(x).unwrap_or(Some(Reason::Stopped));
                }
                objective
            }
            Err(NoValue::Failed) => f64::INFINITY,
            Err(NoValue::Stop) => {
                self.end = Some(Reason::Stopped);
                ENOUGH
            }
        }
    }

    /// Some of the constraints at a point; violated without limit where there are none.
    fn constraints(&mut self, which: &[usize], result: &mut [f64], x: &[f64], gradient: Option<&mut [f64]>) {
        let found = self.evaluations.values(x).and_then(|values| {
            if let Some(own) = gradient {
                let rows = self.evaluations.gradients(x)?.constraints;
                own.chunks_mut(x.len()).zip(which).for_each(|(own, &index)| own.copy_from_slice(&rows[index]));
            }
            Ok(values.constraints)
        });
        match found {
            Ok(values) => result.iter_mut().zip(which).for_each(|(own, &index)| *own = values[index]),
            Err(NoValue::Failed) => result.fill(f64::INFINITY),
            Err(NoValue::Stop) => self.end = Some(Reason::Stopped),
        }
    }
}

impl Optimizer for NloptMethod {
    fn name(&self) -> &'static str {
        self.name
    }
    fn check(&self, evaluations: &Evaluations) -> Result<(), String> {
        if !self.equalities && evaluations.constraints().contains(&ConstraintKind::Equality) {
            return Err(format!("{} treats no equality constraints; sqp, nlopt-slsqp and nlopt-auglag do", self.name));
        }
        Ok(())
    }
    fn go(&self, evaluations: &mut Evaluations, start: &[f64]) -> Reason {
        match evaluations.values(start).and_then(|_| evaluations.gradients(start)) {
            Err(NoValue::Failed) => return Reason::StartFailed,
            Err(NoValue::Stop) => return Reason::Stopped,
            Ok(_) => {}
        }
        let (n, kinds, bounds) = (start.len(), evaluations.constraints().to_vec(), evaluations.bounds().to_vec());
        let (tolerance, points) = (evaluations.stopping().violation, TRIALS * (evaluations.stopping().iterations + 1));
        let of_kind = |kind| (0..kinds.len()).filter(|&k| kinds[k] == kind).collect::<Vec<usize>>();
        let (equalities, inequalities) = (of_kind(ConstraintKind::Equality), of_kind(ConstraintKind::AtMostZero));
        let session = RefCell::new(Session { evaluations, end: None, reached: Vec::new() });
        let objective = |x: &[f64], mut gradient: Option<&mut [f64]>, (): &mut ()| {
            gradient.iter_mut().for_each(|own| own.fill(0.0));
            let mut session = session.borrow_mut();
            if session.end.is_some() { ENOUGH } else { session.objective(x, gradient) }
        };
        let constraints =
            |which: &[usize], satisfied: f64, result: &mut [f64], x: &[f64], mut gradient: Option<&mut [f64]>| {
                gradient.iter_mut().for_each(|own| own.fill(0.0));
                result.fill(satisfied);
                let mut session = session.borrow_mut();
                if session.end.is_none() {
                    session.constraints(which, result, x, gradient);
                }
            };
        let mut nlopt = Nlopt::new(self.algorithm, n, objective, Target::Minimize, ());
        let (lower, upper): (Vec<f64>, Vec<f64>) = bounds.into_iter().unzip();
        let set = nlopt
            .set_lower_bounds(&lower)
            .and_then(|_| nlopt.set_upper_bounds(&upper))
            .and_then(|_| nlopt.set_stopval(0.5 * ENOUGH))
            .and_then(|_| nlopt.set_maxeval(u32::try_from(points).unwrap_or(u32::MAX)))
            .and_then(|_| nlopt.set_xtol_rel(SMALLEST_STEP))
            .and_then(|_| {
                let Some(inner) = self.inner else { return Ok(SuccessState::Success) };
                let mut local = nlopt.get_local_optimizer(inner);
                local.set_xtol_rel(INNER_STEP)?;
                local.set_maxeval(u32::try_from(points).unwrap_or(u32::MAX))?;
                nlopt.set_local_optimizer(local)
            })
            .and_then(|_| {
                let own = |result: &mut [f64], x: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| {
                    constraints(&equalities, 0.0, result, x, gradient);
                };
                match equalities.len() {
                    0 => Ok(SuccessState::Success),
                    m => nlopt.add_equality_mconstraint(m, own, (), &vec![tolerance; m]),
                }
            })
            .and_then(|_| {
                let own = |result: &mut [f64], x: &[f64], gradient: Option<&mut [f64]>, (): &mut ()| {
                    constraints(&inequalities, -1.0, result, x, gradient);
                };
                match inequalities.len() {
                    0 => Ok(SuccessState::Success),
                    m => nlopt.add_inequality_mconstraint(m, own, (), &vec![tolerance; m]),
                }
            });
        if set.is_err() {
            return Reason::Stalled;
        }
        let mut x = start.to_vec();
        let ended = nlopt.optimize(&mut x);
        drop(nlopt);
        let reason = match ended {
            Ok((SuccessState::MaxEvalReached | SuccessState::MaxTimeReached, _)) => Reason::Iterations,
            Ok(_) => Reason::Change,
            Err((FailState::ForcedStop, _)) => Reason::Stopped,
            Err(_) => Reason::Stalled,
        };
        session.into_inner().end.unwrap_or(reason)
    }
}
