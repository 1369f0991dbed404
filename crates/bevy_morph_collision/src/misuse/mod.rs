//! Warnings about likely mistakes: components on entities where they have no effect.
//!
//! None of this runs in a game in which nothing new is spawned. Observers note entities that get one of the plugin's components. Each is
//! looked at in the same frame, for what is certainly wrong. If it still lacks something, it is looked at again some seconds later,
//! when scenes are loaded. Then it is forgotten.
//!
//! - `watch`: notes entities. `look`: the system that looks at entities. `verdict`: what a look says.
//! - `subject`: the components of one entity.
//! - `colliders`: components that need a collider, and colliders without a mesh.
//! - `bodies`: components that need a body.
//! - `scenes`: scenes without parts.
//! - `anchors`: anchors that follow nothing.
//! - `physics`: components of other crates that make an entity a collider, such as the one for physics engines.
//! - `later`: checks of other crates that wait until all plugins are there.
//! - `meshes`: meshes that never come, or whose joint weights are odd.

mod anchors;
mod bodies;
mod colliders;
mod later;
mod look;
mod meshes;
mod physics;
mod scenes;
mod subject;
mod verdict;
mod watch;

use bevy::prelude::*;

use crate::app::{MorphCollisionSystems, Suspects};
use crate::components::{
    MorphActiveCollisionHooks, MorphBodyRoot, MorphCollider, MorphColliderDisabled, MorphColliderOf,
    MorphCollisionEventsEnabled, MorphCollisionLayers, MorphTeleported, MorphTreeOptions,
};
use crate::events::MorphCollidingEntities;
use crate::import;
use crate::self_collisions::MorphSelfCollisions;
use crate::setup::report_outcomes;
use crate::surface::MorphSurfaceAnchor;

pub use later::check_in_next_frame;
pub use physics::note_collider_component;

/// Components whose entity is looked at when they are added. Scenes are noted when they change.
type Watched = (
    MorphCollider,
    MorphSelfCollisions,
    MorphTreeOptions,
    MorphColliderDisabled,
    MorphCollisionLayers,
    MorphCollisionEventsEnabled,
    MorphCollidingEntities,
    MorphColliderOf,
    MorphBodyRoot,
    MorphTeleported,
    MorphActiveCollisionHooks,
);

/// Adds the checks to an app.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<Suspects>()
        .init_resource::<physics::ColliderComponents>()
        // What an anchor follows may change.
        .add_observer(
            |inserted: On<Insert<MorphSurfaceAnchor>>, mut suspects: ResMut<Suspects>| {
                suspects.note(inserted.entity);
            },
        );
    watch::watch::<(Watched, MorphSurfaceAnchor)>(app);
    app.add_systems(
        PostUpdate,
        (
            look::check_suspects.run_if(look::any_suspects),
            meshes::warn_of_missing_meshes.run_if(meshes::any_is_missing),
            meshes::warn_of_joint_weights.run_if(meshes::trees_changed),
            later::run_checks.run_if(later::are_waiting),
        )
            .chain()
            .in_set(MorphCollisionSystems::Import)
            .after(import::finish_trees)
            .after(report_outcomes),
    );
}

#[cfg(test)]
mod tests {
    use bevy::mesh::MeshPlugin;

    use super::*;
    use crate::plugins::MorphCollisionPlugin;

    #[test]
    fn entities_that_came_before_the_plugin_are_looked_at() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), MeshPlugin));
        app.world_mut().spawn(Transform::default());
        let collider = app.world_mut().spawn(MorphCollider::default()).id();
        app.add_plugins(MorphCollisionPlugin);
        let noted = app
            .world_mut()
            .resource_mut::<Suspects>()
            .take(std::time::Duration::ZERO);
        assert_eq!(noted, [(collider, true)]);
    }

    #[test]
    fn colliders_that_lack_nothing_are_forgotten_after_a_bounded_number_per_frame() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), MeshPlugin))
            .add_plugins(MorphCollisionPlugin);
        app.finish();
        app.cleanup();
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(Cuboid::default());
        let body = app.world_mut().spawn_empty().id();
        let colliders = (0..1000).map(|_| (Mesh3d(mesh.clone()), MorphCollider::default(), MorphColliderOf { body }));
        let colliders: Vec<_> = colliders.collect();
        app.world_mut().spawn_batch(colliders);
        for _ in 0..4 {
            assert!(!app.world().resource::<Suspects>().is_empty());
            app.update();
        }
        assert!(app.world().resource::<Suspects>().is_empty());
    }
}
