//! The types that a glTF scene is made of.
//!
//! Bevy copies a scene into the world by reflection, so it needs to know these. With its feature `reflect_auto_register` it knows all types
//! there are, but then a web program is larger by 1 MB with gzip.

use bevy::animation::{AnimatedBy, AnimationTargetId};
use bevy::camera::primitives::{Aabb, CascadesFrusta, CubemapFrusta, Frustum};
use bevy::camera::visibility::{
    CascadesVisibleEntities, CubemapVisibleEntities, DynamicSkinnedMeshBounds, VisibilityClass, VisibleEntities,
    VisibleMeshEntities,
};
use bevy::camera::{CameraMainTextureUsages, RenderTarget};
use bevy::gltf::{
    GltfExtras, GltfMaterialExtras, GltfMaterialName, GltfMeshExtras, GltfMeshName, GltfSceneExtras, GltfSceneName,
};
use bevy::light::cascade::{CascadeShadowConfig, Cascades};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::reflect::TypeRegistry;
use bevy::transform::components::TransformTreeChanged;

macro_rules! register {
    ($types:ident: $($kind:ty,)*) => { $($types.register::<$kind>();)* };
}

/// Registers the components of a scene that Bevy's glTF loader makes, except the material, which Bevy's renderer registers.
pub fn register(types: &mut TypeRegistry) {
    register!(types:
        Name, ChildOf, Children,
        Transform, GlobalTransform, TransformTreeChanged,
        Visibility, InheritedVisibility, ViewVisibility, VisibilityClass,
        Mesh3d, Aabb, MorphWeights, MeshMorphWeights, SkinnedMesh, DynamicSkinnedMeshBounds,
        AnimationPlayer, AnimationTargetId, AnimatedBy,
        GltfExtras, GltfMaterialExtras, GltfMaterialName, GltfMeshExtras, GltfMeshName, GltfSceneExtras, GltfSceneName,
        Camera, Camera3d, Projection, RenderTarget, CameraMainTextureUsages, Frustum, VisibleEntities,
        DirectionalLight, Cascades, CascadesFrusta, CascadeShadowConfig, CascadesVisibleEntities,
        PointLight, CubemapFrusta, CubemapVisibleEntities,
        SpotLight, VisibleMeshEntities,
    );
}
