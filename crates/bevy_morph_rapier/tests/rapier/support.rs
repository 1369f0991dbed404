//! An app with physics, morphing meshes in it, and their true shapes.

use std::path::Path;

use bevy::ecs::message::MessageCursor;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_rapier3d::parry::shape::TriMesh;
use bevy_rapier3d::plugin::context::{RapierContextColliders, RapierRigidBodySet};
use bevy_rapier3d::prelude::*;
pub(crate) use bevy_rapier3d::prelude::{
    Collider, ColliderDisabled, CollidingEntities, Friction, GravityScale, LockedAxes, Sensor,
};
use morph_collision_models::generated::rigid::box_mesh;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};
use morph_collision_workspace::physics::{self, state};
pub(crate) use morph_collision_workspace::physics::{Method, body};

pub(crate) use crate::any_engine::common::*;
use crate::log::run_here;
pub(crate) use crate::schedules::{MORE_BROKEN, MORE_SETUPS};

pub(crate) fn app() -> App {
    let mut app = physics::app(Path::new("../.."));
    run_here(&mut app);
    app
}

pub(crate) fn ball(radius: f32) -> Collider {
    Collider::ball(radius)
}

/// A box with these half-extents.
pub(crate) fn cuboid(half: Vec3) -> Collider {
    Collider::cuboid(half.x, half.y, half.z)
}

pub(crate) fn trimesh(positions: &[Vec3], triangles: &[[u32; 3]]) -> Collider {
    Collider::trimesh(positions.to_vec(), triangles.to_vec()).expect("it has triangles")
}

/// Shapes that are 0.4 wide.
pub(crate) fn shapes() -> [Collider; 5] {
    let corners: Vec<Vec3> = box_mesh(Vec3::splat(0.2)).positions;
    [
        Collider::ball(0.2),
        Collider::cuboid(0.2, 0.2, 0.2),
        Collider::capsule_y(0.1, 0.1),
        Collider::convex_hull(&corners).unwrap(),
        Collider::compound(vec![(Vec3::ZERO, Quat::IDENTITY, Collider::cuboid(0.2, 0.2, 0.2))]),
    ]
}

/// The speed at which Rapier pushes bodies apart.
pub(crate) const DRIVEN: f32 = 3.0;

/// The plugin for Rapier under a name that tests of every engine use.
pub(crate) use bevy_morph_rapier::MorphRapierPlugin as OurPlugin;
/// The names of the plugins.
pub(crate) const OUR_PLUGIN: &str = "MorphRapierPlugin";
pub(crate) const ENGINE_PLUGIN: &str = "RapierPhysicsPlugin";

/// Rapier in its usual schedule.
pub(crate) fn engine() -> RapierPhysicsPlugin<NoUserData> {
    RapierPhysicsPlugin::default()
}

/// Rapier in this schedule.
pub(crate) fn engine_in(schedule: impl ScheduleLabel) -> RapierPhysicsPlugin<NoUserData> {
    engine().in_schedule(schedule)
}

/// What makes a collider fixed.
pub(crate) fn fixed() -> impl Bundle {
    Transform::default()
}

pub(crate) const DYNAMIC: RigidBody = RigidBody::Dynamic;
pub(crate) const FIXED: RigidBody = RigidBody::Fixed;

/// Makes masses readable.
pub(crate) fn weighed() -> impl Bundle {
    (ReadColliderMassProperties::default(), ReadMassProperties::default())
}

pub(crate) fn mass_of_collider(app: &App, entity: Entity) -> f32 {
    app.world().get::<ReadColliderMassProperties>(entity).unwrap().mass
}

pub(crate) fn mass_of_body(app: &App, entity: Entity) -> f32 {
    app.world().get::<ReadMassProperties>(entity).unwrap().mass
}

/// Whether the collider of an entity is in Rapier.
pub(crate) fn is_attached(app: &App, entity: Entity) -> bool {
    app.world().get::<RapierColliderHandle>(entity).is_some()
}

/// The velocity of a body.
pub(crate) fn flying(velocity: Vec3) -> impl Bundle {
    Velocity::linear(velocity)
}

