//! Stresses of members of isotropic materials.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) struct VonMises;

impl Measurand for VonMises {
    const FORM: Form = Form {
        name: "von_mises",
        doc: "von Mises stress by the yield stress [-]: on both surfaces of shells, on the outline of beams of a material and a shape, in the \
              outer fibres of such cables",
        keys: &[GROUP, need("yield_stress", Type::Number("N/m2", Range::Positive), "yield stress")],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let group = known.group(fields, "of")?;
        m.von_mises_functional(name, over(fields), &group, known.number(fields, "yield_stress")?);
        Ok(())
    }
}
