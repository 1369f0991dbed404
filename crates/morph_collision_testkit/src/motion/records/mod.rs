//! Recorded motions with known answers, from files beside the repository.
//!
//! - `.ccdq` ([`read_queries`]): single queries, each with its eight positions.
//! - `.ccdp` ([`FramePair`]): a mesh at two times, and pairs of its features.
//!
//! All numbers are little-endian. A reader checks the length that a header announces against the file before it allocates, so the
//! memory it takes is a small multiple of the file's size.

mod bytes;
mod error;
mod files;
mod frames;
mod queries;

pub use error::{RecordError, RecordProblem};
pub use files::{MissingRecords, find_records};
pub use frames::{FramePair, PairRecord, PairSource};
pub use queries::{QueryRecord, parse_queries, read_queries};
