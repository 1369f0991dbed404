//! Real characters as they play their clips, against brute force over vertices that are morphed and skinned here, from the file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use bevy::animation::ActiveAnimation;
use bevy::camera::primitives::Aabb;
use bevy::ecs::system::RunSystemOnce;
use bevy::math::{Affine3A, DAffine3, DMat4, DVec3, Mat4};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::oracle::{intersecting_pairs, posed_vertices, skinned_vertices, world_vertices};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

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

    fn weights(&self, part: &Part) -> Vec<f32> {
        let world = self.app.world();
        match world.get::<MeshMorphWeights>(part.entity) {
            Some(MeshMorphWeights::Reference(source)) => world.get::<MorphWeights>(*source).unwrap().weights().to_vec(),
            Some(MeshMorphWeights::Value { weights }) => weights.clone(),
            None => Vec::new(),
        }
    }

    fn global(&self, entity: Entity) -> Affine3A {
        self.app.world().get::<GlobalTransform>(entity).unwrap().affine()
    }

    /// Where the vertices of a part's mesh are drawn: with the joints of the app, and everything else from the file.
    fn vertices(&self, part: &Part) -> Vec<DVec3> {
        let mesh = &self.meshes[part.mesh];
        let posed = posed_vertices(&mesh.positions, &mesh.targets, &self.weights(part));
        let Some(skin) = &mesh.skin else {
            return world_vertices(&posed, &self.global(part.entity));
        };
        let shown = self.app.world().get::<SkinnedMesh>(part.entity).expect("it has a skin");
        let matrices = shown.joints.iter().zip(&skin.skeleton.joints).map(|(&entity, joint)| {
            let matrix = Mat4::from(self.global(entity)) * joint.inverse_bind;
            Affine3A::from_mat4(matrix)
        });
        skinned_vertices(&posed, &skin.sets, &matrices.collect::<Vec<_>>())
    }

    /// The same by the file's own clip, evaluated here; `None` where that has ended.
    fn vertices_by_clip(&self, part: &Part, clip: &str) -> Option<Vec<DVec3>> {
        let mesh = &self.meshes[part.mesh];
        let skin = mesh.skin.as_ref()?;
        let seconds = self.seconds(part.root)?;
        let clip_of_joints = skin.skeleton.clip(clip);
        let clip_of_weights = mesh.animations.iter().find(|animation| animation.name == clip);
        let durations = [
            clip_of_joints.map(|clip| clip.duration()),
            clip_of_weights.map(|clip| clip.duration()),
        ];
        if durations.into_iter().flatten().any(|duration| seconds >= duration) {
            return None;
        }
        let weights = clip_of_weights.map_or_else(|| self.weights(part), |clip| clip.sample(seconds));
        let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
        let root = self.global(part.root);
        let joints = skin.skeleton.world_from_mesh(clip_of_joints, seconds);
        let joints: Vec<Affine3A> = joints.into_iter().map(|joint| root * joint).collect();
        Some(skinned_vertices(&posed, &skin.sets, &joints))
    }

    /// How far a clip has been played below a root.
    fn seconds(&self, root: Entity) -> Option<f32> {
        let world = self.app.world();
        let mut below = vec![root];
        while let Some(entity) = below.pop() {
            if let Some(player) = world.get::<AnimationPlayer>(entity) {
                return player
                    .playing_animations()
                    .next()
                    .map(|(_, active): (_, &ActiveAnimation)| active.seek_time());
            }
            below.extend(world.get::<Children>(entity).into_iter().flatten());
        }
        None
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

    /// A ray from outside to somewhere near a vertex.
    fn compare_a_ray(&mut self, all: &[Vec<DVec3>], (min, max): (DVec3, DVec3), when: &str) {
        let size = (max - min).max_element();
        let mut random = || DVec3::from_array(std::array::from_fn(|_| self.rng.random_range(-1.0..=1.0)));
        let origin = ((min + max) / 2.0 + random().normalize_or_zero() * 1.5 * size).as_vec3();
        let near = random() * 0.02 * size;
        let part = self.rng.random_range(0..all.len());
        let target = all[part][self.rng.random_range(0..all[part].len())] + near;
        let Ok(direction) = Dir3::new(target.as_vec3() - origin) else {
            return;
        };
        let cast = move |mut spatial: MorphSpatialQuery| {
            let filter = MorphQueryFilter::default();
            spatial.cast_ray(origin, direction, f32::INFINITY, &filter)
        };
        let hit = self.app.world_mut().run_system_once(cast).unwrap().unwrap();
        let mut first: Option<f64> = None;
        for (part, vertices) in self.parts.iter().zip(all) {
            for corners in &part.triangles {
                let corners = corners.map(|corner| vertices[corner as usize]);
                if let Some(distance) = meets(origin.as_dvec3(), direction.as_dvec3(), corners) {
                    first = Some(first.map_or(distance, |first| first.min(distance)));
                }
            }
        }
        self.counts.rays += 1;
        let (Some(hit), Some(first)) = (hit, first) else {
            assert!(
                hit.is_none() && first.is_none(),
                "{when}: {hit:?}, and by brute force {first:?}"
            );
            return;
        };
        self.counts.hits += 1;
        let off = (f64::from(hit.distance) - first).abs();
        assert!(off < 1e-5 * size, "{when}: {hit:?}, and by brute force at {first}");
        let at = self
            .parts
            .iter()
            .position(|part| part.entity == hit.entity)
            .expect("a part is hit");
        self.check_joint(&hit, at, when);
        let corners = self.parts[at].triangles[hit.triangle as usize].map(|corner| all[at][corner as usize]);
        let by_triangle = meets(origin.as_dvec3(), direction.as_dvec3(), corners);
        assert!(
            by_triangle.is_some_and(|distance| (distance - first).abs() < 1e-5 * size),
            "{when}: the ray misses the triangle of {hit:?}"
        );
    }

    /// The joint of a hit is the one with the largest weight there.
    fn check_joint(&mut self, hit: &MorphRayHit, part: usize, when: &str) {
        let part = &self.parts[part];
        let Some(skin) = &self.meshes[part.mesh].skin else {
            assert_eq!(hit.joint, None, "{when}");
            return;
        };
        let corners = part.triangles[hit.triangle as usize];
        let mut shares = BTreeMap::<u16, f64>::new();
        for (corner, share) in corners.into_iter().zip(hit.barycentrics.to_array()) {
            for set in &skin.sets {
                for (joint, weight) in set.joints[corner as usize]
                    .into_iter()
                    .zip(set.weights[corner as usize])
                {
                    *shares.entry(joint).or_default() += f64::from(share * weight);
                }
            }
        }
        let most = shares.values().copied().fold(0.0, f64::max);
        let joints = &self.app.world().get::<SkinnedMesh>(part.entity).unwrap().joints;
        let near_most = |(_, share): &(&u16, &f64)| **share >= most - 1e-5;
        let candidates: Vec<Entity> = shares
            .iter()
            .filter(near_most)
            .map(|(&joint, _)| joints[usize::from(joint)])
            .collect();
        assert!(
            hit.joint.is_some_and(|joint| candidates.contains(&joint)),
            "{when}: {hit:?}, {shares:?}"
        );
        self.counts.joints += 1;
    }

    /// Reported pairs of triangles of the two bodies are those of brute force.
    fn compare_pairs(&mut self, all: &[Vec<DVec3>], when: &str) {
        let mut expected = BTreeSet::new();
        for (a, of_a) in self
            .parts
            .iter()
            .zip(all)
            .filter(|(part, _)| part.root == self.roots[0])
        {
            for (b, of_b) in self
                .parts
                .iter()
                .zip(all)
                .filter(|(part, _)| part.root == self.roots[1])
            {
                let (near_a, near_b) = (near(a, of_a, extent(of_b)), near(b, of_b, extent(of_a)));
                let pick = |part: &Part, near: &[u32]| -> Vec<[u32; 3]> {
                    near.iter().map(|&triangle| part.triangles[triangle as usize]).collect()
                };
                for (t, u) in intersecting_pairs(of_a, &pick(a, &near_a), of_b, &pick(b, &near_b)) {
                    let (t, u) = (near_a[t as usize], near_b[u as usize]);
                    expected.insert(if a.entity < b.entity {
                        (a.entity, b.entity, t, u)
                    } else {
                        (b.entity, a.entity, u, t)
                    });
                }
            }
        }
        let collisions = self.app.world().resource::<MorphCollisions>();
        let mut found = BTreeSet::new();
        for contact in collisions.iter() {
            assert!(!contact.is_truncated && contact.body1 != contact.body2, "{when}");
            let pairs = contact.triangles.iter();
            found.extend(pairs.map(|p| (contact.collider1, contact.collider2, p.triangle_a, p.triangle_b)));
        }
        let (missed, invented) = (expected.difference(&found).count(), found.difference(&expected).count());
        assert!(
            missed == 0 && invented == 0,
            "{when}: {missed} pairs missed, {invented} invented"
        );
        self.counts.frames_that_touch += usize::from(!expected.is_empty());
        self.counts.triangle_pairs += expected.len();
    }
}

