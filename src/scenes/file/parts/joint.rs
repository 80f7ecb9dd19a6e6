//! Joints, and drivers, which prescribe motions.

use crate::elements::entries::{JointPart, Kind};
use crate::elements::forces::Soft;
use crate::elements::joints::{DRIVERS, JOINTS, ROLLING};
use crate::elements::{Constraint, NodeKind, Parameter};
use crate::scenes::file::describing::*;

const BY_FORMULA: Form = Form {
    name: "formula",
    doc: "formulas of the places of its nodes, and of the time, that are zero",
    keys: &[
        NODES,
        DEFINITIONS,
        OWN_TABLES,
        need("equations", at_least(1, &OfNodes("m, rad")), "what is zero, as in [\"norm(b.position - a.position) - 0.5\"]"),
        BREAKPOINTS,
    ],
};
const FORMS: [Form; JOINTS.len() + 1 + ROLLING.forms.len()] =
    joined(&[&forms_of::<{ JOINTS.len() }, _>(JOINTS), &[BY_FORMULA], ROLLING.forms]);

/// What makes springs of a joint.
const SOFT: [Key; 2] = [
    may(
        "stiffness",
        at_least(1, &Number("N/m, N m/rad", Any)),
        "of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid",
    ),
    may("damping", at_least(1, &Number("N s/m, N m s/rad", Any)), "of a soft joint, of each of its equations; 0"),
];

const PRESENT: Key = may("present", Flag, "whether it is there at the start: an event may lock it later; true");

const STRENGTH: Key = may(
    "strength",
    Number("N, N m", Positive),
    "size of its force, or of its moment where it has no forces, beyond which it opens for good; none",
);

pub(super) const JOINT: Section = Section {
    forms: Forms { common: &[NAME, SOFT[0], SOFT[1], PRESENT, STRENGTH], forms: &FORMS, own: Some(Kind::Joint) },
    space: "joint",
    has_columns: true,
    build: |e, m| {
        let built = match e.context.own.joint_named(e.form) {
            Some(part) => by_entry(part, e, m),
            None if e.form == BY_FORMULA.name => by_formula(e, m),
            None => rolling(e, m),
        }?;
        let is_absent = e.has("present") && !e.flag("present");
        match built {
            Built::Joint(joint) if is_absent => m.comes_and_goes(joint, false),
            _ if is_absent => return e.wrong_key("present", "only a rigid joint comes and goes: leave this out"),
            _ => {}
        }
        match (&built, e.given("strength", Entry::number)?) {
            (Built::Joint(joint), Some(strength)) => m.joint_strength(*joint, strength),
            (_, Some(_)) => return e.wrong_key("strength", "only a rigid joint opens: leave this out"),
            _ => {}
        }
        Ok(built)
    },
    ..Section::listed("joint", "What holds nodes together. Geometry is given in the world at the start.")
};

pub(super) const DRIVER: Section = Section {
    forms: Forms { common: &[NAME], forms: &forms_of::<{ DRIVERS.len() }, _>(DRIVERS), own: None },
    space: "joint",
    has_columns: true,
    build: |e, m| named(DRIVERS, e.form).map_or(Ok(Built::Nothing), |part| by_entry(part, e, m)),
    ..Section::listed("driver", "A prescribed motion.")
};

/// Makes a joint or driver of its entry.
fn by_entry(part: &JointPart, e: Entry, m: &mut Builder) -> Result<Built> {
    let (nodes, values) = (e.different_nodes_of_part(m)?, values(e, part.form.keys)?);
    let made = match rates(e)? {
        Some([stiffness, damping]) => {
            m.soft_joint(part, e.name(), &nodes, values, [&stiffness, &damping]);
            Built::SoftJoint
        }
        None => Built::Joint(m.joint(part, e.name(), &nodes, values)),
    };
    located(made, e, m)
}

/// Stiffnesses and dampings of a soft joint.
fn rates(e: Entry) -> Result<Option<[Vec<Recorded>; 2]>> {
    let [stiffness, mut damping] = [e.series("stiffness")?, e.series("damping")?];
    match (e.has("stiffness"), e.has("damping")) {
        (false, true) => e.wrong_key("damping", "only a soft joint has damping: give it stiffness, too, or leave it out"),
        (false, false) => Ok(None),
        (true, is_damped) => {
            if !is_damped {
                damping.resize(stiffness.len(), Recorded::default());
            }
            Ok(Some([stiffness, damping]))
        }
    }
}

/// A joint by formulas that are zero.
#[derive(Hash)]
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
fn by_formula(e: Entry, m: &mut Builder) -> Result<Built> {
    let mut reading = Reading::new(e, m)?;
    for (at, own) in e.list("equations") {
        let Value::Formula(formula, _) = own else { continue };
        reading.take(at, formula, [false, true])?;
    }
    let Reading { nodes, formulas, p, .. } = reading;
    let count = formulas.all.len();
    if count > MOST_EQUATIONS {
        return e.wrong(format!("a joint has at most {MOST_EQUATIONS} equations, and these are {count}"));
    }
    Ok(match rates(e)? {
        None => Built::Joint(m.constraint(e.name(), &nodes, FormulaJoint(formulas), &p)),
        Some(own) if own.iter().any(|list| list.len() != count) => {
            let text = format!("there are {count} equations: give as many numbers for stiffness, and for damping or none");
            return e.wrong(text);
        }
        Some([stiffness, damping]) => {
            m.element(e.name(), &nodes, Soft(FormulaJoint(formulas)), &[stiffness, damping, p].concat());
            Built::SoftJoint
        }
    })
}

/// Joints that are two constraints: a contact, and what rolls.
fn rolling(e: Entry, m: &mut Builder) -> Result<Built> {
    if let Some(key) = ["stiffness", "damping"].into_iter().find(|key| e.has(key)) {
        return e.wrong_key(key, "what rolls cannot be soft: leave this out");
    }
    let (nodes, values) = (e.different_nodes(m)?, values(e, ROLLING.keys(e.form))?);
    let [_, rolling] = m.rolls(e.form, [&format!("contact of {}", e.name()), e.name()], nodes, values);
    located(Built::Joint(rolling), e, m)
}
