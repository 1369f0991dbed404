//! Finds files of recorded motions and reads them.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use super::error::{RecordError, RecordProblem};

/// Most bytes of a file.
const LIMIT: u64 = 1 << 28;

/// There is no folder of recorded motions.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no folder {}", folder.display())]
pub struct MissingRecords {
    folder: PathBuf,
}

/// The files with an extension (`ccdq` or `ccdp`) in the folder of recorded motions beside the repository, sorted by name.
///
/// # Errors
/// There is no such folder.
pub fn find_records(extension: &str) -> Result<Vec<PathBuf>, MissingRecords> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/ccd"));
    let Ok(entries) = folder.read_dir() else {
        return Err(MissingRecords {
            folder: folder.to_path_buf(),
        });
    };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut paths: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|end| end == extension))
        .collect();
    paths.sort();
    Ok(paths)
}

/// Reads a whole file of at most [`LIMIT`] bytes and parses it.
pub(super) fn read_with<T>(
    path: &Path,
    parse: impl FnOnce(&[u8]) -> Result<T, RecordProblem>,
) -> Result<T, RecordError> {
    read(path)
        .and_then(|content| parse(&content))
        .map_err(|problem| RecordError {
            path: path.to_path_buf(),
            problem,
        })
}

fn read(path: &Path) -> Result<Vec<u8>, RecordProblem> {
    let mut content = Vec::new();
    File::open(path)?.take(LIMIT + 1).read_to_end(&mut content)?;
    let bytes = content.len() as u64;
    if bytes > LIMIT {
        return Err(RecordProblem::TooLarge { bytes, limit: LIMIT });
    }
    Ok(content)
}
