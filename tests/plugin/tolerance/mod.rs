//! Colliders with a tolerance. Answers are those of shapes displaced by at most the tolerance, checked by brute force over
//! vertices.

mod changes;
mod motion;

use bevy::math::{Affine3A, DVec3};
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_testkit::mesh::{InfluenceSet, MorphMesh};
use morph_collision_testkit::models::random::random_blob;
use morph_collision_testkit::oracle::{intersecting_pairs, posed_vertices, skinned_vertices, world_vertices};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::support::{add_mesh, app, bevy_mesh, diagnostics, settle};

/// The most frames that a collider may lag behind; in the movements below, none does for longer.
const MEMORY: usize = 60;

/// Colliders whose vertices are remembered frame by frame.
struct Judge {
    actors: Vec<Actor>,
    /// By actor, oldest first; empty while it takes no part in collisions.
    past: Vec<Vec<Vec<DVec3>>>,
    seen: Seen,
}

struct Actor {
    entity: Entity,
    mesh: MorphMesh,
    tolerance: f64,
    /// The joints and the influences, for a skinned mesh.
    skin: Option<([Entity; 2], InfluenceSet)>,
}

/// Counts of comparisons, to check that the test covers enough.
#[derive(Debug, Default)]
struct Seen {
    compared: usize,
    touching: usize,
    /// Answers that differ from those of the current shapes.
    other: usize,
    /// The largest distance of a vertex from where collisions may have seen it, relative to the tolerance.
    farthest: f64,
}

impl Actor {
    fn vertices(&self, world: &World) -> Option<Vec<DVec3>> {
        if world.get::<MorphColliderDisabled>(self.entity).is_some() {
            return None;
        }
        let global = |entity: Entity| -> Affine3A { world.get::<GlobalTransform>(entity).unwrap().affine() };
        let weights = match world.get::<MeshMorphWeights>(self.entity) {
            Some(MeshMorphWeights::Value { weights }) => weights.clone(),
            _ => vec![0.0; self.mesh.targets.len()],
        };
        let posed = posed_vertices(&self.mesh.positions, &self.mesh.targets, &weights);
        Some(match &self.skin {
            None => world_vertices(&posed, &global(self.entity)),
            Some((joints, set)) => skinned_vertices(&posed, std::slice::from_ref(set), &joints.map(global)),
        })
    }
}

fn farthest(before: &[DVec3], now: &[DVec3]) -> f64 {
    let moved = before.iter().zip(now).map(|(a, b)| a.distance(*b));
    moved.fold(0.0, f64::max)
}

impl Judge {
    fn new(actors: Vec<Actor>) -> Self {
        Self {
            past: vec![Vec::new(); actors.len()],
            actors,
            seen: Seen::default(),
        }
    }

