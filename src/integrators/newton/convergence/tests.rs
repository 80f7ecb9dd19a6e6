//! The judgement by itself: series of corrections, and no equations.

use super::*;

/// What a made-up system answers; counts how often its round-off was measured.
#[derive(Clone, Copy)]
struct MadeUp {
    expected: Option<f64>,
    has_stresses: bool,
    allowed: f64,
    floor: Floor,
    /// What [`Sizes::at_round_off`] says.
    at_round_off: bool,
    measured: usize,
}

/// Without round-off of its own, and nothing else to say.
const SILENT: MadeUp = MadeUp {
    expected: None,
    has_stresses: false,
    allowed: 0.0,
    floor: Floor { corrections: [0.0; 2], unknowns: [1.0; 2] },
    at_round_off: false,
    measured: 0,
};

impl Sizes for MadeUp {
    fn expected_rate(&self) -> Option<f64> {
        self.expected
    }
    fn has_stresses(&mut self) -> bool {
        self.has_stresses
    }
    fn can_relieve(&mut self) -> bool {
        self.has_stresses
    }
    fn allows(&self, left: f64, _size: f64, _reactions: f64) -> bool {
        left <= self.allowed
    }
    fn displacement(&self, step: f64) -> f64 {
        step
    }
    fn moved(&self, _step: f64) -> Option<f64> {
        None
    }
    fn is_nothing(&self, step: f64) -> bool {
        step <= NOTHING
    }
    fn is_no_reaction(&mut self, reaction_step: f64, step: f64) -> bool {
        reaction_step.max(step) <= NOTHING
    }
    fn floor(&mut self) -> Floor {
        self.floor
    }
    fn floor_here(&mut self) -> Floor {
        self.measured += 1;
        self.floor = Floor { unknowns: [f64::INFINITY; 2], ..self.floor };
        self.floor
    }
    fn at_round_off(&mut self, _step: f64, _scale: f64) -> bool {
        self.at_round_off
    }
}

/// Unknowns and multipliers of size 1, the latter corrected by a share of what the former are.
fn correction(step: f64) -> Correction {
    Correction { step, scale: 1.0, reaction_step: 0.1 * step, reactions: 1.0 }
}

/// Verdicts on a series until one ends the search; a matrix is factored where one is asked for, and at first if `fresh`.
fn verdicts(series: &[f64], fresh: bool, mut system: MadeUp) -> Vec<Verdict> {
    let (mut convergence, mut wanted, mut verdicts) = (Convergence::default(), fresh, Vec::new());
    for &step in series {
        if wanted {
            convergence.begin_matrix();
        }
        let verdict = convergence.judge(correction(step), &mut system);
        verdicts.push(verdict);
        wanted = matches!(verdict, Verdict::NewMatrix | Verdict::Restart);
        if matches!(verdict, Verdict::Converged(_) | Verdict::Relieve(_) | Verdict::Fail(..)) {
            break;
        }
    }
    verdicts
}

const CONVERGED: Verdict = Verdict::Converged(RateEstimate::Rates { is_aged: false });
const AGED_MATRIX: Verdict = Verdict::Converged(RateEstimate::Rates { is_aged: true });

#[test]
fn corrections_that_shrink_end_before_the_last_one_is_made() {
    // the second one is as good as the third would be
    let quadratic = verdicts(&[1e-2, 1e-6, 1e-14], true, SILENT);
    assert_eq!(quadratic, [Verdict::GoOn, Verdict::GoOn, CONVERGED]);
    // linear at 1/100: what is left behind the sixth, 1e-12 / 99, is above 1e-14, behind the seventh below
    let linear = verdicts(&[1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14], false, SILENT);
    assert_eq!(linear[..6], [Verdict::GoOn; 6]);
    assert_eq!(linear[6..], [CONVERGED]);
    // the same with less asked for: 1e-8 / 99
    let rough = verdicts(&[1e-2, 1e-4, 1e-6, 1e-8], false, MadeUp { allowed: 2e-10, ..SILENT });
    assert_eq!(rough, [Verdict::GoOn, Verdict::GoOn, Verdict::GoOn, CONVERGED]);
}

#[test]
fn a_slow_matrix_is_renewed_or_not_left_to_the_next_system() {
    let slow = verdicts(&[1e-2, 2e-3], false, SILENT);
    assert_eq!(slow, [Verdict::GoOn, Verdict::NewMatrix]);
    let series: Vec<f64> = (0..12).map(|i| 1e-2 * 0.08_f64.powi(i)).collect();
    assert_eq!(verdicts(&series, false, SILENT).last(), Some(&AGED_MATRIX));
    assert_eq!(verdicts(&series, true, SILENT).last(), Some(&CONVERGED), "a matrix of this search is not old");
}

#[test]
fn a_first_correction_counts_by_the_rate_that_earlier_searches_saw() {
    let known = MadeUp { expected: Some(1e-2), allowed: 1e-8, ..SILENT };
    assert_eq!(verdicts(&[1e-6], false, known), [CONVERGED]);
    assert_eq!(verdicts(&[1e-6], false, MadeUp { expected: None, ..known }), [Verdict::GoOn]);
    // the second correction is seen where stresses are read
    assert_eq!(verdicts(&[1e-6], false, MadeUp { has_stresses: true, ..known }), [Verdict::GoOn]);
    // no rate makes more of a correction than a hundredth
    assert_eq!(verdicts(&[1e-5], false, MadeUp { expected: Some(1e-9), ..known }), [Verdict::GoOn]);
}

