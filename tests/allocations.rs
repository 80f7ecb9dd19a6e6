//! Steps of a running simulation ask for no memory.

use costate::history::Watch;
use costate::integrators::{ConstraintLevel, Method, RunError, StepControl, StepRecord, tables};
use costate::internals::{march, march_adaptive};
use costate::scenes::{AnyScene, Prepared, Settings, built_in};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// Counts what each thread asks for.
struct Counting;

// SAFETY: every call is handed on to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promises are those of `System`.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Steps at the beginning in which vectors grow to their sizes.
const BEFORE: usize = 12;
const STEPS: usize = 40;

/// What the steps after the first ones ask for, and how many steps of a driven mechanism may have leapt: these are looked at by a factorization
/// that has lists of its own.
fn allocations(prepared: &Prepared) -> Result<(u64, usize), RunError> {
    let (mut index, mut at_start) = (0, 0);
    let mut watch = Watch(|_: &StepRecord<f64>| {
        index += 1;
        if index == BEFORE {
            at_start = COUNT.get();
        }
        true
    });
    let run = march(&prepared.problem(), &prepared.method, &prepared.grid, &prepared.plan, &mut watch)?;
    // the end of the run hands its state over; the start has a look of its own
    Ok((COUNT.get() - at_start, run.determinants.saturating_sub(1) / 2))
}

#[test]
fn steps_allocate_nothing() {
    let (mut of_leaps, mut runs) = (0, 0);
    for name in [
        "pendulum",
        "double-pendulum",
        "five-bar",
        "slider-crank",
        "heavy-top",
        "free-body",
        "car-axis",
        "flexible-pendulum",
    ] {
        let scene = built_in::named(name).expect("built in");
        let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
        for table in tables() {
            for level in ConstraintLevel::ALL {
                let settings = Settings { end: 1e-3 * STEPS as f64, steps: STEPS, ..scene.settings().without_method() };
                let prepared =
                    Prepared::with(scene, &x, Method::new(table.clone(), level), settings).expect("a sound scene");
                let what = format!("{name}, {} at {} level", table.name, level.name());
                // the thread's tapes grow once
                allocations(&prepared).unwrap_or_else(|error| panic!("{what}: {error}"));
                let (count, looks) = allocations(&prepared).unwrap_or_else(|error| panic!("{what}: {error}"));
                assert!(count == 0 || looks > 0, "{what}: {count}");
                of_leaps += usize::from(count > 0);
                runs += 1;
            }
        }
    }
    assert!(20 * of_leaps < runs, "{of_leaps} of {runs} runs");
    println!("{of_leaps} of {runs} runs look for leaps after their first steps");
}

/// All that a run without a history asks for, functionals included.
fn of_values(scene: &dyn AnyScene, steps: usize) -> u64 {
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let settings = Settings { end: 1e-3 * steps as f64, steps, ..scene.settings().without_method() };
    let prepared = Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene");
    let before = COUNT.get();
    prepared.analysis().values(&x).expect("runs");
    COUNT.get() - before
}

#[test]
fn functionals_and_long_chains_allocate_nothing() {
    // on this thread, where they are counted
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().expect("a pool of one thread");
    pool.install(|| {
        for (name, changes) in [("chain-common", "define.bars = 300"), ("five-bar", ""), ("heavy-top", "")] {
            let scene = &built_in::changed(name, changes).expect("sound");
            of_values(scene, 2 * STEPS);
            let [short, long] = [STEPS, 2 * STEPS].map(|steps| of_values(scene, steps));
            assert_eq!(long, short, "{}", scene.name());
        }
    });
}

#[test]
fn chosen_steps_allocate_for_their_list_alone() {
    let scene = built_in::named("heavy-top").expect("built in");
    let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
    let settings = scene.settings().without_method().choosing_steps(StepControl::new(1e-7));
    let prepared = Prepared::with(scene, &x, Prepared::default_method(), settings).expect("a sound scene");
    let control = prepared.control.expect("chosen steps");
    // the thread's tapes grow once
    prepared.analysis().values(&x).expect("runs");
    let mut counts = Vec::with_capacity(10_000);
    let mut watch = Watch(|_: &StepRecord<f64>| {
        counts.push(COUNT.get());
        true
    });
    let (problem, method) = (prepared.problem(), &prepared.method);
    let (grid, run) = march_adaptive(&problem, method, &control, &prepared.grid, &prepared.plan, &mut watch);
    let rejected = run.expect("runs").rejected;
    let asking = counts.windows(2).skip(BEFORE).filter(|pair| pair[1] > pair[0]).count();
    // the list of times doubles; steps that are given up factor anew
    let doublings = grid.steps().ilog2() as usize;
    assert!(grid.steps() > 100 && asking <= doublings + rejected, "{asking} of {} steps, {rejected} rejected", grid.steps());
}
