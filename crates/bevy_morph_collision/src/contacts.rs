//! The contacts of the last run.

use std::collections::BTreeMap;

use bevy::prelude::*;
use morph_collision::{Rank, ShapeContact, TrianglePair};

use crate::body_pairs::BodyPairs;
use crate::changes::Changes;
use crate::collider::MorphCollisionMode;
use crate::impact::MorphImpact;

/// The colliders that touch, as of the last run of [`NarrowPhase`](crate::MorphCollisionSystems::NarrowPhase).
///
/// Use it as a system parameter: `Res<MorphCollisions>`. It answers questions about colliders ([`contains`](Self::contains),
/// [`get`](Self::get), [`of`](Self::of)) and about bodies ([`contains_bodies`](Self::contains_bodies),
/// [`collisions_between_bodies`](Self::collisions_between_bodies), [`bodies_colliding_with`](Self::bodies_colliding_with)).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component)]
/// struct Wall;
///
/// fn count(collisions: Res<MorphCollisions>, walls: Query<Entity, With<Wall>>) {
///     for wall in &walls {
///         let triangles: usize = collisions.of(wall).map(|contact| contact.triangles.len()).sum();
///         println!("{triangles} pairs of triangles touch the wall");
///     }
/// }
/// # App::new().add_systems(Update, count);
/// ```
///
/// # What started and ended
///
/// A system that runs once per frame or tick sees every change exactly once in [`MorphCollisions::started`] and
/// [`MorphCollisions::ended`]. They are empty while the plugin is paused. Which changes they show depends on the plugin's
/// schedule:
///
/// - [`PostUpdate`] (the default), or any other schedule that runs once per frame: the changes of the last run. Systems that run
///   earlier in the frame see those of the previous frame.
/// - A fixed schedule, for example [`FixedPostUpdate`]: systems in fixed schedules see the changes of the last run. All other
///   systems see the changes of all runs of this frame together, and none in a frame without a tick.
/// - A schedule of your own: the changes of its last run, until it runs again.
///
/// The messages [`MorphCollisionStart`](crate::MorphCollisionStart) and [`MorphCollisionEnd`](crate::MorphCollisionEnd) do not
/// depend on the schedule: they report every change.
#[derive(Resource, Reflect, Debug, Default)]
#[reflect(Resource, Debug, Default)]
pub struct MorphCollisions {
    #[reflect(ignore)]
    pub(crate) current: BTreeMap<(Entity, Entity), MorphContact>,
    /// The same contacts, grouped by bodies.
    #[reflect(ignore)]
    pub(crate) bodies: BodyPairs,
    #[reflect(ignore)]
    pub(crate) changes: Changes,
    /// Whether anything was compared in this run.
    #[reflect(ignore)]
    pub(crate) compared: bool,
}

/// A contact of two colliders, with `collider1 < collider2`.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphContact {
    /// The first collider.
    pub collider1: Entity,
    /// The second collider.
    pub collider2: Entity,
    /// The body of `collider1`, named by its [`MorphColliderOf`](crate::MorphColliderOf), or `collider1` itself.
    pub body1: Entity,
    /// The body of `collider2`.
    pub body2: Entity,
    /// The mode that applied to this pair.
    pub mode: MorphCollisionMode,
    /// A point at which they touch, in world space. For two meshes it is the deepest point in mode
    /// [`Contacts`](MorphCollisionMode::Contacts), otherwise a point of the first pair of triangles found. For a mesh and a
    /// [`MorphShape`](crate::MorphShape), and if only the margins touch, it is midway between the closest (or deepest) points.
    pub point: Vec3,
    /// The unit vector along which `collider1` moves out of `collider2` at `point`; zero if there is none.
    pub normal: Vec3,
    /// 0 if the colliders touch; if only their margins do, the distance between the colliders, in world units.
    pub distance: f32,
    /// Intersecting triangles: `triangle_a` of `collider1` and `triangle_b` of `collider2`, sorted. For a
    /// [`MorphShape`](crate::MorphShape) the number is [`MorphContact::NO_TRIANGLE`].
    ///
    /// The [`MorphCollisionMode`] decides how many are listed: none in mode `Any`. A triangle's number is its position in the mesh's index buffer
    /// divided by 3; in a triangle strip, it is its position among the triangles that have three different vertices.
    ///
    /// Not reflected: the list is empty in a value created by reflection.
    #[reflect(ignore)]
    pub triangles: Vec<TrianglePair>,
    /// Whether more triangle pairs intersect than the limit,
    /// [`MorphCollisionSettings::max_triangle_pairs`](crate::MorphCollisionSettings). If so, `triangles`, `points` and `normal`
    /// are based on some of the pairs; which ones depends on the tree. Always `false` in modes that report one pair.
    pub is_truncated: bool,
    /// Up to four contact points, deepest first. Only in mode [`Contacts`](MorphCollisionMode::Contacts).
    pub points: Vec<MorphContactPoint>,
    /// How the contact began, if one of the colliders is [continuous](crate::MorphCollider::continuous). It stays the same as long as
    /// the contact lasts. `None` if they were not compared on their way when the contact began.
    ///
    /// If the contact began and ended between two runs, `point`, `normal` and `triangles` are those of the impact.
    pub impact: Option<MorphImpact>,
}

