//! The player: a capsule that follows the user's input, and walks in a circle while there is none.

use std::f32::consts::{PI, TAU};

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;

use super::hill::Hill;
use super::{ABYSS, RATE};

/// The capsule: half the length of its straight part, and its radius.
pub const HALF_SEGMENT: f32 = 0.36;
/// See [`HALF_SEGMENT`].
pub const RADIUS: f32 = 0.27;
/// How fast it walks, in units per second.
pub const SPEED: f32 = 2.2;
/// Its upward speed at the start of a jump.
pub const JUMP: f32 = 5.0;
/// After this many seconds without input it goes for a walk.
pub const IDLE: f32 = 2.0;

const GRAVITY: f32 = 9.81;
/// The speed that presses it to the ground while it stands, so that it follows ground that sinks.
const PRESS: f32 = 1.0;
/// It may still jump for this many seconds after its feet have left the ground.
const GRACE: f32 = 0.1;
/// The radius of its circle, as a fraction of the hill's reach.
const CIRCLE: f32 = 0.42;
/// How fast it turns towards its walking direction, per second.
const TURN: f32 = 12.0;

/// The user's input.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Wish {
    /// Walking direction in world space; its length is at most 1.
    pub walk: Vec2,
    /// Whether to jump in the next step.
    pub jump: bool,
}

/// The walking player.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Player {
    /// Its own vertical velocity from gravity and jumps.
    pub rising: f32,
    /// The direction it looks in, as an angle about `+Y`; 0 is `+Z`.
    pub facing: f32,
    /// Seconds since the last input.
    pub idle: f32,
    /// Seconds since its feet were on the ground.
    pub airborne: f32,
}

/// Where it starts: above a point of its circle.
fn start(hill: &Hill) -> Vec3 {
    let at = CIRCLE * hill.reach.x * Vec2::new(-0.8, 0.6);
    Vec3::new(at.x, hill.reach.y + 0.3, at.y)
}

pub(super) fn spawn(mut commands: Commands, hill: Single<&Hill>) {
    commands.spawn((
        Name::new("player"),
        Player::default(),
        // It pushes other bodies like any kinematic body.
        RigidBody::KinematicPositionBased,
        Collider::capsule_y(HALF_SEGMENT, RADIUS),
        KinematicCharacterController {
            // It wades through dynamic bodies rather than stopping at them.
            filter_flags: QueryFilterFlags::EXCLUDE_DYNAMIC | QueryFilterFlags::EXCLUDE_SENSORS,
            ..default()
        },
        // A jump keeps the velocity of the ground.
        MorphCharacterCarry {
            keep_velocity: true,
            ..default()
        },
        Transform::from_translation(start(&hill)),
        Visibility::default(),
    ));
}

/// Brings a player who has left the ground back up.
pub(super) fn bring_back(mut players: Query<(&mut Transform, &mut Player)>, hill: Single<&Hill>) {
    for (mut place, mut player) in &mut players {
        if place.translation.y < ABYSS {
            place.translation = start(&hill);
            player.rising = 0.0;
        }
    }
}

/// Tells its controller where to go in the next step.
pub(super) fn walk(
    mut players: Query<(
        &Transform,
        &mut Player,
        &mut KinematicCharacterController,
        Option<&KinematicCharacterControllerOutput>,
    )>,
    hill: Single<&Hill>,
    mut wish: ResMut<Wish>,
) {
    let dt = (1.0 / RATE) as f32;
    let jump = std::mem::take(&mut wish.jump);
    for (place, mut player, mut controller, output) in &mut players {
        let is_wished = jump || wish.walk != Vec2::ZERO;
        player.idle = if is_wished { 0.0 } else { player.idle + dt };
        let walk = match player.idle > IDLE {
            true => around(place.translation.xz(), CIRCLE * hill.reach.x),
            false => wish.walk.clamp_length_max(1.0),
        };

        let grounded = output.is_some_and(|output| output.grounded);
        player.airborne = if grounded { 0.0 } else { player.airborne + dt };
        // An obstacle above its head ends a jump.
        let bumped = output.is_some_and(|output| output.effective_translation.y < 0.5 * output.desired_translation.y);
        player.rising = match player.rising > 0.0 {
            true if bumped => 0.0,
            false if grounded => -PRESS,
            _ => player.rising - GRAVITY * dt,
        };
        if jump && player.airborne < GRACE {
            player.rising = JUMP;
            // Prevents a second jump in the air.
            player.airborne = GRACE;
        }

        let step = SPEED * walk;
        controller.translation = Some(dt * Vec3::new(step.x, player.rising, step.y));
        if walk.length() > 0.1 {
            // Turns the shorter way around.
            let turn = (walk.x.atan2(walk.y) - player.facing + PI).rem_euclid(TAU) - PI;
            player.facing += turn * (TURN * dt).min(1.0);
        }
    }
}

/// The direction along a circle around the middle, from any point.
fn around(at: Vec2, radius: f32) -> Vec2 {
    let out = at.normalize_or(Vec2::X);
    let back = (1.5 * (1.0 - at.length() / radius)).clamp(-1.0, 1.0);
    (back * out - out.perp()).normalize_or_zero()
}
