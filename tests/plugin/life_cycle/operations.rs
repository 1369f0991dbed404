//! Changes to colliders, and to the entities they depend on.

use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use rand::RngExt;

use super::zoo::Zoo;
use crate::support::bevy_mesh;

/// The operation that was run.
pub(super) struct Done {
    pub(super) name: &'static str,
    /// Whether it causes trees to be built.
    pub(super) rebuilds: bool,
}

type Operation = fn(&mut Zoo);

/// Every operation, with its relative frequency, and whether it causes trees to be built.
const OPERATIONS: &[(u32, &str, Operation, bool)] = &[
    (14, "spawn", spawn, false),
    (2, "despawn", despawn, false),
    (1, "despawn a parent", despawn_cage, false),
    (
        5,
        "toggle MorphColliderDisabled",
        toggle::<MorphColliderDisabled>,
        false,
    ),
    (5, "toggle Disabled", toggle::<Disabled>, false),
    (2, "toggle Disabled of a parent's whole branch", toggle_branch, false),
    (5, "swap the mesh", swap_mesh, false),
    (3, "toggle the mesh", toggle_mesh, false),
    (3, "toggle the collider", toggle_collider, false),
    (3, "toggle a shape", toggle_shape, false),
    (5, "reparent", reparent, false),
    (8, "move", move_one, false),
    (5, "scale", scale, false),
    (3, "scale a parent", scale_cage, false),
    (3, "place that is not finite", spoil_place, false),
    (2, "parent's place that is not finite", spoil_cage, false),
    (8, "weights", weigh, false),
    (3, "bad weights", weigh_badly, false),
    (3, "shared weights", share_weights, false),
    (3, "pause", pause, false),
    (3, "layers", set_layers, false),
    (3, "mode", set_mode, false),
    (3, "body", set_body, false),
    (2, "listen", toggle::<MorphCollisionEventsEnabled>, false),
    (2, "list", toggle::<MorphCollidingEntities>, false),
    (2, "toggle a scene", toggle_scene, false),
    (2, "edit a scene", edit_scene, false),
    (1, "modify a mesh", modify_mesh, true),
    (1, "remove or bring back a mesh", toggle_asset, true),
    (1, "tree settings", toggle_tree_settings, true),
    (1, "every morphing mesh", toggle_every, true),
];

/// Runs a random operation.
pub(super) fn operate(zoo: &mut Zoo) -> Done {
    let total: u32 = OPERATIONS.iter().map(|(often, ..)| often).sum();
    let mut ticket = zoo.rng.random_range(0..total);
    for &(often, name, operation, rebuilds) in OPERATIONS {
        if ticket < often {
            operation(zoo);
            return Done { name, rebuilds };
        }
        ticket -= often;
    }
    unreachable!("the ticket is less than the sum")
}

/// An animal that still exists.
fn animal(zoo: &mut Zoo) -> Option<Entity> {
    let Zoo { animals, app, .. } = zoo;
    animals.retain(|&animal| app.world().get_entity(animal).is_ok());
    (!animals.is_empty()).then(|| zoo.one_of(&zoo.animals.clone()))
}

fn place(zoo: &mut Zoo) -> Transform {
    let mut along = || zoo.rng.random_range(-1.2..=1.2_f32);
    let at = Vec3::new(along(), along(), along());
    let turn = Quat::from_euler(EulerRot::XYZ, along(), along(), along());
    Transform::from_translation(at).with_rotation(turn)
}

/// Weights of every kind found in real files.
fn some_weights(zoo: &mut Zoo, targets: usize) -> Vec<f32> {
    let most = zoo.one_of(&[0.0, 1.0, 1.0, 6.0]);
    (0..targets).map(|_| zoo.rng.random_range(-0.2 * most..=most)).collect()
}

/// Gives an animal weights that fit its mesh. This test does not cover bad weights whose mesh or collider is removed.
fn weigh_well(zoo: &mut Zoo, animal: Entity) {
    let mesh = zoo.app.world().get::<Mesh3d>(animal).map(|mesh| mesh.id());
    let targets = mesh
        .and_then(|mesh| zoo.meshes[&mesh].as_ref())
        .map_or(0, |mesh| mesh.targets.len());
    let weights = some_weights(zoo, targets);
    let mut animal = zoo.app.world_mut().entity_mut(animal);
    if targets == 0 {
        animal.remove::<MeshMorphWeights>();
    } else {
        animal.insert(MeshMorphWeights::Value { weights });
    }
}

fn all_weigh_well(zoo: &mut Zoo) {
    if animal(zoo).is_some() {
        for animal in zoo.animals.clone() {
            weigh_well(zoo, animal);
        }
    }
}

