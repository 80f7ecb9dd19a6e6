//! Power of what is in no energy.

use super::measurand::Measurand;
use super::over::over;
use crate::elements::entries::names_of;
use crate::elements::forces::LOADS;
use crate::scenes::file::describing::*;
use crate::scenes::file::keys::WITH_ELEMENTS;

/// Sections whose entries put energy in or take it out.
const WITH_POWER: &[&str] = &joined::<&str, { LOADS.len() + WITH_ELEMENTS.len() + 6 }>(&[
    &["spring", "damper", "element"],
    &names_of::<{ LOADS.len() }, _>(LOADS),
    &["joint", "body", "point"],
    WITH_ELEMENTS,
]);

pub(super) const POWER: Measurand = Measurand {
    form: Form {
        name: "power",
        doc: "power of loads, dampers, actuators and losses, of all that is in no energy [W]; an integral is a work [J]",
        keys: &[may(
            "of",
            Type::Items(WITH_POWER),
            "names of loads, springs, dampers, parts of one's own, members or groups; everything",
        )],
    },
    add: |e, m| {
        match e.get("of") {
            None => m.total_power_functional(e.name(), over(&e)),
            Some(_) => m.power_functional(e.name(), over(&e), &e.parts("of")?),
        }
        Ok(())
    },
};
