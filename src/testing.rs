//! Checks for elements, constraints and quantities of anybody's own, which the library's pass too.
//!
//! What is derived from a recording is held against the formula itself, evaluated with num-dual's numbers and by complex steps:
//!
//! * the residual of an element against d/dt (dT/dv) - dT/dq + dV/dq + (de/dq)^T (dW/de + s) - Q, or as it is written
//! * motion, reaction and curvature of a constraint against second-order numbers along the path
//! * value and gradient of a quantity, of its rates along the motion, too
//! * the matrices of Newton's method and the products of the adjoint, in models of several elements at once
//!
//! ```
//! use costate::prelude::*;
//! use costate::testing::{Sample, check_element};
//! use std::sync::Arc;
//!
//! #[derive(Hash)]
//! struct Spring;
//! impl Element for Spring {
//!     const PARAMETERS: &'static [Parameter] = &[Parameter::new("stiffness", "N/m3")];
//!     fn nodes(&self) -> Vec<NodeKind> {
//!         vec![NodeKind::Coordinates(1)]
//!     }
//!     fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
//!         p[0] * q[0].powi(4) * 0.25
//!     }
//! }
//! let samples = Sample::random(&[NodeKind::Coordinates(1)], &[3.0], 12);
//! check_element(&Arc::new(Spring), &samples).unwrap();
//! ```

// indices carry meaning in matrix code
#![allow(clippy::needless_range_loop)]
// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::assembly::{
    Adjoints, ConstraintPart, Equations, Force, Jacobian, Level, Model, NodeId, ProductPoint, ProductSeeds, Products,
    Residual, StageCoefficients, StageSystem, System, SystemOptions, Unknowns, Variational, VectorsAvq,
};
use crate::elements::{
    AnyConstraint, Constraint, ConstraintPhysics, Element, ElementPhysics, NodeKind, Nonholonomic, NonholonomicConstraint,
    State, dofs_of,
};
use crate::functionals::{AnyQuantity, Quantity};
use crate::program::{ProgramWork, Recorded, record};
use crate::scalar::{COMPLEX_STEP, Complex64, Scalar};
use num_dual::{Dual2_64, Dual64, HyperDual64};
use std::sync::Arc;

/// Largest difference, relative to the largest number that it is compared with.
const TOLERANCE: f64 = 1e-12;

/// A state, parameters and a time at which formulas are compared.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Accelerations.
    pub a: Vec<f64>,
    /// Velocities.
    pub v: Vec<f64>,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Parameters.
    pub p: Vec<f64>,
    /// Time \[s\].
    pub t: f64,
}

