//! An app with a crowd whose colliders have a tolerance, at consecutive frames of 60 Hz.

use std::collections::BTreeSet;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::crowd::root_of;
use morph_collision_workspace::drawn::{self, Part};
use morph_collision_workspace::instances::{Instances, in_crowd};
use morph_collision_workspace::{app, error::ExampleError};

use crate::model::{Model, run_on_one_thread};

/// A crowd to measure.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) model: &'static str,
    pub(crate) count: usize,
    /// Distance between neighbours, in sizes of a body.
    pub(crate) spacing: f32,
    /// Whether bodies turn and bob while they play their clip.
    pub(crate) wanders: bool,
}

/// The scenes. All have many contacts and near misses.
pub(crate) const SCENES: [Scene; 4] = [
    Scene {
        name: "dolphins that turn and bob",
        model: "dolphin_564.glb",
        count: 216,
        spacing: 0.5,
        wanders: true,
    },
    Scene {
        name: "dolphins that swim in place",
        model: "dolphin_564.glb",
        count: 216,
        spacing: 0.5,
        wanders: false,
    },
    Scene {
        name: "talking heads",
        model: "mh_head_eyes_teeth_arkit52_dao.glb",
        count: 27,
        spacing: 0.62,
        wanders: false,
    },
    Scene {
        name: "walking characters",
        model: "mh_character_low.glb",
        count: 64,
        spacing: 0.3,
        wanders: false,
    },
];

/// An app, and the current time of its crowd.
pub(crate) struct Stage {
    pub(crate) app: App,
    pub(crate) parts: Vec<Part>,
    pub(crate) meshes: Vec<MorphMesh>,
    /// The longest side of a body, in world units.
    pub(crate) size: f32,
    roots: Vec<Entity>,
    frame: usize,
}

impl Stage {
    /// A crowd in an app whose systems run on one thread. `tolerance` is in sizes of a body.
    pub(crate) fn new(scene: &Scene, tolerance: f32) -> Result<Self, String> {
        let model = Model::find(scene.model)?;
        let mut app = app::headless(model.folder());
        app::ready(&mut app);
        run_on_one_thread(&mut app);
        let spawned = |error: ExampleError| error.to_string();
        let instances = Instances::spawn(&mut app, &model.file, scene.count, false).map_err(spawned)?;
        let size = instances.length();
        let mut stage = Self {
            parts: Vec::new(),
            meshes: model.meshes,
            size,
            roots: instances.roots,
            frame: 0,
            app,
        };
        stage.place(scene);
        for _ in 0..3 {
            stage.app.update();
        }
        let mut colliders = stage.app.world_mut().query::<&mut MorphCollider>();
        for mut collider in colliders.iter_mut(stage.app.world_mut()) {
            *collider = MorphCollider::new(MorphCollisionMode::First).with_tolerance(tolerance * size);
        }
        let mut parts = drawn::parts::<With<MorphCollider>>(stage.app.world_mut(), &stage.meshes);
        let (world, roots) = (stage.app.world(), &stage.roots);
        parts.sort_by_cached_key(|part| (root_of(world, part.entity, roots), part.mesh, part.triangles.start));
        stage.parts = parts;
        stage.app.update();
        Ok(stage)
    }

    /// Advances by one frame; returns the microseconds that the plugin took.
    pub(crate) fn update(&mut self, scene: &Scene) -> f64 {
        self.frame += 1;
        if scene.wanders {
            self.place(scene);
        }
        self.app.update();
        self.diagnostics().duration.as_secs_f64() * 1e6
    }

    fn place(&mut self, scene: &Scene) {
        let seconds = self.frame as f32 / 60.0;
        for (index, &root) in self.roots.iter().enumerate() {
            if let Some(mut transform) = self.app.world_mut().get_mut::<Transform>(root) {
                *transform = in_crowd(index, self.roots.len(), seconds, scene.spacing * self.size);
            }
        }
    }

    pub(crate) fn diagnostics(&self) -> MorphCollisionDiagnostics {
        *self.app.world().resource::<MorphCollisionDiagnostics>()
    }

    /// The pairs of parts that are reported to touch.
    pub(crate) fn touching(&self) -> BTreeSet<(usize, usize)> {
        let place = |entity: Entity| self.parts.iter().position(|part| part.entity == entity);
        let collisions = self.app.world().resource::<MorphCollisions>();
        let pairs = collisions.iter().filter_map(|contact| {
            let (a, b) = (place(contact.collider1)?, place(contact.collider2)?);
            Some((a.min(b), a.max(b)))
        });
        pairs.collect()
    }
}
