use super::{ModeMeasure, Prepared};
use crate::assembly::RestingModel;
use crate::design::{DesignChain, ModelNumbers};
use crate::integrators::{
    Mode, ModeGroup, Modes, Problem, RestingProblem, RunError, SAME_MODE, complex_modes, is_cut, mode_vectors,
    staying_states, value_of, vibrations,
};
use crate::scalar::Complex64;
use crate::sensitivity::{Still, ValueSeeds, value_rates};
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
    /// For each mode; `None` for a rigid motion. Empty where they were not asked for.
    pub gradients: Vec<Option<ModeGradient>>,
    /// Whether it is proved that no mode is missing before the last one, or at all where fewer were found than asked for.
    pub proved: bool,
}

/// Modes that are looked for beyond those asked for, so that none of several with one value is missing.
const BEYOND: usize = 2;

impl Prepared<'_> {
    /// The modes of [`Prepared::modes`], or with damping those of [`Prepared::complex_modes_with_state`] (about a steady turn always
    /// those), and the derivatives of their values by all design variables, through the equilibrium, exact to round-off.
    ///
    /// # Errors
    /// As for these; vectors that do not settle, modes that meet and become one, and an equilibrium that does not follow from its equations.
    pub fn modes_with_gradients(&self, count: usize, damped: bool) -> Result<DifferentiatedModes, RunError> {
        let is_damped = damped || self.spin_rate().is_some();
        let (frame, start, plan, t) = self.still_state()?;
        let vibrating = if is_damped { frame.model.clone() } else { frame.model.with_states_held() };
        let problem = Problem { model: &vibrating, p: frame.parameters(&self.mechanism.numbers.p), start };
        let find = if is_damped { complex_modes } else { vibrations };
        let resting = RestingProblem { problem: &problem, method: &self.method, plan: &plan, t };
        let mut sought = count + BEYOND;
        let mut found = find(resting, sought)?;
        while found.list.len() >= sought && is_cut(&found.list, count) {
            sought *= 2;
            found = find(resting, sought)?;
        }
        let Modes { list: mut modes, proved } = found;
        let asked = count.min(modes.len());
        let vectors = mode_vectors(resting, (&modes, asked), is_damped)?;
        let chain = self.analysis().checked_chain(&self.x)?;
        let is_free = !staying_states(&self.problem()).is_empty();
        let still = Still {
            vectors: &vectors,
            system: self.method.unreduced().system(&frame.model, &plan.dropped),
            p: &problem.p,
            active: &frame.parameters(&chain.active_parameters()),
            method: &self.method,
            t,
            is_damped,
            is_free: is_free || modes.iter().any(|mode| mode.frequency == 0.0 && mode.growth == 0.0),
        };
        let mut gradients: Vec<Option<ModeGradient>> = vec![None; asked];
        for (group, seeds) in vectors.groups.iter().zip(still.gradients()?) {
            let rows: Vec<[Vec<f64>; 2]> = seeds.iter().map(|seeds| by_design(&chain, &frame, seeds)).collect();
            if let [place] = group.modes[..] {
                (modes[place].growth, modes[place].frequency) = (group.lambda.re, group.lambda.im);
            }
            let own = group.modes.iter().zip(parted(group, &rows)?).filter(|(place, _)| **place < asked);
            own.for_each(|(&place, own)| gradients[place] = Some(own));
        }
        modes.truncate(asked);
        Ok(DifferentiatedModes { q: problem.start.q, modes, gradients, proved })
    }
}

/// Whether two modes have one value.
fn is_same(one: &Mode, other: &Mode) -> bool {
    (value_of(one) - value_of(other)).norm() <= SAME_MODE * value_of(other).norm()
}

/// A mode, with its derivatives where they were asked for.
type Measured = (Mode, Option<ModeGradient>);

