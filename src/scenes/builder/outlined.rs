use super::MechanismBuilder;
use crate::assembly::{ElementId, NodeId};
use crate::elements::State;
use crate::elements::flexible::{BeamField, CableStrain, Outline, STRAINS, TYING_POINTS};
use crate::functionals::Quantity;
use crate::functionals::quantities::{CableMeasure, CableQuantity, SectionMeasure, SectionQuantity};
use crate::scalar::{Scalar, larger};

/// The section of a beam or cable at one of its nodes.
#[derive(Clone, Debug)]
pub struct Ring {
    /// The node.
    pub node: NodeId,
    /// Axes 2 and 3 in the frame of the node; a cable's node has none.
    pub axes: Option<[[f64; 3]; 2]>,
    /// Its outline.
    pub outline: Outline,
}

/// The formulas of the elements of a line.
#[derive(Clone, Copy, Debug)]
pub enum LineField {
    /// Of a beam, with three nodes each.
    Beam(BeamField),
    /// Of a cable, with two nodes each.
    Cable(CableStrain),
}

/// A beam or cable with its sections.
#[derive(Clone, Debug)]
pub struct OutlinedLine {
    /// Name of the beam or cable.
    pub name: String,
    /// At all nodes, from end to end.
    pub rings: Vec<Ring>,
    /// Elements, from end to end.
    pub elements: Vec<ElementId>,
    /// Their formulas.
    pub field: LineField,
}

impl LineField {
    /// Places of the nodes of an element, from -1 to 1 for beams and from 0 to 1 for cables.
    pub fn places(self) -> &'static [f64] {
        match self {
            LineField::Beam(_) => &[-1.0, 0.0, 1.0],
            LineField::Cable(_) => &[0.0, 1.0],
        }
    }

    /// N1, N2, N3 \[N\], M1, M2, M3 [N m] in a section at a place of an element, without damping; of a cable EA eps and, as M2, EI kappa.
    pub fn section_forces(self, place: f64, q: &[f64], p: &[f64]) -> [f64; STRAINS] {
        match self {
            LineField::Beam(beam) => {
                let at = |measure| SectionQuantity { measure, beam, places: vec![place] };
                let mut strains = [0.0; TYING_POINTS * STRAINS];
                at(SectionMeasure::Strain(0)).rated(q, p, 0.0, &mut strains);
                let rates = [0.0; TYING_POINTS * STRAINS];
                std::array::from_fn(|i| at(SectionMeasure::Force(i)).value_with_rates(&strains, &rates, p))
            }
            LineField::Cable(strain) => {
                let still = vec![0.0; q.len()];
                let value = |measure| {
                    let quantity = CableQuantity { measure, strain, places: vec![place] };
                    quantity.value(State { a: &still, v: &still, q }, &[], &p[..1], 0.0)
                };
                [p[1] * value(CableMeasure::Strain), 0.0, 0.0, 0.0, p[2] * value(CableMeasure::Curvature), 0.0]
            }
        }
    }

    /// Largest axial stress of a fibre on the outline of a section, tension or compression, at a place of an element \[N/m2\], from the
    /// coordinates and parameters of the element; `None` without a material.
    pub fn largest_stress(self, outline: &Outline, place: f64, q: &[f64], p: &[f64]) -> Option<f64> {
        let young = outline.young?;
        let stress = |[x2, x3]: [f64; 2]| match self {
            LineField::Beam(beam) => {
                let quantity = SectionQuantity { measure: SectionMeasure::FibreStress, beam, places: vec![place] };
                let p = [&p[..TYING_POINTS * beam.tying_parameters()], &[young, x2, x3]].concat();
                let mut strains = [0.0; TYING_POINTS * STRAINS];
                quantity.rated(q, &p, 0.0, &mut strains);
                quantity.value_with_rates(&strains, &[0.0; TYING_POINTS * STRAINS], &p)
            }
            LineField::Cable(strain) => {
                let quantity = CableQuantity { measure: CableMeasure::Stress, strain, places: vec![place] };
                let still = vec![0.0; q.len()];
                // a cable bends about any axis: the fibre farthest out, on either side
                let farthest = 0.5 * outline.sizes[0].max(outline.sizes[1]);
                let at = |side: f64| {
                    let state = State { a: &still, v: &still, q };
                    quantity.value(state, &[], &[p[0], young, side * farthest], 0.0)
                };
                let [outside, inside] = [1.0, -1.0].map(at);
                if outside.abs() > inside.abs() { outside } else { inside }
            }
        };
        let points = outline.points();
        let all = if matches!(self, LineField::Cable(_)) { &points[..1] } else { &points[..] };
        Some(all.iter().map(|&point| stress(point).abs()).fold(0.0, larger))
    }
}

impl<S: Scalar> MechanismBuilder<S> {
    /// The node that `BEAM.start` or `BEAM.end` is.
    #[doc(hidden)]
    pub fn node_at_end(&self, name: &str) -> Option<NodeId> {
        let (line, end) = name.rsplit_once('.').filter(|(_, end)| matches!(*end, "start" | "end"))?;
        let rings = &self.outlined.iter().find(|own| own.name == line)?.rings;
        let ring = if end == "start" { rings.first() } else { rings.last() };
        Some(ring?.node)
    }
}
