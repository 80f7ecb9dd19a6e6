use crate::elements::entries::{Entry, Form, Forms, JointPart, Kind, MadeEntry, Part, SpringPart, named};
use crate::elements::forces::SPRINGS;
use crate::elements::joints::JOINTS;
use crate::elements::{Constraint, Element};
use crate::functionals::quantities::QUANTITIES;
use crate::functionals::{Quantity, QuantityPart};

/// Parts of one's own, which scene files have by their names beside those of the library:
/// `OwnParts::default().joint::<Wire>().spring::<Muscle>().functional::<Clearance>()`.
#[derive(Clone, Debug, Default)]
pub struct OwnParts {
    joints: Vec<JointPart>,
    springs: Vec<SpringPart>,
    functionals: Vec<QuantityPart>,
}

impl OwnParts {
    /// With a joint: a form of `[[joint]]`.
    #[must_use]
    pub fn joint<J: Entry<Law: Constraint>>(mut self) -> Self {
        self.joints.push(JointPart::of::<J>());
        self
    }

    /// With a spring or any other element between nodes: a form of `[[spring]]`.
    #[must_use]
    pub fn spring<E: Entry<Law: Element>>(mut self) -> Self {
        self.springs.push(SpringPart::of::<E>());
        self
    }

    /// With a quantity: a form of `[[functional]]`.
    #[must_use]
    pub fn functional<Q: Entry<Law: Quantity>>(mut self) -> Self {
        self.functionals.push(QuantityPart::of::<Q>());
        self
    }

    /// With a joint whose entry is made while the program runs.
    #[must_use]
    pub fn joint_by<J: MadeEntry<Law: Constraint>>(mut self, entry: &'static J) -> Self {
        self.joints.push(JointPart::by(entry));
        self
    }

    /// The same with a spring or any other element.
    #[must_use]
    pub fn spring_by<E: MadeEntry<Law: Element>>(mut self, entry: &'static E) -> Self {
        self.springs.push(SpringPart::by(entry));
        self
    }

    /// The same with a quantity.
    #[must_use]
    pub fn functional_by<Q: MadeEntry<Law: Quantity>>(mut self, entry: &'static Q) -> Self {
        self.functionals.push(QuantityPart::by(entry));
        self
    }

    pub(crate) fn forms(&self, kind: Kind) -> Vec<Form> {
        match kind {
            Kind::Joint => forms(&self.joints),
            Kind::Spring => forms(&self.springs),
            Kind::Functional => forms(&self.functionals),
        }
    }

    pub(super) fn joint_named(&self, name: &str) -> Option<&JointPart> {
        named(JOINTS, name).or_else(|| named(&self.joints, name))
    }
    pub(super) fn spring_named(&self, name: &str) -> Option<&SpringPart> {
        named(SPRINGS, name).or_else(|| named(&self.springs, name))
    }
    pub(super) fn quantity_named(&self, name: &str) -> Option<&QuantityPart> {
        named(QUANTITIES, name).or_else(|| named(&self.functionals, name))
    }
}

fn forms<L: ?Sized>(parts: &[Part<L>]) -> Vec<Form> {
    parts.iter().map(|part| part.form).collect()
}

pub(super) fn all_forms(forms: &Forms, own: &OwnParts) -> Vec<Form> {
    [forms.forms.to_vec(), forms.own.map(|kind| own.forms(kind)).unwrap_or_default()].concat()
}
