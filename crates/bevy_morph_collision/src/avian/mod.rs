//! Physics: rigid bodies of `avian3d` rest on morphing and skinned meshes, are pushed and carried by them, and its queries see them.
//!
//! - `shape`: what Avian knows the whole surface as.
//! - `scene`, `attach`: which meshes have a surface.
//! - `ahead`: where a mesh will be at the end of a step.
//! - `movers`: the colliders that may meet it.
//! - `push`, `part`: how it pushes: what is near moving bodies is a kinematic body for one step.
//! - `frames`: what surfaces are drawn with, frame by frame.
//! - `step`: the systems around Avian's step.
//! - `contacts`: that contacts with parts are those of the surface.
//!
//! What a surface is, where it moves and what of it is near bodies is in [`crate::physics`].

mod ahead;
mod attach;
mod contacts;
mod frames;
mod movers;
mod part;
mod push;
mod scene;
mod shape;
mod step;

use avian3d::prelude::{NarrowPhaseSystems, PhysicsSchedule, PhysicsStepSystems, PhysicsSystems};
use bevy::app::AnimationSystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;

pub use part::MorphAvianPart;
pub use scene::MorphAvianScene;
pub use step::MorphAvianDiagnostics;

use crate::changes::is_fixed;
use crate::collider::{MorphCollider, MorphCollisionMode};
use crate::contacts::MorphCollisions;
use crate::physics::layout;
use crate::physics::scene::give_to_parts;
use crate::plugin::MorphCollisionSystems;
use crate::plugins::missing;

/// Makes the mesh of a [`MorphCollider`] a collider of Avian's: bodies collide with it as it morphs.
///
/// What Avian's other components say about a collider holds: `Friction`, `Restitution`, `CollisionMargin`, `Sensor`, `CollisionLayers`,
/// `CollisionEventsEnabled`, `CollidingEntities`, `ActiveCollisionHooks`, `ColliderDisabled`. The plugin adds the `Collider` itself when the mesh's
/// tree is ready. Scale and shear of the entity are part of it.
///
/// - Without a `RigidBody`, or on a static or kinematic one (of this entity or one above), the surface pushes and carries bodies at
///   its own velocity: that of the animation, and that of the body.
/// - On a dynamic body it is the body's shape. It collides as it is at each step, and its morphing moves others only by pushing them
///   out of itself.
/// - With a `Sensor` it tells what it touches, and pushes nothing.
///
/// Like `Collider::trimesh` it is a surface without an inside, unless it is [`solid`](Self::solid).
///
/// A mesh that joints move (with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), joint indices and weights) is where its joints are before the step, with the
/// velocity that they give it. On a body, joints are taken to move with that body: put mesh and joints below it, as a glTF scene's root has them.
///
/// The surface is there while the entity has this component, a [`MorphCollider`] and a mesh whose tree is ready, and nothing disables it:
/// [`MorphColliderDisabled`](crate::MorphColliderDisabled), `ColliderDisabled` or Bevy's `Disabled`. Pausing collision detection does not
/// pause it. While its transform is not finite, or it is larger than 1e8 units or as far from the origin, it is left out, which is logged once.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCollider = MorphCollider::new(MorphCollisionMode::Passive))]
pub struct MorphAvianCollider {
    /// By how much a velocity of the surface may change in a second, in world units per second squared. A surface that is elsewhere
    /// from one step to the next has not moved but jumped: what changes faster than this is believed to be a motion when the
    /// step after confirms it, and until then does not throw anything. The default is 100, ten times a fall's.
    pub max_acceleration: f32,
    /// Whether a closed mesh has an inside. Default: no.
    ///
    /// - Contacts push outward alone. Unless the surface is on a dynamic body, what is inside all the same is driven out, at most at the speed at which Avian pushes
    ///   bodies apart (`SolverConfig::max_overlap_solve_speed`, 4 units per second, and never more than 10 length units), and leaves at a third of that.
    ///   It wakes if it sleeps. Between two solid surfaces that overlap, it may be driven from one into the other.
    /// - What asks `SpatialQuery` for points, or for rays that are `solid`, finds the inside. Sensors and shape intersections do not: Avian computes them with the
    ///   triangles alone.
    ///
    /// Costs a ray and a closest point for each body near the surface, whenever the two have moved by as much as was between them.
    ///
    /// A mesh is closed if along each of its edges as many triangles run one way as the other. Vertices that are at the same place in every pose, as at a seam of
    /// texture coordinates, count as one. Otherwise this has no effect, and a warning in the log names the
    /// entity. You can change it at any time; it takes effect in the next step.
    pub solid: bool,
}

impl Default for MorphAvianCollider {
    fn default() -> Self {
        Self {
            max_acceleration: 100.0,
            solid: false,
        }
    }
}

