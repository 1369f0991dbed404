//! Decodes accessors with every bound checked: views, strides, sparse replacement and normalized integers.
//!
//! The `gltf` crate's own iterators assume a validated file and read past or unwrap where it is not one.

use gltf::{buffer, json};
use json::{
    accessor::{ComponentType, Type},
    validation::Checked,
};

use super::error::AccessorProblem;

/// More zeros than this are refused where a file stores none of them (a sparse accessor without a base).
const MAX_UNSTORED: u64 = 1 << 24;

/// The accessors of one file and the bytes they look at.
pub(super) struct Accessors<'a> {
    root: &'a json::Root,
    buffers: &'a [buffer::Data],
}

/// Where a run of equal elements lies: `count` elements of `size` bytes, `stride` bytes apart.
struct Elements<'a> {
    bytes: &'a [u8],
    size: usize,
    stride: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let (bytes, size, stride) = (self.bytes, self.size, self.stride);
        (0..self.count).map(move |i| &bytes[i * stride..i * stride + size])
    }
}

impl<'a> Accessors<'a> {
    pub(super) fn new(root: &'a json::Root, buffers: &'a [buffer::Data]) -> Self {
        Self { root, buffers }
    }

    /// The number of elements, without decoding them.
    pub(super) fn count(&self, index: usize) -> Result<usize, AccessorProblem> {
        let accessor = self.root.accessors.get(index).ok_or(AccessorProblem::Missing(index))?;
        usize::try_from(accessor.count.0).map_err(|_| AccessorProblem::OutOfBounds { accessor: index })
    }

    /// Points or displacements: floats, or the integers of `KHR_mesh_quantization`.
    pub(super) fn vec3(&self, index: usize) -> Result<Vec<[f32; 3]>, AccessorProblem> {
        let expected = "VEC3 of floats or of 8- or 16-bit integers";
        self.decode(
            index,
            Type::Vec3,
            expected,
            |kind| kind != ComponentType::U32,
            |number, bytes| {
                let size = bytes.len() / 3;
                [0, 1, 2].map(|c| number(&bytes[c * size..(c + 1) * size]))
            },
        )
    }

    /// Key times or weights: floats, or normalized integers.
    pub(super) fn scalars(&self, index: usize) -> Result<Vec<f32>, AccessorProblem> {
        let expected = "SCALAR of floats or of normalized 8- or 16-bit integers";
        self.decode(
            index,
            Type::Scalar,
            expected,
            |kind| kind != ComponentType::U32,
            |number, bytes| number(bytes),
        )
    }

    /// Vertex indices of 8, 16 or 32 bits.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, AccessorProblem> {
        let expected = "SCALAR of unsigned integers";
        let unsigned = |kind| matches!(kind, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        self.decode(index, Type::Scalar, expected, unsigned, |_, bytes| {
            unsigned_integer(bytes)
        })
    }

