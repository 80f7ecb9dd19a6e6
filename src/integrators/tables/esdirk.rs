//! Runge-Kutta methods whose first stage is the state at the start: stage order 2.

use super::dirk::l_stable_diagonal;
use crate::integrators::Butcher;

/// Explicit first stage and three implicit ones, order 3, stage order 2, L-stable and stiffly accurate: the tableau of
/// Kennedy & Carpenter (2003), ARK3(2)4L[2]SA, computed from its defining conditions with c = (0, 2 gamma, 3/5, 1), and its
/// embedded weights of order 2.
pub fn esdirk3() -> Butcher {
    let gamma = l_stable_diagonal();
    let (c2, c3) = (2.0 * gamma, 0.6);
    // stage order 2: sum a_3j c_j = c_3^2 / 2
    let a32 = (c3 * c3 / 2.0 - gamma * c3) / c2;
    // sum b c = 1/2 and sum b c^2 = 1/3 with b_4 = gamma
    let (first, second) = (0.5 - gamma, 1.0 / 3.0 - gamma);
    let b3 = (second - c2 * first) / (c3 * (c3 - c2));
    let b2 = (first - b3 * c3) / c2;
    let b = vec![1.0 - b2 - b3 - gamma, b2, b3, gamma];
    let embedded = vec![
        2_756_255_671_327.0 / 12_835_298_489_170.0,
        -10_771_552_573_575.0 / 22_201_958_757_719.0,
        9_247_589_265_047.0 / 10_645_013_368_117.0,
        2_193_209_047_091.0 / 5_459_859_503_100.0,
    ];
    Butcher {
        name: "esdirk3".into(),
        order: 3,
        stage_order: 2,
        l_stable: true,
        a: vec![vec![0.0], vec![gamma, gamma], vec![c3 - a32 - gamma, a32, gamma], b.clone()],
        b,
        embedded: Some((2, embedded)),
    }
}

/// Explicit first stage and five implicit ones, order 4, stage order 2, L-stable and stiffly accurate, embedded order 3:
/// Kennedy & Carpenter (2003), ARK4(3)6L[2]SA.
pub fn esdirk4() -> Butcher {
    let d = 0.25;
    let b = vec![82_889.0 / 524_892.0, 0.0, 15_625.0 / 83_664.0, 69_875.0 / 102_672.0, -2_260.0 / 8_211.0, d];
    let a = vec![
        vec![0.0],
        vec![d, d],
        vec![8_611.0 / 62_500.0, -1_743.0 / 31_250.0, d],
        vec![5_012_029.0 / 34_652_500.0, -654_441.0 / 2_922_500.0, 174_375.0 / 388_108.0, d],
        vec![
            15_267_082_809.0 / 155_376_265_600.0,
            -71_443_401.0 / 120_774_400.0,
            730_878_875.0 / 902_184_768.0,
            2_285_395.0 / 8_070_912.0,
            d,
        ],
        b.clone(),
    ];
    let embedded = vec![
        4_586_570_599.0 / 29_645_900_160.0,
        0.0,
        178_811_875.0 / 945_068_544.0,
        814_220_225.0 / 1_159_782_912.0,
        -3_700_637.0 / 11_593_932.0,
        61_727.0 / 225_920.0,
    ];
    Butcher { name: "esdirk4".into(), order: 4, stage_order: 2, l_stable: true, a, b, embedded: Some((3, embedded)) }
}

/// Explicit first stage and six implicit ones, order 5, stage order 2, L-stable and stiffly accurate, embedded order 4:
/// Kennedy & Carpenter (2016), ESDIRK5(4)7L[2]SA2. The first two coefficients of each row are equal.
pub fn esdirk5() -> Butcher {
    let d = 23.0 / 125.0;
    let row = |second: f64, others: &[f64]| [&[second, second], others, &[d]].concat();
    let b = row(
        -188_593_204_321.0 / 4_778_616_380_481.0,
        &[
            2_809_310_203_510.0 / 10_304_234_040_467.0,
            1_021_729_336_898.0 / 2_364_210_264_653.0,
            870_612_361_811.0 / 2_470_410_392_208.0,
            -1_307_970_675_534.0 / 8_059_683_598_661.0,
        ],
    );
    let a = vec![
        vec![0.0],
        vec![d, d],
        row(791_020_047_304.0 / 3_561_426_431_547.0, &[]),
        row(-158_159_076_358.0 / 11_257_294_102_345.0, &[-85_517_644_447.0 / 5_003_708_988_389.0]),
        row(
            -1_653_327_111_580.0 / 4_048_416_487_981.0,
            &[1_514_767_744_496.0 / 9_099_671_765_375.0, 14_283_835_447_591.0 / 12_247_432_691_556.0],
        ),
        row(
            -4_540_011_970_825.0 / 8_418_487_046_959.0,
            &[
                -1_790_937_573_418.0 / 7_393_406_387_169.0,
                10_819_093_665_085.0 / 7_266_595_846_747.0,
                4_109_463_131_231.0 / 7_386_972_500_302.0,
            ],
        ),
        b.clone(),
    ];
    let first = -582_099_335_757.0 / 7_214_068_459_310.0;
    let embedded = vec![
        first,
        first,
        615_023_338_567.0 / 3_362_626_566_945.0,
        3_192_122_436_311.0 / 6_174_152_374_399.0,
        6_156_034_052_041.0 / 14_430_468_657_929.0,
        -1_011_318_518_279.0 / 9_693_750_372_484.0,
        1_914_490_192_573.0 / 13_754_262_428_401.0,
    ];
    Butcher { name: "esdirk5".into(), order: 5, stage_order: 2, l_stable: true, a, b, embedded: Some((4, embedded)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrators::implicit_weights::implicit_weights;

    #[test]
    fn solutions_by_implicit_stages_alone_have_their_order_and_end_a_stiff_decay() {
        for (tableau, order, ends) in [(esdirk3(), 2, false), (esdirk4(), 3, true), (esdirk5(), 3, true)] {
            let name = tableau.name.clone();
            let c: Vec<f64> = tableau.a.iter().map(|row| row.iter().sum()).collect();
            let weights = implicit_weights(&tableau.a, &tableau.b, &c);
            assert_eq!(weights[0], 0.0, "{name}");
            let (defect, condition) = tableau.order_defect(&weights, order);
            assert!(defect < 1e-13, "{name}: {condition} is missed by {defect:e}");
            // y' = z y from 1: the stages' slopes, one after the other
            let end = |z: f64| {
                let mut slopes: Vec<f64> = Vec::new();
                for row in &tableau.a {
                    let known: f64 = row.iter().zip(&slopes).map(|(a, slope)| a * slope).sum();
                    slopes.push(z * (1.0 + known) / (1.0 - z * row[slopes.len()]));
                }
                1.0 + weights.iter().zip(slopes).map(|(weight, slope)| weight * slope).sum::<f64>()
            };
            let stiff = end(-1e7);
            assert!(stiff.abs() < if ends { 1e-5 } else { 1.0 }, "{name}: {stiff}");
            assert!((end(-1e-3) - (-1e-3_f64).exp()).abs() < 1e-3_f64.powi(order as i32 + 1), "{name}");
        }
    }
}
