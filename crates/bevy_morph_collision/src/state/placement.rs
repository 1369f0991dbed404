//! How a collider takes part in a run, besides its pose.

use crate::components::{MorphCollisionLayers, MorphCollisionMode};
use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;
use morph_collision::motion::MovingShape;
use morph_collision::{Aabb, PlacedShape, WorldFromModel};

/// Everything besides the pose that the broad and narrow phases depend on.
#[derive(Clone, PartialEq)]
pub(crate) struct Placement {
    pub(crate) form: Form,
    pub(crate) body: Entity,
    pub(crate) mode: MorphCollisionMode,
    pub(crate) layers: MorphCollisionLayers,
    pub(crate) margin: f32,
    pub(crate) continuous: bool,
    /// In world space, without the margin.
    pub(crate) bounds: Aabb,
}

impl MapEntities for Placement {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.body.map_entities(mapper);
    }
}

/// The collider's geometry, placed in the world.
#[derive(Clone, PartialEq)]
pub(crate) enum Form {
    /// The identity for a skinned mesh: its joints place it.
    Mesh(WorldFromModel),
    Shape(PlacedShape),
}

/// Why two colliders whose boxes overlap are not compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Skip {
    SameBody,
    Layers,
    Passive,
    Rigid,
}

impl Placement {
    /// Why the two are not compared; `None` if they are.
    pub(crate) fn skips(&self, other: &Self) -> Option<Skip> {
        if self.body == other.body {
            Some(Skip::SameBody)
        } else if !self.layers.interacts_with(other.layers) {
            Some(Skip::Layers)
        } else if self.mode.max(other.mode) == MorphCollisionMode::Passive {
            Some(Skip::Passive)
        } else if matches!((&self.form, &other.form), (Form::Shape(_), Form::Shape(_))) {
            Some(Skip::Rigid)
        } else {
            None
        }
    }

    /// A box around its way from an earlier placement; `None` if it has none.
    pub(crate) fn way_from(&self, before: &Self) -> Option<Aabb> {
        match (&before.form, &self.form) {
            (Form::Mesh(_), Form::Mesh(_)) => Some(before.bounds.union(&self.bounds)),
            (Form::Shape(from), Form::Shape(to)) => {
                let [low, high] = MovingShape::between(from, to)?.bounds();
                let way = Aabb {
                    min: low.as_vec3().map(f32::next_down),
                    max: high.as_vec3().map(f32::next_up),
                };
                Some(way.union(&self.bounds))
            }
            _ => None,
        }
    }

    pub(crate) fn bounds_with_margin(&self) -> Aabb {
        let Aabb { min, max } = self.bounds;
        if self.margin == 0.0 {
            return self.bounds;
        }
        // Round outward to cover the rounding of the subtraction and addition.
        Aabb {
            min: (min - self.margin).map(f32::next_down),
            max: (max + self.margin).map(f32::next_up),
        }
    }
}
