//! What works with a physics engine.

use avian3d::prelude as avian;
use avian3d::prelude::{SpatialQuery, SpatialQueryFilter};
use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude as rapier;
use bevy_rapier3d::prelude::ReadRapierContext;
use morph_collision_workspace::app::{STEP, headless};

use super::Feature;
use super::kinds::{Kind, Subject};
use crate::log::start;
use crate::support::{Edits, assets};

/// What scenes need of a physics engine.
pub(super) trait Engine {
    fn add_to(app: &mut App);

    /// What makes a collider part of a dynamic body.
    fn dynamic() -> impl Bundle;

    fn fixed() -> impl Bundle;

    /// A dynamic ball of radius 0.2 that lists what it touches.
    fn ball() -> impl Bundle;

    fn floor() -> impl Bundle;

    /// A character of height 1, which falls in every frame.
    fn character() -> impl Bundle;

    /// The surface on which a character stands.
    fn ground(app: &App, character: Entity) -> Option<Entity>;

    /// What a ball touches.
    fn touching(app: &App, ball: Entity) -> Vec<Entity>;

    fn speed(app: &App, body: Entity) -> Vec3;

    /// What a ray of the engine hits, from `from` straight down, and how far away.
    fn ray(app: &mut App, from: Vec3) -> Option<(Entity, f32)>;
}

pub(super) struct Rapier;

pub(super) struct Avian;

/// Where bodies start, or rays.
fn above(height: f32) -> Vec3 {
    Vec3::new(0.1, height, 0.05)
}

pub(super) fn features<E: Engine>() -> [Feature; 7] {
    let feature = |name, works| Feature { name, works };
    [
        feature("bodies rest on it and rise with it", rests::<E>),
        feature("it throws bodies", throws::<E>),
        feature("the engine's rays", rays::<E>),
        feature("the engine's events and lists name its entity", events::<E>),
        feature("it drives out what is inside (`solid`)", solid::<E>),
        feature("shape of a dynamic body", dynamic::<E>),
        feature("characters stand on it and are carried", carries::<E>),
    ]
}

fn stage<E: Engine>(kind: Kind, more: impl Bundle) -> Subject {
    let mut app = headless(&assets());
    app.insert_resource(TimeUpdateStrategy::ManualDuration(STEP));
    E::add_to(&mut app);
    start(&mut app);
    Subject::new(kind, app, more)
}

fn surface() -> MorphPhysicsCollider {
    MorphPhysicsCollider::default()
}

fn spawn_at(subject: &mut Subject, at: Vec3, bundle: impl Bundle) -> Entity {
    subject.app.spawn((bundle, Transform::from_translation(at)))
}

fn run(subject: &mut Subject, frames: usize) {
    (0..frames).for_each(|_| subject.app.update());
}

fn height(subject: &Subject, entity: Entity) -> f32 {
    let place = subject.app.world().get::<Transform>(entity);
    place.map_or(f32::NAN, |place| place.translation.y)
}

/// Stretches it to `by` in some frames.
fn rise(subject: &mut Subject, by: f32, frames: u16) {
    for frame in 1..=frames {
        subject.stretched(by * f32::from(frame) / f32::from(frames));
    }
}

fn rests<E: Engine>(kind: Kind) -> bool {
    let mut subject = stage::<E>(kind, surface());
    let ball = spawn_at(&mut subject, above(0.75), E::ball());
    run(&mut subject, 30);
    let before = height(&subject, ball);
    rise(&mut subject, 1.0, 60);
    let after = height(&subject, ball);
    (before - 0.7).abs() < 0.03 && (after - 1.7).abs() < 0.03
}

fn throws<E: Engine>(kind: Kind) -> bool {
    let mut subject = stage::<E>(kind, surface());
    let ball = spawn_at(&mut subject, above(0.71), E::ball());
    run(&mut subject, 10);
    rise(&mut subject, 0.5, 6);
    // It moves at 5 per second.
    E::speed(&subject.app, ball).y > 3.0
}

