//! Pointers that Git LFS leaves in place of files that were not fetched.

/// How every pointer begins.
const BEGINNING: &[u8] = b"version https://git-lfs.github.com/spec/";
/// Fewer equal bytes are a coincidence.
const LEAST: usize = 12;

/// Whether these are the first bytes of a pointer.
pub(super) fn is_pointer(bytes: &[u8]) -> bool {
    let length = bytes.len().min(BEGINNING.len());
    length >= LEAST && bytes[..length] == BEGINNING[..length]
}
