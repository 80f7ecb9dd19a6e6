use super::builder::MechanismBuilder;
use super::sketch::NodePoint;
use crate::elements::Flexible;
use crate::elements::flexible::biquadratic::NODES;
use crate::elements::flexible::{POISSON, SECTION, ShellField, ShellSection, YOUNG};
use std::ops::Range;

/// An element of a shell with what is shown of it at any coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Nodes, r first.
    pub nodes: [NodePoint; NODES],
    parameters: Range<usize>,
    field: ShellField,
}

impl MechanismBuilder<f64> {
    /// The elements of all shells.
    pub fn surfaces(&self) -> Vec<Surface> {
        let of_member = |shell: &super::ShellMember| {
            let surface = |element: usize| {
                let id = shell.elements[element];
                let parameters = self.model.find_element(id)?.parameters.clone();
                let nodes: Option<Vec<NodePoint>> =
                    shell.nodes_of(element).into_iter().map(|node| self.node_point(node, [0.0; 3])).collect();
                Some(Surface { nodes: nodes?.try_into().ok()?, parameters, field: shell.field() })
            };
            (0..shell.elements.len()).filter_map(surface).collect::<Vec<_>>()
        };
        self.shells.iter().flat_map(of_member).collect()
    }
}

impl Surface {
    /// Mean thickness of an isotropic shell \[m\], from the parameters of the whole mechanism.
    pub fn thickness(&self, p: &[f64]) -> Option<f64> {
        let own = &p[self.parameters.clone()];
        (self.field.section == ShellSection::Isotropic)
            .then(|| own[SECTION..SECTION + NODES].iter().sum::<f64>() / NODES as f64)
    }

    /// Largest von Mises stress [N/m2] of an isotropic shell at its Gauss points, on the lower and the upper surface.
    pub fn stress(&self, q: &[f64], p: &[f64]) -> Option<f64> {
        if self.field.section != ShellSection::Isotropic {
            return None;
        }
        let (shell, p) = (Flexible(self.field), &p[self.parameters.clone()]);
        let own: Vec<f64> = self.nodes.iter().flat_map(|node| node.coordinates(q).to_vec()).collect();
        let stresses = shell.points(&own, p).map(|point| point.von_mises(p[YOUNG], p[POISSON]));
        Some(stresses.into_iter().flatten().fold(0.0, f64::max))
    }
}
