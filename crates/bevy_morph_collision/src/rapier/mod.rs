//! Physics with `bevy_rapier3d`: rigid bodies rest on morphing and skinned meshes, are pushed and carried by them, and Rapier's
//! queries see the meshes. Rapier's character controllers walk on them.
//!
//! - `dispatcher`, `gathered`, `landing`, `side`, `sweep`: answer Rapier's questions about two shapes, one of which is a surface or part of one.
//! - `scene`, `attach`: decide which meshes have a surface.
//! - `frames`: remembers the poses with which they are drawn.
//! - `push`, `part`: how a surface pushes: triangles near moving bodies become a kinematic body for one step.
//! - `link`, `obstacles`: on a dynamic body, parts are links of it for one step, and there are parts for everything nearby.
//! - `expel`: drives bodies out of solid surfaces.
//! - `world`: the parts of Rapier's world that surfaces read and change.
//! - `step`: the systems around Rapier's step. `stages`: what one surface does before it. `timestep`: how long it is. `ahead`: where
//!   surfaces will be after it.
//! - `forces`, `touches`: reports of contacts. `spared`: bodies that joints keep a surface from pushing.
//! - `footing`, `ground`, `carry`, `character`: the ground for character controllers, and how surfaces carry them.
//! - `velocity`: velocities of surfaces, as a public system parameter.
//!
//! [`crate::physics`] decides what a surface is, where it moves and which of its triangles are near bodies.

mod ahead;
mod attach;
mod carry;
mod character;
mod dispatcher;
mod expel;
mod footing;
mod forces;
mod frames;
mod gathered;
mod ground;
mod landing;
mod link;
mod obstacles;
mod part;
mod push;
mod scene;
mod side;
mod spared;
mod stages;
mod step;
mod sweep;
mod timestep;
mod touches;
mod velocity;
mod world;

use bevy::app::AnimationSystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed;
use bevy::prelude::*;
use bevy::transform::systems::mark_dirty_trees;
use bevy_rapier3d::control::KinematicCharacterController;
use bevy_rapier3d::plugin::systems::update_character_controls;
use bevy_rapier3d::plugin::{PhysicsSet, RapierContextInitialization, RapierTransformPropagateSet};

pub use crate::physics::surface::MorphSurface;
pub use carry::{MorphCharacterCarry, MorphCharacterGround};
pub use dispatcher::MorphQueryDispatcher;
pub use scene::MorphRapierScene;
pub use step::MorphRapierDiagnostics;
pub use velocity::MorphRapierVelocity;

use crate::app::MorphCollisionSystems;
use crate::components::{MorphCollider, MorphCollisionMode};
use crate::physics::clock::Timing;
use crate::physics::engine::{self, Engine};
use crate::physics::frames::{after_steps, remember_places};
use crate::physics::layout;
use crate::physics::scene::give_to_parts;
use crate::physics::schedule::{follow_fixed_loop, runs_fixed, schedules_with};
use crate::physics::teleport::put_elsewhere;

