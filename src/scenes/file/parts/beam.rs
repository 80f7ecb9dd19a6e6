//! Beams.

use super::line::{LINE, set_motion, with_ends};
use super::section::{is_tapered, section_of, shape_of};
use crate::elements::flexible;
use crate::scenes::BeamLine;
use crate::scenes::file::build_parts::{given, made_of};
use crate::scenes::file::describing::*;
use std::cell::RefCell;

const ARC: Forms = one_form![
    need("centre", Vector("m"), "centre of the circle"),
    need("axis", Vector("-"), "unit vector about which the line turns"),
    need("angle", Number("rad", Any), "angle"),
];

pub(super) const SECTION: Section = Section {
    name: "beam",
    shape: Shape::Listed,
    doc: "A beam, geometrically exact, with shear and torsion, of three-node elements.",
    forms: one_form![
        LINE[0],
        LINE[1],
        LINE[2],
        LINE[3],
        need("section", Type::Item(&["section"]), "name of a section"),
        may(
            "second_axis",
            Vector("-"),
            "direction that spans the plane of axes 1 and 2 with the line; needed but with arc, whose axis is taken"
        ),
        may("arc", Table(&ARC), "part of a circle instead of a straight line"),
        may("twist", Number("rad", Any), "turn of the section from start to end; 0"),
        LINE[4],
        LINE[5],
        LINE[6],
        LINE[7],
    ],
};

fn beam_section<S: Scalar>(known: &Known<S>, fields: &Fields) -> Found<flexible::Section<S>> {
    let (at, Item { name, fields: own, .. }) = section_of(known.items, fields)?;
    if own.form == "cable" {
        return Err(Mistake::new(at, format!("\"{name}\" is a section of cables; a beam needs one of another type")));
    }
    let of = shape_of(known, own)?;
    made_of(own, given(known, own, &flexible::SECTION)?, |given| flexible::Section::given(given, of))
}

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let (from, elements) = (known.vector(fields, "from")?, count(fields, "elements"));
    let mut line = match fields.get("arc") {
        Some((_, Value::Fields(arc))) => {
            let (centre, axis) = (known.vector(arc, "centre")?, known.vector(arc, "axis")?);
            BeamLine::arc(from, centre, axis.unit(), known.number(arc, "angle")?, elements)
        }
        _ => BeamLine::straight([from, known.vector(fields, "to")?], elements, known.vector(fields, "second_axis")?),
    };
    if fields.get("twist").is_some() {
        line = line.twisted(known.number(fields, "twist")?);
    }
    let node = |key: &str| known.node(fields, key, m);
    let (joined, clamped) = ([BeamLine::from_node, BeamLine::to_node], [BeamLine::clamped_start, BeamLine::clamped_end]);
    let line = with_ends(fields, line, node, joined, clamped)?;
    let first = beam_section(known, fields)?;
    let beam = if is_tapered(&section_of(known.items, fields)?.1.fields) {
        let failed = RefCell::new(None);
        let at_share = |share: f64| {
            known.share.set(S::from(share));
            beam_section(known, fields).unwrap_or_else(|why| {
                failed.borrow_mut().get_or_insert(why);
                first
            })
        };
        let beam = m.tapered_beam(name, line, at_share);
        known.share.set(S::zero());
        if let Some(why) = failed.into_inner() {
            return Err(why);
        }
        beam
    } else {
        m.beam(name, line, &first)
    };
    set_motion(known, fields, &beam.nodes, m)?;
    Ok(Made::Beam(beam))
}
