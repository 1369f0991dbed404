//! The frame loop: poses all bodies and describes what touches.

use std::collections::HashSet;

use morph_collision::{ContactQuery, DistanceQuery};
use morph_collision_models::text::number;
use serde::Serialize;

use super::Swept;
use crate::cast::posed::Posed;
use crate::error::CliError;
use crate::messages::progress;
use crate::touching::blame::{self, Blame};
use crate::touching::depth::{self, ThresholdArgs};
use crate::touching::{Among, Search, Touch};

/// What a frame shows.
#[derive(Clone, Debug, Default)]
pub(super) struct Label {
    pub(super) clip: Option<String>,
    pub(super) seconds: Option<f32>,
}

/// One body that intersects itself in a frame, or two bodies that touch.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) frame: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) clip: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) seconds: Option<f32>,
    pub(super) body_a: usize,
    /// The same as `body_a` if it intersects itself.
    pub(super) body_b: usize,
    /// Pairs of triangles that touch or, with a gap, are close.
    pub(super) pairs: usize,
    /// Those of them that are not so at rest.
    pub(super) new: usize,
    /// Minus the distance if nothing touches.
    #[serde(serialize_with = "number")]
    pub(super) depth: f64,
    /// Names of the targets that move the touching vertices most.
    pub(super) targets: Vec<String>,
    /// Names of the joints with the most influence on them.
    pub(super) joints: Vec<String>,
}

/// The rows of all frames. `same_places` says that bodies at rest stand where they stand in all frames. If `ignore_rest`, pairs that touch
/// at rest are left out.
pub(super) fn rows(
    cast: &mut Swept,
    labels: &[Label],
    among: Among,
    same_places: bool,
    ignore_rest: bool,
    thresholds: ThresholdArgs,
) -> Result<Vec<Row>, CliError> {
    let mut search = Search::within(thresholds.gap);
    let at_rest = at_rest(cast, &mut search, among, same_places)?;
    let blames: Vec<Blame<'_>> = cast
        .mesh_of_body
        .iter()
        .map(|&mesh| Blame::new(&cast.meshes[mesh]))
        .collect();
    let steps = progress::count("frame", cast.frames.len() as u64);
    let (mut rows, mut touches, mut measure) = (Vec::new(), Vec::new(), Measure::default());
    for frame in 0..cast.frames.len() {
        let mut weights = Vec::with_capacity(cast.bodies);
        for body in 0..cast.bodies {
            let shape = cast.shape(frame, body);
            let set = cast.method[body].set(&shape);
            set.map_err(|reason| cast.refused(frame, body, reason))?;
            weights.push(shape.weights);
        }
        touches.clear();
        if !search.touching(&mut cast.method, among, cast.most_pairs, &mut touches) {
            return Err(too_many(cast, frame));
        }
        if ignore_rest {
            touches.retain(|touch| !at_rest.contains(touch));
        }
        for group in touches.chunk_by(|one, other| one.bodies == other.bodies) {
            let [a, b] = group[0].bodies;
            let depth = measure.depth(&mut cast.method, group);
            if thresholds.min_depth.is_some_and(|least| depth < least) {
                continue;
            }
            let (targets, joints) = blame::names(&blames, &weights, group);
            let label = labels.get(frame).cloned().unwrap_or_default();
            rows.push(Row {
                frame,
                clip: label.clip,
                seconds: label.seconds,
                body_a: a,
                body_b: b,
                pairs: group.len(),
                new: group.iter().filter(|touch| !at_rest.contains(touch)).count(),
                depth,
                targets,
                joints,
            });
        }
        steps.step();
    }
    Ok(rows)
}

/// The pairs that touch while nothing moves. Pairs of different bodies count only if the bodies stand where they always stand.
fn at_rest(cast: &mut Swept, search: &mut Search, among: Among, same_places: bool) -> Result<HashSet<Touch>, CliError> {
    if cast.frames.is_empty() {
        return Ok(HashSet::new());
    }
    for body in 0..cast.bodies {
        let shape = cast.at_rest(0, body);
        let set = cast.method[body].set(&shape);
        set.map_err(|reason| cast.refused(0, body, reason))?;
    }
    let among = match (among, same_places) {
        (Among::Bodies, false) => return Ok(HashSet::new()),
        (Among::All, false) => Among::Itself,
        (among, _) => among,
    };
    let mut touches = Vec::new();
    if !search.touching(&mut cast.method, among, cast.most_pairs, &mut touches) {
        return Err(too_many(cast, 0));
    }
    Ok(touches.into_iter().collect())
}

fn too_many(cast: &Swept, frame: usize) -> CliError {
    CliError::TooManyTouches {
        input: cast.scene.clone(),
        frame,
        most: cast.most_pairs,
    }
}

/// Measures depths. It keeps the memory of the queries.
#[derive(Default)]
struct Measure {
    contacts: ContactQuery,
    distances: DistanceQuery,
}

impl Measure {
    /// How far the bodies, or the triangles of one body, would have to move apart. If they do not touch, minus their distance.
    fn depth(&mut self, bodies: &mut [Posed], group: &[Touch]) -> f64 {
        let [a, b] = group[0].bodies;
        if let Ok([first, second]) = bodies.get_disjoint_mut([a, b]) {
            if let Some(manifold) = self.contacts.manifold(first.body(), second.body()) {
                return manifold.depth;
            }
            let closest = self.distances.closest(first.body(), second.body(), f64::INFINITY);
            return closest.ok().flatten().map_or(0.0, |pair| -pair.distance);
        }
        let mut body = bodies[a].body();
        let of_pair = |touch: &Touch| {
            let first = body.triangle(touch.pair.triangle_a)?;
            let second = body.triangle(touch.pair.triangle_b)?;
            Some(depth::depth(&first, &second))
        };
        group.iter().filter_map(of_pair).reduce(f64::max).unwrap_or(0.0)
    }
}
