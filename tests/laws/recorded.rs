//! Formulas are recorded once: further designs look them up, and are told where they would record others.

use super::forward::assert_says;
use costate::internals::formulas_made;
use costate::prelude::*;
use costate::scenes::{AnyScene, built_in};

/// Values and gradients at a design.
fn differentiated(prepared: &Prepared, x: &[f64]) -> Result<Vec<Vec<f64>>, RunError> {
    let analysis = prepared.analysis();
    let forward = analysis.forward(x)?;
    Ok([vec![forward.values.clone()], analysis.adjoint(x, &forward)?.rows].concat())
}

/// A built-in scene with few steps, at its initial design with all variables moved by a share of their size.
fn prepared<'s>(scene: &'s dyn AnyScene, share: f64) -> Prepared<'s> {
    let moved = |own: &DesignVariable| (own.initial + share * own.size(own.initial)).clamp(own.lower, own.upper);
    let x: Vec<f64> = scene.variables().iter().map(moved).collect();
    let own = scene.settings();
    let settings = Settings { end: 2.0 * own.end / own.steps as f64, steps: 2, control: None, ..own };
    Prepared::with(scene, &x, Prepared::method_of(&settings).expect("listed"), settings).expect("a sound scene")
}

#[test]
fn further_designs_record_no_formula() {
    // formulas count by threads
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        for name in ["two-four-bar", "flexible-four-bar", "five-bar", "plate-pendulum", "suspension"] {
            let scene = built_in::named(name).expect("listed");
            let own = prepared(scene, 0.0);
            let first = differentiated(&own, &own.x).expect("has a gradient");
            let made = formulas_made();
            assert!(made > 0, "{name}");
            assert_eq!(differentiated(&own, &own.x).expect("has a gradient"), first, "{name}");
            assert_eq!(formulas_made(), made, "{name}: formulas of a second gradient");
            let further = prepared(scene, 1e-3);
            let of_another = differentiated(&further, &further.x).expect("has a gradient");
            assert_eq!(formulas_made(), made, "{name}: formulas of another design");
            assert_eq!(differentiated(&own, &further.x).expect("has a gradient"), of_another, "{name}");
            assert_eq!(formulas_made(), made, "{name}: formulas of a run of another design");
        }
    });
}

/// A spring of a coordinate, linear or not.
#[derive(Hash)]
struct Spring {
    is_cubic: bool,
}

impl Element for Spring {
    const PARAMETERS: &'static [Parameter] = &[Parameter::new("mass", "kg"), Parameter::new("stiffness", "N/m")];
    fn nodes(&self) -> Vec<NodeKind> {
        vec![NodeKind::Coordinates(1)]
    }
    fn residual<S: Scalar>(&self, s: State<S>, p: &[S], _t: S, r: &mut [S]) {
        let q = s.q[0];
        r[0] = p[0] * s.a[0] + p[1] * if self.is_cubic { q * q * q } else { q };
    }
}

/// Its spring is cubic where the variable is above 1.
struct Hardening;

impl Scene for Hardening {
    fn name(&self) -> String {
        "hardening".into()
    }
    fn variables(&self) -> Vec<DesignVariable> {
        vec![DesignVariable::new("stiffness", 1.0, (0.5, 2.0), "N/m")]
    }
    fn settings(&self) -> Settings {
        Settings::new(1.0, 10)
    }
    fn build<S: Scalar>(&self, x: &[S], m: &mut MechanismBuilder<S>) -> Result<(), String> {
        let bob = m.coordinates("bob", &[S::one()], &[S::zero()]);
        m.element("spring", &[bob], Spring { is_cubic: x[0].value() > 1.0 }, &[S::one(), x[0]]);
        m.coordinate_functional("q", Over::Terminal, bob, 0);
        Ok(())
    }
}

/// Both laws are known from other designs: which of them a design has is found all the same.
#[test]
fn an_option_that_follows_the_design_is_told_when_its_formulas_are_known() {
    let at = |x: f64| {
        Prepared::with(&Hardening, &[x], Prepared::default_method(), AnyScene::settings(&Hardening)).expect("sound")
    };
    let [soft, hard, edge] = [0.75, 1.5, 1.0].map(at);
    let of_soft = differentiated(&soft, &[0.75]).expect("one law near by");
    let of_hard = differentiated(&hard, &[1.5]).expect("one law near by");
    let made = formulas_made();
    assert_eq!(differentiated(&soft, &[0.75]).expect("one law near by"), of_soft);
    assert_eq!(differentiated(&hard, &[1.5]).expect("one law near by"), of_hard);
    assert_eq!(formulas_made(), made);
    for (prepared, x) in [(&soft, 1.5), (&hard, 0.75), (&edge, 1.0)] {
        let error = differentiated(prepared, &[x]).expect_err("another law");
        assert_says(&error, &["\"hardening\"", "the law of \"spring\""]);
    }
}
