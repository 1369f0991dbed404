//! Surfaces with steady motion push and carry at their own speed in every step, whatever the lengths of
//! frames and steps.

use std::path::Path;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{
    FRAMES, LENGTHS, STEPS, Steps, Watched, animate, app, begin, begin_to_watch, frames, now, on_a_sheet, range,
};
use crate::support::{place, spawn};

#[test]
fn a_ball_rises_with_the_surface_in_every_step() {
    for steps in STEPS {
        for lengths in FRAMES {
            let (mut app, surface, ball) = on_a_sheet(steps, lengths, Collider::ball(0.5));
            let since = begin(&mut app, surface, |time| [0.5 * time, 0.0]);
            frames(&mut app, lengths, 200);
            let velocities = &app.world().resource::<Watched>().steps[30..];
            assert!(velocities.len() > 50);
            let (low, high) = range(velocities.iter().map(|(_, velocity)| velocity.y));
            assert!(
                low > 0.49 && high < 0.51,
                "{steps:?}, {lengths:?}: velocities from {low} to {high}"
            );
            // How far the ball lags behind the drawn surface, in seconds: at most a few frames or steps.
            let behind = (0.5 * (now(&app) - since) - (place(&app, ball).y - 0.5)) / 0.5;
            assert!(
                (-0.02..0.06).contains(&behind),
                "{steps:?}, {lengths:?}: {behind} s behind"
            );
        }
    }
}

#[test]
fn a_box_is_carried_as_far_as_the_surface_slides() {
    for steps in STEPS {
        for lengths in LENGTHS {
            let (mut app, surface, cuboid) = on_a_sheet(steps, lengths, Collider::cuboid(0.5, 0.5, 0.5));
            let since = begin(&mut app, surface, |time| [0.0, time.min(1.0)]);
            while now(&app) < since + 1.5 {
                frames(&mut app, lengths, 10);
            }
            let carried = place(&app, cuboid).x - 0.1;
            // The surface starts and stops at once; friction needs a moment for both.
            assert!(
                (carried - 1.0).abs() < 0.03,
                "{steps:?}, {lengths:?}: carried by {carried}"
            );
        }
    }
}

#[test]
fn what_is_animated_in_every_step_is_seen_as_it_is() {
    for lengths in LENGTHS {
        for after_physics in [false, true] {
            let steps = Steps::Fixed(64.0);
            let mut app = app(Path::new("."), steps);
            if after_physics {
                app.add_systems(FixedUpdate, animate.after(PhysicsSet::Writeback));
            } else {
                app.add_systems(FixedUpdate, animate.before(PhysicsSet::SyncBackend));
            }
            let surface = spawn(&mut app, &sheet(16), ());
            settle(&mut app);
            let ball = body(&mut app, Collider::ball(0.5), Vec3::new(0.1, 0.5, 0.05));
            frames(&mut app, lengths, 60);
            // Animated by frames at first, then by steps.
            begin(&mut app, surface, |time| [1e-4 * time, 0.0]);
            frames(&mut app, lengths, 30);
            begin_to_watch(&mut app, ball);
            // Stops the system in `Update`, which would animate by another clock.
            app.insert_resource(Stop);
            let since = app.world().resource::<Time<Fixed>>().elapsed_secs();
            begin(&mut app, surface, |time| [0.5 * time, 0.0]);
            app.world_mut().resource_mut::<super::Animated>().since = since;
            frames(&mut app, lengths, 200);
            let watched = app.world().resource::<Watched>();
            let (low, high) = range(watched.steps[30..].iter().map(|(_, velocity)| velocity.y));
            assert!(
                low > 0.495 && high < 0.505,
                "{lengths:?}: velocities from {low} to {high}"
            );
            let elapsed = app.world().resource::<Time<Fixed>>().elapsed_secs() - since;
            let behind = 0.5 * elapsed - (place(&app, ball).y - 0.5);
            let a_step = if after_physics { 0.5 / 64.0 } else { 0.0 };
            assert!(
                (behind - a_step).abs() < 2e-3,
                "{lengths:?}, {after_physics}: {behind} behind"
            );
        }
    }
}

/// While this resource exists, nothing is animated in `Update`.
#[derive(Resource)]
pub(super) struct Stop;

#[test]
fn an_entity_that_is_moved_once_a_frame_carries() {
    for steps in STEPS {
        for lengths in LENGTHS {
            let (mut app, surface, cuboid) = on_a_sheet(steps, lengths, Collider::cuboid(0.5, 0.5, 0.5));
            let since = now(&app);
            app.add_systems(Update, move |mut places: Query<&mut Transform>, time: Res<Time>| {
                let time = time.elapsed_secs() - since;
                if let Ok(mut place) = places.get_mut(surface) {
                    place.translation = Vec3::new(0.3 * time, 0.5 * time, 0.0);
                }
            });
            frames(&mut app, lengths, 200);
            let velocities = &app.world().resource::<Watched>().steps[60..];
            for axis in [0, 1] {
                let speed = [0.3, 0.5][axis];
                let (low, high) = range(velocities.iter().map(|(_, velocity)| velocity[axis]));
                assert!(
                    low > 0.98 * speed && high < 1.02 * speed,
                    "{steps:?}, {lengths:?}: velocities along {axis} from {low} to {high}"
                );
            }
            let height = place(&app, cuboid).y - 0.5;
            let expected = 0.5 * (now(&app) - since);
            assert!(
                (height - expected).abs() < 0.03,
                "{steps:?}, {lengths:?}: {height}, {expected}"
            );
        }
    }
}

#[test]
fn what_is_below_a_moved_parent_is_where_it_is_drawn() {
    // Other plugins place hierarchies after physics.
    let kinds = [None, Some(RigidBody::KinematicPositionBased)];
    for kind in kinds {
        let mut app = app(Path::new("."), Steps::PerFrame);
        let root = app
            .world_mut()
            .spawn((Transform::default(), Visibility::default()))
            .id();
        if let Some(kind) = kind {
            app.world_mut().entity_mut(root).insert((kind, Sleeping::disabled()));
        }
        spawn(&mut app, &sheet(16), ChildOf(root));
        settle(&mut app);
        let ball = body(&mut app, Collider::ball(0.5), Vec3::new(0.1, 0.5, 0.05));
        frames(&mut app, FRAMES[1], 60);
        app.add_systems(Update, move |mut places: Query<&mut Transform>| {
            places.get_mut(root).unwrap().translation.y += 0.5 / 60.0;
        });
        frames(&mut app, FRAMES[1], 60);
        let drawn = app.world().get::<Transform>(root).unwrap().translation.y;
        assert!((drawn - 0.5).abs() < 1e-4, "{kind:?}: it was put back to {drawn}");
        let gap = place(&app, ball).y - 0.5 - drawn;
        assert!(gap.abs() < 1e-3, "{kind:?}: {gap} off");
    }
}
