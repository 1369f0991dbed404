//! Pointers that Git LFS leaves in place of files that were not fetched.

/// What a pointer is, after the name of the file.
pub const LFS_POINTER: &str = "is a Git LFS pointer and not the file itself, which `git lfs pull` fetches";

/// How every pointer begins.
const BEGINNING: &[u8] = b"version https://git-lfs.github.com/spec/";
/// Fewer equal bytes are a coincidence.
const LEAST: usize = 12;

/// Whether these are the first bytes of a pointer that Git LFS leaves in place of a file.
#[must_use]
pub fn is_lfs_pointer(bytes: &[u8]) -> bool {
    let length = bytes.len().min(BEGINNING.len());
    length >= LEAST && bytes[..length] == BEGINNING[..length]
}
