//! Groups of elements of shells.

use crate::functionals::ElementGroup;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "group",
    shape: Shape::Listed,
    doc: "Elements of shells by their places in the grid, for functionals.",
    forms: one_form![
        NAME,
        need("of", Type::Item(&["shell"]), "name of a shell"),
        may("first", Counts(2, 0, 1000), "first and last element along the first direction, from 0; all"),
        may("second", Counts(2, 0, 1000), "first and last element along the second direction, from 0; all"),
    ],
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, _: &mut Builder<S>) -> Found<Made<S>> {
    let Made::Shell(shell) = known.made(fields, "of")? else {
        return Err(Mistake::new(fields.at, "of must name a shell"));
    };
    for (key, count) in ["first", "second"].into_iter().zip(shell.counts) {
        if let (Some([from, to]), Some((at, _))) = (counts(fields, key), fields.get(key))
            && (from > to || to >= count)
        {
            let text = format!("{key} goes from element {from} to {to}; the shell has {count} there, counted from 0");
            return Err(Mistake::new(at, text));
        }
    }
    let bounds = |key: &str, count: usize| counts(fields, key).unwrap_or([0, count.saturating_sub(1)]);
    let ranges = [bounds("first", shell.counts[0]), bounds("second", shell.counts[1])];
    let is_in = |place: [usize; 2]| (0..2).all(|k| (ranges[k][0]..=ranges[k][1]).contains(&place[k]));
    let group: ElementGroup = shell.part(name, is_in);
    if group.elements.is_empty() {
        let [columns, rows] = shell.counts;
        let text = format!("\"{name}\" has no elements; the shell has {columns} x {rows}, counted from 0");
        return Err(Mistake::new(fields.at, text));
    }
    Ok(Made::Group(group))
}