/// The box around points.
fn extent<'a>(points: impl IntoIterator<Item = &'a DVec3>) -> (DVec3, DVec3) {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points
        .into_iter()
        .fold(start, |(min, max), &p| (min.min(p), max.max(p)))
}

/// The triangles of a part whose boxes overlap another one.
fn near(part: &Part, vertices: &[DVec3], (min, max): (DVec3, DVec3)) -> Vec<u32> {
    let overlaps = |corners: &[u32; 3]| {
        let (low, high) = extent(corners.iter().map(|&corner| &vertices[corner as usize]));
        low.cmple(max).all() && high.cmpge(min).all()
    };
    let triangles = (0..).zip(&part.triangles);
    triangles
        .filter(|(_, corners)| overlaps(corners))
        .map(|(triangle, _)| triangle)
        .collect()
}

/// How far from its origin a ray meets a triangle, after Moeller and Trumbore.
fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    let from_a = origin - a;
    let u = from_a.dot(across) / determinant;
    let v = direction.dot(from_a.cross(ab)) / determinant;
    let distance = ac.dot(from_a.cross(ab)) / determinant;
    let is_hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0;
    is_hit.then_some(distance)
}

/// The `Aabb` that Bevy culls by holds all vertices that triangles use; returns how many are outside that of the rest pose, at the entity's own place.
fn check_box(app: &App, part: &Part, vertices: &[DVec3], mesh: &MorphMesh, when: &str) -> usize {
    let aabb = app.world().get::<Aabb>(part.entity).unwrap();
    let place = app.world().get::<GlobalTransform>(part.entity).unwrap().affine();
    let entity_from_world = DAffine3::from_mat4(DMat4::from_cols_array(
        &Mat4::from(place).to_cols_array().map(f64::from),
    ));
    let entity_from_world = entity_from_world.inverse();
    let (center, half) = (aabb.center.as_dvec3(), aabb.half_extents.as_dvec3());
    let used: BTreeSet<u32> = part.triangles.iter().flatten().copied().collect();
    let rest = extent(
        used.iter()
            .map(|&vertex| mesh.positions[vertex as usize].as_dvec3())
            .collect::<Vec<_>>()
            .iter(),
    );
    let mut outgrown = 0;
    for vertex in used {
        let p = entity_from_world.transform_point3(vertices[vertex as usize]);
        let holds = (p - center).abs().cmple(half).all();
        assert!(holds, "{when}: vertex {vertex} at {p} is not in {aabb:?}");
        outgrown += usize::from(p.cmplt(rest.0).any() || p.cmpgt(rest.1).any());
    }
    outgrown
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
