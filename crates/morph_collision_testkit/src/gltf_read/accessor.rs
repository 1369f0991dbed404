//! Decodes accessors with every bound checked: views, strides, sparse replacement and normalized integers.
//!
//! Opening an accessor checks that the data it claims exists. It is decoded after the memory for it has been counted.

use glam::{Mat4, Vec3, Vec4};
use gltf::json::accessor::{BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};

use super::GltfFile;
use super::document::SparsePart;
use super::error::AccessorProblem;

/// An accessor whose type and bounds are checked.
#[derive(Debug)]
pub(super) struct Opened<'a> {
    index: usize,
    count: usize,
    kind: Component,
    normalized: bool,
    /// `None` if there is no buffer view; then the elements are zero.
    stored: Option<Elements<'a>>,
    /// The replaced elements, and their new values.
    replaced: Option<(Component, Elements<'a>, Elements<'a>)>,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// A run of equal elements: `count` elements of `size` bytes, `stride` bytes apart.
#[derive(Debug)]
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

impl GltfFile {
    /// Points or displacements: floats, or the integers of `KHR_mesh_quantization`.
    pub(super) fn open_vec3(&self, index: usize) -> Result<Opened<'_>, AccessorProblem> {
        let expected = "VEC3 of floats or of 8- or 16-bit integers";
        self.open_accessor(index, ("VEC3", 3), expected, |kind| kind != Component::U32)
    }

    /// Key times or weights: floats, or normalized integers.
    pub(super) fn open_scalars(&self, index: usize) -> Result<Opened<'_>, AccessorProblem> {
        let expected = "SCALAR of floats or of normalized 8- or 16-bit integers";
        self.open_accessor(index, ("SCALAR", 1), expected, |kind| kind != Component::U32)
    }

    /// Vertex indices of 8, 16 or 32 bits.
    pub(super) fn open_indices(&self, index: usize) -> Result<Opened<'_>, AccessorProblem> {
        self.open_accessor(
            index,
            ("SCALAR", 1),
            "SCALAR of unsigned integers",
            Component::is_unsigned,
        )
    }

    /// Indices of joints.
    pub(super) fn open_joints(&self, index: usize) -> Result<Opened<'_>, AccessorProblem> {
        let allowed = |kind| matches!(kind, Component::U8 | Component::U16);
        self.open_accessor(index, ("VEC4", 4), "VEC4 of 8- or 16-bit unsigned integers", allowed)
    }

    /// Weights of joints, or rotations: floats, or normalized integers.
    pub(super) fn open_vec4(&self, index: usize) -> Result<Opened<'_>, AccessorProblem> {
        let expected = "VEC4 of floats or of normalized 8- or 16-bit integers";
        self.open_accessor(index, ("VEC4", 4), expected, |kind| kind != Component::U32)
    }

    /// Matrices of floats.
    pub(super) fn open_matrices(&self, index: usize) -> Result<Opened<'_>, AccessorProblem> {
        self.open_accessor(index, ("MAT4", 16), "MAT4 of floats", |kind| kind == Component::F32)
    }

    fn open_accessor(
        &self,
        index: usize,
        (shape, components): (&str, usize),
        expected: &'static str,
        allowed: impl Fn(Component) -> bool,
    ) -> Result<Opened<'_>, AccessorProblem> {
        let accessor = self.root.accessors.get(index, &self.budget);
        let accessor = accessor.map_err(|problem| AccessorProblem::Element {
            accessor: index,
            problem,
        })?;
        let wrong = |found: String| AccessorProblem::Type {
            accessor: index,
            found,
            expected,
        };
        let kind = Component::new(accessor.component_type);
        let Some(kind) = kind.filter(|&kind| accessor.shape == shape && allowed(kind)) else {
            let kind = kind.map_or("an unknown component type".into(), |kind| format!("{kind:?}"));
            return Err(wrong(format!("{} of {kind}", accessor.shape)));
        };
        let out_of_bounds = |_| AccessorProblem::OutOfBounds { accessor: index };
        let (size, count) = (
            kind.size() * components,
            usize::try_from(accessor.count).map_err(out_of_bounds)?,
        );
        let stored = accessor.buffer_view;
        let stored = stored.map(|view| self.elements(index, view, accessor.byte_offset, size, count));
        let replaced = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let index_kind = Component::new(sparse.indices.component_type).filter(|kind| kind.is_unsigned());
                let index_kind = index_kind.ok_or_else(|| AccessorProblem::Type {
                    accessor: index,
                    found: "sparse indices of an unknown component type".into(),
                    expected: "unsigned integers",
                })?;
                let replaced = usize::try_from(sparse.count).map_err(out_of_bounds)?;
                let part =
                    |part: &SparsePart, size| self.elements(index, part.buffer_view, part.byte_offset, size, replaced);
                Some((
                    index_kind,
                    part(&sparse.indices, index_kind.size())?,
                    part(&sparse.values, size)?,
                ))
            }
        };
        Ok(Opened {
            index,
            count,
            kind,
            normalized: accessor.normalized,
            stored: stored.transpose()?,
            replaced,
        })
    }

    fn elements(
        &self,
        accessor: usize,
        view: usize,
        offset: u64,
        size: usize,
        count: usize,
    ) -> Result<Elements<'_>, AccessorProblem> {
        let out_of_bounds = || AccessorProblem::OutOfBounds { accessor };
        let range = |start: u64, length: u64| {
            let start = usize::try_from(start).ok()?;
            Some(start..start.checked_add(usize::try_from(length).ok()?)?)
        };
        let json = self.root.buffer_views.get(view, &self.budget);
        let view = json.map_err(|problem| AccessorProblem::View {
            accessor,
            view,
            problem,
        })?;
        let buffer = self.buffers.get(view.buffer, &self.root, &self.budget);
        let buffer = buffer.map_err(|problem| AccessorProblem::Buffer {
            accessor,
            problem: Box::new(problem),
        })?;
        let bytes = range(view.byte_offset, view.byte_length)
            .and_then(|range| buffer.get(range))
            .ok_or_else(out_of_bounds)?;
        let stride = view.byte_stride.unwrap_or(size);
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

