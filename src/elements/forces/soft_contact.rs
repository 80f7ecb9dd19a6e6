use crate::elements::Admissible::NonNegative;
use crate::elements::joints::{vectors, velocity_at};
use crate::elements::{Element, Frame, NodePair, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// What a [`SoftContact`] is between.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touching {
    /// A plane of a, with what is behind it, and a sphere or point of b. Parameters: `point` of the plane and `normal` away from it in the frame of a,
    /// `centre` in that of b, `radius`.
    SphereOnPlane,
    /// Two spheres, of which one may be a point. Parameters: `centre a`, `centre b` in the frames of the bodies, `radius a`, `radius b`.
    Spheres,
}

/// A contact that gives way by the depth d, where that is above 0: N = k d^n max(0, 1 + c dd/dt) \[N\], which pushes apart, and a friction force of the size
/// mu N |s| / sqrt(|s|^2 + s_0^2) against the slip s. It stores k d^(n + 1) / (n + 1) \[J\].
///
/// * `stiffness`  k [N/m^n], 0 or greater
/// * `damping`  c [s/m], 0 or greater
/// * `sliding`  mu [-], and `slip speed`  s_0 [m/s]: far below it friction is a damper, by which surfaces creep that Coulomb's law would hold; with friction
/// * parameters of what touches
///
/// Source: Hunt, Crossley (1975), Coefficient of Restitution Interpreted as Damping in Vibroimpact; n = 3/2 Hertz (1881), in Johnson (1985), Contact
/// Mechanics, section 4.2.
pub struct SoftContact {
    /// Kinds of both nodes, a and b.
    pub nodes: NodePair,
    /// What touches.
    pub touching: Touching,
    /// n: 1 of a linear law, 3/2 of Hertz's.
    pub exponent: f64,
    /// Whether there is friction.
    pub has_friction: bool,
}

impl SoftContact {
    /// Where the parameters of what touches begin.
    fn first(&self) -> usize {
        if self.has_friction { 4 } else { 2 }
    }

    /// The gap between the surfaces, the direction from a to b, and the place where they touch.
    fn gap<S: Scalar>(&self, q: &[S], p: &[S]) -> (S, Vector3<S>, Vector3<S>) {
        let ([a, b], p) = (Frame::pair(self.nodes, q), &p[self.first()..]);
        match self.touching {
            Touching::SphereOnPlane => {
                let (normal, centre) = (a.direction(&p[3..]), b.point(&p[6..]));
                (normal.dot(&(centre - a.point(p))) - p[9], normal, centre - normal * p[9])
            }
            Touching::Spheres => {
                let centres = [a.point(p), b.point(&p[3..])];
                let between = centres[1] - centres[0];
                let distance = between.length();
                let normal = between * (S::one() / distance);
                (distance - p[6] - p[7], normal, centres[0] + normal * p[6])
            }
        }
    }

    /// k d^n, and the share of it that its rate leaves.
    fn pressing<S: Scalar>(&self, gap: S, rate: S, p: &[S]) -> [S; 2] {
        let depth = S::zero().max(-gap);
        let elastic = if self.exponent == 1.0 { depth } else { depth.powf(self.exponent) };
        [p[0] * elastic, S::zero().max(S::one() - p[1] * rate)]
    }
}

impl Element for SoftContact {
    fn nodes(&self) -> Vec<crate::elements::NodeKind> {
        self.nodes.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let own = |name, unit| Parameter { admissible: NonNegative, ..Parameter::new(name, unit) };
        let stiffness = own("stiffness", if self.exponent == 1.0 { "N/m" } else { "N/m^1.5" }).as_size();
        let friction = [own("sliding", "-"), Parameter::positive("slip speed", "m/s")];
        let geometry = match self.touching {
            Touching::SphereOnPlane => {
                let [point, centre] = ["point", "centre"].map(|name| Parameter::vectors(&[name], "m"));
                [point, vectors(&["normal"]), centre, vec![own("radius", "m")]].concat()
            }
            Touching::Spheres => {
                let centres = Parameter::vectors(&["centre a", "centre b"], "m");
                [centres, vec![own("radius a", "m"), own("radius b", "m")]].concat()
            }
        };
        let friction = friction.into_iter().filter(|_| self.has_friction);
        [stiffness, own("damping", "s/m")].into_iter().chain(friction).chain(geometry).collect()
    }
    fn strain_count(&self) -> usize {
        1
    }
    fn strains<S: Scalar>(&self, q: &[S], p: &[S], _t: S, e: &mut [S]) {
        e[0] = self.gap(q, p).0;
    }
    fn stored<S: Scalar>(&self, e: &[S], p: &[S]) -> S {
        p[0] * S::zero().max(-e[0]).powf(self.exponent + 1.0) / (self.exponent + 1.0)
    }
    fn damping<S: Scalar>(&self, e: &[S], rate: &[S], p: &[S], _t: S, s: &mut [S]) {
        let [elastic, share] = self.pressing(e[0], rate[0], p);
        s[0] = elastic * (S::one() - share);
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], _t: S, force: &mut [S]) {
        if !self.has_friction {
            return;
        }
        let ([a, b], split) = (self.nodes, self.nodes[0].dofs());
        let (gap, normal, place) = self.gap(q, p);
        let relative = velocity_at(b, &v[split..], &q[split..], place) - velocity_at(a, v, q, place);
        let rate = normal.dot(&relative);
        let slip = relative - normal * rate;
        let [elastic, share] = self.pressing(gap, rate, p);
        let size = p[2] * elastic * share / (slip.dot(&slip) + p[3] * p[3]).sqrt();
        let (of_a, of_b) = force.split_at_mut(split);
        for (node, q, own, sign) in [(a, q, of_a, 1.0), (b, &q[split..], of_b, -1.0)] {
            let at = Frame::of(node, q).seen(place - Vector3::first_three(q));
            node.add_force(q, at, slip * (size * sign), own);
        }
    }
    fn outputs(&self) -> Vec<Output> {
        Output::of_strain([("gap", "m"), ("rate", "m/s"), ("force", "N")])
    }
}
