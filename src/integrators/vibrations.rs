//! Small undamped vibrations about an equilibrium: K x = omega^2 M x on the manifold of the constraints.
//!
//! With R and A at (0, 0, q): M = dR/da, and K = d(R + A^T mu)/dq holds the geometric stiffness and the curvature of all reactions.
//! Loads and drivers are frozen, dampers have no effect. The lowest modes are the largest of the operator x -> y,
//!
//! ```text
//! (K + s M) y + A^T nu = M x,  A y = 0:   theta = 1 / (omega^2 + s),
//! ```
//!
//! in a block Krylov space that is orthonormal in M. Where K is symmetric, the numbers of negative eigenvalues of K - r M and K + r M tell how
//! many modes have omega^2 between -r and r (Sylvester's law): none of them is missing. The shift s > 0 makes the matrix regular where a body is free, with omega = 0;
//! directions without inertia vibrate infinitely fast and are not found.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::march::{Method, Problem};
use super::newton::Newton;
use super::{RunError, Stability, StartPlan, Systems};
use crate::assembly::{Equations, Jacobian, Level, Residual, StageCoefficients, StageSystem, Unknowns, VectorsAvq};
use crate::linalg::{Eigenpair, eigenpairs, symmetric_part_eigenpairs};

/// One mode: the motion is the real part of shape exp((growth + i frequency) t), and where it grows also one that fades as fast.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// omega [rad/s]; 0 for a rigid motion, and for an unstable equilibrium that is left without a vibration.
    pub frequency: f64,
    /// Rate of growth [1/s]: 0 where the equilibrium is stable.
    pub growth: f64,
    /// Change of every coordinate of the model, x^T M x = 1; the largest one is positive.
    pub shape: Vec<f64>,
    /// The part that runs ahead by a quarter of a period: zero unless follower loads make the mode flutter.
    pub ahead: Vec<f64>,
}

impl Mode {
    /// True if a small disturbance grows.
    pub fn is_unstable(&self) -> bool {
        self.growth > 0.0
    }
}

/// First shift, as a share of the largest ratio of stiffness and inertia.
const FIRST_SHIFT: f64 = 1e-8;
/// Most shifts that are tried.
const MOST_SHIFTS: usize = 6;
/// A shift this much smaller or larger than the lowest mode that is not rigid is chosen anew.
const FAR: [f64; 2] = [1e-2, 10.0];
/// omega^2 is round-off of zero below this share of the shift ...
const ZERO: f64 = 1e-10;
/// ... and this share of the largest ratio of stiffness and inertia.
const NOISE: f64 = 1e-16;
/// Displacement towards an equilibrium, as a share of the largest coordinate, beyond which a state is none.
const AWAY: f64 = 1e-7;
/// Residual of a mode, relative to theta.
const CONVERGED: f64 = 1e-11;
/// Vectors that are dependent on others but for this share are left out.
const DEPENDENT: f64 = 1e-10;
/// Vectors that are dependent but for this share may be what round-off leaves of the constraints ...
const SUSPICIOUS: f64 = 1e-4;
/// ... and are, if less than this is left of them once they obey these.
const GENUINE: f64 = 0.5;
/// Corrections of each solution against the matrix.
const REFINEMENTS: usize = 2;
/// Modes that are sought beyond those asked for.
const SPARE: usize = 2;
/// Distance of a bound from the last mode below which others are counted, as a share of its omega^2 ...
const BESIDE: f64 = 1e-6;
/// ... and of the largest ratio of stiffness and inertia.
const APART: f64 = 1e-13;
/// A bound above every omega^2, in largest ratios of stiffness and inertia.
const ABOVE: f64 = 1e4;
/// Searches, each from more vectors than the one before, until no mode is missing.
const MOST_SEARCHES: usize = 4;

