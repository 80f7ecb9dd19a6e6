//! Equilibrium paths through limits of the load, by their arc length (Riks 1979, Crisfield 1981).
//!
//! A path is (q, mu, t) with the load factor t. Its tangent has length one in the norm that counts displacements (each coordinate by its
//! coordinate scale) and the load alike, |dq|^2 + psi^2 dt^2, where psi is the length that dq/dt has at the start: no unit matters.
//! The next point lies in the plane at right angles to the tangent, an arc ahead; each correction solves twice with the same matrix, for the
//! residual and for the load.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::march::{Method, Problem, add_scaled};
use super::newton::{NOT_HELD, Newton};
use super::step::newton;
use super::{Counters, RunError, Stability, StartPlan};
use crate::assembly::{Equations, Model, NodeId, Residual, StageSystem, Unknowns, VectorsAvq};
use crate::elements::State;

/// How far and how closely a path is followed.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcLength {
    /// First increment of the load factor; it sets the length of the first arc.
    pub first: f64,
    /// Longest arc, in lengths of the first one.
    pub longest: f64,
    /// Most points.
    pub points: usize,
    /// Load factor at which the path ends.
    pub load: Option<f64>,
    /// Coordinate of the model, and its value at which the path ends.
    pub coordinate: Option<(usize, f64)>,
}

/// One equilibrium of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPoint {
    /// Load factor.
    pub load: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Multipliers.
    pub mu: Vec<f64>,
    /// Change of the load along the path, psi dt/ds, from -1 to 1: negative where equilibria need less and less load.
    pub slope: f64,
    /// Whether it stands under a given load; at a limit signs are those of round-off.
    pub stability: Stability,
}

/// Why a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// The load factor was reached.
    Load,
    /// The coordinate was reached.
    Coordinate,
    /// As many points as were asked for.
    Points,
}

/// Equilibria one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The points, from the load factor 0 on.
    pub points: Vec<PathPoint>,
    /// Limits of the load between them, where its slope is zero.
    pub limits: Vec<PathPoint>,
    /// Why it ends.
    pub end: PathEnd,
    /// Work done.
    pub counters: Counters,
}

/// Corrections that a well chosen arc needs.
const WANTED: f64 = 5.0;
const MOST_CORRECTIONS: usize = 15;
/// Correction that is accepted when corrections no longer shrink.
const NEARLY: f64 = 1e-9;
/// Least cosine between the tangents at both ends of an arc.
const STRAIGHT: f64 = 0.9;
/// Slope at a limit; the load there is off by its square.
const LEVEL: f64 = 1e-7;
/// Most points that are tried to locate a limit or an end.
const MOST_TRIALS: usize = 60;

impl ArcLength {
    /// Arcs that begin with an increment of the load factor: up to 200 points, arcs up to five times the first.
    pub fn new(first: f64) -> Self {
        ArcLength { first, longest: 5.0, points: 200, load: None, coordinate: None }
    }

    /// Ends at a load factor.
    #[must_use]
    pub fn up_to_load(mut self, load: f64) -> Self {
        self.load = Some(load);
        self
    }

    /// Ends where a coordinate of the model passes a value.
    #[must_use]
    pub fn up_to_coordinate(mut self, dof: usize, value: f64) -> Self {
        self.coordinate = Some((dof, value));
        self
    }

    fn check(&self, model: &Model) -> Result<(), RunError> {
        let fail = |message: String| Err(RunError::Input(message));
        if !(self.first != 0.0 && self.first.is_finite()) {
            return fail(format!("the first increment of the load is {}; it must be a number other than 0", self.first));
        }
        if !(self.longest > 0.0) || self.points == 0 {
            return fail(format!(
                "the longest arc is {} first ones, with {} points; both must be above 0",
                self.longest, self.points
            ));
        }
        match self.coordinate {
            Some((dof, _)) if dof >= model.dofs => {
                fail(format!("a path ends at coordinate {dof}, but the model has {}: count from 0", model.dofs))
            }
            _ => Ok(()),
        }
    }
}

