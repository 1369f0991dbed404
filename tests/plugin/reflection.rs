//! How inspectors, remote protocols, scene files and scenes written in Rust work with the plugin's
//! types.

use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent, ReflectEvent, ReflectMessage, ReflectResource};
use bevy::gizmos::GizmoPlugin;
use bevy::prelude::*;
use bevy::reflect::serde::{TypedReflectDeserializer, TypedReflectSerializer};
use bevy::reflect::{FromReflect, ReflectFromReflect, TypePath, TypeRegistry};
use bevy::scene::ScenePlugin;
use bevy::world_serialization::{DynamicWorldBuilder, DynamicWorldRoot};
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::{NoUserData, RapierPhysicsPlugin};
use morph_collision_workspace::app::headless;
use serde::de::DeserializeSeed;

use crate::log::start;
use crate::support::{Edits, app, assets, plain_app, settle};

/// A component that users may insert, with a value that is not the default.
trait Sample: Component + Reflect + FromReflect + TypePath + PartialEq + std::fmt::Debug + Clone {}

impl<C: Component + Reflect + FromReflect + TypePath + PartialEq + std::fmt::Debug + Clone> Sample for C {}

/// Calls `each` for each component; relationships name the entity.
fn for_each_component(entity: Entity, mut each: impl EachComponent) {
    each.of(MorphCollider::new(MorphCollisionMode::First).with_margin(0.5));
    each.of(MorphColliderDisabled);
    each.of(MorphColliderScene {
        collider: MorphCollider::new(MorphCollisionMode::Contacts),
        layers: MorphCollisionLayers::new(3, 5),
        only_named: vec!["jaw".into()],
        ..default()
    });
    each.of(MorphColliderOf { body: entity });
    each.of(MorphBodyRoot);
    each.of(MorphCollisionLayers::new(1, 2));
    each.of(MorphCollisionEventsEnabled);
    each.of(MorphActiveCollisionHooks::FILTER_PAIRS);
    each.of(MorphCollidingEntities::default());
    each.of(MorphShape::from(Capsule3d::new(0.5, 2.0)));
    each.of(MorphSurfaceAnchor::new(entity, 3, Vec3::X).with_offset(0.5));
    each.of(MorphTreeOptions { leaf_size: 3 });
    let without = MorphQueryFilter::from_excluded_entities([entity]);
    each.of(MorphRayCaster::new(Vec3::X, Dir3::NEG_Y).with_filter(without.clone()));
    each.of(MorphRayHits::default());
    each.of(MorphShapeCaster::new(MorphShape::default(), Vec3::X, Dir3::NEG_Y).with_filter(without));
    each.of(MorphShapeHits::default());
    each.of(MorphPhysicsCollider {
        max_acceleration: 7.0,
        solid: true,
    });
    each.of(MorphPhysicsScene {
        collider: MorphPhysicsCollider {
            max_acceleration: 3.0,
            solid: true,
        },
    });
}

trait EachComponent {
    fn of<C: Sample>(&mut self, value: C);
}

/// An app with everything registered, and an entity for relationships.
fn app_and_other() -> (App, Entity) {
    let mut app = app();
    app.register_type::<MorphPhysicsCollider>();
    app.register_type::<MorphPhysicsScene>();
    let other = app.world_mut().spawn_empty().id();
    (app, other)
}

/// Inserts a value by reflection, as an inspector does: a dynamic value, and one read from JSON.
struct Insert<'a>(&'a mut App);

