//! Meshes whose vertices are all blended when the weights change. Every rival starts a frame with this.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision::{InputError, JointMatrices, ModelError, MorphModel, Triangle, WorldFromModel};

use super::PoseError;
use super::skin::{SkinnedBody, WeldedSkin};
use morph_collision_models::mesh::MorphMesh;

/// A welded mesh in a form that is fast to blend as a whole: target by target, each with the vertices that
/// it moves.
#[derive(Debug)]
pub(super) struct WeldedMesh {
    pub(super) base: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    targets: Vec<Target>,
    skin: Option<WeldedSkin>,
    model: MorphModel,
}

#[derive(Debug)]
struct Target {
    /// The vertices it moves, ascending; `None` if it moves all of them.
    vertices: Option<Vec<u32>>,
    deltas: Vec<Vec3>,
}

impl WeldedMesh {
    /// # Errors
    /// See [`MorphMesh::to_model`].
    pub(super) fn new(mesh: &MorphMesh) -> Result<Self, ModelError> {
        let model = mesh.to_model()?;
        let mut sources = vec![None; model.vertex_count()];
        for (source, &welded) in model.welded_from_source().iter().enumerate() {
            sources[welded as usize].get_or_insert(source);
        }
        let sources: Vec<usize> = sources.into_iter().flatten().collect();
        let base: Vec<Vec3> = sources.iter().map(|&source| mesh.positions[source]).collect();
        let displacement = |of: &[Vec3], source: usize| of.get(source).copied().unwrap_or_default();
        let target = |of: &Vec<Vec3>| Target::new(sources.iter().map(|&source| displacement(of, source)));
        Ok(Self {
            triangles: (0..).map_while(|triangle| model.triangle(triangle)).collect(),
            targets: mesh.targets.iter().map(target).collect(),
            skin: mesh.skin.as_ref().map(|skin| WeldedSkin::new(skin, &sources)),
            base,
            model,
        })
    }

    pub(super) fn joint_count(&self) -> Option<usize> {
        self.skin.as_ref().map(WeldedSkin::joint_count)
    }

    /// The joints of a vertex with their weights. A mesh without a skin counts as moved by a single joint.
    pub(super) fn influences(&self, vertex: u32) -> &[(u16, f32)] {
        self.skin.as_ref().map_or(&[(0, 1.0)], |skin| skin.of(vertex as usize))
    }

    pub(super) fn target_count(&self) -> usize {
        self.targets.len()
    }

    /// The nonzero displacements, target by target: target, vertex and displacement.
    pub(super) fn displacements(&self) -> impl Iterator<Item = (u32, u32, Vec3)> {
        (0..).zip(&self.targets).flat_map(|(index, target)| {
            let deltas = target.deltas.iter().enumerate();
            deltas.map(move |(i, &delta)| {
                let vertex = target.vertices.as_ref().map_or(i as u32, |vertices| vertices[i]);
                (index, vertex, delta)
            })
        })
    }

    /// Every vertex in model space: `f32`, ascending target order, zero weights skipped, multiply then add.
    pub(super) fn blend(&self, weights: &[f32], posed: &mut [Vec3]) {
        posed.copy_from_slice(&self.base);
        for (target, &weight) in self.targets.iter().zip(weights) {
            if weight == 0.0 {
                continue;
            }
            match &target.vertices {
                None => {
                    for (vertex, &delta) in posed.iter_mut().zip(&target.deltas) {
                        *vertex += delta * weight;
                    }
                }
                Some(moved) => {
                    for (&vertex, &delta) in moved.iter().zip(&target.deltas) {
                        posed[vertex as usize] += delta * weight;
                    }
                }
            }
        }
    }
}

impl Target {
    fn new(displacements: impl Iterator<Item = Vec3>) -> Self {
        let (mut vertices, mut deltas, mut count) = (Vec::new(), Vec::new(), 0);
        for (vertex, delta) in displacements.enumerate() {
            count += 1;
            if delta != Vec3::ZERO {
                vertices.push(vertex as u32);
                deltas.push(delta);
            }
        }
        Self {
            vertices: (deltas.len() < count).then_some(vertices),
            deltas,
        }
    }
}

