//! Avian's rigid bodies on morphing surfaces: with this plugin, and with what a game can do without it.

use std::path::Path;
use std::time::Duration;

use avian3d::prelude::*;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_avian::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::{headless, ready};
use morph_collision_workspace::physics::drops::Kind;
use morph_collision_workspace::physics::engine::{Engine, PoseSurface};
use morph_collision_workspace::physics::{bevy_mesh, blend};

/// A way to make a morphing mesh collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// [`MorphPhysicsCollider`].
    Ours,
    /// A static body that gets a new `Collider::trimesh` each time from all blended vertices.
    NewMesh,
    /// A plain mesh on a kinematic body, which follows the first weight: what Avian does for a surface that only moves.
    Kinematic,
}

impl Engine for Method {
    fn name(&self) -> &'static str {
        match self {
            Self::Ours => "`MorphPhysicsCollider`",
            Self::NewMesh => "new `Collider::trimesh`",
            Self::Kinematic => "`Collider::trimesh` on a kinematic body",
        }
    }

    fn app(&self, unit: f32, dt: f32) -> App {
        let mut app = headless(Path::new("."));
        let step = Duration::from_secs_f32(dt);
        let physics = PhysicsPlugins::default().with_length_unit(unit);
        app.add_plugins((physics, MorphAvianPlugin))
            .insert_resource(Gravity(Vec3::NEG_Y * 9.81 * unit))
            .insert_resource(Time::<Fixed>::from_duration(step))
            .insert_resource(TimeUpdateStrategy::ManualDuration(step));
        ready(&mut app);
        app
    }

    fn surface<'a>(
        &self,
        app: &mut App,
        mesh: &'a MorphMesh,
        at: Vec3,
        shared: &mut Option<Handle<Mesh>>,
    ) -> PoseSurface<'a> {
        let world = app.world_mut();
        let place = Transform::from_translation(at);
        let trimesh = |positions: &[Vec3]| Collider::trimesh(positions.to_vec(), mesh.triangles.clone());
        match self {
            Self::Ours => {
                let asset = shared.get_or_insert_with(|| world.resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh)));
                let weights = MeshMorphWeights::Value {
                    weights: vec![0.0; mesh.targets.len()],
                };
                let collider = MorphPhysicsCollider::default();
                let surface = world.spawn((Mesh3d(asset.clone()), weights, collider, place)).id();
                Box::new(move |app, weights| {
                    let weights = weights.to_vec();
                    app.world_mut()
                        .entity_mut(surface)
                        .insert(MeshMorphWeights::Value { weights });
                })
            }
            Self::NewMesh => {
                let surface = world.spawn((RigidBody::Static, trimesh(&mesh.positions), place)).id();
                let mut blended = Vec::new();
                Box::new(move |app, weights| {
                    blend(mesh, weights, &mut blended);
                    app.world_mut().entity_mut(surface).insert(trimesh(&blended));
                })
            }
            Self::Kinematic => {
                let body = (RigidBody::Kinematic, SleepingDisabled, trimesh(&mesh.positions), place);
                let surface = world.spawn(body).id();
                Box::new(move |app, weights| {
                    let dt = app.world().resource::<Time<Fixed>>().timestep().as_secs_f32();
                    let place = app.world().get::<Position>(surface).map(|place| place.0);
                    let to = at + mesh.targets[0][0] * weights[0];
                    let velocity = LinearVelocity((to - place.unwrap_or_default()) / dt);
                    app.world_mut().entity_mut(surface).insert(velocity);
                })
            }
        }
    }

    fn body(&self, app: &mut App, kind: Kind, half: Vec3, at: Vec3) -> Entity {
        let collider = match kind {
            Kind::Ball => Collider::sphere(half.x),
            Kind::Cuboid => Collider::cuboid(2.0 * half.x, 2.0 * half.y, 2.0 * half.z),
            // Avian's length of a capsule is that of its segment.
            Kind::Capsule => Collider::capsule(half.y, 2.0 * half.x),
        };
        let body = (RigidBody::Dynamic, collider, Transform::from_translation(at));
        app.world_mut().spawn(body).id()
    }

    fn floor(&self, app: &mut App, half: Vec3, at: Vec3) {
        let collider = Collider::cuboid(2.0 * half.x, 2.0 * half.y, 2.0 * half.z);
        app.world_mut()
            .spawn((RigidBody::Static, collider, Transform::from_translation(at)));
    }

    fn make_slippery(&self, app: &mut App, body: Entity) {
        let slippery = Friction::new(0.0).with_combine_rule(CoefficientCombine::Min);
        app.world_mut().entity_mut(body).insert(slippery);
    }

    fn collide_only_with_surface(&self, app: &mut App, body: Entity) {
        let layers = CollisionLayers::new(LayerMask(0b10), LayerMask::ALL ^ LayerMask(0b10));
        app.world_mut().entity_mut(body).insert(layers);
    }

    fn stay_awake(&self, app: &mut App, body: Entity) {
        app.world_mut().entity_mut(body).insert(SleepingDisabled);
    }

    fn push(&self, app: &mut App, body: Entity, linear: Vec3, angular: Vec3) {
        let velocity = (LinearVelocity(linear), AngularVelocity(angular));
        app.world_mut().entity_mut(body).insert(velocity);
    }

    fn set_ccd(&self, app: &mut App, body: Entity, on: bool) {
        let filter = if on { CcdFilter::DEFAULT } else { CcdFilter::NONE };
        let swept = SweptCcd::default().with_filter(filter);
        app.world_mut().entity_mut(body).insert(swept);
    }

    fn state(&self, app: &App, body: Entity) -> (Vec3, Vec3) {
        let body = app.world().entity(body);
        (
            body.get::<Position>().map(|place| place.0).unwrap_or_default(),
            body.get::<LinearVelocity>()
                .map(|velocity| velocity.0)
                .unwrap_or_default(),
        )
    }
}
