use thiserror::Error;

/// How to build a [`MorphBvh`](crate::MorphBvh).
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BuildOptions {
    /// A node with at most this many triangles becomes a leaf; 1 to 255.
    pub leaf_size: usize,
}

impl BuildOptions {
    /// The paper's setting: one triangle per leaf.
    #[must_use]
    pub const fn paper() -> Self {
        Self { leaf_size: 1 }
    }

    /// Sets [`BuildOptions::leaf_size`].
    #[must_use]
    pub const fn with_leaf_size(mut self, leaf_size: usize) -> Self {
        self.leaf_size = leaf_size;
        self
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { leaf_size: 4 }
    }
}

/// Why a tree cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// [`BuildOptions::leaf_size`] is 0 or above 255.
    #[error("leaf_size is {0}, it must be from 1 to 255")]
    LeafSize(usize),
}
