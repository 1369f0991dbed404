use morph_collision::{BuildOptions, InputError};

/// How the methods are set up; each takes what it knows, and no answer depends on any of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodOptions {
    /// Our trees. `bottom-up`, `hybrid` and `rebuild` take the leaf size.
    pub tree: BuildOptions,
    /// Most children of a node of `bottom-up` and `hybrid`: 2, 4 or 8.
    pub arity: usize,
    /// Whether `morph` tries the leaves first in which it found a pair the last time, where only first pairs are wanted.
    pub witness: bool,
}

impl MethodOptions {
    /// Sets the leaf size.
    ///
    /// # Errors
    /// [`InputError::BadNumber`] unless it is from 1 to 255.
    pub fn with_leaf_size(self, leaf_size: usize) -> Result<Self, InputError> {
        let tree = self.tree.with_leaf_size(leaf_size)?;
        Ok(Self { tree, ..self })
    }
}

impl Default for MethodOptions {
    /// The library's, eight children, and each frame by itself.
    fn default() -> Self {
        Self {
            tree: BuildOptions::default(),
            arity: 8,
            witness: false,
        }
    }
}

impl From<BuildOptions> for MethodOptions {
    fn from(tree: BuildOptions) -> Self {
        Self {
            tree,
            ..Self::default()
        }
    }
}
