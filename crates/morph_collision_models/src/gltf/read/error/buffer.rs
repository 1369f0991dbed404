//! What can be wrong with a buffer.

use super::Remedy;
use crate::gltf::read::document::ElementError;
use crate::memory::OverBudget;
use crate::text::Printable;

/// A buffer that cannot be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("buffer {buffer}{}: {fault}", uri.as_deref().map(|uri| format!(" \"{}\"", Printable(uri))).unwrap_or_default())]
pub struct BufferProblem {
    /// The buffer's index in the file.
    pub buffer: usize,
    /// Its URI, abridged, if it has one.
    pub uri: Option<String>,
    /// Why it cannot be loaded.
    pub fault: BufferFault,
}

/// Why a buffer cannot be loaded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BufferFault {
    /// Its JSON is missing or malformed.
    #[error("it {0}")]
    Element(#[from] ElementError),
    /// It has no URI, and the file has no binary chunk for it.
    #[error("it has no URI, and the file holds no binary data for it")]
    NoChunk,
    /// The buffer is in another file, but only the file's own bytes are available.
    #[error("it is in another file; here everything has to be in one file, as in a .glb")]
    NoDirectory,
    /// It refers to a path that is not allowed by default.
    #[error("refused, because {0}")]
    Outside(&'static str),
    /// Its URI has an unsupported scheme.
    #[error("nothing is read from URIs that begin with \"{}:\"; store the buffer beside the file", Printable(.0))]
    Scheme(String),
    /// Its URI is not a path.
    #[error("the URI is not a path")]
    NoPath,
    /// Its URI is not UTF-8.
    #[error("the URI is not UTF-8 after percent-decoding")]
    NotUtf8,
    /// Its data URI is not in base64.
    #[error("the data URI is not in base64")]
    Encoding,
    /// Its data URI cannot be decoded.
    #[error("the data URI is not valid base64: {0}")]
    Base64(String),
    /// Its file cannot be read.
    #[error("{0}")]
    Io(String),
    /// Its file is a pointer of Git LFS.
    #[error("its file is a Git LFS pointer and not the data itself, which `git lfs pull` fetches")]
    LfsPointer,
    /// It has fewer bytes than it declares.
    #[error("it has {found} bytes, but its byteLength is {promised}")]
    Short {
        /// Number of bytes found.
        found: usize,
        /// Number of bytes declared.
        promised: u64,
    },
    /// It would take more memory than the file may.
    #[error(transparent)]
    OverBudget(OverBudget),
}

impl BufferFault {
    pub(super) fn remedy(&self) -> Option<Remedy> {
        match self {
            Self::OverBudget(_) => Some(Remedy::MoreMemory),
            Self::Element(problem) => problem.remedy(),
            Self::Outside(_) => Some(Remedy::AnyPath),
            _ => None,
        }
    }
}