/// Follows the equilibria of a problem from its start, at the load factor 0, on.
pub fn follow_path(problem: &Problem<f64>, method: &Method, plan: &StartPlan, arc: &ArcLength) -> Result<Path, RunError> {
    arc.check(problem.model)?;
    super::start::check_stillness(problem)?;
    let mut newton = newton(method, &method.system(problem.model, &plan.dropped))?;
    newton.counters = Counters::measuring(method.measures_phases);
    let mut follower = Follower { problem, newton, load_weight: 0.0 };
    let (start, tangent) = follower.start()?;
    let points = vec![PathPoint { slope: tangent.load * follower.load_weight.sqrt(), ..start }];
    let mut path = Path { points, limits: Vec::new(), end: PathEnd::Points, counters: Counters::default() };
    follower.follow(arc, tangent, &mut path)?;
    path.counters = follower.newton.counters;
    Ok(path)
}

struct Direction {
    q: Vec<f64>,
    mu: Vec<f64>,
    load: f64,
}

struct Follower<'m> {
    problem: &'m Problem<'m, f64>,
    newton: Newton<'m, f64>,
    load_weight: f64,
}

struct Trial {
    point: PathPoint,
    tangent: Direction,
    corrections: usize,
}

impl Follower<'_> {
    fn start(&mut self) -> Result<(PathPoint, Direction), RunError> {
        let Problem { model, p, start } = self.problem;
        let place = "first equilibrium (load factor 0)";
        let base = VectorsAvq { q: start.q.clone(), ..VectorsAvq::zeros(model.dofs) };
        let newton = &mut self.newton;
        let mut unknowns = newton.reactions_at_release(&base, p, 0.0);
        let solved = newton.solve(StageSystem { equations: &Equations::EQUILIBRIUM, base: &base, p, t: 0.0 }, &mut unknowns);
        solved.map_err(|failure| newton.describe(&failure, &Equations::EQUILIBRIUM, place))?;
        let q = base.q.iter().zip(&unknowns.x).map(|(q, x)| q + x).collect();
        let mut point = PathPoint { load: 0.0, q, mu: unknowns.mu, slope: 0.0, stability: Stability::default() };
        let tangent = self.towards_load(&point);
        let mut tangent = tangent.map_err(|unknown| RunError::singular(place, &unknown, NOT_HELD))?;
        point.stability = self.newton.stability();
        self.load_weight = self.dot(&tangent.q, &tangent.q);
        if self.load_weight == 0.0 {
            return Err(RunError::Input(
                "nothing moves with the load factor: make a load or a driver depend on time".into(),
            ));
        }
        self.normalize(&mut tangent);
        Ok((point, tangent))
    }

    fn follow(&mut self, options: &ArcLength, mut tangent: Direction, path: &mut Path) -> Result<(), RunError> {
        let first = options.first.abs() / tangent.load.abs();
        if options.first < 0.0 {
            tangent.scale(-1.0);
        }
        let mut arc = first.min(options.longest * first);
        while path.points.len() < options.points {
            let point = path.points.last().expect("the start").clone();
            let mut cause = String::from("the path turns sharply");
            let trial = loop {
                match self.trial(&point, &tangent, arc) {
                    Ok(trial) if self.product(&trial.tangent, &tangent) > STRAIGHT => break trial,
                    Ok(_) => {}
                    Err(failure) => cause = failure,
                }
                // not by one half: an end that is singular by chance is not met again
                arc *= 0.4;
                if arc < super::load_steps::SHORTEST * first {
                    let hint = "the path ends or branches there; start from a disturbed shape";
                    return Err(RunError::NoEquilibrium { t: point.load, h: arc, hint, cause });
                }
            };
            let limit = if trial.point.slope * point.slope < 0.0 {
                Some(self.locate(&point, &tangent, arc, LEVEL, |point| point.slope)?)
            } else {
                None
            };
            let ends = [
                (PathEnd::Load, options.load.map(|value| (None, value))),
                (PathEnd::Coordinate, options.coordinate.map(|(dof, value)| (Some(dof), value))),
            ];
            for (end, passed) in ends {
                let Some((coordinate, value)) = passed else { continue };
                let gap = |point: &PathPoint| coordinate.map_or(point.load, |dof: usize| point.q[dof]) - value;
                if gap(&point) == 0.0 || !(gap(&point) * gap(&trial.point) <= 0.0) {
                    continue;
                }
                let (last, at) = self.locate(&point, &tangent, arc, 0.0, gap)?;
                path.limits.extend(limit.filter(|(_, limit)| *limit < at).map(|(limit, _)| limit));
                path.points.push(last);
                path.end = end;
                return Ok(());
            }
            path.limits.extend(limit.map(|(limit, _)| limit));
            path.points.push(trial.point);
            arc = (arc * (WANTED / trial.corrections as f64).sqrt().clamp(0.5, 2.0)).min(options.longest * first);
            tangent = trial.tangent;
        }
        Ok(())
    }

    /// The point of an arc from `from` where a gap is zero, and its distance: by regula falsi with halved weights (Illinois).
    fn locate(
        &mut self,
        from: &PathPoint,
        tangent: &Direction,
        arc: f64,
        enough: f64,
        gap: impl Fn(&PathPoint) -> f64,
    ) -> Result<(PathPoint, f64), RunError> {
        let fail =
            |cause: String| RunError::NoEquilibrium { t: from.load, h: arc, hint: "try a smaller first increment", cause };
        let mut ends = [(0.0, gap(from)), (arc, f64::NAN)];
        let mut best = self.trial(from, tangent, arc).map_err(fail)?.point;
        let mut best_at = arc;
        ends[1].1 = gap(&best);
        let mut last_side = None;
        for _ in 0..MOST_TRIALS {
            let [(a, gap_a), (b, gap_b)] = ends;
            let at = (a * gap_b - b * gap_a) / (gap_b - gap_a);
            if gap(&best).abs() <= enough || (b - a).abs() <= 4.0 * f64::EPSILON * arc || !(at > a.min(b) && at < a.max(b)) {
                break;
            }
            let trial = match self.trial(from, tangent, at) {
                Ok(trial) => trial.point,
                // a matrix that is singular by chance: the point before is as near
                Err(_) => break,
            };
            let own = gap(&trial);
            (best, best_at) = (trial, at);
            let side = usize::from(own * gap_a <= 0.0);
            ends[side] = (at, own);
            if last_side == Some(side) {
                ends[1 - side].1 *= 0.5;
            }
            last_side = Some(side);
        }
        Ok((best, best_at))
    }

    /// The equilibrium an arc ahead of a point, with its tangent; or why there is none.
    fn trial(&mut self, from: &PathPoint, tangent: &Direction, arc: f64) -> Result<Trial, String> {
        let Problem { model, p, .. } = self.problem;
        let base = VectorsAvq { q: from.q.clone(), ..VectorsAvq::zeros(model.dofs) };
        let mut unknowns = Residual::unknowns(&self.newton.system);
        unknowns.x.iter_mut().zip(&tangent.q).for_each(|(x, d)| *x = arc * d);
        unknowns.mu.iter_mut().zip(&from.mu).zip(&tangent.mu).for_each(|((mu, from), d)| *mu = from + arc * d);
        let mut load = from.load + arc * tangent.load;
        self.newton.set_coordinate_scales(&base, p);
        let size = self.newton.size(&from.q).max(self.newton.size(&unknowns.x));
        let mut previous = f64::INFINITY;
        for corrections in 1..=MOST_CORRECTIONS {
            let stage = StageSystem { equations: &Equations::EQUILIBRIUM, base: &base, p, t: load };
            self.newton.linearize(stage, &mut unknowns).map_err(|unknown| format!("{unknown} is singular"))?;
            let residual = self.newton.correction();
            let along = self.along_load(&unknowns.mu, load);
            // the plane at right angles to the tangent
            let off = arc - self.dot(&tangent.q, &unknowns.x) - self.load_weight * tangent.load * (load - from.load);
            let own = self.dot(&tangent.q, &along.q) + self.load_weight * tangent.load;
            let change = (off - self.dot(&tangent.q, &residual.x)) / own;
            let combine = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + change * b).collect::<Vec<_>>();
            let moved = combine(&residual.x, &along.q);
            add_scaled(&mut unknowns.x, &moved, 1.0);
            add_scaled(&mut unknowns.mu, &combine(&residual.mu, &along.mu), 1.0);
            load += change;
            let step = self.newton.size(&moved).max(change.abs() * self.load_weight.sqrt());
            if !step.is_finite() || step > 1e3 * arc.max(size) {
                return Err(format!("corrections diverge at the load factor {load}"));
            }
            let stalled = step > 0.5 * previous && step <= NEARLY * size;
            if step <= crate::tolerances::ROUND_OFF * size || stalled {
                self.newton.residual.restore(&self.newton.system, stage, &mut unknowns);
                let q = from.q.iter().zip(&unknowns.x).map(|(q, x)| q + x).collect();
                let mut point = PathPoint { load, q, mu: unknowns.mu, slope: 0.0, stability: Stability::default() };
                let mut own = self.towards_load(&point).map_err(|unknown| format!("{unknown} is singular"))?;
                self.normalize(&mut own);
                if self.product(&own, tangent) < 0.0 {
                    own.scale(-1.0);
                }
                point.slope = own.load * self.load_weight.sqrt();
                point.stability = self.newton.stability();
                return Ok(Trial { point, tangent: own, corrections });
            }
            previous = step;
        }
        Err(format!("{MOST_CORRECTIONS} corrections did not converge at the load factor {load}"))
    }

    /// dq/dt and dmu/dt at an equilibrium; or the name of the unknown that is not determined there.
    fn towards_load(&mut self, point: &PathPoint) -> Result<Direction, String> {
        let Problem { model, p, .. } = self.problem;
        let base = VectorsAvq { q: point.q.clone(), ..VectorsAvq::zeros(model.dofs) };
        let mut unknowns = Residual::unknowns(&self.newton.system);
        unknowns.mu.clone_from(&point.mu);
        self.newton.set_coordinate_scales(&base, p);
        self.newton
            .linearize(StageSystem { equations: &Equations::EQUILIBRIUM, base: &base, p, t: point.load }, &mut unknowns)?;
        Ok(self.along_load(&point.mu, point.load))
    }

    fn along_load(&mut self, mu: &[f64], load: f64) -> Direction {
        let (force, gaps) = load_rates(self.problem, &self.newton.residual.at.q, mu, load);
        let Unknowns { x, mu, .. } = self.newton.response(&force, &gaps);
        Direction { q: x, mu, load: 1.0 }
    }

    /// Product of displacements, each scaled \[m2\].
    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.newton.coordinate_scales).map(|((a, b), scale)| a * b * scale * scale).sum()
    }

    fn product(&self, a: &Direction, b: &Direction) -> f64 {
        self.dot(&a.q, &b.q) + self.load_weight * a.load * b.load
    }

    fn normalize(&self, direction: &mut Direction) {
        direction.scale(1.0 / self.product(direction, direction).sqrt());
    }
}

