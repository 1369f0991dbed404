//! Physics: rigid bodies of `bevy_rapier3d` rest on morphing and skinned meshes, are pushed and carried by them, and its queries see them.
//!
//! - `surface`, `triangles`: what Rapier knows as shapes.
//! - `dispatcher`, `gathered`: what it asks about two of them.
//! - `range`: the sizes at which Parry can answer that.
//! - `attach`: which meshes have a surface.
//! - `follow`, `placed`: where a surface is and was.
//! - `push`, `part`, `motion`: how it pushes: what is near moving bodies is a kinematic body for one step.
//! - `world`: what they see of Rapier's world, and change.
//! - `step`: the systems around Rapier's step.

mod attach;
mod dispatcher;
mod follow;
mod gathered;
mod layout;
mod motion;
mod part;
mod placed;
mod push;
mod range;
mod step;
mod surface;
mod triangles;
mod world;

use bevy::app::AnimationSystems;
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed;
use bevy::prelude::*;
use bevy_rapier3d::plugin::{PhysicsSet, RapierContextInitialization};

pub use dispatcher::MorphQueryDispatcher;
pub use step::MorphRapierDiagnostics;
pub use surface::MorphSurface;

use crate::collider::{CollisionMode, MorphCollider};
use crate::contacts::MorphCollisions;
use crate::plugin::MorphCollisionSystems;

/// Makes the mesh of a [`MorphCollider`] a collider of Rapier's: bodies collide with it as it morphs.
///
/// What Rapier's other components say about a collider holds: `Friction`, `Restitution`, `Sensor`, `CollisionGroups`,
/// `SolverGroups`, `ContactSkin`, `ActiveEvents`, `ActiveHooks`, `ColliderDisabled`. The plugin adds the `Collider`
/// itself when the mesh's tree is ready. Scale and shear of the entity are right without `ColliderScale`.
///
/// - Without a `RigidBody`, or on a fixed or kinematic one (of this entity or one above), the surface pushes and carries bodies at
///   its own velocity: that of the animation, and that of the body.
/// - On a dynamic body it is the body's shape. It collides as it is at each step, and its morphing moves others only by pushing them
///   out of itself.
///
/// Like a `TriMesh` it is a surface without an inside.
///
/// A mesh that joints move (with [`SkinnedMesh`](bevy::mesh::skinning::SkinnedMesh), joint indices and weights) is where its joints are before the step, with the
/// velocity that they give it: a character carries what stands on its hand, and its punch throws crates. On a body, joints are taken to move
/// with that body: put mesh and joints below it, as a glTF scene's root has them. Joints that are bodies themselves (a ragdoll) are followed one step late.
/// The entity's own transform must be finite all the same.
///
/// The surface is there while the entity has this component, a [`MorphCollider`] and a mesh whose tree is ready, and nothing disables it:
/// [`MorphColliderDisabled`](crate::MorphColliderDisabled), `ColliderDisabled` or Bevy's `Disabled`. Pausing collision detection does not
/// pause it. While its transform is not finite, or it is larger than 1e8 units or as far from the origin, it is left out, which is logged once.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphCollider = MorphCollider::new(CollisionMode::Passive))]
pub struct MorphRapierCollider {
    /// By how much a velocity of the surface may change in a second, in world units per second squared. A surface that is elsewhere
    /// from one step to the next has not moved but jumped: what changes faster than this is believed to be a motion when the
    /// step after confirms it, and until then does not throw anything. The default is 100, ten times a fall's.
    pub max_acceleration: f32,
}

impl Default for MorphRapierCollider {
    fn default() -> Self {
        Self {
            max_acceleration: 100.0,
        }
    }
}

/// Lets rigid bodies of `bevy_rapier3d` collide with every [`MorphRapierCollider`].
///
/// Add it after `RapierPhysicsPlugin` and beside [`MorphCollisionPlugin`](crate::MorphCollisionPlugin). It gives every
/// physics context a [`MorphQueryDispatcher`] as soon as it is there.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// use bevy_rapier3d::prelude::*;
///
/// # let mut app = App::new();
/// app.add_plugins((RapierPhysicsPlugin::<NoUserData>::default(), MorphCollisionPlugin, MorphRapierPlugin));
/// # fn spawn(mut commands: Commands, jelly: Handle<Mesh>) {
/// commands.spawn((Mesh3d(jelly), MorphRapierCollider::default()));
/// commands.spawn((RigidBody::Dynamic, Collider::ball(0.5), Transform::from_xyz(0.0, 5.0, 0.0)));
/// # }
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphRapierPlugin;

/// [`MorphRapierPlugin`] in a schedule of one's choice; see [`MorphRapierPlugin::in_schedule`].
#[derive(Clone, Copy, Debug)]
pub struct MorphRapierIn {
    schedule: InternedScheduleLabel,
}

impl MorphRapierPlugin {
    /// The same plugin, for a `RapierPhysicsPlugin` in another schedule than [`PostUpdate`], usually [`FixedUpdate`].
    #[must_use]
    pub fn in_schedule(self, schedule: impl ScheduleLabel) -> MorphRapierIn {
        MorphRapierIn {
            schedule: schedule.intern(),
        }
    }
}

/// The plugin's systems around Rapier's step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MorphRapierSystems {
    /// Gives colliders their surfaces; before Rapier reads its components.
    Attach,
    /// Reads morph weights and readies what bodies may touch; just before Rapier's step.
    BeforeStep,
    /// Just after it.
    AfterStep,
}

impl Plugin for MorphRapierPlugin {
    fn build(&self, app: &mut App) {
        build(app, PostUpdate.intern());
    }

    fn finish(&self, app: &mut App) {
        check(app);
    }
}

impl Plugin for MorphRapierIn {
    fn build(&self, app: &mut App) {
        build(app, self.schedule);
    }

    fn finish(&self, app: &mut App) {
        check(app);
    }
}

fn check(app: &mut App) {
    if !app.world().contains_resource::<MorphCollisions>() {
        tracing::error!("MorphRapierPlugin does nothing without MorphCollisionPlugin, which builds its trees");
    }
    layout::add_to_trees(app);
}

fn build(app: &mut App, schedule: InternedScheduleLabel) {
    if !app.world().contains_resource::<RapierContextInitialization>() {
        tracing::error!("MorphRapierPlugin does nothing without RapierPhysicsPlugin, which must be added before it");
        return;
    }
    // Now, or later if the other plugin comes after this one.
    app.init_resource::<layout::MeshLayouts>();
    layout::add_to_trees(app);
    app.register_type::<MorphRapierCollider>()
        .register_type::<MorphRapierDiagnostics>()
        .init_resource::<MorphRapierDiagnostics>()
        .init_resource::<step::Stepping>()
        .add_observer(step::teach_context)
        .add_observer(attach::detach_surface)
        .add_observer(attach::take_parts_along)
        .configure_sets(
            schedule,
            (
                MorphRapierSystems::Attach
                    .after(AnimationSystems)
                    .before(PhysicsSet::SyncBackend)
                    // Trees that are done in this frame are attached in the next one.
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
                attach::attach_surfaces.in_set(MorphRapierSystems::Attach),
                (attach::stop_absent, step::before_step)
                    .chain()
                    .in_set(MorphRapierSystems::BeforeStep),
                step::after_step.in_set(MorphRapierSystems::AfterStep),
            ),
        );
}
