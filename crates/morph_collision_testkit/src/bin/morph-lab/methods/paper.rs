//! The options for the paper's bounding volumes.

use clap::Args;
use morph_collision_testkit::rivals::{PaperOptions, PaperVolume};

/// Options of the method `paper` only.
#[derive(Debug, Args)]
pub(crate) struct PaperArgs {
    /// Bounding volumes of the method paper: aabb (the default), kdop14, kdop18, kdop26 or sphere.
    #[arg(long, value_name = "KIND", help_heading = super::HEADING)]
    volume: Option<PaperVolume>,
    /// Also give the method paper volumes half way between consecutive references.
    #[arg(long, help_heading = super::HEADING)]
    in_betweens: bool,
}

impl PaperArgs {
    /// The flags, and whether each was given.
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
