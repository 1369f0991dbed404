//! An app with Avian, and morphing meshes in it.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
pub(crate) use avian3d::prelude::{
    Collider, ColliderDisabled, CollidingEntities, Friction, GravityScale, LockedAxes, Sensor,
};
use bevy::ecs::message::MessageCursor;
use bevy::ecs::schedule::ScheduleLabel;
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use morph_collision_workspace::app::headless;

pub(crate) use crate::any_engine::common::*;
use crate::any_engine::schedules::{Broken, Setup};
use crate::log::start;
pub(crate) use crate::stage::Method;

const STEP: Duration = Duration::from_nanos(16_666_667);

/// An app with one step per frame.
pub(crate) fn app() -> App {
    let mut app = unfinished();
    start(&mut app);
    app
}

/// The same app, to which more plugins can be added.
pub(crate) fn unfinished() -> App {
    let mut app = headless(Path::new("../.."));
    app.add_plugins((PhysicsPlugins::default(), MorphAvianPlugin))
        .insert_resource(Time::<Fixed>::from_duration(STEP))
        .insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    app
}

pub(crate) fn body(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let body = (RigidBody::Dynamic, collider, Transform::from_translation(at));
    app.world_mut().spawn(body).id()
}

pub(crate) fn ball(radius: f32) -> Collider {
    Collider::sphere(radius)
}

/// A box with these half-extents.
pub(crate) fn cuboid(half: Vec3) -> Collider {
    Collider::cuboid(2.0 * half.x, 2.0 * half.y, 2.0 * half.z)
}

pub(crate) fn trimesh(positions: &[Vec3], triangles: &[[u32; 3]]) -> Collider {
    Collider::trimesh(positions.to_vec(), triangles.to_vec())
}

/// Shapes that are 0.4 wide.
pub(crate) fn shapes() -> [Collider; 3] {
    [
        Collider::sphere(0.2),
        Collider::cuboid(0.4, 0.4, 0.4),
        Collider::capsule(0.1, 0.2),
    ]
}

/// The speed at which Avian pushes bodies apart.
pub(crate) const DRIVEN: f32 = 4.0;

/// The plugin for Avian under a name that tests of every engine use.
pub(crate) use bevy_morph_avian::MorphAvianPlugin as OurPlugin;
/// The names of the plugins.
pub(crate) const OUR_PLUGIN: &str = "MorphAvianPlugin";
pub(crate) const ENGINE_PLUGIN: &str = "PhysicsPlugins";

/// Ways to put an app together that only Avian has: none.
pub(crate) const MORE_SETUPS: &[Setup] = &[];
pub(crate) const MORE_BROKEN: &[Broken] = &[];

/// Avian in its usual schedule.
pub(crate) fn engine() -> PhysicsPlugins {
    PhysicsPlugins::default()
}

/// Avian in this schedule.
pub(crate) fn engine_in(schedule: impl ScheduleLabel) -> PhysicsPlugins {
    PhysicsPlugins::new(schedule)
}

/// What makes a collider fixed.
pub(crate) fn fixed() -> impl Bundle {
    RigidBody::Static
}

pub(crate) const DYNAMIC: RigidBody = RigidBody::Dynamic;
pub(crate) const FIXED: RigidBody = RigidBody::Static;

/// Makes masses readable.
pub(crate) fn weighed() -> impl Bundle {}

pub(crate) fn mass_of_collider(app: &App, entity: Entity) -> f32 {
    app.world().get::<ColliderMassProperties>(entity).unwrap().mass
}

pub(crate) fn mass_of_body(app: &App, entity: Entity) -> f32 {
    app.world().get::<ComputedMass>(entity).unwrap().value()
}

/// Whether an entity has its collider.
pub(crate) fn is_attached(app: &App, entity: Entity) -> bool {
    app.world().get::<Collider>(entity).is_some()
}

/// The velocity of a body.
pub(crate) fn flying(velocity: Vec3) -> impl Bundle {
    LinearVelocity(velocity)
}

/// What makes Avian report the contacts of an entity.
pub(crate) fn listening() -> impl Bundle {
    (CollisionEventsEnabled, CollidingEntities::default())
}

pub(crate) fn colliding(app: &App, entity: Entity) -> Vec<Entity> {
    let colliding = app.world().get::<CollidingEntities>(entity).unwrap();
    colliding.iter().copied().collect()
}

pub(crate) fn place(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Position>(entity).expect("a body").0
}

pub(crate) fn velocity(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<LinearVelocity>(entity).expect("a body").0
}

pub(crate) fn is_asleep(app: &App, entity: Entity) -> bool {
    app.world().entity(entity).contains::<Sleeping>()
}

/// Waits until a body sleeps.
pub(crate) fn fall_asleep(app: &mut App, body: Entity) {
    run(app, 120);
    assert!(is_asleep(app, body));
}

/// The number of all colliders, and of the parts among them.
pub(crate) fn population(app: &mut App) -> (usize, usize) {
    let world = app.world_mut();
    let colliders = world.query::<&Collider>().iter(world).count();
    let parts = world.query::<&MorphAvianPart>().iter(world).count();
    (colliders, parts)
}

/// Runs a system once that queries Avian.
pub(crate) fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&SpatialQuery) -> T + Send + Sync + 'static) -> T {
    let system = move |query: SpatialQuery| ask(&query);
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

/// The first hit of a ray straight down from a height of 5: the entity and the height.
pub(crate) fn below(app: &mut App, x: f32, z: f32) -> Option<(Entity, f32)> {
    all_below(app, x, z).first().copied()
}

/// All hits of such a ray.
pub(crate) fn all_below(app: &mut App, x: f32, z: f32) -> Vec<(Entity, f32)> {
    let mut hits = ask(app, move |query| {
        query.ray_hits(
            Vec3::new(x, 5.0, z),
            Dir3::NEG_Y,
            100.0,
            100,
            true,
            &SpatialQueryFilter::DEFAULT,
        )
    });
    hits.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    hits.iter().map(|hit| (hit.entity, 5.0 - hit.distance)).collect()
}

/// Moves a body elsewhere, at rest.
pub(crate) fn put(app: &mut App, body: Entity, at: Vec3) {
    let velocity = (LinearVelocity::ZERO, AngularVelocity::ZERO);
    app.world_mut().entity_mut(body).insert((Position(at), velocity));
}

/// Runs frames and collects the events.
#[derive(Default)]
pub(crate) struct Log {
    starts: MessageCursor<CollisionStart>,
    ends: MessageCursor<CollisionEnd>,
    pub(crate) started: Vec<(Entity, Entity)>,
    pub(crate) ended: Vec<(Entity, Entity)>,
}

impl Log {
    pub(crate) fn from_now(app: &App) -> Self {
        let mut log = Self::default();
        log.starts.clear(app.world().resource());
        log.ends.clear(app.world().resource());
        log
    }

    pub(crate) fn run(&mut self, app: &mut App, frames: usize, mut each: impl FnMut(&mut App, usize)) {
        for frame in 1..=frames {
            each(app, frame);
            app.update();
            let started = self.starts.read(app.world().resource());
            self.started.extend(started.map(|it| pair(it.collider1, it.collider2)));
            let ended = self.ends.read(app.world().resource());
            self.ended.extend(ended.map(|it| pair(it.collider1, it.collider2)));
        }
    }
}