impl Sample {
    /// `count` states of some nodes with numbers between -1 and 1, the same in every run; Euler parameters have lengths between 1/2 and
    /// 3/2.
    pub fn random(nodes: &[NodeKind], p: &[f64], count: usize) -> Vec<Sample> {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut number = || {
            // Knuth's linear congruential generator; the high bits scatter well enough
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let sample = |_| {
            let mut q = Vec::new();
            for node in nodes {
                let first = q.len();
                q.extend((0..node.dofs()).map(|_| number()));
                if *node == NodeKind::Body {
                    let length = q[first + 3..].iter().map(|e| e * e).sum::<f64>().sqrt();
                    let factor = (1.0 + 0.5 * number()) / length;
                    q[first + 3..].iter_mut().for_each(|e| *e *= factor);
                }
            }
            let [a, v] = [(); 2].map(|()| (0..q.len()).map(|_| number()).collect());
            Sample { a, v, q, p: p.to_vec(), t: number() }
        };
        (0..count).map(sample).collect()
    }

    fn state(&self) -> State<'_, f64> {
        State { a: &self.a, v: &self.v, q: &self.q }
    }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Whether numbers agree up to round-off of the largest of them or of `scale`.
fn agree(what: &str, own: &[f64], exact: &[f64], scale: f64) -> Result<(), String> {
    let limit = TOLERANCE * largest(own).max(largest(exact)).max(scale);
    // differences that are not numbers fail
    match own.iter().zip(exact).position(|(own, exact)| !((own - exact).abs() <= limit)) {
        None if own.len() == exact.len() => Ok(()),
        None => Err(format!("{what}: {} numbers instead of {}", own.len(), exact.len())),
        Some(place) => {
            Err(format!("{what}: entry {place} is {}, not {}; all: {own:?} and {exact:?}", own[place], exact[place]))
        }
    }
}

fn lift<S: Scalar>(x: &[f64]) -> Vec<S> {
    x.iter().map(|&x| S::from(x)).collect()
}

/// Numbers that move: each with its rate.
fn moving(x: &[f64], rate: &[f64]) -> Vec<Dual64> {
    x.iter().zip(rate).map(|(&x, &rate)| Dual64::new(x, rate)).collect()
}

/// Numbers of which one moves with rate 1.
fn seeded(x: &[f64], place: usize) -> Vec<Dual64> {
    x.iter().enumerate().map(|(i, &x)| Dual64::new(x, f64::from(u8::from(i == place)))).collect()
}

/// Damping stresses of an element, those of its dissipation function by num-dual's numbers.
pub fn damping_stresses<E: Element>(element: &E, [e, rate, p]: [&[f64]; 3], t: f64) -> Vec<f64> {
    let mut stresses = vec![0.0; e.len()];
    element.damping(e, rate, p, t, &mut stresses);
    for (place, stress) in stresses.iter_mut().enumerate() {
        *stress += element.dissipation(&lift::<Dual64>(e), &seeded(rate, place), &lift(p)).eps;
    }
    stresses
}

/// Momentum dL/dv, force dL/dq + Q and d/dt (dL/dv) by num-dual's numbers.
fn lagrangian<E: Element>(element: &E, Sample { a, v, q, p, t }: &Sample) -> [Vec<f64>; 3] {
    let n = q.len();
    let mut applied = vec![0.0; n];
    element.add_force(v, q, p, *t, &mut applied);
    let (p1, p2): (Vec<Dual64>, Vec<HyperDual64>) = (lift(p), lift(p));
    let strains = |q: &[Dual64], t: Dual64| {
        let mut e = vec![Dual64::from(0.0); element.strain_count()];
        element.strains(q, &p1, t, &mut e);
        e
    };
    let along = strains(&moving(q, v), Dual64::new(*t, 1.0));
    let (e, rate): (Vec<f64>, Vec<f64>) = along.iter().map(|e| (e.re, e.eps)).unzip();
    let stresses = damping_stresses(element, [&e, &rate, p], *t);
    let mut result = [(); 3].map(|()| Vec::with_capacity(n));
    for i in 0..n {
        result[0].push(element.kinetic(&seeded(v, i), &lift(q), &p1).eps);
        let (own, still) = (seeded(q, i), lift::<Dual64>(v));
        let e = strains(&own, (*t).into());
        let potential = element.potential(&own, &p1) + (element.strain_energy(&own, &p1) + element.stored(&e, &p1));
        let damping: f64 = e.iter().zip(&stresses).map(|(e, s)| e.eps * s).sum();
        result[1].push(element.kinetic(&still, &own, &p1).eps - potential.eps + applied[i] - damping);
        let number = |x: f64, first: bool, rate: f64| HyperDual64::new(x, f64::from(u8::from(first)), rate, 0.0);
        let v2: Vec<HyperDual64> = (0..n).map(|j| number(v[j], i == j, a[j])).collect();
        let q2: Vec<HyperDual64> = (0..n).map(|j| number(q[j], false, v[j])).collect();
        result[2].push(element.kinetic(&v2, &q2, &p2).eps1eps2);
    }
    result
}

/// An element as a model sees it.
pub fn element_physics<E: Element>(element: &Arc<E>) -> ElementPhysics {
    ElementPhysics::new(element.clone())
}

/// A constraint as a model sees it.
pub fn constraint_physics<C: AnyConstraint + 'static>(constraint: &Arc<C>) -> ConstraintPhysics {
    ConstraintPhysics::new(constraint.clone())
}

/// Whether an element's residual is written out.
fn is_written<E: Element>(element: &E) -> bool {
    let (n, m) = (dofs_of(&element.nodes()), element.parameters().len());
    let (_, recording) = record(&vec![f64::NAN; 3 * n + m + 1], |x| {
        let s = State { a: &x[..n], v: &x[n..2 * n], q: &x[2 * n..3 * n] };
        element.residual(s, &x[3 * n..3 * n + m], x[3 * n + m], &mut vec![Recorded::from(0.0); n]);
    });
    !recording.from_energies
}

/// The mass of an element is what its kinetic energy has for velocities that are the same everywhere: d2T/ds2 along each direction in space.
fn check_mass<E: Element>(element: &E, Sample { v, q, p, .. }: &Sample, has_energies: bool) -> Result<(), String> {
    let nodes = element.nodes();
    let mass = element.mass(p);
    if !has_energies || mass == 0.0 || nodes.iter().any(|node| node.in_space().is_none()) {
        return Ok(());
    }
    let mut directions = [(); 3].map(|()| vec![0.0; q.len()]);
    let mut first = 0;
    for node in &nodes {
        directions.iter_mut().enumerate().for_each(|(axis, direction)| direction[first + axis] = 1.0);
        first += node.dofs();
    }
    for (axis, direction) in ["x", "y", "z"].iter().zip(&directions) {
        let moving: Vec<Dual2_64> = v.iter().zip(direction).map(|(&v, &rate)| Dual2_64::new(v, rate, 0.0)).collect();
        let along = element.kinetic(&moving, &lift(q), &lift(p)).v2;
        agree(&format!("mass against the kinetic energy of a motion along {axis}"), &[mass], &[along], 0.0)?;
    }
    Ok(())
}

