//! Random lives of skinned meshes and their joints: no panic, nothing stale, a mesh is where its joints and targets put it, and
//! contacts are those of the oracle.

use std::sync::Weak;

use bevy::ecs::entity_disabling::Disabled;
use bevy::math::{Affine3A, DVec3};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::MorphBvh;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::{InfluenceSet, MorphMesh};
use morph_collision_testkit::oracle::{intersecting_pairs, posed_vertices, skinned_vertices, world_vertices};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{add, boned, extent, skeleton, spawn_skinned};
use crate::support::{Edits, Messages, app, cube, set_weight, stretching_cube};

/// The minimum number of meshes.
const LIMBS: usize = 5;

/// The joint of a corner: one for each side.
fn side(p: Vec3) -> u16 {
    u16::from(p.x > 0.0)
}

struct Life {
    app: App,
    rng: Pcg64Mcg,
    meshes: Vec<Handle<Mesh>>,
    shapes: Vec<MorphMesh>,
    limbs: Vec<Entity>,
    joints: Vec<Entity>,
    counts: Counts,
}

/// Counts of comparisons, to check that the test covers enough.
#[derive(Debug, Default)]
struct Counts {
    /// Meshes compared with their joints.
    places: usize,
    /// Pairs of meshes compared with the oracle, and those among them that touch.
    pairs: usize,
    touching: usize,
    starts: usize,
    ends: usize,
}

impl Life {
    fn new(seed: u64) -> Self {
        let mut app = app();
        let shapes = vec![cube(), stretching_cube()];
        let meshes = shapes.iter().map(|shape| add(&mut app, boned(shape, side))).collect();
        let mut life = Self {
            app,
            rng: Pcg64Mcg::seed_from_u64(seed),
            meshes,
            shapes,
            limbs: Vec::new(),
            joints: Vec::new(),
            counts: Counts::default(),
        };
        for _ in 0..6 {
            life.spawn_joint();
        }
        life
    }

    fn place(&mut self) -> Transform {
        let mut along = || self.rng.random_range(-1.5..=1.5_f32);
        let place = Transform::from_xyz(along(), along(), along()).with_rotation(Quat::from_rotation_y(along()));
        match self.rng.random_range(0..12) {
            0 => place.with_scale(Vec3::ZERO),
            1 => place.with_scale(Vec3::new(1.0, 0.0, -2.0)),
            2 => Transform::from_translation(Vec3::NAN),
            3 => place.with_scale(Vec3::splat(f32::INFINITY)),
            _ => place,
        }
    }

    fn spawn_joint(&mut self) {
        let place = self.place();
        self.joints.push(self.app.spawn(place));
    }

    /// Usually two joints, sometimes another number; some no longer exist.
    fn skin(&mut self) -> SkinnedMesh {
        let count = if self.rng.random_bool(0.1) { 3 } else { 2 };
        let joints: Vec<Entity> = (0..count)
            .map(|_| self.joints[self.rng.random_range(0..self.joints.len())])
            .collect();
        skeleton(&mut self.app, &joints)
    }

    fn operate(&mut self) {
        let mesh = self.meshes[self.rng.random_range(0..self.meshes.len())].clone();
        let (place, skin) = (self.place(), self.skin());
        let joint = self.joints[self.rng.random_range(0..self.joints.len())];
        let other = self.joints[self.rng.random_range(0..self.joints.len())];
        let weight = self.rng.random_range(-1.0..=2.0_f32);
        let operation = self.rng.random_range(0..13);
        if operation == 0 || self.limbs.len() < LIMBS {
            let limb = spawn_skinned(&mut self.app, &mesh, skin);
            self.limbs.push(limb);
            return;
        }
        let index = self.rng.random_range(0..self.limbs.len());
        let limb = self.limbs[index];
        let world = self.app.world_mut();
        let exists = |world: &World, entity: Entity| world.get_entity(entity).is_ok();
        match operation {
            1 => {
                world.despawn(limb);
                self.limbs.swap_remove(index);
            }
            2 => {
                world.entity_mut(limb).insert(Mesh3d(mesh));
            }
            3 => {
                world.entity_mut(limb).insert(skin);
            }
            4 => {
                world.entity_mut(limb).remove::<SkinnedMesh>();
            }
            5 => {
                // Despawns it with all joints below it.
                world.try_despawn(joint).ok();
                self.spawn_joint();
            }
            6 if joint != other && exists(world, joint) && exists(world, other) => {
                let parent = world.get::<ChildOf>(other).map(ChildOf::parent);
                if parent.is_none() && world.get::<Children>(joint).is_none() {
                    world.entity_mut(joint).insert(ChildOf(other));
                }
            }
            7 if exists(world, joint) => {
                world.entity_mut(joint).remove::<ChildOf>();
            }
            8 => set_weight(&mut self.app, limb, weight),
            9 => {
                let mut limb = world.entity_mut(limb);
                match limb.contains::<MorphColliderDisabled>() {
                    true => limb.remove::<MorphColliderDisabled>(),
                    false => limb.insert(MorphColliderDisabled),
                };
            }
            10 => {
                let mut limb = world.entity_mut(limb);
                match limb.contains::<Disabled>() {
                    true => limb.remove::<Disabled>(),
                    false => limb.insert(Disabled),
                };
            }
            _ if exists(world, joint) => {
                world.entity_mut(joint).insert(place);
            }
            _ => {}
        }
    }

    /// Runs frames until all trees are built; returns how many contacts started and ended.
    fn settle(&mut self, messages: &mut Messages) -> (usize, usize) {
        let (mut starts, mut ends, mut left) = (0, 0, 2);
        while left > 0 {
            self.app.update();
            let (started, ended) = messages.read(&self.app);
            (starts, ends) = (starts + started.len(), ends + ended.len());
            if self.app.world().resource::<MorphTrees>().building() == 0 {
                left -= 1;
            }
        }
        (starts, ends)
    }

