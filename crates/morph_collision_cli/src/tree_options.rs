//! How trees are built, as far as commands let one choose.

use clap::Args;
use morph_collision::BuildOptions;

/// The shape of trees; what is not given is as the library has it by default.
#[derive(Debug, Args)]
pub(crate) struct TreeArgs {
    /// Most triangles in a leaf of a tree, 1 to 255.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    leaf: Option<u8>,
}

impl TreeArgs {
    /// The leaf size, if it was given.
    pub(crate) fn leaf(&self) -> Option<usize> {
        self.leaf.map(usize::from)
    }

    pub(crate) fn build(&self) -> BuildOptions {
        let options = BuildOptions::default();
        match self.leaf() {
            Some(leaf) => options.with_leaf_size(leaf),
            None => options,
        }
    }
}
