//! Which triangles intersect.

use bevy::platform::time::Instant;
use std::collections::BTreeMap;

use bevy::prelude::*;
use morph_collision::{Body, PairQuery, QueryStats, TrianglePair};

use crate::bounds::Candidates;
use crate::collider::{ColliderState, CollisionMode};
use crate::diagnostics::MorphCollisionDiagnostics;

/// The colliders that touch, as of the last run of [`NarrowPhase`](crate::MorphCollisionSystems::NarrowPhase).
#[derive(Resource, Debug, Default)]
pub struct MorphCollisions {
    current: Contacts,
    /// Those of the frame before.
    pub(crate) previous: Contacts,
}

type Contacts = BTreeMap<(Entity, Entity), MorphContact>;

/// Two colliders that touch, `collider1 < collider2`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MorphContact {
    /// The first collider.
    pub collider1: Entity,
    /// The second collider.
    pub collider2: Entity,
    /// The body of the first: its [`MorphBody`](crate::MorphBody), or itself.
    pub body1: Entity,
    /// The body of the second.
    pub body2: Entity,
    /// Intersecting triangles, `triangle_a` of `collider1` and `triangle_b` of `collider2`, sorted.
    ///
    /// How many are listed is up to the [`CollisionMode`]. A triangle's number is its place in the mesh's index buffer,
    /// divided by 3; in a triangle strip, its place among the triangles that name three different vertices.
    pub triangles: Vec<TrianglePair>,
    /// What was asked for.
    pub mode: CollisionMode,
}

impl MorphCollisions {
    /// The contacts, in ascending order of their colliders.
    pub fn iter(&self) -> impl Iterator<Item = &MorphContact> {
        self.current.values()
    }

    /// Whether two colliders touch; their order does not matter.
    #[must_use]
    pub fn contains(&self, a: Entity, b: Entity) -> bool {
        self.get(a, b).is_some()
    }

    /// The contact of two colliders; their order does not matter, the contact has its own.
    #[must_use]
    pub fn get(&self, a: Entity, b: Entity) -> Option<&MorphContact> {
        self.current.get(&(a.min(b), a.max(b)))
    }

    /// The number of contacts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.current.len()
    }

    /// Whether nothing touches.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.current.is_empty()
    }

    /// Contacts that are new in this frame.
    pub(crate) fn started(&self) -> impl Iterator<Item = &MorphContact> {
        only_in(&self.current, &self.previous)
    }

    /// Contacts of the frame before that are no more.
    pub(crate) fn ended(&self) -> impl Iterator<Item = &MorphContact> {
        only_in(&self.previous, &self.current)
    }
}

fn only_in<'a>(contacts: &'a Contacts, others: &'a Contacts) -> impl Iterator<Item = &'a MorphContact> {
    contacts
        .iter()
        .filter(|(pair, _)| !others.contains_key(pair))
        .map(|(_, contact)| contact)
}

/// Asks for every candidate pair whether, and where, it touches.
///
/// A pair of which neither collider changed has the answer it had.
pub(crate) fn find_contacts(
    candidates: Res<Candidates>,
    mut colliders: Query<&mut ColliderState>,
    mut collisions: ResMut<MorphCollisions>,
    mut query: Local<PairQuery>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let collisions = &mut *collisions;
    collisions.previous = std::mem::take(&mut collisions.current);
    for &(collider1, collider2) in &candidates.pairs {
        let Ok([mut a, mut b]) = colliders.get_many_mut([collider1, collider2]) else {
            continue;
        };
        let (a, b) = (&mut *a, &mut *b);
        let contact = if a.changed || b.changed {
            let (contact, stats) = contact(&mut query, (collider1, a), (collider2, b));
            diagnostics.stats += stats;
            contact
        } else {
            collisions.previous.get(&(collider1, collider2)).cloned()
        };
        if let Some(contact) = contact {
            diagnostics.triangle_pairs += contact.triangles.len() as u64;
            collisions.current.insert((collider1, collider2), contact);
        }
    }
    diagnostics.touching_pairs = collisions.current.len() as u64;
    for mut state in &mut colliders {
        // What took part and is looked at from now on as it is; what did not will be new when it comes back.
        state.changed = state.placed.is_none();
    }
    diagnostics.duration += start.elapsed();
}

/// The contact of two placed colliders, if they touch.
fn contact(
    query: &mut PairQuery,
    (collider1, a): (Entity, &mut ColliderState),
    (collider2, b): (Entity, &mut ColliderState),
) -> (Option<MorphContact>, QueryStats) {
    let (Some(pose_a), Some(at_a), Some(pose_b), Some(at_b)) = (&mut a.pose, &a.placed, &mut b.pose, &b.placed) else {
        return (None, QueryStats::default());
    };
    let mode = at_a.mode.max(at_b.mode);
    let body_a = Body::new(pose_a, &at_a.world_from_model);
    let body_b = Body::new(pose_b, &at_b.world_from_model);
    let mut triangles = Vec::new();
    let (touches, stats) = match mode {
        CollisionMode::All => {
            let stats = query.all(body_a, body_b, &mut triangles);
            triangles.sort_unstable();
            (!triangles.is_empty(), stats)
        }
        CollisionMode::First => {
            let (first, stats) = query.first(body_a, body_b);
            triangles.extend(first);
            (first.is_some(), stats)
        }
        CollisionMode::Any => query.any(body_a, body_b),
    };
    let contact = touches.then_some(MorphContact {
        collider1,
        collider2,
        body1: at_a.body,
        body2: at_b.body,
        triangles,
        mode,
    });
    (contact, stats)
}
