//! Surfaces that the game puts somewhere else, and says so.

use std::path::Path;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{EVERY, Frames, LENGTHS, Steps, Watched, app, begin, begin_to_watch, frames, now, range};
use crate::support::{place, set_weights, spawn};

/// A sheet whose every change counts as motion, below a parent that may be a body, and a body at rest on it.
fn on_a_sheet(steps: Steps, lengths: Frames, parent: impl Bundle, collider: Collider) -> (App, [Entity; 3]) {
    let mut app = app(Path::new("."), steps);
    let parent = app
        .world_mut()
        .spawn((Transform::default(), Visibility::default(), parent))
        .id();
    let surface = spawn(&mut app, &sheet(16), ChildOf(parent));
    let trusting = MorphPhysicsCollider {
        max_acceleration: f32::INFINITY,
        ..default()
    };
    app.world_mut().entity_mut(surface).insert(trusting);
    settle(&mut app);
    let body = body(&mut app, collider, Vec3::new(0.1, 0.5, 0.05));
    frames(&mut app, lengths, 30);
    begin_to_watch(&mut app, body);
    (app, [parent, surface, body])
}

/// How a surface is put elsewhere.
#[derive(Clone, Copy, Debug)]
enum Way {
    Transform,
    Weights,
    Parent,
    Body,
    /// While collision detection is paused, and for the second time.
    AgainWhilePaused,
    /// By a system in the schedule of physics.
    InSchedule,
}

const WAYS: [Way; 6] = [
    Way::Transform,
    Way::Weights,
    Way::Parent,
    Way::Body,
    Way::AgainWhilePaused,
    Way::InSchedule,
];

#[derive(Resource)]
struct Later(Entity);

fn put_later(later: If<Res<Later>>, mut commands: Commands) {
    let there = (Transform::from_xyz(0.0, 0.2, 0.0), MorphTeleported);
    commands.entity(later.0.0).insert(there);
    commands.remove_resource::<Later>();
}

fn raise(app: &mut App, way: Way, [parent, surface, _]: [Entity; 3]) {
    let there = (Transform::from_xyz(0.0, 0.2, 0.0), MorphTeleported);
    match way {
        Way::Transform => _ = app.world_mut().entity_mut(surface).insert(there),
        Way::Weights => {
            set_weights(app, surface, &[0.2, 0.0]);
            app.world_mut().entity_mut(surface).insert(MorphTeleported);
        }
        Way::Parent | Way::Body => _ = app.world_mut().entity_mut(parent).insert(there),
        Way::AgainWhilePaused => {
            app.world_mut().resource_mut::<MorphCollisionSettings>().paused = true;
            app.world_mut().entity_mut(surface).insert(MorphTeleported);
            frames(app, Frames::Every(1.0 / 60.0), 10);
            assert!(app.world().entity(surface).contains::<MorphTeleported>());
            app.world_mut().entity_mut(surface).insert(there);
        }
        Way::InSchedule => app.world_mut().insert_resource(Later(surface)),
    }
}

#[test]
fn what_is_put_elsewhere_pushes_out_but_throws_nothing() {
    let mut wrong = Vec::new();
    for steps in EVERY {
        for lengths in [LENGTHS[0], LENGTHS[1], LENGTHS[3]] {
            for way in WAYS {
                let ball = Collider::ball(0.5);
                let (mut app, all) = match way {
                    Way::Body => {
                        let awake = (RigidBody::KinematicPositionBased, Sleeping::disabled());
                        on_a_sheet(steps, lengths, awake, ball)
                    }
                    _ => on_a_sheet(steps, lengths, (), ball),
                };
                match steps {
                    Steps::Fixed(_) => app.add_systems(FixedUpdate, put_later.before(PhysicsSet::SyncBackend)),
                    _ => app.add_systems(Update, put_later),
                };
                raise(&mut app, way, all);
                frames(&mut app, lengths, 120);
                let seen = &app.world().resource::<Watched>().steps;
                let (_, highest) = range(seen.iter().map(|(place, _)| place.y));
                let rests = place(&app, all[2]).y;
                if highest > 0.71 || (rests - 0.7).abs() > 1e-2 {
                    wrong.push(format!(
                        "{steps:?}, {lengths:?}, {way:?}: thrown to {highest}, rests at {rests}"
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_is_put_elsewhere_carries_nothing_along() {
    for steps in EVERY {
        let (mut app, [_, surface, cuboid]) = on_a_sheet(steps, LENGTHS[1], (), Collider::cuboid(0.5, 0.5, 0.5));
        let walker = (
            Collider::capsule_y(0.5, 0.3),
            KinematicCharacterController::default(),
            Transform::from_xyz(-2.0, 0.82, 0.05),
        );
        let walker = app.world_mut().spawn(walker).id();
        let walk = move |mut walkers: Query<&mut KinematicCharacterController>| {
            for mut walker in &mut walkers {
                walker.translation = Some(Vec3::NEG_Y * 0.05);
            }
        };
        app.add_systems(Update, walk);
        frames(&mut app, LENGTHS[1], 30);
        let before = [cuboid, walker].map(|entity| place(&app, entity).x);
        let there = (Transform::from_xyz(0.3, 0.0, 0.0), MorphTeleported);
        app.world_mut().entity_mut(surface).insert(there);
        frames(&mut app, LENGTHS[1], 30);
        for (entity, before) in [cuboid, walker].into_iter().zip(before) {
            let after = place(&app, entity).x;
            assert!((after - before).abs() < 1e-3, "{steps:?}: {before} to {after}");
        }
    }
}

#[test]
fn a_moving_surface_that_is_put_elsewhere_keeps_its_speed() {
    for steps in EVERY {
        let lengths = LENGTHS[1];
        let (mut app, [_, surface, ball]) = on_a_sheet(steps, lengths, (), Collider::ball(0.5));
        let since = begin(&mut app, surface, |time| [0.5 * time, 0.0]);
        for i in 1..=5 {
            frames(&mut app, lengths, 30);
            let there = (Transform::from_xyz(0.0, 0.1 * i as f32, 0.0), MorphTeleported);
            app.world_mut().entity_mut(surface).insert(there);
        }
        frames(&mut app, lengths, 40);
        let seen = &app.world().resource::<Watched>().steps;
        let (_, high) = range(seen.iter().map(|(_, velocity)| velocity.y));
        assert!(high < 0.52, "{steps:?}: thrown at {high}");
        let behind = (0.5 * (now(&app) - since) + 0.5 - (place(&app, ball).y - 0.5)) / 0.5;
        assert!((-0.02..0.06).contains(&behind), "{steps:?}: {behind} s behind");
    }
}
