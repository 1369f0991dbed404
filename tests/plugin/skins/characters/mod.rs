//! Real characters as they play their clips, against brute force over vertices that are morphed and skinned here, from the file.

mod answers;
mod drawn;
mod velocity;

use std::path::Path;

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use self::answers::check_box;
use crate::models::{NamedClip, play, shared, with_models};

/// A primitive of the file, shown by an entity.
struct Part {
    entity: Entity,
    root: Entity,
    /// Its mesh in the file, and its triangles there.
    mesh: usize,
    triangles: Vec<[u32; 3]>,
}

/// A file, and two of it in an app.
struct Stage {
    app: App,
    roots: Vec<Entity>,
    clips: Vec<NamedClip>,
    meshes: Vec<MorphMesh>,
    parts: Vec<Part>,
    rng: Pcg64Mcg,
    counts: Counts,
}

/// What was compared, to see that the test tries something.
#[derive(Debug, Default)]
struct Counts {
    frames: usize,
    skinned_vertices: usize,
    /// How far vertices are from where they are by the file's own clips, in parts of the size.
    off_the_clip: f64,
    rays: usize,
    hits: usize,
    joints: usize,
    frames_that_touch: usize,
    triangle_pairs: usize,
    /// Vertices outside the box of the rest pose.
    outgrown: usize,
}

impl Stage {
    /// Two of a model, side by side, so far apart in parts of the size.
    fn new(file: &Path, apart: f32) -> Self {
        let meshes = read_meshes(file).expect("the model can be read");
        // Found by a look at one.
        let size = {
            let mut one = Self::with(file, Vec::new(), &[Transform::default()]);
            one.meshes.clone_from(&meshes);
            one.find_parts();
            let all: Vec<DVec3> = one.parts.iter().flat_map(|part| one.vertices(part)).collect();
            {
                let (min, max) = extent(&all);
                max - min
            }
        };
        let beside = Transform::from_translation(Vec3::X * apart * size.max_element() as f32)
            .with_rotation(Quat::from_rotation_y(0.4))
            .with_scale(Vec3::new(1.0, 1.05, 0.95));
        let mut stage = Self::with(file, meshes, &[Transform::default(), beside]);
        stage.find_parts();
        stage
    }

    fn with(file: &Path, meshes: Vec<MorphMesh>, places: &[Transform]) -> Self {
        let (app, roots, clips) = with_models(file, places);
        Self {
            app,
            roots,
            clips,
            meshes,
            parts: Vec::new(),
            rng: Pcg64Mcg::seed_from_u64(7),
            counts: Counts::default(),
        }
    }

    /// By the label of the mesh asset: `Mesh2/Primitive0`.
    fn find_parts(&mut self) {
        let world = self.app.world_mut();
        let mut colliders = world.query_filtered::<(Entity, &Mesh3d, &MorphBody), With<MorphCollider>>();
        for (entity, shown, body) in colliders.iter(world) {
            let path = world
                .resource::<AssetServer>()
                .get_path(shown.id())
                .expect("it is from the file");
            let label = path
                .label()
                .expect("a mesh has a label")
                .replace("Mesh", "")
                .replace("Primitive", "");
            let (mesh, primitive) = label.split_once('/').expect("a mesh and its primitive");
            let (mesh, primitive): (usize, usize) = (mesh.parse().unwrap(), primitive.parse().unwrap());
            let range = self.meshes[mesh].primitives[primitive].clone();
            self.parts.push(Part {
                entity,
                root: body.0,
                mesh,
                triangles: self.meshes[mesh].triangles[range.start as usize..range.end as usize].to_vec(),
            });
        }
    }

