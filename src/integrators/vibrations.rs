//! Small undamped vibrations about an equilibrium: K x = omega^2 M x on the manifold of the constraints.
//!
//! With R and A at (0, 0, q): M = dR/da, and K = d(R + A^T mu)/dq holds the geometric stiffness and the curvature of all reactions.
//! Loads and drivers are frozen, dampers have no effect, and states of first order stay at the values of the equilibrium: what their rates do to a
//! vibration is damping. The lowest modes are the largest of the operator x -> y,
//!
//! ```text
//! (K + s M) y + A^T nu = M x,  A y = 0:   theta = 1 / (omega^2 + s),
//! ```
//!
//! of which a small model has as many as directions with inertia, and all are found. Those of a large one come from a block Krylov space that is
//! orthonormal in M; where K is symmetric, the number of negative eigenvalues of K - r M tells how many modes have omega^2 below r (Sylvester's
//! law): none of them is missing. The shift s > 0 makes the matrix regular where a body is free, with omega = 0; directions without inertia vibrate
//! infinitely fast and are not found.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::amplitudes::entries;
use super::krylov::{Space, ZERO, add, all_pairs, dot, in_order, largest_pairs, magnitude};
use super::march::{Method, Problem};
use super::newton::Newton;
use super::{RunError, Stability, StartPlan, Stop};
use crate::assembly::{Equations, Jacobian, Level, Residual, StageCoefficients, StageSystem, Unknowns, VectorsAvq};
use crate::linalg::Eigenpair;

/// One mode: the motion is the real part of shape exp((growth + i frequency) t), and where it grows also one that fades as fast.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// omega [rad/s]; 0 for a rigid motion, and for an unstable equilibrium that is left without a vibration.
    pub frequency: f64,
    /// Rate of growth [1/s], negative for one that fades: 0 of an undamped mode of a stable equilibrium.
    pub growth: f64,
    /// Change of every coordinate of the model, x^H M x = 1; the largest one is positive.
    pub shape: Vec<f64>,
    /// The part that runs ahead by a quarter of a period: zero unless follower loads, dampers or a turn make it.
    pub ahead: Vec<f64>,
}

impl Mode {
    /// Share of the critical damping: - growth by the size of growth + i omega; 0 of a rigid motion.
    pub fn damping_ratio(&self) -> f64 {
        let size = self.growth.hypot(self.frequency);
        if size > 0.0 { -self.growth / size } else { 0.0 }
    }

    /// True if a small disturbance grows.
    pub fn is_unstable(&self) -> bool {
        self.growth > 0.0
    }

    /// True if it leaves the equilibrium without swinging about it.
    pub fn topples(&self) -> bool {
        self.growth > 0.0 && self.frequency == 0.0
    }

    /// By which modes are in order: |growth + i omega|^2, less than 0 for those that topple.
    fn rank(&self) -> f64 {
        let square = self.growth * self.growth + self.frequency * self.frequency;
        if self.topples() { -square } else { square }
    }
}

/// Modes in their order: those that topple, the fastest first, then the others by |growth + i omega|.
pub(crate) struct Modes {
    pub list: Vec<Mode>,
    /// Whether it is proved that none is missing before the last one, or at all where fewer were found than asked for.
    pub proved: bool,
}

impl Modes {
    pub(super) fn first(mut list: Vec<Mode>, count: usize, proved: bool) -> Self {
        list.sort_by(|a, b| a.rank().total_cmp(&b.rank()).then(a.growth.total_cmp(&b.growth)));
        list.truncate(count);
        Modes { list, proved }
    }
}

