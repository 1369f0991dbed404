//! Clocks that do not run like clocks: few steps, many steps at once, time that is set back.

use std::path::Path;
use std::time::Duration;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{EVERY, Frames, LENGTHS, Steps, Watched, app, begin, frames, now, on_a_sheet, range};
use crate::support::{place, set_weights, spawn};

#[test]
fn a_step_after_very_many_frames_sees_all_their_motion() {
    // The last one has 144 frames in each step.
    for (rate, lengths) in [(10.0, LENGTHS[0]), (4.0, LENGTHS[1]), (1.0, LENGTHS[0])] {
        let (mut app, surface, ball) = on_a_sheet(Steps::Fixed(rate), lengths, Collider::ball(0.5));
        let a_second = if matches!(lengths, Frames::Every(length) if length < 0.01) {
            144
        } else {
            60
        };
        frames(&mut app, lengths, 5 * a_second);
        let since = begin(&mut app, surface, |time| [0.5 * time, 0.0]);
        frames(&mut app, lengths, 8 * a_second);
        let seen = &app.world().resource::<Watched>().steps;
        let last = seen.len() - (3.0 * rate) as usize;
        let (low, high) = range(seen[last..].iter().map(|(_, velocity)| velocity.y));
        assert!(low > 0.49 && high < 0.51, "{rate} steps a second: {low} to {high}");
        let behind = 0.5 * (now(&app) - since) - (place(&app, ball).y - 0.5);
        assert!(
            behind.abs() < 0.5 * (1.5 / rate as f32 + 0.05),
            "{rate} steps a second: {behind} behind"
        );
    }
}

#[test]
fn very_many_steps_in_a_frame_throw_nothing() {
    for steps in EVERY {
        let lengths = LENGTHS[1];
        let (mut app, surface, ball) = on_a_sheet(steps, lengths, Collider::ball(0.5));
        app.world_mut()
            .resource_mut::<Time<Virtual>>()
            .set_max_delta(Duration::from_secs(10));
        let since = begin(&mut app, surface, |time| [0.05 * time, 0.0]);
        frames(&mut app, lengths, 60);
        frames(&mut app, Frames::Every(4.0), 1);
        frames(&mut app, lengths, 120);
        let seen = &app.world().resource::<Watched>().steps;
        let (_, fastest) = range(seen.iter().map(|(_, velocity)| velocity.y));
        assert!(fastest < 0.06, "{steps:?}: thrown at {fastest}");
        let rests = place(&app, ball).y - 0.5;
        let expected = 0.05 * (now(&app) - since);
        assert!(
            (rests - expected).abs() < 0.01,
            "{steps:?}: at {rests}, not at {expected}"
        );
    }
}

#[test]
fn what_changes_while_time_is_set_back_throws_nothing() {
    for by in [0.02, 0.2] {
        let lengths = LENGTHS[1];
        let (mut app, surface, ball) = on_a_sheet(Steps::Fixed(64.0), lengths, Collider::ball(0.5));
        app.insert_resource(Time::<Fixed>::from_hz(64.0));
        set_weights(&mut app, surface, &[by, 0.0]);
        frames(&mut app, lengths, 120);
        let seen = &app.world().resource::<Watched>().steps;
        let (_, highest) = range(seen.iter().map(|(place, _)| place.y));
        assert!(highest < 0.51 + by, "thrown to {highest} by {by}");
        let rests = place(&app, ball).y;
        assert!((rests - 0.5 - by).abs() < 1e-2, "it rests at {rests} after {by}");
    }
}

#[test]
fn what_flies_past_the_rim_in_a_long_frame_is_not_put_back() {
    let mut app = app(Path::new("."), Steps::Interpolated);
    spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    frames(&mut app, Frames::Every(1.0 / 60.0), 10);
    // A straight line from its start to its end would cross the sheet, which ends at 4.
    let ball = body(&mut app, Collider::ball(0.01), Vec3::new(3.8, 0.08, 0.05));
    app.world_mut()
        .entity_mut(ball)
        .insert(Velocity::linear(Vec3::new(3.0, -0.5, 0.0)));
    frames(&mut app, Frames::Every(0.2), 1);
    frames(&mut app, Frames::Every(1.0 / 60.0), 5);
    let at = place(&app, ball);
    assert!(at.x > 4.3 && at.y < -0.1, "{at}");
}
