//! What a run found: which colliders and bodies touch, and what started and ended.
//!
//! - `collisions`: the contacts of the last run. `contact`: one of them. `impact`: how it began, for continuous colliders.
//! - `body_pairs`: the same contacts, grouped by bodies.
//! - `changes`: what started and ended, in a run or in a frame.
//! - `mapping`: the same for entities that have got other IDs.

mod body_pairs;
mod changes;
mod collisions;
mod contact;
mod impact;
mod mapping;
mod no_triangles;
mod of_bodies;

use bevy::prelude::*;

pub use collisions::MorphCollisions;
pub(crate) use contact::pair_with_shape;
pub use contact::{MorphContact, MorphContactPoint};
pub use impact::{MorphImpact, MorphImpactFeatures};
pub(crate) use mapping::{map_pair, map_pairs};
pub(crate) use no_triangles::no_triangles;

/// Adds the contacts, and registers the types for reflection.
pub(crate) fn add(app: &mut App) {
    app.init_resource::<MorphCollisions>()
        .register_type::<MorphCollisions>()
        .register_type::<MorphContact>()
        .register_type::<MorphContactPoint>()
        .register_type::<MorphImpact>()
        .register_type::<MorphImpactFeatures>();
}
