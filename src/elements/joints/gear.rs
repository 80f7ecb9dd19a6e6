use crate::elements::entries::{BETWEEN, Entry, Example, ExampleValue, Given, Key, Placed, Range, Type, need};
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scalar::Scalar;

/// Two gears: r1 phi1 + r2 phi2 - c = 0 \[m\], for any ratio and any number of turns.
///
/// phi1 and phi2 are coordinates that count turns ([`AngleCoordinate`](super::AngleCoordinate)), usually of both gears against the
/// body that carries their axes. With parallel axes radii of one sign are external gears, of opposite signs an internal gear or a
/// belt. The multiplier is minus the tangential force at the pitch circles, positive where it turns both forwards \[N\].
///
/// * `pitch radius 1`, `pitch radius 2`  r1, r2 \[m\], not 0
/// * `offset`  c \[m\]
#[derive(Hash)]
pub struct GearJoint;

impl Constraint for GearJoint {
    const EQUATIONS: usize = 1;
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_zero("pitch radius 1", "m"),
        Parameter::non_zero("pitch radius 2", "m"),
        Parameter::new("offset", "m"),
    ];

    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1); 2]
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        g[0] = p[0] * q[0] + p[1] * q[1] - p[2];
    }
}

impl Entry for GearJoint {
    type Law = Self;
    const NAME: &'static str = "gear";
    const DOC: &'static str = "gears on two joint angles";
    const KEYS: &'static [Key] =
        &[BETWEEN, need("radii", Type::Numbers(&[2], "m", Range::Any), "pitch radii; of one sign for external gears")];
    const EXAMPLE: Example =
        (&[NodeKind::Coordinates(1), NodeKind::Coordinates(1)], &[("radii", ExampleValue::Numbers(&[0.5, -0.2]))]);

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let radii: [S; 2] = given.numbers("radii");
        let mut offset = S::zero();
        for (node, radius) in radii.into_iter().enumerate() {
            match given.node(node) {
                Placed { kind: NodeKind::Coordinates(1), q } => offset += radius * q[0],
                _ => {
                    let (name, own) = (given.owner(), given.name(node));
                    let text = format!(
                        "gear \"{name}\" needs two joint angles, but node \"{own}\" is none: add one by joint_angle"
                    );
                    given.wrong(text);
                }
            }
        }
        (GearJoint, vec![radii[0], radii[1], offset])
    }
}
