//! What can be wrong with the input of an example.

use std::path::PathBuf;

use thiserror::Error;

/// Why an example cannot start. The message names the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExampleError {
    /// There is no such file.
    #[error("{}: {source}", path.display())]
    Open {
        /// The file asked for.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A directory, or a name that an asset cannot have.
    #[error("{}: not a file that can be loaded as an asset", .0.display())]
    NotAFile(PathBuf),
    /// The loader refuses the file or one that it needs.
    #[error("{}: {reason}", path.display())]
    Load {
        /// The file asked for.
        path: PathBuf,
        /// What the asset server says.
        reason: String,
    },
    /// The file can be loaded, but not read a second time.
    #[error("{0}")]
    Read(String),
    /// The file has nothing to show.
    #[error("{}: the file has no scene", .0.display())]
    NoScene(PathBuf),
    /// Nothing in the file can be used.
    #[error("{}: no usable mesh with morph targets{reason}", path.display())]
    NoMesh {
        /// The file asked for.
        path: PathBuf,
        /// Empty, or a colon and why a mesh could not be used.
        reason: String,
    },
    /// A window is wanted where there is no display.
    #[error("no display here for a window: --screenshots DIR draws without one")]
    NoDisplay,
    /// Nothing is there to draw with.
    #[error(
        "no graphics driver here; one that needs no GPU will do (Debian: apt install mesa-vulkan-drivers libvulkan1)"
    )]
    NoDriver,
    /// Drawing was asked for, and is not built.
    #[error("built without the feature that draws: cargo run --release --features render --example {0}")]
    NotDrawn(&'static str),
    /// A picture that cannot be had or written.
    #[error("{0}")]
    Picture(String),
    /// Loading does not come to an end.
    #[error("{}: still not loaded after {seconds} s", path.display())]
    Stuck {
        /// The file asked for.
        path: PathBuf,
        /// How long it was waited for.
        seconds: u64,
    },
}
