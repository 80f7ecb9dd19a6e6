//! Functions that the processor has no instruction for.

use super::Width;
use crate::program::listing::Instruction;
use crate::scalar::{Curve, Scalar, gathered_place};
use std::sync::Arc;

/// One call out of machine code.
#[derive(Clone, Debug)]
pub struct Call {
    instruction: Instruction,
    width: Width,
    /// Where the instruction takes one.
    curve: Option<Arc<Curve>>,
}

impl Call {
    /// The call that evaluates an instruction, if it needs one.
    pub fn of(instruction: Instruction, width: Width, curves: &[Arc<Curve>]) -> Option<Self> {
        use crate::program::operation::{Binary, Unary};
        let call = |curve| Some(Call { instruction, width, curve });
        match instruction {
            Instruction::Unary(Unary::Neg | Unary::Sqrt | Unary::Floor, _) => None,
            Instruction::Binary(Binary::Add | Binary::Sub | Binary::Mul | Binary::Div, ..) => None,
            Instruction::Binary(Binary::Less | Binary::Vanishing, ..) | Instruction::Select(..) => None,
            Instruction::Unary(..) | Instruction::Binary(Binary::Atan2, ..) => call(None),
            Instruction::Power(..) | Instruction::Gather { .. } => call(None),
            Instruction::Curve { curve, .. } => call(Some(Arc::clone(&curves[curve as usize]))),
        }
    }

    /// Evaluates the instruction for all lanes at `x`, and `y` where it has a second operand. What is gathered lies from `x` on, its place at `y`.
    ///
    /// # Safety
    /// Of all pointers: `call` is one of this type; `x` and `y` can be read for its number of lanes, `x` of what
    /// gathers for each number that it chooses from, and `result` written.
    pub unsafe fn evaluate(call: *const Call, x: *const f64, y: *const f64, result: *mut f64) {
        // SAFETY: promised by the caller.
        let Call { instruction, width, curve } = unsafe { &*call };
        for lane in 0..width.lanes() {
            let (lanes, first) = (width.lanes(), x);
            // SAFETY: as above, for each of the lanes.
            let (x, y) = unsafe { (*x.add(lane), *y.add(lane)) };
            let value = match *instruction {
                Instruction::Unary(function, _) => function.apply(x),
                Instruction::Binary(function, _, _) => function.apply(x, y),
                Instruction::Power(_, exponent) => Scalar::powf(x, exponent),
                Instruction::Curve { order, .. } => curve.as_ref().map_or(f64::NAN, |curve| curve.value(order as usize, x)),
                Instruction::Gather { count, .. } => {
                    let place = gathered_place(y, count as usize);
                    // SAFETY: the place is below the count.
                    unsafe { *first.add(lanes * place + lane) }
                }
                Instruction::Select(..) => unreachable!("emitted in place"),
            };
            // SAFETY: as above.
            unsafe { *result.add(lane) = value };
        }
    }
}