pub(super) fn spawn(zoo: &mut Zoo) {
    let place = place(zoo);
    let mesh = zoo.one_of(&zoo.handles.clone());
    let mode = some_mode(zoo);
    let animal = zoo
        .app
        .world_mut()
        .spawn((Mesh3d(mesh), place, MorphCollider::new(mode)))
        .id();
    weigh_well(zoo, animal);
    let [hangs, listens, lists] = [0.3, 0.5, 0.5].map(|chance| zoo.rng.random_bool(chance));
    let cage = zoo.one_of(&zoo.cages.clone());
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if hangs {
        entity.insert(ChildOf(cage));
    }
    if listens {
        entity.insert(MorphCollisionEventsEnabled);
    }
    if lists {
        entity.insert(MorphCollidingEntities::default());
    }
    zoo.animals.push(animal);
    // Limits their number, so that brute force stays fast.
    if zoo.animals.len() > 14 {
        despawn(zoo);
    }
}

fn despawn(zoo: &mut Zoo) {
    if let Some(animal) = animal(zoo) {
        zoo.app.world_mut().despawn(animal);
    }
}

fn despawn_cage(zoo: &mut Zoo) {
    let cage = zoo.rng.random_range(0..zoo.cages.len());
    let world = zoo.app.world_mut();
    world.despawn(zoo.cages[cage]);
    zoo.cages[cage] = world.spawn(super::zoo::cage()).id();
}

fn toggle<C: Component + Default>(zoo: &mut Zoo) {
    if let Some(animal) = animal(zoo) {
        toggle_on::<C>(zoo.app.world_mut(), animal);
    }
}

fn toggle_on<C: Component + Default>(world: &mut World, entity: Entity) {
    let mut entity = world.entity_mut(entity);
    if entity.contains::<C>() {
        entity.remove::<C>();
    } else {
        entity.insert(C::default());
    }
}

fn toggle_branch(zoo: &mut Zoo) {
    let cage = zoo.one_of(&zoo.cages.clone());
    let world = zoo.app.world_mut();
    let children: Vec<Entity> = world
        .get::<Children>(cage)
        .map(|children| children.to_vec())
        .unwrap_or_default();
    for entity in children.into_iter().chain([cage]) {
        toggle_on::<Disabled>(world, entity);
    }
}

fn swap_mesh(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let mesh = zoo.one_of(&zoo.handles.clone());
    zoo.app.world_mut().entity_mut(animal).insert(Mesh3d(mesh));
    weigh_well(zoo, animal);
}

fn toggle_mesh(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let mesh = zoo.one_of(&zoo.handles.clone());
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if entity.contains::<Mesh3d>() {
        entity.remove::<Mesh3d>();
    } else {
        entity.insert(Mesh3d(mesh));
    }
    weigh_well(zoo, animal);
}

fn toggle_collider(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let mode = some_mode(zoo);
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if entity.contains::<MorphCollider>() {
        entity.remove::<MorphCollider>();
    } else {
        entity.insert(MorphCollider::new(mode));
    }
    weigh_well(zoo, animal);
}

fn toggle_shape(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let radius = zoo.rng.random_range(0.1..=1.0);
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if entity.contains::<MorphShape>() {
        entity.remove::<MorphShape>();
    } else {
        entity.insert(MorphShape::Ball { radius });
    }
    weigh_well(zoo, animal);
}

fn reparent(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let cage = zoo.one_of(&zoo.cages.clone());
    all_weigh_well(zoo);
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if entity.contains::<ChildOf>() {
        entity.remove::<ChildOf>();
    } else {
        entity.insert(ChildOf(cage));
    }
}

fn move_one(zoo: &mut Zoo) {
    if let Some(animal) = animal(zoo) {
        let place = place(zoo);
        zoo.app.world_mut().entity_mut(animal).insert(place);
    }
}

/// Collapsed, flat, tiny, mirrored, huge, and ordinary scales.
const SCALES: [Vec3; 9] = [
    Vec3::ZERO,
    Vec3::new(1.0, 0.0, 1.0),
    Vec3::new(0.0, 0.0, 2.0),
    Vec3::splat(1e-20),
    Vec3::splat(1e-6),
    Vec3::new(-1.0, 1.0, 1.0),
    Vec3::new(0.3, 2.0, 1.0),
    Vec3::splat(1e15),
    Vec3::ONE,
];

fn rescale(zoo: &mut Zoo, entity: Entity) {
    let scale = zoo.one_of(&SCALES);
    if let Some(mut place) = zoo.app.world_mut().get_mut::<Transform>(entity) {
        place.scale = scale;
    }
}

fn scale(zoo: &mut Zoo) {
    if let Some(animal) = animal(zoo) {
        rescale(zoo, animal);
    }
}

fn scale_cage(zoo: &mut Zoo) {
    let cage = zoo.one_of(&zoo.cages.clone());
    rescale(zoo, cage);
}

