//! What the physics engines have in common in tests and reports.

use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use super::drops::Kind;

/// Gives a surface new weights.
pub type PoseSurface<'a> = Box<dyn FnMut(&mut App, &[f32]) + 'a>;

/// A physics engine, and a way to make a morphing mesh collide in it.
pub trait Engine {
    /// The name of this way in tables.
    fn name(&self) -> &'static str;

    /// An app in a world of this length unit, with steps of `dt` seconds, one per frame, and 9.81 units of gravity.
    fn app(&self, unit: f32, dt: f32) -> App;

    /// Spawns a mesh at rest. Several surfaces of this plugin may share what a game would share: the mesh asset.
    fn surface<'a>(
        &self,
        app: &mut App,
        mesh: &'a MorphMesh,
        at: Vec3,
        shared: &mut Option<Handle<Mesh>>,
    ) -> PoseSurface<'a>;

    /// Spawns a dynamic body: a cuboid with these half-extents, a ball whose radius is the first of them, or a capsule with
    /// half of its segment and its radius.
    fn body(&self, app: &mut App, kind: Kind, half: Vec3, at: Vec3) -> Entity;

    /// Spawns a fixed cuboid with these half-extents.
    fn floor(&self, app: &mut App, half: Vec3, at: Vec3);

    /// Takes the friction off a body.
    fn make_slippery(&self, app: &mut App, body: Entity);

    /// Lets a body collide only with the surface, not with bodies like it.
    fn collide_only_with_surface(&self, app: &mut App, body: Entity);

    /// Keeps a body from sleeping.
    fn stay_awake(&self, app: &mut App, body: Entity);

    /// Gives a body a velocity and an angular velocity.
    fn push(&self, app: &mut App, body: Entity, linear: Vec3, angular: Vec3);

    /// Switches continuous collision detection of a body on or off.
    fn set_ccd(&self, app: &mut App, body: Entity, on: bool);

    /// A body's position and velocity.
    fn state(&self, app: &App, body: Entity) -> (Vec3, Vec3);
}
