use morph_collision::{BuildOptions, InputError};

/// Options for setting up methods. Each method uses those that it supports, and no answer depends on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodOptions {
    /// Options of our trees. `bottom-up-scalar` and `hybrid-scalar` use the leaf size.
    pub tree: BuildOptions,
    /// Most children of a node of `bottom-up-scalar` and `hybrid-scalar`: 2, 4 or 8.
    pub arity: usize,
    /// Whether `morph`, if only first pairs are wanted, first tries the leaves in which it found a pair the last time.
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
    /// The library's defaults, eight children, and no data remembered from frame to frame.
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
