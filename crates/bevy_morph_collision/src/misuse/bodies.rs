//! Components that have an effect on bodies only.

use super::subject::{Around, SubjectItem};
use super::verdict::Verdict;
use crate::app::WarnOnce;

/// Looks at the components of an entity that should be a body, or have one.
pub(super) fn check(subject: &SubjectItem, around: &Around, is_new: bool, log: &mut WarnOnce) -> Verdict {
    let entity = subject.entity;
    let is_body = subject.collider.is_some() || subject.parts || subject.scene.is_some();
    if subject.teleported && is_new && !is_body {
        // The next run removes it.
        let is_above = around.any_below(entity, |it| it.collider.is_some() || it.parts || it.scene.is_some());
        if !is_above && !around.is_pending(entity) {
            log.warn("MorphTeleported", around.about(entity), || {
                format!(
                    "`MorphTeleported` has no effect on entity {}: it is no body, and no collider is at or below it. Put it on the \
                     entity that you move elsewhere",
                    around.name(entity)
                )
            });
        }
    }
    let is_idle_root = subject.body_root && (around.settings.every_deforming_mesh.is_none() || !is_body);
    let is_idle_list = subject.colliding && !is_body;
    let are_idle_hooks = subject.hooks && (around.hooks.is_none() || !is_body);
    if !is_idle_root && !is_idle_list && !are_idle_hooks {
        return Verdict::Done;
    }
    if is_new || around.spawned.any_is_pending(&around.names) {
        return Verdict::Again;
    }
    if is_idle_root {
        log.warn("MorphBodyRoot", around.about(entity), || {
            let (why, remedy) = match around.settings.every_deforming_mesh {
                None => (
                    "`MorphCollisionSettings::every_deforming_mesh` is not set",
                    "The body of your own colliders is their `MorphColliderOf`; a `MorphColliderScene` makes its entity a body",
                ),
                Some(_) => (
                    "no collider of `MorphCollisionSettings::every_deforming_mesh` is below it",
                    "Put it on an entity above meshes that deform",
                ),
            };
            let name = around.name(entity);
            format!("`MorphBodyRoot` has no effect on entity {name}: {why}. {remedy}")
        });
    }
    if is_idle_list {
        log.warn("MorphCollidingEntities", around.about(entity), || {
            format!(
                "`MorphCollidingEntities` of entity {} stays empty: the entity is neither a collider nor a body. Put it on one, such as \
                 the entity with `MorphColliderScene`",
                around.name(entity)
            )
        });
    }
    if are_idle_hooks {
        log.warn("MorphActiveCollisionHooks", around.about(entity), || {
            let why = if around.hooks.is_none() {
                "the app has no hooks. Add them with `MorphCollisionHooksPlugin`"
            } else {
                "the entity is neither a collider nor a body. Put it on one, such as the entity with `MorphColliderScene`"
            };
            let name = around.name(entity);
            format!("`MorphActiveCollisionHooks` has no effect on entity {name}: {why}")
        });
    }
    Verdict::Done
}