/// Makes the mesh of a [`MorphCollider`] a Rapier collider: bodies collide with it as it morphs.
///
/// Rapier's other collider components apply as usual: `Friction`, `Restitution`, `Sensor`, `CollisionGroups`, `SolverGroups`,
/// `ContactSkin`, `ActiveEvents`, `ActiveHooks`, `ColliderDisabled`. The plugin adds the `Collider` itself when the mesh's tree
/// is ready. Scale and shear of the entity work without `ColliderScale`.
///
/// - Without a `RigidBody`, or on a fixed or kinematic one (of this entity or an ancestor), the surface pushes and carries bodies
///   at its own velocity, which combines the animation's with that of its body.
/// - A `KinematicCharacterController` stands on it and is carried by it; see [`MorphCharacterCarry`].
/// - On a dynamic body it is the body's shape. While it morphs, it throws and carries others at its own velocity, and its body is
///   pushed the other way. A body in a `MultibodyJoint` that the game created only pushes others out of its surface.
///
/// Like a `TriMesh`, it is a surface without an inside, unless it is [`solid`](Self::solid).
///
/// The joints of a skinned mesh (with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), joint indices and weights) place it as
/// they are before the step, and give it their velocity: a character carries what stands on its hand, and its punch throws
/// crates. On a body, joints are assumed to move with that body: put mesh and joints below it, as the root of a glTF scene does.
/// If joints are bodies themselves (a ragdoll), the surface follows them one step late. The entity's own transform must be finite
/// even for a skinned mesh.
///
/// The surface exists while the entity has this component, a [`MorphCollider`] and a mesh whose tree is ready, and while nothing
/// disables it: [`MorphColliderDisabled`](crate::components::MorphColliderDisabled), `ColliderDisabled` or Bevy's `Disabled`. Pausing
/// collision detection does not pause it. While its transform is not finite, or it is larger than 1e8 units or as far from the
/// origin, it is left out. This is logged once.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCollider = MorphCollider::new(MorphCollisionMode::Passive))]
pub struct MorphRapierCollider {
    /// The highest plausible acceleration of the surface, in length units per second squared: like Rapier's own parameters, it is
    /// multiplied by `IntegrationParameters::length_unit`. If the surface's velocity changes faster, it may have jumped (teleported)
    /// instead of moved. Such a change counts as motion only when the next step confirms it; until then it does not throw anything.
    /// The default is 100, ten times the acceleration of a fall.
    ///
    /// To say that a change is no motion however small it is, insert [`MorphTeleported`](crate::components::MorphTeleported).
    pub max_acceleration: f32,
    /// Whether a closed mesh has an inside. The default is `false`.
    ///
    /// - Contacts only push outward. A body that is inside anyway (it was spawned there, or the surface jumped over it) is driven
    ///   out, at no more than the speed at which Rapier separates bodies (`IntegrationParameters::max_corrective_velocity`, 3
    ///   length units per second, and never more than 10), and leaves at a third of that. A sleeping body wakes up.
    ///   Character controllers are not driven out. Between two solid surfaces that overlap, a body may be driven from one into
    ///   the other.
    /// - Bodies entirely inside count as touching for sensors and for some of Rapier's queries: intersections, distances, points,
    ///   and rays with `solid`. Shape casts and contacts only see triangles.
    ///
    /// Costs a ray and a closest point for each body near the surface, repeated whenever body and surface have moved by as much
    /// as the distance between them.
    ///
    /// A mesh is closed if along each of its edges, the same number of triangles run in either direction. Vertices at the same
    /// place in every pose, as at a seam of texture coordinates, count as one. If the mesh is not closed, this setting has no
    /// effect, and a warning in the log names the entity. You can change it at any time; it takes effect in the next step.
    pub solid: bool,
}

impl Default for MorphRapierCollider {
    fn default() -> Self {
        Self {
            max_acceleration: 100.0,
            solid: false,
        }
    }
}

/// Lets rigid bodies of `bevy_rapier3d` collide with every [`MorphRapierCollider`].
///
/// Part of [`MorphPlugins`](crate::plugins::MorphPlugins), which may come before or after `RapierPhysicsPlugin`. It gives every new physics context
/// a [`MorphQueryDispatcher`].
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// use bevy_rapier3d::prelude::*;
///
/// # let mut app = App::new();
/// app.add_plugins((RapierPhysicsPlugin::<NoUserData>::default(), MorphPlugins));
/// # fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
/// commands.spawn((Mesh3d(jelly), MorphRapierCollider::default()));
/// commands.spawn((RigidBody::Dynamic, Collider::ball(0.5), Transform::from_xyz(0.0, 5.0, 0.0)));
/// # }
/// ```
///
/// It runs in the schedule in which Rapier steps, whichever that is.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphRapierPlugin {
    schedule: Option<InternedScheduleLabel>,
}

impl MorphRapierPlugin {
    /// Names the schedule in which Rapier steps. You only need this if the plugin cannot find it, because your game
    /// adds Rapier's systems to schedules itself after all plugins are there, or to several schedules.
    #[must_use]
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self {
            schedule: Some(schedule.intern()),
        }
    }
}

/// The system sets of the plugin, around Rapier's step. If your game runs Rapier's `PhysicsSet::StepSimulation` only under a condition,
/// give `BeforeStep` and `AfterStep` the same condition.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphRapierSystems {
    /// Gives colliders their surfaces, before Rapier reads its components.
    Attach,
    /// Reads morph weights and prepares the parts that bodies may touch. Just before Rapier's step.
    BeforeStep,
    /// Cleans up just after Rapier's step.
    AfterStep,
}

impl Plugin for MorphRapierPlugin {
    fn build(&self, app: &mut App) {
        engine::build::<Rapier>(app, self.schedule);
    }

    fn finish(&self, app: &mut App) {
        engine::finish::<Rapier>(app, self.schedule);
    }
}

/// The engine.
pub(crate) struct Rapier;

