//! Reads files, with a limit on their length.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::Bytes;

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum FileFault {
    /// The system's error.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is a device or a pipe, which may block or have no end.
    #[error("not a regular file")]
    NotRegular,
    /// It is longer than it may be.
    #[error("it is longer than {}, the most that it may take", Bytes(*.most))]
    TooLong {
        /// The limit in bytes.
        most: u64,
    },
}

/// Opens a file, and returns its length if it is a regular one. Devices and pipes are opened only with `any_path`.
///
/// # Errors
/// [`FileFault::Io`] or [`FileFault::NotRegular`].
pub fn open_file(path: &Path, any_path: bool) -> Result<(File, Option<u64>), FileFault> {
    // Checked before opening, because opening a pipe waits for its other end.
    let found = std::fs::metadata(path)?;
    if !found.is_file() && !found.is_dir() && !any_path {
        return Err(FileFault::NotRegular);
    }
    Ok((File::open(path)?, found.is_file().then_some(found.len())))
}

/// Reads a stream to its end. With a `length`, that much memory is reserved; otherwise, up to three times the length of the stream are
/// allocated while the buffer grows.
///
/// # Errors
/// [`FileFault::Io`], or [`FileFault::TooLong`] if it has more than `most` bytes, of which at most one more is read.
pub fn read_at_most(source: impl Read, length: Option<u64>, most: u64) -> Result<Vec<u8>, FileFault> {
    let too_long = FileFault::TooLong { most };
    if length.is_some_and(|length| length > most) {
        return Err(too_long);
    }
    // One byte more, so that the end is found without growing.
    let capacity = length.map_or(0, |length| length.saturating_add(1));
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(usize::try_from(capacity).unwrap_or(usize::MAX))
        .map_err(io::Error::from)?;
    source.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(too_long);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_too_long_is_refused_and_not_cut() {
        let read = |bytes, length| read_at_most(io::repeat(b' ').take(bytes), length, 1000);
        for length in [None, Some(1000)] {
            assert_eq!(read(1000, length).expect("it is short enough").len(), 1000);
            let error = read(1001, length).expect_err("it is too long").to_string();
            assert_eq!(error, "it is longer than 1000 bytes, the most that it may take");
        }
        assert!(matches!(read(0, Some(1001)), Err(FileFault::TooLong { most: 1000 })));
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_opened_only_if_that_is_allowed() {
        let zero = Path::new("/dev/zero");
        assert!(matches!(open_file(zero, false), Err(FileFault::NotRegular)));
        let (file, length) = open_file(zero, true).expect("it is allowed");
        assert_eq!(length, None);
        assert!(matches!(
            read_at_most(file, length, 1000),
            Err(FileFault::TooLong { most: 1000 })
        ));
    }
}
