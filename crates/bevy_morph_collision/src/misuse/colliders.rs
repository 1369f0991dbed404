//! Colliders without a mesh, and components that need a collider.

use super::subject::{Around, SubjectItem};
use super::verdict::Verdict;
use crate::app::WarnOnce;

/// Looks at the collider of an entity, or at what should have one.
pub(super) fn check(subject: &SubjectItem, around: &Around, is_new: bool, log: &mut WarnOnce) -> Verdict {
    if subject.collider.is_none() {
        return without_collider(subject, around, is_new, log);
    }
    if subject.shape {
        with_shape(subject, around, log);
        return Verdict::Done;
    }
    if subject.mesh {
        return Verdict::Done;
    }
    without_mesh(subject, around, is_new, log)
}

/// A collider that has nothing to collide with.
fn without_mesh(subject: &SubjectItem, around: &Around, is_new: bool, log: &mut WarnOnce) -> Verdict {
    let entity = subject.entity;
    let (component, scene, has_scene) = match around.others.of(subject.archetype) {
        Some(other) => (other.name, other.scene_name, other.has_scene(subject.archetype)),
        None => ("MorphCollider", "MorphColliderScene", subject.scene.is_some()),
    };
    let name = || around.name(entity);
    if has_scene || subject.scene.is_some() || around.spawned.is_root(entity) {
        log.warn("collider on a scene", around.about(entity), || {
            let remedy = if has_scene {
                format!("Remove it, and set `{scene}::collider`")
            } else {
                format!("Use `{scene}` instead")
            };
            format!(
                "`{component}` has no effect on entity {}: it has no `Mesh3d`, and the meshes of its scene are on entities below it. {remedy}",
                name()
            )
        });
        return Verdict::Done;
    }
    if is_new || around.spawned.any_is_pending(&around.names) {
        return Verdict::Again;
    }
    log.warn("collider without a mesh", around.about(entity), || {
        let remedy = if around.any_below(entity, |it| it.mesh) {
            format!("There are meshes on entities below it: use `{scene}` instead, or put `{component}` on them")
        } else {
            format!("Put `{component}` on the entity that has the mesh")
        };
        format!(
            "`{component}` has no effect on entity {}: it has neither a `Mesh3d` nor a `MorphShape`. {remedy}",
            name()
        )
    });
    Verdict::Done
}

/// Components that ask something of a mesh that does not collide.
fn with_shape(subject: &SubjectItem, around: &Around, log: &mut WarnOnce) {
    let entity = subject.entity;
    let physics = around.others.of(subject.archetype).map(|other| other.name);
    let without_effect = [
        (
            physics.is_some(),
            physics.unwrap_or_default(),
            "give this entity a collider of the physics engine",
        ),
        (
            subject.self_collisions,
            "MorphSelfCollisions",
            "remove the shape, or put it on another entity",
        ),
        (
            subject.tree_options,
            "MorphTreeOptions",
            "remove the shape, or put it on another entity",
        ),
    ];
    for (_, component, remedy) in without_effect.into_iter().filter(|(is_there, ..)| *is_there) {
        log.warn(component, around.about(entity), || {
            format!(
                "`{component}` has no effect on entity {}: its `MorphShape` collides instead of a mesh. To change that, {remedy}",
                around.name(entity)
            )
        });
    }
}

/// Components that only a collider uses.
fn without_collider(subject: &SubjectItem, around: &Around, is_new: bool, log: &mut WarnOnce) -> Verdict {
    let entity = subject.entity;
    let on_a_part = "put it on a part of the scene; `MorphColliders` lists them";
    let without_effect = [
        (
            subject.layers,
            "MorphCollisionLayers",
            "set `MorphColliderScene::layers`",
        ),
        (
            subject.events,
            "MorphCollisionEventsEnabled",
            "set `MorphColliderScene::events`; `MorphBodyCollisionStart` and `MorphBodyCollisionEnd` are triggered here without it",
        ),
        (subject.disabled, "MorphColliderDisabled", on_a_part),
        (subject.self_collisions, "MorphSelfCollisions", on_a_part),
        (subject.tree_options, "MorphTreeOptions", on_a_part),
        (subject.part_of, "MorphColliderOf", on_a_part),
    ];
    let has_own_scene = subject.scene.is_some() && !subject.mesh;
    for (_, component, for_scene) in without_effect.into_iter().filter(|(is_there, ..)| *is_there) {
        if !has_own_scene && (is_new || around.spawned.any_is_pending(&around.names)) {
            return Verdict::Again;
        }
        log.warn(component, around.about(entity), || {
            let name = around.name(entity);
            if has_own_scene {
                format!(
                    "`{component}` has no effect on entity {name}: the colliders of its `MorphColliderScene` are on entities below it. \
                     To change that, {for_scene}"
                )
            } else {
                format!(
                    "`{component}` has no effect on entity {name}, which has no `MorphCollider`. Put it on an entity that has one"
                )
            }
        });
    }
    Verdict::Done
}