/// Holds what is derived from an element's formula against the formula in other numbers, at some states.
///
/// # Errors
/// A formula that cannot be recorded, or the first disagreement: what, where, and both numbers.
pub fn check_element<E: Element>(element: &Arc<E>, samples: &[Sample]) -> Result<(), String> {
    let physics = element_physics(element);
    check_sizes(samples, physics.dof_count(), physics.parameter_list().len())?;
    if let Some(why) = physics.residual_refused() {
        return Err(why.into());
    }
    let written = is_written(&**element);
    let has_impulse = physics.impulse_refused().is_none();
    // equations of states follow from no energy
    let has_states = element.nodes().iter().any(|node| node.is_of_states());
    for sample in samples {
        let (s, p, t) = (sample.state(), &sample.p, sample.t);
        let own = physics.residual_at(s, p, t);
        let [momentum, force, rate] = lagrangian(&**element, sample);
        let of_energies: Vec<f64> = rate.iter().zip(&force).map(|(rate, force)| rate - force).collect();
        if written {
            let mut r = vec![0.0; s.q.len()];
            element.residual(s, p, t, &mut r);
            if own != r {
                return Err(format!("residual: the program gives {own:?}, the formula {r:?}"));
            }
            if physics.has_energies() && !has_states {
                agree("written residual against energies", &own, &of_energies, 0.0)?;
            }
        } else {
            agree("residual against energies", &own, &of_energies, largest(&force))?;
        }
        if has_impulse && !has_states && (!written || physics.has_energies()) {
            agree("momentum", &physics.impulse_at(s, p, t, [1.0, 0.0]), &momentum, 0.0)?;
            agree("force", &physics.impulse_at(s, p, t, [0.0, 1.0]), &force, 0.0)?;
        }
        let mut e = vec![0.0; element.strain_count()];
        element.strains(s.q, p, 0.0, &mut e);
        let strain = element.strain_energy(s.q, p) + element.stored(&e, p);
        let energies = [element.kinetic(s.v, s.q, p), element.potential(s.q, p) + strain, element.mass(p), strain];
        let found = physics.energies_at(s.v, s.q, p);
        // -0 is recorded as 0
        if found != energies {
            return Err(format!("energies and mass: the program gives {found:?}, the formulas {energies:?}"));
        }
        check_mass(&**element, sample, physics.has_energies())?;
        check_columns(&physics, sample)?;
    }
    let with_sides = |sample: &Sample| Sample { p: physics.with_sides(&sample.p), ..sample.clone() };
    let samples: Vec<Sample> = samples.iter().map(with_sides).collect();
    let assembled = Assembled::new(&samples, |model, node| {
        model.add_element("", &[node], element.clone());
    });
    let shift = |gamma, beta, alpha| Equations::stage(StageCoefficients::new(gamma, beta, alpha), Level::Acceleration);
    let mut kinds = vec![shift(1.0, 0.0, 0.0), shift(0.0, 1.0, 0.0), shift(0.0, 0.0, 1.0), shift(0.7, -0.4, 1.3)];
    if has_impulse {
        kinds.push(Equations::variational(Variational { alpha: 0.3, h: 0.7, first: false }));
    }
    for equations in &kinds {
        assembled.check_matrix(equations)?;
    }
    assembled.check_products(&kinds[3])?;
    if has_impulse { assembled.check_impulse_products() } else { Ok(()) }
}

/// Derivatives of the residual by complex step, by dual numbers and, along time, by the program.
fn check_columns(physics: &ElementPhysics, sample: &Sample) -> Result<(), String> {
    let (s, p, t) = (sample.state(), &sample.p, sample.t);
    let values = physics.residual().values();
    let inputs = [s.a, s.v, s.q, &physics.with_sides(p)[..], &[t]].concat();
    let column = |place: usize| {
        let (mut complex, mut second): (Vec<Complex64>, Vec<Dual2_64>) = (lift(&inputs), lift(&inputs));
        complex[place].im = COMPLEX_STEP;
        second[place].v1 = 1.0;
        let (mut by_step, mut by_dual) = (vec![Complex64::ZERO; s.q.len()], vec![Dual2_64::from(0.0); s.q.len()]);
        values.run_in(&complex, &mut by_step, &mut ProgramWork::default());
        values.run_in(&second, &mut by_dual, &mut ProgramWork::default());
        let by_step: Vec<f64> = by_step.iter().map(|r| r.im / COMPLEX_STEP).collect();
        (by_step, by_dual.iter().map(|r| r.v1).collect::<Vec<f64>>())
    };
    let columns: Vec<_> = (0..inputs.len()).map(column).collect();
    let scale = columns.iter().map(|(by_step, _)| largest(by_step)).fold(0.0, f64::max);
    for (place, (by_step, by_dual)) in columns.iter().enumerate() {
        agree(&format!("derivative to argument {place} by complex step and dual numbers"), by_step, by_dual, scale)?;
    }
    agree("dR/dt", &physics.time_rate(s, p, t), &columns[inputs.len() - 1].0, scale)
}

