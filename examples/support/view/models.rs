//! Models in a show: scenes as Bevy loads them, and meshes with computed normals if a file has none.

use std::path::Path;
use std::sync::Arc;

use bevy::asset::io::Reader;
use bevy::asset::{AssetLoader, AssetPath, LoadContext, LoadState};
use bevy::gltf::Gltf;
use bevy::mesh::morph::{MeshMorphWeights, MorphAttributes, MorphWeights};
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_collision::morph_collision::{BuildOptions, MorphBvh, Pose};
use morph_collision_models::generated::topology::components;
use morph_collision_models::gltf::read::{ReadError, parse_meshes};
use morph_collision_models::mesh::MorphMesh;

use super::clock::{Pending, Trouble, started};
use crate::app::first_line;
use crate::physics::bevy_mesh;

/// A glTF file's meshes, each in its own space, as `morph_collision_models` reads them.
#[derive(Asset, TypePath, Debug)]
pub struct Model {
    /// The meshes, in file order.
    pub meshes: Vec<MorphMesh>,
}

#[derive(Default, TypePath)]
struct ModelLoader;

impl AssetLoader for ModelLoader {
    type Asset = Model;
    type Settings = ();
    type Error = ReadError;

    async fn load(&self, reader: &mut dyn Reader, (): &(), context: &mut LoadContext<'_>) -> Result<Model, ReadError> {
        let path = context.path().path().to_path_buf();
        let mut bytes = Vec::new();
        reader.read_to_end(&mut bytes).await.map_err(|source| ReadError::Io {
            path: path.clone(),
            source,
        })?;
        let meshes = parse_meshes(&bytes, &path)?;
        Ok(Model { meshes })
    }

    /// Empty, because Bevy's own loader has these extensions. This loader is found by its asset type.
    fn extensions(&self) -> &[&str] {
        &[]
    }
}

pub(super) fn plugin(app: &mut App) {
    app.init_asset::<Model>()
        .init_asset_loader::<ModelLoader>()
        .add_observer(scene_is_there)
        .add_systems(Update, (look_for_trouble, place_models, play.run_if(started)));
}

/// The first scene of a glTF file, as a game loads it.
pub fn scene(assets: &AssetServer, file: &Path) -> impl Bundle {
    let file = AssetPath::from_path_buf(file.to_path_buf());
    let scene = WorldAssetRoot(assets.load(file.with_label("Scene0")));
    (scene, Visibility::default(), Pending)
}

/// On the root of a [`scene`]: plays the file's first clip in a loop.
#[derive(Component, Clone, Debug)]
pub struct Plays {
    gltf: Handle<Gltf>,
    /// Where in the clip to start, in 0..1.
    phase: f32,
}

impl Plays {
    /// Plays the first clip of a file, starting at `phase` in 0..1.
    #[must_use]
    pub fn new(gltf: Handle<Gltf>, phase: f32) -> Self {
        Self { gltf, phase }
    }

    /// Plays the first clip of the file, starting at `phase` in 0..1.
    #[must_use]
    pub fn from(assets: &AssetServer, file: &Path, phase: f32) -> Self {
        Self::new(assets.load(AssetPath::from_path_buf(file.to_path_buf())), phase)
    }
}

fn play(
    gltfs: Res<Assets<Gltf>>,
    clips: Res<Assets<AnimationClip>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut players: Query<(Entity, &mut AnimationPlayer), Without<AnimationGraphHandle>>,
    parents: Query<&ChildOf>,
    scenes: Query<&Plays>,
    mut commands: Commands,
) {
    for (entity, mut player) in &mut players {
        let scene = parents.iter_ancestors(entity).find_map(|above| scenes.get(above).ok());
        let found = scene.and_then(|scene| {
            let clip = gltfs.get(&scene.gltf)?.animations.first()?;
            Some((scene.phase * clips.get(clip)?.duration(), clip.clone()))
        });
        if let Some((from, clip)) = found {
            let (graph, node) = AnimationGraph::from_clip(clip);
            player.play(node).repeat().seek_to(from);
            commands.entity(entity).insert(AnimationGraphHandle(graphs.add(graph)));
        }
    }
}

fn scene_is_there(ready: On<WorldInstanceReady>, mut commands: Commands) {
    commands.entity(ready.entity).remove::<Pending>();
}

/// The weights of a drawn model: its own, or those that it shares with others.
#[must_use]
pub fn weights_of<'a>(weights: &'a MeshMorphWeights, shared: &'a Query<&MorphWeights>) -> &'a [f32] {
    match weights {
        &MeshMorphWeights::Reference(source) => shared.get(source).map_or(&[], MorphWeights::weights),
        MeshMorphWeights::Value { weights } => weights,
    }
}

/// The meshes of a [`Model`], with normals, become children of this entity, one each. Then `dress` is applied to each.
#[derive(Component, Debug)]
pub struct ModelRoot {
    /// The file's meshes.
    pub model: Handle<Model>,
    /// The size of the longest side at rest. The middle is moved to the origin.
    pub size: f32,
    /// Their material.
    pub material: StandardMaterial,
    /// Colours of connected pieces, from the largest piece to the smallest, on top of the material. The last colour is for all
    /// remaining pieces.
    pub pieces: &'static [Color],
    /// Adds the show's own components to each child.
    pub dress: fn(&mut EntityCommands),
}