/// The modes of a problem about its start, which must be an equilibrium at time (or load factor) `t`: up to `count` whose omega^2 are nearest
/// to zero, in the order of omega^2; fewer where there are no more.
///
/// # Errors
/// [`RunError::Input`]: a start that is no equilibrium, an initial velocity, a constraint on velocities, no modes asked for; modes that are
/// there by their count, but were not found;
/// [`RunError::Singular`]: a coordinate with neither inertia nor stiffness.
pub fn vibrations(
    problem: &Problem<f64>,
    method: &Method,
    plan: &StartPlan,
    t: f64,
    count: usize,
) -> Result<Vec<Mode>, RunError> {
    if count == 0 {
        return Err(RunError::Input("0 modes are asked for; it must be at least 1".into()));
    }
    super::start::check_stillness(problem)?;
    let systems = Systems::new(problem.model, method, &plan.dropped);
    let newton = Newton::new(systems.plain, method.tolerance, method.backend);
    let newton = newton.map_err(|singular| RunError::of_pattern(PLACE, singular))?;
    let system = newton.system.clone();
    let nodes = system.multiplier_places().iter().flatten().min().copied().unwrap_or(system.size());
    if nodes == 0 {
        return Ok(Vec::new());
    }
    let zeros = vec![0.0; problem.model.dofs];
    let base = VectorsAvq { a: zeros.clone(), v: zeros, q: problem.start.q.clone() };
    let mass = Jacobian::default();
    let reactions = Unknowns::default();
    let mut operator = Operator { problem, newton, mass, nodes, base, reactions, t, is_symmetric: false };
    let largest = operator.largest_ratio();
    let floor = |shift: f64| ZERO * shift + NOISE * largest;
    let mut shift = if largest > 0.0 { FIRST_SHIFT * largest } else { 1.0 };
    let mut ritz = Vec::new();
    for _ in 0..MOST_SHIFTS {
        operator.set_shift(shift)?;
        ritz = operator.largest_pairs(count, SPARE)?;
        let sizes = ritz.iter().map(|pair| square(pair, shift)).map(|[re, im]| re.hypot(im));
        let (moving, rigid): (Vec<f64>, Vec<f64>) = sizes.partition(|size| *size > floor(shift));
        let lowest = moving.into_iter().fold(f64::INFINITY, f64::min);
        let too_small = !rigid.is_empty() && shift < FAR[0] * lowest;
        if !(lowest.is_finite() && (too_small || shift > FAR[1] * lowest)) {
            break;
        }
        // at the shift of an unstable mode K + s M is singular
        let has_unstable = ritz.iter().any(|pair| square(pair, shift)[0] < -floor(shift));
        shift = if has_unstable { 0.5 * lowest } else { lowest };
    }
    operator.complete(&mut ritz, (count, shift, largest))?;
    let mut modes: Vec<(f64, Mode)> = Vec::new();
    for pair in &ritz {
        let [mut re, mut im] = square(pair, shift);
        if re.hypot(im) <= floor(shift) {
            (re, im) = (0.0, 0.0);
        }
        // (growth + i omega)^2 = -omega^2
        let size = re.hypot(im);
        let [growth, frequency] = [(0.5 * (size - re)).max(0.0).sqrt(), (0.5 * (size + re)).max(0.0).sqrt()];
        let [shape, ahead] = operator.shape(pair)?;
        modes.push((re, Mode { frequency, growth, shape, ahead }));
    }
    modes.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    Ok(modes.into_iter().map(|(_, mode)| mode).collect())
}

/// Where an error is met.
const PLACE: &str = "vibrations";

/// The error of an unknown that K + s M does not determine.
fn undetermined(unknown: String) -> RunError {
    let hint = "it has neither inertia nor stiffness: give it a mass, a spring or a joint".into();
    RunError::Singular { place: PLACE.into(), unknown, hint }
}

/// omega^2 = 1 / theta - s.
fn square(pair: &Eigenpair, shift: f64) -> [f64; 2] {
    let [re, im] = pair.value;
    let size = re * re + im * im;
    [re / size - shift, -im / size]
}

