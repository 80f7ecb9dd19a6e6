//! The columns of the histories: what stands in them, and their names.

use costate::assembly::{Attached, Model, Node};
use costate::elements::{ElementPhysics, NodeKind, Output};
use costate::functionals::{Functional, Measured, Sample};
use costate::scalar::SpatialVector;
use costate::scenes::{JointEnd, Prepared, unknown};

/// Who has the column of the energy.
const ENERGY: &str = "energy";
const DIRECTIONS: [&str; 3] = ["x", "y", "z"];

/// Time, coordinates, their rates, angular velocities, accelerations, energy, what springs, dampers, elements and states tell, multipliers and loads of joints, what functionals measure.
pub struct Columns<'p> {
    prepared: &'p Prepared<'p>,
    /// Whether every element states its energy.
    energies: bool,
    ends: Vec<JointEnd>,
    /// What springs, dampers, elements and states tell, each with its element.
    pub outputs: Vec<(&'p str, Output)>,
}

/// A column: whose it is, and what it is called.
struct Column {
    owner: String,
    name: String,
}

impl<'p> Columns<'p> {
    pub fn new(prepared: &'p Prepared<'p>) -> Self {
        let energies = prepared.model().elements.iter().all(|element| element.physics.has_energies());
        let elements = prepared.model().elements.iter();
        let told = elements.flat_map(|element| element.physics.outputs().into_iter().map(|own| (&*element.name, own)));
        Columns { prepared, energies, ends: prepared.mechanism.joint_ends(), outputs: told.collect() }
    }

    /// Nodes whose coordinates have columns: those that move, but states whose values are told by their names.
    pub fn nodes(&self) -> impl Iterator<Item = &'p Node> {
        let model = self.prepared.model();
        let is_told = |node: &Node| node.kind.is_of_states() && self.outputs.iter().any(|own| own.0 == node.name);
        let told: Vec<usize> = model.nodes.iter().filter(|node| is_told(node)).map(|node| node.dofs.start).collect();
        moving(model).filter(move |node| !told.contains(&node.dofs.start))
    }

    /// Whether a name is that of states.
    pub fn is_state(&self, name: &str) -> bool {
        let model = self.prepared.model();
        model.nodes.iter().any(|node| node.kind.is_of_states() && node.name == name)
    }

    /// What springs, dampers, elements and states tell at a sample.
    pub fn outputs_at(&self, sample: &Sample<f64>) -> Vec<f64> {
        let (model, p) = (self.prepared.model(), &self.prepared.mechanism.numbers.p);
        let telling = model.elements.iter().filter(|element| !element.physics.outputs().is_empty());
        let of = |element: &Attached<ElementPhysics>| {
            let own =
                |x: &[f64]| element.nodes.iter().flat_map(|&id| x[model.node(id).dofs.clone()].to_vec()).collect::<Vec<_>>();
            element.physics.outputs_at([&own(&sample.at.v), &own(&sample.at.q)], &p[element.parameters.clone()], sample.t)
        };
        telling.flat_map(of).collect()
    }

    pub fn have_energy(&self) -> bool {
        self.energies
    }

    /// Their names: `bob.x [m]`, `bob.dx/dt [m/s]`, `bar.omega_x [rad/s]`, `bob.d2x/dt2 [m/s2]`, energy, `spring.force [N]`, `controller.output`, `rod.mu1`, `rod.force_x [N]`,
    /// `hinge.moment_x [N m]`, then what functionals measure.
    pub fn names(&self) -> Vec<String> {
        self.all().into_iter().map(|column| column.name).collect()
    }

    fn all(&self) -> Vec<Column> {
        let model = self.prepared.model();
        let column = |owner: &str, name: String| Column { owner: owner.into(), name };
        let of = |owner: &str, what: String| column(owner, format!("{owner}.{what}"));
        let mut all = vec![column("", "t [s]".into())];
        for rate in [false, true] {
            for node in self.nodes() {
                all.extend((0..node.dofs.len()).map(|index| of(&node.name, coordinate_name(node, index, rate))));
            }
        }
        for node in turning(self.prepared) {
            all.extend(DIRECTIONS.map(|direction| of(&node.name, format!("omega_{direction} [rad/s]"))));
        }
        for node in self.nodes() {
            all.extend((0..accelerated(node)).map(|index| of(&node.name, acceleration_name(node, index))));
        }
        if self.energies {
            all.push(column(ENERGY, "energy [J]".into()));
        }
        for (owner, Output { name, unit }) in &self.outputs {
            let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
            all.push(of(owner, format!("{name}{unit}")));
        }
        for joint in &model.constraints {
            all.extend((1..=joint.equations.len()).map(|row| of(&joint.name, format!("mu{row}"))));
        }
        for end in &self.ends {
            let name = &model.constraints[end.joint].name;
            all.extend(DIRECTIONS.map(|direction| of(name, format!("force_{direction} [N]"))));
            if end.turns {
                all.extend(DIRECTIONS.map(|direction| of(name, format!("moment_{direction} [N m]"))));
            }
        }
        let measured = courses(self.prepared);
        all.extend(measured.map(|own| column(&own.name, format!("measured for {} [{}]", own.name, own.unit))));
        all
    }

    /// The places of the time and of what some names stand for; of all columns if there are no names.
    pub fn chosen(&self, names: &[String]) -> Result<Vec<usize>, String> {
        let all = self.all();
        if names.is_empty() {
            return Ok((0..all.len()).collect());
        }
        let mut chosen = vec![0];
        for name in names {
            let owner = self.node_at_end(name).unwrap_or_else(|| name.replace(' ', ""));
            let is_of = |column: &Column| {
                let rest = column.owner.strip_prefix(name.as_str());
                column.owner.replace(' ', "") == owner || rest.is_some_and(|rest| rest.starts_with(['[', ',']))
            };
            let before = chosen.len();
            chosen.extend((1..all.len()).filter(|&place| is_of(&all[place])));
            if chosen.len() == before {
                let mut known: Vec<String> = all.into_iter().skip(1).map(|column| column.owner).collect();
                known.dedup();
                return Err(unknown("history", name, &known));
            }
        }
        chosen.sort_unstable();
        chosen.dedup();
        Ok(chosen)
    }

    /// The node that `beam.start` or `beam.end` is.
    fn node_at_end(&self, name: &str) -> Option<String> {
        let node = self.prepared.mechanism.node_at_end(name)?;
        Some(self.prepared.model().node(node).name.replace(' ', ""))
    }

    /// Joints whose loads have columns.
    pub fn loaded_joints(&self) -> impl Iterator<Item = &'p str> {
        let model = self.prepared.model();
        self.ends.iter().map(|end| model.constraints[end.joint].name.as_str())
    }

    /// Sizes of the force and the moment of each joint in a row; no moment where its node cannot turn.
    pub fn loads(&self, row: &[f64]) -> Vec<[f64; 2]> {
        let size = |vector: &[f64]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let columns: usize = self.ends.iter().map(|end| if end.turns { 6 } else { 3 }).sum();
        let mut rest = &row[row.len() - courses(self.prepared).count() - columns..];
        let mut next = |count: usize| {
            let (own, others) = rest.split_at(count);
            rest = others;
            size(own)
        };
        self.ends.iter().map(|end| [next(3), next(if end.turns { 3 } else { 0 })]).collect()
    }

    /// Adds what stands in them at a sample to a row.
    pub fn add_row(&self, sample: &Sample<f64>, energy: Option<f64>, outputs: &[f64], row: &mut Vec<f64>) {
        let (model, p) = (self.prepared.model(), &self.prepared.mechanism.numbers.p);
        let [a, v, q] = [&sample.at.a, &sample.at.v, &sample.at.q];
        row.push(sample.t);
        for own in [q, v] {
            row.extend(self.nodes().flat_map(|node| &own[node.dofs.clone()]));
        }
        for node in turning(self.prepared) {
            let own = node.kind.angular_velocity(&v[node.dofs.clone()], &q[node.dofs.clone()]);
            row.extend(own.components());
        }
        for node in self.nodes() {
            row.extend(&a[node.dofs.clone()][..accelerated(node)]);
        }
        row.extend(energy);
        row.extend(outputs);
        row.extend(&sample.mu);
        for end in &self.ends {
            let [force, moment] = self.prepared.mechanism.joint_load(end, (q, &sample.mu), sample.t);
            row.extend(force);
            if end.turns {
                row.extend(moment);
            }
        }
        row.extend(courses(self.prepared).map(|functional| functional.measured_at(model, sample, p)));
    }
}