fn spoil(zoo: &mut Zoo, entity: Entity) {
    let bad = zoo.one_of(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
    let is_spoiled = zoo.rng.random_bool(0.5);
    if let Some(mut place) = zoo.app.world_mut().get_mut::<Transform>(entity) {
        place.translation.x = if is_spoiled { bad } else { 0.0 };
    }
}

fn spoil_place(zoo: &mut Zoo) {
    if let Some(animal) = animal(zoo) {
        spoil(zoo, animal);
    }
}

fn spoil_cage(zoo: &mut Zoo) {
    let cage = zoo.one_of(&zoo.cages.clone());
    spoil(zoo, cage);
}

fn weigh(zoo: &mut Zoo) {
    if let Some(animal) = animal(zoo) {
        weigh_well(zoo, animal);
    }
}

fn weigh_badly(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let bad = zoo.one_of(&[vec![f32::NAN; 2], vec![f32::INFINITY; 3], vec![1.0; 7], vec![]]);
    let bad = MeshMorphWeights::Value { weights: bad };
    zoo.app.world_mut().entity_mut(animal).insert(bad);
}

fn share_weights(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let targets = zoo.rng.random_range(1..4);
    let weights = some_weights(zoo, targets);
    let world = zoo.app.world_mut();
    let weights = MorphWeights::new(weights, None).expect("there are few weights");
    let source = world.spawn((weights, ChildOf(animal))).id();
    world.entity_mut(animal).insert(MeshMorphWeights::Reference(source));
}

fn pause(zoo: &mut Zoo) {
    let mut settings = zoo.app.world_mut().resource_mut::<MorphCollisionSettings>();
    settings.paused = !settings.paused;
}

fn set_layers(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let some = [1, 3, u32::MAX, u32::MAX];
    let layers = MorphCollisionLayers::new(zoo.one_of(&some), zoo.one_of(&some));
    zoo.app.world_mut().entity_mut(animal).insert(layers);
}

fn some_mode(zoo: &mut Zoo) -> MorphCollisionMode {
    use MorphCollisionMode::{All, Contacts, First, Passive};
    zoo.one_of(&[Passive, First, First, All, All, All, Contacts, Contacts])
}

fn set_mode(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let mode = some_mode(zoo);
    if let Some(mut collider) = zoo.app.world_mut().get_mut::<MorphCollider>(animal) {
        collider.mode = mode;
    }
}

fn set_body(zoo: &mut Zoo) {
    let Some(animal) = animal(zoo) else { return };
    let cage = zoo.one_of(&zoo.cages.clone());
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if entity.contains::<MorphColliderOf>() {
        entity.remove::<MorphColliderOf>();
    } else {
        entity.insert(MorphColliderOf { body: cage });
    }
}

fn toggle_scene(zoo: &mut Zoo) {
    all_weigh_well(zoo);
    let cage = zoo.one_of(&zoo.cages.clone());
    toggle_on::<MorphColliderScene>(zoo.app.world_mut(), cage);
}

fn edit_scene(zoo: &mut Zoo) {
    all_weigh_well(zoo);
    let cage = zoo.one_of(&zoo.cages.clone());
    let (mode, only_deforming, events) = (some_mode(zoo), zoo.rng.random_bool(0.5), zoo.rng.random_bool(0.5));
    if let Some(mut scene) = zoo.app.world_mut().get_mut::<MorphColliderScene>(cage) {
        scene.collider.mode = mode;
        scene.only_deforming = only_deforming;
        scene.events = events;
    }
}

fn modify_mesh(zoo: &mut Zoo) {
    let handle = zoo.one_of(&zoo.handles.clone());
    let shape = zoo.one_of(&zoo.shapes.clone());
    zoo.reshape(&handle, shape);
    all_weigh_well(zoo);
}

fn toggle_asset(zoo: &mut Zoo) {
    let handle = zoo.one_of(&zoo.handles.clone());
    let shape = zoo.one_of(&zoo.shapes.clone());
    let mut assets = zoo.app.world_mut().resource_mut::<Assets<Mesh>>();
    if assets.remove(handle.id()).is_some() {
        zoo.meshes.insert(handle.id(), None);
    } else {
        assets
            .insert(handle.id(), bevy_mesh(&shape))
            .expect("the handle is kept");
        zoo.meshes.insert(handle.id(), Some(shape));
    }
    all_weigh_well(zoo);
}

fn toggle_tree_settings(zoo: &mut Zoo) {
    all_weigh_well(zoo);
    let Some(animal) = animal(zoo) else { return };
    let leaf_size = zoo.one_of(&[1, 4]);
    let settings = MorphTreeOptions { leaf_size };
    let mut entity = zoo.app.world_mut().entity_mut(animal);
    if entity.contains::<MorphTreeOptions>() {
        entity.remove::<MorphTreeOptions>();
    } else {
        entity.insert(settings);
    }
}

fn toggle_every(zoo: &mut Zoo) {
    all_weigh_well(zoo);
    let mode = some_mode(zoo);
    let mut settings = zoo.app.world_mut().resource_mut::<MorphCollisionSettings>();
    settings.every_deforming_mesh = match settings.every_deforming_mesh {
        Some(_) => None,
        None => Some(MorphCollider::new(mode)),
    };
}
