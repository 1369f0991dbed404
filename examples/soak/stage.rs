//! The app, its models, and waiting for what is done in the background.

use std::path::Path;
use std::time::Duration;

use bevy::app::AnimationSystems;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_models::generated::random::random_blob;
use morph_collision_workspace::app::{STEP, is_loaded, log, ready, update_until, without_collisions};
use morph_collision_workspace::crowd;
use morph_collision_workspace::error::ExampleError;
use morph_collision_workspace::physics::bevy_mesh;

use crate::actors::{Kind, Plays, play_clips};

/// A frame's number is not known while models are loading, so nothing moves or is reported then.
pub(crate) struct Stage {
    pub(crate) app: App,
    pub(crate) models: Vec<Model>,
    /// A mesh made in code, and the shapes that it may take.
    pub(crate) blob: Handle<Mesh>,
    blobs: Vec<Mesh>,
}

/// A glTF file that stays loaded.
pub(crate) struct Model {
    file: &'static str,
    gltf: Handle<Gltf>,
    pub(crate) scene: Handle<WorldAsset>,
    pub(crate) clips: Vec<Plays>,
}

/// The models, in the order of [`Kind::model`].
const FILES: [&str; 3] = ["heaving_body_5120.glb", "mh_character_low.glb", "dolphin_564.glb"];

/// Morph targets of the blob.
pub(crate) const BLOB_TARGETS: usize = 3;

impl Stage {
    pub(crate) fn new(assets: &Path) -> Result<Self, ExampleError> {
        let mut app = without_collisions(assets);
        app.add_plugins((
            log(),
            RapierPhysicsPlugin::<NoUserData>::default(),
            MorphPlugins,
            MorphRapierPlugin,
        ))
        .insert_resource(TimestepMode::Fixed {
            dt: STEP.as_secs_f32(),
            substeps: 1,
        })
        .configure_sets(PostUpdate, PhysicsSet::SyncBackend.after(AnimationSystems))
        .add_systems(Update, play_clips);
        ready(&mut app);
        for (_, schedule) in app.world_mut().resource_mut::<Schedules>().iter_mut() {
            schedule.set_executor(SingleThreadedExecutor::new());
        }
        app.world_mut().spawn((
            Name::new("ground"),
            Collider::cuboid(8.0, 0.5, 8.0),
            Transform::from_xyz(0.0, -0.5, 0.0),
        ));

        let blobs: Vec<Mesh> = (1..=3)
            .map(|seed| bevy_mesh(&random_blob(seed, 1, BLOB_TARGETS, 0.5)))
            .collect();
        let blob = app.world_mut().resource_mut::<Assets<Mesh>>().add(blobs[0].clone());
        let mut stage = Self {
            app,
            models: Vec::new(),
            blob,
            blobs,
        };
        for file in FILES {
            let model = stage.load(file)?;
            stage.models.push(model);
        }
        stage.build_trees()?;
        Ok(stage)
    }

    fn load(&mut self, file: &'static str) -> Result<Model, ExampleError> {
        let (scene, clips) = crowd::load(&mut self.app, Path::new(file))?;
        let world = self.app.world_mut();
        let gltf = world.resource::<AssetServer>().load(file);
        let mut graphs = world.resource_mut::<Assets<AnimationGraph>>();
        let plays = |(_, clip)| {
            let (graph, node) = AnimationGraph::from_clip(clip);
            Plays {
                graph: graphs.add(graph),
                node,
                from: 0.0,
                is_paused: false,
            }
        };
        Ok(Model {
            file,
            gltf,
            scene,
            clips: clips.into_iter().map(plays).collect(),
        })
    }

    /// Requests every tree. From then on they are there as soon as something is spawned.
    fn build_trees(&mut self) -> Result<(), ExampleError> {
        let kinds = [Kind::Hill, Kind::Character, Kind::Dolphin, Kind::Blob];
        let spawned = kinds.map(|kind| kind.spawn(self, Transform::default()));
        self.settle()?;
        for entity in spawned {
            self.app.world_mut().despawn(entity);
        }
        self.settle()
    }

    /// Another shape for the blob. Everything that shows it changes with it.
    pub(crate) fn reshape(&mut self, shape: usize) -> Result<(), ExampleError> {
        let mesh = self.blobs[shape % self.blobs.len()].clone();
        let mut meshes = self.app.world_mut().resource_mut::<Assets<Mesh>>();
        // Its handle is kept, so it is there.
        if let Some(mut blob) = meshes.get_mut(&self.blob) {
            *blob = mesh;
        }
        self.settle()
    }

    /// Loads a file again, as after an edit. Bevy spawns everything in its scenes anew.
    pub(crate) fn reload(&mut self, model: usize) -> Result<(), ExampleError> {
        let (file, gltf) = (self.models[model].file, self.models[model].gltf.id());
        self.set_quiet(true);
        let mut events = self
            .app
            .world()
            .resource::<Messages<AssetEvent<Gltf>>>()
            .get_cursor_current();
        self.app.world().resource::<AssetServer>().reload(file);
        update_until(&mut self.app, Path::new(file), |world| {
            is_loaded(world.resource::<AssetServer>(), gltf.untyped(), Path::new(file))?;
            let mut events = events.read(world.resource::<Messages<AssetEvent<Gltf>>>());
            Ok(events.any(|event| event.is_loaded_with_dependencies(gltf)))
        })?;
        self.settle()
    }

    /// Runs frames in which nothing moves until all trees are in use.
    fn settle(&mut self) -> Result<(), ExampleError> {
        self.set_quiet(true);
        // Until a change of an asset has reached everyone.
        for _ in 0..4 {
            self.app.update();
        }
        update_until(&mut self.app, Path::new("trees"), |world| {
            Ok(world.resource::<MorphTrees>().building() == 0)
        })?;
        for _ in 0..2 {
            self.app.update();
        }
        self.set_quiet(false);
        Ok(())
    }

    /// Stops time, physics and collisions, or goes on.
    fn set_quiet(&mut self, is_quiet: bool) {
        let world = self.app.world_mut();
        world.resource_mut::<MorphCollisionSettings>().paused = is_quiet;
        let step = if is_quiet { Duration::ZERO } else { STEP };
        world.insert_resource(TimeUpdateStrategy::ManualDuration(step));
        let mut physics = world.query::<&mut RapierConfiguration>();
        for mut physics in physics.iter_mut(world) {
            physics.physics_pipeline_active = !is_quiet;
        }
    }
}
