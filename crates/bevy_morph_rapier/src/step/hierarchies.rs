//! Marks hierarchies in which transforms have changed, so that Rapier places them before its step.

use bevy::ecs::change_detection::Tick;
use bevy::ecs::system::SystemChangeTick;
use bevy::prelude::*;
use bevy::transform::components::TransformTreeChanged;

/// What changes where an entity is, or what is above it.
type Moved = Or<(Changed<Transform>, Changed<ChildOf>, Added<GlobalTransform>)>;

/// Marks every entity that has moved since the last step, and all above it.
///
/// Rapier places hierarchies before its step, but only those that are marked. Without this, the first change of a joint, or of a body with
/// children, would reach the step a frame late, if at all. Bevy's `mark_dirty_trees` marks the same, and takes longer: it uses several
/// tasks, which wait for each other.
pub(crate) fn mark_moved_hierarchies(
    moved: Query<Entity, Moved>,
    mut orphaned: RemovedComponents<ChildOf>,
    mut trees: Query<(&mut TransformTreeChanged, Option<&ChildOf>)>,
    static_transforms: Res<StaticTransformOptimizations>,
    ticks: SystemChangeTick,
) {
    if !static_transforms.is_enabled() {
        orphaned.clear();
        return;
    }
    for entity in moved.iter().chain(orphaned.read()) {
        mark_up(entity, &mut trees, ticks.this_run());
    }
}

/// Marks an entity and all above it, up to one that this run has marked already.
fn mark_up(entity: Entity, trees: &mut Query<(&mut TransformTreeChanged, Option<&ChildOf>)>, this_run: Tick) {
    let mut next = Some(entity);
    while let Some((mut tree, parent)) = next.and_then(|entity| trees.get_mut(entity).ok()) {
        // Not `is_changed`: Bevy may have marked it since the last run, under another parent.
        if tree.last_changed() == this_run {
            return;
        }
        tree.set_changed();
        next = parent.map(ChildOf::parent);
    }
}