/// First shift, as a share of the largest ratio of stiffness and inertia.
const FIRST_SHIFT: f64 = 1e-8;
const MOST_SHIFTS: usize = 6;
/// A shift this much smaller or larger than the lowest mode that is not rigid is chosen anew.
const FAR: [f64; 2] = [1e-2, 10.0];
/// By how much omega^2 may be larger than the shift at which it is found.
const RANGE: f64 = 1e5;
/// Another shift where it is.
const SMALLER: f64 = 1e-6;
/// x^T K x is round-off of zero below this share of the sum of |x_i K_ij x_j|: a thousand units of the last digit of K.
pub(super) const NOISE: f64 = 1e3 * f64::EPSILON;
/// Displacement towards an equilibrium, as a share of the largest coordinate, beyond which a state is none.
const AWAY: f64 = 1e-7;
/// Displacement that is round-off, likewise.
const LAST_DIGITS: f64 = 100.0 * f64::EPSILON;
const REFINEMENTS: usize = 2;
const SPARE: usize = 2;
/// Distance of a bound from the last mode below which others are counted, as a share of its omega^2.
const BESIDE: f64 = 1e-6;
/// A bound above every omega^2, in largest ratios of stiffness and inertia.
const ABOVE: f64 = 1e4;
/// Searches, each from more vectors than the one before, until no mode is missing.
const MOST_SEARCHES: usize = 4;

/// A problem whose start must be an equilibrium at a time, or load factor.
#[derive(Clone, Copy)]
pub(crate) struct RestingProblem<'m> {
    pub problem: &'m Problem<'m, f64>,
    pub method: &'m Method,
    pub plan: &'m StartPlan,
    pub t: f64,
}

/// The modes about an equilibrium: the first `count`, fewer where there are no more.
pub(crate) fn vibrations(resting: RestingProblem, count: usize) -> Result<Modes, RunError> {
    let mut operator = Operator::new(resting, count)?;
    if operator.nodes == 0 {
        return Ok(Modes { list: Vec::new(), proved: true });
    }
    let largest = operator.largest_ratio();
    let mut shift = if largest > 0.0 { FIRST_SHIFT * largest } else { 1.0 };
    operator.set_shift([shift, 0.0])?;
    let whole = operator.motions(None, 1).map(|own| own.inertial);
    let stiffness = operator.stiffness();
    let find = |operator: &mut Operator, shift: f64| {
        operator.set_shift([shift, 0.0])?;
        match &whole {
            Some(whole) => Ok(all_pairs(operator, whole)?.1),
            None => largest_pairs(operator, count, SPARE),
        }
    };
    let mut ritz = find(&mut operator, shift)?;
    for _ in 1..MOST_SHIFTS {
        let found: Vec<(f64, bool)> = ritz
            .iter()
            .map(|pair| {
                let [re, im] = square(pair, shift);
                // at the shift of an unstable mode K + s M is singular
                (if re < 0.0 { -re.hypot(im) } else { re.hypot(im) }, operator.is_rigid(&stiffness, &pair.vector))
            })
            .collect();
        let Some(other) = chosen_shift(&found, shift) else { break };
        shift = other;
        ritz = find(&mut operator, shift)?;
    }
    let (pairs, proved) = match &whole {
        // what is too far from the shift to be told from infinity comes last
        Some(own) => {
            let least = f64::EPSILON * own.basis.len() as f64;
            let place = |pair: &Eigenpair, shift: f64| {
                let [re, im] = square(pair, shift);
                match magnitude(pair) * shift <= least {
                    true => f64::INFINITY,
                    false if im == 0.0 => re,
                    false => re.hypot(im),
                }
            };
            (in_order((ritz, shift), (count, RANGE), &place, &mut |shift| find(&mut operator, shift))?, true)
        }
        None => {
            let proved = operator.complete(&mut ritz, (count, shift, largest), &stiffness)?;
            (ritz.into_iter().map(|pair| (pair, shift)).collect(), proved)
        }
    };
    let mode = |(pair, shift): &(Eigenpair, f64)| {
        let [mut re, mut im] = square(pair, *shift);
        if operator.is_rigid(&stiffness, &pair.vector) {
            (re, im) = (0.0, 0.0);
        }
        // (growth + i omega)^2 = -omega^2
        let size = re.hypot(im);
        let [growth, frequency] = [(0.5 * (size - re)).max(0.0).sqrt(), (0.5 * (size + re)).max(0.0).sqrt()];
        let [shape, ahead] = operator.in_coordinates(pair.vector.clone());
        Mode { frequency, growth, shape, ahead }
    };
    Ok(Modes::first(pairs.iter().map(mode).collect(), count, proved))
}

/// The equilibrium, states of first order with it.
pub(crate) fn equilibrium_at(resting: RestingProblem) -> Result<Vec<f64>, RunError> {
    Ok(Operator::at_equilibrium(resting)?.base.q)
}

