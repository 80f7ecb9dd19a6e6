//! Portable execution of a listing: one loop over its operations, for any number or for eight elements at a time.
//!
//! It runs in batches of equal operations ([`batches`](super::batches)), each a small loop without branches, where a
//! loop over single instructions would mispredict a jump at each of them.

use super::batches::{Kind, batched_order};
use super::listing::{Instruction, Listing, Source};
use super::operation::{Binary, Unary};
use crate::scalar::{Curve, Scalar, gathered_place};
use std::sync::Arc;

/// Eight numbers side by side: one of each of eight elements.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct F64x8(pub [f64; 8]);

/// A row of steps of the same kind.
#[derive(Clone, Debug)]
struct Batch {
    kind: Kind,
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

/// The last step that reads each value; outputs are read after all steps.
fn last_uses(listing: &Listing, order: &[usize]) -> Vec<usize> {
    let mut last_use = vec![0; listing.instructions.len()];
    for (step, &number) in order.iter().enumerate() {
        listing.instructions[number].for_each_source(|source| {
            if let Source::Value(value) = source {
                last_use[value as usize] = step;
            }
        });
    }
    for output in &listing.outputs {
        if let Source::Value(value) = output {
            last_use[*value as usize] = usize::MAX;
        }
    }
    last_use
}

impl LoopCode {
    /// Orders the instructions and assigns the places.
    pub fn new(listing: &Listing) -> Self {
        let (constants, inputs) = (listing.constants.len(), listing.inputs);
        let order = batched_order(listing);
        let mut last_use = last_uses(listing, &order);
        let mut places = constants + inputs;
        let mut place_of_value = vec![0; listing.instructions.len()];
        let mut free: Vec<u32> = Vec::new();
        let mut batches: Vec<Batch> = Vec::new();
        let mut steps = Vec::with_capacity(order.len());
        let place = |source, place_of_value: &[u32]| match source {
            Source::Constant(constant) if (constant as usize) < constants => constant,
            Source::Input(input) if (input as usize) < inputs => constants as u32 + input,
            Source::Value(value) => place_of_value[value as usize],
            _ => panic!("{source:?} of a listing with {inputs} inputs and {constants} constants"),
        };
        for (step, &number) in order.iter().enumerate() {
            let instruction = listing.instructions[number];
            let mut operands = [0; 3];
            let mut count = 0;
            instruction.for_each_source(|source| {
                operands[count] = place(source, &place_of_value);
                count += 1;
                if let Source::Value(value) = source
                    && last_use[value as usize] == step
                {
                    free.push(place_of_value[value as usize]);
                    // an operand that stands twice is freed once
                    last_use[value as usize] = usize::MAX;
                }
            });
            let result = free.pop().unwrap_or_else(|| {
                places += 1;
                places as u32 - 1
            });
            place_of_value[number] = result;
            steps.push(Step { operands, result });
            let kind = Kind::of(instruction);
            match batches.last_mut() {
                Some(batch) if batch.kind == kind => batch.end = steps.len(),
                _ => batches.push(Batch { kind, end: steps.len() }),
            }
        }
        let outputs: Vec<u32> = listing.outputs.iter().map(|&source| place(source, &place_of_value)).collect();
        let in_range = |place: u32| (place as usize) < places;
        assert!(outputs.iter().all(|&place| in_range(place)), "outputs within the work array");
        assert!(steps.iter().all(|step| in_range(step.result)), "results within the work array");
        assert!(steps.iter().all(|step| places == 0 || step.operands.into_iter().all(in_range)), "operands within it");
        let is_inside = |instruction: &Instruction| match *instruction {
            Instruction::Gather { first, count, .. } => count > 0 && (first + count) as usize <= inputs,
            _ => true,
        };
        assert!(listing.instructions.iter().all(is_inside), "what is gathered is among the inputs");
        let curves = listing.curves.clone();
        LoopCode { inputs, constants: listing.constants.clone(), curves, batches, steps, outputs, places }
    }

    /// Evaluates one element with any number.
    ///
    /// * `work` grows to the length that is needed, and may be shared with other programs
    pub fn run<S: Scalar>(&self, inputs: &[S], outputs: &mut [S], work: &mut Vec<S>) {
        assert_eq!(inputs.len(), self.inputs, "number of inputs");
        assert_eq!(outputs.len(), self.outputs.len(), "number of outputs");
        if work.len() < self.places {
            work.resize(self.places, S::from(0.0));
        }
        let work = &mut work[..self.places];
        for (place, &constant) in work.iter_mut().zip(&self.constants) {
            *place = S::from(constant);
        }
        work[self.constants.len()..][..self.inputs].copy_from_slice(inputs);
        self.execute(work);
        for (output, &place) in outputs.iter_mut().zip(&self.outputs) {
            *output = work[place as usize];
        }
    }

    /// Evaluates `L` elements, at most eight: number i of element l stands at L i + l, for inputs and outputs.
    ///
    /// * `work` grows to the length that is needed, and may be shared with other programs
    pub fn run_lanes<const L: usize>(&self, inputs: &[f64], outputs: &mut [f64], work: &mut Vec<F64x8>) {
        assert_eq!(inputs.len(), L * self.inputs, "inputs: their number times that of lanes");
        assert_eq!(outputs.len(), L * self.outputs.len(), "outputs: their number times that of lanes");
        if work.len() < self.places {
            work.resize(self.places, F64x8([0.0; 8]));
        }
        let work = &mut work[..self.places];
        // vectors of AVX-512 gained nothing here: a result is mostly read soon after it is stored, and forwarding it
        // takes longer the wider it is
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has the instructions.
            return unsafe { self.lanes_avx2::<L>(inputs, outputs, work) };
        }
        self.lanes::<L>(inputs, outputs, work);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn lanes_avx2<const L: usize>(&self, inputs: &[f64], outputs: &mut [f64], work: &mut [F64x8]) {
        self.lanes::<L>(inputs, outputs, work);
    }

