//! An app, meshes made in code, and the messages of the app.

use std::path::{Path, PathBuf};

use bevy::ecs::message::MessageCursor;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::headless;
pub(crate) use morph_collision_workspace::physics::bevy_mesh;

use crate::log::start;

/// The folder of the models in the repository.
pub(crate) fn assets() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets")
}

/// An app with all plugins, ready for its first frame, with its systems on this thread: see [`start`].
pub(crate) fn app() -> App {
    let mut app = headless(&assets());
    start(&mut app);
    app
}

/// An app with the Bevy plugins that the collision plugin needs, and none of ours; not ready yet.
pub(crate) fn plain_app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        bevy::mesh::MeshPlugin,
    ));
    app
}

/// An app with the collision plugin in [`FixedPostUpdate`], with this many frames per tick or ticks per frame.
pub(crate) fn fixed_app(frames_per_tick: u32, ticks_per_frame: u32) -> App {
    let mut app = plain_app();
    app.add_plugins(MorphCollisionPlugin.in_schedule(FixedPostUpdate));
    let frame = Time::<Fixed>::default().timestep() * ticks_per_frame / frames_per_tick;
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(frame));
    start(&mut app);
    app
}

/// Edits of an app between two frames, and what it found.
pub(crate) trait Edits {
    fn spawn(&mut self, bundle: impl Bundle) -> Entity;

    fn insert(&mut self, entity: Entity, bundle: impl Bundle);

    fn remove<T: Bundle>(&mut self, entity: Entity);

    fn settings(&mut self) -> Mut<'_, MorphCollisionSettings>;

    /// The contact of two colliders, if they touch.
    fn contact(&self, a: Entity, b: Entity) -> Option<MorphContact>;
}

impl Edits for App {
    fn spawn(&mut self, bundle: impl Bundle) -> Entity {
        self.world_mut().spawn(bundle).id()
    }

    fn insert(&mut self, entity: Entity, bundle: impl Bundle) {
        self.world_mut().entity_mut(entity).insert(bundle);
    }

    fn remove<T: Bundle>(&mut self, entity: Entity) {
        self.world_mut().entity_mut(entity).remove::<T>();
    }

    fn settings(&mut self) -> Mut<'_, MorphCollisionSettings> {
        self.world_mut().resource_mut()
    }

    fn contact(&self, a: Entity, b: Entity) -> Option<MorphContact> {
        self.world().resource::<MorphCollisions>().get(a, b).cloned()
    }
}

/// A cube with sides of 1 around the origin.
pub(crate) fn cube() -> MorphMesh {
    rigid::box_mesh(Vec3::splat(0.5))
}

/// The cube, with one target that stretches it by 1 towards `+X`.
pub(crate) fn stretching_cube() -> MorphMesh {
    let mut mesh = cube();
    let stretch = |p: &Vec3| if p.x > 0.0 { Vec3::X } else { Vec3::ZERO };
    mesh.targets = vec![mesh.positions.iter().map(stretch).collect()];
    mesh.target_names = vec!["stretch".into()];
    mesh
}

pub(crate) fn add_mesh(app: &mut App, mesh: &MorphMesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(bevy_mesh(mesh))
}

/// A collider along the x axis.
pub(crate) fn spawn(app: &mut App, mesh: &Handle<Mesh>, x: f32) -> Entity {
    let place = Transform::from_xyz(x, 0.0, 0.0);
    app.spawn((Mesh3d(mesh.clone()), place, MorphCollider::default()))
}

/// Two cubes, the second at `x`, after a first frame.
pub(crate) fn two_cubes(x: f32) -> (App, [Entity; 2]) {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let cubes = [spawn(&mut app, &mesh, 0.0), spawn(&mut app, &mesh, x)];
    settle(&mut app);
    (app, cubes)
}

pub(crate) fn move_to(app: &mut App, entity: Entity, x: f32) {
    app.insert(entity, Transform::from_xyz(x, 0.0, 0.0));
}

pub(crate) fn set_weight(app: &mut App, entity: Entity, weight: f32) {
    let weights = MeshMorphWeights::Value { weights: vec![weight] };
    app.insert(entity, weights);
}

/// The number of random runs: `default`, if the environment does not ask for another number.
pub(crate) fn seeds(default: u64) -> u64 {
    let asked = std::env::var("MORPH_COLLISION_SEEDS").ok();
    asked.map_or(default, |seeds| {
        seeds.parse().expect("MORPH_COLLISION_SEEDS is a number")
    })
}

/// Runs frames until no tree is being built and all trees are in use.
pub(crate) fn settle(app: &mut App) {
    app.update();
    while app.world().resource::<MorphTrees>().building() > 0 {
        app.update();
    }
    app.update();
}

pub(crate) fn touches(app: &App, a: Entity, b: Entity) -> bool {
    app.world().resource::<MorphCollisions>().contains(a, b)
}

pub(crate) fn diagnostics(app: &App) -> MorphCollisionDiagnostics {
    *app.world().resource::<MorphCollisionDiagnostics>()
}

/// The messages since the last call, or since the beginning.
#[derive(Default)]
pub(crate) struct Messages {
    starts: MessageCursor<MorphCollisionStart>,
    ends: MessageCursor<MorphCollisionEnd>,
}

impl Messages {
    pub(crate) fn read(&mut self, app: &App) -> (Vec<MorphCollisionStart>, Vec<MorphCollisionEnd>) {
        let (starts, ends) = (app.world().resource(), app.world().resource());
        (
            self.starts.read(starts).copied().collect(),
            self.ends.read(ends).copied().collect(),
        )
    }
}

/// The messages about bodies since the last call, or since the beginning.
#[derive(Default)]
pub(crate) struct BodyMessages {
    starts: MessageCursor<MorphBodyCollisionStart>,
    ends: MessageCursor<MorphBodyCollisionEnd>,
}

impl BodyMessages {
    pub(crate) fn read(&mut self, app: &App) -> (Vec<MorphBodyCollisionStart>, Vec<MorphBodyCollisionEnd>) {
        let (starts, ends) = (app.world().resource(), app.world().resource());
        (
            self.starts.read(starts).copied().collect(),
            self.ends.read(ends).copied().collect(),
        )
    }
}
