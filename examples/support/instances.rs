//! Several instances of one model: spawned from its scene, placed on the lanes of the dolphins, and animated.

use std::f32::consts::TAU;
use std::path::Path;

use bevy::gltf::Gltf;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::Aabb;
use bevy_morph_collision::prelude::*;
use morph_collision_models::scenes::dolphins;

use crate::app::{load_gltf, update_until};
use crate::error::ExampleError;

/// The body thickness that the lanes are made for. For other bodies, distances between lanes are scaled.
pub(crate) const THICKNESS_ON_LANES: f32 = 0.5;

/// The instances. The root of each one's scene is its body.
#[derive(Debug)]
pub struct Instances {
    /// The bodies, in the order of their lanes.
    pub roots: Vec<Entity>,
    /// Triangles of one body, all its parts together.
    pub triangles: usize,
    /// Morph targets; the maximum over the body's parts.
    pub targets: usize,
    /// The longest side of a body's box at rest.
    length: f32,
    /// The centre of a body, and the size of the lanes relative to the dolphins'.
    fit: (Vec3, f32),
    animated: bool,
}

/// Marks a root whose scene has been spawned.
#[derive(Component)]
struct Spawned;

impl Instances {
    /// Loads a model in the app's asset folder and spawns it `count` times, ready for frame 0.
    ///
    /// `refit` scales the lanes, for models that are not as thick as a dolphin.
    ///
    /// # Errors
    /// The file cannot be loaded, or has no scene or no usable mesh with morph targets.
    pub fn spawn(app: &mut App, file: &Path, count: usize, refit: bool) -> Result<Self, ExampleError> {
        let gltf = load_gltf(app, file)?;
        let world = app.world_mut();
        let scene = world.resource::<Assets<Gltf>>().get(&gltf).and_then(|gltf| {
            let scene = gltf.default_scene.as_ref().or(gltf.scenes.first())?;
            Some((scene.clone(), gltf.animations.first().cloned()))
        });
        let Some((scene, clip)) = scene else {
            return Err(ExampleError::NoScene(file.into()));
        };

        world.add_observer(|ready: On<WorldInstanceReady>, mut commands: Commands| {
            commands.entity(ready.entity).insert(Spawned);
        });
        let roots: Vec<Entity> = (0..count)
            .map(|index| {
                let name = Name::new(format!("body {index}"));
                world
                    .spawn((name, WorldAssetRoot(scene.clone()), Visibility::default()))
                    .id()
            })
            .collect();
        // Only one of them collides while the tree is built, because all are still in the same place.
        if let Some(&first) = roots.first() {
            world.entity_mut(first).insert(MorphColliderScene::default());
        }
        update_until(app, file, |world| {
            let spawned = world.query_filtered::<(), With<Spawned>>().iter(world).count();
            Ok(spawned == roots.len() && world.resource::<MorphTrees>().building() == 0)
        })?;
        // The parts became colliders in the last frame, at the earliest.
        app.update();
        update_until(app, file, |world| Ok(world.resource::<MorphTrees>().building() == 0))?;

        let mut instances = Self::measure(app.world_mut(), file, roots)?;
        if !refit {
            instances.fit = (Vec3::ZERO, 1.0);
        }
        if let Some(clip) = clip {
            instances.play(app.world_mut(), &clip);
        }
        for &root in &instances.roots {
            app.world_mut().entity_mut(root).insert(MorphColliderScene::default());
        }
        Ok(instances)
    }

    /// Measures the first body, which is at the origin: its triangles, targets and size.
    fn measure(world: &mut World, file: &Path, roots: Vec<Entity>) -> Result<Self, ExampleError> {
        let (mut triangles, mut targets, mut hull, mut reason) = (0, 0, Aabb::EMPTY, String::new());
        let mut parts =
            world.query_filtered::<(&Mesh3d, Option<&SkinnedMesh>, &GlobalTransform), With<MorphCollider>>();
        let (trees, meshes) = (world.resource::<MorphTrees>(), world.resource::<Assets<Mesh>>());
        for (mesh, skin, transform) in parts.iter(world) {
            let Some(tree) = trees.shown_with(mesh, None, skin) else {
                reason = trees.error(mesh.id()).map_or(reason, |error| format!(": {error}"));
                continue;
            };
            triangles += tree.model().triangle_count();
            targets = targets.max(tree.model().target_count());
            let positions = meshes
                .get(mesh.id())
                .and_then(|mesh| mesh.attribute(Mesh::ATTRIBUTE_POSITION));
            if let Some(VertexAttributeValues::Float32x3(positions)) = positions {
                let world = positions.iter().map(|&p| transform.transform_point(p.into()));
                hull = hull.union(&Aabb::from_points(world));
            }
        }
        if targets == 0 {
            return Err(ExampleError::NoMesh {
                path: file.into(),
                reason,
            });
        }
        let size = hull.size();
        let thickness = 0.5 * (size.y + size.z);
        // A flat or degenerate model still needs separate lanes.
        let thickness = if thickness > 0.0 {
            thickness
        } else {
            size.max_element().max(1e-3)
        };
        Ok(Self {
            roots,
            triangles,
            targets,
            length: size.max_element(),
            fit: (hull.center(), thickness / THICKNESS_ON_LANES),
            animated: false,
        })
    }

