use super::{Element, State};
use crate::scalar::{Dual, LANES, Scalar};
use smallvec::SmallVec;

/// Local values of one element: on the stack for up to 16 coordinates or parameters.
type Local<S> = SmallVec<[S; 16]>;

/// Adds d/dt (dT/dv) - dT/dq + dV/dq - Q to `r`, from the energies of an element.
///
/// With one dual direction along the motion (dq, dv) = (v, a) inside N lanes along the unit vectors of v, the mixed
/// part is d/dt (dT/dv_i); lanes along q give dT/dq_i and dV/dq_i.
pub fn lagrangian_residual<E: Element + ?Sized, S: Scalar>(element: &E, s: State<S>, p: &[S], t: S, r: &mut [S]) {
    type Along<S> = Dual<S, 1>;
    type Mixed<S> = Dual<Along<S>, LANES>;
    let n = s.q.len();
    let along = |value: S, rate: S| Along { re: value, eps: [rate] };
    let q: Local<Mixed<S>> = s.q.iter().zip(s.v).map(|(&q, &v)| Mixed::constant(along(q, v))).collect();
    let mut v: Local<Mixed<S>> = s.v.iter().zip(s.a).map(|(&v, &a)| Mixed::constant(along(v, a))).collect();
    let p_mixed: Local<Mixed<S>> = p.iter().map(|&p| Mixed::constant(Along::constant(p))).collect();
    let mut q_lanes: Local<Dual<S, LANES>> = s.q.iter().map(|&q| Dual::constant(q)).collect();
    let v_lanes: Local<Dual<S, LANES>> = s.v.iter().map(|&v| Dual::constant(v)).collect();
    let p_lanes: Local<Dual<S, LANES>> = p.iter().map(|&p| Dual::constant(p)).collect();

    for first in (0..n).step_by(LANES) {
        let lanes = LANES.min(n - first);
        for lane in 0..lanes {
            v[first + lane].eps[lane] = Along::one();
            q_lanes[first + lane].eps[lane] = S::one();
        }
        let kinetic = element.kinetic(&v, &q, &p_mixed);
        let lagrangian = element.kinetic(&v_lanes, &q_lanes, &p_lanes) - element.potential(&q_lanes, &p_lanes);
        for lane in 0..lanes {
            r[first + lane] += kinetic.eps[lane].eps[0] - lagrangian.eps[lane];
            v[first + lane].eps[lane] = Along::zero();
            q_lanes[first + lane].eps[lane] = S::zero();
        }
    }
    let mut force: Local<S> = SmallVec::from_elem(S::zero(), n);
    element.add_force(s.v, s.q, p, t, &mut force);
    for (r, f) in r.iter_mut().zip(force) {
        *r -= f;
    }
}
