// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::newton::Newton;
use super::not_finite::not_finite;
use super::redundancy::dependent_equations;
use super::resting_start::staying_states;
use super::{NewtonTolerance, Problem, RunError, Table};
use crate::assembly::{Equations, Model, Residual, Spin, StageSystem, System, SystemOptions, VectorsAvq};
use crate::design::shortest;
use crate::elements::bodies::OrthonormalAxes;
use crate::elements::{ConstraintPhysics, NodeKind, State};
use crate::linalg::Backend;
use crate::scalar::Quaternion;
use crate::tolerances::CONSISTENT;
use std::sync::Arc;

/// Coordinates and velocities at t = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialState<S> {
    pub q: Vec<S>,
    pub v: Vec<S>,
}

/// What to do about a start that violates constraints, and about constraints that depend on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConstraintPolicy {
    /// Project the start onto the constraints (in the mass metric, differentiated) instead of refusing it.
    pub project_start: bool,
    /// Leave out constraint equations that depend on others instead of refusing them.
    pub drop_redundant: bool,
    /// Start from the equilibrium under the loads of the start, near the given coordinates (differentiated): a motion alone.
    pub from_equilibrium: bool,
}

/// Decisions made once, for the real numbers, and used by every run of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StartPlan {
    /// Constraint equations that are left out.
    pub dropped: Vec<usize>,
    /// Choose others where these no longer do.
    pub choose_again: bool,
    pub project: bool,
    pub equilibrium: Option<RestingPlan>,
}

/// How the equilibrium is found at which a motion begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RestingPlan {
    /// Equations of the [model at rest](Model::at_rest) that are left out: they depend on the others.
    pub dropped: Vec<usize>,
    /// Places of states of first order that stay as they are given: nothing depends on them, or their rates at rest depend on nothing.
    pub stays: Vec<usize>,
}

impl StartPlan {
    /// Examines a start: numbers, nodes, Euler parameters, constraints, rank; for equilibria also that nothing moves.
    pub fn prepare(problem: &Problem<f64>, table: &Table, policy: ConstraintPolicy) -> Result<StartPlan, RunError> {
        examine(problem, table, policy)?;
        let dropped = find_dependent(problem, table, policy)?;
        let equilibrium = policy.from_equilibrium.then(|| {
            let (stays, start) = (staying_states(problem), problem.start.clone());
            let resting = problem.model.at_rest(&stays);
            let (model, p) = (&resting.model, resting.parameters(&problem.p));
            let (q, v) = (resting.coordinates(&start.q, &start.v), resting.velocities(&start.v));
            RestingPlan {
                dropped: dependent_equations(&Problem { model, p, start }, &model.absent_at_start(), (&q, &v), 0.0, None),
                stays,
            }
        });
        Ok(StartPlan { dropped, choose_again: policy.drop_redundant, project: policy.project_start, equilibrium })
    }

    /// Examines the start of another design in the same way, but for the rank of its constraints.
    pub fn check(&self, problem: &Problem<f64>, table: &Table) -> Result<(), RunError> {
        examine(problem, table, self.policy())
    }

    pub(super) fn policy(&self) -> ConstraintPolicy {
        let (project_start, drop_redundant, from_equilibrium) =
            (self.project, self.choose_again, self.equilibrium.is_some());
        ConstraintPolicy { project_start, drop_redundant, from_equilibrium }
    }
}

fn examine(problem: &Problem<f64>, table: &Table, policy: ConstraintPolicy) -> Result<(), RunError> {
    let model = problem.model;
    check_sizes(problem)?;
    check_formulas(model)?;
    check_numbers(problem)?;
    check_nodes(model)?;
    check_finite(problem)?;
    check_euler_parameters(problem, policy)?;
    if table.is_static() {
        check_stillness(problem)?;
    }
    if let Some(event) = model.events.first().filter(|_| table.is_static() || table.variational.is_some()) {
        let (name, table) = (&event.condition.name, &table.name);
        return Err(RunError::Input(format!(
            "method {table} does not know events and stops, as \"{name}\" is one: take another method, or leave them out"
        )));
    }
    if policy.from_equilibrium {
        check_equilibrium(model, &problem.start, table)?;
    }
    if table.variational.is_some() {
        check_lagrangian(model, &table.name)?;
    }
    check_consistency(problem, table, policy)
}

