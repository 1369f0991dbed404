//! What the game does in a frame. It depends only on what a rollback brings back.

use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use rand::RngExt;

use super::library::Hidden;
use super::rules::Rule;
use super::stage::{BODIES, COLLIDERS, SHARED, Stage, joints_of};
use crate::support::Edits;

/// One to three operations.
pub(super) fn operate(stage: &mut Stage) {
    // A pause is short, and nothing is hidden for long.
    if stage.app.settings().paused && stage.rng.random_bool(0.5) {
        stage.app.settings().paused = false;
    }
    let row = stage.rng.random_range(0..COLLIDERS);
    if let Some(entity) = stage.alive(row) {
        let is_hidden = [
            stage.app.world().get::<Disabled>(entity).is_some(),
            stage.app.world().get::<Hidden>(entity).is_some(),
        ];
        match is_hidden {
            [true, _] => hide::<Disabled>(stage, entity),
            [_, true] => hide::<Hidden>(stage, entity),
            _ => {}
        }
    }
    for _ in 0..stage.rng.random_range(1..=3) {
        let row = stage.rng.random_range(0..COLLIDERS);
        match (stage.alive(row), stage.rng.random_range(0..48)) {
            (None, _) | (_, 0) => spawn(stage, row),
            (Some(entity), operation) => change(stage, row, entity, operation),
        }
    }
}

fn place(stage: &mut Stage) -> Transform {
    let mut along = || stage.rng.random_range(-0.9..0.9_f32);
    let at = Vec3::new(along(), along(), along());
    Transform::from_translation(at).with_rotation(Quat::from_euler(EulerRot::XYZ, along(), along(), along()))
}

fn one_of<T: Clone>(stage: &mut Stage, things: &[T]) -> T {
    things[stage.rng.random_range(0..things.len())].clone()
}

fn collider(stage: &mut Stage) -> MorphCollider {
    use MorphCollisionMode::{All, Contacts, First, Passive};
    let mode = one_of(stage, &[Passive, First, First, All, Contacts]);
    let (margin, tolerance) = (one_of(stage, &[0.0, 0.0, 0.1]), one_of(stage, &[0.0, 0.0, 0.25]));
    let continuous = stage.rng.random_bool(0.6);
    let collider = MorphCollider::new(mode).with_margin(margin).with_tolerance(tolerance);
    collider.with_continuous(continuous)
}

fn shape(stage: &mut Stage) -> MorphShape {
    let size = stage.rng.random_range(0.2..0.6);
    let shapes = [
        MorphShape::Ball { radius: size },
        MorphShape::Capsule {
            half_length: size,
            radius: 0.3,
        },
        MorphShape::Cuboid {
            half_extents: Vec3::new(size, 0.3, 0.4),
        },
        MorphShape::Cone {
            half_height: size,
            radius: 0.3,
        },
        MorphShape::from(MorphConvexHull::new(&[Vec3::X, Vec3::Y, Vec3::Z, -size * Vec3::ONE]).expect("it is a solid")),
    ];
    one_of(stage, &shapes)
}

fn weights(stage: &mut Stage, count: usize) -> MeshMorphWeights {
    let weights = (0..count).map(|_| stage.rng.random_range(-0.3..1.0)).collect();
    MeshMorphWeights::Value { weights }
}

/// A collider of any kind.
fn spawn(stage: &mut Stage, row: usize) {
    let (place, collider) = (place(stage), collider(stage));
    let kind = one_of(stage, &[0, 1, 2, 2, 3, 3, 4, 4, 4]);
    let (mesh, targets) = stage.meshes[kind].clone();
    let entity = stage.spawn(row, (place, Mesh3d(mesh), collider));
    if targets > 0 {
        let weights = weights(stage, targets);
        stage.app.insert(entity, weights);
    }
    if kind + 1 == stage.meshes.len() {
        let skin = stage.skin(row);
        stage.app.insert(entity, skin);
    }
    if stage.rng.random_bool(0.15) {
        let shape = shape(stage);
        stage.app.insert(entity, shape);
    }
    if stage.rng.random_bool(0.4) {
        let list = MorphSelfCollisions::default().with_rest(stage.rng.random_bool(0.7));
        stage.app.insert(entity, list);
    }
}

