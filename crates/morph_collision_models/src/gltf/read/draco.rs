//! Primitives that are compressed by Draco (`KHR_draco_mesh_compression`).

use draco_core::{AttributeValueIndex, DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute};

use super::GltfFile;
use super::accessor::{Component, Elements};
use super::attributes::Attributes;
use super::document::Primitive;
use super::error::CompressionFault;
use super::extensions::DRACO;
use super::view::range;

/// Upper bound on the bytes that decoding takes per triangle and per vertex, beside the values of attributes.
const BYTES_PER_ELEMENT: u64 = 512;
/// Upper bound on the share of the remaining memory that decoded values of attributes may take: they exist twice while they are decoded,
/// and once more while a mesh is made of them.
const SHARE_OF_VALUES: u64 = 4;

/// A decoded primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct DracoMesh<'a> {
    mesh: &'a Mesh,
    /// The numbers of its attributes.
    numbers: &'a Attributes,
}

/// A decoded attribute: what it holds, and the value of each vertex.
#[derive(Debug)]
pub(super) struct DracoValues<'a> {
    pub(super) kind: Component,
    pub(super) components: usize,
    pub(super) elements: Elements<'a>,
}

impl GltfFile {
    /// The decoded stream of a primitive; `None` if it is not compressed, or if the file also stores plain data and the stream cannot be
    /// decoded.
    pub(super) fn draco<'a>(&'a self, primitive: &'a Primitive) -> Result<Option<DracoMesh<'a>>, CompressionFault> {
        match self.stream(primitive) {
            Err(fault) if !fault.is_lack_of_memory() && self.stores_plainly(primitive) => Ok(None),
            found => found,
        }
    }

    /// Whether the positions and the indices of a compressed primitive are also stored plainly.
    fn stores_plainly(&self, primitive: &Primitive) -> bool {
        let is_stored = |accessor: usize| {
            let accessor = self.root.accessors.get(accessor, &self.budget);
            accessor.is_ok_and(|accessor| accessor.buffer_view.is_some())
        };
        let positions = primitive.attributes.positions;
        !self.requires(&[DRACO]) && positions.is_some_and(is_stored) && primitive.indices.is_none_or(is_stored)
    }

    fn stream<'a>(&'a self, primitive: &'a Primitive) -> Result<Option<DracoMesh<'a>>, CompressionFault> {
        let Some(stored) = &primitive.extensions.draco else {
            return Ok(None);
        };
        let stored = stored.get(&self.budget).map_err(CompressionFault::Extension)?;
        let count = |accessor: Option<usize>| {
            let accessor = self.root.accessors.get(accessor?, &self.budget).ok()?;
            Some(accessor.count)
        };
        let vertices = count(primitive.attributes.positions).unwrap_or(0);
        let triangles = count(primitive.indices).map_or(vertices, |corners| corners / 3);
        let decode = || self.decode_stream(stored.buffer_view, vertices, triangles);
        let mesh = self.decoded.meshes.get(stored.buffer_view, &self.budget, decode)?;
        Ok(Some(DracoMesh {
            mesh,
            numbers: &stored.attributes,
        }))
    }

    /// Decodes a stream of at most as many elements as the file's accessors say.
    fn decode_stream(&self, view: usize, vertices: u64, triangles: u64) -> Result<Mesh, CompressionFault> {
        let json = self.root.buffer_views.get(view, &self.budget);
        let json = json.map_err(CompressionFault::View)?;
        let buffer = self.buffers.get(json.buffer, &self.root, &self.budget);
        let buffer = buffer.map_err(|problem| CompressionFault::Buffer(Box::new(problem)))?;
        let stream = range(buffer, json.byte_offset, json.byte_length).ok_or(CompressionFault::OutOfBounds)?;
        let what = || format!("decoding buffer view {view}");
        let mesh = self.budget.lend(|| {
            let elements = vertices.saturating_add(triangles);
            let take = self.budget.take(elements, BYTES_PER_ELEMENT, what);
            take.map_err(CompressionFault::OverBudget)?;
            let limits = DecodeLimits::default()
                .with_max_points(vertices)
                .with_max_faces(triangles)
                .with_max_decoded_bytes(self.budget.left() / SHARE_OF_VALUES);
            let mut mesh = Mesh::new();
            let decoded = MeshDecoder::new().decode(&mut DecoderBuffer::new(stream).with_limits(limits), &mut mesh);
            decoded.map_err(|error| CompressionFault::Draco(error.to_string()))?;
            Ok(mesh)
        })?;
        let keep = self.budget.keep(bytes_of(&mesh), 1, what);
        keep.map_err(CompressionFault::OverBudget)?;
        Ok(mesh)
    }
}

/// The bytes of a decoded mesh.
fn bytes_of(mesh: &Mesh) -> u64 {
    let attributes = (0..mesh.num_attributes()).filter_map(|index| mesh.try_attribute(index).ok());
    let values = attributes.map(|attribute| attribute.buffer().data_size() + 4 * mesh.num_points());
    (values.sum::<usize>() + 12 * mesh.num_faces()) as u64
}

impl<'a> DracoMesh<'a> {
    /// The number of triangles.
    pub(super) fn triangle_count(&self) -> usize {
        self.mesh.num_faces()
    }

    /// The corners of its triangles.
    pub(super) fn corners(&self) -> Vec<u32> {
        self.mesh.faces().as_flattened().iter().map(|point| point.0).collect()
    }

    /// The positions.
    pub(super) fn positions(&self) -> Result<Option<DracoValues<'a>>, CompressionFault> {
        self.values(self.numbers.positions)
    }

    /// Joints and weights of a set of influences.
    pub(super) fn influences(&self, set: usize) -> Result<[Option<DracoValues<'a>>; 2], CompressionFault> {
        let [joints, weights] = self.numbers.influences.get(&set).copied().unwrap_or_default();
        Ok([self.values(joints)?, self.values(weights)?])
    }

    /// The values of the attribute with a number; `None` if the attribute is not part of the stream.
    fn values(&self, number: Option<usize>) -> Result<Option<DracoValues<'a>>, CompressionFault> {
        let Some(number) = number else { return Ok(None) };
        let attribute = u32::try_from(number).ok();
        let attribute = attribute.and_then(|number| self.mesh.attribute_by_unique_id(number));
        let attribute: &PointAttribute = attribute.ok_or(CompressionFault::NoAttribute(number))?;
        let kind = component(attribute.data_type()).ok_or(CompressionFault::ComponentType(number))?;
        let components = usize::from(attribute.num_components());
        let order: Option<&[AttributeValueIndex]> = attribute.explicit_mapping();
        let elements = Elements::in_order(
            attribute.buffer().data(),
            kind.size() * components,
            usize::try_from(attribute.byte_stride()).unwrap_or(0),
            self.mesh.num_points(),
            order,
        );
        let elements = elements.ok_or(CompressionFault::OutOfBounds)?;
        Ok(Some(DracoValues {
            kind,
            components,
            elements,
        }))
    }
}

fn component(kind: DataType) -> Option<Component> {
    Some(match kind {
        DataType::Int8 => Component::I8,
        DataType::Uint8 => Component::U8,
        DataType::Int16 => Component::I16,
        DataType::Uint16 => Component::U16,
        DataType::Uint32 => Component::U32,
        DataType::Float32 => Component::F32,
        _ => return None,
    })
}
