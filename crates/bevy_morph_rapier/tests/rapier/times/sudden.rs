//! Jumps, long frames, pauses and slow motion.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::body;

use super::{Frames, LENGTHS, STEPS, Steps, Watched, begin, frames, now, on_a_sheet, range};
use crate::support::place;

#[test]
fn a_jump_between_two_frames_does_not_throw() {
    for steps in [Steps::Fixed(64.0), Steps::Interpolated] {
        for lengths in LENGTHS {
            let jumps: [(f32, super::Weights); 2] = [(0.2, |_| [0.2, 0.0]), (0.4, |_| [0.4, 0.0])];
            for (jump, weights) in jumps {
                let (mut app, surface, ball) = on_a_sheet(steps, lengths, Collider::ball(0.5));
                begin(&mut app, surface, weights);
                frames(&mut app, lengths, 120);
                let steps_seen = &app.world().resource::<Watched>().steps;
                let (_, highest) = range(steps_seen.iter().map(|(place, _)| place.y));
                assert!(
                    highest < 0.6 + jump,
                    "{steps:?}, {lengths:?}: thrown to {highest} by {jump}"
                );
                let rests = place(&app, ball).y;
                assert!(
                    (rests - 0.5 - jump).abs() < 1e-2,
                    "{steps:?}, {lengths:?}: it rests at {rests}"
                );
            }
        }
    }
}

#[test]
fn a_slap_of_several_frames_throws() {
    for steps in [Steps::Fixed(64.0), Steps::Interpolated] {
        for lengths in LENGTHS {
            let (mut app, surface, _) = on_a_sheet(steps, lengths, Collider::ball(0.5));
            // Rises by 0.5 within a tenth of a second.
            begin(&mut app, surface, |time| [(5.0 * time).min(0.5), 0.0]);
            frames(&mut app, lengths, 60);
            let watched = app.world().resource::<Watched>();
            let (_, fastest) = range(watched.steps.iter().map(|(_, velocity)| velocity.y));
            assert!(
                (4.0..6.0).contains(&fastest),
                "{steps:?}, {lengths:?}: thrown at {fastest}"
            );
        }
    }
}

#[test]
fn an_entity_that_is_put_elsewhere_is_never_in_between() {
    for steps in [Steps::Fixed(64.0), Steps::Interpolated] {
        for lengths in LENGTHS {
            let (mut app, surface, _) = on_a_sheet(steps, lengths, Collider::ball(0.5));
            // Balls all along the way. The sheet would push them out, and nothing else moves them.
            let at = [7.0, 14.0, 21.0, 28.0, 34.0].map(|x| Vec3::new(x, 0.3, 0.0));
            let between = at.map(|at| {
                let ball = body(&mut app, Collider::ball(0.5), at);
                app.world_mut().entity_mut(ball).insert(GravityScale(0.0));
                ball
            });
            frames(&mut app, lengths, 5);
            app.world_mut().get_mut::<Transform>(surface).unwrap().translation.x = 40.0;
            frames(&mut app, lengths, 60);
            let places = between.map(|ball| place(&app, ball));
            assert_eq!(places, at, "{steps:?}, {lengths:?}");
            let there = body(&mut app, Collider::ball(0.5), Vec3::new(40.0, 0.6, 0.0));
            frames(&mut app, lengths, 200);
            let height = place(&app, there).y;
            assert!((height - 0.5).abs() < 1e-2, "{steps:?}, {lengths:?}: {height}");
        }
    }
}

#[test]
fn a_long_frame_does_not_throw() {
    for steps in [Steps::Fixed(64.0), Steps::Interpolated] {
        for lengths in LENGTHS {
            let (mut app, surface, ball) = on_a_sheet(steps, lengths, Collider::ball(0.5));
            let since = begin(&mut app, surface, |time| [0.5 * time, 0.0]);
            frames(&mut app, lengths, 150);
            frames(&mut app, Frames::Every(0.2), 1);
            frames(&mut app, lengths, 150);
            let seen = &app.world().resource::<Watched>().steps[30..];
            let (_, fastest) = range(seen.iter().map(|(_, velocity)| velocity.y));
            assert!(fastest < 1.0, "{steps:?}, {lengths:?}: thrown at {fastest}");
            if steps == Steps::Interpolated {
                // It goes on at its speed in all steps of the long frame.
                let (low, high) = range(seen.iter().map(|(_, velocity)| velocity.y));
                assert!(low > 0.49 && high < 0.51, "{lengths:?}: {low} to {high}");
            }
            let (low, high) = range(seen[seen.len() - 20..].iter().map(|(_, velocity)| velocity.y));
            assert!(
                low > 0.49 && high < 0.51,
                "{steps:?}, {lengths:?}: {low} to {high} long after"
            );
            let behind = (0.5 * (now(&app) - since) - (place(&app, ball).y - 0.5)) / 0.5;
            assert!(
                (-0.02..0.06).contains(&behind),
                "{steps:?}, {lengths:?}: {behind} s behind"
            );
        }
    }
}

#[test]
fn a_pause_is_no_motion_and_slow_motion_is_slow() {
    for steps in STEPS {
        let lengths = Frames::Every(1.0 / 50.0);
        let (mut app, surface, ball) = on_a_sheet(steps, lengths, Collider::ball(0.5));
        begin(&mut app, surface, |time| [0.5 * time, 0.0]);
        frames(&mut app, lengths, 100);
        app.world_mut().resource_mut::<Time<Virtual>>().pause();
        let before = place(&app, ball).y;
        frames(&mut app, lengths, 100);
        // At most the motion that had already started is still drawn.
        assert!((place(&app, ball).y - before).abs() < 0.01, "{steps:?}");
        app.world_mut().resource_mut::<Time<Virtual>>().unpause();
        frames(&mut app, lengths, 100);
        app.world_mut().resource_mut::<Time<Virtual>>().set_relative_speed(0.25);
        frames(&mut app, lengths, 400);
        let seen = &app.world().resource::<Watched>().steps[30..];
        let (low, high) = range(seen.iter().map(|(_, velocity)| velocity.y));
        assert!(low > 0.49 && high < 0.51, "{steps:?}: velocities from {low} to {high}");
    }
}

#[test]
fn weights_that_cannot_be_used_keep_the_last_good_ones() {
    for steps in STEPS {
        let lengths = Frames::Every(1.0 / 60.0);
        let (mut app, surface, ball) = on_a_sheet(steps, lengths, Collider::ball(0.5));
        // The last good frame is far from the one before, and steps see the interpolation between them first.
        begin(&mut app, surface, |time| match time {
            0.0..0.495 => [0.0, 0.0],
            0.495..0.51 => [0.3, 0.0],
            _ => [f32::NAN, 0.0],
        });
        frames(&mut app, lengths, 150);
        let height = place(&app, ball).y;
        assert!((height - 0.8).abs() < 1e-2, "{steps:?}: {height}");
    }
}