/// As many numbers as the model has: those of another one may be more or fewer.
fn check_sizes(problem: &Problem<f64>) -> Result<(), RunError> {
    let (model, InitialState { q, v }) = (problem.model, &problem.start);
    let all = [
        ("coordinates", q.len(), model.dofs),
        ("velocities", v.len(), model.dofs),
        ("parameters", problem.p.len(), model.parameters),
    ];
    match all.into_iter().find(|(_, have, wanted)| have != wanted) {
        Some((what, have, wanted)) => Err(RunError::Input(format!(
            "the model has {wanted} {what}, but {have} are given: they belong to another model"
        ))),
        None => Ok(()),
    }
}

/// Elements and constraints whose formulas can be recorded.
fn check_formulas(model: &Model) -> Result<(), RunError> {
    let elements = model.elements.iter().map(|element| (&element.name, element.physics.residual_refused()));
    let joints = model.constraints.iter().map(|joint| (&joint.name, joint.physics.refused()));
    match elements.chain(joints).find_map(|(name, refused)| Some((name, refused?))) {
        Some((name, why)) => Err(RunError::Input(format!("\"{name}\": {why}"))),
        None => Ok(()),
    }
}

fn check_numbers(problem: &Problem<f64>) -> Result<(), RunError> {
    let model = problem.model;
    for (what, values) in [("coordinate", &problem.start.q), ("velocity", &problem.start.v)] {
        if let Some(dof) = values.iter().position(|value| !value.is_finite()) {
            let (name, value) = (model.dof_name(dof), values[dof]);
            return Err(RunError::Input(format!("initial {what} of {name} is {value}: it must be a finite number")));
        }
    }
    for part in model
        .elements
        .iter()
        .map(|e| (&e.name, &e.parameters, e.physics.parameter_list()))
        .chain(model.constraints.iter().map(|c| (&c.name, &c.parameters, c.physics.parameter_list())))
    {
        let (owner, places, parameters) = part;
        for (parameter, place) in parameters.iter().zip(places.clone()) {
            let value = problem.p[place];
            if !parameter.admissible.contains(value) {
                let (name, unit, value) = (&parameter.name, parameter.unit, shortest(value));
                let allowed = parameter.admissible.describe();
                return Err(RunError::Input(format!("\"{owner}\": {name} is {value} {unit}; it must be {allowed}")));
            }
        }
    }
    Ok(())
}

/// Formulas at the start; derivatives of one that has none are found when a matrix is made of them.
fn check_finite(problem: &Problem<f64>) -> Result<(), RunError> {
    let InitialState { q, v } = problem.start.clone();
    let at = VectorsAvq { a: vec![0.0; q.len()], v, q };
    let cause = not_finite(problem.model, &problem.p, &at, 0.0, false);
    cause.map_or(Ok(()), |cause| Err(RunError::not_finite("start", cause)))
}

/// A variational integrator needs momenta, and constraints that derive from positions.
fn check_lagrangian(model: &Model, method: &str) -> Result<(), RunError> {
    for element in &model.elements {
        if let Some(why) = element.physics.impulse_refused() {
            return Err(RunError::Input(format!("method {method} needs the momentum of \"{}\": {why}", element.name)));
        }
    }
    match model.constraints.iter().find(|joint| joint.physics.is_nonholonomic()) {
        Some(joint) => Err(RunError::Input(format!(
            "method {method} cannot keep \"{}\", which restricts velocities only; take another method",
            joint.name
        ))),
        None => Ok(()),
    }
}

fn check_nodes(model: &Model) -> Result<(), RunError> {
    let mut connected = vec![false; model.nodes.len()];
    let of_joints = model.constraints.iter().flat_map(|joint| &joint.nodes);
    of_joints.chain(model.elements.iter().flat_map(|element| &element.nodes)).for_each(|id| connected[id.0] = true);
    for (node, connected) in model.nodes.iter().zip(connected).filter(|(node, _)| !node.fixed) {
        // without inertia, constraints may determine it still: the first accelerations tell
        if !connected {
            return Err(RunError::Input(format!(
                "node \"{}\" is not connected: no element acts on it, so it has no inertia, and no joint holds it; \
                 add a body or mass to it, or remove it",
                node.name
            )));
        }
    }
    Ok(())
}

/// The velocities that a motion has at the equilibrium where it begins: they were given for other coordinates.
pub(super) fn check_velocities(problem: &Problem<f64>, table: &Table) -> Result<(), RunError> {
    let policy = ConstraintPolicy::default();
    let checked = check_euler_parameters(problem, policy).and_then(|()| check_consistency(problem, table, policy));
    checked.map_err(|why| RunError::Input(format!("at the equilibrium where the motion begins: {why}")))
}

