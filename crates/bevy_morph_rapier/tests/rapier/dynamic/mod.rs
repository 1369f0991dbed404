//! Morphing surfaces on dynamic bodies: they throw and carry, and their bodies react.

mod carries;
mod odd;
mod throws;
mod told;

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::physics::{body, settle};

use crate::support::{app, place, run, slab, slab_cut, spawn};

/// Half extents of a slab.
pub(super) const HALF: Vec3 = Vec3::new(1.0, 0.25, 1.0);

/// A dynamic body with this mass, whose surface is a mesh.
pub(super) fn spawn_on(app: &mut App, mesh: &MorphMesh, mass: f32, at: Vec3, more: impl Bundle) -> Entity {
    let weight = AdditionalMassProperties::MassProperties(mass_of(mass, HALF));
    let body = (
        RigidBody::Dynamic,
        Velocity::default(),
        ColliderMassProperties::Density(0.0),
        weight,
    );
    let rest = (Transform::from_translation(at), Sleeping::disabled());
    // It must not fall before it has a surface.
    let entity = spawn(app, mesh, (body, rest, GravityScale(0.0)));
    settle(app);
    app.world_mut()
        .entity_mut(entity)
        .insert(GravityScale(1.0))
        .insert(more);
    entity
}

/// The mass properties of a cuboid.
pub(super) fn mass_of(mass: f32, half: Vec3) -> MassProperties {
    let square = half * half;
    MassProperties {
        mass,
        principal_inertia: mass / 3.0 * (Vec3::splat(square.element_sum()) - square),
        ..default()
    }
}

/// A slab in a world without gravity.
pub(super) fn floating(mass: f32) -> (App, Entity) {
    let mut app = app();
    let surface = spawn_on(&mut app, &slab(HALF), mass, Vec3::ZERO, GravityScale(0.0));
    (app, surface)
}

/// A slab that lies on the ground, with its upper side at `2 * HALF.y`.
pub(super) fn grounded(mass: f32) -> (App, Entity) {
    let mut app = app();
    app.world_mut()
        .spawn((Collider::cuboid(50.0, 0.5, 50.0), Transform::from_xyz(0.0, -0.5, 0.0)));
    // It falls a little.
    let surface = spawn_on(&mut app, &slab_cut(HALF, 2), mass, Vec3::Y * (HALF.y + 0.01), ());
    run(&mut app, 90);
    assert!(
        (place(&app, surface).y - HALF.y).abs() < 1e-2,
        "{}",
        place(&app, surface)
    );
    (app, surface)
}

/// A body that does not sleep.
pub(super) fn thing(app: &mut App, collider: Collider, mass: f32, at: Vec3, more: impl Bundle) -> Entity {
    let thing = body(app, collider, at);
    app.world_mut()
        .entity_mut(thing)
        .insert((ColliderMassProperties::Mass(mass), Sleeping::disabled(), more));
    thing
}