    /// The longest side of a body's box at rest, in world units.
    #[must_use]
    pub fn length(&self) -> f32 {
        self.length
    }

    /// Makes every instance play the clip in a loop, each from a different time.
    fn play(&mut self, world: &mut World, clip: &Handle<AnimationClip>) {
        let duration = world
            .resource::<Assets<AnimationClip>>()
            .get(clip)
            .map_or(0.0, AnimationClip::duration);
        let (graph, node) = AnimationGraph::from_clip(clip.clone());
        let graph = world.resource_mut::<Assets<AnimationGraph>>().add(graph);
        for (index, &root) in self.roots.iter().enumerate() {
            for part in descendants(world, root) {
                let Some(mut player) = world.get_mut::<AnimationPlayer>(part) else {
                    continue;
                };
                player.play(node).repeat().seek_to(dolphins::phase(index) * duration);
                world.entity_mut(part).insert(AnimationGraphHandle(graph.clone()));
                self.animated = true;
            }
        }
    }

    /// Moves every instance to its place in a frame. Without a clip, also moves its weights in waves from 0 to 1.
    pub fn advance(&self, world: &mut World, frame: usize, frames: usize) {
        let (center, scale) = self.fit;
        for (index, &root) in self.roots.iter().enumerate() {
            let place = dolphins::placement(index, self.roots.len(), frame, frames);
            let (_, rotation, translation) = place.to_scale_rotation_translation();
            if let Some(mut transform) = world.get_mut::<Transform>(root) {
                *transform = Transform {
                    translation: translation * scale - rotation * center,
                    rotation,
                    scale: Vec3::ONE,
                };
            }
            if self.animated {
                continue;
            }
            for part in descendants(world, root) {
                let Some(mut weights) = world.get_mut::<MorphWeights>(part) else {
                    continue;
                };
                for (target, weight) in weights.weights_mut().iter_mut().enumerate() {
                    *weight = wave(target, index, frame as f32 / 60.0);
                }
            }
        }
    }
}

/// The weight of a target of instance `index`, if it plays no clip: waves from 0 to 1.
#[must_use]
pub fn wave(target: usize, index: usize, seconds: f32) -> f32 {
    let cycles = seconds * (0.3 + 0.05 * (target % 7) as f32);
    let offset = dolphins::phase(index) + 0.37 * target as f32;
    0.5 - 0.5 * (TAU * (cycles + offset)).cos()
}

/// The place of a member of a crowd after some seconds: on a cubic grid, turning and bobbing at its own pace.
#[must_use]
pub fn in_crowd(index: usize, count: usize, seconds: f32, spacing: f32) -> Transform {
    let side = ((count as f32).cbrt().ceil() as usize).max(1);
    let cell = [index % side, index / side % side, index / side / side].map(|cell| cell as f32);
    let phase = 0.61 * index as f32 + seconds;
    let bob = Vec3::new(phase.sin(), (1.3 * phase).cos(), (0.7 * phase).sin()) * 0.1 * spacing;
    Transform::from_translation(Vec3::from_array(cell) * spacing + bob)
        .with_rotation(Quat::from_rotation_y(phase * TAU / 8.0))
}

fn descendants(world: &World, root: Entity) -> Vec<Entity> {
    let mut found = vec![root];
    let mut next = 0;
    while let Some(&entity) = found.get(next) {
        if let Some(children) = world.get::<Children>(entity) {
            found.extend(children.iter());
        }
        next += 1;
    }
    found
}
