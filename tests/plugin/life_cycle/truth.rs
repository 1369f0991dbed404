//! The expected reports, computed from components, the definition of a vertex and brute force.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use bevy::math::{Affine3A, DVec3};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, world_vertices};

use super::{Zoo, intersecting_pairs};

type Pair = (Entity, Entity);

/// Intersecting triangles, ascending.
type Triangles = Arc<Vec<(u32, u32)>>;

/// The expected content of a report about a pair.
#[derive(Clone)]
pub(super) enum Touching {
    /// Two meshes: the mode, the bodies, and all intersecting triangles.
    Meshes(MorphCollisionMode, [Entity; 2], Triangles),
    /// A mesh and a ball.
    Ball([Entity; 2]),
    /// A mesh and a ball whose distance is too close to the radius to decide in rounded arithmetic.
    Unsure,
}

#[derive(Default)]
pub(super) struct Truth {
    /// The current weights of each mesh that collides.
    in_force: HashMap<Entity, (AssetId<Mesh>, Vec<f32>)>,
    /// Pairs that should be reported, as of the last run.
    pub(super) touching: BTreeMap<Pair, Touching>,
    /// Number of pairs compared in the last run.
    pub(super) compared: usize,
    /// Vertices and answers of the last run, so that only changes are compared again.
    known: HashMap<Entity, Arc<Solid>>,
    answers: HashMap<Pair, (Arc<Solid>, Arc<Solid>, Triangles)>,
}

/// A mesh in world space.
#[derive(PartialEq)]
struct Solid {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// A collider that takes part in collisions.
struct Present {
    entity: Entity,
    body: Entity,
    mode: MorphCollisionMode,
    layers: MorphCollisionLayers,
    form: Form,
}

enum Form {
    Mesh(Arc<Solid>),
    Ball { center: DVec3, radius: f64 },
}

impl Truth {
    /// Computes the expected reports after a frame. While collisions are paused nothing changes.
    pub(super) fn update(&mut self, zoo: &mut Zoo) {
        if zoo.is_paused() {
            return;
        }
        let present = self.present(zoo);
        self.touching.clear();
        self.compared = 0;
        let mut answers = HashMap::new();
        for (j, b) in present.iter().enumerate() {
            for a in &present[..j] {
                let asked = a.mode.max(b.mode);
                let compared =
                    a.body != b.body && a.layers.interacts_with(b.layers) && asked != MorphCollisionMode::Passive;
                if !compared {
                    continue;
                }
                let (pair, bodies) = ((a.entity, b.entity), [a.body, b.body]);
                let touching = match (&a.form, &b.form) {
                    (Form::Mesh(of_a), Form::Mesh(of_b)) => {
                        let found = self.answer(pair, of_a, of_b);
                        answers.insert(pair, (of_a.clone(), of_b.clone(), found.clone()));
                        (!found.is_empty()).then_some(Touching::Meshes(asked, bodies, found))
                    }
                    (Form::Mesh(solid), &Form::Ball { center, radius })
                    | (&Form::Ball { center, radius }, Form::Mesh(solid)) => {
                        ball_touches(solid, center, radius, bodies)
                    }
                    (Form::Ball { .. }, Form::Ball { .. }) => continue,
                };
                self.compared += 1;
                if let Some(touching) = touching {
                    self.touching.insert(pair, touching);
                }
            }
        }
        self.answers = answers;
    }

    fn answer(&self, pair: Pair, a: &Arc<Solid>, b: &Arc<Solid>) -> Triangles {
        match self.answers.get(&pair) {
            Some((of_a, of_b, known)) if Arc::ptr_eq(of_a, a) && Arc::ptr_eq(of_b, b) => known.clone(),
            _ => Arc::new(intersecting_pairs(&a.vertices, &a.triangles, &b.vertices, &b.triangles)),
        }
    }

