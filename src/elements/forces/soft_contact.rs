use crate::elements::Admissible::NonNegative;
use crate::elements::joints::{vectors, velocity_at};
use crate::elements::{Element, Frame, NodePair, Output, Parameter};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use std::hash::{Hash, Hasher};

/// What a [`SoftContact`] is between, of two nodes a and b; its parameters are points and directions in their frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Touching {
    /// A plane of a, with what is behind it, and a sphere or point of b. Parameters: `point` of the plane and `normal` away from it, `centre`, `radius`.
    SphereOnPlane,
    /// A plane of a and the rim of a disc of b, which has no derivative where the disc lies flat. Parameters: those of the plane, `centre`, `axis` and
    /// `radius` of the disc.
    RimOnPlane,
    /// Two spheres, of which one may be a point. Parameters: `centre a`, `centre b`, `radius a`, `radius b`.
    Spheres,
    /// A capsule of a and a sphere or point of b. Parameters: `from`, `to`, `radius a`, `centre`, `radius b`.
    SphereOnCapsule,
    /// A box of a and a sphere of b. Parameters: `middle` and three halves of edges from there, `centre`, `radius`.
    SphereOnBox,
    /// A cylinder of a with flat ends and a sphere of b. Parameters: `from`, `to`, `radius a`, `centre`, `radius b`.
    SphereOnCylinder,
    /// Two capsules, which touch at their middles where they are parallel. Parameters: `from a`, `to a`, `radius a`, `from b`, `to b`, `radius b`.
    Capsules,
}

/// Share of the product of squared lengths by which capsules that are nearly parallel touch near their middles.
const PARALLEL: f64 = 1e-9;

/// Where something is along an edge, from 0 to 1.
fn along<S: Scalar>(share: S) -> S {
    S::zero().max(share).min(S::one())
}

/// The places of two segments that are nearest to each other, as shares of these.
///
/// Source: Ericson (2005), Real-Time Collision Detection, section 5.1.9, with a term that chooses among those of parallel ones.
fn nearest<S: Scalar>([from_a, a]: [Vector3<S>; 2], [from_b, b]: [Vector3<S>; 2]) -> [S; 2] {
    let between = from_a - from_b;
    let (aa, bb, ab) = (a.dot(&a), b.dot(&b), a.dot(&b));
    let (of_a, of_b) = (a.dot(&between), b.dot(&between));
    let held = aa * bb * PARALLEL;
    let first = along((ab * of_b - of_a * bb + held * 0.5) / (aa * bb - ab * ab + held));
    let second = along((ab * first + of_b) / bb);
    [along((ab * second - of_a) / aa), second]
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

impl Hash for SoftContact {
    fn hash<H: Hasher>(&self, state: &mut H) {
        let SoftContact { nodes, touching, exponent, has_friction } = self;
        (nodes, touching, exponent.to_bits(), has_friction).hash(state);
    }
}

impl SoftContact {
    /// Where the parameters of what touches begin.
    fn first(&self) -> usize {
        if self.has_friction { 4 } else { 2 }
    }

    /// The gap between the surfaces, the direction from a to b, and the place where they touch.
    fn gap<S: Scalar>(&self, q: &[S], p: &[S]) -> (S, Vector3<S>, Vector3<S>) {
        let ([a, b], p) = (Frame::pair(self.nodes, q), &p[self.first()..]);
        // nearest places with the radius of each around it
        let [(of_a, radius_a), (of_b, radius_b)] = match self.touching {
            Touching::SphereOnPlane => {
                let (normal, centre) = (a.direction(&p[3..]), b.point(&p[6..]));
                return (normal.dot(&(centre - a.point(p))) - p[9], normal, centre - normal * p[9]);
            }
            Touching::RimOnPlane => {
                let (normal, axis) = (a.direction(&p[3..]), b.direction(&p[9..]));
                let inward = axis * normal.dot(&axis) - normal;
                let lowest = b.point(&p[6..]) + inward * (p[12] / inward.length());
                return (normal.dot(&(lowest - a.point(p))), normal, lowest);
            }
            Touching::Spheres => [(a.point(p), p[6]), (b.point(&p[3..]), p[7])],
            Touching::SphereOnCapsule => {
                let (from, centre) = (a.point(p), b.point(&p[7..]));
                let edge = a.point(&p[3..]) - from;
                let share = along((centre - from).dot(&edge) / edge.dot(&edge));
                [(from + edge * share, p[6]), (centre, p[10])]
            }
            Touching::SphereOnBox => {
                let (middle, centre) = (a.point(p), b.point(&p[12..]));
                let edges = [3, 6, 9].map(|k| a.direction(&p[k..]));
                let nearest = edges.iter().fold(middle, |at, edge| {
                    let share = (centre - middle).dot(edge) / edge.dot(edge);
                    at + *edge * (-S::one()).max(share).min(S::one())
                });
                [(nearest, S::zero()), (centre, p[15])]
            }
            Touching::SphereOnCylinder => {
                let (from, centre) = (a.point(p), b.point(&p[7..]));
                let edge = a.point(&p[3..]) - from;
                let share = (centre - from).dot(&edge) / edge.dot(&edge);
                let aside = centre - from - edge * share;
                let kept = p[6] / aside.dot(&aside).max(p[6] * p[6]).sqrt();
                [(from + edge * along(share) + aside * kept, S::zero()), (centre, p[10])]
            }
            Touching::Capsules => {
                let [of_a, of_b] = [(a, p), (b, &p[7..])].map(|(frame, p)| {
                    let from = frame.point(p);
                    [from, frame.point(&p[3..]) - from]
                });
                let [share_a, share_b] = nearest(of_a, of_b);
                [(of_a[0] + of_a[1] * share_a, p[6]), (of_b[0] + of_b[1] * share_b, p[13])]
            }
        };
        let between = of_b - of_a;
        let distance = between.length();
        let normal = between * (S::one() / distance);
        (distance - radius_a - radius_b, normal, of_a + normal * radius_a)
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
        let places = |names| Parameter::vectors(names, "m");
        let plane = || [places(&["point"]), vectors(&["normal"])].concat();
        let geometry = match self.touching {
            Touching::SphereOnPlane => [plane(), places(&["centre"]), vec![own("radius", "m")]].concat(),
            Touching::RimOnPlane => [plane(), places(&["centre"]), vectors(&["axis"]), vec![own("radius", "m")]].concat(),
            Touching::Spheres => {
                [places(&["centre a", "centre b"]), vec![own("radius a", "m"), own("radius b", "m")]].concat()
            }
            Touching::SphereOnCapsule | Touching::SphereOnCylinder => {
                let (first, second) = (vec![own("radius a", "m")], vec![own("radius b", "m")]);
                [places(&["from", "to"]), first, places(&["centre"]), second].concat()
            }
            Touching::SphereOnBox => {
                let all = ["middle", "first edge", "second edge", "third edge", "centre"];
                [places(&all), vec![own("radius", "m")]].concat()
            }
            Touching::Capsules => {
                let (first, second) = (vec![own("radius a", "m")], vec![own("radius b", "m")]);
                [places(&["from a", "to a"]), first, places(&["from b", "to b"]), second].concat()
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
