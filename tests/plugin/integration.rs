//! How the plugin behaves together with other code: schedules, order, reflection.

use std::any::TypeId;

use bevy::camera::visibility::VisibilityPlugin;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::schedule::Schedules;
use bevy::gizmos::GizmoPlugin;
use bevy::picking::backend::PointerHits;
use bevy::picking::backend::ray::RayMap;
use bevy::prelude::*;
use bevy::reflect::serde::{ReflectDeserializer, ReflectSerializer};
use bevy::reflect::{FromReflect, Reflect, TypePath, TypeRegistry};
use bevy_morph_collision::contacts::MorphContactPoint;
use bevy_morph_collision::debug::MorphCollisionDiagnosticsPlugin;
use bevy_morph_collision::morph_collision::Facing;
use bevy_morph_collision::prelude::*;
use bevy_morph_collision::spatial::{MorphClosestPoints, MorphManifold, MorphProjection};
use serde::de::DeserializeSeed;

use morph_collision_workspace::app::headless;

use crate::hooks::{ByRules, Indifferent, Rules};
use crate::log::{Errors, start};
use crate::support::{Edits, app, assets, cube, move_to, plain_app, settle, spawn, touches};

/// The number of pairs of systems that conflict without an order, over all schedules.
fn ambiguities(app: &mut App) -> usize {
    start(app);
    app.update();
    let schedules = app.world().resource::<Schedules>();
    let conflicts = schedules
        .iter()
        .map(|(_, schedule)| schedule.graph().conflicting_systems().len());
    conflicts.sum()
}

#[test]
fn the_plugins_add_no_ambiguous_order_of_systems() {
    let bevy = || {
        let mut app = plain_app();
        app.add_plugins(VisibilityPlugin);
        app
    };
    let before = ambiguities(&mut bevy());
    let mut ours = bevy();
    ours.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin, MorphCollisionDiagnosticsPlugin));
    assert_eq!(ambiguities(&mut ours), before);
    let mut fixed = bevy();
    fixed.add_plugins((MorphCollisionPlugin.in_schedule(FixedPostUpdate), MorphBoundsPlugin));
    assert_eq!(ambiguities(&mut fixed), before);
    let mut hooked = bevy();
    hooked.init_resource::<Rules>().add_plugins((
        MorphCollisionHooksPlugin::<ByRules>::default(),
        MorphCollisionPlugin,
        MorphCollisionHooksPlugin::<Indifferent>::default(),
        MorphBoundsPlugin,
    ));
    assert_eq!(ambiguities(&mut hooked), before);

    // A conflict would be noticed.
    let mut careless = bevy();
    careless
        .add_plugins(MorphCollisionPlugin)
        .add_systems(PostUpdate, |mut collisions: ResMut<MorphCollisions>| {
            collisions.set_changed();
        });
    assert!(ambiguities(&mut careless) > before);
}

#[test]
fn the_plugin_runs_in_the_fixed_schedule_too() {
    let mut app = plain_app();
    app.add_plugins(MorphCollisionPlugin.in_schedule(FixedPostUpdate));
    // Two frames to a step.
    let step = Time::<Fixed>::default().timestep();
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step / 2));
    start(&mut app);
    let mesh = crate::support::add_mesh(&mut app, &cube());
    let [a, b] = [0.0, 3.0].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    for _ in 0..4 {
        app.update();
    }
    assert!(!touches(&app, a, b));
    // Motion in the fixed schedule is seen in the same step.
    #[derive(Resource, Default)]
    struct Late(Vec<bool>);
    app.init_resource::<Late>();
    app.add_systems(FixedUpdate, move |mut moved: Query<&mut Transform>| {
        moved.get_mut(b).unwrap().translation.x = 0.8;
    });
    app.add_systems(FixedLast, move |now: Res<MorphCollisions>, mut late: ResMut<Late>| {
        late.0.push(now.contains(a, b));
    });
    for _ in 0..4 {
        app.update();
    }
    let late = &app.world().resource::<Late>().0;
    assert!(late.len() >= 2 && late.iter().all(|touching| *touching), "{late:?}");
}

