//! Instances of one glTF file: loaded, measured and moved.

use std::path::{Path, PathBuf};

use bevy::asset::AssetPath;
use bevy::camera::primitives::Aabb;
use bevy::ecs::system::SystemParam;
use bevy::gltf::Gltf;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::scenes::dolphins::phase;

use super::clock::{Clock, Pending, Trouble, started};
use super::models::{Plays, scene};
use crate::app::is_loaded;
use crate::error::ExampleError;
use crate::instances::{self, THICKNESS_ON_LANES};

/// The model and how to place its instances.
#[derive(Resource, Clone, Debug)]
pub struct Group {
    model: PathBuf,
    /// Number of instances.
    pub count: usize,
    /// Whether the model is not a dolphin: it may be thicker, have another centre, or have no clip.
    foreign: bool,
    /// The centre of a body at rest.
    center: Vec3,
    /// Its thickness, relative to a dolphin's.
    size: f32,
}

impl Group {
    /// `count` instances of the file `model`: an asset's name, or any path.
    pub fn new(model: &Path, count: usize, foreign: bool) -> Self {
        Self {
            model: model.into(),
            count,
            foreign,
            center: Vec3::ZERO,
            size: 1.0,
        }
    }

    /// Loads the model and spawns its instances, each a [`Member`].
    pub fn join(self, app: &mut App) {
        app.insert_resource(self)
            .add_systems(Startup, load)
            .add_systems(Update, (spawn, (measure, wave).chain().run_if(started)));
    }

    /// Puts a body, scaled to a dolphin's thickness, where a dolphin would be.
    pub fn place(&self, dolphin: Transform) -> Transform {
        let scale = 1.0 / self.size;
        Transform {
            translation: dolphin.translation - dolphin.rotation * self.center * scale,
            rotation: dolphin.rotation,
            scale: Vec3::splat(scale),
        }
    }
}

/// Index in the group.
#[derive(Component, Clone, Copy, Debug)]
pub struct Member(pub usize);

/// The file while it is loading.
#[derive(Component)]
struct Loading(Handle<Gltf>);

fn load(group: Res<Group>, assets: Res<AssetServer>, mut commands: Commands) {
    let gltf = assets.load(AssetPath::from_path_buf(group.model.clone()));
    commands.spawn((Loading(gltf), Pending));
}

/// Spawns the instances once the file is loaded.
fn spawn(world: &mut World) {
    let Ok((entity, Loading(gltf))) = world.query::<(Entity, &Loading)>().single(world) else {
        return;
    };
    let gltf = gltf.id().untyped();
    let Group { model, count, .. } = world.resource::<Group>().clone();
    match is_loaded(world.resource::<AssetServer>(), gltf, &model) {
        Ok(true) => {
            world.despawn(entity);
        }
        Ok(false) => return,
        Err(error) => {
            world.insert_resource(Trouble(error.to_string()));
            return;
        }
    }
    let assets = world.resource::<AssetServer>().clone();
    for index in 0..count {
        world.spawn((
            Member(index),
            Name::new(format!("body {index}")),
            scene(&assets, &model),
            Plays::from(&assets, &model, phase(index)),
            MorphColliderScene::default(),
            // They keep apart until the show begins.
            Transform::from_xyz(1000.0 * index as f32, 0.0, 0.0),
        ));
    }
}

/// Measures the extent of members.
#[derive(SystemParam, Debug)]
pub struct Extent<'w, 's> {
    members: Query<'w, 's, (&'static Member, &'static GlobalTransform)>,
    parts: Query<'w, 's, (Entity, &'static Aabb, &'static GlobalTransform)>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl Extent<'_, '_> {
    /// A box around all parts of the first member, in the space of its root. If there are none, it goes from
    /// infinity to minus infinity.
    pub fn of_first(&self) -> (Vec3, Vec3) {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (part, bounds, place) in &self.parts {
            let Some((_, root)) = self
                .parents
                .iter_ancestors(part)
                .filter_map(|root| self.members.get(root).ok())
                .find(|(member, _)| member.0 == 0)
            else {
                continue;
            };
            let root_from_part = root.affine().inverse() * place.affine();
            for corner in 0..8 {
                let side = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
                let corner = bounds.center + bounds.half_extents * Vec3A::new(side(0), side(1), side(2));
                let corner = root_from_part.transform_point3(corner.into());
                (min, max) = (min.min(corner), max.max(corner));
            }
        }
        (min, max)
    }
}

/// Scales a model that is not a dolphin to a dolphin's thickness.
fn measure(
    mut group: ResMut<Group>,
    extent: Extent,
    morphing: Query<(), With<MeshMorphWeights>>,
    mut commands: Commands,
    mut done: Local<bool>,
) {
    if std::mem::replace(&mut *done, true) || !group.foreign {
        return;
    }
    if morphing.is_empty() {
        let (path, reason) = (group.model.clone(), String::new());
        commands.insert_resource(Trouble(ExampleError::NoMesh { path, reason }.to_string()));
    }
    let (min, max) = extent.of_first();
    let size = max - min;
    let thickness = 0.5 * (size.y + size.z);
    if thickness.is_finite() && thickness > 0.0 {
        group.center = 0.5 * (min + max);
        group.size = thickness / THICKNESS_ON_LANES;
    }
}

/// Models of members that play no clip, so their weights have to be moved here.
#[derive(SystemParam, Debug)]
pub struct Idle<'w, 's> {
    models: Query<'w, 's, (Entity, &'static mut MorphWeights)>,
    playing: Query<'w, 's, (), With<AnimationGraphHandle>>,
    members: Query<'w, 's, &'static Member>,
    parents: Query<'w, 's, &'static ChildOf>,
}

impl Idle<'_, '_> {
    /// Calls `change` with each member's index and weights.
    pub fn for_each(&mut self, mut change: impl FnMut(usize, &mut [f32])) {
        for (entity, mut weights) in &mut self.models {
            let above: Vec<Entity> = std::iter::once(entity)
                .chain(self.parents.iter_ancestors(entity))
                .collect();
            if above.iter().any(|&entity| self.playing.contains(entity)) {
                continue;
            }
            let member = above.iter().find_map(|&entity| self.members.get(entity).ok());
            change(member.map_or(0, |member| member.0), weights.weights_mut());
        }
    }
}

/// Moves weights in waves from 0 to 1.
fn wave(mut idle: Idle, clock: Res<Clock>) {
    let seconds = clock.frame as f32 / 60.0;
    idle.for_each(|index, weights| {
        for (target, weight) in weights.iter_mut().enumerate() {
            *weight = instances::wave(target, index, seconds);
        }
    });
}
