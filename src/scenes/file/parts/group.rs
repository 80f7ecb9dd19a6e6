//! Groups of elements of shells.

use crate::functionals::ElementGroup;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: one_form![
        NAME,
        need("of", Type::Item(&["shell"]), "name of a shell"),
        may("first", exactly(2, &Count(0, 1000)), "first and last element along the first direction, from 0; all"),
        may("second", exactly(2, &Count(0, 1000)), "first and last element along the second direction, from 0; all"),
    ],
    build,
    ..Section::listed("group", "Elements of shells by their places in the grid, for functionals.")
};

pub(super) fn build(e: Entry, _: &mut Builder) -> Result<Built> {
    let Built::Shell(shell) = e.built("of")? else { return e.wrong("of must name a shell") };
    let mut ranges = Vec::new();
    for (key, count) in ["first", "second"].into_iter().zip(shell.counts) {
        let [from, to] = e.counts(key).unwrap_or([0, count.saturating_sub(1)]);
        if e.has(key) && (from > to || to >= count) {
            let text = format!("{key} goes from element {from} to {to}; the shell has {count} there, counted from 0");
            return e.wrong_key(key, text);
        }
        ranges.push(from..=to);
    }
    let group: ElementGroup =
        shell.part(e.name(), |place| ranges.iter().zip(place).all(|(range, own)| range.contains(&own)));
    if group.elements.is_empty() {
        let ([columns, rows], name) = (shell.counts, e.name());
        return e.wrong(format!("\"{name}\" has no elements; the shell has {columns} x {rows}, counted from 0"));
    }
    Ok(Built::Group(group))
}
