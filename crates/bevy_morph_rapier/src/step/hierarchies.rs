//! Marks hierarchies in which transforms have changed, so that Rapier places them before its step.

use bevy::ecs::change_detection::Tick;
use bevy::ecs::system::SystemChangeTick;
use bevy::prelude::*;
use bevy::transform::components::TransformTreeChanged;

/// What changes where an entity is, or what is above it.
type Moved = Or<(Changed<Transform>, Changed<ChildOf>, Added<GlobalTransform>)>;

/// Marks every entity that has moved since this system last ran, and all above it.
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
        // And what was spawned right before this run has its tick.
        if tree.last_changed() == this_run && tree.added() != this_run {
            return;
        }
        tree.set_changed();
        next = parent.map(ChildOf::parent);
    }
}

#[cfg(test)]
mod tests {
    use bevy::ecs::entity::EntityHashSet;
    use bevy::prelude::*;
    use bevy::tasks::{ComputeTaskPool, TaskPool};
    use bevy::transform::components::TransformTreeChanged;
    use bevy::transform::systems::mark_dirty_trees;

    use super::mark_moved_hierarchies;

    #[derive(Resource, Default)]
    struct Marked(EntityHashSet);

    fn list(marked: Query<Entity, Changed<TransformTreeChanged>>, mut list: ResMut<Marked>) {
        list.0 = marked.iter().collect();
    }

    #[test]
    fn what_moved_is_marked_with_all_above_it() {
        let mut world = World::new();
        world.init_resource::<StaticTransformOptimizations>();
        world.init_resource::<Marked>();
        let [first, second] = [(); 2].map(|()| world.spawn(Transform::default()).id());
        let middle = world.spawn((Transform::default(), ChildOf(first))).id();
        let leaf = world.spawn((Transform::default(), ChildOf(middle))).id();
        let still = world.spawn((Transform::default(), ChildOf(first))).id();
        let mut ours = Schedule::default();
        ours.add_systems((mark_moved_hierarchies, list).chain());
        let mut marked = move |world: &mut World| {
            ours.run(world);
            world.resource::<Marked>().0.clone()
        };
        assert_eq!(
            marked(&mut world),
            EntityHashSet::from_iter([first, second, middle, leaf, still])
        );
        assert_eq!(marked(&mut world), EntityHashSet::from_iter([]));
        let move_leaf = |world: &mut World| {
            world.entity_mut(leaf).insert(Transform::from_xyz(1.0, 0.0, 0.0));
        };
        move_leaf(&mut world);
        assert_eq!(marked(&mut world), EntityHashSet::from_iter([first, middle, leaf]));
        // Bevy marks the leaf at the end of a frame. Then it gets another parent.
        move_leaf(&mut world);
        ComputeTaskPool::get_or_init(TaskPool::default);
        let mut at_the_end = Schedule::default();
        at_the_end.add_systems(mark_dirty_trees);
        at_the_end.run(&mut world);
        world.entity_mut(leaf).insert(ChildOf(second));
        assert!(marked(&mut world).contains(&second));
        let child = world.spawn((Transform::default(), ChildOf(second))).id();
        assert_eq!(marked(&mut world), EntityHashSet::from_iter([second, child]));
        world.entity_mut(leaf).remove::<ChildOf>();
        assert_eq!(marked(&mut world), EntityHashSet::from_iter([leaf]));
    }
}