fn check_sizes(samples: &[Sample], n: usize, m: usize) -> Result<(), String> {
    for Sample { a, v, q, p, .. } in samples {
        if [a.len(), v.len(), q.len(), p.len()] != [n, n, n, m] {
            let (q, p) = (q.len(), p.len());
            return Err(format!("a sample has {q} coordinates and {p} parameters, the formula {n} and {m}"));
        }
    }
    Ok(())
}

/// Holds what is derived from a constraint's g against g in other numbers, at some states.
///
/// # Errors
/// A formula that cannot be recorded, or the first disagreement: what, where, and both numbers.
pub fn check_constraint<C: Constraint>(constraint: &Arc<C>, samples: &[Sample]) -> Result<(), String> {
    check_rows_of(constraint, samples)
}

/// Holds what is derived from the h of a constraint on velocities against h in other numbers, at some states.
///
/// # Errors
/// A formula that cannot be recorded, or the first disagreement: what, where, and both numbers.
pub fn check_nonholonomic<C: NonholonomicConstraint>(
    constraint: &Arc<Nonholonomic<C>>,
    samples: &[Sample],
) -> Result<(), String> {
    check_rows_of(constraint, samples)
}

/// Holds the program of a quantity and its gradient against its formula in other numbers, at some states; it sees so many multipliers.
///
/// # Errors
/// A formula that cannot be recorded, or the first disagreement: what, where, and both numbers.
pub fn check_quantity<Q: Quantity>(quantity: &Q, multipliers: usize, samples: &[Sample]) -> Result<(), String> {
    let counts = [quantity.dofs(), multipliers, quantity.parameters().len()];
    check_sizes(samples, counts[0], counts[2])?;
    let formula = quantity.record(multipliers)?;
    for (index, Sample { a, v, q, p, t }) in samples.iter().enumerate() {
        let mu: Vec<f64> = (0..multipliers).map(|row| (1.3 * row as f64 + index as f64 + 0.4).sin()).collect();
        let x = [&a[..], v, q, &mu, p, &[*t]].concat();
        let mut value = [0.0];
        formula.values().run(&x, &mut value, &mut ProgramWork::default());
        let program = formula.gradient(&[0]);
        let mut entries = vec![0.0; program.labels().len()];
        program.run(&x, &mut entries, &mut ProgramWork::default());
        let mut gradient = vec![0.0; x.len()];
        program.labels().iter().zip(&entries).for_each(|(&label, &entry)| gradient[label as usize] = entry);
        let exact: Vec<Dual64> = (0..x.len()).map(|place| measured(quantity, counts, &seeded(&x, place))).collect();
        agree("value", &value, &[exact[0].re], 0.0)?;
        agree("gradient by (a, v, q, mu, p, t)", &gradient, &exact.iter().map(|own| own.eps).collect::<Vec<f64>>(), 1.0)?;
    }
    Ok(())
}

/// The value of a quantity for (a, v, q, mu, p, t), of which one moves.
fn measured<Q: Quantity>(quantity: &Q, [n, multipliers, m]: [usize; 3], x: &[Dual64]) -> Dual64 {
    let ((state, rest), count) = (x.split_at(3 * n), quantity.rated_count());
    let ((mu, rest), (a, velocities)) = (rest.split_at(multipliers), state.split_at(n));
    let ((p, t), (v, q)) = (rest.split_at(m), velocities.split_at(n));
    if count == 0 {
        return quantity.value(State { a, v, q }, mu, p, t[0]);
    }
    // its first infinitesimal is the motion, its second one what moves of x
    let along = |x: Dual64, rate: Dual64| HyperDual64::new(x.re, rate.re, x.eps, rate.eps);
    let q: Vec<HyperDual64> = q.iter().zip(v).map(|(&q, &v)| along(q, v)).collect();
    let still: Vec<HyperDual64> = p.iter().map(|&p| along(p, Dual64::from(0.0))).collect();
    let mut e = vec![HyperDual64::from(0.0); count];
    quantity.rated(&q, &still, along(t[0], Dual64::from(1.0)), &mut e);
    let numbers: Vec<Dual64> = e.iter().map(|e| Dual64::new(e.re, e.eps2)).collect();
    let rates: Vec<Dual64> = e.iter().map(|e| Dual64::new(e.eps1, e.eps1eps2)).collect();
    quantity.value_with_rates(&numbers, &rates, p)
}

