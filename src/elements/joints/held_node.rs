use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scalar::Scalar;

/// A direction in which a node can move, along or about an axis of the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Freedom {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    Z,
    /// About x.
    RotationX,
    /// About y.
    RotationY,
    /// About z.
    RotationZ,
}

impl Freedom {
    /// All six, translations first.
    pub const ALL: [Freedom; 6] =
        [Freedom::X, Freedom::Y, Freedom::Z, Freedom::RotationX, Freedom::RotationY, Freedom::RotationZ];
    /// Their names in scene files, in the same order.
    pub const NAMES: [&'static str; 6] = ["x", "y", "z", "rotation_x", "rotation_y", "rotation_z"];

    /// Those that a node has; none where its coordinates have no place in space.
    pub fn of(kind: NodeKind) -> &'static [Freedom] {
        match kind {
            NodeKind::Coordinates(_) | NodeKind::States(_) => &[],
            _ if kind.has_axes() => &Freedom::ALL,
            _ => &Freedom::ALL[..3],
        }
    }
}

/// A node that stays where it is at the start, in some directions of the world: x - x_0 = 0 \[m\] and, with its axes d_k and those of the start c_k,
/// (c_1 x d_1 + c_2 x d_2 + c_3 x d_3) / 2 = 0 \[rad\] for small angles. Coordinates without a place in space all stay what they are.
///
/// Parameters: the coordinates of the start.
#[derive(Hash)]
pub struct HeldNode {
    /// The node.
    pub kind: NodeKind,
    /// Directions in which it is held.
    pub held: Vec<Freedom>,
}

impl Constraint for HeldNode {
    const EQUATIONS: usize = 6;

    fn nodes(&self) -> Vec<NodeKind> {
        vec![self.kind]
    }
    fn equations(&self) -> usize {
        match self.kind {
            NodeKind::Coordinates(count) | NodeKind::States(count) => count,
            _ => self.held.len(),
        }
    }
    fn parameters(&self) -> Vec<Parameter> {
        (0..self.kind.dofs()).map(|place| Parameter::named(self.kind.coordinate_name(place), "-")).collect()
    }
    #[inline(always)]
    fn g<S: Scalar>(&self, q: &[S], p: &[S], _t: S, g: &mut [S]) {
        if self.kind.in_space().is_none() {
            g.iter_mut().zip(q.iter().zip(p)).for_each(|(g, (&q, &p))| *g = q - p);
            return;
        }
        let ([c1, c2, c3], [d1, d2, d3]) = (self.kind.axes(p), self.kind.axes(q));
        let turned = (c1.cross(&d1) + c2.cross(&d2) + c3.cross(&d3)) * S::from(0.5);
        for (g, &freedom) in g.iter_mut().zip(&self.held) {
            *g = match freedom {
                Freedom::X | Freedom::Y | Freedom::Z => q[freedom as usize] - p[freedom as usize],
                _ => turned[freedom as usize - 3],
            };
        }
    }
}
