use super::keys::{Form, Key};
use super::{Example, Given, Values};
use crate::elements::forces::Soft;
use crate::elements::{AnyConstraint, AnyElement, Constraint, Element};
use crate::program::Recorded;
use crate::scalar::{Quaternion, Scalar, Vector3};
use std::any::{Any, type_name};
use std::fmt::{Debug, Formatter};
use std::marker::PhantomData;

/// A part with all that is said of it beside its formula: a joint or driver, a spring, damper or load, a quantity that is measured.
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

/// An entry that is made while the program runs, as for a part that another language describes.
pub trait MadeEntry: Send + Sync + 'static {
    /// Its formula.
    type Law: 'static;
    /// Name, sentence and keys.
    fn form(&self) -> Form;
    /// Its nodes, and values of its keys where there is an example.
    fn example(&self) -> Example;
    /// The formula and its parameters, as [`Entry::make`] gives them.
    fn make<S: Scalar>(&self, given: &mut Given<S>) -> (Self::Law, Vec<S>);
}

/// What a type says of itself.
struct OfType<E>(PhantomData<fn() -> E>);

impl<E: Entry> MadeEntry for OfType<E> {
    type Law = E::Law;
    fn form(&self) -> Form {
        Form { name: E::NAME, doc: E::DOC, keys: E::KEYS }
    }
    fn example(&self) -> Example {
        E::EXAMPLE
    }
    fn make<S: Scalar>(&self, given: &mut Given<S>) -> (E::Law, Vec<S>) {
        E::make(given)
    }
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

/// A formula that is held with its type erased.
pub trait Erase<L: ?Sized> {
    /// The same as an `L`.
    fn erased(self) -> Box<L>;
}

impl<C: Constraint> Erase<dyn Law> for C {
    fn erased(self) -> Box<dyn Law> {
        Box::new(self)
    }
}

impl<E: Element> Erase<dyn AnyElement> for E {
    fn erased(self) -> Box<dyn AnyElement> {
        Box::new(self)
    }
}

/// Of entries that make elements of several types.
impl Erase<dyn AnyElement> for Box<dyn AnyElement> {
    fn erased(self) -> Self {
        self
    }
}

/// A formula with its parameters.
pub type WithParameters<L, S> = (Box<L>, Vec<S>);

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

/// Lists of entries, and a function that visits all of them but those behind a bar, which make formulas of several types.
macro_rules! entries {
    ($part:ty, $visitor:path; $($(#[$doc:meta])* $list:ident: $($entry:ty),* $(| $any:ty)*;)*) => {
        $($(#[$doc])* pub const $list: &[$part] = &[$(<$part>::of::<$entry>(),)* $(<$part>::of::<$any>(),)*];)*

        /// Visits all of them.
        pub fn visit_all(visitor: &mut impl $visitor) {
            $($(visitor.visit::<$entry>();)*)*
        }
    };
}
pub(crate) use entries;

/// What an entry makes of what is given, in one of the scalars in which mechanisms are built.
type Maker = fn(&dyn Any, &mut dyn Any) -> Option<Box<dyn Any>>;

/// An entry with its type erased, which makes formulas of type `L`.
pub struct Part<L: ?Sized> {
    /// Name, sentence and keys.
    pub form: Form,
    /// Nodes and values of the example.
    pub example: Example,
    entry: &'static (dyn Any + Send + Sync),
    make: Maker,
    erased: PhantomData<fn() -> Box<L>>,
}

/// A joint or driver of a list.
pub type JointPart = Part<dyn Law>;
/// A spring, damper or load of a list.
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
fn make_in<E: MadeEntry<Law: Erase<L>>, S: Scalar, L: ?Sized + 'static>(
    entry: &E,
    given: &mut dyn Any,
) -> Option<Box<dyn Any>> {
    let (law, p) = entry.make(given.downcast_mut::<Given<S>>()?);
    Some(Box::new((law.erased(), p)))
}

/// In any of them.
fn make<E: MadeEntry<Law: Erase<L>>, L: ?Sized + 'static>(entry: &E, given: &mut dyn Any) -> Option<Box<dyn Any>> {
    make_in::<E, f64, L>(entry, given).or_else(|| make_in::<E, Recorded, L>(entry, given))
}

impl<L: ?Sized + 'static> Part<L> {
    /// The part of an entry.
    pub const fn of<E: Entry<Law: Erase<L>>>() -> Self {
        let form = Form { name: E::NAME, doc: E::DOC, keys: E::KEYS };
        let make: Maker = |_, given| make(&OfType::<E>(PhantomData), given);
        Part { form, example: E::EXAMPLE, entry: &(), make, erased: PhantomData }
    }
    /// The part of an entry that is made while the program runs; of a list of types it is [`Self::of`].
    pub fn by<E: MadeEntry<Law: Erase<L>>>(entry: &'static E) -> Self {
        let make: Maker = |entry, given| make(entry.downcast_ref::<E>()?, given);
        Part { form: entry.form(), example: entry.example(), entry, make, erased: PhantomData }
    }

    /// The formula and its parameters.
    ///
    /// # Errors
    /// A scalar in which no mechanism is built.
    pub fn make<S: Scalar>(&self, given: &mut Given<S>) -> Result<WithParameters<L, S>, String> {
        let made = (self.make)(self.entry, given).and_then(|made| made.downcast::<WithParameters<L, S>>().ok());
        let refused = || format!("a {} is not made in numbers of type {}", self.form.name, type_name::<S>());
        made.map(|made| *made).ok_or_else(refused)
    }

    /// Values of the keys of the example, with its frame at a place \[m\] and turned.
    pub fn example_values<S: Scalar>(&self, origin: Vector3<S>, turn: Quaternion<S>) -> Values<S> {
        self.example.1.iter().map(|(key, sample)| (*key, sample.placed(origin, turn))).collect()
    }
}

/// The part of a list with this name.
pub(crate) fn named<'p, L: ?Sized>(parts: &'p [Part<L>], name: &str) -> Option<&'p Part<L>> {
    parts.iter().find(|part| part.form.name == name)
}

/// The forms of as many parts.
pub const fn forms_of<const N: usize, L: ?Sized>(parts: &[Part<L>]) -> [Form; N] {
    let (mut forms, mut place) = ([Form { name: "", doc: "", keys: &[] }; N], 0);
    while place < N {
        forms[place] = parts[place].form;
        place += 1;
    }
    forms
}

/// The names of as many parts.
pub(crate) const fn names_of<const N: usize, L: ?Sized>(parts: &[Part<L>]) -> [&'static str; N] {
    let (forms, mut names, mut place) = (forms_of::<N, L>(parts), [""; N], 0);
    while place < N {
        names[place] = forms[place].name;
        place += 1;
    }
    names
}

/// Lists one after the other, as many items.
pub(crate) const fn joined<T: Copy, const N: usize>(lists: &[&[T]]) -> [T; N] {
    let (mut all, mut list, mut count) = ([lists[0][0]; N], 0, 0);
    while list < lists.len() {
        let mut place = 0;
        while place < lists[list].len() {
            all[count] = lists[list][place];
            (place, count) = (place + 1, count + 1);
        }
        list += 1;
    }
    assert!(count == N);
    all
}
