use super::keys::{Form, Key};
use super::{Example, Given, Values};
use crate::elements::forces::Soft;
use crate::elements::{AnyConstraint, AnyElement, Constraint, Element};
use crate::program::Recorded;
use crate::scalar::{Complex64, Quaternion, Scalar, Tangents, Vector3};
use std::any::{Any, type_name};
use std::fmt::{Debug, Formatter};

/// A part with all that is said of it beside its formula: a joint or driver, a spring or damper, a quantity that is measured.
pub trait Entry: 'static {
    /// Its formula: a [`Constraint`], an [`Element`] or a [`Quantity`](crate::functionals::Quantity).
    type Law: 'static;
    /// What scene files and programs call it: the word for its `type`.
    const NAME: &'static str;
    /// What it does, in a sentence without a full stop; b and a are its nodes.
    const DOC: &'static str;
    /// Its keys, that of its nodes first.
    const KEYS: &'static [Key];
    /// An example: nodes, and the values of its keys but the nodes.
    const EXAMPLE: Example;

    /// The formula and its parameters, from the nodes where they stand and the values of the keys.
    fn make<S: Scalar>(given: &mut Given<S>) -> (Self::Law, Vec<S>);
}

/// A joint with its type erased, to be held exactly or softly.
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

/// A formula with its parameters.
pub type Made<L, S> = (Box<L>, Vec<S>);

/// What is done with every joint and driver of the library, each with its own type.
pub trait JointVisitor {
    /// Does it with one.
    fn visit<J: Entry<Law: Constraint>>(&mut self);
}

/// What is done with every spring and damper of the library, each with its own type.
pub trait SpringVisitor {
    /// Does it with one.
    fn visit<E: Entry<Law: Element>>(&mut self);
}

/// Lists of entries, and a function that visits all of them.
macro_rules! entries {
    ($part:ty, $visitor:path; $($(#[$doc:meta])* $list:ident: $($entry:ty),*;)*) => {
        $($(#[$doc])* pub const $list: &[$part] = &[$(<$part>::of::<$entry>()),*];)*

        /// Visits all of them.
        pub fn visit_all(visitor: &mut impl $visitor) {
            $($(visitor.visit::<$entry>();)*)*
        }
    };
}
pub(crate) use entries;

/// An entry with its type erased, which makes formulas of type `L`.
pub struct Part<L: ?Sized> {
    /// Name, sentence and keys.
    pub form: Form,
    /// Nodes and values of the example.
    pub example: Example,
    make: fn(&mut dyn Any) -> Option<Box<dyn Any>>,
    erased: std::marker::PhantomData<fn() -> Box<L>>,
}

/// A joint or driver of a list.
pub type JointPart = Part<dyn Law>;
/// A spring or damper of a list.
pub type SpringPart = Part<dyn AnyElement>;

impl<L: ?Sized> Clone for Part<L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L: ?Sized> Copy for Part<L> {}

impl<L: ?Sized> Debug for Part<L> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Part").field("form", &self.form).field("example", &self.example).finish_non_exhaustive()
    }
}

/// In one of the scalars in which mechanisms are built.
fn make<E: Entry, S: Scalar, L: ?Sized + 'static>(given: &mut dyn Any, erase: fn(E::Law) -> Box<L>) -> Option<Box<dyn Any>> {
    let (law, p) = E::make(given.downcast_mut::<Given<S>>()?);
    Some(Box::new((erase(law), p)))
}

/// In any of them.
pub(crate) fn make_in_any<E: Entry, L: ?Sized + 'static>(
    given: &mut dyn Any,
    erase: fn(E::Law) -> Box<L>,
) -> Option<Box<dyn Any>> {
    make::<E, f64, L>(given, erase)
        .or_else(|| make::<E, Recorded, L>(given, erase))
        .or_else(|| make::<E, Complex64, L>(given, erase))
        .or_else(|| make::<E, Tangents, L>(given, erase))
}

impl JointPart {
    /// The entry of a joint.
    pub const fn of<J: Entry<Law: Constraint>>() -> Self {
        Part::new::<J>(|given| make_in_any::<J, dyn Law>(given, |law| Box::new(law)))
    }
}

impl SpringPart {
    /// The entry of a spring or damper.
    pub const fn of<E: Entry<Law: Element>>() -> Self {
        Part::new::<E>(|given| make_in_any::<E, dyn AnyElement>(given, |law| Box::new(law)))
    }
}

impl<L: ?Sized + 'static> Part<L> {
    pub(crate) const fn new<E: Entry>(make: fn(&mut dyn Any) -> Option<Box<dyn Any>>) -> Self {
        let form = Form { name: E::NAME, doc: E::DOC, keys: E::KEYS };
        Part { form, example: E::EXAMPLE, make, erased: std::marker::PhantomData }
    }

    /// The formula and its parameters.
    ///
    /// # Errors
    /// A scalar in which no mechanism is built.
    pub fn make<S: Scalar>(&self, given: &mut Given<S>) -> Result<Made<L, S>, String> {
        let made = (self.make)(given).and_then(|made| made.downcast::<Made<L, S>>().ok());
        let refused = || format!("a {} is not made in numbers of type {}", self.form.name, type_name::<S>());
        made.map(|made| *made).ok_or_else(refused)
    }

    /// Values of the keys of the example, with its frame at a place \[m\] and turned.
    pub fn example_values<S: Scalar>(&self, origin: Vector3<S>, turn: Quaternion<S>) -> Values<S> {
        self.example.1.iter().map(|(key, sample)| (*key, sample.placed(origin, turn))).collect()
    }
}

/// Forms of a section of scene files, of a list of entries and what follows it.
pub const fn forms_of<const N: usize, L: ?Sized>(parts: &[Part<L>], rest: &[Form]) -> [Form; N] {
    let mut forms = [Form { name: "", doc: "", keys: &[] }; N];
    assert!(N == parts.len() + rest.len());
    let mut place = 0;
    while place < N {
        forms[place] = if place < parts.len() { parts[place].form } else { rest[place - parts.len()] };
        place += 1;
    }
    forms
}
