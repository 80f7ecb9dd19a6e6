//! States of first order by entries: an entry is what a file would write of its keys.

use crate::elements::entries::{Form, Range, Type, may, need};

/// Keys under which the fields of an entry have the starts and the rates of its states, and its outputs.
pub(super) const MADE: [&str; 3] = ["starts of states", "rates of states", "outputs of states"];

/// Formulas of a state by its keys, definitions and states.
#[derive(Default)]
pub(super) struct Law {
    /// Names for formulas, each of those before it.
    pub definitions: Vec<[&'static str; 2]>,
    /// Names, starts and rates of the states.
    pub states: Vec<[&'static str; 3]>,
    /// Names and formulas of what others read beside the states.
    pub outputs: Vec<[&'static str; 2]>,
}

/// What a law makes of the keys that are given, or what is wrong with them.
type ByKeys = fn(given: &dyn Fn(&str) -> bool) -> Result<Law, &'static str>;

/// The entry of a state.
pub(super) struct StateEntry {
    pub form: Form,
    /// Formulas for keys that are left out.
    pub defaults: &'static [[&'static str; 2]],
    pub law: ByKeys,
}

/// All entries of states.
pub(super) const STATE_ENTRIES: [StateEntry; 2] = [LAG, PID];

/// A lag of first order: T z' = k u - z.
const LAG: StateEntry = StateEntry {
    form: Form {
        name: "lag",
        doc: "a lag of first order, as of an actuator or a sensor: T z' = k u - z; others know z as NAME.value, z' as NAME.rate",
        keys: &[
            need("input", Type::OfNodes("-"), "u"),
            need("time_constant", Type::Number("s", Range::Positive), "T"),
            may("gain", Type::OfNodes("-"), "k; 1"),
            may("initial", Type::Number("-", Range::Any), "z at the start; 0"),
        ],
    },
    defaults: &[["gain", "1"], ["initial", "0"]],
    law: |_| {
        Ok(Law {
            definitions: vec![["slope", "(gain * input - value) / time_constant"]],
            states: vec![["value", "initial", "slope"]],
            outputs: vec![["rate", "slope"]],
        })
    },
};

/// A PID controller: u = kp e + I + kd e', I' = ki e.
const PID: StateEntry = StateEntry {
    form: Form {
        name: "pid",
        doc: "a PID controller of the error e = set_point - measured: u = kp e + I + kd d, I' = ki e, where d is e', filtered (d = (e - z) / T, \
              z' = d) or as it is given; others know u as NAME.output, e as NAME.error, I as NAME.integral_term. With limits u is held within \
              them, and I' = ki e + (u - kp e - I - kd d) / tracking_time (no windup)",
        keys: &[
            need("measured", Type::OfNodes("-"), "what is controlled"),
            need("set_point", Type::OfNodes("-"), "what it should be"),
            may("proportional", Type::OfNodes("-"), "kp; 0"),
            may("integral", Type::OfNodes("1/s"), "ki; 0"),
            may("derivative", Type::OfNodes("s"), "kd, with filter_time or error_rate; 0"),
            may("filter_time", Type::Number("s", Range::Positive), "T of the filter of the derivative"),
            may("error_rate", Type::OfNodes("1/s"), "e' where the mechanism knows it, as of rates of joints; filtered"),
            may("initial", Type::Number("-", Range::Any), "I at the start; 0"),
            may("initial_error", Type::Number("-", Range::Any), "z at the start, e for a start without a kick; 0"),
            may("least", Type::OfNodes("-"), "lower limit of u; none"),
            may("most", Type::OfNodes("-"), "upper limit of u; none"),
            may(
                "tracking_time",
                Type::Number("s", Range::Positive),
                "time in which I follows u at a limit; needed with one",
            ),
        ],
    },
    defaults: &[["proportional", "0"], ["integral", "0"], ["initial", "0"], ["initial_error", "0"]],
    law: |given| {
        let [filtered, is_rate] = ["filter_time", "error_rate"].map(given);
        let bounds = ["least", "most"].map(given);
        if given("derivative") != (filtered || is_rate) || (filtered && is_rate) {
            return Err("derivative needs one of filter_time and error_rate, and these need it");
        }
        if given("initial_error") && !filtered {
            return Err("initial_error is a start of the filter of the derivative: give filter_time, too, or leave it out");
        }
        if given("tracking_time") != bounds.contains(&true) {
            return Err("limits least and most need tracking_time, and it needs one of them");
        }
        let mut own = Law { definitions: vec![["e", "set_point - measured"]], ..Law::default() };
        own.definitions.push(match (filtered, is_rate) {
            (false, false) => ["free", "proportional * e + integral_term"],
            (true, _) => ["d", "(e - filtered_error) / filter_time"],
            _ => ["d", "error_rate"],
        });
        if filtered || is_rate {
            own.definitions.push(["free", "proportional * e + integral_term + derivative * d"]);
        }
        own.definitions.push([
            "u",
            match bounds {
                [false, false] => "free",
                [true, false] => "max(free, least)",
                [false, true] => "min(free, most)",
                [true, true] => "min(max(free, least), most)",
            },
        ]);
        let is_limited = bounds.contains(&true);
        let rate = if is_limited { "integral * e + (u - free) / tracking_time" } else { "integral * e" };
        own.states.push(["integral_term", "initial", rate]);
        own.states.extend(filtered.then_some(["filtered_error", "initial_error", "d"]));
        own.outputs = vec![["output", "u"], ["error", "e"]];
        Ok(own)
    },
};

/// A state that a file writes itself.
const WRITTEN: Form = Form {
    name: "formula",
    doc: "by its rates, whose formulas know its own values by their names",
    keys: &[
        need("initial", Type::NamedFormulas("-"), "values at the start by their names"),
        need("rate", Type::NamedFormulas("1/s"), "rates of all of them by the same names"),
        may(
            "output",
            Type::NamedFormulas("-"),
            "numbers or vectors that others know beside the values, by their names; none",
        ),
    ],
};

/// All forms of a state.
pub(super) const STATE_FORMS: [Form; STATE_ENTRIES.len() + 1] = [WRITTEN, LAG.form, PID.form];
