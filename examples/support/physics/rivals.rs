//! This plugin, and what a game can do without it to make a morphing mesh collide in Rapier.

use std::borrow::Cow;
use std::path::Path;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::plugin::context::RapierContextColliders;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use super::drops::Kind;
use super::engine::{Engine, PoseSurface};
use super::{app_with_steps, bevy_mesh, blend, body, state};

/// A way to make a morphing mesh collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`MorphPhysicsCollider`].
    Ours,
    /// Blends every vertex and calls `set_vertices` on Rapier's own copy of a `TriMesh`, in place. Parry may reuse old contacts.
    InPlace,
    /// The same with [`TriMeshFlags::DEFORMABLE`]: contacts are recomputed.
    Deformable,
    /// The same with [`TriMeshFlags::FIX_INTERNAL_EDGES_TWO_SIDED`] as well: bodies do not catch on edges inside the surface, as
    /// with this plugin.
    Smooth,
    /// Blends every vertex and calls `set_vertices` on the `Collider` component, which copies the mesh.
    Component,
    /// Blends every vertex and makes a new `TriMesh` each time.
    NewMesh,
    /// A soft body with all particles pinned and moved to the blended vertices.
    SoftBody,
    /// A plain mesh on a kinematic body, which follows the first weight: what Rapier does for a surface that only moves.
    Kinematic,
}

impl Method {
    /// All methods for surfaces that morph, ours first.
    pub const ALL: [Self; 7] = [
        Self::Ours,
        Self::InPlace,
        Self::Deformable,
        Self::Smooth,
        Self::Component,
        Self::NewMesh,
        Self::SoftBody,
    ];
}

impl Engine for Method {
    fn name(&self) -> &'static str {
        match self {
            Self::Ours => "`MorphPhysicsCollider`",
            Self::InPlace => "`set_vertices` in place",
            Self::Deformable => "the same, `DEFORMABLE`",
            Self::Smooth => "the same, `DEFORMABLE` and `FIX_INTERNAL_EDGES_TWO_SIDED`",
            Self::Component => "`set_vertices` on the component",
            Self::NewMesh => "new `TriMesh`",
            Self::SoftBody => "pinned soft body",
            Self::Kinematic => "`TriMesh` on a kinematic body",
        }
    }

    fn app(&self, unit: f32, dt: f32) -> App {
        app_with_steps(Path::new("."), unit, dt, |_: &mut App| {})
    }

    fn surface<'a>(
        &self,
        app: &mut App,
        mesh: &'a MorphMesh,
        at: Vec3,
        shared: &mut Option<Handle<Mesh>>,
    ) -> PoseSurface<'a> {
        let mut surface = Surface::spawn(app, *self, mesh, at, shared);
        Box::new(move |app, weights| surface.pose(app, weights))
    }

    fn body(&self, app: &mut App, kind: Kind, half: Vec3, at: Vec3) -> Entity {
        let collider = match kind {
            Kind::Ball => Collider::ball(half.x),
            Kind::Cuboid => Collider::cuboid(half.x, half.y, half.z),
            Kind::Capsule => Collider::capsule_y(half.x, half.y),
        };
        body(app, collider, at)
    }

    fn floor(&self, app: &mut App, half: Vec3, at: Vec3) {
        let collider = Collider::cuboid(half.x, half.y, half.z);
        app.world_mut().spawn((collider, Transform::from_translation(at)));
    }

    fn make_slippery(&self, app: &mut App, body: Entity) {
        let friction = Friction {
            coefficient: 0.0,
            combine_rule: CoefficientCombineRule::Min,
        };
        app.world_mut().entity_mut(body).insert(friction);
    }

    fn collide_only_with_surface(&self, app: &mut App, body: Entity) {
        let groups = CollisionGroups::new(Group::GROUP_1, Group::ALL ^ Group::GROUP_1);
        app.world_mut().entity_mut(body).insert(groups);
    }

    fn stay_awake(&self, app: &mut App, body: Entity) {
        app.world_mut().entity_mut(body).insert(Sleeping::disabled());
    }

    fn push(&self, app: &mut App, body: Entity, linear: Vec3, angular: Vec3) {
        app.world_mut().entity_mut(body).insert(Velocity { linear, angular });
    }

    fn set_ccd(&self, app: &mut App, body: Entity, on: bool) {
        app.world_mut().entity_mut(body).insert(Ccd { enabled: on });
    }

    fn state(&self, app: &App, body: Entity) -> (Vec3, Vec3) {
        state(app, body)
    }
}

/// The particle radius of a soft body.
const SKIN: f32 = 0.01;

/// A morphing mesh that takes part in physics.
#[derive(Debug)]
struct Surface<'a> {
    method: Method,
    entity: Entity,
    mesh: Cow<'a, MorphMesh>,
    at: Vec3,
    blended: Vec<Vec3>,
}

