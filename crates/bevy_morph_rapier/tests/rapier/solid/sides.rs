//! Which side of a surface is outside: meshes that are open, mirrored, or inside out.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle, sheet};

use super::{SLAB, SOLID, depth, floating, leave, with_slab};
use crate::support::{app, collect_errors, place, run, set_weights, slab, spawn};

#[test]
fn a_mesh_that_is_not_closed_is_not_solid_and_the_log_says_so_once() {
    collect_errors(|errors| {
        let mut app = app();
        let open = spawn(&mut app, &sheet(16), Name::new("a sheet"));
        app.world_mut().entity_mut(open).insert(SOLID);
        settle(&mut app);
        let mut warnings = errors.take_warnings();
        let below = floating(&mut app, Collider::ball(0.3), Vec3::new(0.1, -0.31, 0.05));
        app.world_mut().entity_mut(below).insert(Velocity::linear(Vec3::Y));
        for i in 0..30 {
            set_weights(&mut app, open, &[1e-3 * i as f32, 0.0]);
            run(&mut app, 1);
        }
        warnings.extend(errors.take_warnings());
        let [warning] = &warnings[..] else {
            panic!("{warnings:?}")
        };
        assert!(
            warning.contains("a sheet") && warning.contains("not closed"),
            "{warning}"
        );
        // From below it is as solid as from above.
        assert!(place(&app, below).y < -0.25, "{}", place(&app, below));
        // A closed one gives no warning.
        app.world_mut().despawn(open);
        let closed = spawn(&mut app, &slab(SLAB), ());
        app.world_mut().entity_mut(closed).insert(SOLID);
        settle(&mut app);
        run(&mut app, 5);
        assert!(app.world().get::<RapierColliderHandle>(closed).is_some());
        assert_eq!(errors.take_warnings(), [""; 0]);
    });
}

#[test]
fn mirrored_and_inverted_slabs_push_outward() {
    let scales = [
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(1.0, -1.0, 1.0),
        Vec3::splat(-1.0),
        Vec3::ONE,
    ];
    for scale in scales {
        for inverted in [false, true] {
            let mut app = app();
            let mut mesh = slab(SLAB);
            if inverted {
                mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
            }
            let place_of_slab = Transform::from_xyz(0.2, -0.1, 0.0)
                .with_rotation(Quat::from_rotation_y(0.3))
                .with_scale(scale);
            let surface = spawn(&mut app, &mesh, place_of_slab);
            app.world_mut().entity_mut(surface).insert(SOLID);
            settle(&mut app);
            let rests = body(&mut app, Collider::cuboid(0.2, 0.2, 0.2), Vec3::new(0.3, 0.62, 0.3));
            let inside = floating(&mut app, Collider::ball(0.2), Vec3::new(-0.5, 0.1, -0.5));
            run(&mut app, 90);
            let what = format!("{scale}, {inverted}");
            assert!(
                (place(&app, rests).y - 0.6).abs() < 1e-2,
                "{what}: {}",
                place(&app, rests)
            );
            assert!(place(&app, inside).y > 0.59, "{what}: {}", place(&app, inside));
            // Mirrored again while something lies on it.
            app.world_mut()
                .entity_mut(surface)
                .insert(place_of_slab.with_scale(scale * Vec3::new(1.0, 1.0, -1.0)));
            run(&mut app, 30);
            assert!(
                (place(&app, rests).y - 0.6).abs() < 1e-2,
                "{what}: {}",
                place(&app, rests)
            );
        }
    }
}

#[test]
fn contacts_push_outward_alone_wherever_the_surface_comes_from() {
    // A ball that sticks through the lower side of the slab. A thin surface would push it on.
    let (mut app, surface) = with_slab(SLAB, true, ());
    let low = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, -0.45, 0.05));
    run(&mut app, 60);
    assert!(place(&app, low).y < -0.69, "{}", place(&app, low));
    // The slab is now twice as thick. A ball inside it comes out at the nearest side, not at the far
    // one.
    set_weights(&mut app, surface, &[0.0, 1.0, 0.0, 0.0]);
    run(&mut app, 2);
    let high = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 1.2, 0.05));
    run(&mut app, 60);
    assert!(place(&app, high).y > 1.69, "{}", place(&app, high));
}

#[test]
fn a_collapsed_slab_grows_around_a_body_and_lets_it_out() {
    let (mut app, surface) = with_slab(SLAB, true, Transform::from_scale(Vec3::ZERO));
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.1, 0.05));
    run(&mut app, 5);
    app.world_mut().entity_mut(surface).insert(Transform::default());
    let (steps, ..) = leave(&mut app, ball, SLAB);
    assert!(steps < 60, "{steps}");
    // Its own targets reduce its thickness to nothing, and back.
    let (mut app, surface) = with_slab(SLAB, true, ());
    set_weights(&mut app, surface, &[0.0, 0.0, 0.0, 1.0]);
    run(&mut app, 5);
    set_weights(&mut app, surface, &[0.0; 4]);
    let ball = floating(&mut app, Collider::ball(0.2), Vec3::new(0.1, 0.1, 0.05));
    leave(&mut app, ball, SLAB);
    assert!(depth(place(&app, ball), SLAB) < 0.0);
}
