//! Small steady vibrations where a design variable varies harmonically: (K + i omega C - omega^2 M) x + A^T nu = -dR/dd, A x = -dg/dd.
//!
//! With R and A at (0, 0, q): M = dR/da, C = dR/dv, K = d(R + A^T mu)/dq. The complex system is a real one of twice its size for the parts of
//! x and nu, sparse as they are:
//!
//! ```text
//! [ K - omega^2 M     - omega C   ] [ re ]   [ rhs ]
//! [    omega C      K - omega^2 M ] [ im ] = [  0  ]
//! ```

use super::march::{Method, Problem};
use super::vibrations::{FIRST_SHIFT, Operator};
use super::{RunError, StartPlan};
use crate::assembly::{Equations, Jacobian, Level, Residual, StageCoefficients, StageSystem, System, Unknowns, VectorsAvq};
use crate::linalg::{Backend, Factorization, SparsePattern};
use crate::scalar::{COMPLEX_STEP, Complex64};
use std::sync::Arc;

/// Where an error is met.
const PLACE: &str = "frequency response";
/// Corrections of each solution against the matrix.
const REFINEMENTS: usize = 1;
/// What a solution may leave of its equations, by their largest terms.
const LEFT: f64 = 1e-10;

/// An equilibrium, and how it vibrates.
pub(crate) struct Response {
    /// Coordinates of the equilibrium.
    pub q: Vec<f64>,
    /// Its multipliers.
    pub mu: Vec<f64>,
    /// For each rate.
    pub vibrations: Vec<Vibration>,
}

/// Coordinates and multipliers vary with the real part of (re + i im) exp(i omega t).
pub(crate) struct Vibration {
    /// Parts of the coordinates, for a change of the design variable by 1.
    pub x: [Vec<f64>; 2],
    /// Parts of the multipliers.
    pub mu: [Vec<f64>; 2],
}

/// The real system of both parts.
struct Doubled {
    size: usize,
    /// K with the constraints, M and C among nodes: entries with their places in both diagonal blocks, or in the lower and the upper block
    /// beside them.
    stiffness: Vec<(f64, [usize; 2])>,
    mass: Vec<(f64, [usize; 2])>,
    damping: Vec<(f64, [usize; 2])>,
    pattern: Arc<SparsePattern>,
    factors: Factorization,
}

/// Entries of a matrix, of its first `nodes` rows and columns where that is asked for.
fn entries(matrix: &Jacobian, system: &System, nodes: Option<usize>) -> Vec<(usize, usize, f64)> {
    let (pattern, mut all) = (&system.pattern, Vec::new());
    for column in 0..system.size() {
        for place in pattern.column_starts[column]..pattern.column_starts[column + 1] {
            let row = pattern.rows[place] as usize;
            if nodes.is_none_or(|nodes| row < nodes && column < nodes) && matrix.values[place] != 0.0 {
                all.push((row, column, matrix.values[place]));
            }
        }
    }
    all
}

impl Doubled {
    fn new(size: usize, [stiffness, mass, damping]: [Vec<(usize, usize, f64)>; 3]) -> Result<Self, RunError> {
        let beside = |(row, column): (usize, usize)| [(column, row), (column + size, row + size)];
        let across = |(row, column): (usize, usize)| [(column, row + size), (column + size, row)];
        let of = |list: &[(usize, usize, f64)]| list.iter().map(|own| (own.0, own.1)).collect::<Vec<_>>();
        let diagonal = (0..size).map(|k| (k, k)).chain(of(&stiffness)).chain(of(&mass)).flat_map(beside);
        let all = diagonal.chain(of(&damping).into_iter().flat_map(across)).collect();
        let pattern = Arc::new(SparsePattern::from_entries(2 * size, all));
        let backend = Backend::Multifrontal;
        let factors = Factorization::new(&pattern, backend).map_err(|singular| RunError::of_pattern(PLACE, singular))?;
        let placed = |list: Vec<(usize, usize, f64)>, places: &dyn Fn((usize, usize)) -> [(usize, usize); 2]| {
            let one = |(row, column, value): (usize, usize, f64)| {
                let place = |(column, row)| pattern.position(row, column).unwrap_or(0);
                (value, places((row, column)).map(place))
            };
            list.into_iter().map(one).collect()
        };
        let (stiffness, mass) = (placed(stiffness, &beside), placed(mass, &beside));
        let damping = placed(damping, &across);
        Ok(Doubled { size, stiffness, mass, damping, pattern, factors })
    }