/// The part of a body's state that all rivals share.
#[derive(Clone, Debug)]
pub(super) struct BlendedBody {
    pub(super) mesh: Arc<WeldedMesh>,
    weights: Vec<f32>,
    skinned: Option<SkinnedBody>,
    /// The identity for a skinned body, because its vertices are blended into world space.
    pub(super) affine: Affine3A,
    pub(super) world_from_model: WorldFromModel,
}

impl BlendedBody {
    /// A body at rest at the world's origin.
    pub(super) fn new(mesh: Arc<WeldedMesh>) -> Self {
        Self {
            weights: vec![0.0; mesh.targets.len()],
            skinned: mesh.skin.as_ref().map(|skin| SkinnedBody::new(skin, &mesh.base)),
            mesh,
            affine: Affine3A::IDENTITY,
            world_from_model: WorldFromModel::IDENTITY,
        }
    }

    /// Sets the joints of a skinned body.
    pub(super) fn set_joints(&mut self, joints: &[Affine3A]) -> Result<(), PoseError> {
        let skinned = self.skinned.as_mut().ok_or(PoseError::NoJoints)?;
        let (given, expected) = (JointMatrices::new(joints)?.len(), skinned.joint_count());
        if given != expected {
            let what = "joints".to_owned();
            return Err(InputError::WrongCount { what, given, expected }.into());
        }
        skinned.set(joints);
        Ok(())
    }

    /// Sets weights and placement; returns whether the weights or the joints have changed.
    pub(super) fn set(&mut self, weights: &[f32], affine: &Affine3A) -> Result<bool, PoseError> {
        let world_from_model = WorldFromModel::new(*affine)?;
        self.mesh.model.check_weights(weights)?;
        let joints_changed = self.skinned.as_ref().map(|skinned| skinned.changed);
        if joints_changed.is_none() {
            (self.affine, self.world_from_model) = (*affine, world_from_model);
        }
        if self.weights == weights {
            return Ok(joints_changed == Some(true));
        }
        self.weights.copy_from_slice(weights);
        Ok(true)
    }

    pub(super) fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Counts vertices as blended that will be blended on demand.
    pub(super) fn skip_blending(&mut self) {
        if let Some(skinned) = &mut self.skinned {
            skinned.changed = false;
        }
    }

    /// The joints of a skinned body.
    pub(super) fn joints(&self) -> Option<&[Affine3A]> {
        self.skinned.as_ref().map(SkinnedBody::joints)
    }

    /// A vertex in world space, from its morphed position.
    #[inline]
    pub(super) fn placed_vertex(&self, vertex: u32, posed: Vec3) -> DVec3 {
        match (&self.skinned, &self.mesh.skin) {
            (Some(skinned), Some(skin)) => skinned.placed(skin, vertex as usize, posed),
            _ => self.world_vertex(posed),
        }
    }

    /// Blends all vertices, and places those of a skinned body in world space.
    pub(super) fn blend(&mut self, posed: &mut [Vec3]) {
        self.mesh.blend(&self.weights, posed);
        if let (Some(skinned), Some(skin)) = (&mut self.skinned, &self.mesh.skin) {
            skinned.place(skin, posed);
        }
    }

    /// A triangle in world space; `posed` are the body's blended vertices.
    #[inline]
    pub(super) fn world_triangle(&self, posed: &[Vec3], triangle: [u32; 3]) -> Triangle {
        match &self.skinned {
            None => triangle.map(|vertex| self.world_vertex(posed[vertex as usize])),
            Some(skinned) => triangle.map(|vertex| skinned.world[vertex as usize]),
        }
    }

    /// All vertices in world space; `posed` are the body's blended vertices.
    pub(super) fn world_vertices<'a>(&'a self, posed: &'a [Vec3]) -> impl Iterator<Item = DVec3> + 'a {
        let placed = self.skinned.as_ref().map(|skinned| skinned.world.as_slice());
        let at = move |vertex: usize| placed.map_or_else(|| self.world_vertex(posed[vertex]), |world| world[vertex]);
        (0..posed.len()).map(at)
    }

    #[inline]
    pub(super) fn world_vertex(&self, posed: Vec3) -> DVec3 {
        self.world_from_model.transform_point(posed)
    }
}
