//! Failure of laminates.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::elements::entries::{Form, Type, need};
use crate::scalar::Scalar;
use crate::scenes::file::fields::Item;
use crate::scenes::file::known::{Builder, Found, Known};

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