fn turning<'p>(prepared: &'p Prepared) -> impl Iterator<Item = &'p Node> {
    moving(prepared.model()).filter(|node| node.kind.has_axes())
}

/// Coordinates of a node whose accelerations have a column: those of its place, or all of a node without one.
fn accelerated(node: &Node) -> usize {
    if node.kind.in_space().is_none() { node.dofs.len() } else { 3 }
}

/// A coordinate or its rate, without the node.
fn coordinate_name(node: &Node, index: usize, rate: bool) -> String {
    let (coordinate, unit, per_second) = match (node.kind, index) {
        (NodeKind::Coordinates(_) | NodeKind::States(_), index) => (format!("q{index}"), "", ""),
        (kind, 0..3) => (kind.coordinate_name(index), " [m]", " [m/s]"),
        (kind, _) => (kind.coordinate_name(index), " [-]", " [1/s]"),
    };
    if rate { format!("d{coordinate}/dt{per_second}") } else { format!("{coordinate}{unit}") }
}

fn acceleration_name(node: &Node, index: usize) -> String {
    match node.kind {
        NodeKind::Coordinates(_) | NodeKind::States(_) => format!("d2q{index}/dt2"),
        kind => format!("d2{}/dt2 [m/s2]", kind.coordinate_name(index)),
    }
}

/// Nodes that can move.
pub fn moving(model: &Model) -> impl Iterator<Item = &Node> {
    model.nodes.iter().filter(|node| !node.fixed)
}

/// Functionals whose measured quantity has a course in time: coordinates, rates and loads of joints, places, reactions.
pub fn courses<'p>(prepared: &'p Prepared) -> impl Iterator<Item = &'p Functional> {
    let has = |functional: &&Functional| match &functional.measured {
        Measured::Energy(_) => false,
        Measured::Group(group) => group.is_moving(prepared.model()),
        _ => true,
    };
    prepared.functionals().iter().filter(has)
}
