//! Nobody writes a derivative: the contracts have no method for one, and no function of the library is one.

use std::collections::BTreeSet;
use std::path::Path;

/// All methods of the contracts: formulas, and how many numbers they have. Another method is another promise of an author: it belongs here
/// only if it cannot be read off the recording.
const CONTRACTS: [(&str, &str, &str); 10] = [
    (
        "elements/element.rs",
        "Element",
        "nodes parameters residual kinetic potential strain_energy add_force strain_count strains stored damping dissipation mass outputs write_outputs in_stages",
    ),
    (
        "elements/field.rs",
        "Field",
        "parameters parameters_of node_map residual kinetic potential strain_energy add_force strain_count strains stored stored_together damping \
         dissipation_together mass",
    ),
    ("elements/constraint.rs", "Constraint", "nodes equations parameters g surfaces is_driver"),
    ("elements/friction.rs", "Friction", "nodes parameters directions slip load limits"),
    ("elements/characteristic.rs", "ForceLaw", "parameters value"),
    ("elements/time_formula.rs", "TimeFormula", "parameters value"),
    ("elements/nonholonomic.rs", "NonholonomicConstraint", "nodes parameters h"),
    ("functionals/quantity.rs", "Quantity", "dofs unit parameters value rated_count rated value_with_rates"),
    ("functionals/point_quantity.rs", "PointQuantity", "parameters is_of at_points"),
    ("functionals/shell_quantity.rs", "ShellQuantity", "parameters is_of at_points"),
];

/// Parts of names that say derivative, or product with one.
const WORDS: [&str; 12] = [
    "deriv",
    "gradient",
    "jacobian",
    "hessian",
    "partial",
    "sensitiv",
    "tangent",
    "adjoint",
    "transposed",
    "linearized",
    "jvp",
    "vjp",
];

/// Functions with such a name that are no derivative of a formula that somebody wrote, and why.
const OTHERS: [(&str, &str, &str); 51] = [
    ("elements/lagrangian.rs", "gradient", "of what was recorded"),
    ("elements/dyn_layer.rs", "motion_derivatives", "of what was recorded"),
    ("program/recorded.rs", "derived gradient_of", "of what was recorded"),
    ("program/formula.rs", "derived gradient", "of what was recorded"),
    ("program/derivatives.rs", "partials", "of the single operations of a recording: where all derivatives begin"),
    ("program/scalar/jet.rs", "derivatives_of_power", "of an operation that a recording has"),
    (
        "program/scalar/rotation.rs",
        "g_transposed_times rotation_gradient_transposed",
        "G(e)^T m and the generalized force of a force on a body, as formulas have them",
    ),
    ("elements/flexible/small_strain_cable.rs", "second_derivative", "d2r/dx2 along the cable, from its shape functions"),
    ("elements/flexible/cable.rs", "derivatives", "dr/dx and d2r/dx2 along the cable, from its shape functions"),
    ("elements/flexible/hermite.rs", "derivative_rows", "of shape functions, as tables of numbers"),
    ("program/switch_times.rs", "gradient", "of what was recorded"),
    ("sensitivity/breakpoints.rs", "add_transposed", "of what was recorded"),
    ("sensitivity/switched.rs", "gradient_by_halved_steps", "an adjoint of another run"),
    ("assembly/element_programs.rs", "gradient", "makes the program of the recording"),
    ("assembly/jacobian.rs", "reduce_adjoint set_adjoints", "adjoint variables along the reduced unknowns and back"),
    ("linalg/lib.rs", "solve_transposed", "J^T x = b"),
    ("linalg/dense.rs", "solve_transposed", "J^T x = b"),
    ("linalg/factorization.rs", "solve_transposed", "J^T x = b"),
    ("linalg/multifrontal/multifrontal_lu.rs", "solve_transposed", "J^T x = b"),
    ("linalg/mumps.rs", "solve_transposed", "J^T x = b"),
    (
        "linalg/multifrontal/kernels.rs",
        "solve_unit_lower_transposed solve_upper_transposed subtract_transposed_product",
        "parts of J^T x = b",
    ),
    ("linalg/multifrontal/graph.rs", "transposed", "the pattern of J^T"),
    ("design/mod.rs", "gradient tangent", "by the programs of the recorded map"),
    ("integrators/amplitudes.rs", "solve_transposed", "P^T x = b of complex amplitudes"),
    ("sensitivity/mode_gradients.rs", "gradients", "of values of modes, by the programs of products in complex numbers"),
    ("scenes/differentiated_modes.rs", "modes_with_gradients", "the same for a scene"),
    ("cli/report/run_report.rs", "add_gradient", "to a page"),
    (
        "integrators/resolution.rs",
        "weights_of_derivative",
        "of a polynomial through the last accelerations, for an estimated error",
    ),
    ("functionals/aggregate.rs", "derivatives with_derivative", "of a formula of a few sums, by dual numbers"),
    ("functionals/measured_group.rs", "gradient", "makes the program of the recording"),
    (
        "functionals/functional.rs",
        "share_transposed add_gradient",
        "hands on to the programs of recordings, and to the reverse of a sparse system",
    ),
    (
        "functionals/reactions.rs",
        "add_least_multipliers_transposed",
        "the reverse of a sparse system whose entries are recorded",
    ),
    ("sensitivity/adjoint.rs", "adjoint", "the sweep back"),
    ("sensitivity/analysis.rs", "adjoint adjoint_by_parameters adjoint_of tangent", "begin sweeps"),
    ("sensitivity/over_time.rs", "tangent_over_time", "begins sweeps"),
    ("scenes/prepared.rs", "gradient_limits", "how far a gradient may be from its check"),
    ("scenes/run.rs", "gradient", "begins a sweep"),
    ("optimize/design_program.rs", "gradient gradients gradients_of", "those of runs, and of recorded combinations of them"),
    ("assembly/resting.rs", "add_gradient", "adds up what copies of parameters got"),
    ("elements/at_rest.rs", "turn_gradient", "of a recording"),
    ("optimize/evaluations.rs", "gradients", "those of a program, kept"),
    ("optimize/fit.rs", "jacobian", "by runs with derivative parts"),
    ("optimize/levenberg_marquardt.rs", "jacobian", "the contract of residuals"),
    ("optimize/program.rs", "gradients", "the contract of a program to be optimized"),
    ("optimize/scaling.rs", "gradient", "in scaled variables"),
    ("cli/gradient.rs", "adjoint_work", "counts"),
    ("cli/influences.rs", "gradients insert_gradient", "write"),
    ("cli/meshes.rs", "write_gradients", "writes"),
    ("cli/optimize.rs", "gradient_by gradient_name", "names of a choice"),
    ("testing.rs", "adjoints", "made up, for a check"),
    ("python/src/run.rs", "gradient tangent derivatives", "hand out"),
];

