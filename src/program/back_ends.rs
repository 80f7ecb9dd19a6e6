//! Tests of all ways to execute a listing: each gives the bits of plain evaluation, on random listings.

use super::graph::Graph;
use super::listing::Listing;
use super::loop_code::LoopCode;
use super::native::NativeCode;
use super::operation::{Binary, Node, Unary};
use crate::scalar::{Curve, Interpolant};

/// Marsaglia's xorshift generator with a multiplication behind it.
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11
    }
    fn below(&mut self, limit: usize) -> usize {
        (self.bits() % limit as u64) as usize
    }
    /// A number between 0 and 1.
    fn unit(&mut self) -> f64 {
        self.bits() as f64 / 2.0_f64.powi(53)
    }
    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
    /// Mostly ordinary numbers, sometimes those with rules of their own.
    fn number(&mut self) -> f64 {
        let ordinary = [self.unit(), -self.unit(), 20.0 * self.unit() - 10.0, 1e3 * self.unit()];
        let special = [0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300, 1e-310, 0.5, -2.0];
        if self.below(4) == 0 { self.pick(&special) } else { self.pick(&ordinary) }
    }
}

const UNARY: [Unary; 14] = [
    Unary::Neg,
    Unary::Sqrt,
    Unary::Exp,
    Unary::Ln,
    Unary::Sin,
    Unary::Cos,
    Unary::Tan,
    Unary::Asin,
    Unary::Acos,
    Unary::Atan,
    Unary::Sinh,
    Unary::Cosh,
    Unary::Tanh,
    Unary::Floor,
];
const BINARY: [Binary; 7] =
    [Binary::Add, Binary::Sub, Binary::Mul, Binary::Div, Binary::Atan2, Binary::Less, Binary::Vanishing];

/// A recording with results and a number of arguments.
#[derive(Debug, Default)]
struct Recorded {
    graph: Graph,
    outputs: Vec<Node>,
    inputs: usize,
}

impl Recorded {
    fn listing(&self) -> Listing {
        Listing::of(&self.graph, &self.outputs, self.inputs)
    }
}

/// A recording of any operations; `calls` in a thousand are functions that machine code has to call.
fn random_recording(random: &mut Random, calls: usize) -> Recorded {
    let length = random.pick(&[1, 2, 3, 10, 50, 150, 400]);
    let count = random.pick(&[0, 1, 3, 12, 80, 300]);
    // operands near by keep few values alive, any operands many
    let reach = random.pick(&[3, 30, 1000]);
    let curve = |way| Curve::new(&[-0.5, 0.2, 0.9], &[0.3, -1.0, 2.0], way).expect("increasing knots");
    let curves = [Interpolant::Smooth, Interpolant::Lines].map(curve);
    let mut graph = Graph::default();
    let inputs: Vec<Node> = (0..count).map(|index| graph.input(index)).collect();
    let constants: Vec<Node> = (0..random.pick(&[1, 4, 40])).map(|_| graph.constant(random.number())).collect();
    let mut made: Vec<Node> = Vec::new();
    let operand = |random: &mut Random, made: &[Node]| loop {
        match random.below(8) {
            0 => return random.pick(&constants),
            1 if count > 0 => return random.pick(&inputs),
            2.. if !made.is_empty() => return made[made.len() - 1 - random.below(made.len().min(reach))],
            _ => {}
        }
    };
    for _ in 0..length {
        let x = operand(random, &made);
        let y = if random.below(12) == 0 { x } else { operand(random, &made) };
        let z = if random.below(12) == 0 { x } else { operand(random, &made) };
        made.push(if random.below(1000) < calls {
            match random.below(6) {
                3 if count > 0 => {
                    let first = random.below(count);
                    graph.gather(&inputs[first..][..1 + random.below(count - first)], x)
                }
                0 => graph.power(x, random.pick(&[2.0, 0.5, -1.5, 3.0])),
                1 => graph.on_curve(&curves[random.below(2)], random.below(3), x),
                2 => graph.binary(Binary::Atan2, x, y),
                _ => graph.unary(random.pick(&UNARY[2..13]), x),
            }
        } else {
            match random.below(10) {
                0 => graph.select(x, y, z),
                1 => graph.unary(random.pick(&[Unary::Neg, Unary::Sqrt, Unary::Floor]), x),
                2 => graph.binary(random.pick(&BINARY[5..]), x, y),
                _ => graph.binary(random.pick(&BINARY[..4]), x, y),
            }
        });
    }
    let mut outputs: Vec<Node> = (0..random.pick(&[1, 5, 60])).map(|_| operand(random, &made)).collect();
    if random.below(2) == 0 {
        outputs.extend(vec![made[length - 1]; random.below(20)]);
    }
    Recorded { graph, outputs, inputs: count }
}

