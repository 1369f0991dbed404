//! Which triangles intersect, and where colliders touch.

use bevy::platform::time::Instant;

use bevy::prelude::*;
use morph_collision::{
    BatchQuery, Body, ContactQuery, DistanceQuery, PairMemory, PairTask, PlacedShape, Pose, Remember, ShapeContact,
    ShapeQuery, SurfaceAnchor, TrianglePair, Wanted, triangle_contact,
};
use tracing::debug_span;

use crate::broad_phase::Candidates;
use crate::collider::{ColliderState, CollisionMode, Form, Placement};
use crate::contacts::{MorphCollisions, MorphContact, MorphContactPoint};
use crate::diagnostics::MorphCollisionDiagnostics;
use crate::settings::MorphCollisionSettings;
use crate::workers::TaskPoolWorkers;

type Pair = (Entity, Entity);

/// What the narrow phase keeps for its memory.
#[derive(Default)]
pub(crate) struct Scratch {
    queries: Queries,
    batch: BatchQuery,
    /// Pairs of meshes that are asked about.
    asked: Vec<Asked>,
    /// What is remembered of pairs, and of which ones; in the order of the pairs, and the next ones.
    remember: Remember,
    memories: Vec<(Pair, PairMemory)>,
    next_memories: Vec<(Pair, PairMemory)>,
    answers: Vec<(Pair, Option<MorphContact>)>,
}

#[derive(Default)]
struct Queries {
    contact: ContactQuery,
    distance: DistanceQuery,
    shape: ShapeQuery,
}

/// Two colliders, by their places among those that take part.
#[derive(Clone, Copy)]
struct Asked {
    pair: Pair,
    places: (usize, usize),
    mode: CollisionMode,
}

/// Asks for every candidate pair whether, and where, it touches: all pairs of meshes at once, on Bevy's threads.
///
/// A pair of which neither collider changed has the answer it had.
pub(crate) fn find_contacts(
    mut candidates: ResMut<Candidates>,
    mut colliders: Query<(Entity, &mut ColliderState)>,
    mut collisions: ResMut<MorphCollisions>,
    settings: Res<MorphCollisionSettings>,
    mut scratch: Local<Scratch>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::narrow_phase").entered();
    let collisions = &mut *collisions;
    collisions.started.clear();
    collisions.ended.clear();
    if std::mem::take(&mut candidates.changed) {
        let scratch = &mut *scratch;
        scratch.answers.clear();
        scratch.set_remember(&settings);
        let unchanged = scratch.ask(&candidates.pairs, &mut colliders, &mut diagnostics);
        diagnostics.skipped_unchanged = unchanged;
        collisions.replace(&candidates.pairs, &mut scratch.answers);
        for (_, mut state) in &mut colliders {
            // What took part is looked at from now on as it is; what did not will be new when it comes back.
            state.changed = state.placed.is_none();
        }
    } else {
        diagnostics.skipped_unchanged = candidates.pairs.len() as u64;
    }
    let triangles = collisions
        .current
        .values()
        .map(|contact| contact.triangles.len() as u64);
    diagnostics.triangle_pairs = triangles.sum();
    diagnostics.touching_pairs = collisions.current.len() as u64;
    diagnostics.duration += start.elapsed();
}

impl MorphCollisions {
    /// Takes over what was found, in whatever order, and drops what is no candidate any more.
    fn replace(&mut self, candidates: &[Pair], answers: &mut Vec<(Pair, Option<MorphContact>)>) {
        let Self {
            current,
            started,
            ended,
        } = self;
        for contact in current.extract_if(.., |pair, _| candidates.binary_search(pair).is_err()) {
            ended.push(contact.1);
        }
        for (pair, contact) in answers.drain(..) {
            let before = match contact {
                Some(contact) => {
                    let before = current.insert(pair, contact);
                    if before.is_none() {
                        started.push(pair);
                    }
                    None
                }
                None => current.remove(&pair),
            };
            ended.extend(before);
        }
        started.sort_unstable();
        ended.sort_unstable_by_key(|contact| (contact.collider1, contact.collider2));
    }
}

impl Scratch {
    fn set_remember(&mut self, settings: &MorphCollisionSettings) {
        let remember = Remember {
            separation: settings.separation_cache,
            ..Remember::default()
        };
        if self.remember != remember {
            self.remember = remember;
            self.memories.clear();
        }
    }

