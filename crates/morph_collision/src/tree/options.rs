use thiserror::Error;

/// How to build a [`MorphBvh`](crate::MorphBvh). No answer depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BuildOptions {
    /// A node with at most this many triangles becomes a leaf; 1 to 255.
    pub leaf_size: usize,
}

impl BuildOptions {
    /// Sets [`BuildOptions::leaf_size`].
    #[must_use]
    pub fn with_leaf_size(mut self, leaf_size: usize) -> Self {
        self.leaf_size = leaf_size;
        self
    }

    pub(super) fn check(&self) -> Result<(), BuildError> {
        if !(1..=255).contains(&self.leaf_size) {
            return Err(BuildError::LeafSize(self.leaf_size));
        }
        Ok(())
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self { leaf_size: 8 }
    }
}

/// Why a tree cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// [`BuildOptions::leaf_size`] is 0 or above 255.
    #[error("leaf_size is {0}, it must be from 1 to 255")]
    LeafSize(usize),
}
