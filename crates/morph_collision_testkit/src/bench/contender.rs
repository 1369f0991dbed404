//! The methods that a benchmark compares.

use super::Experiment;
use crate::rivals::{Method, MethodKind, MethodOptions, PaperOptions, SetUpError};

/// A method set up for an experiment's bodies.
#[derive(Debug)]
pub struct Contender {
    /// Its name in tables.
    pub name: String,
    /// The method, holding the bodies.
    pub method: Box<dyn Method>,
}

impl Contender {
    /// Sets a method up for an experiment's bodies.
    ///
    /// # Errors
    /// See [`MethodKind::set_up`].
    pub fn set_up(
        name: impl Into<String>,
        kind: MethodKind,
        experiment: &Experiment,
        options: &MethodOptions,
    ) -> Result<Self, SetUpError> {
        let of_bodies = vec![0; experiment.bodies];
        let meshes = std::slice::from_ref(&experiment.mesh);
        Ok(Self {
            name: name.into(),
            method: kind.set_up(meshes, &of_bodies, options)?,
        })
    }
}

/// A method as it takes part in benchmarks: with its own name, and with tree options that suit it.
#[derive(Clone, Copy, Debug)]
pub struct Entrant {
    /// Its name.
    pub name: &'static str,
    kind: MethodKind,
    trees: Trees,
}

/// How an entrant's trees are built.
#[derive(Clone, Copy, Debug)]
enum Trees {
    /// With the user's options for our trees.
    Ours,
    /// With at most this many children per node and triangles per leaf.
    Own { arity: usize, leaf_size: usize },
}

/// Eight-wide with four triangles per leaf, which is best for walks that test triangles one by one.
const WIDE: Trees = Trees::Own { arity: 8, leaf_size: 4 };

/// Of 1, 2, 4 and 8 triangles per leaf, 4 is best for binary trees too: it takes 0.66 to 0.98 of the time of 1 over the
/// experiments.
const BINARY: Trees = Trees::Own { arity: 2, leaf_size: 4 };

impl Entrant {
    /// All methods that a benchmark runs, ours first.
    pub const ALL: [Self; 10] = [
        Self::new("morph", MethodKind::Morph, Trees::Ours),
        Self::new("hybrid", MethodKind::Hybrid, Trees::Ours),
        Self::new("bottom-up", MethodKind::BottomUp, Trees::Ours),
        Self::new("rigid-floor", MethodKind::RigidFloor, Trees::Ours),
        Self::new("paper", MethodKind::Paper(PaperOptions::BOXES), Trees::Ours),
        Self::new("hybrid-scalar", MethodKind::HybridScalar, WIDE),
        Self::new("hybrid-binary", MethodKind::HybridScalar, BINARY),
        Self::new("bottom-up-scalar", MethodKind::BottomUpScalar, WIDE),
        Self::new("joint-boxes", MethodKind::JointBoxes, WIDE),
        Self::new("parry-trimesh", MethodKind::ParryTriMesh, WIDE),
    ];

    /// Methods that are far slower than all others, so that they run only if they are asked for.
    pub const SLOW: [Self; 1] = [Self::new("brute-force", MethodKind::BruteForce, Trees::Ours)];

    const fn new(name: &'static str, kind: MethodKind, trees: Trees) -> Self {
        Self { name, kind, trees }
    }

    /// The same entrant, with other options if it is the paper's method.
    #[must_use]
    pub fn with_paper(self, options: PaperOptions) -> Self {
        match self.kind {
            MethodKind::Paper(_) => Self::new(self.name, MethodKind::Paper(options), self.trees),
            _ => self,
        }
    }

    /// Whether it is the paper's method, which has its own tree.
    #[must_use]
    pub fn is_paper(&self) -> bool {
        matches!(self.kind, MethodKind::Paper(_))
    }

    /// Whether it is not a rival but the cost of the same bodies if they did not morph.
    #[must_use]
    pub fn is_floor(&self) -> bool {
        self.kind == MethodKind::RigidFloor
    }

    /// Whether it can collide the experiment's mesh, or cast rays at it.
    #[must_use]
    pub fn supports(&self, experiment: &Experiment) -> bool {
        let fits = if experiment.mesh.skin.is_some() {
            self.kind.supports_skins()
        } else {
            !self.kind.is_for_skins()
        };
        fits && (experiment.rays.is_empty() || self.kind.casts_rays())
    }

    /// Sets it up. `ours` are the options of our trees.
    ///
    /// # Errors
    /// See [`MethodKind::set_up`].
    pub fn set_up(&self, experiment: &Experiment, ours: &MethodOptions) -> Result<Contender, SetUpError> {
        let options = match self.trees {
            Trees::Ours => *ours,
            Trees::Own { arity, leaf_size } => MethodOptions {
                arity,
                ..MethodOptions::default().with_leaf_size(leaf_size)?
            },
        };
        Contender::set_up(self.name, self.kind, experiment, &options)
    }
}