    /// Asks about pairs with a collider that changed; says how many have none.
    fn ask(
        &mut self,
        candidates: &[Pair],
        colliders: &mut Query<(Entity, &mut ColliderState)>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> u64 {
        let mut placed: Vec<_> = colliders
            .iter_mut()
            .filter_map(|(entity, state)| Placed::new(entity, state.into_inner()))
            .collect();
        placed.sort_unstable_by_key(|collider| collider.entity);
        let place = |entity: Entity| placed.binary_search_by_key(&entity, |collider| collider.entity).ok();

        let mut unchanged = 0;
        let mut with_shapes = Vec::new();
        self.asked.clear();
        for &pair in candidates {
            let (Some(a), Some(b)) = (place(pair.0), place(pair.1)) else {
                continue;
            };
            if !placed[a].changed && !placed[b].changed {
                unchanged += 1;
                continue;
            }
            let asked = Asked {
                pair,
                places: (a, b),
                mode: placed[a].placement.mode.max(placed[b].placement.mode),
            };
            match (placed[a].placement.form, placed[b].placement.form) {
                (Form::Mesh(_), Form::Mesh(_)) => self.asked.push(asked),
                (Form::Mesh(_), Form::Shape(shape)) => with_shapes.push((asked, shape, false)),
                (Form::Shape(shape), Form::Mesh(_)) => with_shapes.push((asked, shape, true)),
                (Form::Shape(_), Form::Shape(_)) => {}
            }
        }
        for (asked, shape, shape_first) in with_shapes {
            let contact = self
                .queries
                .with_shape(&mut placed, asked, &shape, shape_first, diagnostics);
            self.answers.push((asked.pair, contact));
        }
        self.ask_meshes(&mut placed, diagnostics);
        unchanged
    }

    fn ask_meshes(&mut self, placed: &mut [Placed<'_>], diagnostics: &mut MorphCollisionDiagnostics) {
        let Self {
            queries,
            batch,
            remember,
            asked,
            memories,
            next_memories,
            answers,
        } = self;
        keep_memories(asked, *remember, memories, next_memories);
        let mut left = memories.iter_mut();
        let mut tasks: Vec<_> = asked
            .iter()
            .map(
                |&Asked {
                     places: (a, b), mode, ..
                 }| {
                    let wanted = if wants_all(mode) { Wanted::All } else { Wanted::First };
                    let mut task = PairTask::new(a, b, wanted);
                    if has_memory(mode, *remember) {
                        task.memory = left.next().map(|(_, memory)| memory);
                    }
                    task
                },
            )
            .collect();
        // Shapes are in no task, but have a place.
        let mut spare = Vec::new();
        let mut bodies: Vec<Body<'_>> = Vec::new();
        let mut place_of = vec![usize::MAX; placed.len()];
        for (place, collider) in placed.iter_mut().enumerate() {
            if let (Form::Mesh(world_from_model), Some(pose)) = (&collider.placement.form, &mut collider.pose) {
                place_of[place] = bodies.len();
                bodies.push(Body::new(pose, world_from_model));
            }
        }
        for task in &mut tasks {
            (task.a, task.b) = (place_of[task.a], place_of[task.b]);
        }
        let found = batch.run(&mut bodies, &mut tasks, &TaskPoolWorkers);
        diagnostics.stats += found.stats;
        spare.extend(found.iter().map(<[TrianglePair]>::to_vec));
        drop(bodies);
        for (&asked, triangles) in asked.iter().zip(spare) {
            let contact = queries.with_mesh(placed, asked, triangles, diagnostics);
            answers.push((asked.pair, contact));
        }
    }
}

fn wants_all(mode: CollisionMode) -> bool {
    matches!(mode, CollisionMode::All | CollisionMode::Contacts)
}

impl Queries {
    /// The contact of two meshes of which these triangles intersect.
    fn with_mesh(
        &mut self,
        placed: &mut [Placed<'_>],
        asked: Asked,
        mut triangles: Vec<TrianglePair>,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> Option<MorphContact> {
        let (a, b) = asked.places;
        let Ok([a, b]) = placed.get_disjoint_mut([a, b]) else {
            return None;
        };
        let margin = f64::from(a.placement.margin) + f64::from(b.placement.margin);
        let mut contact = MorphContact::of(asked, a, b);
        if triangles.is_empty() {
            if margin == 0.0 {
                return None;
            }
            let (closest, stats) = self.distance.closest(a.body()?, b.body()?, margin);
            diagnostics.stats += stats;
            let closest = closest?;
            contact.point = closest.point_a.midpoint(closest.point_b).as_vec3();
            contact.normal = (closest.point_a - closest.point_b).normalize_or_zero().as_vec3();
            contact.distance = closest.distance as f32;
            return Some(contact);
        }
        let first = triangles[0];
        let corners_a = world_triangle(&mut a.body()?, first.triangle_a)?;
        let corners_b = world_triangle(&mut b.body()?, first.triangle_b)?;
        if let Some(met) = triangle_contact(&corners_a, &corners_b) {
            contact.point = met.point().as_vec3();
            contact.normal = met.normal.as_vec3();
        }
        if asked.mode == CollisionMode::Contacts {
            let (manifold, stats) = self.contact.manifold(a.body()?, b.body()?);
            diagnostics.stats += stats;
            if let Some(manifold) = manifold {
                contact.normal = manifold.normal.as_vec3();
                contact
                    .points
                    .extend(manifold.points().iter().map(|point| MorphContactPoint {
                        point: point.point.as_vec3(),
                        depth: point.depth as f32,
                        triangles: point.pair,
                    }));
                contact.point = contact.points.first().map_or(contact.point, |deepest| deepest.point);
            }
        }
        if asked.mode != CollisionMode::Any {
            triangles.sort_unstable();
            contact.triangles = triangles;
        }
        Some(contact)
    }

    /// The contact of a mesh and a shape.
    fn with_shape(
        &mut self,
        placed: &mut [Placed<'_>],
        asked: Asked,
        shape: &PlacedShape,
        shape_first: bool,
        diagnostics: &mut MorphCollisionDiagnostics,
    ) -> Option<MorphContact> {
        let (a, b) = asked.places;
        let Ok([a, b]) = placed.get_disjoint_mut([a, b]) else {
            return None;
        };
        let margin = f64::from(a.placement.margin) + f64::from(b.placement.margin);
        let mut contact = MorphContact::of(asked, a, b);
        let mesh = if shape_first { b } else { a };
        let pair = |triangle: u32| match shape_first {
            true => TrianglePair {
                triangle_a: MorphContact::NO_TRIANGLE,
                triangle_b: triangle,
            },
            false => TrianglePair {
                triangle_a: triangle,
                triangle_b: MorphContact::NO_TRIANGLE,
            },
        };
        // Out of the shape towards the mesh is how the mesh leaves it.
        let turn = if shape_first { -1.0 } else { 1.0 };
        let (closest, stats) = self.shape.closest(mesh.body()?, shape, margin);
        diagnostics.stats += stats;
        let closest: ShapeContact = closest?;
        contact.point = closest.point_on_triangle.midpoint(closest.point_on_shape).as_vec3();
        contact.normal = (closest.normal * turn).as_vec3();
        contact.distance = closest.distance.max(0.0) as f32;
        let touches = closest.distance <= 0.0;
        if touches && asked.mode == CollisionMode::First {
            contact.triangles.push(pair(closest.triangle));
        }
        if touches && wants_all(asked.mode) {
            let mut met = Vec::new();
            diagnostics.stats += self.shape.contacts(mesh.body()?, shape, 0.0, &mut met);
            contact.triangles = met.iter().map(|met| pair(met.triangle)).collect();
            contact.triangles.sort_unstable();
            if asked.mode == CollisionMode::Contacts {
                met.sort_by(|x, y| x.distance.total_cmp(&y.distance).then(x.triangle.cmp(&y.triangle)));
                contact.points.extend(met.iter().take(4).map(|met| MorphContactPoint {
                    point: met.point_on_triangle.as_vec3(),
                    depth: -met.distance as f32,
                    triangles: pair(met.triangle),
                }));
            }
        }
        Some(contact)
    }
}

impl MorphContact {
    fn of(asked: Asked, a: &Placed<'_>, b: &Placed<'_>) -> Self {
        Self {
            collider1: asked.pair.0,
            collider2: asked.pair.1,
            body1: a.placement.body,
            body2: b.placement.body,
            mode: asked.mode,
            point: Vec3::ZERO,
            normal: Vec3::ZERO,
            distance: 0.0,
            triangles: Vec::new(),
            points: Vec::new(),
        }
    }
}

/// A triangle's corners in world space.
pub(crate) fn world_triangle(body: &mut Body<'_>, triangle: u32) -> Option<morph_collision::Triangle> {
    let mut corner = |barycentrics| {
        let anchor = SurfaceAnchor { triangle, barycentrics };
        anchor.point(Body::new(body.pose, body.world_from_model))
    };
    Some([
        corner([1.0, 0.0, 0.0])?,
        corner([0.0, 1.0, 0.0])?,
        corner([0.0, 0.0, 1.0])?,
    ])
}

/// Whether something is remembered of a pair: always where one pair of triangles is asked for.
fn has_memory(mode: CollisionMode, remember: Remember) -> bool {
    remember.separation || !wants_all(mode)
}

/// Makes `memories` those of the pairs that have one, in their order: the ones there are, and new ones. Both are sorted.
fn keep_memories(
    asked: &[Asked],
    remember: Remember,
    memories: &mut Vec<(Pair, PairMemory)>,
    next: &mut Vec<(Pair, PairMemory)>,
) {
    let mut known = memories.drain(..).peekable();
    next.clear();
    for &Asked { pair, .. } in asked.iter().filter(|asked| has_memory(asked.mode, remember)) {
        while known.next_if(|(other, _)| *other < pair).is_some() {}
        let memory = known.next_if(|(other, _)| *other == pair);
        next.push(memory.unwrap_or_else(|| (pair, PairMemory::new(remember))));
    }
    drop(known);
    std::mem::swap(memories, next);
}

/// A collider that takes part.
struct Placed<'a> {
    entity: Entity,
    changed: bool,
    placement: &'a Placement,
    pose: Option<&'a mut Pose>,
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
            pose: pose.as_mut(),
        })
    }

    /// The mesh, for one query.
    fn body(&mut self) -> Option<Body<'_>> {
        match (&self.placement.form, &mut self.pose) {
            (Form::Mesh(world_from_model), Some(pose)) => Some(Body::new(pose, world_from_model)),
            _ => None,
        }
    }
}
