//! What a user can do to a demo: time, weights, and invalid files.

use std::path::Path;

use bevy::ecs::system::RunSystemOnce;
use bevy::input::ButtonState;
use bevy::input::keyboard::{Key, KeyboardInput, NativeKey};
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_workspace::demos;
use morph_collision_workspace::heaving::{Game, JUMP, Player, SPEED};
use morph_collision_workspace::view::offscreen::Offscreen;
use morph_collision_workspace::view::overlay::Overlay;
use morph_collision_workspace::view::sliders::Sliders;
use morph_collision_workspace::view::stage::StageCamera;

use crate::support::{alone, frame, offscreen};

const SIZE: (u32, u32) = (160, 90);

/// Presses a key in one frame and releases it in the next.
fn press(demo: &mut Offscreen, key_code: KeyCode) {
    for state in [ButtonState::Pressed, ButtonState::Released] {
        set_key(demo, key_code, state);
        demo.advance(1);
    }
}

fn set_key(demo: &mut Offscreen, key_code: KeyCode, state: ButtonState) {
    let world = demo.app_mut().world_mut();
    let window = world.query_filtered::<Entity, With<Window>>().single(world).unwrap();
    world.write_message(KeyboardInput {
        key_code,
        logical_key: Key::Unidentified(NativeKey::Unidentified),
        state,
        text: None,
        repeat: false,
        window,
    });
}

/// How far the demo's time moves in four frames.
fn passed(demo: &mut Offscreen) -> f64 {
    let before = frame(demo);
    demo.advance(4);
    frame(demo) - before
}

#[test]
fn keys_pause_step_and_change_the_speed() {
    let _alone = alone();
    let mut demo = offscreen(demos::pass_through(), SIZE);
    assert!((passed(&mut demo) - 4.0).abs() < 1e-6);
    press(&mut demo, KeyCode::Equal);
    assert!((passed(&mut demo) - 8.0).abs() < 1e-3, "twice as fast");
    press(&mut demo, KeyCode::Minus);
    press(&mut demo, KeyCode::Minus);
    assert!((passed(&mut demo) - 2.0).abs() < 1e-3, "half as fast");
    press(&mut demo, KeyCode::Space);
    assert_eq!(passed(&mut demo), 0.0);
    let before = frame(&mut demo);
    press(&mut demo, KeyCode::Period);
    demo.advance(3);
    assert!((frame(&mut demo) - before - 1.0).abs() < 1e-6, "one step, once");
    press(&mut demo, KeyCode::Space);
    assert!(passed(&mut demo) > 0.0);
    press(&mut demo, KeyCode::KeyT);
    assert!(!demo.app_mut().world().resource::<Overlay>().shown);
}

#[test]
fn keys_walk_as_seen_from_the_camera_jump_and_pause() {
    let _alone = alone();
    let game = Game { bodies: 0, ..default() };
    let mut demo = offscreen(demos::physics(game), SIZE);
    let player = |demo: &mut Offscreen| -> (Vec3, Player) {
        let world = demo.app_mut().world_mut();
        let (place, player) = world.query::<(&Transform, &Player)>().single(world).unwrap();
        (place.translation, *player)
    };
    // It lands and waits.
    demo.advance(70);
    // The camera looks from behind the hill.
    let world = demo.app_mut().world_mut();
    let mut cameras = world.query_filtered::<&mut Transform, With<StageCamera>>();
    *cameras.single_mut(world).unwrap() = Transform::from_xyz(0.0, 4.0, -9.0).looking_at(Vec3::ZERO, Vec3::Y);
    demo.advance(2);
    let keys = [
        (KeyCode::KeyW, Vec2::Y),
        (KeyCode::ArrowDown, Vec2::NEG_Y),
        (KeyCode::KeyD, Vec2::NEG_X),
        (KeyCode::ArrowLeft, Vec2::X),
    ];
    for (key, towards) in keys {
        let (from, _) = player(&mut demo);
        set_key(&mut demo, key, ButtonState::Pressed);
        demo.advance(30);
        let (to, _) = player(&mut demo);
        set_key(&mut demo, key, ButtonState::Released);
        demo.advance(2);
        // Half a second: slower up a slope, and the hill carries it sideways.
        let way = (to - from).xz();
        let (ahead, aside) = (way.dot(towards), way.perp_dot(towards).abs());
        assert!(ahead > 0.25 * SPEED && aside < 0.5, "{key:?}: {way}");
    }
    press(&mut demo, KeyCode::Space);
    demo.advance(8);
    let (_, jumping) = player(&mut demo);
    assert!(jumping.rising > 0.3 * JUMP && jumping.airborne > 0.05, "{jumping:?}");
    demo.advance(90);
    assert_eq!(player(&mut demo).1.airborne, 0.0, "it lands");
    assert!(passed(&mut demo) > 0.0, "Space does not pause");
    press(&mut demo, KeyCode::KeyP);
    assert_eq!(passed(&mut demo), 0.0);
}

