use super::{AnyConstraint, NodeKind, Parameter, State};
use crate::program::{Digest, Recorded, gradient_of};
use crate::scalar::Scalar;
use std::hash::Hash;
use std::sync::Arc;

/// Coulomb friction in a joint or contact, by one or two velocities s at which its surfaces slip.
///
/// While they slip, forces -L s/|s| act along these, with a limit L that grows with a load by the multipliers mu of the joint; where they stick, s = 0
/// holds, with forces of at most the static limit. All derivatives are made of the recordings of these.
///
/// Source: Glocker (2001), Set-Valued Force Laws, chapter 5.
///
/// Its hash tells what is recorded of it, as that of an [`Element`](crate::elements::Element).
pub trait Friction: Hash + Send + Sync + 'static {
    /// Its physical numbers, in the order of `p`.
    const PARAMETERS: &'static [Parameter] = &[];

    /// Kinds of its nodes, which are those of the joint, in the order in which their coordinates stand.
    fn nodes(&self) -> Vec<NodeKind>;
    /// Parameters of this instance.
    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.to_vec()
    }
    /// Number of velocities, 1 or 2 at right angles.
    fn directions(&self) -> usize {
        1
    }
    /// s(v, q, p, t) \[m/s\] or [rad/s], linear in v, into `s`, which holds zeros before.
    fn slip<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, s: &mut [S]);
    /// The load that presses the surfaces together \[N\], of the first degree in the multipliers of the joint.
    fn load<S: Scalar>(&self, _mu: &[S], _q: &[S], _p: &[S], _t: S) -> S {
        S::zero()
    }
    /// The limits of friction that slips and of friction that sticks \[N\] or [N m], linear in the load but for what they are without; of a state
    /// without accelerations.
    fn limits<S: Scalar>(&self, load: S, state: State<S>, p: &[S], t: S) -> [S; 2];
}

/// A friction with its type erased.
pub trait AnyFriction: Send + Sync {
    /// Path of its type.
    fn type_name(&self) -> &'static str;
    /// What its formulas are recorded of.
    fn origin(&self) -> Digest;
    /// Kinds of its nodes.
    fn node_kinds(&self) -> Vec<NodeKind>;
    /// Its parameters.
    fn parameter_list(&self) -> Vec<Parameter>;
    /// Number of velocities.
    fn direction_count(&self) -> usize;
    /// s of recorded numbers (v, q, p) and t.
    fn slip_of(&self, numbers: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded>;
    /// Both limits for a load, of recorded numbers (v, q, p) and t.
    fn limits_of_load(&self, load: Recorded, numbers: [&[Recorded]; 3], t: Recorded) -> [Recorded; 2];
    /// Both limits of recorded numbers (v, q, mu, p) and t, where these are forces; without a load they count so many times.
    fn limits_of(&self, numbers: [&[Recorded]; 4], t: Recorded, are_forces: Recorded) -> [Recorded; 2];
}

impl<F: Friction> AnyFriction for F {
    fn origin(&self) -> Digest {
        Digest::of_typed(self)
    }
    fn type_name(&self) -> &'static str {
        std::any::type_name::<Self>()
    }
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.nodes()
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        self.parameters()
    }
    fn direction_count(&self) -> usize {
        self.directions()
    }
    fn slip_of(&self, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
        let mut s = vec![Recorded::default(); self.directions()];
        self.slip(v, q, p, t, &mut s);
        s
    }
    fn limits_of_load(&self, load: Recorded, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> [Recorded; 2] {
        self.limits(load, State { a: &[], v, q }, p, t)
    }
    fn limits_of(&self, [v, q, mu, p]: [&[Recorded]; 4], t: Recorded, are_forces: Recorded) -> [Recorded; 2] {
        let [all, unloaded] =
            [self.load(mu, q, p, t), Recorded::from(0.0)].map(|load| self.limits_of_load(load, [v, q, p], t));
        [0, 1].map(|k| all[k] - (Recorded::from(1.0) - are_forces) * unloaded[k])
    }
}

/// A joint whose surfaces slip, along a direction d that events choose: of its own parameters, those of the friction, 1 or 0 in impacts, and d, which is
/// zero where they stick.
pub struct Slipping {
    /// The joint without friction.
    pub joint: Arc<dyn AnyConstraint>,
    /// Its friction.
    pub friction: Arc<dyn AnyFriction>,
}

/// Speed near which slip ends where nothing moves [m/s].
pub(crate) const LEAST_SPEED: f64 = 1e-16;

/// How many numbers tell a direction of slip: of two velocities a speed beside it within which friction has that direction, and the speed to which slip
/// falls before another one is given.
pub(crate) fn directed_by(directions: usize) -> usize {
    if directions == 1 { 1 } else { 4 }
}

