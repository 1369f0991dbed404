//! Drives bodies out of solid surfaces.

use bevy::math::Vec3;
use bevy_rapier3d::parry::bounding_volume::Aabb;
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::ColliderHandle;

use super::spared::Spared;
use super::world::{Manners, Mover, Step, World};
use crate::physics::expel::{Drive, Exit, Expelling, Guest};
use crate::physics::follow::Following;

/// If a collider is inside a surface that pushes with parts, drives it out. Returns whether it is inside.
pub(super) fn drive_out(
    expelling: &mut Expelling<ColliderHandle>,
    mover: &Mover,
    following: &mut Following,
    manners: &Manners,
    step: &Step,
    world: &mut World,
) -> bool {
    let Some(guest) = guest(mover, manners, world) else {
        return false;
    };
    let Some(outward) = following.surface.lock().outward() else {
        return false;
    };
    let travelled = following.travelled_before();
    let exit = following.at_begin(|pose, place| {
        let at = (pose, place);
        expelling.exit(
            mover.visitor.collider,
            &guest,
            at,
            travelled,
            f64::from(outward),
            drive(step),
        )
    });
    let Some(exit) = exit else { return false };
    if let Some(body) = world.bodies.get_mut(mover.visitor.body) {
        let change = exit.change_of(body.linvel(), following);
        if change != Vec3::ZERO {
            body.apply_impulse(change * body.mass(), true);
            world.islands.wake_up(world.bodies, mover.visitor.body, true);
        }
    }
    true
}

/// Drives everything out of a surface on a dynamic body. That body is driven the other way.
pub(super) fn drive_apart(
    expelling: &mut Expelling<ColliderHandle>,
    collider: ColliderHandle,
    following: &mut Following,
    manners: &Manners,
    spared: &Spared,
    step: &Step,
    world: &mut World,
) {
    let (local, outward, in_collider): (Aabb, _, _) = {
        let mut posed = following.surface.lock();
        (posed.bounds(), posed.outward(), posed.collider_from_model)
    };
    let (Some(outward), Some(own), Some(place)) = (outward, step.body, place_of(collider, world)) else {
        expelling.stop();
        return;
    };
    expelling.begin(Some(&in_collider));
    let travelled = following.travelled;
    let bounds = local.transform_by(&place);
    let own_rests = !following.moves && world.bodies.get(own).is_some_and(RigidBody::is_sleeping);
    let mut meeting = Vec::new();
    for mover in step.movers.meeting(&bounds, &mut meeting) {
        let visitor = &mover.visitor;
        if visitor.body == own || !mover.groups.test(manners.groups) || spared.contains(visitor.body) {
            continue;
        }
        if visitor.asleep && own_rests {
            expelling.keep(visitor.collider);
            continue;
        }
        // Before the surface is locked, because the other shape may be the same surface.
        let Some(mut guest) = guest(mover, manners, world) else {
            continue;
        };
        if let Some(own) = world.bodies.get(own) {
            let turns = own.angvel().length() * own.center_of_mass().distance(guest.center.as_vec3());
            guest.reach += f64::from((own.linvel().length() + turns) * step.pace.dt) + 0.1 * guest.size;
        }
        // All of this is in the collider's space, which moves with the body.
        guest.center = place.inverse_transform_point(guest.center.as_vec3()).as_dvec3();
        let exit = expelling.exit(
            visitor.collider,
            &guest,
            (&mut following.surface.lock().pose, &in_collider),
            travelled,
            f64::from(outward),
            drive(step),
        );
        if let Some(exit) = exit {
            let direction = (place.rotation * exit.direction.as_vec3()).normalize_or_zero();
            separate(world, [visitor.body, own], direction, &exit);
        }
    }
    expelling.forget();
}

/// A collider as seen by a surface that may drive it out. `None` if its groups forbid that.
fn guest(mover: &Mover, manners: &Manners, world: &World) -> Option<Guest> {
    let collider = world.colliders.get(mover.visitor.collider)?;
    if !collider.solver_groups().test(manners.solver_groups) {
        return None;
    }
    let place = place_of(mover.visitor.collider, world)?;
    Guest::of(collider.shape(), &place, mover.visitor.bounds.extents().length())
}

/// The place of a collider. If the game moved its body, its colliders follow only in the step.
fn place_of(collider: ColliderHandle, world: &World) -> Option<Place> {
    let collider = world.colliders.get(collider)?;
    let Some(body) = collider.parent().and_then(|body| world.bodies.get(body)) else {
        return Some(*collider.position());
    };
    Some(*body.position() * collider.position_wrt_parent().copied().unwrap_or_default())
}

fn drive(step: &Step) -> Drive {
    Drive {
        limit: step.leaving,
        dt: step.pace.dt,
    }
}

/// Moves one body away from another along a direction. The other body gets the opposite impulse.
fn separate(world: &mut World, bodies: [RigidBodyHandle; 2], direction: Vec3, exit: &Exit) {
    let [Some(first), Some(second)] = bodies.map(|body| world.bodies.get(body)) else {
        return;
    };
    if first.mass() == 0.0 || second.mass() == 0.0 {
        // Rapier has not computed its mass yet.
        return;
    }
    let at = first.center_of_mass();
    let yields = |body: &RigidBody| {
        let mass = body.mass_properties();
        let turns = (at - body.center_of_mass()).cross(direction);
        direction.dot(mass.effective_inv_mass * direction) + turns.dot(mass.effective_world_inv_inertia * turns)
    };
    let relative = first.velocity_at_point(at) - second.velocity_at_point(at);
    let change = exit.change(f64::from(direction.dot(relative))) as f32;
    let impulse = change / (yields(first) + yields(second));
    if impulse == 0.0 || !impulse.is_finite() {
        return;
    }
    for (body, impulse) in bodies.into_iter().zip([impulse, -impulse]) {
        if let Some(body) = world.bodies.get_mut(body) {
            body.apply_impulse_at_point(impulse * direction, at, true);
        }
        world.islands.wake_up(world.bodies, body, true);
    }
}