    /// Checks the answers of a frame. They must be those of some moments at which no vertex was farther from its current place
    /// than the tolerance.
    fn judge(&mut self, app: &App, context: &str) {
        for (actor, past) in self.actors.iter().zip(&mut self.past) {
            match actor.vertices(app.world()) {
                Some(vertices) => past.push(vertices),
                None => past.clear(),
            }
            past.drain(..past.len().saturating_sub(MEMORY));
        }
        let near: Vec<Vec<&Vec<DVec3>>> = self
            .actors
            .iter()
            .zip(&self.past)
            .map(|(actor, past)| {
                let is_near =
                    |then: &&Vec<DVec3>| past.last().is_some_and(|now| farthest(then, now) <= actor.tolerance);
                past.iter().rev().filter(is_near).collect()
            })
            .collect();
        let collisions = app.world().resource::<MorphCollisions>();
        for (j, b) in self.actors.iter().enumerate() {
            for (i, a) in self.actors[..j].iter().enumerate() {
                let reported: Vec<(u32, u32)> = collisions.get(a.entity, b.entity).map_or(vec![], |contact| {
                    let pairs = contact
                        .triangles
                        .iter()
                        .map(|pair| match contact.collider1 == a.entity {
                            true => (pair.triangle_a, pair.triangle_b),
                            false => (pair.triangle_b, pair.triangle_a),
                        });
                    let mut pairs: Vec<_> = pairs.collect();
                    pairs.sort_unstable();
                    pairs
                });
                if near[i].is_empty() || near[j].is_empty() {
                    assert!(reported.is_empty(), "{context}: {i} and {j}: one of them is not there");
                    continue;
                }
                let moments = near[i]
                    .iter()
                    .flat_map(|of_a| near[j].iter().map(move |of_b| (*of_a, *of_b)));
                let answer = |(of_a, of_b): (&Vec<DVec3>, &Vec<DVec3>)| {
                    intersecting_pairs(of_a, &a.mesh.triangles, of_b, &b.mesh.triangles) == reported
                };
                let found = moments.clone().find(|&moment| answer(moment));
                let count = moments.count();
                let (of_a, of_b) = found.unwrap_or_else(|| {
                    let reported = reported.len();
                    panic!("{context}: {i} and {j}: none of {count} moments has these {reported} pairs of triangles")
                });
                self.seen.compared += 1;
                self.seen.touching += usize::from(!reported.is_empty());
                for (then, (now, actor)) in [(of_a, (near[i][0], a)), (of_b, (near[j][0], b))] {
                    if actor.tolerance > 0.0 {
                        self.seen.farthest = self.seen.farthest.max(farthest(then, now) / actor.tolerance);
                    }
                }
                self.seen.other += usize::from(!answer((near[i][0], near[j][0])));
            }
        }
    }
}

fn collider(tolerance: f32) -> MorphCollider {
    MorphCollider::default().with_tolerance(tolerance)
}

fn blob(seed: u64) -> MorphMesh {
    random_blob(seed, 2, 4, 0.4)
}

/// Blobs that morph and wander, with these tolerances.
fn blobs(app: &mut App, tolerances: &[f32]) -> Vec<Actor> {
    let spawn = |(seed, &tolerance): (u64, &f32)| {
        let mesh = blob(seed);
        let handle = add_mesh(app, &mesh);
        Actor {
            entity: app
                .world_mut()
                .spawn((Mesh3d(handle), Transform::default(), collider(tolerance)))
                .id(),
            mesh,
            tolerance: f64::from(tolerance),
            skin: None,
        }
    };
    (0..).zip(tolerances).map(spawn).collect()
}

/// Weights and places in a frame. Some of the colliders stand still now and then.
fn animate(app: &mut App, actors: &[Actor], frame: usize, rng: &mut Pcg64Mcg) {
    for (i, actor) in actors.iter().enumerate() {
        let phase = i as f32 * 1.7;
        let time = match (frame / 16 + i) % 5 {
            0 => (frame / 16 * 16) as f32 / 60.0,
            _ => frame as f32 / 60.0,
        };
        let weights = (0..actor.mesh.targets.len()).map(|k| 0.4 * (time * (1.0 + k as f32) + phase).sin());
        let weights = MeshMorphWeights::Value {
            weights: weights.collect(),
        };
        let at = Vec3::new(
            (0.9 * time + phase).sin(),
            (0.6 * time + 2.0 * phase).cos(),
            (phase * 3.0).sin(),
        ) * 1.1;
        let place = Transform::from_translation(at).with_rotation(Quat::from_rotation_y(0.5 * time + phase));
        app.world_mut().entity_mut(actor.entity).insert(weights);
        if actor.skin.is_none() {
            // Jumps to another place for a few frames.
            let jump = if rng.random_bool(0.02) {
                Vec3::X * 3.0
            } else {
                Vec3::ZERO
            };
            app.world_mut()
                .entity_mut(actor.entity)
                .insert(place.with_translation(at + jump));
        } else if let Some((joints, _)) = &actor.skin {
            for (k, &joint) in joints.iter().enumerate() {
                let turn = Quat::from_rotation_z(0.4 * (time * 2.0 + phase + k as f32).sin());
                let at = at + turn * Vec3::X * (k as f32 - 0.5) * 0.2;
                app.world_mut()
                    .entity_mut(joint)
                    .insert(Transform::from_translation(at).with_rotation(turn));
            }
        }
    }
}

