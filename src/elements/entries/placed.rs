use crate::design::shortest;
use crate::elements::{Frame, NodeKind};
use crate::scalar::{Quaternion, Scalar, SpatialVector, Vector3};

/// A node where it stands at the start.
#[derive(Clone, Copy, Debug)]
pub struct Placed<'q, S> {
    /// What it is.
    pub kind: NodeKind,
    /// Its coordinates.
    pub q: &'q [S],
}

impl<S: Scalar> Placed<'_, S> {
    /// Place of its frame \[m\]; that of the world where it has none.
    pub fn position(self) -> Vector3<S> {
        match self.kind {
            NodeKind::Coordinates(_) | NodeKind::States(_) => Vector3::zeros(),
            _ => Vector3::first_three(self.q),
        }
    }

    /// Euler parameters of a body; other nodes have the axes of the world.
    pub fn rotation(self) -> Quaternion<S> {
        match self.kind {
            NodeKind::Body => Quaternion::from_slice(&self.q[3..]),
            NodeKind::Natural => Quaternion::of_columns(&NodeKind::Natural.axes(self.q)),
            _ => Quaternion::identity(),
        }
    }

    /// A world direction in the frame of a body.
    pub fn local_direction(self, direction: Vector3<S>) -> Vector3<S> {
        match self.kind {
            NodeKind::Natural => Frame::of(NodeKind::Natural, self.q).seen(direction),
            _ => self.rotation().rotate_back(direction),
        }
    }

    /// A world point \[m\] in the frame of a body; zero for other nodes, whose own place it is.
    pub fn local_point(self, point: Vector3<S>) -> Vector3<S> {
        if self.kind.has_axes() { self.local_direction(point - self.position()) } else { Vector3::zeros() }
    }

    /// The slope dr/dx of a cable's node [-].
    pub fn slope(self) -> Vector3<S> {
        Vector3::first_three(&self.q[3..])
    }

    /// A node without axes, here by its name, has no places but its own.
    ///
    /// # Errors
    /// How far a world point \[m\] is from it.
    pub(crate) fn check_point(self, name: &str, point: Vector3<S>) -> Result<(), String> {
        if self.kind.has_axes() || self.kind.in_space().is_none() {
            return Ok(());
        }
        let gap = (self.position() - point).length().value();
        let size = self.position().length().value().max(point.length().value());
        if gap <= crate::tolerances::CONSISTENT * size {
            return Ok(());
        }
        let gap = shortest(gap);
        Err(format!("this point lies {gap} m from \"{name}\", which has no axes and takes hold where it is: leave it out"))
    }
}