    /// Every collider that takes part, in ascending order of entities.
    fn present(&mut self, zoo: &mut Zoo) -> Vec<Present> {
        let Zoo { app, meshes, .. } = zoo;
        let world = app.world_mut();
        let mut colliders = world.query::<(
            Entity,
            &MorphCollider,
            &MorphCollisionLayers,
            &GlobalTransform,
            Option<&MorphColliderOf>,
            Option<&Mesh3d>,
            Option<&MorphShape>,
            Option<&MeshMorphWeights>,
            Has<MorphColliderDisabled>,
        )>();
        let mut sources = world.query::<&MorphWeights>();
        let mut present = Vec::new();
        let mut seen = HashMap::new();
        for (entity, collider, layers, place, of, mesh, shape, weights, is_disabled) in colliders.iter(world) {
            let mesh = mesh.and_then(|mesh| Some((mesh.id(), meshes.get(&mesh.id())?.as_ref()?)));
            if let Some((id, mesh)) = mesh {
                let given = match weights {
                    Some(MeshMorphWeights::Value { weights }) => Some(weights.clone()),
                    Some(&MeshMorphWeights::Reference(source)) => sources
                        .get(world, source)
                        .ok()
                        .map(|weights| weights.weights().to_vec()),
                    None => Some(vec![0.0; mesh.targets.len()]),
                };
                seen.insert(entity, (id, self.weights_in_force(entity, mesh, given)));
            }
            let affine = place.affine();
            if is_disabled || !affine.is_finite() {
                continue;
            }
            let form = match (shape, mesh) {
                (Some(&MorphShape::Ball { radius }), _) => ball(&affine, radius),
                (Some(_), _) => unreachable!("only balls are spawned"),
                (None, Some((_, mesh))) => {
                    let (_, weights) = &seen[&entity];
                    Form::Mesh(self.solid(entity, mesh, weights, &affine))
                }
                (None, None) => continue,
            };
            present.push(Present {
                entity,
                body: of.map_or(entity, |of| of.body),
                mode: collider.mode,
                layers: *layers,
                form,
            });
        }
        // Colliders on disabled entities keep their weights.
        for (entity, before) in self.in_force.drain() {
            let is_away = world.get::<bevy::ecs::entity_disabling::Disabled>(entity).is_some();
            if is_away && world.get::<MorphCollider>(entity).is_some() {
                seen.entry(entity).or_insert(before);
            }
        }
        self.in_force = seen;
        present.sort_by_key(|collider| collider.entity);
        present
    }

    /// The given weights if they are usable, otherwise the last good ones. A mesh with a different number of targets starts at
    /// rest.
    fn weights_in_force(&self, entity: Entity, mesh: &MorphMesh, given: Option<Vec<f32>>) -> Vec<f32> {
        let targets = mesh.targets.len();
        let fit = |weights: &Vec<f32>| weights.len() == targets && weights.iter().all(|weight| weight.is_finite());
        let before = self.in_force.get(&entity).map(|(_, weights)| weights.clone());
        given
            .filter(fit)
            .or_else(|| before.filter(fit))
            .unwrap_or_else(|| vec![0.0; targets])
    }

    fn solid(&mut self, entity: Entity, mesh: &MorphMesh, weights: &[f32], place: &Affine3A) -> Arc<Solid> {
        let posed = posed_vertices(&mesh.positions, &mesh.targets, weights);
        let now = Solid {
            vertices: world_vertices(&posed, place),
            triangles: mesh.triangles.clone(),
        };
        match self.known.get(&entity) {
            Some(known) if **known == now => known.clone(),
            _ => {
                let now = Arc::new(now);
                self.known.insert(entity, now.clone());
                now
            }
        }
    }

