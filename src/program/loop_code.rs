//! Portable execution of a listing: one loop over its operations, for any number or for eight elements at a time.
//!
//! It runs in batches of equal operations ([`batches`](super::batches)), each a small loop without branches, where a
//! loop over single instructions would mispredict a jump at each of them.

use super::batches::batched_order;
use super::listing::Listing;
use super::operation::{Binary, Node, Operation, Unary};
use crate::scalar::{Curve, Scalar, gathered_place};
use std::sync::Arc;

/// Eight numbers side by side: one of each of eight elements.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct F64x8(pub [f64; 8]);

/// A row of steps of the same kind.
#[derive(Clone, Debug)]
struct Batch {
    /// What all of them do, without operands.
    kind: Operation,
    /// Where its steps end; they start where those of the batch before end.
    end: usize,
}

/// Places of the operands, unused ones 0, and of the result.
#[derive(Clone, Copy, Debug)]
struct Step {
    operands: [u32; 3],
    result: u32,
}

/// A listing, ready for the loop: each value has a place in a work array, behind the constants and the inputs.
#[derive(Clone, Debug)]
pub struct LoopCode {
    inputs: usize,
    constants: Vec<f64>,
    curves: Vec<Arc<Curve>>,
    batches: Vec<Batch>,
    steps: Vec<Step>,
    outputs: Vec<u32>,
    /// Length of the work array; every place of `steps` and `outputs` is below it.
    places: usize,
}

/// The last step that reads each value. Outputs are read after all steps; arguments and constants stay.
fn last_uses(listing: &Listing, order: &[usize]) -> Vec<usize> {
    let mut last_use = vec![usize::MAX; listing.operations.len()];
    for (step, &number) in order.iter().enumerate() {
        for operand in listing.operations[number].operands() {
            if !listing.operations[operand].is_leaf() {
                last_use[operand] = step;
            }
        }
    }
    listing.outputs.iter().for_each(|output| last_use[output.0 as usize] = usize::MAX);
    last_use
}

impl LoopCode {
    /// Orders the operations and assigns the places.
    pub fn new(listing: &Listing) -> Self {
        let (constants, inputs): (Vec<f64>, usize) = (listing.constants().collect(), listing.inputs);
        let order = batched_order(listing);
        let mut last_use = last_uses(listing, &order);
        let mut places = (constants.len() + inputs) as u32;
        let mut free: Vec<u32> = Vec::new();
        let mut batches: Vec<Batch> = Vec::new();
        let mut steps = Vec::with_capacity(order.len());
        let mut next_constant = 0..;
        let place_of_leaf = |operation: &Operation| match operation {
            Operation::Constant(_) => next_constant.next().unwrap_or_default(),
            Operation::Input(input) => constants.len() as u32 + input,
            _ => u32::MAX,
        };
        let mut place_of: Vec<u32> = listing.operations.iter().map(place_of_leaf).collect();
        for (step, &number) in order.iter().enumerate() {
            let operation = listing.operations[number];
            let mut operands = [0; 3];
            for (place, operand) in operands.iter_mut().zip(operation.operands()) {
                *place = place_of[operand];
                if last_use[operand] == step {
                    free.push(*place);
                    // an operand that stands twice is freed once
                    last_use[operand] = usize::MAX;
                }
            }
            let result = free.pop().unwrap_or_else(|| {
                places += 1;
                places - 1
            });
            place_of[number] = result;
            steps.push(Step { operands, result });
            let kind = operation.map(|_| Node(0));
            match batches.last_mut() {
                Some(batch) if batch.kind == kind => batch.end = steps.len(),
                _ => batches.push(Batch { kind, end: steps.len() }),
            }
        }
        let outputs: Vec<u32> = listing.outputs.iter().map(|output| place_of[output.0 as usize]).collect();
        let is_inside = |step: &Step| step.operands.into_iter().chain([step.result]).all(|place| place < places);
        assert!(steps.iter().all(is_inside), "places within the work array");
        let curves = listing.curves.clone();
        LoopCode { inputs, constants, curves, batches, steps, outputs, places: places as usize }
    }

    /// Evaluates one element with any number.
    ///
    /// * `work` grows to the length that is needed, and may be shared with other programs
    pub fn run<S: Scalar>(&self, inputs: &[S], outputs: &mut [S], work: &mut Vec<S>) {
        self.evaluate::<S, 1>(inputs, outputs, self.room(work, S::zero()));
    }