/// A number from -0.5 to 0.5 in no pattern that a mode could follow (the generator SplitMix64).
fn noise(i: usize, k: usize) -> f64 {
    let mut z = (i as u64 + ((k as u64) << 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64 - 0.5
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    target.iter_mut().zip(values).for_each(|(target, value)| *target += factor * value);
}

impl Krylov {
    /// Takes from a vector what lies along the basis, twice for the sake of round-off, and adds up the coefficients.
    fn orthogonalize(&self, vector: &mut [f64], mut coefficients: Option<&mut [f64]>) {
        for _ in 0..2 {
            for (place, (image, own)) in self.images.iter().zip(&self.basis).enumerate() {
                let share = dot(image, vector);
                add(vector, -share, own);
                if let Some(coefficients) = &mut coefficients {
                    coefficients[place] += share;
                }
            }
        }
    }
}

struct Operator<'m> {
    problem: &'m Problem<'m, f64>,
    /// Its matrix is that of K + s M with the constraints.
    newton: Newton<'m, f64>,
    /// M, with rows A.
    mass: Jacobian,
    /// Unknowns of nodes, in front of multipliers.
    nodes: usize,
    /// The equilibrium.
    base: VectorsAvq<f64>,
    /// Its reactions, without displacements.
    reactions: Unknowns<f64>,
    t: f64,
    /// Whether K is.
    is_symmetric: bool,
}

/// Vectors that are orthonormal in M, and what the operator does to them.
#[derive(Default)]
struct Krylov {
    basis: Vec<Vec<f64>>,
    /// M times the basis.
    images: Vec<Vec<f64>>,
    /// Coefficients of the operator's results, one list for each vector that it was applied to.
    columns: Vec<Vec<f64>>,
}

impl Operator<'_> {
    /// Largest ratio of stiffness and inertia of one coordinate [1/s2]: above most omega^2.
    fn largest_ratio(&mut self) -> f64 {
        let Problem { p, .. } = self.problem;
        let mut unknowns = self.newton.reactions_at_release(&self.base, p, self.t);
        self.assemble_mass();
        let equations = Equations::stage(StageCoefficients::new(0.0, 0.0, 1.0), Level::Position);
        let Newton { system, residual, .. } = &mut self.newton;
        let mut stiffness = Jacobian::default();
        let stage = StageSystem { equations: &equations, base: &self.base, p, t: self.t };
        residual.evaluate(system, stage, &mut unknowns);
        stiffness.assemble(system, &equations, residual, &unknowns, p, self.t);
        let diagonal = (0..self.nodes).filter_map(|i| system.pattern.position(i, i));
        diagonal.fold(0.0, |largest: f64, place| {
            let (stiffness, mass) = (stiffness.values[place].abs(), self.mass.values[place]);
            if mass > 0.0 { largest.max(stiffness / mass) } else { largest }
        })
    }

    fn assemble_mass(&mut self) {
        let Newton { system, residual, .. } = &mut self.newton;
        let equations = Equations::acceleration();
        let mut unknowns = Residual::unknowns(system);
        let stage = StageSystem { equations: &equations, base: &self.base, p: &self.problem.p, t: self.t };
        residual.evaluate(system, stage, &mut unknowns);
        self.mass.assemble(system, &equations, residual, &unknowns, &self.problem.p, self.t);
    }

    /// Finds the reactions of the equilibrium and factors K + s M there: with a = s x and q + x the equations have the solution x = 0 in
    /// an equilibrium, stable or not, and that matrix.
    fn set_shift(&mut self, shift: f64) -> Result<(), RunError> {
        let Problem { model, p, .. } = self.problem;
        let equations = Equations::stage(StageCoefficients::new(shift, 0.0, 1.0), Level::Position);
        let mut unknowns = self.newton.reactions_at_release(&self.base, p, self.t);
        let no_equilibrium = |how: String| {
            Err(RunError::Input(format!(
                "vibrations need an equilibrium to start from, but {how}: find it first by the method \"static\""
            )))
        };
        if let Err(failure) =
            self.newton.solve(StageSystem { equations: &equations, base: &self.base, p, t: self.t }, &mut unknowns)
        {
            return match self.newton.describe(&failure, &equations, PLACE) {
                RunError::NoConvergence { .. } => no_equilibrium("there is none near this state".into()),
                other => Err(other),
            };
        }
        let size = |place: usize| (unknowns.x[place] * self.newton.coordinate_scales[place]).abs();
        if let Some(dof) = (0..model.dofs).max_by(|&a, &b| size(a).total_cmp(&size(b)))
            && !(size(dof) <= AWAY * self.newton.size(&self.base.q))
        {
            return no_equilibrium(format!("{} would move by {:.1e} to reach one", model.dof_name(dof), unknowns.x[dof]));
        }
        add(&mut self.base.q, 1.0, &unknowns.x);
        unknowns.x.fill(0.0);
        self.assemble_mass();
        self.reactions = unknowns;
        let factored = self.factor(shift);
        self.is_symmetric = matches!(factored, Ok(Stability { determinant: None, .. }));
        factored.map(|_| ()).map_err(undetermined)
    }

    /// Factors K + s M at the equilibrium, and counts its negative eigenvalues; or the name of an unknown that it does not determine.
    fn factor(&mut self, shift: f64) -> Result<Stability, String> {
        let equations = Equations::stage(StageCoefficients::new(shift, 0.0, 1.0), Level::Position);
        let Operator { newton, base, reactions, t, problem: Problem { p, .. }, .. } = self;
        newton.linearize(StageSystem { equations: &equations, base, p, t: *t }, reactions)?;
        Ok(newton.stability())
    }

    /// Searches again, from more vectors, while modes are missing below the last one, or anywhere where fewer were found than asked for.
    fn complete(&mut self, ritz: &mut Vec<Eigenpair>, (count, shift, largest): (usize, f64, f64)) -> Result<(), RunError> {
        let apart = (APART * largest).max(ZERO * shift);
        let mut counted = [0, 0];
        for search in 1..=MOST_SEARCHES {
            if !self.is_symmetric {
                return Ok(());
            }
            let sizes: Vec<f64> = ritz.iter().map(|pair| square(pair, shift)[0].abs()).collect();
            let mut bound = ABOVE * largest.max(shift);
            if sizes.len() >= count {
                bound = sizes.iter().fold(0.0, |most: f64, size| most.max(*size));
                // modes as good as the last one may be either
                while sizes.iter().any(|size| (size - bound).abs() < (BESIDE * bound).max(apart)) && bound > 0.0 {
                    bound -= (2.0 * BESIDE * bound).max(2.0 * apart);
                }
            }
            if bound <= 0.0 {
                return Ok(());
            }
            let found = sizes.iter().filter(|size| **size < bound).count();
            // where a bound meets a mode by chance, one beside it does not
            let mut known = |shift: f64| self.factor(shift).ok().filter(|own| own.neutral == 0).map(|own| own.negative);
            let mut below = |bound: f64| known(-bound).or_else(|| known(-bound * (1.0 + BESIDE)));
            let counts = (below(bound), below(-bound));
            self.factor(shift).map_err(undetermined)?;
            let (Some(above), Some(unstable)) = counts else { return Ok(()) };
            counted = [found, above.saturating_sub(unstable)];
            if counted[0] == counted[1] {
                return Ok(());
            }
            *ritz = self.largest_pairs(count, SPARE + search * (counted[1].saturating_sub(found) + 2))?;
        }
        let [found, there] = counted;
        Err(RunError::Input(format!(
            "of {there} modes that are there by Sylvester's law, {found} were found: masses or stiffnesses differ by more than the digits of a \
             number hold; ask for fewer modes, or mend the smallest masses"
        )))
    }

    /// M x.
    fn times_mass(&self, x: &[f64]) -> Vec<f64> {
        let pattern = &self.newton.system.pattern;
        let mut product = vec![0.0; self.nodes];
        for (column, &x) in x.iter().enumerate() {
            for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                if (pattern.rows[place] as usize) < self.nodes {
                    product[pattern.rows[place] as usize] += self.mass.values[place] * x;
                }
            }
        }
        product
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
            for (column, &x) in x.iter().enumerate() {
                for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                    left[pattern.rows[place] as usize] -= jacobian.values[place] * x;
                }
            }
        }
        x.truncate(self.nodes);
        x
    }

    /// The operator on a vector x, given as M x.
    fn apply(&mut self, image: &[f64]) -> Vec<f64> {
        let mut rhs = vec![0.0; self.newton.system.size()];
        rhs[..self.nodes].copy_from_slice(image);
        self.solve(&rhs)
    }

    /// Moves a vector back onto the constraints, A x = 0.
    fn obey_constraints(&mut self, vector: &mut [f64]) {
        let pattern = &self.newton.system.pattern;
        let mut rhs = vec![0.0; self.newton.system.size()];
        for (column, &x) in vector.iter().enumerate() {
            for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
                if (pattern.rows[place] as usize) >= self.nodes {
                    rhs[pattern.rows[place] as usize] -= self.mass.values[place] * x;
                }
            }
        }
        add(vector, 1.0, &self.solve(&rhs));
    }

    /// Length in M.
    fn norm(&self, vector: &[f64]) -> f64 {
        dot(vector, &self.times_mass(vector)).max(0.0).sqrt()
    }

    /// Adds a vector to the basis where it does not depend on it; returns its coefficients.
    fn extend(&mut self, krylov: &mut Krylov, mut vector: Vec<f64>) -> Vec<f64> {
        let before = self.norm(&vector);
        let mut coefficients = vec![0.0; krylov.basis.len()];
        krylov.orthogonalize(&mut vector, Some(&mut coefficients));
        let left = self.norm(&vector);
        if !(left > DEPENDENT * before) {
            return coefficients;
        }
        vector.iter_mut().for_each(|value| *value /= left);
        if left < SUSPICIOUS * before {
            self.obey_constraints(&mut vector);
            krylov.orthogonalize(&mut vector, None);
            let genuine = self.norm(&vector);
            if !(genuine > GENUINE) {
                return coefficients;
            }
            vector.iter_mut().for_each(|value| *value /= genuine);
        }
        krylov.images.push(self.times_mass(&vector));
        krylov.basis.push(vector);
        coefficients.push(left);
        coefficients
    }

    /// Eigenvalues theta of largest size, with their vectors in unknowns of nodes, from a few vectors more than values.
    fn largest_pairs(&mut self, count: usize, spare: usize) -> Result<Vec<Eigenpair>, RunError> {
        let mut krylov = Krylov::default();
        for k in 0..(count + spare).min(self.nodes) {
            let start = self.times_mass(&(0..self.nodes).map(|i| noise(i, k)).collect::<Vec<f64>>());
            let vector = self.apply(&start);
            self.extend(&mut krylov, vector);
        }
        loop {
            let known = krylov.columns.len();
            for place in known..krylov.basis.len() {
                let result = self.apply(&krylov.images[place]);
                let column = self.extend(&mut krylov, result);
                krylov.columns.push(column);
            }
            let size = krylov.columns.len();
            let entry = |i: usize, j: usize| krylov.columns[j].get(i).copied().unwrap_or(0.0);
            let found = if self.is_symmetric { symmetric_part_eigenpairs(size, entry) } else { eigenpairs(size, entry) };
            let mut pairs = found.ok_or_else(|| {
                RunError::Input(
                    "the matrices of the vibrations hold numbers that are not finite, or the search for their eigenvalues does not \
                     converge: check masses and stiffnesses"
                        .into(),
                )
            })?;
            let magnitude = |pair: &Eigenpair| pair.value[0].hypot(pair.value[1]);
            pairs.sort_by(|a, b| magnitude(b).total_cmp(&magnitude(a)));
            pairs.truncate(count);
            let left = |pair: &Eigenpair| {
                let beyond = |part: &[f64], i: usize| (0..size).map(|j| entry(i, j) * part[j]).sum::<f64>();
                let rows = size..krylov.basis.len();
                rows.flat_map(|i| [beyond(&pair.vector[0], i), beyond(&pair.vector[1], i)]).fold(0.0, f64::hypot)
            };
            if krylov.basis.len() == size || pairs.iter().all(|pair| left(pair) <= CONVERGED * magnitude(pair)) {
                for pair in &mut pairs {
                    for part in &mut pair.vector {
                        let mut vector = vec![0.0; self.nodes];
                        krylov.basis.iter().zip(&*part).for_each(|(own, share)| add(&mut vector, *share, own));
                        *part = vector;
                    }
                }
                return Ok(pairs);
            }
        }
    }

    /// A mode in all coordinates, with x^T M x = 1 and its largest entry positive.
    fn shape(&mut self, pair: &Eigenpair) -> Result<[Vec<f64>; 2], RunError> {
        // once more through the operator: what has no inertia follows what has, and theta is divided by its size alone
        let images = [0, 1].map(|part| self.times_mass(&pair.vector[part]));
        let vectors = images.map(|image| self.apply(&image));
        let norm = vectors.iter().map(|vector| dot(vector, &self.times_mass(vector))).sum::<f64>().sqrt();
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
        let (cosine, sine) = (re[largest] / turn / norm, -im[largest] / turn / norm);
        let combine = |a: f64, b: f64| re.iter().zip(&im).map(|(re, im)| a * re + b * im).collect();
        Ok([combine(cosine, -sine), combine(sine, cosine)])
    }
}