    /// Compares the plugin's reports with the expected ones; returns the number of triangle pairs that it lists.
    pub(super) fn check(&self, app: &App, context: &str) -> usize {
        let collisions = app.world().resource::<MorphCollisions>();
        let limit = app.world().resource::<MorphCollisionSettings>().max_triangle_pairs;
        let mut listed = 0;
        for (&(a, b), touching) in &self.touching {
            let contact = collisions.get(a, b);
            let (bodies, triangles) = match touching {
                Touching::Unsure => continue,
                Touching::Ball(bodies) => (bodies, None),
                Touching::Meshes(mode, bodies, triangles) => (bodies, Some((mode, triangles))),
            };
            let contact = contact.unwrap_or_else(|| {
                let [a, b] = [a, b].map(|entity| describe(app.world(), entity));
                panic!("{context}: these touch, and are not reported:\n{a}\n{b}")
            });
            assert_eq!([contact.body1, contact.body2], *bodies, "{context}");
            let Some((mode, triangles)) = triangles else { continue };
            assert_eq!(contact.mode, *mode, "{context}");
            let found: Vec<_> = contact
                .triangles
                .iter()
                .map(|pair| (pair.triangle_a, pair.triangle_b))
                .collect();
            listed += found.len();
            match mode {
                MorphCollisionMode::All | MorphCollisionMode::Contacts => {
                    let all = triangles.len();
                    assert_eq!(
                        contact.is_truncated,
                        all > limit,
                        "{context}: {a} and {b} have {all} pairs"
                    );
                    assert_eq!(found.len(), all.min(limit), "{context}: {a} and {b}");
                    let is_there = |pair| triangles.binary_search(pair).is_ok();
                    assert!(
                        found.is_sorted_by(|x, y| x < y) && found.iter().all(is_there),
                        "{context}: {a} and {b}"
                    );
                }
                MorphCollisionMode::First => {
                    assert!(
                        found.len() == 1 && triangles.contains(&found[0]),
                        "{context}: {a} and {b}"
                    );
                }
                MorphCollisionMode::Passive => {
                    assert!(found.is_empty(), "{context}: {a} and {b}");
                }
            }
        }
        for contact in collisions.iter() {
            let pair = (contact.collider1, contact.collider2);
            check_neighbours(collisions, contact, context);
            assert!(
                self.touching.contains_key(&pair),
                "{context}: these are reported, and do not touch:\n{}\n{}",
                describe(app.world(), pair.0),
                describe(app.world(), pair.1),
            );
        }
        listed
    }
}

/// What is found by adjacency is what a look at all contacts finds.
fn check_neighbours(collisions: &MorphCollisions, contact: &MorphContact, context: &str) {
    for (collider, body) in [(contact.collider1, contact.body1), (contact.collider2, contact.body2)] {
        let of_collider = collisions.iter().filter(|contact| contact.other(collider).is_some());
        assert!(
            collisions.collisions_with(collider).eq(of_collider),
            "{context}: contacts of {collider}"
        );
        let of_body = |contact: &&MorphContact| contact.body1 == body || contact.body2 == body;
        let of_body: Vec<&MorphContact> = collisions.iter().filter(of_body).collect();
        assert!(
            collisions.collisions_with_body(body).eq(of_body.iter().copied()),
            "{context}: contacts of {body}"
        );
        let others = of_body.iter().map(|contact| {
            if contact.body1 == body {
                contact.body2
            } else {
                contact.body1
            }
        });
        let mut others: Vec<Entity> = others.collect();
        others.sort_unstable();
        others.dedup();
        assert!(
            collisions.bodies_colliding_with(body).eq(others),
            "{context}: bodies at {body}"
        );
    }
}

/// A description of an entity for messages.
fn describe(world: &World, entity: Entity) -> String {
    let components = world.inspect_entity(entity).map(|components| {
        let names = components.map(|(_, component)| component.name().shortname().to_string());
        names.collect::<Vec<_>>().join(" ")
    });
    let place = world.get::<GlobalTransform>(entity);
    let shows = (world.get::<Mesh3d>(entity), world.get::<MorphShape>(entity));
    let collides = (
        world.get::<MorphCollider>(entity),
        world.get::<MorphCollisionLayers>(entity),
    );
    let weights = (
        world.get::<MeshMorphWeights>(entity),
        world.get::<MorphColliderOf>(entity),
    );
    format!("{entity}: {components:?} {place:?} {shows:?} {collides:?} {weights:?}")
}

/// A ball placed by a transform; the largest scale applies to the radius.
fn ball(place: &Affine3A, radius: f32) -> Form {
    let axes = [place.matrix3.x_axis, place.matrix3.y_axis, place.matrix3.z_axis];
    let scale = axes
        .map(|axis| Vec3::from(axis).as_dvec3().length())
        .into_iter()
        .fold(0.0, f64::max);
    Form::Ball {
        center: Vec3::from(place.translation).as_dvec3(),
        radius: f64::from(radius) * scale,
    }
}

fn ball_touches(solid: &Solid, center: DVec3, radius: f64, bodies: [Entity; 2]) -> Option<Touching> {
    let distances = solid.triangles.iter().map(|corners| {
        let corners = corners.map(|corner| solid.vertices[corner as usize]);
        distance_to_triangle(center, corners)
    });
    let distance = distances.fold(f64::INFINITY, f64::min);
    let reach = solid
        .vertices
        .iter()
        .fold(center.length() + radius, |reach, v| reach.max(v.length()));
    match distance - radius {
        // The plugin scales a ball in `f32`, this test in `f64`.
        gap if gap.abs() <= 1e-4 * reach => Some(Touching::Unsure),
        gap => (gap < 0.0).then_some(Touching::Ball(bodies)),
    }
}

/// The distance from a point to a triangle: to its plane if the foot point is inside, otherwise to its edges.
fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_edge = |from: DVec3, to: DVec3| {
        let along = to - from;
        let t = (p - from).dot(along) / along.length_squared();
        let t = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
        p.distance(from + along * t)
    };
    let edges = to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let is_left = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && is_left(a, b) && is_left(b, c) && is_left(c, a) {
        return edges.min((p - a).dot(normal).abs());
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_triangle() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(distance_to_triangle(DVec3::new(0.25, 0.25, -2.0), triangle), 2.0);
        assert_eq!(distance_to_triangle(DVec3::new(0.5, -3.0, 0.0), triangle), 3.0);
        assert_eq!(distance_to_triangle(DVec3::new(-3.0, -4.0, 0.0), triangle), 5.0);
        assert_eq!(distance_to_triangle(DVec3::new(0.0, 0.0, 1.0), [DVec3::ZERO; 3]), 1.0);
    }
}
