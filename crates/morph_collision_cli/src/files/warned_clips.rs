//! Which animations a warning was printed for.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The animations that a warning was printed for.
#[derive(Clone, Debug, Default)]
pub(crate) struct WarnedClips(Arc<Mutex<HashSet<(PathBuf, usize)>>>);

impl WarnedClips {
    /// Whether this is the first time that it is asked about an animation.
    pub(crate) fn is_news(&self, file: &Path, animation: usize) -> bool {
        let warned = self.0.lock();
        let mut warned = warned.unwrap_or_else(PoisonError::into_inner);
        warned.insert((file.to_owned(), animation))
    }
}
