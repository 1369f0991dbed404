//! The hat in a fixed-step game. It is on the head in every drawn frame, whether or not a step was
//! run.

use bevy::math::{Affine3A, DVec3};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::oracle::{point_distance, posed_vertices, world_vertices};

use super::programs::hat::{Hat, game};
use super::{head, play_until, program, weights};

#[test]
fn the_hat_is_on_the_head_in_every_frame() {
    let head = head();
    let mut app = program(MorphPlugins.in_schedule(FixedPostUpdate), game);
    let mut hats = app
        .world_mut()
        .query_filtered::<&GlobalTransform, (With<Hat>, With<MorphSurfaceAnchor>)>();
    play_until(&mut app, |world| {
        world
            .query_filtered::<(), (With<Hat>, With<MorphSurfaceAnchor>)>()
            .iter(world)
            .count()
            > 0
    });
    // More frames than steps.
    let frame = Time::<Fixed>::default().timestep().mul_f32(0.4);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    let mut meshes = app
        .world_mut()
        .query_filtered::<&GlobalTransform, With<MorphCollider>>();
    let (mut places, mut on_head, mut raised) = (Vec::<Vec3>::new(), Vec::<Vec3>::new(), Vec::<f32>::new());
    for frame in 0..400 {
        app.update();
        let weights = weights(&mut app);
        let posed = posed_vertices(&head.positions, &head.targets, &weights);
        let place: Affine3A = meshes.single(app.world()).expect("there is one mesh").affine();
        let world = world_vertices(&posed, &place);
        let hat = *hats.single(app.world()).expect("there is one hat");
        let at = hat.translation().as_dvec3();
        let corners = |triangle: &[u32; 3]| triangle.map(|v| world[v as usize]);
        let nearest = head
            .triangles
            .iter()
            .map(|triangle| (point_distance(at, &corners(triangle)), triangle));
        let (distance, triangle) = nearest.min_by(|a, b| a.0.total_cmp(&b.0)).expect("it has triangles");
        assert!(distance < 1e-5, "frame {frame}: {distance} off the head");
        let [a, b, c] = corners(triangle);
        let normal: DVec3 = (b - a).cross(c - a).normalize();
        assert!(
            hat.up().as_dvec3().dot(normal) > 0.999,
            "frame {frame}: upright on the surface"
        );
        assert!(at.y > 7.0 && hat.up().y > 0.2, "frame {frame}: on top, at {at}");
        places.push(hat.translation());
        on_head.push(place.inverse().transform_point3(hat.translation()));
        raised.extend(weights.iter().copied().max_by(f32::total_cmp));
    }
    let moved = places.windows(2).filter(|two| two[0].distance(two[1]) > 1e-5).count();
    assert!(moved > 350, "the head nods in nearly all frames: {moved}");
    let farthest = on_head.iter().map(|at| at.distance(on_head[0])).fold(0.0, f32::max);
    assert!(farthest > 2e-3, "frowns move it on the head: {farthest}");
    assert!(raised.iter().any(|&w| w > 0.9), "and it frowns");
}
