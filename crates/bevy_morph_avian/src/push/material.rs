//! What contacts with a surface are like.

use avian3d::prelude::{ActiveCollisionHooks, CollisionLayers, CollisionMargin, Friction, Restitution};
use bevy::prelude::*;

/// Properties that the parts of a surface take from the surface's collider.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactMaterial {
    pub(crate) friction: Option<Friction>,
    pub(crate) restitution: Option<Restitution>,
    pub(crate) margin: Option<CollisionMargin>,
    pub(crate) layers: CollisionLayers,
    pub(crate) hooks: Option<ActiveCollisionHooks>,
}

impl ContactMaterial {
    pub(crate) fn apply_to(&self, mut part: EntityCommands) {
        fn set(part: &mut EntityCommands, component: Option<impl Component>) {
            fn remove<C: Component>(part: &mut EntityCommands, _: &Option<C>) {
                part.try_remove::<C>();
            }
            match component {
                Some(component) => {
                    part.try_insert(component);
                }
                none => remove(part, &none),
            }
        }
        set(&mut part, self.friction);
        set(&mut part, self.restitution);
        set(&mut part, self.margin);
        set(&mut part, self.hooks);
        part.try_insert(self.layers);
    }
}