impl Opened<'_> {
    /// The number of elements.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Whether the file stores nothing for it, so that all elements are zero.
    pub(super) fn is_unstored(&self) -> bool {
        self.stored.is_none() && self.replaced.as_ref().is_none_or(|(_, at, _)| at.count == 0)
    }

    /// Appends points or displacements.
    pub(super) fn append_vec3(&self, to: &mut Vec<Vec3>) -> Result<(), AccessorProblem> {
        self.append(to, |opened, bytes| Vec3::from_array(opened.numbers(bytes)))
    }

    /// Appends points or displacements with a last component of 0.
    pub(super) fn append_vec3_as_vec4(&self, to: &mut Vec<Vec4>) -> Result<(), AccessorProblem> {
        self.append(to, |opened, bytes| Vec3::from_array(opened.numbers(bytes)).extend(0.0))
    }

    /// Appends rotations.
    pub(super) fn append_vec4(&self, to: &mut Vec<Vec4>) -> Result<(), AccessorProblem> {
        self.append(to, |opened, bytes| Vec4::from_array(opened.numbers(bytes)))
    }

    /// Appends indices of joints.
    pub(super) fn append_joints(&self, to: &mut Vec<[u16; 4]>) -> Result<(), AccessorProblem> {
        self.append(to, |_, bytes| {
            let size = bytes.len() / 4;
            [0, 1, 2, 3].map(|c| unsigned_integer(&bytes[c * size..(c + 1) * size]) as u16)
        })
    }

    /// Appends weights of joints.
    pub(super) fn append_joint_weights(&self, to: &mut Vec<[f32; 4]>) -> Result<(), AccessorProblem> {
        self.append(to, Self::numbers)
    }

    /// Matrices.
    pub(super) fn matrices(&self) -> Result<Vec<Mat4>, AccessorProblem> {
        let mut matrices = Vec::new();
        self.append(&mut matrices, |opened, bytes| {
            Mat4::from_cols_array(&opened.numbers(bytes))
        })?;
        Ok(matrices)
    }

    /// Key times or weights.
    pub(super) fn scalars(&self) -> Result<Vec<f32>, AccessorProblem> {
        let mut values = Vec::new();
        self.append(&mut values, Self::number)?;
        Ok(values)
    }

    /// Vertex indices.
    pub(super) fn indices(&self) -> Result<Vec<u32>, AccessorProblem> {
        let mut values = Vec::new();
        self.append(&mut values, |_, bytes| unsigned_integer(bytes))?;
        Ok(values)
    }

    fn append<T: Clone + Default>(
        &self,
        values: &mut Vec<T>,
        element: impl Fn(&Self, &[u8]) -> T,
    ) -> Result<(), AccessorProblem> {
        let start = values.len();
        values.reserve_exact(self.count);
        match &self.stored {
            Some(elements) => values.extend(elements.iter().map(|bytes| element(self, bytes))),
            None => values.resize(start + self.count, T::default()),
        }
        if let Some((_, at, with)) = &self.replaced {
            for (at, with) in at.iter().zip(with.iter()) {
                let at = unsigned_integer(at) as usize;
                let value = values[start..].get_mut(at);
                let value = value.ok_or(AccessorProblem::SparseIndex {
                    accessor: self.index,
                    element: at,
                    count: self.count,
                })?;
                *value = element(self, with);
            }
        }
        Ok(())
    }

    /// The components of an element as floats.
    fn numbers<const N: usize>(&self, bytes: &[u8]) -> [f32; N] {
        let size = bytes.len() / N;
        std::array::from_fn(|c| self.number(&bytes[c * size..(c + 1) * size]))
    }

    /// One component as a float.
    fn number(&self, bytes: &[u8]) -> f32 {
        let signed = |value: f32, max: f32| {
            if self.normalized {
                (value / max).max(-1.0)
            } else {
                value
            }
        };
        let unsigned = |value: f32, max: f32| if self.normalized { value / max } else { value };
        match (self.kind, bytes) {
            (Component::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (Component::I8, &[a]) => signed(f32::from(a as i8), 127.0),
            (Component::I16, &[a, b]) => signed(f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (Component::U16, &[a, b]) => unsigned(f32::from(u16::from_le_bytes([a, b])), 65535.0),
            _ => unsigned(unsigned_integer(bytes) as f32, 255.0),
        }
    }
}

impl Component {
    fn new(kind: u32) -> Option<Self> {
        Some(match kind {
            BYTE => Self::I8,
            UNSIGNED_BYTE => Self::U8,
            SHORT => Self::I16,
            UNSIGNED_SHORT => Self::U16,
            UNSIGNED_INT => Self::U32,
            FLOAT => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// A little-endian integer of up to 32 bits.
fn unsigned_integer(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