const PLACE: &str = "vibrations";

/// The error of an unknown that K + s M does not determine.
fn undetermined(unknown: String) -> RunError {
    RunError::singular(PLACE, &unknown, "it has neither inertia nor stiffness: give it a mass, a spring or a joint")
}

/// A shift that suits omega^2 that were found with another one better, and what of them is rigid; half of the least where some are on the side of
/// the shift.
fn chosen_shift(found: &[(f64, bool)], shift: f64) -> Option<f64> {
    let moving = || found.iter().filter(|own| !own.1).map(|own| own.0);
    let lowest = moving().fold(f64::INFINITY, |least: f64, own| least.min(own.abs()));
    if lowest <= ZERO * shift {
        return Some(SMALLER * shift);
    }
    let too_small = moving().count() < found.len() && shift < FAR[0] * lowest;
    let is_far = lowest.is_finite() && (too_small || shift > FAR[1] * lowest);
    is_far.then_some(if moving().any(|own| own < 0.0) { 0.5 * lowest } else { lowest })
}

/// omega^2 = 1 / theta - s.
fn square(pair: &Eigenpair, shift: f64) -> [f64; 2] {
    let [re, im] = pair.value;
    let size = re * re + im * im;
    [re / size - shift, -im / size]
}

/// A model at an equilibrium, and what is linear in small motions about it.
pub(super) struct Operator<'m> {
    problem: &'m Problem<'m, f64>,
    /// Its matrix is that of K + beta C + gamma M with the constraints.
    pub newton: Newton<'m, f64>,
    /// M, with rows A.
    pub mass: Jacobian,
    /// Unknowns of nodes, in front of multipliers.
    pub nodes: usize,
    pub base: VectorsAvq<f64>,
    pub reactions: Unknowns<f64>,
    t: f64,
    is_symmetric: bool,
}

impl Space for Operator<'_> {
    fn size(&self) -> usize {
        self.nodes
    }
    fn is_symmetric(&self) -> bool {
        self.is_symmetric
    }
    fn image(&self, vector: &[f64]) -> Vec<f64> {
        self.times_mass(vector)
    }
    fn apply(&mut self, image: &[f64]) -> Vec<f64> {
        self.solve_nodes(image)
    }
    fn obey_constraints(&mut self, vector: &mut [f64]) {
        self.obey(vector);
    }
}

impl<'m> Operator<'m> {
    /// At the start, where nothing may move, for so many modes.
    pub fn new(RestingProblem { problem, method, plan, t }: RestingProblem<'m>, count: usize) -> Result<Self, RunError> {
        if count == 0 {
            return Err(RunError::Input("0 modes are asked for; it must be at least 1".into()));
        }
        if let Some(dof) = problem.start.v.iter().position(|&v| v != 0.0) {
            return Err(RunError::Input(format!(
                "initial velocity of {} is {}, and vibrations are about what rests: set it to 0 (who moves evenly along with a motion sees it at rest), \
                 begin with a steady turn ([[spin]] and start = \"steady\" of a scene file), or take a run of one period (--periodic)",
                problem.model.dof_name(dof),
                problem.start.v[dof]
            )));
        }
        super::start::check_stillness(problem)?;
        let system = method.system(problem.model, &plan.dropped);
        let newton = Newton::new(system, method.tolerance, method.backend);
        let newton = newton.map_err(|singular| RunError::of_pattern(PLACE, singular))?;
        let system = newton.system.clone();
        let nodes = system.multiplier_places().iter().flatten().min().copied().unwrap_or(system.size());
        let base = VectorsAvq { q: problem.start.q.clone(), ..VectorsAvq::zeros(problem.model.dofs) };
        let (mass, reactions) = (Jacobian::default(), Unknowns::default());
        Ok(Operator { problem, newton, mass, nodes, base, reactions, t, is_symmetric: false })
    }

    /// Where states of first order have come to rest, too.
    pub fn at_equilibrium(resting: RestingProblem<'m>) -> Result<Self, RunError> {
        let mut operator = Operator::new(resting, 1)?;
        let largest = operator.largest_ratio();
        let shift = if largest > 0.0 { FIRST_SHIFT * largest } else { 1.0 };
        // states that integrate what moves have a place in C alone
        operator.set_shift([shift, shift.sqrt()])?;
        Ok(operator)
    }

