//! Which side of a surface is outside: meshes that are open, mirrored, or inside out.

use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::{body, settle};

use crate::any_engine::solid::{SLAB, SOLID, depth, floating, leave, with_slab};
use crate::support::{app, place, run, set_weights, slab, spawn};

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
