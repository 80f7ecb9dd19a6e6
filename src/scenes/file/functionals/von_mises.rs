//! Stresses of members of isotropic materials.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) const VON_MISES: Measurand = Measurand {
    form: Form {
        name: "von_mises",
        doc: "von Mises stress by the yield stress [-]: on both surfaces of shells, on the outline of beams of a material and a shape, in the \
              outer fibres of such cables",
        keys: &[GROUP, need("yield_stress", Type::Number("N/m2", Range::Positive), "yield stress")],
    },
    add: |e, m| {
        let group = e.group("of")?;
        m.von_mises_functional(e.name(), over(&e), &group, e.number("yield_stress")?);
        Ok(())
    },
};
