//! Tables by names, which formulas call like functions: `[table.road]` makes `road(x)`.

use super::fields::Fields;
use super::formula::{Formula, Meaning};
use super::keys::one_form;
use super::raw::{KeyValue, Raw};
use super::reader::Reader;
use super::section::Section;
use crate::elements::Table;
use crate::elements::entries::{COLUMNS, FILE, Forms, INTERPOLATION, Range, Type, VALUES, at_least, may};
use crate::scalar::{Curve, Interpolant, Scalar};
use std::sync::Arc;

/// The keys of a table.
pub(super) const TABLE: Forms = one_form![
    may(
        "points",
        at_least(0, &Type::Fixed("", Range::Any)),
        "numbers at which it has values, increasing; those of the file"
    ),
    VALUES,
    FILE,
    COLUMNS,
    INTERPOLATION,
    may(
        "extrapolation",
        Type::Choice(&["constant", "linear"]),
        "beyond the points: the value at the end, or straight on with the slope there; a run that gets there warns; linear with monotone and \
         smooth, constant with lines and steps"
    ),
];

/// `[table.NAME]`.
pub(super) const TABLES: Section = Section {
    forms: TABLE,
    ..Section::named(
        "table",
        "A function of one number by values at points, which all formulas call by its name: `road(wheel.position.x)`, `drag(v)`. Values may be \
          formulas of design variables. An [[element]], a [[state]] or a functional by a formula may have tables of its own by its key table.",
    )
};

/// A table as formulas call it.
#[derive(Clone, Debug)]
pub(super) struct NamedTable {
    of: Values,
    /// Where its argument is kept between the ends.
    within: Option<[f64; 2]>,
}

/// Values at the points.
#[derive(Clone, Debug)]
enum Values {
    /// Always the same.
    Fixed(Arc<Curve>),
    /// Given with the argument.
    OfDesign(Table),
}

impl NamedTable {
    /// The natural cubic spline through so many values at equal distances, the first at 0 and the last at 1.
    pub fn spline(count: usize) -> Result<Self, String> {
        let knots: Vec<f64> = (0..count).map(|k| k as f64 / (count - 1) as f64).collect();
        Ok(NamedTable { of: Values::OfDesign(Table::new(&knots, Interpolant::Smooth)?), within: None })
    }

    /// What its keys say, and the formulas of its values where they change with the design.
    fn of(fields: &Fields) -> Result<(Self, Vec<Formula>), String> {
        let (points, values) = fields.points_and_values("points")?;
        let (is_linear, mut interpolant) = (fields.text("extrapolation").map(|word| word == "linear"), fields.way());
        if interpolant == Interpolant::Lines && is_linear == Some(true) {
            interpolant = Interpolant::LinesOn;
        }
        if interpolant == Interpolant::Steps && is_linear == Some(true) {
            return Err("steps stay constant beyond the points: leave extrapolation out".into());
        }
        let fixed: Option<Vec<f64>> = values.iter().map(Formula::constant_number).collect();
        let (of, values) = match fixed {
            Some(fixed) => (Values::Fixed(Curve::new(&points, &fixed, interpolant)?), Vec::new()),
            None => (Values::OfDesign(Table::new(&points, interpolant)?), values),
        };
        let is_kept = is_linear == Some(false) && !interpolant.has_kinks();
        Ok((NamedTable { of, within: is_kept.then(|| [points[0], points[points.len() - 1]]) }, values))
    }

    pub fn value<S: Scalar>(&self, x: S, values: &[S]) -> S {
        let x = self.within.map_or(x, |[first, last]| x.max(S::from(first)).min(S::from(last)));
        match &self.of {
            Values::Fixed(curve) => x.on_curve(curve, 0),
            Values::OfDesign(table) => table.value(x, &table.numbers(values)),
        }
    }
}

impl Reader {
    /// Takes a table, which formulas call from here on.
    pub(super) fn take_table(&mut self, own: &KeyValue) {
        let before = self.mistakes.len();
        let fields = self.fields(&own.value, &TABLE, &format!("the table \"{}\"", own.key));
        let fields = self.with_columns(fields);
        let made = NamedTable::of(&fields).or_else(|why| {
            if self.mistakes.len() == before {
                self.wrong(own.value.at, format!("the table \"{}\": {why}", own.key));
            }
            // what is wrong is told once, not by all that call it
            NamedTable::spline(2).map(|table| (table, vec![Formula::literal(1.0); 2]))
        });
        let (table, values) = made.unwrap_or_else(|why| unreachable!("two points make a spline: {why}"));
        self.scope.add(&own.key, Meaning::Table(Arc::new(table), values.into()));
    }

    /// The tables of an entry's own.
    pub(super) fn take_own_tables(&mut self, raw: &Raw) {
        let Some(given) = raw.get("table") else { return };
        let wanted = "with tables, as in { drag = { points = [0, 1], values = [0, 5] } }";
        self.named(given, "table", wanted, |reader, own| {
            reader.check_name(&own.key, own.at);
            if reader.scope.find(&own.key).is_some() || reader.scope.of_node(&own.key).next().is_some() {
                reader.wrong(own.at, format!("\"{}\" is a name here already: take another one", own.key));
            }
            reader.take_table(own);
            Some(())
        });
    }
}