#[test]
fn stagnation_is_round_off_where_the_floor_or_the_residual_says_so() {
    let series = [1e-3, 1e-9, 1e-11, 9e-12, 1.2e-11];
    let floored = MadeUp { floor: Floor { corrections: [6e-12; 2], unknowns: [1.0; 2] }, ..SILENT };
    assert_eq!(verdicts(&series, true, floored), [Verdict::GoOn, Verdict::GoOn, CONVERGED]);
    // by the residual: a new matrix is asked first, and tells with its second correction
    let by_residual = verdicts(&series, true, MadeUp { at_round_off: true, ..SILENT });
    assert_eq!(by_residual[..4], [Verdict::GoOn, Verdict::GoOn, Verdict::GoOn, Verdict::NewMatrix]);
    let Verdict::Converged(RateEstimate::Floor(floor)) = by_residual[4] else { panic!("{by_residual:?}") };
    assert_eq!(floor, Floor { corrections: [1.2e-11, 0.1 * 1.2e-11], unknowns: [1.0; 2] });
    // neither says so: the search goes on
    let neither = verdicts(&series, true, SILENT);
    assert!(neither.iter().all(|verdict| !matches!(verdict, Verdict::Converged(_))), "{neither:?}");
    // nearly all digits are enough, whatever says so
    assert_eq!(verdicts(&[1e-3, 2e-4, 8e-14, 7e-14], true, SILENT).last(), Some(&Verdict::Converged(RateEstimate::Nothing)));
}

#[test]
fn a_floor_is_measured_where_the_state_is_unlike_the_one_it_was_found_in() {
    let mut impact = MadeUp { floor: Floor { corrections: [1e-8; 2], unknowns: [100.0, 1.0] }, ..SILENT };
    let mut convergence = Convergence::default();
    convergence.begin_matrix();
    convergence.judge(correction(1e-3), &mut impact);
    convergence.judge(correction(5e-9), &mut impact);
    assert_eq!(impact.measured, 1);
}

#[test]
fn corrections_that_grow_diverge_or_are_relieved() {
    let series = [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
    let diverged = verdicts(&series, true, SILENT);
    assert_eq!(diverged.last(), Some(&Verdict::Fail(FailureKind::Diverged, 32.0)), "the fifth that grew");
    let stressed = MadeUp { has_stresses: true, ..SILENT };
    assert_eq!(verdicts(&series, true, stressed).last(), Some(&Verdict::Relieve(4.0)), "the second");
    assert_eq!(verdicts(&[1e-3, 1.0], true, stressed).last(), Some(&Verdict::Relieve(1.0)), "a wild one");
    assert_eq!(verdicts(&[1.0, 1e7], true, SILENT).last(), Some(&Verdict::Fail(FailureKind::Diverged, 1e7)));
}

#[test]
fn an_old_matrix_that_leads_astray_is_not_followed() {
    let astray = verdicts(&[1e-3, 1e-2, 1e-3, 1e-9, 1e-16], false, SILENT);
    assert_eq!(astray, [Verdict::GoOn, Verdict::Restart, Verdict::GoOn, Verdict::GoOn, CONVERGED]);
}

#[test]
fn corrections_that_go_up_and_down_are_never_taken_for_a_solution() {
    let series: Vec<f64> = (0..24).map(|i| if i % 2 == 0 { 1e-3 } else { 1.5e-3 }).collect();
    let seen = verdicts(&series, true, MadeUp { at_round_off: true, ..SILENT });
    // far from round-off, whatever the residual says; growth in turn with shrinking is no divergence
    assert_eq!(seen[0], Verdict::GoOn);
    assert_eq!(seen[1..], [Verdict::NewMatrix; 23]);
}

#[test]
fn what_is_no_number_ends_the_search() {
    for none in [f64::NAN, f64::INFINITY] {
        let mut convergence = Convergence::default();
        let is_none = |verdict| match verdict {
            Verdict::Fail(FailureKind::NotFinite, seen) => !seen.is_finite(),
            _ => false,
        };
        assert!(is_none(convergence.judge_residual(none)));
        assert!(is_none(convergence.judge(correction(none), &mut SILENT.clone())));
    }
    // multipliers that are none are not accepted
    let mut convergence = Convergence::default();
    convergence.begin_matrix();
    let none = Correction { reaction_step: f64::NAN, ..correction(1e-16) };
    assert_eq!(convergence.judge(none, &mut SILENT.clone()), Verdict::GoOn);
}

#[test]
fn a_small_residual_ends_the_search_where_it_is_asked_for() {
    for (by_residual, last) in [(true, Verdict::Converged(RateEstimate::Nothing)), (false, Verdict::GoOn)] {
        let mut convergence = Convergence::new(by_residual);
        assert_eq!(convergence.judge_residual(2e3), Verdict::GoOn);
        assert_eq!(convergence.judge_residual(1e-5), Verdict::GoOn);
        assert_eq!(convergence.judge_residual(1e-6), last, "1e-9 of the first one");
        assert_eq!(Convergence::new(by_residual).judge_residual(1e-12), last);
    }
}
