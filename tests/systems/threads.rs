//! Matrices whose columns belong to several threads.

use costate::integrators::RunError;
use costate::internals::{Jacobian, Owners, Residual, StageSystem, Systems};
use costate::scenes::built_in::all;
use costate::scenes::{AnyScene, Prepared};
use std::sync::Arc;

/// The matrix of accelerations at the start, all at once or by columns of so many threads.
fn matrix(scene: &dyn AnyScene, threads: Option<usize>) -> Result<Vec<f64>, RunError> {
    let prepared = Prepared::new(scene)?;
    let problem = prepared.problem();
    let forward = prepared.analysis().forward(&prepared.x)?;
    let start = forward.history.start_record().expect("a start");
    let record = &start.acceleration;
    let systems = Systems::new(problem.model, &prepared.method, &start.dropped);
    let at = StageSystem { equations: &record.equations, base: &record.base, p: &problem.p, t: record.t };
    let (mut residual, mut unknowns) = (Residual::default(), record.unknowns.clone());
    residual.start(&systems.plain, at);
    residual.evaluate(&systems.plain, at, &mut unknowns);
    let mut jacobian = Jacobian::default();
    if let Some(count) = threads {
        let mut of_each = vec![Vec::new(); count];
        // columns of one node belong to several, and some threads have none
        let numbers = (0..systems.plain.size() as u32).map(|unknown| (unknown, unknown.wrapping_mul(0x9e37_79b9) >> 20));
        numbers.for_each(|(unknown, number)| of_each[number as usize % count].push(unknown));
        jacobian.divide_by_threads(Some(&Arc::new(Owners::new(&of_each))));
    }
    jacobian.assemble(&systems.plain, &record.equations, &residual, &unknowns, &problem.p, record.t);
    Ok(jacobian.values)
}

#[test]
fn threads_that_have_columns_of_their_own_give_the_bits_of_one() {
    let mut compared = 0;
    for scene in all() {
        let name = scene.name();
        let Ok(whole) = matrix(&*scene, None) else { continue };
        for threads in [2, 5] {
            let given = matrix(&*scene, Some(threads)).unwrap_or_else(|error| panic!("{name}: {error}"));
            let differing = whole.iter().zip(&given).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!((given.len(), differing), (whole.len(), 0), "{name} on {threads} threads");
        }
        compared += 1;
    }
    assert!(compared > 10, "only {compared} scenes");
}
