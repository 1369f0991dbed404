//! The crates in the character's way, and the rays that are cast at it.

use std::f32::consts::TAU;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::act::{PERIOD, ROUND, on_round};
use super::{Moment, Tally};

/// A crate, and whether it has been kicked since it was last put in the way.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Crate {
    kicked: bool,
}

/// Marks a ray hit; it stays on the skin.
#[derive(Component, Clone, Copy, Debug)]
pub struct Dart;

/// Half extents of the ground.
pub const GROUND: Vec3 = Vec3::new(4.0, 0.1, 4.0);
/// Half extent of a crate.
pub const HALF: f32 = 0.1;
const CRATES: usize = 12;
/// Seconds between rays.
const EVERY: f32 = 0.25;

pub(super) fn spawn(mut commands: Commands) {
    commands.spawn((
        Collider::cuboid(GROUND.x, GROUND.y, GROUND.z),
        Transform::from_xyz(0.0, -GROUND.y, 0.0),
    ));
    for index in 0..CRATES {
        commands.spawn((
            Crate::default(),
            RigidBody::Dynamic,
            Collider::cuboid(HALF, HALF, HALF),
            Velocity::default(),
            in_the_way(index),
        ));
    }
}

/// A place on the circle, but not where the character stands at first; alternately on the left and
/// on the right.
fn in_the_way(index: usize) -> Transform {
    let angle = TAU * (index as f32 + 1.5) / (CRATES as f32 + 2.0);
    let aside = if index.is_multiple_of(2) {
        1.0 + 0.09 / ROUND
    } else {
        1.0 - 0.09 / ROUND
    };
    Transform::from_translation(on_round(angle) * aside + Vec3::Y * HALF).with_rotation(Quat::from_rotation_y(angle))
}

/// Counts kicks: crates that move while the character walks.
pub(super) fn watch(mut crates: Query<(&mut Crate, &Velocity)>, mut tally: ResMut<Tally>) {
    for (mut kicked, velocity) in &mut crates {
        if !kicked.kicked && velocity.linear.length() > 0.7 {
            kicked.kicked = true;
            tally.kicks += 1;
        }
    }
}

/// Puts all crates in the way again at the start of each round.
pub(super) fn bring_back(
    moment: Res<Moment>,
    mut round: Local<i32>,
    mut crates: Query<(&mut Crate, &mut Transform, &mut Velocity)>,
) {
    let now = (moment.seconds / PERIOD).floor() as i32;
    if std::mem::replace(&mut *round, now) == now {
        return;
    }
    for (index, (mut kicked, mut place, mut velocity)) in crates.iter_mut().enumerate() {
        *kicked = Crate::default();
        *place = in_the_way(index);
        *velocity = Velocity::default();
    }
}

/// The random source of rays, and when the next one is cast.
#[derive(Resource, Debug)]
pub struct Aim {
    rng: Pcg64Mcg,
    next: f32,
}

impl Default for Aim {
    fn default() -> Self {
        Self {
            rng: Pcg64Mcg::seed_from_u64(4),
            next: 0.5,
        }
    }
}

impl Aim {
    /// The next ray, if it is time for one: from a random point around these bounds to a random point within them.
    pub fn ray(&mut self, seconds: f32, center: Vec3, size: Vec3) -> Option<Ray3d> {
        // After the clock has jumped, skipped rays are not made up for.
        if seconds < self.next {
            return None;
        }
        self.next = seconds + EVERY;
        let mut within = |reach: f32| self.rng.random_range(-reach..=reach);
        let aside = Vec3::new(within(1.0), 0.3 * within(1.0), 0.6 + within(1.0)).normalize_or_zero();
        let spread = Vec3::new(0.1, 0.4 * size.y, 0.1);
        let target = center + spread * Vec3::new(within(1.0), within(1.0), within(1.0));
        let direction = Dir3::new(-aside).ok()?;
        Some(Ray3d::new(target + 3.0 * aside, direction))
    }
}
