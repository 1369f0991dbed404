//! The bytes of buffer views.

use super::GltfFile;
use super::document::View;
use super::error::{AccessorProblem, CompressionFault};
use super::extensions::MESHOPT;

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
        let decoded = self.meshopt(index, view);
        if let Ok(Some(decoded)) = decoded {
            return Ok((view, decoded));
        }
        let plain = self.range(view.buffer, view.byte_offset, view.byte_length);
        if let Err(fault) = decoded {
            // The buffer of the view may hold the same data for readers that know no compression.
            return match plain {
                Ok(bytes) if !fault.is_lack_of_memory() && !self.requires(&MESHOPT) => Ok((view, bytes)),
                _ => Err(compressed(fault)),
            };
        }
        match plain {
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