#[test]
fn settings_survive_a_scene_file() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let scene = MorphColliderScene {
        collider: MorphCollider::new(MorphCollisionMode::Contacts).with_margin(0.25),
        layers: MorphCollisionLayers::new(3, 5),
        only_named: vec!["jaw".into()],
        ..default()
    };
    let values: Vec<Box<dyn PartialReflect>> = vec![
        Box::new(scene),
        Box::new(MorphCollider::new(MorphCollisionMode::First)),
        Box::new(MorphCollisionLayers::new(1, 2)),
        Box::new(MorphTreeOptions { leaf_size: 3 }),
        Box::new(MorphShape::Capsule {
            half_length: 1.0,
            radius: 0.5,
        }),
        Box::new(MorphColliderDisabled),
        Box::new(MorphColliderOf::default()),
        Box::new(MorphSurfaceAnchor::default().with_offset(0.5)),
    ];
    for value in values {
        let text = serde_json::to_string(&ReflectSerializer::new(&*value, &registry)).unwrap();
        let mut reader = serde_json::Deserializer::from_str(&text);
        let read = ReflectDeserializer::new(&registry).deserialize(&mut reader).unwrap();
        assert_eq!(read.reflect_partial_eq(&*value), Some(true), "{text}");
        let path = value.reflect_type_path();
        let registration = registry.get_with_type_path(path).unwrap();
        assert!(
            registration.data::<ReflectComponent>().is_some(),
            "{path} is a component of scenes"
        );
    }
}

#[test]
fn a_mesh_that_is_swapped_and_one_that_goes_are_followed() {
    let (mut app, [a, b]) = crate::support::two_cubes(0.8);
    assert!(touches(&app, a, b));
    let mut small = cube();
    small.positions.iter_mut().for_each(|p| *p *= 0.1);
    let small = crate::support::add_mesh(&mut app, &small);
    app.insert(b, Mesh3d(small));
    settle(&mut app);
    assert!(!touches(&app, a, b), "0.05 large, and 0.3 away");
    move_to(&mut app, b, 0.5);
    app.update();
    assert!(touches(&app, a, b));
    app.remove::<Mesh3d>(b);
    app.update();
    assert!(!touches(&app, a, b));
}

/// Writes a value like a scene file, and reads it again.
fn there_and_back<T: FromReflect + PartialEq + std::fmt::Debug>(registry: &TypeRegistry, value: &T) -> T {
    let text = serde_json::to_string(&ReflectSerializer::new(value, registry)).unwrap();
    let mut reader = serde_json::Deserializer::from_str(&text);
    let read = ReflectDeserializer::new(registry).deserialize(&mut reader).unwrap();
    T::from_reflect(&*read).expect("all fields are there or have a default")
}

#[test]
fn questions_and_answers_are_reflected() {
    let mut app = headless(&assets());
    app.add_plugins(MorphPickingPlugin);
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let entity = Entity::PLACEHOLDER;
    // Fields that reflection cannot see have the values that reflection gives them.
    let triangles = TrianglePair {
        triangle_a: MorphContact::NO_TRIANGLE,
        triangle_b: MorphContact::NO_TRIANGLE,
    };
    let filter = MorphQueryFilter {
        mask: Some(5),
        excluded_entities: vec![entity],
        only_front: true,
    };
    assert_eq!(there_and_back(&registry, &filter), filter);
    let hit = MorphRayHit {
        entity,
        distance: 1.5,
        point: Vec3::new(1.0, 2.0, 3.0),
        normal: Vec3::Y,
        facing: Facing::EdgeOn,
        triangle: 7,
        barycentrics: Vec3::new(0.5, 0.25, 0.25),
        uv: Some(Vec2::new(0.1, 0.2)),
        joint: Some(entity),
    };
    assert_eq!(there_and_back(&registry, &hit), hit);
    let front = MorphRayHit {
        facing: Facing::Front,
        ..hit
    };
    assert_eq!(there_and_back(&registry, &front), hit);
    assert_eq!(front.reflect_clone().unwrap().reflect_partial_eq(&front), Some(true));
    let projection = MorphProjection {
        entity,
        distance: 1.5,
        point: Vec3::X,
        normal: Vec3::Y,
        triangle: 7,
        barycentrics: Vec3::X,
        uv: None,
        joint: None,
    };
    assert_eq!(there_and_back(&registry, &projection), projection);
    let closest = MorphClosestPoints {
        point1: Vec3::X,
        point2: Vec3::Y,
        distance: 2.0,
        triangles,
    };
    assert_eq!(there_and_back(&registry, &closest), closest);
    let point = MorphContactPoint {
        point: Vec3::X,
        depth: 0.25,
        triangles,
    };
    let contacts = MorphManifold {
        normal: Vec3::Z,
        depth: 0.5,
        pair_count: 3,
        is_truncated: true,
        points: vec![point],
    };
    assert_eq!(there_and_back(&registry, &contacts), contacts);
    let pick = MorphPick::from(&hit);
    assert_eq!(there_and_back(&registry, &pick), pick);
}

