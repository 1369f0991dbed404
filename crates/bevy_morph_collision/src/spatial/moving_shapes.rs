//! Casts of shapes that move and turn.

use bevy::math::DVec3;
use bevy::prelude::*;
use morph_collision::motion::MovingShape;
use morph_collision::{Aabb, InputError, Rank};

use super::shapes::place;
use super::target::Target;
use super::{MorphMotionHit, MorphQueryFilter, MorphSpatialQuery};
use crate::components::MorphShape;
use crate::contacts::MorphContact;

/// The largest error of a time, as a share of the motion.
const TOLERANCE: f64 = 1e-6;

/// How a shape moves: along a straight line, while it turns at a constant rate around a point that moves with it.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Debug, Default, Clone, PartialEq)]
pub struct MorphShapeMotion {
    /// How far it moves, in world units.
    pub translation: Vec3,
    /// The point around which it turns, in world space at the start: a hinge, or the handle of a sword.
    pub pivot: Vec3,
    /// The axis of the turn times its angle in radians. It may be more than a whole turn.
    pub rotation: Vec3,
}

impl MorphSpatialQuery<'_, '_> {
    /// The first collider that a solid shape touches while it moves and turns: a sword that is swung, a door that opens.
    ///
    /// Colliders stay as they are in this run. Nothing is missed. What the shape passes by within 1e-13 of the coordinates (1.5e-8 for
    /// cylinders, cones and convex hulls) may be reported. Among equal times, the lowest entity wins. A half-space cannot move.
    ///
    /// ```
    /// # use bevy::prelude::*;
    /// # use bevy_morph_collision::prelude::*;
    /// fn slash(spatial: MorphSpatialQuery) {
    ///     let blade = MorphShape::Cuboid { half_extents: Vec3::new(0.02, 0.5, 0.005) };
    ///     let (hand, up) = (Vec3::new(0.0, 1.0, 0.0), Vec3::Y * 0.5);
    ///     let swing = MorphShapeMotion { pivot: hand, rotation: Vec3::X * -1.5, ..default() };
    ///     let hit = spatial.cast_moving_shape(&blade, hand + up, Quat::IDENTITY, &swing, &MorphQueryFilter::default());
    ///     if let Some(hit) = hit {
    ///         println!("hits {} after {} of the swing", hit.entity, hit.time);
    ///     }
    /// }
    /// # App::new().add_systems(Update, slash);
    /// ```
    #[must_use]
    pub fn cast_moving_shape(
        &self,
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        motion: &MorphShapeMotion,
        filter: &MorphQueryFilter,
    ) -> Option<MorphMotionHit> {
        self.cast_moving_shape_predicate(shape, origin, rotation, motion, filter, |_| true)
    }

    /// [`MorphSpatialQuery::cast_moving_shape`] for colliders that a predicate accepts.
    #[must_use]
    pub fn cast_moving_shape_predicate(
        &self,
        shape: &MorphShape,
        origin: Vec3,
        rotation: Quat,
        motion: &MorphShapeMotion,
        filter: &MorphQueryFilter,
        mut predicate: impl FnMut(Entity) -> bool,
    ) -> Option<MorphMotionHit> {
        let shape = self.valid("cast_moving_shape", moving(shape, origin, rotation, motion))?;
        let [low, high] = shape.bounds().map(DVec3::as_vec3);
        let around = Aabb {
            min: low.map(f32::next_down),
            max: high.map(f32::next_up),
        };
        let mut first: Option<(Rank<(Entity, u32)>, MorphMotionHit)> = None;
        let reaches = |bounds: &Aabb| around.overlaps(bounds).then_some(0.0);
        self.walker()?
            .walk(filter, &mut predicate, 0.0, reaches, |queries, entity, target| {
                let found = match target {
                    Target::Mesh(body) => {
                        let found = queries.shape.cast_moving(body, &shape, TOLERANCE);
                        found.map(|hit| (hit.time, hit.point, hit.normal, hit.velocity, hit.triangle))
                    }
                    Target::Shape(other) => {
                        let found = shape.cast(other, TOLERANCE);
                        found.map(|hit| (hit.time, hit.point, hit.normal, hit.velocity, MorphContact::NO_TRIANGLE))
                    }
                };
                if let Some((time, point, normal, velocity, triangle)) = found {
                    let [point, normal, velocity] = [point, normal, velocity].map(DVec3::as_vec3);
                    let rank = Rank::new(time.latest, (entity, triangle));
                    let time = time.latest as f32;
                    if first.as_ref().is_none_or(|(first, _)| rank < *first) {
                        let hit = MorphMotionHit {
                            entity,
                            time,
                            point,
                            normal,
                            velocity,
                            triangle,
                        };
                        first = Some((rank, hit));
                    }
                }
                0.0
            });
        first.map(|(_, hit)| hit)
    }
}

fn moving(
    shape: &MorphShape,
    origin: Vec3,
    rotation: Quat,
    motion: &MorphShapeMotion,
) -> Result<MovingShape, InputError> {
    let (placed, _) = place(shape, origin, rotation)?;
    let moving = MovingShape::new(placed, motion.translation.as_dvec3())?;
    moving.turning(motion.pivot.as_dvec3(), motion.rotation.as_dvec3())
}
