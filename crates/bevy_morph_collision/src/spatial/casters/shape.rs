//! Shapes that are cast in every run.

use bevy::prelude::*;
use morph_collision::batch::QuestionBatch;

use super::carrier::to_world;
use super::cast::Caster;
use crate::components::{MorphShape, MorphUnit};
use crate::spatial::shapes::{FirstTouch, ShapeCast};
use crate::spatial::walker::Walker;
use crate::spatial::{MorphQueryFilter, MorphShapeHit, MorphSpatialQuery};

/// Casts a solid shape from its entity in every run, and lists what it touches in [`MorphShapeHits`].
///
/// It is a [`MorphRayCaster`](crate::spatial::MorphRayCaster) with a thick ray: for the ground below a character, or for a camera that must
/// not enter a body. The shape does not rotate on its way.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn spawn(mut commands: Commands) {
///     let feet = MorphShape::Ball { radius: 0.3 };
///     commands.spawn((Transform::from_xyz(0.0, 1.0, 0.0), MorphShapeCaster::new(feet, Vec3::ZERO, Dir3::NEG_Y).with_max_distance(2.0)));
/// }
///
/// fn is_grounded(casters: Query<&MorphShapeHits>) {
///     println!("{} of them stand on something", casters.iter().filter(|hits| !hits.is_empty()).count());
/// }
/// # App::new().add_systems(Startup, spawn).add_systems(Update, is_grounded);
/// ```
///
/// - **When.** At the end of each run, in [`MorphCollisionSystems::Casters`](crate::app::MorphCollisionSystems::Casters). While collision is
///   paused, hits stay as they are.
/// - **Bad input.** A shape with an invalid number or transform hits nothing, and the log names its entity.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
#[require(MorphShapeHits, Transform)]
pub struct MorphShapeCaster {
    /// Whether the shape is cast. If not, it hits nothing.
    pub enabled: bool,
    /// The shape, in world units: the entity's scale does not change it.
    pub shape: MorphShape,
    /// Where the shape's centre starts, in the entity's space.
    pub origin: Vec3,
    /// How the shape is turned, in the entity's space.
    pub rotation: Quat,
    /// The direction, in the entity's space. Only the entity's rotation turns it, not its scale.
    pub direction: Dir3,
    /// How far the shape moves at most, in world units; [`f32::MAX`] by default.
    #[reflect(@0.0..=f32::INFINITY, @MorphUnit::Length)]
    pub max_distance: f32,
    /// How many colliders are listed, each where the shape first touches it, nearest first; 1 by default, which takes the least time.
    pub max_hits: usize,
    /// Leaves out the colliders of the body that the caster is on: of the first entity, from its own up to the root of its hierarchy,
    /// that is a collider or a body. On by default.
    pub ignore_self: bool,
    /// Which colliders the shape sees. [`MorphQueryFilter::only_front`] has no effect on shapes.
    #[entities]
    pub filter: MorphQueryFilter,
}

impl Default for MorphShapeCaster {
    fn default() -> Self {
        Self {
            enabled: true,
            shape: MorphShape::default(),
            origin: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            direction: Dir3::NEG_Z,
            max_distance: f32::MAX,
            max_hits: 1,
            ignore_self: true,
            filter: MorphQueryFilter::default(),
        }
    }
}

impl MorphShapeCaster {
    /// A shape that starts at a point and moves in a direction, both in the entity's space.
    #[must_use]
    pub fn new(shape: MorphShape, origin: Vec3, direction: Dir3) -> Self {
        Self {
            shape,
            origin,
            direction,
            ..default()
        }
    }

    /// Turns the shape, in the entity's space.
    #[must_use]
    pub fn with_rotation(mut self, rotation: Quat) -> Self {
        self.rotation = rotation;
        self
    }

    /// Limits how far the shape moves, in world units.
    #[must_use]
    pub fn with_max_distance(mut self, max_distance: f32) -> Self {
        self.max_distance = max_distance;
        self
    }

    /// Lists up to `max_hits` colliders.
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

    /// Sets which colliders the shape sees.
    #[must_use]
    pub fn with_filter(mut self, filter: MorphQueryFilter) -> Self {
        self.filter = filter;
        self
    }
}

/// What a [`MorphShapeCaster`] touched in the last run, nearest first. Bevy's change detection sees it only when hits differ.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphShapeHits(Vec<MorphShapeHit>);

impl std::ops::Deref for MorphShapeHits {
    type Target = [MorphShapeHit];

    fn deref(&self) -> &[MorphShapeHit] {
        &self.0
    }
}

impl Caster for MorphShapeCaster {
    const NAME: &'static str = "MorphShapeCaster";
    type Cast = ShapeCast;
    type Found = FirstTouch;
    type Hit = MorphShapeHit;
    type Hits = MorphShapeHits;

    fn sees(&self) -> (bool, bool, &MorphQueryFilter) {
        (self.enabled, self.ignore_self, &self.filter)
    }

    fn place(&self, place: &GlobalTransform) -> Result<ShapeCast, String> {
        let (origin, rotation, direction) = to_world(place, self.origin, self.rotation, self.direction)?;
        let cast = ShapeCast::new(&self.shape, origin, rotation, direction, self.max_distance);
        cast.map_err(|error| error.to_string())
    }

    fn sort<'a>(batch: &mut QuestionBatch, casts: impl Iterator<Item = &'a ShapeCast> + Clone) {
        batch.sort_points(casts.map(|cast| cast.origin.as_dvec3()));
    }

    fn ask(&self, cast: &ShapeCast, filter: &MorphQueryFilter, walker: &mut Walker<'_, '_, '_>) -> Vec<FirstTouch> {
        walker.first_impacts(cast, self.max_hits, filter, &mut |_| true)
    }

    fn hit(found: &FirstTouch, _: &MorphSpatialQuery) -> MorphShapeHit {
        MorphShapeHit::new(found)
    }

    fn list(hits: &mut MorphShapeHits) -> &mut Vec<MorphShapeHit> {
        &mut hits.0
    }
}
