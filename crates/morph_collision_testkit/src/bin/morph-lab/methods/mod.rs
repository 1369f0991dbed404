//! The methods by the names that `run` and `bench` share, and their options.

mod options;
mod paper;

use clap::builder::{PossibleValue, PossibleValuesParser};
use morph_collision_testkit::rivals::MethodKind;

pub(crate) use options::MethodArgs;
pub(crate) use paper::PaperArgs;

/// The heading of the options that choose a method.
pub(crate) const HEADING: &str = "Methods";

/// The binary form of `hybrid-scalar`, which is not a method of its own.
pub(crate) const HYBRID_BINARY: &str = "hybrid-binary";

/// All methods with a description each.
const METHODS: [(&str, &str); 11] = [
    ("morph", "this library's method"),
    (
        "hybrid",
        "refits half of the tree up front and the rest on demand, with this library's code",
    ),
    (
        "bottom-up",
        "refits all boxes from the leaves up, with this library's code",
    ),
    (
        "rigid-floor",
        "this library's method over meshes frozen beforehand: the cost without any morphing",
    ),
    ("paper", "the method as published; not for skinned models"),
    ("hybrid-scalar", "hybrid as usually written, in plain loops"),
    (HYBRID_BINARY, "the same with two children per node"),
    ("bottom-up-scalar", "bottom-up as usually written, in plain loops"),
    ("joint-boxes", "boxes from one box per joint; for skinned models"),
    ("parry-trimesh", "Parry's triangle mesh with updated vertices"),
    (
        "brute-force",
        "all triangles against all, in exact arithmetic; very slow",
    ),
];

/// Accepts the names.
pub(crate) fn names() -> PossibleValuesParser {
    PossibleValuesParser::new(METHODS.map(|(name, about)| PossibleValue::new(name).help(about)))
}

/// The method with one of these names.
pub(crate) fn kind(name: &str) -> MethodKind {
    let name = if name == HYBRID_BINARY { "hybrid-scalar" } else { name };
    name.parse().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use morph_collision_testkit::bench::Entrant;

    use super::*;

    #[test]
    fn the_list_has_every_method_that_runs_or_is_measured() {
        let names = METHODS.map(|(name, _)| name);
        let mut measured: Vec<&str> = Entrant::ALL
            .iter()
            .chain(&Entrant::SLOW)
            .map(|entrant| entrant.name)
            .collect();
        measured.sort_unstable();
        let mut sorted = names;
        sorted.sort_unstable();
        assert_eq!(measured, sorted);
        for kind in MethodKind::ALL {
            assert!(names.contains(&kind.to_string().as_str()), "{kind}");
        }
        for name in names {
            let expected = if name == HYBRID_BINARY { "hybrid-scalar" } else { name };
            assert_eq!(kind(name).to_string(), expected);
        }
    }
}
