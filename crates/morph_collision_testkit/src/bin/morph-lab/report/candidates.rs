//! The candidates of each comparison.

use morph_collision_testkit::bench::{Contender, Experiment};
use morph_collision_testkit::rivals::{MethodKind, MethodOptions, SetUpError};

/// The label of our method with a remembered pair of leaves.
pub(crate) const WITNESS: &str = "morph, remembered pair";

/// One row of a future table. The others are compared with the first row.
pub(crate) struct Candidate {
    pub(crate) label: String,
    pub(crate) method: MethodKind,
    pub(crate) options: MethodOptions,
}

impl Candidate {
    pub(crate) fn set_up(&self, experiment: &Experiment) -> Result<Contender, SetUpError> {
        Contender::set_up(&self.label, self.method, experiment, &self.options)
    }
}

pub(crate) fn morph(label: impl Into<String>, options: MethodOptions) -> Candidate {
    Candidate {
        label: label.into(),
        method: MethodKind::Morph,
        options,
    }
}

/// A method with leaf sizes that suit it: our default, or 4 if its walks test triangles one by one.
pub(crate) fn rival(label: impl Into<String>, method: MethodKind) -> Candidate {
    let options = if method.uses_our_trees() {
        MethodOptions::default()
    } else {
        with_leaf_size(4)
    };
    Candidate {
        label: label.into(),
        method,
        options,
    }
}

fn with_leaf_size(leaf_size: usize) -> MethodOptions {
    MethodOptions::default().with_leaf_size(leaf_size).expect("1 to 255")
}

/// The defaults and other leaf sizes.
pub(crate) fn leaves(_: &Experiment) -> Vec<Candidate> {
    let default = MethodOptions::default();
    let mut rows = vec![morph("leaf 8, the default", default)];
    for leaf in [1, 2, 4, 16] {
        rows.push(morph(format!("leaf {leaf}"), with_leaf_size(leaf)));
    }
    // Its distance from 1 is the noise.
    rows.push(morph("leaf 8 (the default again)", default));
    rows
}

/// The effect of remembering the last intersection of a pair of bodies.
pub(crate) fn witness(_: &Experiment) -> Vec<Candidate> {
    let witness = MethodOptions {
        witness: true,
        ..MethodOptions::default()
    };
    vec![morph("morph", MethodOptions::default()), morph(WITNESS, witness)]
}

/// The same beside the best methods that pose and refit everything.
pub(crate) fn witness_and_rivals(experiment: &Experiment) -> Vec<Candidate> {
    let rivals = [
        MethodKind::Hybrid,
        MethodKind::BottomUp,
        MethodKind::HybridScalar,
        MethodKind::BottomUpScalar,
        MethodKind::ParryTriMesh,
    ];
    let rivals = rivals.map(|kind| rival(kind.to_string(), kind));
    witness(experiment).into_iter().chain(rivals).collect()
}

/// Every method; the oracle only if it finishes in reasonable time.
pub(crate) fn methods(experiment: &Experiment) -> Vec<Candidate> {
    let small = experiment.mesh.triangles.len() < 1000;
    let skinned = experiment.mesh.skin.is_some();
    let rays = !experiment.rays.is_empty();
    let is_candidate = |kind: &MethodKind| {
        (small || *kind != MethodKind::BruteForce)
            && (if skinned {
                kind.supports_skins()
            } else {
                !kind.is_for_skins()
            })
            && (!rays || kind.casts_rays())
    };
    let methods = MethodKind::ALL.into_iter().filter(is_candidate);
    methods.map(|method| rival(method.to_string(), method)).collect()
}
