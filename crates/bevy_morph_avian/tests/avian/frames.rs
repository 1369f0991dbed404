//! Surfaces that are animated once a frame, with any frame and step lengths.

use std::time::Duration;

use avian3d::prelude::*;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use morph_collision_workspace::physics::{settle, sheet};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::log::start;
use crate::support::{body, place, spawn, unfinished};

/// The upward velocities of a ball, step by step.
#[derive(Resource)]
struct Watched {
    ball: Entity,
    velocities: Vec<f32>,
}

fn watch(mut watched: If<ResMut<Watched>>, bodies: Query<&LinearVelocity>) {
    let velocity = bodies.get(watched.ball).unwrap().y;
    watched.velocities.push(velocity);
}

fn frames(app: &mut App, (shortest, longest): (f64, f64), count: usize) {
    let mut random = Pcg64::seed_from_u64(5);
    for _ in 0..count {
        let length = shortest + random.random::<f64>() * (longest - shortest);
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f64(length)));
        app.update();
    }
}

#[test]
fn what_is_animated_once_a_frame_pushes_at_its_own_speed_in_every_step() {
    let every = |length: f64| (length, length);
    let lengths = [
        every(1.0 / 144.0),
        every(1.0 / 60.0),
        every(1.0 / 30.0),
        (1.0 / 144.0, 1.0 / 30.0),
    ];
    for lengths in lengths {
        let mut app = unfinished();
        app.insert_resource(Time::<Fixed>::from_hz(64.0))
            .add_systems(FixedLast, watch);
        start(&mut app);
        let surface = spawn(&mut app, &sheet(16), ());
        settle(&mut app);
        let ball = body(&mut app, Collider::sphere(0.5), Vec3::new(0.1, 0.5, 0.05));
        frames(&mut app, lengths, 90);
        let since = app.world().resource::<Time<Virtual>>().elapsed_secs();
        let height = move |time: &Time<Virtual>| 0.5 * (time.elapsed_secs() - since);
        app.add_systems(
            Update,
            move |mut weights: Query<&mut MeshMorphWeights>, time: Res<Time<Virtual>>| {
                let weights_now = vec![height(&time), 0.0];
                *weights.get_mut(surface).unwrap() = MeshMorphWeights::Value { weights: weights_now };
            },
        );
        app.insert_resource(Watched {
            ball,
            velocities: Vec::new(),
        });
        frames(&mut app, lengths, 250);
        let speeds = &app.world().resource::<Watched>().velocities[30..];
        assert!(speeds.len() > 50);
        let low = speeds.iter().copied().fold(f32::MAX, f32::min);
        let high = speeds.iter().copied().fold(f32::MIN, f32::max);
        assert!(
            low > 0.49 && high < 0.51,
            "{lengths:?}: velocities from {low} to {high}"
        );
        let behind = (height(app.world().resource::<Time<Virtual>>()) - (place(&app, ball).y - 0.5)) / 0.5;
        assert!((-0.02..0.08).contains(&behind), "{lengths:?}: {behind} s behind");
    }
}
