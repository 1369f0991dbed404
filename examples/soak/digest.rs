//! A hash of everything that was reported.

use std::fmt;

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::questions::ask;
use crate::stage::Stage;

/// Mixes 64 bits at a time, as `FxHash` does. Entities count with their bits: they are the same in every run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Digest(u64);

impl Digest {
    pub(crate) fn add(&mut self, bits: u64) {
        self.0 = (self.0.rotate_left(5) ^ bits).wrapping_mul(0x517c_c1b7_2722_0a95);
    }

    pub(crate) fn entity(&mut self, entity: Entity) {
        self.add(entity.to_bits());
    }

    pub(crate) fn float(&mut self, number: f32) {
        self.add(number.to_bits().into());
    }

    pub(crate) fn vector(&mut self, vector: Vec3) {
        vector.to_array().into_iter().for_each(|number| self.float(number));
    }

    fn pair(&mut self, pair: TrianglePair) {
        self.add(u64::from(pair.triangle_a) << 32 | u64::from(pair.triangle_b));
    }

    pub(crate) fn impact(&mut self, impact: Option<MorphImpact>) {
        self.add(u64::from(impact.is_some()));
        let Some(impact) = impact else { return };
        self.add(impact.earliest.to_bits());
        self.add(impact.latest.to_bits());
        [impact.point, impact.normal, impact.velocity]
            .into_iter()
            .for_each(|vector| self.vector(vector));
        impact.barycentrics.into_iter().for_each(|at| self.vector(at));
        self.add(impact.features as u64);
        self.pair(impact.triangles);
    }

    fn contact(&mut self, contact: &MorphContact) {
        self.entity(contact.collider1);
        self.entity(contact.collider2);
        self.add(contact.mode as u64);
        self.vector(contact.point);
        self.vector(contact.normal);
        self.float(contact.distance);
        contact.triangles.iter().for_each(|&pair| self.pair(pair));
        for point in &contact.points {
            self.vector(point.point);
            self.float(point.depth);
            self.pair(point.triangles);
        }
        self.impact(contact.impact);
    }

    /// Contacts, hits of casters, places of anchors, and answers to questions.
    pub(crate) fn add_frame(&mut self, stage: &mut Stage, question: u64) {
        let world = stage.app.world_mut();
        for contact in world.resource::<MorphCollisions>().iter() {
            self.contact(contact);
        }
        let mut placed = world.query_filtered::<&Transform, With<MorphSurfaceAnchor>>();
        // In no order that is promised.
        let places = placed.iter(world).map(|place| {
            let mut digest = Self::default();
            digest.vector(place.translation);
            place.rotation.to_array().into_iter().for_each(|x| digest.float(x));
            digest.0
        });
        let places = places.fold(0_u64, u64::wrapping_add);
        self.add(places);
        let mut hits = world.query::<AnyOf<(&MorphRayHits, &MorphShapeHits)>>();
        let hits = hits.iter(world).map(|(rays, shapes)| {
            let mut digest = Self::default();
            for hit in rays.iter().flat_map(|hits| hits.iter()) {
                digest.entity(hit.entity);
                digest.float(hit.distance);
            }
            for hit in shapes.iter().flat_map(|hits| hits.iter()) {
                digest.entity(hit.entity);
                digest.float(hit.distance);
                digest.vector(hit.point);
            }
            digest.0
        });
        let hits = hits.fold(0_u64, u64::wrapping_add);
        self.add(hits);
        // A system of ours whose parameters are always there.
        match world.run_system_cached_with(ask, question) {
            Ok(answers) => self.add(answers.0),
            Err(error) => error!("nothing could be asked: {error}"),
        }
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}
