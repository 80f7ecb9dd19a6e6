//! Members of thin walls.

use crate::elements::flexible::MATERIAL;
use crate::scenes::file::describing::*;
use crate::scenes::{Extrusion, Profile};

const WALL: Forms = one_form![
    need("between", exactly(2, &Count(0, 1000)), "its corners, counted from 0"),
    need("elements", Count(1, 1000), "elements from one to the other"),
];

pub(super) const SECTION: Section = Section {
    forms: forms!([
        NAME,
        may("start", Vector("m"), "where the origin of the profile starts; the origin"),
        need("along", Vector("m"), "its line"),
        need("first_axis", Vector("-"), "axis 1 of the profile, at right angles to the line"),
        may("twist", Number("rad", Any), "turn of the profile about the line from start to end; 0"),
        need("elements", Count(1, MOST), "elements along the line"),
        MATERIAL,
        need("thickness", OneOrMore(&Number("m", Positive)), "thickness, or that of each wall"),
    ]
    "box_tube" "rectangular tube of four walls: lower, right, upper, left" [
        need("width", Number("m", Positive), "of the middle lines along axis 1"),
        need("height", Number("m", Positive), "of the middle lines along axis 2"),
        need("across", exactly(2, &Count(1, 100)), "elements across lower and upper, and right and left walls"),
    ]
    "i_section" "two flanges and a web: both halves of the lower flange, of the upper one, web" [
        need("width", Number("m", Positive), "of the flanges along axis 1"),
        need("height", Number("m", Positive), "of the web along axis 2"),
        need("across", exactly(2, &Count(1, 100)), "elements across half a flange, and the web"),
    ]
    "profile" "walls between corners" [
        need("corners", at_least(2, &Numbers(&[2], "m", Any)), "places along axes 1 and 2"),
        need("walls", at_least(0, &Table(&WALL)), "walls between corners"),
    ]),
    build,
    ..Section::with_nodes(
        "thin_walls",
        "A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them.",
        Nodes { edges: &["start", "end"], own: 0, of_edge: 1, known: OF_BODY },
    )
};

pub(super) fn build(e: Entry, m: &mut Builder) -> Result<Built> {
    let (name, across) = (e.name(), e.counts("across").unwrap_or([1; 2]));
    let size = || Ok::<_, Mistake>([e.number("width")?, e.number("height")?]);
    let (profile, walls) = match e.form {
        "box_tube" => (Profile::box_tube(size()?, across), 4),
        "i_section" => (Profile::i_section(size()?, across), 5),
        _ => {
            let corners = e.pairs("corners")?;
            let walls = e.tables("walls").filter_map(|own| Some((own.counts("between")?, own.count("elements"))));
            let walls: Vec<([usize; 2], usize)> = walls.collect();
            let count = walls.len();
            (Profile::new(corners, walls), count)
        }
    };
    let extrusion = Extrusion {
        start: e.vector_or("start", Vector3::zeros())?,
        along: e.vector("along")?,
        first_axis: e.vector("first_axis")?,
        twist: e.number_or("twist", 0.0)?,
        elements: e.count("elements"),
    };
    let thickness = e.series("thickness")?;
    if thickness.len() != 1 && thickness.len() != walls {
        let text = format!("\"{name}\" has {} thicknesses; give one, or {walls}, one for each wall", thickness.len());
        return e.wrong_key("thickness", text);
    }
    let of_wall = |wall: usize, _: f64| thickness[wall % thickness.len()];
    let walls = m.thin_walls(name, &profile, &extrusion, &e.material()?, of_wall);
    // why there may be none is among the mistakes of the builder
    Ok(if walls.start().is_empty() { Built::Nothing } else { Built::Walls(walls) })
}
