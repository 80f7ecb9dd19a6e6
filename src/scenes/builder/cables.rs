//! Cables in absolute nodal coordinates: lines with sections, their weight, their ends, and what is read in their sections.

use super::beams::{End, line_and_member, places_at};
use super::line_stress::LineStress;
use super::weights::Heavy;
use super::{Drawing, LineField, MechanismBuilder, OutlinedLine, Ring};
use crate::assembly::{ElementId, NodeId};
use crate::elements::flexible::{Cable, CableInertia, CableSection, CableStrain, GRAVITY, SmallStrainCableField};
use crate::elements::{Flexible, NodeKind};
use crate::functionals::quantities::{CableLargestStress, CableMeasure, CableQuantity};
use crate::functionals::{ElementGroup, Over};
use crate::scalar::{Scalar, SpatialVector, Vector3};
use crate::scenes::Drawn;
use crate::tolerances::CONSISTENT;

/// A straight cable at t = 0, in the world, as long as in its reference.
#[derive(Clone, Copy, Debug)]
pub struct CableLine<S> {
    /// Both ends \[m\].
    points: [Vector3<S>; 2],
    elements: usize,
    ends: [End; 2],
}

impl<S: Scalar> CableLine<S> {
    /// A line of equal elements.
    pub fn straight(points: [Vector3<S>; 2], elements: usize) -> Self {
        CableLine { points, elements, ends: [End::Free; 2] }
    }
}

/// A cable of a mechanism: where joints and loads take hold of it, and where it is read.
#[derive(Clone, Debug)]
pub struct CableMember {
    /// Nodes, one more than elements.
    pub nodes: Vec<NodeId>,
    /// Its elastic elements.
    pub elements: Vec<ElementId>,
    strain: CableStrain,
    name: String,
}

line_and_member!(CableLine, CableMember);

impl<S: Scalar> MechanismBuilder<S> {
    /// A cable along a line: see [`CableSection`].
    pub fn cable(&mut self, name: &str, line: CableLine<S>, section: &CableSection<S>) -> CableMember {
        let CableLine { points: [from, to], elements, ends } = line;
        let whole = (to - from).length();
        let mut member = CableMember { nodes: Vec::new(), elements: Vec::new(), strain: section.strain, name: name.into() };
        let sound = self.check_cable(name, (elements, whole.value()), section);
        let direction = if sound { (to - from) * whole.recip() } else { Vector3::from_f64([1.0, 0.0, 0.0]) };
        for i in 0..=elements {
            let end = if i == 0 { Some(ends[0]) } else { (i == elements).then_some(ends[1]) };
            let point = from + (to - from) * S::from(i as f64 / elements.max(1) as f64);
            let q: Vec<S> = point.components().into_iter().chain(direction.components()).collect();
            member.nodes.push(match end {
                Some(End::Node(node)) => {
                    self.check_continued(name, node, point, direction, whole);
                    node
                }
                _ => {
                    let fixed = matches!(end, Some(End::Clamped));
                    self.add_node_of_member(&format!("{name}[{i}]"), NodeKind::Slope, fixed, &q)
                }
            });
        }
        if !sound {
            return member;
        }
        let length = whole * S::from(1.0 / elements as f64);
        for (element, nodes) in member.nodes.windows(2).enumerate() {
            let own = format!("{name}, element {}", element + 1);
            let (elastic, inertia) = ([length, section.axial, section.bending], [length, section.mass]);
            let id = match section.strain {
                CableStrain::Exact => {
                    // gravity is added when it is given
                    let mut p = [&elastic[..], &[section.mass], &[S::zero(); 3]].concat();
                    p.extend(section.damped.then_some(section.damping));
                    self.add_element(&own, nodes, Cable { damped: section.damped }.into(), &p)
                }
                CableStrain::Small => {
                    let id = self.add_element(&own, nodes, Flexible(SmallStrainCableField).into(), &elastic);
                    self.add_element(&format!("inertia of {own}"), nodes, CableInertia.into(), &inertia);
                    id
                }
            };
            member.elements.push(id);
            let stress = section.outer_fibres.map_or_else(LineStress::by_stiffness, LineStress::Cable);
            self.line_stresses.insert(id, stress);
            self.heavy.push(match section.strain {
                CableStrain::Exact => Heavy::Own(id, GRAVITY),
                CableStrain::Small => Heavy::Cable(own, [nodes[0], nodes[1]], inertia),
            });
        }
        let rings = member.nodes.iter().map(|&node| Ring { node, axes: None, outline: section.outline() }).collect();
        self.outlined.push(OutlinedLine {
            name: name.into(),
            rings,
            elements: member.elements.clone(),
            field: LineField::Cable(section.strain),
        });
        let points = member.nodes.iter().map(|&node| (node, [0.0; 3])).collect();
        self.drawings.push(Drawing { drawn: Drawn::Body, points });
        member
    }