#[test]
fn components_have_a_reflected_default() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    fn default_of<T: Reflect + TypePath>(registry: &TypeRegistry) -> Box<T> {
        let registration = registry.get(TypeId::of::<T>()).expect("it is registered");
        let default = registration.data::<ReflectDefault>().expect("it has a default");
        default.default().downcast::<T>().unwrap()
    }
    let shape = MorphShape::Ball { radius: 0.5 };
    assert_eq!(*default_of::<MorphShape>(&registry), shape);
    assert_eq!(default_of::<MorphColliderOf>(&registry).body, Entity::PLACEHOLDER);
    let anchor = default_of::<MorphSurfaceAnchor>(&registry);
    assert_eq!((anchor.collider, anchor.offset), (Entity::PLACEHOLDER, 0.0));
    assert!((anchor.barycentrics.element_sum() - 1.0).abs() < 1e-6);
    default_of::<MorphQueryFilter>(&registry);
}

#[test]
fn plugins_that_need_others_say_so_and_do_not_panic() {
    let errors_of = |plugins: &dyn Fn(&mut App)| {
        let mut logged = Vec::new();
        Errors::collect(|errors| {
            let mut app = plain_app();
            plugins(&mut app);
            start(&mut app);
            for _ in 0..3 {
                app.update();
            }
            logged = errors.take();
        });
        logged
    };
    let picking = |app: &mut App| {
        app.init_resource::<RayMap>().add_message::<PointerHits>();
    };
    type Case<'a> = (&'a dyn Fn(&mut App), &'a [[&'a str; 2]]);
    let cases: [Case; 6] = [
        (
            &|app| {
                app.add_plugins((GizmoPlugin, MorphGizmosPlugin));
            },
            &[["MorphGizmosPlugin", "MorphCollisionPlugin"]],
        ),
        (
            &|app| {
                app.add_plugins((MorphGizmosPlugin, MorphCollisionPlugin));
            },
            &[["MorphGizmosPlugin", "GizmoPlugin"]],
        ),
        (
            &|app| {
                picking(app);
                app.add_plugins(MorphPickingPlugin);
            },
            &[["MorphPickingPlugin", "MorphCollisionPlugin"]],
        ),
        (
            &|app| {
                app.add_plugins((MorphPickingPlugin, MorphCollisionPlugin));
            },
            &[["MorphPickingPlugin", "DefaultPickingPlugins"]],
        ),
        (
            &|app| {
                app.add_plugins((MorphPickingPlugin, MorphGizmosPlugin));
            },
            &[
                ["MorphPickingPlugin", "MorphCollisionPlugin"],
                ["MorphPickingPlugin", "DefaultPickingPlugins"],
                ["MorphGizmosPlugin", "MorphCollisionPlugin"],
                ["MorphGizmosPlugin", "GizmoPlugin"],
            ],
        ),
        (
            &|app| {
                picking(app);
                app.add_plugins((MorphPickingPlugin, MorphGizmosPlugin, GizmoPlugin, MorphCollisionPlugin));
            },
            &[],
        ),
    ];
    for (plugins, expected) in cases {
        let logged = errors_of(plugins);
        assert_eq!(logged.len(), expected.len(), "{logged:?}");
        for (error, [who, what]) in logged.iter().zip(expected) {
            assert!(
                error.starts_with(who) && error.contains(what),
                "{error} is not about {what}"
            );
        }
    }
}
