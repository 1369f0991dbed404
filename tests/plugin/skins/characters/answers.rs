//! Compares the plugin's answers with brute force.

use std::collections::{BTreeMap, BTreeSet};

use bevy::camera::primitives::Aabb;
use bevy::ecs::system::RunSystemOnce;
use bevy::math::{DAffine3, DMat4, DVec3, Mat4};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::intersecting_pairs;
use morph_collision_workspace::drawn::{extent, meets, near};
use rand::RngExt;

use super::{Part, Stage};

impl Stage {
    /// Casts a ray from outside to a point near a vertex.
    pub(super) fn compare_a_ray(&mut self, all: &[Vec<DVec3>], (min, max): (DVec3, DVec3), when: &str) {
        let size = (max - min).max_element();
        let mut random = || DVec3::from_array(std::array::from_fn(|_| self.rng.random_range(-1.0..=1.0)));
        let origin = ((min + max) / 2.0 + random().normalize_or_zero() * 1.5 * size).as_vec3();
        let near = random() * 0.02 * size;
        let part = self.rng.random_range(0..all.len());
        let target = all[part][self.rng.random_range(0..all[part].len())] + near;
        let Ok(direction) = Dir3::new(target.as_vec3() - origin) else {
            return;
        };
        let cast = move |spatial: MorphSpatialQuery| {
            let filter = MorphQueryFilter::default();
            spatial.cast_ray(origin, direction, f32::INFINITY, &filter)
        };
        let hit = self.app.world_mut().run_system_once(cast).unwrap();
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

    /// Checks that the joint of a hit is the one with the largest weight there.
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

    /// Checks that the reported pairs of triangles of the two bodies are those of brute force.
    pub(super) fn compare_pairs(&mut self, all: &[Vec<DVec3>], when: &str) {
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
                let (near_a, corners_a) = near(&a.triangles, of_a, extent(of_b));
                let (near_b, corners_b) = near(&b.triangles, of_b, extent(of_a));
                for (t, u) in intersecting_pairs(of_a, &corners_a, of_b, &corners_b) {
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

/// Checks that the `Aabb` used for culling contains all vertices of triangles. Returns how many of them are outside the rest
/// pose's box at the entity's own place.
pub(super) fn check_box(app: &App, part: &Part, vertices: &[DVec3], mesh: &MorphMesh, when: &str) -> usize {
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
