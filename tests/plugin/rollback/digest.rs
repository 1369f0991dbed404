//! Hashes of everything that the plugin reports, with rows instead of entities.

use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::banks::Banks;

/// A hash (FNV-1a), and how much it is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Digest {
    hash: u64,
    count: u64,
}

impl Digest {
    pub(super) fn new() -> Self {
        Self {
            hash: 0xcbf2_9ce4_8422_2325,
            count: 0,
        }
    }

    pub(super) fn add(&mut self, bits: u64) {
        self.count += 1;
        for byte in bits.to_le_bytes() {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    pub(super) fn entities(&mut self, banks: &Banks, entities: impl IntoIterator<Item = Entity>) {
        let before = self.count;
        for entity in entities {
            self.add(banks.row(entity).into());
        }
        self.add(self.count - before);
    }

    pub(super) fn floats(&mut self, numbers: impl IntoIterator<Item = f32>) {
        for number in numbers {
            self.add(number.to_bits().into());
        }
    }

    fn pair(&mut self, pair: TrianglePair) {
        self.add(u64::from(pair.triangle_a) << 32 | u64::from(pair.triangle_b));
    }

    pub(super) fn impact(&mut self, impact: Option<MorphImpact>) {
        self.add(u64::from(impact.is_some()));
        let Some(impact) = impact else { return };
        self.add(impact.earliest.to_bits());
        self.add(impact.latest.to_bits());
        let vectors = [impact.point, impact.normal, impact.velocity];
        for vector in vectors.into_iter().chain(impact.barycentrics) {
            self.floats(vector.to_array());
        }
        self.add(impact.features as u64);
        self.pair(impact.triangles);
    }

    fn ray_hit(&mut self, banks: &Banks, hit: &MorphRayHit) {
        self.entities(banks, std::iter::once(hit.entity).chain(hit.joint));
        self.add(hit.triangle.into());
        self.floats([hit.distance]);
        self.floats(hit.normal.to_array());
    }

    fn shape_hit(&mut self, banks: &Banks, hit: &MorphShapeHit) {
        self.entities(banks, [hit.entity]);
        self.add(hit.triangle.into());
        self.floats([hit.distance]);
        self.floats(hit.point.to_array());
        self.floats(hit.normal.to_array());
    }

    fn contact(&mut self, banks: &Banks, contact: &MorphContact) {
        self.entities(
            banks,
            [contact.collider1, contact.collider2, contact.body1, contact.body2],
        );
        self.add(contact.mode as u64);
        self.floats(contact.point.to_array());
        self.floats(contact.normal.to_array());
        self.floats([contact.distance]);
        self.add(contact.is_truncated.into());
        self.add(contact.triangles.len() as u64);
        contact.triangles.iter().for_each(|&pair| self.pair(pair));
        self.add(contact.points.len() as u64);
        for point in &contact.points {
            self.floats(point.point.to_array());
            self.floats([point.depth]);
            self.pair(point.triangles);
        }
        self.impact(contact.impact);
    }
}

/// How many hits casters list.
pub(super) fn cast_hits(world: &World) -> usize {
    let alive = world.resource::<Banks>().rows.iter().flatten();
    let hits = |&entity: &Entity| {
        let rays = world.get::<MorphRayHits>(entity).map_or(0, |hits| hits.len());
        rays + world.get::<MorphShapeHits>(entity).map_or(0, |hits| hits.len())
    };
    alive.map(hits).sum()
}

/// The state after a run, as systems of the game see it: contacts, changes, lists, regions, and answers to rays.
pub(super) fn state(world: &mut World) -> Digest {
    let mut digest = Digest::new();
    let found: Digest = world.run_system_cached(ask).expect("the system runs");
    digest.add(found.hash);
    let banks = world.resource::<Banks>();
    let collisions = world.resource::<MorphCollisions>();
    for contacts in [
        collisions.iter().collect::<Vec<_>>(),
        collisions.started().collect(),
        collisions.ended().collect(),
    ] {
        digest.add(contacts.len() as u64);
        contacts.into_iter().for_each(|contact| digest.contact(banks, contact));
    }
    for entity in banks.rows.iter().flatten().map(|&entity| world.entity(entity)) {
        digest.entities(banks, collisions.bodies_colliding_with(entity.id()));
        if let Some(list) = entity.get::<MorphCollidingEntities>() {
            digest.entities(banks, list.iter().copied());
        }
        if let Some(hits) = entity.get::<MorphRayHits>() {
            digest.add(hits.len() as u64);
            hits.iter().for_each(|hit| digest.ray_hit(banks, hit));
        }
        if let Some(hits) = entity.get::<MorphShapeHits>() {
            digest.add(hits.len() as u64);
            hits.iter().for_each(|hit| digest.shape_hit(banks, hit));
        }
        if let Some(list) = entity.get::<MorphSelfCollisions>() {
            digest.add(list.is_truncated().into());
            digest.add(list.regions().len() as u64);
            for region in list.regions() {
                digest.add(region.region.into());
                digest.floats(region.point.to_array());
                digest.add(region.triangles.len() as u64);
                region.triangles.iter().for_each(|&pair| digest.pair(pair));
            }
        }
    }
    digest
}

/// Rays through the middle, and how fast what they hit moves.
fn ask(spatial: MorphSpatialQuery, banks: Res<Banks>) -> Digest {
    let mut digest = Digest::new();
    for direction in [Dir3::X, Dir3::Y, Dir3::NEG_Z] {
        let origin = Vec3::new(0.1, 0.2, -0.1) - 10.0 * *direction;
        for hit in spatial.ray_hits(origin, direction, 20.0, &MorphQueryFilter::default()) {
            digest.ray_hit(&banks, &hit);
            digest.floats(hit.velocity(&spatial).unwrap_or(Vec3::NAN).to_array());
        }
    }
    digest
}

/// Reads all messages.
#[derive(Default)]
pub(super) struct Reader {
    starts: MessageCursor<MorphCollisionStart>,
    ends: MessageCursor<MorphCollisionEnd>,
    body_starts: MessageCursor<MorphBodyCollisionStart>,
    body_ends: MessageCursor<MorphBodyCollisionEnd>,
    self_starts: MessageCursor<MorphSelfCollisionStart>,
    self_ends: MessageCursor<MorphSelfCollisionEnd>,
}

/// How much happened, to check that a test covers enough.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) starts: usize,
    pub(super) impacts: usize,
    pub(super) body_starts: usize,
    pub(super) self_starts: usize,
    pub(super) self_ends: usize,
    pub(super) observed: usize,
    pub(super) cast_hits: usize,
}

impl Reader {
    /// The messages since the last call, in order.
    pub(super) fn read(&mut self, world: &World, counts: &mut Counts) -> Digest {
        let (mut digest, banks) = (Digest::new(), world.resource::<Banks>());
        for end in self.ends.read(world.resource()) {
            digest.add(1);
            digest.entities(banks, [end.collider1, end.collider2, end.body1, end.body2]);
        }
        for start in self.starts.read(world.resource()) {
            counts.starts += 1;
            digest.add(2);
            counts.impacts += usize::from(start.impact.is_some());
            digest.entities(banks, [start.collider1, start.collider2, start.body1, start.body2]);
            digest.floats(start.point.to_array());
            digest.floats(start.normal.to_array());
            digest.impact(start.impact);
        }
        for end in self.body_ends.read(world.resource()) {
            digest.add(3);
            digest.entities(banks, [end.body1, end.body2]);
        }
        for start in self.body_starts.read(world.resource()) {
            counts.body_starts += 1;
            digest.add(4);
            digest.entities(banks, [start.body1, start.body2, start.collider1, start.collider2]);
            digest.floats(start.point.to_array());
            digest.floats(start.normal.to_array());
            digest.impact(start.impact);
        }
        for end in self.self_ends.read(world.resource()) {
            counts.self_ends += 1;
            digest.add(5);
            digest.entities(banks, [end.collider]);
            digest.add(end.region.into());
        }
        for start in self.self_starts.read(world.resource()) {
            counts.self_starts += 1;
            digest.add(6);
            digest.entities(banks, [start.collider]);
            digest.add(start.region.into());
            digest.floats(start.point.to_array());
        }
        digest
    }
}
