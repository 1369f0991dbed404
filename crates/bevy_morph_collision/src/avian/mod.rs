//! Physics with `avian3d`: rigid bodies rest on morphing and skinned meshes, are pushed and carried by them, and Avian's queries
//! see the meshes.
//!
//! - `shape`: the shape that stands for the whole surface in Avian.
//! - `scene`, `attach`: decide which meshes have a surface.
//! - `ahead`: where a mesh will be at the end of a step.
//! - `movers`: the colliders that may touch it.
//! - `push`, `part`: how a surface pushes: triangles near moving bodies become a kinematic body for one step.
//! - `frames`: remembers the poses with which surfaces are drawn.
//! - `step`: the systems around Avian's step.
//! - `carry`, `figure`: carries characters, with their colliders. `velocity`: velocities of surfaces, as a public system parameter.
//! - `contacts`: turns contacts with parts into contacts with the surface.
//!
//! [`crate::physics`] decides what a surface is, where it moves and which of its triangles are near bodies.

mod ahead;
mod attach;
mod carry;
mod contacts;
mod figure;
mod frames;
mod movers;
mod part;
mod push;
mod scene;
mod shape;
mod step;
mod velocity;

use avian3d::prelude::{NarrowPhaseSystems, PhysicsLengthUnit, PhysicsSchedule, PhysicsStepSystems, PhysicsSystems};
use bevy::app::AnimationSystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;

pub use carry::{MorphAvianCarry, MorphAvianGround};
pub use part::MorphAvianPart;
pub use scene::MorphAvianScene;
pub use step::MorphAvianDiagnostics;
pub use velocity::MorphAvianVelocity;

use crate::app::MorphCollisionSystems;
use crate::components::{MorphCollider, MorphCollisionMode};
use crate::physics::clock::Timing;
use crate::physics::engine::{self, Engine};
use crate::physics::frames::{after_steps, remember_places};
use crate::physics::layout;
use crate::physics::scene::give_to_parts;
use crate::physics::schedule::{follow_fixed_loop, runs_fixed, schedules_with};
use crate::physics::teleport::put_elsewhere;

/// Makes the mesh of a [`MorphCollider`] an Avian collider: bodies collide with it as it morphs.
///
/// Avian's other collider components apply as usual: `Friction`, `Restitution`, `CollisionMargin`, `Sensor`, `CollisionLayers`,
/// `CollisionEventsEnabled`, `CollidingEntities`, `ActiveCollisionHooks`, `ColliderDisabled`. The plugin adds the `Collider`
/// itself when the mesh's tree is ready. The surface includes scale and shear of the entity.
///
/// - Without a `RigidBody`, or on a static or kinematic one (of this entity or an ancestor), the surface pushes and carries
///   bodies at its own velocity, which combines the animation's with that of its body.
/// - On a dynamic body it is the body's shape. In each step it collides with its shape at that time, and its morphing moves
///   others only by pushing them out of itself.
/// - With a `Sensor` it reports what it touches, and pushes nothing.
/// - A character that your game moves, for example with `MoveAndSlide`, is carried by it if it has a [`MorphAvianCarry`].
///
/// Like `Collider::trimesh`, it is a surface without an inside, unless it is [`solid`](Self::solid).
///
/// The joints of a skinned mesh (with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), joint indices and weights) place it as
/// they are before the step, and give it their velocity. On a body, joints are assumed to move with that body: put mesh and
/// joints below it, as the root of a glTF scene does.
///
/// The surface exists while the entity has this component, a [`MorphCollider`] and a mesh whose tree is ready, and while nothing
/// disables it: [`MorphColliderDisabled`](crate::components::MorphColliderDisabled), `ColliderDisabled` or Bevy's `Disabled`. Pausing
/// collision detection does not pause it. While its transform is not finite, or it is larger than 1e8 units or as far from the
/// origin, it is left out. This is logged once.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCollider = MorphCollider::new(MorphCollisionMode::Passive))]
pub struct MorphAvianCollider {
    /// The highest plausible acceleration of the surface, in length units per second squared: like Avian's own parameters, it is
    /// multiplied by `PhysicsLengthUnit`. If the surface's velocity changes faster, it may have jumped (teleported) instead of moved.
    /// Such a change counts as motion only when the next step confirms it; until then it does not throw anything. The default is
    /// 100, ten times the acceleration of a fall.
    ///
    /// To say that a change is no motion however small it is, insert [`MorphTeleported`](crate::components::MorphTeleported).
    pub max_acceleration: f32,
    /// Whether a closed mesh has an inside. The default is `false`.
    ///
    /// - Contacts only push outward. Unless the surface is on a dynamic body, a body that is inside anyway is driven out, at no
    ///   more than the speed at which Avian separates bodies (`SolverConfig::max_overlap_solve_speed`, 4 length units per second,
    ///   and never more than 10), and leaves at a third of that. A sleeping body wakes up. Between two solid surfaces
    ///   that overlap, a body may be driven from one into the other.
    /// - Point queries and `solid` rays of `SpatialQuery` find the inside. Sensors and shape intersections do not, because Avian
    ///   computes them from the triangles only.
    ///
    /// Costs a ray and a closest point for each body near the surface, repeated whenever body and surface have moved by as much
    /// as the distance between them.
    ///
    /// A mesh is closed if along each of its edges, the same number of triangles run in either direction. Vertices at the same
    /// place in every pose, as at a seam of texture coordinates, count as one. If the mesh is not closed, this setting has no
    /// effect, and a warning in the log names the entity. You can change it at any time; it takes effect in the next step.
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
/// Part of [`MorphPlugins`](crate::plugins::MorphPlugins), which may come before or after `PhysicsPlugins`.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// use avian3d::prelude::*;
///
/// # let mut app = App::new();
/// app.add_plugins((PhysicsPlugins::default(), MorphPlugins));
/// # fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
/// commands.spawn((Mesh3d(jelly), MorphAvianCollider::default()));
/// commands.spawn((RigidBody::Dynamic, Collider::sphere(0.5), Transform::from_xyz(0.0, 5.0, 0.0)));
/// # }
/// ```
///
/// It runs in the schedule in which Avian steps, whichever that is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphAvianPlugin {
    schedule: Option<InternedScheduleLabel>,
}

