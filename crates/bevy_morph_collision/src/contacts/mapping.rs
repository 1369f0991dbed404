//! Contacts of entities that have got other IDs.
//!
//! A rollback may spawn entities again. The order of two colliders may then be another one, and their contact is turned around.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::prelude::*;
use morph_collision::TrianglePair;

use super::body_pairs::BodyPairs;
use super::changes::Changes;
use super::collisions::MorphCollisions;
use super::contact::MorphContact;
use super::impact::MorphImpact;

/// The pair of the entities that these two have become, in ascending order.
pub(crate) fn map_pair((a, b): (Entity, Entity), mapper: &mut impl EntityMapper) -> (Entity, Entity) {
    let (a, b) = (mapper.get_mapped(a), mapper.get_mapped(b));
    (a.min(b), a.max(b))
}

/// The same for all pairs of a sorted list.
pub(crate) fn map_pairs(pairs: &mut [(Entity, Entity)], mapper: &mut impl EntityMapper) {
    pairs.iter_mut().for_each(|pair| *pair = map_pair(*pair, mapper));
    pairs.sort_unstable();
}

fn swapped(TrianglePair { triangle_a, triangle_b }: TrianglePair) -> TrianglePair {
    TrianglePair {
        triangle_a: triangle_b,
        triangle_b: triangle_a,
    }
}

impl MapEntities for MorphContact {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let entities = [
            &mut self.collider1,
            &mut self.collider2,
            &mut self.body1,
            &mut self.body2,
        ];
        entities.into_iter().for_each(|entity| entity.map_entities(mapper));
        if self.collider1 > self.collider2 {
            std::mem::swap(&mut self.collider1, &mut self.collider2);
            std::mem::swap(&mut self.body1, &mut self.body2);
            self.normal = -self.normal;
            self.impact = self.impact.map(MorphImpact::reversed);
            let of_points = self.points.iter_mut().map(|point| &mut point.triangles);
            let all = self.triangles.iter_mut().chain(of_points);
            all.for_each(|triangles| *triangles = swapped(*triangles));
            self.triangles.sort_unstable();
        }
    }
}

impl MapEntities for MorphCollisions {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.changes.map_entities(mapper);
        self.bodies.map_entities(mapper);
        let contacts: Vec<MorphContact> = std::mem::take(&mut self.current).into_values().collect();
        self.neighbours.clear();
        for mut contact in contacts {
            contact.map_entities(mapper);
            let (a, b) = contact.pair();
            self.current.insert((a, b), contact);
            self.neighbours.entry(a).or_default().insert(b);
            self.neighbours.entry(b).or_default().insert(a);
        }
    }
}

impl MapEntities for Changes {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        let (started, of_run) = self.started.split_at_mut(self.run.0);
        map_pairs(started, mapper);
        map_pairs(of_run, mapper);
        self.ended.iter_mut().for_each(|contact| contact.map_entities(mapper));
        let (ended, passed) = self.ended.split_at_mut(self.passed);
        for contacts in [&mut ended[self.run.1..], passed] {
            contacts.sort_unstable_by_key(MorphContact::pair);
        }
    }
}

impl MapEntities for BodyPairs {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        for list in [&mut self.now, &mut self.before, &mut self.passed, &mut self.touched] {
            for (bodies, colliders) in &mut *list {
                (*bodies, *colliders) = (map_pair(*bodies, mapper), map_pair(*colliders, mapper));
            }
            list.sort_unstable();
        }
        self.find_descending();
    }
}

#[cfg(test)]
mod tests {
    use bevy::ecs::entity::EntityHashMap;

    use super::*;
    use crate::components::MorphCollisionMode;
    use crate::contacts::{MorphContactPoint, MorphImpactFeatures};

    fn contact([a, b]: [Entity; 2]) -> MorphContact {
        let triangles = TrianglePair {
            triangle_a: 3,
            triangle_b: 7,
        };
        MorphContact {
            collider1: a,
            collider2: b,
            body1: a,
            body2: b,
            mode: MorphCollisionMode::Contacts,
            point: Vec3::ONE,
            normal: Vec3::X,
            distance: 0.0,
            triangles: vec![triangles],
            is_truncated: false,
            points: vec![MorphContactPoint {
                point: Vec3::ONE,
                depth: 0.5,
                triangles,
            }],
            impact: Some(MorphImpact {
                earliest: 0.25,
                latest: 0.5,
                point: Vec3::ONE,
                normal: Vec3::X,
                velocity: Vec3::NEG_X,
                features: MorphImpactFeatures::VertexFace,
                triangles,
                barycentrics: [Vec3::X, Vec3::Z],
            }),
        }
    }

    #[test]
    fn contacts_follow_their_colliders_and_turn_around_with_them() {
        let mut entities: Vec<Entity> = (1..5).filter_map(Entity::from_raw_u32).collect();
        entities.sort_unstable();
        let [a, b, c, d] = *entities.as_array().expect("four entities");
        let mut collisions = MorphCollisions::default();
        collisions.begin_run();
        collisions.touch(contact([a, b]));
        collisions.touch(contact([b, c]));
        collisions.end_run(vec![contact([a, c])]);
        // The lowest collider becomes the highest.
        let mut map = EntityHashMap::from_iter([(a, d), (b, b), (c, c)]);
        let before = collisions.clone();
        collisions.map_entities(&mut map);
        assert_eq!(collisions.get(b, c), before.get(b, c));
        assert!(!collisions.contains(a, b) && collisions.contains_bodies(b, d));
        let turned = collisions.get(b, d).expect("it is the contact of the first two");
        assert_eq!(
            (turned.collider1, turned.body2, turned.normal),
            (b, d, Vec3::NEG_X),
            "{turned:?}"
        );
        assert_eq!(
            (turned.triangles[0].triangle_a, turned.points[0].triangles.triangle_a),
            (7, 7)
        );
        let impact = turned.impact.expect("it has one");
        assert_eq!((impact.normal, impact.velocity), (Vec3::NEG_X, Vec3::X));
        assert_eq!(impact.features, MorphImpactFeatures::FaceVertex);
        assert_eq!(
            (impact.triangles.triangle_a, impact.barycentrics),
            (7, [Vec3::Z, Vec3::X])
        );
        let pairs: Vec<_> = collisions.started().map(MorphContact::pair).collect();
        assert_eq!(pairs, [(b, c), (b, d), (c, d)]);
        assert_eq!(collisions.ended().map(MorphContact::pair).collect::<Vec<_>>(), [(c, d)]);
        assert!(collisions.in_run((c, d)).is_some());
        assert_eq!(collisions.bodies_colliding_with(d).collect::<Vec<_>>(), [b]);
        assert_eq!(collisions.collisions_with(b).count(), 2);
    }
}