impl<'a> Surface<'a> {
    /// Spawns a mesh at rest.
    fn spawn(app: &mut App, method: Method, mesh: &'a MorphMesh, at: Vec3, shared: &mut Option<Handle<Mesh>>) -> Self {
        let place = Transform::from_translation(at);
        let world = app.world_mut();
        let mesh = match method {
            Method::Smooth => Cow::Owned(in_order_of_triangles(mesh)),
            _ => Cow::Borrowed(mesh),
        };
        let entity = match method {
            Method::Ours => {
                let asset = shared.get_or_insert_with(|| world.resource_mut::<Assets<Mesh>>().add(bevy_mesh(&mesh)));
                let weights = vec![0.0; mesh.targets.len()];
                world.spawn((
                    Mesh3d(asset.clone()),
                    MeshMorphWeights::Value { weights },
                    MorphPhysicsCollider::default(),
                    place,
                ))
            }
            Method::SoftBody => {
                let all = (0..mesh.positions.len() as u32).collect();
                let body = SoftBody::trimesh(mesh.positions.clone(), mesh.triangles.clone());
                // A mesh with triangles always has one.
                let body = body.map(|body| body.map(|builder| builder.oriented(false).particle_radius(SKIN)));
                let mut entity = world.spawn((place, SoftBodyPinnedParticles(all)));
                if let Some(body) = body {
                    entity.insert(body);
                }
                entity
            }
            _ => {
                let flags = match method {
                    Method::Deformable => TriMeshFlags::DEFORMABLE,
                    Method::Smooth => TriMeshFlags::DEFORMABLE | TriMeshFlags::FIX_INTERNAL_EDGES_TWO_SIDED,
                    _ => TriMeshFlags::default(),
                };
                let (positions, triangles) = (mesh.positions.clone(), mesh.triangles.clone());
                let collider = Collider::trimesh_with_flags(positions, triangles, flags);
                let mut entity = world.spawn(place);
                if let Ok(collider) = collider {
                    entity.insert(collider);
                }
                if method == Method::Kinematic {
                    entity.insert((RigidBody::KinematicPositionBased, Sleeping::disabled()));
                }
                entity
            }
        }
        .id();
        Self {
            method,
            entity,
            mesh,
            at,
            blended: Vec::new(),
        }
    }

    /// Sets new weights.
    fn pose(&mut self, app: &mut App, weights: &[f32]) {
        if !matches!(self.method, Method::Ours | Method::Kinematic) {
            blend(&self.mesh, weights, &mut self.blended);
        }
        let world = app.world_mut();
        match self.method {
            Method::Ours => {
                if let Some(mut to) = world.get_mut::<MeshMorphWeights>(self.entity) {
                    let weights = weights.to_vec();
                    *to = MeshMorphWeights::Value { weights };
                }
            }
            Method::InPlace | Method::Deformable | Method::Smooth => {
                let mut contexts = world.query::<&mut RapierContextColliders>();
                let Ok(mut context) = contexts.single_mut(world) else {
                    return;
                };
                let handle = context.entity2collider().get(&self.entity).copied();
                let collider = handle.and_then(|handle| context.colliders.get_mut(handle));
                if let Some(mesh) = collider.and_then(|collider| collider.shape_mut().as_trimesh_mut()) {
                    mesh.set_vertices(&self.blended);
                }
            }
            Method::Component => {
                if let Some(mut collider) = world.get_mut::<Collider>(self.entity)
                    && let Some(mesh) = collider.as_trimesh_mut()
                {
                    mesh.raw.set_vertices(&self.blended);
                }
            }
            Method::NewMesh => {
                if let Ok(collider) = Collider::trimesh(self.blended.clone(), self.mesh.triangles.clone()) {
                    world.entity_mut(self.entity).insert(collider);
                }
            }
            Method::SoftBody => {
                let targets = self.blended.iter().zip(0..);
                let targets = targets
                    .map(|(&vertex, particle)| (particle, vertex + self.at))
                    .collect();
                world.entity_mut(self.entity).insert(SoftBodyKinematicTargets(targets));
            }
            Method::Kinematic => {
                if let Some(mut place) = world.get_mut::<Transform>(self.entity) {
                    place.translation = self.at + self.mesh.targets[0][0] * weights[0];
                }
            }
        }
    }
}

/// A mesh with its vertices in the order in which triangles name them. Parry keeps this order for meshes whose internal edges it
/// fixes.
fn in_order_of_triangles(mesh: &MorphMesh) -> MorphMesh {
    let mut places = vec![u32::MAX; mesh.positions.len()];
    let mut order = Vec::new();
    for &vertex in mesh.triangles.as_flattened() {
        let place = &mut places[vertex as usize];
        if *place == u32::MAX {
            *place = order.len() as u32;
            order.push(vertex);
        }
    }
    let ordered = |all: &Vec<Vec3>| {
        order
            .iter()
            .filter_map(|&vertex| all.get(vertex as usize).copied())
            .collect()
    };
    let corners = |corners: &[u32; 3]| corners.map(|vertex| places[vertex as usize]);
    MorphMesh {
        positions: ordered(&mesh.positions),
        targets: mesh.targets.iter().map(ordered).collect(),
        triangles: mesh.triangles.iter().map(corners).collect(),
        ..mesh.clone()
    }
}