impl EachComponent for Insert<'_> {
    fn of<C: Sample>(&mut self, value: C) {
        let registry = self.0.world().resource::<AppTypeRegistry>().clone();
        let registry = registry.read();
        let path = C::type_path();
        let registration = registry.get_with_type_path(path).expect(path);
        let component = registration.data::<ReflectComponent>().expect(path);
        let text = serde_json::to_string(&TypedReflectSerializer::new(&value, &registry)).expect(path);
        let mut reader = serde_json::Deserializer::from_str(&text);
        let read = TypedReflectDeserializer::new(registration, &registry).deserialize(&mut reader);
        for dynamic in [value.to_dynamic().expect(path), read.expect(path)] {
            let entity = self.0.world_mut().spawn_empty().id();
            component.insert(&mut self.0.world_mut().entity_mut(entity), &*dynamic, &registry);
            self.0.world_mut().flush();
            assert_eq!(self.0.world().get::<C>(entity), Some(&value), "{text}");
        }
        // Missing fields take their values from the default, which every component has.
        let default = registration.data::<ReflectDefault>().expect(path);
        assert!(default.default().is::<C>());
        assert!(registration.data::<ReflectFromReflect>().is_some(), "{path}");
    }
}

#[test]
fn every_component_can_be_inserted_by_reflection() {
    let (mut app, other) = app_and_other();
    for_each_component(other, Insert(&mut app));
    let colliders = app.world().get::<MorphColliders>(other);
    assert!(colliders.is_some_and(|colliders| colliders.len() == 2), "{colliders:?}");
}

#[test]
fn fields_that_are_not_said_have_their_defaults() {
    let (mut app, _) = app_and_other();
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let path = MorphColliderScene::type_path();
    let registration = registry.get_with_type_path(path).expect(path);
    let text = r#"{"collider": {"margin": 0.25}, "only_named": ["jaw"]}"#;
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = TypedReflectDeserializer::new(registration, &registry).deserialize(&mut reader);
    let entity = app.world_mut().spawn_empty().id();
    let component = registration.data::<ReflectComponent>().expect(path);
    component.insert(&mut app.world_mut().entity_mut(entity), &*read.expect(text), &registry);
    let expected = MorphColliderScene {
        collider: MorphCollider::default().with_margin(0.25),
        only_named: vec!["jaw".into()],
        ..default()
    };
    assert_eq!(app.world().get(entity), Some(&expected));
}

/// Spawns an entity with one of the components.
struct Spawn<'a>(&'a mut World, &'a mut Vec<Entity>);

impl EachComponent for Spawn<'_> {
    fn of<C: Sample>(&mut self, value: C) {
        let name = Name::new(C::type_path());
        self.1.push(self.0.spawn((name, value)).id());
    }
}

/// Compares the component on the entity with that name.
struct Compare<'a>(&'a mut World);

impl EachComponent for Compare<'_> {
    fn of<C: Sample>(&mut self, value: C) {
        let path = C::type_path();
        let mut named = self.0.query::<(&Name, &C)>();
        let found = named.iter(self.0).find(|(name, _)| name.as_str() == path);
        assert_eq!(found.expect(path).1, &value);
    }
}

#[test]
fn every_component_survives_a_scene_file() {
    let folder = tempfile::tempdir().expect("there is room for a small file");
    let (mut app, other) = app_and_other();
    app.insert(other, Name::new("other"));
    let mut entities = vec![other];
    for_each_component(other, Spawn(app.world_mut(), &mut entities));
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let builder = DynamicWorldBuilder::from_world(app.world(), &registry)
        .allow_component::<Name>()
        .allow_component::<MorphCollider>()
        .allow_component::<MorphColliderDisabled>()
        .allow_component::<MorphColliderScene>()
        .allow_component::<MorphColliderOf>()
        .allow_component::<MorphColliders>()
        .allow_component::<MorphBodyRoot>()
        .allow_component::<MorphCollisionLayers>()
        .allow_component::<MorphCollisionEventsEnabled>()
        .allow_component::<MorphActiveCollisionHooks>()
        .allow_component::<MorphCollidingEntities>()
        .allow_component::<MorphShape>()
        .allow_component::<MorphSurfaceAnchor>()
        .allow_component::<MorphTreeOptions>()
        .allow_component::<MorphRayCaster>()
        .allow_component::<MorphRayHits>()
        .allow_component::<MorphShapeCaster>()
        .allow_component::<MorphShapeHits>()
        .allow_component::<MorphPhysicsCollider>()
        .allow_component::<MorphPhysicsScene>();
    let text = builder
        .extract_entities(entities.into_iter())
        .build()
        .serialize(&registry);
    std::fs::write(folder.path().join("level.scn.ron"), text.expect("it can be written")).expect("there is room");

    let mut app = headless(folder.path());
    start(&mut app);
    app.register_type::<MorphPhysicsCollider>();
    app.register_type::<MorphPhysicsScene>();
    let scene = app.world().resource::<AssetServer>().load("level.scn.ron");
    app.spawn(DynamicWorldRoot(scene));
    let mut other = None;
    for _ in 0..10_000 {
        app.update();
        let mut named = app.world_mut().query::<(Entity, &Name)>();
        other = named
            .iter(app.world())
            .find_map(|(entity, name)| (name.as_str() == "other").then_some(entity));
        if other.is_some() {
            break;
        }
    }
    let other = other.expect("the scene is spawned");
    // The anchor and the relationship, in both directions, name the entity that was spawned for the one
    // in the file.
    for_each_component(other, Compare(app.world_mut()));
    let colliders = app.world().get::<MorphColliders>(other);
    assert!(colliders.is_some_and(|colliders| colliders.len() == 1), "{colliders:?}");
}