impl Engine for Rapier {
    type Present = RapierContextInitialization;
    const PLUGINS: [&'static str; 2] = ["MorphRapierPlugin", "RapierPhysicsPlugin"];
    const VALUES: [&'static str; 2] = [
        "MorphRapierPlugin::default()",
        "RapierPhysicsPlugin::<NoUserData>::default()",
    ];
    const NO_STEP: &'static str = "MorphRapierPlugin does nothing, because no schedule has a system in Rapier's `PhysicsSet::StepSimulation`: name the \
                 schedule to which you will add it, for example MorphRapierPlugin::new(FixedUpdate)";

    fn is_there(app: &App) -> bool {
        app.world().contains_resource::<RapierContextInitialization>()
    }

    fn schedules(app: &App) -> Vec<InternedScheduleLabel> {
        schedules_with(app, PhysicsSet::StepSimulation)
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
    app.register_type::<MorphRapierCollider>()
        .register_type::<MorphRapierScene>()
        .register_type::<MorphRapierDiagnostics>()
        .register_type::<MorphCharacterCarry>()
        .register_type::<MorphCharacterGround>()
        .init_resource::<MorphRapierDiagnostics>()
        .insert_resource(step::Stepping::new(Timing::new(is_fixed)))
        .init_resource::<footing::Footing>()
        .add_observer(step::teach_context)
        .add_observer(attach::detach_surface)
        .add_observer(put_elsewhere::<attach::RapierSurface>)
        .add_observer(attach::take_parts_along)
        .configure_sets(
            schedule,
            (
                MorphRapierSystems::Attach
                    .after(AnimationSystems)
                    .before(PhysicsSet::SyncBackend)
                    // Trees that are finished in this frame are attached in the next one.
                    .before(MorphCollisionSystems::Import)
                    .before(mark_3d_meshes_as_changed_if_their_assets_changed),
                MorphRapierSystems::BeforeStep
                    .after(PhysicsSet::SyncBackend)
                    .before(PhysicsSet::StepSimulation),
                MorphRapierSystems::AfterStep
                    .after(PhysicsSet::StepSimulation)
                    .before(PhysicsSet::Writeback),
            ),
        )
        .add_systems(
            schedule,
            (
                (give_to_parts::<MorphRapierScene>, attach::attach_surfaces)
                    .chain()
                    .in_set(MorphRapierSystems::Attach),
                (attach::stop_absent, step::before_step)
                    .chain()
                    .in_set(MorphRapierSystems::BeforeStep),
                step::note_step.in_set(PhysicsSet::StepSimulation),
                step::after_step.in_set(MorphRapierSystems::AfterStep),
                footing::before_controllers
                    .in_set(PhysicsSet::SyncBackend)
                    .before(update_character_controls),
                (footing::after_controllers, carry::carry)
                    .chain()
                    .in_set(PhysicsSet::SyncBackend)
                    .after(update_character_controls)
                    .before(RapierTransformPropagateSet),
                // Rapier places hierarchies before its step, but only those that were marked. Otherwise, the first change of a joint, or
                // of a body with children, would reach the step a frame late, if at all.
                mark_dirty_trees
                    .run_if(any_with_component::<attach::RapierSurface>)
                    .in_set(PhysicsSet::SyncBackend)
                    .after(carry::carry)
                    .before(RapierTransformPropagateSet),
            ),
        );
    let fixed = |stepping: Res<step::Stepping>| stepping.timing.is_fixed;
    let remember = remember_places::<attach::RapierSurface>
        .after(AnimationSystems)
        .after(TransformSystems::Propagate)
        .before(MorphCollisionSystems::Anchors);
    app.add_systems(PostUpdate, remember);
    let at_the_end = frames::record_frame
        .after(AnimationSystems)
        .after(TransformSystems::Propagate)
        .before(remember_places::<attach::RapierSurface>);
    let before_steps = frames::record_frame
        .in_set(MorphRapierSystems::BeforeStep)
        .after(attach::stop_absent)
        .before(step::before_step);
    if is_fixed != Some(false) {
        app.add_systems(PostUpdate, at_the_end.run_if(fixed))
            .add_systems(FixedLast, after_steps::<attach::RapierSurface>.run_if(fixed));
    }
    if is_fixed != Some(true) {
        app.add_systems(schedule, before_steps.run_if(not(fixed)));
    }
    // Has no effect if controllers already exist; those are carried if you add the component to them.
    let _too_late = app.try_register_required_components::<KinematicCharacterController, MorphCharacterCarry>();
}
