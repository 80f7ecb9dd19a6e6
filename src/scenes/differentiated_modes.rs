use super::Prepared;
use crate::assembly::RestingModel;
use crate::design::{DesignChain, ModelNumbers};
use crate::integrators::{Mode, ModeGroup, Problem, RunError, complex_modes, is_cut, mode_vectors, vibrations};
use crate::scalar::Complex64;
use crate::sensitivity::{Still, ValueBars, value_rates};
use nalgebra::DMatrix;

/// How the value of a mode, growth + i omega, changes with the design.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeGradient {
    /// d growth / dx, for each design variable.
    pub growth: Vec<f64>,
    /// d omega / dx.
    pub frequency: Vec<f64>,
    /// How many modes have this value. Of several each variable alone parts the values as the derivatives say, the lowest omega first: they are
    /// those of the values in order, not of one mode, and do not add up where variables change together.
    pub equal: usize,
}

/// Modes about an equilibrium, with their derivatives.
#[derive(Clone, Debug)]
pub struct DifferentiatedModes {
    /// Coordinates about which they vibrate.
    pub q: Vec<f64>,
    /// The modes.
    pub modes: Vec<Mode>,
    /// For each mode; `None` for a rigid motion.
    pub gradients: Vec<Option<ModeGradient>>,
}

/// Modes that are looked for beyond those asked for, so that none of several with one value is missing.
const BEYOND: usize = 2;

impl Prepared<'_> {
    /// The modes of [`Prepared::modes_with_state`], or with damping those of [`Prepared::complex_modes_with_state`] (about a steady turn always
    /// those), and the derivatives of their values by all design variables, through the equilibrium, exact to round-off.
    ///
    /// # Errors
    /// As for these; vectors that do not settle, modes that meet and become one, and an equilibrium that does not follow from its equations.
    pub fn modes_with_gradients(&self, count: usize, damped: bool) -> Result<DifferentiatedModes, RunError> {
        let (start, plan, t) = self.still_state()?;
        let is_damped = damped || self.spin_rate().is_some();
        let frame = self.model().in_frame();
        let problem = Problem { model: &frame.model, p: frame.parameters(&self.mechanism.numbers.p), start };
        let find = if is_damped { complex_modes } else { vibrations };
        let mut sought = count + BEYOND;
        let mut modes = find(&problem, &self.method, &plan, t, sought)?;
        while modes.len() >= sought && is_cut(&modes, count) {
            sought *= 2;
            modes = find(&problem, &self.method, &plan, t, sought)?;
        }
        let asked = count.min(modes.len());
        let vectors = mode_vectors(&problem, &self.method, &plan, t, (&modes, asked), is_damped)?;
        let chain = self.analysis().checked_chain(&self.x)?;
        let still = Still {
            vectors: &vectors,
            p: &problem.p,
            active: &frame.parameters(&chain.active_parameters()),
            method: &self.method,
            t,
            is_damped,
            has_rigid_motions: modes.iter().any(|mode| mode.frequency == 0.0 && mode.growth == 0.0),
        };
        let mut gradients: Vec<Option<ModeGradient>> = vec![None; asked];
        for (group, bars) in vectors.groups.iter().zip(still.gradients()?) {
            let rows: Vec<[Vec<f64>; 2]> = bars.iter().map(|bars| by_design(&chain, &frame, bars)).collect();
            let own = group.modes.iter().zip(parted(group, &rows)?).filter(|(place, _)| **place < asked);
            own.for_each(|(&place, own)| gradients[place] = Some(own));
        }
        modes.truncate(asked);
        Ok(DifferentiatedModes { q: problem.start.q, modes, gradients })
    }
}

/// A gradient by all variables, its real part first.
fn by_design(chain: &DesignChain, frame: &RestingModel, ValueBars { p, q }: &ValueBars) -> [Vec<f64>; 2] {
    let numbers = chain.real();
    [0, 1].map(|part| {
        let mut bar = ModelNumbers { p: vec![0.0; numbers.p.len()], q: q[part].clone(), v: vec![0.0; numbers.v.len()] };
        frame.add_gradient(&p[part], &mut bar.p);
        chain.gradient(&bar)
    })
}

/// Derivatives of the values of a group, from those of w_i^T B z_j by all variables.
fn parted(group: &ModeGroup, rows: &[[Vec<f64>; 2]]) -> Result<Vec<ModeGradient>, RunError> {
    let equal = group.modes.len();
    let mut all = vec![ModeGradient { growth: Vec::new(), frequency: Vec::new(), equal }; equal];
    for variable in 0..rows[0][0].len() {
        let entries = rows.iter().map(|[re, im]| Complex64::new(re[variable], im[variable]));
        let rates = value_rates(group, &DMatrix::from_row_iterator(equal, equal, entries)).ok_or_else(|| {
            RunError::Input(format!(
                "the mode at {:.6e} rad/s has no derivative: two modes meet there and become one, as where damping is critical or a flutter begins",
                group.lambda.norm()
            ))
        })?;
        for (own, rate) in all.iter_mut().zip(rates) {
            // a zero has no sign
            own.growth.push(rate.re + 0.0);
            own.frequency.push(rate.im + 0.0);
        }
    }
    Ok(all)
}
