//! Random lives of skinned meshes and their joints: no panic, no ghost, and a mesh is where its joints put it.

use std::sync::Weak;

use bevy::math::Affine3A;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::morph_collision::MorphBvh;
use bevy_morph_collision::{MorphTrees, prelude::*};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{add, boned, extent, limb, skeleton, spawn_skinned};
use crate::support::{Messages, app, stretching_cube};

struct Life {
    app: App,
    rng: Pcg64Mcg,
    meshes: Vec<Handle<Mesh>>,
    limbs: Vec<Entity>,
    joints: Vec<Entity>,
    /// How often a mesh was compared with its joints.
    compared: usize,
}

impl Life {
    fn new(seed: u64) -> Self {
        let mut app = app();
        let side = |p: Vec3| u16::from(p.x > 0.0);
        let meshes = vec![add(&mut app, limb()), add(&mut app, boned(&stretching_cube(), side))];
        let mut life = Self {
            app,
            rng: Pcg64Mcg::seed_from_u64(seed),
            meshes,
            limbs: Vec::new(),
            joints: Vec::new(),
            compared: 0,
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
        self.joints.push(self.app.world_mut().spawn(place).id());
    }

    /// Two joints, or now and then another number; some do not exist any more.
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
        let operation = self.rng.random_range(0..10);
        if operation == 0 || self.limbs.len() < 3 {
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
                // With all joints below it.
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
            _ if exists(world, joint) => {
                world.entity_mut(joint).insert(place);
            }
            _ => {}
        }
    }

    /// Runs frames until all trees are there; returns how many contacts started and ended.
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

    /// A limb whose joints are all there, and good, is where they put its corners at rest.
    fn check(&mut self, context: &str) {
        for limb in self.limbs.clone() {
            let Some(skin) = self.app.world().get::<SkinnedMesh>(limb).cloned() else {
                continue;
            };
            let places = skin
                .joints
                .iter()
                .map(|&joint| Some(self.app.world().get::<GlobalTransform>(joint)?.affine()));
            let Some(places) = places.collect::<Option<Vec<_>>>() else {
                continue;
            };
            if !places.iter().all(Affine3A::is_finite) {
                continue;
            }
            let corner = |i: usize| Vec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 1 { 0.5 } else { -0.5 }));
            let corners = (0..8).map(|i| places[i & 1].transform_point3(corner(i)));
            let (min, max) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| {
                (min.min(p), max.max(p))
            });
            let found = extent(&mut self.app, limb);
            let (low, high) = found.unwrap_or_else(|| panic!("{context}: {limb} is not there"));
            assert!(
                low.distance(min) < 1e-3 && high.distance(max) < 1e-3,
                "{context}: {low} {high}, not {min} {max}"
            );
            self.compared += 1;
        }
    }
}

#[test]
fn skinned_meshes_and_joints_come_and_go() {
    let (mut compared, mut starts, mut ends) = (0, 0, 0);
    for seed in 0..8 {
        let mut life = Life::new(seed);
        let mut messages = Messages::default();
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
        compared += life.compared;
    }
    println!("{compared} places compared, {starts} starts");
    assert!(
        compared > 500 && starts > 100,
        "{compared} places compared, {starts} starts"
    );
}
