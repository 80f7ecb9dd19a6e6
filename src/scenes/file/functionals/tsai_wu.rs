//! Failure of laminates.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) struct TsaiWu;

impl Measurand for TsaiWu {
    const FORM: Form = Form {
        name: "tsai_wu",
        doc: "failure ratio of Tsai and Wu in laminates [-]",
        keys: &[GROUP, need("laminate", Type::Item(&["laminate"]), "name of the laminate, whose plies have strengths")],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let (laminate, strengths) = known.laminate(fields)?;
        m.tsai_wu_functional(name, over(fields), &known.group(fields, "of")?, laminate, strengths);
        Ok(())
    }
}
