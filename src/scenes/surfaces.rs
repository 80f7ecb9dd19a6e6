use super::builder::MechanismBuilder;
use super::sketch::NodePoint;
use crate::elements::Flexible;
use crate::elements::flexible::biquadratic::{GAUSS_POINTS, NODES, weights};
use crate::elements::flexible::shape::THREE;
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

/// The larger one, or what is not a number: a stress that is none is not hidden behind others.
fn larger(a: f64, b: f64) -> f64 {
    if b <= a { a } else { b }
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
        Some(self.stresses(q, p)?.into_iter().fold(0.0, larger))
    }

    /// The same at each Gauss point, r first.
    pub fn stresses(&self, q: &[f64], p: &[f64]) -> Option<[f64; GAUSS_POINTS]> {
        if self.field.section != ShellSection::Isotropic {
            return None;
        }
        let (shell, p) = (Flexible(self.field), &p[self.parameters.clone()]);
        let own: Vec<f64> = self.nodes.iter().flat_map(|node| node.coordinates(q).to_vec()).collect();
        let at_points = shell.points(&own, p);
        Some(at_points.map(|point| point.von_mises(p[YOUNG], p[POISSON]).into_iter().fold(0.0, larger)))
    }

    /// The piece of the reference surface around each Gauss point: its corners \[m\], and whether it ends at the edge of the element from each
    /// corner to the next.
    pub fn pieces(&self, q: &[f64]) -> [([[f64; 3]; 4], [bool; 4]); GAUSS_POINTS] {
        let nodes = self.nodes.each_ref().map(|node| node.at(q));
        let ends = [-1.0, 0.5 * THREE[0], 0.5 * THREE[2], 1.0];
        let at = |i: usize, j: usize| {
            let own = weights(ends[i], ends[j]).value;
            [0, 1, 2].map(|k| own.iter().zip(&nodes).map(|(weight, node)| weight * node[k]).sum())
        };
        std::array::from_fn(|point| {
            let (i, j) = (point % 3, point / 3);
            let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            (corners, [j == 0, i == 2, j == 2, i == 0])
        })
    }
}
