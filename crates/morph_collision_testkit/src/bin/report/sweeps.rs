//! What is compared with what.

use morph_collision::{BuildOptions, Remember, SeparatingAxes, Split, VolumeKind};
use morph_collision_testkit::bench::{Contender, Experiment};
use morph_collision_testkit::rivals::{MethodKind, MorphTuning, SetUpError};

/// One row of a table to be; the first of them is what the others are compared with.
pub(crate) struct Candidate {
    pub(crate) label: String,
    pub(crate) method: MethodKind,
    pub(crate) options: BuildOptions,
    pub(crate) tuning: MorphTuning,
}

impl Candidate {
    pub(crate) fn set_up(&self, experiment: &Experiment) -> Result<Contender, SetUpError> {
        Contender::set_up(&self.label, self.method, experiment, &self.options, self.tuning)
    }
}

pub(crate) fn morph(label: impl Into<String>, options: BuildOptions) -> Candidate {
    Candidate {
        label: label.into(),
        method: MethodKind::Morph,
        options,
        tuning: MorphTuning::default(),
    }
}

/// The defaults, and everything that differs from them in one option.
pub(crate) fn options(_: &Experiment) -> Vec<Candidate> {
    let default = BuildOptions::default;
    let mut rows = vec![morph("default", default())];
    for kind in VolumeKind::ALL.into_iter().filter(|&kind| kind != default().volume) {
        rows.push(morph(kind.to_string(), default().with_volume(kind)));
    }
    for arity in [2, 4, 8].into_iter().filter(|&arity| arity != default().arity) {
        rows.push(morph(format!("arity {arity}"), default().with_arity(arity)));
    }
    for leaf in [1, 2, 4, 8, 16].into_iter().filter(|&leaf| leaf != default().leaf_size) {
        rows.push(morph(format!("leaf {leaf}"), default().with_leaf_size(leaf)));
    }
    for split in Split::ALL.into_iter().filter(|&split| split != default().split) {
        rows.push(morph(split.to_string(), default().with_split(split)));
    }
    rows.push(morph("no leaf tables", default().with_leaf_tables(false)));
    rows.push(morph("interval only", default().with_scales([])));
    rows.push(morph("scale 4", default().with_scales([4.0])));
    rows.push(morph("scales 1, 4", default().with_scales([1.0, 4.0])));
    rows.push(morph(
        "scales 1, 4, reflected",
        default().with_scales([1.0, 4.0]).with_reflected(true),
    ));
    rows.push(morph("16-bit tables", default().with_compact(true)));
    rows.push(morph("in-betweens", default().with_in_betweens(true)));
    rows.push(morph("the paper's", BuildOptions::paper()));
    rows
}

/// Options that depend on each other: kind of volume, leaf size and leaf tables.
pub(crate) fn shape(_: &Experiment) -> Vec<Candidate> {
    let mut rows = vec![morph("default", BuildOptions::default())];
    for kind in [VolumeKind::Aabb, VolumeKind::Kdop18] {
        for leaf in [2, 4, 8, 16] {
            for tables in [true, false] {
                let options = BuildOptions::default().with_volume(kind).with_leaf_size(leaf);
                let options = options.with_leaf_tables(tables);
                let mut label = format!("{kind}, leaf {leaf}");
                if !tables {
                    label += ", no leaf tables";
                }
                // It stays: how far it is from 1 is the noise.
                if options == BuildOptions::default() {
                    label += " (the default again)";
                }
                rows.push(morph(label, options));
            }
        }
    }
    rows
}

/// What is kept from frame to frame, and the full separating-axis test.
pub(crate) fn memory(_: &Experiment) -> Vec<Candidate> {
    let row = |label: &str, axes, remember| Candidate {
        tuning: MorphTuning { axes, remember },
        ..morph(label, BuildOptions::default())
    };
    let lite = SeparatingAxes::Lite;
    let remember = |separation, front, witness| Remember {
        separation,
        front,
        witness,
    };
    vec![
        row("default", lite, Remember::NOTHING),
        row("full SAT", SeparatingAxes::Full, Remember::NOTHING),
        row("witness", lite, remember(false, false, true)),
        row("separation", lite, remember(true, false, false)),
        row("separation and witness", lite, remember(true, false, true)),
        row("front", lite, remember(false, true, false)),
        row("separation and front", lite, remember(true, true, false)),
    ]
}

/// Every method; the oracle only where it comes to an end.
pub(crate) fn methods(experiment: &Experiment) -> Vec<Candidate> {
    let mut rows = vec![
        morph("morph", BuildOptions::default()),
        morph("morph, the paper's tree", BuildOptions::paper()),
    ];
    let small = experiment.mesh.triangles.len() < 1000;
    let rivals = MethodKind::ALL
        .into_iter()
        .filter(|&kind| kind != MethodKind::Morph && (small || kind != MethodKind::BruteForce));
    let options = |method| match method {
        MethodKind::MorphEager | MethodKind::RigidFloor => BuildOptions::default(),
        // What suits walks that test triangles one by one.
        _ => BuildOptions::default().with_leaf_size(4),
    };
    rows.extend(rivals.map(|method| Candidate {
        label: method.to_string(),
        method,
        options: options(method),
        tuning: MorphTuning::default(),
    }));
    rows
}
