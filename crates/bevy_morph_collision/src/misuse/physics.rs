//! Components for physics engines that the app does not have.

use bevy::prelude::*;

use super::subject::{Around, SubjectItem};
use super::verdict::Verdict;
use crate::app::WarnOnce;

/// Notes entities that get a component of a physics engine.
pub(super) fn watch(app: &mut App) {
    #[cfg(feature = "rapier")]
    note_when_added::<(crate::MorphRapierCollider, crate::MorphRapierScene)>(app);
    #[cfg(feature = "avian")]
    note_when_added::<(crate::MorphAvianCollider, crate::MorphAvianScene)>(app);
    #[cfg(not(any(feature = "rapier", feature = "avian")))]
    let _no_engine = app;
}

#[cfg(any(feature = "rapier", feature = "avian"))]
fn note_when_added<B: Bundle>(app: &mut App) {
    app.add_observer(|added: On<Add<B>>, mut suspects: ResMut<super::Suspects>| suspects.note(added.entity));
}

/// The component that makes an entity a collider of a physics engine, the one for scenes, and whether the entity has that, too.
#[cfg_attr(not(any(feature = "rapier", feature = "avian")), allow(unused_variables))]
pub(super) fn collider_of(subject: &SubjectItem) -> Option<(&'static str, &'static str, bool)> {
    #[cfg(feature = "rapier")]
    if let (true, has_scene) = subject.rapier {
        return Some(("MorphRapierCollider", "MorphRapierScene", has_scene));
    }
    #[cfg(feature = "avian")]
    if let (true, has_scene) = subject.avian {
        return Some(("MorphAvianCollider", "MorphAvianScene", has_scene));
    }
    None
}

/// Warns of components for a physics engine that the app, or this crate's plugin for it, lacks.
#[cfg_attr(not(any(feature = "rapier", feature = "avian")), allow(unused_variables))]
pub(super) fn check(subject: &SubjectItem, around: &Around, log: &mut WarnOnce) -> Verdict {
    #[cfg(feature = "rapier")]
    if let Some(plugin) = around.rapier.plugin() {
        let components = ["MorphRapierCollider", "MorphRapierScene"];
        warn_of(subject.rapier, components, plugin, (subject, around), log);
    }
    #[cfg(feature = "avian")]
    if let Some(plugin) = around.avian.plugin() {
        let components = ["MorphAvianCollider", "MorphAvianScene"];
        warn_of(subject.avian, components, plugin, (subject, around), log);
    }
    Verdict::Done
}

#[cfg(any(feature = "rapier", feature = "avian"))]
fn warn_of(
    (collider, scene): (bool, bool),
    names: [&'static str; 2],
    [plugin, value]: [&str; 2],
    (subject, around): (&SubjectItem, &Around),
    log: &mut WarnOnce,
) {
    let component = match (collider, scene) {
        (_, true) => names[1],
        (true, false) => names[0],
        (false, false) => return,
    };
    // The app lacks it, whichever entity shows that first.
    log.warn(names[0], String::new(), || {
        let name = around.name(subject.entity);
        format!(
            "`{component}` has no effect on entity {name}, because the app lacks `{plugin}`: write app.add_plugins({value})"
        )
    });
}
