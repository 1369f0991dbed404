//! Finds meshes in glTF files with more than four joints per vertex, of which Bevy draws four.

use std::future::ready;

use bevy::asset::LoadContext;
use bevy::gltf::extensions::{ErasedGltfExtensionHandler, GltfExtensionHandler};
use bevy::gltf::gltf::accessor::{DataType, Dimensions};
use bevy::gltf::gltf::mesh::util::ReadWeights;
use bevy::gltf::gltf::{Gltf, Mesh as GltfFileMesh, Primitive, Semantic};
use bevy::mesh::MeshVertexAttribute;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy::tasks::ConditionalSendFuture;

use super::complaints::FurtherInfluences;

/// Remembers the meshes whose further sets of influences the loader drops.
#[derive(Clone)]
pub(super) struct FurtherSets(pub(super) FurtherInfluences);

impl GltfExtensionHandler for FurtherSets {
    fn dyn_clone(&self) -> Box<dyn ErasedGltfExtensionHandler> {
        Box::new(self.clone())
    }

    fn on_gltf_primitive(
        &mut self,
        context: &mut LoadContext<'_>,
        _: &Gltf,
        mesh: &GltfFileMesh,
        primitive: &Primitive,
        buffers: &[Vec<u8>],
        _: &HashMap<Box<str>, MeshVertexAttribute>,
        _: bool,
        _: bool,
        _: &mut Option<Mesh>,
    ) -> impl ConditionalSendFuture<Output = ()> {
        if has_further_weights(primitive, buffers) {
            self.0.insert(format!("{}#Mesh{}", context.path(), mesh.index()));
        }
        ready(())
    }
}

/// Whether a weight of the second set of influences is not 0. Further sets only occur with the second.
fn has_further_weights(primitive: &Primitive, buffers: &[Vec<u8>]) -> bool {
    let Some(weights) = primitive.get(&Semantic::Weights(1)) else {
        return false;
    };
    // The reader expects these.
    let is_readable = weights.dimensions() == Dimensions::Vec4
        && matches!(weights.data_type(), DataType::U8 | DataType::U16 | DataType::F32);
    if !is_readable {
        return false;
    }
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
    let weights = reader.read_weights(1).map(ReadWeights::into_f32);
    weights.is_some_and(|mut weights| weights.any(|of_vertex| of_vertex != [0.0; 4]))
}