/// Checks what a type of the plugin is registered as.
fn check_registered<T: TypePath>(registry: &TypeRegistry, has: &[fn(&bevy::reflect::TypeRegistration) -> bool]) {
    let path = T::type_path();
    let registration = registry.get_with_type_path(path).expect(path);
    for (i, has) in has.iter().enumerate() {
        assert!(has(registration), "{path} lacks number {i}");
    }
}

/// Checks that a component is registered as one.
struct Registered<'a>(&'a TypeRegistry);

impl EachComponent for Registered<'_> {
    fn of<C: Sample>(&mut self, _: C) {
        check_registered::<C>(
            self.0,
            &[
                |registration| registration.data::<ReflectComponent>().is_some(),
                |registration| registration.data::<ReflectDefault>().is_some(),
            ],
        );
    }
}

#[test]
fn components_resources_and_events_are_registered() {
    let mut app = plain_app();
    // Without Bevy's automatic registration, which a feature enables.
    app.insert_resource(AppTypeRegistry::default());
    app.add_plugins((
        GizmoPlugin,
        RapierPhysicsPlugin::<NoUserData>::default(),
        MorphPlugins,
        MorphRapierPlugin,
    ));
    let registry = app.world().resource::<AppTypeRegistry>().read();
    for_each_component(Entity::PLACEHOLDER, Registered(&registry));
    check_registered::<MorphColliders>(
        &registry,
        &[|registration| registration.data::<ReflectComponent>().is_some()],
    );
    check_registered::<MorphGizmos>(
        &registry,
        &[|registration| registration.data::<ReflectDefault>().is_some()],
    );
    let resource: [fn(&bevy::reflect::TypeRegistration) -> bool; 2] = [
        |registration| registration.data::<ReflectResource>().is_some(),
        |registration| registration.data::<ReflectDefault>().is_some(),
    ];
    check_registered::<MorphCollisionSettings>(&registry, &resource);
    check_registered::<MorphCollisionDiagnostics>(&registry, &resource);
    check_registered::<MorphCollisions>(&registry, &resource);
    check_registered::<MorphTrees>(&registry, &resource);
    check_registered::<MorphPickingSettings>(&registry, &resource);
    check_registered::<MorphPhysicsDiagnostics>(&registry, &resource);
    let event: [fn(&bevy::reflect::TypeRegistration) -> bool; 3] = [
        |registration| registration.data::<ReflectEvent>().is_some(),
        |registration| registration.data::<ReflectMessage>().is_some(),
        |registration| registration.data::<ReflectFromReflect>().is_some(),
    ];
    check_registered::<MorphCollisionStart>(&registry, &event);
    check_registered::<MorphCollisionEnd>(&registry, &event);
    check_registered::<MorphBodyCollisionStart>(&registry, &event);
    check_registered::<MorphBodyCollisionEnd>(&registry, &event);
    // These are not messages.
    let entity_event = [event[0], event[2]];
    check_registered::<MorphColliderReady>(&registry, &entity_event);
    check_registered::<MorphColliderFailed>(&registry, &entity_event);
    check_registered::<MorphColliderSceneReady>(&registry, &entity_event);
}