/// A point at which two colliders touch.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphContactPoint {
    /// In world space.
    pub point: Vec3,
    /// How far the triangles at this point must move along [`MorphContact::normal`] to separate, in world units.
    pub depth: f32,
    /// The two triangles. Not reflected: both are [`MorphContact::NO_TRIANGLE`] in a value created by reflection.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
}

/// The triangles of a value created by reflection. Types of [`morph_collision`] are not reflected.
pub(crate) fn no_triangles() -> TrianglePair {
    TrianglePair {
        triangle_a: MorphContact::NO_TRIANGLE,
        triangle_b: MorphContact::NO_TRIANGLE,
    }
}

/// Pairs a triangle of a mesh with the shape that it intersects.
pub(crate) fn pair_with_shape(triangle: u32, shape_first: bool) -> TrianglePair {
    let mut triangles = [triangle, MorphContact::NO_TRIANGLE];
    if shape_first {
        triangles.reverse();
    }
    TrianglePair {
        triangle_a: triangles[0],
        triangle_b: triangles[1],
    }
}

impl MorphContactPoint {
    /// Keeps the four deepest triangles that intersect a shape, deepest first.
    pub(crate) fn with_shape(met: &mut [ShapeContact], shape_first: bool) -> Vec<Self> {
        met.sort_by_key(|met| Rank::new(met.distance, met.triangle));
        let point = |met: &ShapeContact| Self {
            point: met.point_on_triangle.as_vec3(),
            depth: -met.distance as f32,
            triangles: pair_with_shape(met.triangle, shape_first),
        };
        met.iter().take(4).map(point).collect()
    }
}

impl MorphContact {
    /// The triangle number used for colliders without triangles.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// The two colliders, in ascending order.
    pub(crate) fn pair(&self) -> (Entity, Entity) {
        (self.collider1, self.collider2)
    }

    /// Where the contact began, with its normal: at the impact if there is one.
    pub(crate) fn begins_at(&self) -> (Vec3, Vec3) {
        self.impact
            .map_or((self.point, self.normal), |impact| (impact.point, impact.normal))
    }

    /// The other collider of the pair; `None` if `collider` is not part of it.
    #[must_use]
    pub fn other(&self, collider: Entity) -> Option<Entity> {
        match collider {
            _ if collider == self.collider1 => Some(self.collider2),
            _ if collider == self.collider2 => Some(self.collider1),
            _ => None,
        }
    }
}

impl MorphCollisions {
    /// All contacts, in ascending order of their colliders.
    pub fn iter(&self) -> impl Iterator<Item = &MorphContact> {
        self.current.values()
    }

    /// The contacts of one collider, in ascending order. Iterates over all contacts.
    pub fn of(&self, collider: Entity) -> impl Iterator<Item = &MorphContact> {
        self.iter().filter(move |contact| contact.other(collider).is_some())
    }

    /// Whether two colliders touch, in either order.
    #[must_use]
    pub fn contains(&self, a: Entity, b: Entity) -> bool {
        self.get(a, b).is_some()
    }

    /// The contact of two colliders, in either order. The contact itself has them in ascending order.
    #[must_use]
    pub fn get(&self, a: Entity, b: Entity) -> Option<&MorphContact> {
        self.current.get(&(a.min(b), a.max(b)))
    }

    /// The number of contacts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.current.len()
    }

    /// Whether there are no contacts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.current.is_empty()
    }

    /// Contacts that started. [Which ones](MorphCollisions#what-started-and-ended) depends on where you call this.
    ///
    /// A contact that started and ended within one frame is in the state in which it ended. One that started several times in a frame is
    /// listed as often, each time in its last state.
    pub fn started(&self) -> impl Iterator<Item = &MorphContact> {
        let ended = |pair: &(Entity, Entity)| {
            let is_one = |contact: &&MorphContact| contact.pair() == *pair;
            self.changes.ended.iter().rev().find(is_one)
        };
        let started = self.changes.started().iter();
        started.filter_map(move |pair| self.current.get(pair).or_else(|| ended(pair)))
    }

    /// Contacts that ended, in their last state. [Which ones](MorphCollisions#what-started-and-ended) depends on where you call
    /// this.
    pub fn ended(&self) -> impl Iterator<Item = &MorphContact> {
        self.changes.ended().iter()
    }

    /// Contacts that started in the last run.
    pub(crate) fn started_in_run(&self) -> impl Iterator<Item = &MorphContact> {
        let started = self.changes.started_in_run().iter();
        started.filter_map(|&pair| self.in_run(pair))
    }

    /// A contact that lasts, or that began and ended in the last run.
    pub(crate) fn in_run(&self, pair: (Entity, Entity)) -> Option<&MorphContact> {
        let passed = self.changes.passed_in_run();
        let place = || passed.binary_search_by_key(&pair, MorphContact::pair).ok();
        self.current.get(&pair).or_else(|| passed.get(place()?))
    }
}
