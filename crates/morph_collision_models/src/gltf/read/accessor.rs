//! Decodes accessors with every bound checked: views, strides, sparse replacement and normalized integers.
//!
//! Opening an accessor checks that the data it claims exists. It is decoded after the memory for it has been counted.

use draco_core::AttributeValueIndex;
use glam::{Mat4, Vec3, Vec4};
use gltf::json::accessor::{BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT};

use super::GltfFile;
use super::document::{Accessor, SparsePart};
use super::draco::DracoValues;
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
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

/// A run of equal elements: `count` elements of `size` bytes, `stride` bytes apart.
#[derive(Debug)]
pub(super) struct Elements<'a> {
    bytes: &'a [u8],
    size: usize,
    stride: usize,
    count: usize,
    /// Which of the stored values each element has, if they are not in order.
    order: Option<&'a [AttributeValueIndex]>,
}

impl<'a> Elements<'a> {
    /// Elements at the start of `bytes`; `None` if they reach beyond.
    fn new(bytes: &'a [u8], size: usize, stride: usize, count: usize) -> Option<Self> {
        // The last element need not be followed by a whole stride.
        let length = match count.checked_sub(1) {
            Some(before_last) => before_last.checked_mul(stride)?.checked_add(size)?,
            None => 0,
        };
        Some(Self {
            bytes: bytes.get(..length)?,
            size,
            stride,
            count,
            order: None,
        })
    }

    /// Like [`Elements::new`], for elements that may share stored values.
    pub(super) fn in_order(
        bytes: &'a [u8],
        size: usize,
        stride: usize,
        count: usize,
        order: Option<&'a [AttributeValueIndex]>,
    ) -> Option<Self> {
        let Some(order) = order else {
            return Self::new(bytes, size, stride, count);
        };
        let last = order.get(..count)?.iter().map(|value| value.0 as usize).max();
        let stored = match last {
            Some(last) => last.checked_add(1)?,
            None => 0,
        };
        let stored = Self::new(bytes, size, stride, stored)?;
        let order = Some(order);
        Some(Self { count, order, ..stored })
    }

    /// The bytes of an element.
    fn get(&self, index: usize) -> &'a [u8] {
        let start = self.order.map_or(index, |order| order[index].0 as usize) * self.stride;
        &self.bytes[start..start + self.size]
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        (0..self.count).map(|index| self.get(index))
    }
}

/// What an accessor has to hold.
pub(super) struct Form {
    shape: &'static str,
    components: usize,
    /// The same in words.
    expected: &'static str,
    allowed: fn(Component) -> bool,
    /// Whether integers always stand for fractions; otherwise the file says so.
    fractions: bool,
}

/// Points or displacements: floats, or the integers of `KHR_mesh_quantization`.
pub(super) const POINTS: Form = Form {
    shape: "VEC3",
    components: 3,
    expected: "VEC3 of floats or of 8- or 16-bit integers",
    allowed: |kind| kind != Component::U32,
    fractions: false,
};
/// Key times.
pub(super) const TIMES: Form = Form {
    shape: "SCALAR",
    components: 1,
    expected: "SCALAR of floats",
    allowed: |kind| kind == Component::F32,
    fractions: false,
};
/// Weights of targets: floats, or normalized integers.
pub(super) const WEIGHTS: Form = Form {
    shape: "SCALAR",
    components: 1,
    expected: "SCALAR of floats or of normalized 8- or 16-bit integers",
    allowed: |kind| kind != Component::U32,
    fractions: true,
};
/// Vertex indices of 8, 16 or 32 bits.
pub(super) const INDICES: Form = Form {
    shape: "SCALAR",
    components: 1,
    expected: "SCALAR of unsigned integers",
    allowed: Component::is_unsigned,
    fractions: false,
};
/// Indices of joints.
pub(super) const JOINTS: Form = Form {
    shape: "VEC4",
    components: 4,
    expected: "VEC4 of 8- or 16-bit unsigned integers",
    allowed: |kind| matches!(kind, Component::U8 | Component::U16),
    fractions: false,
};
/// Weights of joints, or rotations: floats, or normalized integers.
pub(super) const FRACTIONS: Form = Form {
    shape: "VEC4",
    components: 4,
    expected: "VEC4 of floats or of normalized 8- or 16-bit integers",
    allowed: |kind| kind != Component::U32,
    fractions: true,
};
/// Matrices.
pub(super) const MATRICES: Form = Form {
    shape: "MAT4",
    components: 16,
    expected: "MAT4 of floats",
    allowed: |kind| kind == Component::F32,
    fractions: false,
};