impl Direction {
    fn scale(&mut self, factor: f64) {
        self.q.iter_mut().chain(&mut self.mu).for_each(|value| *value *= factor);
        self.load *= factor;
    }
}

/// Derivatives of residual with reactions, and of constraints, by the load factor.
fn load_rates(problem: &Problem<f64>, q: &[f64], mu: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
    let Problem { model, p, .. } = problem;
    let (mut force, mut gaps) = (vec![0.0; model.dofs], vec![0.0; model.equations]);
    let dofs = |nodes: &[NodeId]| nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone()).collect::<Vec<_>>();
    let mut add = |dofs: &[usize], own: &[f64]| dofs.iter().zip(own).for_each(|(&dof, own)| force[dof] += own);
    for element in &model.elements {
        let dofs = dofs(&element.nodes);
        let own: Vec<f64> = dofs.iter().map(|&dof| q[dof]).collect();
        let still = vec![0.0; own.len()];
        let state = State { a: &still, v: &still, q: &own };
        add(&dofs, &element.physics.time_rate(state, &p[element.parameters.clone()], t));
    }
    for joint in &model.constraints {
        let dofs = dofs(&joint.nodes);
        let own: Vec<f64> = dofs.iter().map(|&dof| q[dof]).collect();
        let (mu, p) = (&mu[joint.equations.clone()], &p[joint.parameters.clone()]);
        let (of_reaction, of_gap) = joint.physics.time_rates(&own, mu, p, t);
        add(&dofs, &of_reaction);
        gaps[joint.equations.clone()].copy_from_slice(&of_gap);
    }
    (force, gaps)
}
