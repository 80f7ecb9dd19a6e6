//! Functions that the processor has no instruction for.

use super::Width;
use crate::program::listing::Instruction;
use crate::scalar::{CurveId, Scalar};

/// One call out of machine code.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    instruction: Instruction,
    width: Width,
}

impl Call {
    /// The call that evaluates an instruction, if it needs one.
    pub fn of(instruction: Instruction, width: Width) -> Option<Self> {
        use crate::program::operation::{Binary, Unary};
        match instruction {
            Instruction::Unary(Unary::Neg | Unary::Sqrt | Unary::Floor, _) => None,
            Instruction::Binary(Binary::Add | Binary::Sub | Binary::Mul | Binary::Div, ..) => None,
            Instruction::Binary(Binary::Less | Binary::Vanishing, ..) | Instruction::Select(..) => None,
            Instruction::Unary(..) | Instruction::Binary(Binary::Atan2, ..) => Some(Call { instruction, width }),
            Instruction::Power(..) | Instruction::KnotWeight { .. } => Some(Call { instruction, width }),
        }
    }

    /// Evaluates the instruction for all lanes at `x`, and `y` where it has a second operand.
    ///
    /// # Safety
    /// Of all pointers: `call` is one of this type; `x` and `y` can be read for its number of lanes, and `result`
    /// written.
    pub unsafe extern "sysv64" fn evaluate(call: *const Call, x: *const f64, y: *const f64, result: *mut f64) {
        // SAFETY: promised by the caller.
        let Call { instruction, width } = unsafe { *call };
        for lane in 0..width.lanes() {
            // SAFETY: as above, for each of the lanes.
            let (x, y) = unsafe { (*x.add(lane), *y.add(lane)) };
            let value = match instruction {
                Instruction::Unary(function, _) => function.apply(x),
                Instruction::Binary(function, _, _) => function.apply(x, y),
                Instruction::Power(_, exponent) => Scalar::powf(x, exponent),
                Instruction::KnotWeight { curve, knot, order, .. } => {
                    x.knot_weight(CurveId(curve), knot as usize, order as usize)
                }
                Instruction::Select(..) => unreachable!("emitted in place"),
            };
            // SAFETY: as above.
            unsafe { *result.add(lane) = value };
        }
    }
}
