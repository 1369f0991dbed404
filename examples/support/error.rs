//! Problems with the input of an example.

use std::path::PathBuf;

use thiserror::Error;

/// Why an example cannot start. The message names the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExampleError {
    /// There is no such file.
    #[error("{}: {source}", path.display())]
    Open {
        /// The requested file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A directory, or a name that is not a valid asset path.
    #[error("{}: not a file that can be loaded as an asset", .0.display())]
    NotAFile(PathBuf),
    /// The loader refuses the file or one that it needs.
    #[error("{}: {reason}", path.display())]
    Load {
        /// The requested file.
        path: PathBuf,
        /// The asset server's error.
        reason: String,
    },
    /// The file can be loaded, but not read a second time.
    #[error("{0}")]
    Read(String),
    /// The file has no scene.
    #[error("{}: the file has no scene", .0.display())]
    NoScene(PathBuf),
    /// No mesh in the file can be used.
    #[error("{}: no usable mesh with morph targets{reason}", path.display())]
    NoMesh {
        /// The requested file.
        path: PathBuf,
        /// Empty, or a colon and the reason why a mesh could not be used.
        reason: String,
    },
    /// There is no display to open a window on.
    #[error("no display here for a window: --screenshots DIR draws without one")]
    NoDisplay,
    /// There is no graphics driver.
    #[error(
        "no graphics driver here; one that needs no GPU will do (Debian: apt install mesa-vulkan-drivers libvulkan1)"
    )]
    NoDriver,
    /// Drawing was requested, but the feature `render` is off.
    #[error("built without the feature that draws: cargo run --release --features render --example {0}")]
    NotDrawn(&'static str),
    /// A picture that cannot be made or written.
    #[error("{0}")]
    Picture(String),
    /// Loading does not finish.
    #[error("{}: still not loaded after {seconds} s", path.display())]
    Stuck {
        /// The requested file.
        path: PathBuf,
        /// The waiting time in seconds.
        seconds: u64,
    },
}
