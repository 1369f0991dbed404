//! How the paper's method bounds nodes, as far as commands let one choose.

use clap::Args;
use morph_collision_testkit::rivals::{PaperOptions, PaperVolume};

/// What only the method `paper` can be told.
#[derive(Debug, Args)]
pub(crate) struct PaperArgs {
    /// Bounding volumes of the method paper: aabb (where left out), kdop14, kdop18, kdop26 or sphere.
    #[arg(long, value_name = "KIND")]
    volume: Option<PaperVolume>,
    /// Give the method paper volumes half way between consecutive references, too.
    #[arg(long)]
    in_betweens: bool,
}

impl PaperArgs {
    /// The flags, and which were given.
    pub(crate) fn given(&self) -> [(&'static str, bool); 2] {
        [("--volume", self.volume.is_some()), ("--in-betweens", self.in_betweens)]
    }

    pub(crate) fn options(&self) -> PaperOptions {
        PaperOptions {
            volume: self.volume.unwrap_or_default(),
            in_betweens: self.in_betweens,
        }
    }
}