    /// Both parts at a rate.
    fn solve(&mut self, omega: f64, rhs: &[f64]) -> Result<[Vec<f64>; 2], RunError> {
        let mut values = vec![0.0; self.pattern.rows.len()];
        for (value, places) in &self.stiffness {
            places.iter().for_each(|&place| values[place] += value);
        }
        for (value, places) in &self.mass {
            places.iter().for_each(|&place| values[place] -= omega * omega * value);
        }
        for (value, [below, above]) in &self.damping {
            values[*below] += omega * value;
            values[*above] -= omega * value;
        }
        let undetermined = || {
            RunError::Input(format!(
                "{PLACE}: at {omega} rad/s the response is not determined: that is the rate of a mode without damping, or something moves freely; \
                 take another rate, or give it damping or a spring"
            ))
        };
        self.factors.start_afresh(false);
        self.factors.factor(&values).map_err(|_| undetermined())?;
        let whole = [rhs, &vec![0.0; self.size]].concat();
        let (mut x, mut left) = (vec![0.0; whole.len()], whole.clone());
        for _ in 0..=REFINEMENTS {
            self.factors.solve(&mut left);
            x.iter_mut().zip(&left).for_each(|(x, own)| *x += own);
            left.copy_from_slice(&whole);
            self.add_products(&values, &x, |row, term| left[row] -= term);
        }
        let mut sizes: Vec<f64> = whole.iter().map(|own| own.abs()).collect();
        self.add_products(&values, &x, |row, term| sizes[row] += term.abs());
        let largest = sizes.into_iter().fold(0.0, f64::max);
        if !left.iter().all(|left| left.abs() <= LEFT * largest) {
            return Err(undetermined());
        }
        let im = x.split_off(self.size);
        Ok([x, im])
    }

    /// Hands out the terms of a product with their rows.
    fn add_products(&self, values: &[f64], x: &[f64], mut add: impl FnMut(usize, f64)) {
        for (column, x) in x.iter().enumerate() {
            let places = self.pattern.column_starts[column]..self.pattern.column_starts[column + 1];
            let entries = self.pattern.rows[places.clone()].iter().zip(&values[places]);
            entries.for_each(|(&row, value)| add(row as usize, value * x));
        }
    }
}

/// The response of a problem about its start, which must be an equilibrium at time (or load factor) `t`, to a harmonic change of its parameters
/// at some rates [rad/s]: `varied` has them with a complex step along what changes.
///
/// # Errors
/// As for [`vibrations`](super::vibrations()); a rate at which the response is not determined.
pub(crate) fn harmonic_response(
    problem: &Problem<f64>,
    varied: &[Complex64],
    method: &Method,
    plan: &StartPlan,
    t: f64,
    rates: &[f64],
) -> Result<Response, RunError> {
    let mut operator = Operator::new(problem, method, plan, (t, 1))?;
    let largest = operator.largest_ratio();
    operator.set_shift([if largest > 0.0 { FIRST_SHIFT * largest } else { 1.0 }, 0.0])?;
    let (stiffness, size) = (operator.stiffness(), operator.newton.system.size());
    let damping = operator.assembled(&Equations::stage(StageCoefficients::new(0.0, 1.0, 0.0), Level::Velocity));
    let system = operator.newton.system.clone();
    let rhs = change(&operator, &stiffness, varied, t);
    let nodes = Some(operator.nodes);
    let matrices =
        [entries(&stiffness, &system, None), entries(&operator.mass, &system, nodes), entries(&damping, &system, nodes)];
    let mut doubled = Doubled::new(size, matrices)?;
    let mut vibrations = Vec::new();
    for &omega in rates {
        let parts = doubled.solve(omega, &rhs)?.map(|reduced| {
            let mut unknowns = Residual::<f64>::unknowns(&system);
            stiffness.add_step(&system, &reduced, None, &mut unknowns, &operator.newton.coordinate_scales);
            (unknowns.x, unknowns.mu)
        });
        let [(re, mu_re), (im, mu_im)] = parts;
        vibrations.push(Vibration { x: [re, im], mu: [mu_re, mu_im] });
    }
    Ok(Response { q: operator.base.q, mu: operator.reactions.mu, vibrations })
}

/// Minus the change of the equations with the parameters, at the equilibrium.
fn change(operator: &Operator, stiffness: &Jacobian, varied: &[Complex64], t: f64) -> Vec<f64> {
    let (system, equations) =
        (&operator.newton.system, Equations::stage(StageCoefficients::new(0.0, 0.0, 1.0), Level::Position));
    let lift = |list: &[f64]| list.iter().map(|&own| Complex64::from(own)).collect::<Vec<_>>();
    let base = VectorsAvq { a: lift(&operator.base.a), v: lift(&operator.base.v), q: lift(&operator.base.q) };
    let own = &operator.reactions;
    let lists = [&own.x, &own.y, &own.mu, &own.eta, &own.local_mu, &own.local_eta].map(|list| lift(list));
    let [x, y, mu, eta, local_mu, local_eta] = lists;
    let mut unknowns = Unknowns { x, y, mu, eta, local_mu, local_eta };
    let mut residual = Residual::<Complex64>::default();
    let stage = StageSystem { equations: &equations, base: &base, p: varied, t };
    residual.start(system, stage);
    residual.evaluate(system, stage, &mut unknowns);
    let mut rhs = vec![0.0; system.size()];
    stiffness.reduce(system, &residual, Some(0), &mut rhs);
    rhs.iter_mut().for_each(|own| *own /= COMPLEX_STEP);
    rhs
}
