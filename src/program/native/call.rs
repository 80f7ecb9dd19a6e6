//! Functions that the processor has no instruction for.

use crate::operation::{Binary, Operation, Unary};
use crate::scalar::{Curve, Scalar, gathered_place};
use std::sync::Arc;

/// One call out of machine code.
#[derive(Clone, Debug)]
pub struct Call {
    operation: Operation,
    lanes: usize,
    /// Where the operation takes one.
    curve: Option<Arc<Curve>>,
}

impl Call {
    /// The call that evaluates an operation, if it needs one.
    pub fn of(operation: Operation, lanes: usize, curves: &[Arc<Curve>]) -> Option<Self> {
        let curve = match operation {
            Operation::Input(_) | Operation::Constant(_) | Operation::Select(_) => return None,
            Operation::Unary(Unary::Neg | Unary::Sqrt | Unary::Floor, _) => return None,
            Operation::Binary(Binary::Atan2, ..) => None,
            Operation::Binary(..) => return None,
            Operation::Unary(..) | Operation::Power(..) | Operation::Gather { .. } => None,
            Operation::Curve { curve, .. } => Some(Arc::clone(&curves[curve as usize])),
        };
        Some(Call { operation, lanes, curve })
    }

    /// Evaluates the operation for all lanes at `x`, and `y` where it has a second operand. What is gathered lies from `x` on, its place at `y`.
    ///
    /// # Safety
    /// Of all pointers: `call` is one of this type; `x` and `y` can be read for its number of lanes, `x` of what
    /// gathers for each number that it chooses from, and `result` written.
    pub unsafe fn evaluate(call: *const Call, x: *const f64, y: *const f64, result: *mut f64) {
        // SAFETY: promised by the caller.
        let Call { operation, lanes, curve } = unsafe { &*call };
        let first = x;
        for lane in 0..*lanes {
            // SAFETY: as above, for each of the lanes.
            let (x, y) = unsafe { (*x.add(lane), *y.add(lane)) };
            let value = match *operation {
                Operation::Unary(function, _) => x.unary(function),
                Operation::Binary(function, ..) => function.apply(x, y),
                Operation::Power(_, bits) => Scalar::powf(x, f64::from_bits(bits)),
                Operation::Curve { order, .. } => curve.as_ref().map_or(f64::NAN, |curve| curve.value(order as usize, x)),
                Operation::Gather { count, .. } => {
                    let place = gathered_place(y, count as usize);
                    // SAFETY: the place is below the count.
                    unsafe { *first.add(lanes * place + lane) }
                }
                Operation::Input(_) | Operation::Constant(_) | Operation::Select(_) => unreachable!("not called"),
            };
            // SAFETY: as above.
            unsafe { *result.add(lane) = value };
        }
    }
}
