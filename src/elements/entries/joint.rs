use super::keys::{Form, Key};
use super::{Given, Sample, Values};
use crate::elements::forces::Soft;
use crate::elements::{AnyConstraint, AnyElement, Constraint, NodeKind};
use crate::program::Recorded;
use crate::scalar::{Complex64, Quaternion, Scalar, Tangents, Vector3};
use std::any::Any;

/// A joint or motion driver with all that is said of it beside its equations.
pub trait JointEntry: 'static {
    /// Its equations.
    type Law: Constraint;
    /// What scene files and programs call it: the word for its `type`.
    const NAME: &'static str;
    /// What it does, in a sentence without a full stop; b and a are its nodes.
    const DOC: &'static str;
    /// Its keys, that of its nodes first.
    const KEYS: &'static [Key];
    /// An example: nodes, and the values of its keys but the nodes.
    const EXAMPLE: (&'static [NodeKind], &'static [(&'static str, Sample)]);

    /// The law and its parameters, from the nodes where they stand and the values of the keys.
    fn make<S: Scalar>(given: &mut Given<S>) -> (Self::Law, Vec<S>);
}

/// A law with its type erased, to be held exactly or softly.
pub trait Law {
    /// Equations that hold.
    fn rigid(self: Box<Self>) -> Box<dyn AnyConstraint>;
    /// Springs and dampers in place of the equations.
    fn soft(self: Box<Self>) -> Box<dyn AnyElement>;
    /// Number of equations.
    fn equations(&self) -> usize;
}

impl<C: Constraint> Law for C {
    fn rigid(self: Box<Self>) -> Box<dyn AnyConstraint> {
        self
    }
    fn soft(self: Box<Self>) -> Box<dyn AnyElement> {
        Box::new(Soft(*self))
    }
    fn equations(&self) -> usize {
        Constraint::equations(self)
    }
}

/// A law with its parameters.
pub type Made<S> = (Box<dyn Law>, Vec<S>);

/// What is done with every entry of a list, each with its own type.
pub trait JointVisitor {
    /// Does it with one.
    fn visit<J: JointEntry>(&mut self);
}

/// Lists of entries, and a function that visits all of them.
macro_rules! entries {
    ($($(#[$doc:meta])* $list:ident: $($joint:ty),*;)*) => {
        $($(#[$doc])* pub const $list: &[$crate::elements::entries::JointPart] =
            &[$($crate::elements::entries::JointPart::of::<$joint>()),*];)*

        /// Visits every joint and driver.
        pub fn visit_all(visitor: &mut impl $crate::elements::entries::JointVisitor) {
            $($(visitor.visit::<$joint>();)*)*
        }
    };
}
pub(crate) use entries;

/// An entry of a list of joints.
#[derive(Clone, Copy, Debug)]
pub struct JointPart {
    /// Name, sentence and keys.
    pub form: Form,
    /// Nodes and values of the example.
    pub example: (&'static [NodeKind], &'static [(&'static str, Sample)]),
    make: fn(&mut dyn Any) -> Option<Box<dyn Any>>,
}

/// In one of the scalars in which mechanisms are built.
fn make<J: JointEntry, S: Scalar>(given: &mut dyn Any) -> Option<Box<dyn Any>> {
    let (law, p) = J::make(given.downcast_mut::<Given<S>>()?);
    Some(Box::new((Box::new(law) as Box<dyn Law>, p)))
}

impl JointPart {
    /// The entry of a joint.
    pub const fn of<J: JointEntry>() -> Self {
        JointPart {
            form: Form { name: J::NAME, doc: J::DOC, keys: J::KEYS },
            example: J::EXAMPLE,
            make: |given| {
                make::<J, f64>(given)
                    .or_else(|| make::<J, Recorded>(given))
                    .or_else(|| make::<J, Complex64>(given))
                    .or_else(|| make::<J, Tangents>(given))
            },
        }
    }

    /// The law and its parameters.
    ///
    /// # Errors
    /// A scalar in which no mechanism is built.
    pub fn make<S: Scalar>(&self, given: &mut Given<S>) -> Result<Made<S>, String> {
        let made = (self.make)(given).and_then(|made| made.downcast::<Made<S>>().ok());
        let scalar = std::any::type_name::<S>;
        made.map(|made| *made).ok_or_else(|| format!("a {} is not made in numbers of type {}", self.form.name, scalar()))
    }

    /// Values of the keys of the example, with its frame at a place \[m\] and turned.
    pub fn example_values<S: Scalar>(&self, origin: Vector3<S>, turn: Quaternion<S>) -> Values<S> {
        self.example.1.iter().map(|(key, sample)| (*key, sample.placed(origin, turn))).collect()
    }
}

/// Forms of a section of scene files, of a list of entries and what follows it.
pub const fn joint_forms<const N: usize>(parts: &[JointPart], rest: &[Form]) -> [Form; N] {
    let mut forms = [Form { name: "", doc: "", keys: &[] }; N];
    assert!(N == parts.len() + rest.len());
    let mut place = 0;
    while place < N {
        forms[place] = if place < parts.len() { parts[place].form } else { rest[place - parts.len()] };
        place += 1;
    }
    forms
}