/// Lets rigid bodies of `avian3d` collide with every [`MorphAvianCollider`].
///
/// Add it after `PhysicsPlugins` and beside [`MorphCollisionPlugin`](crate::MorphCollisionPlugin).
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// use avian3d::prelude::*;
///
/// # let mut app = App::new();
/// app.add_plugins((PhysicsPlugins::default(), MorphCollisionPlugin::default(), MorphAvianPlugin::default()));
/// # fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
/// commands.spawn((Mesh3d(jelly), MorphAvianCollider::default()));
/// commands.spawn((RigidBody::Dynamic, Collider::sphere(0.5), Transform::from_xyz(0.0, 5.0, 0.0)));
/// # }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct MorphAvianPlugin {
    schedule: InternedScheduleLabel,
}

impl MorphAvianPlugin {
    /// The plugin for `PhysicsPlugins` in another schedule than [`FixedPostUpdate`].
    #[must_use]
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: schedule.intern(),
        }
    }
}

impl Default for MorphAvianPlugin {
    fn default() -> Self {
        Self::new(FixedPostUpdate)
    }
}

/// The plugin's systems around Avian's step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphAvianSystems {
    /// Gives colliders their surfaces; before Avian prepares its step, in the schedule that physics runs in.
    Attach,
    /// Reads morph weights and readies what bodies may touch; in Avian's `PhysicsSchedule`, before its `First`.
    BeforeStep,
    /// Sees to it that contacts are computed anew where the surface changed; in Avian's narrow phase, before contacts are updated.
    BeforeContacts,
    /// Says what touches surfaces, in their name; in Avian's narrow phase, after contacts are updated.
    AfterContacts,
}

impl Plugin for MorphAvianPlugin {
    fn build(&self, app: &mut App) {
        build(app, self.schedule);
    }

    fn finish(&self, app: &mut App) {
        check(app);
    }
}

fn check(app: &mut App) {
    let world = app.world();
    if !world.contains_resource::<MorphCollisions>() {
        missing(
            app,
            "MorphAvianPlugin does nothing without MorphCollisionPlugin, which builds its trees",
        );
    }
    if !is_there(app) {
        missing(
            app,
            "MorphAvianPlugin does nothing without PhysicsPlugins, which must be added before it",
        );
    } else if !app.world().contains_resource::<step::Stepping>() {
        tracing::error!("MorphAvianPlugin does nothing: PhysicsPlugins must be added before it");
    }
    layout::add_to_trees(app);
}

/// Whether Avian is.
fn is_there(app: &App) -> bool {
    app.get_schedule(PhysicsSchedule).is_some()
}

fn build(app: &mut App, schedule: InternedScheduleLabel) {
    if !is_there(app) {
        // Logged at the end, when it is known whether it comes later.
        return;
    }
    let is_fixed = is_fixed(schedule);
    // Now, or later if the other plugin comes after this one.
    app.init_resource::<layout::MeshLayouts>();
    layout::add_to_trees(app);
    app.register_type::<MorphAvianCollider>()
        .register_type::<MorphAvianScene>()
        .register_type::<MorphAvianPart>()
        .register_type::<MorphAvianDiagnostics>()
        .init_resource::<MorphAvianDiagnostics>()
        .insert_resource(step::Stepping::new(is_fixed))
        .add_observer(attach::detach_surface)
        .add_observer(contacts::take_parts_along)
        .configure_sets(
            schedule,
            MorphAvianSystems::Attach
                .after(AnimationSystems)
                .before(PhysicsSystems::First)
                .before(MorphCollisionSystems::Import),
        )
        .configure_sets(
            PhysicsSchedule,
            (
                MorphAvianSystems::BeforeStep.before(PhysicsStepSystems::First),
                MorphAvianSystems::BeforeContacts.in_set(NarrowPhaseSystems::First),
                MorphAvianSystems::AfterContacts.in_set(NarrowPhaseSystems::Last),
            ),
        )
        .add_systems(
            schedule,
            (give_to_parts::<MorphAvianScene>, attach::attach_surfaces)
                .chain()
                .in_set(MorphAvianSystems::Attach),
        )
        // Avian refuses schedules with systems in no order. A game's own may be anywhere.
        .add_systems(
            PhysicsSchedule,
            (
                (
                    contacts::stop_disabled,
                    movers::find_movers,
                    step::before_step,
                    step::drive_out,
                )
                    .chain()
                    .in_set(MorphAvianSystems::BeforeStep)
                    .ambiguous_with_all(),
                contacts::refresh_contacts
                    .in_set(MorphAvianSystems::BeforeContacts)
                    .ambiguous_with_all(),
                contacts::name_surfaces
                    .in_set(MorphAvianSystems::AfterContacts)
                    .ambiguous_with_all(),
                step::after_step
                    .after(PhysicsStepSystems::Solver)
                    .before(PhysicsStepSystems::Sleeping)
                    .ambiguous_with_all(),
            ),
        );
    if is_fixed {
        let at_the_end = frames::record_frame
            .after(AnimationSystems)
            .after(TransformSystems::Propagate)
            .before(MorphCollisionSystems::Anchors);
        app.add_systems(PostUpdate, at_the_end)
            .add_systems(FixedLast, frames::after_steps);
    }
}
