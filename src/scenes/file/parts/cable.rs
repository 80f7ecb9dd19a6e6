//! Cables.

use super::line::{LINE, LINE_NODES, set_motion, with_ends};
use super::section::{is_tapered, section_of, shape_of};
use crate::elements::flexible::{self, CableSection};
use crate::scenes::CableLine;
use crate::scenes::file::describing::*;

pub(super) const SECTION: Section = Section {
    forms: Forms {
        common: &LINE,
        ..one_form![
            need("section", Type::Item(&["section"]), "name of a section that is not of type beam"),
            may("strains", Choice(&["exact", "small"]), "strains of its energy; exact"),
        ]
    },
    build,
    ..Section::with_nodes(
        "cable",
        "A cable in absolute nodal coordinates: straight at the start, without torsion.",
        LINE_NODES,
    )
};

fn cable_section(e: Entry) -> Result<CableSection<Recorded>> {
    let (at, own) = section_of(e)?;
    let why = match own.form {
        _ if is_tapered(&own) => "depends on share, and a cable has one section from end to end",
        "beam" => "is a section of beams; a cable needs one of another type",
        _ if own.has("offset") => "has an offset, which a cable cannot have",
        _ => {
            let of = shape_of(own)?;
            let section = built_from(own, given(own, &flexible::SECTION)?, |given| CableSection::given(given, of))?;
            return Ok(if e.text("strains") == Some("small") { section.small_strains() } else { section });
        }
    };
    Err(Mistake::new(at, format!("\"{}\" {why}", own.name())))
}

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let line = CableLine::straight([e.vector("from")?, e.vector("to")?], e.count("elements"));
    let (joined, clamped) = ([CableLine::from_node, CableLine::to_node], [CableLine::clamped_start, CableLine::clamped_end]);
    let line = with_ends(e, line, joined, clamped, m)?;
    let cable = m.cable(e.name(), line, &cable_section(e)?);
    set_motion(e, &cable.nodes, m)?;
    Ok(Built::Cable(cable))
}
