//! Parts by their entries.

use super::MechanismBuilder;
use crate::assembly::{ElementId, NodeId};
use crate::elements::entries::{Given, Part, SpringPart, Type, Values, WithParameters, named};
use crate::scalar::Scalar;

/// An entry of a list of the library.
pub(super) fn entry<L: ?Sized>(list: &'static [Part<L>], name: &str) -> &'static Part<L> {
    named(list, name).unwrap_or_else(|| unreachable!("{name} is in no list of entries"))
}

/// Methods that add parts of a list by their entries: the name of the entry, arguments, what nodes it is on, and the arguments that are keys.
macro_rules! methods_by_entry {
    ($list:ident.$add:ident -> $id:ty;
     $($(#[$doc:meta])* $method:ident $entry:literal ($($argument:tt: $type:ty),*) on $($on:expr),* => $($key:ident),*;)*) => {
        #[allow(unused_parens)]
        impl<S: Scalar> MechanismBuilder<S> {$(
            $(#[$doc])*
            pub fn $method(&mut self, name: &str $(, $argument: $type)*) -> $id {
                self.$add(entry($list, $entry), name, $($on,)* [$((stringify!($key), $key.into())),*])
            }
        )*}
    };
}
pub(super) use methods_by_entry;

impl<S: Scalar> MechanismBuilder<S> {
    /// What an entry, or what is like one, makes its parameters of.
    pub(in crate::scenes) fn given(&self, name: &str, nodes: &[NodeId], values: Values<S>) -> Given<S> {
        let placed = nodes.iter().filter_map(|&node| Some((&*self.model.find_node(node)?.name, self.placed(node)?)));
        Given::new(name, placed, values)
    }

    /// The formula and parameters of a part by its entry; what is wrong is kept with the other mistakes.
    pub(super) fn build_part<L: ?Sized + 'static>(
        &mut self,
        part: &Part<L>,
        name: &str,
        nodes: &[NodeId],
        values: Values<S>,
    ) -> Option<WithParameters<L, S>> {
        if nodes.iter().any(|&node| self.kind_of(name, node).is_none()) {
            return None;
        }
        let count = part.example.0.len();
        let is_on_elements = part.form.keys.first().is_some_and(|key| matches!(key.takes, Type::Item(_)));
        if nodes.len() != count && !is_on_elements {
            self.mistakes.push(format!("\"{name}\" needs {count} nodes, but {} were given", nodes.len()));
            return None;
        }
        let keys = part.form.keys.iter().filter(|key| !key.takes.is_nodes()).map(|key| key.name);
        let known: Vec<&str> = keys.collect();
        let unknown = values.iter().filter(|(key, _)| !known.contains(key));
        let mut wrong: Vec<(Option<&'static str>, String)> = unknown
            .map(|(key, _)| {
                (None, format!("\"{name}\", a {}, has no key {key}: it has {}", part.form.name, known.join(", ")))
            })
            .collect();
        let mut given = self.given(name, nodes, values);
        let made = part.make(&mut given);
        wrong.extend(given.mistakes());
        let made = made.map_err(|why| wrong = vec![(None, format!("\"{name}\": {why}"))]).ok().filter(|_| wrong.is_empty());
        self.keep_mistakes(name, wrong);
        made
    }

    /// Adds a spring or damper by its entry, one of a list or of your own: `m.spring(&SpringPart::of::<MySpring>(), "name", &[a, b], keys)`.
    pub fn spring(&mut self, part: &SpringPart, name: &str, nodes: &[NodeId], keys: impl Into<Values<S>>) -> ElementId {
        match self.build_part(part, name, nodes, keys.into()) {
            Some((law, p)) => self.add_element(name, nodes, law, &p),
            None => self.model.refused_element(),
        }
    }

    /// Keeps mistakes, those in values of keys apart.
    pub(super) fn keep_mistakes(&mut self, name: &str, wrong: Vec<(Option<&'static str>, String)>) {
        for (key, text) in wrong {
            match key {
                Some(key) => self.wrong_keys.push((name.into(), key, text)),
                None => self.mistakes.push(text),
            }
        }
    }
}
