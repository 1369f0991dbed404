//! What is measured against what.

use super::Experiment;
use crate::rivals::{Method, MethodKind, MethodOptions, PaperOptions, SetUpError};

/// A method that is ready for an experiment's bodies.
#[derive(Debug)]
pub struct Contender {
    /// Its name in tables.
    pub name: String,
    /// It, holding the bodies.
    pub method: Box<dyn Method>,
}

impl Contender {
    /// Sets a method up for an experiment's bodies.
    ///
    /// # Errors
    /// As [`MethodKind::set_up`].
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

/// A method as a benchmark enters it: by a name of its own, with the trees that suit it.
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
    /// As the user wants ours.
    Ours,
    /// With at most so many children, and so many triangles in a leaf.
    Own { arity: usize, leaf_size: usize },
}

/// Eight-wide with four triangles in a leaf: what walks like best that test triangles one by one (`docs/performance.md`).
const WIDE: Trees = Trees::Own { arity: 8, leaf_size: 4 };

/// Of 1, 2, 4 and 8 triangles in a leaf 4 suits binary trees best, too: 0.66 to 0.98 of the time of 1 over the experiments.
const BINARY: Trees = Trees::Own { arity: 2, leaf_size: 4 };

impl Entrant {
    /// All that a benchmark runs, ours first; the octree and brute force are not in it, being far behind.
    pub const ALL: [Self; 13] = [
        Self::new("morph", MethodKind::Morph, Trees::Ours),
        Self::new("morph-eager", MethodKind::MorphEager, Trees::Ours),
        Self::new("rigid-floor", MethodKind::RigidFloor, Trees::Ours),
        Self::new("paper", MethodKind::Paper(PaperOptions::BOXES), Trees::Ours),
        Self::new("hybrid", MethodKind::Hybrid, WIDE),
        Self::new("hybrid-binary", MethodKind::Hybrid, BINARY),
        Self::new("bottom-up", MethodKind::BottomUp, WIDE),
        Self::new("joint-boxes", MethodKind::JointBoxes, WIDE),
        Self::new("joint-union", MethodKind::JointUnion, WIDE),
        Self::new("rebuild", MethodKind::Rebuild, WIDE),
        Self::new("parry-trimesh", MethodKind::ParryTriMesh, WIDE),
        Self::new("parry-bvh", MethodKind::ParryBvh, WIDE),
        Self::new("parry-rebuild", MethodKind::ParryRebuild, WIDE),
    ];

    const fn new(name: &'static str, kind: MethodKind, trees: Trees) -> Self {
        Self { name, kind, trees }
    }

    /// The same, with other options if it is the paper's method.
    #[must_use]
    pub fn with_paper(self, options: PaperOptions) -> Self {
        match self.kind {
            MethodKind::Paper(_) => Self::new(self.name, MethodKind::Paper(options), self.trees),
            _ => self,
        }
    }

    /// Whether it is the paper's method, which has a tree of its own.
    #[must_use]
    pub fn is_paper(&self) -> bool {
        matches!(self.kind, MethodKind::Paper(_))
    }

    /// Whether it is no rival but the price of the same bodies if they did not morph.
    #[must_use]
    pub fn is_floor(&self) -> bool {
        self.kind == MethodKind::RigidFloor
    }

    /// Whether it collides the experiment's mesh, or casts rays at it.
    #[must_use]
    pub fn supports(&self, experiment: &Experiment) -> bool {
        let fits = if experiment.mesh.skin.is_some() {
            self.kind.supports_skins()
        } else {
            !self.kind.is_for_skins()
        };
        fits && (experiment.rays.is_empty() || self.kind.casts_rays())
    }

    /// Sets it up; `ours` is for our trees.
    ///
    /// # Errors
    /// As [`MethodKind::set_up`].
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
