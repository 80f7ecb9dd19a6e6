use crate::elements::Admissible::NonNegative;
use crate::elements::{Constraint, Element, NodeKind, Output, Parameter};
use crate::scalar::Scalar;

/// A soft version of any joint g(q, p, t): springs and dampers in place of its equations, R = A^T (k g + c dg/dt) with A = dg/dq.
///
/// V = 1/2 sum k_i g_i^2 \[J\]; a joint whose g depends on time does work of its own beside. Rows of joints that hold points together are in world axes: different stiffnesses stay with the world.
///
/// * `stiffness i`  k_i of each equation [N/m or N m/rad], 0 or greater
/// * `damping i`  c_i [N s/m or N m s/rad], 0 or greater
/// * parameters of the joint
#[derive(Hash)]
pub struct Soft<J>(pub J);

/// The methods of an element that is a soft joint, given by its method `soft`, with other names of parameters.
macro_rules! as_soft_joint {
    () => {
        fn nodes(&self) -> Vec<NodeKind> {
            self.soft().nodes()
        }
        fn strain_count(&self) -> usize {
            self.soft().strain_count()
        }
        fn strains<S: Scalar>(&self, q: &[S], p: &[S], t: S, e: &mut [S]) {
            self.soft().strains(q, p, t, e);
        }
        fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
            self.soft().stored(e, p)
        }
        fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], t: S, s: &mut [S]) {
            self.soft().damping(e, rate, p, t, s);
        }
    };
}
pub(super) use as_soft_joint;

impl<J: Constraint> Element for Soft<J> {
    fn nodes(&self) -> Vec<NodeKind> {
        self.0.nodes()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let each = |what, unit| {
            let own = move |i| Parameter { admissible: NonNegative, ..Parameter::named(format!("{what} {i}"), unit) };
            (1..=self.0.equations()).map(own)
        };
        let stiffnesses = each("stiffness", "N/m, N m/rad").map(Parameter::as_size);
        stiffnesses.chain(each("damping", "N s/m, N m s/rad")).chain(self.0.parameters()).collect()
    }
    fn strain_count(&self) -> usize {
        self.0.equations()
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], t: S, e: &mut [S]) {
        self.0.g(q, &p[2 * self.0.equations()..], t, e);
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        e.iter().zip(p).map(|(&e, &k)| k * e * e * 0.5).sum()
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        for ((s, &rate), &c) in s.iter_mut().zip(rate).zip(&p[e.len()..]) {
            *s = c * rate;
        }
    }
    fn outputs(&self) -> Vec<Output> {
        let of = |row| ["g", "dg/dt", "mu"].map(|name| Output::new(format!("{name}{row}"), ""));
        (1..=self.0.equations()).flat_map(of).collect()
    }
}