fn source() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Names of the functions in a text, tests left out.
fn functions(text: &str) -> Vec<String> {
    // what stands in front of an item of the file, not of an impl
    let text = text.split("\n#[cfg(test)]").next().unwrap_or_default();
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let names = code.flat_map(|line| {
        line.split("fn ")
            .skip(1)
            .map(|rest| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>())
    });
    names.filter(|name| !name.is_empty()).collect()
}

/// Functions whose names say derivative.
fn suspects(folder: &Path, found: &mut BTreeSet<(String, String)>, files: &mut usize) {
    for entry in std::fs::read_dir(folder).expect("a folder of src").map(|entry| entry.expect("readable").path()) {
        if entry.is_dir() {
            suspects(&entry, found, files);
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            *files += 1;
            let text = std::fs::read_to_string(&entry).expect("readable");
            let place = entry.strip_prefix(source()).expect("inside src").to_string_lossy().replace('\\', "/");
            let named = functions(&text).into_iter().filter(|name| WORDS.iter().any(|word| name.contains(word)));
            found.extend(named.map(|name| (place.clone(), name)));
        }
    }
}

#[test]
fn no_helper_is_a_derivative() {
    let (mut found, mut files) = (BTreeSet::new(), 0);
    suspects(&source(), &mut found, &mut files);
    assert!(files > 350, "only {files} files were read");
    let names = |&(place, names, _): &(&str, &str, &str)| {
        names.split(' ').map(|name| (place.to_string(), name.to_string())).collect::<Vec<_>>()
    };
    let allowed: BTreeSet<_> = OTHERS.iter().flat_map(names).collect();
    let written: Vec<_> = found.difference(&allowed).collect();
    assert!(written.is_empty(), "derivatives are made of recordings, not written: {written:?}");
    let gone: Vec<_> = allowed.difference(&found).collect();
    assert!(gone.is_empty(), "nothing has these names any more: {gone:?}");
}

#[test]
fn contracts_have_no_method_for_a_derivative() {
    for (place, name, methods) in CONTRACTS {
        let text = std::fs::read_to_string(source().join(place)).expect("readable");
        let start = text.find(&format!("pub trait {name}")).unwrap_or_else(|| panic!("{place} has no trait {name}"));
        let body = text[start..].split("\n}").next().expect("a body");
        let own: BTreeSet<String> = functions(body).into_iter().collect();
        let expected: BTreeSet<String> = methods.split(' ').map(String::from).collect();
        assert_eq!(own, expected, "methods of {name}");
    }
}
