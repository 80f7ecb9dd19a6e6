//! Joints, drivers, springs, dampers and loads, by their entries.

use super::fields::{Fields, Item};
use super::known::{Builder, Found, Known, Made, count, missing, text};
use super::mistake::Mistake;
use crate::elements::entries::{Forms, Given, GivenValue, JointPart, Key, Part, SpringPart, Type, Values, may};
use crate::scalar::Scalar;
use crate::scenes::builder::Wrong;

/// The value of a key of an entry, if it is given.
fn value<S: Scalar>(known: &Known<S>, fields: &Fields, key: &Key) -> Found<Option<GivenValue<S>>> {
    if fields.get(key.name).is_none() {
        return Ok(None);
    }
    Ok(Some(match key.takes {
        Type::Number(..) => GivenValue::Number(known.number(fields, key.name)?),
        Type::Numbers(..) => GivenValue::Numbers(known.series(fields, key.name)?),
        Type::Vector(_) => GivenValue::Vector(known.vector(fields, key.name)?),
        Type::Points => GivenValue::Vectors(known.points(fields, key.name)?),
        Type::Choice(_) => GivenValue::Word(text(fields, key.name).unwrap_or_default().into()),
        Type::Function(..) => {
            let parts = known.function(fields, key.name)?.parts();
            let (function, numbers) = parts.map_err(|why| Mistake::new(fields.at(key.name), why))?;
            GivenValue::Function(function, numbers)
        }
        Type::Law(..) | Type::Energy(..) => {
            let (law, numbers) = known.law(fields, key.name)?;
            GivenValue::Law(law, numbers)
        }
        Type::Count(..) => GivenValue::Count(count(fields, key.name)),
        Type::Table(_) if key.name == "orientation" => GivenValue::Rotation(known.orientation(fields)?),
        _ => {
            let text = format!("the entry of this part has a key {} of a type that no entry can have", key.name);
            return Err(Mistake::new(fields.at, text));
        }
    }))
}

/// Values of the keys of an entry but the nodes.
pub(super) fn values<S: Scalar>(
    known: &Known<S>,
    fields: &Fields,
    keys: impl IntoIterator<Item = &'static Key>,
) -> Found<Values<S>> {
    let mut values = Vec::new();
    for key in keys.into_iter().filter(|key| !key.takes.is_nodes()) {
        values.extend(value(known, fields, key)?.map(|value| (key.name, value)));
    }
    Ok(values)
}

/// What is made of the values of keys without an entry, or where in the file what is wrong stands.
pub(super) fn made_of<S: Scalar, T>(
    fields: &Fields,
    mut given: Given<S>,
    make: impl FnOnce(&mut Given<S>) -> T,
) -> Found<T> {
    let made = make(&mut given);
    match given.mistakes().into_iter().next() {
        Some((Some(key), _)) if fields.get(key).is_none() => missing(fields, key),
        Some((key, what)) => Err(Mistake::new(key.map_or(fields.at, |key| fields.at(key)), what)),
        None => Ok(made),
    }
}

/// The values of keys of some forms, for what has no nodes.
pub(super) fn given<S: Scalar>(known: &Known<S>, fields: &Fields, forms: &Forms) -> Found<Given<S>> {
    Ok(Given::new("", [], values(known, fields, forms.keys(fields.form))?))
}

/// What was made of an entry, or where in the file what is wrong stands.
pub(super) fn located<S: Scalar>(made: Result<Made<S>, Vec<Wrong>>, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    made.or_else(|wrong| {
        let (keys, others): (Vec<Wrong>, Vec<Wrong>) = wrong.into_iter().partition(|(key, _)| key.is_some());
        m.tell(&item.name, others);
        let at = |key| item.fields.at(key);
        keys.into_iter().find_map(|(key, what)| Some(Err(Mistake::new(at(key?), what)))).unwrap_or(Ok(Made::Nothing))
    })
}

/// What is made of a part, if there is one for an entry.
pub(super) fn of_part<L: ?Sized, T>(
    item: &Item,
    part: Option<&Part<L>>,
    make: impl FnOnce(&Part<L>) -> Found<T>,
) -> Found<T> {
    part.ok_or_else(|| nothing_builds(item)).and_then(make)
}

/// An entry of a type that nobody makes.
pub(super) fn nothing_builds(item: &Item) -> Mistake {
    Mistake::new(item.fields.at, format!("nothing builds a {} of type {}", item.section, item.fields.form))
}

/// Makes a joint or driver of its entry.
pub(super) fn joint<S: Scalar>(known: &Known<S>, part: &JointPart, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let Item { name, fields, .. } = item;
    let (nodes, values) = (known.different_nodes_of_part(fields, m)?, values(known, fields, part.form.keys)?);
    let made = match rates(known, fields)? {
        Some([stiffness, damping]) => {
            m.soft_part(part, name, &nodes, values, [&stiffness, &damping]).map(|_| Made::SoftJoint)
        }
        None => m.rigid_part(part, name, &nodes, values).map(Made::Joint),
    };
    located(made, item, m)
}

/// Makes a spring, damper or load of its entry, on each node or element of what carries it.
pub(super) fn element<S: Scalar>(known: &Known<S>, part: &SpringPart, item: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let Item { name, fields, .. } = item;
    let (on, mut values) = (known.carriers(name, fields, m)?, values(known, fields, part.form.keys)?);
    if fields.get("on").is_some() && on.len() > 1 {
        let share = S::from(1.0 / on.len() as f64);
        values.iter_mut().for_each(|(key, own)| match own {
            GivenValue::Vector(own) if *key == "direction" => *own *= share,
            _ => {}
        });
    }
    let made = m.load_part(part, &on, &values).map(|()| Made::Nothing);
    located(made, item, m)
}

/// What makes springs of a joint.
pub(super) const SOFT: [Key; 2] = [
    may(
        "stiffness",
        Type::Series("N/m, N m/rad"),
        "of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid",
    ),
    may("damping", Type::Series("N s/m, N m s/rad"), "of a soft joint, of each of its equations; 0"),
];

/// Stiffnesses and dampings of a soft joint.
pub(super) fn rates<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<Option<[Vec<S>; 2]>> {
    let stiffness = known.series(fields, "stiffness")?;
    match (fields.get("stiffness"), fields.get("damping")) {
        (None, Some((at, _))) => {
            Err(Mistake::new(at, "only a soft joint has damping: give it stiffness, too, or leave it out"))
        }
        (None, None) => Ok(None),
        _ => {
            let mut damping = known.series(fields, "damping")?;
            if damping.is_empty() {
                damping.resize(stiffness.len(), S::zero());
            }
            Ok(Some([stiffness, damping]))
        }
    }
}