/// Equations of constraints in any numbers.
trait InNumbers: AnyConstraint + 'static {
    /// g or h of (v, q, p, t).
    fn equations_at<S: Scalar>(&self, numbers: [&[S]; 3], t: S) -> Vec<S>;
}

impl<C: Constraint> InNumbers for C {
    fn equations_at<S: Scalar>(&self, [_, q, p]: [&[S]; 3], t: S) -> Vec<S> {
        let mut g = vec![S::zero(); self.equations()];
        self.g(q, p, t, &mut g);
        g
    }
}

impl<C: NonholonomicConstraint> InNumbers for Nonholonomic<C> {
    fn equations_at<S: Scalar>(&self, [v, q, p]: [&[S]; 3], t: S) -> Vec<S> {
        let mut h = vec![S::zero(); C::EQUATIONS];
        self.0.h(v, q, p, t, &mut h);
        h
    }
}

fn check_rows_of<C: InNumbers>(constraint: &Arc<C>, samples: &[Sample]) -> Result<(), String> {
    let physics = constraint_physics(constraint);
    check_sizes(samples, physics.dof_count(), physics.parameter_count())?;
    if let Some(why) = physics.refused() {
        return Err(why.into());
    }
    let (n, count, restricts_velocities) = (physics.dof_count(), physics.equation_count(), physics.is_nonholonomic());
    for (index, sample) in samples.iter().enumerate() {
        let (s, p, t) = (sample.state(), &sample.p, sample.t);
        let mu: Vec<f64> = (0..count).map(|row| (1.3 * row as f64 + index as f64 + 0.4).sin()).collect();
        let lambda: Vec<f64> = (0..n).map(|dof| (0.7 * dof as f64 + index as f64 + 0.2).cos()).collect();
        let motion = physics.motion(s, p, t);
        let part = |order: usize| motion.iter().map(|g| g[order]).collect::<Vec<f64>>();
        let still = vec![0.0; n];
        let real = constraint.equations_at([s.v, s.q, p], t);
        let at_rest = constraint.equations_at([&still[..], s.q, p], t);
        if part(usize::from(restricts_velocities)) != real || physics.value(s.q, p, t) != at_rest {
            return Err(format!("equations: the program gives {motion:?}, the formula {real:?}"));
        }
        // along the path q + s v + s^2 a / 2
        let path = |x: &[f64], first: &[f64], second: &[f64]| -> Vec<Dual2_64> {
            (0..n).map(|i| Dual2_64::new(x[i], first[i], second[i])).collect()
        };
        let (v2, q2) = (path(s.v, s.a, &still), path(s.q, s.v, s.a));
        let along = constraint.equations_at([&v2[..], &q2, &lift(p)], Dual2_64::new(t, 1.0, 0.0));
        let first: Vec<f64> = along.iter().map(|g| g.v1).collect();
        agree("first derivative along the motion", &part(1 + usize::from(restricts_velocities)), &first, 1.0)?;
        if !restricts_velocities {
            let second: Vec<f64> = along.iter().map(|g| g.v2).collect();
            agree("second derivative along the motion", &part(2), &second, 1.0)?;
        }
        check_rows(&physics, &**constraint, sample, [&mu, &lambda])?;
    }
    let assembled = Assembled::new(samples, |model, node| {
        model.add_constraint("", &[node], constraint.clone());
    });
    for level in [Level::Position, Level::Velocity, Level::Acceleration] {
        let equations = Equations::stage(StageCoefficients::new(0.7, 0.4, 1.3), level);
        assembled.check_matrix(&equations)?;
        assembled.check_products(&equations)?;
    }
    Ok(())
}

