use super::{Element, State};
use crate::scalar::{Dual, Job, LANES, Scalar, widest};
use smallvec::SmallVec;

/// Local values of one element: on the stack for up to 16 coordinates or parameters.
type Local<S> = SmallVec<[S; 16]>;
/// With derivatives along eight coordinates or velocities.
type Lanes<S> = Dual<S, LANES>;
/// These, and their derivative along the motion; in this order all lanes of a number lie side by side.
type Moving<S> = Dual<Lanes<S>, 1>;

/// Energies and non-conservative force, of which a residual can be made.
pub trait Energies {
    /// Kinetic energy T(v, q, p) [J].
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S;
    /// Potential energy V(q, p) [J].
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S;
    /// Adds the generalized non-conservative force Q(v, q, p, t).
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]);
}

impl<E: Element + ?Sized> Energies for E {
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        Element::kinetic(self, v, q, p)
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        Element::potential(self, q, p)
    }
    #[inline(always)]
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        Element::add_force(self, v, q, p, t, force);
    }
}

/// Adds d/dt (dT/dv) - dT/dq + dV/dq - Q to `r`, from the energies of an element.
///
/// With one dual direction along the motion (dq, dv) = (v, a) around N lanes along the unit vectors of v, the mixed
/// part is d/dt (dT/dv_i); lanes along q give dT/dq_i and dV/dq_i.
pub fn lagrangian_residual<E: Energies + ?Sized, S: Scalar>(element: &E, s: State<S>, p: &[S], t: S, r: &mut [S]) {
    widest(FromEnergies(element, s, p, r));
    load_residual(element, s, p, t, r);
}

/// Subtracts the non-conservative force: the whole residual of an element without energies.
#[inline(always)]
pub fn load_residual<E: Energies + ?Sized, S: Scalar>(element: &E, s: State<S>, p: &[S], t: S, r: &mut [S]) {
    let mut force: Local<S> = SmallVec::from_elem(S::zero(), s.q.len());
    element.add_force(s.v, s.q, p, t, &mut force);
    for (r, f) in r.iter_mut().zip(&force) {
        *r -= *f;
    }
}

/// The part of the residual that comes from the energies.
struct FromEnergies<'j, E: ?Sized, S>(&'j E, State<'j, S>, &'j [S], &'j mut [S]);

impl<E: Energies + ?Sized, S: Scalar> Job for FromEnergies<'_, E, S> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let FromEnergies(element, s, p, r) = self;
        let n = s.q.len();
        // filled where they are: moving such a list costs as much as the energies
        let (mut q, mut v, mut numbers) = (Local::<Moving<S>>::new(), Local::<Moving<S>>::new(), Local::<Moving<S>>::new());
        let (mut q_lanes, mut v_lanes, mut p_lanes) =
            (Local::<Lanes<S>>::new(), Local::<Lanes<S>>::new(), Local::<Lanes<S>>::new());
        for i in 0..n {
            q.push(moving(s.q[i], s.v[i]));
            v.push(moving(s.v[i], s.a[i]));
            q_lanes.push(Dual::constant(s.q[i]));
            v_lanes.push(Dual::constant(s.v[i]));
        }
        for &p in p {
            numbers.push(Dual::constant(Dual::constant(p)));
            p_lanes.push(Dual::constant(p));
        }
        for first in (0..n).step_by(LANES) {
            let lanes = LANES.min(n - first);
            for lane in 0..lanes {
                v[first + lane].re.eps[lane] = S::one();
                q_lanes[first + lane].eps[lane] = S::one();
            }
            let kinetic = element.kinetic(&v, &q, &numbers);
            let lagrangian = element.kinetic(&v_lanes, &q_lanes, &p_lanes) - element.potential(&q_lanes, &p_lanes);
            for lane in 0..lanes {
                r[first + lane] += kinetic.eps[0].eps[lane] - lagrangian.eps[lane];
                v[first + lane].re.eps[lane] = S::zero();
                q_lanes[first + lane].eps[lane] = S::zero();
            }
        }
    }
}

/// Adds (dP/dq) v with P = dT/dv: the part of [`lagrangian_residual`] that the momentum changes by without acceleration.
pub fn lagrangian_momentum_rate<E: Energies + ?Sized, S: Scalar>(element: &E, v: &[S], q: &[S], p: &[S], r: &mut [S]) {
    let moving_q: Local<Moving<S>> = q.iter().zip(v).map(|(&q, &v)| moving(q, v)).collect();
    let mut moving_v: Local<Moving<S>> = v.iter().map(|&v| moving(v, S::zero())).collect();
    let numbers: Local<Moving<S>> = p.iter().map(|&p| Dual::constant(Dual::constant(p))).collect();
    for first in (0..q.len()).step_by(LANES) {
        let lanes = LANES.min(q.len() - first);
        (0..lanes).for_each(|lane| moving_v[first + lane].re.eps[lane] = S::one());
        let kinetic = element.kinetic(&moving_v, &moving_q, &numbers);
        for lane in 0..lanes {
            r[first + lane] += kinetic.eps[0].eps[lane];
            moving_v[first + lane].re.eps[lane] = S::zero();
        }
    }
}

/// A number with its rate along the motion.
#[inline(always)]
fn moving<S: Scalar>(value: S, rate: S) -> Moving<S> {
    Dual { re: Dual::constant(value), eps: [Dual::constant(rate)] }
}
