//! The colliders that may touch a surface during a step.

use avian3d::prelude::CollisionLayers;
use bevy::prelude::*;
use bevy_morph_physics::math::SortedBoxes;
use bevy_morph_physics::push::{EnclosedCollider, Flight, NearbyCollider};
use parry3d::bounding_volume::Aabb;
use parry3d::shape::SharedShape;

/// A collider that may touch a surface.
pub(crate) struct Mover {
    /// A collider without a body counts as its own body.
    pub(crate) nearby: NearbyCollider<Entity, Entity>,
    pub(crate) layers: CollisionLayers,
    /// Whether surfaces push it. If not, it is a sensor or on a body that nothing pushes, and matters only if something listens
    /// for its contacts.
    pub(crate) pushed: bool,
    /// Whether it needs to know what it touches.
    pub(crate) listens: bool,
    pub(crate) velocity: Vec3,
    /// Its shape and how it moves, if surfaces push it and collision hooks do not decide what it touches.
    pub(crate) flight: Option<(SharedShape, Flight)>,
    /// Set if surfaces push it and one of them is solid: the collider as a solid surface sees it.
    pub(crate) enclosed: Option<EnclosedCollider>,
}

/// All colliders that may touch a surface.
#[derive(Default)]
pub(crate) struct Movers {
    all: Vec<Mover>,
    boxes: SortedBoxes,
}

impl Movers {
    /// Takes the list to fill it again.
    pub(crate) fn take(&mut self) -> Vec<Mover> {
        self.all.clear();
        std::mem::take(&mut self.all)
    }

    /// Replaces all, for this number of searches.
    pub(crate) fn set(&mut self, movers: Vec<Mover>, searches: usize) {
        self.all = movers;
        self.boxes
            .take(self.all.iter().map(|mover| mover.nearby.bounds), searches);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the movers that may be in a box during the step. `indices` is scratch memory.
    pub(crate) fn meeting<'a>(&'a self, bounds: &Aabb, indices: &'a mut Vec<u32>) -> impl Iterator<Item = &'a Mover> {
        self.boxes.meeting(bounds, indices);
        indices.iter().map(|&index| &self.all[index as usize])
    }
}
