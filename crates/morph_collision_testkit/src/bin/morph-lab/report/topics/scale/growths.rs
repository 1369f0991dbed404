//! What grows, and the experiments of each size.

use morph_collision_models::generated::random::random_blob;
use morph_collision_testkit::bench::Experiment;

use crate::report::context::Context;

/// A number that grows.
pub(super) struct Growth {
    /// The name of its scenes.
    pub(super) scene: &'static str,
    pub(super) title: &'static str,
    /// The number.
    pub(super) axis: &'static str,
}

const BODIES: Growth = Growth {
    scene: "bodies",
    title: "Bodies: dolphins of 564 triangles",
    axis: "bodies",
};

const TRIANGLES: &str = "triangles";

const DENSE: &str = "targets, each of which moves every vertex";
const SPARSE: &str = "targets, each of which moves 15 % of the vertices";

pub(super) const GROWTHS: [Growth; 6] = [
    BODIES,
    Growth {
        scene: TRIANGLES,
        title: "Triangles: two bodies that pass through each other",
        axis: "triangles of a body",
    },
    Growth {
        scene: "dense",
        title: "Dense targets: two grazing bodies of 20480 triangles",
        axis: DENSE,
    },
    Growth {
        scene: "sparse",
        title: "Sparse targets: the same bodies",
        axis: SPARSE,
    },
    Growth {
        scene: "dense-growing",
        title: "Dense targets, the sum of weights growing along",
        axis: DENSE,
    },
    Growth {
        scene: "sparse-growing",
        title: "Sparse targets, the sum of weights growing along",
        axis: SPARSE,
    },
];

/// Up to this many targets have full weights. If there are more, each weight is smaller, so that the sum stays the same.
const FULL_WEIGHTS: f64 = 16.0;

impl Growth {
    /// The sizes.
    pub(super) fn sizes(&self, quick: bool) -> Vec<usize> {
        match (self.scene, quick) {
            ("bodies", true) => vec![1, 10, 100],
            ("bodies", false) => vec![1, 3, 10, 30, 100, 300, 1000],
            (TRIANGLES, true) => (3..=5).map(triangles).collect(),
            (TRIANGLES, false) => (3..=8).map(triangles).collect(),
            (_, true) => vec![2, 16, 128],
            (_, false) => vec![2, 4, 8, 16, 32, 64, 128, 256],
        }
    }

    /// The experiment of a size.
    pub(super) fn experiment(&self, context: &Context, size: usize) -> Experiment {
        let every = context.every;
        let mut experiment = match self.scene {
            "bodies" => Experiment::many_dolphins(size, 0, every),
            TRIANGLES => {
                let level = (0..).find(|&level| triangles(level) >= size).unwrap_or(0);
                Experiment::pass_through(level, 2 * every)
            }
            scene => {
                let sparsity = if scene.starts_with("dense") { 0.0 } else { 0.85 };
                let most = if scene.ends_with("growing") {
                    f64::INFINITY
                } else {
                    FULL_WEIGHTS
                };
                let share = (most / size as f64).min(1.0);
                Experiment::grazing(scene, random_blob(7, 5, size, sparsity), share, 2 * every)
            }
        };
        experiment.name = self.scene.to_owned();
        experiment.title = self.title.to_owned();
        experiment
    }
}

/// Triangles of a body of the pass-through.
fn triangles(level: u32) -> usize {
    20 * 4_usize.pow(level)
}
