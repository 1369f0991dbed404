//! The bytes of buffers, loaded when they are first used.

use std::cell::OnceCell;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};

use super::ReadOptions;
use super::document::{Buffer, Root};
use super::error::{BufferFault, BufferProblem};
use super::lfs;
use super::uri::{self, Source};
use crate::memory::MemoryBudget;

/// Padding is optional, because some exporters omit it.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The buffers of one file.
#[derive(Debug)]
pub(super) struct Buffers {
    /// The directory that other files are relative to; `None` allows no other files.
    directory: Option<PathBuf>,
    any_path: bool,
    /// The whole file, and the range of the binary chunk if it is a `.glb`.
    bytes: Vec<u8>,
    chunk: Option<Range<usize>>,
    loaded: Vec<OnceCell<Result<Vec<u8>, BufferFault>>>,
}

impl Buffers {
    pub(super) fn new(
        root: &Root,
        directory: Option<&Path>,
        options: &ReadOptions,
        bytes: Vec<u8>,
        chunk: Option<Range<usize>>,
    ) -> Self {
        Self {
            directory: directory.map(Path::to_owned),
            any_path: options.any_path,
            bytes,
            chunk,
            loaded: root.buffers.indices().map(|_| OnceCell::new()).collect(),
        }
    }

    /// The bytes of a buffer.
    pub(super) fn get(&self, index: usize, root: &Root, budget: &MemoryBudget) -> Result<&[u8], BufferProblem> {
        let json = root.buffers.get(index, budget);
        let uri = json.as_ref().ok().and_then(|buffer| buffer.uri.as_deref());
        let problem = |fault: BufferFault| BufferProblem {
            buffer: index,
            uri: uri.map(abridged),
            fault,
        };
        let json = json.map_err(|error| problem(error.into()))?;
        let Some(uri) = uri else {
            let chunk = self.chunk.clone().filter(|_| index == 0);
            let bytes = chunk.and_then(|chunk| self.bytes.get(chunk));
            return bytes
                .ok_or_else(|| problem(BufferFault::NoChunk))
                .and_then(|bytes| long_enough(bytes, json).map_err(problem));
        };
        let loaded = self.loaded.get(index).ok_or_else(|| problem(BufferFault::NoChunk))?;
        if loaded.get().is_none() {
            let found = self.load(index, uri, json, budget);
            // A refusal is not remembered, because there may be more memory later.
            if let Err(fault @ BufferFault::OverBudget(_)) = found {
                return Err(problem(fault));
            }
            // It was empty, so this sets it.
            let _ = loaded.set(found);
        }
        match loaded.get() {
            Some(Ok(bytes)) => Ok(bytes),
            Some(Err(fault)) => Err(problem(fault.clone())),
            None => Err(problem(BufferFault::NoChunk)),
        }
    }

    /// The paths of the files that hold buffers, whether or not they exist or may be read.
    pub(super) fn files(&self, root: &Root, budget: &MemoryBudget) -> Vec<PathBuf> {
        let path = |index: usize| {
            let uri = root.buffers.get(index, budget).ok()?.uri.as_deref()?;
            match uri::resolve(uri, self.directory.as_deref(), true) {
                Ok(Source::File(path)) => Some(path),
                _ => None,
            }
        };
        root.buffers.indices().filter_map(path).collect()
    }

    fn load(&self, index: usize, uri: &str, json: &Buffer, budget: &MemoryBudget) -> Result<Vec<u8>, BufferFault> {
        let directory = self.directory.as_deref();
        let bytes = match uri::resolve(uri, directory, self.any_path)? {
            Source::Base64(text) => {
                let take = budget.keep(text.len() as u64, 1, || format!("buffer {index}"));
                take.map_err(BufferFault::OverBudget)?;
                BASE64
                    .decode(text)
                    .map_err(|error| BufferFault::Base64(error.to_string()))?
            }
            Source::File(path) => {
                if !self.any_path {
                    uri::check_file(&path, directory.unwrap_or(Path::new("")))?;
                }
                read_file(&path, index, json.byte_length, budget)?
            }
        };
        if lfs::is_lfs_pointer(&bytes) {
            return Err(BufferFault::LfsPointer);
        }
        long_enough(&bytes, json)?;
        Ok(bytes)
    }
}

/// Reads at most `length` bytes of a file, so that endless files are no problem.
fn read_file(path: &Path, index: usize, length: u64, budget: &MemoryBudget) -> Result<Vec<u8>, BufferFault> {
    let io = |error: std::io::Error| BufferFault::Io(error.to_string());
    let file = File::open(path).map_err(io)?;
    let found = file.metadata().map_err(io)?;
    let length = if found.is_file() {
        length.min(found.len())
    } else {
        length
    };
    let take = budget.keep(length, 1, || format!("buffer {index}"));
    take.map_err(BufferFault::OverBudget)?;
    let mut bytes = Vec::new();
    let capacity = usize::try_from(length)
        .ok()
        .and_then(|length| bytes.try_reserve_exact(length).ok());
    capacity.ok_or_else(|| BufferFault::Io("out of memory".into()))?;
    file.take(length).read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

fn long_enough<'a>(bytes: &'a [u8], json: &Buffer) -> Result<&'a [u8], BufferFault> {
    if (bytes.len() as u64) < json.byte_length {
        return Err(BufferFault::Short {
            found: bytes.len(),
            promised: json.byte_length,
        });
    }
    Ok(bytes)
}

/// A URI for messages, without its data if it is a data URI.
fn abridged(uri: &str) -> String {
    const MOST: usize = 200;
    let end = if uri.starts_with("data:") {
        uri.find(',').map_or(MOST, |comma| comma + 1).min(MOST)
    } else {
        MOST
    };
    match uri.char_indices().nth(end) {
        None => uri.to_owned(),
        Some((at, _)) => format!("{}...", &uri[..at]),
    }
}