/// A, A^T mu and the gradients of lambda . A^T mu against derivatives of the formula.
fn check_rows<C: InNumbers>(
    physics: &ConstraintPhysics,
    constraint: &C,
    sample: &Sample,
    [mu, lambda]: [&[f64]; 2],
) -> Result<(), String> {
    let (n, count, restricts_velocities) = (physics.dof_count(), physics.equation_count(), physics.is_nonholonomic());
    let (s, p, t) = (sample.state(), &sample.p, sample.t);
    let still = vec![0.0; n];
    // A: derivatives to coordinates or velocities; lambda . A^T mu is the derivative of mu . g along lambda
    let seed = |x: &[f64], along: &[f64], place: Option<usize>| -> Vec<HyperDual64> {
        (0..x.len()).map(|i| HyperDual64::new(x[i], along[i], f64::from(u8::from(Some(i) == place)), 0.0)).collect()
    };
    let mixed = |towards: usize, place: Option<usize>| {
        let (q_place, p_place) = ((towards == 0).then_some(place).flatten(), (towards == 1).then_some(place).flatten());
        let v = if restricts_velocities { seed(&still, lambda, None) } else { lift(s.v) };
        let q = seed(s.q, if restricts_velocities { &still } else { lambda }, q_place);
        let p = seed(p, &vec![0.0; p.len()], p_place);
        constraint.equations_at([&v[..], &q, &p], t.into())
    };
    let weighted = |g: &[HyperDual64]| g.iter().zip(mu).map(|(g, mu)| g.eps1eps2 * mu).sum::<f64>();
    let rows = physics.rows(s.q, p, t);
    let row_products: Vec<f64> = rows.chunks_exact(n).map(|row| row.iter().zip(lambda).map(|(a, l)| a * l).sum()).collect();
    let exact: Vec<f64> = mixed(0, None).iter().map(|g| g.eps1).collect();
    agree("rows", &row_products, &exact, largest(&rows))?;
    for dof in 0..n {
        let mut moved = lift::<Dual2_64>(if restricts_velocities { &still } else { s.q });
        moved[dof].v1 = 1.0;
        let (v, q) = if restricts_velocities { (moved, lift(s.q)) } else { (lift(s.v), moved) };
        let g = constraint.equations_at([&v[..], &q, &lift(p)], t.into());
        let own: Vec<f64> = (0..count).map(|row| rows[row * n + dof]).collect();
        agree("column of the rows", &own, &g.iter().map(|g| g.v1).collect::<Vec<_>>(), largest(&rows))?;
    }
    let reaction = physics.reaction(s.q, mu, p, t);
    let by_rows: Vec<f64> = (0..n).map(|dof| (0..count).map(|row| mu[row] * rows[row * n + dof]).sum()).collect();
    agree("reaction", &reaction, &by_rows, 1.0)?;
    let (of_q, of_p) = physics.along_rows((s.q, p, t), mu, (&[NodeKind::Coordinates(n)], lambda));
    let exact: Vec<f64> = (0..n).map(|dof| weighted(&mixed(0, Some(dof)))).collect();
    agree("gradient of the reaction to coordinates", &of_q, &exact, 1.0)?;
    let exact: Vec<f64> = (0..p.len()).map(|place| weighted(&mixed(1, Some(place)))).collect();
    agree("gradient of the reaction to parameters", &of_p, &exact, 1.0)
}

/// A model with one node, and one element or constraint on it, for each sample.
struct Assembled<'s> {
    model: Model,
    samples: &'s [Sample],
    at: VectorsAvq<f64>,
    p: Vec<f64>,
}

/// One group of arguments: (a, v, q) or parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Argument {
    State(usize),
    Parameters,
}

impl<'s> Assembled<'s> {
    fn new(samples: &'s [Sample], add: impl Fn(&mut Model, NodeId)) -> Self {
        let mut model = Model::default();
        let nodes: Vec<NodeId> =
            samples.iter().map(|sample| model.add_node("", NodeKind::Coordinates(sample.q.len()), false)).collect();
        nodes.into_iter().for_each(|node| add(&mut model, node));
        let all = |part: fn(&Sample) -> &Vec<f64>| samples.iter().flat_map(|sample| part(sample).clone()).collect();
        let at = VectorsAvq { a: all(|s| &s.a), v: all(|s| &s.v), q: all(|s| &s.q) };
        let p = all(|s| &s.p);
        Assembled { model, samples, at, p }
    }

