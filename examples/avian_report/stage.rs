//! Rigid bodies of Avian on morphing surfaces: with this plugin, and with what a game can do by itself.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::physics::drops::{Drop, Kind};
use morph_collision_workspace::physics::{DT, bevy_mesh, blend};

/// An app with Avian in steps of [`DT`], one for each frame, ready for its first.
pub(crate) fn app(assets: &Path) -> App {
    let mut app = morph_collision_workspace::app::headless(assets);
    let step = Duration::from_secs_f32(DT);
    app.add_plugins((PhysicsPlugins::default(), MorphAvianPlugin::default()))
        .insert_resource(Time::<Fixed>::from_duration(step))
        .insert_resource(TimeUpdateStrategy::ManualDuration(step));
    morph_collision_workspace::app::ready(&mut app);
    app
}

/// A way to make a morphing mesh collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// [`MorphAvianCollider`].
    Ours,
    /// Every vertex blended, a new `Collider::trimesh` each time, on a static body.
    NewMesh,
}

impl Method {
    /// All of them, ours first.
    pub(crate) const ALL: [Self; 2] = [Self::Ours, Self::NewMesh];

    /// How tables call it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ours => "`MorphAvianCollider`",
            Self::NewMesh => "new `Collider::trimesh`",
        }
    }
}

/// A morphing mesh in physics.
#[derive(Debug)]
pub(crate) struct Surface<'a> {
    method: Method,
    entity: Entity,
    mesh: &'a MorphMesh,
    blended: Vec<Vec3>,
}

impl<'a> Surface<'a> {
    /// A mesh at rest somewhere. Of this plugin's, several may share what is shared in a game: the mesh asset.
    pub(crate) fn spawn(
        app: &mut App,
        method: Method,
        mesh: &'a MorphMesh,
        at: Vec3,
        shared: &mut Option<Handle<Mesh>>,
    ) -> Self {
        let world = app.world_mut();
        let place = Transform::from_translation(at);
        let entity = match method {
            Method::Ours => {
                let asset = shared.get_or_insert_with(|| world.resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh)));
                let weights = vec![0.0; mesh.targets.len()];
                let weights = MeshMorphWeights::Value { weights };
                world
                    .spawn((Mesh3d(asset.clone()), weights, MorphAvianCollider::default(), place))
                    .id()
            }
            Method::NewMesh => {
                let collider = Collider::trimesh(mesh.positions.clone(), mesh.triangles.clone());
                world.spawn((RigidBody::Static, collider, place)).id()
            }
        };
        Self {
            method,
            entity,
            mesh,
            blended: Vec::new(),
        }
    }

    /// Gives it other weights.
    pub(crate) fn pose(&mut self, app: &mut App, weights: &[f32]) {
        let mut surface = app.world_mut().entity_mut(self.entity);
        match self.method {
            Method::Ours => {
                let weights = weights.to_vec();
                surface.insert(MeshMorphWeights::Value { weights });
            }
            Method::NewMesh => {
                blend(self.mesh, weights, &mut self.blended);
                surface.insert(Collider::trimesh(self.blended.clone(), self.mesh.triangles.clone()));
            }
        }
    }
}

/// A dynamic body that falls as told.
pub(crate) fn drop_body(app: &mut App, drop: &Drop) -> Entity {
    let size = drop.size;
    let collider = match drop.kind {
        Kind::Ball => Collider::sphere(size),
        Kind::Cuboid => Collider::cuboid(2.0 * size, 1.4 * size, size),
        // Avian's is as long as its segment.
        Kind::Capsule => Collider::capsule(0.5 * size, 2.0 * size),
    };
    let body = body(app, collider, drop.at);
    // They meet the surface alone.
    let layers = CollisionLayers::new(LayerMask(0b10), LayerMask::ALL ^ LayerMask(0b10));
    let velocity = (LinearVelocity(drop.linear), AngularVelocity(drop.angular));
    app.world_mut().entity_mut(body).insert((velocity, layers));
    body
}

/// A dynamic body.
pub(crate) fn body(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let body = (RigidBody::Dynamic, collider, Transform::from_translation(at));
    app.world_mut().spawn(body).id()
}

/// A cuboid that slides at 3/s and that nothing slows down.
pub(crate) fn glide(app: &mut App, body: Entity) {
    let slippery = Friction::new(0.0).with_combine_rule(CoefficientCombine::Min);
    let pushed = (slippery, LinearVelocity(Vec3::X * 3.0));
    app.world_mut().entity_mut(body).insert(pushed);
}

/// A ball of radius 0.5, or a cuboid of half-extent 0.5.
pub(crate) fn half(kind: Kind) -> Collider {
    match kind {
        Kind::Ball => Collider::sphere(0.5),
        _ => Collider::cuboid(1.0, 1.0, 1.0),
    }
}

/// A ball of radius 0.3, or a cuboid of half-extent 0.3.
pub(crate) fn small(kind: Kind) -> Collider {
    match kind {
        Kind::Ball => Collider::sphere(0.3),
        _ => Collider::cuboid(0.6, 0.6, 0.6),
    }
}

/// A floor of 6 by 8 and a height of 1.
pub(crate) fn floor(app: &mut App, at: Vec3) {
    let shape = Collider::cuboid(6.0, 1.0, 8.0);
    app.world_mut()
        .spawn((RigidBody::Static, shape, Transform::from_translation(at)));
}

/// A body that never sleeps.
pub(crate) fn stay_awake(app: &mut App, body: Entity) {
    app.world_mut().entity_mut(body).insert(SleepingDisabled);
}

/// Where a body is, and how fast.
pub(crate) fn state(app: &App, body: Entity) -> (Vec3, Vec3) {
    let body = app.world().entity(body);
    (
        body.get::<Position>().map(|place| place.0).unwrap_or_default(),
        body.get::<LinearVelocity>()
            .map(|velocity| velocity.0)
            .unwrap_or_default(),
    )
}
