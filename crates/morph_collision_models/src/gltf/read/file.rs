//! Opens a file and parses its JSON.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::animation_list::AnimationList;
use super::buffers::Buffers;
use super::compressed::Decoded;
use super::container::chunks;
use super::document::{Root, RootError, abridged};
use super::error::ReadError;
use super::extensions::{self, Support};
use super::lfs;
use super::skin::Parents;
use crate::memory::{self, FileFault, MemoryBudget};

/// How far to trust a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// Most bytes of memory that the file and everything made from it may take; [`memory::DEFAULT_LIMIT`] by default.
    pub memory_limit: u64,
    /// Allows devices and pipes, and buffers outside the model's directory. Off by default. Nothing is ever fetched from a
    /// network.
    pub any_path: bool,
    /// Reads a mesh with bad parts without them, instead of refusing it, and counts them ([`Skipped`](super::Skipped)). Off by
    /// default.
    pub skip_bad: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            memory_limit: memory::DEFAULT_LIMIT,
            any_path: false,
            skip_bad: false,
        }
    }
}

/// A file with parsed JSON. Meshes, clips and buffers are read on demand.
#[derive(Debug)]
pub struct GltfFile {
    pub(super) path: PathBuf,
    pub(super) root: Root,
    pub(super) buffers: Buffers,
    pub(super) decoded: Decoded,
    pub(super) budget: MemoryBudget,
    pub(super) parents: Parents,
    /// For each mesh that a node shows, [the main one](GltfFile::main_node); computed on first use.
    pub(super) main_nodes: OnceCell<HashMap<usize, usize>>,
    /// The names of the animations; made on first use.
    pub(super) animation_list: OnceCell<AnimationList>,
    pub(super) skip_bad: bool,
}

impl GltfFile {
    /// Opens a file and parses its JSON.
    ///
    /// # Errors
    /// The file cannot be read, is not glTF, or needs an extension that changes how geometry is stored.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self, ReadError> {
        Self::open_within(path, options, MemoryBudget::new(options.memory_limit))
    }

    /// Like [`GltfFile::open`], with a budget that can be shared with other files instead of [`ReadOptions::memory_limit`].
    ///
    /// # Errors
    /// See [`GltfFile::open`].
    pub fn open_within(path: &Path, options: &ReadOptions, budget: MemoryBudget) -> Result<Self, ReadError> {
        let (file, length) = memory::open_file(path, options.any_path).map_err(|fault| read_error(fault, path))?;
        let bytes = read_all(file, length, path, &budget)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        Self::new(bytes, path, Some(directory), options, budget)
    }

    /// Like [`GltfFile::open_within`], from a stream of unknown length, such as a pipe. Buffers must be within it. `path` is only for
    /// messages.
    ///
    /// # Errors
    /// See [`GltfFile::open`].
    pub fn read_from(
        source: impl Read,
        path: &Path,
        options: &ReadOptions,
        budget: MemoryBudget,
    ) -> Result<Self, ReadError> {
        let bytes = read_all(source, None, path, &budget)?;
        Self::new(bytes, path, None, options, budget)
    }

    /// Like [`GltfFile::open`], from a file's bytes. Buffers must be within them. `path` is only for messages.
    ///
    /// The bytes are copied. The copy counts towards the limit, and `bytes` themselves, which are the caller's, do not.
    ///
    /// # Errors
    /// See [`GltfFile::open`].
    pub fn parse(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Self, ReadError> {
        let budget = MemoryBudget::new(options.memory_limit);
        let over = |over| ReadError::OverBudget {
            path: path.to_owned(),
            over,
        };
        budget.take(bytes.len() as u64, 1, || "the file".into()).map_err(over)?;
        Self::new(bytes.to_vec(), path, None, options, budget)
    }

    fn new(
        bytes: Vec<u8>,
        path: &Path,
        directory: Option<&Path>,
        options: &ReadOptions,
        budget: MemoryBudget,
    ) -> Result<Self, ReadError> {
        let not_gltf = |reason: String| ReadError::NotGltf {
            path: path.to_owned(),
            reason,
        };
        if lfs::is_lfs_pointer(&bytes) {
            let reason = "it is a Git LFS pointer and not the model itself, which `git lfs pull` fetches";
            return Err(not_gltf(reason.into()));
        }
        let (json, chunk) = if bytes.starts_with(b"glTF") {
            let (json, chunk) = chunks(&bytes).map_err(not_gltf)?;
            (json, chunk)
        } else {
            (0..bytes.len(), None)
        };
        let root = Root::parse(&bytes[json], &budget).map_err(|error| match error {
            RootError::Json(_) | RootError::Version(_) => not_gltf(error.to_string()),
            RootError::OverBudget(over) => ReadError::OverBudget {
                path: path.to_owned(),
                over,
            },
        })?;
        let unknown = |name: &&String| extensions::support(name) == Support::Unknown;
        if let Some(extension) = root.extensions_required.iter().find(unknown) {
            return Err(ReadError::Extension {
                path: path.to_owned(),
                extension: abridged(extension),
            });
        }
        Ok(Self {
            path: path.to_owned(),
            buffers: Buffers::new(&root, directory, options, bytes, chunk),
            decoded: Decoded::new(&root),
            root,
            budget,
            parents: Parents::new(),
            main_nodes: OnceCell::new(),
            animation_list: OnceCell::new(),
            skip_bad: options.skip_bad,
        })
    }

    /// Whether meshes are read without their bad parts ([`ReadOptions::skip_bad`]).
    #[must_use]
    pub fn skips_bad(&self) -> bool {
        self.skip_bad
    }

    /// The path it was opened with.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// This file and the files that its buffers are in, whether they exist or not.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = vec![self.path.clone()];
        files.extend(self.buffers.files(&self.root, &self.budget));
        files
    }

    /// The memory that the file may still take. Count anything that you build from its meshes here.
    #[must_use]
    pub fn budget(&self) -> &MemoryBudget {
        &self.budget
    }
}

/// Reads at most as many bytes as the budget allows.
fn read_all(source: impl Read, length: Option<u64>, path: &Path, budget: &MemoryBudget) -> Result<Vec<u8>, ReadError> {
    // If the length is unknown, the buffer grows while reading, up to twice the file's length.
    let (length, growth) = length.map_or((budget.left() / 4, 2), |length| (length, 1));
    let take = budget.take(length, growth, || "the file".into());
    take.map_err(|over| ReadError::OverBudget {
        path: path.to_owned(),
        over,
    })?;
    memory::read_at_most(source, (growth == 1).then_some(length), length).map_err(|fault| read_error(fault, path))
}

fn read_error(fault: FileFault, path: &Path) -> ReadError {
    let path = path.to_owned();
    match fault {
        FileFault::NotRegular => ReadError::NotRegular { path },
        FileFault::Io(source) => ReadError::Io { path, source },
        FileFault::TooLong { most } => ReadError::TooLong { path, most },
    }
}

#[cfg(test)]
mod tests {
    use super::super::error::Remedy;
    use super::*;

    #[test]
    fn a_stream_that_is_too_long_is_refused_and_not_cut() {
        let read = |bytes| {
            read_all(
                std::io::repeat(b' ').take(bytes),
                None,
                Path::new("-"),
                &MemoryBudget::new(4000),
            )
        };
        assert_eq!(read(1000).expect("it is short enough").len(), 1000);
        let error = read(1001).expect_err("it is too long");
        assert!(error.to_string().contains("longer than 1000 bytes"), "{error}");
        assert_eq!(error.remedy(), Some(Remedy::MoreMemory));
    }
}