impl MorphAvianPlugin {
    /// Names the schedule in which Avian steps. You only need this if the plugin cannot find it, because your game
    /// runs Avian itself after all plugins are there, or to several schedules.
    #[must_use]
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: Some(schedule.intern()),
        }
    }
}

/// The system sets of the plugin, around Avian's step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphAvianSystems {
    /// Gives colliders their surfaces, before Avian prepares its step. In the schedule of physics.
    Attach,
    /// Reads morph weights and prepares the parts that bodies may touch. In Avian's `PhysicsSchedule`, before its `First`.
    BeforeStep,
    /// Makes Avian recompute contacts where the surface changed. In Avian's narrow phase, before contacts are updated.
    BeforeContacts,
    /// Reports what touches surfaces, in the surfaces' names. In Avian's narrow phase, after contacts are updated.
    AfterContacts,
}

impl Plugin for MorphAvianPlugin {
    fn build(&self, app: &mut App) {
        engine::build::<Avian>(app, self.schedule);
    }

    fn finish(&self, app: &mut App) {
        engine::finish::<Avian>(app, self.schedule);
    }
}

/// The engine.
pub(crate) struct Avian;

impl Engine for Avian {
    type Present = PhysicsLengthUnit;
    const PLUGINS: [&'static str; 2] = ["MorphAvianPlugin", "PhysicsPlugins"];
    const VALUES: [&'static str; 2] = ["MorphAvianPlugin::default()", "PhysicsPlugins::default()"];
    const NO_STEP: &'static str = "MorphAvianPlugin does nothing, because no schedule has a system in Avian's `PhysicsSystems::StepSimulation`: name the \
                 schedule in which you run Avian's `PhysicsSchedule`, for example MorphAvianPlugin::new(FixedUpdate)";

    fn is_there(app: &App) -> bool {
        app.get_schedule(PhysicsSchedule).is_some()
    }

    fn schedules(app: &App) -> Vec<InternedScheduleLabel> {
        schedules_with(app, PhysicsSystems::StepSimulation)
    }

    fn build(app: &mut App, schedule: InternedScheduleLabel) {
        build(app, schedule);
    }
}

fn build(app: &mut App, schedule: InternedScheduleLabel) {
    let is_fixed = runs_fixed(app, schedule);
    follow_fixed_loop(app);
    // Now, or later if the other plugin is added after this one.
    app.init_resource::<layout::MeshLayouts>();
    layout::add_to_trees(app);
    app.register_type::<MorphAvianCollider>()
        .register_type::<MorphAvianScene>()
        .register_type::<MorphAvianPart>()
        .register_type::<MorphAvianDiagnostics>()
        .register_type::<MorphAvianCarry>()
        .register_type::<MorphAvianGround>()
        .init_resource::<carry::Footing>()
        .init_resource::<MorphAvianDiagnostics>()
        .insert_resource(step::Stepping::new(Timing::new(is_fixed)))
        .add_observer(attach::detach_surface)
        .add_observer(put_elsewhere::<attach::AvianSurface>)
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
            (
                give_to_parts::<MorphAvianScene>,
                attach::attach_surfaces,
                frames::watch_clock,
            )
                .chain()
                .in_set(MorphAvianSystems::Attach),
        )
        .add_systems(
            schedule,
            frames::rest
                .after(PhysicsSystems::StepSimulation)
                .before(PhysicsSystems::Writeback),
        )
        // Avian rejects schedules whose systems have an ambiguous order. A game's own systems may be anywhere.
        .add_systems(
            PhysicsSchedule,
            (
                (
                    carry::find_ground,
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
                (step::after_step, carry::carry)
                    .chain()
                    .after(PhysicsStepSystems::Solver)
                    .before(PhysicsStepSystems::Sleeping)
                    .ambiguous_with_all(),
            ),
        );
    let fixed = |stepping: Res<step::Stepping>| stepping.timing.is_fixed;
    let remember = remember_places::<attach::AvianSurface>
        .after(AnimationSystems)
        .after(TransformSystems::Propagate)
        .before(MorphCollisionSystems::Anchors);
    app.add_systems(PostUpdate, remember);
    let at_the_end = frames::record_frame
        .after(AnimationSystems)
        .after(TransformSystems::Propagate)
        .before(remember_places::<attach::AvianSurface>);
    if is_fixed != Some(false) {
        app.add_systems(PostUpdate, at_the_end.run_if(fixed))
            .add_systems(FixedLast, after_steps::<attach::AvianSurface>.run_if(fixed));
    }
}
