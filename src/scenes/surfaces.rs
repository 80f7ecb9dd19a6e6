use super::builder::MechanismBuilder;
use super::sketch::NodePoint;
use crate::assembly::{ElementId, NodeId};
use crate::elements::flexible::faces::NODE_PARAMETERS;
use crate::elements::flexible::{ShellKind, ShellSection};
use crate::scalar::larger;
use std::ops::Range;

/// An element of a shell with what is shown of it at any coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Nodes, in the order of its face.
    pub nodes: Vec<NodePoint>,
    /// What it is.
    pub kind: ShellKind,
    /// Which element of the model.
    pub element: ElementId,
    parameters: Range<usize>,
    /// Where its plies begin and end along the normal, from the nodes on \[m\]; `None` for one that has a thickness.
    layers: Option<[f64; 2]>,
}

impl MechanismBuilder<f64> {
    /// The elements of all shells.
    pub fn surfaces(&self) -> Vec<Surface> {
        let of_member = |shell: &super::MeshedShell| {
            type Shown<'s> = (((ShellKind, &'s [NodeId]), &'s ElementId), Option<[f64; 2]>);
            let surface = |(((kind, nodes), &id), layers): Shown| {
                let parameters = self.model.find_element(id)?.parameters.clone();
                let nodes: Option<Vec<NodePoint>> = nodes.iter().map(|&node| self.node_point(node, [0.0; 3])).collect();
                Some(Surface { nodes: nodes?, kind, element: id, parameters, layers })
            };
            shell.faces().zip(&shell.elements).zip(shell.layers()).filter_map(surface).collect::<Vec<_>>()
        };
        self.shells.iter().flat_map(of_member).collect()
    }
}

impl Surface {
    /// Mean thickness \[m\], that of all plies or from the parameters of the whole mechanism.
    pub fn thickness(&self, p: &[f64]) -> Option<f64> {
        if let Some([below, above]) = self.layers {
            return Some(above - below);
        }
        let own = self.thicknesses()?;
        let count = own.len() as f64;
        Some(p[own].iter().sum::<f64>() / count)
    }

    /// Where it begins and ends along the director, from the nodes on \[m\], at the shape functions of its nodes.
    pub fn sides(&self, p: &[f64], weights: &[f64]) -> Option<[f64; 2]> {
        let half = |own: Range<usize>| 0.5 * p[own].iter().zip(weights).map(|(t, w)| t * w).sum::<f64>();
        self.layers.or_else(|| self.thicknesses().map(half).map(|half| [-half, half]))
    }

    /// Places of the thicknesses of an isotropic shell at its nodes among the parameters of the whole mechanism.
    pub fn thicknesses(&self) -> Option<Range<usize>> {
        let (first, shape) = (self.parameters.start, self.kind.face.shape());
        (self.kind.section == ShellSection::Isotropic).then(|| first + shape.section()..first + shape.young())
    }

    /// Directors of its nodes in their frames.
    pub fn directors(&self, p: &[f64]) -> Vec<[f64; 3]> {
        let first = self.parameters.start;
        let own = (0..self.nodes.len()).map(|node| first + node * NODE_PARAMETERS + 3);
        own.map(|place| [p[place], p[place + 1], p[place + 2]]).collect()
    }

    /// Von Mises stress [N/m2] of an isotropic shell at each Gauss point, in the order of its face: the larger of the lower and the upper surface.
    pub fn stresses(&self, q: &[f64], p: &[f64]) -> Option<Vec<f64>> {
        Some(self.layer_stresses(q, p)?.into_iter().map(|[lower, _, upper]| larger(larger(0.0, lower), upper)).collect())
    }

    /// Von Mises stresses [N/m2] of an isotropic shell at each of its Gauss points: at the lower surface, in the middle, at the upper surface.
    pub fn layer_stresses(&self, q: &[f64], p: &[f64]) -> Option<Vec<[f64; 3]>> {
        if self.kind.section != ShellSection::Isotropic {
            return None;
        }
        let (shape, p) = (self.kind.face.shape(), &p[self.parameters.clone()]);
        let own: Vec<f64> = self.nodes.iter().flat_map(|node| node.coordinates(q).to_vec()).collect();
        let at_points = self.kind.points(&own, p).into_iter();
        let at_places = at_points.map(|point| {
            [-0.5, 0.0, 0.5].map(|z| point.von_mises_at(z * point.thickness, p[shape.young()], p[shape.poisson()]))
        });
        Some(at_places.collect())
    }
}
