//! The laws of `Scalar`, for every number type and every function.
//!
//! A new type is one line in `types!` and one `Probe`; a new function is one line in `functions!`.

use crate::support::Random;
use costate::internals::{Formula, Graph, Moving, Node, Program, ProgramWork, Recorded, record};
use costate::scalar::{COMPLEX_STEP, Complex64, Curve, Interpolant, Scalar, TANGENTS, Tangents};
use num_dual::{Derivative, Dual2_64, Dual64, HyperDual64};
use std::sync::{Arc, OnceLock};

/// f(x) and every derivative that a type found for it: the entries of `first` are all f'(x), those of `second` all f''(x).
#[derive(Debug)]
struct Parts {
    value: f64,
    first: Vec<f64>,
    second: Vec<f64>,
}

/// How derivatives enter and leave a type.
trait Probe: Scalar {
    /// Whether it takes num-dual's own functions, whose values may differ in the last bit.
    const FOREIGN: bool = false;
    /// Whether values have the bits of real numbers in quotients, too.
    const EXACT: bool = false;
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts;
}

/// A different seed in each place, so that derivatives that are swapped or shared show.
fn seed(place: usize) -> f64 {
    (place + 1) as f64
}

/// Curvature of the path on which numbers with second derivatives move: f(x(s))'' = f'' + f' x'' with x' = 1.
const BEND: f64 = 0.5;

impl Probe for f64 {
    const EXACT: bool = true;
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        Parts { value: f(x), first: vec![], second: vec![] }
    }
}
impl Probe for Complex64 {
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let y = f(Complex64::new(x, COMPLEX_STEP));
        Parts { value: y.re, first: vec![y.im / COMPLEX_STEP], second: vec![] }
    }
}
impl Probe for Dual64 {
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let y = f(Dual64::new(x, 1.0));
        Parts { value: y.re, first: vec![y.eps], second: vec![] }
    }
}
impl Probe for Moving<f64> {
    const EXACT: bool = true;
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let y = f(Moving::new(x, 1.0));
        Parts { value: y.value, first: vec![y.rate], second: vec![] }
    }
}

fn tangents(x: f64) -> Tangents {
    Tangents::new(x, Derivative::some(nalgebra::SVector::from_fn(|place, _| seed(place))))
}

impl Probe for Tangents {
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let y = f(tangents(x));
        let eps = y.eps.0.unwrap_or_else(nalgebra::SVector::zeros);
        Parts { value: y.re, first: (0..TANGENTS).map(|k| eps[k] / seed(k)).collect(), second: vec![] }
    }
}
impl Probe for Dual2_64 {
    const FOREIGN: bool = true;
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let y = f(Dual2_64::new(x, 1.0, BEND));
        Parts { value: y.re, first: vec![y.v1], second: vec![y.v2 - BEND * y.v1] }
    }
}
impl Probe for HyperDual64 {
    const FOREIGN: bool = true;
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let y = f(HyperDual64::new(x, 1.0, 2.0, BEND));
        Parts { value: y.re, first: vec![y.eps1, y.eps2 / 2.0], second: vec![(y.eps1eps2 - BEND * y.eps1) / 2.0] }
    }
}

/// The results of a program of one argument.
fn run(program: &Program, x: f64) -> Vec<f64> {
    let mut results = vec![0.0; program.outputs()];
    program.run(&[x], &mut results, &mut ProgramWork::default());
    results
}

/// Derivatives that are made of recordings: forward and in reverse, and each of both.
impl Probe for Recorded {
    const EXACT: bool = true;
    fn probe(x: f64, f: impl Fn(Self) -> Self) -> Parts {
        let formula = Formula::record(1, |x| vec![f(x[0])]).expect("it chooses by `select`");
        let derive = |graph: &mut Graph, x: &[Node], of: &[Node]| -> [Node; 2] {
            let one = graph.constant(1.0);
            [graph.forward(of, &[(x[0], one)])[0], graph.reverse(of, &[one], &x[..1])[0]]
        };
        let first = formula.dense_program(("own 1", Default::default()), 0, |graph, x, y| derive(graph, x, y).to_vec());
        let second = formula.dense_program(("own 2", Default::default()), 0, |graph, x, y| {
            derive(graph, x, y).into_iter().flat_map(|first| derive(graph, x, &[first])).collect()
        });
        Parts { value: run(formula.values(), x)[0], first: run(&first, x), second: run(&second, x) }
    }
}

