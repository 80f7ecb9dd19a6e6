use super::{DifferentiatedModes, Prepared};
use crate::assembly::{Model, RestingModel, VectorsAvq};
use crate::functionals::{Functional, Sample};
use crate::integrators::{
    ArcLength, InitialState, Mode, Modes, Observer, Path, Problem, Response, RestingProblem, RunError, StabilityCourse,
    StartPlan, StepRecord, Vibration, complex_modes, equilibrium_at, follow_path, forces_turn, harmonic_response, march,
    march_adaptive, march_dividing, resting_start, vibrations,
};
use crate::scalar::{COMPLEX_STEP, Complex64, SpatialVector, Vector3};

/// By how much of its size, or of 1, a variable changes where it is seen whether loads turn with it.
const SEEN: f64 = 0.1;

/// The last state of a run over load steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equilibrium {
    /// Load factor.
    pub load: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Multipliers.
    pub mu: Vec<f64>,
    /// Redundant constraint equations that were left out.
    pub dropped: Vec<usize>,
    /// Whether it stands, and where the path to it lost its stability.
    pub stability: Option<StabilityCourse>,
}

impl Observer for Equilibrium {
    fn step(&mut self, step: &StepRecord<f64>) -> Result<bool, RunError> {
        self.load = step.t + step.h;
        self.q.clone_from(&step.q);
        self.dropped.clone_from(&step.dropped);
        if let Some(last) = step.stages.last() {
            self.mu.clone_from(&last.solve.unknowns.mu);
        }
        Ok(true)
    }
}

