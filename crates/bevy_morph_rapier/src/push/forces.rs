//! Contact forces of a whole surface, instead of those of its parts.

use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy_rapier3d::prelude::ContactForceEvent;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{
    Collider, ColliderHandle, ColliderSet, ContactForceEvent as PairForce, NarrowPhase,
};
use bevy_rapier3d::rapier::pipeline::ActiveEvents;

/// Rapier's world after a step.
pub(crate) struct SteppedWorld<'a> {
    pub(crate) narrow_phase: &'a NarrowPhase,
    pub(crate) bodies: &'a RigidBodySet,
    pub(crate) colliders: &'a ColliderSet,
    /// The length of a substep.
    pub(crate) dt: f32,
}

/// The colliders that pressed on a surface by more than their threshold in the last step.
#[derive(Default)]
pub(crate) struct Forces {
    above: HashSet<ColliderHandle>,
}

impl Forces {
    /// Reports the contact force between the surface and each collider that asks for it: Rapier's force for a pair of colliders,
    /// summed over the surface's parts. With several substeps, the last one counts.
    pub(crate) fn report(
        &mut self,
        surface: Entity,
        parts: impl Iterator<Item = ColliderHandle>,
        stepped: &SteppedWorld,
        report: &mut impl FnMut(ContactForceEvent),
    ) {
        let mut sums: HashMap<ColliderHandle, (ContactForceEvent, f32)> = HashMap::default();
        for part in parts {
            let Some(part_collider) = stepped.colliders.get(part) else {
                continue;
            };
            for pair in stepped.narrow_phase.contact_pairs_with(part) {
                let is_first = pair.collider1 == part;
                let other = if is_first { pair.collider2 } else { pair.collider1 };
                let Some(collider) = stepped.colliders.get(other) else {
                    continue;
                };
                let threshold = threshold(part_collider).min(threshold(collider));
                let body = collider.parent().and_then(|body| stepped.bodies.get(body));
                let total = pair.total_impulse_magnitude() / stepped.dt;
                // Sleeping bodies keep the contacts with which they fell asleep.
                if threshold == f32::MAX || total == 0.0 || body.is_some_and(RigidBody::is_sleeping) {
                    continue;
                }
                let Some(entity) = Entity::try_from_bits(collider.user_data as u64) else {
                    continue;
                };
                let force = PairForce::from_contact_pair(stepped.dt, pair, total);
                // The colliders of a pair are in arbitrary order. In the event, the surface comes first.
                let sign = if is_first { 1.0 } else { -1.0 };
                let (sum, _) = sums
                    .entry(other)
                    .or_insert_with(|| (no_force(surface, entity), threshold));
                sum.total_force += sign * force.total_force;
                sum.total_force_magnitude += force.total_force_magnitude;
                if force.max_force_magnitude > sum.max_force_magnitude {
                    sum.max_force_magnitude = force.max_force_magnitude;
                    sum.max_force_direction = sign * force.max_force_direction;
                }
            }
        }
        sums.retain(|_, (sum, threshold)| sum.total_force_magnitude > *threshold);
        for (other, (sum, _)) in &mut sums {
            sum.started = !self.above.contains(other);
            report(*sum);
        }
        self.above.clear();
        self.above.extend(sums.keys().copied());
    }
}

fn no_force(surface: Entity, other: Entity) -> ContactForceEvent {
    ContactForceEvent {
        collider1: surface,
        collider2: other,
        total_force: Vec3::ZERO,
        total_force_magnitude: 0.0,
        max_force_direction: Vec3::ZERO,
        max_force_magnitude: 0.0,
        started: false,
    }
}

/// The force above which a collider wants events.
fn threshold(collider: &Collider) -> f32 {
    let asks = collider.active_events().contains(ActiveEvents::CONTACT_FORCE_EVENTS);
    if asks {
        collider.contact_force_event_threshold()
    } else {
        f32::MAX
    }
}