/// What is above zero while slip goes on in a direction d, and falls to zero where it ends or has turned away from it by an eighth of a turn: the velocity
/// along it, less of two velocities |s| / sqrt(2), which is smooth where they are still, and of a slip along d zero at its least speed.
pub(crate) fn going_on(s: &[Recorded], d: &[Recorded]) -> Recorded {
    let along = s.iter().zip(d).map(|(&s, &d)| s * d).sum();
    let &[_, _, still, least] = d else { return along };
    let squares = s.iter().map(|&s| s * s).sum::<Recorded>();
    let share = std::f64::consts::FRAC_1_SQRT_2;
    along - ((squares + still * still).sqrt() - still) * Recorded::from(share) - least * Recorded::from(1.0 - share)
}

/// The direction in which friction is overcome, zero where d is: that of slip, of two velocities d where they are still, within a speed near which it
/// ends. A step may go on beyond the end of slip along d, where friction is what it was before it.
fn direction(s: &[Recorded], d: &[Recorded]) -> Vec<Recorded> {
    let &[first, second, still, _] = d else { return d.to_vec() };
    let (zero, one) = (Recorded::from(0.0), Recorded::from(1.0));
    let sticks = (first * first + second * second).less(Recorded::from(0.5));
    let (along, across) = (first * s[0] + second * s[1], first * s[1] - second * s[0]);
    let along = (along * along + sticks.select(one, still * still)).sqrt();
    let size = (along * along + across * across).sqrt();
    let own = [along * first - across * second, along * second + across * first];
    own.into_iter().map(|own| sticks.select(zero, own / size)).collect()
}

impl AnyConstraint for Slipping {
    fn origin(&self) -> Digest {
        Digest::of(&("slipping", self.joint.origin(), self.friction.origin()))
    }
    fn type_name(&self) -> &'static str {
        self.joint.type_name()
    }
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.joint.node_kinds()
    }
    fn equation_count(&self) -> usize {
        self.joint.equation_count()
    }
    fn is_nonholonomic(&self) -> bool {
        self.joint.is_nonholonomic()
    }
    fn is_driver(&self) -> bool {
        self.joint.is_driver()
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        let own = ["are forces", "slip 1", "slip 2", "still", "least"]
            .into_iter()
            .take(1 + directed_by(self.friction.direction_count()));
        let own = own.map(|name| Parameter::named(name.to_string(), ""));
        self.joint.parameter_list().into_iter().chain(self.friction.parameter_list()).chain(own).collect()
    }
    fn evaluate(&self, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
        self.joint.evaluate([v, q, &p[..self.joint.parameter_list().len()]], t)
    }
    fn has_friction(&self) -> bool {
        true
    }
    fn friction_forces(&self, [v, q, mu, p]: [&[Recorded]; 4], t: Recorded) -> Vec<Recorded> {
        let (p, own) = p[self.joint.parameter_list().len()..].split_at(self.friction.parameter_list().len());
        let (are_forces, d) = (own[0], &own[1..]);
        let s = self.friction.slip_of([v, q, p], t);
        let [limit, _] = self.friction.limits_of([v, q, mu, p], t, are_forces);
        let forces: Vec<Recorded> = direction(&s, d).into_iter().map(|own| limit * own).collect();
        gradient_of(&s, &forces, v)
    }
}

/// What sticks, s = w: of the parameters of the friction, of w, which is zero but in impacts, and of two velocities of a direction c of unit length: the
/// first equation is that along c, the second one that at right angles to it.
pub struct Sticking(pub Arc<dyn AnyFriction>);

impl AnyConstraint for Sticking {
    fn origin(&self) -> Digest {
        Digest::of(&("sticking", self.0.origin()))
    }
    fn type_name(&self) -> &'static str {
        self.0.type_name()
    }
    fn node_kinds(&self) -> Vec<NodeKind> {
        self.0.node_kinds()
    }
    fn equation_count(&self) -> usize {
        self.0.direction_count()
    }
    fn is_nonholonomic(&self) -> bool {
        true
    }
    fn parameter_list(&self) -> Vec<Parameter> {
        let kept = (0..self.0.direction_count()).map(|k| Parameter::named(format!("kept {k}"), ""));
        let axis = ["c 1", "c 2"].map(|name| Parameter::named(name.to_string(), ""));
        let axis = axis.into_iter().filter(|_| self.0.direction_count() == 2);
        self.0.parameter_list().into_iter().chain(kept).chain(axis).collect()
    }
    fn evaluate(&self, [v, q, p]: [&[Recorded]; 3], t: Recorded) -> Vec<Recorded> {
        let (p, own) = p.split_at(self.0.parameter_list().len());
        let slip: Vec<Recorded> = self.0.slip_of([v, q, p], t).into_iter().zip(own).map(|(s, &kept)| s - kept).collect();
        match (&slip[..], own) {
            (&[s, other], &[_, _, x, y]) => vec![x * s + y * other, x * other - y * s],
            _ => slip,
        }
    }
}
