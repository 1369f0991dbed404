//! Anchors that follow nothing.

use bevy::prelude::*;

use super::subject::{Around, SubjectItem};
use super::verdict::Verdict;
use crate::app::WarnOnce;
use crate::surface::MorphSurfaceAnchor;

/// Looks at what the anchor of an entity follows.
pub(super) fn check(subject: &SubjectItem, around: &Around, is_new: bool, log: &mut WarnOnce) -> Verdict {
    let Some(anchor) = subject.anchor else {
        return Verdict::Done;
    };
    if is_new {
        return Verdict::Again;
    }
    let problem = match problem(anchor, around) {
        Ok(()) => return Verdict::Done,
        Err(None) => return Verdict::Again,
        Err(Some(problem)) => problem,
    };
    log.warn("MorphSurfaceAnchor", around.about(subject.entity), || {
        let name = around.name(subject.entity);
        format!("the `MorphSurfaceAnchor` of entity {name} follows nothing: {problem}")
    });
    Verdict::Done
}

/// Why an anchor follows nothing; `Err(None)` if that is not known yet.
fn problem(anchor: &MorphSurfaceAnchor, around: &Around) -> Result<(), Option<String>> {
    let collider = anchor.collider;
    let Ok(target) = around.subjects.get(collider) else {
        return Err(Some(format!(
            "its `collider`, entity {collider}, does not exist. Set it to an entity with a `MorphCollider`, such as `MorphRayHit::entity`"
        )));
    };
    let name = around.name(collider);
    if target.collider.is_none() || (!target.mesh && !target.shape) {
        if around.spawned.any_is_pending(&around.names) {
            return Err(None);
        }
        let why = match target.parts || target.scene.is_some() {
            true => "is a body, and its colliders are on other entities. Set it to one of them",
            false => "is no collider. Set it to an entity with `MorphCollider` and `Mesh3d`",
        };
        return Err(Some(format!(
            "its `collider`, entity {name}, {why}, such as `MorphRayHit::entity`"
        )));
    }
    if target.shape {
        return Err(Some(format!(
            "its `collider`, entity {name}, has a `MorphShape`, and shapes have no surface to follow. Make the entity a child of it instead"
        )));
    }
    if !anchor.barycentrics.is_finite() || !anchor.offset.is_finite() {
        return Err(Some("its `barycentrics` or its `offset` is not finite".into()));
    }
    let Some(key) = around.tree_key(collider) else {
        return Ok(());
    };
    match (around.trees.tree(key), around.trees.outcome(key)) {
        (Some(tree), _) => {
            let count = tree.model().triangle_count();
            if anchor.triangle as usize >= count {
                let triangle = anchor.triangle;
                let text = format!(
                    "the mesh of entity {name} has {count} triangles, and no number {triangle}; they count from 0"
                );
                return Err(Some(text));
            }
            Ok(())
        }
        // The mesh has failed, which is logged elsewhere.
        (None, Some(_)) => Ok(()),
        (None, None) => Err(None),
    }
}