fn rays<E: Engine>(kind: Kind) -> bool {
    let mut subject = stage::<E>(kind, surface());
    let collider = subject.collider;
    let is = |hit: Option<(Entity, f32)>, far: f32| {
        hit.is_some_and(|(entity, distance)| entity == collider && (distance - far).abs() < 1e-3)
    };
    let before = E::ray(&mut subject.app, above(5.0));
    subject.stretch(1.0);
    run(&mut subject, 2);
    is(before, 4.5) && is(E::ray(&mut subject.app, above(5.0)), 3.5)
}

fn events<E: Engine>(kind: Kind) -> bool {
    let mut subject = stage::<E>(kind, surface());
    let ball = spawn_at(&mut subject, above(2.5), E::ball());
    run(&mut subject, 2);
    let before = E::touching(&subject.app, ball);
    subject.stretch(1.5);
    run(&mut subject, 60);
    before.is_empty() && E::touching(&subject.app, ball) == [subject.collider]
}

fn solid<E: Engine>(kind: Kind) -> bool {
    let is_left = |solid: bool| {
        let mut subject = stage::<E>(kind, MorphPhysicsCollider { solid, ..surface() });
        subject.stretch(2.0);
        run(&mut subject, 5);
        // In the middle of what is stretched or has moved there.
        let ball = spawn_at(&mut subject, above(2.1), E::ball());
        run(&mut subject, 90);
        let place = subject
            .app
            .world()
            .get::<Transform>(ball)
            .expect("a body has one")
            .translation;
        place.x.abs().max(place.z.abs()) > 0.5 || !(-0.5..2.5).contains(&place.y)
    };
    is_left(true) && !is_left(false)
}

fn dynamic<E: Engine>(kind: Kind) -> bool {
    let mut subject = stage::<E>(kind, (surface(), E::dynamic()));
    // It falls by 1. What is rigid does not stretch, so its upper side is lower.
    let deforms = !matches!(kind, Kind::Rigid | Kind::Shape);
    if deforms {
        subject.stretch(1.0);
    }
    spawn_at(&mut subject, Vec3::NEG_Y * 2.5, E::floor());
    run(&mut subject, 120);
    let upper = if deforms { 0.5 } else { -0.5 };
    let hit = E::ray(&mut subject.app, above(5.0));
    hit.is_some_and(|(entity, distance)| entity == subject.collider && (distance - (5.0 - upper)).abs() < 0.05)
}

fn carries<E: Engine>(kind: Kind) -> bool {
    // Avian's `MoveAndSlide` ignores colliders without a body.
    let mut subject = stage::<E>(kind, (surface(), E::fixed()));
    let character = spawn_at(&mut subject, above(1.05), E::character());
    run(&mut subject, 30);
    let before = height(&subject, character);
    rise(&mut subject, 1.0, 60);
    let after = height(&subject, character);
    E::ground(&subject.app, character) == Some(subject.collider)
        && (before - 1.0).abs() < 0.05
        && (after - 2.0).abs() < 0.05
}

impl Engine for Rapier {
    fn add_to(app: &mut App) {
        app.add_plugins((rapier::RapierPhysicsPlugin::<()>::default(), MorphRapierPlugin));
        app.insert_resource(rapier::TimestepMode::Fixed {
            dt: STEP.as_secs_f32(),
            substeps: 1,
        });
        let fall = |mut characters: Query<&mut rapier::KinematicCharacterController>| {
            for mut character in &mut characters {
                character.translation = Some(Vec3::NEG_Y * 0.05);
            }
        };
        app.add_systems(Update, fall);
    }

    fn dynamic() -> impl Bundle {
        rapier::RigidBody::Dynamic
    }

    fn fixed() -> impl Bundle {
        rapier::RigidBody::Fixed
    }

    fn ball() -> impl Bundle {
        (
            rapier::RigidBody::Dynamic,
            rapier::Collider::ball(0.2),
            rapier::Velocity::default(),
            rapier::ActiveEvents::COLLISION_EVENTS,
            rapier::CollidingEntities::default(),
        )
    }