#[track_caller]
fn assert_same_bits(found: &[f64], expected: &[f64], way: &str, listing: &Listing) {
    assert_eq!(found.len(), expected.len());
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        let same = found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan();
        assert!(same, "{way}: number {place} is {found}, not {expected}; {listing:?}");
    }
}

/// The numbers of several elements side by side.
fn side_by_side(elements: &[Vec<f64>]) -> Vec<f64> {
    (0..elements[0].len()).flat_map(|number| elements.iter().map(move |element| element[number])).collect()
}

/// Machine code by its name, for so many lanes.
type Native = (String, usize, NativeCode);

fn run(code: &NativeCode, inputs: &[f64], outputs: &mut [f64], scratch: &mut Vec<f64>) {
    (0..code.sections()).for_each(|section| code.run_section(section, inputs, outputs, scratch));
}

/// Codes for all numbers of lanes and of all instruction sets that this machine has.
#[cfg(all(any(target_arch = "x86_64", all(target_arch = "aarch64", target_os = "linux")), not(miri)))]
fn native_codes(listing: &Listing) -> Vec<Native> {
    use super::native::Level;
    let mut codes = Vec::new();
    for level in Level::ALL {
        for lanes in [1, 2, 4, 8] {
            for section in [400, 1 << 20] {
                let code = NativeCode::compile_for(listing, lanes, level, section);
                let name = format!("{lanes} lanes with {level:?}, sections of {section} bytes");
                codes.extend(code.map(|code| (name, lanes, code)));
            }
        }
    }
    codes
}

#[cfg(not(all(any(target_arch = "x86_64", all(target_arch = "aarch64", target_os = "linux")), not(miri))))]
fn native_codes(_listing: &Listing) -> Vec<Native> {
    Vec::new()
}

fn check_loop<const L: usize>(code: &LoopCode, listing: &Listing, elements: &[Vec<f64>], expected: &[Vec<f64>]) {
    let mut outputs = vec![7.0; L * listing.outputs.len()];
    code.run_lanes::<L>(&side_by_side(&elements[..L]), &mut outputs, &mut Vec::new());
    assert_same_bits(&outputs, &side_by_side(&expected[..L]), &format!("loop of {L} lanes"), listing);
}

fn check(recorded: &Recorded, random: &mut Random) {
    let listing = &recorded.listing();
    let elements: Vec<Vec<f64>> = (0..8).map(|_| (0..listing.inputs).map(|_| random.number()).collect()).collect();
    let expected: Vec<Vec<f64>> = elements.iter().map(|x| recorded.graph.values_of(&recorded.outputs, x)).collect();
    let code = LoopCode::new(listing);
    let mut outputs = vec![7.0; listing.outputs.len()];
    let mut work = Vec::new();
    for (inputs, expected) in elements.iter().zip(&expected) {
        code.run::<f64>(inputs, &mut outputs, &mut work);
        assert_same_bits(&outputs, expected, "loop", listing);
    }
    check_loop::<8>(&code, listing, &elements, &expected);
    check_loop::<4>(&code, listing, &elements, &expected);
    check_loop::<2>(&code, listing, &elements, &expected);

    let mut scratch = Vec::new();
    for (way, lanes, code) in native_codes(listing) {
        for start in (0..8).step_by(lanes) {
            // one number more behind the outputs must stay as it is
            let mut outputs = vec![7.0; lanes * listing.outputs.len() + 1];
            let (inside, behind) = outputs.split_at_mut(lanes * listing.outputs.len());
            run(&code, &side_by_side(&elements[start..start + lanes]), inside, &mut scratch);
            assert_same_bits(inside, &side_by_side(&expected[start..start + lanes]), &way, listing);
            assert_eq!(behind, [7.0], "{way} wrote behind its outputs");
        }
    }
}

