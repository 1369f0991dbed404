//! What can be wrong with a file of recorded motions.

use std::io;
use std::path::PathBuf;

/// A file of recorded motions that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct RecordError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub problem: RecordProblem,
}

/// What is wrong with the bytes, and where. Indices count from 0.
#[derive(Debug, thiserror::Error)]
pub enum RecordProblem {
    /// The file cannot be read.
    #[error("it cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The file is larger than any that this reader accepts.
    #[error("it has {bytes} bytes, which is over the limit of {limit}")]
    TooLarge {
        /// Size of the file, or as far as it was read.
        bytes: u64,
        /// The limit.
        limit: u64,
    },
    /// The file does not start as the format requires.
    #[error("the header's {field} is {found}, but should be {expected}")]
    Header {
        /// The field.
        field: &'static str,
        /// Its value.
        found: String,
        /// The only value allowed.
        expected: String,
    },
    /// The file's length does not match the counts in its header.
    #[error("it has {found} bytes, but its header announces {expected}")]
    Length {
        /// Bytes of the file.
        found: u64,
        /// Bytes that the header announces.
        expected: u64,
    },
    /// A byte with a value that means nothing.
    #[error("{list} {index}: the {field} is {found}, which has no meaning")]
    Byte {
        /// The list it is in.
        list: &'static str,
        /// Its place in the list.
        index: usize,
        /// The field.
        field: &'static str,
        /// Its value.
        found: u8,
    },
    /// A coordinate is infinite or NaN.
    #[error("{list} {index}: a coordinate is {found}")]
    NotFinite {
        /// The list it is in.
        list: &'static str,
        /// Its place in the list.
        index: usize,
        /// The coordinate.
        found: f64,
    },
    /// An index refers to nothing.
    #[error("{list} {index} refers to {target} {found}, but there are {count}")]
    OutOfRange {
        /// The list it is in.
        list: &'static str,
        /// Its place in the list.
        index: usize,
        /// What it refers to.
        target: &'static str,
        /// The index.
        found: u32,
        /// How many there are.
        count: usize,
    },
}