    fn floor() -> impl Bundle {
        rapier::Collider::cuboid(5.0, 1.0, 5.0)
    }

    fn character() -> impl Bundle {
        (
            rapier::Collider::capsule_y(0.3, 0.2),
            rapier::KinematicCharacterController::default(),
            MorphCharacterCarry::default(),
        )
    }

    fn ground(app: &App, character: Entity) -> Option<Entity> {
        app.world().get::<MorphCharacterGround>(character)?.surface
    }

    fn touching(app: &App, ball: Entity) -> Vec<Entity> {
        let list = app.world().get::<rapier::CollidingEntities>(ball);
        list.map(|list| list.iter().collect()).unwrap_or_default()
    }

    fn speed(app: &App, body: Entity) -> Vec3 {
        let velocity = app.world().get::<rapier::Velocity>(body);
        velocity.map_or(Vec3::ZERO, |velocity| velocity.linear)
    }

    fn ray(app: &mut App, from: Vec3) -> Option<(Entity, f32)> {
        let ray = move |context: ReadRapierContext| {
            let context = context.single().ok()?;
            context.cast_ray(from, Vec3::NEG_Y, 100.0, true, rapier::QueryFilter::default())
        };
        app.world_mut().run_system_once(ray).expect("there is a context")
    }
}

/// A character of Avian that falls slowly.
#[derive(Component)]
struct Falls;

fn fall(
    mut characters: Query<(Entity, &avian::Collider, &mut Transform), With<Falls>>,
    space: avian::MoveAndSlide,
    time: Res<Time>,
) {
    for (entity, collider, mut place) in &mut characters {
        let filter = SpatialQueryFilter::from_excluded_entities([entity]);
        let moved = space.move_and_slide(
            collider,
            place.translation,
            place.rotation,
            Vec3::NEG_Y * 3.0,
            time.delta(),
            &avian::MoveAndSlideConfig::default(),
            &filter,
            |_| avian::MoveAndSlideHitResponse::Accept,
        );
        place.translation = moved.position;
    }
}

impl Engine for Avian {
    fn add_to(app: &mut App) {
        app.add_plugins((avian::PhysicsPlugins::default(), MorphAvianPlugin))
            .insert_resource(Time::<Fixed>::from_duration(STEP))
            .add_systems(FixedUpdate, fall);
    }

    fn dynamic() -> impl Bundle {
        avian::RigidBody::Dynamic
    }

    fn fixed() -> impl Bundle {
        avian::RigidBody::Static
    }

    fn ball() -> impl Bundle {
        (
            avian::RigidBody::Dynamic,
            avian::Collider::sphere(0.2),
            avian::CollidingEntities::default(),
        )
    }

    fn floor() -> impl Bundle {
        (avian::RigidBody::Static, avian::Collider::cuboid(10.0, 2.0, 10.0))
    }

    fn character() -> impl Bundle {
        (Falls, avian::Collider::capsule(0.2, 0.6), MorphAvianCarry::default())
    }

    fn ground(app: &App, character: Entity) -> Option<Entity> {
        app.world().get::<MorphCharacterGround>(character)?.surface
    }

    fn touching(app: &App, ball: Entity) -> Vec<Entity> {
        let list = app.world().get::<avian::CollidingEntities>(ball);
        list.map(|list| list.iter().copied().collect()).unwrap_or_default()
    }

    fn speed(app: &App, body: Entity) -> Vec3 {
        let velocity = app.world().get::<avian::LinearVelocity>(body);
        velocity.map_or(Vec3::ZERO, |velocity| velocity.0)
    }

    fn ray(app: &mut App, from: Vec3) -> Option<(Entity, f32)> {
        let ray = move |query: SpatialQuery| {
            let hit = query.cast_ray(from, Dir3::NEG_Y, 100.0, true, &SpatialQueryFilter::DEFAULT)?;
            Some((hit.entity, hit.distance))
        };
        app.world_mut().run_system_once(ray).expect("there is a query")
    }
}
