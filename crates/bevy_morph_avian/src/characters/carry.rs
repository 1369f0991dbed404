//! Carries kinematic characters along with the surface on which they stand.

use std::f32::consts::PI;
use std::ops::RangeInclusive;

use avian3d::prelude::{
    ColliderOf, MoveAndSlide, MoveAndSlideConfig, Physics, PhysicsLengthUnit, Position, RigidBody, Rotation, Sensor,
    ShapeCastConfig, SpatialQuery, SpatialQueryFilter,
};
use bevy::ecs::entity::EntityHashSet;
use bevy::ecs::entity::hash_map::EntityHashMap;
use bevy::prelude::*;
use bevy_morph_collision::components::MorphUnit;
use bevy_morph_physics::moving::SurfacePoint;
use bevy_morph_physics::{MorphCharacterGround, MorphPhysicsCollider};
use morph_collision::ShapeQuery;
use tracing::error;

use super::shape::{CharacterShape, CharacterShapes};
use crate::surface::AvianSurface;

/// What [`MorphAvianCarry::reach`] may be.
const REACHES: RangeInclusive<f32> = f32::MIN_POSITIVE..=f32::MAX;
/// What [`MorphAvianCarry::max_slope`] may be.
const SLOPES: RangeInclusive<f32> = 0.0..=PI;

/// Carries a character along with the [`MorphPhysicsCollider`] on which it stands.
///
/// Put it on a character that your game moves itself, for example with Avian's `MoveAndSlide`: an entity with a `Collider`, and
/// usually with `RigidBody::Kinematic`. At the end of each step, the character also moves with the velocity of the surface below its
/// feet, until it hits a wall. It is not rotated. Your own changes of its `Transform` add to that.
///
/// The component may be on a body, or on a collider below it: the body moves. If the entity has no `Collider`, all colliders of its
/// body are its shape.
///
/// The ground is the first thing below its shape that is not steeper than [`max_slope`](Self::max_slope). Surfaces that the
/// character merely touches do not move it. `MoveAndSlide` ignores colliders without a `RigidBody`, so give the surface one, such as
/// `RigidBody::Static`.
///
/// If a number is out of range, nothing carries the character, and the log says so once.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_avian::prelude::*;
/// use avian3d::prelude::*;
///
/// fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
///     commands.spawn((Mesh3d(jelly), MorphPhysicsCollider::default(), RigidBody::Static));
///     let body = (RigidBody::Kinematic, Collider::capsule(0.3, 1.0), CustomPositionIntegration);
///     commands.spawn((body, MorphAvianCarry::default(), Transform::from_xyz(0.0, 5.0, 0.0)));
/// }
/// ```
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCharacterGround)]
pub struct MorphAvianCarry {
    /// The direction away from the ground. The default is `+Y`.
    pub up: Dir3,
    /// How far below the shape the ground may be, in length units (multiplied by `PhysicsLengthUnit`). It must be larger than the
    /// character's distance from the ground, which is `MoveAndSlideConfig::skin_width`, 0.01. The default is 0.1.
    #[reflect(@REACHES, @MorphUnit::Length)]
    pub reach: f32,
    /// The angle of the steepest slope that carries, in radians. The default is 45 degrees.
    #[reflect(@SLOPES, @MorphUnit::Angle)]
    pub max_slope: f32,
}

impl Default for MorphAvianCarry {
    fn default() -> Self {
        Self {
            up: Dir3::Y,
            reach: 0.1,
            max_slope: std::f32::consts::FRAC_PI_4,
        }
    }
}

/// The points of surfaces on which characters stand before a step.
#[derive(Resource, Default)]
pub(crate) struct Footing(EntityHashMap<(Entity, SurfacePoint)>);

/// The number of things below a character that are too steep and may be skipped.
const WALLS: usize = 4;