/// A function of one variable, written for every scalar and differentiated on paper.
trait Function {
    const NAME: &'static str;
    /// Places inside the domain, away from singular points.
    const POINTS: &'static [f64];
    fn at<S: Scalar>(x: S) -> S;
    /// [f'(x), f''(x)].
    fn derivatives(x: f64) -> [f64; 2];
}

/// A spline and straight lines over the same knots.
fn curves() -> &'static [Arc<Curve>; 2] {
    static CURVES: OnceLock<[Arc<Curve>; 2]> = OnceLock::new();
    let new = |interpolant| Curve::new(&[-0.7, -0.2, 0.1, 0.8], &VALUES, interpolant).expect("increasing knots");
    CURVES.get_or_init(|| [Interpolant::Smooth, Interpolant::Lines].map(new))
}

const VALUES: [f64; 4] = [0.5, -0.3, 0.9, 0.2];

fn slope_of(curve: usize, order: usize, x: f64) -> f64 {
    curves()[curve].value(order, x)
}

#[test]
fn derivatives_of_curves_are_the_slopes_of_those_of_one_order_less() {
    for curve in curves() {
        for order in 0..3 {
            for x in [-1.1, -0.5, -0.1, 0.0, 0.4, 0.6, 1.7] {
                let slope = slope_by_differences(|x: f64| curve.value(order, x), x);
                let own = curve.value(order + 1, x);
                assert!((own - slope).abs() < 1e-8 * own.abs().max(1.0), "order {order}, {x}: {own} {slope}");
            }
        }
    }
}

/// Something to be done with every function of the list.
trait Visitor {
    fn visit<F: Function>(&mut self);
}

macro_rules! functions {
    ($($name:ident($x:ident) = $f:expr, first $first:expr, second $second:expr, at [$($point:expr),*];)*) => {
        $(
            #[allow(non_camel_case_types)]
            struct $name;
            impl Function for $name {
                const NAME: &'static str = stringify!($name);
                const POINTS: &'static [f64] = &[$($point),*];
                fn at<S: Scalar>($x: S) -> S { $f }
                #[allow(unused_variables)]
                fn derivatives($x: f64) -> [f64; 2] { [$first, $second] }
            }
        )*
        fn visit_functions(visitor: &mut impl Visitor) { $(visitor.visit::<$name>();)* }
    };
}

