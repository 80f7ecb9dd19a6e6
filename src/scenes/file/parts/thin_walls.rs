//! Members of thin walls.

use crate::elements::flexible::MATERIAL;
use crate::scenes::file::describing::*;
use crate::scenes::file::keys::MOST;
use crate::scenes::{Extrusion, Profile};

const WALL: Forms = one_form![
    need("between", Counts(2, 0, 1000), "its corners, counted from 0"),
    need("elements", Count(1, 1000), "elements from one to the other"),
];

pub(super) const SECTION: Section = Section {
    name: "thin_walls",
    shape: Shape::Listed,
    doc: "A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them.",
    forms: forms!([
        NAME,
        may("start", Vector("m"), "where the origin of the profile starts; the origin"),
        need("along", Vector("m"), "its line"),
        need("first_axis", Vector("-"), "axis 1 of the profile, at right angles to the line"),
        may("twist", Number("rad", Any), "turn of the profile about the line from start to end; 0"),
        need("elements", Count(1, MOST), "elements along the line"),
        MATERIAL,
        need("thickness", OneOrMore("m", Positive), "thickness, or that of each wall"),
    ]
    "box_tube" "rectangular tube of four walls: lower, right, upper, left" [
        need("width", Number("m", Positive), "of the middle lines along axis 1"),
        need("height", Number("m", Positive), "of the middle lines along axis 2"),
        need("across", Counts(2, 1, 100), "elements across lower and upper, and right and left walls"),
    ]
    "i_section" "two flanges and a web: both halves of the lower flange, of the upper one, web" [
        need("width", Number("m", Positive), "of the flanges along axis 1"),
        need("height", Number("m", Positive), "of the web along axis 2"),
        need("across", Counts(2, 1, 100), "elements across half a flange, and the web"),
    ]
    "profile" "walls between corners" [
        need("corners", Pairs("m"), "places along axes 1 and 2"),
        need("walls", Tables(&WALL), "walls between corners"),
    ]),
};

pub(super) fn build<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<Made<S>> {
    let (profile, walls) = match fields.form {
        "profile" => {
            let corners = list(fields, "corners").map(|given| known.pair(given)).collect::<Found<Vec<[S; 2]>>>()?;
            let wall = |(_, own): (usize, &Fields)| Some((counts(own, "between")?, count(own, "elements")));
            let walls: Vec<([usize; 2], usize)> = fields.tables("walls").filter_map(wall).collect();
            let number = walls.len();
            (Profile::new(corners, walls), number)
        }
        form => {
            let size = [known.number(fields, "width")?, known.number(fields, "height")?];
            let across = counts(fields, "across").unwrap_or([1; 2]);
            match form {
                "box_tube" => (Profile::box_tube(size, across), 4),
                _ => (Profile::i_section(size, across), 5),
            }
        }
    };
    let extrusion = Extrusion {
        start: known.vector_or(fields, "start", Vector3::zeros())?,
        along: known.vector(fields, "along")?,
        first_axis: known.vector(fields, "first_axis")?,
        twist: known.number_or(fields, "twist", 0.0)?,
        elements: count(fields, "elements"),
    };
    let thickness = known.series(fields, "thickness")?;
    if thickness.len() != 1 && thickness.len() != walls {
        let text = format!("\"{name}\" has {} thicknesses; give one, or {walls}, one for each wall", thickness.len());
        return Err(Mistake::new(fields.at("thickness"), text));
    }
    let of_wall = |wall: usize, _: f64| thickness[wall % thickness.len()];
    let walls = m.thin_walls(name, &profile, &extrusion, &known.material(fields)?, of_wall);
    match walls.start().is_empty() {
        // why is among the mistakes of the builder
        true => Ok(Made::Nothing),
        false => Ok(Made::Walls(walls)),
    }
}
