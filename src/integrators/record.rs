use super::{Pause, RunError, Scheme, SetNumber, SideChange, StepRule};
use crate::assembly::{Clock, Equations, JointFriction, Unknowns, VectorsAvq, clone_fields};
use crate::elements::RunScalar;
use crate::scalar::Scalar;

/// One solved system: all that the adjoint needs to go back through it.
#[derive(Debug, PartialEq)]
pub struct SolveRecord<S> {
    /// Time \[s\].
    pub t: f64,
    /// Its kind.
    pub equations: Equations,
    /// Point from which the unknowns move.
    pub base: VectorsAvq<S>,
    /// The solution.
    pub unknowns: Unknowns<S>,
}

impl<S: Scalar> SolveRecord<S> {
    /// Writes the acceleration at a stage that starts from none: that of an equilibrium is zero.
    pub(crate) fn write_acceleration(&self, a: &mut Vec<S>) {
        let gamma = self.equations.residual.gamma;
        a.clear();
        a.extend(self.unknowns.x.iter().map(|&x| x * gamma));
    }

    /// (a, v, q) at the solution.
    pub fn point(&self) -> VectorsAvq<S> {
        VectorsAvq::shifted(&self.base, self.equations.residual, &self.unknowns)
    }
}

/// One stage of a step.
#[derive(Debug, PartialEq)]
pub struct StageRecord<S> {
    /// The stage's system; for a known stage the point alone, with its acceleration as x.
    pub solve: SolveRecord<S>,
    /// Carried vector that is the acceleration of an explicit first stage, which is not solved for.
    pub known: Option<usize>,
}

/// One step.
#[derive(Debug, PartialEq)]
pub struct StepRecord<S> {
    /// Start of the step \[s\].
    pub t: f64,
    /// Size of the step \[s\].
    pub h: f64,
    /// Its end \[s\]: t + h but for rounding.
    pub(crate) end: f64,
    /// Which of the method's tables made it.
    pub scheme: Scheme,
    /// Redundant constraint equations that are left out.
    pub dropped: Vec<usize>,
    /// Sides of switches that change where it starts; the first of them ended the step before.
    pub switched: Vec<SideChange>,
    /// How time goes, where derivative parts move the ends of the step.
    pub(crate) clock: Option<Clock<S>>,
    /// Derivative parts of the length of an Euler step, which no clock can measure as a share of it \[s\].
    pub(crate) lengthened: Option<S>,
    /// Acceleration solved anew at the start: at a breakpoint, or because other redundant equations are left out from here on.
    pub restart: Option<SolveRecord<S>>,
    /// The table's carried vectors before the step, q and v first.
    pub(crate) carried: Vec<Vec<S>>,
    /// Stages.
    pub stages: Vec<StageRecord<S>>,
    /// Projection of the coordinates at the end.
    pub position_projection: Option<SolveRecord<S>>,
    /// Projection of the velocities at the end.
    pub velocity_projection: Option<SolveRecord<S>>,
    /// Coordinates at the end.
    pub q: Vec<S>,
    /// Velocities at the end.
    pub v: Vec<S>,
    /// Accelerations of the state there with their multipliers, where these tell the event that ends the step.
    pub forces: Option<SolveRecord<S>>,
    /// What events set there, from where the next step goes on.
    pub set: Vec<SetNumber<S>>,
    /// Impacts there.
    pub impacts: Vec<ImpactRecord<S>>,
    /// Directions of what sticks from there on.
    pub axes: Vec<AxisRecord<S>>,
}

/// An impact at the end of a step.
#[derive(Debug, PartialEq)]
pub struct ImpactRecord<S> {
    /// Number of the event whose it is, among those that happen there.
    pub event: usize,
    /// The change of velocities x under which the equations of the joints that are hit stand still, and impulses mu.
    pub solve: SolveRecord<S>,
    /// Equations that are left out in it.
    pub dropped: Vec<usize>,
    /// Place in p of the restitution e: velocities change by (1 + e) x; without one by x.
    pub restitution: Option<usize>,
    /// Other stops that are hit in it.
    pub others: Vec<OtherHit>,
    /// Places in mu and in v of impulses and of the states to which their sizes are added.
    pub impulses: Vec<[usize; 2]>,
    /// Parameters that are others in it, by their places: which surfaces slip where.
    pub set: Vec<(usize, f64)>,
    /// Slip that sticking surfaces have in it, so that with restitution none is left.
    pub kept: Vec<SlipBefore<S>>,
    /// Directions of what sticks in it.
    pub axes: Vec<AxisRecord<S>>,
}

