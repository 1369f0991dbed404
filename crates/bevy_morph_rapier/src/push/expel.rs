//! Drives bodies out of solid surfaces.

use bevy::math::Vec3;
use bevy_rapier3d::parry::bounding_volume::Aabb;
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::ColliderHandle;

use super::filtered_bodies::FilteredBodies;
use super::material::ContactMaterial;
use super::movers::Mover;
use super::step::Step;
use super::world::World;
use bevy_morph_physics::moving::MovingSurface;
use bevy_morph_physics::push::{Drive, EnclosedCollider, Exit, Expelling, SolidSurface};

/// If a collider is inside a surface that pushes with parts, drives it out. Returns whether it is inside.
pub(crate) fn drive_out(
    expelling: &mut Expelling<ColliderHandle>,
    mover: &Mover,
    moving: &mut MovingSurface,
    material: &ContactMaterial,
    step: &Step,
    world: &mut World,
) -> bool {
    let Some(enclosed) = enclosed(mover, material, world) else {
        return false;
    };
    let Some(outward) = moving.surface.lock().outward() else {
        return false;
    };
    let travelled = moving.travelled_before();
    let exit = moving.at_start(|pose, world_from_model| {
        let surface = SolidSurface {
            pose,
            world_from_model,
            travelled,
            outward: f64::from(outward),
        };
        expelling.exit(mover.nearby.collider, &enclosed, surface, drive(step))
    });
    let Some(exit) = exit else { return false };
    if let Some(body) = world.bodies.get_mut(mover.nearby.body) {
        let change = exit.change_of(body.linvel(), moving);
        if change != Vec3::ZERO {
            body.apply_impulse(change * body.mass(), true);
            world.islands.wake_up(world.bodies, mover.nearby.body, true);
        }
    }
    true
}

/// Drives everything out of a surface on a dynamic body. That body is driven the other way.
pub(crate) fn drive_apart(
    expelling: &mut Expelling<ColliderHandle>,
    collider: ColliderHandle,
    moving: &mut MovingSurface,
    material: &ContactMaterial,
    filtered_bodies: &FilteredBodies,
    step: &Step,
    world: &mut World,
) {
    let (local, outward, in_collider): (Aabb, _, _) = {
        let mut posed = moving.surface.lock();
        (posed.bounds(), posed.outward(), posed.collider_from_model)
    };
    let (Some(outward), Some(own), Some(isometry)) = (outward, step.body, isometry_of(collider, world)) else {
        expelling.stop();
        return;
    };
    expelling.begin(Some(&in_collider));
    let bounds = local.transform_by(&isometry);
    let own_rests = !moving.moves && world.bodies.get(own).is_some_and(RigidBody::is_sleeping);
    let mut meeting = Vec::new();
    for mover in step.movers.meeting(&bounds, &mut meeting) {
        let nearby = &mover.nearby;
        if nearby.body == own || !mover.groups.test(material.groups) || filtered_bodies.contains(nearby.body) {
            continue;
        }
        if nearby.asleep && own_rests {
            expelling.keep(nearby.collider);
            continue;
        }
        // Before the surface is locked, because the other shape may be the same surface.
        let Some(mut enclosed) = enclosed(mover, material, world) else {
            continue;
        };
        if let Some(own) = world.bodies.get(own) {
            let turns = own.angvel().length() * own.center_of_mass().distance(enclosed.center.as_vec3());
            enclosed.reach += f64::from((own.linvel().length() + turns) * step.params.dt) + 0.1 * enclosed.size;
        }
        // All of this is in the collider's space, which moves with the body.
        enclosed.center = isometry.inverse_transform_point(enclosed.center.as_vec3()).as_dvec3();
        let travelled = moving.travelled();
        let mut posed = moving.surface.lock();
        let surface = SolidSurface {
            pose: posed.pose.get(),
            world_from_model: &in_collider,
            travelled,
            outward: f64::from(outward),
        };
        let exit = expelling.exit(nearby.collider, &enclosed, surface, drive(step));
        drop(posed);
        if let Some(exit) = exit {
            let direction = (isometry.rotation * exit.direction.as_vec3()).normalize_or_zero();
            separate(world, [nearby.body, own], direction, &exit);
        }
    }
    expelling.forget();
}

/// A collider as seen by a surface that may drive it out. `None` if its groups forbid that.
fn enclosed(mover: &Mover, material: &ContactMaterial, world: &World) -> Option<EnclosedCollider> {
    let collider = world.colliders.get(mover.nearby.collider)?;
    if !collider.solver_groups().test(material.solver_groups) {
        return None;
    }
    let isometry = isometry_of(mover.nearby.collider, world)?;
    EnclosedCollider::of(collider.shape(), &isometry, mover.nearby.bounds.extents().length())
}

/// Where a collider is. If the game moved its body, its colliders follow only in the step.
fn isometry_of(collider: ColliderHandle, world: &World) -> Option<Isometry> {
    let collider = world.colliders.get(collider)?;
    let Some(body) = collider.parent().and_then(|body| world.bodies.get(body)) else {
        return Some(*collider.position());
    };
    Some(*body.position() * collider.position_wrt_parent().copied().unwrap_or_default())
}

fn drive(step: &Step) -> Drive {
    Drive {
        limit: step.expel_speed,
        dt: step.params.dt,
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
