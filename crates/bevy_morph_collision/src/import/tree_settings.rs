//! How trees are built: for all meshes, or for what one entity shows.

use bevy::prelude::*;
use morph_collision::{BuildOptions, VolumeKind};

/// How trees are built, for all meshes. No answer depends on it.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::{BuildOptions, MorphCollisionPlugin, MorphTreeOptions};
/// # let mut app = App::new();
/// app.insert_resource(MorphTreeOptions(BuildOptions::default().with_leaf_size(8)));
/// app.add_plugins(MorphCollisionPlugin);
/// ```
#[derive(Resource, Reflect, Clone, Debug, Default)]
#[reflect(Resource, Clone, Debug, Default)]
pub struct MorphTreeOptions(#[reflect(ignore)] pub BuildOptions);

/// On a collider: how the tree of its mesh is built, where it is not as [`MorphTreeOptions`] say. Colliders with equal settings
/// share a tree. No answer depends on it.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Component, Debug, Default, Clone, PartialEq, Hash)]
pub struct MorphTreeSettings {
    /// The kind of bounding volume.
    pub volume: MorphVolume,
    /// Children of a node at most: 2, 4 or 8.
    pub arity: u8,
    /// A node with at most this many triangles becomes a leaf; 1 to 255.
    pub leaf_size: u8,
    /// Tight volumes half way between targets, for shapes that rest there.
    pub in_betweens: bool,
    /// Half the bytes, a little more time.
    pub compact: bool,
}

/// The kind of bounding volume of a tree.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[reflect(Debug, Default, Clone, PartialEq, Hash)]
pub enum MorphVolume {
    /// Axis-aligned boxes.
    #[default]
    Aabb,
    /// Boxes with cut corners.
    Kdop14,
    /// Boxes with cut edges.
    Kdop18,
    /// Boxes with cut corners and edges.
    Kdop26,
    /// Spheres.
    Sphere,
}

impl Default for MorphTreeSettings {
    fn default() -> Self {
        let BuildOptions {
            arity,
            leaf_size,
            in_betweens,
            compact,
            ..
        } = BuildOptions::default();
        Self {
            volume: MorphVolume::default(),
            arity: arity as u8,
            leaf_size: leaf_size as u8,
            in_betweens,
            compact,
        }
    }
}

impl MorphTreeSettings {
    /// These over options for all.
    pub(crate) fn over(&self, options: &BuildOptions) -> BuildOptions {
        let volume = match self.volume {
            MorphVolume::Aabb => VolumeKind::Aabb,
            MorphVolume::Kdop14 => VolumeKind::Kdop14,
            MorphVolume::Kdop18 => VolumeKind::Kdop18,
            MorphVolume::Kdop26 => VolumeKind::Kdop26,
            MorphVolume::Sphere => VolumeKind::Sphere,
        };
        options
            .clone()
            .with_volume(volume)
            .with_arity(self.arity.into())
            .with_leaf_size(self.leaf_size.into())
            .with_in_betweens(self.in_betweens)
            .with_compact(self.compact)
    }
}