/// A stop that is hit at the same time as another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherHit {
    /// Its equation.
    pub row: usize,
    /// Place in p of its own restitution e'; zero without.
    pub restitution: Option<usize>,
}

/// The direction along which joints alone let surfaces slip that stick: that of their slip behind the second of two impacts less that behind the first,
/// of which the second makes them slip.
#[derive(Debug, PartialEq)]
pub struct AxisRecord<S> {
    /// Number of the friction.
    pub friction: usize,
    /// Both impacts, of which none happens.
    pub impacts: [ImpactRecord<S>; 2],
}

/// Slip before an impact.
#[derive(Debug, PartialEq)]
pub struct SlipBefore<S> {
    /// Number of the friction.
    pub friction: usize,
    /// Its velocities.
    pub slip: Vec<S>,
}

clone_fields!(SolveRecord { t, equations, base, unknowns });
clone_fields!(ImpactRecord { event, solve, dropped, restitution, others, impulses, set, kept, axes });
clone_fields!(AxisRecord { friction, impacts });
clone_fields!(SlipBefore { friction, slip });
clone_fields!(StageRecord { solve, known });
clone_fields!(StepRecord {
    t,
    h,
    end,
    scheme,
    dropped,
    switched,
    clock,
    lengthened,
    restart,
    carried,
    stages,
    position_projection,
    velocity_projection,
    q,
    v,
    forces,
    set,
    impacts,
    axes
});

impl<S: Scalar> ImpactRecord<S> {
    /// How much of x velocities change by.
    pub fn factor(&self, p: &[S]) -> S {
        self.restitution.map_or(S::one(), |place| p[place] + S::one())
    }

    /// The shares of the rates before it that the equations of other stops keep behind x, by their rows: (e - e') / (1 + e), so that (1 + e) x turns a
    /// rate r to -e' r.
    pub fn shares(&self, p: &[S]) -> Vec<(usize, S)> {
        let of = |place: Option<usize>| place.map_or(S::zero(), |place| p[place]);
        let e = of(self.restitution);
        self.others.iter().map(|own| (own.row, (e - of(own.restitution)) / (e + S::one()))).collect()
    }

    /// Writes the parameters that are others in it: with restitution velocities change by (1 + e) x, so that e / (1 + e) of a slip is left behind x.
    pub fn set_parameters(&self, frictions: &[JointFriction], p: &mut [S]) {
        let share = self.restitution.map_or(S::zero(), |place| p[place] / (p[place] + S::one()));
        self.set.iter().for_each(|&(place, value)| p[place] = S::from(value));
        for SlipBefore { friction, slip } in &self.kept {
            p[frictions[*friction].kept.clone()].iter_mut().zip(slip).for_each(|(p, &slip)| *p = share * slip);
        }
    }

    /// Adds what it changes to velocities and states that are measured by a time that goes `pace` times as fast.
    pub fn add_to(&self, v: &mut [S], p: &[S], pace: S) {
        let factor = self.factor(p) * pace;
        v.iter_mut().zip(&self.solve.unknowns.x).for_each(|(v, &x)| *v += x * factor);
        self.sizes().for_each(|(_, dof, size)| v[dof] += size * factor);
    }

    /// Rows of its impulses, the states to which their sizes are added, and those without restitution.
    fn sizes(&self) -> impl Iterator<Item = (usize, usize, S)> + '_ {
        self.impulses.iter().map(|&[row, dof]| {
            let own = self.solve.unknowns.mu[row];
            (row, dof, if own.value() < 0.0 { -own } else { own })
        })
    }
}