    /// Plays every clip and compares every so many frames.
    fn play_all(&mut self, every: usize, most_frames: usize) {
        let file = self.meshes.first().map(|mesh| mesh.name.clone()).unwrap_or_default();
        let world = self.app.world_mut();
        let mut places = world.query::<(Entity, &Transform)>();
        let rest: Vec<(Entity, Transform)> = places.iter(world).map(|(entity, place)| (entity, *place)).collect();
        for (name, clip) in &self.clips.clone() {
            // What a clip leaves alone stays where the one before left it, in Bevy.
            for &(entity, place) in &rest {
                self.app.world_mut().entity_mut(entity).insert(place);
            }
            let length = self
                .app
                .world()
                .resource::<Assets<AnimationClip>>()
                .get(clip)
                .unwrap()
                .duration();
            play(&mut self.app, clip, &self.roots, |index| 0.37 * length * index as f32);
            let frames = ((length * 60.0) as usize).min(most_frames);
            // The graph is a new asset, which takes players a few frames to notice.
            for _ in 0..3 {
                self.app.update();
            }
            for frame in 0..frames {
                self.app.update();
                if frame % every == 0 {
                    self.compare(name, &format!("{file}, {name}, frame {frame}"));
                }
            }
        }
    }

    fn compare(&mut self, clip: &str, when: &str) {
        self.counts.frames += 1;
        let all: Vec<Vec<DVec3>> = self.parts.iter().map(|part| self.vertices(part)).collect();
        let (min, max) = extent(all.iter().flatten());
        let size = (max - min).max_element();
        for (part, vertices) in self.parts.iter().zip(&all) {
            if let Some(by_clip) = self.vertices_by_clip(part, clip) {
                let off = by_clip
                    .iter()
                    .zip(vertices)
                    .map(|(a, b)| a.distance(*b))
                    .fold(0.0, f64::max)
                    / size;
                assert!(off < 1e-4, "{when}: the app's pose is off the clip by {off}");
                self.counts.off_the_clip = self.counts.off_the_clip.max(off);
                self.counts.skinned_vertices += vertices.len();
            }
            self.counts.outgrown += check_box(&self.app, part, vertices, &self.meshes[part.mesh], when);
        }
        for _ in 0..12 {
            self.compare_a_ray(&all, (min, max), when);
        }
        self.compare_pairs(&all, when);
    }
}

/// The box around points.
fn extent<'a>(points: impl IntoIterator<Item = &'a DVec3>) -> (DVec3, DVec3) {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points
        .into_iter()
        .fold(start, |(min, max), &p| (min.min(p), max.max(p)))
}

/// What the counts of a model say.
fn compare_model(name: &str, apart: f32, every: usize, most_frames: usize) -> Option<Counts> {
    let mut stage = Stage::new(&shared(name)?, apart);
    assert!(
        stage.parts.iter().any(|part| stage.meshes[part.mesh].skin.is_some()),
        "{name} is skinned"
    );
    stage.play_all(every, most_frames);
    println!("{name}: {:?}", stage.counts);
    Some(stage.counts)
}

#[test]
fn a_character_that_walks_and_talks() {
    for (name, every, most_frames) in [("mh_character_low.glb", 6, 180), ("mh_character.glb", 45, 180)] {
        let Some(counts) = compare_model(name, 0.3, every, most_frames) else {
            continue;
        };
        assert!(
            counts.frames > 10 && counts.hits > 60 && counts.joints == counts.hits,
            "{counts:?}"
        );
        assert!(
            counts.frames_that_touch > 3 && counts.triangle_pairs > 100,
            "{counts:?}"
        );
        assert!(counts.outgrown > 1000 && counts.skinned_vertices > 10_000, "{counts:?}");
    }
}

#[test]
fn a_fox_that_runs() {
    let Some(counts) = compare_model("Fox.glb", 0.1, 4, 240) else {
        return;
    };
    assert!(
        counts.frames > 20 && counts.hits > 100 && counts.joints == counts.hits,
        "{counts:?}"
    );
    assert!(
        counts.frames_that_touch > 5 && counts.triangle_pairs > 100,
        "{counts:?}"
    );
}

#[test]
fn a_robot_whose_hands_are_skinned_and_whose_face_morphs() {
    let Some(counts) = compare_model("RobotExpressive.glb", 0.3, 6, 90) else {
        return;
    };
    assert!(
        counts.frames > 50 && counts.hits > 200 && counts.joints > 10,
        "{counts:?}"
    );
    assert!(counts.joints < counts.hits, "{counts:?}");
    assert!(counts.frames_that_touch > 3 && counts.triangle_pairs > 20, "{counts:?}");
}
