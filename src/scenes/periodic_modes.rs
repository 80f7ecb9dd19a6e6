use super::Prepared;
use crate::assembly::Model;
use crate::elements::NodeKind;
use crate::integrators::{Crossing, Mode, RunError, SwitchKind};
use crate::linalg::{eigenpairs, least_singular_value};
use crate::scalar::Complex64;
use crate::sensitivity::Transition;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Small motions about one that repeats itself: x(t) exp((growth + i omega) t) with shapes x of the same period.
#[derive(Clone, Debug)]
pub struct PeriodicModes {
    /// The period \[s\].
    pub period: f64,
    /// By how much the state at the end of the period differs from that at its start, at most, as a share of the largest coordinate or velocity.
    pub gap: f64,
    /// Coordinates at the start of the period.
    pub q: Vec<f64>,
    /// Those that grow fastest or fade most slowly, with their shapes at the start of the period. Their omega are known up to multiples of
    /// 2 pi / period: each is the one from 0 to pi / period.
    pub modes: Vec<Mode>,
    /// Modes that fade to nothing within one period.
    pub faded: usize,
    /// Formulas with a kink that the motion passes: there the modes are right to first order of the step only.
    pub kinks: Vec<Crossing>,
}

/// Gap of a motion that does not repeat itself.
const NOT_PERIODIC: f64 = 1e-3;
/// Share of a change at the end of the period that may lie outside of those that the constraints allow at its start.
const OUTSIDE: f64 = 1e-5;
/// Share of the largest multiplier below which one is round-off.
const FADED: f64 = 1e-13;
/// Difference of a multiplier's size from 1 that round-off may make of several equal ones.
const NEAR: f64 = 1e-3;

impl Prepared<'_> {
    /// Modes about the motion of a run, which must repeat itself with the run's duration as period: of rotors whose blades see another support, load or
    /// stiffness in each direction, of mechanisms that are driven periodically. Changes of the state at the start are carried through
    /// the run, exact for its steps; eigenvalues mu of that map are exp((growth + i omega) period) (Floquet's theory).
    ///
    /// # Errors
    /// Those of the run, with the coordinate that does not return; a formula that jumps on the way, which has no derivative there; equilibria, which
    /// have no period.
    pub fn periodic_modes(&self, count: usize) -> Result<PeriodicModes, RunError> {
        if self.method.table.is_static() {
            return Err(RunError::Input("equilibria have no period: take a method for motions".into()));
        }
        let mut transition = self.analysis().transition(&self.mechanism.numbers)?;
        if let Some(Crossing { part, step, t, .. }) = transition.crossings.iter().find(|own| own.kind == SwitchKind::Jump) {
            return Err(RunError::Input(format!(
                "step {step} (t = {t} s): the formula of \"{part}\" jumps there, and what becomes of a change has no derivative; keep the motion on one side, or \
                 write the formula without the jump"
            )));
        }
        let [first, .., last] = self.grid.times[..] else {
            return Err(RunError::Input("a run without steps has no period".into()));
        };
        let period = last - first;
        let signs = signs_at_end(self.model(), &transition);
        let gap = self.gap(&transition, &signs)?;
        let (map, round_off) = returned(&transition, &signs, self.grid.steps())?;
        let pairs = eigenpairs(map.nrows(), |i, j| map[(i, j)]);
        let mut pairs = pairs.ok_or_else(|| RunError::Input("the modes of the period do not converge".into()))?;
        let size = |[re, im]: [f64; 2]| re.hypot(im);
        pairs.sort_by(|a, b| size(b.value).total_cmp(&size(a.value)));
        let largest = pairs.first().map_or(0.0, |pair| size(pair.value));
        let all = pairs.len();
        pairs.retain(|pair| size(pair.value) > FADED * largest);
        let faded = all - pairs.len();
        let modes = pairs.iter().take(count).map(|pair| {
            let [re, im] = pair.value;
            let parts = pair.vector.each_ref().map(|part| &transition.basis * DVector::from_column_slice(part));
            let [shape, ahead] = shape(self.model().dofs, &transition.places[0], parts);
            let size = size(pair.value);
            // a map that differs by round-off may have a value of size 1 there: of two equal values they are far from it
            let is_neutral = || {
                let value = Complex64::new(re, im) / size;
                let shifted = map.map(Complex64::from) - DMatrix::from_diagonal_element(map.nrows(), map.nrows(), value);
                least_singular_value(shifted) <= round_off
            };
            let growth = if (size - 1.0).abs() < NEAR && is_neutral() { 0.0 } else { size.ln() / period };
            Mode { frequency: im.atan2(re).abs() / period, growth, shape, ahead }
        });
        let modes = modes.collect();
        let (kinks, q) = (std::mem::take(&mut transition.crossings), transition.ends[0].q.clone());
        Ok(PeriodicModes { period, gap, modes, faded, kinks, q })
    }

    /// The largest share by which the state at the end is another one; angles may be whole turns ahead.
    fn gap(&self, transition: &Transition, signs: &[f64]) -> Result<f64, RunError> {
        let (model, [start, end]) = (self.model(), &transition.ends);
        let of = |order: usize, place: usize| match order {
            0 => (start.q[place], end.q[place]),
            _ => (start.v[place], end.v[place]),
        };
        let mut worst = (0.0, String::new());
        for (order, places) in transition.places.iter().enumerate() {
            let largest = places.iter().map(|&place| of(order, place).0.abs()).fold(1.0, f64::max);
            for &place in places {
                let (before, after) = of(order, place);
                let mut gap = signs[place] * after - before;
                let is_coordinate = model
                    .nodes
                    .iter()
                    .any(|node| matches!(node.kind, NodeKind::Coordinates(_)) && node.dofs.contains(&place));
                if order == 0 && is_coordinate {
                    gap -= TAU * (gap / TAU).round();
                }
                if gap.abs() / largest > worst.0 {
                    let what = if order == 0 { "" } else { "the rate of " };
                    let name = model.dof_name(place);
                    worst = (
                        gap.abs() / largest,
                        format!("{what}{name} is {before:.6e} at the start and {after:.6e} at the end"),
                    );
                }
            }
        }
        if worst.0 <= NOT_PERIODIC {
            return Ok(worst.0);
        }
        Err(RunError::Input(format!(
            "the motion does not repeat itself with the duration of the run as its period: {}; let the run be one period long, from a state of the periodic motion",
            worst.1
        )))
    }
}

