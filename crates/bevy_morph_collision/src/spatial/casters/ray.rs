//! Rays that are cast in every run.

use bevy::prelude::*;
use morph_collision::batch::QuestionBatch;

use super::carrier::to_world;
use super::cast::Caster;
use crate::components::MorphUnit;
use crate::spatial::rays::{Ranked, RayCast};
use crate::spatial::walker::Walker;
use crate::spatial::{MorphQueryFilter, MorphRayHit, MorphSpatialQuery};

/// Casts a ray from its entity in every run, and lists the hits in [`MorphRayHits`].
///
/// The ray follows the entity's [`GlobalTransform`]: put it on a muzzle, an eye, a wheel or a foot. All casters of a run are
/// answered together, on Bevy's threads, which is faster than asking one by one. The answers are those of
/// [`MorphSpatialQuery::cast_ray`](crate::spatial::MorphSpatialQuery::cast_ray) and
/// [`ray_hits`](crate::spatial::MorphSpatialQuery::ray_hits) at the end of the run.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands) {
///     commands.spawn((Name::new("lidar"), Transform::from_xyz(0.0, 1.0, 0.0), MorphRayCaster::new(Vec3::ZERO, Dir3::NEG_Z)));
/// }
///
/// fn measure(lidars: Query<(&Name, &MorphRayHits)>) {
///     for (name, hits) in &lidars {
///         println!("{name}: {:?}", hits.first().map(|hit| hit.distance));
///     }
/// }
/// # App::new().add_systems(Startup, spawn).add_systems(Update, measure);
/// ```
///
/// - **When.** At the end of each run, in [`MorphCollisionSystems::Casters`](crate::app::MorphCollisionSystems::Casters). Systems after that
///   see new hits. While collision is paused, hits stay as they are.
/// - **Bad input.** A ray with an invalid number or transform hits nothing, and the log names its entity.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphRayHits, Transform)]
pub struct MorphRayCaster {
    /// Whether the ray is cast. If not, it hits nothing.
    pub enabled: bool,
    /// Where the ray starts, in the entity's space.
    pub origin: Vec3,
    /// The direction, in the entity's space. Only the entity's rotation turns it, not its scale.
    pub direction: Dir3,
    /// The largest distance of hits, in world units; [`f32::MAX`] by default.
    #[reflect(@0.0..=f32::INFINITY, @MorphUnit::Length)]
    pub max_distance: f32,
    /// How many hits are listed, nearest first; 1 by default, which takes the least time.
    pub max_hits: usize,
    /// Leaves out the colliders of the body that the caster is on: of the first entity, from its own up to the root of its hierarchy,
    /// that is a collider or a body. On by default.
    pub ignore_self: bool,
    /// Which colliders the ray sees.
    #[entities]
    pub filter: MorphQueryFilter,
}

impl Default for MorphRayCaster {
    fn default() -> Self {
        Self {
            enabled: true,
            origin: Vec3::ZERO,
            direction: Dir3::NEG_Z,
            max_distance: f32::MAX,
            max_hits: 1,
            ignore_self: true,
            filter: MorphQueryFilter::default(),
        }
    }
}

impl MorphRayCaster {
    /// A ray from a point, both in the entity's space.
    #[must_use]
    pub fn new(origin: Vec3, direction: Dir3) -> Self {
        Self {
            origin,
            direction,
            ..default()
        }
    }

    /// Limits the distance of hits, in world units.
    #[must_use]
    pub fn with_max_distance(mut self, max_distance: f32) -> Self {
        self.max_distance = max_distance;
        self
    }

    /// Lists up to `max_hits` hits.
    #[must_use]
    pub fn with_max_hits(mut self, max_hits: usize) -> Self {
        self.max_hits = max_hits;
        self
    }

    /// Whether the colliders of the caster's own body are left out.
    #[must_use]
    pub fn with_ignore_self(mut self, ignore_self: bool) -> Self {
        self.ignore_self = ignore_self;
        self
    }

    /// Sets which colliders the ray sees.
    #[must_use]
    pub fn with_filter(mut self, filter: MorphQueryFilter) -> Self {
        self.filter = filter;
        self
    }
}

/// What a [`MorphRayCaster`] hit in the last run, nearest first. Bevy's change detection sees it only when hits differ.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphRayHits(Vec<MorphRayHit>);

impl std::ops::Deref for MorphRayHits {
    type Target = [MorphRayHit];

    fn deref(&self) -> &[MorphRayHit] {
        &self.0
    }
}

impl Caster for MorphRayCaster {
    const NAME: &'static str = "MorphRayCaster";
    type Cast = RayCast;
    type Found = Ranked;
    type Hit = MorphRayHit;
    type Hits = MorphRayHits;

    fn sees(&self) -> (bool, bool, &MorphQueryFilter) {
        (self.enabled, self.ignore_self, &self.filter)
    }

    fn place(&self, place: &GlobalTransform) -> Result<RayCast, String> {
        let (origin, _, direction) = to_world(place, self.origin, Quat::IDENTITY, self.direction)?;
        RayCast::new(origin, direction, self.max_distance).map_err(|error| error.to_string())
    }

    fn sort<'a>(batch: &mut QuestionBatch, casts: impl Iterator<Item = &'a RayCast> + Clone) {
        batch.sort_rays(casts.map(|cast| [cast.origin.as_dvec3(), cast.direction.as_dvec3()]));
    }

    fn ask(&self, cast: &RayCast, filter: &MorphQueryFilter, walker: &mut Walker<'_, '_, '_>) -> Vec<Ranked> {
        let mut hits = match self.max_hits {
            0 => Vec::new(),
            1 => Vec::from_iter(walker.first_hit(cast, filter, &mut |_| true)),
            _ => walker.all_hits(cast, filter, &mut |_| true),
        };
        hits.truncate(self.max_hits);
        hits
    }

    fn hit(found: &Ranked, spatial: &MorphSpatialQuery) -> MorphRayHit {
        spatial.ray_hit(found)
    }

    fn list(hits: &mut MorphRayHits) -> &mut Vec<MorphRayHit> {
        &mut hits.0
    }
}