fn change(stage: &mut Stage, row: usize, entity: Entity, operation: u32) {
    match operation {
        1 | 2 => stage.despawn(row),
        3..=10 => {
            let place = place(stage);
            stage.app.insert(entity, place);
        }
        11..=16 => {
            let nudge = 0.1 * place(stage).translation;
            if let Some(mut place) = stage.app.world_mut().get_mut::<Transform>(entity) {
                place.translation += nudge;
            }
        }
        17..=20 => reweigh(stage, entity),
        21 => {
            let collider = collider(stage);
            stage.app.insert(entity, collider);
        }
        22 => {
            let layers = MorphCollisionLayers::new(one_of(stage, &[1, 3, 7]), one_of(stage, &[1, 3, 7]));
            stage.app.insert(entity, layers);
        }
        23 => {
            let place = place(stage);
            stage.app.insert(entity, (place, MorphTeleported));
        }
        24 => {
            let body = stage.rng.random_range(BODIES);
            match stage.alive(body) {
                Some(body) if stage.rng.random_bool(0.7) => stage.app.insert(entity, MorphColliderOf { body }),
                _ => stage.app.remove::<MorphColliderOf>(entity),
            }
        }
        25 => {
            let shape = shape(stage);
            match stage.app.world().get::<MorphShape>(entity) {
                Some(_) if stage.rng.random_bool(0.3) => stage.app.remove::<MorphShape>(entity),
                _ => stage.app.insert(entity, shape),
            }
        }
        26 => hide::<MorphColliderDisabled>(stage, entity),
        27 => hide::<Disabled>(stage, entity),
        34 => hide::<Hidden>(stage, entity),
        28 => toggle::<MorphSelfCollisions>(stage, entity),
        29 => toggle::<MorphActiveCollisionHooks>(stage, entity),
        30 => {
            let rule = stage.rng.random_range(0..12);
            stage.app.insert_resource(Rule(rule));
        }
        31 => {
            let limit = one_of(stage, &[5, 8192]);
            stage.app.settings().max_triangle_pairs = limit;
        }
        32 => stage.app.settings().paused = stage.rng.random_bool(0.3),
        33 => {
            let kind = stage.rng.random_range(0..4);
            let mesh = stage.meshes[kind].0.clone();
            stage.app.remove::<SkinnedMesh>(entity);
            stage.app.insert(entity, Mesh3d(mesh));
            reweigh(stage, entity);
        }
        36 => toggle::<MorphCollisionEventsEnabled>(stage, entity),
        37 => toggle::<MorphCollidingEntities>(stage, entity),
        38 => cast(stage, entity),
        39 => {
            // Below a body, or free.
            let body = stage.rng.random_range(BODIES);
            match (stage.alive(body), stage.app.world().get::<ChildOf>(entity)) {
                (Some(body), None) => stage.app.insert(entity, ChildOf(body)),
                _ => stage.app.remove::<ChildOf>(entity),
            }
        }
        40 => {
            let (place, row) = (place(stage), stage.rng.random_range(BODIES));
            if let Some(body) = stage.alive(row) {
                stage.app.insert(body, place);
            }
        }
        41 => {
            let row = stage.rng.random_range(BODIES);
            let weights: Vec<f32> = (0..SHARED).map(|_| stage.rng.random_range(-0.3..1.0)).collect();
            let body = stage.alive(row);
            if let Some(mut shared) = body.and_then(|body| stage.app.world_mut().get_mut::<MorphWeights>(body)) {
                shared.weights_mut().copy_from_slice(&weights);
            }
        }
        35 => stage.app.insert(entity, MorphSelfCollisions::default().with_rest(true)),
        _ => {
            let joint = stage.rng.random_range(0..2);
            bend(stage, joints_of(row)[joint]);
        }
    }
}

/// Casts a ray or a shape from an entity from now on, or not any more.
fn cast(stage: &mut Stage, entity: Entity) {
    let direction = one_of(stage, &[Dir3::X, Dir3::NEG_Y, Dir3::Z]);
    if stage.rng.random_bool(0.3) {
        stage.app.remove::<(MorphRayCaster, MorphRayHits)>(entity);
        stage.app.remove::<(MorphShapeCaster, MorphShapeHits)>(entity);
    } else if stage.rng.random_bool(0.5) {
        let caster = MorphRayCaster::new(-2.0 * *direction, direction).with_max_hits(3);
        stage.app.insert(entity, caster);
    } else {
        let shape = shape(stage);
        let caster = MorphShapeCaster::new(shape, -3.0 * *direction, direction).with_max_hits(2);
        stage.app.insert(entity, caster);
    }
}

/// Takes an entity out, or brings it back. Most of the time it is there.
fn hide<C: Component + Default>(stage: &mut Stage, entity: Entity) {
    let is_hidden = stage.app.world().get::<C>(entity).is_some();
    if is_hidden || stage.rng.random_bool(0.4) {
        toggle::<C>(stage, entity);
        // Bevy does not notice where a disabled entity was moved to.
        if let Some(mut place) = stage.app.world_mut().get_mut::<Transform>(entity) {
            place.set_changed();
        }
    }
}

fn toggle<C: Component + Default>(stage: &mut Stage, entity: Entity) {
    match stage.app.world().get::<C>(entity) {
        Some(_) => stage.app.remove::<C>(entity),
        None => stage.app.insert(entity, C::default()),
    }
}

/// Weights that fit, or some that cannot be used.
fn reweigh(stage: &mut Stage, entity: Entity) {
    let mesh = stage.app.world().get::<Mesh3d>(entity).map(|mesh| mesh.0.clone());
    let targets = stage.meshes.iter().find(|(known, _)| Some(known) == mesh.as_ref());
    let count = targets.map_or(0, |&(_, count)| count);
    let body = stage.rng.random_range(BODIES);
    if let Some(body) = stage.alive(body)
        && count == SHARED
        && stage.rng.random_bool(0.3)
    {
        return stage.app.insert(entity, MeshMorphWeights::Reference(body));
    }
    let mut weights = weights(stage, count);
    if stage.rng.random_bool(0.1) {
        let weights_of_nan = vec![f32::NAN; count];
        weights = MeshMorphWeights::Value {
            weights: weights_of_nan,
        };
    }
    if count == 0 {
        stage.app.remove::<MeshMorphWeights>(entity);
    } else {
        stage.app.insert(entity, weights);
    }
}

/// Moves a joint, makes its place invalid, or despawns it.
fn bend(stage: &mut Stage, row: usize) {
    let Some(joint) = stage.alive(row) else { return };
    match stage.rng.random_range(0..8) {
        0 => stage.despawn(row),
        1 | 2 => stage.app.insert(joint, Transform::from_translation(Vec3::NAN)),
        _ => {
            let place = place(stage);
            stage.app.insert(joint, place);
        }
    }
}
