//! What a game implements.

use bevy::ecs::system::ReadOnlySystemParam;
use bevy::prelude::*;

pub use crate::broad_phase::MorphCandidatePair;
use crate::contacts::MorphContact;

/// A game's own rules for pairs of colliders, as a [`SystemParam`](bevy::ecs::system::SystemParam) that reads whatever they depend on.
///
/// Add them with [`MorphCollisionHooksPlugin`](crate::plugins::MorphCollisionHooksPlugin). They are asked about pairs of which a collider,
/// or its body, has [`MorphActiveCollisionHooks`](crate::components::MorphActiveCollisionHooks). With several hooks, all have to agree; one
/// that comes later is not asked about what another has refused, and sees a contact as the other has changed it.
///
/// Hooks decide about collisions of colliders: [`MorphCollisions`](crate::contacts::MorphCollisions) and its events. Spatial queries have
/// [filters](crate::spatial::MorphQueryFilter), physics engines have hooks of their own, and self-collisions ask nobody.
///
/// - Hooks may use [`MorphSpatialQuery`](crate::spatial::MorphSpatialQuery) and what else the plugin offers to read. Contacts are those of the
///   last run.
/// - Commands run in the middle of the run. Do not spawn or despawn colliders, bodies or joints with them: events would name entities that
///   are gone. Leave that to a system or an observer that reads the events.
/// - A parameter that cannot be fetched, such as a `Single` without a match, makes Bevy leave the hooks out, and then nothing is refused. Use a
///   `Query` or an `Option`.
///
/// # Teams
///
/// Members of a team do not collide with each other:
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component, PartialEq)]
/// struct Team(u8);
///
/// #[derive(SystemParam)]
/// struct TeamRules<'w, 's> {
///     teams: Query<'w, 's, &'static Team>,
/// }
///
/// impl MorphCollisionHooks for TeamRules<'_, '_> {
///     fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
///         !matches!(self.teams.get_many([pair.body1, pair.body2]), Ok([one, other]) if one == other)
///     }
/// }
///
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin));
/// app.add_plugins((MorphPlugins, MorphCollisionHooksPlugin::<TeamRules>::default()));
/// app.world_mut().spawn((MorphShape::Ball { radius: 0.5 }, Team(1), MorphActiveCollisionHooks::FILTER_PAIRS));
/// # app.finish();
/// # app.update();
/// ```
///
/// # The owner of a projectile
///
/// An arrow does not hit the character that shoots it, not even the hand at the string:
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component)]
/// struct ShotBy(Entity);
///
/// #[derive(SystemParam)]
/// struct SpareTheOwner<'w, 's> {
///     arrows: Query<'w, 's, &'static ShotBy>,
/// }
///
/// impl MorphCollisionHooks for SpareTheOwner<'_, '_> {
///     fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
///         let is_shot_by = |arrow, owner| self.arrows.get(arrow).is_ok_and(|by| by.0 == owner);
///         !is_shot_by(pair.body1, pair.body2) && !is_shot_by(pair.body2, pair.body1)
///     }
/// }
/// # App::new().add_plugins(MorphCollisionHooksPlugin::<SpareTheOwner>::default());
/// ```
///
/// # A one-way surface
///
/// What comes from below goes through the leaf of a giant plant, until its feet are above:
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component)]
/// struct OneWay;
///
/// #[derive(SystemParam)]
/// struct OneWaySurfaces<'w, 's> {
///     surfaces: Query<'w, 's, &'static GlobalTransform, With<OneWay>>,
///     places: Query<'w, 's, &'static GlobalTransform>,
/// }
///
/// impl MorphCollisionHooks for OneWaySurfaces<'_, '_> {
///     fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
///         // The origin of a character is between its feet.
///         let comes_from_below = |surface, other| {
///             let (surface, other) = (self.surfaces.get(surface), self.places.get(other));
///             surface.ok().zip(other.ok()).is_some_and(|(surface, feet)| feet.translation().y < surface.translation().y)
///         };
///         !comes_from_below(pair.body1, pair.body2) && !comes_from_below(pair.body2, pair.body1)
///     }
/// }
/// # App::new().add_plugins(MorphCollisionHooksPlugin::<OneWaySurfaces>::default());
/// ```
///
/// # Scratches
///
/// Blows that go less than a centimetre deep do not count (in mode [`Contacts`](crate::components::MorphCollisionMode::Contacts)):
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(SystemParam)]
/// struct OnlyBlows;
///
/// impl MorphCollisionHooks for OnlyBlows {
///     fn modify_contacts(&self, contact: &mut MorphContact, _: &mut Commands) -> bool {
///         contact.points.retain(|point| point.depth >= 0.01);
///         !contact.points.is_empty()
///     }
/// }
/// # App::new().add_plugins(MorphCollisionHooksPlugin::<OnlyBlows>::default());
/// ```
pub trait MorphCollisionHooks: ReadOnlySystemParam + Send + Sync {
    /// Whether two colliders are compared. If not, they do not touch, and a contact that they have ends.
    ///
    /// Called at most once in each run for each pair whose boxes overlap, or overlap on the way of a continuous collider, and that layers and
    /// modes allow; before any triangle is tested. The order of the calls depends on the entities only.
    fn filter_pairs(&self, pair: &MorphCandidatePair, commands: &mut Commands) -> bool {
        let _ = (pair, commands);
        true
    }

    /// Changes a contact before anybody sees it. If it returns `false`, the colliders do not touch.
    ///
    /// Called at most once in each run for each pair that touches, in the order of the entities. The contact is the one that was found in this
    /// run: what was changed in earlier runs is not in it, but [`impact`](MorphContact::impact) still says how it began. The colliders, their
    /// bodies and the impact cannot be changed.
    fn modify_contacts(&self, contact: &mut MorphContact, commands: &mut Commands) -> bool {
        let _ = (contact, commands);
        true
    }
}
