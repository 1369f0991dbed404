//! Closed surfaces with an inside.

use bevy::prelude::*;
use bevy_morph_physics::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::support::{
    Collider, DRIVEN, GravityScale, app, ball, body, collect_errors, cuboid, diagnostics, flying, place, run,
    set_weights, shapes, slab, spawn, velocity,
};

pub(crate) const SOLID: MorphPhysicsCollider = MorphPhysicsCollider {
    max_acceleration: 100.0,
    solid: true,
};

/// The speed at which bodies leave the inside.
pub(crate) const LEAVES: f32 = DRIVEN / 3.0;

pub(crate) const SLAB: Vec3 = Vec3::new(2.0, 0.5, 2.0);

/// A slab in physics, solid or not.
pub(crate) fn with_slab(half: Vec3, solid: bool, more: impl Bundle) -> (App, Entity) {
    let mut app = app();
    let slab = spawn(&mut app, &slab(half), more);
    app.world_mut()
        .entity_mut(slab)
        .insert(MorphPhysicsCollider { solid, ..SOLID });
    settle(&mut app);
    (app, slab)
}

pub(crate) fn floating(app: &mut App, collider: Collider, at: Vec3) -> Entity {
    let body = body(app, collider, at);
    app.world_mut().entity_mut(body).insert(GravityScale(0.0));
    body
}

/// How deep a point is inside a slab, over all axes; negative outside.
pub(crate) fn depth(at: Vec3, half: Vec3) -> f32 {
    (half - at.abs()).min_element()
}

/// Lets a body leave. Returns after how many steps it is out and away, its highest speed, and its speed when its middle came out.
pub(crate) fn leave(app: &mut App, body: Entity, half: Vec3) -> (usize, f32, f32) {
    let (mut fastest, mut at_the_door): (f32, Option<f32>) = (0.0, None);
    for step in 1..=240 {
        run(app, 1);
        let speed = velocity(app, body).length();
        fastest = fastest.max(speed);
        let depth = depth(place(app, body), half);
        if depth < 0.0 {
            at_the_door.get_or_insert(speed);
        }
        if depth < -0.19 {
            return (step, fastest, at_the_door.unwrap_or_default());
        }
    }
    panic!("it is still in, at {}", place(app, body));
}

#[test]
fn what_is_spawned_inside_is_driven_out() {
    for at in [
        Vec3::new(0.1, 0.15, 0.05),
        Vec3::new(0.1, -0.15, 0.05),
        Vec3::new(1.6, 0.02, -0.3),
        Vec3::new(0.0, 1e-3, 0.0),
    ] {
        for shape in shapes() {
            let (mut app, _) = with_slab(SLAB, true, ());
            let body = floating(&mut app, shape, at);
            let (steps, fastest, leaves) = leave(&mut app, body, SLAB);
            let way = place(&app, body) - at;
            println!("{at}: {steps} steps, {fastest}/s, leaves at {leaves}/s, {way}");
            assert!(steps < 60, "{steps} steps from {at}");
            assert!(fastest < 1.02 * DRIVEN, "{fastest} from {at}");
            assert!((0.5 * LEAVES..1.2 * LEAVES).contains(&leaves), "{leaves} from {at}");
            // Straight out through the nearest side.
            let nearest = if at.x > 1.0 { Vec3::X } else { Vec3::Y * at.y.signum() };
            assert!(way.normalize().dot(nearest) > 0.99, "{way} from {at}");
            // It continues without another push.
            run(&mut app, 10);
            assert!(velocity(&app, body).length() < 1.2 * LEAVES, "{}", velocity(&app, body));
        }
    }
}

#[test]
fn what_is_inside_a_surface_that_is_not_solid_stays() {
    for shape in shapes() {
        let (mut app, _) = with_slab(SLAB, false, ());
        let at = Vec3::new(0.1, 0.1, 0.05);
        let inside = floating(&mut app, shape, at);
        run(&mut app, 60);
        assert_eq!(place(&app, inside), at);
    }
}

#[test]
fn what_a_jump_swallows_leaves_by_the_way_it_came() {
    // The slab jumps up, so that the box is then nearer to its lower side.
    let half = Vec3::new(2.0, 0.25, 2.0);
    let (mut app, surface) = with_slab(half, true, ());
    let cuboid = body(&mut app, cuboid(Vec3::splat(0.15)), Vec3::new(0.1, 0.41, 0.05));
    run(&mut app, 60);
    assert!((place(&app, cuboid).y - 0.4).abs() < 1e-2);
    set_weights(&mut app, surface, &[0.55, 0.0, 0.0, 0.0]);
    let (mut fastest, mut highest): (f32, f32) = (0.0, 0.0);
    for _ in 0..120 {
        run(&mut app, 1);
        fastest = fastest.max(velocity(&app, cuboid).length());
        highest = highest.max(place(&app, cuboid).y);
    }
    println!("{fastest}/s, up to {highest}");
    assert!(fastest < 1.02 * DRIVEN && highest < 1.05, "{fastest}, {highest}");
    let rests = place(&app, cuboid).y;
    assert!((rests - 0.95).abs() < 1e-2, "{rests}");
}

#[test]
fn a_mesh_that_is_not_closed_is_not_solid_and_the_log_says_so_once() {
    collect_errors(|errors| {
        let mut app = app();
        let open = spawn(&mut app, &sheet(16), Name::new("a sheet"));
        app.world_mut().entity_mut(open).insert(SOLID);
        settle(&mut app);
        let mut warnings = errors.take_warnings();
        let below = floating(&mut app, ball(0.3), Vec3::new(0.1, -0.31, 0.05));
        app.world_mut().entity_mut(below).insert(flying(Vec3::Y));
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
        assert_eq!(diagnostics(&app).surfaces, 1);
        assert_eq!(errors.take_warnings(), [""; 0]);
    });
}