#[test]
fn every_way_gives_the_bits_of_plain_evaluation() {
    let mut random = Random::new(1);
    for _ in 0..1500 {
        check(&random_recording(&mut random, 0), &mut random);
    }
}

#[test]
fn calls_keep_every_number_that_is_read_later() {
    let mut random = Random::new(2);
    for calls in [1000, 200, 20] {
        for _ in 0..500 {
            check(&random_recording(&mut random, calls), &mut random);
        }
    }
}

#[test]
fn long_listings_reach_the_far_addresses() {
    let mut random = Random::new(3);
    let (inputs, half) = (2000, 3000);
    let mut graph = Graph::default();
    let arguments: Vec<Node> = (0..inputs).map(|index| graph.input(index)).collect();
    let constants: Vec<Node> = (0..700).map(|_| graph.constant(random.number())).collect();
    // all inputs and constants, then all values a second time in the order in which they were made
    let mut values = Vec::new();
    for number in 0..half {
        let function = random.pick(&BINARY[..3]);
        values.push(graph.binary(function, arguments[number % inputs], random.pick(&constants)));
    }
    for number in 0..half {
        let before = values[random.below(half)];
        values.push(graph.binary(random.pick(&BINARY), values[number], before));
    }
    let outputs = values.into_iter().rev().step_by(2).collect();
    let recorded = Recorded { graph, outputs, inputs };
    let short = |(way, ..): &Native| way.ends_with("sections of 400 bytes");
    assert!(native_codes(&recorded.listing()).iter().filter(|code| short(code)).all(|(.., code)| code.sections() > 50));
    check(&recorded, &mut random);
}

#[test]
fn recordings_without_operations_run() {
    let mut random = Random::new(4);
    check(&Recorded::default(), &mut random);
    let mut graph = Graph::default();
    let (_, input, constant) = (graph.input(0), graph.input(1), graph.constant(0.5));
    check(&Recorded { graph, outputs: vec![input, constant, input], inputs: 2 }, &mut random);
}

#[test]
fn runs_allocate_once_and_share_their_work_arrays() {
    let mut random = Random::new(5);
    let listing = random_recording(&mut random, 10).listing();
    let inputs = vec![0.5; 8 * listing.inputs];
    let mut outputs = vec![0.0; 8 * listing.outputs.len()];
    let code = LoopCode::new(&listing);
    let mut work = Vec::new();
    code.run_lanes::<8>(&inputs, &mut outputs, &mut work);
    let first = (work.as_ptr(), work.len());
    code.run_lanes::<8>(&inputs, &mut outputs, &mut work);
    assert_eq!(first, (work.as_ptr(), work.len()));
    if let Some(code) = NativeCode::compile(&listing, 8) {
        let mut scratch = Vec::new();
        run(&code, &inputs, &mut outputs, &mut scratch);
        let first = (scratch.as_ptr(), scratch.len());
        run(&code, &inputs, &mut outputs, &mut scratch);
        assert_eq!(first, (scratch.as_ptr(), scratch.len()));
    }
}

/// Mappings of this process, as Linux tells them.
#[test]
#[cfg(all(any(target_arch = "x86_64", target_arch = "aarch64"), target_os = "linux", not(miri)))]
fn no_memory_is_writable_and_executable_at_once() {
    let mut random = Random::new(6);
    let listing = random_recording(&mut random, 10).listing();
    let codes = native_codes(&listing);
    let maps = std::fs::read_to_string("/proc/self/maps").expect("the list of mappings");
    let permissions = |line: &str| line.split(' ').nth(1).map(str::to_owned);
    assert!(maps.lines().filter_map(permissions).all(|own| !(own.contains('w') && own.contains('x'))));
    assert_eq!(codes.is_empty(), !super::native::Level::ALL.into_iter().any(|level| level.is_available(1)));
}
