//! The state that a web page gets from a demo, and touch input.

use std::collections::BTreeMap;

use bevy::camera::NormalizedRenderTarget;
use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::morph::MorphWeights;
use bevy::picking::pointer::{Location, PointerAction, PointerButton, PointerId, PointerInput};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::demos;
use morph_collision_workspace::view::offscreen::Offscreen;
use morph_collision_workspace::view::page::{self, Hand, PageState};
use morph_collision_workspace::view::sliders::Sliders;
use morph_collision_workspace::view::stage::StageCamera;

use crate::support::{alone, frame, offscreen};

const SIZE: (u32, u32) = (320, 180);

#[test]
fn a_page_is_told_what_the_show_is_at() {
    let _alone = alone();
    let mut demo = offscreen(demos::pass_through(), SIZE);
    let page_state = PageState::default();
    page::plugin(demo.app_mut().insert_resource(page_state.clone()));
    demo.jump(100);
    demo.advance(4);
    let state = page_state.now();
    let diagnostics = *demo.app_mut().world().resource::<MorphCollisionDiagnostics>();
    assert_eq!((state.show, state.started, state.drawn), ("pass_through", true, 4));
    assert_eq!(state.frame, frame(&mut demo));
    assert_eq!((state.colliders, state.touching, state.events), (2, 1, 1));
    assert!(state.triangle_pairs > 0 && state.red > 0);
    assert_eq!(state.triangle_pairs, diagnostics.triangle_pairs);
    assert!(state.weights.iter().any(|&weight| weight != 0.0));
    assert_eq!(state.trouble, None);
}

#[test]
fn a_page_sets_weights_and_gives_them_back() {
    let _alone = alone();
    let mut demo = offscreen(demos::pass_through(), SIZE);
    let (page_state, hand) = (PageState::default(), Hand::default());
    page::plugin(
        demo.app_mut()
            .insert_resource(page_state.clone())
            .insert_resource(hand.clone()),
    );
    demo.jump(100);
    demo.advance(2);
    let own = page_state.now();
    assert_eq!(own.targets.len(), own.weights.len());
    let by_hand = vec![0.25, -0.5];
    hand.set(Some(by_hand.clone()));
    demo.advance(2);
    assert_eq!(page_state.now().weights, by_hand);
    assert!(page_state.now().in_hand);
    let models = |weights: Query<&MorphWeights>| -> Vec<Vec<f32>> {
        weights.iter().map(|weights| weights.weights().to_vec()).collect()
    };
    let drawn = demo.app_mut().world_mut().run_system_once(models).unwrap();
    assert!(
        !drawn.is_empty() && drawn.iter().all(|weights| *weights == by_hand),
        "{drawn:?}"
    );
    hand.set(None);
    demo.advance(2);
    assert_ne!(page_state.now().weights, by_hand);
    // Another model takes the place of the one that they are for.
    hand.set(Some(by_hand));
    demo.advance(2);
    demo.app_mut().insert_resource(Sliders::default());
    demo.advance(2);
    assert!(!page_state.now().in_hand);
    assert_eq!(page_state.now().targets, own.targets);
}

/// The materials of all models that can be clicked.
fn materials(demo: &mut Offscreen) -> BTreeMap<Entity, AssetId<StandardMaterial>> {
    let all = |drawn: Query<(Entity, &MeshMaterial3d<StandardMaterial>), With<MorphCollider>>| -> BTreeMap<_, _> {
        drawn
            .iter()
            .map(|(entity, material)| (entity, material.0.id()))
            .collect()
    };
    demo.app_mut().world_mut().run_system_once(all).unwrap()
}

/// Presses a pointer at one place, moves it to another, and releases it.
fn stroke(demo: &mut Offscreen, from: Vec2, to: Vec2) {
    let pointer = PointerId::Custom(bevy::asset::uuid::Uuid::from_u128(7));
    let world = demo.app_mut().world_mut();
    let mut cameras = world.query_filtered::<&bevy::camera::RenderTarget, With<StageCamera>>();
    let bevy::camera::RenderTarget::Image(image) = cameras.single(world).unwrap().clone() else {
        panic!("the demo is drawn into an image");
    };
    world.spawn(pointer);
    let button = PointerButton::Primary;
    for (position, action) in [
        (from, PointerAction::Move { delta: Vec2::ONE }),
        (from, PointerAction::Press(button)),
        (to, PointerAction::Move { delta: to - from }),
        (to, PointerAction::Release(button)),
    ] {
        let location = Location {
            target: NormalizedRenderTarget::Image(image.clone()),
            position,
        };
        let world = demo.app_mut().world_mut();
        world.write_message(PointerInput::new(pointer, location, action));
        demo.advance(2);
    }
}

#[test]
fn a_click_paints_and_a_drag_does_not() {
    let _alone = alone();
    let mut demo = offscreen(demos::picking(), SIZE);
    demo.advance(4);
    // On the body in the middle.
    let at = Vec2::new(175.0, 85.0);
    let before = materials(&mut demo);
    stroke(&mut demo, at, at + Vec2::X * 20.0);
    assert_eq!(materials(&mut demo), before, "a drag that ends on the model");
    stroke(&mut demo, at, at + Vec2::X * 3.0);
    let after = materials(&mut demo);
    let painted = before.iter().filter(|&(entity, color)| after[entity] != *color).count();
    assert_eq!(painted, 1, "a click of a hand that is not quite still");
}