/// What the changes at the end are in terms of those of the start, and by how much round-off changes that: a unit of the last digit for each step
/// and each direction, and what lies outside of the changes that are possible at the start.
fn returned(transition: &Transition, signs: &[f64], steps: usize) -> Result<(DMatrix<f64>, f64), RunError> {
    let Transition { places, basis, changed, .. } = transition;
    let rows: Vec<f64> = places.iter().flatten().map(|&place| signs[place]).collect();
    let turned = DMatrix::from_fn(changed.nrows(), changed.ncols(), |i, j| rows[i] * changed[(i, j)]);
    // the basis that was made differs from an orthonormal one by the round-off of the projection
    let inverse = basis.clone().pseudo_inverse(f64::EPSILON.sqrt()).map_err(|why| RunError::Input(why.into()))?;
    let map = inverse * &turned;
    let outside = (basis * &map - &turned).amax();
    if outside <= OUTSIDE * turned.amax() {
        let round_off = (steps + map.nrows()) as f64 * f64::EPSILON * map.norm() + outside;
        return Ok((map, round_off));
    }
    Err(RunError::Input(format!(
        "at the end of the period changes of the state are none that the constraints allow at its start, by {outside:.1e} of {:.1e}: take more steps",
        turned.amax()
    )))
}

/// -1 for the Euler parameters of bodies that have turned an odd number of times: opposite ones stand for the same axes.
fn signs_at_end(model: &Model, transition: &Transition) -> Vec<f64> {
    let [start, end] = &transition.ends;
    let mut signs = vec![1.0; model.dofs];
    for node in model.nodes.iter().filter(|node| node.kind == NodeKind::Body) {
        let own = node.dofs.start + 3..node.dofs.end;
        let along: f64 = own.clone().map(|place| start.q[place] * end.q[place]).sum();
        if along < 0.0 {
            signs[own].fill(-1.0);
        }
    }
    signs
}

/// Changes of the coordinates of the model, the largest one real, positive and 1.
fn shape(dofs: usize, places: &[usize], [re, im]: [DVector<f64>; 2]) -> [Vec<f64>; 2] {
    let size = |row: usize| re[row].hypot(im[row]);
    let largest = (0..places.len()).max_by(|&a, &b| size(a).total_cmp(&size(b)));
    let mut parts = [vec![0.0; dofs], vec![0.0; dofs]];
    let Some(top) = largest.filter(|&row| size(row) > 0.0) else { return parts };
    // by the conjugate of the largest
    let (c, s, square) = (re[top], im[top], size(top).powi(2));
    for (row, &place) in places.iter().enumerate() {
        parts[0][place] = (re[row] * c + im[row] * s) / square;
        parts[1][place] = (im[row] * c - re[row] * s) / square;
    }
    parts
}
