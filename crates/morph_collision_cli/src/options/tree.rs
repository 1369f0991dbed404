//! The tree options that commands share.

use clap::Args;
use morph_collision::BuildOptions;

/// How trees are built. Defaults are the library's.
#[derive(Debug, Default, Args)]
pub struct TreeArgs {
    /// The most triangles in a leaf of this library's trees, 1 to 255; 8 by default. It changes the speed, never an answer.
    #[arg(long, value_name = "N", value_parser = parse_leaf)]
    leaf: Option<BuildOptions>,
}

fn parse_leaf(text: &str) -> Result<BuildOptions, String> {
    let leaf_size = text
        .parse()
        .map_err(|error: std::num::ParseIntError| error.to_string())?;
    let options = BuildOptions::default().with_leaf_size(leaf_size);
    options.map_err(|error| error.to_string())
}

impl TreeArgs {
    /// The leaf size, if it was given.
    #[must_use]
    pub fn leaf(&self) -> Option<usize> {
        self.leaf.map(|options| options.leaf_size())
    }

    /// The options of a tree.
    #[must_use]
    pub fn build(&self) -> BuildOptions {
        self.leaf.unwrap_or_default()
    }
}
