//! The rain: balls and boxes that fall on the hill, roll off, and fall again.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::hill::Hill;
use super::{ABYSS, Game};

/// A falling body.
#[derive(Component, Clone, Copy, Debug)]
pub struct Falling {
    /// Its index.
    pub number: u32,
    /// Its shape.
    pub form: Form,
    /// Its position after the last step; `None` before the first step and after it was moved
    /// elsewhere.
    pub(super) before: Option<Vec3>,
    /// Whether its centre went through the hill.
    pub through: bool,
    /// Where it started to fall.
    from: Vec3,
}

/// A body's shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A ball of this radius.
    Ball(f32),
    /// A cuboid with these half extents.
    Cuboid(Vec3),
}

/// Spawns all bodies in the air when the game begins.
pub(super) fn spawn(mut commands: Commands, game: Res<Game>, hill: Single<&Hill>) {
    let mut rng = Pcg64Mcg::seed_from_u64(game.seed);
    let Vec2 { x: reach, y: top } = hill.reach;
    for number in 0..game.bodies {
        let mut within = |reach: f32| rng.random_range(-reach..=reach);
        let from = Vec3::new(
            within(0.6 * reach),
            top + 1.5 + 0.08 * number as f32,
            within(0.5 * reach),
        );
        let size = 0.19 + within(0.07);
        let form = match number % 2 {
            0 => Form::Ball(size),
            _ => Form::Cuboid(size * Vec3::new(1.0, 0.8, 0.6)),
        };
        let collider = match form {
            Form::Ball(radius) => Collider::ball(radius),
            Form::Cuboid(half) => Collider::cuboid(half.x, half.y, half.z),
        };
        commands.spawn((
            Falling {
                number,
                form,
                before: None,
                through: false,
                from,
            },
            RigidBody::Dynamic,
            collider,
            Velocity::default(),
            // Damping as on grass, so that rolling bodies come to rest.
            Damping {
                angular_damping: 1.0,
                ..default()
            },
            Ccd { enabled: game.ccd },
            Transform::from_translation(from),
            Visibility::default(),
        ));
    }
}

/// Puts bodies that have left the ground back into the air.
pub(super) fn bring_back(mut bodies: Query<(&mut Falling, &mut Transform, &mut Velocity)>) {
    for (mut falling, mut place, mut velocity) in &mut bodies {
        if place.translation.y < ABYSS {
            place.translation = falling.from;
            *velocity = Velocity::default();
            falling.before = None;
        }
    }
}
