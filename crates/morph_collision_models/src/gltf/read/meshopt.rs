//! Buffer views that are compressed by meshoptimizer (`EXT_meshopt_compression`, `KHR_meshopt_compression`).

use meshoptimizer_rs::codec::{
    decode_filter_color, decode_filter_exp, decode_filter_oct, decode_filter_quat, decode_index_buffer,
    decode_index_sequence, decode_vertex_buffer,
};
use meshoptimizer_rs::{Error, Limits, Workspace};

use super::GltfFile;
use super::document::{MeshoptView, View};
use super::error::CompressionFault;

impl GltfFile {
    /// The decoded bytes of a view; `None` if it is not compressed.
    pub(super) fn meshopt(&self, index: usize, view: &View) -> Result<Option<&[u8]>, CompressionFault> {
        let extensions = &view.extensions;
        let Some(stored) = extensions.khr_meshopt.as_ref().or(extensions.ext_meshopt.as_ref()) else {
            return Ok(None);
        };
        let stored = stored.get(&self.budget).map_err(CompressionFault::Extension)?;
        let decode = || self.decode_view(index, stored);
        let bytes = self.decoded.views.get(index, &self.budget, decode)?;
        Ok(Some(bytes))
    }

    fn decode_view(&self, index: usize, stored: &MeshoptView) -> Result<Vec<u8>, CompressionFault> {
        let source = self.range(stored.buffer, stored.byte_offset, stored.byte_length)?;
        let stride = stored.byte_stride;
        // The decoder's own work is proportional to these bytes, too. It keeps nothing else.
        let bytes = stored.count.saturating_mul(stride as u64);
        let keep = self.budget.keep(bytes, 1, || format!("decoded buffer view {index}"));
        keep.map_err(CompressionFault::OverBudget)?;
        let count = usize::try_from(stored.count).map_err(|_| CompressionFault::OutOfBounds)?;
        decode(stored, count, source).map_err(|error| CompressionFault::Meshopt(error.to_string()))
    }
}

fn decode(stored: &MeshoptView, count: usize, source: &[u8]) -> Result<Vec<u8>, Error> {
    let stride = stored.byte_stride;
    let limits = Limits {
        max_bytes: count.saturating_mul(stride),
        ..Limits::default()
    };
    let workspace = &mut Workspace::new(limits);
    let filter = stored.filter.as_deref().unwrap_or("NONE");
    let mut bytes = match (&*stored.mode, filter) {
        ("ATTRIBUTES", _) => decode_vertex_buffer(count, stride, source, workspace),
        ("TRIANGLES", "NONE") => decode_index_buffer(count, stride, source, workspace),
        ("INDICES", "NONE") => decode_index_sequence(count, stride, source, workspace),
        _ => Err(Error::InvalidParameter),
    }?;
    // Filters change the bytes in place.
    match filter {
        "NONE" => {}
        "OCTAHEDRAL" => decode_filter_oct(&mut bytes, count, stride, workspace)?,
        "QUATERNION" => decode_filter_quat(&mut bytes, count, stride, workspace)?,
        "EXPONENTIAL" => decode_filter_exp(&mut bytes, count, stride, workspace)?,
        "COLOR" => decode_filter_color(&mut bytes, count, stride, workspace)?,
        _ => return Err(Error::InvalidParameter),
    }
    Ok(bytes)
}
