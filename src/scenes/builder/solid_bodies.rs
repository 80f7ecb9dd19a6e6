//! Bodies of solids: mass, mass centre, inertia and picture from one statement.

use super::MechanismBuilder;
use crate::assembly::NodeId;
use crate::scalar::Scalar;
use crate::scenes::facets::Facets;
use crate::scenes::solid::{Solid, SolidShape, mass_properties};

/// Solids of a body as they are drawn, in its frame.
pub(crate) struct DrawnSolid {
    pub node: NodeId,
    pub facets: Facets,
}

impl<S: Scalar> MechanismBuilder<S> {
    /// Makes a body of solids, given in the world at the start: it is drawn as these, and those with a density give it mass, mass centre and
    /// inertia. Where none has one the body has no mass of them.
    pub fn solid_body(&mut self, name: &str, node: NodeId, solids: &[Solid<S>]) {
        if self.kind_of("solids", node).is_none() {
            return;
        }
        let mistakes: Vec<String> = solids.iter().filter_map(|solid| solid.mistake()).collect();
        if !mistakes.is_empty() {
            self.mistakes.extend(mistakes.into_iter().map(|why| format!("a solid of \"{name}\" {why}")));
            return;
        }
        let own: Vec<Solid<S>> = solids.iter().map(|solid| self.seen_from(node, solid)).collect();
        let facets = own.iter().map(|solid| DrawnSolid { node, facets: solid.shape.facets() });
        self.solids.extend(facets);
        if let Some((mass, centre, inertia)) = mass_properties(&own) {
            self.rigid_body(name, node, mass, centre, inertia);
        }
    }

    /// A solid in the frame of a node.
    fn seen_from(&self, node: NodeId, solid: &Solid<S>) -> Solid<S> {
        let point = |own| self.local_point(node, own);
        let shape = match &solid.shape {
            SolidShape::Box { ends, second_axis, size } => {
                SolidShape::Box { ends: ends.map(point), second_axis: self.local_direction(node, *second_axis), size: *size }
            }
            SolidShape::Cylinder { ends, diameter, wall } => {
                SolidShape::Cylinder { ends: ends.map(point), diameter: *diameter, wall: *wall }
            }
            SolidShape::Sphere { centre, diameter, wall } => {
                SolidShape::Sphere { centre: point(*centre), diameter: *diameter, wall: *wall }
            }
            SolidShape::Surface { surface, scale, position, rotation } => SolidShape::Surface {
                surface: surface.clone(),
                scale: *scale,
                position: point(*position),
                rotation: self.rotation(node).conjugate().times(*rotation),
            },
        };
        Solid { shape, density: solid.density }
    }
}
