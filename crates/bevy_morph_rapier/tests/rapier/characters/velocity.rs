//! The velocities of surfaces, for a game's own character controllers.

use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_rapier::MorphRapierVelocity;
use bevy_rapier3d::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};
use morph_collision_workspace::physics::{DT, body, settle, sheet};

use crate::support::{app, global, run, set_weights, spawn};

/// Runs a system once that queries [`MorphRapierVelocity`].
fn ask<T: Send + 'static>(app: &mut App, ask: impl Fn(&mut MorphRapierVelocity) -> T + Send + Sync + 'static) -> T {
    let system = move |mut surfaces: MorphRapierVelocity| ask(&mut surfaces);
    app.world_mut()
        .run_system_once(system)
        .expect("its parameters are there")
}

/// The place of a point of a mesh.
fn point(mesh: &MorphMesh, weights: &[f32], place: &GlobalTransform, triangle: u32, shares: Vec3) -> DVec3 {
    let world = world_vertices(
        &posed_vertices(&mesh.positions, &mesh.targets, weights),
        &place.affine(),
    );
    let corners = mesh.triangles[triangle as usize].map(|corner| world[corner as usize]);
    (0..3).map(|i| corners[i] * f64::from(shares[i])).sum()
}

/// A sheet with a bulge, so that no two points move the same way.
fn bulging() -> MorphMesh {
    let mut mesh = sheet(16);
    let bulge = mesh
        .positions
        .iter()
        .map(|p| Vec3::Y * (-p.length_squared() / 4.0).exp());
    let bulge = bulge.collect();
    mesh.targets.push(bulge);
    mesh
}

#[test]
fn velocities_are_finite_differences() {
    for kinematic in [false, true] {
        let mesh = bulging();
        let mut app = app();
        let place = Transform::from_xyz(0.3, -0.2, 0.1)
            .with_rotation(Quat::from_rotation_z(0.3))
            .with_scale(Vec3::new(1.0, 1.5, 0.7));
        let surface = spawn(&mut app, &mesh, place);
        if kinematic {
            app.world_mut()
                .entity_mut(surface)
                .insert(RigidBody::KinematicPositionBased);
        }
        settle(&mut app);
        let (mut last, mut worst): (Option<(Vec<f32>, GlobalTransform)>, f64) = (None, 0.0);
        for frame in 1..=40 {
            let time = DT * frame as f32;
            let weights = vec![(3.0 * time).sin(), time, 0.5 * (5.0 * time).cos()];
            set_weights(&mut app, surface, &weights);
            app.world_mut().get_mut::<Transform>(surface).unwrap().rotation = Quat::from_rotation_z(0.3 + time);
            run(&mut app, 1);
            let now = global(&app, surface);
            if let Some((before, from)) = last.replace((weights.clone(), now)).filter(|_| frame > 3) {
                for triangle in [0, 100, 271, 411] {
                    let shares = Vec3::new(0.2, 0.5, 0.3);
                    let at = |weights: &[f32], place| point(&mesh, weights, place, triangle, shares);
                    let truth = (at(&weights, &now) - at(&before, &from)) / f64::from(DT);
                    let (said, near) = ask(&mut app, {
                        let here = at(&weights, &now).as_vec3();
                        move |surfaces| {
                            (
                                surfaces.velocity_at(surface, triangle, shares),
                                surfaces.surface_velocity(surface, here),
                            )
                        }
                    });
                    for said in [said.unwrap(), near.unwrap()] {
                        worst = worst.max((said.as_dvec3() - truth).length() / truth.length().max(1.0));
                    }
                }
            }
        }
        assert!(worst < 1e-3, "{kinematic}: {worst}");
    }
}

#[test]
fn nothing_else_has_a_velocity_of_a_surface() {
    let mut app = app();
    let surface = spawn(&mut app, &sheet(8), ());
    let rides = spawn(
        &mut app,
        &sheet(8),
        (RigidBody::Dynamic, Transform::from_xyz(0.0, 50.0, 0.0)),
    );
    settle(&mut app);
    let ball = body(&mut app, Collider::ball(0.3), Vec3::Y);
    run(&mut app, 2);
    let asked = ask(&mut app, move |surfaces| {
        let at = |surfaces: &mut MorphRapierVelocity, entity| surfaces.velocity_at(entity, 0, Vec3::X);
        [
            at(surfaces, surface),
            at(surfaces, ball),
            at(surfaces, rides),
            surfaces.velocity_at(surface, 1_000_000, Vec3::X),
            surfaces.surface_velocity(surface, Vec3::splat(f32::NAN)),
        ]
    });
    assert_eq!(asked, [Some(Vec3::ZERO), None, None, None, None]);
    // A jump does not count as motion.
    set_weights(&mut app, surface, &[0.0, 4.0]);
    run(&mut app, 1);
    let jumps = ask(&mut app, move |surfaces| surfaces.velocity_at(surface, 0, Vec3::X));
    assert_eq!(jumps, Some(Vec3::ZERO));
}