#[test]
fn events_can_be_triggered_by_reflection() {
    #[derive(Resource, Default)]
    struct Heard(Vec<MorphBodyCollisionEnd>);
    let (mut app, body) = app_and_other();
    app.init_resource::<Heard>();
    app.world_mut()
        .entity_mut(body)
        .observe(|end: On<MorphBodyCollisionEnd>, mut heard: ResMut<Heard>| heard.0.push(*end));
    let end = MorphBodyCollisionEnd {
        body1: body,
        body2: Entity::PLACEHOLDER,
    };
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let event = registry
        .get_with_type_path(MorphBodyCollisionEnd::type_path())
        .and_then(|registration| registration.data::<ReflectEvent>());
    event.expect("it is an event").trigger(app.world_mut(), &end, &registry);
    assert_eq!(app.world().resource::<Heard>().0, [end]);
}

#[test]
fn scenes_written_in_rust_have_colliders_and_bodies() {
    let mut app = headless(&assets());
    app.add_plugins(ScenePlugin);
    start(&mut app);
    let root = app.world_mut().spawn_scene(bsn! {
        #Knight
        MorphBodyRoot
        MorphCollidingEntities
        MorphColliders [
            MorphCollider { margin: 0.5 }
            MorphCollisionLayers { memberships: 3 }
            --
            MorphShape::Ball { radius: 0.25 }
            MorphCollisionEventsEnabled
        ]
        Children [
            MorphColliderScene { events: true, collider: MorphCollider { mode: MorphCollisionMode::First } }
            --
            MorphShape::Ball { radius: 0.25 }
            MorphColliderOf { body: #Knight }
            --
            MorphColliderDisabled MorphTreeOptions { leaf_size: 2 } MorphSurfaceAnchor { offset: 0.5 }
        ]
    });
    let root = root.expect("the scene can be spawned").id();
    settle(&mut app);
    let world = app.world();
    let colliders = world.get::<MorphColliders>(root).expect("it is a body");
    assert_eq!(colliders.len(), 3);
    let mesh = world.get::<MorphCollider>(colliders[0]);
    assert_eq!(mesh, Some(&MorphCollider::default().with_margin(0.5)));
    let layers = world.get::<MorphCollisionLayers>(colliders[0]);
    assert_eq!(layers, Some(&MorphCollisionLayers::new(3, u32::MAX)));
    assert_eq!(world.get(colliders[1]), Some(&MorphShape::Ball { radius: 0.25 }));
    assert_eq!(world.get(colliders[2]), Some(&MorphColliderOf { body: root }));
    let children = world.get::<Children>(root).expect("it has children");
    let scene = MorphColliderScene {
        events: true,
        collider: MorphCollider::new(MorphCollisionMode::First),
        ..default()
    };
    assert_eq!(world.get(children[0]), Some(&scene));
    let anchor = MorphSurfaceAnchor::default().with_offset(0.5);
    assert_eq!(world.get(children[2]), Some(&anchor));
    assert_eq!(world.get(children[2]), Some(&MorphTreeOptions { leaf_size: 2 }));
}

#[test]
fn shapes_come_from_primitives() {
    assert_eq!(MorphShape::from(Sphere::new(2.0)), MorphShape::Ball { radius: 2.0 });
    let cuboid = MorphShape::Cuboid {
        half_extents: Vec3::new(0.5, 1.0, 1.5),
    };
    assert_eq!(MorphShape::from(Cuboid::new(1.0, 2.0, 3.0)), cuboid);
    let capsule = MorphShape::Capsule {
        half_length: 1.5,
        radius: 0.25,
    };
    assert_eq!(MorphShape::from(Capsule3d::new(0.25, 3.0)), capsule);
}
