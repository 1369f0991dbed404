//! FNV-1a over little-endian bytes: the same on every machine.

use glam::{DVec3, Vec3};

/// A running hash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hash(u64);

impl Hash {
    pub(super) const EMPTY: Self = Self(0xcbf2_9ce4_8422_2325);

    pub(super) fn value(self) -> u64 {
        self.0
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.bytes(&value.to_le_bytes());
    }

    pub(super) fn u64(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    /// Hashes every bit, including the sign of a zero.
    pub(super) fn vertex(&mut self, v: Vec3) {
        for value in v.to_array() {
            self.u32(value.to_bits());
        }
    }

    /// Hashes every bit, including the sign of a zero.
    pub(super) fn world_vertex(&mut self, v: DVec3) {
        for value in v.to_array() {
            self.u64(value.to_bits());
        }
    }

    /// Hashes a number of an answer. Both zeros hash alike, because machines differ in which of two zeros
    /// is the minimum.
    pub(super) fn number(&mut self, value: f64) {
        assert!(!value.is_nan(), "an answer holds NaN");
        self.u64((value + 0.0).to_bits());
    }

    pub(super) fn numbers(&mut self, values: impl IntoIterator<Item = f64>) {
        for value in values {
            self.number(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_fnv_1a() {
        let mut hash = Hash::EMPTY;
        hash.bytes(b"foobar");
        assert_eq!(hash.value(), 0x8594_4171_f739_67e8);
    }
}
