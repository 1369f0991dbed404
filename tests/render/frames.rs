//! Each example draws what its description says.

use std::path::Path;

use bevy::ecs::system::RunSystemOnce;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use image::RgbImage;
use morph_collision_workspace::character::{Dart, HandOnFace, Tally};
use morph_collision_workspace::demos;
use morph_collision_workspace::heaving::{Falling, Game, Player};
use morph_collision_workspace::view::Demo;
use morph_collision_workspace::view::offscreen::Offscreen;
use morph_collision_workspace::view::pointer::Script;
use morph_collision_workspace::view::stage::{Notes, StageCamera};
use morph_collision_workspace::view::volumes::show_volumes;

use crate::support::{alone, count, frame, is_drawn, is_red, offscreen};

const SIZE: (u32, u32) = (320, 180);

/// A picture of a frame, and one a little later. Both must demo something, and something must move.
fn watch(demo: Demo, at: u32) -> (Offscreen, RgbImage) {
    let mut demo = offscreen(demo, SIZE);
    // Leaves time for clicks, and for bodies to fall.
    demo.advance(at.min(20));
    demo.jump(at - 1);
    demo.advance(1);
    let first = demo.picture().unwrap();
    assert_eq!(frame(&mut demo).round(), f64::from(at));
    let pixels = count(&first, is_drawn);
    let share = pixels as f64 / f64::from(SIZE.0 * SIZE.1);
    assert!((0.02..0.98).contains(&share), "{pixels} pixels are drawn on");
    demo.advance(10);
    let second = demo.picture().unwrap();
    let moved = first.pixels().zip(second.pixels()).filter(|(a, b)| a != b).count();
    assert!(moved > 50, "{moved} pixels differ after ten frames");
    (demo, first)
}

#[test]
fn dolphins_touch() {
    let _alone = alone();
    let (mut demo, picture) = watch(demos::dolphins(Path::new("dolphin_564.glb"), 12, false), 60);
    let touching = demo.app_mut().world().resource::<MorphCollisions>().len();
    assert!(touching > 0, "none of twelve touch");
    assert!(count(&picture, is_red) > 5, "nothing is red");
}

#[test]
fn bodies_pass_through_each_other() {
    let _alone = alone();
    let (_, picture) = watch(demos::pass_through(), 120);
    assert!(count(&picture, is_red) > 10, "nothing is red");
}

#[test]
fn a_face_runs_into_itself_and_wears_pins() {
    let _alone = alone();
    let (mut demo, picture) = watch(demos::face(), 60);
    assert!(count(&picture, is_red) > 5, "nothing is red");
    let world = demo.app_mut().world_mut();
    let regions = world.query::<&MorphSelfCollisions>().single(world).unwrap().regions();
    assert!(!regions.is_empty(), "a speaking mouth touches itself");
    // Each pin is on its triangle, wherever that has moved.
    let off = |pins: Query<(&MorphSurfaceAnchor, &GlobalTransform)>, spatial: MorphSpatialQuery| -> Vec<f32> {
        let off = |(anchor, place): (&MorphSurfaceAnchor, &GlobalTransform)| {
            let corners = spatial.posed_triangle(anchor.collider, anchor.triangle).unwrap();
            let [u, v, w] = anchor.barycentrics.to_array();
            place
                .translation()
                .distance(corners[0] * u + corners[1] * v + corners[2] * w)
        };
        pins.iter().map(off).collect()
    };
    let off = world.run_system_once(off).unwrap();
    assert!(
        off.len() == 4 && off.iter().all(|&off| off < 1e-4),
        "{off:?} off the skin"
    );
}

#[test]
fn a_character_touches_its_face_wears_darts_and_kicks_crates() {
    let _alone = alone();
    let (mut demo, picture) = watch(demos::character(), 66);
    // The face is small in such a small picture.
    assert!(count(&picture, is_red) > 0, "nothing is red");
    let world = demo.app_mut().world_mut();
    let pairs = world.query::<&HandOnFace>().single(world).unwrap().0.len();
    assert!(pairs > 0, "the hand is on the face");
    // It walks into the crates.
    demo.advance(130);
    let world = demo.app_mut().world_mut();
    assert_eq!(world.query::<&HandOnFace>().single(world).unwrap().0.len(), 0);
    let tally = world.resource::<Tally>().clone();
    assert!(
        tally.kicks > 0 && tally.hits > 1 && tally.last_hit.is_some(),
        "{tally:?}"
    );
    let off = |darts: Query<(&MorphSurfaceAnchor, &GlobalTransform), With<Dart>>, spatial: MorphSpatialQuery| {
        let off = |(anchor, place): (&MorphSurfaceAnchor, &GlobalTransform)| {
            let corners = spatial.posed_triangle(anchor.collider, anchor.triangle).unwrap();
            let [u, v, w] = anchor.barycentrics.to_array();
            place
                .translation()
                .distance(corners[0] * u + corners[1] * v + corners[2] * w)
        };
        darts.iter().map(off).collect::<Vec<f32>>()
    };
    let off = world.run_system_once(off).unwrap();
    assert!(
        off.len() as u32 == tally.hits && off.iter().all(|&off| off < 1e-4),
        "{off:?} off the skin"
    );
}

