use crate::elements::{Table, TimeFormula, TimeFunction};
use crate::scalar::{Interpolant, Scalar};
use std::sync::Arc;

/// A function of time with its numbers, for loads and drivers: see [`TimeFunction`] for the formulas.
///
/// Numbers of type `S` may depend on design variables; times of type `f64` are topology.
#[derive(Clone, Debug)]
pub enum Signal<S> {
    /// f = c.
    Constant(S),
    /// f = offset + rate t.
    ConstantRate {
        /// Value at t = 0.
        offset: S,
        /// Per second.
        rate: S,
    },
    /// f = offset + amplitude sin(angular_frequency t + phase).
    Sine {
        /// Mean.
        offset: S,
        /// Of the sine.
        amplitude: S,
        /// [rad/s].
        angular_frequency: S,
        /// \[rad\].
        phase: S,
    },
    /// From one value to another along 10 s^3 - 15 s^4 + 6 s^5, twice continuously differentiable.
    SmoothRamp {
        /// Value until the start.
        from: S,
        /// Value from the end on.
        to: S,
        /// When it begins \[s\].
        start: S,
        /// How long it takes \[s\].
        duration: S,
    },
    /// One value before a time and another from it on; for loads only.
    Step {
        /// Value before.
        before: S,
        /// Value after.
        after: S,
        /// Time of the jump \[s\].
        switch: f64,
    },
    /// Values at times; lines and steps are for loads only.
    Table {
        /// Times, increasing \[s\].
        times: Vec<f64>,
        /// A value for each time. Those that are always the same are cheaper as [`TimeFunction::curve`] with [`Signal::of`].
        values: Vec<S>,
        /// The way between them.
        interpolant: Interpolant,
    },
    /// Another one started from rest: see [`TimeFunction::SmoothStart`].
    SmoothStart {
        /// What is started.
        of: Box<Signal<S>>,
        /// How long it takes until time runs at its full rate \[s\].
        duration: S,
    },
    /// A function that is chosen elsewhere, with its parameters in their order.
    Of {
        /// The function.
        function: TimeFunction,
        /// Its numbers.
        parameters: Vec<S>,
    },
}

impl<S: Scalar> Signal<S> {
    /// A function that is chosen elsewhere, with its parameters in their order.
    pub fn of(function: TimeFunction, parameters: &[S]) -> Self {
        Signal::Of { function, parameters: parameters.to_vec() }
    }

    /// A function of one's own, with its parameters in their order.
    ///
    /// # Errors
    /// If it branches on a value.
    pub fn own(formula: impl TimeFormula, parameters: &[S]) -> Result<Self, String> {
        Ok(Signal::of(TimeFunction::own(formula)?, parameters))
    }

    /// The function and its parameters.
    ///
    /// # Errors
    /// Times that do not increase, or of another number than the values.
    pub fn parts(self) -> Result<(TimeFunction, Vec<S>), String> {
        Ok(match self {
            Signal::Constant(value) => (TimeFunction::Constant, vec![value]),
            Signal::ConstantRate { offset, rate } => (TimeFunction::ConstantRate, vec![offset, rate]),
            Signal::Sine { offset, amplitude, angular_frequency, phase } => {
                (TimeFunction::Sine, vec![offset, amplitude, angular_frequency, phase])
            }
            Signal::SmoothRamp { from, to, start, duration } => (TimeFunction::SmoothRamp, vec![from, to, start, duration]),
            Signal::Step { before, after, switch } => (TimeFunction::Step { switch }, vec![before, after]),
            Signal::Table { times, values, interpolant } => {
                if times.len() != values.len() {
                    return Err(format!("there are {} times, but {} values; give one for each", times.len(), values.len()));
                }
                let table = Table::new(&times, interpolant)?;
                let numbers = table.numbers(&values);
                (TimeFunction::Table(table), numbers)
            }
            Signal::SmoothStart { of, duration } => {
                let (function, mut parameters) = of.parts()?;
                parameters.push(duration);
                (TimeFunction::SmoothStart(Arc::new(function)), parameters)
            }
            Signal::Of { function, parameters } => (function, parameters),
        })
    }
}
