//! The cases with their files and limits.

/// A scene of a file, whose functionals have the names of the references.
pub struct Case {
    pub name: &'static str,
    /// Its name among the references.
    pub reference: &'static str,
    pub text: &'static str,
    /// Limits of the relative errors of values and derivatives with the steps that the file gives.
    pub given: [f64; 2],
    /// Tolerance of chosen steps.
    pub tolerance: f64,
    /// Limits with chosen steps.
    pub chosen: [f64; 2],
}

/// Powers of 1.5 have no second derivative where they begin: their runs converge slowly, and derivatives more slowly. The reference of the penalty floor
/// has ten digits of its value, and seven of its derivative.
pub const CASES: [Case; 17] = [
    Case {
        name: "bounce-set",
        reference: "E01",
        text: include_str!("bounce-set.toml"),
        given: [1e-11, 1e-11],
        tolerance: 1e-11,
        chosen: [1e-11, 1e-11],
    },
    Case {
        name: "bounce-stop",
        reference: "E01",
        text: include_str!("bounce-stop.toml"),
        given: [1e-11, 1e-11],
        tolerance: 1e-11,
        chosen: [1e-11, 1e-11],
    },
    Case {
        name: "moving-table",
        reference: "E02",
        text: include_str!("moving-table.toml"),
        given: [1e-10, 1e-10],
        tolerance: 1e-11,
        chosen: [1e-10, 1e-10],
    },
    Case {
        name: "wall",
        reference: "E03",
        text: include_str!("wall.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "wall-point",
        reference: "E03",
        text: include_str!("wall-point.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "knee",
        reference: "E04a",
        text: include_str!("knee.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "hunt-crossley",
        reference: "E09a",
        text: include_str!("hunt-crossley.toml"),
        given: [1e-8, 1e-5],
        tolerance: 1e-12,
        chosen: [1e-9, 1e-7],
    },
    Case {
        name: "hunt-crossley-floor",
        reference: "E09b",
        text: include_str!("hunt-crossley-floor.toml"),
        given: [1e-3, 1e-3],
        tolerance: 1e-12,
        chosen: [1e-7, 1e-5],
    },
    Case {
        name: "hertz",
        reference: "E10",
        text: include_str!("hertz.toml"),
        given: [1e-8, 1e-6],
        tolerance: 1e-12,
        chosen: [1e-9, 1e-7],
    },
    Case {
        name: "latch",
        reference: "E15",
        text: include_str!("latch.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "cradle-stops",
        reference: "E18",
        text: include_str!("cradle-stops.toml"),
        given: [1e-11, 1e-11],
        tolerance: 1e-11,
        chosen: [1e-11, 1e-11],
    },
    Case {
        name: "cradle-events",
        reference: "E18",
        text: include_str!("cradle-events.toml"),
        given: [1e-11, 1e-11],
        tolerance: 1e-11,
        chosen: [1e-11, 1e-11],
    },
    Case {
        name: "leaves",
        reference: "E22",
        text: include_str!("leaves.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "release",
        reference: "E24",
        text: include_str!("release.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "clegg",
        reference: "E27",
        text: include_str!("clegg.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-8, 1e-8],
    },
    Case {
        name: "buffers",
        reference: "E34",
        text: include_str!("buffers.toml"),
        given: [1e-9, 1e-9],
        tolerance: 1e-13,
        chosen: [1e-9, 1e-9],
    },
    Case {
        name: "penalty-floor",
        reference: "penalty",
        text: include_str!("penalty-floor.toml"),
        given: [1e-6, 1e-6],
        tolerance: 1e-11,
        chosen: [1e-9, 1e-7],
    },
];

/// One step of the simplest walker.
pub const WALKER: &str = include_str!("walker.toml");
