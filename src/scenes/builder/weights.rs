//! Weights of masses, beams, cables and shells.

use super::MechanismBuilder;
use crate::assembly::{ElementId, NodeId};
use crate::elements::Flexible;
use crate::elements::flexible::shape::THREE;
use crate::elements::flexible::{BeamGravityField, CableGravity};
use crate::elements::forces::Gravity;
use crate::scalar::{Scalar, SpatialVector, Vector3};

/// What has a weight; elements of their own are added in the order of these kinds.
#[derive(Clone)]
pub(super) enum Heavy<S> {
    /// A mass with its centre in the frame of its node.
    Mass(NodeId, S, Vector3<S>),
    /// An element of a beam: name, nodes, inertia of its Gauss points, whether eccentric.
    Beam(String, [NodeId; 3], Vec<S>, bool),
    /// An element of a cable: name, nodes, length and mass.
    Cable(String, [NodeId; 2], [S; 2]),
    /// An element among whose parameters gravity is, from this place on.
    Own(ElementId, usize),
}

impl<S: Scalar> MechanismBuilder<S> {
    /// Weight of every mass, beam, cable and shell, whether added before or after: g [m/s2]. Several calls add up.
    pub fn gravity(&mut self, gravity: Vector3<S>) {
        self.add_weights(gravity, 0);
        self.gravities.push((gravity, self.heavy.len()));
    }

    /// Weight of all but the first of what has one.
    pub(super) fn add_weights(&mut self, gravity: Vector3<S>, first: usize) {
        let mut all = self.heavy[first..].to_vec();
        all.sort_by_key(|own| match own {
            Heavy::Mass(..) => 0,
            Heavy::Beam(..) => 1,
            Heavy::Cable(..) | Heavy::Own(..) => 2,
        });
        let g = gravity.components();
        for own in all {
            match own {
                Heavy::Mass(node, mass, centre) => {
                    let name = format!("weight of {}", self.model.nodes[node.0].name);
                    let on = self.kind_in_space(&name, node);
                    let p: Vec<S> = [mass].into_iter().chain(g).chain(centre.components()).collect();
                    self.add_element(&name, &[node], Gravity { on }.into(), &p);
                }
                Heavy::Beam(name, nodes, inertia, eccentric) => {
                    let points = inertia.chunks_exact(inertia.len() / THREE.len());
                    let p: Vec<S> = points.flat_map(|own| own[..4].iter().copied().chain(g)).collect();
                    let weight = Flexible(BeamGravityField { eccentric });
                    self.add_element(&format!("weight of {name}"), &nodes, weight.into(), &p);
                }
                Heavy::Cable(name, nodes, inertia) => {
                    let p = [&inertia[..], &g].concat();
                    self.add_element(&format!("weight of {name}"), &nodes, CableGravity.into(), &p);
                }
                Heavy::Own(element, place) => {
                    // an element that was refused has been reported already
                    let Some(element) = self.model.find_element(element) else { continue };
                    let first = element.parameters.start + place;
                    self.numbers.p[first..first + 3].iter_mut().zip(g).for_each(|(own, component)| *own += component);
                }
            }
        }
    }
}