    #[inline(always)]
    fn lanes<const L: usize>(&self, inputs: &[f64], outputs: &mut [f64], work: &mut [F64x8]) {
        for (place, &constant) in work.iter_mut().zip(&self.constants) {
            *place = F64x8([constant; 8]);
        }
        for (place, input) in work[self.constants.len()..].iter_mut().zip(inputs.as_chunks::<L>().0) {
            place.0[..L].copy_from_slice(input);
        }
        self.execute(work);
        for (output, &place) in outputs.as_chunks_mut::<L>().0.iter_mut().zip(&self.outputs) {
            output.copy_from_slice(&work[place as usize].0[..L]);
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
                Kind::Binary(Binary::Add) => each!(|[x, y, _]| N::binary(Binary::Add, x, y)),
                Kind::Binary(Binary::Sub) => each!(|[x, y, _]| N::binary(Binary::Sub, x, y)),
                Kind::Binary(Binary::Mul) => each!(|[x, y, _]| N::binary(Binary::Mul, x, y)),
                Kind::Binary(Binary::Div) => each!(|[x, y, _]| N::binary(Binary::Div, x, y)),
                Kind::Binary(Binary::Less) => each!(|[x, y, _]| N::binary(Binary::Less, x, y)),
                Kind::Binary(Binary::Vanishing) => each!(|[x, y, _]| N::binary(Binary::Vanishing, x, y)),
                Kind::Unary(Unary::Neg) => each!(|[x, _, _]| N::unary(Unary::Neg, x)),
                Kind::Unary(Unary::Sqrt) => each!(|[x, _, _]| N::unary(Unary::Sqrt, x)),
                Kind::Select => each!(|[x, y, z]| N::choose(x, y, z)),
                Kind::Binary(function) => each!(|[x, y, _]| N::binary(function, x, y)),
                Kind::Unary(function) => each!(|[x, _, _]| N::unary(function, x)),
                Kind::Power(exponent) => each!(|[x, _, _]| x.power(exponent)),
                Kind::Curve { curve, order } => {
                    let curve = &self.curves[curve as usize];
                    each!(|[x, _, _]| x.on(curve, order as usize));
                }
                Kind::Gather { first, count } => {
                    let first = self.constants.len() + first as usize;
                    for step in steps {
                        let at = work[step.operands[0] as usize];
                        work[step.result as usize] = at.gathered(&work[first..][..count as usize]);
                    }
                }
            }
        }
    }
}

/// Does one operation for each step.
///
/// # Safety
/// The places of the steps are below the length of `work`.
#[inline(always)]
unsafe fn each_step<N: Number>(work: &mut [N], steps: &[Step], operation: impl Fn([N; 3]) -> N) {
    for step in steps {
        // SAFETY: promised by the caller.
        unsafe {
            let operands = step.operands.map(|place| *work.get_unchecked(place as usize));
            *work.get_unchecked_mut(step.result as usize) = operation(operands);
        }
    }
}

/// What the loop does with a number.
trait Number: Copy {
    fn unary(function: Unary, x: Self) -> Self;
    fn binary(function: Binary, x: Self, y: Self) -> Self;
    fn choose(mask: Self, then: Self, otherwise: Self) -> Self;
    fn power(self, exponent: f64) -> Self;
    fn on(self, curve: &Arc<Curve>, order: usize) -> Self;
    fn gathered(self, from: &[Self]) -> Self;
}

impl<S: Scalar> Number for S {
    #[inline(always)]
    fn unary(function: Unary, x: S) -> S {
        function.apply(x)
    }
    #[inline(always)]
    fn binary(function: Binary, x: S, y: S) -> S {
        function.apply(x, y)
    }
    #[inline(always)]
    fn choose(mask: S, then: S, otherwise: S) -> S {
        mask.select(then, otherwise)
    }
    #[inline(always)]
    fn power(self, exponent: f64) -> S {
        self.powf(exponent)
    }
    #[inline(always)]
    fn on(self, curve: &Arc<Curve>, order: usize) -> S {
        self.on_curve(curve, order)
    }
    #[inline(always)]
    fn gathered(self, from: &[S]) -> S {
        self.gather(from)
    }
}

impl Number for F64x8 {
    #[inline(always)]
    fn unary(function: Unary, x: F64x8) -> F64x8 {
        F64x8(x.0.map(|x| function.apply(x)))
    }
    #[inline(always)]
    fn binary(function: Binary, x: F64x8, y: F64x8) -> F64x8 {
        F64x8(std::array::from_fn(|lane| function.apply(x.0[lane], y.0[lane])))
    }
    #[inline(always)]
    fn choose(mask: F64x8, then: F64x8, otherwise: F64x8) -> F64x8 {
        F64x8(std::array::from_fn(|lane| Scalar::select(mask.0[lane], then.0[lane], otherwise.0[lane])))
    }
    #[inline(always)]
    fn power(self, exponent: f64) -> F64x8 {
        F64x8(self.0.map(|x| Scalar::powf(x, exponent)))
    }
    #[inline(always)]
    fn on(self, curve: &Arc<Curve>, order: usize) -> F64x8 {
        F64x8(self.0.map(|x| x.on_curve(curve, order)))
    }
    #[inline(always)]
    fn gathered(self, from: &[F64x8]) -> F64x8 {
        F64x8(std::array::from_fn(|lane| from[gathered_place(self.0[lane], from.len())].0[lane]))
    }
}
