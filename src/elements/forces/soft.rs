use crate::elements::Admissible::NonNegative;
use crate::elements::erased::Reaction;
use crate::elements::{Constraint, Element, Parameter, State};
use crate::scalar::{Dual, LANES, Scalar};
use smallvec::SmallVec;

/// Numbers of one joint: on the stack for up to three bodies.
type Few<S> = SmallVec<[S; 24]>;

/// A soft version of any joint g(q, p, t): springs and dampers in place of its equations, R = A^T (k g + c dg/dt) with A = dg/dq.
///
/// V = 1/2 sum k_i g_i^2 [J]. A joint that is not [`STEADY`](Constraint::STEADY) does work of its own: then all of this is a
/// force, no energy. Rows of joints that hold points together are in world axes: different stiffnesses stay with the world.
///
/// * `stiffness i`  k_i of each equation [N/m or N m/rad], 0 or greater
/// * `damping i`  c_i [N s/m or N m s/rad], 0 or greater
/// * parameters of the joint
pub struct Soft<J>(pub J);

impl<J: Constraint> Soft<J> {
    /// g at (q, p, t), in any number type.
    fn gap<S: Scalar>(&self, q: &[S], p: &[S], t: S) -> Few<S> {
        let mut g = Few::from_elem(S::zero(), self.0.equations());
        self.0.g(q, p, t, &mut g);
        g
    }

    /// Adds A^T (elastic k g + viscous c dg/dt), dg/dt from one dual direction along (q, t)' = (v, 1), A^T from the written
    /// reaction or eight directions along q at a time.
    fn add_forces<S: Scalar>(&self, [elastic, viscous]: [f64; 2], [v, q, p]: [&[S]; 3], t: S, r: &mut [S]) {
        let (stiffness, rest) = p.split_at(self.0.equations());
        let (damping, own) = rest.split_at(self.0.equations());
        let along: Few<Dual<S, 1>> = q.iter().zip(v).map(|(&re, &v)| Dual { re, eps: [v] }).collect();
        let constants: Few<_> = own.iter().map(|&p| Dual::constant(p)).collect();
        let g = self.gap(&along, &constants, Dual { re: t, eps: [S::one()] });
        let coefficients = stiffness.iter().zip(damping);
        let force: Few<S> =
            g.iter().zip(coefficients).map(|(g, (&k, &c))| k * g.re * elastic + c * g.eps[0] * viscous).collect();
        if J::REACTION {
            return S::run(Reaction(&self.0, [q, &force, own], t, r));
        }
        let mut lanes: Few<Dual<S, LANES>> = q.iter().map(|&q| Dual::constant(q)).collect();
        let constants: Few<_> = own.iter().map(|&p| Dual::constant(p)).collect();
        for first in (0..q.len()).step_by(LANES) {
            let group = first..q.len().min(first + LANES);
            group.clone().for_each(|dof| lanes[dof].eps[dof - first] = S::one());
            let g = self.gap(&lanes, &constants, Dual::constant(t));
            for dof in group {
                r[dof] += g.iter().zip(&force).map(|(g, &force)| g.eps[dof - first] * force).sum();
                lanes[dof].eps[dof - first] = S::zero();
            }
        }
    }
}

impl<J: Constraint> Element for Soft<J> {
    const DOFS: usize = J::DOFS;
    const ENERGIES: bool = J::STEADY;
    const CONSTANT_MASS: bool = true;

    fn dofs(&self) -> usize {
        self.0.dofs()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let each = |what, unit| {
            let name = move |i| format!("{what} {i}");
            (1..=self.0.equations()).map(move |i| Parameter { name: name(i).into(), unit, admissible: NonNegative })
        };
        each("stiffness", "N/m, N m/rad").chain(each("damping", "N s/m, N m s/rad")).chain(self.0.parameters()).collect()
    }
    #[inline(always)]
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        if !J::STEADY {
            return S::zero();
        }
        let g = self.gap(q, &p[2 * self.0.equations()..], S::zero());
        g.iter().zip(p).map(|(&g, &k)| k * g * g * 0.5).sum()
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        self.add_forces([if J::STEADY { 0.0 } else { -1.0 }, -1.0], [v, q, p], t, force);
    }
    #[inline(always)]
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], t: S, r: &mut [S]) {
        self.add_forces([1.0; 2], [s.v, s.q, p], t, r);
    }
    fn kinks(&self, p: &[f64]) -> Vec<f64> {
        self.0.kinks(&p[2 * self.0.equations()..])
    }
}
