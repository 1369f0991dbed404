//! An engine in any schedule, and plugins in any order: it works, or the log says what to write.

use std::path::Path;
use std::time::Duration;

use bevy::ecs::schedule::ScheduleLabel;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use morph_collision_workspace::app::without_collisions;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::{Errors, start};
use crate::support::{ball, body, place, run, spawn, velocity};

/// A schedule of the game's own.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Own;

/// A way to put an app together.
pub(crate) type Setup = (&'static str, fn(&mut App));

/// A way to put an app together in which physics cannot feel a mesh, and what the log must name.
pub(crate) type Broken = (&'static str, fn(&mut App), &'static str);

/// Starts an app with one step of 1/64 s in each frame, a sheet and a ball at rest on it. Returns the sheet and the ball.
pub(crate) fn ball_on_a_sheet(set_up: fn(&mut App)) -> (App, Entity, Entity) {
    let mut app = without_collisions(Path::new("."));
    set_up(&mut app);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(1.0 / 64.0)));
    start(&mut app);
    let surface = spawn(&mut app, &sheet(16), ());
    settle(&mut app);
    let ball = body(&mut app, ball(0.5), Vec3::new(0.1, 0.51, 0.05));
    run(&mut app, 40);
    (app, surface, ball)
}

/// Each setup carries a ball as fast as the sheet rises, and logs nothing.
pub(crate) fn works_in_any_schedule_and_in_any_order(setups: &[Setup]) {
    Errors::collect(|errors| {
        for &(name, set_up) in setups {
            let (mut app, surface, ball) = ball_on_a_sheet(set_up);
            let height = place(&app, ball).y;
            assert!((height - 0.5).abs() < 1e-2, "{name}: at rest at {height}");
            app.add_systems(
                Update,
                move |mut weights: Query<&mut MeshMorphWeights>, time: Res<Time>, mut height: Local<f32>| {
                    *height += 0.5 * time.delta_secs();
                    let weights_now = vec![*height, 0.0];
                    *weights.get_mut(surface).unwrap() = MeshMorphWeights::Value { weights: weights_now };
                },
            );
            run(&mut app, 60);
            let speed = velocity(&app, ball).y;
            assert!((speed - 0.5).abs() < 0.01, "{name}: {speed}");
            assert_eq!(errors.take(), Vec::<String>::new(), "{name}");
            assert_eq!(errors.take_warnings(), Vec::<String>::new(), "{name}");
        }
    });
}

/// Each setup is logged once, with the name.
pub(crate) fn is_told_once(broken: &[Broken]) {
    Errors::collect(|errors| {
        for &(name, set_up, names) in broken {
            let mut app = without_collisions(Path::new("."));
            set_up(&mut app);
            start(&mut app);
            for _ in 0..2 {
                spawn(&mut app, &sheet(2), ());
                run(&mut app, 5);
            }
            let said = [errors.take(), errors.take_warnings()].concat();
            assert_eq!(said.len(), 1, "{name}: {said:?}");
            assert!(said[0].contains(names), "{name}: {said:?}");
        }
    });
}