    /// Evaluates `L` elements, at most eight: number i of element l stands at L i + l, for inputs and outputs.
    ///
    /// * `work` grows to the length that is needed, and may be shared with other programs
    pub fn run_lanes<const L: usize>(&self, inputs: &[f64], outputs: &mut [f64], work: &mut Vec<F64x8>) {
        let work = self.room(work, F64x8([0.0; 8]));
        // vectors of AVX-512 gained nothing here: a result is mostly read soon after it is stored, and forwarding it
        // takes longer the wider it is
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the instructions.
            return unsafe { self.evaluate_avx2::<L>(inputs, outputs, work) };
        }
        self.evaluate::<F64x8, L>(inputs, outputs, work);
    }

    fn room<'w, N: Copy>(&self, work: &'w mut Vec<N>, zero: N) -> &'w mut [N] {
        if work.len() < self.places {
            work.resize(self.places, zero);
        }
        &mut work[..self.places]
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn evaluate_avx2<const L: usize>(&self, inputs: &[f64], outputs: &mut [f64], work: &mut [F64x8]) {
        self.evaluate::<F64x8, L>(inputs, outputs, work);
    }

    #[inline(always)]
    fn evaluate<N: Number, const L: usize>(&self, inputs: &[N::Lane], outputs: &mut [N::Lane], work: &mut [N]) {
        assert_eq!(inputs.len(), L * self.inputs, "inputs: their number times that of lanes");
        assert_eq!(outputs.len(), L * self.outputs.len(), "outputs: their number times that of lanes");
        for (place, &constant) in work.iter_mut().zip(&self.constants) {
            place.lanes().fill(constant.into());
        }
        for (place, input) in work[self.constants.len()..].iter_mut().zip(inputs.as_chunks::<L>().0) {
            place.lanes()[..L].copy_from_slice(input);
        }
        self.execute(work);
        for (output, &place) in outputs.as_chunks_mut::<L>().0.iter_mut().zip(&self.outputs) {
            output.copy_from_slice(&work[place as usize].lanes()[..L]);
        }
    }

    /// Runs all batches over the work array.
    #[inline(always)]
    fn execute<N: Number>(&self, work: &mut [N]) {
        assert_eq!(work.len(), self.places);
        let mut start = 0;
        for batch in &self.batches {
            let steps = &self.steps[start..batch.end];
            start = batch.end;
            macro_rules! each {
                ($operation:expr) => {
                    // SAFETY: `new` made sure that the places of all steps are below `places`, the length of `work`.
                    unsafe { each_step(work, steps, $operation) }
                };
            }
            // written out for operations that are one machine instruction: the loop around them has no branch then
            match batch.kind {
                Operation::Binary(Binary::Add, ..) => each!(|[x, y, _]| Binary::Add.apply(x, y)),
                Operation::Binary(Binary::Sub, ..) => each!(|[x, y, _]| Binary::Sub.apply(x, y)),
                Operation::Binary(Binary::Mul, ..) => each!(|[x, y, _]| Binary::Mul.apply(x, y)),
                Operation::Binary(Binary::Div, ..) => each!(|[x, y, _]| Binary::Div.apply(x, y)),
                Operation::Binary(Binary::Less, ..) => each!(|[x, y, _]| Binary::Less.apply(x, y)),
                Operation::Binary(Binary::Vanishing, ..) => each!(|[x, y, _]| Binary::Vanishing.apply(x, y)),
                Operation::Unary(Unary::Neg, _) => each!(|[x, _, _]| x.unary(Unary::Neg)),
                Operation::Unary(Unary::Sqrt, _) => each!(|[x, _, _]| x.unary(Unary::Sqrt)),
                Operation::Select(_) => each!(|[x, y, z]| Scalar::select(x, y, z)),
                Operation::Binary(function, ..) => each!(|[x, y, _]| function.apply(x, y)),
                Operation::Unary(function, _) => each!(|[x, _, _]| x.unary(function)),
                Operation::Power(_, bits) => each!(|[x, _, _]| Scalar::powf(x, f64::from_bits(bits))),
                Operation::Curve { curve, order, .. } => {
                    let curve = &self.curves[curve as usize];
                    each!(|[x, _, _]| x.on_curve(curve, order as usize));
                }
                Operation::Gather { count, .. } => {
                    for step in steps {
                        let [first, at, _] = step.operands.map(|place| place as usize);
                        work[step.result as usize] = work[at].gathered(&work[first..][..count as usize]);
                    }
                }
                Operation::Input(_) | Operation::Constant(_) => unreachable!("not executed"),
            }
        }
    }
}

/// Does one operation for each step.
///
/// # Safety
/// The places of the steps are below the length of `work`.
#[inline(always)]
unsafe fn each_step<N: Number>(work: &mut [N], steps: &[Step], operation: impl Fn([N::Lane; 3]) -> N::Lane) {
    for step in steps {
        // SAFETY: promised by the caller.
        unsafe {
            let operands = step.operands.map(|place| *work.get_unchecked(place as usize));
            *work.get_unchecked_mut(step.result as usize) = N::in_lanes(operands, &operation);
        }
    }
}

/// A number of the loop, or several side by side.
trait Number: Copy {
    type Lane: Scalar;
    fn lanes(&mut self) -> &mut [Self::Lane];
    /// An operation in each lane.
    fn in_lanes(operands: [Self; 3], operation: impl Fn([Self::Lane; 3]) -> Self::Lane) -> Self;
    /// The number at this place of a list.
    fn gathered(self, from: &[Self]) -> Self;
}

impl<S: Scalar> Number for S {
    type Lane = S;
    #[inline(always)]
    fn lanes(&mut self) -> &mut [S] {
        std::slice::from_mut(self)
    }
    #[inline(always)]
    fn in_lanes(operands: [S; 3], operation: impl Fn([S; 3]) -> S) -> S {
        operation(operands)
    }
    #[inline(always)]
    fn gathered(self, from: &[S]) -> S {
        self.gather(from)
    }
}

impl Number for F64x8 {
    type Lane = f64;
    #[inline(always)]
    fn lanes(&mut self) -> &mut [f64] {
        &mut self.0
    }
    #[inline(always)]
    fn in_lanes([x, y, z]: [F64x8; 3], operation: impl Fn([f64; 3]) -> f64) -> F64x8 {
        F64x8(std::array::from_fn(|lane| operation([x.0[lane], y.0[lane], z.0[lane]])))
    }
    #[inline(always)]
    fn gathered(self, from: &[F64x8]) -> F64x8 {
        F64x8(std::array::from_fn(|lane| from[gathered_place(self.0[lane], from.len())].0[lane]))
    }
}