    fn decode<T: Clone + Default>(
        &self,
        index: usize,
        shape: Type,
        expected: &'static str,
        allowed: impl Fn(ComponentType) -> bool,
        element: impl Fn(&dyn Fn(&[u8]) -> f32, &[u8]) -> T,
    ) -> Result<Vec<T>, AccessorProblem> {
        let accessor = self.root.accessors.get(index).ok_or(AccessorProblem::Missing(index))?;
        let kind = match (&accessor.component_type, &accessor.type_) {
            (Checked::Valid(kind), Checked::Valid(found)) if *found == shape && allowed(kind.0) => kind.0,
            (kind, found) => {
                let kind = match kind {
                    Checked::Valid(kind) => format!("{:?}", kind.0),
                    Checked::Invalid => "an unknown component type".into(),
                };
                let found = match found {
                    Checked::Valid(found) => format!("{found:?}").to_uppercase(),
                    Checked::Invalid => "an unknown shape".into(),
                };
                let found = format!("{found} of {kind}");
                return Err(AccessorProblem::Type {
                    accessor: index,
                    found,
                    expected,
                });
            }
        };
        let normalized = accessor.normalized;
        let number = move |bytes: &[u8]| component(kind, normalized, bytes);
        let size = kind.size() * shape.multiplicity();
        let count = self.count(index)?;

        let mut values: Vec<T> = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                let elements = self.elements(index, view.value(), offset, size, count)?;
                elements.iter().map(|bytes| element(&number, bytes)).collect()
            }
            None if accessor.count.0 > MAX_UNSTORED => {
                return Err(AccessorProblem::Unstored {
                    accessor: index,
                    count: accessor.count.0,
                });
            }
            None => vec![T::default(); count],
        };

        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_kind) = sparse.indices.component_type else {
                let found = "sparse indices of an unknown component type".into();
                return Err(AccessorProblem::Type {
                    accessor: index,
                    found,
                    expected: "unsigned integers",
                });
            };
            let replaced =
                usize::try_from(sparse.count.0).map_err(|_| AccessorProblem::OutOfBounds { accessor: index })?;
            let (at, with) = (&sparse.indices, &sparse.values);
            let at = self.elements(
                index,
                at.buffer_view.value(),
                at.byte_offset.0,
                index_kind.0.size(),
                replaced,
            )?;
            let with = self.elements(index, with.buffer_view.value(), with.byte_offset.0, size, replaced)?;
            for (at, with) in at.iter().zip(with.iter()) {
                let at = unsigned_integer(at) as usize;
                let value = values.get_mut(at).ok_or(AccessorProblem::SparseIndex {
                    accessor: index,
                    element: at,
                    count,
                })?;
                *value = element(&number, with);
            }
        }
        Ok(values)
    }

    fn elements(
        &self,
        accessor: usize,
        view: usize,
        offset: u64,
        size: usize,
        count: usize,
    ) -> Result<Elements<'a>, AccessorProblem> {
        let out_of_bounds = || AccessorProblem::OutOfBounds { accessor };
        let range = |start: u64, length: u64| {
            let start = usize::try_from(start).ok()?;
            Some(start..start.checked_add(usize::try_from(length).ok()?)?)
        };
        let view = self
            .root
            .buffer_views
            .get(view)
            .ok_or(AccessorProblem::MissingView { accessor, view })?;
        let buffer: &[u8] = self.buffers.get(view.buffer.value()).ok_or_else(out_of_bounds)?;
        let bytes = range(view.byte_offset.unwrap_or_default().0, view.byte_length.0)
            .and_then(|range| buffer.get(range))
            .ok_or_else(out_of_bounds)?;
        let stride = view.byte_stride.map_or(size, |stride| stride.0);
        if stride < size {
            return Err(AccessorProblem::Stride { accessor, size, stride });
        }
        // The last element need not be followed by a whole stride.
        let length = match count.checked_sub(1) {
            Some(before_last) => before_last.checked_mul(stride).and_then(|n| n.checked_add(size)),
            None => Some(0),
        };
        let bytes = length
            .and_then(|length| range(offset, length as u64))
            .and_then(|range| bytes.get(range))
            .ok_or_else(out_of_bounds)?;
        Ok(Elements {
            bytes,
            size,
            stride,
            count,
        })
    }
}

/// One component as a float. Only called with as many bytes as `kind` has.
fn component(kind: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let signed = |value: f32, max: f32| if normalized { (value / max).max(-1.0) } else { value };
    let unsigned = |value: f32, max: f32| if normalized { value / max } else { value };
    match (kind, bytes) {
        (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
        (ComponentType::I8, &[a]) => signed(f32::from(a as i8), 127.0),
        (ComponentType::I16, &[a, b]) => signed(f32::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::U16, &[a, b]) => unsigned(f32::from(u16::from_le_bytes([a, b])), 65535.0),
        _ => unsigned(unsigned_integer(bytes) as f32, 255.0),
    }
}

/// A little-endian integer of up to 32 bits.
fn unsigned_integer(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