/// Before a step: finds the points on which characters stand. Surfaces are where the last step left them.
pub(crate) fn find_ground(
    characters: Query<(Entity, &MorphAvianCarry)>,
    shapes: CharacterShapes,
    isometries: Query<(&Position, &Rotation)>,
    mut surfaces: Query<(&mut AvianSurface, Option<&ColliderOf>), With<MorphPhysicsCollider>>,
    bodies: Query<&RigidBody>,
    sensors: Query<(), With<Sensor>>,
    spatial: SpatialQuery,
    length_unit: Res<PhysicsLengthUnit>,
    mut footing: ResMut<Footing>,
    names: Query<NameOrEntity>,
    // Characters whose numbers are out of range, and the log says so.
    mut bad: Local<EntityHashSet>,
    mut query: Local<ShapeQuery>,
) {
    footing.0.clear();
    if surfaces.is_empty() {
        return;
    }
    let is_solid = |entity| !sensors.contains(entity);
    bad.retain(|&entity| characters.contains(entity));
    for (entity, carry) in &characters {
        let reach = carry.reach * length_unit.0;
        let Some(character) = shapes.of(entity) else { continue };
        let Ok((position, rotation)) = isometries.get(character.root) else {
            continue;
        };
        if !(REACHES.contains(&carry.reach) && SLOPES.contains(&carry.max_slope)) {
            if bad.insert(entity) {
                let name = names
                    .get(entity)
                    .map_or_else(|_| entity.to_string(), |name| name.to_string());
                error!("nothing carries entity `{name}`, because a number in its {carry:?} is out of range");
            }
            continue;
        }
        bad.remove(&entity);
        if !position.0.is_finite() || !(reach > 0.0 && reach.is_finite()) {
            continue;
        }
        let filter = character.filter();
        // From higher up, because the character may touch the ground.
        let start = position.0 + carry.up * reach;
        let config = ShapeCastConfig {
            ignore_origin_penetration: true,
            ..ShapeCastConfig::from_max_distance(2.0 * reach)
        };
        let steepest = carry.max_slope.cos().max(1e-3);
        let below = character
            .shapes_at(start, *rotation)
            .filter_map(|(shape, at, rotation)| {
                let mut filter = filter.clone();
                for _ in 0..WALLS {
                    let hit =
                        spatial.cast_shape_predicate(shape, at.0, rotation, -carry.up, &config, &filter, &is_solid)?;
                    if hit.normal1.dot(*carry.up) >= steepest {
                        return Some(hit);
                    }
                    filter.excluded_entities.insert(hit.entity);
                }
                None
            });
        let Some(hit) = below.min_by(|a, b| a.distance.total_cmp(&b.distance)) else {
            continue;
        };
        let Ok((mut surface, of)) = surfaces.get_mut(hit.entity) else {
            continue;
        };
        // What its body does in the step is not known yet.
        let is_dynamic = of.is_some_and(|of| bodies.get(of.body) == Ok(&RigidBody::Dynamic));
        if !is_dynamic && let Some(point) = surface.moving.closest(hit.point1, &mut query) {
            footing.0.insert(entity, (hit.entity, point));
        }
    }
}

/// At the end of a step: moves characters along with those points.
///
/// Inside the step, so that Avian does not take the new place for one that the game has set since then: it would ignore how the
/// game itself moves the `Transform`.
pub(crate) fn carry(
    mut characters: Query<(Entity, &mut MorphCharacterGround)>,
    shapes: CharacterShapes,
    mut surfaces: Query<&mut AvianSurface>,
    mut isometries: ParamSet<(MoveAndSlide, Query<(&mut Position, &Rotation)>)>,
    mut transforms: Query<(&mut Transform, Option<&ChildOf>), Without<RigidBody>>,
    globals: Query<&GlobalTransform>,
    footing: Res<Footing>,
    time: Res<Time<Physics>>,
    length_unit: Res<PhysicsLengthUnit>,
) {
    let skin = MoveAndSlideConfig::default().skin_width * length_unit.0;
    for (entity, mut ground) in &mut characters {
        let mut new = MorphCharacterGround::default();
        if let Some(&(surface, point)) = footing.0.get(&entity)
            && let Ok(mut state) = surfaces.get_mut(surface)
            && let Some(character) = shapes.of(entity)
        {
            let velocity = state.moving.velocity_at(point).unwrap_or_default().as_vec3();
            new.surface = Some(surface);
            new.velocity = velocity;
            let mut filter = character.filter();
            filter.excluded_entities.insert(surface);
            let from = isometries
                .p1()
                .get(character.root)
                .map(|(at, rotation)| (at.0, *rotation));
            let motion = velocity * time.delta_secs();
            if let Ok((from, rotation)) = from
                && motion != Vec3::ZERO
                && motion.is_finite()
            {
                let shift = slide(&isometries.p0(), &character, from, rotation, motion, skin, &filter);
                if let Ok((mut transform, parent)) = transforms.get_mut(character.root) {
                    // Avian follows the transform of a collider without a body.
                    let parent = parent.and_then(|parent| globals.get(parent.parent()).ok());
                    let shift = match parent {
                        Some(parent) => parent.affine().inverse().transform_vector3(shift),
                        None => shift,
                    };
                    // It is not if the parent is flat.
                    if shift.is_finite() {
                        transform.translation += shift;
                    }
                } else if let Ok((mut position, _)) = isometries.p1().get_mut(character.root) {
                    position.0 += shift;
                }
            }
        }
        ground.set_if_neq(new);
    }
}

/// How far a character moves that slides along what is in its way.
fn slide(
    space: &MoveAndSlide,
    character: &CharacterShape,
    from: Vec3,
    rotation: Rotation,
    motion: Vec3,
    skin: f32,
    filter: &SpatialQueryFilter,
) -> Vec3 {
    let (mut left, mut moved) = (motion, Vec3::ZERO);
    for _ in 0..4 {
        let Some(direction) = left.try_normalize() else { break };
        let hits = character
            .shapes_at(from + moved, rotation)
            .filter_map(|(shape, at, rotation)| {
                let hit = space.cast_move(shape, at.0, rotation, left, skin, filter)?;
                Some((hit.distance, hit.normal1))
            });
        let Some((distance, normal)) = hits.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            moved += left;
            break;
        };
        let way = direction * distance.min(left.length());
        moved += way;
        left -= way;
        left -= normal * left.dot(normal).min(0.0);
    }
    moved
}
