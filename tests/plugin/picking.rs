//! The picking backend: pointers' rays against posed meshes.

use bevy::camera::visibility::RenderLayers;
use bevy::ecs::message::MessageCursor;
use bevy::picking::backend::PointerHits;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::surface::MorphPickingSettings;

use morph_collision_workspace::app::headless;

use crate::log::start;
use crate::support::{Edits, add_mesh, assets, set_weight, settle, spawn, stretching_cube};

struct Picked {
    app: App,
    camera: Entity,
    cubes: [Entity; 2],
    hits: MessageCursor<PointerHits>,
}

impl Picked {
    /// Two stretching cubes at 0 and 4, and a pointer whose ray comes from +X.
    fn new() -> Self {
        let mut app = headless(&assets());
        app.init_resource::<RayMap>()
            .add_message::<PointerHits>()
            .add_plugins(MorphPickingPlugin);
        start(&mut app);
        let mesh = add_mesh(&mut app, &stretching_cube());
        let cubes = [spawn(&mut app, &mesh, 0.0), spawn(&mut app, &mesh, 4.0)];
        let camera = app.spawn(Camera { order: 3, ..default() });
        settle(&mut app);
        let ray = Ray3d::new(Vec3::new(9.0, 0.1, 0.2), Dir3::NEG_X);
        let id = RayId::new(camera, PointerId::Mouse);
        app.world_mut().resource_mut::<RayMap>().map.insert(id, ray);
        let mut picked = Self {
            app,
            camera,
            cubes,
            hits: MessageCursor::default(),
        };
        picked.read();
        picked
    }

    fn read(&mut self) -> Vec<PointerHits> {
        self.hits.read(self.app.world().resource()).cloned().collect()
    }

    /// The entities under the pointer in the next frame, nearest first.
    fn over(&mut self) -> Vec<(Entity, f32)> {
        self.app.update();
        let hits = self.read();
        assert!(hits.len() <= 1);
        let picks = hits.into_iter().flat_map(|hits| hits.picks);
        picks.map(|(entity, hit)| (entity, hit.depth)).collect()
    }
}

#[test]
fn the_morphed_surface_is_hit() {
    let mut picked = Picked::new();
    let [_, b] = picked.cubes;
    assert_eq!(picked.over(), [(b, 4.5)]);
    set_weight(&mut picked.app, b, 2.0);
    // Picking runs first in a frame, so it sees what the last frame drew.
    picked.app.update();
    picked.read();
    picked.app.update();
    let hits = picked.read().remove(0);
    assert_eq!((hits.pointer, hits.order), (PointerId::Mouse, 3.0));
    let (entity, hit) = &hits.picks[0];
    assert_eq!((*entity, hit.depth, hit.camera), (b, 2.5, picked.camera));
    assert_eq!(
        (hit.position, hit.normal),
        (Some(Vec3::new(6.5, 0.1, 0.2)), Some(Vec3::X))
    );
    let pick = hit.extra_as::<MorphPick>().expect("it tells more");
    assert!(pick.triangle < 12 && (pick.barycentrics.element_sum() - 1.0).abs() < 1e-6);
    assert_eq!(pick.uv, None, "the cube has none");
}

#[test]
fn pickable_says_what_is_hovered_and_what_blocks() {
    let mut picked = Picked::new();
    let [a, b] = picked.cubes;
    let through = Pickable {
        should_block_lower: false,
        is_hoverable: true,
    };
    picked.app.world_mut().entity_mut(b).insert(through);
    assert_eq!(picked.over(), [(b, 4.5), (a, 8.5)]);
    picked.app.world_mut().entity_mut(b).insert(Pickable::IGNORE);
    assert_eq!(picked.over(), [(a, 8.5)]);
    picked
        .app
        .world_mut()
        .resource_mut::<MorphPickingSettings>()
        .require_pickable = true;
    assert_eq!(picked.over(), []);
    picked.app.world_mut().entity_mut(a).insert(Pickable::default());
    assert_eq!(picked.over(), [(a, 8.5)]);
}

#[test]
fn render_layers_and_visibility_are_heeded() {
    let mut picked = Picked::new();
    let [a, b] = picked.cubes;
    picked.app.world_mut().entity_mut(b).insert(RenderLayers::layer(5));
    assert_eq!(picked.over(), [(a, 8.5)]);
    let camera = picked.camera;
    picked.app.world_mut().entity_mut(camera).insert(RenderLayers::layer(5));
    assert_eq!(picked.over(), [(b, 4.5)]);
    picked.app.world_mut().entity_mut(b).insert(ViewVisibility::HIDDEN);
    assert_eq!(picked.over(), []);
}

#[test]
fn a_shell_is_not_picked_from_inside_unless_asked_for() {
    let mut picked = Picked::new();
    let [a, b] = picked.cubes;
    let id = RayId::new(picked.camera, PointerId::Mouse);
    let inside = Ray3d::new(Vec3::new(4.0, 0.1, 0.2), Dir3::NEG_X);
    picked.app.world_mut().resource_mut::<RayMap>().map.insert(id, inside);
    assert_eq!(picked.over(), [(a, 3.5)]);
    picked.app.world_mut().resource_mut::<MorphPickingSettings>().back_faces = true;
    assert_eq!(picked.over(), [(b, 0.5)]);
}

#[test]
fn picks_come_in_the_order_of_hits() {
    let mut picked = Picked::new();
    picked.cubes.sort();
    let [a, b] = picked.cubes;
    // Nearer by less than a rounding of the distance, and then at the same place.
    for (scale, first) in [(1.0 + f32::EPSILON, b), (1.0, a)] {
        let place = Transform::from_scale(Vec3::splat(scale));
        picked.app.world_mut().entity_mut(b).insert(place);
        picked.app.world_mut().entity_mut(a).insert(Transform::IDENTITY);
        for cube in [a, b] {
            let see_through = Pickable {
                should_block_lower: false,
                is_hoverable: true,
            };
            picked.app.world_mut().entity_mut(cube).insert(see_through);
        }
        picked.app.update();
        picked.read();
        let second = if first == a { b } else { a };
        assert_eq!(picked.over(), [(first, 8.5), (second, 8.5)]);
    }
}
