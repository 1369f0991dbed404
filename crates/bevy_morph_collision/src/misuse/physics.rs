//! Components of other crates that make an entity a collider, such as the one for physics engines.

use bevy::ecs::archetype::Archetype;
use bevy::ecs::component::ComponentId;
use bevy::prelude::*;

use super::watch::watch;

/// A component that makes the mesh of an entity a collider, and the one that does the same for a scene.
pub(super) struct ColliderComponent {
    collider: ComponentId,
    scene: ComponentId,
    pub(super) name: &'static str,
    pub(super) scene_name: &'static str,
}

/// Such components of other crates.
#[derive(Resource, Default)]
pub(super) struct ColliderComponents(Vec<ColliderComponent>);

impl ColliderComponents {
    /// The first one that an entity has.
    pub(super) fn of(&self, archetype: &Archetype) -> Option<&ColliderComponent> {
        self.0.iter().find(|component| archetype.contains(component.collider))
    }
}

impl ColliderComponent {
    /// Whether an entity has the component for scenes.
    pub(super) fn has_scene(&self, archetype: &Archetype) -> bool {
        archetype.contains(self.scene)
    }
}

/// From now on, warns if the component `C`, which makes the mesh of an entity a collider, has no effect on its entity. `S` is the one for
/// scenes.
pub fn note_collider_component<C: Component, S: Component>(app: &mut App) {
    fn short_name<T>() -> &'static str {
        std::any::type_name::<T>().rsplit("::").next().unwrap_or_default()
    }
    let world = app.world_mut();
    let (collider, scene) = (world.register_component::<C>(), world.register_component::<S>());
    let mut known = world.get_resource_or_init::<ColliderComponents>();
    if known.0.iter().any(|component| component.collider == collider) {
        return;
    }
    known.0.push(ColliderComponent {
        collider,
        scene,
        name: short_name::<C>(),
        scene_name: short_name::<S>(),
    });
    watch::<(C, S)>(app);
}
