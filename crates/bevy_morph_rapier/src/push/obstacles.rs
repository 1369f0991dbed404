//! What surfaces on dynamic bodies touch besides dynamic bodies: fixed and kinematic colliders.

use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::parry::shape::{HalfSpace, Shape, TypedShape};
use bevy_rapier3d::rapier::dynamics::{RigidBodyHandle, RigidBodyType};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle};

use super::movers::{Mover, is_part};
use super::world::World;
use crate::queries::is_ground;
use bevy_morph_physics::math::SortedBoxes;
use bevy_morph_physics::push::NearbyCollider;

/// All colliders that are not on a dynamic body and may have contacts.
pub(crate) struct Obstacles {
    colliders: Vec<ColliderHandle>,
    boxes: SortedBoxes,
}

impl Obstacles {
    /// Collects them, for this number of searches in a step of `dt` seconds.
    pub(crate) fn find(world: &World, dt: f32, searches: usize) -> Self {
        let found = |(handle, collider): (ColliderHandle, &Collider)| {
            let [begin, end] =
                whereabouts(collider, dt, world)?.map(|isometry| collider.shape().compute_aabb(&isometry));
            Some((handle, begin.merged(&end)))
        };
        let (colliders, found): (Vec<_>, Vec<_>) = world.colliders.iter().filter_map(found).unzip();
        let mut boxes = SortedBoxes::default();
        boxes.take(found.into_iter(), searches);
        Self { colliders, boxes }
    }

    /// Those in a box during a step of `dt` seconds, with their bounds cut to it.
    pub(crate) fn within(&self, bounds: &Aabb, dt: f32, world: &World) -> Vec<Mover> {
        let mut indices = Vec::new();
        self.boxes.meeting(bounds, &mut indices);
        let obstacle = |&index: &u32| {
            let handle = *self.colliders.get(index as usize)?;
            let collider = world.colliders.get(handle)?;
            let [begin, end] = whereabouts(collider, dt, world)?;
            let at_begin = within(bounds, collider.shape(), &begin);
            let at_end = if end == begin {
                None
            } else {
                within(bounds, collider.shape(), &end)
            };
            let in_box = match (at_begin, at_end) {
                (Some(begin), Some(end)) => begin.merged(&end),
                (begin, end) => begin.or(end)?,
            };
            Some(Mover {
                nearby: NearbyCollider {
                    collider: handle,
                    body: collider.parent().unwrap_or_else(RigidBodyHandle::invalid),
                    bounds: in_box.loosened(collider.contact_skin()),
                    asleep: false,
                },
                look_ahead: 0.0,
                fast: false,
                flight: None,
                bullet: false,
                groups: collider.collision_groups(),
                events: collider.active_events(),
            })
        };
        indices.iter().filter_map(obstacle).collect()
    }
}

/// Where a collider is at the start and end of a step, if it is an obstacle.
fn whereabouts(collider: &Collider, dt: f32, world: &World) -> Option<[Isometry; 2]> {
    if collider.is_sensor() || !collider.is_enabled() || is_part(collider) || is_ground(collider.shape()) {
        return None;
    }
    let Some(body) = collider.parent().and_then(|body| world.bodies.get(body)) else {
        return Some([*collider.position(); 2]);
    };
    if body.is_dynamic() || !body.is_enabled() {
        return None;
    }
    let end = match body.body_type() {
        RigidBodyType::KinematicPositionBased => *body.next_position(),
        RigidBodyType::KinematicVelocityBased => body.predict_position_using_velocity(dt),
        _ => *body.position(),
    };
    let in_body = collider.position_wrt_parent().copied().unwrap_or_default();
    Some([*body.position() * in_body, end * in_body])
}

/// A box around the part of a shape that is in a box.
fn within(bounds: &Aabb, shape: &dyn Shape, isometry: &Isometry) -> Option<Aabb> {
    if !isometry.translation.is_finite() || !isometry.rotation.is_finite() {
        return None;
    }
    if let Some(plane) = shape.as_shape::<HalfSpace>() {
        return below(bounds, plane, isometry);
    }
    let whole = shape.compute_aabb(isometry).intersection(bounds)?;
    // Of a large ground, only the part nearby counts.
    let local = whole.transform_by(&isometry.inverse());
    let mut near: Option<Aabb> = None;
    let mut add = |part: Aabb| near = Some(near.map_or(part, |near| near.merged(&part)));
    if let TypedShape::HeightField(field) = shape.as_typed_shape() {
        field.map_elements_in_local_aabb(&local, &mut |_, triangle| add(triangle.local_aabb()));
    } else if let Some(composite) = shape.as_composite_shape() {
        let bvh = composite.bvh();
        for leaf in bvh.intersect_aabb(&local) {
            bvh.leaf_node(leaf).into_iter().for_each(|leaf| add(leaf.aabb()));
        }
    } else {
        return Some(whole);
    }
    near?.transform_by(isometry).intersection(&whole)
}

/// A box around the part of a box below a plane, as far as the axes allow.
fn below(bounds: &Aabb, plane: &HalfSpace, isometry: &Isometry) -> Option<Aabb> {
    let normal = isometry.rotation * plane.normal;
    let height = normal.dot(isometry.translation);
    let corners = bounds.vertices();
    if corners.iter().all(|corner| normal.dot(*corner) > height) {
        return None;
    }
    let mut below = *bounds;
    let axis = normal.abs().max_position();
    if normal[axis].abs() > 0.999 {
        // The plane's highest point in the box.
        let others = corners.map(|corner| (height - normal.dot(corner)) / normal[axis] + corner[axis]);
        if normal[axis] > 0.0 {
            below.maxs[axis] = others.into_iter().fold(f32::MIN, f32::max).min(bounds.maxs[axis]);
        } else {
            below.mins[axis] = others.into_iter().fold(f32::MAX, f32::min).max(bounds.mins[axis]);
        }
    }
    Some(below)
}