#[test]
fn a_skinned_model_is_pointed_at_where_its_joints_put_it() {
    let _alone = alone();
    let (mut demo, _) = watch(demos::picking(), 136);
    demo.advance(4);
    let notes = demo.app_mut().world().resource::<Notes>().0.clone();
    let said = |name: &str| notes.iter().find(|(of, _)| *of == name).map(|(_, value)| value.clone());
    assert_eq!(
        said("pointed at").as_deref(),
        Some("mh_character_low.skin"),
        "{notes:?}"
    );
    assert!(
        said("joint").is_some_and(|joint| joint.starts_with("spine")),
        "{notes:?}"
    );
}

#[test]
fn pointed_at_is_what_is_drawn() {
    let _alone = alone();
    let (mut demo, _) = watch(demos::picking(), 60);
    // The arrow is under the pointer, on the model's current shape.
    let offset = |arrow: Single<&GlobalTransform, With<demos::Arrow>>,
                  camera: Single<(&Camera, &GlobalTransform), With<StageCamera>>,
                  script: Res<Script>| {
        let on_screen = |at| camera.0.world_to_viewport(camera.1, at).unwrap();
        on_screen(arrow.translation()).distance(on_screen(script.0[1].at))
    };
    for _ in 0..3 {
        demo.advance(7);
        let offset = demo.app_mut().world_mut().run_system_once(offset).unwrap();
        assert!(offset < 0.5, "the arrow is {offset} pixels from the pointer");
    }
    let world = demo.app_mut().world();
    let notes = &world.resource::<Notes>().0;
    assert!(
        notes.contains(&("pointed at", "pass_through_20480".into())),
        "{notes:?}"
    );
}

#[test]
fn a_player_stands_in_the_rain_on_a_hill_that_heaves() {
    let _alone = alone();
    let game = Game {
        bodies: 20,
        ..default()
    };
    let (mut demo, picture) = watch(demos::physics(game), 20);
    let orange = |picture: &RgbImage, x, y| {
        let [r, g, b] = picture.get_pixel(x, y).0.map(i32::from);
        r > g + 60 && g > b + 10
    };
    let seen = count(&picture, orange);
    assert!(seen > 60, "{seen} pixels of the player are to be seen");
    demo.advance(40);
    let world = demo.app_mut().world_mut();
    let (mut lowest, mut bodies) = (f32::MAX, world.query::<(&Falling, &Transform)>());
    for (_, place) in bodies.iter(world) {
        lowest = lowest.min(place.translation.y);
    }
    assert!(lowest < 1.6, "the lowest of 20 bodies is at {lowest}");
    let ground = *world
        .query_filtered::<&MorphCharacterGround, With<Player>>()
        .single(world)
        .unwrap();
    assert!(ground.surface.is_some() && ground.velocity.y != 0.0, "{ground:?}");
}

#[test]
fn boxes_that_follow_the_morph_keep_what_is_in_sight() {
    let _alone = alone();
    let (mut demo, picture) = watch(demos::culling(), 90);
    let [left, right] =
        [0..160, 160..320].map(|half| count(&picture, |picture, x, y| half.contains(&x) && is_drawn(picture, x, y)));
    assert!(
        left < 50 && right > 1000,
        "{left} pixels on the left, {right} on the right"
    );
    let notes = demo.app_mut().world().resource::<Notes>().0.clone();
    let [(_, bevys), (_, repaired)] = &notes[..] else {
        panic!("{notes:?}")
    };
    assert_eq!((bevys.as_str(), repaired.as_str()), ("0 of 4", "4 of 4"));
}

#[test]
fn a_slap_between_two_frames_leaves_a_mark_on_one_side_only() {
    let _alone = alone();
    let mut demo = offscreen(demos::slap(), SIZE);
    demo.advance(30);
    let red = |demo: &mut Offscreen| {
        let picture = demo.picture().unwrap();
        [0..160, 160..320].map(|half| count(&picture, |picture, x, y| half.contains(&x) && is_red(picture, x, y)))
    };
    assert_eq!(red(&mut demo), [0, 0]);
    // The slap is in frame 36.
    demo.advance(9);
    let [left, right] = red(&mut demo);
    assert!(
        left == 0 && right > 5,
        "{left} red pixels on the left, {right} on the right"
    );
    let notes = demo.app_mut().world().resource::<Notes>().0.clone();
    let [(_, left), (_, right), ..] = &notes[..] else {
        panic!("{notes:?}")
    };
    assert_eq!((left.as_str(), right.as_str()), ("0 of 1 slaps", "1 of 1 slaps"));
}

#[test]
fn a_crowd_is_drawn() {
    let _alone = alone();
    let (mut demo, _) = watch(demos::crowd(Path::new("dolphin_564.glb"), 60, false), 10);
    assert_eq!(
        demo.app_mut().world().resource::<MorphCollisionDiagnostics>().colliders,
        60
    );
}

#[test]
fn bounding_volumes_are_drawn_level_by_level() {
    let _alone = alone();
    let mut demo = offscreen(demos::dolphins(Path::new("dolphin_564.glb"), 3, false), SIZE);
    // Everything that is neither water nor dolphin: lines in the colours of nodes that were refitted, or
    // only drawn.
    let mut lines = |level| {
        show_volumes(demo.app_mut(), level);
        demo.advance(1);
        count(&demo.picture().unwrap(), |picture, x, y| {
            let [r, g, b] = picture.get_pixel(x, y).0.map(i32::from);
            r - b > 60 || b - r > 100 && b - g > 60
        })
    };
    let (none, roots, deep) = (lines(None), lines(Some(0)), lines(Some(2)));
    assert!(
        none < 400 && roots > none + 1000 && deep > roots + 500,
        "{none}, {roots}, {deep} pixels"
    );
}