/// What makes Rapier report the contacts of an entity.
pub(crate) fn listening() -> impl Bundle {
    (ActiveEvents::COLLISION_EVENTS, CollidingEntities::default())
}

pub(crate) fn colliding(app: &App, entity: Entity) -> Vec<Entity> {
    app.world().get::<CollidingEntities>(entity).unwrap().iter().collect()
}

pub(crate) fn is_asleep(app: &App, entity: Entity) -> bool {
    app.world().get::<Sleeping>(entity).is_some_and(|it| it.sleeping)
}

/// Waits until a body sleeps.
pub(crate) fn fall_asleep(app: &mut App, body: Entity) {
    app.world_mut().entity_mut(body).insert(Sleeping::default());
    run(app, 300);
    assert!(is_asleep(app, body));
}

pub(crate) fn place(app: &App, entity: Entity) -> Vec3 {
    state(app, entity).0
}

pub(crate) fn velocity(app: &App, entity: Entity) -> Vec3 {
    state(app, entity).1
}

/// The number of all colliders in Rapier, and of the bodies that are parts.
pub(crate) fn population(app: &mut App) -> (usize, usize) {
    let world = app.world_mut();
    let mut contexts = world.query::<(&RapierRigidBodySet, &RapierContextColliders)>();
    let (bodies, colliders) = contexts.single(world).expect("there is one context");
    let (bodies, colliders) = (bodies.bodies.len(), colliders.colliders.len());
    let of_the_game = world.query::<&RapierRigidBodyHandle>().iter(world).count();
    (colliders, bodies - of_the_game)
}

/// Runs a system once that queries Rapier.
pub(crate) fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&RapierContext) -> T + Send + Sync + 'static) -> T {
    let system = move |context: ReadRapierContext| ask(&context.single().expect("there is one context"));
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

/// A mesh at its place in the world, as Parry's own mesh.
pub(crate) fn truth(mesh: &MorphMesh, weights: &[f32], place: &GlobalTransform) -> TriMesh {
    let posed = posed_vertices(&mesh.positions, &mesh.targets, weights);
    let world = world_vertices(&posed, &place.affine());
    let world = world.into_iter().map(DVec3::as_vec3).collect();
    TriMesh::new(world, mesh.triangles.clone()).expect("a mesh with triangles")
}

pub(crate) fn global(app: &App, entity: Entity) -> GlobalTransform {
    *app.world().entity(entity).get::<GlobalTransform>().unwrap()
}

/// Runs frames and collects the events.
#[derive(Default)]
pub(crate) struct Log {
    cursor: MessageCursor<CollisionEvent>,
    pub(crate) started: Vec<(Entity, Entity)>,
    pub(crate) ended: Vec<(Entity, Entity)>,
}

impl Log {
    pub(crate) fn from_now(app: &App) -> Self {
        let mut log = Self::default();
        log.cursor.clear(app.world().resource());
        log
    }

    pub(crate) fn run(&mut self, app: &mut App, frames: usize, mut each: impl FnMut(&mut App, usize)) {
        for frame in 1..=frames {
            each(app, frame);
            app.update();
            for event in self.cursor.read(app.world().resource()) {
                match *event {
                    CollisionEvent::Started(a, b, _) => self.started.push((a.min(b), a.max(b))),
                    CollisionEvent::Stopped(a, b, _) => self.ended.push((a.min(b), a.max(b))),
                }
            }
        }
    }
}

/// Moves a body elsewhere, at rest.
pub(crate) fn put(app: &mut App, body: Entity, at: Vec3) {
    app.world_mut()
        .entity_mut(body)
        .insert((Transform::from_translation(at), Velocity::zero()));
}

/// The first hit of a ray straight down from a height of 5: the entity and the height.
pub(crate) fn below(app: &mut App, x: f32, z: f32) -> Option<(Entity, f32)> {
    let hit = ask(app, move |context| {
        context.cast_ray(Vec3::new(x, 5.0, z), -Vec3::Y, 100.0, true, QueryFilter::default())
    });
    hit.map(|(entity, distance)| (entity, 5.0 - distance))
}