#[test]
fn answers_are_exact_for_shapes_displaced_by_no_more_than_their_tolerances() {
    for (seed, tolerances) in [[0.0, 0.02, 0.04, 0.1], [0.05; 4], [0.3; 4]].into_iter().enumerate() {
        let mut app = app();
        let mut rng = Pcg64Mcg::seed_from_u64(seed as u64);
        let actors = blobs(&mut app, &tolerances);
        animate(&mut app, &actors, 0, &mut rng);
        settle(&mut app);
        let mut judge = Judge::new(actors);
        judge.judge(&app, &format!("{tolerances:?}, at first"));
        let mut held = 0;
        for frame in 1..150 {
            animate(&mut app, &judge.actors, frame, &mut rng);
            // Some are disabled for a while.
            let gone = judge.actors[frame % 4].entity;
            let mut gone = app.world_mut().entity_mut(gone);
            match rng.random_range(0..12) {
                0 => {
                    gone.insert(MorphColliderDisabled);
                }
                1..5 => {
                    gone.remove::<MorphColliderDisabled>();
                }
                _ => {}
            }
            app.update();
            held += diagnostics(&app).held_colliders;
            judge.judge(&app, &format!("{tolerances:?}, frame {frame}"));
        }
        let seen = judge.seen;
        assert!(seen.compared > 300 && seen.touching > 100, "{tolerances:?}: {seen:?}");
        assert!(seen.other > 30 && held > 100, "{tolerances:?}: {held} held, {seen:?}");
        assert!(seen.farthest > 0.3 && seen.farthest <= 1.0, "{tolerances:?}: {seen:?}");
    }
}

#[test]
fn answers_about_skinned_meshes_are_too() {
    let mut app = app();
    let mut rng = Pcg64Mcg::seed_from_u64(77);
    let mut actors = blobs(&mut app, &[0.05, 0.03]);
    for (seed, tolerance) in [(5, 0.05), (6, 0.02)] {
        let mesh = blob(seed);
        let share = |p: &Vec3| (0.5 + p.x).clamp(0.0, 1.0);
        let set = InfluenceSet {
            joints: vec![[0, 1, 0, 0]; mesh.positions.len()],
            weights: mesh
                .positions
                .iter()
                .map(|p| [1.0 - share(p), share(p), 0.0, 0.0])
                .collect(),
        };
        let skinned = bevy_mesh(&mesh)
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_JOINT_INDEX,
                VertexAttributeValues::Uint16x4(set.joints.clone()),
            )
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, set.weights.clone());
        let world = app.world_mut();
        let skinned = world.resource_mut::<Assets<Mesh>>().add(skinned);
        let poses = SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2]);
        let inverse_bindposes = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>().add(poses);
        let joints = [(); 2].map(|()| world.spawn(Transform::default()).id());
        let skin = SkinnedMesh {
            inverse_bindposes,
            joints: joints.to_vec(),
        };
        let entity = world
            .spawn((Mesh3d(skinned), skin, Transform::default(), collider(tolerance)))
            .id();
        actors.push(Actor {
            entity,
            mesh,
            tolerance: f64::from(tolerance),
            skin: Some((joints, set)),
        });
    }
    animate(&mut app, &actors, 0, &mut rng);
    settle(&mut app);
    let mut judge = Judge::new(actors);
    judge.judge(&app, "at first");
    for frame in 1..150 {
        animate(&mut app, &judge.actors, frame, &mut rng);
        app.update();
        judge.judge(&app, &format!("frame {frame}"));
    }
    let seen = judge.seen;
    assert!(seen.touching > 100 && seen.other > 30, "{seen:?}");
    assert!(seen.farthest > 0.3 && seen.farthest <= 1.0, "{seen:?}");
}