impl Prepared<'_> {
    /// What is measured of modes.
    ///
    /// # Errors
    /// As for [`Prepared::complex_modes_with_state`]; fewer modes than that.
    #[doc(hidden)]
    pub fn measured_modes(&self, measures: &[ModeMeasure]) -> Result<Vec<f64>, RunError> {
        self.measured(measures, false, |modes, measure| Ok(measure.value(&modes[measure.number - 1].0)))
    }

    /// Its derivatives by all design variables.
    ///
    /// # Errors
    /// As for [`Prepared::modes_with_gradients`]; rigid motions, whose frequency has no derivative.
    #[doc(hidden)]
    pub fn measured_modes_by_design(&self, measures: &[ModeMeasure]) -> Result<Vec<Vec<f64>>, RunError> {
        let row = |modes: &[Measured], measure: &ModeMeasure| {
            let (own, gradient) = &modes[measure.number - 1];
            if gradient.is_none() {
                let ModeMeasure { name, number, .. } = measure;
                let first = modes.iter().position(|own| own.1.is_some());
                let first = first
                    .map_or("there is no other".into(), |first| format!("the first that is none is mode {}", first + 1));
                return Err(RunError::Input(format!(
                    "\"{name}\" is of mode {number}, a rigid motion here, which has no derivative: {first} (`costate modes` numbers them)"
                )));
            }
            let equal = |(mode, _): &&Measured| is_same(mode, own);
            let group: Vec<&ModeGradient> = modes.iter().filter(equal).filter_map(|own| own.1.as_ref()).collect();
            let mut mean = vec![0.0; self.x.len()];
            for gradient in &group {
                let rates = measure.rates(own, gradient);
                mean.iter_mut().zip(rates).for_each(|(mean, rate)| *mean += rate / group.len() as f64);
            }
            Ok(mean)
        };
        self.measured(measures, true, row)
    }

    /// What is made of the modes that measures are of, found by a count.
    fn measured<T>(
        &self,
        measures: &[ModeMeasure],
        with_gradients: bool,
        make: impl Fn(&[Measured], &ModeMeasure) -> Result<T, RunError>,
    ) -> Result<Vec<T>, RunError> {
        let mut all: Vec<Option<T>> = measures.iter().map(|_| None).collect();
        for damped in [false, true] {
            let own = || measures.iter().enumerate().filter(|(_, own)| own.damped == damped);
            let Some((_, last)) = own().max_by_key(|(_, own)| own.number) else { continue };
            let mut count = last.number + BEYOND;
            let modes = loop {
                let found = match with_gradients {
                    true => self.modes_with_gradients(count, damped)?,
                    false => self.modes_at_rest(count, damped || self.spin_rate().is_some())?,
                };
                let DifferentiatedModes { modes, mut gradients, proved, .. } = found;
                gradients.resize(modes.len(), None);
                let is_all = modes.len() < count;
                let modes: Vec<Measured> = modes.into_iter().zip(gradients).collect();
                let Some((own, _)) = modes.get(last.number - 1) else {
                    let ModeMeasure { name, number, .. } = last;
                    let there = if proved { "there are" } else { "those found are" };
                    let words = format!("\"{name}\" is of mode {number}; {there} only {}", modes.len());
                    return Err(RunError::Input(words));
                };
                // with all that have its value
                if is_all || modes.last().is_some_and(|(end, _)| !is_same(own, end)) {
                    break modes;
                }
                count *= 2;
            };
            for (place, measure) in own() {
                all[place] = Some(make(&modes, measure)?);
            }
        }
        Ok(all.into_iter().flatten().collect())
    }
}

/// A gradient by all variables, its real part first.
fn by_design(chain: &DesignChain, frame: &RestingModel, ValueSeeds { p, q }: &ValueSeeds) -> [Vec<f64>; 2] {
    let numbers = chain.real();
    [0, 1].map(|part| {
        let zeros = |list: &[f64]| vec![0.0; list.len()];
        let mut bar = ModelNumbers { p: zeros(&numbers.p), q: zeros(&numbers.q), v: zeros(&numbers.v) };
        frame.set_motion(&q[part], &mut bar.q, &mut bar.v);
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
