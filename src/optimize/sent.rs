//! What ranks tell each other of designs that they have simulated.

use super::{Conditions, DesignHistory, DesignPoint, Ended, Optimized, Point, Reason, Values, Work};
use crate::exchange::{sent_by_fields, sent_by_variants};
use crate::functionals::{Extreme, Extremes};
use crate::integrators::{Counters, RunError, Stop};

sent_by_fields!(Extreme { value, t, element });
sent_by_fields!(Extremes { smallest, largest });
sent_by_fields!(Counters {
    systems,
    iterations,
    projecting,
    residuals,
    factorizations,
    solves,
    products,
    blocks,
    choices,
    nanoseconds,
});
sent_by_fields!(Work { simulations, simulation, simulation_seconds, sweeps, gradient, gradient_seconds });
sent_by_fields!(DesignPoint {
    evaluation,
    iteration,
    design,
    functionals,
    extremes,
    events,
    gradients,
    objective,
    violation,
    work,
    fingerprint
});
sent_by_fields!(DesignHistory { variables, functionals, maximize, tolerance, points });
sent_by_fields!(Values { objective, constraints });
sent_by_fields!(Point { x, values, violation });
sent_by_fields!(Conditions { multipliers, slopes, stationarity, violation, complementarity, tolerance, allowed });
sent_by_variants!(Reason {
    0 Change {},
    1 Optimal {},
    2 Creeping {},
    3 Iterations {},
    4 Stalled {},
    5 Infeasible {},
    6 Stopped {},
    7 StartFailed {},
});
sent_by_fields!(Ended { reason, best, conditions, iterations, evaluations, gradients, failed });
sent_by_fields!(Optimized { ended, history, failure });
sent_by_variants!(RunError {
    0 Input { 0: message },
    1 Stopped { reason: reason, place: place, cause: cause, hint: hint },
    2 NoEquilibrium { t: t, h: h, hint: hint, cause: cause },
    3 Interrupted { steps: steps },
});
sent_by_variants!(Stop { 0 Singular {}, 1 NoConvergence {}, 2 NotFinite {}, 3 Redundant {}, 4 StepSize {}, 5 History {} });
