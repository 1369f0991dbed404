use morph_collision::BuildOptions;

/// How the methods are set up; each takes what it knows, and no answer depends on any of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodOptions {
    /// Most children of a node of `bottom-up` and `hybrid`: 2, 4 or 8.
    pub arity: usize,
    /// Most triangles in a leaf of our trees, and of `bottom-up`, `hybrid` and `rebuild`; 1 to 255.
    pub leaf_size: usize,
    /// Whether `morph` tries the leaves first in which it found a pair the last time, where only first pairs are wanted.
    pub witness: bool,
}

impl MethodOptions {
    /// The same with other leaves.
    #[must_use]
    pub fn with_leaf_size(self, leaf_size: usize) -> Self {
        Self { leaf_size, ..self }
    }

    /// For our trees.
    #[must_use]
    pub fn build(&self) -> BuildOptions {
        BuildOptions::default().with_leaf_size(self.leaf_size)
    }
}

impl Default for MethodOptions {
    /// The library's, eight children, and each frame by itself.
    fn default() -> Self {
        Self {
            arity: 8,
            leaf_size: BuildOptions::default().leaf_size,
            witness: false,
        }
    }
}
