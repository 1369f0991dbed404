//! The component that makes a mesh take part in physics.

use std::ops::RangeInclusive;

use bevy::prelude::*;
use bevy_morph_collision::components::{MorphCollider, MorphCollisionMode, MorphUnit};

use super::engine_check::check_engine;

/// What [`MorphPhysicsCollider::max_acceleration`] may be.
pub(crate) const ACCELERATIONS: RangeInclusive<f32> = 0.0..=f32::INFINITY;

/// Makes the mesh of a [`MorphCollider`] a collider of the physics engine: bodies collide with it as it deforms.
///
/// The engine's other collider components apply as usual, such as those for friction, restitution, groups or layers, sensors and
/// events. The plugin adds the engine's `Collider` itself when the mesh's tree is ready. The surface includes scale and shear of the entity.
///
/// - Without a rigid body, or on one that is fixed or kinematic (of this entity or an ancestor), the surface pushes and carries bodies
///   at its own velocity, which combines the animation's with that of its body.
/// - On a dynamic body it is the body's shape. With Rapier, it throws and carries others at its own velocity while it morphs, and its body is
///   pushed the other way; only a body in a `MultibodyJoint` that the game created just pushes others out of its surface. With Avian, its
///   morphing moves others only by pushing them out of itself.
/// - As a sensor it reports what it touches, and pushes nothing.
/// - Characters that a game moves can stand on it and be carried by it: see `MorphCharacterCarry` in `bevy_morph_rapier` and
///   `MorphAvianCarry` in `bevy_morph_avian`.
///
/// Like a triangle mesh, it is a surface without an inside, unless it is [`solid`](Self::solid).
///
/// The joints of a skinned mesh (with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), joint indices and weights) place it as
/// they are before the step, and give it their velocity: a character carries what stands on its hand, and its punch throws
/// crates. On a body, joints are assumed to move with that body: put mesh and joints below it, as the root of a glTF scene does.
/// If joints are bodies themselves (a ragdoll), the surface follows them one step late. The entity's own transform must be finite
/// even for a skinned mesh.
///
/// The surface exists while the entity has this component, a [`MorphCollider`] and a mesh whose tree is ready, and while nothing
/// disables it: [`MorphColliderDisabled`](bevy_morph_collision::components::MorphColliderDisabled), the engine's `ColliderDisabled` or Bevy's
/// `Disabled`. Pausing collision detection does not pause it. While its transform is not finite, or it is larger than 1e8 units or as
/// far from the origin, it is left out. This is logged once.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCollider = MorphCollider::new(MorphCollisionMode::Passive))]
#[component(on_add = check_engine::<Self>)]
pub struct MorphPhysicsCollider {
    /// The highest plausible acceleration of the surface, in length units per second squared: like the engine's own parameters, it is
    /// multiplied by its length unit. If the surface's velocity changes faster, it may have jumped (teleported) instead of moved.
    /// Such a change counts as motion only when the next step confirms it; until then it does not throw anything. The default is
    /// 100, ten times the acceleration of a fall.
    ///
    /// To say that a change is no motion however small it is, insert [`MorphTeleported`](bevy_morph_collision::components::MorphTeleported).
    /// Not negative. The log says so once if it is, and the last good value stays in use.
    #[reflect(@ACCELERATIONS, @MorphUnit::Acceleration)]
    pub max_acceleration: f32,
    /// Whether a closed mesh has an inside. The default is `false`.
    ///
    /// - Contacts only push outward. A body that is inside anyway (it was spawned there, or the surface jumped over it) is driven
    ///   out, at no more than the speed at which the engine separates bodies (with Rapier
    ///   `IntegrationParameters::max_corrective_velocity`, 3 length units per second; with Avian
    ///   `SolverConfig::max_overlap_solve_speed`, 4; and never more than 10), and leaves at a third of that. A sleeping body wakes up.
    ///   Characters that the game moves are not driven out. Between two solid surfaces that overlap, a body may be driven from one
    ///   into the other. With Avian, nothing is driven out of a surface on a dynamic body.
    /// - Point queries and `solid` rays find the inside. With Rapier, bodies entirely inside also count as touching for sensors,
    ///   intersections and distances; shape casts and contacts only see triangles. With Avian, sensors and shape intersections only see
    ///   triangles.
    ///
    /// Costs a ray and a closest point for each body near the surface, repeated whenever body and surface have moved by as much
    /// as the distance between them.
    ///
    /// A mesh is closed if along each of its edges, the same number of triangles run in either direction. Vertices at the same
    /// place in every pose, as at a seam of texture coordinates, count as one. If the mesh is not closed, this setting has no
    /// effect, and a warning in the log names the entity. You can change it at any time; it takes effect in the next step.
    pub solid: bool,
}

impl Default for MorphPhysicsCollider {
    fn default() -> Self {
        Self {
            max_acceleration: 100.0,
            solid: false,
        }
    }
}
