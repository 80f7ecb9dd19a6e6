//! Multipliers of joints.

use super::joint_load::OF_JOINT;
use super::measurand::Measurand;
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) const REACTION: Measurand = Measurand {
    form: Form {
        name: "reaction",
        doc: "weighted sum of a joint's multipliers",
        keys: &[OF_JOINT, need("weights", Type::Series("-"), "a weight for each of its equations")],
    },
    add: |e, m| {
        let joint = e.joint()?;
        m.reaction_functional(e.name(), over(&e), joint, &e.series("weights")?);
        Ok(())
    },
};

pub(super) const REACTION_NORM: Measurand = Measurand {
    form: Form {
        name: "reaction_norm",
        doc: "length of the forces among a joint's multipliers [N]; of its moments [N m] where it has no force",
        keys: &[OF_JOINT],
    },
    add: |e, m| {
        m.reaction_norm_functional(e.name(), over(&e), e.joint()?);
        Ok(())
    },
};
