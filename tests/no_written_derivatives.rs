//! Nobody writes a derivative: the contracts have no method for one, and no helper in the folders of formulas is one.

use std::collections::BTreeSet;
use std::path::Path;

/// All methods of the contracts: formulas, and how many numbers they have. Another method is another promise of an author: it belongs here
/// only if it cannot be read off the recording.
const CONTRACTS: [(&str, &str, &str); 8] = [
    (
        "elements/element.rs",
        "Element",
        "nodes parameters residual kinetic potential strain_energy add_force strain_count strains stored damping dissipation mass breakpoints \
         in_stages",
    ),
    (
        "elements/field.rs",
        "Field",
        "parameters parameters_of node_map residual kinetic potential strain_energy add_force strain_count strains stored stored_together damping \
         dissipation_together mass breakpoints",
    ),
    ("elements/constraint.rs", "Constraint", "nodes equations parameters g is_driver breakpoints"),
    ("elements/time_formula.rs", "TimeFormula", "parameters value breakpoints"),
    ("elements/nonholonomic.rs", "NonholonomicConstraint", "nodes parameters h breakpoints"),
    ("functionals/quantity.rs", "Quantity", "dofs parameters value rated_count rated value_with_rates"),
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
const OTHERS: [(&str, &str, &str); 15] = [
    ("elements/lagrangian.rs", "gradient", "of what was recorded"),
    ("elements/dyn_layer.rs", "motion_derivatives", "of what was recorded"),
    ("elements/dyn_layer.rs", "reaction_gradient", "of what was recorded"),
    ("elements/flexible/small_strain_cable.rs", "second_derivative", "d2r/dx2 along the cable, from its shape functions"),
    ("elements/flexible/cable.rs", "derivatives", "dr/dx and d2r/dx2 along the cable, from its shape functions"),
    ("elements/flexible/hermite.rs", "derivative_rows", "of shape functions, as tables of numbers"),
    ("functionals/aggregate.rs", "derivatives", "of a formula of a few sums, by dual numbers"),
    ("functionals/aggregate.rs", "with_derivative", "a dual number to begin with"),
    ("functionals/measured_group.rs", "gradient", "makes the program of the recording"),
    ("functionals/functional.rs", "share_transposed", "hands on to the solve with transposed matrices below"),
    ("functionals/functional.rs", "add_gradient", "runs the program made of the recording"),
    ("functionals/reactions.rs", "add_gradient", "of the root mean square of lengths: one of the last that are written"),
    (
        "functionals/reactions.rs",
        "length_gradient",
        "by the length that makes moments forces: one of the last that are written",
    ),
    ("functionals/reactions.rs", "add_least_multipliers_transposed", "solve with transposed matrices, as in a step"),
    ("functionals/reactions.rs", "add_row_gradient", "runs the program made of the recording"),
];

fn source() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Names of the functions in a text, tests left out.
fn functions(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
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
    for folder in ["elements", "functionals"] {
        suspects(&source().join(folder), &mut found, &mut files);
    }
    assert!(files > 60, "only {files} files were read");
    let allowed: BTreeSet<_> = OTHERS.iter().map(|&(place, name, _)| (place.to_string(), name.to_string())).collect();
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
