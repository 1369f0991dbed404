//! How trees are built, as far as commands let one choose.

use clap::Args;
use morph_collision::{BuildOptions, Split};

/// The shape of trees; what is not given is as the library has it by default.
#[derive(Debug, Args)]
pub(crate) struct TreeArgs {
    /// Most children of a node of a tree of ours: 2, 4 or 8.
    #[arg(long, value_name = "N", value_parser = arity)]
    arity: Option<usize>,
    /// Most triangles in a leaf of a tree of ours, 1 to 255.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    leaf: Option<u8>,
    /// How morph shares triangles out among children: midpoint, sah or pose-sah.
    #[arg(long, value_name = "RULE")]
    split: Option<Split>,
}

impl TreeArgs {
    /// Whether arity, leaf size and split were given.
    pub(crate) fn given(&self) -> (bool, bool, bool) {
        (self.arity.is_some(), self.leaf.is_some(), self.split.is_some())
    }

    pub(crate) fn build(&self) -> BuildOptions {
        let mut options = BuildOptions::default();
        if let Some(arity) = self.arity {
            options = options.with_arity(arity);
        }
        if let Some(leaf) = self.leaf {
            options = options.with_leaf_size(usize::from(leaf));
        }
        if let Some(split) = self.split {
            options = options.with_split(split);
        }
        options
    }
}

fn arity(text: &str) -> Result<usize, String> {
    match text {
        "2" => Ok(2),
        "4" => Ok(4),
        "8" => Ok(8),
        _ => Err("it must be 2, 4 or 8".to_owned()),
    }
}
