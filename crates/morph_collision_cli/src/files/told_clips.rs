//! Which animations a warning was printed for.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The animations that a warning was printed for.
#[derive(Debug, Default)]
pub(crate) struct ToldClips(Mutex<HashSet<(PathBuf, usize)>>);

impl ToldClips {
    /// Whether this is the first time that it is asked about an animation.
    pub(crate) fn is_news(&self, file: &Path, animation: usize) -> bool {
        let told = self.0.lock();
        let mut told = told.unwrap_or_else(PoisonError::into_inner);
        told.insert((file.to_owned(), animation))
    }
}