    /// Whether a line of some length \[m\] may be a cable; tells what of its section may not.
    fn check_cable(&mut self, name: &str, (elements, whole): (usize, f64), section: &CableSection<S>) -> bool {
        let sound = elements > 0 && whole > 0.0 && whole.is_finite();
        if !sound {
            self.mistakes.push(format!(
                "\"{name}\" has {elements} elements on a line of {whole} m; a cable needs one element or more and ends that lie apart"
            ));
        }
        if let Some(size) = section.impossible {
            self.mistakes.push(format!("the section of \"{name}\": {size}"));
        }
        if section.damped && section.strain == CableStrain::Small {
            self.mistakes.push(format!(
                "\"{name}\" asks for damping of a cable for small strains, which has none: take the exact strains"
            ));
        }
        sound
    }

    /// A node in which two cables meet holds one slope.
    fn check_continued(&mut self, name: &str, node: NodeId, point: Vector3<S>, direction: Vector3<S>, length: S) {
        if self.kind_of(name, node).is_none() {
            return;
        }
        let own = &self.model.nodes[node.0];
        if own.kind != NodeKind::Slope {
            self.mistakes.push(format!(
                "\"{name}\" ends in \"{}\", which is no node of a cable: give it a node of its own and a joint",
                own.name
            ));
            return;
        }
        let q = &self.numbers.q[own.dofs.clone()];
        let gap = (Vector3::first_three(q) - point).length().value();
        let turned = (Vector3::first_three(&q[3..]) - direction).length().value();
        if gap > CONSISTENT * length.value() || turned > CONSISTENT {
            self.mistakes.push(format!(
                "\"{name}\" meets its node \"{}\" at a distance of {gap:.3e} m and with a slope that differs by {turned:.3e}; \
                 cables that share a node go on in one direction, others meet in a body",
                own.name
            ));
        }
    }

    /// A functional of a strain of a cable at a share of its length, from 0 to 1.
    pub fn cable_strain_functional(
        &mut self,
        name: &str,
        over: Over,
        cable: &CableMember,
        share: f64,
        measure: CableMeasure,
    ) {
        if measure == CableMeasure::Stress {
            self.mistakes.push(format!("\"{name}\": a stress needs Young's modulus: take cable_stress_functional"));
            return;
        }
        self.add_cable_quantity(name, over, (cable, share), measure, &[]);
    }

    /// A functional of the axial stress E (eps + z kappa) of a cable [N/m2], for Young's modulus E [N/m2] and a distance z \[m\] of the fibre
    /// from the axis: 0 without bending, positive on the outside of the bend.
    pub fn cable_stress_functional(
        &mut self,
        name: &str,
        over: Over,
        (cable, share): (&CableMember, f64),
        young: S,
        distance: S,
    ) {
        self.add_cable_quantity(name, over, (cable, share), CableMeasure::Stress, &[young, distance]);
    }

    fn add_cable_quantity(
        &mut self,
        name: &str,
        over: Over,
        (cable, share): (&CableMember, f64),
        measure: CableMeasure,
        own: &[S],
    ) {
        if !(0.0..=1.0).contains(&share) {
            let of = &cable.name;
            self.mistakes.push(format!("\"{name}\" asks for {share} of the length of \"{of}\"; shares are 0 to 1"));
            return;
        }
        let places = places_at(share, cable.elements.len(), [0.0, 1.0]);
        let (mut nodes, mut p) = (Vec::new(), Vec::new());
        for &(element, _) in &places {
            // a cable that was refused has been reported already
            let Some(&id) = cable.elements.get(element) else { return };
            let Some(length) = self.first_parameters(name, id, 1) else { return };
            nodes.extend_from_slice(&cable.nodes[element..element + 2]);
            p.extend(length);
        }
        p.extend_from_slice(own);
        let places = places.into_iter().map(|(_, xi)| xi).collect();
        let quantity = CableQuantity { measure, strain: cable.strain, places };
        self.add_functional(name, over, (&nodes, &[]), quantity.into(), &p);
    }

    /// A smooth maximum over time and length of the axial stress of a cable, tension or compression [N/m2], in fibres at a distance
    /// `distance` \[m\] from the axis, for Young's modulus `young` [N/m2] and a sharpness [m2/N]; the mean over time is taken as in
    /// [`Over::smooth_maximum`], so that it does not depend on the unit of time.
    pub fn largest_cable_stress_functional(
        &mut self,
        name: &str,
        cable: &CableMember,
        young: S,
        distance: S,
        sharpness: f64,
    ) {
        let elements = cable.elements.len();
        // a cable that was refused has been reported already
        let Some(&first) = cable.elements.first() else { return };
        let Some(length) = self.first_parameters(name, first, 1) else { return };
        let p = [length[0], young, distance];
        let over = Over::smooth_maximum(sharpness);
        let quantity = CableLargestStress { strain: cable.strain, elements, sharpness };
        self.add_functional(name, over, (&cable.nodes, &[]), quantity.into(), &p);
    }
}
