//! What parts are made of by their entries: the values of keys as numbers.

use super::entry_context::{Builder, Built, Entry, Result};
use super::mistake::Mistake;
use crate::elements::entries::{Forms, Given, GivenValue, Key, Type, Values};
use crate::program::Recorded;

fn value(e: Entry, key: &Key) -> Result<GivenValue<Recorded>> {
    Ok(match key.takes {
        Type::Number(..) => GivenValue::Number(e.number(key.name)?),
        Type::Numbers(..) => GivenValue::Numbers(e.series(key.name)?),
        Type::Vector(_) => GivenValue::Vector(e.vector(key.name)?),
        Type::List(Type::Vector(_), ..) => GivenValue::Vectors(e.points(key.name)?),
        Type::Choice(_) => GivenValue::Word(e.text(key.name).unwrap_or_default().into()),
        Type::Function(..) => {
            let (function, numbers) = e.function(key.name)?.parts().or_else(|why| e.wrong_key(key.name, why))?;
            GivenValue::Function(function, numbers)
        }
        Type::Law(..) | Type::Energy(..) => {
            let (law, numbers) = e.law(key.name)?;
            GivenValue::Law(law, numbers)
        }
        Type::Count(..) => GivenValue::Count(e.count(key.name)),
        Type::Table(_) if key.name == "orientation" => GivenValue::Rotation(e.orientation()?),
        _ => return e.wrong(format!("the entry of this part has a key {} of a type that no entry can have", key.name)),
    })
}

/// Values of the keys that are given but the nodes.
pub(super) fn values(e: Entry, keys: impl IntoIterator<Item = &'static Key>) -> Result<Values<Recorded>> {
    let given = keys.into_iter().filter(|key| !key.takes.is_nodes() && e.has(key.name));
    given.map(|key| Ok((key.name, value(e, key)?))).collect()
}

/// What `make` builds from the values of keys; of a mistake, its place in the file.
pub(super) fn built_from<T>(
    e: Entry,
    mut given: Given<Recorded>,
    make: impl FnOnce(&mut Given<Recorded>) -> T,
) -> Result<T> {
    let built = make(&mut given);
    match given.mistakes().into_iter().next() {
        Some((Some(key), _)) if !e.has(key) => e.wrong(format!("the key {key} is needed here")),
        Some((key, what)) => e.wrong_key(key.unwrap_or_default(), what),
        None => Ok(built),
    }
}

/// The values of keys of some forms, for what has no nodes.
pub(super) fn given(e: Entry, forms: &Forms) -> Result<Given<Recorded>> {
    Ok(Given::new("", [], values(e, forms.keys(e.form))?))
}

/// What was built of an entry, or where in the file what is wrong stands.
pub(super) fn located(built: Built, e: Entry, m: &mut Builder) -> Result<Built> {
    match (m.take_wrong_keys().into_iter().next(), built) {
        (Some((_, key, what)), _) => Err(Mistake::new(e.place(key), what)),
        (None, Built::Joint(own)) if m.model.find_constraint(own).is_none() => Ok(Built::Nothing),
        (None, built) => Ok(built),
    }
}