impl Prepared<'_> {
    /// The equilibrium at the end of the load steps, with the method `static`.
    ///
    /// # Errors
    /// Another method, or a load step without equilibrium.
    pub fn equilibrium(&self) -> Result<Equilibrium, RunError> {
        if !self.method.table.is_static() {
            let name = &self.method.table.name;
            return Err(RunError::Input(format!("the method is \"{name}\"; equilibria are found by \"static\"")));
        }
        let (problem, mut last) = (self.problem(), Equilibrium::default());
        let run = match &self.control {
            Some(control) => march_adaptive(&problem, &self.method, control, &self.grid, &self.plan, &mut last).1?,
            None if self.divide => march_dividing(&problem, &self.method, &self.grid, &self.plan, &mut last).1?,
            None => march(&problem, &self.method, &self.grid, &self.plan, &mut last)?,
        };
        last.stability = run.stability;
        Ok(last)
    }

    /// Coordinates of the equilibrium at which the motion begins, with the values of states of first order in the places of theirs; those that the
    /// scene gives where it does not begin at one.
    ///
    /// # Errors
    /// An equilibrium that is not found.
    pub fn resting_start(&self) -> Result<Vec<f64>, RunError> {
        let start = resting_start(&self.problem(), &self.method, &self.plan)?;
        Ok(self.model().about_rest(false).coordinates(&start.q, &start.v))
    }

    /// Equilibria along their path, through limits of the load; the load factor is 0 at the start, whatever the method.
    ///
    /// # Errors
    /// A start or options that are no good, a first equilibrium that is not found, or a path that ends, with its last load.
    pub fn path(&self, arc: &ArcLength) -> Result<Path, RunError> {
        follow_path(&self.problem(), &self.method, &self.plan, arc)
    }

    /// Lowest modes of small undamped vibrations: with the method `static` about the equilibrium at the end of the load steps, otherwise
    /// about the start, which must be one, or is looked for in a run from equilibrium.
    ///
    /// # Errors
    /// See [`Prepared::equilibrium`], and modes that are there by their count, but were not found.
    pub fn modes(&self, count: usize) -> Result<Vec<Mode>, RunError> {
        Ok(self.modes_at_rest(count, false)?.modes)
    }

    /// What vibrates about a state: its model in the frame of that, with parameters and start.
    fn vibrating<'f>(&self, frame: &RestingModel, model: &'f Model, start: InitialState<f64>) -> Problem<'f, f64> {
        Problem { model, p: frame.parameters(&self.mechanism.numbers.p), start }
    }

    /// Lowest modes of small vibrations with dampers, states of first order and, about a steady turn, Coriolis and centrifugal forces in the frame
    /// that turns; with the coordinates about which they vibrate first.
    ///
    /// # Errors
    /// As for [`Prepared::modes`].
    pub fn complex_modes_with_state(&self, count: usize) -> Result<(Vec<f64>, Vec<Mode>), RunError> {
        let found = self.modes_at_rest(count, true)?;
        Ok((found.q, found.modes))
    }

    /// The modes of either, and whether it is proved that none is missing; their derivatives are by [`Prepared::modes_with_gradients`].
    ///
    /// # Errors
    /// As for [`Prepared::modes`].
    pub fn modes_at_rest(&self, count: usize, damped: bool) -> Result<DifferentiatedModes, RunError> {
        let (frame, start, plan, load) = self.still_state()?;
        let vibrating = if damped { frame.model.clone() } else { frame.model.with_states_held() };
        let problem = self.vibrating(&frame, &vibrating, start);
        let find = if damped { complex_modes } else { vibrations };
        let resting = RestingProblem { problem: &problem, method: &self.method, plan: &plan, t: load };
        let Modes { list, proved } = find(resting, count)?;
        Ok(DifferentiatedModes { q: problem.start.q, modes: list, gradients: Vec::new(), proved })
    }

    /// How what the functionals measure vibrates where a design variable d varies harmonically by a small d cos(omega t) about the equilibrium of
    /// [`Prepared::modes`]: for each rate omega [rad/s] and each functional, in their order, the real and imaginary part of its complex
    /// amplitude by d. A force whose size is the variable gives receptances, a driver whose displacement is the variable transmissibilities.
    /// Equations know the variable by its value alone: a damper sees no rate of it. About a steady turn what vibrates is seen from the frame that turns
    /// (a load of a part that turns is at rest there), and read at moments when that stands as at the start.
    ///
    /// # Errors
    /// As for [`Prepared::modes`]; an unknown variable, one that is part of a steady turn, a rate at which nothing determines the response.
    pub fn frequency_response(&self, variable: &str, rates: &[f64]) -> Result<Vec<Vec<[f64; 2]>>, RunError> {
        let mut x: Vec<Complex64> = self.x.iter().map(|&x| x.into()).collect();
        let place = self.variable(variable)?;
        x[place].im = COMPLEX_STEP;
        let varied = self.analysis().numbers_with_parts(&x)?.p;
        if self.model().spin.as_ref().is_some_and(|spin| varied[spin.parameters.clone()].iter().any(|own| own.im != 0.0)) {
            return Err(RunError::Input(format!(
                "\"{variable}\" is part of the steady turn itself: a response is that of vibrations about it"
            )));
        }
        let (frame, start, plan, load) = self.still_state()?;
        // a load that is zero turns with everything, and its change may not
        let more = SEEN * self.x[place].abs().max(1.0) / COMPLEX_STEP;
        let changed: Vec<f64> = varied.iter().map(|own| own.re + more * own.im).collect();
        let (mut q, mut v) = (start.q.clone(), start.v.clone());
        frame.set_motion(&start.q, &mut q, &mut v);
        forces_turn(self.model(), &changed, [&q, &v])
            .map_err(|error| RunError::Input(format!("with more of \"{variable}\" {error}")))?;
        let problem = self.vibrating(&frame, &frame.model, start);
        let resting = RestingProblem { problem: &problem, method: &self.method, plan: &plan, t: load };
        let response = harmonic_response(resting, &frame.parameters(&varied), rates)?;
        let all = rates.iter().zip(&response.vibrations);
        Ok(all
            .map(|(&omega, own)| self.measured_amplitudes(&frame, (&response, &plan.dropped, load), &varied, (omega, own)))
            .collect())
    }

    /// Velocities of the same motion with those of the steady turn at these coordinates, or at changes of them.
    fn turned(&self, x: &[Complex64], is_change: bool) -> Vec<Complex64> {
        let mut v = vec![Complex64::default(); x.len()];
        let Some(spin) = &self.model().spin else { return v };
        let numbers: Vec<Complex64> =
            self.mechanism.numbers.p[spin.parameters.clone()].iter().map(|&own| own.into()).collect();
        let about = if is_change { Vector3::zeros() } else { Vector3::first_three(&numbers) };
        let omega = Vector3::first_three(&numbers[3..]) * numbers[6];
        for node in spin.nodes.iter().map(|node| &self.model().nodes[node.0]) {
            node.kind.turn(&x[node.dofs.clone()], about, omega, &mut v[node.dofs.clone()]);
        }
        v
    }

    /// Complex amplitudes of what the functionals measure.
    fn measured_amplitudes(
        &self,
        frame: &RestingModel,
        (response, dropped, t): (&Response, &[usize], f64),
        varied: &[Complex64],
        (omega, Vibration { x, mu }): (f64, &Vibration),
    ) -> Vec<[f64; 2]> {
        let with = |values: &[f64], parts: &[f64], factor: f64| -> Vec<Complex64> {
            values.iter().zip(parts).map(|(&value, part)| Complex64::new(value, factor * part * COMPLEX_STEP)).collect()
        };
        let still = vec![0.0; response.q.len()];
        let real: Vec<Complex64> = varied.iter().map(|own| own.re.into()).collect();
        // x' = i omega x and x'' = -omega^2 x: the rate of the real part is -omega times the imaginary one
        let samples = [(0, 1, -omega, varied), (1, 0, omega, &real)].map(|(own, other, turn, p)| {
            let mut at = VectorsAvq {
                a: with(&still, &x[own], -omega * omega),
                v: with(&still, &x[other], turn),
                q: with(&response.q, &x[own], 1.0),
            };
            // in the world at the moment when the frame stands as at the start: x' + Omega x, x'' + 2 Omega x' + Omega Omega x
            let of_turn = self.turned(&at.q, false);
            let (coriolis, centripetal) = (self.turned(&at.v, true), self.turned(&of_turn, true));
            for k in 0..at.q.len() {
                at.a[k] += coriolis[k] * 2.0 + centripetal[k];
                at.v[k] += of_turn[k];
            }
            frame.in_motion(&mut at);
            let mu = with(&response.mu, &mu[own], 1.0);
            let mut sample = Sample { t: t.into(), at, mu, dropped: dropped.to_vec(), ..Sample::empty() };
            sample.share(self.model(), p);
            (sample, p)
        });
        let part = |functional: &Functional| {
            samples.each_ref().map(|(sample, p)| functional.measured_at(self.model(), sample, p).im / COMPLEX_STEP)
        };
        self.functionals().iter().map(part).collect()
    }

    /// The model of small motions, the state about which things vibrate, the equations that are left out there, and the load factor.
    pub(super) fn still_state(&self) -> Result<(RestingModel, InitialState<f64>, StartPlan, f64), RunError> {
        let (mut plan, mut load) = (self.plan.clone(), 0.0);
        let mut start = resting_start(&self.problem(), &self.method, &plan)?;
        if self.method.table.is_static() {
            let found = self.equilibrium()?;
            (load, start.q, plan.dropped) = (found.load, found.q, found.dropped);
        }
        let frame = self.model().about_rest(self.plan.equilibrium.is_some());
        start.q = frame.coordinates(&start.q, &start.v);
        self.model().state_dofs().for_each(|dof| start.v[dof] = 0.0);
        if self.model().state_dofs().next().is_some() {
            // undamped modes leave states where they are
            let problem = self.vibrating(&frame, &frame.model, start.clone());
            start.q = equilibrium_at(RestingProblem { problem: &problem, method: &self.method, plan: &plan, t: load })?;
        }
        Ok((frame, start, plan, load))
    }

    /// The rate of the steady turn at which the motion begins [rad/s], if it begins with one.
    pub fn spin_rate(&self) -> Option<f64> {
        self.plan.equilibrium.as_ref()?;
        Some(self.mechanism.numbers.p[self.model().spin.as_ref()?.parameters.end - 1])
    }

    /// Takes another rate of that turn [rad/s].
    pub fn turn_at(&mut self, rate: f64) {
        if let Some(spin) = &self.mechanism.model.spin {
            self.mechanism.numbers.p[spin.parameters.end - 1] = rate;
        }
    }

    /// How a mode about a state q goes round the axis of the steady turn, in its frame: from 1, circles with the sense of the axis, by 0, no circles, to
    /// -1, circles against it; turns of bodies count with the length of the largest coordinate. `None` without a steady turn, and of what moves
    /// along the axis alone.
    pub fn whirl(&self, q: &[f64], mode: &Mode) -> Option<f64> {
        let spin = self.model().spin.as_ref()?;
        let axis = Vector3::first_three(&self.mechanism.numbers.p[spin.parameters.clone()][3..]);
        let across = |x: Vector3<f64>| x - axis * axis.dot(&x);
        let length = q.iter().fold(0.0, |most: f64, q| most.max(q.abs()));
        let (mut round, mut size) = (0.0, 0.0);
        for node in spin.nodes.iter().map(|node| &self.model().nodes[node.0]) {
            let motions = [&mode.shape, &mode.ahead].map(|own| {
                let (own, q) = (&own[node.dofs.clone()], &q[node.dofs.clone()]);
                [Vector3::first_three(own), node.kind.angular_velocity(own, q) * length].map(across)
            });
            for (shape, ahead) in motions[0].iter().zip(&motions[1]) {
                round += axis.dot(&ahead.cross(shape));
                size += 0.5 * (shape.dot(shape) + ahead.dot(ahead));
            }
        }
        (size > 0.0).then(|| round / size)
    }
}
