//! Samples for the contract tests: the same in every run, and where a test fails the simplest state in which it does is looked for.

// not every test file uses all of it
#[allow(dead_code)]
pub mod motion;
#[allow(dead_code)]
pub mod time_functions;

use proptest::collection;
use proptest::prelude::{ProptestConfig, Strategy};
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};
use std::fmt::Debug;

/// Numbers that test states are made of.
pub enum Random {
    /// Linear congruential generator of Knuth's MMIX; the high bits are good enough to scatter test states.
    Generator(u64),
    /// Chosen from outside, from -2^30 to 2^30, and how many of them are used up: whole numbers are made simpler by bisection.
    Given(Vec<i32>, usize),
}

impl Random {
    /// The sequence that belongs to `seed`.
    #[allow(dead_code)]
    pub fn new(seed: u64) -> Self {
        let mut random = Random::Generator(seed);
        // small seeds begin with small numbers: the first few are thrown away
        (0..4).for_each(|_| _ = random.uniform(0.0, 1.0));
        random
    }

    /// A number in [from, to).
    pub fn uniform(&mut self, from: f64, to: f64) -> f64 {
        let share = match self {
            Random::Generator(state) => {
                *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (*state >> 11) as f64 / (1u64 << 53) as f64
            }
            Random::Given(numbers, used) => {
                *used += 1;
                0.5 + f64::from(numbers[*used - 1]) / f64::from(1u32 << 31)
            }
        };
        from + (to - from) * share
    }

    /// `count` numbers in [-1, 1).
    pub fn vector(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.uniform(-1.0, 1.0)).collect()
    }
}

/// States that `make` builds of random numbers, and among which proptest finds simpler ones: with all numbers in the middle of their range.
fn states<T: Debug>(make: impl Fn(&mut Random) -> T) -> (TestRunner, impl Strategy<Value = T>) {
    let mut counting = Random::Given(vec![0; 1000], 0);
    make(&mut counting);
    let Random::Given(_, count) = counting else { unreachable!("it stays what it was") };
    let config =
        ProptestConfig { cases: 12, failure_persistence: None, max_shrink_iters: 2000, ..ProptestConfig::default() };
    let runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    (runner, collection::vec(-(1 << 30)..(1 << 30), count).prop_map(move |numbers| make(&mut Random::Given(numbers, 0))))
}

/// Runs a test for random states; one that fails is reported with the simplest state in which it does.
#[allow(dead_code)]
pub fn for_all<T: Debug>(name: &str, make: impl Fn(&mut Random) -> T, test: impl Fn(T)) {
    let (mut runner, states) = states(make);
    let outcome = runner.run(&states, |state| {
        test(state);
        Ok(())
    });
    if let Err(why) = outcome {
        panic!("{name}: {why}");
    }
}

/// The states of [`for_all`], for what is said of all of them together.
#[allow(dead_code)]
pub fn twelve<T: Debug>(make: impl Fn(&mut Random) -> T) -> Vec<T> {
    use proptest::strategy::ValueTree;
    let (mut runner, states) = states(make);
    (0..12).map(|_| states.new_tree(&mut runner).expect("nothing is left out").current()).collect()
}

#[test]
fn a_claim_that_fails_is_shown_the_simplest_state() {
    let claim = || for_all("squares", |random| random.vector(3), |x| assert!(x[1] < 0.25, "too large"));
    let why = std::panic::catch_unwind(claim).expect_err("a quarter is among the numbers");
    let why = why.downcast_ref::<String>().expect("in words");
    assert!(why.contains("squares") && why.contains("too large"), "{why}");
    let state = why.split("[").nth(1).expect("the state").split(']').next().expect("its end");
    let x: Vec<f64> = state.split(',').filter_map(|x| x.trim().parse().ok()).collect();
    assert!(x.len() == 3 && x[0].abs() < 1e-3 && (x[1] - 0.25).abs() < 1e-3 && x[2].abs() < 1e-3, "{why}");
}
