//! Matrices whose columns belong to several threads.

use costate::history::Watch;
use costate::integrators::StepRecord;
use costate::internals::{Jacobian, Owners, Residual, StageSystem};
use costate::scenes::{AnyScene, Prepared, built_in};
use std::sync::Arc;

/// The matrix of the first stage, all at once or by columns of so many threads; nothing of what has no stage.
fn matrix(scene: &dyn AnyScene, threads: Option<usize>) -> Option<Vec<f64>> {
    let prepared = Prepared::new(scene).ok()?;
    let problem = prepared.problem();
    let mut first = None;
    let mut watch = Watch(|step: &StepRecord<f64>| {
        first =
            step.stages.iter().find(|stage| stage.known.is_none()).map(|stage| (stage.solve.clone(), step.dropped.clone()));
        false
    });
    let _ = prepared.analysis().observed(&prepared.x, &mut watch);
    let (record, dropped) = first?;
    let system = &*prepared.method.system(problem.model, &dropped);
    let at = StageSystem { equations: &record.equations, base: &record.base, p: &problem.p, t: record.t };
    let (mut residual, mut unknowns) = (Residual::default(), record.unknowns.clone());
    residual.start(system, at);
    residual.evaluate(system, at, &mut unknowns);
    let mut jacobian = Jacobian::default();
    if let Some(count) = threads {
        let mut of_each = vec![Vec::new(); count];
        // columns of one node belong to several, and some threads have none
        let numbers = (0..system.size() as u32).map(|unknown| (unknown, unknown.wrapping_mul(0x9e37_79b9) >> 20));
        numbers.for_each(|(unknown, number)| of_each[number as usize % count].push(unknown));
        jacobian.divide_by_threads(Some(&Arc::new(Owners::new(&of_each))));
    }
    jacobian.assemble(system, &record.equations, &residual, &unknowns, &problem.p, record.t);
    Some(jacobian.values)
}

#[test]
fn threads_that_have_columns_of_their_own_give_the_bits_of_one() {
    let mut compared = 0;
    for name in built_in::names() {
        let scene = built_in::named(name).expect("built in");
        let Some(whole) = matrix(scene, None) else { continue };
        for threads in [2, 5] {
            let given = matrix(scene, Some(threads)).expect("a stage");
            let differing = whole.iter().zip(&given).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!((given.len(), differing), (whole.len(), 0), "{name} on {threads} threads");
        }
        compared += 1;
    }
    assert!(compared > 10, "only {compared} scenes");
}
