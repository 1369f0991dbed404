//! An app with the plugin, and what lives in it.

use std::time::Duration;

use bevy::mesh::morph::MorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy::time::TimeUpdateStrategy;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::random::{random_blob, triangle_soup};
use morph_collision_models::mesh::MorphMesh;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::banks::{Banks, Born};
use super::digest::{Counts, Digest, Reader, state};
use super::library::Hidden;
use super::observed;
use super::operations::operate;
use super::rules::{Rule, Rules};
use crate::log::start;
use crate::skins::boned;
use crate::support::{Edits, add_mesh, assets, cube, diagnostics, settle, stretching_cube};

/// The rows of colliders. Two rows of joints for each of them follow, then those of bodies.
pub(super) const COLLIDERS: usize = 8;
pub(super) const BODIES: std::ops::Range<usize> = 3 * COLLIDERS..3 * COLLIDERS + 2;
/// How many weights a body has, which its meshes with so many targets may share.
pub(super) const SHARED: usize = 2;

/// The rows of a collider's joints.
pub(super) fn joints_of(row: usize) -> [usize; 2] {
    [COLLIDERS + 2 * row, COLLIDERS + 2 * row + 1]
}

pub(super) struct Stage {
    pub(super) app: App,
    /// The meshes, with their numbers of targets. The last one is skinned.
    pub(super) meshes: Vec<(Handle<Mesh>, usize)>,
    bind_poses: Handle<SkinnedMeshInverseBindposes>,
    reader: Reader,
    pub(super) counts: Counts,
    pub(super) rng: Pcg64Mcg,
    /// The next frame.
    pub(super) frame: u32,
    /// The entities spawned in this frame.
    births: u32,
    seed: u64,
}

/// What a frame reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Report {
    pub(super) state: Digest,
    pub(super) messages: Digest,
    /// Entity events.
    observed: Digest,
    /// Counts of the run: of pairs that touch, of their triangles, of boxes that overlap, of colliders that are held, and of swept pairs. There are
    /// none during a pause.
    counts: Option<[u64; 5]>,
}

impl Stage {
    pub(super) fn new(seed: u64) -> Self {
        let mut app = morph_collision_workspace::app::headless(&assets());
        app.add_plugins(MorphCollisionHooksPlugin::<Rules>::default())
            .init_resource::<Rule>();
        app.world_mut().register_disabling_component::<Hidden>();
        start(&mut app);
        let shapes: Vec<MorphMesh> = vec![
            cube(),
            stretching_cube(),
            random_blob(seed, 1, 3, 0.5),
            triangle_soup(seed, 14, 2),
        ];
        let mut meshes: Vec<(Handle<Mesh>, usize)> = shapes
            .iter()
            .map(|shape| (add_mesh(&mut app, shape), shape.targets.len()))
            .collect();
        let skinned = boned(&random_blob(seed + 9, 0, 2, 0.3), |p| u16::from(p.x > 0.0));
        let skinned = app.world_mut().resource_mut::<Assets<Mesh>>().add(skinned);
        meshes.push((skinned, 2));
        let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
        let bind_poses = (app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>()).add(poses);
        // Permanent entities request the trees, which are then there.
        for (mesh, _) in &meshes {
            let keeper = (
                Mesh3d(mesh.clone()),
                MorphCollider::default(),
                MorphCollisionLayers::NONE,
            );
            let keeper = app.spawn(keeper);
            if mesh == &meshes[4].0 {
                let joints = vec![app.spawn(Transform::default()), app.spawn(Transform::default())];
                let inverse_bindposes = bind_poses.clone();
                app.insert(
                    keeper,
                    SkinnedMesh {
                        inverse_bindposes,
                        joints,
                    },
                );
            }
        }
        let banks = Banks::new(app.world(), BODIES.end);
        app.insert_resource(banks);
        let mut stage = Self {
            app,
            meshes,
            bind_poses,
            reader: Reader::default(),
            counts: Counts::default(),
            rng: Pcg64Mcg::seed_from_u64(seed),
            frame: 0,
            births: 0,
            seed,
        };
        observed::observe(&mut stage.app);
        for row in BODIES {
            let weights = MorphWeights::new(vec![0.2; SHARED], None).expect("they are few");
            stage.spawn(row, (Transform::default(), MorphCollidingEntities::default(), weights));
        }
        settle(&mut stage.app);
        // As after a frame.
        stage.report(true);
        stage.frame = 1;
        stage
    }

    /// An entity in a row, which replaces another one.
    pub(super) fn spawn(&mut self, row: usize, bundle: impl Bundle) -> Entity {
        self.despawn(row);
        self.births += 1;
        let born = Born(self.frame * 64 + self.births);
        let world = self.app.world_mut();
        let entity = world.resource_mut::<Banks>().next(row);
        world.spawn_at(entity, (bundle, born)).expect("the ID is new");
        world.resource_mut::<Banks>().rows[row] = Some(entity);
        entity
    }

    pub(super) fn despawn(&mut self, row: usize) {
        let world = self.app.world_mut();
        if let Some(entity) = world.resource_mut::<Banks>().rows[row].take() {
            world.despawn(entity);
        }
    }

    pub(super) fn alive(&self, row: usize) -> Option<Entity> {
        self.app.world().resource::<Banks>().rows[row]
    }

    /// Joints for a collider.
    pub(super) fn skin(&mut self, row: usize) -> SkinnedMesh {
        let joints = joints_of(row).map(|joint| self.spawn(joint, Transform::default()));
        SkinnedMesh {
            inverse_bindposes: self.bind_poses.clone(),
            joints: joints.to_vec(),
        }
    }

    /// A frame. Which operations it has depends on its number and `players`: one prediction differs from another.
    pub(super) fn run(&mut self, players: u64) -> Report {
        let number = u64::from(self.frame);
        self.rng = Pcg64Mcg::seed_from_u64(self.seed << 32 | players << 16 | number);
        self.births = 0;
        operate(self);
        let step = Duration::from_millis(10 + number % 7);
        self.app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
        let has_run = !self.app.settings().paused;
        self.app.update();
        // Systems of the game may also come after the run.
        if self.rng.random_bool(0.4) {
            operate(self);
        }
        self.frame += 1;
        self.report(has_run)
    }

    fn report(&mut self, has_run: bool) -> Report {
        let messages = self.reader.read(self.app.world(), &mut self.counts);
        let run = diagnostics(&self.app);
        let counts = [
            run.touching_pairs,
            run.triangle_pairs,
            run.overlapping_pairs,
            run.held_colliders,
            run.swept_pairs,
        ];
        Report {
            state: state(self.app.world_mut()),
            messages,
            observed: observed::take(self.app.world_mut(), &mut self.counts),
            counts: has_run.then_some(counts),
        }
    }
}
