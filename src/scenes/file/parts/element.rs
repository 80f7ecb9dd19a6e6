//! Parts of one's own, by formulas.

use crate::elements::{Element, NodeKind, Output, Parameter};
use crate::scenes::file::describing::*;
use crate::scenes::file::formula::Quantity;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        NODES,
        DEFINITIONS,
        OWN_TABLES,
        may("kinetic", Type::OfNodes("J"), "kinetic energy, of places and rates; none"),
        may("potential", Type::OfNodes("J"), "potential energy, of places; none"),
        may(
            "force",
            Type::NamedFormulas("N, N m"),
            "forces on its nodes in the world, of anything; of a joint angle its moment; none"
        ),
        may("moment", Type::NamedFormulas("N m"), "moments on bodies among them in the world, of anything; none"),
        BREAKPOINTS,
    ],
    space: "force",
    has_columns: true,
    build,
    ..Section::listed(
        "element",
        "A part of one's own, by formulas of what its nodes do. Of a node called a in `nodes` these know a.position and a.velocity [m, m/s], \
          of one with axes a.x_axis, a.y_axis, a.z_axis and a.angular_velocity [rad/s], all in the world; of a joint angle a.value and \
          a.rate, of a state a.NAME of its values and outputs; and the time t.",
    )
};

/// An element by formulas: numbers of its energies among them, and of the loads on each node.
#[derive(Hash)]
struct FormulaElement {
    formulas: Formulas,
    kinetic: Option<usize>,
    potential: Option<usize>,
    /// Node, whether it is a moment, number of the formula.
    loads: Vec<(usize, bool, usize)>,
    /// What histories tell: all formulas.
    outputs: Vec<Output>,
}

impl Element for FormulaElement {
    fn nodes(&self) -> Vec<NodeKind> {
        self.formulas.kinds()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.formulas.parameters()
    }
    fn kinetic<S: Scalar>(&self, v: &[S], q: &[S], p: &[S]) -> S {
        let Some(which) = self.kinetic else { return S::zero() };
        self.formulas.number(which, &self.formulas.arguments([v, q], S::zero(), p), p)
    }
    fn potential<S: Scalar>(&self, q: &[S], p: &[S]) -> S {
        let Some(which) = self.potential else { return S::zero() };
        let still = vec![S::zero(); q.len()];
        self.formulas.number(which, &self.formulas.arguments([&still, q], S::zero(), p), p)
    }
    fn add_force<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, force: &mut [S]) {
        if self.loads.is_empty() {
            return;
        }
        let known = self.formulas.arguments([v, q], t, p);
        for &(node, is_moment, which) in &self.loads {
            let (kind, place) = (self.formulas.nodes[node].kind, self.formulas.place(node));
            let (q, force) = (&q[place.clone()], &mut force[place]);
            match self.formulas.value(which, &known, p) {
                Quantity::Number(own) => force[0] += own,
                Quantity::Vector(own) if is_moment => kind.add_moment(q, own, force),
                Quantity::Vector(own) => kind.add_force(q, self.formulas.point(node, p), own, force),
            }
        }
    }
    fn outputs(&self) -> Vec<Output> {
        self.outputs.clone()
    }
    fn write_outputs<S: Scalar>(&self, v: &[S], q: &[S], p: &[S], t: S, outputs: &mut [S]) {
        let known = self.formulas.arguments([v, q], t, p);
        outputs.iter_mut().zip(self.formulas.numbers(&known, p)).for_each(|(output, own)| *output = own);
    }
}

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let mut reading = Reading::new(e, m)?;
    let kinetic = reading.take_key(e, "kinetic", [true, false])?;
    let potential = reading.take_key(e, "potential", [false, false])?;
    let energies = [("kinetic", kinetic), ("potential", potential)].into_iter().filter(|own| own.1.is_some());
    let mut outputs: Vec<Output> = energies.flat_map(|(name, _)| outputs_of(name, "J", false)).collect();
    let mut loads = Vec::new();
    for (key, is_moment) in [("force", false), ("moment", true)] {
        let Some((_, Value::Formulas(given))) = e.get(key) else { continue };
        for (of, at, formula) in given {
            let Some(node) = reading.names.iter().position(|name| name == of) else {
                return Err(Mistake::new(*at, format!("there is no \"{of}\" among the nodes")));
            };
            let KnownNode { kind, .. } = reading.formulas.nodes[node];
            if kind.is_of_states() {
                return Err(Mistake::new(*at, format!("\"{of}\" is a state: its own section says how it changes")));
            }
            let wants_vector = kind.in_space().is_some();
            if wants_vector != formula.is_vector() || (is_moment && !kind.has_axes()) {
                let wanted = match (is_moment, wants_vector) {
                    (true, _) if !kind.has_axes() => "no moment",
                    (_, true) => "a vector",
                    _ => "a number",
                };
                return Err(Mistake::new(*at, format!("\"{of}\" is {}, which takes {wanted} here", kind.words())));
            }
            let (what, unit) = if is_moment { ("moment", "N m") } else { ("force", if wants_vector { "N" } else { "" }) };
            outputs.extend(outputs_of(&format!("{of}.{what}"), unit, formula.is_vector()));
            loads.push((node, is_moment, reading.take(*at, formula, [true, true])?));
        }
    }
    if kinetic.is_none() && potential.is_none() && loads.is_empty() {
        return e.wrong("an element needs kinetic, potential, force or moment");
    }
    let Reading { nodes, formulas, p, .. } = reading;
    m.element(e.name(), &nodes, FormulaElement { formulas, kinetic, potential, loads, outputs }, &p);
    Ok(Built::Nothing)
}
