use super::Soft;
use super::soft::as_soft_joint;
use crate::elements::entries::{
    AT, BETWEEN, Entry, Example, ExampleValue, Given, Key, ORIENTATION, POINT, Range, TWO_BODIES, Type, may, need,
};
use crate::elements::joints::{gap, points};
use crate::elements::{Constraint, Element, Frame, NodeKind, NodePair, Output, Parameter};
use crate::scalar::{Quaternion, Scalar, SpatialVector};

/// A bushing: springs and dampers along and about the axes of a frame fixed in body a.
///
/// u = f_a* (x_b - x_a) \[m\] and w = 2 vec(f_a* f_b) [rad for small angles, at most 2] with the frames f_a = e_a e_af, f_b = e_b e_bf; where
/// a body has natural coordinates, w is half the vector of F_a^T F_b - F_b^T F_a [at most 1] with the matrices of the frames;
/// F = k u + c du/dt, M = k w + c dw/dt, V = 1/2 sum k u^2 + 1/2 sum k w^2 \[J\].
///
/// * `stiffness along x, y, z` [N/m], `stiffness about x, y, z` [N m/rad], 0 or greater
/// * `damping along x, y, z` [N s/m], `damping about x, y, z` [N m s/rad], 0 or greater
/// * `point a`, `point b`  in the frames of the bodies \[m\]: together at rest
/// * `frame a e0..e3`, `frame b e0..e3`  e_af, e_bf, Euler parameters in the frames of the bodies: together at rest
#[derive(Hash)]
pub struct Bushing(pub NodePair);

/// (u, w) with the parameters behind stiffness and damping.
#[derive(Hash)]
struct Displacement(NodePair);

impl Constraint for Displacement {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.to_vec()
    }
    fn parameters(&self) -> Vec<Parameter> {
        let frame = |of| (0..4).map(move |i| Parameter::named(format!("frame {of} e{i}"), "-"));
        points().into_iter().chain(frame("a")).chain(frame("b")).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        if self.0 == [NodeKind::Body; 2] {
            let frame = |e: &[S], own: &[S]| Quaternion::from_slice(e).times(Quaternion::from_slice(own));
            let (fa, fb) = (frame(&q[3..], &p[6..]), frame(&q[10..], &p[10..]));
            g[..3].copy_from_slice(&fa.rotate_back(gap(self.0, q, p)).components());
            g[3..].copy_from_slice(&(fa.conjugate().times(fb).parts().1 * S::from(2.0)).components());
            return;
        }
        let [a, b] = Frame::pair(self.0, q);
        let own =
            |frame: &Frame<S>, e: &[S]| Quaternion::from_slice(e).columns().map(|axis| frame.direction(&axis.components()));
        let (fa, fb) = (own(&a, &p[6..]), own(&b, &p[10..]));
        let between = b.point(&p[3..]) - a.point(p);
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            g[i] = fa[i].dot(&between);
            g[3 + i] = (fa[k].dot(&fb[j]) - fa[j].dot(&fb[k])) * S::from(0.5);
        }
    }
}

impl Bushing {
    fn soft(&self) -> Soft<Displacement> {
        Soft(Displacement(self.0))
    }
}

impl Element for Bushing {
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::non_negative("stiffness along x", "N/m").as_size(),
        Parameter::non_negative("stiffness along y", "N/m").as_size(),
        Parameter::non_negative("stiffness along z", "N/m").as_size(),
        Parameter::non_negative("stiffness about x", "N m/rad").as_size(),
        Parameter::non_negative("stiffness about y", "N m/rad").as_size(),
        Parameter::non_negative("stiffness about z", "N m/rad").as_size(),
        Parameter::non_negative("damping along x", "N s/m"),
        Parameter::non_negative("damping along y", "N s/m"),
        Parameter::non_negative("damping along z", "N s/m"),
        Parameter::non_negative("damping about x", "N m s/rad"),
        Parameter::non_negative("damping about y", "N m s/rad"),
        Parameter::non_negative("damping about z", "N m s/rad"),
    ];

    as_soft_joint!();

    fn outputs(&self) -> Vec<Output> {
        let along = [("displacement", "m"), ("rate", "m/s"), ("force", "N")];
        let about = [("turn", "rad"), ("turning rate", "rad/s"), ("moment", "N m")];
        let of_axis = |(named, axis): ([(&str, &'static str); 3], &str)| {
            named.map(|(name, unit)| Output::new(format!("{name}_{axis}"), unit))
        };
        [along, about].into_iter().flat_map(|named| ["x", "y", "z"].map(|axis| (named, axis))).flat_map(of_axis).collect()
    }

    fn parameters(&self) -> Vec<Parameter> {
        Self::PARAMETERS.iter().cloned().chain(self.soft().0.parameters()).collect()
    }
}

impl Entry for Bushing {
    type Law = Self;
    const NAME: &'static str = "bushing";
    const DOC: &'static str = "along and about three axes, with dampers; at rest as the bodies stand";
    const KEYS: &'static [Key] = &[
        BETWEEN,
        POINT,
        may("orientation", Type::Table(&ORIENTATION), "its axes; those of the world"),
        need("stiffness", Type::Numbers(&[6], "N/m, N m/rad", Range::AtLeastZero), "along and about x, y, z"),
        may("damping", Type::Numbers(&[6], "N s/m, N m s/rad", Range::AtLeastZero), "along and about x, y, z; 0"),
    ];
    const EXAMPLE: Example = (
        TWO_BODIES,
        &[
            AT,
            ("stiffness", ExampleValue::Numbers(&[3.0, 5.0, 7.0, 2.0, 4.0, 6.0])),
            ("damping", ExampleValue::Numbers(&[3.0, 5.0, 7.0, 2.0, 4.0, 6.0])),
        ],
    );

    fn make<S: Scalar>(given: &mut Given<S>) -> (Self, Vec<S>) {
        let nodes = given.bodies();
        let axes = given.rotation("orientation");
        let [on_a, on_b] = [0, 1].map(|node| given.node(node).rotation().conjugate().times(axes).0);
        let (stiffness, damping): ([S; 6], [S; 6]) = (given.numbers("stiffness"), given.numbers_or_zero("damping"));
        let point = given.point("point", 1);
        let points = given.local_points([0, 1], [point; 2]);
        (Bushing(nodes), [&stiffness[..], &damping, &points, &on_a, &on_b].concat())
    }
}
