//! Takes numbers from the front of bytes.

use super::error::RecordProblem;

/// The bytes that are left. Past the end it reads zeros; readers check the length first.
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl Bytes<'_> {
    pub(super) fn take<const N: usize>(&mut self) -> [u8; N] {
        let mut taken = [0; N];
        let count = N.min(self.0.len());
        let (front, rest) = self.0.split_at(count);
        taken[..count].copy_from_slice(front);
        self.0 = rest;
        taken
    }

    pub(super) fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    pub(super) fn u32s<const N: usize>(&mut self) -> [u32; N] {
        std::array::from_fn(|_| self.u32())
    }

    /// Three finite coordinates.
    pub(super) fn position(&mut self, list: &'static str, index: usize) -> Result<[f64; 3], RecordProblem> {
        let position = [0; 3].map(|_| f64::from_le_bytes(self.take()));
        match position.iter().find(|x| !x.is_finite()) {
            Some(&found) => Err(RecordProblem::NotFinite { list, index, found }),
            None => Ok(position),
        }
    }

    /// The name of the format and its version.
    pub(super) fn format(&mut self, name: &[u8; 4]) -> Result<(), RecordProblem> {
        let found: [u8; 4] = self.take();
        if found != *name {
            return Err(RecordProblem::Header {
                field: "format",
                found: format!("\"{}\"", found.escape_ascii()),
                expected: format!("\"{}\"", name.escape_ascii()),
            });
        }
        self.constant("version", 1)
    }

    /// A number of the header that must have one value.
    pub(super) fn constant(&mut self, field: &'static str, expected: u32) -> Result<(), RecordProblem> {
        let found = self.u32();
        if found == expected {
            return Ok(());
        }
        Err(RecordProblem::Header {
            field,
            found: found.to_string(),
            expected: expected.to_string(),
        })
    }
}

/// Fails unless a file of `found` bytes has the length that its header announces.
pub(super) fn check_length(found: usize, expected: u64) -> Result<(), RecordProblem> {
    let found = found as u64;
    if found == expected {
        Ok(())
    } else {
        Err(RecordProblem::Length { found, expected })
    }
}

/// A byte that must be 0 or 1.
pub(super) fn flag(list: &'static str, index: usize, field: &'static str, found: u8) -> Result<bool, RecordProblem> {
    match found {
        0 | 1 => Ok(found == 1),
        _ => Err(RecordProblem::Byte {
            list,
            index,
            field,
            found,
        }),
    }
}
