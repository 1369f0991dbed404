//! Scenes that make no colliders, or fewer than wanted.

use std::collections::BTreeSet;

use super::subject::{Around, SubjectItem};
use super::verdict::Verdict;
use crate::app::WarnOnce;
use crate::components::MorphColliderScene;
use crate::setup::SceneState;

/// How many names a message lists.
const LISTED: usize = 20;

/// A mesh of a scene.
struct Part<'a> {
    /// Its name and those of the entities above it, up to the root.
    names: Vec<&'a str>,
    /// Whether it deforms or collides anyway.
    is_wanted: bool,
}

/// Looks at the scene of an entity, once its meshes are there.
pub(super) fn check(subject: &SubjectItem, around: &Around, is_new: bool, log: &mut WarnOnce) -> Verdict {
    let Some(scene) = subject.scene else {
        return Verdict::Done;
    };
    let state = around.spawned.state(subject.entity, &around.hierarchy, &around.names);
    match state {
        // A scene may still be spawned below it.
        None if is_new || around.spawned.any_is_pending(&around.names) => return Verdict::Again,
        None | Some(SceneState::Spawned) => {}
        // Noted again when it is spawned. Failures are logged elsewhere.
        Some(_) => return Verdict::Done,
    }
    let parts = parts(subject, around);
    if parts.is_empty() {
        log.warn("scene without meshes", around.about(subject.entity), || {
            let remedy = match state {
                None => "Put it on the entity that spawns the scene (`WorldAssetRoot`), or above the meshes",
                Some(_) => "Is it the right scene of the file?",
            };
            let name = around.name(subject.entity);
            format!("`MorphColliderScene` makes no colliders: there are no meshes at or below entity {name}. {remedy}")
        });
        return Verdict::Done;
    }
    unknown_names(subject, scene, &parts, around, log);
    rigid_meshes(subject, scene, &parts, around, log);
    Verdict::Done
}

/// The meshes of a scene.
fn parts<'a>(subject: &SubjectItem, around: &'a Around) -> Vec<Part<'a>> {
    let (root, hierarchy) = (subject.entity, &around.hierarchy);
    let mut parts = Vec::new();
    for entity in std::iter::once(root).chain(hierarchy.below(root)) {
        let Ok(mesh) = around.subjects.get(entity) else {
            continue;
        };
        if !mesh.mesh || hierarchy.scene_root(entity) != Some(root) {
            continue;
        }
        let path = hierarchy.path_below(entity, root);
        parts.push(Part {
            names: path.filter_map(|entity| around.names.own_name(entity)).collect(),
            is_wanted: mesh.deforms != (false, false) || mesh.collider.is_some(),
        });
    }
    parts
}

/// Warns of names that no mesh has.
fn unknown_names(
    subject: &SubjectItem,
    scene: &MorphColliderScene,
    parts: &[Part],
    around: &Around,
    log: &mut WarnOnce,
) {
    let known: BTreeSet<&str> = parts.iter().flat_map(|part| part.names.iter().copied()).collect();
    let unknown = scene.only_named.iter().filter(|name| !known.contains(name.as_str()));
    let unknown = list(unknown.map(String::as_str));
    if unknown.is_empty() {
        return;
    }
    let about = format!("{} {unknown}", around.about(subject.entity));
    log.warn("unknown names", about, || {
        let name = around.name(subject.entity);
        let known = match known.is_empty() {
            true => "None of them has a name".into(),
            false => format!("Their names: {}", list(known.iter().copied())),
        };
        format!(
            "`MorphColliderScene::only_named` of entity {name} has names that no mesh of the scene has, and no entity above one: {unknown}. \
             {known}"
        )
    });
}

/// Warns if everything wanted is left out because it is rigid.
fn rigid_meshes(
    subject: &SubjectItem,
    scene: &MorphColliderScene,
    parts: &[Part],
    around: &Around,
    log: &mut WarnOnce,
) {
    if !scene.only_deforming {
        return;
    }
    let are_rigid = |name: Option<&str>| {
        let is_named = |part: &&Part| name.is_none_or(|name| part.names.contains(&name));
        let mut named = parts.iter().filter(is_named).peekable();
        named.peek().is_some() && named.all(|part| !part.is_wanted)
    };
    let (is_told, which) = if scene.only_named.is_empty() {
        (are_rigid(None), "it".into())
    } else {
        let names = scene.only_named.iter().map(String::as_str);
        let rigid = list(names.filter(|name| are_rigid(Some(name))));
        (!rigid.is_empty(), rigid)
    };
    if !is_told {
        return;
    }
    let about = format!("{} {which}", around.about(subject.entity));
    log.warn("rigid meshes", about, || {
        let name = around.name(subject.entity);
        format!(
            "`MorphColliderScene` of entity {name} makes no colliders of {which}, because no mesh there has morph targets or joints. To \
             include rigid meshes, set `MorphColliderScene::only_deforming` to false"
        )
    });
}

/// Names in backticks, the first ones if there are many.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    let more = names.len().saturating_sub(LISTED);
    let listed = names[..names.len() - more].join(", ");
    if more > 0 {
        format!("{listed} and {more} more")
    } else {
        listed
    }
}