    /// Largest ratio of stiffness and inertia of one coordinate [1/s2]: above most omega^2.
    pub fn largest_ratio(&mut self) -> f64 {
        self.reactions = self.newton.reactions_at_release(&self.base, &self.problem.p, self.t);
        self.assemble_mass();
        let stiffness = self.stiffness();
        let system = &self.newton.system;
        let diagonal = (0..self.nodes).filter_map(|i| system.pattern.position(i, i));
        diagonal.fold(0.0, |largest: f64, place| {
            let (stiffness, mass) = (stiffness.values[place].abs(), self.mass.values[place]);
            if mass > 0.0 { largest.max(stiffness / mass) } else { largest }
        })
    }

    /// K with the reactions that are known, and the constraints.
    pub fn stiffness(&mut self) -> Jacobian {
        let equations = Equations::EQUILIBRIUM;
        let Operator { newton: Newton { system, residual, .. }, base, reactions, problem: Problem { p, .. }, t, .. } = self;
        let mut stiffness = Jacobian::default();
        residual.evaluate(system, StageSystem { equations: &equations, base, p, t: *t }, reactions);
        stiffness.assemble(system, &equations, residual, reactions, p, *t);
        stiffness
    }

    fn assemble_mass(&mut self) {
        self.mass = self.assembled(&Equations::acceleration());
    }

    /// A matrix without reactions: M, or C with the rows A.
    pub fn assembled(&mut self, equations: &Equations) -> Jacobian {
        let Newton { system, residual, .. } = &mut self.newton;
        let (mut matrix, mut unknowns) = (Jacobian::default(), Residual::unknowns(system));
        let stage = StageSystem { equations, base: &self.base, p: &self.problem.p, t: self.t };
        residual.evaluate(system, stage, &mut unknowns);
        matrix.assemble(system, equations, residual, &unknowns, &self.problem.p, self.t);
        matrix
    }

    /// Finds the reactions of the equilibrium and factors K + beta C + gamma M there: with a = gamma x, v = beta x and q + x the equations have the
    /// solution x = 0 in an equilibrium, stable or not, and that matrix.
    pub fn set_shift(&mut self, [gamma, beta]: [f64; 2]) -> Result<(), RunError> {
        let Problem { model, p, .. } = self.problem;
        let equations = Equations::stage(StageCoefficients::new(gamma, beta, 1.0), Level::Position);
        let mut unknowns = self.newton.reactions_at_release(&self.base, p, self.t);
        let no_equilibrium = |how: String| {
            Err(RunError::Input(format!(
                "vibrations need an equilibrium to start from, but {how}: begin at one (start = \"equilibrium\" of a scene file), or find it by the \
                 method \"static\""
            )))
        };
        let farthest = |newton: &Newton<f64>, x: &[f64]| {
            let size = |dof: &usize| (x[*dof] * newton.coordinate_scales[*dof]).abs();
            (0..model.dofs).max_by(|one, other| size(one).total_cmp(&size(other))).map(|dof| (dof, size(&dof)))
        };
        let stage = StageSystem { equations: &equations, base: &self.base, p, t: self.t };
        if let Err(failure) = self.newton.solve(stage, &mut unknowns) {
            let why = self.newton.describe(&failure, &equations, PLACE);
            // the matrix is regular with as much inertia as stiffness, unless something is not determined; and what is let go moves
            let heavy = Equations::stage(StageCoefficients::new(gamma / FIRST_SHIFT, beta, 1.0), Level::Position);
            unknowns = self.newton.reactions_at_release(&self.base, p, self.t);
            let is_regular = self.newton.linearize(StageSystem { equations: &heavy, ..stage }, &mut unknowns).is_ok();
            if why.is(&[Stop::NotFinite]) || !is_regular {
                return Err(why);
            }
            let moved = self.newton.correction().x;
            let first = farthest(&self.newton, &moved).filter(|own| own.1 > LAST_DIGITS * self.newton.size(&self.base.q));
            let Some((dof, _)) = first else { return Err(why) };
            let first = format!(": let go, {} moves away first", model.dof_name(dof));
            return no_equilibrium(format!("this state is none, and none is near{first}"));
        }
        if let Some((dof, size)) = farthest(&self.newton, &unknowns.x)
            && !(size <= AWAY * self.newton.size(&self.base.q))
        {
            return no_equilibrium(format!("{} would move by {:.1e} to reach one", model.dof_name(dof), unknowns.x[dof]));
        }
        add(&mut self.base.q, 1.0, &unknowns.x);
        unknowns.x.fill(0.0);
        self.assemble_mass();
        self.reactions = unknowns;
        let factored = self.factor([gamma, beta]);
        self.is_symmetric = matches!(factored, Ok(Stability { determinant: None, .. }));
        factored.map(|_| ()).map_err(undetermined)
    }