impl ImpactRecord<f64> {
    /// Adds the adjoint of its multipliers by that of velocities and states, and that of the restitution.
    pub fn go_back(&self, v_bar: &[f64], p: &[f64], mu_bar: &mut [f64], p_bar: &mut [f64]) {
        let along: f64 = self.solve.unknowns.x.iter().zip(v_bar).map(|(x, bar)| x * bar).sum();
        let factor = self.factor(p);
        self.sizes().for_each(|(row, dof, _)| mu_bar[row] += factor * self.solve.unknowns.mu[row].signum() * v_bar[dof]);
        if let Some(place) = self.restitution {
            p_bar[place] += along + self.sizes().map(|(_, dof, size)| size * v_bar[dof]).sum::<f64>();
        }
    }
}

impl<S: Scalar> StepRecord<S> {
    /// Velocities and coordinates from which it starts.
    #[doc(hidden)]
    pub fn start(&self) -> [&[S]; 2] {
        [&self.carried[1], &self.carried[0]]
    }

    /// Its time by the laid one, in which integrals go over it.
    pub(crate) fn length(&self) -> S
    where
        S: RunScalar,
    {
        let lengthened = self.lengthened.map_or(S::one(), |own| S::one() + own / self.h);
        self.clock.map_or(lengthened, |clock| lengthened * clock.length())
    }

    /// Whether the acceleration at its start does not come from a step before, for the number `index` of steps before.
    pub(super) fn begins_anew(&self, index: usize) -> bool {
        index == 0 || self.restart.is_some()
    }
}

/// What happens before the first step.
#[derive(Clone, Debug, PartialEq)]
pub struct StartRecord<S> {
    /// Redundant constraint equations that are left out.
    pub dropped: Vec<usize>,
    /// Sides of switches.
    pub sides: Vec<f64>,
    /// How time goes, where derivative parts move the ends of steps.
    pub(crate) clock: Option<Clock<S>>,
    /// The equilibrium at the start, if asked for: its unknowns lead there from the given coordinates.
    pub equilibrium: Option<SolveRecord<S>>,
    /// Projection of the given coordinates, if asked for.
    pub position_projection: Option<SolveRecord<S>>,
    /// Projection of the given velocities, if asked for.
    pub velocity_projection: Option<SolveRecord<S>>,
    /// The first acceleration and its multipliers.
    pub acceleration: SolveRecord<S>,
    /// Directions of what sticks there.
    pub axes: Vec<AxisRecord<S>>,
}

/// Sees the steps of an earlier run again; `false` stops it.
pub type Replay<'r, S> = &'r mut dyn FnMut(&StepRecord<S>) -> Result<bool, RunError>;

/// Sees a run step by step while it goes on.
pub trait Observer<S = f64> {
    /// The start, after projections.
    ///
    /// # Errors
    /// What the observer could not do.
    fn start(&mut self, _start: &StartRecord<S>) -> Result<(), RunError> {
        Ok(())
    }
    /// A finished step; `false` stops the run.
    ///
    /// # Errors
    /// What the observer could not do.
    fn step(&mut self, step: &StepRecord<S>) -> Result<bool, RunError>;
    /// Before step `index`, with everything from which the run can go on there.
    #[doc(hidden)]
    fn checkpoint(&mut self, _index: usize, _pause: &dyn Fn() -> Pause<S>) -> Result<(), RunError> {
        Ok(())
    }
    /// Behind the last step, with the same.
    #[doc(hidden)]
    fn end(&mut self, _pause: &dyn Fn() -> Pause<S>) -> Result<(), RunError> {
        Ok(())
    }
    /// Asked behind the start: where the run was before, if steps of it are kept already, which are handed out in their order.
    /// [`RunError::Interrupted`] if the function returns `false`.
    #[doc(hidden)]
    fn take_up(&mut self, _rule: StepRule, _steps: Replay<S>) -> Result<Option<Pause<S>>, RunError> {
        Ok(None)
    }
}

/// Hands out the steps of a finished real run one after the other.
pub trait Steps {
    /// The next one; `None` behind the last.
    fn next(&mut self) -> Result<Option<&StepRecord<f64>>, RunError>;
}
