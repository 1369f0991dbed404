//! Avian's rigid bodies on morphing surfaces: with this plugin, and with what a game can do without it.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_workspace::physics::behaviour::{Engine, PoseSurface};
use morph_collision_workspace::physics::drops::{Drop, Kind};
use morph_collision_workspace::physics::{DT, bevy_mesh, blend};

/// An app with Avian in steps of [`DT`], one per frame, ready for its first frame.
pub(crate) fn app(assets: &Path) -> App {
    app_with_steps(assets, 1.0, DT)
}

/// The same app in a world with another unit of length, and with steps of another length.
fn app_with_steps(assets: &Path, unit: f32, dt: f32) -> App {
    let mut app = morph_collision_workspace::app::headless(assets);
    let step = Duration::from_secs_f32(dt);
    let physics = PhysicsPlugins::default().with_length_unit(unit);
    app.add_plugins((physics, MorphAvianPlugin::default()))
        .insert_resource(Gravity(Vec3::NEG_Y * 9.81 * unit))
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
    /// A static body that gets a new `Collider::trimesh` each time from all blended vertices.
    NewMesh,
}

impl Method {
    /// All methods, ours first.
    pub(crate) const ALL: [Self; 2] = [Self::Ours, Self::NewMesh];

    /// The name used in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ours => "`MorphAvianCollider`",
            Self::NewMesh => "new `Collider::trimesh`",
        }
    }
}

impl Engine for Method {
    fn app(&self, unit: f32, dt: f32) -> App {
        app_with_steps(Path::new("."), unit, dt)
    }

    fn surface<'a>(&self, app: &mut App, mesh: &'a MorphMesh) -> PoseSurface<'a> {
        let mut surface = Surface::spawn(app, *self, mesh, Vec3::ZERO, &mut None);
        Box::new(move |app, weights| surface.pose(app, weights))
    }

    fn body(&self, app: &mut App, kind: Kind, half: f32, at: Vec3) -> Entity {
        let collider = match kind {
            Kind::Ball => Collider::sphere(half),
            _ => Collider::cuboid(2.0 * half, 2.0 * half, 2.0 * half),
        };
        body(app, collider, at)
    }

    fn make_slippery(&self, app: &mut App, body: Entity) {
        let slippery = Friction::new(0.0).with_combine_rule(CoefficientCombine::Min);
        app.world_mut().entity_mut(body).insert(slippery);
    }

    fn push(&self, app: &mut App, body: Entity, velocity: Vec3) {
        app.world_mut().entity_mut(body).insert(LinearVelocity(velocity));
    }

    fn set_ccd(&self, app: &mut App, body: Entity, on: bool) {
        let filter = if on { CcdFilter::DEFAULT } else { CcdFilter::NONE };
        let swept = SweptCcd::default().with_filter(filter);
        app.world_mut().entity_mut(body).insert(swept);
    }

    fn state(&self, app: &App, body: Entity) -> (Vec3, Vec3) {
        state(app, body)
    }
}

/// A plain mesh on a kinematic body, which follows the first weight: what Avian does for a surface that only moves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kinematic;

impl Engine for Kinematic {
    fn app(&self, unit: f32, dt: f32) -> App {
        Engine::app(&Method::NewMesh, unit, dt)
    }

    fn surface<'a>(&self, app: &mut App, mesh: &'a MorphMesh) -> PoseSurface<'a> {
        let collider = Collider::trimesh(mesh.positions.clone(), mesh.triangles.clone());
        let body = (RigidBody::Kinematic, SleepingDisabled, collider, Transform::default());
        let (entity, way) = (app.world_mut().spawn(body).id(), mesh.targets[0][0]);
        Box::new(move |app, weights| {
            let dt = app.world().resource::<Time<Fixed>>().timestep().as_secs_f32();
            let place = app.world().get::<Position>(entity).map(|place| place.0);
            let velocity = (way * weights[0] - place.unwrap_or_default()) / dt;
            app.world_mut().entity_mut(entity).insert(LinearVelocity(velocity));
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

/// A morphing mesh that takes part in physics.
#[derive(Debug)]
pub(crate) struct Surface<'a> {
    method: Method,
    entity: Entity,
    mesh: &'a MorphMesh,
    blended: Vec<Vec3>,
}

impl<'a> Surface<'a> {
    /// Spawns a mesh at rest. With this plugin, surfaces may share what a game would share: the mesh asset.
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

    /// Sets new weights.
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

/// Spawns a dynamic body that falls as `drop` says.
pub(crate) fn drop_body(app: &mut App, drop: &Drop) -> Entity {
    let size = drop.size;
    let collider = match drop.kind {
        Kind::Ball => Collider::sphere(size),
        Kind::Cuboid => Collider::cuboid(2.0 * size, 1.4 * size, size),
        // Avian's length of a capsule is that of its segment.
        Kind::Capsule => Collider::capsule(0.5 * size, 2.0 * size),
    };
    let body = body(app, collider, drop.at);
    // They collide only with the surface.
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

/// A ball of radius 0.3, or a cuboid of half-extent 0.3.
pub(crate) fn small(kind: Kind) -> Collider {
    match kind {
        Kind::Ball => Collider::sphere(0.3),
        _ => Collider::cuboid(0.6, 0.6, 0.6),
    }
}

/// A floor of 6 by 8 with a height of 1.
pub(crate) fn floor(app: &mut App, at: Vec3) {
    let shape = Collider::cuboid(6.0, 1.0, 8.0);
    app.world_mut()
        .spawn((RigidBody::Static, shape, Transform::from_translation(at)));
}

/// Keeps a body from sleeping.
pub(crate) fn stay_awake(app: &mut App, body: Entity) {
    app.world_mut().entity_mut(body).insert(SleepingDisabled);
}

/// A body's position and velocity.
pub(crate) fn state(app: &App, body: Entity) -> (Vec3, Vec3) {
    let body = app.world().entity(body);
    (
        body.get::<Position>().map(|place| place.0).unwrap_or_default(),
        body.get::<LinearVelocity>()
            .map(|velocity| velocity.0)
            .unwrap_or_default(),
    )
}