    /// Factors K + beta C + gamma M at the equilibrium, and counts its negative eigenvalues; or the name of an unknown that it does not determine.
    fn factor(&mut self, [gamma, beta]: [f64; 2]) -> Result<Stability, String> {
        let equations = Equations::stage(StageCoefficients::new(gamma, beta, 1.0), Level::Position);
        let Operator { newton, base, reactions, t, problem: Problem { p, .. }, .. } = self;
        newton.linearize(StageSystem { equations: &equations, base, p, t: *t }, reactions)?;
        Ok(newton.stability())
    }

    /// Searches again, from more vectors, while modes are missing below the last one, or anywhere where fewer were found than asked for. Returns
    /// whether it is known that none is.
    fn complete(
        &mut self,
        ritz: &mut Vec<Eigenpair>,
        (count, shift, largest): (usize, f64, f64),
        stiffness: &Jacobian,
    ) -> Result<bool, RunError> {
        // each vector has x^T M x = 1
        let noise = ritz.iter().map(|pair| NOISE * self.along(stiffness, &pair.vector)[1]);
        let apart = noise.fold(ZERO * shift, f64::max);
        let (mut counted, mut sought) = ([0, 0], count);
        for search in 1..=MOST_SEARCHES {
            if !self.is_symmetric {
                return Ok(false);
            }
            let squares: Vec<f64> = ritz.iter().map(|pair| square(pair, shift)[0]).collect();
            let mut bound = ABOVE * largest.max(shift);
            if squares.len() >= sought {
                bound = squares.iter().fold(0.0, |most: f64, own| most.max(own.abs()));
                // modes as good as the last one may be either
                while squares.iter().any(|own| (own - bound).abs() < (BESIDE * bound).max(apart)) && bound > 0.0 {
                    bound -= (2.0 * BESIDE * bound).max(2.0 * apart);
                }
                if bound <= 0.0 {
                    bound = -2.0 * apart;
                }
            }
            // where a bound meets a mode by chance, one beside it does not
            let mut known =
                |bound: f64| self.factor([-bound, 0.0]).ok().filter(|own| own.neutral == 0).map(|own| own.negative);
            let there = known(bound).or_else(|| known(bound * (1.0 - BESIDE)));
            self.factor([shift, 0.0]).map_err(undetermined)?;
            let Some(there) = there else { return Ok(false) };
            counted = [squares.iter().filter(|own| **own < bound).count(), there];
            if counted[0] == counted[1] {
                return Ok(true);
            }
            sought += there.saturating_sub(counted[0]);
            *ritz = largest_pairs(self, sought, SPARE * (search + 1))?;
        }
        let [found, there] = counted;
        Err(RunError::Input(format!(
            "of {there} modes that are there by Sylvester's law, {found} were found: masses or stiffnesses differ by more than the digits of a \
             number hold; ask for fewer modes, or mend the smallest masses"
        )))
    }

    /// Size of x^H K x of a complex vector, and the sum of the sizes of its terms.
    pub fn along(&self, matrix: &Jacobian, vector: &[Vec<f64>; 2]) -> [f64; 2] {
        let (pattern, nodes) = (&self.newton.system.pattern, self.nodes);
        let ([re, im], mut sums) = (vector, [0.0; 3]);
        for (row, column, value) in entries(pattern, &matrix.values).filter(|own| own.0 < nodes && own.1 < nodes) {
            sums[0] += value * (re[row] * re[column] + im[row] * im[column]);
            sums[1] += value * (re[row] * im[column] - im[row] * re[column]);
            sums[2] += value.abs() * re[row].hypot(im[row]) * re[column].hypot(im[column]);
        }
        [sums[0].hypot(sums[1]), sums[2]]
    }

