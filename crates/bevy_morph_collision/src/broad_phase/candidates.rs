//! Places colliders in the world and finds pairs that are close enough to compare.

use bevy::ecs::entity::{EntityMapper, MapEntities};
use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::Aabb;
use tracing::debug_span;

use super::placing::{Participant, ParticipantItem, ParticipantReadOnlyItem};
use super::sweep::Sweep;
use super::swept_pairs::SweptPairs;
use super::teleports::Teleports;
use super::visits::{Visited, Visits};
use crate::app::{MorphCollisionSystems, Names};
use crate::contacts::map_pairs;
use crate::state::{ColliderNews, ColliderState, MorphCollisionDiagnostics, Moved, Placement, Runs, Skip};

/// Pairs for the narrow phase. Each pair is in ascending order of entities, and the list is sorted.
#[derive(Resource, Default)]
pub(crate) struct Candidates {
    pub(crate) pairs: Vec<(Entity, Entity)>,
    /// Pairs to compare on their way from the last run, whether or not they are in `pairs`.
    pub(crate) swept: SweptPairs,
    // Kept to reuse memory, and for runs without changes.
    colliders: Vec<(Entity, Placement)>,
    /// The colliders in the order of the query, with their indices in `colliders`. As long as the query returns the same entities
    /// in the same order, nothing is sorted.
    indices: Vec<(Entity, u32)>,
    /// Scratch memory for sorting.
    order: Vec<(Entity, u32)>,
    bounds: Vec<Aabb>,
    sweep: Sweep,
    overlaps: Vec<(u32, u32)>,
    counts: Counts,
    tally: Tally,
}

/// What later runs depend on of [`Candidates`].
#[derive(Clone, Default)]
pub(crate) struct CandidatesMemory {
    pairs: Vec<(Entity, Entity)>,
    colliders: Vec<(Entity, Placement)>,
    counts: Counts,
}

impl MapEntities for CandidatesMemory {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        map_pairs(&mut self.pairs, mapper);
        for (entity, placed) in &mut self.colliders {
            entity.map_entities(mapper);
            placed.map_entities(mapper);
        }
        self.colliders.sort_unstable_by_key(|(entity, _)| *entity);
    }
}

/// How many colliders there are.
#[derive(Default)]
struct Tally {
    /// Those that take part.
    present: usize,
    /// Those among them that are continuous.
    continuous: usize,
    /// Those that collisions see in an earlier state.
    held: u64,
}

impl Tally {
    fn add(&mut self, state: &ColliderState) {
        self.present += usize::from(state.placed.is_some());
        self.continuous += usize::from(state.placed.as_ref().is_some_and(|placed| placed.continuous));
        self.held += u64::from(state.freshness.is_held_back());
    }

    fn remove(&mut self, state: &ColliderState) {
        self.present -= usize::from(state.placed.is_some());
        self.continuous -= usize::from(state.placed.as_ref().is_some_and(|placed| placed.continuous));
        self.held -= u64::from(state.freshness.is_held_back());
    }
}

/// What happened to overlapping pairs.
#[derive(Clone, Copy, Default)]
struct Counts {
    overlaps: u64,
    same_body: u64,
    layers: u64,
    passive: u64,
    rigid: u64,
    nodes: u64,
}

/// Places all colliders and pairs those of different bodies whose world-space bounds overlap.
///
/// This refits only the root box of each tree, and only if something changed. A collider with a transform that is not finite is
/// left out and logged once, until the transform is finite again. Transforms of skinned meshes do not matter.
pub(crate) fn find_candidates(
    mut colliders: Query<Participant>,
    mut visits: Visits,
    mut news: ResMut<ColliderNews>,
    names: Names,
    mut teleports: Teleports,
    mut candidates: ResMut<Candidates>,
    mut runs: ResMut<Runs>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::broad_phase").entered();
    let candidates = &mut *candidates;
    let (mut changed, mut any_moved) = (false, false);
    let mut reposed = std::mem::take(&mut news.reposed);
    let mut visited = visits.find(&reposed);
    if std::mem::take(&mut news.is_restored) {
        visited = Visited::All { are_same: false };
    }
    runs.begin(!matches!(visited, Visited::All { are_same: false }));
    let mut visit = |participant: &mut ParticipantItem| {
        let visit = participant.visit(&runs, &names, &mut diagnostics);
        changed |= visit.changed;
        any_moved |= visit.moved;
    };
    let tally = &mut candidates.tally;
    match visited {
        Visited::All { .. } => {
            *tally = Tally::default();
            for mut participant in &mut colliders {
                visit(&mut participant);
                tally.add(&participant.state);
            }
        }
        Visited::Some(entities) => {
            for &entity in entities {
                if let Ok(mut participant) = colliders.get_mut(entity) {
                    tally.remove(&participant.state);
                    visit(&mut participant);
                    tally.add(&participant.state);
                }
            }
        }
    }
    // Their state differs from the one before this run.
    news.moved = match visited {
        Visited::Some(entities) => Moved::Some(entities.to_vec()),
        Visited::All { .. } if any_moved || !reposed.is_empty() => Moved::All,
        Visited::All { .. } => Moved::default(),
    };
    reposed.clear();
    news.reposed = reposed;
    diagnostics.held_colliders = tally.held;
    let any_continuous = tally.continuous > 0;
    runs.placed(changed || tally.present != candidates.colliders.len(), any_moved);
    let elsewhere = teleports.take();
    let is_interrupted = runs.take_interruption();
    candidates.swept.clear();
    let any_way = any_continuous && !is_interrupted && runs.any_changed();
    if any_way {
        candidates.swept.remember(&candidates.colliders);
    }
    if runs.any_changed() {
        candidates.find_pairs(&colliders);
    }
    if any_way {
        candidates.swept.find(&candidates.colliders, &elsewhere);
    }

    let Counts {
        overlaps,
        same_body,
        layers,
        passive,
        rigid,
        nodes,
    } = candidates.counts;
    diagnostics.nodes_total = nodes;
    diagnostics.colliders = candidates.colliders.len() as u64;
    diagnostics.overlapping_pairs = overlaps;
    diagnostics.skipped_same_body = same_body;
    diagnostics.skipped_layers = layers;
    diagnostics.skipped_passive = passive;
    diagnostics.skipped_rigid = rigid;
    diagnostics.candidate_pairs = candidates.pairs.len() as u64;
    diagnostics.spend(MorphCollisionSystems::BroadPhase, start.elapsed());
}

