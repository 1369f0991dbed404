//! Meshes that are waited for although nobody loads or adds them, and meshes with odd joint weights.

use std::time::Duration;

use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use super::subject::Around;
use super::verdict::FRAME;
use crate::app::{PATIENCE, Suspects};
use crate::import::{FurtherInfluences, MorphTrees, TreeKey};

pub(super) fn any_is_missing(trees: Res<MorphTrees>) -> bool {
    trees.waiting().next().is_some()
}

/// Warns of meshes that were missing for some time without being loaded. Runs only while colliders wait for meshes.
pub(super) fn warn_of_missing_meshes(
    around: Around,
    mut suspects: ResMut<Suspects>,
    time: Option<Res<Time<Real>>>,
    mut waiting: Local<HashMap<TreeKey, Duration>>,
) {
    let frame = time.map_or(FRAME, |time| time.delta());
    let mut still_waiting = HashMap::default();
    for (key, asked_by) in around.trees.waiting() {
        let waited = waiting.get(&key).map_or(Duration::ZERO, |&before| before + frame);
        let is_loading = around.names.is_loading(key.mesh);
        still_waiting.insert(key, if is_loading { Duration::ZERO } else { waited });
        if !is_loading && waited >= PATIENCE {
            suspects.log().warn("missing mesh", around.about(asked_by), || {
                format!(
                    "the mesh of entity {} is not in `Assets<Mesh>`: it was removed, or never added. The entity is left out until the \
                     mesh is there",
                    around.name(asked_by)
                )
            });
        }
    }
    *waiting = still_waiting;
}

/// How far the joint weights of a vertex may be from a sum of 1. Weights that are stored in bytes are often off by half a percent.
const MAX_WEIGHT_ERROR: f64 = 0.01;

pub(super) fn trees_changed(trees: Res<MorphTrees>, mut seen: Local<u64>) -> bool {
    std::mem::replace(&mut *seen, trees.version()) != trees.version()
}

/// Warns of meshes whose joint weights do not sum to 1. Runs only when there are new trees.
pub(super) fn warn_of_joint_weights(around: Around, mut suspects: ResMut<Suspects>, further: Res<FurtherInfluences>) {
    for (key, asked_by, error) in around.trees.joint_weight_errors() {
        if error <= MAX_WEIGHT_ERROR {
            continue;
        }
        let file = around.names.asset(key.mesh);
        // The weights in the file may sum to 1: Bevy drops some of them, and another warning says so.
        if file.as_deref().is_some_and(|file| further.has(file)) {
            continue;
        }
        let about = file.clone().unwrap_or_else(|| around.about(asked_by));
        suspects.log().warn("joint weights", about, || {
            let name = around.names.entity(asked_by);
            let mesh = file.map_or_else(|| "the mesh".into(), |path| format!("mesh `{path}`"));
            format!(
                "the joint weights of {mesh} of entity `{name}` do not sum to 1 at every vertex; the largest difference is {error:.2}. Bevy \
                 draws such a vertex too close to the world's origin or too far from it, and it collides there. Normalise the weights in \
                 the program that exported the file"
            )
        });
    }
}
