//! Beams.

use super::line::{LINE, LINE_NODES, set_motion, with_ends};
use super::section::{is_tapered, section_of, shape_of};
use crate::elements::flexible;
use crate::scenes::BeamLine;
use crate::scenes::file::describing::*;
use std::cell::RefCell;

const ARC: Forms = one_form![
    need("centre", Vector("m"), "centre of the circle"),
    need("axis", Vector("-"), "unit vector about which the line turns"),
    need("angle", Number("rad", Any), "angle"),
];

pub(super) const SECTION: Section = Section {
    forms: Forms {
        common: &LINE,
        ..one_form![
            need("section", Type::Item(&["section"]), "name of a section"),
            may(
                "second_axis",
                Vector("-"),
                "direction that spans the plane of axes 1 and 2 with the line; required unless `arc` is given, whose axis is taken"
            ),
            may("arc", Table(&ARC), "part of a circle instead of a straight line"),
            may("twist", Number("rad", Any), "turn of the section from start to end; 0"),
        ]
    },
    build,
    ..Section::with_nodes(
        "beam",
        "A beam, geometrically exact, with shear and torsion, of three-node elements.",
        Nodes { known: OF_BODY, ..LINE_NODES },
    )
};

fn beam_section(e: Entry) -> Result<flexible::Section<Recorded>> {
    let (at, own) = section_of(e)?;
    if own.form == "cable" {
        let text = format!("\"{}\" is a section of cables; a beam needs one of another type", own.name());
        return Err(Mistake::new(at, text));
    }
    let of = shape_of(own)?;
    built_from(own, given(own, &flexible::SECTION)?, |given| flexible::Section::given(given, of))
}

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let (from, elements) = (e.vector("from")?, e.count("elements"));
    let mut line = match e.table("arc") {
        Some(arc) => {
            let (centre, axis) = (arc.vector("centre")?, arc.vector("axis")?);
            BeamLine::arc(from, centre, axis.unit(), arc.number("angle")?, elements)
        }
        None => BeamLine::straight([from, e.vector("to")?], elements, e.vector("second_axis")?),
    };
    if let Some(twist) = e.given("twist", Entry::number)? {
        line = line.twisted(twist);
    }
    let (joined, clamped) = ([BeamLine::from_node, BeamLine::to_node], [BeamLine::clamped_start, BeamLine::clamped_end]);
    let line = with_ends(e, line, joined, clamped, m)?;
    let first = beam_section(e)?;
    let beam = if is_tapered(&section_of(e)?.1) {
        let (failed, share) = (RefCell::new(None), &e.context.share);
        let at_share = |place: f64| {
            share.set(place.into());
            beam_section(e).unwrap_or_else(|why| {
                failed.borrow_mut().get_or_insert(why);
                first
            })
        };
        let beam = m.tapered_beam(e.name(), line, at_share);
        share.set(Recorded::default());
        if let Some(why) = failed.into_inner() {
            return Err(why);
        }
        beam
    } else {
        m.beam(e.name(), line, &first)
    };
    set_motion(e, &beam.nodes, m)?;
    Ok(Built::Beam(beam))
}