/// A child of a [`ModelRoot`].
#[derive(Component, Clone, Copy, Debug)]
pub struct ModelPart;

fn place_models(
    roots: Query<(Entity, &ModelRoot), With<Pending>>,
    models: Res<Assets<Model>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (root, wanted) in &roots {
        let Some(model) = models.get(&wanted.model) else {
            continue;
        };
        let positions = || model.meshes.iter().flat_map(|mesh| &mesh.positions);
        let min = positions().copied().fold(Vec3::INFINITY, Vec3::min);
        let max = positions().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let scale = wanted.size / (max - min).max_element().max(f32::MIN_POSITIVE);
        let place = Transform::from_translation(-scale * 0.5 * (min + max)).with_scale(Vec3::splat(scale));
        let material = materials.add(wanted.material.clone());
        for mesh in &model.meshes {
            let name = Name::new(mesh.name.clone());
            let weights = MeshMorphWeights::Value {
                weights: vec![0.0; mesh.targets.len()],
            };
            let drawn = (Mesh3d(meshes.add(painted(mesh, wanted.pieces))), weights);
            let mut part = commands.spawn((
                ModelPart,
                name,
                drawn,
                MeshMaterial3d(material.clone()),
                place,
                ChildOf(root),
            ));
            (wanted.dress)(&mut part);
        }
        commands.entity(root).remove::<Pending>();
    }
}

/// A Bevy mesh with smooth normals at rest and at full weight of every target.
///
/// In between, the GPU blends normals as it does positions. A mesh for which no tree can be built gets no normals.
#[must_use]
pub fn with_normals(mesh: &MorphMesh) -> Mesh {
    let bevy = bevy_mesh(mesh);
    let Some((base, targets)) = normals(mesh) else {
        return bevy;
    };
    let mut attributes = Vec::with_capacity(mesh.targets.len() * base.len());
    for (displacements, normals) in mesh.targets.iter().zip(&targets) {
        for ((&position, &normal), &rest) in displacements.iter().zip(normals).zip(&base) {
            attributes.push(MorphAttributes::new(position, normal - rest, Vec3::ZERO));
        }
    }
    let mut bevy = bevy.with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, base);
    if !attributes.is_empty() {
        bevy.set_morph_targets(attributes);
        bevy.set_morph_target_names(mesh.target_names.clone());
    }
    bevy
}

/// The mesh with normals, and each connected piece in its colour.
fn painted(mesh: &MorphMesh, colors: &[Color]) -> Mesh {
    let bevy = with_normals(mesh);
    let Some(last) = colors.last() else {
        return bevy;
    };
    let mut pieces = components(mesh.positions.len(), &mesh.triangles);
    pieces.sort_by_key(|piece| std::cmp::Reverse(piece.len()));
    let mut painted = vec![LinearRgba::WHITE.to_f32_array(); mesh.positions.len()];
    for (i, piece) in pieces.iter().enumerate() {
        let color = colors.get(i).unwrap_or(last).to_linear().to_f32_array();
        for &triangle in piece {
            for &corner in &mesh.triangles[triangle] {
                painted[corner as usize] = color;
            }
        }
    }
    bevy.with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, painted)
}

/// Normals at rest, and at full weight of each target.
fn normals(mesh: &MorphMesh) -> Option<(Vec<Vec3>, Vec<Vec<Vec3>>)> {
    let model = Arc::new(mesh.to_model().ok()?);
    let mut pose = Pose::new(Arc::new(MorphBvh::build(model, &BuildOptions::default())));
    let mut of = |target: Option<usize>| {
        let mut weights = vec![0.0; mesh.targets.len()];
        if let Some(target) = target {
            weights[target] = 1.0;
        }
        pose.set_weights(&weights).ok()?;
        let mut normals = Vec::new();
        pose.source_normals(&mut normals);
        // Vertices without area are drawn as if they faced up.
        let drawn = |normal: Vec3| if normal == Vec3::ZERO { Vec3::Y } else { normal };
        Some(normals.into_iter().map(drawn).collect::<Vec<_>>())
    };
    let base = of(None)?;
    let targets = (0..mesh.targets.len())
        .map(|target| of(Some(target)))
        .collect::<Option<_>>()?;
    Some((base, targets))
}

/// Ends the show if a file cannot be loaded.
fn look_for_trouble(
    roots: Query<(Option<&ModelRoot>, Option<&WorldAssetRoot>), With<Pending>>,
    assets: Res<AssetServer>,
    mut commands: Commands,
) {
    for (model, scene) in &roots {
        let ids = [
            model.map(|root| root.model.id().untyped()),
            scene.map(|root| root.0.id().untyped()),
        ];
        for id in ids.into_iter().flatten() {
            if let Some(LoadState::Failed(error)) = assets.get_load_state(id) {
                commands.insert_resource(Trouble(first_line(&error)));
            }
        }
    }
}