impl Candidates {
    pub(crate) fn memory(&self) -> CandidatesMemory {
        CandidatesMemory {
            pairs: self.pairs.clone(),
            colliders: self.colliders.clone(),
            counts: self.counts,
        }
    }

    /// Goes back to an earlier run.
    pub(crate) fn restore(&mut self, memory: CandidatesMemory) {
        self.pairs = memory.pairs;
        self.swept.clear();
        self.colliders = memory.colliders;
        // If the query has another order, they are sorted.
        self.indices.clear();
        let entities = self.colliders.iter().map(|(entity, _)| *entity);
        self.indices.extend(entities.zip(0..));
        self.counts = memory.counts;
    }

    /// The colliders that took part in the last run, ascending, in the state that collisions see.
    pub(crate) fn colliders(&self) -> &[(Entity, Placement)] {
        &self.colliders
    }

    /// The body of a collider that took part in the last run.
    pub(super) fn body_of(&self, collider: Entity) -> Entity {
        let index = self.colliders.binary_search_by_key(&collider, |&(entity, _)| entity);
        index.map_or(collider, |index| self.colliders[index].1.body)
    }

    /// Copies the placements of all colliders that take part. Returns `false` if they are not the same colliders in the same order
    /// as before.
    fn copy_placements(&mut self, colliders: &Query<Participant>) -> bool {
        self.counts.nodes = 0;
        let mut indices = self.indices.iter();
        for participant in colliders {
            let Some(placed) = participant.state.seen_as() else {
                continue;
            };
            match indices.next() {
                Some(&(entity, index)) if entity == participant.entity => {
                    self.colliders[index as usize].1 = placed.clone();
                }
                _ => return false,
            }
            let pose = participant.state.pose.as_ref();
            self.counts.nodes += pose.map_or(0, |pose| pose.lock().bvh().node_count() as u64);
        }
        indices.next().is_none()
    }

    /// Sorts the colliders that take part. Placements are large, so they are not sorted themselves.
    fn sort(&mut self, colliders: &Query<Participant>) {
        let takes_part = |participant: &ParticipantReadOnlyItem| participant.state.seen_as().is_some();
        let entities = colliders
            .iter()
            .filter(takes_part)
            .map(|participant| participant.entity);
        self.order.clear();
        self.order.extend(entities.zip(0..));
        self.indices.clone_from(&self.order);
        self.order.sort_unstable();
        self.colliders.clear();
        for (&(entity, order), index) in self.order.iter().zip(0..) {
            self.indices[order as usize].1 = index;
            let participant = colliders.get(entity).ok();
            let placed = participant.and_then(|participant| participant.state.seen_as().cloned());
            self.colliders.extend(placed.map(|placed| (entity, placed)));
        }
    }

    /// Finds the pairs of boxes that overlap, and those among them to compare.
    fn find_pairs(&mut self, colliders: &Query<Participant>) {
        self.counts = Counts::default();
        if !self.copy_placements(colliders) {
            self.sort(colliders);
            // Counts the nodes of all of them.
            let are_same = self.copy_placements(colliders);
            debug_assert!(are_same);
        }

        self.bounds.clear();
        let bounds = self.colliders.iter().map(|(_, placed)| placed.bounds_with_margin());
        self.bounds.extend(bounds);
        self.sweep.find(&self.bounds, &mut self.overlaps);

        self.pairs.clear();
        let counts = &mut self.counts;
        counts.overlaps = self.overlaps.len() as u64;
        for &(i, j) in &self.overlaps {
            let ((a, placed_a), (b, placed_b)) = (&self.colliders[i as usize], &self.colliders[j as usize]);
            let skipped = match placed_a.skips(placed_b) {
                Some(Skip::SameBody) => &mut counts.same_body,
                Some(Skip::Layers) => &mut counts.layers,
                Some(Skip::Passive) => &mut counts.passive,
                Some(Skip::Rigid) => &mut counts.rigid,
                None => {
                    self.pairs.push((*a, *b));
                    continue;
                }
            };
            *skipped += 1;
        }
    }
}