    /// Whether a mesh takes part in collisions.
    fn is_enabled(&self, limb: Entity) -> bool {
        let limb = self.app.world().entity(limb);
        !limb.contains::<MorphColliderDisabled>() && !limb.contains::<Disabled>()
    }

    /// A mesh and the positions of its vertices, from components alone; `None` if they depend on earlier states because a joint
    /// is gone or invalid.
    fn vertices(&self, limb: Entity) -> Option<(&MorphMesh, Vec<DVec3>)> {
        let limb = self.app.world().entity(limb);
        let mesh = limb.get::<Mesh3d>()?.id();
        let shape = &self.shapes[self.meshes.iter().position(|known| known.id() == mesh)?];
        let mut weights = vec![0.0; shape.targets.len()];
        if let Some(MeshMorphWeights::Value { weights: given }) = limb.get::<MeshMorphWeights>() {
            weights
                .iter_mut()
                .zip(given)
                .for_each(|(weight, given)| *weight = *given);
        }
        let posed = posed_vertices(&shape.positions, &shape.targets, &weights);
        let place = |entity: Entity| Some(self.app.world().get::<GlobalTransform>(entity)?.affine());
        let Some(skin) = limb.get::<SkinnedMesh>() else {
            return Some((shape, world_vertices(&posed, &place(limb.id())?)));
        };
        let joints: Vec<Affine3A> = skin.joints.iter().map(|&joint| place(joint)).collect::<Option<_>>()?;
        if !joints.iter().all(Affine3A::is_finite) {
            return None;
        }
        let sides = shape.positions.iter().map(|&p| [side(p), 0, 0, 0]).collect();
        let weights = vec![[1.0, 0.0, 0.0, 0.0]; posed.len()];
        let influences = InfluenceSet { joints: sides, weights };
        Some((shape, skinned_vertices(&posed, &[influences], &joints)))
    }

    /// Checks that every participating mesh is where its vertices are, and that its contacts are those of the oracle.
    fn check(&mut self, context: &str) {
        let mut known = Vec::new();
        for limb in self.limbs.clone() {
            if !self.is_enabled(limb) {
                let touched = self
                    .app
                    .world()
                    .resource::<MorphCollisions>()
                    .collisions_with(limb)
                    .next();
                assert!(touched.is_none(), "{context}: {limb} is disabled");
                continue;
            }
            let Some((shape, vertices)) = self.vertices(limb) else {
                continue;
            };
            let triangles = shape.triangles.clone();
            let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            let (min, max) = vertices
                .iter()
                .fold(start, |(min, max), p| (min.min(p.as_vec3()), max.max(p.as_vec3())));
            let found = extent(&mut self.app, limb);
            let (low, high) = found.unwrap_or_else(|| panic!("{context}: {limb} is not there"));
            assert!(
                low.distance(min) < 1e-3 && high.distance(max) < 1e-3,
                "{context}: {low} {high}, not {min} {max}"
            );
            self.counts.places += 1;
            known.push((limb, vertices, triangles));
        }
        for (i, (a, of_a, triangles_of_a)) in known.iter().enumerate() {
            for (b, of_b, triangles_of_b) in &known[..i] {
                let touch = !intersecting_pairs(of_a, triangles_of_a, of_b, triangles_of_b).is_empty();
                let found = self.app.world().resource::<MorphCollisions>().contains(*a, *b);
                assert_eq!(found, touch, "{context}: whether {a} and {b} touch");
                self.counts.pairs += 1;
                self.counts.touching += usize::from(touch);
            }
        }
    }
}

#[test]
fn skinned_meshes_and_joints_come_and_go() {
    let mut all = Counts::default();
    for seed in 0..8 {
        let mut life = Life::new(seed);
        let mut messages = Messages::default();
        let (mut starts, mut ends) = (0, 0);
        for step in 0..80 {
            for _ in 0..2 {
                life.operate();
            }
            let (started, ended) = life.settle(&mut messages);
            (starts, ends) = (starts + started, ends + ended);
            let touching = life.app.world().resource::<MorphCollisions>().len();
            assert_eq!(starts - ends, touching, "seed {seed}, step {step}");
            for contact in life.app.world().resource::<MorphCollisions>().iter() {
                assert!(
                    life.limbs.contains(&contact.collider1) && life.limbs.contains(&contact.collider2),
                    "a ghost"
                );
            }
            life.check(&format!("seed {seed}, step {step}"));
        }
        let trees = life.app.world().resource::<MorphTrees>();
        let trees: Vec<Weak<MorphBvh>> = trees.iter().map(|(_, tree)| std::sync::Arc::downgrade(tree)).collect();
        assert!(!trees.is_empty());
        for entity in life.limbs.drain(..).chain(life.joints.drain(..)) {
            life.app.world_mut().try_despawn(entity).ok();
        }
        life.meshes.clear();
        ends += life.settle(&mut messages).1;
        assert_eq!(starts, ends, "seed {seed}: everything is gone");
        assert!(
            trees.iter().all(|tree| tree.upgrade().is_none()),
            "seed {seed}: a tree is kept"
        );
        all.places += life.counts.places;
        all.pairs += life.counts.pairs;
        all.touching += life.counts.touching;
        all.starts += starts;
        all.ends += ends;
    }
    println!("{all:?}");
    assert!(all.places > 1000 && all.starts > 200, "{all:?}");
    assert!(all.pairs > 1000 && all.touching > 200, "{all:?}");
    assert!(all.touching < all.pairs, "{all:?}");
}
