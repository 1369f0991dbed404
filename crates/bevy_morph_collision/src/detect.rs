//! Which triangles intersect.

use bevy::platform::time::Instant;
use std::collections::BTreeMap;

use bevy::prelude::*;
use morph_collision::{BatchQuery, Body, PairMemory, PairTask, Pose, Remember, TrianglePair, Wanted};

use crate::bounds::Candidates;
use crate::collider::{ColliderState, CollisionMode, Placement};
use crate::diagnostics::MorphCollisionDiagnostics;
use crate::workers::TaskPoolWorkers;

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

/// What the narrow phase keeps for its memory.
#[derive(Default)]
pub(crate) struct Scratch {
    query: BatchQuery,
    /// Which colliders are asked about, and in which mode.
    asked: Vec<((Entity, Entity), CollisionMode)>,
    /// Of pairs that were asked for one pair of triangles: where it was. In the order of the pairs, and the next ones.
    memories: Vec<((Entity, Entity), PairMemory)>,
    next_memories: Vec<((Entity, Entity), PairMemory)>,
}

/// Asks for every candidate pair whether, and where, it touches: all pairs at once, on Bevy's threads.
///
/// A pair of which neither collider changed has the answer it had.
pub(crate) fn find_contacts(
    candidates: Res<Candidates>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    mut collisions: ResMut<MorphCollisions>,
    mut scratch: Local<Scratch>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let MorphCollisions { current, previous } = &mut *collisions;
    *previous = std::mem::take(current);
    let Scratch {
        query,
        asked,
        memories,
        next_memories,
    } = &mut *scratch;
    asked.clear();

    let mut placed: Vec<_> = colliders
        .iter_mut()
        .filter_map(|(entity, state)| Placed::new(entity, state.into_inner()))
        .collect();
    placed.sort_unstable_by_key(|collider| collider.entity);
    let place = |entity: Entity| placed.binary_search_by_key(&entity, |collider| collider.entity).ok();
    let mut places = Vec::new();
    for &(collider1, collider2) in &candidates.pairs {
        let (Some(a), Some(b)) = (place(collider1), place(collider2)) else {
            continue;
        };
        let pair = (collider1, collider2);
        if placed[a].changed || placed[b].changed {
            let mode = placed[a].placement.mode.max(placed[b].placement.mode);
            asked.push((pair, mode));
            places.push((a, b));
        } else if let Some(contact) = previous.get(&pair) {
            current.insert(pair, contact.clone());
        }
    }

    remember(asked, memories, next_memories);
    let mut left = memories.iter_mut();
    let mut tasks: Vec<_> = asked
        .iter()
        .zip(&places)
        .map(|(&(_, mode), &(a, b))| match mode {
            CollisionMode::All => PairTask::new(a, b, Wanted::All),
            CollisionMode::First | CollisionMode::Any => PairTask {
                memory: left.next().map(|(_, memory)| memory),
                ..PairTask::new(a, b, Wanted::First)
            },
        })
        .collect();
    let body_of = |place: usize| placed[place].placement.body;
    let bodies_of: Vec<_> = places.iter().map(|&(a, b)| (body_of(a), body_of(b))).collect();
    let mut bodies: Vec<_> = placed.into_iter().map(Placed::into_body).collect();
    let answers = query.run(&mut bodies, &mut tasks, &TaskPoolWorkers);
    diagnostics.stats += answers.stats;
    for ((found, &(pair, mode)), (body1, body2)) in answers.iter().zip(&*asked).zip(bodies_of) {
        if found.is_empty() {
            continue;
        }
        let mut triangles = match mode {
            CollisionMode::Any => Vec::new(),
            CollisionMode::First | CollisionMode::All => found.to_vec(),
        };
        triangles.sort_unstable();
        let contact = MorphContact {
            collider1: pair.0,
            collider2: pair.1,
            body1,
            body2,
            triangles,
            mode,
        };
        current.insert(pair, contact);
    }
    diagnostics.triangle_pairs += current
        .values()
        .map(|contact| contact.triangles.len() as u64)
        .sum::<u64>();
    diagnostics.touching_pairs = current.len() as u64;
    for (_, mut state) in &mut colliders {
        // What took part and is looked at from now on as it is; what did not will be new when it comes back.
        state.changed = state.placed.is_none();
    }
    diagnostics.duration += start.elapsed();
}

/// Makes `memories` those of the pairs that are asked for one pair of triangles, in their order: the ones there are, and new
/// ones. Both are sorted.
fn remember(
    asked: &[((Entity, Entity), CollisionMode)],
    memories: &mut Vec<((Entity, Entity), PairMemory)>,
    next: &mut Vec<((Entity, Entity), PairMemory)>,
) {
    let mut known = memories.drain(..).peekable();
    next.clear();
    for &(pair, _) in asked.iter().filter(|(_, mode)| *mode != CollisionMode::All) {
        while known.next_if(|(other, _)| *other < pair).is_some() {}
        let memory = known.next_if(|(other, _)| *other == pair);
        next.push(memory.unwrap_or_else(|| (pair, PairMemory::new(Remember::default()))));
    }
    drop(known);
    std::mem::swap(memories, next);
}

/// A collider that takes part.
struct Placed<'a> {
    entity: Entity,
    changed: bool,
    placement: &'a Placement,
    pose: &'a mut Pose,
}

impl<'a> Placed<'a> {
    fn new(entity: Entity, state: &'a mut ColliderState) -> Option<Self> {
        let ColliderState {
            pose, placed, changed, ..
        } = state;
        Some(Self {
            entity,
            changed: *changed,
            placement: placed.as_ref()?,
            pose: pose.as_mut()?,
        })
    }

    fn into_body(self) -> Body<'a> {
        Body::new(self.pose, &self.placement.world_from_model)
    }
}