impl GltfFile {
    /// Opens an accessor that holds `form`.
    pub(super) fn open_accessor(&self, index: usize, form: &Form) -> Result<Opened<'_>, AccessorProblem> {
        let (accessor, count) = self.accessor(index)?;
        let kind = Component::new(accessor.component_type);
        let kind = form.check(index, &accessor.shape, kind)?;
        let size = kind.size() * form.components;
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
                let replaced = usize::try_from(sparse.count);
                let replaced = replaced.map_err(|_| AccessorProblem::OutOfBounds { accessor: index })?;
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
            normalized: accessor.normalized || form.fractions,
            stored: stored.transpose()?,
            replaced,
        })
    }

    /// Opens an accessor of vertices. Its values come from a compressed primitive, if that has them.
    pub(super) fn open_vertices<'a>(
        &'a self,
        index: usize,
        form: &Form,
        decoded: Option<DracoValues<'a>>,
    ) -> Result<Opened<'a>, AccessorProblem> {
        let Some(decoded) = decoded else {
            return self.open_accessor(index, form);
        };
        let (accessor, count) = self.accessor(index)?;
        let shape = match decoded.components {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            4 => "VEC4",
            _ => "more than four components",
        };
        let kind = form.check(index, shape, Some(decoded.kind))?;
        if decoded.elements.count != count {
            return Err(AccessorProblem::DecodedCount {
                accessor: index,
                found: decoded.elements.count,
                expected: count,
            });
        }
        Ok(Opened {
            index,
            count,
            kind,
            normalized: accessor.normalized || form.fractions,
            stored: Some(decoded.elements),
            replaced: None,
        })
    }

    /// An accessor and the number of its elements.
    fn accessor(&self, index: usize) -> Result<(&Accessor, usize), AccessorProblem> {
        let accessor = self.root.accessors.get(index, &self.budget);
        let accessor = accessor.map_err(|problem| AccessorProblem::Element {
            accessor: index,
            problem,
        })?;
        let count = usize::try_from(accessor.count);
        let count = count.map_err(|_| AccessorProblem::OutOfBounds { accessor: index })?;
        Ok((accessor, count))
    }

    fn elements(
        &self,
        accessor: usize,
        view: usize,
        offset: u64,
        size: usize,
        count: usize,
    ) -> Result<Elements<'_>, AccessorProblem> {
        let (view, bytes) = self.view(accessor, view)?;
        let stride = view.byte_stride.unwrap_or(size);
        if stride < size {
            return Err(AccessorProblem::Stride { accessor, size, stride });
        }
        let start = usize::try_from(offset).ok();
        let elements = start
            .and_then(|start| bytes.get(start..))
            .and_then(|bytes| Elements::new(bytes, size, stride, count));
        elements.ok_or(AccessorProblem::OutOfBounds { accessor })
    }
}

impl Form {
    /// The component type of an accessor, if its type is the needed one.
    fn check(&self, accessor: usize, shape: &str, kind: Option<Component>) -> Result<Component, AccessorProblem> {
        match kind {
            Some(kind) if shape == self.shape && (self.allowed)(kind) => Ok(kind),
            _ => {
                let kind = kind.map_or("an unknown component type".into(), |kind| format!("{kind:?}"));
                Err(AccessorProblem::Type {
                    accessor,
                    found: format!("{shape} of {kind}"),
                    expected: self.expected,
                })
            }
        }
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

    /// The last number; `None` if there is none.
    pub(super) fn last_scalar(&self) -> Option<f32> {
        let last = self.count.checked_sub(1)?;
        // Replaced elements ascend, so only the last of them can be the last of all.
        let replaced = self.replaced.as_ref().and_then(|(_, at, with)| {
            let index = at.count.checked_sub(1)?;
            (unsigned_integer(at.get(index)) as usize == last).then(|| with.get(index))
        });
        let bytes = replaced.or_else(|| self.stored.as_ref().map(|elements| elements.get(last)));
        Some(bytes.map_or(0.0, |bytes| self.number(bytes)))
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

    pub(super) fn size(self) -> usize {
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