    /// Times of the checks: few, because each is one for all states.
    fn times(&self) -> impl Iterator<Item = f64> + '_ {
        self.samples.iter().take(3).map(|sample| sample.t)
    }

    fn complex_at(&self) -> VectorsAvq<Complex64> {
        VectorsAvq { a: lift(&self.at.a), v: lift(&self.at.v), q: lift(&self.at.q) }
    }

    fn system(&self) -> System<'_> {
        System::new(&self.model, SystemOptions::default())
    }

    /// Multipliers that are not zero.
    fn unknowns(system: &System) -> Unknowns<f64> {
        let mut unknowns = Residual::<f64>::unknowns(system);
        unknowns.mu.iter_mut().enumerate().for_each(|(i, x)| *x = (1.9 * i as f64 + 0.3).sin());
        unknowns
    }

    fn complex_unknowns(unknowns: &Unknowns<f64>) -> Unknowns<Complex64> {
        Unknowns { x: lift(&unknowns.x), mu: lift(&unknowns.mu), local_mu: lift(&unknowns.local_mu) }
    }

    /// F and G of one sample, divided by a step's size.
    fn steps_of(&self, residual: &Residual<Complex64>, index: usize) -> [Vec<f64>; 2] {
        let n = self.samples[index].q.len();
        let rows = self.model.equations / self.samples.len();
        [(&residual.f, n), (&residual.g, rows)]
            .map(|(all, count)| all.iter().skip(index * count).take(count).map(|x| x.im / COMPLEX_STEP).collect())
    }

    /// The matrix of Newton's method against complex steps of every unknown.
    fn check_matrix(&self, equations: &Equations) -> Result<(), String> {
        let system = self.system();
        let (n, rows) = (self.samples[0].q.len(), self.model.equations / self.samples.len());
        for t in self.times() {
            let mut unknowns = Self::unknowns(&system);
            let (mut real, mut jacobian) = (Residual::default(), Jacobian::default());
            real.evaluate(&system, StageSystem { equations, base: &self.at, p: &self.p, t }, &mut unknowns);
            jacobian.assemble(&system, equations, &real, &unknowns, &self.p, t);
            let mut complex = Residual::default();
            let (at, p) = (self.complex_at(), lift::<Complex64>(&self.p));
            // places of the rows of a sample in the matrix: F, G
            let places = |index: usize| -> [Vec<usize>; 2] {
                let multipliers = system.multiplier_places().iter().skip(index * rows).take(rows);
                [(n * index..n * (index + 1)).collect(), multipliers.flatten().copied().collect()]
            };
            let all: Vec<[Vec<usize>; 2]> = (0..self.samples.len()).map(places).collect();
            let mut blocks: Vec<[[Vec<f64>; 2]; 2]> = vec![Default::default(); self.samples.len()];
            for group in 0..2 {
                for column in 0..all[0][group].len() {
                    let mut stepped = Self::complex_unknowns(&unknowns);
                    let numbers = if group == 0 { &mut stepped.x } else { &mut stepped.mu };
                    let count = all[0][group].len();
                    numbers.iter_mut().skip(column).step_by(count).for_each(|x| x.im = COMPLEX_STEP);
                    complex.evaluate(&system, StageSystem { equations, base: &at, p: &p, t }, &mut stepped);
                    for (index, places) in all.iter().enumerate() {
                        let exact = self.steps_of(&complex, index);
                        for (block, (places_of_rows, exact)) in blocks[index].iter_mut().zip(places.iter().zip(exact)) {
                            let entry = |&row: &usize| {
                                let place = system.pattern.position(row, places[group][column]);
                                place.map_or(0.0, |place| jacobian.values[place])
                            };
                            block[0].extend(places_of_rows.iter().map(entry));
                            block[1].extend(exact);
                        }
                    }
                }
            }
            for (index, block) in blocks.iter().enumerate() {
                for (what, [own, exact]) in ["F", "G"].iter().zip(block) {
                    agree(&format!("matrix of {equations:?}, rows of {what} in sample {index}"), own, exact, 0.0)?;
                }
            }
        }
        Ok(())
    }

    /// Gradients of adjoint variables times the rows of a system against complex steps of every argument.
    fn check_products(&self, equations: &Equations) -> Result<(), String> {
        let system = self.system();
        let t = self.samples[0].t;
        let unknowns = Self::unknowns(&system);
        let adjoints = Self::adjoints(&system);
        let (at, p) = (self.complex_at(), lift::<Complex64>(&self.p));
        let mut complex = Residual::default();
        let mut product_of = |argument: Argument, place: usize| -> Vec<f64> {
            let (mut at, mut p) = (at.clone(), p.clone());
            self.step(argument, place, &mut at, &mut p);
            let mut stepped = Self::complex_unknowns(&unknowns);
            complex.evaluate(&system, StageSystem { equations, base: &at, p: &p, t }, &mut stepped);
            (0..self.samples.len())
                .map(|index| {
                    let weights = [&adjoints.f, &adjoints.g];
                    let steps = self.steps_of(&complex, index);
                    let own = |(all, steps): (&Vec<f64>, Vec<f64>)| -> f64 {
                        all[index * steps.len()..].iter().zip(steps).map(|(weight, step)| weight * step).sum()
                    };
                    weights.into_iter().zip(steps).filter(|(_, steps)| !steps.is_empty()).map(own).sum()
                })
                .collect()
        };
        let found = |active: &[bool]| {
            let (mut bar, mut bar_p) = (vec![0.0; 3 * self.at.q.len()], vec![0.0; self.p.len()]);
            let mut products = Products::new(active);
            let point = ProductPoint { at: &self.at, p: &self.p, t };
            let mut seeds = [ProductSeeds { avq: &mut bar, p: &mut bar_p }];
            let adjoints = std::slice::from_ref(&adjoints);
            products.add_elements(&system, adjoints, (Force::Residual, 1.0), point, &mut seeds);
            products.add_constraints(&system, (equations, ConstraintPart::Both), adjoints, &unknowns, point, &mut seeds);
            (bar, bar_p)
        };
        self.compare_products(&format!("{equations:?}"), found, &mut product_of)
    }

    /// The same for the impulse w_P P + w_F F of elements.
    fn check_impulse_products(&self) -> Result<(), String> {
        let system = self.system();
        let (t, weights) = (self.samples[0].t, [0.6, -1.7]);
        let adjoints = Self::adjoints(&system);
        let (at, p) = (self.complex_at(), lift::<Complex64>(&self.p));
        let mut product_of = |argument: Argument, place: usize| -> Vec<f64> {
            let (mut at, mut p) = (at.clone(), p.clone());
            self.step(argument, place, &mut at, &mut p);
            let own = |index: usize| {
                let (n, m) = (self.samples[index].q.len(), self.samples[index].p.len());
                let [dofs, places] = [n, m].map(|count| index * count..(index + 1) * count);
                let s = State { a: &at.a[dofs.clone()], v: &at.v[dofs.clone()], q: &at.q[dofs.clone()] };
                let values = self.model.elements[index].physics.impulse_at(s, &p[places], t.into(), weights);
                adjoints.f[dofs].iter().zip(values).map(|(weight, value)| weight * value.im / COMPLEX_STEP).sum()
            };
            (0..self.samples.len()).map(own).collect()
        };
        let found = |active: &[bool]| {
            let (mut bar, mut bar_p) = (vec![0.0; 3 * self.at.q.len()], vec![0.0; self.p.len()]);
            let point = ProductPoint { at: &self.at, p: &self.p, t };
            let mut seeds = [ProductSeeds { avq: &mut bar, p: &mut bar_p }];
            let adjoints = std::slice::from_ref(&adjoints);
            Products::new(active).add_elements(&system, adjoints, (Force::Impulse(weights), 1.0), point, &mut seeds);
            (bar, bar_p)
        };
        self.compare_products("impulse", found, &mut product_of)
    }

    fn adjoints(system: &System) -> Adjoints {
        let mut adjoints = Adjoints::zeros(system);
        let Adjoints { f, g } = &mut adjoints;
        for (phase, numbers) in [f, g].into_iter().enumerate() {
            let number = |i: usize| (0.9 * i as f64 + phase as f64 + 0.1).cos();
            numbers.iter_mut().enumerate().for_each(|(i, x)| *x = number(i));
        }
        adjoints
    }

    /// A complex step of one argument of every element.
    fn step(&self, argument: Argument, place: usize, at: &mut VectorsAvq<Complex64>, p: &mut [Complex64]) {
        let (n, m) = (self.samples[0].q.len(), self.samples[0].p.len());
        let (numbers, count): (&mut [Complex64], usize) = match argument {
            Argument::State(0) => (&mut at.a, n),
            Argument::State(1) => (&mut at.v, n),
            Argument::State(_) => (&mut at.q, n),
            Argument::Parameters => (p, m),
        };
        numbers.iter_mut().skip(place).step_by(count).for_each(|x| x.im = COMPLEX_STEP);
    }

    fn compare_products(
        &self,
        what: &str,
        found: impl Fn(&[bool]) -> (Vec<f64>, Vec<f64>),
        product_of: &mut dyn FnMut(Argument, usize) -> Vec<f64>,
    ) -> Result<(), String> {
        let (n, m) = (self.samples[0].q.len(), self.samples[0].p.len());
        let all = [(Argument::State(0), n), (Argument::State(1), n), (Argument::State(2), n), (Argument::Parameters, m)];
        let exact = all.map(|(argument, count)| {
            let mut values = vec![0.0; count * self.samples.len()];
            for place in 0..count {
                let products = product_of(argument, place);
                values[place..].iter_mut().step_by(count).zip(products).for_each(|(value, product)| *value = product);
            }
            values
        });
        // every parameter, then every other one
        for stride in [1, 2] {
            let active: Vec<bool> = (0..self.p.len()).map(|place| (place % m.max(1)) % stride == 0).collect();
            let (bar, bar_p) = found(&active);
            let avq = bar.chunks(self.at.q.len().max(1));
            for (argument, (own, exact)) in ["a", "v", "q", "p"].iter().zip(avq.chain([&bar_p[..]]).zip(&exact)) {
                let mut exact = exact.clone();
                if *argument == "p" {
                    exact.iter_mut().zip(&active).filter(|(_, active)| !**active).for_each(|(value, _)| *value = 0.0);
                }
                let count = exact.len() / self.samples.len();
                for (index, (own, exact)) in own.chunks(count.max(1)).zip(exact.chunks(count.max(1))).enumerate() {
                    let place = format!("products of {what}, gradient to {argument} in sample {index}");
                    agree(&place, own, exact, 1.0)?;
                }
            }
        }
        Ok(())
    }
}
