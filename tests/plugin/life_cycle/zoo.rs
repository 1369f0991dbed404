//! An app with a few small meshes, and the entities that live in it.

use std::collections::HashMap;

use bevy::ecs::entity_disabling::Disabled;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::random::{random_blob, triangle_soup};
use morph_collision_models::mesh::MorphMesh;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::support::{Edits, add_mesh, app, bevy_mesh, cube, settle, stretching_cube};

pub(super) struct Zoo {
    pub(super) app: App,
    pub(super) rng: Pcg64Mcg,
    /// The meshes that assets currently hold; `None` for a removed asset.
    pub(super) meshes: HashMap<AssetId<Mesh>, Option<MorphMesh>>,
    pub(super) handles: Vec<Handle<Mesh>>,
    /// Meshes that can be put into assets.
    pub(super) shapes: Vec<MorphMesh>,
    /// Entities that may be colliders; some may have been despawned.
    pub(super) animals: Vec<Entity>,
    /// Entities that may be parents of animals.
    pub(super) cages: Vec<Entity>,
}

/// A parent, and often a body. It lists what it touches.
pub(super) fn cage() -> impl Bundle {
    (Transform::default(), MorphCollidingEntities::default())
}

impl Zoo {
    pub(super) fn new(seed: u64) -> Self {
        let mut app = app();
        let shapes = vec![
            cube(),
            stretching_cube(),
            random_blob(seed, 0, 3, 0.5),
            random_blob(seed + 100, 1, 2, 0.3),
            triangle_soup(seed, 12, 2),
        ];
        let handles: Vec<_> = shapes.iter().map(|mesh| add_mesh(&mut app, mesh)).collect();
        let meshes = handles
            .iter()
            .map(Handle::id)
            .zip(shapes.iter().cloned().map(Some))
            .collect();
        // A permanent entity shows each mesh, so that its tree is kept and nobody else has to wait for
        // it.
        for handle in &handles {
            let keeper = (
                Mesh3d(handle.clone()),
                MorphCollider::default(),
                MorphCollisionLayers::NONE,
            );
            app.spawn(keeper);
        }
        // In every other life, lists are truncated early.
        if seed % 2 == 1 {
            app.settings().max_triangle_pairs = 40;
        }
        let cages = (0..3).map(|_| app.spawn(cage())).collect();
        settle(&mut app);
        Self {
            app,
            rng: Pcg64Mcg::seed_from_u64(seed),
            meshes,
            handles,
            shapes,
            animals: Vec::new(),
            cages,
        }
    }

    /// A number from 1 to `most`.
    pub(super) fn up_to(&mut self, most: usize) -> usize {
        self.rng.random_range(1..=most)
    }

    /// A random element.
    pub(super) fn one_of<T: Clone>(&mut self, things: &[T]) -> T {
        things[self.rng.random_range(0..things.len())].clone()
    }

    pub(super) fn is_paused(&self) -> bool {
        self.app.world().resource::<MorphCollisionSettings>().paused
    }

    /// Whether any animal uses a tree that no permanent entity keeps.
    pub(super) fn has_trees_of_its_own(&mut self) -> bool {
        let world = self.app.world_mut();
        let mut settings = world.query_filtered::<(), (With<MorphTreeOptions>, Allow<Disabled>)>();
        settings.iter(world).next().is_some()
    }

    /// Runs frames until no tree is being built and all trees are in use.
    pub(super) fn settle(&mut self, mut after_frame: impl FnMut(&mut App)) {
        for _ in 0..100_000 {
            self.app.update();
            after_frame(&mut self.app);
            if self.app.world().resource::<MorphTrees>().building() == 0 {
                return;
            }
        }
        panic!("a tree is never finished");
    }

    /// Puts another shape into a mesh asset.
    pub(super) fn reshape(&mut self, handle: &Handle<Mesh>, shape: MorphMesh) {
        let mut assets = self.app.world_mut().resource_mut::<Assets<Mesh>>();
        assets
            .insert(handle.id(), bevy_mesh(&shape))
            .expect("the handle is kept");
        self.meshes.insert(handle.id(), Some(shape));
    }

    pub(super) fn despawn_everything(&mut self) {
        self.app.settings().paused = false;
        for entity in self.animals.drain(..).chain(self.cages.drain(..)) {
            self.app.world_mut().try_despawn(entity).ok();
        }
        self.app.update();
    }
}
