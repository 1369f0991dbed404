//! Where colliders are in the world, and which of them are close enough to look at.

use bevy::platform::time::Instant;

use bevy::prelude::*;
use morph_collision::{Aabb, WorldFromModel, overlapping_pairs};
use tracing::error;

use crate::collider::{ColliderState, MorphBody, MorphCollider, Placement};
use crate::diagnostics::MorphCollisionDiagnostics;

/// Pairs for the narrow phase, each in ascending order of entities, and sorted.
#[derive(Resource, Default)]
pub(crate) struct Candidates {
    pub(crate) pairs: Vec<(Entity, Entity)>,
    // Kept for their memory.
    colliders: Vec<(Entity, Entity, Aabb)>,
    bounds: Vec<Option<Aabb>>,
    overlaps: Vec<(u32, u32)>,
}

/// Places every collider and pairs those of different bodies whose world bounds overlap.
///
/// Only the root volume of each tree is refitted for this. A transform that is not finite is logged once, until it is
/// finite again, and leaves its collider out.
pub(crate) fn find_candidates(
    mut colliders: Query<(
        NameOrEntity,
        &MorphCollider,
        &mut ColliderState,
        &GlobalTransform,
        Option<&MorphBody>,
    )>,
    mut candidates: ResMut<Candidates>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let candidates = &mut *candidates;
    candidates.colliders.clear();
    for (name, collider, mut state, transform, body) in &mut colliders {
        let state = &mut *state;
        let Some(pose) = &mut state.pose else {
            state.placed = None;
            continue;
        };
        let world_from_model = match WorldFromModel::new(transform.affine()) {
            Ok(world_from_model) => world_from_model,
            Err(error) => {
                if !state.bad_transform {
                    error!("entity `{name}` is left out of collisions: {error}");
                }
                state.bad_transform = true;
                state.placed = None;
                continue;
            }
        };
        state.bad_transform = false;
        let placed = Placement {
            world_from_model,
            body: body.map_or(name.entity, |body| body.0),
            mode: collider.mode,
        };
        state.changed |= state.placed != Some(placed);
        state.placed = Some(placed);

        diagnostics.nodes_total += pose.bvh().node_count() as u64;
        // A pose keeps its root volume as long as its weights stay.
        diagnostics.stats.volumes_blended += u64::from(std::mem::take(&mut state.reposed));
        let bounds = pose.world_bounds(&world_from_model);
        candidates.colliders.push((name.entity, placed.body, bounds));
    }
    candidates.colliders.sort_unstable_by_key(|&(entity, ..)| entity);

    candidates.bounds.clear();
    let bounds = candidates.colliders.iter().map(|&(.., bounds)| Some(bounds));
    candidates.bounds.extend(bounds);
    candidates.overlaps.clear();
    overlapping_pairs(&candidates.bounds, &mut candidates.overlaps);

    candidates.pairs.clear();
    let pairs = candidates.overlaps.iter().filter_map(|&(i, j)| {
        let (a, body_a, _) = candidates.colliders[i as usize];
        let (b, body_b, _) = candidates.colliders[j as usize];
        (body_a != body_b).then_some((a, b))
    });
    candidates.pairs.extend(pairs);

    diagnostics.colliders = candidates.colliders.len() as u64;
    diagnostics.candidate_pairs = candidates.pairs.len() as u64;
    diagnostics.duration += start.elapsed();
}