functions! {
    sqrt(x) = x.sqrt(), first 0.5 / x.sqrt(), second -0.25 / (x * x.sqrt()), at [1e-3, 0.4, 3.0, 1e8];
    exp(x) = x.exp(), first x.exp(), second x.exp(), at [-3.0, 0.0, 0.7, 20.0];
    ln(x) = x.ln(), first 1.0 / x, second -1.0 / (x * x), at [1e-3, 0.4, 1.0, 50.0];
    sin(x) = x.sin(), first x.cos(), second -x.sin(), at [-2.0, 0.0, 0.7, 30.0];
    cos(x) = x.cos(), first -x.sin(), second -x.cos(), at [-2.0, 0.0, 0.7, 30.0];
    tan(x) = x.tan(), first x.cos().powi(-2), second 2.0 * x.tan() * x.cos().powi(-2), at [-1.2, 0.0, 0.7, 2.0];
    asin(x) = x.asin(), first (1.0 - x * x).powf(-0.5), second x * (1.0 - x * x).powf(-1.5), at [-0.9, -1e-9, 0.0, 0.4, 0.75];
    acos(x) = x.acos(), first -(1.0 - x * x).powf(-0.5), second -x * (1.0 - x * x).powf(-1.5), at [-0.9, -1e-9, 0.0, 0.4, 0.75];
    atan(x) = x.atan(), first 1.0 / (1.0 + x * x), second -2.0 * x / (1.0 + x * x).powi(2), at [-40.0, -1.0, 0.0, 0.4, 3.0];
    sinh(x) = x.sinh(), first x.cosh(), second x.sinh(), at [-2.0, 0.0, 0.7, 5.0];
    cosh(x) = x.cosh(), first x.sinh(), second x.cosh(), at [-2.0, 0.0, 0.7, 5.0];
    tanh(x) = x.tanh(), first x.cosh().powi(-2), second -2.0 * x.tanh() * x.cosh().powi(-2), at [-1.5, 0.0, 0.3, 1.2];
    recip(x) = x.recip(), first -1.0 / (x * x), second 2.0 / (x * x * x), at [-2.0, 0.01, 0.7, 30.0];
    cube(x) = x.powi(3), first 3.0 * x * x, second 6.0 * x, at [-2.0, 0.0, 0.7];
    square(x) = x.powi(2), first 2.0 * x, second 2.0, at [-2.0, 0.0, 0.7];
    first_power(x) = x.powi(1), first 1.0, second 0.0, at [-2.0, 0.0, 0.7];
    zeroth_power(x) = x.powi(0), first 0.0, second 0.0, at [-2.0, 0.0, 0.7];
    inverse_square(x) = x.powi(-2), first -2.0 / (x * x * x), second 6.0 / x.powi(4), at [-2.0, 0.7];
    real_power(x) = x.powf(1.7), first 1.7 * x.powf(0.7), second 1.7 * 0.7 * x.powf(-0.3), at [1e-3, 0.7, 20.0];
    real_power_at_zero(x) = x.powf(3.5), first 3.5 * x.powf(2.5), second 8.75 * x.powf(1.5), at [0.0, 0.2];
    negative_real_power(x) = x.powf(-0.5), first -0.5 * x.powf(-1.5), second 0.75 * x.powf(-2.5), at [0.01, 0.7, 20.0];
    integer_power_of_negative(x) = x.powf(3.0), first 3.0 * x * x, second 6.0 * x, at [-2.0, -0.1, 0.0, 0.7];
    square_as_real_power(x) = x.powf(2.0), first 2.0 * x, second 2.0, at [-2.0, 0.0, 0.7];
    unit_real_power(x) = x.powf(1.0), first 1.0, second 0.0, at [-2.0, 0.0, 0.7];
    atan2_of_ordinate(x) = x.atan2(S::from(-0.7)), first -0.7 / (x * x + 0.49), second 1.4 * x / (x * x + 0.49).powi(2),
        at [-2.0, -0.3, 0.7, 4.0];
    atan2_of_abscissa(x) = S::from(0.7).atan2(x), first -0.7 / (x * x + 0.49), second 1.4 * x / (x * x + 0.49).powi(2),
        at [-2.0, 0.0, 0.7, 4.0];
    // on a circle the angle is the parameter itself; both arguments move
    atan2_on_a_circle(x) = (x.sin() * 3.0).atan2(x.cos() * 3.0), first 1.0, second 0.0, at [-2.0, -0.5, 0.0, 1.0, 3.0];
    absolute(x) = x.abs(), first x.signum(), second 0.0, at [-2.0, -1e-3, 0.7];
    larger(x) = (x * x).max(x), first if (0.0..=1.0).contains(&x) { 1.0 } else { 2.0 * x }, second
        if (0.0..=1.0).contains(&x) { 0.0 } else { 2.0 }, at [-2.0, 0.5, 3.0];
    sine_times_cosine(x) = { let (s, c) = x.sin_cos(); s * c }, first (2.0 * x).cos(), second -2.0 * (2.0 * x).sin(),
        at [-2.0, 0.0, 0.6];
    negative(x) = -x, first -1.0, second 0.0, at [-2.0, 0.0, 0.7];
    sum_with_number(x) = x + 3.0, first 1.0, second 0.0, at [-2.0, 0.7];
    difference_with_number(x) = x - 3.0, first 1.0, second 0.0, at [-2.0, 0.7];
    product_with_number(x) = x * 3.0, first 3.0, second 0.0, at [-2.0, 0.7];
    quotient_by_number(x) = x / 3.0, first 1.0 / 3.0, second 0.0, at [-2.0, 0.7];
    sum(x) = x + x * x, first 1.0 + 2.0 * x, second 2.0, at [-2.0, 0.7];
    difference(x) = x - x * x, first 1.0 - 2.0 * x, second -2.0, at [-2.0, 0.7];
    product(x) = (x + 1.0) * (x * x), first 3.0 * x * x + 2.0 * x, second 6.0 * x + 2.0, at [-2.0, 0.7];
    quotient(x) = x / (x * x + 1.0), first (1.0 - x * x) / (1.0 + x * x).powi(2),
        second 2.0 * x * (x * x - 3.0) / (1.0 + x * x).powi(3), at [-2.0, 0.0, 0.7];
    sum_of_terms(x) = [x, x * x, S::one(), S::zero()].into_iter().sum(), first 1.0 + 2.0 * x, second 2.0, at [-2.0, 0.7];
    smaller(x) = (x * x).min(x), first if (0.0..=1.0).contains(&x) { 2.0 * x } else { 1.0 }, second
        if (0.0..=1.0).contains(&x) { 2.0 } else { 0.0 }, at [-2.0, 0.5, 3.0];
    signed(x) = x.sign() * x, first x.signum(), second 0.0, at [-2.0, -1e-3, 0.7];
    sawtooth(x) = x - x.floor(), first 1.0, second 0.0, at [-2.3, -0.5, 0.7];
    mask(x) = x.less(S::from(0.5)) * x, first if x < 0.5 { 1.0 } else { 0.0 }, second 0.0, at [-2.0, 0.7];
    selected(x) = x.less(S::one()).select(x * x, x.exp()), first if x < 1.0 { 2.0 * x } else { x.exp() }, second
        if x < 1.0 { 2.0 } else { x.exp() }, at [-2.0, 0.7, 1.0, 1.4];
    // what is not taken is not a number, and has derivatives that are none
    guarded_root(x) = S::zero().less(x).select(x * x.sqrt() * x.ln() / (x - x * 1.5).sqrt().abs(), x * x), first 2.0 * x, second 2.0,
        at [-0.7, -0.01];
    guarded_quotient(x) = (x * x).less(S::from(0.25)).select(x * 3.0, S::one() / ((x * x - 0.09).ln() + x.exp() * 1e300 * 1e300)),
        first 3.0, second 0.0, at [0.3, -0.3, 0.0];
    vanishing(x) = x.sin().vanishing_times(x), first x.sin() + x * x.cos(), second 2.0 * x.cos() - x * x.sin(), at [-2.0, 0.7];
    // zero times what is infinite
    vanished(x) = x.floor().vanishing_times((x - 0.25).ln()) + x, first 1.0, second 0.0, at [0.25, 0.1];
    spline(x) = x.on_curve(&curves()[0], 0), first slope_of(0, 1, x), second slope_of(0, 2, x),
        at [-2.0, -0.6, -0.2, 0.0, 0.4, 0.8, 3.0];
    lines(x) = x.on_curve(&curves()[1], 0), first slope_of(1, 1, x), second 0.0, at [-2.0, -0.6, 0.0, 0.4, 3.0];
    assigned(x) = { let mut y = x; y += x * x; y *= x; y -= x; y /= x; y }, first 2.0 * x + 1.0, second 2.0, at [-2.0, 0.7];
}

