//! Statistics, counted after every step.

use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use bevy_rapier3d::rapier::geometry::Collider as RapierCollider;

use super::ABYSS;
use super::player::Player;
use super::rain::Falling;

/// The player's statistics.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Steps since it first stood on something.
    pub steps: u32,
    /// Steps after which it was on the ground, according to Rapier's controller.
    pub grounded: u32,
    /// Steps after which the hill was below its feet.
    pub on_hill: u32,
    /// How far it has walked, seen from above.
    pub walked: f32,
    /// Its position after the step before.
    before: Option<Vec3>,
}

impl Tally {
    /// The share `of` of the steps, in 0..=1.
    #[must_use]
    pub fn share(&self, of: u32) -> f32 {
        of as f32 / self.steps.max(1) as f32
    }
}

pub(super) fn count_ground(
    players: Query<(&Transform, &KinematicCharacterControllerOutput, &MorphCharacterGround), With<Player>>,
    mut tally: ResMut<Tally>,
) {
    for (place, output, ground) in &players {
        if tally.steps == 0 && !output.grounded {
            continue;
        }
        tally.steps += 1;
        tally.grounded += u32::from(output.grounded);
        tally.on_hill += u32::from(ground.surface.is_some());
        let before = tally.before.replace(place.translation).unwrap_or(place.translation);
        tally.walked += before.xz().distance(place.translation.xz());
    }
}

/// Finds bodies whose centres went through the hill's physics surface, or that the hill has risen above.
pub(super) fn find_fallen_through(
    mut bodies: Query<(&Transform, &mut Falling)>,
    surfaces: Query<(), With<MorphPhysicsCollider>>,
    context: ReadRapierContext,
) {
    let Ok(context) = context.single() else { return };
    let is_surface = |entity: Entity, _: &RapierCollider| surfaces.contains(entity);
    let filter = QueryFilter::new().predicate(&is_surface);
    for (place, mut falling) in &mut bodies {
        let at = place.translation;
        let Some(before) = falling.before.replace(at) else {
            continue;
        };
        let hits =
            |way: Vec3, from: Vec3| way != Vec3::ZERO && context.cast_ray(from, way, 1.0, false, filter).is_some();
        falling.through |= hits(at - before, before) || hits(ABYSS.abs() * Vec3::Y, at);
    }
}