#[test]
fn a_hand_on_the_sliders_moves_every_model() {
    let _alone = alone();
    let mut demo = offscreen(demos::dolphins(Path::new("dolphin_564.glb"), 3, false), SIZE);
    let weights = |demo: &mut Offscreen| -> Vec<Vec<f32>> {
        let all = |weights: Query<&MorphWeights>| -> Vec<Vec<f32>> {
            weights.iter().map(|weights| weights.weights().to_vec()).collect()
        };
        demo.app_mut().world_mut().run_system_once(all).unwrap()
    };
    demo.advance(5);
    let names: Vec<String> = {
        let sliders = demo.app_mut().world().resource::<Sliders>();
        sliders.weights.iter().map(|(name, _)| name.clone()).collect()
    };
    assert_eq!(names, ["tail_down", "tail_up"]);
    let played = weights(&mut demo);
    assert!(
        played.iter().any(|weights| weights != &played[0]),
        "each is in another stroke"
    );

    let mut sliders = demo.app_mut().world_mut().resource_mut::<Sliders>();
    sliders.in_hand = true;
    (sliders.weights[0].1, sliders.weights[1].1) = (0.25, -0.5);
    demo.advance(2);
    assert_eq!(weights(&mut demo), vec![vec![0.25, -0.5]; 3]);

    demo.app_mut().world_mut().resource_mut::<Sliders>().in_hand = false;
    demo.advance(2);
    assert!(
        weights(&mut demo).iter().all(|weights| weights[1] >= 0.0),
        "they swim on"
    );
}

#[test]
fn a_file_that_is_no_good_ends_the_show_with_its_name() {
    let _alone = alone();
    let folder = std::env::temp_dir().join("morph_collision_controls");
    std::fs::create_dir_all(&folder).unwrap();
    let broken = folder.join("broken.glb");
    std::fs::write(&broken, b"no glTF").unwrap();
    let game = Game {
        model: broken.clone(),
        ..default()
    };
    for demo in [
        demos::dolphins(&broken, 2, true),
        demos::crowd(&broken, 2, true),
        demos::physics(game),
    ] {
        let error = Offscreen::new(demo, SIZE, true).unwrap_err().to_string();
        // The message says what is wrong, not only that nothing was loaded.
        assert!(error.contains("broken.glb") && !error.contains('\n'), "{error}");
    }
}

#[test]
fn a_model_that_does_not_morph_is_refused() {
    let _alone = alone();
    let rigid = morph_collision_models::generated::rigid::box_mesh(Vec3::ONE);
    let file = std::env::temp_dir().join("morph_collision_controls_rigid.glb");
    std::fs::write(&file, to_glb(&rigid, &Appearance::default()).unwrap()).unwrap();
    let mut demo = offscreen(demos::dolphins(&file, 2, true), SIZE);
    demo.advance(2);
    let error = demo.picture().unwrap_err().to_string();
    assert!(
        error.contains("rigid.glb") && error.contains("morph targets"),
        "{error}"
    );
    assert_eq!(
        demo.app_mut().world().resource::<MorphCollisionDiagnostics>().colliders,
        0
    );
}
