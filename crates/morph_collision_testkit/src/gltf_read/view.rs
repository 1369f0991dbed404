//! The bytes of buffer views.

use super::GltfFile;
use super::document::View;
use super::error::{AccessorProblem, CompressionFault};

impl GltfFile {
    /// A view and its bytes, decoded if they are compressed. Errors name `accessor`, which uses it.
    pub(super) fn view(&self, accessor: usize, index: usize) -> Result<(&View, &[u8]), AccessorProblem> {
        let view = self.root.buffer_views.get(index, &self.budget);
        let view = view.map_err(|problem| AccessorProblem::View {
            accessor,
            view: index,
            problem,
        })?;
        let compressed = |fault| AccessorProblem::Compressed {
            accessor,
            view: index,
            fault: Box::new(fault),
        };
        if let Some(decoded) = self.meshopt(index, view).map_err(compressed)? {
            return Ok((view, decoded));
        }
        match self.range(view.buffer, view.byte_offset, view.byte_length) {
            Ok(bytes) => Ok((view, bytes)),
            Err(CompressionFault::Buffer(problem)) => Err(AccessorProblem::Buffer { accessor, problem }),
            Err(_) => Err(AccessorProblem::OutOfBounds { accessor }),
        }
    }

    /// Bytes of a buffer.
    pub(super) fn range(&self, buffer: usize, offset: u64, length: u64) -> Result<&[u8], CompressionFault> {
        let bytes = self.buffers.get(buffer, &self.root, &self.budget);
        let bytes = bytes.map_err(|problem| CompressionFault::Buffer(Box::new(problem)))?;
        range(bytes, offset, length).ok_or(CompressionFault::OutOfBounds)
    }
}

/// A part of some bytes, if they have it.
pub(super) fn range(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    bytes.get(start..start.checked_add(usize::try_from(length).ok()?)?)
}
