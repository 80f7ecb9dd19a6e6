//! Joints.

use crate::elements::entries::Kind;
use crate::elements::forces::Soft;
use crate::elements::joints::{JOINTS, ROLLING};
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scenes::file::build_parts::{SOFT, joint, located, rates, values};
use crate::scenes::file::describing::*;
use crate::scenes::file::formula_parts::{BREAKPOINTS, DEFINITIONS, Formulas, NODES, OWN_TABLES, Reading};

const BY_FORMULA: Form = Form {
    name: "formula",
    doc: "formulas of the places of its nodes, and of the time, that are zero",
    keys: &[
        NODES,
        DEFINITIONS,
        OWN_TABLES,
        need("equations", SeriesOfNodes("m, rad"), "what is zero, as in [\"norm(b.position - a.position) - 0.5\"]"),
        BREAKPOINTS,
    ],
};
const FORMS: [Form; JOINTS.len() + 1 + ROLLING.forms.len()] =
    joined(&[&forms_of::<{ JOINTS.len() }, _>(JOINTS), &[BY_FORMULA], ROLLING.forms]);

pub(super) const SECTION: Section = Section {
    name: "joint",
    shape: Shape::Listed,
    doc: "What holds nodes together. Geometry is given in the world at the start.",
    forms: Forms { common: &[NAME, SOFT[0], SOFT[1]], forms: &FORMS, own: Some(Kind::Joint) },
};

pub(super) fn build<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    match known.own.joint_named(item.fields.form) {
        Some(part) => joint(known, part, item, m),
        None if item.fields.form == BY_FORMULA.name => by_formula(known, item, m),
        None => rolling(known, item, m),
    }
}

/// A joint by formulas that are zero.
struct FormulaJoint(Formulas);

/// Most equations of a joint by formulas.
const MOST_EQUATIONS: usize = 12;

impl Constraint for FormulaJoint {
    const EQUATIONS: usize = MOST_EQUATIONS;

    fn nodes(&self) -> Vec<NodeKind> {
        self.0.kinds()
    }
    fn equations(&self) -> usize {
        self.0.all.len()
    }
    fn parameters(&self) -> Vec<Parameter> {
        self.0.parameters()
    }
    fn g<S: Scalar>(&self, q: &[S], p: &[S], t: S, g: &mut [S]) {
        let still = vec![S::zero(); q.len()];
        let known = self.0.arguments([&still, q], t, p);
        g.iter_mut().enumerate().for_each(|(which, own)| *own = self.0.number(which, &known, p));
    }
}

/// A joint by its equations.
fn by_formula<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let mut reading = Reading::new(known, fields, m)?;
    for (at, own) in list(fields, "equations") {
        let Value::Formula(formula, _) = own else { continue };
        reading.take(at, formula, [false, true])?;
    }
    let Reading { nodes, formulas, p, .. } = reading;
    let count = formulas.all.len();
    if count > MOST_EQUATIONS {
        return Err(Mistake::new(
            fields.at,
            format!("a joint has at most {MOST_EQUATIONS} equations, and these are {count}"),
        ));
    }
    Ok(match rates(known, fields)? {
        None => Made::Joint(m.constraint(name, &nodes, FormulaJoint(formulas), &p)),
        Some(own) if own.iter().any(|list| list.len() != count) => {
            let text = format!("there are {count} equations: give as many numbers for stiffness, and for damping or none");
            return Err(Mistake::new(fields.at, text));
        }
        Some([stiffness, damping]) => {
            m.element(name, &nodes, Soft(FormulaJoint(formulas)), &[stiffness, damping, p].concat());
            Made::SoftJoint
        }
    })
}

/// Joints that are two constraints: a contact, and what rolls.
fn rolling<S: Scalar>(known: &Known<S>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let Item { name, fields, .. } = item;
    if let Some((at, _)) = fields.get("stiffness").or(fields.get("damping")) {
        return Err(Mistake::new(at, "what rolls cannot be soft: leave this out"));
    }
    let (nodes, values) = (known.different_nodes(fields, m)?, values(known, fields, ROLLING.keys(fields.form))?);
    let made = m.rolling_part(fields.form, [&format!("contact of {name}"), name], nodes, values);
    located(made.map(|own| Made::Joint(own[1])), item, m)
}