fn check_euler_parameters(problem: &Problem<f64>, policy: ConstraintPolicy) -> Result<(), RunError> {
    for node in problem.model.nodes.iter().filter(|node| node.kind == NodeKind::Body && !policy.project_start) {
        let own = |x: &[f64]| Quaternion::from_slice(&x[node.dofs.start + 3..]);
        let (e, rate) = (own(&problem.start.q), own(&problem.start.v));
        let norm = e.norm_squared().sqrt();
        if (norm - 1.0).abs() > CONSISTENT {
            return Err(RunError::Input(format!(
                "body \"{}\": its Euler parameters {:?} have length {norm}, not 1; normalize them or ask for the start to be projected",
                node.name, e.0
            )));
        }
        let along: f64 = e.0.iter().zip(rate.0).map(|(e, r)| e * r).sum();
        let size = rate.norm_squared().sqrt();
        if along.abs() > CONSISTENT * size.max(1.0) {
            return Err(RunError::Input(format!(
                "body \"{}\": the rates of its Euler parameters change their length (e . de/dt = {along:.3e} 1/s); \
                 give an angular velocity instead or ask for the start to be projected",
                node.name
            )));
        }
    }
    for node in problem.model.nodes.iter().filter(|node| node.kind == NodeKind::Natural && !policy.project_start) {
        let (q, v) = (&problem.start.q[node.dofs.clone()], &problem.start.v[node.dofs.clone()]);
        let still = vec![0.0; q.len()];
        let g = ConstraintPhysics::new(Arc::new(OrthonormalAxes)).motion(State { a: &still, v, q }, &[], 0.0);
        let largest = |order: usize| g.iter().fold(0.0, |largest: f64, g| largest.max(g[order].abs()));
        let (off, rate) = (largest(0), largest(1));
        let speed = v[3..].iter().fold(1.0, |largest: f64, v| largest.max(v.abs()));
        if off > CONSISTENT || rate > CONSISTENT * speed {
            return Err(RunError::Input(format!(
                "body \"{}\": its axes are off from orthonormal by {off:.3e}, and their rates move them off by {rate:.3e} 1/s; \
                 give a rotation and an angular velocity or ask for the start to be projected",
                node.name
            )));
        }
    }
    Ok(())
}

/// Whether a motion can begin at an equilibrium.
fn check_equilibrium(model: &Model, start: &InitialState<f64>, table: &Table) -> Result<(), RunError> {
    if table.is_static() {
        let text =
            "a start from equilibrium is one of a motion: statics find equilibria themselves; leave one of the two out";
        return Err(RunError::Input(text.into()));
    }
    check_holonomic(model, "start it from given coordinates")?;
    let given = |spin: &Spin| {
        let mut dofs = spin.nodes.iter().flat_map(|node| model.nodes[node.0].dofs.clone());
        dofs.find(|&dof| start.v[dof] != 0.0)
    };
    match model.spin.as_ref().and_then(given) {
        Some(dof) => Err(RunError::Input(format!(
            "initial velocity of {} is {}: what turns steadily at the start has the velocities of that turn; leave it out",
            model.dof_name(dof),
            start.v[dof]
        ))),
        None => Ok(()),
    }
}

fn check_holonomic(model: &Model, instead: &str) -> Result<(), RunError> {
    match model.constraints.iter().find(|joint| joint.physics.is_nonholonomic()) {
        Some(joint) => Err(RunError::Input(format!(
            "joint \"{}\" restricts velocities, not positions: it has no equilibrium of its own; remove it or {instead}",
            joint.name
        ))),
        None => Ok(()),
    }
}

/// Nothing moves: no initial velocity, and no constraint on velocities alone.
pub(super) fn check_stillness(problem: &Problem<f64>) -> Result<(), RunError> {
    let model = problem.model;
    check_holonomic(model, "simulate the motion instead of the statics")?;
    if let Some(dof) = problem.start.v.iter().position(|&v| v != 0.0) {
        return Err(RunError::Input(format!(
            "initial velocity of {} is {}: in statics nothing moves; set it to 0 or simulate the motion instead of the statics",
            model.dof_name(dof),
            problem.start.v[dof]
        )));
    }
    Ok(())
}

