//! The one hash of stored data: the same on every machine and in every version.

/// Where a hash starts.
pub(crate) const START: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a over numbers instead of bytes. The upper half of a number counts little, so pass numbers below 2^32.
pub(crate) fn hash(start: u64, numbers: impl IntoIterator<Item = u64>) -> u64 {
    numbers
        .into_iter()
        .fold(start, |hash, number| (hash ^ number).wrapping_mul(0x0100_0000_01b3))
}
