//! Compares real characters that play their clips with brute force over vertices that are morphed and skinned here, from the
//! file.
//!
//! By default, some frames of each clip are compared. With [`EVERY_FRAME`] in the environment, it is every frame of every clip
//! at 60 Hz.

mod answers;
mod by_clip;
mod velocity;

use std::path::Path;

use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::crowd::edit_players;
use morph_collision_workspace::drawn::{self, extent};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use self::answers::check_box;
use crate::models::{NamedClip, play, shared, with_models};
use crate::support::Edits;

/// The environment variable that enables the comparison of every frame.
const EVERY_FRAME: &str = "MORPH_COLLISION_EVERY_FRAME";

/// A primitive of the file, shown by an entity.
struct Part {
    entity: Entity,
    root: Entity,
    /// Its mesh in the file, and the primitive's triangles.
    mesh: usize,
    triangles: Vec<[u32; 3]>,
}

/// A file, and two instances of it in an app.
struct Stage {
    app: App,
    roots: Vec<Entity>,
    clips: Vec<NamedClip>,
    meshes: Vec<MorphMesh>,
    parts: Vec<Part>,
    rng: Pcg64Mcg,
    counts: Counts,
}

/// Counts of comparisons, to check that the test covers enough.
#[derive(Debug, Default)]
struct Counts {
    clips: usize,
    frames: usize,
    /// Boxes that were compared with their vertices.
    boxes: usize,
    skinned_vertices: usize,
    /// The largest distance of a vertex from its position by the file's own clips, relative to the model's size.
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
    /// Two instances of a model, side by side; `apart` is relative to the model's size.
    fn new(file: &Path, apart: f32) -> Self {
        let meshes = read_meshes(file).expect("the model can be read");
        // Measured on a single instance.
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

    fn find_parts(&mut self) {
        let world = self.app.world_mut();
        for part in drawn::parts::<With<MorphCollider>>(world, &self.meshes) {
            self.parts.push(Part {
                entity: part.entity,
                root: world
                    .get::<MorphColliderOf>(part.entity)
                    .expect("a scene is a body")
                    .body,
                mesh: part.mesh,
                triangles: part.triangles(&self.meshes).to_vec(),
            });
        }
    }

    /// Plays every clip from beginning to end and compares every `every`-th frame; frames are 1/60 s apart.
    fn play_all(&mut self, every: usize, most_frames: usize) {
        let file = self.meshes.first().map(|mesh| mesh.name.clone()).unwrap_or_default();
        let world = self.app.world_mut();
        let mut places = world.query::<(Entity, &Transform)>();
        let rest: Vec<(Entity, Transform)> = places.iter(world).map(|(entity, place)| (entity, *place)).collect();
        for (name, clip) in &self.clips.clone() {
            // In Bevy, joints that a clip does not move stay where the previous clip left them.
            for &(entity, place) in &rest {
                self.app.insert(entity, place);
            }
            let length = play(&mut self.app, clip, &self.roots, |index, length| {
                0.37 * length * index as f32
            });
            let frames = ((length * 60.0) as usize).min(most_frames);
            // The graph is a new asset, and players take a few frames to notice it. Meanwhile they are paused.
            edit_players(&mut self.app, |player| _ = player.pause_all());
            for _ in 0..3 {
                self.app.update();
            }
            assert_eq!(self.seconds(self.roots[0]), Some(0.0), "{name} starts at its beginning");
            edit_players(&mut self.app, |player| _ = player.resume_all());
            self.counts.clips += 1;
            for frame in 0..=frames {
                if frame > 0 {
                    self.app.update();
                }
                if frame % every == 0 {
                    self.compare(name, &format!("{file}, {name}, frame {frame}"));
                }
            }
            if most_frames > frames {
                let left = length - self.seconds(self.roots[0]).expect("it is played");
                assert!(left < 1.01 / 60.0, "{left} s of {name} were not played");
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
            self.counts.boxes += 1;
            self.counts.outgrown += check_box(&self.app, part, vertices, &self.meshes[part.mesh], when);
        }
        for _ in 0..12 {
            self.compare_a_ray(&all, (min, max), when);
        }
        self.compare_pairs(&all, when);
    }
}

/// The counts for a model.
fn compare_model(name: &str, apart: f32, every: usize, most_frames: usize) -> Option<Counts> {
    let (every, most_frames) = match std::env::var_os(EVERY_FRAME) {
        Some(_) => (1, usize::MAX),
        None => (every, most_frames),
    };
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
