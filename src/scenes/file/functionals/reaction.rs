//! Multipliers of joints.

use super::joint_load::OF_JOINT;
use super::measurand::Measurand;
use super::over::over;
use crate::scenes::file::describing::*;

pub(super) struct Reaction;

impl Measurand for Reaction {
    const FORM: Form = Form {
        name: "reaction",
        doc: "weighted sum of a joint's multipliers",
        keys: &[OF_JOINT, need("weights", Type::Series("-"), "a weight for each of its equations")],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        let joint = known.joint(fields)?;
        m.reaction_functional(name, over(fields), joint, &known.series(fields, "weights")?);
        Ok(())
    }
}

pub(super) struct ReactionNorm;

impl Measurand for ReactionNorm {
    const FORM: Form = Form {
        name: "reaction_norm",
        doc: "length of the forces among a joint's multipliers [N]; of its moments [N m] where it has no force",
        keys: &[OF_JOINT],
    };

    fn add<S: Scalar>(known: &Known<S>, Item { name, fields, .. }: &Item, m: &mut Builder<S>) -> Found<()> {
        m.reaction_norm_functional(name, over(fields), known.joint(fields)?);
        Ok(())
    }
}
