//! Cables.

use super::line::{LINE, set_motion, with_ends};
use super::section::{is_tapered, section_of, shape_of};
use crate::elements::flexible::{self, CableSection};
use crate::scenes::CableLine;
use crate::scenes::file::build_parts::{given, made_of};
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    name: "cable",
    shape: Shape::Listed,
    doc: "A cable in absolute nodal coordinates: straight at the start, without torsion.",
    forms: one_form![
        LINE[0],
        LINE[1],
        LINE[2],
        LINE[3],
        need("section", Type::Item(&["section"]), "name of a section that is not of type beam"),
        may("strains", Choice(&["exact", "small"]), "strains of its energy; exact"),
        LINE[4],
        LINE[5],
        LINE[6],
        LINE[7],
    ],
};

fn cable_section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<CableSection<S>> {
    let (at, Item { name, fields: own, .. }) = section_of(known.items, fields)?;
    if is_tapered(own) {
        let text = format!("\"{name}\" depends on share, and a cable has one section from end to end");
        return Err(Mistake::new(at, text));
    }
    if own.form == "beam" {
        return Err(Mistake::new(at, format!("\"{name}\" is a section of beams; a cable needs one of another type")));
    }
    if own.get("offset").is_some() {
        return Err(Mistake::new(at, format!("\"{name}\" has an offset, which a cable cannot have")));
    }
    let of = shape_of(known, own)?;
    let section = made_of(own, given(known, own, &flexible::SECTION)?, |given| CableSection::given(given, of))?;
    Ok(if text(fields, "strains") == Some("small") { section.small_strains() } else { section })
}

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let ends = [known.vector(fields, "from")?, known.vector(fields, "to")?];
    let line = CableLine::straight(ends, count(fields, "elements"));
    let node = |key: &str| known.node(fields, key, m);
    let (joined, clamped) = ([CableLine::from_node, CableLine::to_node], [CableLine::clamped_start, CableLine::clamped_end]);
    let line = with_ends(fields, line, node, joined, clamped)?;
    let cable = m.cable(name, line, &cable_section(known, fields)?);
    set_motion(known, fields, &cable.nodes, m)?;
    Ok(Made::Cable(cable))
}
