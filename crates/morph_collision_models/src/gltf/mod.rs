//! glTF 2.0 files.

pub mod read;
pub mod write;
