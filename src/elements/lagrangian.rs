//! Residuals, momenta and forces made of energies, in recorded numbers.

// `!(x <= limit)` is how a NaN fails a check
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::dyn_layer::split_arguments;
use super::{Element, NodeKind, Output, Parameter, State, dofs_of};
use crate::program::{Formula, Recorded, Stages, along_motion, gradient_of, is_from_energies, record};

/// Energies of an element.
pub(super) struct Energies {
    /// T.
    pub kinetic: Recorded,
    /// V with the strain energy.
    pub potential: Recorded,
    /// The strain energy, U with what is stored in strains that are given.
    pub strain: Recorded,
}

/// A trait whose methods are those of an [`Element`] in recorded numbers, which every element has.
macro_rules! in_recorded_numbers {
    ($(#[$doc:meta])* $trait:ident: $(fn $method:ident($($argument:ident: $type:ty),*) $(-> $result:ty)?;)*) => {
        $(#[$doc])*
        pub trait $trait {
            $(fn $method(&self, $($argument: $type),*) $(-> $result)?;)*
        }

        impl<E: Element> $trait for E {
            $(fn $method(&self, $($argument: $type),*) $(-> $result)? {
                Element::$method(self, $($argument),*)
            })*
        }
    };
}

in_recorded_numbers! {
    /// What a residual is made of: an element, or the same in numbers that a node map makes of its coordinates.
    Formulas:
    fn kinetic(v: &[Recorded], q: &[Recorded], p: &[Recorded]) -> Recorded;
    fn potential(q: &[Recorded], p: &[Recorded]) -> Recorded;
    fn strain_energy(q: &[Recorded], p: &[Recorded]) -> Recorded;
    fn add_force(v: &[Recorded], q: &[Recorded], p: &[Recorded], t: Recorded, force: &mut [Recorded]);
    fn strain_count() -> usize;
    fn strains(q: &[Recorded], p: &[Recorded], t: Recorded, e: &mut [Recorded]);
    fn stored(e: &[Recorded], p: &[Recorded]) -> Recorded;
    fn damping(e: &[Recorded], rate: &[Recorded], p: &[Recorded], t: Recorded, s: &mut [Recorded]);
    fn dissipation(e: &[Recorded], rate: &[Recorded], p: &[Recorded]) -> Recorded;
}

/// An element with its type erased where it is recorded, so that what is made of its formulas is compiled once for all of them.
pub trait ElementFormulas: Formulas {
    fn node_kinds(&self) -> Vec<NodeKind>;
    fn parameter_list(&self) -> Vec<Parameter>;
    fn residual(&self, s: State<Recorded>, p: &[Recorded], t: Recorded, r: &mut [Recorded]);
    fn mass(&self, p: &[Recorded]) -> Recorded;
    fn output_list(&self) -> Vec<Output>;
    fn write_outputs(&self, state: [&[Recorded]; 3], t: Recorded, outputs: &mut [Recorded]);
    fn in_stages(&self, s: State<Recorded>, p: &[Recorded], t: Recorded) -> Option<(Vec<Recorded>, Stages<Recorded>)>;
}

impl<E: Element> ElementFormulas for E {
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.nodes()
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn residual(&self, s: State<Recorded>, p: &[Recorded], t: Recorded, r: &mut [Recorded]) {
        Element::residual(self, s, p, t, r);
    }
    fn mass(&self, p: &[Recorded]) -> Recorded {
        Element::mass(self, p)
    }
    fn output_list(&self) -> Vec<Output> {
        self.outputs()
    }
    fn write_outputs(&self, [v, q, p]: [&[Recorded]; 3], t: Recorded, outputs: &mut [Recorded]) {
        Element::write_outputs(self, v, q, p, t, outputs);
    }
    fn in_stages(&self, s: State<Recorded>, p: &[Recorded], t: Recorded) -> Option<(Vec<Recorded>, Stages<Recorded>)> {
        Element::in_stages(self, s, p, t)
    }
}

/// Numbers of coordinates and parameters.
pub(super) fn sizes(element: &dyn ElementFormulas) -> (usize, usize) {
    (dofs_of(&element.node_kinds()), element.parameter_list().len())
}

/// For each coordinate whether it is that of a state of first order, which has neither energy nor power.
fn are_states(element: &dyn ElementFormulas) -> Vec<bool> {
    element.node_kinds().into_iter().flat_map(|kind| vec![kind.is_of_states(); kind.dofs()]).collect()
}

/// Those of some numbers that belong to coordinates, not to states.
fn of_coordinates(element: &dyn ElementFormulas, numbers: &[Recorded]) -> Vec<Recorded> {
    let all = numbers.iter().zip(are_states(element));
    all.filter(|(_, is_state)| !is_state).map(|(own, _)| *own).collect()
}

fn zeros(count: usize) -> Vec<Recorded> {
    vec![Recorded::from(0.0); count]
}

fn strains(element: &dyn Formulas, q: &[Recorded], p: &[Recorded], t: Recorded) -> Vec<Recorded> {
    let mut e = zeros(element.strain_count());
    element.strains(q, p, t, &mut e);
    e
}

impl Energies {
    pub fn of(element: &dyn Formulas, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> Self {
        let strain = element.strain_energy(q, p) + element.stored(&strains(element, q, p, t), p);
        Energies { kinetic: element.kinetic(v, q, p), potential: element.potential(q, p) + strain, strain }
    }
}

/// Numbers with their rates.
pub(crate) fn paired(numbers: &[Recorded], rates: &[Recorded]) -> Vec<(Recorded, Recorded)> {
    numbers.iter().copied().zip(rates.iter().copied()).collect()
}

/// The gradient of one number.
fn gradient(of: Recorded, towards: &[Recorded]) -> Vec<Recorded> {
    gradient_of(&[of], &[Recorded::from(1.0)], towards)
}

/// Damping stresses s + dD/d(de/dt).
fn losses(element: &dyn Formulas, [e, rate, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
    let mut stresses = zeros(e.len());
    element.damping(e, rate, p, t, &mut stresses);
    let dissipation = element.dissipation(e, rate, p);
    // rates may be the constant 0, too, and its gradient towards itself is 1
    if is_zero(dissipation) {
        return stresses;
    }
    let dissipated = gradient(dissipation, rate);
    stresses.into_iter().zip(dissipated).map(|(stress, dissipated)| stress + dissipated).collect()
}

/// Force F = dL/dq + Q and momentum P = dL/dv.
fn force_and_momentum(element: &dyn Formulas, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> (Vec<Recorded>, Vec<Recorded>) {
    let Energies { kinetic, potential, .. } = Energies::of(element, [v, q, p], t);
    let mut force = gradient(kinetic - potential, q);
    let mut applied = zeros(q.len());
    element.add_force(v, q, p, t, &mut applied);
    let e = strains(element, q, p, t);
    // along the motion of coordinates and time
    let moving = [paired(q, v), vec![(t, Recorded::from(1.0))]].concat();
    let stresses = losses(element, [&e, &along_motion(&e, &moving), p], t);
    let damping = gradient_of(&e, &stresses, q);
    for ((force, applied), damping) in force.iter_mut().zip(applied).zip(damping) {
        *force = *force + applied - damping;
    }
    (force, gradient(kinetic, v))
}

/// R(a, v, q, p, t), as it is written or from energies, and the stages in which it is made.
pub(super) fn residual(
    element: &dyn ElementFormulas,
    s: State<Recorded>,
    p: &[Recorded],
    t: Recorded,
) -> (Vec<Recorded>, Option<Stages<Recorded>>) {
    if let Some((residual, stages)) = element.in_stages(s, p, t) {
        return (residual, Some(stages));
    }
    match written(element, s, p, t) {
        Some(residual) => (residual, None),
        None => (from_energies(element, s, p, t), None),
    }
}

/// The residual, if it is written out.
fn written(element: &dyn ElementFormulas, s: State<Recorded>, p: &[Recorded], t: Recorded) -> Option<Vec<Recorded>> {
    let mut residual = zeros(s.q.len());
    element.residual(s, p, t, &mut residual);
    (!is_from_energies()).then_some(residual)
}

/// d/dt (dT/dv) - dL/dq - Q.
pub(super) fn from_energies(element: &dyn Formulas, s: State<Recorded>, p: &[Recorded], t: Recorded) -> Vec<Recorded> {
    let (force, momentum) = force_and_momentum(element, [s.v, s.q, p], t);
    let moving = [paired(s.v, s.a), paired(s.q, s.v)].concat();
    let rate = along_motion(&momentum, &moving);
    rate.into_iter().zip(force).map(|(rate, force)| rate - force).collect()
}

/// Strains, their rates, and the outputs behind those of strains.
pub(super) fn told(element: &dyn ElementFormulas, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
    let e = strains(element, q, p, t);
    let moving = [paired(q, v), vec![(t, Recorded::from(1.0))]].concat();
    let mut own = zeros(element.output_list().len() - OF_STRAIN * e.len());
    element.write_outputs([v, q, p], t, &mut own);
    let rates = along_motion(&e, &moving);
    [e, rates, own].concat()
}

/// Outputs of a strain: it, its rate, its stress.
pub(super) const OF_STRAIN: usize = 3;

/// Stresses of given strains and rates: what is stored and what is lost.
pub(super) fn stresses(element: &dyn Formulas, [e, rate, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
    let stored = gradient(element.stored(e, p), e);
    stored.into_iter().zip(losses(element, [e, rate, p], t)).map(|(stored, lost)| stored + lost).collect()
}

/// Force of given stresses, (de/dq)^T w.
pub(super) fn stress_force(element: &dyn Formulas, [q, p, w]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
    gradient_of(&strains(element, q, p, t), w, q)
}

/// Strains at a place, their change along d there, and strains at another place, one list behind the other.
pub(super) fn strain_course(element: &dyn Formulas, [from, d, to, p]: [&[Recorded]; 4], t: Recorded) -> Vec<Recorded> {
    let start = strains(element, from, p, t);
    let change = along_motion(&start, &paired(from, d));
    [start, change, strains(element, to, p, t)].concat()
}

/// s(e_0) + ds/de e' - s(e_1) with the stresses s = dW/de.
pub(super) fn stress_deviation(
    element: &dyn Formulas,
    [start, change, end]: [&[Recorded]; 3],
    p: &[Recorded],
) -> Vec<Recorded> {
    let stresses = |e: &[Recorded]| gradient(element.stored(e, p), e);
    let foreseen = stresses(start);
    let changes = along_motion(&foreseen, &paired(start, change));
    foreseen.into_iter().zip(changes).zip(stresses(end)).map(|((start, change), end)| start + change - end).collect()
}

/// w_P P + w_F F; `None` for a written residual without energies whose mass matrix depends on its state.
///
/// Such a residual with a constant mass matrix M gives P = M v and F = -R without accelerations.
pub(super) fn impulse(
    element: &dyn ElementFormulas,
    s: State<Recorded>,
    p: &[Recorded],
    t: Recorded,
    [of_momentum, of_force]: [Recorded; 2],
) -> Option<Vec<Recorded>> {
    let (force, momentum) = match written(element, s, p, t) {
        Some(residual) if are_states(element).contains(&true) || !has_energies(element) => {
            let momentum = along_motion(&residual, &paired(s.a, s.v));
            // what the momentum depends on beside v: M of anything else would leave its derivatives behind
            let still: Vec<(Recorded, Recorded)> = s.a.iter().map(|&a| (a, Recorded::from(1.0))).collect();
            let depends = |towards: &[Recorded]| {
                let columns = along_motion(&residual, &still);
                columns.iter().any(|column| gradient(*column, towards).iter().any(|entry| !is_zero(*entry)))
            };
            if depends(s.a) || depends(s.v) || depends(s.q) || depends(&[t]) {
                return None;
            }
            let inertia = along_motion(&residual, &paired(s.a, s.a));
            let force = residual.iter().zip(inertia).map(|(&residual, inertia)| inertia - residual).collect();
            (force, momentum)
        }
        _ => force_and_momentum(element, [s.v, s.q, p], t),
    };
    Some(momentum.into_iter().zip(force).map(|(momentum, force)| of_momentum * momentum + of_force * force).collect())
}

/// Power with which the element changes its energies beside what the motion does: of its forces, losses and what drives it, d(T + V)/dt - R . v, in
/// which states of first order do not count: their equations are no forces.
///
/// What energies make of the residual cancels in that; it is left out where both ways agree at two states, which they do for kinetic energies that
/// are quadratic in velocities.
pub(super) fn power(element: &dyn ElementFormulas, s: State<Recorded>, p: &[Recorded], t: Recorded) -> (Recorded, Recorded) {
    let moving = [paired(s.v, s.a), paired(s.q, s.v)].concat();
    // as energies are told, which know no time
    let Energies { kinetic, potential, .. } = Energies::of(element, [s.v, s.q, p], Recorded::from(0.0));
    let own = residual(element, s, p, t).0;
    let [own_rates, own] = [s.v, &own].map(|numbers| of_coordinates(element, numbers));
    let whole = along_motion(&[kinetic + potential], &moving)[0] - work_of(&own, &own_rates);
    let mut applied = zeros(s.q.len());
    element.add_force(s.v, s.q, p, t, &mut applied);
    let e = strains(element, s.q, p, t);
    let of_q = paired(s.q, s.v);
    let with_time = [&of_q[..], &[(t, Recorded::from(1.0))]].concat();
    let stresses = losses(element, [&e, &along_motion(&e, &with_time), p], t);
    let lost = work_of(&stresses, &along_motion(&e, &of_q));
    (work_of(&of_coordinates(element, &applied), &own_rates) - lost, whole)
}

fn work_of(forces: &[Recorded], rates: &[Recorded]) -> Recorded {
    forces.iter().zip(rates).map(|(&force, &rate)| force * rate).sum()
}

/// Which of two ways to calculate a power serves: the shorter one where both agree at two states.
pub(super) fn shorter_power_serves(element: &dyn ElementFormulas) -> bool {
    agrees_at_two_states(element, |values, s, p, t| {
        let (short, whole) = power(element, s, p, t);
        let parts = residual(element, s, p, t).0;
        // by the size of what cancels
        let sizes: Vec<Recorded> = parts.iter().zip(s.v).map(|(&force, &rate)| force * rate).collect();
        (agree(values, &[&[short][..], &sizes].concat(), &[&[whole][..], &sizes].concat()), false)
    })
}

/// Whether two ways to calculate something agree at two states, of whose numbers none are alike and all have the size of those of Euler parameters.
///
/// `agrees` says whether they do, from the numbers and the same as recorded, and whether formulas may choose, so that they could differ elsewhere.
fn agrees_at_two_states(
    element: &dyn ElementFormulas,
    agrees: impl Fn(&[f64], State<Recorded>, &[Recorded], Recorded) -> (bool, bool),
) -> bool {
    let (n, m) = sizes(element);
    (0..2).all(|probe| {
        let number = |i: usize| 0.6 + 0.35 * ((i + 37 * probe) as f64 * 1.7 + 0.3).sin();
        let values: Vec<f64> = (0..3 * n + m + 1).map(number).collect();
        let ((agree, may_choose), recording) = record(&values, |x| {
            let [a, v, q, p, t] = split_arguments(x, [n, n, n, m, 1]);
            agrees(&values, State { a, v, q }, p, t[0])
        });
        agree && (may_choose || !recording.graph.has_choices())
    })
}

/// True for the constant 0.
fn is_zero(number: Recorded) -> bool {
    number.is_known_zero()
}

/// Whether equations are linear in some numbers: their gradient does not depend on these.
pub(super) fn is_linear_in(equations: &[Recorded], numbers: &[Recorded]) -> bool {
    equations.iter().all(|&equation| {
        gradient(equation, numbers).into_iter().all(|entry| gradient(entry, numbers).into_iter().all(is_zero))
    })
}

/// Whether equations do not depend on a number.
pub(super) fn is_steady_in(equations: &[Recorded], number: Recorded) -> bool {
    equations.iter().all(|&equation| is_zero(gradient(equation, &[number])[0]))
}

/// Whether energies are complete: the residual follows from them and from losses, or is found to agree with what does at two states.
///
/// A written residual that chooses between formulas may agree at some states and not at others: it counts as more than its energies.
pub(super) fn has_energies(element: &dyn ElementFormulas) -> bool {
    agrees_at_two_states(element, |values, s, p, t| {
        let e = strains(element, s.q, p, t);
        let stored = element.stored(&e, p);
        // strains that depend on time do work
        let steady = is_zero(gradient(stored, &[t])[0]);
        let lossless = losses(element, [&e, &zeros(e.len()), p], t).into_iter().all(is_zero);
        let Some(own) = written(element, s, p, t) else { return (steady && lossless, true) };
        let [own, made] = [own, from_energies(element, s, p, t)].map(|rows| of_coordinates(element, &rows));
        (steady && lossless && agree(values, &own, &made), own.iter().all(|row| is_zero(*row)))
    })
}

/// Whether nothing changes its energy but the motion: no force beside its energies, no losses, no time.
pub(super) fn is_conservative(element: &dyn ElementFormulas) -> bool {
    let (n, m) = sizes(element);
    let mut is_free = true;
    let forces = Formula::record(2 * n + m + 1, |x| {
        let ([v, q, p, t], mut force) = (split_arguments(x, [n, n, m, 1]), zeros(n));
        element.add_force(v, q, p, t[0], &mut force);
        let mut e = strains(element, q, p, t[0]);
        let losses = losses(element, [&e, &along_motion(&e, &paired(q, v)), p], t[0]);
        e.extend(&losses);
        is_free = of_coordinates(element, &force).iter().chain(&losses).all(|&force| is_zero(force));
        e
    });
    is_free && forces.is_ok() && has_energies(element)
}

/// Whether two lists of numbers are equal up to round-off.
fn agree(values: &[f64], own: &[Recorded], made: &[Recorded]) -> bool {
    let numbers = crate::program::evaluate(values, &[own, made].concat());
    let (own, made) = numbers.split_at(own.len());
    let size = numbers.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    own.iter().zip(made).all(|(own, made)| !((own - made).abs() > crate::tolerances::SAME_DERIVATIVE * size))
}