fn check_consistency(problem: &Problem<f64>, table: &Table, policy: ConstraintPolicy) -> Result<(), RunError> {
    let model = problem.model;
    let size = |x: &[f64]| x.iter().fold(1.0, |s: f64, x| s.max(x.abs()));
    let (length, speed) = (size(&problem.start.q), size(&problem.start.v));
    let mut messages = Vec::new();
    for joint in model.constraints.iter().enumerate().filter(|(own, _)| model.is_there_at_start(*own)).map(|(_, own)| own) {
        let gather =
            |x: &[f64]| joint.nodes.iter().flat_map(|n| x[model.nodes[n.0].dofs.clone()].to_vec()).collect::<Vec<_>>();
        let (q, v) = (gather(&problem.start.q), gather(&problem.start.v));
        let zeros = vec![0.0; q.len()];
        let g = joint.physics.motion(State { a: &zeros, v: &v, q: &q }, &problem.p[joint.parameters.clone()], 0.0);
        for (row, [value, rate, _]) in g.iter().enumerate() {
            if !(value.abs() <= CONSISTENT * length) {
                messages.push(format!("joint \"{}\", constraint {}: g = {:.6e}", joint.name, row + 1, value));
            } else if !table.is_static() && !policy.from_equilibrium && !(rate.abs() <= CONSISTENT * speed) {
                messages.push(format!("joint \"{}\", constraint {}: dg/dt = {:.6e}", joint.name, row + 1, rate));
            }
        }
    }
    if messages.is_empty() || policy.project_start {
        return Ok(());
    }
    let shown = messages.iter().take(6).cloned().collect::<Vec<_>>().join("; ");
    let more = if messages.len() > 6 { format!("; and {} more", messages.len() - 6) } else { String::new() };
    Err(RunError::Input(format!(
        "the start violates its constraints: {shown}{more}; correct the initial positions and velocities or ask for the start to be projected"
    )))
}

/// Constraint equations that depend on others at the start, if the policy allows to drop them.
fn find_dependent(problem: &Problem<f64>, table: &Table, policy: ConstraintPolicy) -> Result<Vec<usize>, RunError> {
    let model = problem.model;
    let place = "start (t = 0 s)";
    let absent = model.absent_at_start();
    let dependent_at_start = || dependent_equations(problem, &absent, (&problem.start.q, &problem.start.v), 0.0, None);
    let is_told = |dependent: &[usize]| dependent.len() > absent.len();
    if policy.drop_redundant {
        return Ok(dependent_at_start());
    }
    if table.is_static() {
        // accelerations may not exist: freedoms of an equilibrium need no inertia
        let dependent = dependent_at_start();
        return if is_told(&dependent) { Err(redundant(model, &dependent)) } else { Ok(dependent) };
    }
    let system = Arc::new(System::new(model, SystemOptions { dropped: absent.clone(), ..SystemOptions::default() }));
    let mut newton = Newton::<f64>::new(system.clone(), NewtonTolerance::RoundOff, Backend::Automatic).map_err(|_| {
        let hint = "it has no inertia, or nothing holds it: give it a mass or a constraint";
        RunError::singular(place, "an unknown", hint)
    })?;
    let mut unknowns = Residual::unknowns(&system);
    // the point of the analysis: the constraints at their own start, whatever its consistency
    let base = VectorsAvq { a: vec![0.0; model.dofs], v: problem.start.v.clone(), q: problem.start.q.clone() };
    let stage = StageSystem { equations: &Equations::acceleration(), base: &base, p: &problem.p, t: 0.0 };
    let Err(failure) = newton.solve(stage, &mut unknowns) else {
        return Ok(absent);
    };
    // what is no number came before a matrix
    let has_matrix = !newton.jacobian.values.is_empty();
    let dependent = if has_matrix { dependent_at_start() } else { Vec::new() };
    if !is_told(&dependent) {
        return Err(newton.describe(&failure, &Equations::acceleration(), place));
    }
    Err(redundant(model, &dependent))
}

fn redundant(model: &Model, left_out: &[usize]) -> RunError {
    let absent = model.absent_at_start();
    let dependent: Vec<usize> = left_out.iter().copied().filter(|row| absent.binary_search(row).is_err()).collect();
    let kept: Vec<usize> = (0..model.equations).filter(|row| left_out.binary_search(row).is_err()).collect();
    // of a loop of beams these are hundreds
    const SHOWN: usize = 6;
    let names = |list: &[usize]| {
        let shown = list.iter().take(SHOWN).map(|&row| model.equation_name(row)).collect::<Vec<_>>().join("; ");
        if list.len() > SHOWN { format!("{shown}; and {} more", list.len() - SHOWN) } else { shown }
    };
    let subset = if kept.is_empty() { String::new() } else { format!(" An independent subset is: {}.", names(&kept)) };
    RunError::Input(format!(
        "the constraints are redundant: {} of {} equations depend on the others: {}.{subset} Remove a joint's excess equations or \
         let redundant ones be left out (`drop_redundant = true` in [settings] of a scene file, `Settings::dropping_redundant` in a program)",
        dependent.len(),
        model.equations,
        names(&dependent),
    ))
}
