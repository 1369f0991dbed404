//! Twelve dolphins that swim closely together as a group, roll, and touch now and then: the paper's Fig. 7. Or any other model in their
//! place.

use std::path::{Path, PathBuf};

use bevy::asset::AssetPath;
use bevy::camera::primitives::Aabb;
use bevy::gltf::Gltf;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::scenes::dolphins as lanes;

use crate::displacements::spread_over_split_vertices;
use crate::instances::{self as waves, THICKNESS_ON_LANES};
use crate::view::Show;
use crate::view::clock::{Clock, FRACTIONS, Pending, Trouble, started};
use crate::view::models::{Plays, scene};

/// Closer together than where times are taken, for something to be seen.
const CLOSER: Vec3 = Vec3::new(1.0, 0.8, 0.8);

#[derive(Resource)]
struct Group {
    model: PathBuf,
    count: usize,
    /// Whether the model is not a dolphin: it may be thicker, lie elsewhere, have no clip, or no normals.
    foreign: bool,
    /// The centre of a body, and the size of the lanes relative to the dolphins'.
    fit: (Vec3, f32),
}

/// The file while it is loaded.
#[derive(Component)]
struct Loading(Handle<Gltf>);

/// Number in the group.
#[derive(Component)]
struct Dolphin(usize);

/// `count` instances of the glTF file `model`: an asset's name, or any path. A `foreign` one is not a dolphin.
#[must_use]
pub fn dolphins(model: &Path, count: usize, foreign: bool) -> Show {
    let model = model.to_path_buf();
    Show {
        name: "dolphins",
        about: "Dolphins, morphed by the GPU, swim as a group. Touching triangles are red.",
        keys: &[],
        eye: Vec3::new(1.15, 1.1, 2.5),
        target: Vec3::new(0.0, -0.1, 0.0),
        pictures: &[20, 60, 240, 380],
        scene: Box::new(move |app| {
            let fit = (Vec3::ZERO, 1.0);
            app.insert_resource(Group {
                model,
                count,
                foreign,
                fit,
            })
            .add_systems(Startup, load)
            .add_systems(Update, (spawn, (fit_lanes, swim, wave).chain().run_if(started)));
        }),
    }
}

fn load(group: Res<Group>, assets: Res<AssetServer>, mut commands: Commands) {
    let gltf = assets.load(AssetPath::from_path_buf(group.model.clone()));
    commands.spawn((Loading(gltf), Pending));
}

/// Once the file is there.
fn spawn(world: &mut World) {
    let Ok((entity, Loading(gltf))) = world.query::<(Entity, &Loading)>().single(world) else {
        return;
    };
    let gltf = gltf.clone();
    let assets = world.resource::<AssetServer>().clone();
    if let Some(error) = assets.get_load_state(&gltf).and_then(|state| match state {
        bevy::asset::LoadState::Failed(error) => Some(error.to_string()),
        _ => None,
    }) {
        let trouble = error.lines().next().unwrap_or_default().to_owned();
        world.insert_resource(Trouble(trouble));
        return;
    }
    if !assets.is_loaded_with_dependencies(&gltf) {
        return;
    }
    let (model, count, foreign) = {
        let group = world.resource::<Group>();
        (group.model.clone(), group.count, group.foreign)
    };
    if foreign && let Err(error) = spread_over_split_vertices(world, &gltf, &model) {
        world.insert_resource(Trouble(error.to_string()));
        return;
    }
    for index in 0..count {
        world.spawn((
            Dolphin(index),
            Name::new(format!("dolphin {index}")),
            scene(&assets, &model),
            Plays::from(&assets, &model, lanes::phase(index)),
            MorphColliderScene::default(),
            // Until the show begins they keep apart.
            Transform::from_xyz(1000.0 * index as f32, 0.0, 0.0),
        ));
    }
    world.despawn(entity);
}

/// Other models get lanes as far apart as they are thick.
fn fit_lanes(
    mut group: ResMut<Group>,
    dolphins: Query<(&Dolphin, &GlobalTransform)>,
    parts: Query<(&Aabb, &GlobalTransform, &ChildOf)>,
    parents: Query<&ChildOf>,
    mut done: Local<bool>,
) {
    if std::mem::replace(&mut *done, true) || !group.foreign {
        return;
    }
    let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for (bounds, place, above) in &parts {
        let roots = std::iter::once(above.parent()).chain(parents.iter_ancestors(above.parent()));
        let Some((_, root)) = roots
            .filter_map(|root| dolphins.get(root).ok())
            .find(|(dolphin, _)| dolphin.0 == 0)
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
    let size = max - min;
    let thickness = 0.5 * (size.y + size.z);
    if thickness.is_finite() && thickness > 0.0 {
        group.fit = (0.5 * (min + max), thickness / THICKNESS_ON_LANES);
    }
}

fn swim(mut dolphins: Query<(&Dolphin, &mut Transform)>, group: Res<Group>, clock: Res<Clock>) {
    let frames = lanes::FRAMES * FRACTIONS;
    let now = clock.fractions() % frames;
    let (center, size) = group.fit;
    for (&Dolphin(index), mut place) in &mut dolphins {
        let lane = lanes::placement(index, group.count, now, frames);
        let (_, rotation, translation) = lane.to_scale_rotation_translation();
        // The camera swims along. Its distance is made for dolphins, so a larger model becomes smaller rather than the lanes larger.
        let lane = (translation - Vec3::X * lanes::way(now, frames)) * CLOSER;
        let translation = lane - rotation * center / size;
        *place = Transform {
            translation,
            rotation,
            scale: Vec3::splat(1.0 / size),
        };
    }
}

/// What plays no clip morphs in waves, from 0 to 1.
fn wave(
    mut models: Query<(Entity, &mut MorphWeights)>,
    playing: Query<(), With<AnimationGraphHandle>>,
    dolphins: Query<&Dolphin>,
    parents: Query<&ChildOf>,
    clock: Res<Clock>,
) {
    for (entity, mut weights) in &mut models {
        let above: Vec<Entity> = std::iter::once(entity).chain(parents.iter_ancestors(entity)).collect();
        if above.iter().any(|&entity| playing.contains(entity)) {
            continue;
        }
        let index = above
            .iter()
            .find_map(|&entity| dolphins.get(entity).ok())
            .map_or(0, |dolphin| dolphin.0);
        let seconds = clock.frame as f32 / 60.0;
        for (target, weight) in weights.weights_mut().iter_mut().enumerate() {
            *weight = waves::wave(target, index, seconds);
        }
    }
}
