//! Attributes of a mesh at a point of its surface.

use bevy::ecs::system::SystemParam;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use crate::import::{MorphTrees, influences_of, uv_of};
use crate::state::ColliderState;

/// The meshes that colliders show.
#[derive(SystemParam)]
pub(crate) struct Surfaces<'w, 's> {
    shown: Query<'w, 's, (&'static Mesh3d, Option<&'static SkinnedMesh>)>,
    meshes: Option<Res<'w, Assets<Mesh>>>,
    trees: Option<Res<'w, MorphTrees>>,
}

impl Surfaces<'_, '_> {
    /// A collider's mesh, its skeleton, and the vertices of one of its triangles, as numbered in the mesh.
    fn triangle(
        &self,
        entity: Entity,
        state: &ColliderState,
        triangle: u32,
    ) -> Option<(&Mesh, Option<&SkinnedMesh>, [usize; 3])> {
        let (mesh, skin) = self.shown.get(entity).ok()?;
        let mesh = self.meshes.as_ref()?.get(mesh)?;
        let bvh = state.pose.as_ref()?.lock().bvh().clone();
        let corners = self.trees.as_ref()?.corners(state.tree?, &bvh, triangle)?;
        Some((mesh, skin, corners.map(|corner| corner as usize)))
    }

    /// The texture coordinates at a point of a triangle.
    pub(super) fn uv(&self, entity: Entity, state: &ColliderState, triangle: u32, barycentrics: Vec3) -> Option<Vec2> {
        let (mesh, _, corners) = self.triangle(entity, state, triangle)?;
        let mut uv = Vec2::ZERO;
        for (corner, weight) in corners.into_iter().zip(barycentrics.to_array()) {
            uv += uv_of(mesh, corner)? * weight;
        }
        Some(uv)
    }

    /// The joint with the largest weight at a point of a triangle.
    pub(super) fn joint(
        &self,
        entity: Entity,
        state: &ColliderState,
        triangle: u32,
        barycentrics: Vec3,
    ) -> Option<Entity> {
        // Without a skinned pose, the mesh's joint attributes have no effect.
        state.pose.as_ref()?.lock().joints()?;
        let (mesh, skin, corners) = self.triangle(entity, state, triangle)?;
        let mut shares: Vec<(u16, f32)> = Vec::new();
        for (corner, share) in corners.into_iter().zip(barycentrics.to_array()) {
            for (joint, weight) in influences_of(mesh, corner)? {
                match shares.iter_mut().find(|(known, _)| *known == joint) {
                    Some((_, sum)) => *sum += share * weight,
                    None => shares.push((joint, share * weight)),
                }
            }
        }
        shares.retain(|&(_, weight)| weight > 0.0);
        shares.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let &(joint, _) = shares.first()?;
        skin?.joints.get(usize::from(joint)).copied()
    }
}