/// Compares all derivatives with the table, relative to the largest derivative of the function at that place.
struct AgainstTable<T>(std::marker::PhantomData<T>, &'static str);

impl<T: Probe> Visitor for AgainstTable<T> {
    fn visit<F: Function>(&mut self) {
        for &x in F::POINTS {
            let parts = T::probe(x, F::at);
            let [first, second] = F::derivatives(x);
            let place = format!("{} in {} at {x}: {parts:?}, expected derivatives {first}, {second}", F::NAME, self.1);
            let off = (parts.value - F::at(x)).abs();
            // quotients of complex and dual numbers round otherwise, and so do num-dual's own functions
            let rounds = T::FOREIGN || F::NAME.contains("quotient") || F::NAME == "assigned";
            // -0 is recorded as 0
            let same = if rounds && !T::EXACT { off <= 3e-16 * parts.value.abs() } else { off == 0.0 };
            assert!(same, "value of {place}");
            let close = |computed: f64, expected: f64, scale: f64| (computed - expected).abs() <= 1e-14 * scale;
            assert!(parts.first.iter().all(|&d| close(d, first, first.abs().max(f64::MIN_POSITIVE))), "{place}");
            // a second derivative is read off sums that also hold f' x'', so its round-off has that size
            assert!(parts.second.iter().all(|&d| close(d, second, first.abs() + second.abs())), "{place}");
        }
    }
}

/// A random formula: each step makes a new number of moderate size from earlier ones.
struct RandomFormula(Vec<(usize, usize, usize)>);

impl RandomFormula {
    const OPERATIONS: usize = 22;
    const STEPS: usize = 12;

    fn random(random: &mut Random) -> Self {
        let mut index = |count: usize| random.uniform(0.0, count as f64) as usize;
        RandomFormula((0..Self::STEPS).map(|k| (index(Self::OPERATIONS), index(k + 2), index(k + 2))).collect())
    }

    fn at<S: Scalar>(&self, x: S) -> S {
        let mut known = vec![x, -x * 0.5 + 0.8];
        for &(operation, i, j) in &self.0 {
            let (a, b) = (known[i], known[j]);
            let next = match operation {
                0 => a + b,
                1 => a - b,
                2 => a * b,
                3 => a / (b * b + 1.0),
                4 => (a * a + 0.5).sqrt(),
                5 => (a.tanh() + b.tanh()).exp(),
                6 => (a * a + 0.5).ln(),
                7 => a.sin(),
                8 => b.cos(),
                9 => a.atan().tan(),
                10 => (a.sin() * 0.8).asin(),
                11 => (a.cos() * 0.8).acos(),
                12 => a.atan(),
                13 => b.tanh().sinh(),
                14 => a.sin().cosh(),
                15 => (a * a + 1.0).recip(),
                16 => a.tanh().powi(3),
                17 => (a * a + 0.2).powf(1.3),
                18 => a.atan2(b * b + 0.3),
                19 => (a + 0.3).abs(),
                20 => a.max(b),
                _ => a.tanh() - b / 3.0,
            };
            // kept in bounds: what grows without limit says nothing about the types
            known.push(S::from(3.0).less(next.abs()).select(next.tanh(), next));
        }
        known[2..].iter().copied().sum()
    }
}

/// Derivatives of a formula by differences of f64 with two Richardson steps: coarse, but independent of every type.
fn slope_by_differences(f: impl Fn(f64) -> f64, x: f64) -> f64 {
    let central = |h: f64| (f(x + h) - f(x - h)) / (2.0 * h);
    let h = 1e-3;
    let [a, b, c] = [central(h), central(h / 2.0), central(h / 4.0)];
    let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
    (16.0 * bc - ab) / 15.0
}

/// Places where the formula has a breakpoint (abs, max, tanh bounds) within reach of the differences are left out by comparing
/// one-sided derivatives of the reference.
fn smooth_around(formula: &RandomFormula, x: f64) -> bool {
    let slope = |x| Dual2_64::probe(x, |x| formula.at(x));
    let (left, right, here) = (slope(x - 2e-3), slope(x + 2e-3), slope(x));
    let curvature = here.second[0].abs() + 1.0;
    [left, right].iter().all(|side| (side.first[0] - here.first[0]).abs() < 2e-2 * curvature && side.second[0].is_finite())
}

fn random_formulas_agree<T: Probe>(name: &str) {
    let mut random = Random::new(7);
    for number in 0..200 {
        let formula = RandomFormula::random(&mut random);
        let x = random.uniform(-1.0, 1.0);
        let reference = Dual2_64::probe(x, |x| formula.at(x));
        let (first, second) = (reference.first[0], reference.second[0]);
        let parts = T::probe(x, |x| formula.at(x));
        let place = format!("formula {number} {:?} in {name} at {x}: {parts:?} against {reference:?}", formula.0);
        let close = |a: f64, b: f64, scale: f64| (a - b).abs() <= 1e-13 * scale.max(1.0);
        assert!(close(parts.value, formula.at(x), formula.at(x).abs()), "value of {place}");
        assert!(parts.first.iter().all(|&d| close(d, first, first.abs())), "first derivative of {place}");
        assert!(parts.second.iter().all(|&d| close(d, second, first.abs() + second.abs())), "second derivative of {place}");
    }
}

/// A zero that does not move, but whose parts have all been through arithmetic.
fn nowhere<S: Scalar>(x: S) -> S {
    let same = x;
    x - same
}

type Named<T> = (&'static str, fn(T) -> T);

/// sqrt, real powers and atan2 where their derivatives are infinite: what does not move has no derivative, and no NaN.
fn zero_perturbations_stay_zero<T: Probe>(name: &str) {
    let place = |what: &str, parts: &Parts| format!("{what} in {name}: {parts:?}");
    let at_zero: [Named<T>; 8] = [
        ("sqrt(0)", |x| nowhere(x).sqrt()),
        ("0^0.5", |x| nowhere(x).powf(0.5)),
        ("0^1.5", |x| nowhere(x).powf(1.5)),
        ("0^2.5", |x| nowhere(x).powf(2.5)),
        ("0^2", |x| nowhere(x).powf(2.0)),
        ("0^1", |x| nowhere(x).powf(1.0)),
        ("atan2(0, 0)", |x| nowhere(x).atan2(nowhere(x))),
        ("sqrt(x^2 0)", |x| (x * x * 0.0).sqrt()),
    ];
    for (what, function) in at_zero {
        let parts = T::probe(0.7, function);
        assert!(parts.value == 0.0, "{}", place(what, &parts));
        assert!(parts.first.iter().chain(&parts.second).all(|&d| d == 0.0), "{}", place(what, &parts));
    }
    let parts = T::probe(0.0, |x| (x * x).powf(1.5));
    assert!(parts.first.iter().all(|&d| d == 0.0), "{}", place("(x^2)^1.5", &parts));
    // the length of a vector that starts to grow from zero: infinite derivative of the root, zero perturbation below it;
    // a breakpoint has no second derivative, so types that carry one are left out
    let parts = T::probe(0.0, |x| (x * x).sqrt() + 1.0);
    let breakpoint_is_out_of_reach = !parts.second.is_empty();
    assert!(breakpoint_is_out_of_reach || parts.first.iter().all(|&d| d == 0.0), "{}", place("sqrt(x^2)", &parts));
    let parts = T::probe(0.0, |x| x.powf(1.5));
    assert!(parts.first.iter().all(|&d| d == 0.0), "{}", place("x^1.5", &parts));
    let parts = T::probe(0.0, |x| x.powf(2.5));
    assert!(parts.first.iter().chain(&parts.second).all(|&d| d == 0.0), "{}", place("x^2.5", &parts));
    let parts = T::probe(0.0, |x| x.atan2(T::from(2.0)));
    assert!(parts.first.iter().all(|&d| d == 0.5), "{}", place("atan2(x, 2)", &parts));
    let parts = T::probe(0.0, |x| T::from(2.0).atan2(x));
    assert!(parts.first.iter().all(|&d| d == -0.5), "{}", place("atan2(2, x)", &parts));
    let parts = T::probe(0.0, |x| x.atan2(T::from(-2.0)));
    assert!(parts.first.iter().all(|&d| d == -0.5), "{}", place("atan2(x, -2)", &parts));
}

macro_rules! types {
    ($($test:ident: $type:ty,)*) => {
        $(mod $test {
            use super::*;
            #[test]
            fn follows_the_table_of_derivatives() {
                visit_functions(&mut AgainstTable::<$type>(std::marker::PhantomData, stringify!($type)));
            }
            #[test]
            fn agrees_with_the_others_on_random_formulas() {
                random_formulas_agree::<$type>(stringify!($type));
            }
            #[test]
            fn keeps_zero_perturbations_where_a_derivative_is_infinite() {
                zero_perturbations_stay_zero::<$type>(stringify!($type));
            }
            #[test]
            fn knows_constants() {
                assert!(<$type>::from(0.3).is_constant() && (<$type>::from(0.3).sin() * 2.0).is_constant());
                assert_eq!(<$type as num_traits::Zero>::zero().value(), 0.0);
                assert_eq!(<$type>::from(-2.0).abs().value(), 2.0);
            }
        })*
    };
}

types! {
    f64_only: f64,
    complex: Complex64,
    dual: Dual64,
    moving: Moving<f64>,
    tangent: Tangents,
    dual_of_second_order: Dual2_64,
    hyper_dual: HyperDual64,
    recorded: Recorded,
}

#[test]
fn random_formulas_have_the_slope_that_differences_show() {
    let mut random = Random::new(7);
    let mut compared = 0;
    for number in 0..200 {
        let formula = RandomFormula::random(&mut random);
        let x = random.uniform(-1.0, 1.0);
        if !smooth_around(&formula, x) {
            continue;
        }
        compared += 1;
        let first = Dual64::probe(x, |x| formula.at(x)).first[0];
        let slope = slope_by_differences(|x| formula.at(x), x);
        let scale = first.abs().max(1.0);
        assert!((slope - first).abs() <= 1e-6 * scale, "formula {number} {:?} at {x}: {slope} against {first}", formula.0);
    }
    assert!(compared > 120, "only {compared} formulas were smooth enough to compare");
}

/// The derivative survives any step: too small for round-off to hide, too large for underflow to remove.
struct ComplexSteps;

impl Visitor for ComplexSteps {
    fn visit<F: Function>(&mut self) {
        for &x in F::POINTS {
            for step in [1e-20, 1e-30, COMPLEX_STEP] {
                let y: Complex64 = F::at(Complex64::new(x, step));
                let [first, _] = F::derivatives(x);
                let error = (y.im / step - first).abs();
                assert!(
                    error <= 1e-14 * first.abs(),
                    "{} at {x} with step {step}: {} against {first}",
                    F::NAME,
                    y.im / step
                );
            }
        }
    }
}

#[test]
fn complex_steps_of_any_size_give_the_derivative_of_every_function() {
    visit_functions(&mut ComplexSteps);
}

#[test]
fn real_power_of_a_negative_complex_number_gains_no_imaginary_part() {
    for exponent in [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 4.0] {
        let power = Scalar::powf(Complex64::from(-1.7), exponent);
        assert_eq!((power.re, power.im), ((-1.7f64).powf(exponent), 0.0), "exponent {exponent}");
    }
}

#[test]
fn reciprocal_of_a_huge_complex_number_does_not_underflow() {
    let huge = Complex64::new(1e200, 1e100);
    let inverse = huge.recip();
    assert_eq!(inverse.re, 1e-200);
    assert!((inverse.im / -1e-300 - 1.0).abs() < 1e-14, "{inverse:?}");
}

#[test]
fn products_and_absolute_values_of_complex_numbers_conjugate_nothing() {
    let (x, y) = (Complex64::new(2.0, 3e-30), Complex64::new(-5.0, 7e-30));
    assert_eq!(x * x, Complex64::new(4.0, 12e-30));
    assert_eq!(x * y, Complex64::new(-10.0, 2.0 * 7e-30 + 3e-30 * -5.0));
    // the modulus would say (5, 0): a breakpoint where the function of a real argument is smooth
    assert_eq!(y.abs(), Complex64::new(5.0, -7e-30));
    assert_eq!(Scalar::sqrt(y * y), Complex64::new(5.0, -7e-30));
}

#[test]
fn infinite_derivatives_show_as_infinite_where_something_moves() {
    assert_eq!(Dual64::probe(0.0, |x| x.sqrt()).first, [f64::INFINITY]);
    assert_eq!(Tangents::probe(0.0, |x| x.sqrt()).first, [f64::INFINITY; TANGENTS]);
    assert_eq!(Recorded::probe(0.0, |x| x.sqrt()).first, [f64::INFINITY; 2]);
    assert_eq!(Scalar::sqrt(Complex64::new(0.0, COMPLEX_STEP)).im, f64::INFINITY);
}

#[test]
fn what_does_not_move_under_a_root_of_zero_leaves_gradients_alone() {
    // the length of a vector that is zero: forward and in reverse
    let lengths: [Named<Recorded>; 4] = [
        ("length", |x| (x * x + (x * 3.0) * (x * 2.0)).sqrt() + x),
        ("quotient", |x| (x * x / (x * x + 2.0)).sqrt() + x),
        ("product", |x| (x * x * (x + 2.0) * 0.5).sqrt() + x),
        ("power", |x| (x * x).powf(0.75) + x),
    ];
    for (what, length) in lengths {
        assert_eq!(Recorded::probe(0.0, length).first, [1.0; 2], "{what}");
    }
}

/// A function of many variables with every kind of operation, zero-length vectors included.
fn composite<S: Scalar>(x: &[S]) -> S {
    let mut total = S::zero();
    for (k, pair) in x.windows(2).enumerate() {
        let (a, b) = (pair[0], pair[1]);
        total += (a * b).sin() / (b * b + 1.0) + (a * a + 0.1).powf(0.7) * (k as f64 + 1.0);
        total -= b.atan2(a + 3.0) * a.tanh().exp() - (a - b).abs();
    }
    let still = nowhere(x[0]) * x[1];
    total + (still * still).sqrt() + x[2].max(x[3]) * x[4].recip()
}

#[test]
fn a_recorded_gradient_equals_that_of_tangents() {
    let mut random = Random::new(11);
    let x: Vec<f64> = random.vector(TANGENTS).iter().map(|x| 0.9 + 0.6 * x).collect();
    let variable = |(k, &x): (usize, &f64)| {
        Tangents::new(x, Derivative::some(nalgebra::SVector::from_fn(|place, _| f64::from(u8::from(place == k)))))
    };
    let dual = composite(&x.iter().enumerate().map(variable).collect::<Vec<_>>());
    let formula = Formula::record(TANGENTS, |x| vec![composite(x)]).expect("no branches");
    // weights are arguments: the sweep is linear in what comes back
    let program = formula.dense_program(("own 1", Default::default()), 1, |graph, x, y| {
        [y, &graph.reverse(y, &x[TANGENTS..], &x[..TANGENTS])].concat()
    });
    for weight in [1.0, 2.0] {
        let mut results = vec![0.0; TANGENTS + 1];
        program.run(&[&x[..], &[weight]].concat(), &mut results, &mut ProgramWork::default());
        assert_eq!(results[0], dual.re);
        let forward = dual.eps.unwrap_generic(nalgebra::Const::<TANGENTS>, nalgebra::Const::<1>);
        for (k, (reverse, forward)) in results[1..].iter().zip(forward.iter()).enumerate() {
            let forward = weight * forward;
            assert!((reverse - forward).abs() <= 1e-14 * forward.abs().max(1.0), "variable {k}: {reverse} and {forward}");
        }
    }
}

#[test]
fn a_recording_survives_a_panic_inside_another() {
    let panicked = std::panic::catch_unwind(|| record(&[1.0], |x| assert!((x[0] * 2.0).number() < 0.0)));
    assert!(panicked.is_err());
    let (nine, recording) = record(&[3.0], |x| x[0] * x[0]);
    assert_eq!((nine.number(), recording.looked), (9.0, false));
}

#[test]
fn a_formula_that_looks_at_a_value_is_refused() {
    let branching = |x: &[Recorded]| vec![if x[0].value() > 0.0 { x[0] } else { -x[0] }];
    assert!(record(&[0.3], branching).1.looked);
    let why = Formula::record(1, branching).expect_err("it branches");
    assert!(why.contains("select"), "{why}");
    // constants may be looked at
    let (_, recording) = record(&[0.3], |x| if (Recorded::from(2.0) * 3.0).value() > 0.0 { x[0] } else { -x[0] });
    assert!(!recording.looked);
    assert!(Formula::record(1, |x| vec![x[0].abs()]).is_ok());
}

#[test]
fn equal_recordings_are_one_formula() {
    let record = |factor: f64| Formula::record(2, |x| vec![x[0] * x[1] * factor + x[1].sin()]).expect("no branches");
    assert!(std::sync::Arc::ptr_eq(&record(3.0), &record(3.0)));
    assert!(!std::sync::Arc::ptr_eq(&record(3.0), &record(4.0)));
}
