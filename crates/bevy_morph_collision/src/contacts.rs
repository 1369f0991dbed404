//! Who touches whom.

use std::collections::BTreeMap;

use bevy::prelude::*;
use morph_collision::{ShapeContact, TrianglePair};

use crate::body_pairs::BodyPairs;
use crate::changes::Changes;
use crate::collider::MorphCollisionMode;

/// The colliders that touch, as of the last run of [`NarrowPhase`](crate::MorphCollisionSystems::NarrowPhase).
///
/// As a system parameter: `Res<MorphCollisions>`. It can be asked about colliders ([`contains`](Self::contains), [`get`](Self::get),
/// [`of`](Self::of)) and about bodies ([`contains_bodies`](Self::contains_bodies),
/// [`collisions_between_bodies`](Self::collisions_between_bodies), [`bodies_colliding_with`](Self::bodies_colliding_with)).
///
/// # What started and ended
///
/// [`MorphCollisions::started`] and [`MorphCollisions::ended`] show a system that runs once per frame or tick every change exactly
/// once. While the plugin is paused they are empty. Which changes they show depends on the plugin's schedule:
///
/// - [`PostUpdate`] (the default), or any other that runs once per frame: those of the last run. A system before it sees
///   the run of the frame before.
/// - A fixed schedule ([`FixedPostUpdate`], for example): systems of the fixed schedules see those of the last run. All other systems
///   see those of all runs of this frame together, and none in a frame without a tick.
/// - A schedule of your own: those of its last run, until it runs again.
///
/// The messages [`MorphCollisionStart`](crate::MorphCollisionStart) and [`MorphCollisionEnd`](crate::MorphCollisionEnd) miss nothing
/// either and need no such rule.
#[derive(Resource, Reflect, Debug, Default)]
#[reflect(Resource, Debug, Default)]
pub struct MorphCollisions {
    #[reflect(ignore)]
    pub(crate) current: BTreeMap<(Entity, Entity), MorphContact>,
    /// The same contacts by their bodies.
    #[reflect(ignore)]
    pub(crate) bodies: BodyPairs,
    #[reflect(ignore)]
    pub(crate) changes: Changes,
    /// Whether anything was compared in this run.
    #[reflect(ignore)]
    pub(crate) compared: bool,
}

/// Two colliders that touch, `collider1 < collider2`.
#[derive(Reflect, Clone, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphContact {
    /// The first collider.
    pub collider1: Entity,
    /// The second collider.
    pub collider2: Entity,
    /// The body of the first: that of its [`MorphColliderOf`](crate::MorphColliderOf), or itself.
    pub body1: Entity,
    /// The body of the second.
    pub body2: Entity,
    /// What was asked for.
    pub mode: MorphCollisionMode,
    /// A point at which they touch, in world space; between the closest points where only their margins do. In mode
    /// [`Contacts`](MorphCollisionMode::Contacts) the deepest, otherwise that of the first pair of triangles found.
    pub point: Vec3,
    /// The direction in which the first collider leaves the second there, a unit vector; zero if there is none.
    pub normal: Vec3,
    /// 0 if they touch, otherwise how far they are apart within their margins, in world units.
    pub distance: f32,
    /// Intersecting triangles, `triangle_a` of `collider1` and `triangle_b` of `collider2`, sorted; of a
    /// [`MorphShape`](crate::MorphShape) it is [`MorphContact::NO_TRIANGLE`].
    ///
    /// How many are listed is up to the [`MorphCollisionMode`]. A triangle's number is its place in the mesh's index buffer,
    /// divided by 3; in a triangle strip, its place among the triangles that name three different vertices.
    ///
    /// Not reflected: the list is empty in a value made by reflection.
    #[reflect(ignore)]
    pub triangles: Vec<TrianglePair>,
    /// Whether more triangles intersect than were looked at, which is at most
    /// [`MorphCollisionSettings::max_triangle_pairs`](crate::MorphCollisionSettings): `triangles` are some of them, and `points` and
    /// `normal` are made from some of them. Which ones depends on the tree. Always `false` in modes that ask for one pair.
    pub is_truncated: bool,
    /// In mode [`Contacts`](MorphCollisionMode::Contacts): up to four points of contact, the deepest first.
    pub points: Vec<MorphContactPoint>,
}

/// A point at which two colliders touch.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphContactPoint {
    /// In world space.
    pub point: Vec3,
    /// How far the triangles that meet there have to be moved along [`MorphContact::normal`] until they part, in world units.
    pub depth: f32,
    /// The two triangles. Not reflected: both are [`MorphContact::NO_TRIANGLE`] in a value made by reflection.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
}

/// The triangles of a value made by reflection, which cannot see types of [`morph_collision`].
pub(crate) fn no_triangles() -> TrianglePair {
    TrianglePair {
        triangle_a: MorphContact::NO_TRIANGLE,
        triangle_b: MorphContact::NO_TRIANGLE,
    }
}

/// A triangle of a mesh that meets a shape.
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
    /// The deepest four points of triangles that meet a shape, which come out deepest first.
    pub(crate) fn with_shape(met: &mut [ShapeContact], shape_first: bool) -> Vec<Self> {
        met.sort_by(|x, y| x.distance.total_cmp(&y.distance).then(x.triangle.cmp(&y.triangle)));
        let point = |met: &ShapeContact| Self {
            point: met.point_on_triangle.as_vec3(),
            depth: -met.distance as f32,
            triangles: pair_with_shape(met.triangle, shape_first),
        };
        met.iter().take(4).map(point).collect()
    }
}

impl MorphContact {
    /// The triangle of a collider that has none.
    pub const NO_TRIANGLE: u32 = u32::MAX;

    /// The other collider of the pair, if `collider` is one.
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
    /// The contacts, in ascending order of their colliders.
    pub fn iter(&self) -> impl Iterator<Item = &MorphContact> {
        self.current.values()
    }

    /// The contacts of one collider, in ascending order. Looks through all contacts.
    pub fn of(&self, collider: Entity) -> impl Iterator<Item = &MorphContact> {
        self.iter().filter(move |contact| contact.other(collider).is_some())
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

    /// Contacts that started; [which ones](MorphCollisions#what-started-and-ended) depends on where you ask.
    ///
    /// A contact that started and ended within one frame is as it was when it ended.
    pub fn started(&self) -> impl Iterator<Item = &MorphContact> {
        let ended = |pair: &(Entity, Entity)| {
            let is_one = |contact: &&MorphContact| (contact.collider1, contact.collider2) == *pair;
            self.changes.ended.iter().rev().find(is_one)
        };
        let started = self.changes.started().iter();
        started.filter_map(move |pair| self.current.get(pair).or_else(|| ended(pair)))
    }

    /// Contacts that ended, as they last were; [which ones](MorphCollisions#what-started-and-ended) depends on where you ask.
    pub fn ended(&self) -> impl Iterator<Item = &MorphContact> {
        self.changes.ended().iter()
    }

    /// Contacts that started in the last run.
    pub(crate) fn started_in_run(&self) -> impl Iterator<Item = &MorphContact> {
        let started = self.changes.started_in_run().iter();
        started.filter_map(|pair| self.current.get(pair))
    }
}
