//! This plugin, and what a game can do without it to make a morphing mesh collide in Rapier.

use std::borrow::Cow;
use std::path::Path;

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_rapier3d::plugin::context::RapierContextColliders;
use bevy_rapier3d::prelude::*;
use morph_collision_testkit::mesh::MorphMesh;

use super::behaviour::{Engine, PoseSurface};
use super::drops::Kind;
use super::{app_with_steps, bevy_mesh, body, state};

/// A way to make a morphing mesh collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// [`MorphRapierCollider`].
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
}

impl Method {
    /// All methods, ours first.
    pub const ALL: [Self; 7] = [
        Self::Ours,
        Self::InPlace,
        Self::Deformable,
        Self::Smooth,
        Self::Component,
        Self::NewMesh,
        Self::SoftBody,
    ];

    /// The name used in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ours => "`MorphRapierCollider`",
            Self::InPlace => "`set_vertices` in place",
            Self::Deformable => "the same, `DEFORMABLE`",
            Self::Smooth => "the same, `DEFORMABLE` and `FIX_INTERNAL_EDGES_TWO_SIDED`",
            Self::Component => "`set_vertices` on the component",
            Self::NewMesh => "new `TriMesh`",
            Self::SoftBody => "pinned soft body",
        }
    }
}

impl Engine for Method {
    fn app(&self, unit: f32, dt: f32) -> App {
        app_with_steps(Path::new("."), unit, dt, |_: &mut App| {})
    }

    fn surface<'a>(&self, app: &mut App, mesh: &'a MorphMesh) -> PoseSurface<'a> {
        let mut surface = Surface::spawn(app, *self, mesh, Vec3::ZERO, &mut None);
        Box::new(move |app, weights| surface.pose(app, weights))
    }

    fn body(&self, app: &mut App, kind: Kind, half: f32, at: Vec3) -> Entity {
        let collider = match kind {
            Kind::Ball => Collider::ball(half),
            _ => Collider::cuboid(half, half, half),
        };
        body(app, collider, at)
    }

    fn make_slippery(&self, app: &mut App, body: Entity) {
        let friction = Friction {
            coefficient: 0.0,
            combine_rule: CoefficientCombineRule::Min,
        };
        app.world_mut().entity_mut(body).insert(friction);
    }

    fn push(&self, app: &mut App, body: Entity, velocity: Vec3) {
        app.world_mut().entity_mut(body).insert(Velocity::linear(velocity));
    }

    fn set_ccd(&self, app: &mut App, body: Entity, on: bool) {
        app.world_mut().entity_mut(body).insert(Ccd { enabled: on });
    }

    fn state(&self, app: &App, body: Entity) -> (Vec3, Vec3) {
        state(app, body)
    }
}

/// A plain mesh on a kinematic body, which follows the first weight: what Rapier does for a surface that only moves.
#[derive(Clone, Copy, Debug)]
pub struct Kinematic;

impl Engine for Kinematic {
    fn app(&self, unit: f32, dt: f32) -> App {
        Engine::app(&Method::NewMesh, unit, dt)
    }

    fn surface<'a>(&self, app: &mut App, mesh: &'a MorphMesh) -> PoseSurface<'a> {
        let collider = Collider::trimesh(mesh.positions.clone(), mesh.triangles.clone());
        let body = (
            RigidBody::KinematicPositionBased,
            Sleeping::disabled(),
            Transform::default(),
        );
        let mut entity = app.world_mut().spawn(body);
        if let Ok(collider) = collider {
            entity.insert(collider);
        }
        let (entity, way) = (entity.id(), mesh.targets[0][0]);
        Box::new(move |app, weights| {
            if let Some(mut place) = app.world_mut().get_mut::<Transform>(entity) {
                place.translation = way * weights[0];
            }
        })
    }

    fn body(&self, app: &mut App, kind: Kind, half: f32, at: Vec3) -> Entity {
        Engine::body(&Method::NewMesh, app, kind, half, at)
    }

    fn make_slippery(&self, app: &mut App, body: Entity) {
        Method::NewMesh.make_slippery(app, body);
    }

    fn push(&self, app: &mut App, body: Entity, velocity: Vec3) {
        Method::NewMesh.push(app, body, velocity);
    }

    fn set_ccd(&self, app: &mut App, body: Entity, on: bool) {
        Method::NewMesh.set_ccd(app, body, on);
    }

    fn state(&self, app: &App, body: Entity) -> (Vec3, Vec3) {
        Engine::state(&Method::NewMesh, app, body)
    }
}

/// The particle radius of a soft body.
const SKIN: f32 = 0.01;

/// A morphing mesh that takes part in physics.
#[derive(Debug)]
pub struct Surface<'a> {
    method: Method,
    entity: Entity,
    mesh: Cow<'a, MorphMesh>,
    at: Vec3,
    blended: Vec<Vec3>,
}

impl<'a> Surface<'a> {
    /// Spawns a mesh at rest. With [`Method::Ours`], several surfaces may share what a game would share: the mesh asset.
    pub fn spawn(
        app: &mut App,
        method: Method,
        mesh: &'a MorphMesh,
        at: Vec3,
        shared: &mut Option<Handle<Mesh>>,
    ) -> Self {
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
                    MorphRapierCollider::default(),
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
    pub fn pose(&mut self, app: &mut App, weights: &[f32]) {
        if self.method != Method::Ours {
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

/// Blends every vertex, one target after the other, as fast as plain loops can.
pub fn blend(mesh: &MorphMesh, weights: &[f32], into: &mut Vec<Vec3>) {
    into.clone_from(&mesh.positions);
    for (target, &weight) in mesh.targets.iter().zip(weights) {
        if weight != 0.0 {
            for (vertex, &displacement) in into.iter_mut().zip(target) {
                *vertex += weight * displacement;
            }
        }
    }
}