    /// Whether a mode is a rigid motion but for the round-off of its stiffness.
    pub fn is_rigid(&self, stiffness: &Jacobian, vector: &[Vec<f64>; 2]) -> bool {
        let [own, terms] = self.along(stiffness, vector);
        own <= NOISE * terms
    }

    pub fn times_mass(&self, x: &[f64]) -> Vec<f64> {
        self.times(&self.mass, x)
    }

    pub fn times(&self, matrix: &Jacobian, x: &[f64]) -> Vec<f64> {
        let (pattern, nodes) = (&self.newton.system.pattern, self.nodes);
        let mut product = vec![0.0; nodes];
        let among_nodes = entries(pattern, &matrix.values).filter(|own| own.0 < nodes && own.1 < nodes);
        among_nodes.for_each(|(row, column, value)| product[row] += value * x[column]);
        product
    }

    pub fn solve_nodes(&mut self, forces: &[f64]) -> Vec<f64> {
        let mut rhs = vec![0.0; self.newton.system.size()];
        rhs[..self.nodes].copy_from_slice(forces);
        self.solve(&rhs)
    }

    /// Solves with K + s M and the constraints, refined: where the shift is all the stiffness that a constrained direction has, pivots
    /// are as small as it is. Returns the unknowns of nodes.
    fn solve(&mut self, rhs: &[f64]) -> Vec<f64> {
        let Newton { system, jacobian, factorization, .. } = &mut self.newton;
        let pattern = &system.pattern;
        let (mut x, mut left) = (vec![0.0; rhs.len()], rhs.to_vec());
        for _ in 0..=REFINEMENTS {
            factorization.solve(&mut left);
            add(&mut x, 1.0, &left);
            left.copy_from_slice(rhs);
            entries(pattern, &jacobian.values).for_each(|(row, column, value)| left[row] -= value * x[column]);
        }
        x.truncate(self.nodes);
        x
    }

    /// Moves a vector back onto the constraints, A x = 0.
    pub fn obey(&mut self, vector: &mut [f64]) {
        let (pattern, nodes) = (&self.newton.system.pattern, self.nodes);
        let mut rhs = vec![0.0; self.newton.system.size()];
        let of_constraints = entries(pattern, &self.mass.values).filter(|own| own.0 >= nodes && own.1 < nodes);
        of_constraints.for_each(|(row, column, value)| rhs[row] -= value * vector[column]);
        add(vector, 1.0, &self.solve(&rhs));
    }

    /// A complex vector in all coordinates, with x^H M x = 1, or where it moves no mass with 1 as its largest entry, which is real and positive.
    pub fn in_coordinates(&self, vectors: [Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let inertia = vectors.iter().map(|vector| dot(vector, &self.times_mass(vector))).sum::<f64>();
        let [re, im] = vectors.map(|vector| {
            let mut unknowns = Residual::<f64>::unknowns(&self.newton.system);
            let mut reduced = vec![0.0; self.newton.system.size()];
            reduced[..self.nodes].copy_from_slice(&vector);
            let Newton { system, jacobian, coordinate_scales, .. } = &self.newton;
            jacobian.add_step(system, &reduced, None, &mut unknowns, coordinate_scales);
            unknowns.x
        });
        let size = |i: &usize| re[*i].hypot(im[*i]) * self.newton.coordinate_scales[*i];
        let largest = (0..re.len()).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0);
        // turned so that the largest entry is real and positive
        let turn = re[largest].hypot(im[largest]);
        let norm = if inertia > 0.0 { inertia.sqrt() } else { turn };
        let (cosine, sine) = (re[largest] / turn / norm, -im[largest] / turn / norm);
        let combine = |a: f64, b: f64| re.iter().zip(&im).map(|(re, im)| a * re + b * im).collect();
        [combine(cosine, -sine), combine(sine, cosine)]
    }
}
