//! Packs values into the one buffer of a file. Each list gets its own accessor and view.

use gltf::Glb;
use gltf_json::{
    self as json, Index, Root, Value,
    accessor::{ComponentType, GenericComponentType, Type},
    buffer::Target,
    validation::{Checked, USize64},
};

/// The growing buffer.
#[derive(Default)]
pub(super) struct Packer {
    bytes: Vec<u8>,
}

impl Packer {
    /// A vertex attribute; `bounded` adds the smallest and largest value per component, as glTF requires for
    /// positions.
    pub(super) fn vertices<const N: usize>(
        &mut self,
        root: &mut Root,
        shape: Type,
        values: &[[f32; N]],
        bounded: bool,
    ) -> Index<json::Accessor> {
        let bytes = values.as_flattened().iter().flat_map(|v| v.to_le_bytes());
        let view = self.view(root, bytes, Some(Target::ArrayBuffer));
        let bounds = bounded.then(|| extremes(values));
        accessor(root, view, ComponentType::F32, shape, values.len(), bounds)
    }

    /// The joints of a set of influences, with 8 bits if the number of `joints` allows.
    pub(super) fn joints(&mut self, root: &mut Root, values: &[[u16; 4]], joints: usize) -> Index<json::Accessor> {
        let (values_of, target) = (values.as_flattened().iter(), Some(Target::ArrayBuffer));
        let (view, kind) = if joints <= 256 {
            (
                self.view(root, values_of.map(|&joint| joint as u8), target),
                ComponentType::U8,
            )
        } else {
            let bytes = values_of.flat_map(|joint| joint.to_le_bytes());
            (self.view(root, bytes, target), ComponentType::U16)
        };
        accessor(root, view, kind, Type::Vec4, values.len(), None)
    }

    /// Matrices of joints, or values of a channel that moves a node.
    pub(super) fn values<const N: usize>(
        &mut self,
        root: &mut Root,
        shape: Type,
        values: impl ExactSizeIterator<Item = [f32; N]>,
    ) -> Index<json::Accessor> {
        let count = values.len();
        let view = self.view(root, values.flatten().flat_map(f32::to_le_bytes), None);
        accessor(root, view, ComponentType::F32, shape, count, None)
    }

    /// Key times (bounded) or weights of an animation.
    pub(super) fn keys(&mut self, root: &mut Root, values: &[f32], bounded: bool) -> Index<json::Accessor> {
        let view = self.view(root, values.iter().flat_map(|v| v.to_le_bytes()), None);
        let (scalars, _) = values.as_chunks::<1>();
        let bounds = bounded.then(|| extremes(scalars));
        accessor(root, view, ComponentType::F32, Type::Scalar, values.len(), bounds)
    }

    /// Vertex indices, with 16 bits if the number of `vertices` allows. 65535 itself is not used, as glTF requires.
    pub(super) fn indices(&mut self, root: &mut Root, indices: &[u32], vertices: usize) -> Index<json::Accessor> {
        let target = Some(Target::ElementArrayBuffer);
        let (view, kind) = if vertices <= usize::from(u16::MAX) {
            let view = self.view(root, indices.iter().flat_map(|&i| (i as u16).to_le_bytes()), target);
            (view, ComponentType::U16)
        } else {
            (
                self.view(root, indices.iter().flat_map(|i| i.to_le_bytes()), target),
                ComponentType::U32,
            )
        };
        accessor(root, view, kind, Type::Scalar, indices.len(), None)
    }

    fn view(
        &mut self,
        root: &mut Root,
        bytes: impl Iterator<Item = u8>,
        target: Option<Target>,
    ) -> Index<json::buffer::View> {
        let offset = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - offset;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        root.push(json::buffer::View {
            buffer: Index::new(0),
            byte_length: USize64::from(length),
            byte_offset: Some(USize64::from(offset)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: None,
        })
    }

    /// The container: JSON and the buffer.
    pub(super) fn finish(self, mut root: Root) -> Result<Vec<u8>, String> {
        root.push(json::Buffer {
            byte_length: USize64::from(self.bytes.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        let json = json::serialize::to_vec(&root).map_err(|error| error.to_string())?;
        let length = json.len().saturating_add(self.bytes.len()).saturating_add(64);
        let length = u32::try_from(length).map_err(|_| "it is larger than 4 GiB".to_string())?;
        let header = gltf::binary::Header {
            magic: *b"glTF",
            version: 2,
            length,
        };
        let glb = Glb {
            header,
            json: json.into(),
            bin: Some(self.bytes.into()),
        };
        glb.to_vec().map_err(|error| error.to_string())
    }
}

fn accessor(
    root: &mut Root,
    view: Index<json::buffer::View>,
    kind: ComponentType,
    shape: Type,
    count: usize,
    bounds: Option<(Value, Value)>,
) -> Index<json::Accessor> {
    let (min, max) = bounds.unzip();
    root.push(json::Accessor {
        buffer_view: Some(view),
        byte_offset: None,
        count: USize64::from(count),
        component_type: Checked::Valid(GenericComponentType(kind)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(shape),
        min,
        max,
        name: None,
        normalized: false,
        sparse: None,
    })
}

/// The smallest and largest value of every component.
fn extremes<const N: usize>(values: &[[f32; N]]) -> (Value, Value) {
    let along = |start: f32, pick: fn(f32, f32) -> f32| {
        let mut extreme = [start; N];
        for value in values {
            for c in 0..N {
                extreme[c] = pick(extreme[c], value[c]);
            }
        }
        Value::from(extreme.to_vec())
    };
    (along(f32::INFINITY, f32::min), along(f32::NEG_INFINITY, f32::max))
}
