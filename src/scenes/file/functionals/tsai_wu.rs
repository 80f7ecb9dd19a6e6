//! Failure of laminates.

use super::measurand::{GROUP, Measurand};
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) const TSAI_WU: Measurand = Measurand {
    form: Form {
        name: "tsai_wu",
        doc: "failure ratio of Tsai and Wu in laminates [-]",
        keys: &[GROUP, need("laminate", Type::Item(&["laminate"]), "name of the laminate, whose plies have strengths")],
    },
    add: |e, m| {
        let (laminate, strengths) = e.laminate()?;
        m.tsai_wu_functional(e.name(), over(&e), &e.group("of")?, laminate, strengths);
        Ok(())
    },
};
